#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "lut/deal.h"
#include "lut/grid.h"

/* ---- Hilbert order ------------------------------------------------------------ */

/* Two levels of the curve at once: in each of its four positions (as it is; x
 * and y swapped; turned half round; both) the rank of the square x * 4 + y among
 * 4 x 4, and the curve's position inside that square. */
static const uint8_t hilbert_rank[4][16] = {
    {0, 3, 4, 5, 1, 2, 7, 6, 14, 13, 8, 9, 15, 12, 11, 10},
    {0, 1, 14, 15, 3, 2, 13, 12, 4, 7, 8, 11, 5, 6, 9, 10},
    {10, 11, 12, 15, 9, 8, 13, 14, 6, 7, 2, 1, 5, 4, 3, 0},
    {10, 9, 6, 5, 11, 8, 7, 4, 12, 13, 2, 3, 15, 14, 1, 0},
};
static const uint8_t hilbert_turn[4][16] = {
    {0, 2, 1, 0, 1, 1, 3, 0, 3, 3, 1, 0, 0, 2, 3, 0},
    {1, 0, 2, 1, 3, 0, 2, 3, 0, 2, 0, 2, 1, 1, 1, 1},
    {2, 1, 0, 2, 2, 3, 1, 1, 2, 1, 3, 3, 2, 3, 0, 2},
    {3, 3, 3, 3, 0, 2, 0, 2, 1, 0, 2, 1, 3, 0, 2, 3},
};

/* Where square (x, y) of 4^steps a side comes on the curve. */
static uint32_t get_hilbert_rank(uint32_t x, uint32_t y, int steps) {
  uint32_t rank = 0, position = 0;
  for (int bit = 2 * steps - 2; bit >= 0; bit -= 2) {
    const uint32_t square = ((x >> bit) & 3) << 2 | ((y >> bit) & 3);
    rank = rank << 4 | hilbert_rank[position][square];
    position = hilbert_turn[position][square];
  }
  return rank;
}

/* ---- ordering ----------------------------------------------------------------- */

/* Cells that hold more are ordered within, on a curve of their own. */
enum { CROWD = 32, MOST_STEPS = 5 };

typedef struct Box {
  float low[2], high[2];
} Box;

static Box get_box(const StySpot *spots, size_t count) {
  Box box = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
  for (size_t i = 0; i < count; i++) {
    const float at[2] = {spots[i].x, spots[i].y};
    for (int k = 0; k < 2; k++) {
      box.low[k] = at[k] < box.low[k] ? at[k] : box.low[k];
      box.high[k] = at[k] > box.high[k] ? at[k] : box.high[k];
    }
  }
  return box;
}

static uint32_t get_cell(const Box *box, const double scale[2], int steps, const StySpot *spot) {
  const uint32_t last = (1u << 2 * steps) - 1;
  const uint32_t x = (uint32_t)(((double)spot->x - (double)box->low[0]) * scale[0]);
  const uint32_t y = (uint32_t)(((double)spot->y - (double)box->low[1]) * scale[1]);
  return get_hilbert_rank(x < last ? x : last, y < last ? y : last, steps);
}

/* Moves the few spots of a cell, dropping those at the place of an earlier one. */
static size_t move_distinct(const StySpot *spots, size_t count, StySpot *out) {
  size_t kept = 0;
  for (size_t i = 0; i < count; i++) {
    bool known = false;
    for (size_t k = 0; k < kept && !known; k++) known = out[k].x == spots[i].x && out[k].y == spots[i].y;
    if (!known) out[kept++] = spots[i];
  }
  return kept;
}

static StyStatus order_spots(StySpot *spots, StySpot *spare, size_t *count, const StyRun *run, StyError *error);

/* A deal of spots into cells. */
typedef struct Dealing {
  StySpot *spots, *spare;
  Box box;
  double scale[2];
  int steps, parts;
  size_t cells;
  uint32_t *cell;   /* of each spot */
  uint32_t *counts; /* part by part, spots in each cell; then where in `spare` they begin */
  uint32_t *first;  /* per cell and one more: where in `spare` */
} Dealing;

static void count_spots(void *context, int part, size_t begin, size_t end) {
  const Dealing *d = context;
  uint32_t *counts = d->counts + (size_t)part * d->cells;
  memset(counts, 0, d->cells * sizeof *counts);
  for (size_t i = begin; i < end; i++) counts[d->cell[i] = get_cell(&d->box, d->scale, d->steps, &d->spots[i])]++;
}

static void move_spots(void *context, int part, size_t begin, size_t end) {
  const Dealing *d = context;
  uint32_t *next = d->counts + (size_t)part * d->cells;
  for (size_t i = begin; i < end; i++) d->spare[next[d->cell[i]]++] = d->spots[i];
}

/* Orders cells within and moves them back, to where the first of them begins; *kept of their spots remain. */
static StyStatus order_cells(const Dealing *d, size_t begin_cell, size_t end_cell, size_t *kept, StyError *error) {
  StySpot *out = d->spots + d->first[begin_cell];
  *kept = 0;
  for (size_t c = begin_cell; c < end_cell; c++) {
    const size_t begin = d->first[c];
    size_t members = d->first[c + 1] - begin;
    if (members > CROWD) {
      /* What lies before has moved already, so this part of `spots` is free. */
      const StyStatus status =
          order_spots(d->spare + begin, d->spots + begin, &members, &(StyRun){.threads = 1}, error);
      if (status) return status;
      memmove(out + *kept, d->spare + begin, members * sizeof *out);
      *kept += members;
    } else {
      *kept += move_distinct(d->spare + begin, members, out + *kept);
    }
  }
  return STY_OK;
}

enum { CELL_RUNS = 64 }; /* what threads take at a time */

typedef struct CellRuns {
  const Dealing *dealing;
  size_t ends[CELL_RUNS + 1]; /* cells */
  size_t kept[CELL_RUNS];
} CellRuns;

static StyStatus order_run(void *context, long r, StyError *error) {
  CellRuns *runs = context;
  return order_cells(runs->dealing, runs->ends[r], runs->ends[r + 1], &runs->kept[r], error);
}

/* All cells, in runs of about equally many spots where there are several threads' worth. */
static StyStatus order_all_cells(const Dealing *d, size_t *count, const StyRun *run, StyError *error) {
  if (d->parts == 1) return order_cells(d, 0, d->cells, count, error);
  CellRuns runs = {.dealing = d};
  size_t cell = 0;
  for (int r = 0; r < CELL_RUNS; r++) {
    runs.ends[r] = cell;
    while (cell < d->cells && d->first[cell] < *count * (size_t)(r + 1) / CELL_RUNS) cell++;
  }
  runs.ends[CELL_RUNS] = d->cells;
  const StyStatus status =
      sty_parallel_for(&(StyRun){.threads = sty_get_threads(run)}, CELL_RUNS, order_run, &runs, error);
  if (status) return status;
  size_t kept = 0;
  for (int r = 0; r < CELL_RUNS; r++) {
    memmove(d->spots + kept, d->spots + d->first[runs.ends[r]], runs.kept[r] * sizeof *d->spots);
    kept += runs.kept[r];
  }
  *count = kept;
  return STY_OK;
}

/* Each call deals its spots into more cells than one, so that few levels suffice
 * for any: 30 for the worst that float can express. */
static StyStatus order_spots(StySpot *spots, StySpot *spare, size_t *count, const StyRun *run, StyError *error) {
  Dealing d = {.spots = spots, .spare = spare, .box = get_box(spots, *count), .steps = 1};
  const Box *box = &d.box;
  if (box->low[0] == box->high[0] && box->low[1] == box->high[1]) {
    *count = 1; /* all at one place; the first is the lowest */
    return STY_OK;
  }
  while (d.steps < MOST_STEPS && (size_t)1 << 4 * d.steps < *count / 4) d.steps++;
  d.cells = (size_t)1 << 4 * d.steps;
  d.parts = sty_count_parts(run, *count);
  for (int k = 0; k < 2; k++)
    d.scale[k] =
        box->high[k] > box->low[k] ? (double)(1 << 2 * d.steps) / ((double)box->high[k] - (double)box->low[k]) : 0;
  d.cell = sty_allocate_large(*count * sizeof *d.cell);
  d.counts = malloc((size_t)d.parts * d.cells * sizeof *d.counts);
  d.first = malloc((d.cells + 1) * sizeof *d.first);
  const bool complete = d.cell && d.counts && d.first;
  if (complete) {
    sty_split_items(run, *count, d.parts, count_spots, &d);
    sty_sum_counts(d.counts, d.parts, d.cells, d.first, run);
    sty_split_items(run, *count, d.parts, move_spots, &d);
  }
  free(d.cell);
  free(d.counts);
  const StyStatus status =
      complete ? order_all_cells(&d, count, run, error) : sty_fail_memory(error, "engine grid", (double)*count * 4);
  free(d.first);
  return status;
}

/* ---- the tree ----------------------------------------------------------------- */

static size_t pad(size_t count) { return (count + STY_FAN - 1) / STY_FAN * STY_FAN; }

static bool fill_leaves(StyTree *tree, const StySpot *spots) {
  const size_t padded = pad(tree->count);
  tree->pixels = malloc(padded * sizeof *tree->pixels);
  bool complete = tree->pixels;
  for (int k = 0; k < tree->dims; k++) {
    tree->at[k] = malloc(padded * sizeof *tree->at[k]);
    complete = complete && tree->at[k];
  }
  if (!complete) return false;
  for (size_t i = 0; i < padded; i++) {
    const StySpot *spot = &spots[i < tree->count ? i : tree->count - 1];
    tree->at[0][i] = spot->x;
    tree->at[1][i] = spot->y;
    if (tree->dims == 3) tree->at[2][i] = sty_get_height(spot->x, spot->y);
    tree->pixels[i] = (int32_t)spot->pixel;
  }
  return true;
}

/* The boxes over groups of STY_FAN of `count` boxes (a multiple of it). */
static bool add_level(StyTree *tree, float *const low[3], float *const high[3], const int32_t *pixels, size_t count) {
  StyTreeLevel *level = &tree->levels[tree->level_count++];
  const size_t nodes = count / STY_FAN, padded = pad(nodes);
  level->first_pixel = malloc(padded * sizeof *level->first_pixel);
  bool complete = level->first_pixel;
  for (int k = 0; k < tree->dims; k++) {
    level->low[k] = malloc(padded * sizeof *level->low[k]);
    level->high[k] = malloc(padded * sizeof *level->high[k]);
    complete = complete && level->low[k] && level->high[k];
  }
  if (!complete) return false;
  for (size_t n = 0; n < padded; n++) {
    const size_t begin = n * STY_FAN, end = n < nodes ? begin + STY_FAN : begin;
    int32_t pixel = INT32_MAX;
    for (size_t c = begin; c < end; c++) pixel = pixels[c] < pixel ? pixels[c] : pixel;
    level->first_pixel[n] = pixel;
    for (int k = 0; k < tree->dims; k++) {
      float least = INFINITY, most = -INFINITY;
      for (size_t c = begin; c < end; c++) {
        least = low[k][c] < least ? low[k][c] : least;
        most = high[k][c] > most ? high[k][c] : most;
      }
      level->low[k][n] = least;
      level->high[k][n] = most;
    }
  }
  return true;
}

static bool build_levels(StyTree *tree) {
  size_t count = pad(tree->count);
  if (!add_level(tree, tree->at, tree->at, tree->pixels, count)) return false;
  while (count / STY_FAN > STY_FAN) {
    count = pad(count / STY_FAN);
    const StyTreeLevel *below = &tree->levels[tree->level_count - 1];
    if (!add_level(tree, below->low, below->high, below->first_pixel, count)) return false;
  }
  return true;
}

StyStatus sty_plant_tree(int dims, StySpot *spots, size_t count, const StyRun *run, StyTree *out, StyError *error) {
  StyTree tree = {.dims = dims, .count = count};
  if (count == 0) {
    *out = tree;
    return STY_OK;
  }
  StySpot *spare = sty_allocate_large(count * sizeof *spare);
  StyStatus status = spare ? order_spots(spots, spare, &tree.count, run, error)
                           : sty_fail_memory(error, "engine grid", (double)count * 12);
  free(spare);
  if (!status && (!fill_leaves(&tree, spots) || !build_levels(&tree)))
    status = sty_fail_memory(error, "engine grid", (double)count * 24);
  if (status)
    sty_fell_tree(&tree);
  else
    *out = tree;
  return status;
}

void sty_fell_tree(StyTree *tree) {
  for (int k = 0; k < 3; k++) free(tree->at[k]);
  free(tree->pixels);
  for (int l = 0; l < tree->level_count; l++) {
    for (int k = 0; k < 3; k++) {
      free(tree->levels[l].low[k]);
      free(tree->levels[l].high[k]);
    }
    free(tree->levels[l].first_pixel);
  }
  *tree = (StyTree){0};
}
