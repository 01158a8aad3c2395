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

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "lut/deal.h"

/* Values that aren't worth sorting. */
enum { FEW = STY_FAN };

enum { REGION = 3, STEPS = 2, MOST_IN_REGION = 16 * REGION * REGION };

/* ---- laying out cells --------------------------------------------------------- */

static int get_column(const StyCells *cells, float x) {
  const int column = (int)(((double)x - cells->x0) * cells->inverse);
  return column < cells->columns ? column : cells->columns - 1;
}

static int get_row(const StyCells *cells, float y) {
  const int row = (int)(((double)y - cells->y0) * cells->inverse);
  return row < cells->rows ? row : cells->rows - 1;
}

static void get_box(const StySites *sites, double low[2], double high[2]) {
  float box[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
  for (size_t s = 0; s < sites->count; s++) {
    const float x = sites->values[2 * s], y = sites->values[2 * s + 1];
    box[0] = x < box[0] ? x : box[0];
    box[1] = y < box[1] ? y : box[1];
    box[2] = x > box[2] ? x : box[2];
    box[3] = y > box[3] ? y : box[3];
  }
  for (int k = 0; k < 2; k++) {
    low[k] = (double)box[k];
    high[k] = (double)box[2 + k];
  }
}

/* Whether the guide deserves cells, and if so, where they lie. */
static bool lay_out_cells(const StySites *sites, StyCells *cells) {
  double low[2], high[2];
  get_box(sites, low, high);
  const double width = high[0] - low[0], height = high[1] - low[1], count = (double)sites->count;
  const double side = sqrt(width * height / count);
  /* A region's width must be more than rounding can blur at the distance of the
   * farthest texel, or farther points could tie with nearer ones. */
  const double farthest = 4 + 2 * (fabs(low[0]) + fabs(high[0]) + fabs(low[1]) + fabs(high[1]));
  if (!(side * REGION > farthest * 1e-6) || width > side * count || height > side * count) return false;
  *cells = (StyCells){.columns = (int)(width / side) + 1,
                      .rows = (int)(height / side) + 1,
                      .x0 = low[0],
                      .y0 = low[1],
                      .inverse = 1 / side,
                      .reach = sqrt(2.0) * REGION * side * 1.001};
  return (double)cells->columns * cells->rows < 4 * count + 64;
}

/* ---- what is plain ------------------------------------------------------------ */

typedef struct Regions {
  int columns, rows;
  uint32_t *counts; /* points in each */
  bool *plain;
} Regions;

static size_t get_region(const Regions *regions, int column, int row) {
  return (size_t)(row / REGION) * (size_t)regions->columns + (size_t)(column / REGION);
}

static bool is_plain(const Regions *regions, int x, int y) {
  if (regions->counts[(size_t)y * (size_t)regions->columns + (size_t)x] > MOST_IN_REGION) return false;
  if (x < STEPS || y < STEPS || x >= regions->columns - STEPS || y >= regions->rows - STEPS) return false;
  for (int dy = -STEPS; dy <= STEPS; dy++)
    for (int dx = -STEPS; dx <= STEPS; dx++)
      if (!regions->counts[(size_t)(y + dy) * (size_t)regions->columns + (size_t)(x + dx)]) return false;
  return true;
}

/* ---- dealing out -------------------------------------------------------------- */

/* Room for what the plain cells hold. */
static bool make_room(StyCells *cells, size_t count) {
  cells->x = sty_allocate_large((count + 1) * sizeof *cells->x);
  cells->y = sty_allocate_large((count + 1) * sizeof *cells->y);
  cells->pixels = sty_allocate_large((count + 1) * sizeof *cells->pixels);
  return cells->x && cells->y && cells->pixels;
}

static void free_cells(StyCells *cells) {
  free(cells->first);
  free(cells->x);
  free(cells->y);
  free(cells->pixels);
  *cells = (StyCells){0};
}

/* Drops points at the place of an earlier one of their cell, in cells begin to
 * end - 1, whose points move together; returns how many remain. */
static size_t drop_cell_duplicates(StyCells *cells, size_t begin, size_t end) {
  size_t kept = cells->first[begin], from = kept;
  for (size_t c = begin; c < end; c++) {
    const size_t to = cells->first[c + 1], base = kept;
    if (c > begin) cells->first[c] = (uint32_t)kept; /* the first one's place is read by who has the cells before */
    for (size_t p = from; p < to; p++) {
      bool known = false;
      for (size_t k = base; k < kept && !known; k++) known = cells->x[k] == cells->x[p] && cells->y[k] == cells->y[p];
      if (known) continue;
      cells->x[kept] = cells->x[p];
      cells->y[kept] = cells->y[p];
      cells->pixels[kept++] = cells->pixels[p];
    }
    from = to;
  }
  return kept - cells->first[begin];
}

typedef struct Dropping {
  StyCells *cells;
  size_t begin[STY_MOST_PARTS], end[STY_MOST_PARTS]; /* cells */
  size_t kept[STY_MOST_PARTS];                       /* points */
} Dropping;

static void drop_part(void *context, int part, size_t begin, size_t end) {
  Dropping *d = context;
  d->begin[part] = begin;
  d->end[part] = end;
  d->kept[part] = drop_cell_duplicates(d->cells, begin, end);
}

/* In all cells; returns how many points remain. */
static size_t drop_duplicates(StyCells *cells, const StyRun *run) {
  const size_t count = (size_t)cells->columns * (size_t)cells->rows;
  const int parts = sty_count_parts(run, count);
  Dropping d = {.cells = cells};
  sty_split_items(run, count, parts, drop_part, &d);
  size_t kept = 0;
  for (int part = 0; part < parts; part++) {
    const size_t from = cells->first[d.begin[part]], gap = from - kept;
    if (gap) {
      memmove(cells->x + kept, cells->x + from, d.kept[part] * sizeof *cells->x);
      memmove(cells->y + kept, cells->y + from, d.kept[part] * sizeof *cells->y);
      memmove(cells->pixels + kept, cells->pixels + from, d.kept[part] * sizeof *cells->pixels);
      for (size_t c = d.begin[part]; c < d.end[part]; c++) cells->first[c] -= (uint32_t)gap;
    }
    kept += d.kept[part];
  }
  cells->first[count] = (uint32_t)kept;
  return kept;
}

/* Sites on their way. */
typedef struct Sorting {
  const StySites *sites;
  StyCells *cells;
  StySpot *spots;
  int parts;
  size_t buckets;   /* cells, and for what isn't plain one more */
  uint32_t *cell;   /* of each site */
  uint32_t *counts; /* part by part, sites in each bucket; then where they begin */
} Sorting;

static void count_sites(void *context, int part, size_t begin, size_t end) {
  const Sorting *s = context;
  uint32_t *counts = s->counts + (size_t)part * s->buckets;
  memset(counts, 0, s->buckets * sizeof *counts);
  for (size_t i = begin; i < end; i++) {
    const float *value = s->sites->values + 2 * i;
    const size_t row = (size_t)get_row(s->cells, value[1]);
    s->cell[i] = (uint32_t)(row * (size_t)s->cells->columns + (size_t)get_column(s->cells, value[0]));
    counts[s->cell[i]]++;
  }
}

static void find_plain_regions(const Sorting *s, Regions *regions) {
  for (int part = 0; part < s->parts; part++) {
    const uint32_t *counts = s->counts + (size_t)part * s->buckets;
    for (int row = 0; row < s->cells->rows; row++)
      for (int column = 0; column < s->cells->columns; column++)
        regions->counts[get_region(regions, column, row)] += *counts++;
  }
  for (int y = 0; y < regions->rows; y++)
    for (int x = 0; x < regions->columns; x++)
      regions->plain[(size_t)y * (size_t)regions->columns + (size_t)x] = is_plain(regions, x, y);
}

/* What isn't plain counts to the last bucket; its own cell counts as empty. */
static void set_apart(const Sorting *s, const Regions *regions) {
  for (int part = 0; part < s->parts; part++) {
    uint32_t *counts = s->counts + (size_t)part * s->buckets, *apart = counts + s->buckets - 1;
    for (int row = 0; row < s->cells->rows; row++)
      for (int column = 0; column < s->cells->columns; column++, counts++)
        if (!regions->plain[get_region(regions, column, row)]) {
          *apart += *counts;
          *counts = 0;
        }
  }
}

static void move_sites(void *context, int part, size_t begin, size_t end) {
  const Sorting *s = context;
  StyCells *cells = s->cells;
  const size_t apart = s->buckets - 1;
  const uint32_t plain = cells->first[apart];
  uint32_t *next = s->counts + (size_t)part * s->buckets;
  for (size_t i = begin; i < end; i++) {
    const float *value = s->sites->values + 2 * i;
    const size_t cell = s->cell[i];
    if (cells->first[cell] < cells->first[cell + 1]) {
      const uint32_t place = next[cell]++;
      cells->x[place] = value[0];
      cells->y[place] = value[1];
      cells->pixels[place] = (int32_t)s->sites->pixels[i];
    } else {
      s->spots[next[apart]++ - plain] = (StySpot){value[0], value[1], s->sites->pixels[i]};
    }
  }
}

static StyStatus deal_out(Sorting *s, Regions *regions, const StyRun *run, StyError *error) {
  const size_t count = s->sites->count;
  sty_split_items(run, count, s->parts, count_sites, s);
  find_plain_regions(s, regions);
  set_apart(s, regions);
  sty_sum_counts(s->counts, s->parts, s->buckets, s->cells->first);
  const size_t plain = s->cells->first[s->buckets - 1];
  s->spots = sty_allocate_large((count - plain + 1) * sizeof *s->spots);
  if (!make_room(s->cells, plain) || !s->spots) return sty_fail_memory(error, "engine grid", (double)count * 12);
  sty_split_items(run, count, s->parts, move_sites, s);
  return STY_OK;
}

/* Plain points into the cells, the others to *spots, both by ascending pixel. */
static StyStatus sort_sites(const StySites *sites, StyCells *cells, StySpot **spots, size_t *spot_count,
                            const StyRun *run, StyError *error) {
  Sorting s = {.sites = sites,
               .cells = cells,
               .parts = sty_count_parts(run, sites->count),
               .buckets = (size_t)cells->columns * (size_t)cells->rows + 1};
  Regions regions = {.columns = (cells->columns + REGION - 1) / REGION, .rows = (cells->rows + REGION - 1) / REGION};
  const size_t region_count = (size_t)regions.columns * (size_t)regions.rows;
  regions.counts = calloc(region_count, sizeof *regions.counts);
  regions.plain = malloc(region_count * sizeof *regions.plain);
  s.cell = sty_allocate_large(sites->count * sizeof *s.cell);
  s.counts = sty_allocate_large((size_t)s.parts * s.buckets * sizeof *s.counts);
  cells->first = sty_allocate_large((s.buckets + 1) * sizeof *cells->first);
  StyStatus status = STY_OK;
  if (!regions.counts || !regions.plain || !s.cell || !s.counts || !cells->first)
    status = sty_fail_memory(error, "engine grid", (double)sites->count * 12);
  if (!status) status = deal_out(&s, &regions, run, error);
  free(regions.counts);
  free(regions.plain);
  free(s.cell);
  free(s.counts);
  *spots = s.spots;
  if (!status) *spot_count = sites->count - cells->first[s.buckets - 1];
  return status;
}

static StySpot get_spot(const StySites *sites, int dims, size_t s) {
  float at[3];
  sty_lift(dims, sites->values + 2 * s, at);
  return (StySpot){at[0], at[1], sites->pixels[s]};
}

/* `count` sites, those that `which` lists or else all, for a tree without cells; NULL: no memory. */
static StySpot *copy_sites(const StySites *sites, int dims, const size_t *which, size_t count) {
  StySpot *spots = sty_allocate_large(count * sizeof *spots);
  for (size_t i = 0; spots && i < count; i++) spots[i] = get_spot(sites, dims, which ? which[i] : i);
  return spots;
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

/* Sites to where they are searched, and to *spots those for the tree. */
static StyStatus deal_sites(const StySites *sites, int dims, StyCells *cells, StySpot **spots, size_t *spot_count,
                            const StyRun *run, StyError *error) {
  size_t few[FEW];
  const size_t few_count = find_few(sites, few);
  if (!few_count && dims == 2 && lay_out_cells(sites, cells))
    return sort_sites(sites, cells, spots, spot_count, run, error);
  *cells = (StyCells){0};
  *spot_count = few_count ? few_count : sites->count;
  *spots = copy_sites(sites, dims, few_count ? few : NULL, *spot_count);
  return *spots ? STY_OK : sty_fail_memory(error, "engine grid", (double)*spot_count * 12);
}

static StyStatus build_by_search(const StySites *sites, const StyMeasure *measure, StyLut *lut, const StyRun *run,
                                 StyError *error) {
  StyCells cells = {0};
  StyTree tree = {0};
  StySpot *spots = NULL;
  size_t spot_count = 0;
  StyStatus status = deal_sites(sites, measure->dims, &cells, &spots, &spot_count, run, error);
  const size_t plain = !status && cells.columns ? drop_duplicates(&cells, run) : 0;
  if (!status) status = sty_plant_tree(measure->dims, spots, spot_count, run, &tree, error);
  free(spots);
  if (!status) {
    lut->unique = plain + tree.count;
    status = sty_search_blocks(&cells, &tree, measure, lut, run, error);
  }
  sty_fell_tree(&tree);
  free_cells(&cells);
  return status;
}

StyStatus sty_build_grid(const StySites *sites, const StyEngineOptions *options, StyLut *lut, const StyRun *run,
                         StyError *error) {
  (void)options;
  const StyMeasure measure = sty_choose_measure(sites, &lut->spec);
  return measure.integer ? sty_transform_sites(sites, &measure, lut, run, error)
                         : build_by_search(sites, &measure, lut, run, error);
}
