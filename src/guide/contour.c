#include "guide/contour.h"

#include "guide/kernels.h"

const StyContourWeights sty_default_contour = {1, 1};

typedef struct Drawing {
  const StyContours *contours;
  const StyKernels *kernels;
  const float *coverage, *depth, *normal[3]; /* the sources' */
  float *strength;
} Drawing;

static void draw_row(const Drawing *drawing, long row) {
  const StyContours *contours = drawing->contours;
  const long width = contours->sources->width, height = contours->drawn->height;
  const bool first = row == 0 && contours->is_top, last = row + 1 == height && contours->is_bottom;
  StyOutlines outlines = {.width = (int)width,
                          .is_border = first || last,
                          .weights = contours->weights,
                          .footprint = &contours->footprint,
                          .strength = drawing->strength + row * width};
  const long middle = contours->first + row,
             rows[3] = {first ? middle : middle - 1, middle, last ? middle : middle + 1};
  for (int r = 0; r < 3; r++) {
    outlines.coverage[r] = drawing->coverage + rows[r] * width;
    outlines.depth[r] = drawing->depth + rows[r] * width;
    for (int k = 0; k < 3; k++) outlines.normal[r][k] = drawing->normal[k] + rows[r] * width;
  }
  drawing->kernels->draw_outlines(&outlines);
}

/* Rows that one thread draws in one go: as many as their handing over is nothing to. */
enum { ROWS = 32 };

static StyStatus draw_rows(void *context, long part, StyError *error) {
  (void)error;
  const Drawing *drawing = context;
  const long height = drawing->contours->drawn->height, end = (part + 1) * ROWS;
  for (long row = part * ROWS; row < end && row < height; row++) draw_row(drawing, row);
  return STY_OK;
}

void sty_draw_contours(const StyContours *contours, int threads) {
  const StyRun run = {.threads = threads};
  const StyImage *sources = contours->sources;
  Drawing drawing = {.contours = contours,
                     .kernels = sty_get_kernels(),
                     .coverage = sty_find_channel(sources, "A"),
                     .depth = sty_find_channel(sources, "depth.Z"),
                     .normal = {sty_find_channel(sources, "normal.X"), sty_find_channel(sources, "normal.Y"),
                                sty_find_channel(sources, "normal.Z")},
                     .strength = sty_find_channel(contours->drawn, "contour.Y")};
  sty_parallel_for(&run, (contours->drawn->height + ROWS - 1) / ROWS, draw_rows, &drawing, NULL);
}
