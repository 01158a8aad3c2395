#include "frames.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "sequence.h"
#include "stylut/guide.h"
#include "stylut/image_io.h"

void free_frame(FilledFrame *filled) {
  free(filled->guide);
  free(filled->styles);
  free(filled->luma);
  free(filled->albedo);
  free(filled->objects);
  free(filled->fine);
  free(filled->depth);
}

/* Room for a part of the frame, where the guide has it. */
static void *allocate_part(bool has, size_t bytes, bool *failed) {
  void *part = has ? malloc(bytes) : NULL;
  *failed = *failed || (has && !part);
  return part;
}

static bool has_albedo(const StyImage *image) {
  return sty_find_channel(image, "albedo.R") && sty_find_channel(image, "albedo.G") &&
         sty_find_channel(image, "albedo.B");
}

static StyStatus allocate_frame(FilledFrame *filled, const StyImage *image, StyError *error) {
  const size_t pixels = sty_count_pixels(image);
  bool failed = false;
  filled->guide = allocate_part(true, 4 * pixels, &failed);
  filled->fine = allocate_part(image->bits > 8, 2 * pixels * sizeof *filled->fine, &failed);
  filled->depth = allocate_part(sty_find_channel(image, "depth.Z"), pixels * sizeof *filled->depth, &failed);
  filled->styles = allocate_part(filled->frame.style == 0, pixels, &failed);
  filled->luma = allocate_part(sty_find_channel(image, "luma.Y"), pixels, &failed);
  filled->albedo = allocate_part(has_albedo(image), 4 * pixels, &failed);
  filled->objects = allocate_part(sty_find_channel(image, "object.I"), pixels * sizeof *filled->objects, &failed);
  return failed ? sty_fail_memory(error, "frame", (double)pixels * 24) : STY_OK;
}

/* The guide's bytes, and coverage as the file has it, not just 0 and 255: it becomes the picture's alpha. */
static StyStatus fill_guide(const StyImage *image, uint8_t *guide, StyError *error) {
  const float *alpha = sty_find_channel(image, "A");
  StyImage *encoded = NULL;
  StyStatus status = sty_encode_normals(image, 8, &encoded, error);
  if (!status) status = sty_convert_to_rgba8("guide", encoded, guide, error);
  sty_destroy_image(&encoded);
  for (size_t i = 0; !status && i < sty_count_pixels(image); i++) {
    const float covered = alpha[i] > 0 ? alpha[i] * 255.0f + 0.5f : 0;
    guide[4 * i + 3] = covered < 1 ? covered > 0 : covered < 255 ? (uint8_t)covered : 255;
  }
  return status;
}

/* 0..1 to 0..most, rounded; what isn't a number is 0. */
static int round_share(double value, int most) { return value > 0 ? (int)(fmin(value, 1) * most + 0.5) : 0; }

/* As sRGB holds scene-linear reflectance: the encoding of exemplars. */
static uint8_t encode_srgb(float value) {
  return (uint8_t)round_share(value <= 0.0031308f ? value * 12.92 : 1.055 * pow(value, 1 / 2.4) - 0.055, 255);
}

static void fill_albedo(const StyImage *image, uint8_t *albedo) {
  static const char *const names[] = {"albedo.R", "albedo.G", "albedo.B"};
  for (size_t c = 0; c < 3; c++) {
    const float *plane = sty_find_channel(image, names[c]);
    for (size_t i = 0; i < sty_count_pixels(image); i++) albedo[4 * i + c] = encode_srgb(plane[i]);
  }
  for (size_t i = 0; i < sty_count_pixels(image); i++) albedo[4 * i + 3] = 255;
}

/* What isn't a number says nothing, whatever it stands for; depths are looked at where they are used. */
static StyStatus refuse_nan(const char *name, const StyImage *image, StyError *error) {
  static const char *const names[] = {"style.I", "luma.Y", "object.I", "albedo.R", "albedo.G", "albedo.B"};
  const float *covered = sty_find_channel(image, "A");
  for (size_t c = 0; c < sizeof names / sizeof *names; c++) {
    const float *plane = sty_find_channel(image, names[c]);
    for (size_t i = 0; plane && i < sty_count_pixels(image); i++)
      if (isnan(plane[i]) && covered[i] > 0)
        return sty_fail(error, STY_ERROR_INPUT, "%s: found nan in %s at (%zu, %zu), expected a number", name, names[c],
                        i % (size_t)image->width, i / (size_t)image->width);
  }
  return STY_OK;
}

/* A style or an object: a whole number, 0 where it is none. What is beyond those is counted. */
static int read_id(float value, int most, size_t *foreign) {
  if (value == 0 || isnan(value)) return 0;
  const bool is_one = value > 0 && value <= (float)most && value == floorf(value);
  *foreign += !is_one;
  return is_one ? (int)value : 0;
}

/* Luminance as it would be if all were white: what chooses lightings and bands is light, not paint. */
static void fill_luma(const StyImage *image, uint8_t *out) {
  const float *luma = sty_find_channel(image, "luma.Y");
  const float *r = sty_find_channel(image, "albedo.R"), *g = sty_find_channel(image, "albedo.G"),
              *b = sty_find_channel(image, "albedo.B");
  for (size_t i = 0; i < sty_count_pixels(image); i++) {
    const float albedo = r && g && b ? 0.2126f * r[i] + 0.7152f * g[i] + 0.0722f * b[i] : 1;
    out[i] = (uint8_t)round_share(albedo > 0 ? luma[i] / albedo : luma[i], 255);
  }
}

static void fill_values(const StyImage *image, FilledFrame *out) {
  const float *x = sty_find_channel(image, "normal.X"), *y = sty_find_channel(image, "normal.Y");
  const float *depth = sty_find_channel(image, "depth.Z"), *ids = sty_find_channel(image, "style.I");
  const float *objects = sty_find_channel(image, "object.I");
  for (size_t i = 0; i < sty_count_pixels(image); i++) {
    if (out->fine) out->fine[2 * i] = x[i], out->fine[2 * i + 1] = y[i];
    if (out->depth) out->depth[i] = depth[i];
    const bool is_covered = out->guide[4 * i + 3] > 0;
    size_t none = 0;
    if (out->styles)
      out->styles[i] = (uint8_t)(ids ? read_id(ids[i], 255, is_covered ? &out->foreign_styles : &none) : 0);
    if (out->objects)
      out->objects[i] = (uint16_t)read_id(objects[i], 65535, is_covered ? &out->foreign_objects : &none);
  }
  if (out->luma) fill_luma(image, out->luma);
  if (out->albedo) fill_albedo(image, out->albedo);
}

StyStatus fill_frame(const char *name, const StyImage *image, int style, FilledFrame *out, StyError *error) {
  *out = (FilledFrame){.frame = {.width = image->width, .height = image->height, .style = style}};
  StyStatus status = refuse_nan(name, image, error);
  if (!status) status = allocate_frame(out, image, error);
  if (!status) status = fill_guide(image, out->guide, error);
  if (status) return status;
  fill_values(image, out);
  out->frame.guide = out->guide;
  out->frame.fine = out->fine;
  out->frame.depth = out->depth;
  out->frame.styles = out->styles;
  out->frame.luma = out->luma;
  out->frame.albedo = out->albedo;
  out->frame.objects = out->objects;
  return STY_OK;
}

StyStatus require_frame(Options *options, const char *guide) {
  StyImageFormat format;
  if (!guide)
    return sty_fail(&options->error, STY_ERROR_USAGE, "option '--guide': found none, expected the frame's guide");
  StyStatus status = require_output(options);
  if (!status && access(guide, F_OK) != 0)
    status = refuse_pattern("--guide", guide, "one frame's guide", &options->error);
  if (status) return status;
  if (sty_get_image_format(options->output, &format, NULL) || format != STY_IMAGE_PNG)
    return sty_fail(&options->error, STY_ERROR_USAGE,
                    "option '--output': found '%s', expected a name that ends in .png", options->output);
  return STY_OK;
}

StyStatus refuse_argument(Options *options, const char *text) {
  return sty_fail(&options->error, STY_ERROR_USAGE, "found '%s', expected options alone", text);
}

StyStatus write_picture(const Options *options, const char *command, int width, int height, int bits,
                        const void *picture, const char *const *inputs, int input_count, StyError *error) {
  static const char *const names[] = {"R", "G", "B", "A"};
  StyImage *image = NULL;
  StyStatus status = sty_create_image(width, height, 4, names, bits, &image, error);
  if (status) return status;
  const size_t pixels = sty_count_pixels(image);
  for (size_t i = 0; i < pixels; i++)
    for (size_t c = 0; c < 4; c++)
      image->data[c * pixels + i] = bits == 8 ? (float)((const uint8_t *)picture)[4 * i + c] / 255.0f
                                              : (float)((const uint16_t *)picture)[4 * i + c] / 65535.0f;
  status = add_history(options, command, image, inputs, input_count, error);
  if (!status) status = sty_write_image(options->output, image, error);
  sty_destroy_image(&image);
  return status;
}

StyStatus report_picture(const Options *options, const char *schema, const char *guide, const StyFrame *frame,
                         json_t *runtime, StyError *error) {
  size_t covered = 0;
  for (size_t i = 0; i < (size_t)frame->width * (size_t)frame->height; i++) covered += frame->guide[4 * i + 3] > 0;
  if (!covered) warn(options, "%s: found no covered pixel, expected a frame that shows something", clean_text(guide));
  if (options->json)
    return print_json(json_pack("{s:s, s:[ii], s:I, s:o}", "schema", schema, "size", frame->width, frame->height,
                                "covered", (json_int_t)covered, "runtime", runtime),
                      error);
  json_decref(runtime);
  if (!options->quiet)
    printf("%s: %dx%d, %zu pixels covered\n", clean_text(options->output), frame->width, frame->height, covered);
  return STY_OK;
}
