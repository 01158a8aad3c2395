#include <math.h>
#include <stdlib.h>

#include "audit/stored.h"
#include "stylut/audit.h"

enum { SMALLEST = 16, LARGEST = 4096, MORE = 2, IDLE = 3, HALVINGS = 3 };

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

double sty_compare_budget(const StyFigures *figures, const StyBudget *budget) {
  double share = 0;
  if (budget->mean > 0) share = fmax(share, figures->mean / budget->mean);
  if (budget->p99 > 0) share = fmax(share, figures->p99 / budget->p99);
  if (budget->max > 0) share = fmax(share, figures->max / budget->max);
  return share;
}

static int compare_candidates(const void *a, const void *b) {
  const StyCandidate *x = a, *y = b;
  if (x->bytes != y->bytes) return (x->bytes > y->bytes) - (x->bytes < y->bytes);
  return (int)x->spec.map - (int)y->spec.map;
}

/* What sizes are tried for. */
typedef struct Search {
  const StySites *sites;
  const StyImage *guide;
  StyLutSpec spec; /* with the size that is tried */
  StyEncoding encoding;
  const StyAuditOptions *options;
  const StyRun *run;
  const StyBudget *budget;
  StyCandidate *candidates;
  int *count;
} Search;

static StyStatus try_size(Search *s, int size, StyCandidate **out, StyError *error) {
  s->spec.width = s->spec.height = size;
  *out = &s->candidates[(*s->count)++];
  return try_spec(s->sites, s->guide, &s->spec, s->encoding, s->options, s->run, *out, error);
}

/* Between a size that fails and one that does. */
static StyStatus halve_sizes(Search *s, int failed, int met, StyError *error) {
  StyStatus status = STY_OK;
  for (int h = 0; h < HALVINGS && met - failed > 1 && *s->count < STY_MOST_CANDIDATES; h++) {
    const int size = (failed + met) / 2;
    StyCandidate *candidate;
    status = try_size(s, size, &candidate, error);
    if (status) return status;
    if (sty_compare_budget(&candidate->lookup, s->budget) <= 1)
      met = size;
    else
      failed = size;
  }
  return status;
}

/* Sizes of one map, appended to the candidates. */
static StyStatus try_sizes(Search *s, StyError *error) {
  double best = INFINITY;
  int met = 0, idle = 0, least_met = 0, last_failed = 0;
  for (int step = 0; met <= MORE && idle < IDLE && *s->count < STY_MOST_CANDIDATES; step++) {
    const int size = (int)lround(SMALLEST * pow(2, 0.5 * step));
    if (size > LARGEST) break;
    StyCandidate *candidate;
    const StyStatus status = try_size(s, size, &candidate, error);
    if (status) return status;
    const double share = sty_compare_budget(&candidate->lookup, s->budget);
    if (met == 0 && share <= 1)
      least_met = size;
    else if (met == 0)
      last_failed = size;
    met += met > 0 || share <= 1;
    idle = share < best * (1 - least_gain) ? 0 : idle + 1;
    best = fmin(best, share);
    if (s->run && s->run->progress) s->run->progress(s->run->context, fmin(1, step / 16.0));
  }
  return least_met && last_failed ? halve_sizes(s, last_failed, least_met, error) : STY_OK;
}

StyStatus sty_choose_size(const StySites *sites, const StyImage *guide, const StyLutSpec *spec, bool any_map,
                          StyEncoding encoding, const StyAuditOptions *options, const StyBudget *budget,
                          const StyRun *run, StyCandidate *candidates, int *count, int *chosen, StyError *error) {
  const StyLutSpec first = {SMALLEST, SMALLEST, spec->sampling, any_map ? STY_MAP_XY : spec->map, spec->metric};
  *count = 0;
  *chosen = -1;
  StyStatus status = sty_check_spec(&first, error);
  for (int map = STY_MAP_XY; !status && map <= STY_MAP_EQUAL_AREA; map++) {
    Search search = {sites, guide, *spec, encoding, options, run, budget, candidates, count};
    if (any_map) search.spec.map = (StyMap)map;
    if ((int)search.spec.map != map || (map != STY_MAP_XY && spec->sampling != STY_SAMPLE_CENTRE)) continue;
    status = try_sizes(&search, error);
  }
  if (status) return status;
  qsort(candidates, (size_t)*count, sizeof *candidates, compare_candidates);
  for (int c = *count; c-- > 0;)
    if (sty_compare_budget(&candidates[c].lookup, budget) <= 1) *chosen = c;
  return STY_OK;
}
