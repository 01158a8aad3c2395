#include <math.h>
#include <stdlib.h>
#include <string.h>

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

static bool order_spots(StySpot *spots, StySpot *spare, size_t *count);

/* Sorts by cell into `spare`, whose cells end up where `ends` says, and back. */
static bool order_cells(StySpot *spots, StySpot *spare, size_t *count, const uint32_t *ends, size_t cells) {
  size_t kept = 0, begin = 0;
  for (size_t c = 0; c < cells; c++) {
    size_t members = ends[c] - begin;
    if (members > CROWD) {
      /* What lies before has moved already, so this part of `spots` is free. */
      if (!order_spots(spare + begin, spots + begin, &members)) return false;
      memmove(spots + kept, spare + begin, members * sizeof *spots);
      kept += members;
    } else {
      kept += move_distinct(spare + begin, members, spots + kept);
    }
    begin = ends[c];
  }
  *count = kept;
  return true;
}

/* Each call deals its spots into more cells than one, so that few levels suffice
 * for any: 30 for the worst that float can express. False: memory is short. */
static bool order_spots(StySpot *spots, StySpot *spare, size_t *count) {
  const Box box = get_box(spots, *count);
  if (box.low[0] == box.high[0] && box.low[1] == box.high[1]) {
    *count = 1; /* all at one place; the first is the lowest */
    return true;
  }
  int steps = 1;
  while (steps < MOST_STEPS && (size_t)1 << 4 * steps < *count / 4) steps++;
  const size_t cells = (size_t)1 << 4 * steps;
  double scale[2];
  for (int k = 0; k < 2; k++)
    scale[k] = box.high[k] > box.low[k] ? (double)(1 << 2 * steps) / ((double)box.high[k] - (double)box.low[k]) : 0;
  uint32_t *ends = calloc(cells + 1, sizeof *ends), *cell = malloc(*count * sizeof *cell);
  bool ordered = ends && cell;
  if (ordered) {
    for (size_t i = 0; i < *count; i++) ends[(cell[i] = get_cell(&box, scale, steps, &spots[i])) + 1]++;
    for (size_t c = 0; c < cells; c++) ends[c + 1] += ends[c];
    for (size_t i = 0; i < *count; i++) spare[ends[cell[i]]++] = spots[i];
  }
  free(cell);
  if (ordered) ordered = order_cells(spots, spare, count, ends, cells);
  free(ends);
  return ordered;
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

StyStatus sty_plant_tree(int dims, StySpot *spots, size_t count, StyTree *out, StyError *error) {
  StyTree tree = {.dims = dims, .count = count};
  if (count == 0) {
    *out = tree;
    return STY_OK;
  }
  StySpot *spare = malloc(count * sizeof *spare);
  const bool ordered = spare && order_spots(spots, spare, &tree.count);
  free(spare);
  if (!ordered || !fill_leaves(&tree, spots) || !build_levels(&tree)) {
    sty_fell_tree(&tree);
    return sty_fail_memory(error, "engine grid", (double)count * 24);
  }
  *out = tree;
  return STY_OK;
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
