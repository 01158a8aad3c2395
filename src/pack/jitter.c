#include "base/random.h"
#include "stylut/pack.h"

void sty_make_jitter(uint64_t seed, uint8_t *out) {
  for (int i = 0; i < 2 * STY_JITTER_SIZE * STY_JITTER_SIZE; i++)
    out[i] = (uint8_t)((sty_draw_bits(&seed) >> 32) * 255 >> 32);
}
