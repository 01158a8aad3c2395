/* FLANN's KDTreeSingle: an exact kd-tree, but which of several equally near
 * points it returns is a matter of chance (40 % of ties differ from a linear
 * scan). So each query asks for a few neighbours, and the tie rule picks among
 * those at the minimum. Where the whole handful is equally near, it asks for
 * all within that distance; where even those are too many (the centre of a
 * circle), the sites are scanned. */
#include <flann/flann.h>
#include <float.h>
#include <stdlib.h>

#include "lut/engine.h"
#include "stylut/version.h"

enum { NEIGHBOURS = 8, CROWD = 4096 };

/* FLANN prunes with float bounds: a neighbour may be missed by rounding when it
 * is nearer than the last one found by less than this factor. */
static const float rounding_slack = 1.00001f;

typedef struct Job {
  const StySites *sites;
  StyLut *lut;
  flann_index_t index;
  struct FLANNParameters parameters;
} Job;

const char *sty_get_search_library_version(void) { return "FLANN " FLANN_VERSION_; }

/* The nearest of `found` by the tie rule; *settled when no site that FLANN may
 * have missed can be as near. */
static size_t choose_site(const StySites *sites, const int *found, int count, const float g[2], bool *settled) {
  size_t nearest = (size_t)found[0];
  float best = sty_measure_site(sites, nearest, g), farthest = best;
  for (int k = 1; k < count; k++) {
    const size_t site = (size_t)found[k];
    const float distance = sty_measure_site(sites, site, g);
    if (distance < best || (distance == best && site < nearest)) {
      best = distance;
      nearest = site;
    }
    if (distance > farthest) farthest = distance;
  }
  *settled = (size_t)count == sites->count || farthest > best * rounding_slack;
  return nearest;
}

/* Room for one row's queries and answers. */
typedef struct Row {
  float *queries, *distances; /* 2 and NEIGHBOURS a texel */
  int *found;                 /* NEIGHBOURS a texel */
  int *crowd;                 /* CROWD, for one texel */
  float *crowd_distances;
} Row;

/* The nearest site of texel i, whose handful was equally near. */
static size_t search_crowd(const Job *job, const Row *row, int i, size_t nearest) {
  float g[2] = {row->queries[2 * i], row->queries[2 * i + 1]};
  struct FLANNParameters parameters = job->parameters;
  const float radius = sty_measure_site(job->sites, nearest, g) * rounding_slack * rounding_slack + FLT_MIN;
  const int count =
      flann_radius_search_float(job->index, g, row->crowd, row->crowd_distances, CROWD, radius, &parameters);
  bool settled;
  if (count < 1 || count >= CROWD) return sty_scan_sites(job->sites, g);
  return choose_site(job->sites, row->crowd, count, g, &settled);
}

static StyStatus search_row(const Job *job, const Row *row, int j, StyError *error) {
  const int size = job->lut->size;
  const int count = job->sites->count < NEIGHBOURS ? (int)job->sites->count : NEIGHBOURS;
  for (int i = 0; i < size; i++) sty_get_texel_value(job->lut, i, j, row->queries + 2 * i);
  struct FLANNParameters parameters = job->parameters;
  if (flann_find_nearest_neighbors_index_float(job->index, row->queries, size, row->found, row->distances, count,
                                               &parameters) != 0)
    return sty_fail(error, STY_ERROR_LIBRARY, "flann-single: FLANN's search failed");
  for (int i = 0; i < size; i++) {
    bool settled;
    size_t site = choose_site(job->sites, row->found + i * count, count, row->queries + 2 * i, &settled);
    if (!settled) site = search_crowd(job, row, i, site);
    sty_set_texel(job->lut, i, j, job->sites, site, row->queries + 2 * i);
  }
  return STY_OK;
}

static StyStatus build_row(void *context, long j, StyError *error) {
  const Job *job = context;
  const size_t size = (size_t)job->lut->size;
  const Row row = {malloc(size * 2 * sizeof(float)), malloc(size * NEIGHBOURS * sizeof(float)),
                   malloc(size * NEIGHBOURS * sizeof(int)), malloc(CROWD * sizeof(int)), malloc(CROWD * sizeof(float))};
  const bool complete = row.queries && row.distances && row.found && row.crowd && row.crowd_distances;
  const StyStatus status = complete ? search_row(job, &row, (int)j, error)
                                    : sty_fail_memory(error, "flann-single", (double)(size * 72 + CROWD * 8));
  free(row.queries);
  free(row.distances);
  free(row.found);
  free(row.crowd);
  free(row.crowd_distances);
  return status;
}

StyStatus sty_build_flann_single(const StySites *sites, StyLut *lut, const StyRun *run, StyError *error) {
  Job job = {.sites = sites, .lut = lut, .parameters = DEFAULT_FLANN_PARAMETERS};
  job.parameters.algorithm = FLANN_INDEX_KDTREE_SINGLE;
  job.parameters.leaf_max_size = 10;
  job.parameters.eps = 0;
  job.parameters.cores = 1; /* the rows are what runs in parallel */
  job.parameters.log_level = FLANN_LOG_NONE;
  float speedup;
  /* A global of the library's, which its other users may have changed. */
  flann_set_distance_type(FLANN_DIST_EUCLIDEAN, 0);
  job.index = flann_build_index_float(sites->values, (int)sites->count, 2, &speedup, &job.parameters);
  if (!job.index) return sty_fail(error, STY_ERROR_LIBRARY, "flann-single: FLANN could not build its index");
  const StyStatus status = sty_parallel_for(run, lut->size, build_row, &job, error);
  flann_free_index_float(job.index, &job.parameters);
  return status;
}
