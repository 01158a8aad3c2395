/* The coherent choice.
 *
 * Where a guide shows the same value in many places, the exact nearest neighbour
 * scatters: neighbouring texels land on source pixels far apart, and a style
 * drawn through such a table pops when a surface turns. Within the slack there
 * is usually a pixel near the neighbours' pixels. The coherent choice minimizes
 *   sum over neighbouring texels: much for a jump, a little for a long way
 *   + a little per texel for what its pixel is farther than the nearest
 *   + something per texel for how small a piece its pixel gives to frames; where
 *     there are none, the guide itself stands in for them, at a lower price,
 * by fusion moves (Lempitsky, Rother, Roth, Blake, "Fusion Moves for Markov
 * Random Field Optimization", 2010): a proposal is a smooth patch grown over the
 * table from one texel and its pixel, as far as the slack lets the source's
 * surface be followed; a minimum cut takes over of it what makes the sum less. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "lut/choice.h"
#include "lut/cut.h"

/* What the sum counts, in integers, so that it is the same everywhere: a jump; how
 * much more a way almost as far costs than one of FREE_WAY / 8 jumps, up to which
 * ways cost nothing (on a sphere, its own guide, they are 2 / 8), and a diagonal one
 * may cost more than a jump; a texel at the full
 * slack; a texel whose pixel makes no piece at all in frames, or in the guide itself.
 * If the shortest ways were the cheapest, small bumps would win, where all normals
 * are close together, and so pieces would become small. */
enum { JUMP_COST = 1000, STEP_COST = 1600, FREE_WAY = 3, SLACK_COST = 60 };
enum { FRAMES_COST = 5000, GUIDE_COST = 200 };

/* Proposals: so many at most; and no more once a round of them took off less than
 * the 1/LEAST_GAIN-th part of the sum. A round is over once its patches together
 * would cover the table ROUND times: many a seed's patch is a few texels, and a
 * handful of such says nothing about what there is to gain. Three times as many
 * made the sum a tenth less and tables no calmer. */
enum { MOST_PROPOSALS = 64, ROUND = 2, LEAST_GAIN = 12 };

enum { MOST_REACH = 16 };

typedef struct Fusion {
  StyChoice *choice;
  int64_t farthest;      /* squared pixels: beyond it is a jump */
  int32_t piece_cost;    /* FRAMES_COST or GUIDE_COST */
  int reach;             /* pixels: how far from a neighbour's pixel a patch looks for its next */
  int32_t *ways;         /* what a way costs, by its length in pixels along x plus along y, up to 2 * jump */
  uint32_t *proposal;    /* per texel: a packed source pixel, or none */
  int32_t *own;          /* per texel: what its current pixel costs by itself */
  int32_t *proposed_own; /* per node: what the proposed one would */
  int *queue;            /* texels in the order a patch took them */
  int *node;             /* per texel: its node in the cut, or -1 */
  StyCut cut;
} Fusion;

/* ---- costs ----------------------------------------------------------------------- */

static bool is_jump(const Fusion *f, uint32_t p, uint32_t q) {
  const int64_t dx = sty_get_x(p) - sty_get_x(q), dy = sty_get_y(p) - sty_get_y(q);
  return dx * dx + dy * dy > f->farthest;
}

/* The neighbour of a texel in direction s that takes part, or -1. */
static int get_neighbour(const Fusion *f, int texel, int s) {
  const StyLutSpec *spec = &f->choice->lut->spec;
  const int x = texel % spec->width + sty_steps[s][0], y = texel / spec->width + sty_steps[s][1];
  if (x < 0 || y < 0 || x >= spec->width || y >= spec->height) return -1;
  return f->choice->live[y * spec->width + x] ? y * spec->width + x : -1;
}

/* For two neighbouring texels' pixels: a jump, or the way from one to the other. */
static int32_t get_pair_cost(const Fusion *f, uint32_t p, uint32_t q) {
  if (is_jump(f, p, q)) return JUMP_COST;
  return f->ways[abs(sty_get_x(p) - sty_get_x(q)) + abs(sty_get_y(p) - sty_get_y(q))];
}

/* What pixels farther than the nearest cost a texel: so much per squared distance above the least. */
typedef struct Excess {
  float least, rate;
} Excess;

static Excess get_excess(const Fusion *f, int texel) {
  const float least = f->choice->lut->errors[texel] * f->choice->lut->errors[texel];
  const float room = f->choice->limits[texel] - least;
  /* Where the slack is so little that rounding hides it, all that it allows is equally good. */
  return (Excess){least, room > 0 ? SLACK_COST / room : 0};
}

static int32_t get_excess_cost(const Excess *excess, float squared) {
  const float cost = (squared - excess->least) * excess->rate;
  return cost > 0 ? cost < SLACK_COST ? (int32_t)(cost + 0.5f) : SLACK_COST : 0;
}

/* For the piece around a pixel that is less than it could be. */
static int32_t get_piece_cost(const Fusion *f, int texel, uint32_t pixel) {
  const StyChoice *choice = f->choice;
  if (!sty_has_askers(choice->serve, (size_t)texel)) return 0;
  const bool known = choice->favourites && choice->favourites[texel] == pixel;
  const float piece = known ? choice->services[texel]
                            : sty_measure_service(choice->serve, (size_t)texel, sty_get_x(pixel), sty_get_y(pixel));
  const float share = 1 - piece / STY_LARGEST_PIECE;
  return share > 0 ? (int32_t)((float)f->piece_cost * share + 0.5f) : 0;
}

static int32_t get_own_cost(const Fusion *f, int texel, uint32_t pixel) {
  const Excess excess = get_excess(f, texel);
  return get_excess_cost(&excess, sty_measure_option(f->choice, texel, pixel)) + get_piece_cost(f, texel, pixel);
}

/* ---- growing a patch ---------------------------------------------------------- */

/* Source pixels that a texel's neighbours in the patch have. */
typedef struct Around {
  uint32_t pixels[4];
  int count;
} Around;

static Around look_around(const Fusion *f, int texel) {
  Around around = {.count = 0};
  for (int s = 0; s < 4; s++) {
    const int other = get_neighbour(f, texel, s);
    if (other >= 0 && f->proposal[other] != STY_NO_PIXEL) around.pixels[around.count++] = f->proposal[other];
  }
  return around;
}

/* What a pixel costs toward them, or `most` or more. */
static int32_t get_around_cost(const Fusion *f, const Around *around, uint32_t pixel, int32_t most) {
  int32_t sum = 0;
  for (int n = 0; n < around->count && sum < most; n++) sum += get_pair_cost(f, around->pixels[n], pixel);
  return sum;
}

/* Squared distances of a row's pixels from a texel's place; whether any is within
 * the limit. Without branches, so that it becomes vectors. */
static bool measure_row(const StyChoice *choice, int texel, size_t begin, int count, float *out) {
  const float *place = choice->places + (size_t)choice->dims * (size_t)texel, limit = choice->limits[texel];
  const float *x = choice->values[0] + begin, *y = choice->values[1] + begin;
  for (int i = 0; i < count; i++) {
    const float dx = place[0] - x[i], dy = place[1] - y[i];
    out[i] = dx * dx + dy * dy;
  }
  for (int i = 0; choice->dims == 3 && i < count; i++) {
    const float dz = place[2] - choice->values[2][begin + (size_t)i];
    out[i] = out[i] + dz * dz;
  }
  int any = 0;
  for (int i = 0; i < count; i++) any |= out[i] <= limit;
  return any;
}

/* The cheapest pixel so far of those that a texel may go on with. */
typedef struct Best {
  uint32_t pixel;
  int32_t cost;
} Best;

static void try_row(const Fusion *f, int texel, const Around *around, int left, int right, int y, Best *best) {
  const StyChoice *choice = f->choice;
  const Excess excess = get_excess(f, texel);
  float distances[2 * MOST_REACH + 1];
  if (!measure_row(choice, texel, (size_t)y * (size_t)choice->lut->source_width + (size_t)left, right - left,
                   distances))
    return;
  for (int x = left; x < right; x++) {
    if (!(distances[x - left] <= choice->limits[texel])) continue;
    const int32_t own = get_excess_cost(&excess, distances[x - left]);
    const int32_t most = best->cost - own < JUMP_COST ? best->cost - own : JUMP_COST;
    if (most <= 0) continue;
    const int32_t toward = get_around_cost(f, around, sty_pack_pixel(x, y), most);
    if (toward < most) *best = (Best){sty_pack_pixel(x, y), own + toward};
  }
}

/* The cheapest allowed pixel around `from` that is no jump from any neighbour's, or none. */
static uint32_t continue_patch(const Fusion *f, int texel, uint32_t from) {
  const int width = f->choice->lut->source_width, height = f->choice->lut->source_height;
  const int left = sty_get_x(from) > f->reach ? sty_get_x(from) - f->reach : 0;
  const int top = sty_get_y(from) > f->reach ? sty_get_y(from) - f->reach : 0;
  const int right = sty_get_x(from) + f->reach < width ? sty_get_x(from) + f->reach + 1 : width;
  const int bottom = sty_get_y(from) + f->reach < height ? sty_get_y(from) + f->reach + 1 : height;
  const Around around = look_around(f, texel);
  Best best = {STY_NO_PIXEL, INT32_MAX};
  for (int y = top; y < bottom; y++) try_row(f, texel, &around, left, right, y, &best);
  return best.pixel;
}

/* Follows the source's surface over the table, texel by texel; how many it took. */
static int grow_patch(Fusion *f, int texel) {
  memset(f->proposal, 0xff, sty_count_texels(&f->choice->lut->spec) * sizeof *f->proposal);
  int count = 0;
  f->queue[count++] = texel;
  f->proposal[texel] = f->choice->current[texel];
  for (int q = 0; q < count; q++)
    for (int s = 0; s < 4; s++) {
      const int other = get_neighbour(f, f->queue[q], s);
      if (other < 0 || f->proposal[other] != STY_NO_PIXEL) continue;
      f->proposal[other] = continue_patch(f, other, f->proposal[f->queue[q]]);
      if (f->proposal[other] != STY_NO_PIXEL) f->queue[count++] = other;
    }
  return count;
}

/* ---- fusing ------------------------------------------------------------------- */

/* Costs of one texel for itself and toward neighbours that don't change. */
static void add_own_costs(Fusion *f, int texel, int32_t proposed_own) {
  const uint32_t current = f->choice->current[texel], proposed = f->proposal[texel];
  int32_t keep = f->own[texel], take = proposed_own;
  for (int s = 0; s < 4; s++) {
    const int other = get_neighbour(f, texel, s);
    if (other < 0 || f->node[other] >= 0) continue;
    keep += get_pair_cost(f, current, f->choice->current[other]);
    take += get_pair_cost(f, proposed, f->choice->current[other]);
  }
  sty_add_cut_costs(&f->cut, f->node[texel], keep, take);
}

/* Costs of two neighbours that may both change; a cut can't say them all where
 * both mixed choices are cheap, and then takes them for dearer than they are. */
static void add_pair_costs(Fusion *f, int a, int b) {
  const uint32_t a0 = f->choice->current[a], b0 = f->choice->current[b], a1 = f->proposal[a], b1 = f->proposal[b];
  const int32_t neither = get_pair_cost(f, a0, b0), both = get_pair_cost(f, a1, b1);
  const int32_t only_a = get_pair_cost(f, a1, b0);
  int32_t only_b = get_pair_cost(f, a0, b1);
  if (neither + both > only_a + only_b) only_b = neither + both - only_a;
  /* = neither + (only_a - neither) [a] + (both - only_a) [b] + (only_a + only_b - neither - both) [b and not a] */
  sty_add_cut_costs(&f->cut, f->node[a], neither, only_a);
  sty_add_cut_costs(&f->cut, f->node[b], 0, both - only_a);
  const int32_t mixed = only_a + only_b - neither - both;
  if (mixed > 0) sty_add_cut_edge(&f->cut, f->node[a], f->node[b], mixed);
}

/* Gives a node to each queued texel whose proposal is another pixel and moves
 * them to the front of the queue; how many. */
static int number_changes(Fusion *f, int count) {
  int changes = 0;
  for (int q = 0; q < count; q++) {
    const int texel = f->queue[q];
    if (f->proposal[texel] == f->choice->current[texel]) continue;
    f->queue[changes] = texel;
    f->node[texel] = changes++;
  }
  return changes;
}

/* Jumps between feasible texels at the cut's nodes; those between two nodes count twice. */
static long count_jumps(const Fusion *f, int changes) {
  const StyChoice *choice = f->choice;
  long jumps = 0;
  for (int n = 0; n < changes; n++) {
    const int texel = f->queue[n];
    for (int s = 0; s < 4 && choice->live[texel] == STY_FEASIBLE; s++) {
      const int other = get_neighbour(f, texel, s);
      if (other >= 0 && choice->live[other] == STY_FEASIBLE &&
          is_jump(f, choice->current[texel], choice->current[other]))
        jumps += f->node[other] < 0 ? 2 : 1;
    }
  }
  return jumps;
}

/* Exchanges the pixels of the nodes that the cut wants to change, and their costs, with those proposed. */
static void exchange(Fusion *f, int changes) {
  for (int n = 0; n < changes; n++) {
    if (!sty_is_on_sink_side(&f->cut, n)) continue;
    const int texel = f->queue[n];
    const uint32_t pixel = f->choice->current[texel];
    const int32_t own = f->own[texel];
    f->choice->current[texel] = f->proposal[texel];
    f->proposal[texel] = pixel;
    f->own[texel] = f->proposed_own[n];
    f->proposed_own[n] = own;
  }
}

/* Takes over, of the proposal for the `count` queued texels, what pays; but where
 * no frames are to be served, shorter ways aren't paid with more jumps. */
static void fuse_proposal(Fusion *f, int count) {
  const int changes = number_changes(f, count);
  if (!changes) return;
  sty_reset_cut(&f->cut, changes);
  for (int n = 0; n < changes; n++) {
    const int texel = f->queue[n];
    f->proposed_own[n] = get_own_cost(f, texel, f->proposal[texel]);
    add_own_costs(f, texel, f->proposed_own[n]);
    for (int s = 0; s < 2; s++) {
      const int other = get_neighbour(f, texel, s);
      if (other >= 0 && f->node[other] >= 0) add_pair_costs(f, texel, other);
    }
  }
  sty_solve_cut(&f->cut);
  const long before = count_jumps(f, changes);
  exchange(f, changes);
  if (!f->choice->favourites && count_jumps(f, changes) > before) exchange(f, changes);
  for (int n = 0; n < changes; n++) f->node[f->queue[n]] = -1;
}

/* The whole sum. */
static int64_t count_cost(const Fusion *f) {
  int64_t total = 0;
  for (int t = 0; t < (int)sty_count_texels(&f->choice->lut->spec); t++) {
    if (!f->choice->live[t]) continue;
    total += f->own[t];
    for (int s = 0; s < 2; s++) {
      const int other = get_neighbour(f, t, s);
      if (other >= 0) total += get_pair_cost(f, f->choice->current[t], f->choice->current[other]);
    }
  }
  return total;
}

static int count_live(const Fusion *f) {
  int count = 0;
  for (size_t t = 0; t < sty_count_texels(&f->choice->lut->spec); t++) count += f->choice->live[t] != STY_DEAD;
  return count;
}

/* ---- proposals ---------------------------------------------------------------- */

/* Some texel next to a jump, or -1: there is none. */
static int choose_seed(Fusion *f, uint64_t *state) {
  const int texels = (int)sty_count_texels(&f->choice->lut->spec);
  int count = 0;
  for (int t = 0; t < texels; t++) {
    if (!f->choice->live[t]) continue;
    for (int s = 0; s < 4; s++) {
      const int other = get_neighbour(f, t, s);
      if (other < 0 || !is_jump(f, f->choice->current[t], f->choice->current[other])) continue;
      f->queue[count++] = t;
      break;
    }
  }
  return count ? f->queue[sty_draw_bits(state) % (uint64_t)count] : -1;
}

/* What serves frames best, everywhere at once; how many texels it is for. */
static int propose_favourites(Fusion *f) {
  int count = 0;
  for (int t = 0; t < (int)sty_count_texels(&f->choice->lut->spec); t++)
    if (f->choice->live[t]) {
      f->proposal[t] = f->choice->favourites[t];
      f->queue[count++] = t;
    }
  return count;
}

/* ---- the whole ---------------------------------------------------------------- */

static void close_fusion(Fusion *f) {
  free(f->ways);
  free(f->proposal);
  free(f->own);
  free(f->proposed_own);
  free(f->queue);
  free(f->node);
  sty_close_cut(&f->cut);
}

static StyStatus open_fusion(StyChoice *choice, Fusion *f, StyError *error) {
  const StyLut *lut = choice->lut;
  const size_t texels = sty_count_texels(&lut->spec);
  const double jump = sty_get_jump(&lut->spec, lut->source_width, lut->source_height);
  const size_t longest = (size_t)(2 * jump);
  *f = (Fusion){.choice = choice,
                .farthest = (int64_t)(jump * jump),
                .piece_cost = choice->favourites ? FRAMES_COST : GUIDE_COST};
  f->reach = jump < 2 ? 1 : jump > 2 * MOST_REACH ? MOST_REACH : (int)(jump / 2);
  f->ways = malloc((longest + 1) * sizeof *f->ways);
  f->proposal = malloc(texels * sizeof *f->proposal);
  f->own = calloc(texels, sizeof *f->own);
  f->proposed_own = malloc(texels * sizeof *f->proposed_own);
  f->queue = malloc(texels * sizeof *f->queue);
  f->node = malloc(texels * sizeof *f->node);
  if (!f->ways || !f->proposal || !f->own || !f->proposed_own || !f->queue || !f->node ||
      !sty_open_cut((int)texels, 2 * (int)texels, &f->cut)) {
    close_fusion(f);
    return sty_fail_memory(error, "coherent LUT", (double)texels * 115);
  }
  for (size_t length = 0; length <= longest; length++) {
    const double way = (double)length / jump - FREE_WAY / 8.0;
    f->ways[length] = way > 0 ? (int32_t)(STEP_COST * way) : 0;
  }
  for (size_t t = 0; t < texels; t++) {
    f->node[t] = -1;
    if (choice->live[t]) f->own[t] = get_own_cost(f, (int)t, choice->current[t]);
  }
  return STY_OK;
}

StyStatus sty_make_coherent(StyChoice *choice, const StyRun *run, StyError *error) {
  Fusion f;
  const StyStatus status = open_fusion(choice, &f, error);
  if (status) return status;
  if (choice->favourites) fuse_proposal(&f, propose_favourites(&f));
  uint64_t state = 1;
  int64_t cost = count_cost(&f), grown = 0;
  const int64_t round = ROUND * (int64_t)count_live(&f);
  for (int proposal = 0; proposal < MOST_PROPOSALS; proposal++) {
    const int seed = choose_seed(&f, &state);
    if (seed < 0) break;
    const int count = grow_patch(&f, seed);
    fuse_proposal(&f, count);
    if (run && run->progress) run->progress(run->context, (proposal + 1.0) / MOST_PROPOSALS);
    grown += count;
    if (grown < round) continue;
    grown = 0;
    const int64_t before = cost;
    cost = count_cost(&f);
    if ((before - cost) * LEAST_GAIN < cost) break;
  }
  close_fusion(&f);
  return STY_OK;
}
