#include "guide/pyramid.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double largest_value = 1e30; /* room for sums and squares in float */

/* Where a picture's colours are. */
typedef struct Source {
  const char *name;
  const StyImage *image;
  char names[3][STY_MAX_NAME];
  const float *planes[3];
  const float *alpha; /* NULL: none */
  bool decode, encode;
} Source;

/* A level, and what it is filled from: the level below, or the picture. */
typedef struct Filling {
  StyLevel *level;
  const StyLevel *below;
  const Source *source;
} Filling;

/* ---- colours ------------------------------------------------------------------- */

/* sRGB's transfer function (IEC 61966-2-1), odd beyond 0 so that no value is lost. */
static double decode_srgb(double value) {
  const double v = fabs(value);
  return copysign(v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4), value);
}

static double encode_srgb(double value) {
  const double v = fabs(value);
  return copysign(v <= 0.0031308 ? v * 12.92 : 1.055 * pow(v, 1 / 2.4) - 0.055, value);
}

static bool find_planes(Source *source, const char *layer, const char *const suffixes[3]) {
  bool all = true;
  for (int k = 0; k < 3; k++) {
    snprintf(source->names[k], sizeof source->names[k], "%s%s%s", layer ? layer : "", layer ? "." : "", suffixes[k]);
    source->planes[k] = sty_find_channel(source->image, source->names[k]);
    all = all && source->planes[k];
  }
  return all;
}

static StyStatus find_source(const char *name, const StyImage *image, const StyStrokeOptions *options, Source *out,
                             StyError *error) {
  const char *kind = sty_find_attribute(image, "stylut:kind"), *layer = options->layer;
  if (kind) return sty_fail(error, STY_ERROR_INPUT, "%s: found stylut:kind = %s, expected a picture", name, kind);
  *out = (Source){.name = name, .image = image, .alpha = sty_find_channel(image, "A")};
  out->decode = image->bits < 32 && !options->srgb;
  out->encode = image->bits == 32 && options->srgb;
  if (find_planes(out, layer, (const char *const[3]){"R", "G", "B"}) ||
      find_planes(out, layer, (const char *const[3]){"Y", "Y", "Y"}))
    return STY_OK;
  const char *before = layer ? layer : "", *dot = layer ? "." : "";
  return sty_fail(error, STY_ERROR_INPUT, "%s: found no colours, expected channels %s%sR, %s%sG and %s%sB, or %s%sY",
                  name, before, dot, before, dot, before, dot, before, dot);
}

static StyStatus fail_value(const Source *source, const char *channel, float value, size_t pixel, const char *expected,
                            StyError *error) {
  const size_t width = (size_t)source->image->width;
  return sty_fail(error, STY_ERROR_INPUT, "%s: found %s = %g at pixel (%zu, %zu), expected %s", source->name, channel,
                  (double)value, pixel % width, pixel / width, expected);
}

static StyStatus read_pixel(const Source *source, size_t pixel, double colour[3], double *weight, StyError *error) {
  const float alpha = source->alpha ? source->alpha[pixel] : 1;
  if (isnan(alpha)) return fail_value(source, "A", alpha, pixel, "a coverage from 0 to 1", error);
  *weight = alpha > 0 ? fmin((double)alpha, 1) : 0;
  for (int k = 0; k < 3 && *weight > 0; k++) {
    const double value = (double)source->planes[k][pixel];
    if (!(fabs(value) <= largest_value))
      return fail_value(source, source->names[k], source->planes[k][pixel], pixel, "a finite value within 1e+30",
                        error);
    colour[k] = source->decode ? decode_srgb(value) : source->encode ? encode_srgb(value) : value;
  }
  return STY_OK;
}

/* ---- levels -------------------------------------------------------------------- */

static void set_pixel(StyLevel *level, size_t pixel, const double colour[3], double weight) {
  static const double rec709[3] = {0.2126, 0.7152, 0.0722}; /* eq. 4.3 */
  double luma = 0;
  for (int k = 0; k < 3; k++) {
    level->planes[PLANE_RED + k][pixel] = (float)colour[k];
    luma += rec709[k] * (double)(float)colour[k];
  }
  level->planes[PLANE_LUMA][pixel] = (float)luma;
  level->planes[PLANE_WEIGHT][pixel] = (float)weight;
}

static StyStatus fill_first_row(void *context, long y, StyError *error) {
  const Filling *filling = context;
  for (int x = 0; x < filling->level->width; x++) {
    const size_t pixel = (size_t)y * (size_t)filling->level->width + (size_t)x;
    double colour[3] = {0, 0, 0}, weight = 0;
    const StyStatus status = read_pixel(filling->source, pixel, colour, &weight, error);
    if (status) return status;
    if (weight > 0) set_pixel(filling->level, pixel, colour, weight);
  }
  return STY_OK;
}

/* Eq. 4.2 with each pixel's share of what is there as its weight; all 1/4 inside an opaque picture. */
static void average_pixels(const StyLevel *below, int x, int y, double colour[3], double *weight) {
  for (int j = 2 * y; j < 2 * y + 2 && j < below->height; j++)
    for (int i = 2 * x; i < 2 * x + 2 && i < below->width; i++) {
      const size_t pixel = (size_t)j * (size_t)below->width + (size_t)i;
      const double share = (double)below->planes[PLANE_WEIGHT][pixel];
      *weight += share;
      for (int k = 0; k < 3; k++) colour[k] += share * (double)below->planes[PLANE_RED + k][pixel];
    }
  for (int k = 0; k < 3 && *weight > 0; k++) colour[k] /= *weight;
}

static StyStatus fill_row(void *context, long y, StyError *error) {
  const Filling *filling = context;
  (void)error;
  for (int x = 0; x < filling->level->width; x++) {
    double colour[3] = {0, 0, 0}, weight = 0;
    average_pixels(filling->below, x, (int)y, colour, &weight);
    if (weight > 0) set_pixel(filling->level, (size_t)y * (size_t)filling->level->width + (size_t)x, colour, weight);
  }
  return STY_OK;
}

/* ---- gradients ----------------------------------------------------------------- */

/* NULL for a pixel that isn't there. */
static const float *find_luma(const StyLevel *level, int x, int y) {
  if (x < 0 || y < 0 || x >= level->width || y >= level->height) return NULL;
  const size_t pixel = (size_t)y * (size_t)level->width + (size_t)x;
  return level->planes[PLANE_WEIGHT][pixel] > 0 ? &level->planes[PLANE_LUMA][pixel] : NULL;
}

/* The slope of luma at (x, y) along (dx, dy): central where both neighbours are there. */
static bool find_slope(const StyLevel *level, int x, int y, int dx, int dy, double *slope) {
  const float *behind = find_luma(level, x - dx, y - dy), *ahead = find_luma(level, x + dx, y + dy);
  const float *here = behind && ahead ? NULL : find_luma(level, x, y);
  if (behind && ahead)
    *slope = ((double)*ahead - (double)*behind) / 2;
  else if (here && ahead)
    *slope = (double)*ahead - (double)*here;
  else if (here && behind)
    *slope = (double)*here - (double)*behind;
  else
    return false;
  return true;
}

/* One of eq. 4.5's kernels: three slopes side by side, weighed 1, 2, 1. */
static double apply_sobel(const StyLevel *level, int x, int y, int dx, int dy) {
  double sum = 0, weight = 0, slope;
  for (int side = -1; side <= 1; side++) {
    if (!find_slope(level, x + side * abs(dy), y + side * abs(dx), dx, dy, &slope)) continue;
    sum += (side ? 1 : 2) * slope;
    weight += side ? 1 : 2;
  }
  return weight > 0 ? sum / weight : 0;
}

static StyStatus measure_gradient_row(void *context, long y, StyError *error) {
  const StyLevel *level = ((const Filling *)context)->level;
  (void)error;
  for (int x = 0; x < level->width; x++) {
    const size_t pixel = (size_t)y * (size_t)level->width + (size_t)x;
    if (!(level->planes[PLANE_WEIGHT][pixel] > 0)) continue;
    level->planes[PLANE_RIGHT][pixel] = (float)apply_sobel(level, x, (int)y, 1, 0);
    level->planes[PLANE_UP][pixel] = (float)apply_sobel(level, x, (int)y, 0, -1); /* row 0 is the top */
  }
  return STY_OK;
}

/* ---- the whole ----------------------------------------------------------------- */

static StyStatus create_level(int width, int height, StyLevel *out, StyError *error) {
  StyLevel level = {.width = width, .height = height};
  const size_t pixels = sty_count_level_pixels(&level);
  float *memory = calloc(pixels * PLANE_COUNT, sizeof *memory);
  if (!memory) return sty_fail_memory(error, "multiscale buffers", (double)pixels * PLANE_COUNT * sizeof *memory);
  for (int k = 0; k < PLANE_COUNT; k++) level.planes[k] = memory + (size_t)k * pixels;
  *out = level;
  return STY_OK;
}

static StyStatus add_level(StyPyramid *pyramid, const Source *source, const StyRun *run, StyError *error) {
  const StyLevel *below = pyramid->count ? &pyramid->levels[pyramid->count - 1] : NULL;
  StyLevel *level = &pyramid->levels[pyramid->count];
  const int width = below ? (below->width + 1) / 2 : source->image->width;
  const int height = below ? (below->height + 1) / 2 : source->image->height;
  StyStatus status = create_level(width, height, level, error);
  if (status) return status;
  pyramid->count++;
  Filling filling = {level, below, source};
  status = sty_parallel_for(run, height, below ? fill_row : fill_first_row, &filling, error);
  return status ? status : sty_parallel_for(run, height, measure_gradient_row, &filling, error);
}

int sty_count_stroke_levels(int width, int height) {
  int count = 1;
  for (int side = width > height ? width : height; side > 1; side = (side + 1) / 2) count++;
  return count;
}

StyStatus sty_build_pyramid(const char *name, const StyImage *picture, const StyStrokeOptions *options,
                            const StyRun *run, StyPyramid *out, StyError *error) {
  StyPyramid pyramid = {.count = 0};
  const int count = sty_count_stroke_levels(picture->width, picture->height);
  Source source;
  StyStatus status = find_source(name, picture, options, &source, error);
  while (!status && pyramid.count < count) status = add_level(&pyramid, &source, run, error);
  if (status)
    sty_destroy_pyramid(&pyramid);
  else
    *out = pyramid;
  return status;
}

void sty_destroy_pyramid(StyPyramid *pyramid) {
  for (int m = 0; m < pyramid->count; m++) free(pyramid->levels[m].planes[0]);
  pyramid->count = 0;
}

double sty_measure_detail(const StyLevel *level, size_t pixel) {
  const double right = (double)level->planes[PLANE_RIGHT][pixel], up = (double)level->planes[PLANE_UP][pixel];
  return sqrt(right * right + up * up);
}
