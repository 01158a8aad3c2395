/* The least a program needs to wear a style: libstylut_rt, five files in memory,
 * two calls. Usage: use_runtime BUNDLE > picture.ppm */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "stylut/runtime.h"

enum { SIDE = 256 };

static StyBlob read_blob(const char *folder, const char *name) {
  char path[4096];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "rb");
  long size = file && fseek(file, 0, SEEK_END) == 0 ? ftell(file) : 0;
  void *data = size > 0 ? malloc((size_t)size) : NULL;
  if (!data || fseek(file, 0, SEEK_SET) != 0 || fread(data, 1, (size_t)size, file) != (size_t)size) {
    fprintf(stderr, "use_runtime: cannot read %s\n", path);
    exit(2);
  }
  fclose(file);
  return (StyBlob){data, (size_t)size};
}

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
  static const char *const names[STY_BUNDLE_FILES] = {"exemplars.ktx2", "guides.ktx2", "luts.ktx2", "params.ktx2",
                                                      "jitter.ktx2"};
  static uint8_t guide[4 * SIDE * SIDE], picture[4 * SIDE * SIDE];
  static StyMatch matches[SIDE * SIDE];
  StyBlob files[STY_BUNDLE_FILES];
  StyBundle bundle;
  for (int i = 0; i < STY_BUNDLE_FILES; i++) files[i] = read_blob(argc > 1 ? argv[1] : ".", names[i]);
  StyRuntimeStatus status = sty_open_bundle(files, &bundle, NULL);
  draw_guide(guide);
  const StyFrame frame = {.width = SIDE, .height = SIDE, .guide = guide, .style = 1};
  const StyRect all = {0, 0, SIDE, SIDE};
  if (!status) status = sty_transfer_frame(&bundle, &frame, all, matches);
  if (!status) status = sty_blend_frame(&bundle, &frame, all, matches, 8, picture);
  for (int i = 0; i < STY_BUNDLE_FILES; i++) free((void *)files[i].data); /* not before the last use of `bundle` */
  if (status) return fprintf(stderr, "use_runtime: %s\n", sty_describe_runtime_status(status)), 3;
  printf("P6 %d %d 255\n", SIDE, SIDE);
  for (int i = 0; i < SIDE * SIDE; i++) fwrite(picture + 4 * i, 1, 3, stdout);
  return 0;
}
