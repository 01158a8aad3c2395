/* Points that fill the unit square evenly, as many as one wants, in an order of their own for every key: the first two
 * dimensions of Sobol's sequence, a (0,2)-sequence, with Owen's scrambling by hash (Burley, "Practical Hash-based Owen
 * Scrambling", JCGT 9(4), 2020; the hash is Vegdahl's, as in pbrt-v4). Every 2^k points, from the first, have one in
 * each of the 2^k rectangles that any halving of the sides gives. Pairs of differing keys are as good as independent,
 * so that one key a pair of dimensions makes points of many dimensions. */
#ifndef STYLUT_SRC_BASE_SOBOL_H
#define STYLUT_SRC_BASE_SOBOL_H

#include "base/random.h"

static inline uint32_t sty_reverse_bits(uint32_t x) {
  x = (x >> 1 & 0x55555555) | (x & 0x55555555) << 1;
  x = (x >> 2 & 0x33333333) | (x & 0x33333333) << 2;
  x = (x >> 4 & 0x0f0f0f0f) | (x & 0x0f0f0f0f) << 4;
  x = (x >> 8 & 0x00ff00ff) | (x & 0x00ff00ff) << 8;
  return x >> 16 | x << 16;
}

/* A permutation in which each bit is flipped by what is below it alone. */
static inline uint32_t sty_scramble_bits(uint32_t x, uint32_t key) {
  x ^= x * 0x3d20adeau;
  x += key;
  x *= key >> 16 | 1;
  x ^= x * 0x05526c56u;
  return x ^ x * 0x53a22864u;
}

/* Pascal's triangle modulo 2 times the bits of x: the second dimension's matrix. */
static inline uint32_t sty_apply_pascal(uint32_t x) {
  x ^= x >> 1 & 0x55555555;
  x ^= x >> 2 & 0x33333333;
  x ^= x >> 4 & 0x0f0f0f0f;
  x ^= x >> 8 & 0x00ff00ff;
  return x ^ x >> 16;
}

/* Point `number` of this key's, each coordinate in [0, 1). */
static inline void sty_draw_pair(uint64_t key, uint32_t number, double out[2]) {
  const uint64_t order = sty_draw_bits(&key), flips = sty_draw_bits(&key);
  const uint32_t i = sty_reverse_bits(sty_scramble_bits(sty_reverse_bits(number), (uint32_t)order));
  out[0] = sty_reverse_bits(sty_scramble_bits(i, (uint32_t)flips)) * 0x1p-32;
  out[1] = sty_reverse_bits(sty_scramble_bits(sty_apply_pascal(i), (uint32_t)(flips >> 32))) * 0x1p-32;
}

#endif
