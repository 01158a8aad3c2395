#include "inputs.h"

#include <string.h>

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

/* A picture's normals and coverage may stand in other channels than a guide's. */
static bool needs_import(const StyImage *image, const StyFeature *features, int count) {
  bool needs = !sty_find_channel(image, "A");
  for (int f = 0; f < count; f++) {
    const char *channel = features[f].channel;
    const bool is_normal = strcmp(channel, "normal") == 0 || strncmp(channel, "normal.", 7) == 0;
    needs = needs || (is_normal && !sty_find_channel(image, "normal.X"));
  }
  return needs;
}

StyStatus read_features(const char *path, const StyFeature *features, int count, StyImage **out, StyError *error) {
  StyImage *image = NULL;
  StyStatus status = sty_read_image(path, &image, error);
  if (!status && needs_import(image, features, count)) status = sty_import_guide(path, &image, error);
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

StyStatus take_argument_or_frame(Options *options, const char **slot, Frames *frames, const char *text) {
  return *slot && frames->count ? add_frame(frames, text, &options->error) : take_argument(options, slot, text);
}

int append_frames(const Frames *frames, const char **files, int count) {
  memcpy(files + count, frames->files, (size_t)frames->count * sizeof *files);
  return count + frames->count;
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
  StyLut *lut = NULL;
  if (!status) status = sty_decode_lut(path, image, hints, &lut, error);
  sty_destroy_image(&image);
  if (!status && lut->depth)
    status = sty_fail(error, STY_ERROR_INPUT, "%s: found a table of three dimensions (%s, %s, %s), expected a flat one",
                      path, lut->axes[0].channel, lut->axes[1].channel, lut->axes[2].channel);
  if (status)
    sty_destroy_lut(&lut);
  else
    *out = lut;
  return status;
}
