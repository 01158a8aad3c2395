#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "stylut/lut.h"

/* The line for the first value that can't be used. */
static StyStatus fail_value(const char *name, const StySites *sites, StyError *error) {
  size_t s = 0;
  while (fabsf(sites->values[2 * s]) <= STY_MAX_GUIDE_VALUE && fabsf(sites->values[2 * s + 1]) <= STY_MAX_GUIDE_VALUE)
    s++;
  return sty_fail(
      error, STY_ERROR_INPUT, "%s: found guide value (%g, %g) at pixel (%zu, %zu), expected finite values within %g",
      name, (double)sites->values[2 * s], (double)sites->values[2 * s + 1], sites->pixels[s] % (size_t)sites->width,
      sites->pixels[s] / (size_t)sites->width, (double)STY_MAX_GUIDE_VALUE);
}

/* Lists the covered pixels; without a branch, since at a silhouette none would be foreseen. */
static void find_covered(const float *covered, size_t pixels, StySites *sites) {
  size_t count = 0;
  for (size_t i = 0; i < pixels; i++) {
    sites->pixels[count] = (uint32_t)i;
    count += covered[i] > 0;
  }
  sites->count = count;
}

/* Copies their values; -0 becomes 0. False: one can't be used. */
static bool copy_values(const float *x, const float *y, StySites *sites) {
  int unusable = 0;
  for (size_t s = 0; s < sites->count; s++) {
    const uint32_t pixel = sites->pixels[s];
    const float vx = x[pixel] + 0.0f, vy = y[pixel] + 0.0f;
    unusable |= !(fabsf(vx) <= STY_MAX_GUIDE_VALUE) | !(fabsf(vy) <= STY_MAX_GUIDE_VALUE);
    sites->values[2 * s] = vx;
    sites->values[2 * s + 1] = vy;
  }
  return !unusable;
}

/* The bytes whose values these are; not 0 where one is something else. Without
 * branches, so that it becomes vectors. */
static int get_levels(const float *values, size_t count, uint8_t *out) {
  int wrong = 0;
  for (size_t i = 0; i < count; i++) {
    const int level = (int)((values[i] + 1) * 127.5f + 0.5f);
    wrong |= (level & ~255) | ((float)(2 * level - 255) / 255.0f != values[i]);
    out[i] = (uint8_t)level;
  }
  return wrong;
}

/* The bytes of all values, or NULL where one is something else. */
static StyStatus find_levels(StySites *sites, StyError *error) {
  enum { CHUNK = 4096 };
  const size_t count = 2 * sites->count;
  uint8_t *levels = sty_allocate_large(count);
  if (!levels) return sty_fail_memory(error, "guide levels", (double)count);
  bool all = true;
  for (size_t begin = 0; all && begin < count; begin += CHUNK)
    all = !get_levels(sites->values + begin, count - begin < CHUNK ? count - begin : CHUNK, levels + begin);
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
  StySites *sites = calloc(1, sizeof *sites);
  if (sites) {
    *sites = (StySites){.width = guide->width, .height = guide->height};
    sites->pixels = sty_allocate_large((pixels + 1) * sizeof *sites->pixels);
  }
  StyStatus status = STY_OK;
  if (!sites || !sites->pixels) status = sty_fail_memory(error, name, (double)pixels * 12);
  if (!status) {
    find_covered(covered, pixels, sites);
    if (!sites->count)
      status =
          sty_fail(error, STY_ERROR_INPUT, "%s: found no covered pixel, expected a guide that shows something", name);
  }
  if (!status) {
    sites->values = sty_allocate_large(sites->count * 2 * sizeof *sites->values);
    if (!sites->values) status = sty_fail_memory(error, name, (double)pixels * 12);
  }
  if (!status && !copy_values(x, y, sites)) status = fail_value(name, sites, error);
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
