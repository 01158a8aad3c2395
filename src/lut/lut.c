#include "stylut/lut.h"

#include <math.h>
#include <stdlib.h>

const char *const sty_sampling_names[] = {"centre", "unorm8", NULL};

StyStatus sty_create_lut(int size, StySampling sampling, int source_width, int source_height, StyLut **out,
                         StyError *error) {
  const int smallest = sampling == STY_SAMPLE_UNORM8 ? 2 : 1;
  if (size < smallest || size > STY_MAX_LUT_SIZE)
    return sty_fail(error, STY_ERROR_USAGE, "LUT size: found %d, expected %d to %d", size, smallest, STY_MAX_LUT_SIZE);
  if (source_width < 1 || source_height < 1 || source_width > STY_MAX_SIDE || source_height > STY_MAX_SIDE)
    return sty_fail(error, STY_ERROR_INPUT, "LUT: found a source of %d x %d pixels, expected sides of 1 to %d",
                    source_width, source_height, STY_MAX_SIDE);
  const size_t texels = (size_t)size * (size_t)size;
  StyLut *lut = calloc(1, sizeof *lut);
  if (lut) {
    *lut = (StyLut){.size = size, .sampling = sampling, .source_width = source_width, .source_height = source_height};
    lut->pixels = calloc(texels, sizeof *lut->pixels);
    lut->errors = calloc(texels, sizeof *lut->errors);
  }
  if (!lut || !lut->pixels || !lut->errors) {
    sty_destroy_lut(&lut);
    return sty_fail_memory(error, "LUT", (double)texels * 8);
  }
  *out = lut;
  return STY_OK;
}

void sty_destroy_lut(StyLut **lut) {
  if (!lut || !*lut) return;
  free((*lut)->pixels);
  free((*lut)->errors);
  free(*lut);
  *lut = NULL;
}

void sty_get_texel_value(const StyLut *lut, int i, int j, float g[2]) {
  const int n = lut->size;
  if (lut->sampling == STY_SAMPLE_CENTRE) {
    g[0] = (float)(2 * i + 1 - n) / (float)n;
    g[1] = (float)(n - 2 * j - 1) / (float)n;
  } else {
    g[0] = (float)(2 * i - (n - 1)) / (float)(n - 1);
    g[1] = (float)((n - 1) - 2 * j) / (float)(n - 1);
  }
}

static int clamp_texel(float t, int size) { return t > 0 ? t < (float)size ? (int)t : size - 1 : 0; }

void sty_find_texel(const StyLut *lut, const float g[2], int t[2]) {
  const float h[2] = {g[0] * 0.5f + 0.5f, 0.5f - g[1] * 0.5f};
  for (int k = 0; k < 2; k++)
    t[k] = lut->sampling == STY_SAMPLE_CENTRE ? clamp_texel(floorf(h[k] * (float)lut->size), lut->size)
                                              : clamp_texel(roundf(h[k] * (float)(lut->size - 1)), lut->size);
}
