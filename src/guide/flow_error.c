#include <math.h>
#include <stdlib.h>

#include "stylut/flow.h"

static const float most_motion = 1e6f;

/* A motion and what it covers. */
typedef struct Motion {
  const char *name;
  const StyImage *image;
  const float *covered; /* NULL: everything */
  const float *u, *v;
} Motion;

static StyStatus find_motion(const char *name, const StyImage *image, Motion *out, StyError *error) {
  *out = (Motion){name, image, sty_find_channel(image, "A"), sty_find_channel(image, "motion.U"),
                  sty_find_channel(image, "motion.V")};
  if (out->u && out->v) return STY_OK;
  return sty_fail(error, STY_ERROR_INPUT, "%s: found no motion, expected channels motion.U and motion.V", name);
}

static StyStatus check_motion(const Motion *motion, size_t p, StyError *error) {
  if (fabsf(motion->u[p]) <= most_motion && fabsf(motion->v[p]) <= most_motion) return STY_OK;
  const size_t width = (size_t)motion->image->width;
  return sty_fail(error, STY_ERROR_INPUT,
                  "%s: found the motion (%g, %g) at pixel (%zu, %zu), expected pixels within %g", motion->name,
                  (double)motion->u[p], (double)motion->v[p], p % width, p / width, (double)most_motion);
}

/* Between (u, v, 1) of both; atan2 keeps its precision for small angles. */
static double measure_angle(double u, double v, double s, double t) {
  const double cross[3] = {v - t, s - u, u * t - v * s};
  const double sine = sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
  return atan2(sine, u * s + v * t + 1) * (180 / M_PI);
}

static int compare_floats(const void *a, const void *b) {
  const float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

/* Sorts them; the sum is over the sorted, so that it is the same wherever they were. */
static StyFlowSpread measure_spread(float *errors, size_t count) {
  static const double shares[3] = {0.50, 0.95, 0.99};
  double percentiles[3], sum = 0;
  qsort(errors, count, sizeof *errors, compare_floats);
  for (size_t i = 0; i < count; i++) sum += (double)errors[i];
  for (int k = 0; k < 3; k++) {
    const size_t rank = (size_t)ceil(shares[k] * (double)count);
    percentiles[k] = (double)errors[rank ? rank - 1 : 0];
  }
  return (StyFlowSpread){sum / (double)count, percentiles[0], percentiles[1], percentiles[2],
                         (double)errors[count - 1]};
}

static StyStatus collect_errors(const Motion *found, const Motion *truth, float *end_points, float *angles,
                                StyFlowError *out, StyError *error) {
  StyStatus status = STY_OK;
  double length = 0;
  for (size_t p = 0; !status && p < sty_count_pixels(found->image); p++) {
    if ((found->covered && !(found->covered[p] > 0)) || (truth->covered && !(truth->covered[p] > 0))) continue;
    status = check_motion(found, p, error);
    if (!status) status = check_motion(truth, p, error);
    const double u = (double)found->u[p], v = (double)found->v[p], s = (double)truth->u[p], t = (double)truth->v[p];
    const double distance = sqrt((u - s) * (u - s) + (v - t) * (v - t));
    end_points[out->pixels] = (float)distance;
    angles[out->pixels++] = (float)measure_angle(u, v, s, t);
    out->above_1 += distance > 1;
    out->above_3 += distance > 3;
    length += sqrt(s * s + t * t);
  }
  out->mean_truth = out->pixels ? length / (double)out->pixels : 0;
  return status;
}

static void conclude(float *end_points, float *angles, StyFlowError *out) {
  out->end_point = measure_spread(end_points, out->pixels);
  out->angular = measure_spread(angles, out->pixels);
  out->above_1 /= (double)out->pixels;
  out->above_3 /= (double)out->pixels;
  out->relative = out->mean_truth > 0 ? out->end_point.mean / out->mean_truth : 0;
}

StyStatus sty_measure_flow(const char *const names[2], const StyImage *found, const StyImage *truth, StyFlowError *out,
                           StyError *error) {
  Motion motions[2];
  StyStatus status = find_motion(names[0], found, &motions[0], error);
  if (!status) status = find_motion(names[1], truth, &motions[1], error);
  if (!status && (found->width != truth->width || found->height != truth->height))
    status = sty_fail(error, STY_ERROR_INPUT, "%s: found %dx%d pixels, and %s has %dx%d, expected one size", names[1],
                      truth->width, truth->height, names[0], found->width, found->height);
  if (status) return status;
  const size_t pixels = sty_count_pixels(found);
  float *errors = malloc(2 * pixels * sizeof *errors);
  if (!errors) return sty_fail_memory(error, "flow errors", 2 * (double)pixels * sizeof *errors);
  StyFlowError measured = {0};
  status = collect_errors(&motions[0], &motions[1], errors, errors + pixels, &measured, error);
  if (!status && !measured.pixels)
    status =
        sty_fail(error, STY_ERROR_INPUT, "%s: found no pixel that %s covers, too, expected some", names[1], names[0]);
  if (!status) {
    conclude(errors, errors + pixels, &measured);
    *out = measured;
  }
  free(errors);
  return status;
}

StyStatus sty_encode_motion(const StyImage *flow, double scale, int bits, StyImage **out, StyError *error) {
  static const char *const names[] = {"R", "G", "B", "A"};
  Motion motion;
  StyImage *image = NULL;
  StyStatus status = find_motion("picture", flow, &motion, error);
  if (!status && !(scale > 0))
    status = sty_fail(error, STY_ERROR_USAGE, "scale: found %g, expected a number above 0", scale);
  if (!status) status = sty_create_image(flow->width, flow->height, 4, names, bits, &image, error);
  if (status) return status;
  const size_t pixels = sty_count_pixels(flow);
  const double top = bits == 8 ? 255 : 65535;
  for (size_t p = 0; p < pixels; p++) {
    if (motion.covered && !(motion.covered[p] > 0)) continue;
    const double values[4] = {(double)motion.u[p] / scale / 2 + 0.5, (double)motion.v[p] / scale / 2 + 0.5, 0.5, 1};
    for (size_t c = 0; c < 4; c++) image->data[c * pixels + p] = (float)(rint(fmin(fmax(values[c], 0), 1) * top) / top);
  }
  *out = image;
  return STY_OK;
}
