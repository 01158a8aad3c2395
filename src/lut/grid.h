/* The parts of the engine `grid`.
 *
 *   transform.c  8-bit guides: an exact distance transform in integers
 *   grid.c       other guides: the plain inside of a dense guide in cells, what
 *                is exposed, crowded or hangs free in a tree
 *   cells.c      those cells
 *   tree.c       that tree: a packed R-tree in Hilbert order
 *   deal.c       what both sort with, on several threads
 *   search.c     answers blocks of texels from cells and tree */
#ifndef STYLUT_SRC_LUT_GRID_H
#define STYLUT_SRC_LUT_GRID_H

#include "lut/engine.h"

/* ---- transform.c -------------------------------------------------------------- */

/* For measures that are integer. */
StyStatus sty_transform_sites(const StySites *sites, const StyMeasure *measure, StyLut *lut, const StyRun *run,
                              StyError *error);

/* ---- tree.c ------------------------------------------------------------------- */

enum { STY_FAN = 8, STY_TREE_LEVELS = 12 }; /* points of a leaf, children of a node; 8^12 is beyond any image */

/* x and y in the metric's space (the third coordinate follows from them). */
typedef struct StySpot {
  float x, y;
  uint32_t pixel;
} StySpot;

/* Bounding boxes of one level's nodes; padded with boxes that hold nothing. */
typedef struct StyTreeLevel {
  float *low[3], *high[3];
  int32_t *first_pixel; /* the lowest below this node */
} StyTreeLevel;

/* A packed R-tree: points in Hilbert order, eight to a leaf, nodes over eight
 * successive children up to one root's. Kamel, Faloutsos, "On Packing
 * R-trees", 1993. Empty when count is 0. */
typedef struct StyTree {
  int dims;
  size_t count; /* distinct points */
  float *at[3]; /* padded to whole leaves with the last point */
  int32_t *pixels;
  int level_count; /* levels[0] are the leaves */
  StyTreeLevel levels[STY_TREE_LEVELS];
} StyTree;

/* Plants a tree over spots, which come by ascending pixel. They are reordered, and
 * of those at one place only the lowest pixel is kept. */
StyStatus sty_plant_tree(int dims, StySpot *spots, size_t count, const StyRun *run, StyTree *out, StyError *error);
void sty_fell_tree(StyTree *tree);

/* ---- cells.c ------------------------------------------------------------------ */

/* Square cells over the plane, row after row from (x0, y0). */
typedef struct StyCells {
  int columns, rows;
  double x0, y0, inverse; /* column of x = (x - x0) * inverse, rounded down */
  uint32_t *first;        /* per cell and one more: where its points begin */
  float *x, *y;
  int32_t *pixels;
  double reach; /* a point in here serves no texel farther away than this */
} StyCells;

/* Whether the guide deserves cells, and if so, where they lie. */
bool sty_lay_out_cells(const StySites *sites, const StyRun *run, StyCells *cells);

/* Plain points into the cells, the others to *spots, both by ascending pixel. The
 * caller frees both, after an error too. */
StyStatus sty_sort_into_cells(const StySites *sites, StyCells *cells, StySpot **spots, size_t *spot_count,
                              const StyRun *run, StyError *error);

/* Of points at one place only the lowest pixel stays; returns how many remain. */
size_t sty_drop_cell_duplicates(StyCells *cells, const StyRun *run);

void sty_free_cells(StyCells *cells);

/* ---- search.c ----------------------------------------------------------------- */

/* Fills the table from both; cells may be empty (columns 0). Which of the
 * processor's vector units are used does not change a byte. */
StyStatus sty_search_blocks(const StyCells *cells, const StyTree *tree, const StyMeasure *measure, StyLut *lut,
                            const StyRun *run, StyError *error);

#endif
