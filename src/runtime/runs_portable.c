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

static void choose_seeds(const Candidates *candidates, int k0, int k1, NearSeed *out) {
  for (int k = k0; k < k1; k++) {
    int32_t least = candidates->base[0] + candidates->slope[0] * k;
    for (int i = 1; i < 9; i++) {
      const int32_t value = candidates->base[i] + candidates->slope[i] * k;
      least = value < least ? value : least;
    }
    out[k] = candidates->places[least & 15];
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
