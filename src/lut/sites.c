#include <math.h>
#include <stdlib.h>

#include "stylut/lut.h"

static StyStatus fail_value(const char *name, const StyImage *guide, size_t pixel, float x, float y, StyError *error) {
  return sty_fail(error, STY_ERROR_INPUT,
                  "%s: found guide value (%g, %g) at pixel (%zu, %zu), expected finite values within %g", name,
                  (double)x, (double)y, pixel % (size_t)guide->width, pixel / (size_t)guide->width,
                  (double)STY_MAX_GUIDE_VALUE);
}

/* Copies covered pixels; -0 becomes 0. `sites` has room for all. */
static StyStatus copy_values(const char *name, const StyImage *guide, const float *covered, const float *x,
                             const float *y, StySites *sites, StyError *error) {
  const size_t pixels = sty_count_pixels(guide);
  size_t count = 0;
  for (size_t i = 0; i < pixels; i++) {
    if (!(covered[i] > 0)) continue;
    if (!(fabsf(x[i]) <= STY_MAX_GUIDE_VALUE && fabsf(y[i]) <= STY_MAX_GUIDE_VALUE))
      return fail_value(name, guide, i, x[i], y[i], error);
    sites->values[2 * count] = x[i] + 0.0f;
    sites->values[2 * count + 1] = y[i] + 0.0f;
    sites->pixels[count++] = (uint32_t)i;
  }
  sites->count = count;
  return STY_OK;
}

/* The byte whose value this is, or -1. */
static int get_level(float value) {
  const int level = (int)((value + 1) * 127.5f + 0.5f);
  return level >= 0 && level < 256 && (float)(2 * level - 255) / 255.0f == value ? level : -1;
}

/* The bytes of all values, or NULL where one is something else. */
static StyStatus find_levels(StySites *sites, StyError *error) {
  enum { CHUNK = 4096 };
  const size_t count = 2 * sites->count;
  uint8_t *levels = malloc(count);
  if (!levels) return sty_fail_memory(error, "guide levels", (double)count);
  bool all = true;
  for (size_t begin = 0; all && begin < count; begin += CHUNK) {
    const size_t end = begin + CHUNK < count ? begin + CHUNK : count;
    int signs = 0;
    for (size_t i = begin; i < end; i++) {
      const int level = get_level(sites->values[i]);
      signs |= level;
      levels[i] = (uint8_t)level;
    }
    all = signs >= 0;
  }
  if (!all) {
    free(levels);
    levels = NULL;
  }
  sites->levels = levels;
  return STY_OK;
}

StyStatus sty_collect_sites(const char *name, const StyImage *guide, StySites **out, StyError *error) {
  const float *covered = sty_find_channel(guide, "A");
  const float *x = sty_find_channel(guide, "normal.X"), *y = sty_find_channel(guide, "normal.Y");
  if (!covered || !x || !y)
    return sty_fail(error, STY_ERROR_INPUT, "%s: found no normals, expected channels A, normal.X and normal.Y", name);
  const size_t pixels = sty_count_pixels(guide);
  size_t count = 0;
  for (size_t i = 0; i < pixels; i++) count += covered[i] > 0;
  if (!count)
    return sty_fail(error, STY_ERROR_INPUT, "%s: found no covered pixel, expected a guide that shows something", name);

  StySites *sites = calloc(1, sizeof *sites);
  if (sites) {
    *sites = (StySites){.width = guide->width, .height = guide->height};
    sites->values = malloc(count * 2 * sizeof *sites->values);
    sites->pixels = malloc(count * sizeof *sites->pixels);
  }
  StyStatus status = STY_OK;
  if (!sites || !sites->values || !sites->pixels) status = sty_fail_memory(error, name, (double)count * 12);
  if (!status) status = copy_values(name, guide, covered, x, y, sites, error);
  if (!status) status = find_levels(sites, error);
  if (status)
    sty_destroy_sites(&sites);
  else
    *out = sites;
  return status;
}

void sty_destroy_sites(StySites **sites) {
  if (!sites || !*sites) return;
  free((*sites)->values);
  free((*sites)->pixels);
  free((*sites)->levels);
  free(*sites);
  *sites = NULL;
}
