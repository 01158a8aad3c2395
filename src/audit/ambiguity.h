/* How well a guide decides between its pixels. */
#ifndef STYLUT_SRC_AUDIT_AMBIGUITY_H
#define STYLUT_SRC_AUDIT_AMBIGUITY_H

#include "lut/near.h"
#include "stylut/audit.h"

/* The source pixels that one place might as well be answered with. */
typedef struct StyAmbiguity {
  size_t pixels, pieces; /* pieces: connected ones (8-neighbours) */
  double spread;         /* RMS distance from their centroid, pixels */
} StyAmbiguity;

/* Of the sites within `precision` of `least`, the least distance from `at` (in the metric's space, guide units). */
StyStatus sty_measure_choice(const StyNear *near, const float *at, double least, double precision, StyAmbiguity *out,
                             StyError *error);

/* Per texel of the exact table: how many connected pieces (8-neighbours) the
 * source pixels within `precision` of the least distance form, and how far they
 * spread (RMS distance from their centroid, pixels). */
StyStatus sty_measure_ambiguity(const StyLut *exact, const StySites *sites, double precision, const StyRun *run,
                                float *pieces, float *spread, StyError *error);

/* Per texel: the share of 8 seeded trials in which the nearest source pixel moves
 * by more than `jump` when every value of the guide is disturbed by up to half
 * of `precision` either way. */
StyStatus sty_measure_stability(const StyLut *exact, const StySites *sites, double precision, double jump,
                                uint64_t seed, const StyRun *run, float *unstable, StyError *error);

#endif
