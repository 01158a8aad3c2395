#include "lut/engine.h"

/* Points ascend by pixel: the first at the minimum is the lowest. */
static size_t scan_levels(const StyPoints *points, const StyQuery *query) {
  double best = sty_measure_point(points, 0, query);
#pragma omp simd reduction(min : best)
  for (size_t p = 1; p < points->count; p++) {
    const double distance = sty_square_steps(&points->measure, query, points->levels + 2 * p);
    best = distance < best ? distance : best;
  }
  size_t nearest = 0;
  while (sty_square_steps(&points->measure, query, points->levels + 2 * nearest) != best) nearest++;
  return nearest;
}

/* For few dimensions, known where it is called, several points go at a time. */
static inline size_t scan_values(int dims, const float *values, size_t count, const float *at) {
  float best = sty_square_distance(dims, at, values);
#pragma omp simd reduction(min : best)
  for (size_t p = 1; p < count; p++) {
    const float distance = sty_square_distance(dims, at, values + (size_t)dims * p);
    best = distance < best ? distance : best;
  }
  size_t nearest = 0;
  while (sty_square_distance(dims, at, values + (size_t)dims * nearest) != best) nearest++;
  return nearest;
}

/* Any number of dimensions, one point at a time. */
static size_t scan_long_values(int dims, const float *values, size_t count, const float *at) {
  float best = sty_square_distance(dims, at, values);
  size_t nearest = 0;
  for (size_t p = 1; p < count; p++) {
    const float distance = sty_square_distance(dims, at, values + (size_t)dims * p);
    if (distance >= best) continue;
    best = distance;
    nearest = p;
  }
  return nearest;
}

size_t sty_scan_points(const StyPoints *points, const StyQuery *query) {
  const int dims = points->measure.dims;
  if (points->measure.integer) return scan_levels(points, query);
  if (dims == 2) return scan_values(2, points->values, points->count, query->at);
  if (dims == 3) return scan_values(3, points->values, points->count, query->at);
  return scan_long_values(dims, points->values, points->count, query->at);
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
