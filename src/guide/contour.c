#include "guide/contour.h"

#include <math.h>

const StyContourWeights sty_default_contour = {1, 1};

/* A guide's planes that outlines are made of. */
typedef struct Planes {
  const StyImage *image;
  const float *coverage, *depth, *normal[3];
  float *contour;
} Planes;

/* The way of the pixel's depth from the line between two neighbours; infinite beside a miss. */
static double leave_line(const Planes *planes, size_t pixel, size_t before, size_t after) {
  if (planes->coverage[before] == 0 || planes->coverage[after] == 0) return INFINITY;
  if (before == pixel || after == pixel) return 0;
  return fabs(((double)planes->depth[before] + (double)planes->depth[after]) / 2 - (double)planes->depth[pixel]);
}

static double get_turn(const Planes *planes, size_t pixel, size_t other) {
  if (planes->coverage[other] == 0) return 0;
  double cosine = 0;
  for (int k = 0; k < 3; k++) cosine += (double)planes->normal[k][pixel] * (double)planes->normal[k][other];
  return 1 - cosine;
}

/* `around` is the pixel's neighbours left, right, above and below, or itself at the image's border. */
static double get_strength(const Planes *planes, size_t pixel, const size_t around[4], const StyContourWeights *weights,
                           double footprint) {
  double gap = 0, turn = 0;
  for (int axis = 0; axis < 2; axis++) {
    const size_t before = around[2 * axis], after = around[2 * axis + 1];
    gap = fmax(gap, leave_line(planes, pixel, before, after));
    turn = fmax(turn, fmax(get_turn(planes, pixel, before), get_turn(planes, pixel, after)));
  }
  const double depth = fmin(gap / (footprint * STY_CONTOUR_SPAN), 1);
  return fmin(fmax(weights->depth * depth + weights->normal * turn, 0), 1);
}

typedef struct Drawing {
  Planes planes;
  const StyContourWeights *weights;
  const StyFootprint *footprint;
} Drawing;

static StyStatus draw_row(void *context, long row, StyError *error) {
  (void)error;
  const Drawing *drawing = context;
  const Planes *planes = &drawing->planes;
  const size_t width = (size_t)planes->image->width, start = (size_t)row * width;
  const size_t up = row > 0 ? width : 0, down = row + 1 < planes->image->height ? width : 0;
  for (size_t x = 0; x < width; x++) {
    const size_t i = start + x, around[4] = {i - (x > 0), i + (x + 1 < width), i - up, i + down};
    if (planes->coverage[i] == 0) continue;
    const double footprint = drawing->footprint->constant + drawing->footprint->slope * (double)planes->depth[i];
    planes->contour[i] = (float)get_strength(planes, i, around, drawing->weights, footprint);
  }
  return STY_OK;
}

StyStatus sty_draw_contours(const StyGuide *guide, const StyContourWeights *weights, const StyFootprint *footprint,
                            const StyRun *run, StyError *error) {
  const StyImage *image = guide->image;
  Drawing drawing = {
      {image,
       guide->coverage,
       sty_find_channel(image, "depth.Z"),
       {sty_find_channel(image, "normal.X"), sty_find_channel(image, "normal.Y"), sty_find_channel(image, "normal.Z")},
       sty_find_channel(image, "contour.Y")},
      weights,
      footprint};
  return sty_parallel_for(run, image->height, draw_row, &drawing, error);
}
