/* The engine `grid`.
 *
 * Guides that aren't 8-bit: a counting sort puts the points into square cells of
 * about one point each. Where a guide is dense, a texel's neighbour is in the
 * cells around it, and nothing beats looking there. What that would make slow
 * goes into a tree: points that are exposed, since they serve texels far away,
 * and points in crowds. The rest is plain: each region of 3 x 3 cells whose
 * neighbours within two steps are all occupied, and which holds a bounded number
 * of points. A plain point p serves no texel q farther away than `reach`: on the
 * way from p to q, two regions on, lies an occupied region, and all of its points
 * are nearer to q.
 *
 * Bounds: of the plain points a block of 16 texels looks at those in its own cells,
 * which over the whole table is each of them about once, and at those within
 * reach of it, which are bounded in number. The tree, like any, has no better
 * bound than all of its points for each texel, which needs all of them to be
 * equally far: a circle seen from its very centre. */
#include "lut/grid.h"

#include <stdlib.h>

#include "base/memory.h"
#include "lut/deal.h"

/* Values that aren't worth sorting. */
enum { FEW = STY_FAN };

typedef struct Copying {
  const StySites *sites;
  int dims;
  const size_t *which; /* NULL: all */
  StySpot *spots;
} Copying;

static void copy_part(void *context, int part, size_t begin, size_t end) {
  (void)part;
  const Copying *c = context;
  for (size_t i = begin; i < end; i++) {
    const size_t s = c->which ? c->which[i] : i;
    float at[3];
    sty_lift(c->dims, c->sites->values + 2 * s, at);
    c->spots[i] = (StySpot){at[0], at[1], c->sites->pixels[s]};
  }
}

/* `count` sites, those that `which` lists or else all, for a tree without cells; NULL: no memory. */
static StySpot *copy_sites(const StySites *sites, int dims, const size_t *which, size_t count, const StyRun *run) {
  Copying c = {sites, dims, which, sty_allocate_large(count * sizeof *c.spots)};
  if (c.spots) sty_split_items(run, count, sty_count_parts(run, count), copy_part, &c);
  return c.spots;
}

/* The first sites of each value where there are at most FEW values, such as those
 * of a cube's faces: sorting all of their sites would take far longer than to
 * answer. Returns how many; 0: there are more. */
static size_t find_few(const StySites *sites, size_t few[FEW]) {
  size_t count = 0;
  for (size_t s = 0; s < sites->count; s++) {
    const float *value = sites->values + 2 * s;
    bool known = false;
    for (size_t k = 0; k < count && !known; k++) {
      const float *other = sites->values + 2 * few[k];
      known = other[0] == value[0] && other[1] == value[1];
    }
    if (known) continue;
    if (count == FEW) return 0;
    few[count++] = s;
  }
  return count;
}

/* Sites to where they are searched, and to *spots those for the tree. What is bounded
 * about cells holds for texels: values asked from far away see points closer together
 * than rounding can tell. */
static StyStatus deal_sites(const StySites *sites, int dims, bool for_texels, StyCells *cells, StySpot **spots,
                            size_t *spot_count, const StyRun *run, StyError *error) {
  size_t few[FEW];
  const size_t few_count = find_few(sites, few);
  if (!few_count && dims == 2 && for_texels && sty_lay_out_cells(sites, run, cells))
    return sty_sort_into_cells(sites, cells, spots, spot_count, run, error);
  *cells = (StyCells){0};
  *spot_count = few_count ? few_count : sites->count;
  *spots = copy_sites(sites, dims, few_count ? few : NULL, *spot_count, run);
  return *spots ? STY_OK : sty_fail_memory(error, "engine grid", (double)*spot_count * 12);
}

static StyStatus build_by_search(const StySites *sites, const StyMeasure *measure, StyLut *lut, const StyRun *run,
                                 StyError *error) {
  StyCells cells = {0};
  StyTree tree = {0};
  StySpot *spots = NULL;
  size_t spot_count = 0;
  StyStatus status = deal_sites(sites, measure->dims, !lut->asked, &cells, &spots, &spot_count, run, error);
  const size_t plain = !status && cells.columns ? sty_drop_cell_duplicates(&cells, run) : 0;
  if (!status) status = sty_plant_tree(measure->dims, spots, spot_count, run, &tree, error);
  free(spots);
  if (!status) {
    lut->unique = plain + tree.count;
    status = sty_search_blocks(&cells, &tree, measure, lut, run, error);
  }
  sty_fell_tree(&tree);
  sty_free_cells(&cells);
  return status;
}

StyStatus sty_build_grid(const StySites *sites, const StyEngineOptions *options, StyLut *lut, const StyRun *run,
                         StyError *error) {
  (void)options;
  const StyMeasure measure = sty_choose_measure(sites, &lut->spec);
  return measure.integer ? sty_transform_sites(sites, &measure, lut, run, error)
                         : build_by_search(sites, &measure, lut, run, error);
}
