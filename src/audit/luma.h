/* Luma of sRGB-encoded colours (Rec. 601), and planes seen through windows. */
#ifndef STYLUT_SRC_AUDIT_LUMA_H
#define STYLUT_SRC_AUDIT_LUMA_H

#include "stylut/parallel.h"

/* Pixel i of 3 planes of `pixels` values. */
static inline float sty_get_luma(const float *rgb, size_t pixels, size_t i) {
  return 0.299f * rgb[i] + 0.587f * rgb[pixels + i] + 0.114f * rgb[2 * pixels + i];
}

/* A filter of 2*radius+1 taps each way, the product of two lists. */
typedef struct Filter {
  int radius;
  const double *across, *down;
} Filter;

/* out = the plane under the filter; beyond its edges the plane goes on as it ends. Errors: memory. */
StyStatus sty_filter_plane(const float *in, int width, int height, const Filter *filter, const StyRun *run, float *out,
                           StyError *error);

#endif
