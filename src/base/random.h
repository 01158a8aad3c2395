/* Seeded numbers, the same on every machine: splitmix64 (Steele, Lea, Flood, "Fast
 * Splittable Pseudorandom Number Generators", 2014). */
#ifndef STYLUT_SRC_BASE_RANDOM_H
#define STYLUT_SRC_BASE_RANDOM_H

#include <stdint.h>

/* Its finalizer: keys that are neighbours give numbers that aren't. */
static inline uint64_t sty_mix_bits(uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/* The next number; any state will do for a seed. */
static inline uint64_t sty_draw_bits(uint64_t *state) { return sty_mix_bits(*state += 0x9e3779b97f4a7c15u); }

#endif
