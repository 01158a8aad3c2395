#include "voters.h"

static int count_alike(const uint8_t *guide, int most) {
  const bool is_covered = guide[3] > 0;
  int count = 1;
  while (count < most && (guide[4 * (size_t)count + 3] > 0) == is_covered) count++;
  return count;
}

/* Less k*k, the squared distance from pixel k is linear in k. Counted in sixteenths it leaves room for the seed's
 * number in the order of the reference's loops, so that the least value names the seed that they would find. */
static void choose_in_cell(const SeedGrid *grid, int y, int cell, int k0, int k1, NearSeed *out) {
  NearSeed seeds[9];
  int32_t base[9], slope[9];
  for (int i = 0; i < 9; i++) {
    seeds[i] = grid->rows[i % 3][cell + i / 3];
    seeds[i].y = (int16_t)(seeds[i].y - y);
    base[i] = 16 * (seeds[i].x * seeds[i].x + seeds[i].y * seeds[i].y) + i;
    slope[i] = -32 * seeds[i].x;
  }
  for (int k = k0; k < k1; k++) {
    int32_t least = base[0] + slope[0] * k;
    for (int i = 1; i < 9; i++) {
      const int32_t value = base[i] + slope[i] * k;
      least = value < least ? value : least;
    }
    out[k] = seeds[least & 15];
  }
}

static void choose_seeds(const SeedGrid *grid, int y, int k0, int k1, NearSeed *out) {
  while (k0 < k1) {
    const int cell = (k0 + grid->phase) >> grid->level, end = ((cell + 1) << grid->level) - grid->phase;
    const int next = end < k1 ? end : k1;
    choose_in_cell(grid, y, cell, k0, next, out);
    k0 = next;
  }
}

static void place_offsets(const StySeedOffset *offsets, int k0, int k1, NearSeed *out) {
  for (int k = k0; k < k1; k++) out[k] = (NearSeed){(int16_t)(k + offsets[k].x), offsets[k].y};
}

#define UNIT(name) sty_##name##_portable
#include "runs_seeds.h"

/* Neighbours mostly share a seed, and what it proposes. */
typedef struct Remembered {
  NearSeed seed;
  Proposal proposal;
} Remembered;

static void ask_seed(const Run *run, NearSeed seed, int level, Remembered *last) {
  const Point in_frame = {run->x + seed.x, run->y + seed.y};
  const Point in_grid = {in_frame.x - run->anchor.x, in_frame.y - run->anchor.y};
  last->seed = seed;
  last->proposal = propose(run->source, run->frame, in_frame, in_grid, level);
  /* The pixels of a run have one object, where that matters. */
  if (run->frame->anchors && last->proposal.object != get_object(run->frame, run->first))
    last->proposal.is_made = false;
}

/* Serves those of `count` pixels that take what their seeds propose; how many are left. */
static int try_level(const Run *run, int level, const SeedRow seeds, int16_t *places, int count) {
  const Source *source = run->source;
  Remembered last = {.seed = seeds[places[0]]};
  int left = 0;
  ask_seed(run, last.seed, level, &last);
  for (int i = 0; i < count; i++) {
    const int k = places[i];
    if (seeds[k].x != last.seed.x || seeds[k].y != last.seed.y) ask_seed(run, seeds[k], level, &last);
    const Proposal *proposal = &last.proposal;
    const Point candidate = {proposal->found.x + to_source(source, k - last.seed.x),
                             proposal->found.y + to_source(source, -last.seed.y)};
    if (proposal->is_made &&
        accepts(source, run->frame, run->first + (size_t)k, proposal->tilt, candidate, proposal->lighting))
      run->matches[k] = (StyMatch){.x = (uint16_t)candidate.x,
                                   .y = (uint16_t)candidate.y,
                                   .level = (uint8_t)level,
                                   .layer = (uint8_t)proposal->lighting,
                                   .style = source->number};
    else
      places[left++] = (int16_t)k;
  }
  return left;
}

static void match_run(const Run *run) {
  int16_t places[RUN_LENGTH];
  SeedRow seeds;
  int count = run->length;
  for (int k = 0; k < count; k++) places[k] = (int16_t)k;
  for (int level = run->source->style.top_level; level >= 0 && count > 0; level--) {
    find_seeds(run, level, places[0], places[count - 1] + 1, seeds);
    count = try_level(run, level, seeds, places, count);
  }
  for (int i = 0; i < count; i++)
    run->matches[places[i]] = fall_back(run->source, run->frame, run->first + (size_t)places[i]);
}

#include "runs_plain.h"

static void compare_voters(const Voter *a, const Voter *b, uint64_t bits[COLUMN_WORDS]) {
  for (int word = 0; word < COLUMN_WORDS; word++) {
    bits[word] = 0;
    for (int k = 0; k < WORD; k++) bits[word] |= (uint64_t)is_same_vote(&a[word * WORD + k], &b[word * WORD + k]) << k;
  }
}

#include "blend_body.h"
#include "runs_body.h"
