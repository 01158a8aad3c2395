#include <math.h>

#include "lut/engine.h"

/* Minima side by side, which compilers turn into vectors without being asked; a
 * single one they mustn't, or won't. Enough that the inner loop stays a loop:
 * unrolled, gcc's is slower. */
enum { LANES = 32 };

static double scan_levels(const StyPoints *points, const StyQuery *query) {
  double best[LANES];
  size_t p = 0;
  for (int k = 0; k < LANES; k++) best[k] = INFINITY;
  for (; p + LANES <= points->count; p += LANES)
    for (size_t k = 0; k < LANES; k++) {
      const double distance = sty_square_steps(&points->measure, query, points->levels + 2 * (p + k));
      best[k] = distance < best[k] ? distance : best[k];
    }
  for (; p < points->count; p++)
    best[0] = fmin(best[0], sty_square_steps(&points->measure, query, points->levels + 2 * p));
  for (int k = 1; k < LANES; k++) best[0] = fmin(best[0], best[k]);
  return best[0];
}

static inline float scan_values(int dims, const float *values, size_t count, const float *at) {
  float best[LANES];
  size_t p = 0;
  for (int k = 0; k < LANES; k++) best[k] = INFINITY;
  for (; p + LANES <= count; p += LANES)
    for (size_t k = 0; k < LANES; k++) {
      const float distance = sty_square_distance(dims, at, values + (size_t)dims * (p + k));
      best[k] = distance < best[k] ? distance : best[k];
    }
  for (; p < count; p++) best[0] = fminf(best[0], sty_square_distance(dims, at, values + (size_t)dims * p));
  for (int k = 1; k < LANES; k++) best[0] = fminf(best[0], best[k]);
  return best[0];
}

/* Any number of dimensions, one point at a time. */
static float scan_long_values(int dims, const float *values, size_t count, const float *at) {
  float best = INFINITY;
  for (size_t p = 0; p < count; p++) best = fminf(best, sty_square_distance(dims, at, values + (size_t)dims * p));
  return best;
}

static double find_least(const StyPoints *points, const StyQuery *query) {
  if (points->measure.integer) return scan_levels(points, query);
  switch (points->measure.dims) {
    case 2: return (double)scan_values(2, points->values, points->count, query->at);
    case 3: return (double)scan_values(3, points->values, points->count, query->at);
    default: return (double)scan_long_values(points->measure.dims, points->values, points->count, query->at);
  }
}

size_t sty_scan_points(const StyPoints *points, const StyQuery *query) {
  const double best = find_least(points, query);
  /* Points ascend by pixel: the first at the minimum is the lowest. */
  size_t nearest = 0;
  while (sty_measure_point(points, nearest, query) != best) nearest++;
  return nearest;
}

typedef struct Job {
  const StyPoints *points;
  StyLut *lut;
} Job;

static StyStatus build_row(void *context, long j, StyError *error) {
  (void)error;
  const Job *job = context;
  const int width = job->lut->spec.width;
  for (int i = 0; i < width; i++) {
    StyQuery query;
    sty_make_query(&job->points->measure, job->lut, i, (int)j, &query);
    const size_t nearest = sty_scan_points(job->points, &query);
    sty_set_texel(job->lut, &job->points->measure, (size_t)j * (size_t)width + (size_t)i, job->points->pixels[nearest],
                  sty_measure_point(job->points, nearest, &query));
  }
  return STY_OK;
}

StyStatus sty_build_brute(const StySites *sites, const StyEngineOptions *options, StyLut *lut, const StyRun *run,
                          StyError *error) {
  (void)options;
  StyPoints points;
  StyStatus status = sty_collapse_sites(sites, &lut->spec, &points, error);
  if (status) return status;
  lut->unique = points.count;
  Job job = {&points, lut};
  status = sty_parallel_for(run, lut->spec.height, build_row, &job, error);
  sty_free_points(&points);
  return status;
}
