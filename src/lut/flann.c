/* FLANN's indices. KDTREE_SINGLE is exact but for ties (see ties.c); the
 * randomized forest is approximate, and says so.
 * Muja, Lowe, "Fast Approximate Nearest Neighbors", 2009. */
#include <flann/flann.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bridge/module.h"
#include "lut/engine.h"
#include "stylut/version.h"

const char *sty_get_search_library_version(void) { return "FLANN " FLANN_VERSION_; }

#define FLANN_SYMBOLS(X)                      \
  X(DEFAULT_FLANN_PARAMETERS)                 \
  X(flann_set_distance_type)                  \
  X(flann_build_index_float)                  \
  X(flann_find_nearest_neighbors_index_float) \
  X(flann_radius_search_float)                \
  X(flann_free_index_float)

static struct { FLANN_SYMBOLS(STY_MODULE_MEMBER) } flann;
#define SYMBOL(name) STY_MODULE_SYMBOL(flann, name),
static const StySymbol SYMBOLS[] = {FLANN_SYMBOLS(SYMBOL)};
static StyModule module = STY_MODULE("FLANN", "libstylut_flann.so", 50e6, false, SYMBOLS);

typedef struct Index {
  flann_index_t index;
  struct FLANNParameters parameters;
} Index;

/* Before anything else of FLANN's. */
static StyStatus get_parameters(enum flann_algorithm_t algorithm, struct FLANNParameters *out, StyError *error) {
  const StyStatus status = sty_open_module(&module, error);
  if (status) return status;
  *out = *flann.DEFAULT_FLANN_PARAMETERS;
  out->algorithm = algorithm;
  out->cores = 1; /* the rows are what runs in parallel */
  out->log_level = FLANN_LOG_NONE;
  out->random_seed = 1;
  return STY_OK;
}

static StyStatus open_index(const char *name, const StyPoints *points, Index *index, StyError *error) {
  float speedup;
  /* A global of the library's, which its other users may have changed. */
  flann.flann_set_distance_type(FLANN_DIST_EUCLIDEAN, 0);
  index->index = flann.flann_build_index_float(points->values, (int)points->count, points->measure.dims, &speedup,
                                               &index->parameters);
  index->parameters.random_seed = 0; /* or every single query would seed the C library's generator anew */
  return index->index ? STY_OK : sty_fail(error, STY_ERROR_LIBRARY, "engine %s: FLANN could not build its index", name);
}

static void close_index(Index *index) { flann.flann_free_index_float(index->index, &index->parameters); }

/* ---- exact -------------------------------------------------------------------- */

static bool find_nearest(const StySearch *search, const float *at, int count, int *found) {
  const Index *index = search->index;
  struct FLANNParameters parameters = index->parameters;
  float query[STY_MOST_DIMS], distances[64];
  memcpy(query, at, (size_t)search->points->measure.dims * sizeof *query);
  return flann.flann_find_nearest_neighbors_index_float(index->index, query, 1, found, distances, count, &parameters) ==
         0;
}

static int find_within(const StySearch *search, const float *at, float squared_radius, int most, int *found) {
  const Index *index = search->index;
  struct FLANNParameters parameters = index->parameters;
  float query[STY_MOST_DIMS];
  memcpy(query, at, (size_t)search->points->measure.dims * sizeof *query);
  float *distances = malloc((size_t)most * sizeof *distances);
  if (!distances) return -1;
  const int count =
      flann.flann_radius_search_float(index->index, query, found, distances, most, squared_radius, &parameters);
  free(distances);
  return count;
}

StyStatus sty_build_flann_single(const StySites *sites, const StyEngineOptions *options, StyLut *lut, const StyRun *run,
                                 StyError *error) {
  (void)options;
  StyPoints points;
  Index index = {0};
  StyStatus status = get_parameters(FLANN_INDEX_KDTREE_SINGLE, &index.parameters, error);
  if (!status) status = sty_collapse_sites(sites, &lut->spec, &points, error);
  if (status) return status;
  index.parameters.leaf_max_size = 10;
  index.parameters.eps = 0;
  lut->unique = points.count;
  status = open_index("flann-single", &points, &index, error);
  if (!status) {
    const StySearch search = {&points, &index, find_nearest, find_within};
    status = sty_search_table("flann-single", &search, lut, run, error);
    close_index(&index);
  }
  sty_free_points(&points);
  return status;
}

/* ---- approximate -------------------------------------------------------------- */

typedef struct Job {
  const char *name;
  const StyPoints *points;
  const Index *index;
  StyLut *lut;
} Job;

static StyStatus answer_row(const Job *job, int j, float *queries, int *found, float *distances, StyError *error) {
  const StyMeasure *measure = &job->points->measure;
  const int width = job->lut->spec.width;
  StyQuery query;
  for (int i = 0; i < width; i++) {
    sty_make_query(measure, job->lut, i, j, &query);
    memcpy(queries + i * measure->dims, query.at, (size_t)measure->dims * sizeof *queries);
  }
  struct FLANNParameters parameters = job->index->parameters;
  if (flann.flann_find_nearest_neighbors_index_float(job->index->index, queries, width, found, distances, 1,
                                                     &parameters) != 0)
    return sty_fail(error, STY_ERROR_LIBRARY, "engine %s: FLANN's search failed", job->name);
  for (int i = 0; i < width; i++) {
    if (found[i] < 0 || (size_t)found[i] >= job->points->count)
      return sty_fail(error, STY_ERROR_LIBRARY, "engine %s: FLANN found no neighbour for texel (%d, %d)", job->name, i,
                      j);
    const size_t point = (size_t)found[i];
    sty_make_query(measure, job->lut, i, j, &query);
    sty_set_texel(job->lut, measure, (size_t)j * (size_t)width + (size_t)i, job->points->pixels[point],
                  sty_measure_point(job->points, point, &query));
  }
  return STY_OK;
}

static StyStatus build_row(void *context, long j, StyError *error) {
  const Job *job = context;
  const size_t width = (size_t)job->lut->spec.width, dims = (size_t)job->points->measure.dims;
  float *queries = malloc(width * dims * sizeof *queries), *distances = malloc(width * sizeof *distances);
  int *found = malloc(width * sizeof *found);
  const StyStatus status = queries && distances && found
                               ? answer_row(job, (int)j, queries, found, distances, error)
                               : sty_fail_memory(error, job->name, (double)width * (double)(4 * dims + 8));
  free(queries);
  free(distances);
  free(found);
  return status;
}

/* ---- as many checks as an aim takes ------------------------------------------- */

/* Of the table's texels so many, evenly spaced, say how often the forest is right; fewer of them
 * where each is compared with a great many points. */
enum { MOST_SAMPLED = 256, LEAST_SAMPLED = 16, LEAST_CHECKS = 8 };
static const size_t most_comparisons = (size_t)1 << 26;

typedef struct Sample {
  StyQuery queries[MOST_SAMPLED];
  double least[MOST_SAMPLED]; /* of each, over all points */
  int count;
} Sample;

static void take_sample(const Job *job, Sample *sample) {
  const StyMeasure *measure = &job->points->measure;
  const size_t texels = sty_count_texels(&job->lut->spec), width = (size_t)job->lut->spec.width;
  size_t count = most_comparisons / job->points->count;
  count = count < LEAST_SAMPLED ? LEAST_SAMPLED : count > MOST_SAMPLED ? MOST_SAMPLED : count;
  sample->count = (int)(count < texels ? count : texels);
  for (int s = 0; s < sample->count; s++) {
    const size_t texel = (size_t)s * texels / (size_t)sample->count;
    StyQuery *query = &sample->queries[s];
    sty_make_query(measure, job->lut, (int)(texel % width), (int)(texel / width), query);
    sample->least[s] = INFINITY;
    for (size_t p = 0; p < job->points->count; p++)
      sample->least[s] = fmin(sample->least[s], sty_measure_point(job->points, p, query));
  }
}

static int count_right(const Job *job, Index *index, const Sample *sample) {
  const StySearch search = {job->points, index, find_nearest, find_within};
  int right = 0;
  for (int s = 0; s < sample->count; s++) {
    int found = -1;
    if (find_nearest(&search, sample->queries[s].at, 1, &found) && found >= 0 && (size_t)found < job->points->count)
      right += sty_measure_point(job->points, (size_t)found, &sample->queries[s]) <= sample->least[s];
  }
  return right;
}

/* Doubles the checks until the aim is met, or all points are looked at. FLANN's own
 * tuning (FLANN_INDEX_AUTOTUNED) takes ties for errors: where a guide has many, it
 * takes minutes, and at 2,800 points it may not come to an end. */
static StyStatus tune_checks(const Job *job, Index *index, double aim, StyError *error) {
  Sample *sample = malloc(sizeof *sample);
  if (!sample) return sty_fail_memory(error, job->name, (double)sizeof *sample);
  take_sample(job, sample);
  index->parameters.checks = LEAST_CHECKS;
  while (count_right(job, index, sample) < aim * sample->count && (size_t)index->parameters.checks < job->points->count)
    index->parameters.checks *= 2;
  free(sample);
  return STY_OK;
}

/* `aim`: the share of exact answers to choose the checks for; 0: they are given. */
static StyStatus build_forest(const char *name, const StySites *sites, struct FLANNParameters parameters, double aim,
                              StyLut *lut, const StyRun *run, StyError *error) {
  StyPoints points;
  StyStatus status = sty_collapse_sites(sites, &lut->spec, &points, error);
  if (status) return status;
  lut->unique = points.count;
  Index index = {NULL, parameters};
  status = open_index(name, &points, &index, error);
  if (!status) {
    Job job = {name, &points, &index, lut};
    if (aim > 0) status = tune_checks(&job, &index, aim, error);
    if (!status) status = sty_parallel_for(run, lut->spec.height, build_row, &job, error);
    close_index(&index);
  }
  sty_free_points(&points);
  return status;
}

StyStatus sty_build_flann_forest(const StySites *sites, const StyEngineOptions *options, StyLut *lut, const StyRun *run,
                                 StyError *error) {
  struct FLANNParameters parameters;
  const StyStatus status = get_parameters(FLANN_INDEX_KDTREE, &parameters, error);
  if (status) return status;
  parameters.trees = options->trees;
  parameters.checks = options->checks;
  return build_forest("flann-forest", sites, parameters, 0, lut, run, error);
}

StyStatus sty_build_flann_auto(const StySites *sites, const StyEngineOptions *options, StyLut *lut, const StyRun *run,
                               StyError *error) {
  struct FLANNParameters parameters;
  const StyStatus status = get_parameters(FLANN_INDEX_KDTREE, &parameters, error);
  if (status) return status;
  parameters.trees = sty_default_engine_options.trees;
  return build_forest("flann-auto", sites, parameters, options->precision, lut, run, error);
}
