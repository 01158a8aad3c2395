#include <math.h>

#include "guide/channels.h"
#include "guide/contour.h"
#include "guide/rays.h"

static void fill_sphere(const StyGuide *guide, unsigned groups) {
  const int width = guide->image->width, height = guide->image->height;
  for (int j = 0; j < height; j++) {
    const double y = 1 - (j + 0.5) / height * 2;
    for (int i = 0; i < width; i++) {
      const double x = (i + 0.5) / width * 2 - 1;
      const double rest = 1 - x * x - y * y;
      if (rest < 0) continue;
      const double z = sqrt(rest);
      StySample sample = {.normal = {x, y, z},
                          .depth = 1 - z,
                          .position = {x, y, z},
                          .object = 1,
                          .style = 1,
                          .albedo = {1, 1, 1},
                          .luma = 1,
                          .curvature = 1,
                          .paths = {.full = {1, 1, 1}, .lde = {1, 1, 1}, .ld12e = {1, 1, 1}}};
      if (groups & STY_GUIDE_UV) sty_get_sphere_uv(sample.normal, 1, sample.uv);
      sty_set_sample(guide, (size_t)j * (size_t)width + (size_t)i, &sample);
    }
  }
}

StyStatus sty_make_sphere_guide(int width, int height, unsigned groups, StyImage **out, StyError *error) {
  StyGuide guide;
  if (groups & STY_GUIDE_MOTION)
    return sty_fail(error, STY_ERROR_USAGE, "channel motion: found with a sphere that stands still, expected a scene");
  const unsigned contour = groups & STY_GUIDE_CONTOUR;
  StyStatus status = sty_create_guide(width, height, contour ? groups | STY_CONTOUR_SOURCES : groups, &guide, error);
  if (status) return status;
  fill_sphere(&guide, groups);
  const StyFootprint footprint = {2.0 / height, 0};
  if (contour) status = sty_draw_contours(&guide, &sty_default_contour, &footprint, NULL, error);
  if (!status) status = sty_select_channels(&guide.image, 0, height, groups, error);
  if (status)
    sty_destroy_image(&guide.image);
  else
    *out = guide.image;
  return status;
}
