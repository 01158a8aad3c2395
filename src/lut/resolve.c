/* The choice among nearly equal source pixels.
 *
 * Where a guide shows the same value in many places, the exact nearest neighbour
 * scatters: neighbouring texels land on source pixels far apart, and a style
 * drawn through such a table pops when a surface turns. Within the slack there
 * is usually a pixel near the neighbours' pixels. The coherent choice minimizes
 *   sum over neighbouring texels: much for a jump, a little for a shorter way
 *   + a little per texel for what its pixel is farther than the nearest,
 * by fusion moves (Lempitsky, Rother, Roth, Blake, "Fusion Moves for Markov
 * Random Field Optimization", 2010): a proposal is a smooth patch grown over the
 * table from one texel and its pixel, as far as the slack lets the source's
 * surface be followed; a minimum cut takes over of it what makes the sum less. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "lut/cut.h"
#include "lut/engine.h"

/* What the sum counts, in integers, so that it is the same everywhere: a jump; a
 * way almost as far; a texel at the full slack. The last two are tuned on what
 * moves between frames of a turning figure: with STEP_COST 150 a quarter more
 * does, with SLACK_COST 200 an eighth. */
enum { JUMP_COST = 1000, STEP_COST = 400, SLACK_COST = 60 };

/* Proposals: so many at most; and no more once a round of them took off less than
 * the 1/LEAST_GAIN-th part of the sum. */
enum { MOST_PROPOSALS = 96, ROUND = 6, LEAST_GAIN = 30 };

enum { MOST_REACH = 16 };

static const uint32_t nothing = UINT32_MAX; /* no picture has that many pixels */

static const int steps[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};

typedef struct Resolve {
  StyLut *lut;
  int dims;
  float *values[3];   /* planes of the source pixels, in the metric's space; NAN where uncovered */
  float *places;      /* dims per texel */
  float *limits;      /* per texel: the largest squared distance allowed */
  uint8_t *live;      /* per texel: whether it takes part */
  int jump, reach;    /* pixels: what is a jump; how far from a neighbour's pixel a patch looks for its next */
  uint32_t *current;  /* per texel: its source pixel, packed: y above, x below, 16 bits each */
  uint32_t *proposal; /* per texel: a packed source pixel, or `nothing` */
  int *queue;         /* texels in the order a patch took them */
  int *node;          /* per texel: its node in the cut, or -1 */
  StyCut cut;
} Resolve;

/* ---- setting up --------------------------------------------------------------- */

static int get_x(uint32_t packed) { return (int)(packed & 0xffff); }
static int get_y(uint32_t packed) { return (int)(packed >> 16); }
static uint32_t pack_pixel(int x, int y) { return (uint32_t)y << 16 | (uint32_t)x; }

/* Feasible texels, and those at the rim that a feasible value may fall into. */
static bool is_live(const StyLutSpec *spec, int i, int j) {
  if (sty_is_feasible(spec, i, j)) return true;
  for (int s = 0; s < 4; s++) {
    const int x = i + steps[s][0], y = j + steps[s][1];
    if (x >= 0 && y >= 0 && x < spec->width && y < spec->height && sty_is_feasible(spec, x, y)) return true;
  }
  return false;
}

static void set_texels(Resolve *r, const StyMeasure *measure, double slack) {
  const StyLutSpec *spec = &r->lut->spec;
  for (int j = 0; j < spec->height; j++)
    for (int i = 0; i < spec->width; i++) {
      const size_t t = (size_t)j * (size_t)spec->width + (size_t)i;
      StyQuery query;
      sty_make_query(measure, r->lut, i, j, &query);
      memcpy(r->places + (size_t)r->dims * t, query.at, (size_t)r->dims * sizeof(float));
      /* The margin is for rounding: never beyond the slack. */
      const double limit = (double)r->lut->errors[t] + slack * (1 - 1e-6);
      r->limits[t] = (float)(limit * limit);
      r->live[t] = is_live(spec, i, j);
      r->node[t] = -1;
      const int pixel = (int)r->lut->pixels[t], width = r->lut->source_width;
      r->current[t] = pack_pixel(pixel % width, pixel / width);
    }
}

static void set_values(Resolve *r, const StySites *sites) {
  const size_t pixels = (size_t)sites->width * (size_t)sites->height;
  for (int k = 0; k < r->dims; k++)
    for (size_t p = 0; p < pixels; p++) r->values[k][p] = NAN;
  for (size_t s = 0; s < sites->count; s++) {
    float at[3];
    sty_lift(r->dims, sites->values + 2 * s, at);
    for (int k = 0; k < r->dims; k++) r->values[k][sites->pixels[s]] = at[k];
  }
}

static void close_resolve(Resolve *r) {
  for (int k = 0; k < 3; k++) free(r->values[k]);
  free(r->places);
  free(r->limits);
  free(r->live);
  free(r->current);
  free(r->proposal);
  free(r->queue);
  free(r->node);
  sty_close_cut(&r->cut);
}

static StyStatus open_resolve(StyLut *lut, const StySites *sites, double slack, Resolve *r, StyError *error) {
  const StyMeasure measure = sty_choose_measure(sites, &lut->spec);
  const size_t texels = sty_count_texels(&lut->spec), dims = (size_t)measure.dims;
  const size_t pixels = (size_t)sites->width * (size_t)sites->height;
  const int source = sites->width > sites->height ? sites->width : sites->height;
  const int table = lut->spec.width > lut->spec.height ? lut->spec.width : lut->spec.height;
  *r = (Resolve){.lut = lut, .dims = measure.dims, .jump = 4 * source > table ? 4 * source / table : 1};
  r->reach = r->jump / 2 < 1 ? 1 : r->jump / 2 > MOST_REACH ? MOST_REACH : r->jump / 2;
  bool complete = true;
  for (int k = 0; k < r->dims; k++) complete = (r->values[k] = malloc(pixels * sizeof(float))) && complete;
  r->places = malloc(texels * dims * sizeof *r->places);
  r->limits = malloc(texels * sizeof *r->limits);
  r->live = malloc(texels * sizeof *r->live);
  r->current = malloc(texels * sizeof *r->current);
  r->proposal = malloc(texels * sizeof *r->proposal);
  r->queue = malloc(texels * sizeof *r->queue);
  r->node = malloc(texels * sizeof *r->node);
  if (!complete || !r->places || !r->limits || !r->live || !r->current || !r->proposal || !r->queue || !r->node ||
      !sty_open_cut((int)texels, 2 * (int)texels, &r->cut)) {
    close_resolve(r);
    return sty_fail_memory(error, "coherent LUT", (double)texels * 130 + (double)pixels * 8);
  }
  set_texels(r, &measure, slack);
  set_values(r, sites);
  return STY_OK;
}

/* ---- distances ---------------------------------------------------------------- */

static float measure_pixel(const Resolve *r, int texel, uint32_t pixel) {
  const size_t at = (size_t)get_y(pixel) * (size_t)r->lut->source_width + (size_t)get_x(pixel);
  float value[3] = {0};
  for (int k = 0; k < r->dims; k++) value[k] = r->values[k][at];
  return sty_square_distance(r->dims, r->places + (size_t)r->dims * (size_t)texel, value);
}

/* The same for `count` pixels of a row. */
static void measure_row(const Resolve *r, int texel, size_t begin, int count, float *out) {
  const float *place = r->places + (size_t)r->dims * (size_t)texel;
  for (int i = 0; i < count; i++) {
    const float dx = place[0] - r->values[0][begin + (size_t)i], dy = place[1] - r->values[1][begin + (size_t)i];
    out[i] = dx * dx + dy * dy;
  }
  for (int i = 0; r->dims == 3 && i < count; i++) {
    const float dz = place[2] - r->values[2][begin + (size_t)i];
    out[i] = out[i] + dz * dz;
  }
}

static bool is_jump(const Resolve *r, uint32_t p, uint32_t q) {
  const int dx = get_x(p) - get_x(q), dy = get_y(p) - get_y(q);
  return dx * dx + dy * dy > r->jump * r->jump;
}

/* The neighbour of a texel in direction s that takes part, or -1. */
static int get_neighbour(const Resolve *r, int texel, int s) {
  const int width = r->lut->spec.width;
  const int x = texel % width + steps[s][0], y = texel / width + steps[s][1];
  if (x < 0 || y < 0 || x >= width || y >= r->lut->spec.height) return -1;
  return r->live[y * width + x] ? y * width + x : -1;
}

/* ---- costs -------------------------------------------------------------------- */

/* For two neighbouring texels' pixels: a jump, or the way from one to the other. */
static int32_t get_pair_cost(const Resolve *r, uint32_t p, uint32_t q) {
  if (is_jump(r, p, q)) return JUMP_COST;
  return STEP_COST * (abs(get_x(p) - get_x(q)) + abs(get_y(p) - get_y(q))) / r->jump;
}

/* For a pixel farther than the nearest; `squared` is its distance. */
static int32_t get_excess_cost(const Resolve *r, int texel, float squared) {
  const float least = r->lut->errors[texel] * r->lut->errors[texel];
  const float share = (squared - least) / (r->limits[texel] - least);
  return share > 0 ? (int32_t)(SLACK_COST * share + 0.5f) : 0;
}

static int32_t get_own_cost(const Resolve *r, int texel, uint32_t pixel) {
  return get_excess_cost(r, texel, measure_pixel(r, texel, pixel));
}

/* ---- growing a patch ---------------------------------------------------------- */

/* Source pixels that a texel's neighbours in the patch have. */
typedef struct Around {
  uint32_t pixels[4];
  int count;
} Around;

static Around look_around(const Resolve *r, int texel) {
  Around around = {.count = 0};
  for (int s = 0; s < 4; s++) {
    const int other = get_neighbour(r, texel, s);
    if (other >= 0 && r->proposal[other] != nothing) around.pixels[around.count++] = r->proposal[other];
  }
  return around;
}

/* What a pixel costs toward them; JUMP_COST or more when it is a jump from any. */
static int32_t get_around_cost(const Resolve *r, const Around *around, uint32_t pixel) {
  int32_t sum = 0;
  for (int n = 0; n < around->count && sum < JUMP_COST; n++) sum += get_pair_cost(r, around->pixels[n], pixel);
  return sum;
}

/* The cheapest allowed pixel around `from` that is no jump from any neighbour's, or `nothing`. */
static uint32_t continue_patch(const Resolve *r, int texel, uint32_t from) {
  const int width = r->lut->source_width, height = r->lut->source_height;
  const int left = get_x(from) > r->reach ? get_x(from) - r->reach : 0;
  const int top = get_y(from) > r->reach ? get_y(from) - r->reach : 0;
  const int right = get_x(from) + r->reach < width ? get_x(from) + r->reach + 1 : width;
  const int bottom = get_y(from) + r->reach < height ? get_y(from) + r->reach + 1 : height;
  const Around around = look_around(r, texel);
  uint32_t best = nothing;
  int32_t least = INT32_MAX;
  float distances[2 * MOST_REACH + 1];
  for (int y = top; y < bottom; y++) {
    measure_row(r, texel, (size_t)y * (size_t)width + (size_t)left, right - left, distances);
    for (int x = left; x < right; x++) {
      if (!(distances[x - left] <= r->limits[texel])) continue;
      const int32_t own = get_excess_cost(r, texel, distances[x - left]);
      if (own >= least) continue;
      const int32_t toward = get_around_cost(r, &around, pack_pixel(x, y));
      if (toward >= JUMP_COST || own + toward >= least) continue;
      least = own + toward;
      best = pack_pixel(x, y);
    }
  }
  return best;
}

/* Follows the source's surface over the table, texel by texel; how many it took. */
static int grow_patch(Resolve *r, int texel) {
  memset(r->proposal, 0xff, sty_count_texels(&r->lut->spec) * sizeof *r->proposal);
  int count = 0;
  r->queue[count++] = texel;
  r->proposal[texel] = r->current[texel];
  for (int q = 0; q < count; q++)
    for (int s = 0; s < 4; s++) {
      const int other = get_neighbour(r, r->queue[q], s);
      if (other < 0 || r->proposal[other] != nothing) continue;
      r->proposal[other] = continue_patch(r, other, r->proposal[r->queue[q]]);
      if (r->proposal[other] != nothing) r->queue[count++] = other;
    }
  return count;
}

/* ---- fusing ------------------------------------------------------------------- */

/* Costs of one texel for itself and toward neighbours that don't change. */
static void add_own_costs(Resolve *r, int texel) {
  const uint32_t current = r->current[texel], proposed = r->proposal[texel];
  int32_t keep = get_own_cost(r, texel, current), take = get_own_cost(r, texel, proposed);
  for (int s = 0; s < 4; s++) {
    const int other = get_neighbour(r, texel, s);
    if (other < 0 || r->node[other] >= 0) continue;
    keep += get_pair_cost(r, current, r->current[other]);
    take += get_pair_cost(r, proposed, r->current[other]);
  }
  sty_add_cut_costs(&r->cut, r->node[texel], keep, take);
}

/* Costs of two neighbours that may both change; a cut can't say them all where
 * both mixed choices are cheap, and then takes them for dearer than they are. */
static void add_pair_costs(Resolve *r, int a, int b) {
  const uint32_t a0 = r->current[a], b0 = r->current[b], a1 = r->proposal[a], b1 = r->proposal[b];
  const int32_t neither = get_pair_cost(r, a0, b0), both = get_pair_cost(r, a1, b1);
  const int32_t only_a = get_pair_cost(r, a1, b0);
  int32_t only_b = get_pair_cost(r, a0, b1);
  if (neither + both > only_a + only_b) only_b = neither + both - only_a;
  /* = neither + (only_a - neither) [a] + (both - only_a) [b] + (only_a + only_b - neither - both) [b and not a] */
  sty_add_cut_costs(&r->cut, r->node[a], neither, only_a);
  sty_add_cut_costs(&r->cut, r->node[b], 0, both - only_a);
  const int32_t mixed = only_a + only_b - neither - both;
  if (mixed > 0) sty_add_cut_edge(&r->cut, r->node[a], r->node[b], mixed);
}

static int64_t get_total(const Resolve *r, const int *texels, int count) {
  int64_t total = 0;
  for (int n = 0; n < count; n++) {
    const int texel = texels[n];
    total += get_own_cost(r, texel, r->current[texel]);
    for (int s = 0; s < 4; s++) {
      const int other = get_neighbour(r, texel, s);
      /* Pairs of two listed texels once, others from this side only. */
      if (other >= 0 && (r->node[other] < 0 || s < 2)) total += get_pair_cost(r, r->current[texel], r->current[other]);
    }
  }
  return total;
}

/* Takes over what pays; how much less the sum is then. */
static int64_t fuse_patch(Resolve *r, int count) {
  int changes = 0;
  for (int q = 0; q < count; q++) {
    const int texel = r->queue[q];
    if (r->proposal[texel] == r->current[texel]) continue;
    r->queue[changes] = texel;
    r->node[texel] = changes++;
  }
  sty_reset_cut(&r->cut, changes);
  for (int n = 0; n < changes; n++) {
    add_own_costs(r, r->queue[n]);
    for (int s = 0; s < 2; s++) {
      const int other = get_neighbour(r, r->queue[n], s);
      if (other >= 0 && r->node[other] >= 0) add_pair_costs(r, r->queue[n], other);
    }
  }
  const int64_t before = get_total(r, r->queue, changes);
  if (changes) sty_solve_cut(&r->cut);
  for (int n = 0; n < changes; n++)
    if (sty_is_on_sink_side(&r->cut, n)) {
      r->current[r->queue[n]] = r->proposal[r->queue[n]];
    }
  const int64_t after = get_total(r, r->queue, changes);
  for (int n = 0; n < changes; n++) r->node[r->queue[n]] = -1;
  return before - after;
}

/* The whole sum. */
static int64_t count_cost(Resolve *r) {
  int count = 0;
  for (int t = 0; t < (int)sty_count_texels(&r->lut->spec); t++)
    if (r->live[t]) r->queue[count++] = t;
  int64_t total = 0;
  for (int n = 0; n < count; n++) {
    total += get_own_cost(r, r->queue[n], r->current[r->queue[n]]);
    for (int s = 0; s < 2; s++) {
      const int other = get_neighbour(r, r->queue[n], s);
      if (other >= 0) total += get_pair_cost(r, r->current[r->queue[n]], r->current[other]);
    }
  }
  return total;
}

/* ---- proposals ---------------------------------------------------------------- */

/* Some texel next to a jump, or -1: there is none. */
static int choose_seed(Resolve *r, uint64_t *state) {
  const int texels = (int)sty_count_texels(&r->lut->spec);
  int count = 0;
  for (int t = 0; t < texels; t++) {
    if (!r->live[t]) continue;
    for (int s = 0; s < 4; s++) {
      const int other = get_neighbour(r, t, s);
      if (other < 0 || !is_jump(r, r->current[t], r->current[other])) continue;
      r->queue[count++] = t;
      break;
    }
  }
  return count ? r->queue[sty_draw_bits(state) % (uint64_t)count] : -1;
}

/* Puts the choices into the table; pixels that stayed keep their errors as they are. */
static void write_choices(const Resolve *r) {
  for (size_t t = 0; t < sty_count_texels(&r->lut->spec); t++) {
    const uint32_t chosen = r->current[t];
    const uint32_t pixel = (uint32_t)get_y(chosen) * (uint32_t)r->lut->source_width + (uint32_t)get_x(chosen);
    if (r->lut->pixels[t] == pixel) continue;
    r->lut->pixels[t] = pixel;
    r->lut->errors[t] = sqrtf(measure_pixel(r, (int)t, chosen));
  }
}

StyStatus sty_resolve_coherent(StyLut *lut, const StySites *sites, double slack, const StyRun *run, StyError *error) {
  Resolve r;
  const StyStatus status = open_resolve(lut, sites, slack, &r, error);
  if (status) return status;
  uint64_t state = 1;
  int64_t gain = 0; /* of the last round */
  for (int proposal = 0; proposal < MOST_PROPOSALS; proposal++) {
    const int seed = choose_seed(&r, &state);
    if (seed < 0) break;
    gain += fuse_patch(&r, grow_patch(&r, seed));
    if (run && run->progress) run->progress(run->context, (proposal + 1.0) / MOST_PROPOSALS);
    if ((proposal + 1) % ROUND) continue;
    if (gain * LEAST_GAIN < count_cost(&r)) break;
    gain = 0;
  }
  write_choices(&r);
  close_resolve(&r);
  return STY_OK;
}
