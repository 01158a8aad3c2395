#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "audit/luma.h"
#include "stylut/measure.h"

enum { RADIUS = 5, TAPS = 2 * RADIUS + 1 };
enum { MEAN_A, MEAN_B, SQUARE_A, SQUARE_B, PRODUCT, MOMENTS };

static void make_window(double window[TAPS]) {
  const double sigma = 1.5;
  double sum = 0;
  for (int i = 0; i < TAPS; i++) sum += window[i] = exp(-(i - RADIUS) * (i - RADIUS) / (2 * sigma * sigma));
  for (int i = 0; i < TAPS; i++) window[i] /= sum;
}

static float get_moment(int moment, float a, float b) {
  const float values[MOMENTS] = {a, b, a * a, b * b, a * b};
  return values[moment];
}

static double compare_windows(const float *moments, size_t pixels, size_t i) {
  const double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
  const double a = (double)moments[MEAN_A * pixels + i], b = (double)moments[MEAN_B * pixels + i];
  const double variance_a = (double)moments[SQUARE_A * pixels + i] - a * a;
  const double variance_b = (double)moments[SQUARE_B * pixels + i] - b * b;
  const double covariance = (double)moments[PRODUCT * pixels + i] - a * b;
  return (2 * a * b + c1) * (2 * covariance + c2) / ((a * a + b * b + c1) * (variance_a + variance_b + c2));
}

/* Over the windows that lie inside the picture. */
static double average(const float *moments, int width, int height) {
  const size_t pixels = (size_t)width * (size_t)height;
  double sum = 0;
  for (int y = RADIUS; y < height - RADIUS; y++)
    for (int x = RADIUS; x < width - RADIUS; x++)
      sum += compare_windows(moments, pixels, (size_t)y * (size_t)width + (size_t)x);
  return sum / ((double)(width - 2 * RADIUS) * (double)(height - 2 * RADIUS));
}

StyStatus sty_measure_ssim(int width, int height, const float *a, const float *b, const StyRun *run, double *out,
                           StyError *error) {
  const size_t pixels = (size_t)width * (size_t)height;
  if (width < TAPS || height < TAPS) {
    *out = memcmp(a, b, 3 * pixels * sizeof *a) == 0;
    return STY_OK;
  }
  float *moments = malloc((MOMENTS + 1) * pixels * sizeof *moments);
  if (!moments) return sty_fail_memory(error, "similarity", (double)((MOMENTS + 1) * pixels * sizeof *moments));
  double window[TAPS];
  make_window(window);
  const Filter filter = {RADIUS, window, window};
  float *plane = moments + MOMENTS * pixels;
  StyStatus status = STY_OK;
  for (int m = 0; !status && m < MOMENTS; m++) {
    for (size_t i = 0; i < pixels; i++)
      plane[i] = get_moment(m, sty_get_luma(a, pixels, i), sty_get_luma(b, pixels, i));
    status = sty_filter_plane(plane, width, height, &filter, run, moments + (size_t)m * pixels, error);
  }
  if (!status) *out = average(moments, width, height);
  free(moments);
  return status;
}
