#include "stylut/match.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lut/engine.h"

StyStatus sty_create_field(int width, int height, int source_width, int source_height, StyField **out,
                           StyError *error) {
  const size_t pixels = (size_t)width * (size_t)height;
  StyField *field = calloc(1, sizeof *field);
  if (field) {
    *field = (StyField){.width = width, .height = height, .source_width = source_width, .source_height = source_height};
    field->pixels = malloc(pixels * sizeof *field->pixels);
    field->errors = calloc(pixels, sizeof *field->errors);
  }
  if (!field || !field->pixels || !field->errors) {
    sty_destroy_field(&field);
    return sty_fail_memory(error, "field", (double)pixels * 8);
  }
  memset(field->pixels, 0xff, pixels * sizeof *field->pixels);
  *out = field;
  return STY_OK;
}

void sty_destroy_field(StyField **field) {
  if (!field || !*field) return;
  free((*field)->pixels);
  free((*field)->errors);
  free(*field);
  *field = NULL;
}

/* Puts the answers to the target's sites where those are. */
static void place_answers(const StySites *target, const StyLut *answers, StyField *field) {
  field->matched = target->count;
  field->unique = answers->unique;
  for (size_t s = 0; s < target->count; s++) {
    field->pixels[target->pixels[s]] = answers->pixels[s];
    field->errors[target->pixels[s]] = answers->errors[s];
  }
}

StyStatus sty_match_guide(const StySites *source, const StyEngine *engine, const StyEngineOptions *options,
                          const char *name, const StyImage *target, const StyRun *run, StyField **out,
                          StyError *error) {
  StySites *asked = NULL;
  StyLut *answers = NULL;
  StyField *field = NULL;
  StyStatus status = sty_collect_target(name, target, source, &asked, error);
  if (!status) status = sty_create_field(target->width, target->height, source->width, source->height, &field, error);
  if (!status && asked->count) {
    status =
        sty_answer_values(source, engine, options, STY_METRIC_XY, asked->values, asked->count, run, &answers, error);
    if (!status) place_answers(asked, answers, field);
  }
  sty_destroy_sites(&asked);
  sty_destroy_lut(&answers);
  if (status)
    sty_destroy_field(&field);
  else
    *out = field;
  return status;
}

/* ---- encoding ------------------------------------------------------------------- */

static void encode_pixel(const StyField *field, size_t i, int bits, float v[4]) {
  const uint32_t width = (uint32_t)field->source_width, height = (uint32_t)field->source_height;
  const uint32_t x = field->pixels[i] % width, y = field->pixels[i] / width;
  if (bits == 32) {
    v[0] = sty_get_coordinate(x, width);
    v[1] = sty_get_coordinate(y, height);
    v[2] = field->errors[i];
    v[3] = 1;
  } else {
    v[0] = (float)x / 65535.0f;
    v[1] = (float)y / 65535.0f;
    v[2] = 0;
    v[3] = 1;
  }
}

static StyStatus describe_field(const StyField *field, StyImage *image, StyError *error) {
  char source[32];
  snprintf(source, sizeof source, "%dx%d", field->source_width, field->source_height);
  const StyStatus status = sty_set_attribute(image, "stylut:kind", "field", error);
  return status ? status : sty_set_attribute(image, "stylut:source", source, error);
}

StyStatus sty_encode_field(const StyField *field, int bits, StyImage **out, StyError *error) {
  static const char *const float_names[] = {"u", "v", "error", "A"}, *const integer_names[] = {"R", "G", "B", "A"};
  StyImage *image = NULL;
  StyStatus status =
      sty_create_image(field->width, field->height, 4, bits == 32 ? float_names : integer_names, bits, &image, error);
  if (!status) status = describe_field(field, image, error);
  if (status) {
    sty_destroy_image(&image);
    return status;
  }
  const size_t pixels = sty_count_pixels(image);
  for (size_t i = 0; i < pixels; i++) {
    float v[4];
    if (field->pixels[i] == STY_NO_PIXEL) continue;
    encode_pixel(field, i, bits, v);
    for (size_t c = 0; c < 4; c++) image->data[c * pixels + i] = v[c];
  }
  *out = image;
  return STY_OK;
}
