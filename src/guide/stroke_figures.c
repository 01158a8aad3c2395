#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "guide/pyramid.h"

enum { BINS = 1 << 16 };

/* Numbers that aren't negative come in the order of their bits. */
static uint32_t get_bits(float value) {
  uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits;
}

/* The bin that the rank-th value (from 1) is in, by `shift` bits of those values whose upper bits are `upper`;
 * *rank becomes the rank within the bin. */
static uint32_t find_bin(const float *values, size_t count, int shift, uint32_t upper, size_t *rank, size_t *bins) {
  memset(bins, 0, BINS * sizeof *bins);
  for (size_t i = 0; i < count; i++) {
    const uint32_t bits = get_bits(values[i]);
    if (shift || bits >> 16 == upper) bins[(bits >> shift) & (BINS - 1)]++;
  }
  uint32_t bin = 0;
  while (*rank > bins[bin]) *rank -= bins[bin++];
  return bin;
}

/* By nearest rank, in two passes of counting: pictures may hold a quarter of a billion pixels. */
static double find_percentile(const float *values, size_t count, double share, size_t *bins) {
  size_t rank = (size_t)ceil(share * (double)count);
  if (rank < 1) rank = 1;
  const uint32_t upper = find_bin(values, count, 16, 0, &rank, bins);
  const uint32_t bits = upper << 16 | find_bin(values, count, 0, upper, &rank, bins);
  float value;
  memcpy(&value, &bits, sizeof value);
  return (double)value;
}

StyStatus sty_measure_level(const StyLevel *level, double threshold, StyStrokeLevel *out, StyError *error) {
  const size_t pixels = sty_count_level_pixels(level);
  StyStrokeLevel figures = {.width = level->width, .height = level->height};
  float *details = malloc(pixels * sizeof *details);
  size_t *bins = malloc(BINS * sizeof *bins);
  if (!details || !bins) {
    free(details);
    free(bins);
    return sty_fail_memory(error, "figures", (double)pixels * sizeof *details);
  }
  for (size_t i = 0; i < pixels; i++) {
    if (!(level->planes[PLANE_WEIGHT][i] > 0)) continue;
    const double detail = sty_measure_detail(level, i);
    details[figures.covered++] = (float)detail;
    figures.flat += !(detail > 0 && detail >= threshold);
  }
  if (figures.covered) {
    figures.p50 = find_percentile(details, figures.covered, 0.5, bins);
    figures.p90 = find_percentile(details, figures.covered, 0.9, bins);
    figures.p99 = find_percentile(details, figures.covered, 0.99, bins);
    figures.max = find_percentile(details, figures.covered, 1, bins);
  }
  free(details);
  free(bins);
  *out = figures;
  return STY_OK;
}
