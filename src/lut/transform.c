/* The exact nearest-site transform of an 8-bit guide, in integers.
 *
 * A guide of bytes has at most 256 x 256 values. Texels and values lie on one
 * fine integer scale (see StyMeasure), so that squared distances are whole
 * numbers and separate into x and y. Per table row:
 *   1. in every value column, the occupied value nearest in y;
 *   2. the lower envelope of the parabolas which the columns raise over the row.
 * Felzenszwalb and Huttenlocher, "Distance Transforms of Sampled Functions",
 * 2012. The work is pixels + 256 L + L^2, whatever the guide shows. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lut/grid.h"

enum { LEVELS = 256, ROWS = 16 }; /* table rows that a thread takes at a time */

static const uint32_t empty = UINT32_MAX;

typedef struct Transform {
  StyLut *lut;
  StyMeasure measure;
  uint32_t pixels[LEVELS][LEVELS];   /* lowest pixel of each value, or `empty`; rows are gy, byte 0 first */
  int16_t below[LEVELS][LEVELS];     /* the last occupied row at or before this one, in this column; -1: none */
  int16_t above[LEVELS + 1][LEVELS]; /* the first at or after; LEVELS: none */
} Transform;

static size_t fill_values(Transform *t, const StySites *sites) {
  memset(t->pixels, 0xff, sizeof t->pixels);
  size_t unique = 0;
  for (size_t s = 0; s < sites->count; s++) {
    uint32_t *slot = &t->pixels[sites->levels[2 * s + 1]][sites->levels[2 * s]];
    unique += *slot == empty;
    *slot = sites->pixels[s] < *slot ? sites->pixels[s] : *slot;
  }
  return unique;
}

static void find_neighbours(Transform *t) {
  int16_t last[LEVELS], next[LEVELS];
  for (int x = 0; x < LEVELS; x++) last[x] = -1, next[x] = LEVELS;
  memcpy(t->above[LEVELS], next, sizeof next);
  for (int y = 0; y < LEVELS; y++) {
    for (int x = 0; x < LEVELS; x++) last[x] = t->pixels[y][x] != empty ? (int16_t)y : last[x];
    memcpy(t->below[y], last, sizeof last);
  }
  for (int y = LEVELS - 1; y >= 0; y--) {
    for (int x = 0; x < LEVELS; x++) next[x] = t->pixels[y][x] != empty ? (int16_t)y : next[x];
    memcpy(t->above[y], next, sizeof next);
  }
}

/* ---- one table row ------------------------------------------------------------ */

/* What a value column raises over a table row: its value nearest in y. */
typedef struct Parabola {
  int64_t place, height; /* x of the column, squared y distance; steps */
  uint32_t pixel;
} Parabola;

/* A texel's place on the fine scale; `i` counts from the side where bytes are 0. */
static int64_t get_place(const Transform *t, int i) {
  return 255 * (int64_t)(t->lut->spec.sampling == STY_SAMPLE_CENTRE ? 2 * i + 1 : i);
}

/* The parabolas over a row at y, one per column that isn't empty. Of two values
 * equally far the lower pixel counts. */
static int raise_parabolas(const Transform *t, int64_t y, Parabola *out) {
  const int64_t scale = t->measure.scale;
  const int row = y / scale < LEVELS ? (int)(y / scale) : LEVELS - 1;
  int count = 0;
  for (int x = 0; x < LEVELS; x++) {
    const int low = t->below[row][x], high = t->above[row + 1][x];
    if (low < 0 && high == LEVELS) continue;
    const int64_t down = low < 0 ? INT64_MAX : y - low * scale, up = high == LEVELS ? INT64_MAX : high * scale - y;
    const bool lower = down < up || (down == up && t->pixels[low][x] < t->pixels[high][x]);
    const int64_t distance = lower ? down : up;
    out[count++] = (Parabola){x * scale, distance * distance, t->pixels[lower ? low : high][x]};
  }
  return count;
}

/* Whether `middle` is nowhere as low as the lower of its neighbours. One that
 * touches the envelope in a single point stays: it may hold the lowest pixel. */
static bool is_hidden(const Parabola *left, const Parabola *middle, const Parabola *right) {
  /* left meets middle at a/2p, middle meets right at b/2q; hidden when b/q < a/p. */
  const int64_t p = middle->place - left->place, q = right->place - middle->place;
  const int64_t a = middle->height - left->height + p * (middle->place + left->place);
  const int64_t b = right->height - middle->height + q * (right->place + middle->place);
  return (__int128)b * p < (__int128)a * q;
}

/* Keeps those that are lowest somewhere. */
static int keep_envelope(Parabola *parabolas, int count) {
  int kept = 0;
  for (int i = 0; i < count; i++) {
    while (kept > 1 && is_hidden(&parabolas[kept - 2], &parabolas[kept - 1], &parabolas[i])) kept--;
    parabolas[kept++] = parabolas[i];
  }
  return kept;
}

static int64_t get_height(const Parabola *p, int64_t x) { return p->height + (x - p->place) * (x - p->place); }

/* Of parabolas equally high at x, from `first` on, the lowest pixel. */
static uint32_t break_tie(const Parabola *first, int64_t x, int64_t height) {
  uint32_t pixel = first->pixel;
  for (const Parabola *p = first + 1; get_height(p, x) == height; p++) pixel = p->pixel < pixel ? p->pixel : pixel;
  return pixel;
}

static void answer_row(const Transform *t, int j, double *heights) {
  Parabola envelope[LEVELS + 1];
  const int size = t->lut->spec.width;
  const int count = keep_envelope(envelope, raise_parabolas(t, get_place(t, size - 1 - j), envelope));
  envelope[count] = (Parabola){0, INT64_MAX / 2, empty}; /* higher than any, so that no end need be looked for */
  uint32_t *pixels = t->lut->pixels + (size_t)j * (size_t)size;
  float *errors = t->lut->errors + (size_t)j * (size_t)size;
  const Parabola *at = envelope;
  for (int i = 0; i < size; i++) {
    const int64_t x = get_place(t, i);
    int64_t height = get_height(at, x), next;
    while ((next = get_height(at + 1, x)) < height) {
      height = next;
      at++;
    }
    pixels[i] = next == height ? break_tie(at, x, height) : at->pixel;
    heights[i] = (double)height;
  }
  for (int i = 0; i < size; i++) errors[i] = (float)(sqrt(heights[i]) * t->measure.unit);
}

static StyStatus answer_rows(void *context, long block, StyError *error) {
  const Transform *t = context;
  const int size = t->lut->spec.width, end = ((int)block + 1) * ROWS;
  double *heights = malloc((size_t)size * sizeof *heights);
  if (!heights) return sty_fail_memory(error, "engine grid", (double)size * 8);
  for (int j = (int)block * ROWS; j < end && j < size; j++) answer_row(t, j, heights);
  free(heights);
  return STY_OK;
}

StyStatus sty_transform_sites(const StySites *sites, const StyMeasure *measure, StyLut *lut, const StyRun *run,
                              StyError *error) {
  Transform *t = malloc(sizeof *t);
  if (!t) return sty_fail_memory(error, "engine grid", sizeof *t);
  t->lut = lut;
  t->measure = *measure;
  lut->unique = fill_values(t, sites);
  find_neighbours(t);
  const StyStatus status = sty_parallel_for(run, (lut->spec.width + ROWS - 1) / ROWS, answer_rows, t, error);
  free(t);
  return status;
}
