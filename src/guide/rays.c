#include "guide/rays.h"

#include <embree3/rtcore.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene/points.h"
#include "scene/vector.h"
#include "stylut/version.h"

/* Rays that leave a surface start this far off it (trace units). */
static const double RAY_START = 1.0 / 32768;

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

struct StyTracer {
  RTCDevice device;
  RTCScene scene;
  RTCScene *trees; /* 1 per mesh; NULL where no object needs it */
  Placed *placed;  /* 1 per object */
  Ball *balls;     /* 1 per sphere */
  const StyScene *model;
  char message[256];                   /* what Embree complained about first */
  _Atomic long long bytes, most_bytes; /* Embree's own */
};

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

static StyStatus place_all(StyTracer *tracer, const StyScene *scene, StyError *error) {
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
  StyTracer *tracer = context;
  if (!tracer->message[0])
    snprintf(tracer->message, sizeof tracer->message, "%s (code %d)", text ? text : "no reason given", (int)code);
}

/* Called from whichever thread asks for memory. */
static bool count_bytes(void *context, ssize_t bytes, bool post) {
  (void)post;
  StyTracer *tracer = context;
  const long long now = atomic_fetch_add(&tracer->bytes, bytes) + bytes;
  long long most = tracer->most_bytes;
  while (now > most && !atomic_compare_exchange_weak(&tracer->most_bytes, &most, now)) {
  }
  return true;
}

static RTCGeometry make_triangles(const StyTracer *tracer, const StyMesh *mesh) {
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

static RTCScene make_tree(const StyTracer *tracer) {
  RTCScene scene = rtcNewScene(tracer->device);
  if (scene) rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  return scene;
}

/* A tree of its own for a mesh that several objects, or a moved one, show. */
static RTCScene make_shared_tree(const StyTracer *tracer, const StyMesh *mesh) {
  RTCScene tree = make_tree(tracer);
  if (!tree) return NULL;
  attach(tree, make_triangles(tracer, mesh), 0);
  rtcCommitScene(tree);
  return tree;
}

static RTCGeometry make_instance(const StyTracer *tracer, RTCScene tree, const double matrix[3][4]) {
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

static RTCGeometry make_spheres(const StyTracer *tracer) {
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
static void attach_all(StyTracer *tracer) {
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
static StyStatus build_tracer(StyTracer *tracer, const StyScene *scene, StyError *error) {
  const StyStatus status = place_all(tracer, scene, error);
  if (status) return status;
  tracer->device = rtcNewDevice("threads=1");
  if (!tracer->device)
    return sty_fail(error, STY_ERROR_LIBRARY, "Embree does not start (code %d)", (int)rtcGetDeviceError(NULL));
  rtcSetDeviceErrorFunction(tracer->device, keep_message, tracer);
  rtcSetDeviceMemoryMonitorFunction(tracer->device, count_bytes, tracer);
  tracer->scene = make_tree(tracer);
  if (tracer->scene) {
    attach_all(tracer);
    rtcCommitScene(tracer->scene);
  }
  if (rtcGetDeviceError(tracer->device) == RTC_ERROR_NONE && !tracer->message[0]) return STY_OK;
  return sty_fail(error, STY_ERROR_LIBRARY, "Embree fails on %zu triangles: %s", sty_count_scene_triangles(scene),
                  tracer->message);
}

StyStatus sty_open_tracer(const StyScene *scene, StyTracer **out, StyError *error) {
  StyTracer *tracer = calloc(1, sizeof *tracer);
  if (!tracer) return sty_fail_memory(error, "scene", sizeof *tracer);
  const StyStatus status = build_tracer(tracer, scene, error);
  if (status)
    sty_close_tracer(&tracer);
  else
    *out = tracer;
  return status;
}

double sty_get_tracer_bytes(const StyTracer *tracer) { return (double)tracer->most_bytes; }

void sty_close_tracer(StyTracer **closed) {
  if (!closed || !*closed) return;
  StyTracer *tracer = *closed;
  if (tracer->scene) rtcReleaseScene(tracer->scene);
  for (int m = 0; tracer->trees && m < tracer->model->mesh_count; m++)
    if (tracer->trees[m]) rtcReleaseScene(tracer->trees[m]);
  free(tracer->trees);
  free(tracer->placed);
  free(tracer->balls);
  if (tracer->device) rtcReleaseDevice(tracer->device);
  free(tracer);
  *closed = NULL;
}

/* ---- hits ---- */

/* Not fmin and fmax, which are calls. */
static double clamp(double value, double low, double high) { return value < low ? low : value > high ? high : value; }

static void get_corner(const Placed *placed, const uint32_t *corner, double out[3]) {
  const float *p = &placed->mesh->positions[3 * (size_t)*corner];
  for (int i = 0; i < 3; i++) {
    const double *row = placed->matrix[i];
    out[i] = placed->is_unmoved ? p[i] : row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
  }
}

/* The normal that light would see, and with it the mean curvature of the surface that has it: half the normal's
 * divergence over the triangle. */
typedef struct Bend {
  double normal[3];   /* not yet of unit length */
  double steps[2][3]; /* its change along the triangle's two edges */
} Bend;

static void move_normal(const Placed *placed, const double own[3], double out[3]) {
  for (int i = 0; i < 3; i++) out[i] = dot_vectors(placed->cofactors[i], own);
}

static void get_normal(const Placed *placed, const uint32_t *corner, double out[3]) {
  const float *n = &placed->mesh->normals[3 * (size_t)*corner];
  const double own[3] = {n[0], n[1], n[2]};
  if (placed->is_unmoved)
    memcpy(out, own, sizeof own);
  else
    move_normal(placed, own, out);
}

static void interpolate_normal(const Placed *placed, const uint32_t *corners, const double weights[3], Bend *bend) {
  double own[3] = {0, 0, 0}, steps[2][3];
  const float *n[3];
  for (int c = 0; c < 3; c++) n[c] = &placed->mesh->normals[3 * (size_t)corners[c]];
  for (int k = 0; k < 3; k++) {
    for (int c = 0; c < 3; c++) own[k] += weights[c] * n[c][k];
    for (int e = 0; e < 2; e++) steps[e][k] = (double)n[e + 1][k] - n[0][k];
  }
  move_normal(placed, own, bend->normal);
  for (int e = 0; e < 2; e++) move_normal(placed, steps[e], bend->steps[e]);
}

/* `normal` is bend->normal as the viewer sees it. */
static double get_curvature(const Bend *bend, const double ab[3], const double ac[3], const double normal[3]) {
  const double size = dot_vectors(bend->normal, normal); /* negative where it was turned round */
  const double aa = dot_vectors(ab, ab), bb = dot_vectors(ac, ac), mixed = dot_vectors(ab, ac);
  const double determinant = aa * bb - mixed * mixed;
  if (!(determinant > 0) || size == 0) return 0;
  double slopes[2][3];
  for (int e = 0; e < 2; e++) {
    const double along = dot_vectors(bend->steps[e], normal);
    for (int k = 0; k < 3; k++) slopes[e][k] = (bend->steps[e][k] - along * normal[k]) / size;
  }
  const double divergence = bb * dot_vectors(slopes[0], ab) + aa * dot_vectors(slopes[1], ac) -
                            mixed * (dot_vectors(slopes[0], ac) + dot_vectors(slopes[1], ab));
  return divergence / determinant / 2;
}

static void bend_triangle(const Placed *placed, const uint32_t *indices, StyHit *hit) {
  double corners[3][3], ab[3], ac[3];
  Bend bend;
  for (int c = 0; c < 3; c++) get_corner(placed, &indices[c], corners[c]);
  subtract_vectors(corners[1], corners[0], ab);
  subtract_vectors(corners[2], corners[0], ac);
  interpolate_normal(placed, indices, hit->weights, &bend);
  hit->curvature = get_curvature(&bend, ab, ac, hit->shading);
}

static void interpolate_uv(const StyMesh *mesh, const uint32_t *corners, const double weights[3], double out[2]) {
  for (int k = 0; k < 2; k++) {
    out[k] = 0;
    for (int c = 0; mesh->uvs && c < 3; c++) out[k] += weights[c] * mesh->uvs[2 * (size_t)corners[c] + (size_t)k];
  }
}

static void load_triangle(const Placed *placed, const StyHit *hit, bool shading, int i, StyLanes *lanes) {
  const uint32_t *indices = &placed->mesh->indices[3 * (size_t)hit->triangle];
  for (int c = 0; c < 3; c++) {
    double corner[3], normal[3];
    get_corner(placed, &indices[c], corner);
    for (int k = 0; k < 3; k++) lanes->corners[c][k][i] = corner[k];
    if (!shading) continue;
    get_normal(placed, &indices[c], normal);
    for (int k = 0; k < 3; k++) lanes->normals[c][k][i] = normal[k];
  }
}

static void store_triangle(const Placed *placed, const StyLanes *lanes, int i, unsigned parts, StyHit *hit) {
  const StyMesh *mesh = placed->mesh;
  const uint32_t *indices = &mesh->indices[3 * (size_t)hit->triangle];
  for (int k = 0; k < 3; k++) {
    hit->at[k] = lanes->at[k][i];
    hit->facet[k] = lanes->facet[k][i];
    hit->weights[k] = lanes->weights[k][i];
    if (parts & STY_HIT_SHADING) hit->shading[k] = lanes->shading[k][i];
  }
  if (parts & STY_HIT_CURVATURE) bend_triangle(placed, indices, hit);
  if (parts & STY_HIT_UV) interpolate_uv(mesh, indices, hit->weights, hit->uv);
  const int part = (int)mesh->part_ids[hit->triangle] - 1;
  hit->material = &placed->object->material;
  hit->paint = placed->object->is_painted || !mesh->paints ? &placed->object->material.paint : &mesh->paints[part];
  hit->style = placed->object->style;
  hit->object = placed->object->first_id + part;
}

/* All of a block that met triangles, together; other lanes take the first one's triangle, to no end. */
static void hit_triangles(const StyTracer *tracer, const StyRays *rays, const struct RTCRayHit8 *packet, unsigned parts,
                          const bool *is_triangle, StyHit *hits) {
  StyLanes lanes;
  lanes.rays = rays;
  const bool shading = parts & STY_HIT_SHADING;
  int first = 0;
  while (!is_triangle[first]) first++;
  for (int i = 0; i < STY_RAYS; i++) {
    const int j = is_triangle[i] ? i : first;
    load_triangle(&tracer->placed[hits[j].thing], &hits[j], shading, i, &lanes);
    lanes.found[0][i] = (double)packet->hit.u[j];
    lanes.found[1][i] = (double)packet->hit.v[j];
  }
  sty_meet_triangles(&lanes, shading);
  for (int i = 0; i < STY_RAYS; i++)
    if (is_triangle[i]) store_triangle(&tracer->placed[hits[i].thing], &lanes, i, parts, &hits[i]);
}

void sty_get_sphere_uv(const double out[3], double radius, double uv[2]) {
  uv[0] = 0.5 + atan2(out[0], out[2]) / (2 * M_PI);
  uv[1] = 0.5 + asin(clamp(out[1] / radius, -1, 1)) / M_PI;
}

/* From inside, the far wall. A ray that only Embree takes for a hit touches. */
static void hit_sphere(const Ball *ball, const StyRay *ray, StyHit *hit) {
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
  sty_get_sphere_uv(hit->facet, ball->radius, hit->uv);
  hit->curvature = 1 / ball->radius;
  if (dot_vectors(hit->facet, ray->direction) > 0) {
    for (int k = 0; k < 3; k++) hit->facet[k] = -hit->facet[k];
    hit->curvature = -hit->curvature;
  }
  memcpy(hit->shading, hit->facet, sizeof hit->shading);
  normalize_vector(hit->shading);
  hit->material = &ball->sphere->material;
  hit->paint = &ball->sphere->material.paint;
  hit->style = ball->sphere->style;
  hit->object = ball->sphere->id;
}

static void find_hits(const StyTracer *tracer, const StyRays *rays, const struct RTCRayHit8 *packet, unsigned parts,
                      const int *valid, StyHit *hits) {
  const unsigned objects = (unsigned)tracer->model->object_count;
  bool is_triangle[STY_RAYS], any = false;
  for (int i = 0; i < STY_RAYS; i++) {
    is_triangle[i] = false;
    if (!valid[i]) continue;
    const unsigned instance = packet->hit.instID[0][i], primitive = packet->hit.primID[i];
    hits[i].thing = instance == RTC_INVALID_GEOMETRY_ID ? packet->hit.geomID[i] : instance;
    hits[i].triangle = primitive;
    is_triangle[i] = hits[i].thing != objects;
    any |= is_triangle[i];
    if (is_triangle[i]) continue;
    hits[i].thing += primitive;
    const StyRay ray = sty_get_ray(rays, i);
    hit_sphere(&tracer->balls[primitive], &ray, &hits[i]);
  }
  if (any) hit_triangles(tracer, rays, packet, parts, is_triangle, hits);
}

/* ---- rays ---- */

static void set_rays(struct RTCRay8 *packet, const StyRays *rays) {
  float *const origin[] = {packet->org_x, packet->org_y, packet->org_z};
  float *const direction[] = {packet->dir_x, packet->dir_y, packet->dir_z};
  for (int k = 0; k < 3; k++)
    for (int i = 0; i < STY_RAYS; i++) {
      origin[k][i] = (float)rays->origin[k][i];
      direction[k][i] = (float)rays->direction[k][i];
    }
  for (int i = 0; i < STY_RAYS; i++) {
    packet->tnear[i] = 0;
    packet->tfar[i] = INFINITY;
    packet->time[i] = 0;
    packet->mask[i] = ~0u;
    packet->id[i] = 0;
    packet->flags[i] = 0;
  }
}

bool sty_trace_rays(const StyTracer *tracer, const StyRays *rays, bool coherent, unsigned parts, int *valid,
                    StyHit hits[STY_RAYS]) {
  struct RTCIntersectContext context;
  _Alignas(32) struct RTCRayHit8 packet;
  rtcInitIntersectContext(&context);
  if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  set_rays(&packet.ray, rays);
  for (int i = 0; i < STY_RAYS; i++) {
    packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  rtcIntersect8(valid, tracer->scene, &context, &packet);
  int any = 0;
  for (int i = 0; i < STY_RAYS; i++) {
    valid[i] = packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID ? 0 : valid[i];
    any |= valid[i];
  }
  if (any) find_hits(tracer, rays, &packet, parts, valid, hits);
  return any;
}

void sty_leave_hit(const StyHit *hit, const double to[3], StyRay *out) {
  double off[3] = {hit->facet[0], hit->facet[1], hit->facet[2]};
  normalize_vector(off);
  /* Where only the interpolated normal faces the light, the facet is seen from behind by it. */
  const double side = dot_vectors(off, to) < 0 ? -RAY_START : RAY_START;
  for (int k = 0; k < 3; k++) out->origin[k] = hit->at[k] + side * off[k];
  memcpy(out->direction, to, sizeof out->direction);
}

void sty_trace_shadows(const StyTracer *tracer, const StyHit hits[STY_RAYS], double to[STY_RAYS][3],
                       const double distances[STY_RAYS], int *asks) {
  struct RTCIntersectContext context;
  _Alignas(32) struct RTCRay8 packet;
  StyRays rays = {0};
  rtcInitIntersectContext(&context);
  for (int i = 0; i < STY_RAYS; i++) {
    if (!asks[i]) continue;
    StyRay ray;
    sty_leave_hit(&hits[i], to[i], &ray);
    sty_set_ray(&rays, i, &ray);
  }
  set_rays(&packet, &rays);
  for (int i = 0; i < STY_RAYS; i++)
    if (asks[i]) packet.tfar[i] = (float)distances[i];
  rtcOccluded8(asks, tracer->scene, &context, &packet);
  for (int i = 0; i < STY_RAYS; i++)
    if (asks[i] && packet.tfar[i] < 0) asks[i] = 0;
}

/* ---- another scene ---- */

void sty_follow_hit(const StyScene *scene, const StyHit *hit, const StyScene *other, double at[3]) {
  const unsigned objects = (unsigned)scene->object_count;
  if (hit->thing >= objects) {
    const StySphere *sphere = &scene->spheres[hit->thing - objects], *then = &other->spheres[hit->thing - objects];
    double centre[3];
    sty_get_trace_point(scene, sphere->centre, centre);
    sty_get_trace_point(other, then->centre, at);
    const double growth = then->radius * other->scale / (sphere->radius * scene->scale);
    for (int k = 0; k < 3; k++) at[k] += (hit->at[k] - centre[k]) * growth;
    return;
  }
  const Placed placed = place_object(other, &other->objects[hit->thing]);
  const uint32_t *indices = &placed.mesh->indices[3 * (size_t)hit->triangle];
  double corner[3];
  for (int k = 0; k < 3; k++) at[k] = 0;
  for (int c = 0; c < 3; c++) {
    get_corner(&placed, &indices[c], corner);
    for (int k = 0; k < 3; k++) at[k] += hit->weights[c] * corner[k];
  }
}

const char *sty_get_ray_library_version(void) { return "Embree " RTC_VERSION_STRING; }
