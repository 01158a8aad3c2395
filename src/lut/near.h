/* All source pixels near a place, in the metric's space: what a choice among
 * nearly equal ones, and the measure of ambiguity, are made from. */
#ifndef STYLUT_SRC_LUT_NEAR_H
#define STYLUT_SRC_LUT_NEAR_H

#include "lut/engine.h"

/* Sites in square buckets of their x and y. */
typedef struct StyNear {
  const StySites *sites; /* borrowed */
  int dims;
  int columns, rows;
  double x0, y0, inverse;
  uint32_t *first; /* per bucket and one more: where its sites begin */
  uint32_t *order; /* sites, bucket by bucket, ascending within each */
} StyNear;

/* For queries of about `radius`. The caller closes it. */
StyStatus sty_open_near(const StySites *sites, int dims, double radius, StyNear *out, StyError *error);
void sty_close_near(StyNear *near);

/* A growing list of site numbers. */
typedef struct StyNearList {
  uint32_t *sites;
  size_t count, capacity;
} StyNearList;

/* Replaces the list by the sites within `radius` of `at` (its dims coordinates),
 * in ascending order. False: memory is short. */
bool sty_list_near(const StyNear *near, const float *at, double radius, StyNearList *list);

#endif
