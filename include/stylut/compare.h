/* Two pictures, value by value: whether and where they differ.
 *
 * Channels are paired by name, whatever their order. A difference is |a - b|, in
 * double; of two pictures of 8 or 16 bits it is that of the stored integers over
 * 65535 (for 8 bits the same as over 255), so that one level is the same number
 * everywhere. NaN against NaN and an infinity against itself differ by 0; NaN
 * against a number, and an infinity against anything else, differ infinitely. */
#ifndef STYLUT_COMPARE_H
#define STYLUT_COMPARE_H

#include "stylut/image.h"
#include "stylut/parallel.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct StyCompareOptions {
  double fail;      /* a pixel fails when one of its channels differs by more; 0 and up */
  double hard_fail; /* the same, counted apart; INFINITY: none can */
} StyCompareOptions;

typedef struct StyComparison {
  size_t pixels, values;                   /* values: pixels times channels */
  size_t differing, failing, hard_failing; /* pixels */
  size_t infinite;                         /* values that differ infinitely */
  double mean, rms;                        /* over all other values, equal ones included; 0 where there are none */
  double finite_max;                       /* largest difference among these */
  /* The largest difference of all, first in row-major order and then by the
   * channels of `a`, and where it is. Without any difference: 0, and all zero. */
  double max;
  int channel, x, y;
  float found[2]; /* the two values there */
} StyComparison;

/* Compares two pictures; the result is the same for any number of threads.
 * `largest` gets each pixel's largest difference; it has room for all pixels, or
 * is NULL. The names are for messages. STY_FILES_DIFFER: the pictures have other
 * sizes or channel names, so that nothing was compared. STY_ERROR_LIBRARY:
 * memory. */
StyStatus sty_compare_images(const char *name_a, const StyImage *a, const char *name_b, const StyImage *b,
                             const StyCompareOptions *options, const StyRun *run, StyComparison *out, float *largest,
                             StyError *error);

/* Paints differences as an 8-bit RGB picture: black where the value is 0, white
 * where it is infinite, else the ramp viridis, ever lighter: violet just above
 * 0, teal at a quarter of `top`, yellow at `top` and above. It follows the square
 * root, since most differences are far below the largest. `values` aren't negative. */
StyStatus sty_paint_heat(const float *values, int width, int height, double top, StyImage **out, StyError *error);

#ifdef __cplusplus
}
#endif
#endif
