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
  uint32_t *order; /* sites, bucket by bucket, in each value by value, of each ascending */
  uint32_t *runs;  /* per value and one more: where its sites begin in `order` */
  uint32_t *first; /* per bucket and one more: where its values begin in `runs` */
} StyNear;

/* For queries of about `radius`. The caller closes it. */
StyStatus sty_open_near(const StySites *sites, int dims, double radius, StyNear *out, StyError *error);
void sty_close_near(StyNear *near);

/* A growing list of site numbers, of one StyNear. Where many texels have the same
 * ones around them, as on plateaus, it is made only once. */
typedef struct StyNearList {
  uint32_t *sites;
  size_t count, capacity;
  bool unchanged; /* since the query before */
  uint32_t *runs; /* what it is made from; `found` is room for the next */
  uint32_t *found;
  size_t run_count, run_capacity;
} StyNearList;

/* Replaces the list, which is zero at first, by the sites within `radius` of `at` (its
 * dims coordinates), value by value. False: memory is short. */
bool sty_list_near(const StyNear *near, const float *at, double radius, StyNearList *list);

/* Puts the list's sites in ascending order; those of a single value are. */
void sty_sort_near_list(StyNearList *list);
void sty_free_near_list(StyNearList *list);

#endif
