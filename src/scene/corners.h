/* Triangle corners: a mesh before its vertices are shared. Corner 3*t+k is
 * corner k of triangle t. */
#ifndef STYLUT_SCENE_CORNERS_H
#define STYLUT_SCENE_CORNERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "stylut/status.h"

/* At most this many triangles, so that a corner's number fits 32 bits. */
#define STY_MAX_TRIANGLES ((size_t)1 << 28)

/* Compared byte by byte: no NaN, no negative zero. */
typedef struct StyCorner {
  float position[3];
  float normal[3]; /* all zero: not known yet */
  float uv[2];     /* zero where the file has none */
} StyCorner;

/* Numbers distinct items from 0 in order of their first appearance: ids[i] for item i of `count`, which lie `stride`
 * bytes apart. Only the first `size` bytes of each count, a multiple of 4. */
StyStatus sty_number_distinct(const void *items, size_t stride, size_t count, size_t size, uint32_t *ids,
                              size_t *distinct, StyError *error);

static inline uint32_t sty_next_corner(uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

/* For qsort: records of three uint32_t, of which the first counts most. */
int sty_compare_triples(const void *a, const void *b);

/* The edge from corner `corner` of its triangle to the next one. */
typedef struct StyEdge {
  uint32_t low, high; /* numbers of the end positions */
  uint32_t corner;
} StyEdge;

static inline bool sty_is_same_edge(const StyEdge *a, const StyEdge *b) {
  return a->low == b->low && a->high == b->high;
}

/* The edges of all triangles, one per corner, whose position has the number ids[c]; sorted, so that those between the
 * same positions stand together, in the order of their corners. */
void sty_list_edges(const uint32_t *ids, size_t corner_count, StyEdge *edges);

#endif
