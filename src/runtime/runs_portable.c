#include "voters.h"

static int count_alike(const uint8_t *guide, int most) {
  const bool is_covered = guide[3] > 0;
  int count = 1;
  while (count < most && (guide[4 * (size_t)count + 3] > 0) == is_covered) count++;
  return count;
}

static int measure_segment(const NearSeed *seeds, int count) {
  int length = 1;
  while (length < count && seeds[length].x == seeds->x && seeds[length].y == seeds->y) length++;
  return length;
}

static void try_pixels(const Run *run, const Segment *segment, Waiting *waiting) {
  try_pixels_singly(run, segment, waiting);
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

#include "runs_plain.h"

static void compare_voters(const Voter *a, const Voter *b, uint64_t bits[COLUMN_WORDS]) {
  for (int word = 0; word < COLUMN_WORDS; word++) {
    bits[word] = 0;
    for (int k = 0; k < WORD; k++) bits[word] |= (uint64_t)is_same_vote(&a[word * WORD + k], &b[word * WORD + k]) << k;
  }
}

#define UNIT(name) sty_##name##_portable
#include "blend_body.h"
#include "runs_body.h"
