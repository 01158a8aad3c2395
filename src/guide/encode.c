#include <math.h>

#include "stylut/guide.h"

StyStatus sty_encode_normals(const StyImage *guide, int bits, StyImage **out, StyError *error) {
  static const char *const names[] = {"R", "G", "B", "A"};
  static const char *const sources[] = {"normal.X", "normal.Y", "normal.Z"};
  const float *covered = sty_find_channel(guide, "A"), *planes[3];
  for (int c = 0; c < 3; c++) {
    planes[c] = sty_find_channel(guide, sources[c]);
    if (!planes[c] || !covered)
      return sty_fail(error, STY_ERROR_INPUT, "found no channel %s, expected a guide with normals", sources[c]);
  }
  StyImage *image = NULL;
  const StyStatus status = sty_create_image(guide->width, guide->height, 4, names, bits, &image, error);
  if (status) return status;
  const size_t pixels = sty_count_pixels(guide);
  const float top = bits == 8 ? 255.0f : 65535.0f;
  for (size_t i = 0; i < pixels; i++) {
    if (!(covered[i] > 0)) continue;
    for (size_t c = 0; c < 3; c++) {
      const float half = fminf(fmaxf(planes[c][i] * 0.5f + 0.5f, 0.0f), 1.0f);
      image->data[c * pixels + i] = (float)lrintf(half * top) / top;
    }
    image->data[3 * pixels + i] = 1;
  }
  *out = image;
  return STY_OK;
}
