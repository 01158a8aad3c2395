#include "audit/figures.h"

#include <math.h>
#include <stdlib.h>

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

StyStatus sty_open_tally(size_t capacity, StyTally *out, StyError *error) {
  *out = (StyTally){.samples = malloc((capacity + 1) * sizeof *out->samples), .capacity = capacity};
  return out->samples ? STY_OK : sty_fail_memory(error, "audit", (double)capacity * sizeof *out->samples);
}

void sty_close_tally(StyTally *tally) {
  free(tally->samples);
  *tally = (StyTally){0};
}

void sty_add_error(StyTally *tally, double angle, double weight, const int texel[2], const float g[2], uint32_t pixel,
                   int source_width) {
  if (!(weight > 0)) return;
  if (tally->count == 0 || angle > tally->figures.max) {
    tally->figures.max = angle;
    for (int k = 0; k < 2; k++) {
      tally->figures.texel[k] = texel[k];
      tally->figures.value[k] = g[k];
    }
    tally->figures.source[0] = (int)(pixel % (uint32_t)source_width);
    tally->figures.source[1] = (int)(pixel / (uint32_t)source_width);
  }
  tally->samples[tally->count++] = (StySample){angle, weight};
}

static int compare_samples(const void *a, const void *b) {
  const StySample *x = a, *y = b;
  if (x->error != y->error) return (x->error > y->error) - (x->error < y->error);
  return (x->weight > y->weight) - (x->weight < y->weight);
}

static int get_error_bin(double error) {
  if (!(error >= STY_LEAST_ERROR)) return 0;
  const int bin = 1 + (int)floor(log10(error / STY_LEAST_ERROR) * STY_ERROR_BINS_A_DECADE);
  return bin < STY_ERROR_BINS ? bin : STY_ERROR_BINS - 1;
}

StyFigures sty_finish_tally(StyTally *tally) {
  double weight = 0, sum = 0;
  for (size_t i = 0; i < tally->count; i++) {
    weight += tally->samples[i].weight;
    sum += tally->samples[i].weight * tally->samples[i].error;
  }
  qsort(tally->samples, tally->count, sizeof *tally->samples, compare_samples);
  StyFigures figures = tally->figures;
  figures.mean = sum / weight;
  for (size_t i = 0; i < tally->count; i++)
    figures.shares[get_error_bin(tally->samples[i].error)] += tally->samples[i].weight / weight;
  const double shares[] = {0.50, 0.95, 0.99};
  double *const percentiles[] = {&figures.p50, &figures.p95, &figures.p99};
  for (int k = 0; k < 3; k++) {
    /* Nearest rank; the margin keeps rounding of the sum from asking for one more. */
    const double wanted = shares[k] * weight * (1 - 1e-12);
    double reached = 0;
    size_t i = 0;
    while (i + 1 < tally->count && (reached += tally->samples[i].weight) < wanted) i++;
    *percentiles[k] = tally->samples[i].error;
  }
  return figures;
}
