/* A mesh by its places alone, which is what tells how its triangles hang together. */
#ifndef STYLUT_SRC_SCENE_SOUP_H
#define STYLUT_SRC_SCENE_SOUP_H

#include "stylut/mesh.h"

typedef struct StySoup {
  const StyMesh *mesh;
  size_t point_count;
  size_t triangle_count;
  float *points;       /* 3 per point, trace space */
  uint32_t *corners;   /* point per corner */
  uint32_t *triangles; /* of the mesh: the soup's are fewer where copies were left out */
} StySoup;

/* All triangles. The mesh must outlive the soup. STY_ERROR_LIBRARY. */
StyStatus sty_make_soup(const StyMesh *mesh, StySoup *out, StyError *error);
void sty_destroy_soup(StySoup *soup);

/* Leaves out triangles on the same points as an earlier one. */
StyStatus sty_drop_copies(StySoup *soup, size_t *copies, StyError *error);

#endif
