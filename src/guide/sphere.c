#include <math.h>

#include "guide/contour.h"
#include "guide/kernels.h"

/* What is the same all over the sphere: its ids, and what surroundings of light 1 do. */
static StySamples get_plain_samples(void) {
  StySamples samples = {.coverage = {0}};
  StyLane *const ones[] = {&samples.coverage, &samples.object, &samples.style, &samples.luma, &samples.curvature};
  StyLane *const colours[] = {samples.albedo, samples.paths.full, samples.paths.lde, samples.paths.ld12e};
  for (size_t c = 0; c < sizeof ones / sizeof *ones; c++) EACH_LANE(*ones[c])[i] = 1;
  for (size_t c = 0; c < sizeof colours / sizeof *colours; c++)
    for (int k = 0; k < 3; k++) EACH_LANE colours[c][k][i] = 1;
  return samples;
}

/* The pixel's point of the sphere; false: beside it. */
static bool find_point(const StyImage *image, int column, int row, double out[3]) {
  out[0] = (column + 0.5) / image->width * 2 - 1;
  out[1] = 1 - (row + 0.5) / image->height * 2;
  const double rest = 1 - out[0] * out[0] - out[1] * out[1];
  out[2] = sqrt(fmax(rest, 0));
  return rest >= 0;
}

static void fill_sphere(const StyGuide *guide, unsigned groups) {
  const StyImage *image = guide->image;
  const StyKernels *kernels = sty_get_kernels();
  StySamples samples = get_plain_samples();
  for (int y = 0; y < image->height; y += STY_BLOCK_HEIGHT)
    for (int x = 0; x < image->width; x += STY_BLOCK_WIDTH) {
      int valid[STY_LANES];
      EACH_LANE {
        double point[3], uv[2] = {0, 0};
        valid[i] = find_point(image, x + i % STY_BLOCK_WIDTH, y + i / STY_BLOCK_WIDTH, point) ? -1 : 0;
        if (valid[i] && groups & STY_GUIDE_UV) sty_get_sphere_uv(point, 1, uv);
        for (int k = 0; k < 3; k++) samples.normal[k][i] = samples.position[k][i] = point[k];
        for (int k = 0; k < 2; k++) samples.uv[k][i] = uv[k];
        samples.depth[i] = 1 - point[2];
      }
      kernels->set_samples(guide, x, y, valid, &samples);
    }
}

static StyStatus draw_contours(const StyGuide *guide, StyError *error) {
  StyGuide sources;
  const StyImage *image = guide->image;
  StyStatus status = sty_create_guide(image->width, image->height, STY_CONTOUR_SOURCES, &sources, error);
  if (status) return status;
  fill_sphere(&sources, STY_CONTOUR_SOURCES);
  const StyContours contours = {.sources = sources.image,
                                .drawn = guide->image,
                                .is_top = true,
                                .is_bottom = true,
                                .weights = &sty_default_contour,
                                .footprint = {2.0 / image->height, 0}};
  status = sty_draw_contours(&contours, NULL, error);
  sty_destroy_image(&sources.image);
  return status;
}

StyStatus sty_make_sphere_guide(int width, int height, unsigned groups, StyImage **out, StyError *error) {
  StyGuide guide;
  if (groups & STY_GUIDE_MOTION)
    return sty_fail(error, STY_ERROR_USAGE, "channel motion: found with a sphere that stands still, expected a scene");
  StyStatus status = sty_create_guide(width, height, groups, &guide, error);
  if (status) return status;
  fill_sphere(&guide, groups);
  if (groups & STY_GUIDE_CONTOUR) status = draw_contours(&guide, error);
  if (status)
    sty_destroy_image(&guide.image);
  else
    *out = guide.image;
  return status;
}
