/* What readers and solvers of point pairs share. */
#ifndef STYLUT_SRC_GUIDE_PAIRS_H
#define STYLUT_SRC_GUIDE_PAIRS_H

#include "stylut/warp.h"

/* The first pair that names a point of an earlier one again, *earlier, by its `to` (*is_to) or its `from`; -1: none. */
int sty_find_repeated_point(const StyPair *pairs, int count, int *earlier, bool *is_to);

#endif
