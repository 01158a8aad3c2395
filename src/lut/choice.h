/* What the texels of a table choose from: the source pixels within the slack of
 * the nearest, and how well each would serve frames. */
#ifndef STYLUT_SRC_LUT_CHOICE_H
#define STYLUT_SRC_LUT_CHOICE_H

#include "lut/engine.h"
#include "lut/serve.h"
#include "stylut/match.h"

/* Source pixels are packed: y above, x below, 16 bits each; STY_NO_PIXEL is none. */
static inline uint32_t sty_pack_pixel(int x, int y) { return (uint32_t)y << 16 | (uint32_t)x; }
static inline int sty_get_x(uint32_t packed) { return (int)(packed & 0xffff); }
static inline int sty_get_y(uint32_t packed) { return (int)(packed >> 16); }

/* The four neighbours of a texel; the first two name each pair once. */
static const int sty_steps[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};

/* Texels that take part are feasible or at the rim, where a feasible value may still fall into them. */
enum { STY_DEAD, STY_RIM, STY_FEASIBLE };

typedef struct StyChoice {
  StyLut *lut;
  int dims;
  float *values[3];      /* planes of the source pixels, in the metric's space; NAN where uncovered */
  float *places;         /* dims per texel */
  float *limits;         /* per texel: the largest squared distance allowed */
  uint8_t *live;         /* per texel: STY_DEAD and so on */
  uint32_t *current;     /* per texel: its source pixel, packed */
  const StyServe *serve; /* frames or, without any, the guide itself */
  /* With frames, else NULL: */
  uint32_t *favourites; /* per texel: the source pixel that serves them best */
  float *services;      /* per texel: how well */
} StyChoice;

/* Squared distance of a pixel from a texel's place, by the metric. */
static inline float sty_measure_option(const StyChoice *choice, int texel, uint32_t pixel) {
  const size_t at = (size_t)sty_get_y(pixel) * (size_t)choice->lut->source_width + (size_t)sty_get_x(pixel);
  float value[3] = {0};
  for (int k = 0; k < choice->dims; k++) value[k] = choice->values[k][at];
  return sty_square_distance(choice->dims, choice->places + (size_t)choice->dims * (size_t)texel, value);
}

/* Makes choices coherent (see coherent.c). */
StyStatus sty_make_coherent(StyChoice *choice, const StyRun *run, StyError *error);

#endif
