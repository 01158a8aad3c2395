/* Guides of scenes. Embree finds which triangle or sphere a pixel sees; where
 * the ray meets it is worked out again here, in double and from the triangle's
 * number alone, so that values don't depend on the processor's vector units or
 * on how rays travel together. */
#include <embree3/rtcore.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "guide/channels.h"
#include "scene/points.h"
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

/* ---- what is traced ---- */

/* An object in the scene's trace space. */
typedef struct Placed {
  const StyMesh *mesh;
  const StyObject *object;
  double matrix[3][4];    /* from the mesh's trace space */
  double cofactors[3][3]; /* for normals: proportional to the transform's inverse transpose */
  bool is_unmoved;        /* the matrix is the identity */
} Placed;

/* A sphere in the scene's trace space. */
typedef struct Ball {
  double centre[3], radius;
  const StySphere *sphere;
} Ball;

typedef struct Tracer {
  RTCDevice device;
  RTCScene scene;
  RTCScene *trees; /* 1 per mesh; NULL where no object needs it */
  Placed *placed;  /* 1 per object */
  Ball *balls;     /* 1 per sphere */
  const StyScene *model;
  char message[256]; /* what Embree complained about first */
} Tracer;

/* Scaled first, so that products of extreme transforms stay finite. */
static void set_cofactors(const double transform[3][4], double out[3][3]) {
  double most = 0, m[3][3];
  for (int i = 0; i < 9; i++) most = fmax(most, fabs(transform[i / 3][i % 3]));
  for (int i = 0; i < 9; i++) m[i / 3][i % 3] = transform[i / 3][i % 3] / most;
  for (int i = 0; i < 3; i++) cross_vectors(m[(i + 1) % 3], m[(i + 2) % 3], out[i]);
}

static Placed place_object(const StyScene *scene, const StyObject *object) {
  Placed placed = {.mesh = scene->meshes[object->mesh], .object = object};
  sty_get_object_matrix(scene, object, placed.matrix);
  set_cofactors(object->transform, placed.cofactors);
  placed.is_unmoved = memcmp(placed.matrix, sty_identity, sizeof sty_identity) == 0;
  return placed;
}

static Ball place_sphere(const StyScene *scene, const StySphere *sphere) {
  Ball ball = {.radius = sphere->radius * scene->scale, .sphere = sphere};
  sty_get_trace_point(scene, sphere->centre, ball.centre);
  return ball;
}

static StyStatus place_all(Tracer *tracer, const StyScene *scene, StyError *error) {
  const size_t objects = (size_t)scene->object_count, spheres = (size_t)scene->sphere_count;
  tracer->model = scene;
  tracer->trees = calloc((size_t)scene->mesh_count + 1, sizeof *tracer->trees);
  tracer->placed = malloc((objects + 1) * sizeof *tracer->placed);
  tracer->balls = malloc((spheres + 1) * sizeof *tracer->balls);
  if (!tracer->trees || !tracer->placed || !tracer->balls)
    return sty_fail_memory(error, "scene", (double)objects * sizeof *tracer->placed);
  for (size_t o = 0; o < objects; o++) tracer->placed[o] = place_object(scene, &scene->objects[o]);
  for (size_t s = 0; s < spheres; s++) tracer->balls[s] = place_sphere(scene, &scene->spheres[s]);
  return STY_OK;
}

/* ---- acceleration structure ---- */

static void keep_message(void *context, enum RTCError code, const char *text) {
  Tracer *tracer = context;
  if (!tracer->message[0])
    snprintf(tracer->message, sizeof tracer->message, "%s (code %d)", text ? text : "no reason given", (int)code);
}

static void release_tracer(Tracer *tracer) {
  if (tracer->scene) rtcReleaseScene(tracer->scene);
  for (int m = 0; tracer->trees && m < tracer->model->mesh_count; m++)
    if (tracer->trees[m]) rtcReleaseScene(tracer->trees[m]);
  free(tracer->trees);
  free(tracer->placed);
  free(tracer->balls);
  if (tracer->device) rtcReleaseDevice(tracer->device);
}

static RTCGeometry make_triangles(const Tracer *tracer, const StyMesh *mesh) {
  RTCGeometry geometry = rtcNewGeometry(tracer->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  if (!geometry) return NULL;
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh->positions, 0,
                             3 * sizeof(float), mesh->vertex_count);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh->indices, 0,
                             3 * sizeof(uint32_t), mesh->triangle_count);
  rtcCommitGeometry(geometry);
  return geometry;
}

/* Attached under its number, which is how a hit names it. */
static void attach(RTCScene scene, RTCGeometry geometry, unsigned number) {
  if (!geometry) return;
  rtcAttachGeometryByID(scene, geometry, number);
  rtcReleaseGeometry(geometry);
}

static RTCScene make_tree(const Tracer *tracer) {
  RTCScene scene = rtcNewScene(tracer->device);
  if (scene) rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  return scene;
}

/* A tree of its own for a mesh that several objects, or a moved one, show. */
static RTCScene make_shared_tree(const Tracer *tracer, const StyMesh *mesh) {
  RTCScene tree = make_tree(tracer);
  if (!tree) return NULL;
  attach(tree, make_triangles(tracer, mesh), 0);
  rtcCommitScene(tree);
  return tree;
}

static RTCGeometry make_instance(const Tracer *tracer, RTCScene tree, const double matrix[3][4]) {
  RTCGeometry geometry = rtcNewGeometry(tracer->device, RTC_GEOMETRY_TYPE_INSTANCE);
  if (!geometry) return NULL;
  float columns[12];
  for (int j = 0; j < 4; j++)
    for (int i = 0; i < 3; i++) columns[3 * j + i] = (float)matrix[i][j];
  rtcSetGeometryInstancedScene(geometry, tree);
  rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
  rtcCommitGeometry(geometry);
  return geometry;
}

static RTCGeometry make_spheres(const Tracer *tracer) {
  const size_t count = (size_t)tracer->model->sphere_count;
  RTCGeometry geometry = rtcNewGeometry(tracer->device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
  if (!geometry) return NULL;
  float *at = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), count);
  for (size_t s = 0; at && s < count; s++) {
    for (int k = 0; k < 3; k++) at[4 * s + (size_t)k] = (float)tracer->balls[s].centre[k];
    at[4 * s + 3] = (float)tracer->balls[s].radius;
  }
  rtcCommitGeometry(geometry);
  return geometry;
}

/* Object o is geometry o, as it is or as an instance of its mesh's tree; all spheres are the one after them. */
static void attach_all(Tracer *tracer) {
  const StyScene *model = tracer->model;
  for (int o = 0; o < model->object_count; o++) {
    const Placed *placed = &tracer->placed[o];
    RTCScene *tree = &tracer->trees[placed->object->mesh];
    if (placed->is_unmoved) {
      attach(tracer->scene, make_triangles(tracer, placed->mesh), (unsigned)o);
      continue;
    }
    if (!*tree) *tree = make_shared_tree(tracer, placed->mesh);
    if (*tree) attach(tracer->scene, make_instance(tracer, *tree, placed->matrix), (unsigned)o);
  }
  if (model->sphere_count) attach(tracer->scene, make_spheres(tracer), (unsigned)model->object_count);
}

/* One thread builds, whatever the run asks for: the order of triangles in the
 * tree depends on the number of builders, and decides which of two triangles
 * wins where a ray meets their common edge. */
static StyStatus build_tracer(Tracer *tracer, const StyScene *scene, StyError *error) {
  const StyStatus status = place_all(tracer, scene, error);
  if (status) return status;
  tracer->device = rtcNewDevice("threads=1");
  if (!tracer->device)
    return sty_fail(error, STY_ERROR_LIBRARY, "Embree does not start (code %d)", (int)rtcGetDeviceError(NULL));
  rtcSetDeviceErrorFunction(tracer->device, keep_message, tracer);
  tracer->scene = make_tree(tracer);
  if (tracer->scene) {
    attach_all(tracer);
    rtcCommitScene(tracer->scene);
  }
  if (rtcGetDeviceError(tracer->device) == RTC_ERROR_NONE && !tracer->message[0]) return STY_OK;
  return sty_fail(error, STY_ERROR_LIBRARY, "Embree fails on %zu triangles: %s", sty_count_scene_triangles(scene),
                  tracer->message);
}

/* ---- rays ---- */

typedef struct Ray {
  double origin[3], direction[3]; /* trace space */
} Ray;

typedef struct Render {
  const Tracer *tracer;
  const StyCamera *camera;
  const StyTraceOptions *options;
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

static void set_ray(struct RTCRay8 *packet, int i, const double origin[3], const double direction[3], double far) {
  packet->org_x[i] = (float)origin[0];
  packet->org_y[i] = (float)origin[1];
  packet->org_z[i] = (float)origin[2];
  packet->dir_x[i] = (float)direction[0];
  packet->dir_y[i] = (float)direction[1];
  packet->dir_z[i] = (float)direction[2];
  packet->tnear[i] = 0;
  packet->tfar[i] = (float)far;
  packet->time[i] = 0;
  packet->mask[i] = ~0u;
  packet->id[i] = 0;
  packet->flags[i] = 0;
}

static void set_packet_ray(struct RTCRayHit8 *packet, int i, const Ray *ray) {
  set_ray(&packet->ray, i, ray->origin, ray->direction, INFINITY);
  packet->hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
  packet->hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
}

/* ---- shading ---- */

/* Where a ray meets what it meets. */
typedef struct Hit {
  double at[3];      /* trace space */
  double facet[3];   /* normal of the surface itself, any length, on the viewer's side */
  double shading[3]; /* the normal that light would see, unit length, on the same side; for normals and luma */
  const StyMaterial *material;
  int style, object;
} Hit;

static double clamp(double value, double low, double high) { return fmin(fmax(value, low), high); }

/* Moeller and Trumbore 1997. `u` and `v` hold Embree's answer for a ray within
 * the triangle's plane, where there is no other. */
static void find_weights(const Ray *ray, const double corner[3], const double ab[3], const double ac[3], double u,
                         double v, double weights[3]) {
  double p[3], q[3], from[3];
  cross_vectors(ray->direction, ac, p);
  const double determinant = dot_vectors(ab, p);
  if (determinant != 0) {
    subtract_vectors(ray->origin, corner, from);
    cross_vectors(from, ab, q);
    u = dot_vectors(from, p) / determinant;
    v = dot_vectors(ray->direction, q) / determinant;
  }
  weights[1] = clamp(u, 0, 1);
  weights[2] = clamp(v, 0, 1 - weights[1]);
  weights[0] = 1 - weights[1] - weights[2];
}

static void get_corner(const Placed *placed, const uint32_t *corner, double out[3]) {
  const float *p = &placed->mesh->positions[3 * (size_t)*corner];
  for (int i = 0; i < 3; i++) {
    const double *row = placed->matrix[i];
    out[i] = placed->is_unmoved ? p[i] : row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
  }
}

/* On the facet's visible side whichever way the file's normals point, since
 * winding and normals of a file need not agree. */
static void interpolate_normal(const Placed *placed, const uint32_t *corners, const double weights[3],
                               const double facet[3], double out[3]) {
  double own[3] = {0, 0, 0};
  for (int c = 0; c < 3; c++) {
    const float *n = &placed->mesh->normals[3 * (size_t)corners[c]];
    for (int k = 0; k < 3; k++) own[k] += weights[c] * n[k];
  }
  for (int i = 0; i < 3; i++) out[i] = dot_vectors(placed->cofactors[i], own);
  if (!normalize_vector(out)) {
    memcpy(out, facet, 3 * sizeof *out);
    normalize_vector(out);
  }
  if (dot_vectors(out, facet) < 0)
    for (int k = 0; k < 3; k++) out[k] = -out[k];
}

static void hit_triangle(const Render *render, const Placed *placed, unsigned triangle, double u, double v,
                         const Ray *ray, Hit *hit) {
  const uint32_t *indices = &placed->mesh->indices[3 * (size_t)triangle];
  double corners[3][3], ab[3], ac[3], weights[3];
  for (int c = 0; c < 3; c++) get_corner(placed, &indices[c], corners[c]);
  subtract_vectors(corners[1], corners[0], ab);
  subtract_vectors(corners[2], corners[0], ac);
  cross_vectors(ab, ac, hit->facet);
  if (dot_vectors(hit->facet, ray->direction) > 0)
    for (int k = 0; k < 3; k++) hit->facet[k] = -hit->facet[k];
  find_weights(ray, corners[0], ab, ac, u, v, weights);
  for (int k = 0; k < 3; k++)
    hit->at[k] = weights[0] * corners[0][k] + weights[1] * corners[1][k] + weights[2] * corners[2][k];
  if (render->options->groups & (STY_GUIDE_NORMAL | STY_GUIDE_LUMA))
    interpolate_normal(placed, indices, weights, hit->facet, hit->shading);
  hit->material = &placed->object->material;
  hit->style = placed->object->style;
  hit->object = placed->object->first_id + (int)placed->mesh->part_ids[triangle] - 1;
}

/* From inside, the far wall. A ray that only Embree takes for a hit touches. */
static void hit_sphere(const Ball *ball, const Ray *ray, Hit *hit) {
  double from[3];
  subtract_vectors(ray->origin, ball->centre, from);
  const double a = dot_vectors(ray->direction, ray->direction), b = dot_vectors(from, ray->direction);
  /* The distance of ray and centre, squared, without the cancellation of b*b - a*c. */
  double nearest[3];
  for (int k = 0; k < 3; k++) nearest[k] = from[k] - b / a * ray->direction[k];
  const double half = sqrt(fmax(0, ball->radius * ball->radius - dot_vectors(nearest, nearest)) / a);
  const double t = -b / a - half >= 0 ? -b / a - half : -b / a + half;
  for (int k = 0; k < 3; k++) {
    const double out = nearest[k] + (t + b / a) * ray->direction[k];
    hit->at[k] = ball->centre[k] + out;
    hit->facet[k] = out;
  }
  if (dot_vectors(hit->facet, ray->direction) > 0)
    for (int k = 0; k < 3; k++) hit->facet[k] = -hit->facet[k];
  memcpy(hit->shading, hit->facet, sizeof hit->shading);
  normalize_vector(hit->shading);
  hit->material = &ball->sphere->material;
  hit->style = ball->sphere->style;
  hit->object = ball->sphere->id;
}

static void find_hit(const Render *render, const Ray *ray, const struct RTCRayHit8 *packet, int i, Hit *hit) {
  const unsigned instance = packet->hit.instID[0][i], geometry = packet->hit.geomID[i],
                 triangle = packet->hit.primID[i];
  const unsigned object = instance == RTC_INVALID_GEOMETRY_ID ? geometry : instance;
  const Tracer *tracer = render->tracer;
  if (object == (unsigned)tracer->model->object_count)
    hit_sphere(&tracer->balls[triangle], ray, hit);
  else
    hit_triangle(render, &tracer->placed[object], triangle, (double)packet->hit.u[i], (double)packet->hit.v[i], ray,
                 hit);
}

static void bend_to_horizon(const double direction[3], double normal[3]) {
  if (dot_vectors(normal, direction) <= 0) return;
  double along[3] = {direction[0], direction[1], direction[2]};
  normalize_vector(along);
  const double away = dot_vectors(normal, along);
  for (int k = 0; k < 3; k++) normal[k] -= away * along[k];
  normalize_vector(normal);
}

/* What normals are told in. */
static void get_frame(const Render *render, const Ray *ray, double right[3], double up[3], double back[3]) {
  const StyCamera *camera = render->camera;
  memcpy(right, camera->right, 3 * sizeof *right);
  memcpy(up, camera->up, 3 * sizeof *up);
  memcpy(back, camera->back, 3 * sizeof *back);
  if (!render->options->ray_frame || !camera->perspective) return;
  for (int k = 0; k < 3; k++) back[k] = -ray->direction[k];
  normalize_vector(back);
  const double along = dot_vectors(right, back);
  for (int k = 0; k < 3; k++) right[k] -= along * back[k];
  normalize_vector(right);
  cross_vectors(back, right, up);
}

static void shade_normal(const Render *render, const Hit *hit, const Ray *ray, double out[3]) {
  double normal[3];
  if (render->options->flat) {
    memcpy(normal, hit->facet, sizeof normal);
    normalize_vector(normal);
  } else {
    memcpy(normal, hit->shading, sizeof normal);
    bend_to_horizon(ray->direction, normal);
  }
  double right[3], up[3], back[3];
  get_frame(render, ray, right, up, back);
  out[0] = dot_vectors(normal, right);
  out[1] = dot_vectors(normal, up);
  out[2] = dot_vectors(normal, back);
}

static void shade_place(const Render *render, const Hit *hit, StySample *sample) {
  const StyScene *scene = render->tracer->model;
  double from_eye[3];
  for (int k = 0; k < 3; k++) {
    sample->position[k] = hit->at[k] / scene->scale + scene->centre[k];
    from_eye[k] = hit->at[k] - render->camera->eye[k];
  }
  sample->depth = -dot_vectors(from_eye, render->camera->back) / scene->scale;
}

/* ---- light ---- */

/* What a block's pixels see; those that see nothing aren't valid. */
typedef struct Block {
  Ray rays[BLOCK];
  Hit hits[BLOCK];
  double luma[BLOCK];
  _Alignas(32) int valid[BLOCK];
} Block;

/* Shadow rays start this far off the surface (trace units). */
static const double SHADOW_START = 1.0 / 32768;

static double get_luminance(const double colour[3]) {
  return 0.2126 * colour[0] + 0.7152 * colour[1] + 0.0722 * colour[2];
}

/* From a hit to the light: a unit vector, and the distance in trace units; false where they are in one place. */
static bool aim_at_light(const StyScene *scene, const StyLight *light, const Hit *hit, double to[3], double *distance) {
  double from[3];
  sty_get_trace_point(scene, light->position, from);
  for (int k = 0; k < 3; k++) to[k] = light->is_point ? from[k] - hit->at[k] : -light->direction[k];
  *distance = light->is_point ? sqrt(dot_vectors(to, to)) : INFINITY;
  return normalize_vector(to);
}

static void set_shadow_ray(struct RTCRay8 *packet, int i, const Hit *hit, const double to[3], double distance) {
  double off[3] = {hit->facet[0], hit->facet[1], hit->facet[2]}, start[3];
  normalize_vector(off);
  /* Where only the interpolated normal faces the light, the facet is seen from behind by it. */
  const double side = dot_vectors(off, to) < 0 ? -SHADOW_START : SHADOW_START;
  for (int k = 0; k < 3; k++) start[k] = hit->at[k] + side * off[k];
  set_ray(packet, i, start, to, distance);
}

/* Lambert and Blinn-Phong, of one light that is not hidden. */
static double reflect(const Hit *hit, const Ray *ray, const StyLight *light, const double to[3], double received) {
  double colour[3], half[3], toward[3] = {-ray->direction[0], -ray->direction[1], -ray->direction[2]};
  const double cosine = dot_vectors(hit->shading, to);
  for (int k = 0; k < 3; k++) colour[k] = hit->material->colour[k] * light->colour[k];
  double luma = get_luminance(colour) * cosine;
  if (hit->material->specular > 0 && normalize_vector(toward)) {
    for (int k = 0; k < 3; k++) half[k] = toward[k] + to[k];
    if (normalize_vector(half))
      luma += get_luminance(light->colour) * hit->material->specular *
              pow(fmax(0, dot_vectors(hit->shading, half)), hit->material->shininess);
  }
  return luma * received;
}

/* One light's share for all pixels of a block at once. */
static void light_block(const Render *render, const StyLight *light, Block *block) {
  const StyScene *scene = render->tracer->model;
  _Alignas(32) struct RTCRay8 packet;
  _Alignas(32) int asks[BLOCK];
  double to[BLOCK][3], distances[BLOCK];
  for (int i = 0; i < BLOCK; i++) {
    asks[i] = 0;
    if (!block->valid[i] || !aim_at_light(scene, light, &block->hits[i], to[i], &distances[i])) continue;
    if (!(dot_vectors(block->hits[i].shading, to[i]) > 0)) continue;
    asks[i] = -1;
    set_shadow_ray(&packet, i, &block->hits[i], to[i], distances[i]);
  }
  if (scene->shadows) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded8(asks, render->tracer->scene, &context, &packet);
  }
  for (int i = 0; i < BLOCK; i++) {
    if (!asks[i] || (scene->shadows && packet.tfar[i] < 0)) continue;
    const double world = distances[i] / scene->scale;
    const double received = light->is_point ? light->intensity / (world * world) : light->intensity;
    block->luma[i] += reflect(&block->hits[i], &block->rays[i], light, to[i], received);
  }
}

static void light_all(const Render *render, Block *block) {
  const StyScene *scene = render->tracer->model;
  for (int i = 0; i < BLOCK; i++)
    block->luma[i] = block->valid[i] ? scene->ambient * get_luminance(block->hits[i].material->colour) : 0;
  for (int l = 0; l < scene->light_count; l++) light_block(render, &scene->lights[l], block);
}

static void shade_hit(const Render *render, const Block *block, int i, size_t pixel) {
  const unsigned groups = render->options->groups;
  const Hit *hit = &block->hits[i];
  StySample sample = {.object = hit->object, .style = hit->style, .luma = block->luma[i]};
  memcpy(sample.albedo, hit->material->colour, sizeof sample.albedo);
  if (groups & STY_GUIDE_NORMAL) shade_normal(render, hit, &block->rays[i], sample.normal);
  if (groups & (STY_GUIDE_DEPTH | STY_GUIDE_POSITION)) shade_place(render, hit, &sample);
  sty_set_sample(&render->guide, pixel, &sample);
}

/* ---- tiles ---- */

static void trace_block(const Render *render, struct RTCIntersectContext *context, int x0, int y0) {
  const int width = render->options->width, height = render->options->height;
  Block block;
  _Alignas(32) struct RTCRayHit8 packet;
  for (int i = 0; i < BLOCK; i++) {
    const int x = x0 + i % BLOCK_WIDTH, y = y0 + i / BLOCK_WIDTH;
    block.valid[i] = x < width && y < height ? -1 : 0;
    block.rays[i] = make_ray(render, x, y);
    set_packet_ray(&packet, i, &block.rays[i]);
  }
  rtcIntersect8(block.valid, render->tracer->scene, context, &packet);
  for (int i = 0; i < BLOCK; i++) {
    if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) block.valid[i] = 0;
    if (block.valid[i]) find_hit(render, &block.rays[i], &packet, i, &block.hits[i]);
    block.luma[i] = 0;
  }
  if (render->options->groups & STY_GUIDE_LUMA) light_all(render, &block);
  for (int i = 0; i < BLOCK; i++) {
    const size_t x = (size_t)(x0 + i % BLOCK_WIDTH), y = (size_t)(y0 + i / BLOCK_WIDTH);
    if (block.valid[i]) shade_hit(render, &block, i, y * (size_t)width + x);
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
  Render render = {.tracer = &tracer, .camera = camera, .options = options};
  StyStatus status = check_camera(camera, error);
  if (status != STY_OK) return status;

  const double begin = sty_get_milliseconds();
  status = build_tracer(&tracer, scene, error);
  const double built = sty_get_milliseconds();
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
