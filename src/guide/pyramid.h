/* A picture at every scale, with the gradient of its luminance: what stylut/strokes.h is made of. */
#ifndef STYLUT_SRC_GUIDE_PYRAMID_H
#define STYLUT_SRC_GUIDE_PYRAMID_H

#include "stylut/strokes.h"

enum { PLANE_RED, PLANE_GREEN, PLANE_BLUE, PLANE_LUMA, PLANE_WEIGHT, PLANE_RIGHT, PLANE_UP, PLANE_COUNT };

typedef struct StyLevel {
  int width, height;
  /* Row-major, by PLANE_...; RIGHT and UP are the gradient of luma. WEIGHT is the sum of the coverage of the
   * picture's pixels that are in this one; where it is 0, all others are. */
  float *planes[PLANE_COUNT];
} StyLevel;

typedef struct StyPyramid {
  int count;
  StyLevel levels[STY_MAX_STROKE_LEVELS];
} StyPyramid;

static inline size_t sty_count_level_pixels(const StyLevel *level) {
  return (size_t)level->width * (size_t)level->height;
}

/* All levels; heeds `srgb` and `layer` of the options. Errors as sty_make_stroke_guide. */
StyStatus sty_build_pyramid(const char *name, const StyImage *picture, const StyStrokeOptions *options,
                            const StyRun *run, StyPyramid *out, StyError *error);
void sty_destroy_pyramid(StyPyramid *pyramid);

/* Length of the gradient. */
double sty_measure_detail(const StyLevel *level, size_t pixel);

/* STY_ERROR_LIBRARY: memory. */
StyStatus sty_measure_level(const StyLevel *level, double threshold, StyStrokeLevel *out, StyError *error);

#endif
