/* Door to CGAL's kd-tree: an exact search that shares no code with FLANN's or
 * ours. Built without CGAL (STY_WITH_CGAL not defined) opening one fails with
 * STY_ERROR_UNAVAILABLE. No exception crosses. */
#ifndef STYLUT_BRIDGE_NEIGHBOURS_H
#define STYLUT_BRIDGE_NEIGHBOURS_H

#include <stddef.h>

#include "stylut/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct StyNeighbours StyNeighbours;

/* Builds a tree with sliding midpoints over `count` points of 2 or 3 `dims`.
 * They must be finite and distinct: building is quadratic on identical points.
 * The caller closes it. Errors: STY_ERROR_LIBRARY (CGAL failed, memory). */
StyStatus sty_open_neighbours(const float *values, size_t count, int dims, StyNeighbours **out, StyError *error);
void sty_close_neighbours(StyNeighbours **tree);

/* Indices of the `count` points nearest to `at`, nearest first; returns how
 * many were found, or -1 when CGAL failed. Safe from several threads. */
int sty_find_neighbours(const StyNeighbours *tree, const float *at, int count, int *found);

/* Indices of at most `most` points within `radius` of `at`, in any order. */
int sty_find_neighbours_within(const StyNeighbours *tree, const float *at, double radius, int most, int *found);

#ifdef __cplusplus
}
#endif
#endif
