#include "inputs.h"

#include "stylut/image_io.h"

StyStatus read_guide(const char *path, StyImage **out, StyError *error) {
  StyImage *image = NULL;
  StyStatus status = sty_read_image(path, &image, error);
  if (!status) status = sty_import_guide(path, &image, error);
  if (status)
    sty_destroy_image(&image);
  else
    *out = image;
  return status;
}

StyStatus read_lut(const char *path, const StyLutHints *hints, StyLut **out, StyError *error) {
  StyImage *image = NULL;
  StyStatus status = sty_read_image(path, &image, error);
  if (!status) status = sty_decode_lut(path, image, hints, out, error);
  sty_destroy_image(&image);
  return status;
}
