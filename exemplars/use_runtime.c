/* The least a program needs to wear a style: libstylut_rt, five files in memory,
 * two calls. Usage: use_runtime BUNDLE > picture.ppm */
#include <math.h>

#include "read_bundle.h"

enum { SIDE = 256 };

/* A frame of our own: a ring seen from above, normals as bytes n/2+1/2. */
static void draw_guide(uint8_t *guide) {
  for (int i = 0; i < SIDE * SIDE; i++) {
    const double x = (i % SIDE + 0.5) / SIDE * 2 - 1, y = 1 - (i / SIDE + 0.5) / SIDE * 2, r = sqrt(x * x + y * y);
    const double across = (r - 0.6) / 0.3; /* -1 at the inner rim, 1 at the outer */
    if (fabs(across) >= 1) continue;       /* coverage stays 0 */
    const double n[3] = {x / r * across, y / r * across, sqrt(1 - across * across)};
    for (int c = 0; c < 3; c++) guide[4 * i + c] = (uint8_t)(n[c] * 127.5 + 128);
    guide[4 * i + 3] = 255;
  }
}

int main(int argc, char **argv) {
  static uint8_t guide[4 * SIDE * SIDE], picture[4 * SIDE * SIDE];
  static StyMatch matches[SIDE * SIDE];
  StyBlob files[STY_BUNDLE_FILES];
  const StyBundle bundle = open_bundle(argc > 1 ? argv[1] : ".", files);
  draw_guide(guide);
  const StyFrame frame = {.width = SIDE, .height = SIDE, .guide = guide, .style = 1};
  const StyRect all = {0, 0, SIDE, SIDE};
  require(sty_transfer_frame(&bundle, &frame, all, matches));
  require(sty_blend_frame(&bundle, &frame, all, matches, 8, picture));
  close_files(files);
  printf("P6 %d %d 255\n", SIDE, SIDE);
  for (int i = 0; i < SIDE * SIDE; i++) fwrite(picture + 4 * i, 1, 3, stdout);
  return 0;
}
