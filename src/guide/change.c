#include "guide/change.h"

#include <math.h>
#include <stdlib.h>

/* ---- rendering ---- */

static StyStatus render(const StyScene *scene, const StyCamera *camera, const StyTraceOptions *like, int times,
                        unsigned groups, const StyRun *run, StyTraceTimes *taken, StyImage **out, StyError *error) {
  const StyTraceOptions options = {.width = times * like->width,
                                   .height = times * like->height,
                                   .groups = groups,
                                   .flat = like->flat,
                                   .ray_frame = like->ray_frame};
  return sty_trace_guide(scene, camera, &options, run, taken, out, error);
}

StyStatus sty_render_shape(const StyScene *scene, const StyCamera *camera, const StyTraceOptions *trace,
                           const StyRun *run, StyShape *out, StyRenderCost *cost, StyError *error) {
  StyShape shape = {0};
  StyTraceTimes times;
  StyStatus status = render(scene, camera, trace, 1, STY_GUIDE_NORMAL, run, &times, &shape.normals, error);
  if (!status) status = render(scene, camera, trace, 2, STY_GUIDE_OBJECT, run, NULL, &shape.ids, error);
  if (status) {
    sty_destroy_shape(&shape);
    return status;
  }
  *cost = (StyRenderCost){.triangles = sty_count_scene_triangles(scene),
                          .build_ms = times.build_ms,
                          .trace_ms = times.trace_ms,
                          .tree_bytes = times.tree_bytes};
  for (int m = 0; m < scene->mesh_count; m++) cost->mesh_bytes += sty_get_mesh_bytes(scene->meshes[m]);
  *out = shape;
  return STY_OK;
}

void sty_destroy_shape(StyShape *shape) {
  sty_destroy_image(&shape->normals);
  sty_destroy_image(&shape->ids);
}

/* ---- normals ---- */

static int compare_floats(const void *a, const void *b) {
  const float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

/* By the chord, which is exact for small angles, too. */
static double get_angle(const float *const a[3], const float *const b[3], size_t i) {
  double square = 0;
  for (int k = 0; k < 3; k++) square += ((double)a[k][i] - b[k][i]) * ((double)a[k][i] - b[k][i]);
  return 2 * asin(fmin(sqrt(square) / 2, 1)) * (180 / M_PI);
}

static void find_normals(const StyImage *image, const float *out[3]) {
  static const char *const names[3] = {"normal.X", "normal.Y", "normal.Z"};
  for (int k = 0; k < 3; k++) out[k] = sty_find_channel(image, names[k]);
}

static StyStatus measure_normals(const StyImage *full, const StyImage *simple, StyGuideChange *out, StyError *error) {
  const size_t pixels = sty_count_pixels(full);
  const float *a[3], *b[3], *a_covers = sty_find_channel(full, "A"), *b_covers = sty_find_channel(simple, "A");
  float *angles = malloc(pixels * sizeof *angles);
  if (!angles) return sty_fail_memory(error, "angles", (double)(pixels * sizeof *angles));
  find_normals(full, a);
  find_normals(simple, b);
  size_t count = 0;
  double sum = 0;
  for (size_t i = 0; i < pixels; i++) {
    if (!(a_covers[i] > 0 && b_covers[i] > 0)) continue;
    const double angle = get_angle(a, b, i);
    angles[count++] = (float)angle;
    sum += angle;
  }
  qsort(angles, count, sizeof *angles, compare_floats);
  out->compared = count;
  if (count) {
    out->mean = sum / (double)count;
    out->p99 = (double)angles[(size_t)ceil(0.99 * (double)count) - 1];
    out->maximum = (double)angles[count - 1];
  }
  free(angles);
  return STY_OK;
}

/* ---- silhouettes ---- */

enum { MOST_STEPS = 2 * STY_MOST_SILHOUETTE };

/* Two planes of ids, and for each row how many steps something in it lies off. */
typedef struct Planes {
  const float *a, *b;
  int width, height;
  int *steps; /* 1 per row */
} Planes;

static int clamp(int value, int most) { return value < 0 ? 0 : value > most ? most : value; }

/* Whether `plane` shows this id within so many steps. */
static bool shows(const Planes *planes, const float *plane, float id, int x, int y, int steps) {
  const int left = clamp(x - steps, planes->width - 1), right = clamp(x + steps, planes->width - 1);
  const int top = clamp(y - steps, planes->height - 1), bottom = clamp(y + steps, planes->height - 1);
  for (int j = top; j <= bottom; j++)
    for (int i = left; i <= right; i++)
      if (plane[(size_t)j * (size_t)planes->width + (size_t)i] == id) return true;
  return false;
}

static StyStatus measure_row(void *context, long row, StyError *error) {
  (void)error;
  const Planes *planes = context;
  int steps = 0;
  for (int x = 0; x < planes->width; x++) {
    const size_t i = (size_t)row * (size_t)planes->width + (size_t)x;
    if (planes->a[i] == planes->b[i]) continue;
    if (steps == 0) steps = 1;
    while (steps < MOST_STEPS && !(shows(planes, planes->b, planes->a[i], x, (int)row, steps) &&
                                   shows(planes, planes->a, planes->b[i], x, (int)row, steps)))
      steps++;
  }
  planes->steps[row] = steps;
  return STY_OK;
}

static StyStatus measure_silhouette(const StyImage *full, const StyImage *simple, const StyRun *run, double *out,
                                    StyError *error) {
  Planes planes = {.a = sty_find_channel(full, "object.I"),
                   .b = sty_find_channel(simple, "object.I"),
                   .width = full->width,
                   .height = full->height};
  planes.steps = malloc((size_t)full->height * sizeof *planes.steps);
  if (!planes.steps) return sty_fail_memory(error, "silhouettes", (double)full->height * sizeof *planes.steps);
  const StyStatus status = sty_parallel_for(run, full->height, measure_row, &planes, error);
  int most = 0;
  for (int y = 0; !status && y < full->height; y++) most = planes.steps[y] > most ? planes.steps[y] : most;
  free(planes.steps);
  *out = most / 2.0;
  return status;
}

StyStatus sty_measure_change(const StyShape *full, const StyShape *simple, const StyRun *run, StyGuideChange *out,
                             StyError *error) {
  StyGuideChange change = {0};
  StyStatus status = measure_normals(full->normals, simple->normals, &change, error);
  if (!status) status = measure_silhouette(full->ids, simple->ids, run, &change.silhouette, error);
  if (!status) *out = change;
  return status;
}
