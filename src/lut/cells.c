/* The cells of the engine `grid`: what of a guide is plain goes into them, what isn't
 * is set apart for the tree (see grid.c for why). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "lut/deal.h"
#include "lut/grid.h"

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

typedef struct Boxing {
  const StySites *sites;
  float boxes[STY_MOST_PARTS][4]; /* least x and y, most x and y */
} Boxing;

static void box_part(void *context, int part, size_t begin, size_t end) {
  Boxing *b = context;
  float box[4] = {INFINITY, INFINITY, -INFINITY, -INFINITY};
  for (size_t s = begin; s < end; s++) {
    const float x = b->sites->values[2 * s], y = b->sites->values[2 * s + 1];
    box[0] = x < box[0] ? x : box[0];
    box[1] = y < box[1] ? y : box[1];
    box[2] = x > box[2] ? x : box[2];
    box[3] = y > box[3] ? y : box[3];
  }
  memcpy(b->boxes[part], box, sizeof box);
}

static void get_box(const StySites *sites, const StyRun *run, double low[2], double high[2]) {
  Boxing b = {.sites = sites};
  const int parts = sty_count_parts(run, sites->count);
  sty_split_items(run, sites->count, parts, box_part, &b);
  for (int k = 0; k < 2; k++) {
    low[k] = INFINITY;
    high[k] = -INFINITY;
    for (int part = 0; part < parts; part++) {
      low[k] = fmin(low[k], (double)b.boxes[part][k]);
      high[k] = fmax(high[k], (double)b.boxes[part][2 + k]);
    }
  }
}

bool sty_lay_out_cells(const StySites *sites, const StyRun *run, StyCells *cells) {
  double low[2], high[2];
  get_box(sites, run, low, high);
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

void sty_free_cells(StyCells *cells) {
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

size_t sty_drop_cell_duplicates(StyCells *cells, const StyRun *run) {
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
  Regions *regions;
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

/* Sites in one region. */
static uint32_t count_region(const Sorting *s, int x, int y) {
  const StyCells *cells = s->cells;
  const int right = (x + 1) * REGION < cells->columns ? (x + 1) * REGION : cells->columns;
  const int bottom = (y + 1) * REGION < cells->rows ? (y + 1) * REGION : cells->rows;
  uint32_t count = 0;
  for (int part = 0; part < s->parts; part++)
    for (int row = y * REGION; row < bottom; row++) {
      const uint32_t *counts = s->counts + (size_t)part * s->buckets + (size_t)row * (size_t)cells->columns;
      for (int column = x * REGION; column < right; column++) count += counts[column];
    }
  return count;
}

static void count_region_rows(void *context, int part, size_t begin, size_t end) {
  (void)part;
  const Sorting *s = context;
  uint32_t *count = s->regions->counts + begin * (size_t)s->regions->columns;
  for (int y = (int)begin; y < (int)end; y++)
    for (int x = 0; x < s->regions->columns; x++) *count++ = count_region(s, x, y);
}

static void find_plain_regions(void *context, int part, size_t begin, size_t end) {
  (void)part;
  const Sorting *s = context;
  bool *plain = s->regions->plain + begin * (size_t)s->regions->columns;
  for (int y = (int)begin; y < (int)end; y++)
    for (int x = 0; x < s->regions->columns; x++) *plain++ = is_plain(s->regions, x, y);
}

/* What isn't plain counts to the last bucket of each part; its own cell counts as empty. */
static void set_apart(void *context, int part, size_t begin, size_t end) {
  (void)begin, (void)end;
  const Sorting *s = context;
  uint32_t *counts = s->counts + (size_t)part * s->buckets, *apart = counts + s->buckets - 1;
  for (int row = 0; row < s->cells->rows; row++) {
    const bool *plain = s->regions->plain + (size_t)(row / REGION) * (size_t)s->regions->columns;
    for (int column = 0; column < s->cells->columns; column++, counts++)
      if (!plain[column / REGION]) {
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

static StyStatus deal_out(Sorting *s, const StyRun *run, StyError *error) {
  const size_t count = s->sites->count, region_rows = (size_t)s->regions->rows;
  sty_split_items(run, count, s->parts, count_sites, s);
  sty_split_items(run, region_rows, s->parts, count_region_rows, s);
  sty_split_items(run, region_rows, s->parts, find_plain_regions, s);
  sty_split_items(run, (size_t)s->parts, s->parts, set_apart, s);
  sty_sum_counts(s->counts, s->parts, s->buckets, s->cells->first, run);
  const size_t plain = s->cells->first[s->buckets - 1];
  s->spots = sty_allocate_large((count - plain + 1) * sizeof *s->spots);
  if (!make_room(s->cells, plain) || !s->spots) return sty_fail_memory(error, "engine grid", (double)count * 12);
  sty_split_items(run, count, s->parts, move_sites, s);
  return STY_OK;
}

StyStatus sty_sort_into_cells(const StySites *sites, StyCells *cells, StySpot **spots, size_t *spot_count,
                              const StyRun *run, StyError *error) {
  Regions regions = {.columns = (cells->columns + REGION - 1) / REGION, .rows = (cells->rows + REGION - 1) / REGION};
  Sorting s = {.sites = sites,
               .cells = cells,
               .regions = &regions,
               .parts = sty_count_parts(run, sites->count),
               .buckets = (size_t)cells->columns * (size_t)cells->rows + 1};
  const size_t region_count = (size_t)regions.columns * (size_t)regions.rows;
  regions.counts = malloc(region_count * sizeof *regions.counts);
  regions.plain = malloc(region_count * sizeof *regions.plain);
  s.cell = sty_allocate_large(sites->count * sizeof *s.cell);
  s.counts = sty_allocate_large((size_t)s.parts * s.buckets * sizeof *s.counts);
  cells->first = sty_allocate_large((s.buckets + 1) * sizeof *cells->first);
  StyStatus status = STY_OK;
  if (!regions.counts || !regions.plain || !s.cell || !s.counts || !cells->first)
    status = sty_fail_memory(error, "engine grid", (double)sites->count * 12);
  if (!status) status = deal_out(&s, run, error);
  free(regions.counts);
  free(regions.plain);
  free(s.cell);
  free(s.counts);
  *spots = s.spots;
  if (!status) *spot_count = sites->count - cells->first[s.buckets - 1];
  return status;
}
