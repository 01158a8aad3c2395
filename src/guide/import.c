#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "stylut/guide.h"

enum { BASE_COUNT = 4 }; /* A and the normals */

/* Whether a channel comes along as it is: other layers than the normals. */
static bool is_extra(const char *name) {
  static const char *const normals[] = {"normal.X", "normal.Y", "normal.Z"};
  for (int k = 0; k < 3; k++)
    if (strcmp(name, normals[k]) == 0) return false;
  return strchr(name, '.') != NULL;
}

/* Where the normals of a picture are. */
typedef struct Source {
  const StyImage *image;
  const float *planes[3];
  const float *alpha; /* NULL: none */
  int top;            /* largest integer of n/2+1/2; 0: normals as they are */
} Source;

static StyStatus fail_normals(const char *name, const StyImage *image, StyError *error) {
  char found[256] = "";
  for (int c = 0; c < image->channel_count && strlen(found) < sizeof found - STY_MAX_NAME; c++) {
    const size_t used = strlen(found);
    snprintf(found + used, sizeof found - used, "%s%s", c ? ", " : "", image->names[c]);
  }
  return sty_fail(
      error, STY_ERROR_INPUT,
      "%s: no normals: found %d channel%s (%s) of %d bit, expected normal.X, normal.Y and normal.Z, or R, G "
      "and B of 8 or 16 bit",
      name, image->channel_count, image->channel_count == 1 ? "" : "s", found, image->bits);
}

static bool find_planes(Source *source, const char *const names[3]) {
  for (int k = 0; k < 3; k++) source->planes[k] = sty_find_channel(source->image, names[k]);
  return source->planes[0] && source->planes[1] && source->planes[2];
}

static StyStatus find_source(const char *name, const StyImage *image, Source *out, StyError *error) {
  *out = (Source){.image = image, .alpha = sty_find_channel(image, "A")};
  if (find_planes(out, (const char *const[3]){"normal.X", "normal.Y", "normal.Z"})) return STY_OK;
  if (image->bits == 32 || !find_planes(out, (const char *const[3]){"R", "G", "B"}))
    return fail_normals(name, image, error);
  out->top = image->bits == 8 ? 255 : 65535;
  return STY_OK;
}

static bool is_covered(const Source *source, size_t i) {
  if (source->alpha) return source->alpha[i] > 0;
  return source->planes[0][i] != 0 || source->planes[1][i] != 0 || source->planes[2][i] != 0;
}

/* Through the integer of the file, so that equal bytes give equal normals. */
static float decode_normal(const Source *source, float value) {
  if (source->top == 0) return value;
  return (float)(2 * lrintf(value * (float)source->top) - source->top) / (float)source->top;
}

static StyStatus decode_pixels(const char *name, const Source *source, StyImage *guide, StyError *error) {
  static const char *const NORMALS[3] = {"normal.X", "normal.Y", "normal.Z"};
  const size_t count = sty_count_pixels(guide);
  float *coverage = sty_find_channel(guide, "A"), *normals[3];
  for (int k = 0; k < 3; k++) normals[k] = sty_find_channel(guide, NORMALS[k]);
  for (size_t i = 0; i < count; i++) {
    if (source->alpha && isnan(source->alpha[i]))
      return sty_fail(error, STY_ERROR_INPUT, "%s: found A = nan at pixel (%zu, %zu), expected a coverage of 0 or 1",
                      name, i % (size_t)guide->width, i / (size_t)guide->width);
    if (!is_covered(source, i)) continue;
    coverage[i] = source->alpha ? fminf(source->alpha[i], 1) : 1; /* kept: it becomes the picture's alpha */
    for (int k = 0; k < 3; k++) {
      normals[k][i] = decode_normal(source, source->planes[k][i]);
      if (fabsf(normals[k][i]) <= STY_MAX_GUIDE_VALUE) continue;
      return sty_fail(error, STY_ERROR_INPUT,
                      "%s: found %s = %g at pixel (%zu, %zu), expected a finite value within %g", name, NORMALS[k],
                      (double)normals[k][i], i % (size_t)guide->width, i / (size_t)guide->width,
                      (double)STY_MAX_GUIDE_VALUE);
    }
  }
  return STY_OK;
}

static StyStatus copy_rest(const StyImage *image, StyImage *guide, StyError *error) {
  for (int c = BASE_COUNT; c < guide->channel_count; c++)
    memcpy(sty_find_channel(guide, guide->names[c]), sty_find_channel(image, guide->names[c]),
           sty_count_pixels(image) * sizeof(float));
  StyStatus status = STY_OK;
  for (int a = 0; a < image->attribute_count && status == STY_OK; a++)
    status = sty_set_attribute(guide, image->attributes[a].name, image->attributes[a].value, error);
  return status;
}

/* A table's coordinates would pass for normals. */
static StyStatus refuse_kind(const char *name, const StyImage *image, StyError *error) {
  const char *kind = sty_find_attribute(image, "stylut:kind");
  return kind ? sty_fail(error, STY_ERROR_INPUT, "%s: found stylut:kind = %s, expected a guide", name, kind) : STY_OK;
}

StyStatus sty_import_guide(const char *name, StyImage **image, StyError *error) {
  Source source;
  StyStatus status = refuse_kind(name, *image, error);
  if (status == STY_OK) status = find_source(name, *image, &source, error);
  if (status != STY_OK) return status;
  const char *names[BASE_COUNT + STY_MAX_CHANNELS] = {"A", "normal.X", "normal.Y", "normal.Z"};
  int count = BASE_COUNT;
  for (int c = 0; c < (*image)->channel_count; c++)
    if (is_extra((*image)->names[c])) names[count++] = (*image)->names[c];
  StyImage *guide = NULL;
  status = sty_create_image((*image)->width, (*image)->height, count, names, (*image)->bits, &guide, error);
  if (status != STY_OK) return status;
  status = decode_pixels(name, &source, guide, error);
  if (status == STY_OK) status = copy_rest(*image, guide, error);
  if (status != STY_OK) {
    sty_destroy_image(&guide);
    return status;
  }
  sty_destroy_image(image);
  *image = guide;
  return STY_OK;
}
