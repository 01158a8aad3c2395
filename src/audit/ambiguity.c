#include "audit/ambiguity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "lut/near.h"

/* ---- pieces ------------------------------------------------------------------- */

/* A stretch of pixels in one row, from first to last. */
typedef struct Stretch {
  int y, first, last;
  uint32_t piece; /* union-find: the stretch that stands for this one's piece */
} Stretch;

typedef struct Pieces {
  Stretch *stretches;
  size_t capacity;
} Pieces;

static uint32_t find_piece(Stretch *stretches, uint32_t s) {
  while (stretches[s].piece != s) s = stretches[s].piece = stretches[stretches[s].piece].piece;
  return s;
}

/* Ascending pixels into stretches; how many. */
static size_t cut_stretches(const StyNearList *list, const StySites *sites, Stretch *out) {
  size_t count = 0;
  for (size_t i = 0; i < list->count; i++) {
    const uint32_t pixel = sites->pixels[list->sites[i]];
    const int x = (int)(pixel % (uint32_t)sites->width), y = (int)(pixel / (uint32_t)sites->width);
    if (count && out[count - 1].y == y && out[count - 1].last + 1 == x)
      out[count - 1].last = x;
    else
      out[count] = (Stretch){y, x, x, (uint32_t)count}, count++;
  }
  return count;
}

/* Joins stretches of successive rows that touch, corners included. */
static size_t count_pieces(Stretch *stretches, size_t count) {
  size_t pieces = count, above = 0;
  for (size_t s = 0; s < count; s++) {
    while (above < s && (stretches[above].y < stretches[s].y - 1 ||
                         (stretches[above].y == stretches[s].y - 1 && stretches[above].last + 1 < stretches[s].first)))
      above++;
    for (size_t a = above; a < s && stretches[a].y == stretches[s].y - 1 && stretches[a].first <= stretches[s].last + 1;
         a++) {
      const uint32_t p = find_piece(stretches, (uint32_t)a), q = find_piece(stretches, (uint32_t)s);
      if (p == q) continue;
      stretches[p > q ? p : q].piece = p > q ? q : p;
      pieces--;
    }
  }
  return pieces;
}

static double measure_spread(const StyNearList *list, const StySites *sites) {
  double sum[2] = {0, 0}, squares = 0;
  const double count = (double)list->count;
  for (size_t i = 0; i < list->count; i++) {
    const uint32_t pixel = sites->pixels[list->sites[i]];
    const double at[2] = {pixel % (uint32_t)sites->width, pixel / (uint32_t)sites->width};
    for (int k = 0; k < 2; k++) {
      sum[k] += at[k];
      squares += at[k] * at[k];
    }
  }
  const double variance = squares / count - (sum[0] * sum[0] + sum[1] * sum[1]) / (count * count);
  return variance > 0 ? sqrt(variance) : 0;
}

/* ---- ambiguity ---------------------------------------------------------------- */

/* What a thread needs for one place after another. */
typedef struct Scratch {
  StyNearList list;
  Pieces pieces;
  StyAmbiguity last; /* that of the list */
} Scratch;

static void free_scratch(Scratch *scratch) {
  sty_free_near_list(&scratch->list);
  free(scratch->pieces.stretches);
}

/* False: memory is short. */
static bool measure_choice(const StyNear *near, const float *at, double least, double precision, Scratch *scratch,
                           StyAmbiguity *out) {
  const StyNearList *list = &scratch->list;
  Pieces *pieces = &scratch->pieces;
  /* The margin lets the nearest itself in, whose distance was measured in float. */
  const double radius = (least + precision) * (1 + 1e-6) + 1e-7;
  if (!sty_list_near(near, at, radius, &scratch->list)) return false;
  if (list->unchanged) {
    *out = scratch->last;
    return true;
  }
  sty_sort_near_list(&scratch->list);
  if (pieces->capacity < list->count) {
    Stretch *grown = realloc(pieces->stretches, list->count * sizeof *grown);
    if (!grown) return false;
    *pieces = (Pieces){grown, list->count};
  }
  const size_t count = cut_stretches(list, near->sites, pieces->stretches);
  scratch->last =
      (StyAmbiguity){list->count, count_pieces(pieces->stretches, count), measure_spread(list, near->sites)};
  *out = scratch->last;
  return true;
}

StyStatus sty_measure_choice(const StyNear *near, const float *at, double least, double precision, StyAmbiguity *out,
                             StyError *error) {
  Scratch scratch = {0};
  const bool enough = measure_choice(near, at, least, precision, &scratch, out);
  const size_t count = scratch.list.count;
  free_scratch(&scratch);
  return enough ? STY_OK : sty_fail_memory(error, "ambiguity", (double)count * sizeof(Stretch));
}

typedef struct Job {
  const StyLut *exact;
  StyNear near;
  StyMeasure measure;
  double precision;
  float *pieces, *spread;
} Job;

static bool measure_texel(const Job *job, int i, int j, Scratch *scratch) {
  const size_t texel = (size_t)j * (size_t)job->exact->spec.width + (size_t)i;
  StyQuery query;
  sty_make_query(&job->measure, job->exact, i, j, &query);
  StyAmbiguity choice;
  if (!measure_choice(&job->near, query.at, (double)job->exact->errors[texel], job->precision, scratch, &choice))
    return false;
  job->pieces[texel] = (float)choice.pieces;
  job->spread[texel] = (float)choice.spread;
  return true;
}

static StyStatus measure_row(void *context, long j, StyError *error) {
  const Job *job = context;
  Scratch scratch = {0};
  bool enough = true;
  for (int i = 0; enough && i < job->exact->spec.width; i++)
    if (sty_is_feasible(&job->exact->spec, i, (int)j)) enough = measure_texel(job, i, (int)j, &scratch);
  const size_t count = scratch.list.count;
  free_scratch(&scratch);
  return enough ? STY_OK : sty_fail_memory(error, "ambiguity", (double)count * sizeof(Stretch));
}

StyStatus sty_measure_ambiguity(const StyLut *exact, const StySites *sites, double precision, const StyRun *run,
                                float *pieces, float *spread, StyError *error) {
  Job job = {.exact = exact,
             .measure = sty_choose_measure(sites, &exact->spec),
             .precision = precision,
             .pieces = pieces,
             .spread = spread};
  StyStatus status = sty_open_near(sites, job.measure.dims, precision, &job.near, error);
  if (!status) status = sty_parallel_for(run, exact->spec.height, measure_row, &job, error);
  sty_close_near(&job.near);
  return status;
}

/* ---- stability ---------------------------------------------------------------- */

enum { TRIALS = 8 };

static double draw_signed_half(uint64_t *state) { return (double)(sty_draw_bits(state) >> 11) * 0x1p-53 - 0.5; }

static void count_moves(const StyLut *exact, const StyLut *disturbed, double jump, float *unstable) {
  const uint32_t width = (uint32_t)exact->source_width;
  for (size_t t = 0; t < sty_count_texels(&exact->spec); t++) {
    const double dx = (double)(exact->pixels[t] % width) - (double)(disturbed->pixels[t] % width);
    const double dy = (double)(exact->pixels[t] / width) - (double)(disturbed->pixels[t] / width);
    if (dx * dx + dy * dy > jump * jump) unstable[t] += 1.0f / TRIALS;
  }
}

StyStatus sty_measure_stability(const StyLut *exact, const StySites *sites, double precision, double jump,
                                uint64_t seed, const StyRun *run, float *unstable, StyError *error) {
  StySites disturbed = *sites;
  disturbed.levels = NULL; /* they no longer are */
  disturbed.values = malloc(2 * sites->count * sizeof *disturbed.values);
  if (!disturbed.values) return sty_fail_memory(error, "stability", (double)sites->count * 8);
  memset(unstable, 0, sty_count_texels(&exact->spec) * sizeof *unstable);
  const StyEngine *engine = NULL;
  StyStatus status = sty_find_engine("engine", "auto", &engine, error);
  uint64_t state = seed;
  for (int trial = 0; !status && trial < TRIALS; trial++) {
    for (size_t v = 0; v < 2 * sites->count; v++)
      disturbed.values[v] = (float)((double)sites->values[v] + precision * draw_signed_half(&state)) + 0.0f;
    StyLut *lut = NULL;
    const StyRun quiet = {.threads = run ? run->threads : 0};
    status = sty_build_lut(&disturbed, engine, NULL, &exact->spec, &quiet, &lut, error);
    if (!status) count_moves(exact, lut, jump, unstable);
    sty_destroy_lut(&lut);
  }
  free(disturbed.values);
  return status;
}
