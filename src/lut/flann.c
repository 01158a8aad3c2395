/* FLANN's KDTreeSingle: an exact kd-tree, but which of several equally near
 * points it returns is a matter of chance (40 % of ties differ from a linear
 * scan). So each query asks for a few neighbours, and the tie rule picks among
 * those at the minimum. Where the whole handful is equally near (the centre of
 * a circle), the sites are scanned. */
#include <flann/flann.h>
#include <stdlib.h>

#include "lut/engine.h"
#include "stylut/version.h"

enum { NEIGHBOURS = 8 };

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

static size_t choose_site(const Job *job, const int *found, int count, const float g[2]) {
  const StySites *sites = job->sites;
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
  const bool all_seen = (size_t)count == sites->count;
  return all_seen || farthest > best * rounding_slack ? nearest : sty_scan_sites(sites, g);
}

static StyStatus build_row(void *context, long j, StyError *error) {
  Job *job = context;
  const int size = job->lut->size;
  const int count = job->sites->count < NEIGHBOURS ? (int)job->sites->count : NEIGHBOURS;
  float *queries = malloc((size_t)size * 2 * sizeof *queries);
  int *found = malloc((size_t)size * NEIGHBOURS * sizeof *found);
  float *distances = malloc((size_t)size * NEIGHBOURS * sizeof *distances);
  StyStatus status = STY_OK;
  if (!queries || !found || !distances) {
    status = sty_fail_memory(error, "flann-single", (double)size * NEIGHBOURS * 10);
  } else {
    for (int i = 0; i < size; i++) sty_get_texel_value(job->lut, i, (int)j, queries + 2 * i);
    struct FLANNParameters parameters = job->parameters;
    if (flann_find_nearest_neighbors_index_float(job->index, queries, size, found, distances, count, &parameters) != 0)
      status = sty_fail(error, STY_ERROR_LIBRARY, "flann-single: FLANN's search failed");
    for (int i = 0; !status && i < size; i++) {
      const size_t site = choose_site(job, found + i * count, count, queries + 2 * i);
      sty_set_texel(job->lut, i, (int)j, job->sites, site, queries + 2 * i);
    }
  }
  free(queries);
  free(found);
  free(distances);
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
  job.index = flann_build_index_float(sites->values, (int)sites->count, 2, &speedup, &job.parameters);
  if (!job.index) return sty_fail(error, STY_ERROR_LIBRARY, "flann-single: FLANN could not build its index");
  const StyStatus status = sty_parallel_for(run, lut->size, build_row, &job, error);
  flann_free_index_float(job.index, &job.parameters);
  return status;
}
