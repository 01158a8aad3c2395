/* Low frequencies of an exemplar: a Gaussian over what is covered, rows first, then columns. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "stylut/pack.h"

enum { CHANNELS = 4 }; /* R, G, B times weight, and weight */

typedef struct Blur {
  int width, height, reach;
  float *kernel; /* reach + 1 */
  float *planes, *rows;
} Blur;

static void make_kernel(double sigma, int reach, float *kernel) {
  for (int i = 0; i <= reach; i++) kernel[i] = (float)exp(-0.5 * i * i / (sigma * sigma));
}

/* Of `count` values `step` apart the weighted sum around place `at`; what lies beyond the ends has no weight. */
static float sum_around(const Blur *blur, const float *values, int count, size_t step, int at) {
  const int from = at < blur->reach ? -at : -blur->reach;
  const int to = count - 1 - at < blur->reach ? count - 1 - at : blur->reach;
  float sum = 0;
  for (int o = from; o <= to; o++) sum += blur->kernel[o < 0 ? -o : o] * values[(size_t)(at + o) * step];
  return sum;
}

static StyStatus blur_row(void *context, long i, StyError *error) {
  const Blur *blur = context;
  (void)error;
  const float *row = blur->planes + (size_t)i * (size_t)blur->width;
  float *out = blur->rows + (size_t)i * (size_t)blur->width;
  for (int x = 0; x < blur->width; x++) out[x] = sum_around(blur, row, blur->width, 1, x);
  return STY_OK;
}

static StyStatus blur_across_rows(void *context, long i, StyError *error) {
  const Blur *blur = context;
  (void)error;
  const size_t width = (size_t)blur->width, pixels = width * (size_t)blur->height;
  const size_t plane = (size_t)i / (size_t)blur->height * pixels;
  const int y = (int)(i % blur->height);
  for (size_t x = 0; x < width; x++)
    blur->planes[plane + (size_t)y * width + x] = sum_around(blur, blur->rows + plane + x, blur->height, width, y);
  return STY_OK;
}

static void fill_planes(const uint8_t *exemplar, const StyImage *guide, float *planes) {
  const size_t pixels = sty_count_pixels(guide);
  const float *covered = sty_find_channel(guide, "A");
  for (size_t i = 0; i < pixels; i++) {
    const float weight = covered[i] > 0 ? exemplar[4 * i + 3] : 0;
    for (size_t c = 0; c < 3; c++) planes[c * pixels + i] = weight * exemplar[4 * i + c];
    planes[3 * pixels + i] = weight;
  }
}

/* Where nothing covered is in reach the exemplar stays. */
static void write_base(const uint8_t *exemplar, const float *planes, size_t pixels, uint8_t *out) {
  memcpy(out, exemplar, 4 * pixels);
  for (size_t i = 0; i < pixels; i++)
    for (size_t c = 0; c < 3 && planes[3 * pixels + i] > 0; c++)
      out[4 * i + c] = (uint8_t)fminf(255, planes[c * pixels + i] / planes[3 * pixels + i] + 0.5f);
}

StyStatus sty_make_base(const uint8_t *exemplar, const StyImage *guide, double sigma, const StyRun *run, uint8_t **out,
                        StyError *error) {
  const size_t pixels = sty_count_pixels(guide), plane = CHANNELS * pixels * sizeof(float);
  Blur blur = {.width = guide->width, .height = guide->height, .reach = (int)ceil(3 * sigma)};
  blur.kernel = malloc(((size_t)blur.reach + 1) * sizeof *blur.kernel);
  blur.planes = malloc(plane);
  blur.rows = malloc(plane);
  uint8_t *base = malloc(4 * pixels);
  StyStatus status = STY_OK;
  if (!blur.kernel || !blur.planes || !blur.rows || !base) status = sty_fail_memory(error, "base", 2.0 * (double)plane);
  if (!status) {
    make_kernel(sigma, blur.reach, blur.kernel);
    fill_planes(exemplar, guide, blur.planes);
    status = sty_parallel_for(run, (long)CHANNELS * blur.height, blur_row, &blur, error);
  }
  if (!status) status = sty_parallel_for(run, (long)CHANNELS * blur.height, blur_across_rows, &blur, error);
  if (!status) {
    write_base(exemplar, blur.planes, pixels, base);
    *out = base;
  } else {
    free(base);
  }
  free(blur.kernel);
  free(blur.planes);
  free(blur.rows);
  return status;
}
