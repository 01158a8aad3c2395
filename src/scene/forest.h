/* Sets that grow together (union-find): each element points to its parent, a root to itself. */
#ifndef STYLUT_SRC_SCENE_FOREST_H
#define STYLUT_SRC_SCENE_FOREST_H

#include <stdint.h>

static inline uint32_t find_root(uint32_t *parents, uint32_t element) {
  while (parents[element] != element) element = parents[element] = parents[parents[element]];
  return element;
}

/* The lower number becomes the root, so that results don't depend on order. */
static inline void join_sets(uint32_t *parents, uint32_t a, uint32_t b) {
  a = find_root(parents, a), b = find_root(parents, b);
  if (a < b)
    parents[b] = a;
  else
    parents[a] = b;
}

#endif
