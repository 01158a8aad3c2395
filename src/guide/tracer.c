/* Embree's trees of a scene. */
#include "guide/tracer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "scene/points.h"
#include "scene/vector.h"
#include "stylut/version.h"

/* Scaled first, so that products of extreme transforms stay finite. */
static void set_cofactors(const double transform[3][4], double out[3][3]) {
  double most = 0, m[3][3];
  for (int i = 0; i < 9; i++) most = fmax(most, fabs(transform[i / 3][i % 3]));
  for (int i = 0; i < 9; i++) m[i / 3][i % 3] = transform[i / 3][i % 3] / most;
  for (int i = 0; i < 3; i++) cross_vectors(m[(i + 1) % 3], m[(i + 2) % 3], out[i]);
}

StyPlaced sty_place_object(const StyScene *scene, const StyObject *object) {
  StyPlaced placed = {.mesh = scene->meshes[object->mesh], .object = object};
  sty_get_object_matrix(scene, object, placed.matrix);
  set_cofactors(object->transform, placed.cofactors);
  placed.is_unmoved = memcmp(placed.matrix, sty_identity, sizeof sty_identity) == 0;
  return placed;
}

static double get_shift(const StyPlaced *placed) {
  double shift = 0;
  for (int k = 0; k < 3; k++) shift = fmax(shift, fabs(placed->matrix[k][3]));
  return shift;
}

static StyBall place_sphere(const StyScene *scene, const StySphere *sphere) {
  StyBall ball = {.radius = sphere->radius * scene->scale, .sphere = sphere};
  sty_get_trace_point(scene, sphere->centre, ball.centre);
  for (int k = 0; k < 3; k++) ball.reach = fmax(ball.reach, ball.radius + fabs(ball.centre[k]));
  return ball;
}

static StyStatus place_all(StyTracer *tracer, const StyScene *scene, StyError *error) {
  const size_t objects = (size_t)scene->object_count, spheres = (size_t)scene->sphere_count;
  tracer->model = scene;
  tracer->kernels = sty_get_kernels();
  tracer->trees = calloc((size_t)scene->mesh_count + 1, sizeof *tracer->trees);
  tracer->users = calloc((size_t)scene->mesh_count + 1, sizeof *tracer->users);
  tracer->placed = malloc((objects + 1) * sizeof *tracer->placed);
  tracer->balls = malloc((spheres + 1) * sizeof *tracer->balls);
  if (!tracer->trees || !tracer->users || !tracer->placed || !tracer->balls)
    return sty_fail_memory(error, "scene", (double)objects * sizeof *tracer->placed);
  for (size_t o = 0; o < objects; o++) {
    tracer->placed[o] = sty_place_object(scene, &scene->objects[o]);
    tracer->placed[o].shift = get_shift(&tracer->placed[o]);
    tracer->users[scene->objects[o].mesh]++;
  }
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
  RTCGeometry geometry = sty_embree.rtcNewGeometry(tracer->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  if (!geometry) return NULL;
  sty_embree.rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh->positions, 0,
                                        3 * sizeof(float), mesh->vertex_count);
  sty_embree.rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh->indices, 0,
                                        3 * sizeof(uint32_t), mesh->triangle_count);
  sty_embree.rtcCommitGeometry(geometry);
  return geometry;
}

/* Attached under its number, which is how a hit names it. */
static void attach(RTCScene scene, RTCGeometry geometry, unsigned number) {
  if (!geometry) return;
  sty_embree.rtcAttachGeometryByID(scene, geometry, number);
  sty_embree.rtcReleaseGeometry(geometry);
}

static bool report_building(void *context, double done) {
  const StyRun *run = context;
  run->progress(run->context, done < 1 ? done : 1);
  return true;
}

static RTCScene make_tree(const StyTracer *tracer) {
  RTCScene scene = sty_embree.rtcNewScene(tracer->device);
  const StyRun *run = tracer->run;
  if (!scene) return NULL;
  sty_embree.rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  if (run && run->progress)
    sty_embree.rtcSetSceneProgressMonitorFunction(scene, report_building, (void *)(uintptr_t)run);
  return scene;
}

/* A tree of its own for a mesh that several objects, or a moved one, show. */
static RTCScene make_shared_tree(const StyTracer *tracer, const StyMesh *mesh) {
  RTCScene tree = make_tree(tracer);
  if (!tree) return NULL;
  attach(tree, make_triangles(tracer, mesh), 0);
  sty_embree.rtcCommitScene(tree);
  return tree;
}

static RTCGeometry make_instance(const StyTracer *tracer, RTCScene tree, const double matrix[3][4]) {
  RTCGeometry geometry = sty_embree.rtcNewGeometry(tracer->device, RTC_GEOMETRY_TYPE_INSTANCE);
  if (!geometry) return NULL;
  float columns[12];
  for (int j = 0; j < 4; j++)
    for (int i = 0; i < 3; i++) columns[3 * j + i] = (float)matrix[i][j];
  sty_embree.rtcSetGeometryInstancedScene(geometry, tree);
  sty_embree.rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
  sty_embree.rtcCommitGeometry(geometry);
  return geometry;
}

static RTCGeometry make_spheres(const StyTracer *tracer) {
  const size_t count = (size_t)tracer->model->sphere_count;
  RTCGeometry geometry = sty_embree.rtcNewGeometry(tracer->device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
  if (!geometry) return NULL;
  float *at = sty_embree.rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                                                 4 * sizeof(float), count);
  for (size_t s = 0; at && s < count; s++) {
    for (int k = 0; k < 3; k++) at[4 * s + (size_t)k] = (float)tracer->balls[s].centre[k];
    at[4 * s + 3] = (float)tracer->balls[s].radius;
  }
  sty_embree.rtcCommitGeometry(geometry);
  return geometry;
}

/* Object o is geometry o, as it is or, moved or not the only one, as an instance of its mesh's tree; all spheres are
 * the one after them. */
static void attach_all(StyTracer *tracer) {
  const StyScene *model = tracer->model;
  for (int o = 0; o < model->object_count; o++) {
    const StyPlaced *placed = &tracer->placed[o];
    RTCScene *tree = &tracer->trees[placed->object->mesh];
    if (placed->is_unmoved && tracer->users[placed->object->mesh] == 1) {
      attach(tracer->scene, make_triangles(tracer, placed->mesh), (unsigned)o);
      continue;
    }
    if (!*tree) *tree = make_shared_tree(tracer, placed->mesh);
    if (*tree) attach(tracer->scene, make_instance(tracer, *tree, placed->matrix), (unsigned)o);
  }
  if (model->sphere_count) attach(tracer->scene, make_spheres(tracer), (unsigned)model->object_count);
}

#define SYMBOL(name) STY_MODULE_SYMBOL(sty_embree, name),
struct StyEmbree sty_embree;
static const StySymbol SYMBOLS[] = {STY_EMBREE_SYMBOLS(SYMBOL)};
/* The addresses are those of TBB's threads and its heap. */
static StyModule module = STY_MODULE("Embree", "libstylut_embree.so", 500e6, false, SYMBOLS);

/* One thread builds, whatever the run asks for: the order of triangles in the
 * tree depends on the number of builders, and decides which of two triangles
 * wins where a ray meets their common edge. */
static StyStatus build_tracer(StyTracer *tracer, const StyScene *scene, StyError *error) {
  StyStatus status = place_all(tracer, scene, error);
  if (!status) status = sty_open_module(&module, error);
  if (status) return status;
  tracer->device = sty_embree.rtcNewDevice("threads=1");
  if (!tracer->device) {
    const enum RTCError code = sty_embree.rtcGetDeviceError(NULL);
    return sty_fail(error, STY_ERROR_LIBRARY, "Embree does not start (%s, code %d)",
                    code == RTC_ERROR_OUT_OF_MEMORY ? "found too little memory" : "no reason given", (int)code);
  }
  sty_embree.rtcSetDeviceErrorFunction(tracer->device, keep_message, tracer);
  sty_embree.rtcSetDeviceMemoryMonitorFunction(tracer->device, count_bytes, tracer);
  tracer->scene = make_tree(tracer);
  if (tracer->scene) {
    attach_all(tracer);
    sty_embree.rtcCommitScene(tracer->scene);
  }
  if (sty_embree.rtcGetDeviceError(tracer->device) == RTC_ERROR_NONE && !tracer->message[0]) return STY_OK;
  return sty_fail(error, STY_ERROR_LIBRARY, "Embree fails on %zu triangles: %s", sty_count_scene_triangles(scene),
                  tracer->message);
}

StyStatus sty_open_tracer(const StyScene *scene, const StyRun *run, StyTracer **out, StyError *error) {
  StyTracer *tracer = calloc(1, sizeof *tracer);
  if (!tracer) return sty_fail_memory(error, "scene", sizeof *tracer);
  tracer->run = run;
  sty_begin_stage(run, "building");
  const StyStatus status = build_tracer(tracer, scene, error);
  tracer->run = NULL;
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
  if (tracer->scene) sty_embree.rtcReleaseScene(tracer->scene);
  for (int m = 0; tracer->trees && m < tracer->model->mesh_count; m++)
    if (tracer->trees[m]) sty_embree.rtcReleaseScene(tracer->trees[m]);
  free(tracer->trees);
  free(tracer->users);
  free(tracer->placed);
  free(tracer->balls);
  if (tracer->device) sty_embree.rtcReleaseDevice(tracer->device);
  free(tracer);
  *closed = NULL;
}

const char *sty_get_ray_library_version(void) { return "Embree " RTC_VERSION_STRING; }
