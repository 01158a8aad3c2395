#include "stylut/image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

StyStatus sty_create_image(int width, int height, int channel_count, const char *const *names, int bits, StyImage **out,
                           StyError *error) {
  if (width < 1 || height < 1 || width > STY_MAX_SIDE || height > STY_MAX_SIDE ||
      (long long)width * height > STY_MAX_PIXELS)
    return sty_fail(error, STY_ERROR_INPUT,
                    "found a picture of %d x %d pixels, expected sides up to %d and at most %lld pixels", width, height,
                    STY_MAX_SIDE, STY_MAX_PIXELS);
  if (channel_count < 1 || channel_count > STY_MAX_CHANNELS)
    return sty_fail(error, STY_ERROR_INPUT, "found %d channels, expected 1 to %d", channel_count, STY_MAX_CHANNELS);
  const size_t values = (size_t)width * (size_t)height * (size_t)channel_count;
  StyImage *image = calloc(1, sizeof *image);
  if (image) {
    *image = (StyImage){.width = width, .height = height, .channel_count = channel_count, .bits = bits};
    image->names = calloc((size_t)channel_count, sizeof *image->names);
    image->data = sty_allocate_large(values * sizeof *image->data);
    if (image->data) memset(image->data, 0, values * sizeof *image->data);
  }
  if (!image || !image->names || !image->data) {
    sty_destroy_image(&image);
    return sty_fail_memory(error, "picture", (double)values * sizeof(float));
  }
  for (int c = 0; c < channel_count; c++) {
    strncpy(image->names[c], names[c], STY_MAX_NAME - 1);
  }
  *out = image;
  return STY_OK;
}

void sty_destroy_image(StyImage **image) {
  if (!image || !*image) return;
  for (int i = 0; i < (*image)->attribute_count; i++) {
    free((*image)->attributes[i].name);
    free((*image)->attributes[i].value);
  }
  free((*image)->attributes);
  free((*image)->names);
  free((*image)->data);
  free(*image);
  *image = NULL;
}

StyStatus sty_copy_image(const StyImage *image, StyImage **out, StyError *error) {
  const char *names[STY_MAX_CHANNELS];
  StyImage *copy = NULL;
  for (int c = 0; c < image->channel_count; c++) names[c] = image->names[c];
  StyStatus status =
      sty_create_image(image->width, image->height, image->channel_count, names, image->bits, &copy, error);
  if (!status)
    memcpy(copy->data, image->data, sty_count_pixels(image) * (size_t)image->channel_count * sizeof *image->data);
  for (int i = 0; !status && i < image->attribute_count; i++)
    status = sty_set_attribute(copy, image->attributes[i].name, image->attributes[i].value, error);
  if (status) sty_destroy_image(&copy);
  *out = copy;
  return status;
}

float *sty_find_channel(const StyImage *image, const char *name) {
  for (int c = 0; c < image->channel_count; c++)
    if (strcmp(image->names[c], name) == 0) return image->data + (size_t)c * sty_count_pixels(image);
  return NULL;
}

uint32_t sty_encode_coordinate(uint32_t pixel, uint32_t side, uint32_t maximum) {
  return (uint32_t)(((2 * (uint64_t)pixel + 1) * maximum + side - 1) / (2 * (uint64_t)side));
}

uint32_t sty_decode_coordinate(uint32_t value, uint32_t side, uint32_t maximum) {
  const uint64_t pixel = (uint64_t)value * side / maximum;
  return pixel < side ? (uint32_t)pixel : side - 1;
}

StyStatus sty_convert_to_rgba8(const char *name, const StyImage *image, uint8_t *out, StyError *error) {
  if (image->bits > 16 || image->channel_count > 4)
    return sty_fail(error, STY_ERROR_INPUT,
                    "%s: found %d channels of %d bits, expected a picture of 1 to 4 channels and 8 or 16 bits", name,
                    image->channel_count, image->bits);
  const size_t pixels = sty_count_pixels(image);
  const bool grey = image->channel_count < 3, has_alpha = image->channel_count % 2 == 0;
  for (int c = 0; c < 4; c++) {
    const bool constant = c == 3 && !has_alpha;
    const float *plane = image->data + (c == 3 ? (size_t)image->channel_count - 1 : grey ? 0 : (size_t)c) * pixels;
    for (size_t i = 0; i < pixels; i++) out[4 * i + (size_t)c] = constant ? 255 : (uint8_t)lrintf(plane[i] * 255.0f);
  }
  return STY_OK;
}

static StyAttribute *find_attribute(const StyImage *image, const char *name) {
  for (int i = 0; i < image->attribute_count; i++)
    if (strcmp(image->attributes[i].name, name) == 0) return &image->attributes[i];
  return NULL;
}

const char *sty_find_attribute(const StyImage *image, const char *name) {
  const StyAttribute *attribute = find_attribute(image, name);
  return attribute ? attribute->value : NULL;
}

StyStatus sty_set_attribute(StyImage *image, const char *name, const char *value, StyError *error) {
  char *value_copy = strdup(value);
  if (!value_copy) return sty_fail_memory(error, "attribute", (double)strlen(value));
  StyAttribute *existing = find_attribute(image, name);
  if (existing) {
    free(existing->value);
    existing->value = value_copy;
    return STY_OK;
  }
  char *name_copy = strdup(name);
  StyAttribute *grown =
      name_copy ? realloc(image->attributes, (size_t)(image->attribute_count + 1) * sizeof *grown) : NULL;
  if (!grown) {
    free(value_copy);
    free(name_copy);
    return sty_fail_memory(error, "attribute", (double)strlen(value));
  }
  image->attributes = grown;
  grown[image->attribute_count++] = (StyAttribute){name_copy, value_copy};
  return STY_OK;
}
