#include "inputs.h"

#include <string.h>

#include "stylut/file.h"
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

void warn_about_normals(const Options *options, const char *path, const StyImage *guide) {
  static const float rim = 1.05f, most = 0.25f;
  const float *covered = sty_find_channel(guide, "A");
  const float *x = sty_find_channel(guide, "normal.X"), *y = sty_find_channel(guide, "normal.Y");
  size_t count = 0, beyond = 0;
  for (size_t p = 0; p < sty_count_pixels(guide); p++) {
    if (!(covered[p] > 0)) continue;
    count++;
    beyond += !(x[p] * x[p] + y[p] * y[p] <= rim * rim);
  }
  if ((float)beyond > most * (float)count)
    warn(options, "%s: found normals longer than 1 in %.0f %% of the covered pixels, expected unit normals",
         clean_text(path), 100.0 * (double)beyond / (double)count);
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
  /* "--frames -o OUT" would take -o for a frame. */
  if (file[0] == '-')
    return sty_fail(error, STY_ERROR_USAGE, "--frames: found '%s', expected a file; ./%s if it is one", file, file);
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

static StyStatus read_table(const char *path, const StyLutHints *hints, StyImage **image, StyLut **out,
                            StyError *error) {
  StyLut *lut = NULL;
  StyStatus status = sty_read_image(path, image, error);
  if (!status) status = sty_decode_lut(path, *image, hints, &lut, error);
  if (!status && lut->depth)
    status = sty_fail(error, STY_ERROR_INPUT, "%s: found a table of three dimensions (%s, %s, %s), expected a flat one",
                      path, lut->axes[0].channel, lut->axes[1].channel, lut->axes[2].channel);
  if (status)
    sty_destroy_lut(&lut);
  else
    *out = lut;
  return status;
}

StyStatus read_lut(const char *path, const StyLutHints *hints, StyLut **out, StyError *error) {
  StyImage *image = NULL;
  const StyStatus status = read_table(path, hints, &image, out, error);
  sty_destroy_image(&image);
  return status;
}

StyStatus read_lut_of_guide(const Options *options, const char *path, const char *guide, const StyLutHints *hints,
                            StyLut **out, StyError *error) {
  StyImage *image = NULL;
  char hash[STY_HASH_SIZE];
  StyStatus status = read_table(path, hints, &image, out, error);
  const char *origin = status ? NULL : sty_find_attribute(image, "stylut:input1");
  if (origin) status = sty_hash_file(guide, hash, error);
  if (!status && origin && strcmp(origin, hash) != 0)
    warn(options, "%s: found that it was made of another file (sha256 %.12s...), expected %s (%.12s...)",
         clean_text(path), clean_text(origin), clean_text(guide), hash);
  sty_destroy_image(&image);
  if (status) sty_destroy_lut(out);
  return status;
}
