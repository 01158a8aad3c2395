#include <math.h>

#include "guide/channels.h"

StyStatus sty_make_sphere_guide(int width, int height, unsigned groups, StyImage **out, StyError *error) {
  StyGuide guide;
  StyStatus status = sty_create_guide(width, height, groups, &guide, error);
  if (status != STY_OK) return status;
  for (int j = 0; j < height; j++) {
    const double y = 1 - (j + 0.5) / height * 2;
    for (int i = 0; i < width; i++) {
      const double x = (i + 0.5) / width * 2 - 1;
      const double rest = 1 - x * x - y * y;
      if (rest < 0) continue;
      const double z = sqrt(rest);
      const StySample sample = {.normal = {x, y, z},
                                .depth = 1 - z,
                                .position = {x, y, z},
                                .object = 1,
                                .style = 1,
                                .albedo = {1, 1, 1},
                                .luma = 1};
      sty_set_sample(&guide, (size_t)j * (size_t)width + (size_t)i, &sample);
    }
  }
  *out = guide.image;
  return STY_OK;
}
