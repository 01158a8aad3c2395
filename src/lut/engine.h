/* The engines' build functions, for the table in engines.c. */
#ifndef STYLUT_SRC_LUT_ENGINE_H
#define STYLUT_SRC_LUT_ENGINE_H

#include "stylut/lut.h"

StyStatus sty_build_brute(const StySites *sites, StyLut *lut, const StyRun *run, StyError *error);
StyStatus sty_build_analytic(const StySites *sites, StyLut *lut, const StyRun *run, StyError *error);
StyStatus sty_build_flann_single(const StySites *sites, StyLut *lut, const StyRun *run, StyError *error);

/* The one distance that all exact engines agree on: squared, in float. */
static inline float sty_measure_site(const StySites *sites, size_t site, const float g[2]) {
  const float dx = g[0] - sites->values[2 * site], dy = g[1] - sites->values[2 * site + 1];
  return dx * dx + dy * dy;
}

/* The nearest site by looking at each; ties go to the lowest pixel. */
size_t sty_scan_sites(const StySites *sites, const float g[2]);

/* Writes the answer for texel (i, j). */
void sty_set_texel(StyLut *lut, int i, int j, const StySites *sites, size_t site, const float g[2]);

#endif
