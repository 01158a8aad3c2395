#include "inputs.h"

#include <string.h>
#include <unistd.h>

#include "stylut/file.h"
#include "stylut/image_io.h"
#include "stylut/mesh.h"
#include "stylut/scene_file.h"

/* A mesh or a scene, which isn't seen from anywhere yet. */
static bool is_model(const char *path) {
  return access(path, F_OK) == 0 && (sty_is_scene_file(path) || sty_is_mesh_file(path));
}

static StyStatus import_guide(const char *path, StyImage **out, StyError *error) {
  StyImage *image = NULL;
  StyStatus status = !is_model(path) ? sty_read_image(path, &image, error)
                                     : sty_fail(error, STY_ERROR_INPUT,
                                                "%s: found a scene, expected a guide, as 'stylut guide scene' makes "
                                                "of one",
                                                path);
  if (!status) status = sty_import_guide(path, &image, error);
  if (status)
    sty_destroy_image(&image);
  else
    *out = image;
  return status;
}

static void warn_about_normals(const Options *options, const char *path, const StyImage *guide) {
  static const double shortest = 0.9, longest = 1.1, most = 0.1;
  const float *covered = sty_find_channel(guide, "A");
  const float *normal[3] = {sty_find_channel(guide, "normal.X"), sty_find_channel(guide, "normal.Y"),
                            sty_find_channel(guide, "normal.Z")};
  size_t count = 0, odd = 0, away = 0;
  for (size_t p = 0; p < sty_count_pixels(guide); p++) {
    if (!(covered[p] > 0)) continue;
    double squared = 0;
    for (int k = 0; k < 3; k++) squared += (double)normal[k][p] * (double)normal[k][p];
    count++;
    odd += !(squared > shortest * shortest && squared < longest * longest);
    away += normal[2][p] < 0;
  }
  if ((double)odd > most * (double)count)
    warn(options, "%s: found normals of other lengths than 1 in %.0f %% of the covered pixels, expected unit normals",
         clean_text(path), 100 * (double)odd / (double)count);
  else if (2 * away > count)
    warn(options,
         "%s: found normals facing away from the viewer in %.0f %% of the covered pixels, expected z toward it",
         clean_text(path), 100 * (double)away / (double)count);
}

StyStatus read_guide(const Options *options, const char *path, StyImage **out, StyError *error) {
  const StyStatus status = import_guide(path, out, error);
  if (!status) warn_about_normals(options, path, *out);
  return status;
}

static bool shows_normals(const StyImage *image) {
  return sty_find_channel(image, "normal.X") && sty_find_channel(image, "normal.Y") &&
         sty_find_channel(image, "normal.Z");
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

StyStatus read_features(const Options *options, const char *path, const StyFeature *features, int count, StyImage **out,
                        StyError *error) {
  StyImage *image = NULL;
  StyStatus status = sty_read_image(path, &image, error);
  if (!status && needs_import(image, features, count)) status = sty_import_guide(path, &image, error);
  if (!status && shows_normals(image)) warn_about_normals(options, path, image);
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
  if (!*slot) frames->before_argument = is_behind_option(options, "--fr", text); /* however abbreviated */
  if (!*slot || !frames->count) return take_argument(options, slot, text);
  if (frames->before_argument)
    return sty_fail(
        &options->error, STY_ERROR_USAGE,
        "--frames: found '%s' and '%s' behind it, of which the first may be a frame, too; expected --frames "
        "behind the other argument",
        *slot, text);
  return add_frame(frames, text, &options->error);
}

int append_frames(const Frames *frames, const char **files, int count) {
  memcpy(files + count, frames->files, (size_t)frames->count * sizeof *files);
  return count + frames->count;
}

StyStatus read_frames(const Options *options, const Frames *frames, StyImage *out[MOST_FRAMES], StyError *error) {
  StyStatus status = STY_OK;
  for (int f = 0; !status && f < frames->count; f++) status = read_guide(options, frames->files[f], &out[f], error);
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

StyStatus read_lut(const Options *options, const char *path, const char *guide, const StyLutHints *hints, StyLut **out,
                   bool *of_another, StyError *error) {
  StyImage *image = NULL;
  char hash[STY_HASH_SIZE];
  StyStatus status = read_table(path, hints, &image, out, error);
  const char *origin = status || !guide ? NULL : sty_find_attribute(image, "stylut:input1");
  if (origin) status = sty_hash_file(guide, hash, error);
  *of_another = !status && origin && strcmp(origin, hash) != 0;
  if (*of_another)
    warn(options, "%s: found that it was made of another file (sha256 %.12s...), expected %s (%.12s...)",
         clean_text(path), clean_text(origin), clean_text(guide), hash);
  sty_destroy_image(&image);
  if (status) sty_destroy_lut(out);
  return status;
}

StyStatus decode_table(const StyTexture *texture, uint32_t layer, StySampling sampling, int source_width,
                       int source_height, StyLut **out, StyError *error) {
  const StyLutSpec spec = {.width = (int)texture->width, .height = (int)texture->height, .sampling = sampling};
  const uint32_t width = (uint32_t)source_width, height = (uint32_t)source_height;
  const size_t texels = sty_count_texels(&spec);
  const unsigned char *from = texture->texels + layer * texels * texture->texel_size;
  StyLut *lut = NULL;
  const StyStatus status = sty_create_lut(&spec, source_width, source_height, &lut, error);
  if (status) return status;
  for (size_t t = 0; t < texels; t++, from += 4) {
    const uint32_t x = sty_decode_coordinate((uint32_t)(from[0] | from[1] << 8), width, 65535);
    const uint32_t y = sty_decode_coordinate((uint32_t)(from[2] | from[3] << 8), height, 65535);
    lut->pixels[t] = y * width + x;
  }
  *out = lut;
  return STY_OK;
}
