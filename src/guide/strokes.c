#include "stylut/strokes.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "guide/pyramid.h"

/* What a pixel of a level says. */
typedef struct Sample {
  double color[3], luma, orientation[2], detail, line[2];
} Sample;

typedef struct Group {
  unsigned bit;
  int count; /* channels */
  const char *channels[3];
  size_t field; /* offset of `count` doubles in Sample */
} Group;

static const Group groups[STY_STROKE_GROUPS] = {
    {STY_STROKES_COLOUR, 3, {"R", "G", "B"}, offsetof(Sample, color)},
    {STY_STROKES_LUMA, 1, {"Y"}, offsetof(Sample, luma)},
    {STY_STROKES_ORIENTATION, 2, {"X", "Y"}, offsetof(Sample, orientation)},
    {STY_STROKES_DETAIL, 1, {"Y"}, offsetof(Sample, detail)},
    {STY_STROKES_LINE, 2, {"X", "Y"}, offsetof(Sample, line)},
};

const char *const sty_stroke_groups[STY_STROKE_GROUPS + 1] = {"color", "luma", "orientation", "detail", "line", NULL};

/* ---- one pixel ----------------------------------------------------------------- */

/* Sums over the pixels of a level that a sample is made of. */
typedef struct Sums {
  double weight, color[3], luma, detail;
  double vector[2]; /* detail times orientation: the gradient, turned */
  double tensor[2]; /* detail squared times line: the structure tensor but for its trace */
} Sums;

static void add_pixel(const StyLevel *level, int x, int y, double share, Sums *sums) {
  const size_t pixel = (size_t)y * (size_t)level->width + (size_t)x;
  if (!(level->planes[PLANE_WEIGHT][pixel] > 0)) return;
  const double ox = (double)level->planes[PLANE_UP][pixel], oy = -(double)level->planes[PLANE_RIGHT][pixel];
  sums->weight += share;
  for (int k = 0; k < 3; k++) sums->color[k] += share * (double)level->planes[PLANE_RED + k][pixel];
  sums->luma += share * (double)level->planes[PLANE_LUMA][pixel];
  sums->detail += share * sty_measure_detail(level, pixel);
  sums->vector[0] += share * ox;
  sums->vector[1] += share * oy;
  sums->tensor[0] += share * (ox * ox - oy * oy);
  sums->tensor[1] += share * (2 * ox * oy);
}

/* The pixel of the level that holds pixel (x, y) of the picture, or the four around its centre, by distance. */
static void gather(const StyLevel *level, int depth, int x, int y, bool smooth, Sums *sums) {
  if (!smooth) {
    add_pixel(level, x >> depth, y >> depth, 1, sums);
    return;
  }
  const double scale = ldexp(1, -depth), u = (x + 0.5) * scale - 0.5, v = (y + 0.5) * scale - 0.5;
  const int left = (int)floor(u), top = (int)floor(v);
  for (int j = 0; j < 2; j++)
    for (int i = 0; i < 2; i++) {
      const double share = (i ? u - left : 1 - (u - left)) * (j ? v - top : 1 - (v - top));
      const bool inside = left + i >= 0 && top + j >= 0 && left + i < level->width && top + j < level->height;
      if (inside && share > 0) add_pixel(level, left + i, top + j, share, sums);
    }
}

/* A line's unit vector from twice its angle, on the side that `towards` is on. */
static void halve_angle(const double line[2], const double towards[2], double out[2]) {
  if (line[0] >= 0) {
    out[0] = sqrt((1 + line[0]) / 2);
    out[1] = line[1] / (2 * out[0]);
  } else {
    out[1] = copysign(sqrt((1 - line[0]) / 2), line[1]);
    out[0] = line[1] / (2 * out[1]);
  }
  const double sign = out[0] * towards[0] + out[1] * towards[1] < 0 ? -1 : 1;
  for (int k = 0; k < 2; k++) out[k] *= sign;
}

static Sample finish_sample(const Sums *sums, double threshold) {
  Sample sample = {.luma = sums->luma / sums->weight, .detail = sums->detail / sums->weight};
  for (int k = 0; k < 3; k++) sample.color[k] = sums->color[k] / sums->weight;
  const double length = sqrt(sums->tensor[0] * sums->tensor[0] + sums->tensor[1] * sums->tensor[1]);
  if (!(length > 0) || sample.detail < threshold) return sample;
  for (int k = 0; k < 2; k++) sample.line[k] = sums->tensor[k] / length;
  halve_angle(sample.line, sums->vector, sample.orientation);
  return sample;
}

/* ---- the picture --------------------------------------------------------------- */

typedef struct Assembly {
  const StyPyramid *pyramid;
  const StyStrokeOptions *options;
  StyImage *guide;
} Assembly;

/* Into the planes of one level, which begin at `plane`; the next level's. */
static float *store_sample(const StyStrokeOptions *options, const Sample *sample, float *plane, size_t pixels,
                           size_t pixel) {
  for (int g = 0; g < STY_STROKE_GROUPS; g++) {
    if (!(options->groups & groups[g].bit)) continue;
    const double *values = (const double *)(const void *)((const char *)sample + groups[g].field);
    for (int c = 0; c < groups[g].count; c++, plane += pixels) plane[pixel] = (float)values[c];
  }
  return plane;
}

static StyStatus assemble_row(void *context, long y, StyError *error) {
  const Assembly *assembly = context;
  const StyStrokeOptions *options = assembly->options;
  const size_t pixels = sty_count_pixels(assembly->guide);
  const float *coverage = assembly->pyramid->levels[0].planes[PLANE_WEIGHT];
  (void)error;
  for (int x = 0; x < assembly->guide->width; x++) {
    const size_t pixel = (size_t)y * (size_t)assembly->guide->width + (size_t)x;
    if (!(coverage[pixel] > 0)) continue;
    assembly->guide->data[pixel] = coverage[pixel];
    float *plane = assembly->guide->data + pixels; /* behind A */
    for (int m = options->first; m < options->first + options->count; m++) {
      Sums sums = {0};
      gather(&assembly->pyramid->levels[m], m, x, (int)y, options->smooth, &sums);
      const Sample sample = finish_sample(&sums, options->threshold);
      plane = store_sample(options, &sample, plane, pixels, pixel);
    }
  }
  return STY_OK;
}

static StyStatus create_guide(const StyImage *picture, const StyStrokeOptions *options, StyImage **out,
                              StyError *error) {
  char names[STY_MAX_CHANNELS][32] = {"A"};
  const char *list[STY_MAX_CHANNELS] = {names[0]};
  int count = 1;
  for (int m = options->first; m < options->first + options->count; m++)
    for (int g = 0; g < STY_STROKE_GROUPS; g++)
      for (int c = 0; c < groups[g].count && (options->groups & groups[g].bit); c++, count++) {
        char number[16] = "";
        if (options->numbered) snprintf(number, sizeof number, "%d.", m);
        snprintf(names[count], sizeof names[count], "%s.%s%s", sty_stroke_groups[g], number, groups[g].channels[c]);
        list[count] = names[count];
      }
  return sty_create_image(picture->width, picture->height, count, list, 32, out, error);
}

static int count_channels(const StyStrokeOptions *options) {
  int count = 0;
  for (int g = 0; g < STY_STROKE_GROUPS; g++)
    if (options->groups & groups[g].bit) count += groups[g].count;
  return 1 + count * options->count;
}

static StyStatus check_options(const char *name, const StyImage *picture, const StyStrokeOptions *options,
                               StyError *error) {
  const int levels = sty_count_stroke_levels(picture->width, picture->height);
  const int last = options->first + options->count - 1;
  if (options->first < 0 || options->count < 1 || options->first >= levels || last >= levels)
    return sty_fail(error, STY_ERROR_USAGE, "%s: found a wish for level %d, expected 0 to %d for %dx%d pixels", name,
                    options->first < 0 ? options->first : last, levels - 1, picture->width, picture->height);
  if (!options->numbered && options->count > 1)
    return sty_fail(error, STY_ERROR_USAGE, "%s: found %d levels under the same names, expected them numbered", name,
                    options->count);
  if (count_channels(options) > STY_MAX_CHANNELS)
    return sty_fail(error, STY_ERROR_USAGE, "%s: found a wish for %d channels, expected fewer levels or groups: %d",
                    name, count_channels(options), STY_MAX_CHANNELS);
  return STY_OK;
}

static StyStatus measure_levels(const StyPyramid *pyramid, double threshold, StyStrokeFigures *out, StyError *error) {
  StyStatus status = STY_OK;
  StyStrokeFigures figures = {.count = pyramid->count};
  for (int m = 0; !status && m < pyramid->count; m++)
    status = sty_measure_level(&pyramid->levels[m], threshold, &figures.levels[m], error);
  if (!status) *out = figures;
  return status;
}

StyStatus sty_make_stroke_guide(const char *name, const StyImage *picture, const StyStrokeOptions *options,
                                const StyRun *run, StyStrokeFigures *figures, StyImage **out, StyError *error) {
  StyPyramid pyramid = {.count = 0};
  StyImage *guide = NULL;
  const StyRun quiet = {.threads = sty_get_threads(run)}; /* progress is that of the last, longest stage */
  StyStatus status = check_options(name, picture, options, error);
  if (!status) status = sty_build_pyramid(name, picture, options, &quiet, &pyramid, error);
  if (!status) status = create_guide(picture, options, &guide, error);
  Assembly assembly = {&pyramid, options, guide};
  if (!status) status = sty_parallel_for(run, picture->height, assemble_row, &assembly, error);
  if (!status && figures) status = measure_levels(&pyramid, options->threshold, figures, error);
  if (status)
    sty_destroy_image(&guide);
  else
    *out = guide;
  sty_destroy_pyramid(&pyramid);
  return status;
}
