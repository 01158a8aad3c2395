/* Nearest points for blocks of 4 x 4 texels at a time, one texel to a lane.
 *
 * Exactness rests on rounding being monotone: the distance of two boxes,
 * computed in the same shape as that of two points, is never above the computed
 * distance of any two points in them. So a node is passed over only if none of
 * its points can win, ties included, and no margin is needed for rounding.
 *
 * Included by search_plain.c, search_avx2.c and search_avx512.c, which are
 * compiled for those vector units: lanes are independent and nothing is
 * contracted, so the bytes are the same. Each defines ANSWER_BLOCKS, the name of
 * the function it is to have. */
#include <math.h>
#include <string.h>

#include "lut/search.h"
#ifdef __AVX2__
#include <immintrin.h>
#endif

/* ---- lanes -------------------------------------------------------------------- */

#ifdef __AVX2__
#define WIDTH 8
#else
#define WIDTH 4
#endif

#define INLINE static inline __attribute__((always_inline))

/* The vector types that gcc and clang share. */
typedef float Floats __attribute__((vector_size(4 * WIDTH)));
typedef int32_t Ints __attribute__((vector_size(4 * WIDTH))); /* of comparisons: -1 for true */

INLINE Floats load_floats(const float *from) {
  Floats v;
  memcpy(&v, from, sizeof v);
  return v;
}

INLINE Ints load_ints(const int32_t *from) {
  Ints v;
  memcpy(&v, from, sizeof v);
  return v;
}

/* All lanes alike: an operation with a number spreads it. */
INLINE Ints spread_int(int32_t value) { return value - (Ints){0}; }

INLINE Ints select_ints(Ints mask, Ints yes, Ints no) { return (mask & yes) | (~mask & no); }
INLINE Floats select_floats(Ints mask, Floats yes, Floats no) { return (Floats)select_ints(mask, (Ints)yes, (Ints)no); }
INLINE Floats pick_larger(Floats a, Floats b) { return select_floats(a > b, a, b); }
INLINE Floats pick_smaller(Floats a, Floats b) { return select_floats(a < b, a, b); }

enum { SIDE = STY_BLOCK_SIDE, LANES = SIDE * SIDE };

enum { STACK = (STY_FAN - 1) * STY_TREE_LEVELS + 1 };

INLINE float find_least(const float lanes[LANES]) {
  Floats least = load_floats(lanes);
  for (int l = WIDTH; l < LANES; l += WIDTH) least = pick_smaller(least, load_floats(lanes + l));
  float smallest = least[0];
  for (int l = 1; l < WIDTH; l++) smallest = least[l] < smallest ? least[l] : smallest;
  return smallest;
}

INLINE float find_most(const float lanes[LANES]) {
  Floats most = load_floats(lanes);
  for (int l = WIDTH; l < LANES; l += WIDTH) most = pick_larger(most, load_floats(lanes + l));
  float largest = most[0];
  for (int l = 1; l < WIDTH; l++) largest = most[l] > largest ? most[l] : largest;
  return largest;
}

/* A block's texels and the best found for each so far. */
typedef struct Block {
  _Alignas(64) float at[3][LANES];
  _Alignas(64) float best[LANES];
  _Alignas(64) int32_t pixels[LANES];
  float low[3], high[3]; /* their box */
} Block;

typedef struct Node {
  float distance; /* squared, from the block's box */
  int level;      /* that of its children; -1: points */
  uint32_t number;
} Node;

static Node get_root(const StyTree *tree) { return (Node){0, tree->level_count - 1, 0}; }

typedef struct Window {
  int left, right, top, bottom; /* cells, all inclusive; left > right: none */
} Window;

static int clamp_cell(double cell, int count) { return cell < 0 ? -1 : cell < count ? (int)cell : count; }

/* The cells within `radius` of the block's box. */
static Window get_window(const StyCells *cells, const Block *block, double radius) {
  Window w = {clamp_cell(((double)block->low[0] - radius - cells->x0) * cells->inverse, cells->columns),
              clamp_cell(((double)block->high[0] + radius - cells->x0) * cells->inverse, cells->columns),
              clamp_cell(((double)block->low[1] - radius - cells->y0) * cells->inverse, cells->rows),
              clamp_cell(((double)block->high[1] + radius - cells->y0) * cells->inverse, cells->rows)};
  if (w.left < 0) w.left = 0;
  if (w.top < 0) w.top = 0;
  if (w.right == cells->columns) w.right--;
  if (w.bottom == cells->rows) w.bottom--;
  return w;
}

/* Texel l of the block asks for the value of the table's (i, j); beyond the table's edge for the last one's. */
INLINE void set_lane(int dims, const StySearchJob *job, int i, int j, Block *block, int l) {
  float g[2], at[3];
  if (job->columns) {
    g[0] = job->columns[i];
    g[1] = job->rows[j];
  } else {
    sty_get_asked_value(job->lut, 2, i, j, g);
  }
  sty_lift(dims, g, at);
  for (int k = 0; k < dims; k++) block->at[k][l] = at[k];
}

INLINE void set_block(int dims, const StySearchJob *job, int i0, int j0, Block *block) {
  const int last_column = job->lut->spec.width - 1, last_row = job->lut->spec.height - 1;
  if (dims == 2 && job->columns && i0 + SIDE - 1 <= last_column && j0 + SIDE - 1 <= last_row) {
    for (int row = 0; row < SIDE; row++) {
      memcpy(block->at[0] + row * SIDE, job->columns + i0, SIDE * sizeof(float));
      for (int l = 0; l < SIDE; l++) block->at[1][row * SIDE + l] = job->rows[j0 + row];
    }
  } else {
    for (int l = 0; l < LANES; l++) {
      const int i = i0 + l % SIDE, j = j0 + l / SIDE;
      set_lane(dims, job, i < last_column ? i : last_column, j < last_row ? j : last_row, block, l);
    }
  }
  for (int k = 0; k < dims; k++) {
    block->low[k] = find_least(block->at[k]);
    block->high[k] = find_most(block->at[k]);
  }
  for (int l = 0; l < LANES; l++) {
    block->best[l] = INFINITY;
    block->pixels[l] = INT32_MAX;
  }
}

/* As sty_set_texel does it: the unit of what isn't measured in integers is 1. */
static void write_block(const StySearchJob *job, int i0, int j0, const Block *block) {
  const StyLutSpec *spec = &job->lut->spec;
  float errors[LANES];
  for (int l = 0; l < LANES; l++) errors[l] = sqrtf(block->best[l]);
  const int columns = spec->width - i0 < SIDE ? spec->width - i0 : SIDE;
  for (int row = 0; row < SIDE && j0 + row < spec->height; row++) {
    const size_t texel = (size_t)(j0 + row) * (size_t)spec->width + (size_t)i0;
    for (int i = 0; i < columns; i++) {
      job->lut->pixels[texel + (size_t)i] = (uint32_t)block->pixels[row * SIDE + i];
      job->lut->errors[texel + (size_t)i] = errors[row * SIDE + i];
    }
  }
}

#ifdef __AVX512F__

INLINE float find_worst(const Block *block) { return _mm512_reduce_max_ps(_mm512_load_ps(block->best)); }

/* Whether a node may hold an answer for any lane. */
INLINE bool concerns_lanes(int dims, const Block *block, const StyTreeLevel *level, size_t number) {
  __m512 sum = _mm512_setzero_ps();
  for (int k = 0; k < dims; k++) {
    const __m512 at = _mm512_load_ps(block->at[k]);
    const __m512 below = _mm512_sub_ps(_mm512_set1_ps(level->low[k][number]), at);
    const __m512 above = _mm512_sub_ps(at, _mm512_set1_ps(level->high[k][number]));
    const __m512 gap = _mm512_max_ps(_mm512_max_ps(below, above), _mm512_setzero_ps());
    sum = _mm512_add_ps(sum, _mm512_mul_ps(gap, gap));
  }
  const __m512 best = _mm512_load_ps(block->best);
  const __m512i pixel = _mm512_set1_epi32(level->first_pixel[number]), found = _mm512_load_si512(block->pixels);
  return (_mm512_cmp_ps_mask(sum, best, _CMP_LT_OQ) |
          _mm512_mask_cmplt_epi32_mask(_mm512_cmp_ps_mask(sum, best, _CMP_EQ_OQ), pixel, found)) != 0;
}

/* Points begin to end - 1 against all lanes. */
INLINE void test_points(int dims, Block *block, float *const at[3], const int32_t *pixels, size_t begin, size_t end) {
  __m512 lanes[3], best = _mm512_load_ps(block->best);
  __m512i found = _mm512_load_si512(block->pixels);
  for (int k = 0; k < dims; k++) lanes[k] = _mm512_load_ps(block->at[k]);
  for (size_t p = begin; p < end; p++) {
    const __m512 dx = _mm512_sub_ps(lanes[0], _mm512_set1_ps(at[0][p]));
    const __m512 dy = _mm512_sub_ps(lanes[1], _mm512_set1_ps(at[1][p]));
    __m512 distance = _mm512_add_ps(_mm512_mul_ps(dx, dx), _mm512_mul_ps(dy, dy));
    if (dims == 3) {
      const __m512 dz = _mm512_sub_ps(lanes[2], _mm512_set1_ps(at[2][p]));
      distance = _mm512_add_ps(distance, _mm512_mul_ps(dz, dz));
    }
    const __m512i pixel = _mm512_set1_epi32(pixels[p]);
    const __mmask16 tied = _mm512_mask_cmplt_epi32_mask(_mm512_cmp_ps_mask(distance, best, _CMP_EQ_OQ), pixel, found);
    const __mmask16 nearer = tied | _mm512_cmp_ps_mask(distance, best, _CMP_LT_OQ);
    best = _mm512_mask_mov_ps(best, nearer, distance);
    found = _mm512_mask_mov_epi32(found, nearer, pixel);
  }
  _mm512_store_ps(block->best, best);
  _mm512_store_si512(block->pixels, found);
}

#else

INLINE float find_worst(const Block *block) { return find_most(block->best); }

INLINE bool concerns_lanes(int dims, const Block *block, const StyTreeLevel *level, size_t number) {
  Ints any = {0};
  for (int l = 0; l < LANES; l += WIDTH) {
    Floats sum = {0};
    for (int k = 0; k < dims; k++) {
      const Floats at = load_floats(block->at[k] + l);
      const Floats below = level->low[k][number] - at, above = at - level->high[k][number];
      const Floats gap = pick_larger(pick_larger(below, above), (Floats){0});
      sum = sum + gap * gap;
    }
    const Floats best = load_floats(block->best + l);
    const Ints pixels = load_ints(block->pixels + l);
    any |= (sum < best) | ((sum == best) & (level->first_pixel[number] < pixels));
  }
  int32_t all = 0;
  for (int l = 0; l < WIDTH; l++) all |= any[l];
  return all != 0;
}

INLINE void test_points(int dims, Block *block, float *const at[3], const int32_t *pixels, size_t begin, size_t end) {
  enum { PARTS = LANES / WIDTH };
  Floats best[PARTS], lanes[3][PARTS];
  Ints found[PARTS];
  for (int part = 0; part < PARTS; part++) {
    best[part] = load_floats(block->best + part * WIDTH);
    found[part] = load_ints(block->pixels + part * WIDTH);
    for (int k = 0; k < dims; k++) lanes[k][part] = load_floats(block->at[k] + part * WIDTH);
  }
  for (size_t p = begin; p < end; p++) {
    const Ints pixel = spread_int(pixels[p]);
    for (int part = 0; part < PARTS; part++) {
      const Floats dx = lanes[0][part] - at[0][p], dy = lanes[1][part] - at[1][p];
      Floats distance = dx * dx + dy * dy;
      if (dims == 3) {
        const Floats dz = lanes[2][part] - at[2][p];
        distance = distance + dz * dz;
      }
      const Ints nearer = (distance < best[part]) | ((distance == best[part]) & (pixel < found[part]));
      best[part] = select_floats(nearer, distance, best[part]);
      found[part] = select_ints(nearer, pixel, found[part]);
    }
  }
  for (int part = 0; part < PARTS; part++) {
    memcpy(block->best + part * WIDTH, &best[part], sizeof best[part]);
    memcpy(block->pixels + part * WIDTH, &found[part], sizeof found[part]);
  }
}

#endif

/* ---- the tree ----------------------------------------------------------------- */

/* Squared distances from a box to the children of a node: the eight from `begin`. */
INLINE void measure_children(int dims, const StyTreeLevel *level, size_t begin, const float low[3], const float high[3],
                             float out[STY_FAN]) {
  for (int c = 0; c < STY_FAN; c += WIDTH) {
    Floats sum = {0};
    for (int k = 0; k < dims; k++) {
      const Floats below = load_floats(level->low[k] + begin + c) - high[k];
      const Floats above = low[k] - load_floats(level->high[k] + begin + c);
      const Floats gap = pick_larger(pick_larger(below, above), (Floats){0});
      sum = sum + gap * gap;
    }
    memcpy(out + c, &sum, sizeof sum);
  }
}

/* Pushes the children that may hold an answer, the nearest on top. */
INLINE int push_children(int dims, const StyTree *tree, const Node *node, const float low[3], const float high[3],
                         float worst, Node *stack, int height) {
  const StyTreeLevel *level = &tree->levels[node->level];
  const size_t begin = (size_t)node->number * STY_FAN;
  float distances[STY_FAN];
  measure_children(dims, level, begin, low, high, distances);
  const int base = height;
  for (int c = 0; c < STY_FAN; c++) {
    /* Boxes that hold nothing are infinitely far. */
    if (!(distances[c] <= worst) || distances[c] == INFINITY) continue;
    int at = height++;
    for (; at > base && stack[at - 1].distance < distances[c]; at--) stack[at] = stack[at - 1];
    stack[at] = (Node){distances[c], node->level - 1, (uint32_t)begin + (uint32_t)c};
  }
  return height;
}

INLINE void search_tree(int dims, const StyTree *tree, Block *block) {
  Node stack[STACK];
  int height = 0;
  float worst = find_worst(block);
  stack[height++] = get_root(tree);
  while (height) {
    const Node node = stack[--height];
    if (node.distance > worst) continue;
    if (node.level + 1 < tree->level_count && !concerns_lanes(dims, block, &tree->levels[node.level + 1], node.number))
      continue;
    if (node.level >= 0) {
      height = push_children(dims, tree, &node, block->low, block->high, worst, stack, height);
      continue;
    }
    const size_t begin = (size_t)node.number * STY_FAN;
    test_points(dims, block, tree->at, tree->pixels, begin, begin + STY_FAN);
    worst = find_worst(block);
  }
}

/* ---- cells -------------------------------------------------------------------- */

/* Points in cells left to right - 1 of a row. */
INLINE void test_cells(const StyCells *cells, Block *block, int row, int left, int right) {
  if (left >= right) return;
  float *const at[3] = {cells->x, cells->y, NULL};
  const uint32_t *first = cells->first + (size_t)row * (size_t)cells->columns;
  test_points(2, block, at, cells->pixels, first[left], first[right]);
}

/* What `w` holds beyond `known`, which lies within it or is empty. */
INLINE void test_window(const StyCells *cells, Block *block, Window w, Window known) {
  const bool nothing = known.left > known.right || known.top > known.bottom;
  for (int row = w.top; row <= w.bottom; row++) {
    if (nothing || row < known.top || row > known.bottom) {
      test_cells(cells, block, row, w.left, w.right + 1);
    } else {
      test_cells(cells, block, row, w.left, known.left);
      test_cells(cells, block, row, known.right + 1, w.right + 1);
    }
  }
}

/* ---- blocks ------------------------------------------------------------------- */

INLINE void answer_block(int dims, const StySearchJob *job, Block *block) {
  static const Window none = {0, -1, 0, -1};
  const bool has_cells = job->cells->columns > 0;
  const Window own = has_cells ? get_window(job->cells, block, 0) : none;
  if (has_cells) test_window(job->cells, block, own, none);
  if (job->tree->count) search_tree(dims, job->tree, block);
  if (!has_cells) return;
  /* Rounding of the squares is far below this margin. */
  const double radius = sqrt((double)find_worst(block)) * (1 + 1e-6) + 1e-18;
  const double reach = job->cells->reach;
  test_window(job->cells, block, get_window(job->cells, block, radius < reach ? radius : reach), own);
}

INLINE void answer_row(int dims, const StySearchJob *job, int j0) {
  for (int i0 = 0; i0 < job->lut->spec.width; i0 += SIDE) {
    Block block;
    set_block(dims, job, i0, j0, &block);
    answer_block(dims, job, &block);
#ifdef __AVX2__
    /* What follows calls code for any processor, which is many times slower while
     * the upper halves of the registers are in use; compilers forget it here. */
    _mm256_zeroupper();
#endif
    write_block(job, i0, j0, &block);
  }
}

void ANSWER_BLOCKS(const StySearchJob *job, int j0) {
  if (job->measure->dims == 2)
    answer_row(2, job, j0);
  else
    answer_row(3, job, j0);
}
