#ifndef STYLUT_GUIDE_CONTOUR_H
#define STYLUT_GUIDE_CONTOUR_H

#include "guide/channels.h"
#include "stylut/parallel.h"

/* The channels that outlines are made from. */
enum { STY_CONTOUR_SOURCES = STY_GUIDE_NORMAL | STY_GUIDE_DEPTH };

/* How wide a pixel is at a depth z: constant + slope * z, scene units. */
typedef struct StyFootprint {
  double constant, slope;
} StyFootprint;

/* Fills the contour channel of a guide that has normal and depth, see StyContourWeights. Neighbours beyond the image
 * are taken to be like the pixel itself. */
StyStatus sty_draw_contours(const StyGuide *guide, const StyContourWeights *weights, const StyFootprint *footprint,
                            const StyRun *run, StyError *error);

#endif
