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

StyStatus add_frame(Frames *frames, const char *file, StyError *error) {
  if (frames->count == MOST_FRAMES)
    return sty_fail(error, STY_ERROR_USAGE, "--frames: found more than %d files, expected at most that", MOST_FRAMES);
  frames->files[frames->count++] = file;
  return STY_OK;
}

StyStatus read_frames(const Frames *frames, StyImage *out[MOST_FRAMES], StyError *error) {
  StyStatus status = STY_OK;
  for (int f = 0; !status && f < frames->count; f++) status = read_guide(frames->files[f], &out[f], error);
  return status;
}

void destroy_frames(StyImage *frames[MOST_FRAMES]) {
  for (int f = 0; f < MOST_FRAMES; f++) sty_destroy_image(&frames[f]);
}

StyStatus read_lut(const char *path, const StyLutHints *hints, StyLut **out, StyError *error) {
  StyImage *image = NULL;
  StyStatus status = sty_read_image(path, &image, error);
  if (!status) status = sty_decode_lut(path, image, hints, out, error);
  sty_destroy_image(&image);
  return status;
}
