#include "stylut/pack.h"

/* splitmix64 (Steele, Lea, Flood 2014): the same table on every machine. */
static uint64_t get_next(uint64_t *state) {
  uint64_t z = (*state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

void sty_make_jitter(uint64_t seed, uint8_t *out) {
  for (int i = 0; i < 2 * STY_JITTER_SIZE * STY_JITTER_SIZE; i++)
    out[i] = (uint8_t)((get_next(&seed) >> 32) * 255 >> 32);
}
