/* LDR-FLIP: a colour pipeline (what the eye filters away at this distance, then a colour difference) and a feature
 * pipeline (edges and points that one picture has), the second as the exponent of the first. Names and numbers are the
 * paper's. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "audit/luma.h"
#include "stylut/measure.h"

static const double pi = 3.14159265358979323846;
static const double pixels_per_degree = 67;
static const double white_point[3] = {0.950428545377181, 1, 1.088900370798128};

enum { MOST_TAPS = 64 };

/* ---- colours ---- */

static double decode_srgb(double c) { return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4); }

static void multiply(const double m[3][3], const double v[3], double out[3]) {
  for (int i = 0; i < 3; i++) out[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
}

/* Linear sRGB to XYZ over the white point. */
static void get_relative_xyz(const double rgb[3], double out[3]) {
  static const double m[3][3] = {
      {10135552 / 24577794.0, 8788810 / 24577794.0, 4435075 / 24577794.0},
      {2613072 / 12288897.0, 8788810 / 12288897.0, 887015 / 12288897.0},
      {1425312 / 73733382.0, 8788810 / 73733382.0, 70074185 / 73733382.0},
  };
  multiply(m, rgb, out);
  for (int i = 0; i < 3; i++) out[i] /= white_point[i];
}

static void get_ycxcz(const double srgb[3], double out[3]) {
  const double linear[3] = {decode_srgb(srgb[0]), decode_srgb(srgb[1]), decode_srgb(srgb[2])};
  double xyz[3];
  get_relative_xyz(linear, xyz);
  out[0] = 116 * xyz[1] - 16;
  out[1] = 500 * (xyz[0] - xyz[1]);
  out[2] = 200 * (xyz[1] - xyz[2]);
}

/* Back to linear sRGB, clamped to what a screen shows. */
static void get_shown_rgb(const double ycxcz[3], double out[3]) {
  static const double m[3][3] = {{3.241003232976358, -1.537398969488785, -0.498615881996363},
                                 {-0.969224252202516, 1.875929983695176, 0.041554226340085},
                                 {0.055639419851975, -0.204011206123910, 1.057148977187533}};
  const double y = (ycxcz[0] + 16) / 116;
  const double xyz[3] = {(y + ycxcz[1] / 500) * white_point[0], y, (y - ycxcz[2] / 200) * white_point[2]};
  multiply(m, xyz, out);
  for (int i = 0; i < 3; i++) out[i] = fmin(fmax(out[i], 0), 1);
}

static double bend(double t) { return t > 0.008856 ? cbrt(t) : 7.787 * t + 16.0 / 116; }

/* CIELAB with Hunt's adjustment: darker colours are less colourful. */
static void get_hunt_lab(const double rgb[3], double out[3]) {
  double xyz[3];
  get_relative_xyz(rgb, xyz);
  const double x = bend(xyz[0]), y = bend(xyz[1]), z = bend(xyz[2]);
  out[0] = 116 * y - 16;
  out[1] = 0.01 * out[0] * 500 * (x - y);
  out[2] = 0.01 * out[0] * 200 * (y - z);
}

/* HyAB to the power q_c. */
static double get_distance(const double a[3], const double b[3]) {
  return pow(fabs(a[0] - b[0]) + hypot(a[1] - b[1], a[2] - b[2]), 0.7);
}

/* Errors up to p_c of the largest (green against blue) take up p_t of the range. */
static double remap(double difference) {
  static const double p_c = 0.4, p_t = 0.95;
  double green[3], blue[3];
  get_hunt_lab((const double[3]){0, 1, 0}, green);
  get_hunt_lab((const double[3]){0, 0, 1}, blue);
  const double most = get_distance(green, blue), knee = p_c * most;
  return difference < knee ? p_t / knee * difference : p_t + (difference - knee) / (most - knee) * (1 - p_t);
}

/* ---- filters ---- */

/* exp(-pi^2 d^2 / b), its values and their sum; d in degrees. */
static double make_gaussian(double b, int radius, double *taps) {
  double sum = 0;
  for (int i = -radius; i <= radius; i++) {
    const double d = i / pixels_per_degree;
    sum += taps[i + radius] = exp(-pi * pi * d * d / b);
  }
  return sum;
}

static void scale_taps(double *taps, int radius, double factor) {
  for (int i = 0; i < 2 * radius + 1; i++) taps[i] *= factor;
}

/* One plane under the eye's contrast sensitivity: one or two Gaussians (weight a, width b), which sum to 1. */
static StyStatus blur(const float *in, int width, int height, const double a[2], const double b[2], const StyRun *run,
                      float *scratch, float *out, StyError *error) {
  const int radius = (int)ceil(3 * sqrt(0.04 / (2 * pi * pi)) * pixels_per_degree);
  const size_t pixels = (size_t)width * (size_t)height;
  double taps[2][MOST_TAPS], weight[2], total = 0;
  for (int g = 0; g < 2; g++) {
    const double sum = make_gaussian(b[g], radius, taps[g]);
    scale_taps(taps[g], radius, 1 / sum);
    total += weight[g] = a[g] * sqrt(pi / b[g]) * sum * sum;
  }
  StyStatus status = sty_filter_plane(in, width, height, &(Filter){radius, taps[0], taps[0]}, run, out, error);
  if (status || weight[1] == 0) return status;
  status = sty_filter_plane(in, width, height, &(Filter){radius, taps[1], taps[1]}, run, scratch, error);
  for (size_t i = 0; !status && i < pixels; i++)
    out[i] = (float)((weight[0] * (double)out[i] + weight[1] * (double)scratch[i]) / total);
  return status;
}

/* Positive taps sum to 1 and negative ones to -1. */
static void balance(double *taps, int radius) {
  double sums[2] = {0, 0};
  for (int i = 0; i < 2 * radius + 1; i++) sums[taps[i] < 0] += fabs(taps[i]);
  for (int i = 0; i < 2 * radius + 1; i++) taps[i] /= sums[taps[i] < 0];
}

typedef struct Detectors {
  int radius;
  double gaussian[MOST_TAPS], edge[MOST_TAPS], point[MOST_TAPS];
} Detectors;

static void make_detectors(Detectors *out) {
  static const double w = 0.082;
  const double sigma = 0.5 * w * pixels_per_degree;
  const int radius = out->radius = (int)ceil(3 * sigma);
  double sum = 0;
  for (int i = -radius; i <= radius; i++) {
    const double g = exp(-i * i / (2 * sigma * sigma));
    sum += out->gaussian[i + radius] = g;
    out->edge[i + radius] = -i * g;
    out->point[i + radius] = (i * i / (sigma * sigma) - 1) * g;
  }
  scale_taps(out->gaussian, radius, 1 / sum);
  balance(out->edge, radius);
  balance(out->point, radius);
}

/* ---- a picture's parts ---- */

enum { Y, CX, CZ, EDGE_X, EDGE_Y, POINT_X, POINT_Y, SCRATCH, PLANES };

static void convert(const float *rgb, size_t pixels, float *planes) {
  for (size_t i = 0; i < pixels; i++) {
    const double srgb[3] = {(double)rgb[i], (double)rgb[pixels + i], (double)rgb[2 * pixels + i]};
    double ycxcz[3];
    get_ycxcz(srgb, ycxcz);
    for (size_t c = 0; c < 3; c++) planes[c * pixels + i] = (float)ycxcz[c];
  }
}

static StyStatus detect(const float *luma, int width, int height, const StyRun *run, float *planes, StyError *error) {
  const size_t pixels = (size_t)width * (size_t)height;
  Detectors d;
  make_detectors(&d);
  const Filter filters[] = {{d.radius, d.edge, d.gaussian},
                            {d.radius, d.gaussian, d.edge},
                            {d.radius, d.point, d.gaussian},
                            {d.radius, d.gaussian, d.point}};
  StyStatus status = STY_OK;
  for (size_t f = 0; !status && f < 4; f++)
    status = sty_filter_plane(luma, width, height, &filters[f], run, planes + (EDGE_X + f) * pixels, error);
  return status;
}

/* Features of Y as a share of white; then each of Y, Cx, Cz as the eye sees it. */
static StyStatus prepare(const float *rgb, int width, int height, const StyRun *run, float *planes, StyError *error) {
  static const double a[3][2] = {{1, 0}, {1, 0}, {34.1, 13.5}},
                      b[3][2] = {{0.0047, 1e-5}, {0.0053, 1e-5}, {0.04, 0.025}};
  const size_t pixels = (size_t)width * (size_t)height;
  float *scratch = planes + SCRATCH * pixels, *copy = planes + PLANES * pixels;
  convert(rgb, pixels, planes);
  for (size_t i = 0; i < pixels; i++) scratch[i] = (planes[i] + 16) / 116;
  StyStatus status = detect(scratch, width, height, run, planes, error);
  for (size_t c = 0; !status && c < 3; c++) {
    float *plane = planes + c * pixels;
    for (size_t i = 0; i < pixels; i++) copy[i] = plane[i];
    status = blur(copy, width, height, a[c], b[c], run, scratch, plane, error);
  }
  return status;
}

/* ---- the difference ---- */

static void get_seen_lab(const float *planes, size_t pixels, size_t i, double out[3]) {
  const double ycxcz[3] = {(double)planes[i], (double)planes[CX * pixels + i], (double)planes[CZ * pixels + i]};
  double rgb[3];
  get_shown_rgb(ycxcz, rgb);
  get_hunt_lab(rgb, out);
}

static double get_strength(const float *planes, size_t pixels, size_t i, size_t first) {
  return hypot((double)planes[first * pixels + i], (double)planes[(first + 1) * pixels + i]);
}

typedef struct Pair {
  int width;
  size_t pixels;
  const float *planes[2];
  double *rows;
} Pair;

static StyStatus compare_row(void *context, long y, StyError *error) {
  (void)error;
  const Pair *pair = context;
  double sum = 0;
  for (int x = 0; x < pair->width; x++) {
    const size_t i = (size_t)y * (size_t)pair->width + (size_t)x;
    double lab[2][3], edge[2], point[2];
    for (int k = 0; k < 2; k++) {
      get_seen_lab(pair->planes[k], pair->pixels, i, lab[k]);
      edge[k] = get_strength(pair->planes[k], pair->pixels, i, EDGE_X);
      point[k] = get_strength(pair->planes[k], pair->pixels, i, POINT_X);
    }
    const double feature = sqrt(fmax(fabs(edge[0] - edge[1]), fabs(point[0] - point[1])) / sqrt(2));
    sum += pow(remap(get_distance(lab[0], lab[1])), 1 - feature);
  }
  pair->rows[y] = sum;
  return STY_OK;
}

StyStatus sty_measure_flip(int width, int height, const float *reference, const float *test, const StyRun *run,
                           double *out, StyError *error) {
  const size_t pixels = (size_t)width * (size_t)height, values = (PLANES + 1) * pixels;
  float *planes = malloc(2 * values * sizeof *planes);
  double *rows = malloc((size_t)height * sizeof *rows);
  StyStatus status = planes && rows ? STY_OK : sty_fail_memory(error, "FLIP", (double)(2 * values * sizeof *planes));
  if (!status) status = prepare(reference, width, height, run, planes, error);
  if (!status) status = prepare(test, width, height, run, planes + values, error);
  const Pair pair = {width, pixels, {planes, planes ? planes + values : NULL}, rows};
  if (!status) status = sty_parallel_for(run, height, compare_row, (void *)(uintptr_t)&pair, error);
  if (!status) {
    double sum = 0;
    for (int y = 0; y < height; y++) sum += rows[y];
    *out = sum / (double)pixels;
  }
  free(planes);
  free(rows);
  return status;
}
