#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "audit/luma.h"
#include "stylut/measure.h"

enum { SIDE = STY_FLAT_WINDOW, REACH = SIDE / 2, LAGS = 2 * REACH + 1 };

/* A window's luma, and sums of it and of its squares over all rectangles from the corner. */
typedef struct Window {
  uint8_t luma[SIDE][SIDE];
  uint32_t sums[SIDE + 1][SIDE + 1], squares[SIDE + 1][SIDE + 1];
} Window;

static bool is_flat(const StyShot *shot, int x0, int y0) {
  uint8_t least[3] = {255, 255, 255}, most[3] = {0, 0, 0};
  for (int y = y0; y < y0 + SIDE; y++) {
    const size_t row = (size_t)y * (size_t)shot->width;
    for (int x = x0; x < x0 + SIDE; x++) {
      const uint8_t *texel = shot->guide + 4 * (row + (size_t)x);
      if (!texel[3]) return false;
      for (int c = 0; c < 3; c++) {
        if (texel[c] < least[c]) least[c] = texel[c];
        if (texel[c] > most[c]) most[c] = texel[c];
        if (most[c] - least[c] > STY_FLAT_STEPS) return false;
      }
    }
  }
  return true;
}

static void fill_window(const StyShot *shot, int x0, int y0, Window *out) {
  const size_t pixels = (size_t)shot->width * (size_t)shot->height;
  for (int i = 0; i <= SIDE; i++) out->sums[0][i] = out->squares[0][i] = out->sums[i][0] = out->squares[i][0] = 0;
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++) {
      const size_t i = (size_t)(y0 + y) * (size_t)shot->width + (size_t)(x0 + x);
      const uint32_t luma = out->luma[y][x] = (uint8_t)(sty_get_luma(shot->rgb, pixels, i) * 255 + 0.5f);
      out->sums[y + 1][x + 1] = luma + out->sums[y][x + 1] + out->sums[y + 1][x] - out->sums[y][x];
      out->squares[y + 1][x + 1] = luma * luma + out->squares[y][x + 1] + out->squares[y + 1][x] - out->squares[y][x];
    }
}

static double add_up(const uint32_t sums[SIDE + 1][SIDE + 1], int x0, int y0, int x1, int y1) {
  return (double)(sums[y1][x1] - sums[y0][x1] - sums[y1][x0] + sums[y0][x0]);
}

/* Correlation of the window with itself, moved by (dx, dy >= 0), over what overlaps. */
static double correlate(const Window *window, int dx, int dy) {
  const int x0 = dx < 0 ? -dx : 0, x1 = dx < 0 ? SIDE : SIDE - dx, y1 = SIDE - dy;
  uint32_t products = 0;
  for (int y = 0; y < y1; y++) {
    const uint8_t *a = window->luma[y], *b = window->luma[y + dy] + dx;
    for (int x = x0; x < x1; x++) products += (uint32_t)a[x] * b[x];
  }
  const double n = (double)(x1 - x0) * y1;
  const double a = add_up(window->sums, x0, 0, x1, y1), b = add_up(window->sums, x0 + dx, dy, x1 + dx, SIDE);
  const double spread_a = n * add_up(window->squares, x0, 0, x1, y1) - a * a;
  const double spread_b = n * add_up(window->squares, x0 + dx, dy, x1 + dx, SIDE) - b * b;
  return spread_a < n * n || spread_b < n * n ? 0 : (n * products - a * b) / sqrt(spread_a * spread_b);
}

static bool is_peak(const double table[LAGS][LAGS], int row, int column) {
  for (int y = row - 1; y <= row + 1; y++)
    for (int x = column - 1; x <= column + 1; x++)
      if (table[y][x] > table[row][column]) return false;
  return true;
}

/* How far a peak rises above the lowest value, not below 0, on the straight way to it from no lag: a slope is like
 * itself next door without repeating anything. */
static double measure_rise(const double table[LAGS][LAGS], int row, int column) {
  const int dx = column - REACH, dy = row - REACH, steps = abs(dx) > abs(dy) ? abs(dx) : abs(dy);
  double lowest = table[row][column];
  for (int i = 1; i < steps; i++) {
    const double value =
        table[REACH + (int)lround((double)dy * i / steps)][REACH + (int)lround((double)dx * i / steps)];
    lowest = fmin(lowest, value);
  }
  return table[row][column] - fmax(lowest, 0);
}

static double find_peak(const Window *window) {
  double table[LAGS][LAGS], highest = 0;
  for (int dy = 0; dy <= REACH; dy++)
    for (int dx = -REACH; dx <= REACH; dx++)
      table[REACH + dy][REACH + dx] = table[REACH - dy][REACH - dx] = correlate(window, dx, dy);
  for (int row = REACH; row < LAGS - 1; row++)
    for (int column = 1; column < LAGS - 1; column++) {
      const bool far = row - REACH >= STY_LEAST_LAG || abs(column - REACH) >= STY_LEAST_LAG;
      if (far && table[row][column] > highest && is_peak(table, row, column))
        highest = fmax(highest, measure_rise(table, row, column));
    }
  return fmin(highest, 1);
}

typedef struct Job {
  const StyShot *shot;
  int across;
  double *peaks; /* of each window; -1 where it isn't flat */
} Job;

static StyStatus measure_window(void *context, long i, StyError *error) {
  const Job *job = context;
  const int x0 = (int)(i % job->across) * REACH, y0 = (int)(i / job->across) * REACH;
  job->peaks[i] = -1;
  if (!is_flat(job->shot, x0, y0)) return STY_OK;
  Window *window = malloc(sizeof *window);
  if (!window) return sty_fail_memory(error, "repetition", sizeof *window);
  fill_window(job->shot, x0, y0, window);
  job->peaks[i] = find_peak(window);
  free(window);
  return STY_OK;
}

void sty_mark_flat(const StyShot *shot, uint8_t *mask) {
  const size_t width = (size_t)shot->width;
  memset(mask, 0, width * (size_t)shot->height);
  for (int y0 = 0; y0 + SIDE <= shot->height; y0 += REACH)
    for (int x0 = 0; x0 + SIDE <= shot->width; x0 += REACH)
      if (is_flat(shot, x0, y0))
        for (int y = y0; y < y0 + SIDE; y++) memset(mask + (size_t)y * width + (size_t)x0, 255, SIDE);
}

static int compare_keys(const void *a, const void *b) {
  const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
  return (x > y) - (x < y);
}

static size_t count_distinct(uint64_t *keys, size_t count) {
  size_t distinct = 0;
  qsort(keys, count, sizeof *keys, compare_keys);
  for (size_t i = 0; i < count; i++) distinct += i == 0 || keys[i] != keys[i - 1];
  return distinct;
}

/* Pixels of flat areas, and how many of them show one source pixel. */
static StyStatus measure_area(const StyShot *shot, StyRepetition *out, StyError *error) {
  const size_t pixels = (size_t)shot->width * (size_t)shot->height;
  uint8_t *mask = malloc(pixels);
  uint64_t *keys = malloc(pixels * sizeof *keys);
  size_t covered = 0, flat = 0, shown = 0;
  if (mask && keys) {
    sty_mark_flat(shot, mask);
    for (size_t i = 0; i < pixels; i++) {
      const StyMatch *match = &shot->matches[i];
      covered += shot->guide[4 * i + 3] > 0;
      flat += mask[i] > 0;
      if (mask[i] && match->level != STY_LEVEL_NONE)
        keys[shown++] =
            (uint64_t)match->style << 40 | (uint64_t)match->layer << 32 | (uint64_t)match->y << 16 | match->x;
    }
    out->flat = covered ? (double)flat / (double)covered : 0;
    out->shown = shown ? (double)shown / (double)count_distinct(keys, shown) : 0;
  }
  const bool failed = !mask || !keys;
  free(mask);
  free(keys);
  return failed ? sty_fail_memory(error, "repetition", (double)pixels * (1 + sizeof *keys)) : STY_OK;
}

StyStatus sty_measure_repetition(const StyShot *shot, const StyRun *run, StyRepetition *out, StyError *error) {
  const int across = shot->width / REACH - 1, down = shot->height / REACH - 1;
  *out = (StyRepetition){0};
  if (across < 1 || down < 1) return STY_OK;
  const size_t count = (size_t)across * (size_t)down;
  double *peaks = malloc(count * sizeof *peaks);
  if (!peaks) return sty_fail_memory(error, "repetition", (double)(count * sizeof *peaks));
  Job job = {shot, across, peaks};
  const StyStatus status = sty_parallel_for(run, (long)count, measure_window, &job, error);
  for (size_t i = 0; !status && i < count; i++) {
    if (peaks[i] < 0) continue;
    out->windows++;
    out->mean += peaks[i];
    out->largest = fmax(out->largest, peaks[i]);
  }
  free(peaks);
  if (status || !out->windows) return status;
  out->mean /= (double)out->windows;
  return measure_area(shot, out, error);
}
