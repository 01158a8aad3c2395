/* One row of blocks, for each kind of vector unit: see search_blocks.h. */
#ifndef STYLUT_SRC_LUT_SEARCH_H
#define STYLUT_SRC_LUT_SEARCH_H

#include "lut/grid.h"

enum { STY_BLOCK_SIDE = 4 }; /* texels */

typedef struct StySearchJob {
  const StyCells *cells;
  const StyTree *tree;
  const StyMeasure *measure;
  StyLut *lut;
  const float *columns, *rows; /* what texels of each ask for, x and y; NULL where those don't share it */
} StySearchJob;

/* Fills table rows j0 to j0 + STY_BLOCK_SIDE - 1. */
void sty_answer_blocks_plain(const StySearchJob *job, int j0);
#ifdef __x86_64__
void sty_answer_blocks_avx2(const StySearchJob *job, int j0);
void sty_answer_blocks_avx512(const StySearchJob *job, int j0);
#endif

#endif
