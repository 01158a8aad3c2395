#include "bridge/codec.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "bridge/module.h"
#include "bridge/whole.h"
#include "stylut/ceilings.h"
#include "stylut/image_io.h"

static const StyImageCodec *codec;
static const StySymbol SYMBOLS[] = {{"sty_image_codec", &codec}};
static StyModule module = STY_MODULE("image module", "libstylut_oiio.so", 700e6, true, SYMBOLS);

static StyStatus get_codec(const StyImageCodec **out, StyError *error) {
  const StyStatus status = sty_open_module(&module, error);
  if (!status) *out = codec;
  return status;
}

/* For a file that is to be read. */
static StyStatus get_reader(const char *path, const StyImageCodec **out, StyError *error) {
  const StyStatus status = get_codec(out, error);
  return status ? status : sty_check_whole(path, error);
}

/* The module has a copy of ours that nobody sets anything in. */
static long long get_most_pixels(void) { return (long long)sty_get_ceiling(STY_CEILING_PIXELS); }

StyStatus sty_read_image(const char *path, StyImage **out, StyError *error) {
  const StyImageCodec *c;
  const StyStatus status = get_reader(path, &c, error);
  return status ? status : c->read(path, get_most_pixels(), out, error);
}

StyStatus sty_read_image_shape(const char *path, StyImageShape *out, StyError *error) {
  const StyImageCodec *c;
  const StyStatus status = get_reader(path, &c, error);
  return status ? status : c->read_shape(path, get_most_pixels(), out, error);
}

StyStatus sty_resize_image(const char *name, const StyImage *image, int width, int height, StyImage **out,
                           StyError *error) {
  const StyImageCodec *c;
  StyImage *resized = NULL;
  StyStatus status = get_codec(&c, error);
  const char *names[STY_MAX_CHANNELS];
  for (int i = 0; i < image->channel_count; i++) names[i] = image->names[i];
  if (!status) status = sty_create_image(width, height, image->channel_count, names, image->bits, &resized, error);
  if (!status) status = c->resize(name, image, resized, error);
  if (status)
    sty_destroy_image(&resized);
  else
    *out = resized;
  return status;
}

static bool has_ending(const char *path, const char *ending) {
  const size_t length = strlen(path), tail = strlen(ending);
  return length > tail && strcasecmp(path + length - tail, ending) == 0;
}

StyStatus sty_get_image_format(const char *path, StyImageFormat *out, StyError *error) {
  if (!has_ending(path, ".exr") && !has_ending(path, ".png"))
    return sty_fail(error, STY_ERROR_USAGE, "%s: found an unknown ending, expected .exr or .png", path);
  *out = has_ending(path, ".exr") ? STY_IMAGE_EXR : STY_IMAGE_PNG;
  return STY_OK;
}

struct StyImageWriter {
  StyOutput output;
  StyRowWriter *rows;
  int height, written;
};

static StyStatus check_format(const char *path, StyImageFormat format, const StyImage *like, StyError *error) {
  if (format != STY_IMAGE_PNG || (like->channel_count <= 4 && like->bits <= 16)) return STY_OK;
  return sty_fail(error, STY_ERROR_USAGE, "%s: found %d channels of %d bits, which PNG can't hold; expected .exr", path,
                  like->channel_count, like->bits);
}

static StyStatus open_writer(const char *path, const StyImage *like, int height, StyImageWriter *out, StyError *error) {
  const StyImageCodec *c;
  StyImageFormat format = STY_IMAGE_EXR;
  StyImageWriter writer = {.height = height};
  StyStatus status = sty_get_image_format(path, &format, error);
  if (!status) status = check_format(path, format, like, error);
  if (!status) status = get_codec(&c, error);
  if (!status) status = sty_open_output(path, &writer.output, error);
  if (status) return status;
  status = c->open_writer(path, writer.output.stream, format, like, height, &writer.rows, error);
  if (status)
    sty_discard_output(&writer.output);
  else
    *out = writer;
  return status;
}

static StyStatus append_rows(StyImageWriter *writer, const StyImage *rows, StyError *error) {
  writer->written += rows->height;
  if (writer->written > writer->height)
    return sty_fail(error, STY_ERROR_USAGE, "%s: found %d rows, expected %d", writer->output.path, writer->written,
                    writer->height);
  return codec->write_rows(writer->rows, rows, error);
}

/* All but the last step: *out can appear. */
static StyStatus finish_rows(StyImageWriter *writer, StyOutput *out, StyError *error) {
  StyStatus status = STY_OK;
  if (writer->written != writer->height)
    status = sty_fail(error, STY_ERROR_USAGE, "%s: found %d rows, expected %d", writer->output.path, writer->written,
                      writer->height);
  if (!status) status = codec->close_writer(&writer->rows, error);
  codec->discard_writer(&writer->rows);
  if (!status) status = sty_flush_output(&writer->output, error);
  if (status)
    sty_discard_output(&writer->output);
  else
    *out = writer->output;
  return status;
}

StyStatus sty_open_image_writer(const char *path, const StyImage *like, int height, StyImageWriter **out,
                                StyError *error) {
  StyImageWriter *writer = malloc(sizeof *writer);
  if (!writer) return sty_fail_memory(error, path, sizeof *writer);
  const StyStatus status = open_writer(path, like, height, writer, error);
  if (status)
    free(writer);
  else
    *out = writer;
  return status;
}

StyStatus sty_write_rows(StyImageWriter *writer, const StyImage *rows, StyError *error) {
  return append_rows(writer, rows, error);
}

StyStatus sty_close_image_writer(StyImageWriter **writer, StyError *error) {
  StyOutput output;
  const StyStatus status = finish_rows(*writer, &output, error);
  free(*writer);
  *writer = NULL;
  return status ? status : sty_commit_output(&output, error);
}

void sty_discard_image_writer(StyImageWriter **writer) {
  if (!writer || !*writer) return;
  codec->discard_writer(&(*writer)->rows);
  sty_discard_output(&(*writer)->output);
  free(*writer);
  *writer = NULL;
}

/* OpenImageIO 2.4 and what it draws in; rows that are copied at a time on the way to it; and rows that OpenEXR 3 holds
 * per processor while it compresses them, in parts that are half full. */
static const double LIBRARY_BYTES = 128e6, COPIED_ROWS = 64, HELD_ROWS = 64;

double sty_get_image_library_bytes(void) { return LIBRARY_BYTES; }

double sty_estimate_writer_bytes(int width, int channels, int rows) {
  const double row = (double)width * channels * sizeof(float), processors = (double)sysconf(_SC_NPROCESSORS_ONLN);
  return LIBRARY_BYTES + row * (fmin(rows, COPIED_ROWS) + HELD_ROWS * processors);
}

StyStatus sty_prepare_image(const char *path, const StyImage *image, StyOutput *out, StyError *error) {
  StyImageWriter writer;
  StyStatus status = open_writer(path, image, image->height, &writer, error);
  if (status) return status;
  status = append_rows(&writer, image, error);
  if (!status) return finish_rows(&writer, out, error);
  codec->discard_writer(&writer.rows);
  sty_discard_output(&writer.output);
  return status;
}

StyStatus sty_write_image(const char *path, const StyImage *image, StyError *error) {
  StyOutput output;
  const StyStatus status = sty_prepare_image(path, image, &output, error);
  return status ? status : sty_commit_output(&output, error);
}

StyStatus sty_open_texture_map(const char *path, StyTextureMap **out, StyError *error) {
  const StyImageCodec *c;
  const StyStatus status = get_reader(path, &c, error);
  return status ? status : c->open_texture(path, get_most_pixels(), out, error);
}

void sty_close_texture_map(StyTextureMap **texture) {
  if (texture && *texture) codec->close_texture(texture);
}

bool sty_sample_texture_map(const StyTextureMap *texture, const double uv[2], bool nearest, float out[3]) {
  return codec->sample_texture(texture, uv, nearest, out);
}
