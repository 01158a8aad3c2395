/* Pictures as files, through OpenImageIO, as tables, and as guides of other programs. */
#include <math.h>

#include "fuzz.h"
#include "stylut/foreign.h"
#include "stylut/image_io.h"
#include "stylut/lut.h"

/* Readers are first tried by the name's ending. */
static const char *name_picture(const uint8_t *data, size_t size) {
  switch (size ? data[0] : 0) {
    case 0x89: return "picture.png";
    case 0xff: return "picture.jpg";
    case 'I':
    case 'M': return "picture.tif";
    case '#': return "picture.hdr";
    case 0: return "picture.tga";
    default: return "picture.exr";
  }
}

static void check_image(const StyImage *image) {
  require(image->width >= 1 && image->width <= STY_MAX_SIDE && image->height >= 1 && image->height <= STY_MAX_SIDE);
  require(image->channel_count >= 1 && image->channel_count <= STY_MAX_CHANNELS);
  for (int c = 0; c < image->channel_count; c++) require(memchr(image->names[c], 0, STY_MAX_NAME));
  const size_t values = (size_t)image->channel_count * sty_count_pixels(image);
  for (size_t i = 0; image->bits < 32 && i < values; i++) require(image->data[i] >= 0 && image->data[i] <= 1);
}

/* Every taken value of a covered pixel is finite. */
static void check_guide(const StyImage *guide) {
  const float *covered = sty_find_channel(guide, "A");
  require(covered);
  for (int k = 0; k < 3; k++) {
    const float *normal = sty_find_channel(guide, (const char *const[]){"normal.X", "normal.Y", "normal.Z"}[k]);
    require(normal);
    for (size_t i = 0; i < sty_count_pixels(guide); i++) require(!(covered[i] > 0) || isfinite(normal[i]));
  }
}

static void import_picture(const char *path, int program, StyImage **image) {
  static const StyStand camera = {.perspective = true, .position = {1, 2, 3}, .up = {0, 1, 0}, .fov = 40};
  static StyNotes notes;
  const StyForeignOptions options = {.program = program, .camera = &camera};
  StyError error;
  const StyStatus status = sty_import_foreign(path, &options, image, &notes, &error);
  if (status)
    require_message(status, &error);
  else
    check_guide(*image);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  StyImage *image = NULL;
  StyLut *lut = NULL;
  StyError error;
  const char *path = put_file(name_picture(data, size), data, size);
  StyStatus status = sty_read_image(path, &image, &error);
  if (status) {
    require(!image);
    require_message(status, &error);
    return 0;
  }
  check_image(image);
  status = sty_decode_lut(path, image, &(StyLutHints){0, 0, -1, STY_FOREIGN_NONE}, &lut, &error);
  if (status) require_message(status, &error);
  sty_destroy_lut(&lut);
  import_picture(path, (int)(size % 6), &image);
  sty_destroy_image(&image);
  return 0;
}
