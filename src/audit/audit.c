#include "stylut/audit.h"

#include <math.h>
#include <stdlib.h>

enum { BYTES = 256 };

/* Lookups per texel and axis. */
static int get_samples(const StyLut *lut) { return lut->size <= 1024 ? 4 : 2; }

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
static double measure_angle(Vector a, Vector b) {
  const Vector cross = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  const double sine = sqrt(cross.x * cross.x + cross.y * cross.y + cross.z * cross.z);
  return atan2(sine, a.x * b.x + a.y * b.y + a.z * b.z) * (180 / M_PI);
}

typedef struct Guide {
  const float *covered, *x, *y;
} Guide;

static double measure_error(const Guide *guide, uint32_t pixel, const float g[2]) {
  if (!(guide->covered[pixel] > 0)) return 180;
  return measure_angle(reconstruct_normal(g[0], g[1]), reconstruct_normal(guide->x[pixel], guide->y[pixel]));
}

static int compare_doubles(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Errors in the order they were found, and where the largest is. */
typedef struct Tally {
  double *errors;
  size_t count;
  StyFigures figures;
} Tally;

static void add_error(Tally *tally, double angle, int i, int j, const float g[2], uint32_t pixel, int width) {
  if (tally->count == 0 || angle > tally->figures.max) {
    tally->figures.max = angle;
    tally->figures.texel[0] = i;
    tally->figures.texel[1] = j;
    tally->figures.value[0] = g[0];
    tally->figures.value[1] = g[1];
    tally->figures.source[0] = (int)(pixel % (uint32_t)width);
    tally->figures.source[1] = (int)(pixel / (uint32_t)width);
  }
  tally->errors[tally->count++] = angle;
}

static double get_percentile(const Tally *tally, double share) {
  const size_t rank = (size_t)ceil(share * (double)tally->count);
  return tally->errors[rank ? rank - 1 : 0];
}

static StyFigures finish_tally(Tally *tally) {
  double sum = 0;
  for (size_t i = 0; i < tally->count; i++) sum += tally->errors[i];
  qsort(tally->errors, tally->count, sizeof *tally->errors, compare_doubles);
  StyFigures figures = tally->figures;
  figures.mean = sum / (double)tally->count;
  figures.p50 = get_percentile(tally, 0.50);
  figures.p95 = get_percentile(tally, 0.95);
  figures.p99 = get_percentile(tally, 0.99);
  return figures;
}

static bool is_feasible(const float g[2]) { return g[0] * g[0] + g[1] * g[1] <= 1; }

/* Adds the error of the texel's answer to the guide value g. */
static void ask(const StyLut *lut, const Guide *guide, const float g[2], const int texel[2], Tally *tally) {
  const uint32_t pixel = lut->pixels[(size_t)texel[1] * (size_t)lut->size + (size_t)texel[0]];
  add_error(tally, measure_error(guide, pixel, g), texel[0], texel[1], g, pixel, lut->source_width);
}

/* Asks for samples x samples values spread over every texel's square, those on
 * the rim included whose own centre isn't feasible. */
static void ask_between_centres(const StyLut *lut, const Guide *guide, Tally *tally) {
  const int samples = get_samples(lut), asked = lut->size * samples;
  for (int b = 0; b < asked; b++)
    for (int a = 0; a < asked; a++) {
      const float g[2] = {(float)((a + 0.5) * 2 / asked - 1), (float)(1 - (b + 0.5) * 2 / asked)};
      if (is_feasible(g)) ask(lut, guide, g, (const int[2]){a / samples, b / samples}, tally);
    }
}

/* Asks for every byte guide there is. */
static void ask_for_bytes(const StyLut *lut, const Guide *guide, Tally *tally) {
  for (int b = 0; b < BYTES; b++)
    for (int a = 0; a < BYTES; a++) {
      const float g[2] = {(float)(2 * a - 255) / 255.0f, (float)(255 - 2 * b) / 255.0f};
      int texel[2];
      sty_find_texel(lut, g, texel);
      if (is_feasible(g)) ask(lut, guide, g, texel, tally);
    }
}

static size_t count_feasible(const StyLut *lut) {
  size_t count = 0;
  for (int j = 0; j < lut->size; j++)
    for (int i = 0; i < lut->size; i++) {
      float g[2];
      sty_get_texel_value(lut, i, j, g);
      count += is_feasible(g);
    }
  return count;
}

static void audit_texels(const StyLut *lut, const StyLut *exact, const Guide *guide, Tally *assignment,
                         StyAudit *audit) {
  size_t covered = 0;
  for (int j = 0; j < lut->size; j++)
    for (int i = 0; i < lut->size; i++) {
      const size_t texel = (size_t)j * (size_t)lut->size + (size_t)i;
      float g[2];
      sty_get_texel_value(lut, i, j, g);
      if (!is_feasible(g)) continue;
      audit->background += !(guide->covered[lut->pixels[texel]] > 0);
      covered += exact->errors[texel] <= audit->tolerance;
      ask(lut, guide, g, (const int[2]){i, j}, assignment);
    }
  audit->coverage = (double)covered / (double)audit->feasible;
}

StyStatus sty_audit_lut(const StyLut *lut, const StyLut *exact, const StyImage *guide, double tolerance, StyAudit *out,
                        StyError *error) {
  const Guide planes = {sty_find_channel(guide, "A"), sty_find_channel(guide, "normal.X"),
                        sty_find_channel(guide, "normal.Y")};
  if (!planes.covered || !planes.x || !planes.y)
    return sty_fail(error, STY_ERROR_INPUT,
                    "found a guide without normals, expected channels A, normal.X and normal.Y");
  if (exact->size != lut->size || exact->sampling != lut->sampling || exact->source_width != lut->source_width ||
      exact->source_height != lut->source_height)
    return sty_fail(error, STY_ERROR_INPUT,
                    "found an exact LUT of another size, sampling or source, expected the same as of the one audited");
  if (lut->source_width != guide->width || lut->source_height != guide->height)
    return sty_fail(error, STY_ERROR_INPUT,
                    "found a LUT for a source of %dx%d pixels, expected one for the guide's %dx%d", lut->source_width,
                    lut->source_height, guide->width, guide->height);
  StyAudit audit = {.size = lut->size, .sampling = lut->sampling, .tolerance = tolerance};
  audit.feasible = count_feasible(lut);
  if (audit.feasible == 0)
    return sty_fail(error, STY_ERROR_INPUT, "found no feasible texel in a LUT of size %d, expected size 3 or more",
                    lut->size);
  const bool bytes = lut->sampling == STY_SAMPLE_UNORM8;
  const size_t side = bytes ? BYTES : (size_t)(lut->size * get_samples(lut));
  Tally assignment = {.errors = malloc(audit.feasible * sizeof(double))};
  Tally lookup = {.errors = malloc(side * side * sizeof(double))};
  StyStatus status = STY_OK;
  if (!assignment.errors || !lookup.errors) {
    status = sty_fail_memory(error, "audit", (double)(side * side) * sizeof(double));
  } else {
    audit_texels(lut, exact, &planes, &assignment, &audit);
    if (bytes)
      ask_for_bytes(lut, &planes, &lookup);
    else
      ask_between_centres(lut, &planes, &lookup);
    audit.assignment = finish_tally(&assignment);
    audit.lookup = finish_tally(&lookup);
    *out = audit;
  }
  free(assignment.errors);
  free(lookup.errors);
  return status;
}
