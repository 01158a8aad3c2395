/* A bundle of one style whose exemplar is a sphere: what people pack. */
#ifndef STYLUT_TESTS_SPHERE_H
#define STYLUT_TESTS_SPHERE_H

#include "fixture.h"

/* A LUT whose texel for bytes (i, 255-j) holds the covered pixel at the least distance, lowest first among equals. */
static inline void search_by_force(Fixture *fixture, int side, const uint8_t *guide) {
  static int columns[128 * 128], rows[128 * 128];
  uint32_t pixels[128 * 128], count = 0;
  for (int i = 0; i < side * side; i++) {
    if (!guide[4 * i + 3]) continue;
    columns[count] = guide[4 * i];
    rows[count] = 255 - guide[4 * i + 1];
    pixels[count++] = (uint32_t)i;
  }
  for (int j = 0; j < 256; j++)
    for (int i = 0; i < 256; i++) {
      uint32_t least = UINT32_MAX; /* distance in the high bits, number in the low 14 */
      for (uint32_t k = 0; k < count; k++) {
        const int dx = columns[k] - i, dy = rows[k] - j;
        const uint32_t key = (uint32_t)(dx * dx + dy * dy) << 14 | k;
        least = key < least ? key : least;
      }
      const uint32_t best = pixels[least & 0x3FFF];
      const double u = (best % (uint32_t)side + 0.5) / side, v = (best / (uint32_t)side + 0.5) / side;
      put32(fixture->texels[STY_BUNDLE_LUTS] + 4 * (256 * j + i),
            (uint32_t)floor(u * 65535 + 0.5) | (uint32_t)floor(v * 65535 + 0.5) << 16);
    }
}

static inline void put_normal(uint8_t texel[4], double x, double y, double z) {
  const double n[3] = {x, y, z};
  for (int c = 0; c < 3; c++) texel[c] = (uint8_t)floor(n[c] * 127.5 + 128);
  texel[3] = 255;
}

/* Not opened; exemplars and jitter are noise. `side` is at most 128. */
static inline Fixture *make_sphere(uint64_t *random, int side, int exemplars) {
  Fixture *fixture = make_fixture(side, side, 256, 1, exemplars, 2);
  uint8_t *guide = fixture->texels[STY_BUNDLE_GUIDES];
  for (int i = 0; i < side * side; i++) {
    const double x = (i % side + 0.5) / side * 2 - 1, y = 1 - (i / side + 0.5) / side * 2, square = 1 - x * x - y * y;
    if (square >= 0) put_normal(guide + 4 * i, x, y, sqrt(square));
  }
  fill_random(random, fixture->texels[STY_BUNDLE_EXEMPLARS], count_texel_bytes(fixture, STY_BUNDLE_EXEMPLARS));
  fill_random(random, fixture->texels[STY_BUNDLE_JITTER], count_texel_bytes(fixture, STY_BUNDLE_JITTER));
  search_by_force(fixture, side, guide);
  return fixture;
}

#endif
