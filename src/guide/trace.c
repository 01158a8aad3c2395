/* Guides of triangle scenes. Embree finds which triangle a pixel sees; where
 * the ray meets it is worked out again here, in double and from the triangle's
 * number alone, so that values don't depend on the processor's vector units or
 * on how rays travel together. */
#include <embree3/rtcore.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "guide/channels.h"
#include "scene/vector.h"
#include "stylut/version.h"

/* Rays travel in blocks of 4 x 2 pixels: eight at a time with the coherent
 * flag is 2.5 times as fast as one at a time. */
enum { BLOCK_WIDTH = 4, BLOCK_HEIGHT = 2, BLOCK = BLOCK_WIDTH * BLOCK_HEIGHT, TILE = 32 };

/* Orthographic rays start this far behind the eye's plane (trace units), so
 * that a surface that touches the plane isn't missed. */
static const double START_SLACK = 1.0 / 1024;

/* Embree aborts on absurd origins; a camera near the scene is far below this. */
static const double LARGEST_CAMERA = 1e6;

/* ---- acceleration structure ---- */

typedef struct Tracer {
  RTCDevice device;
  RTCScene scene;
  char message[256]; /* what Embree complained about first */
} Tracer;

static void keep_message(void *context, enum RTCError code, const char *text) {
  Tracer *tracer = context;
  if (!tracer->message[0])
    snprintf(tracer->message, sizeof tracer->message, "%s (code %d)", text ? text : "no reason given", (int)code);
}

static void release_tracer(Tracer *tracer) {
  if (tracer->scene) rtcReleaseScene(tracer->scene);
  if (tracer->device) rtcReleaseDevice(tracer->device);
}

static void attach_triangles(Tracer *tracer, const StyScene *scene) {
  RTCGeometry geometry = rtcNewGeometry(tracer->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  if (!geometry) return;
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, scene->positions, 0,
                             3 * sizeof(float), scene->vertex_count);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, scene->indices, 0,
                             3 * sizeof(uint32_t), scene->triangle_count);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(tracer->scene, geometry);
  rtcReleaseGeometry(geometry);
}

/* One thread builds, whatever the run asks for: the order of triangles in the
 * tree depends on the number of builders, and decides which of two triangles
 * wins where a ray meets their common edge. */
static StyStatus build_tracer(Tracer *tracer, const StyScene *scene, StyError *error) {
  tracer->device = rtcNewDevice("threads=1");
  if (!tracer->device)
    return sty_fail(error, STY_ERROR_LIBRARY, "Embree does not start (code %d)", (int)rtcGetDeviceError(NULL));
  rtcSetDeviceErrorFunction(tracer->device, keep_message, tracer);
  tracer->scene = rtcNewScene(tracer->device);
  if (tracer->scene) {
    rtcSetSceneFlags(tracer->scene, RTC_SCENE_FLAG_ROBUST);
    attach_triangles(tracer, scene);
    rtcCommitScene(tracer->scene);
  }
  if (rtcGetDeviceError(tracer->device) == RTC_ERROR_NONE && !tracer->message[0]) return STY_OK;
  return sty_fail(error, STY_ERROR_LIBRARY, "Embree fails on %zu triangles: %s", scene->triangle_count,
                  tracer->message);
}

/* ---- rays ---- */

typedef struct Ray {
  double origin[3], direction[3]; /* trace space */
} Ray;

typedef struct Render {
  const StyScene *scene;
  const StyCamera *camera;
  const StyTraceOptions *options;
  RTCScene tree;
  StyGuide guide;
} Render;

static Ray make_ray(const Render *render, int x, int y) {
  const StyCamera *camera = render->camera;
  const double s = ((x + 0.5) / render->options->width * 2 - 1) * camera->half_width;
  const double t = (1 - (y + 0.5) / render->options->height * 2) * camera->half_height;
  Ray ray;
  for (int k = 0; k < 3; k++) {
    const double film = s * camera->right[k] + t * camera->up[k];
    ray.origin[k] = camera->perspective ? camera->eye[k] : camera->eye[k] + film + START_SLACK * camera->back[k];
    ray.direction[k] = camera->perspective ? film - camera->back[k] : -camera->back[k];
  }
  return ray;
}

static void set_packet_ray(struct RTCRayHit8 *packet, int i, const Ray *ray) {
  packet->ray.org_x[i] = (float)ray->origin[0];
  packet->ray.org_y[i] = (float)ray->origin[1];
  packet->ray.org_z[i] = (float)ray->origin[2];
  packet->ray.dir_x[i] = (float)ray->direction[0];
  packet->ray.dir_y[i] = (float)ray->direction[1];
  packet->ray.dir_z[i] = (float)ray->direction[2];
  packet->ray.tnear[i] = 0;
  packet->ray.tfar[i] = INFINITY;
  packet->ray.time[i] = 0;
  packet->ray.mask[i] = ~0u;
  packet->ray.id[i] = 0;
  packet->ray.flags[i] = 0;
  packet->hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
  packet->hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
}

/* ---- shading ---- */

typedef struct Hit {
  size_t triangle;
  double corners[3][3]; /* trace space */
  double normal[3];     /* of the facet, any length, on the viewer's side */
  double weights[3];    /* barycentric */
} Hit;

static double clamp(double value, double low, double high) { return fmin(fmax(value, low), high); }

/* Moeller and Trumbore 1997. `u` and `v` hold Embree's answer for a ray within
 * the triangle's plane, where there is no other. */
static void set_weights(Hit *hit, const Ray *ray, const double ab[3], const double ac[3], double u, double v) {
  double p[3], q[3], from[3];
  cross_vectors(ray->direction, ac, p);
  const double determinant = dot_vectors(ab, p);
  if (determinant != 0) {
    subtract_vectors(ray->origin, hit->corners[0], from);
    cross_vectors(from, ab, q);
    u = dot_vectors(from, p) / determinant;
    v = dot_vectors(ray->direction, q) / determinant;
  }
  hit->weights[1] = clamp(u, 0, 1);
  hit->weights[2] = clamp(v, 0, 1 - hit->weights[1]);
  hit->weights[0] = 1 - hit->weights[1] - hit->weights[2];
}

static Hit get_hit(const Render *render, const Ray *ray, const struct RTCRayHit8 *packet, int i) {
  Hit hit = {.triangle = packet->hit.primID[i]};
  for (int c = 0; c < 3; c++) {
    const float *p = &render->scene->positions[3 * (size_t)render->scene->indices[3 * hit.triangle + (size_t)c]];
    for (int k = 0; k < 3; k++) hit.corners[c][k] = p[k];
  }
  double ab[3], ac[3];
  subtract_vectors(hit.corners[1], hit.corners[0], ab);
  subtract_vectors(hit.corners[2], hit.corners[0], ac);
  cross_vectors(ab, ac, hit.normal);
  if (dot_vectors(hit.normal, ray->direction) > 0)
    for (int k = 0; k < 3; k++) hit.normal[k] = -hit.normal[k];
  set_weights(&hit, ray, ab, ac, (double)packet->hit.u[i], (double)packet->hit.v[i]);
  return hit;
}

/* On the facet's visible side whichever way the file's normals point, since
 * winding and normals of a file need not agree. */
static void interpolate_normal(const Render *render, const Hit *hit, double out[3]) {
  for (int k = 0; k < 3; k++) out[k] = 0;
  for (int c = 0; c < 3; c++) {
    const float *n = &render->scene->normals[3 * (size_t)render->scene->indices[3 * hit->triangle + (size_t)c]];
    for (int k = 0; k < 3; k++) out[k] += hit->weights[c] * n[k];
  }
  if (!normalize_vector(out)) {
    memcpy(out, hit->normal, 3 * sizeof *out);
    normalize_vector(out);
  }
  if (dot_vectors(out, hit->normal) < 0)
    for (int k = 0; k < 3; k++) out[k] = -out[k];
}

static void bend_to_horizon(const double direction[3], double normal[3]) {
  if (dot_vectors(normal, direction) <= 0) return;
  double along[3] = {direction[0], direction[1], direction[2]};
  normalize_vector(along);
  const double away = dot_vectors(normal, along);
  for (int k = 0; k < 3; k++) normal[k] -= away * along[k];
  normalize_vector(normal);
}

static void shade_normal(const Render *render, const Hit *hit, const Ray *ray, double out[3]) {
  double normal[3];
  if (render->options->flat) {
    memcpy(normal, hit->normal, sizeof normal);
    normalize_vector(normal);
  } else {
    interpolate_normal(render, hit, normal);
    bend_to_horizon(ray->direction, normal);
  }
  out[0] = dot_vectors(normal, render->camera->right);
  out[1] = dot_vectors(normal, render->camera->up);
  out[2] = dot_vectors(normal, render->camera->back);
}

static void shade_place(const Render *render, const Hit *hit, StySample *sample) {
  const StyScene *scene = render->scene;
  double from_eye[3];
  for (int k = 0; k < 3; k++) {
    const double at = hit->weights[0] * hit->corners[0][k] + hit->weights[1] * hit->corners[1][k] +
                      hit->weights[2] * hit->corners[2][k];
    sample->position[k] = at / scene->scale + scene->centre[k];
    from_eye[k] = at - render->camera->eye[k];
  }
  sample->depth = -dot_vectors(from_eye, render->camera->back) / scene->scale;
}

static void shade_hit(const Render *render, const Ray *ray, const struct RTCRayHit8 *packet, int i, size_t pixel) {
  const unsigned groups = render->options->groups;
  StySample sample;
  sample.object = render->scene->object_ids[packet->hit.primID[i]];
  if (groups & ~(unsigned)STY_GUIDE_OBJECT) {
    const Hit hit = get_hit(render, ray, packet, i);
    if (groups & STY_GUIDE_NORMAL) shade_normal(render, &hit, ray, sample.normal);
    if (groups & (STY_GUIDE_DEPTH | STY_GUIDE_POSITION)) shade_place(render, &hit, &sample);
  }
  sty_set_sample(&render->guide, pixel, &sample);
}

/* ---- tiles ---- */

static void trace_block(const Render *render, struct RTCIntersectContext *context, int x0, int y0) {
  const int width = render->options->width, height = render->options->height;
  Ray rays[BLOCK];
  _Alignas(32) int valid[BLOCK];
  _Alignas(32) struct RTCRayHit8 packet;
  for (int i = 0; i < BLOCK; i++) {
    const int x = x0 + i % BLOCK_WIDTH, y = y0 + i / BLOCK_WIDTH;
    valid[i] = x < width && y < height ? -1 : 0;
    rays[i] = make_ray(render, x, y);
    set_packet_ray(&packet, i, &rays[i]);
  }
  rtcIntersect8(valid, render->tree, context, &packet);
  for (int i = 0; i < BLOCK; i++) {
    if (!valid[i] || packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
    const size_t x = (size_t)(x0 + i % BLOCK_WIDTH), y = (size_t)(y0 + i / BLOCK_WIDTH);
    shade_hit(render, &rays[i], &packet, i, y * (size_t)width + x);
  }
}

static int count_tiles(int side) { return (side + TILE - 1) / TILE; }

static StyStatus trace_tile(void *context, long tile, StyError *error) {
  (void)error;
  const Render *render = context;
  const int columns = count_tiles(render->options->width);
  const int x0 = (int)(tile % columns) * TILE, y0 = (int)(tile / columns) * TILE;
  struct RTCIntersectContext coherent;
  rtcInitIntersectContext(&coherent);
  coherent.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  for (int y = y0; y < y0 + TILE && y < render->options->height; y += BLOCK_HEIGHT)
    for (int x = x0; x < x0 + TILE && x < render->options->width; x += BLOCK_WIDTH)
      trace_block(render, &coherent, x, y);
  return STY_OK;
}

/* ---- the whole ---- */

static StyStatus check_camera(const StyCamera *camera, StyError *error) {
  const double values[] = {camera->eye[0],   camera->eye[1],  camera->eye[2],     camera->right[0],   camera->right[1],
                           camera->right[2], camera->up[0],   camera->up[1],      camera->up[2],      camera->back[0],
                           camera->back[1],  camera->back[2], camera->half_width, camera->half_height};
  for (size_t i = 0; i < sizeof values / sizeof *values; i++)
    if (!(fabs(values[i]) <= LARGEST_CAMERA))
      return sty_fail(error, STY_ERROR_USAGE, "camera: found the value %g, expected at most %g scene sizes", values[i],
                      LARGEST_CAMERA);
  return STY_OK;
}

StyStatus sty_trace_guide(const StyScene *scene, const StyCamera *camera, const StyTraceOptions *options,
                          const StyRun *run, StyTraceTimes *times, StyImage **out, StyError *error) {
  Tracer tracer = {0};
  Render render = {.scene = scene, .camera = camera, .options = options};
  StyStatus status = check_camera(camera, error);
  if (status != STY_OK) return status;

  const double begin = sty_get_milliseconds();
  status = build_tracer(&tracer, scene, error);
  const double built = sty_get_milliseconds();
  render.tree = tracer.scene;
  if (status == STY_OK)
    status = sty_create_guide(options->width, options->height, options->groups, &render.guide, error);
  const long tiles = (long)count_tiles(options->width) * count_tiles(options->height);
  if (status == STY_OK) status = sty_parallel_for(run, tiles, trace_tile, &render, error);
  release_tracer(&tracer);
  if (status != STY_OK) {
    sty_destroy_image(&render.guide.image);
    return status;
  }
  if (times) *times = (StyTraceTimes){.build_ms = built - begin, .trace_ms = sty_get_milliseconds() - built};
  *out = render.guide.image;
  return STY_OK;
}

const char *sty_get_ray_library_version(void) { return "Embree " RTC_VERSION_STRING; }
