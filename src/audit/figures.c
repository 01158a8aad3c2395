#include "audit/figures.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

StyStatus sty_find_planes(const StyImage *guide, StyGuidePlanes *out, StyError *error) {
  *out = (StyGuidePlanes){sty_find_channel(guide, "A"), sty_find_channel(guide, "normal.X"),
                          sty_find_channel(guide, "normal.Y")};
  if (out->covered && out->x && out->y) return STY_OK;
  return sty_fail(error, STY_ERROR_INPUT, "found a guide without normals, expected channels A, normal.X and normal.Y");
}

/* ---- angles ------------------------------------------------------------------- */

typedef struct Vector {
  double x, y, z;
} Vector;

static Vector reconstruct_normal(double gx, double gy) {
  const double squared = gx * gx + gy * gy;
  if (squared <= 1) return (Vector){gx, gy, sqrt(1 - squared)};
  const double length = sqrt(squared);
  return (Vector){gx / length, gy / length, 0};
}

/* atan2 keeps its precision for small and large angles alike. */
double sty_measure_angle(const float p[2], const float q[2]) {
  const Vector a = reconstruct_normal(p[0], p[1]), b = reconstruct_normal(q[0], q[1]);
  const Vector cross = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  const double sine = sqrt(cross.x * cross.x + cross.y * cross.y + cross.z * cross.z);
  return atan2(sine, a.x * b.x + a.y * b.y + a.z * b.z) * (180 / M_PI);
}

double sty_measure_pixel(const StyGuidePlanes *guide, uint32_t pixel, const float g[2]) {
  if (!(guide->covered[pixel] > 0)) return 180;
  return sty_measure_angle(g, (const float[2]){guide->x[pixel], guide->y[pixel]});
}

/* ---- tallies ------------------------------------------------------------------ */

/* Percentiles are found without sorting: errors are not negative, so that their bits order as they
 * do. One pass bins them by the upper half of the bits, a second one those of a bin by the lower. */
enum { HALF = 16, HALVES = 1 << HALF };

static uint32_t get_bits(float error) {
  uint32_t bits;
  memcpy(&bits, &error, sizeof bits);
  return bits;
}

StyStatus sty_open_tally(size_t capacity, StyTally *out, StyError *error) {
  *out = (StyTally){.samples = malloc((capacity + 1) * sizeof *out->samples),
                    .bins = calloc((size_t)2 * HALVES, sizeof *out->bins),
                    .capacity = capacity};
  if (out->samples && out->bins) return STY_OK;
  sty_close_tally(out);
  return sty_fail_memory(error, "audit", (double)capacity * sizeof *out->samples);
}

void sty_close_tally(StyTally *tally) {
  free(tally->samples);
  free(tally->bins);
  *tally = (StyTally){0};
}

static int get_error_bin(double error) {
  if (!(error >= STY_LEAST_ERROR)) return 0;
  const int bin = 1 + (int)floor(log10(error / STY_LEAST_ERROR) * STY_ERROR_BINS_A_DECADE);
  return bin < STY_ERROR_BINS ? bin : STY_ERROR_BINS - 1;
}

void sty_add_error(StyTally *tally, double angle, double weight, const int texel[2], const float g[2], uint32_t pixel,
                   int source_width) {
  if (!(weight > 0)) return;
  /* All figures are of the rounded values: a percentile must not exceed the largest. */
  const StySample sample = {(float)angle, (float)weight};
  const double error = (double)sample.error, counts = (double)sample.weight;
  if (tally->count == 0 || error > tally->figures.max) {
    tally->figures.max = error;
    for (int k = 0; k < 2; k++) {
      tally->figures.texel[k] = texel[k];
      tally->figures.value[k] = g[k];
    }
    tally->figures.source[0] = (int)(pixel % (uint32_t)source_width);
    tally->figures.source[1] = (int)(pixel / (uint32_t)source_width);
  }
  tally->samples[tally->count++] = sample;
  tally->sum += counts * error;
  tally->weight += counts;
  tally->bins[get_bits(sample.error) >> HALF] += counts;
  tally->figures.shares[get_error_bin(error)] += counts;
}

/* The bin in which the weight `*before` the first grows past `wanted`; then it is that before this bin. */
static uint32_t find_bin(const double *bins, double wanted, double *before) {
  uint32_t last = 0;
  for (uint32_t b = 0; b < HALVES; b++) {
    if (!(bins[b] > 0)) continue;
    if (*before + bins[b] >= wanted) return b;
    last = b;
    *before += bins[b];
  }
  *before -= bins[last]; /* rounding has kept the sum below what is wanted */
  return last;
}

/* The nearest rank. */
static double find_percentile(const StyTally *tally, double share) {
  /* The margin keeps rounding of the sum from asking for one more. */
  const double wanted = share * tally->weight * (1 - 1e-12);
  double before = 0, *lower = tally->bins + HALVES;
  const uint32_t upper = find_bin(tally->bins, wanted, &before);
  memset(lower, 0, HALVES * sizeof *lower);
  for (size_t i = 0; i < tally->count; i++) {
    const uint32_t bits = get_bits(tally->samples[i].error);
    if (bits >> HALF == upper) lower[bits % HALVES] += (double)tally->samples[i].weight;
  }
  const uint32_t bits = upper << HALF | find_bin(lower, wanted, &before);
  float error;
  memcpy(&error, &bits, sizeof error);
  return (double)error;
}

StyFigures sty_finish_tally(StyTally *tally) {
  StyFigures figures = tally->figures;
  figures.mean = tally->sum / tally->weight;
  for (int b = 0; b < STY_ERROR_BINS; b++) figures.shares[b] /= tally->weight;
  figures.p50 = find_percentile(tally, 0.50);
  figures.p95 = find_percentile(tally, 0.95);
  figures.p99 = find_percentile(tally, 0.99);
  return figures;
}
