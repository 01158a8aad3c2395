#ifndef STYLUT_GUIDE_CONTOUR_H
#define STYLUT_GUIDE_CONTOUR_H

#include "guide/channels.h"
#include "stylut/parallel.h"

/* The channels that outlines are made from, beside coverage. */
enum { STY_CONTOUR_SOURCES = STY_GUIDE_NORMAL | STY_GUIDE_DEPTH };

/* How wide a pixel is at a depth z: constant + slope * z, scene units. */
typedef struct StyFootprint {
  double constant, slope;
} StyFootprint;

/* Rows of a picture that have outlines, and what these are made from. */
typedef struct StyContours {
  const StyImage *sources; /* with coverage, normal and depth */
  StyImage *drawn;         /* as wide; its contour channel is filled */
  int first;               /* row of the sources where the first of `drawn` is */
  bool is_top, is_bottom;  /* those drawn begin, or end, with the picture's own border; else the sources reach beyond */
  const StyContourWeights *weights;
  StyFootprint footprint;
} StyContours;

/* See StyContourWeights. Neighbours beyond the picture are taken to be like the pixel itself. */
void sty_draw_contours(const StyContours *contours, int threads);

#endif
