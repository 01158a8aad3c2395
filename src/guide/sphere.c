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

/* True where the pixel shows the sphere: then what it shows is noted as sample i. */
static bool look_at_pixel(const StyImage *image, int column, int row, unsigned groups, int i, StySamples *samples) {
  double point[3], uv[2] = {0, 0};
  if (column >= image->width || !find_point(image, column, row, point)) return false;
  if (groups & STY_GUIDE_UV) sty_get_sphere_uv(point, 1, uv);
  for (int k = 0; k < 3; k++) samples->normal[k][i] = samples->position[k][i] = point[k];
  for (int k = 0; k < 2; k++) samples->uv[k][i] = uv[k];
  samples->depth[i] = 1 - point[2];
  return true;
}

static void fill_sphere(const StyGuide *guide, unsigned groups) {
  const StyKernels *kernels = sty_get_kernels();
  StySamples samples = get_plain_samples();
  StyStrip strip;
  for (int y = 0; y < guide->image->height; y += STY_BLOCK_HEIGHT)
    for (int x0 = 0; x0 < guide->image->width; x0 += STY_STRIP_WIDTH) {
      for (int x = 0; x < STY_STRIP_WIDTH; x += STY_BLOCK_WIDTH) {
        int valid[STY_LANES];
        EACH_LANE {
          const int column = x0 + x + i % STY_BLOCK_WIDTH, row = y + i / STY_BLOCK_WIDTH;
          valid[i] = look_at_pixel(guide->image, column, row, groups, i, &samples) ? -1 : 0;
        }
        kernels->set_samples(&guide->channels, x, valid, &samples, &strip);
      }
      sty_write_strip(&strip, x0, y, guide);
    }
  sty_finish_strips();
}

static StyStatus draw_contours(const StyGuide *guide, StyError *error) {
  StyGuide sources;
  const StyImage *image = guide->image;
  const StyStatus status = sty_create_guide(image->width, image->height, STY_CONTOUR_SOURCES, &sources, error);
  if (status) return status;
  fill_sphere(&sources, STY_CONTOUR_SOURCES);
  const StyContours contours = {.sources = sources.image,
                                .drawn = guide->image,
                                .is_top = true,
                                .is_bottom = true,
                                .weights = &sty_default_contour,
                                .footprint = {2.0 / image->height, 0}};
  sty_draw_contours(&contours, 1);
  sty_destroy_image(&sources.image);
  return STY_OK;
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
