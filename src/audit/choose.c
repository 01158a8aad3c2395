#include <math.h>
#include <stdlib.h>

#include "audit/stored.h"
#include "stylut/audit.h"

enum { SMALLEST = 16, LARGEST = 4096, MORE = 2, IDLE = 3 };

/* What one more size must bring to count as better. */
static const double least_gain = 0.01;

static StyStatus try_spec(const StySites *sites, const StyImage *guide, const StyLutSpec *spec, StyEncoding encoding,
                          const StyAuditOptions *options, const StyRun *run, StyCandidate *out, StyError *error) {
  const StyEngine *engine = NULL;
  const StyRun quiet = {.threads = run ? run->threads : 0};
  StyLut *lut = NULL, *stored = NULL;
  StyStatus status = sty_find_engine("engine", "auto", &engine, error);
  if (!status) status = sty_build_lut(sites, engine, NULL, spec, &quiet, &lut, error);
  if (!status) status = sty_restore_lut(lut, encoding, &stored, error);
  *out = (StyCandidate){.spec = *spec, .bytes = sty_count_bytes(spec, encoding)};
  if (!status) status = sty_audit_lookup(stored, guide, options, &out->lookup, error);
  sty_destroy_lut(&lut);
  sty_destroy_lut(&stored);
  return status;
}

static int compare_candidates(const void *a, const void *b) {
  const StyCandidate *x = a, *y = b;
  if (x->bytes != y->bytes) return (x->bytes > y->bytes) - (x->bytes < y->bytes);
  return (int)x->spec.map - (int)y->spec.map;
}

/* Sizes of one map, appended to the candidates. */
static StyStatus try_sizes(const StySites *sites, const StyImage *guide, StyLutSpec spec, StyEncoding encoding,
                           const StyAuditOptions *options, double budget, const StyRun *run, StyCandidate *candidates,
                           int *count, StyError *error) {
  double best = INFINITY;
  int met = 0, idle = 0;
  for (int step = 0; met <= MORE && idle < IDLE && *count < STY_MOST_CANDIDATES; step++) {
    spec.width = spec.height = (int)lround(SMALLEST * pow(2, 0.5 * step));
    if (spec.width > LARGEST) return STY_OK;
    StyCandidate *candidate = &candidates[(*count)++];
    const StyStatus status = try_spec(sites, guide, &spec, encoding, options, run, candidate, error);
    if (status) return status;
    met += met > 0 || candidate->lookup.p99 <= budget;
    idle = candidate->lookup.p99 < best * (1 - least_gain) ? 0 : idle + 1;
    best = fmin(best, candidate->lookup.p99);
    if (run && run->progress) run->progress(run->context, fmin(1, step / 16.0));
  }
  return STY_OK;
}

StyStatus sty_choose_size(const StySites *sites, const StyImage *guide, const StyLutSpec *spec, bool any_map,
                          StyEncoding encoding, const StyAuditOptions *options, double budget, const StyRun *run,
                          StyCandidate *candidates, int *count, int *chosen, StyError *error) {
  *count = 0;
  *chosen = -1;
  StyStatus status = STY_OK;
  for (int map = STY_MAP_XY; !status && map <= STY_MAP_EQUAL_AREA; map++) {
    StyLutSpec own = *spec;
    if (any_map) own.map = (StyMap)map;
    if ((int)own.map != map || (map != STY_MAP_XY && spec->sampling != STY_SAMPLE_CENTRE)) continue;
    status = try_sizes(sites, guide, own, encoding, options, budget, run, candidates, count, error);
  }
  if (status) return status;
  qsort(candidates, (size_t)*count, sizeof *candidates, compare_candidates);
  for (int c = *count; c-- > 0;)
    if (candidates[c].lookup.p99 <= budget) *chosen = c;
  return STY_OK;
}
