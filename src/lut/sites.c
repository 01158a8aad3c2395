#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "stylut/lut.h"

/* No search library is ever handed a coordinate beyond this. */
#define LARGEST_VALUE 1000.0f

static uint64_t get_key(const float value[2]) {
  uint64_t key;
  memcpy(&key, value, sizeof key);
  return key;
}

/* splitmix64's finalizer: neighbouring values must not land in neighbouring slots. */
static uint64_t mix(uint64_t key) {
  key = (key ^ (key >> 30)) * 0xbf58476d1ce4e5b9u;
  key = (key ^ (key >> 27)) * 0x94d049bb133111ebu;
  return key ^ (key >> 31);
}

static StyStatus check_value(const char *name, const StyImage *guide, size_t pixel, float x, float y, StyError *error) {
  if (fabsf(x) <= LARGEST_VALUE && fabsf(y) <= LARGEST_VALUE) return STY_OK;
  return sty_fail(
      error, STY_ERROR_INPUT, "%s: found guide value (%g, %g) at pixel (%zu, %zu), expected finite values within %g",
      name, (double)x, (double)y, pixel % (size_t)guide->width, pixel / (size_t)guide->width, (double)LARGEST_VALUE);
}

/* Appends the pixel's value unless an earlier pixel had it. `slots` is an open
 * hash table of site number + 1; pixels come in row-major order, so the first
 * to arrive is the lowest. */
static void add_site(StySites *sites, uint32_t *slots, size_t mask, const float value[2], uint32_t pixel) {
  const uint64_t key = get_key(value);
  size_t slot = (size_t)mix(key) & mask;
  while (slots[slot]) {
    if (get_key(sites->values + 2 * (size_t)(slots[slot] - 1)) == key) return;
    slot = (slot + 1) & mask;
  }
  memcpy(sites->values + 2 * sites->count, value, 2 * sizeof *value);
  sites->pixels[sites->count++] = pixel;
  slots[slot] = (uint32_t)sites->count;
}

static void shrink_to_fit(StySites *sites) {
  float *values = realloc(sites->values, sites->count * 2 * sizeof *values);
  if (values) sites->values = values;
  uint32_t *pixels = realloc(sites->pixels, sites->count * sizeof *pixels);
  if (pixels) sites->pixels = pixels;
}

StyStatus sty_collect_sites(const char *name, const StyImage *guide, StySites **out, StyError *error) {
  const float *covered = sty_find_channel(guide, "A");
  const float *x = sty_find_channel(guide, "normal.X"), *y = sty_find_channel(guide, "normal.Y");
  if (!covered || !x || !y)
    return sty_fail(error, STY_ERROR_INPUT, "%s: found no normals, expected channels A, normal.X and normal.Y", name);
  const size_t pixels = sty_count_pixels(guide);
  size_t points = 0;
  for (size_t i = 0; i < pixels; i++) points += covered[i] > 0;
  if (!points)
    return sty_fail(error, STY_ERROR_INPUT, "%s: found no covered pixel, expected a guide that shows something", name);

  size_t slot_count = 16;
  while (slot_count < points + points / 2) slot_count *= 2;
  StySites *sites = calloc(1, sizeof *sites);
  uint32_t *slots = calloc(slot_count, sizeof *slots);
  StyStatus status = STY_OK;
  if (sites) {
    *sites = (StySites){.width = guide->width, .height = guide->height, .point_count = points};
    sites->values = malloc(points * 2 * sizeof *sites->values);
    sites->pixels = malloc(points * sizeof *sites->pixels);
  }
  if (!sites || !slots || !sites->values || !sites->pixels)
    status = sty_fail_memory(error, name, (double)points * 12 + (double)slot_count * 4);
  for (size_t i = 0; !status && i < pixels; i++) {
    if (!(covered[i] > 0)) continue;
    status = check_value(name, guide, i, x[i], y[i], error);
    const float value[2] = {x[i] + 0.0f, y[i] + 0.0f}; /* -0 becomes 0 */
    if (!status) add_site(sites, slots, slot_count - 1, value, (uint32_t)i);
  }
  free(slots);
  if (status) {
    sty_destroy_sites(&sites);
    return status;
  }
  shrink_to_fit(sites);
  *out = sites;
  return STY_OK;
}

void sty_destroy_sites(StySites **sites) {
  if (!sites || !*sites) return;
  free((*sites)->values);
  free((*sites)->pixels);
  free(*sites);
  *sites = NULL;
}
