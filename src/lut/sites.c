#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "lut/engine.h"

/* What is collected, and from where. */
typedef struct Collection {
  const char *name;
  const StyImage *guide;
  const float *covered, *planes[STY_MOST_DIMS];
  StyFeature features[STY_MOST_DIMS];
  int dims;
} Collection;

/* ---- channels ----------------------------------------------------------------- */

static StyStatus fail_channel(const Collection *c, const char *channel, StyError *error) {
  char there[512] = "";
  for (int i = 0; i < c->guide->channel_count && strlen(there) < sizeof there - STY_MAX_NAME - 2; i++) {
    const size_t used = strlen(there);
    snprintf(there + used, sizeof there - used, "%s%s", i ? ", " : "", c->guide->names[i]);
  }
  return sty_fail(error, STY_ERROR_INPUT, "%s: found no channel %s, expected one of %s", c->name, channel, there);
}

static StyStatus add_channel(Collection *c, const char *channel, float weight, StyError *error) {
  if (c->dims == STY_MOST_DIMS)
    return sty_fail(error, STY_ERROR_USAGE, "%s: found more than %d channels to compare, expected at most that",
                    c->name, STY_MOST_DIMS);
  for (int k = 0; k < c->dims; k++)
    if (strcmp(c->features[k].channel, channel) == 0)
      return sty_fail(error, STY_ERROR_USAGE, "%s: found channel %s twice, expected it once", c->name, channel);
  StyFeature *feature = &c->features[c->dims];
  *feature = (StyFeature){.weight = weight};
  strcpy(feature->channel, channel);
  c->planes[c->dims++] = sty_find_channel(c->guide, channel);
  return STY_OK;
}

/* The channel of this name, or, unless it is `exact`, all that are called NAME.something. */
static StyStatus add_feature(Collection *c, const StyFeature *feature, bool exact, StyError *error) {
  const char *name = feature->channel;
  if (!(feature->weight > 0 && feature->weight <= 1000))
    return sty_fail(error, STY_ERROR_USAGE, "%s: found weight %g of %s, expected one above 0, at most 1000", c->name,
                    (double)feature->weight, name);
  if (sty_find_channel(c->guide, name)) return add_channel(c, name, feature->weight, error);
  const size_t length = strlen(name);
  const int before = c->dims;
  StyStatus status = STY_OK;
  for (int i = 0; !status && !exact && i < c->guide->channel_count; i++) {
    const char *channel = c->guide->names[i];
    if (strncmp(channel, name, length) == 0 && channel[length] == '.')
      status = add_channel(c, channel, feature->weight, error);
  }
  return !status && c->dims == before ? fail_channel(c, name, error) : status;
}

static StyStatus find_channels(Collection *c, const StyFeature *features, int count, bool exact, StyError *error) {
  c->covered = sty_find_channel(c->guide, "A");
  if (!c->covered) return fail_channel(c, "A", error);
  StyStatus status = STY_OK;
  for (int f = 0; !status && f < count; f++) status = add_feature(c, &features[f], exact, error);
  return status;
}

/* ---- values ------------------------------------------------------------------- */

/* The line for the first value that can't be used. */
static StyStatus fail_value(const Collection *c, const StySites *sites, StyError *error) {
  size_t v = 0;
  while (fabsf(sites->values[v]) <= STY_MAX_GUIDE_VALUE) v++;
  const size_t k = v % (size_t)c->dims, pixel = sites->pixels[v / (size_t)c->dims], width = (size_t)c->guide->width;
  char times[32] = "";
  if (c->features[k].weight != 1) snprintf(times, sizeof times, " times %g", (double)c->features[k].weight);
  return sty_fail(error, STY_ERROR_INPUT, "%s: found %s = %g%s at pixel (%zu, %zu), expected a finite value within %g",
                  c->name, c->features[k].channel, (double)c->planes[k][pixel], times, pixel % width, pixel / width,
                  (double)STY_MAX_GUIDE_VALUE);
}

/* Lists the covered pixels; without a branch, since at a silhouette none would be foreseen.
 * False: a coverage isn't a number. */
static bool find_covered(const Collection *c, StySites *sites) {
  const size_t pixels = sty_count_pixels(c->guide);
  size_t count = 0, odd = 0;
  for (size_t i = 0; i < pixels; i++) {
    sites->pixels[count] = (uint32_t)i;
    count += c->covered[i] > 0;
    odd += isnan(c->covered[i]) != 0;
  }
  sites->count = count;
  return !odd;
}

static StyStatus fail_coverage(const Collection *c, StyError *error) {
  const size_t width = (size_t)c->guide->width;
  size_t i = 0;
  while (!isnan(c->covered[i])) i++;
  return sty_fail(error, STY_ERROR_INPUT, "%s: found A = nan at pixel (%zu, %zu), expected a coverage of 0 or 1",
                  c->name, i % width, i / width);
}

/* Copies their values; -0 becomes 0. False: one can't be used. */
static inline bool copy_values(const Collection *c, int dims, StySites *sites) {
  int unusable = 0;
  for (size_t s = 0; s < sites->count; s++)
    for (int k = 0; k < dims; k++) {
      const float value = c->planes[k][sites->pixels[s]] * c->features[k].weight + 0.0f;
      unusable |= !(fabsf(value) <= STY_MAX_GUIDE_VALUE);
      sites->values[(size_t)dims * s + (size_t)k] = value;
    }
  return !unusable;
}

static StyStatus create_sites(const Collection *c, StySites **out, StyError *error) {
  const size_t pixels = sty_count_pixels(c->guide), dims = (size_t)c->dims;
  StySites *sites = calloc(1, sizeof *sites);
  bool numbers = true;
  if (sites) {
    *sites = (StySites){.width = c->guide->width, .height = c->guide->height, .dims = c->dims};
    sites->pixels = sty_allocate_large((pixels + 1) * sizeof *sites->pixels);
    sites->features = malloc(dims * sizeof *sites->features);
  }
  if (sites && sites->pixels) {
    numbers = find_covered(c, sites);
    sites->values = sty_allocate_large(sites->count * dims * sizeof *sites->values);
  }
  if (!sites || !sites->values || !sites->features) {
    sty_destroy_sites(&sites);
    return sty_fail_memory(error, c->name, (double)pixels * (double)(dims + 1) * 4);
  }
  if (!numbers) {
    sty_destroy_sites(&sites);
    return fail_coverage(c, error);
  }
  memcpy(sites->features, c->features, dims * sizeof *sites->features);
  *out = sites;
  return STY_OK;
}

static StyStatus collect(const Collection *c, bool may_be_empty, StySites **out, StyError *error) {
  StySites *sites = NULL;
  StyStatus status = create_sites(c, &sites, error);
  if (status) return status;
  if (!sites->count && !may_be_empty)
    status =
        sty_fail(error, STY_ERROR_INPUT, "%s: found no covered pixel, expected a guide that shows something", c->name);
  else if (!(c->dims == 2 ? copy_values(c, 2, sites) : copy_values(c, c->dims, sites)))
    status = fail_value(c, sites, error);
  if (status)
    sty_destroy_sites(&sites);
  else
    *out = sites;
  return status;
}

/* ---- levels ------------------------------------------------------------------- */

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

/* ---- the whole ---------------------------------------------------------------- */

StyStatus sty_collect_sites(const char *name, const StyImage *guide, StySites **out, StyError *error) {
  static const StyFeature normals[] = {{"normal.X", 1}, {"normal.Y", 1}};
  Collection c = {.name = name, .guide = guide};
  if (find_channels(&c, normals, 2, true, NULL))
    return sty_fail(error, STY_ERROR_INPUT, "%s: found no normals, expected channels A, normal.X and normal.Y", name);
  StySites *sites = NULL;
  StyStatus status = collect(&c, false, &sites, error);
  if (!status) status = find_levels(sites, error);
  if (status)
    sty_destroy_sites(&sites);
  else
    *out = sites;
  return status;
}

StyStatus sty_collect_features(const char *name, const StyImage *guide, const StyFeature *features, int count,
                               StySites **out, StyError *error) {
  Collection c = {.name = name, .guide = guide};
  if (count < 1) return sty_fail(error, STY_ERROR_USAGE, "%s: found no channels to compare, expected some", name);
  const StyStatus status = find_channels(&c, features, count, false, error);
  return status ? status : collect(&c, false, out, error);
}

StyStatus sty_collect_target(const char *name, const StyImage *guide, const StySites *source, StySites **out,
                             StyError *error) {
  Collection c = {.name = name, .guide = guide};
  const StyStatus status = find_channels(&c, source->features, source->dims, true, error);
  return status ? status : collect(&c, true, out, error);
}

void sty_destroy_sites(StySites **sites) {
  if (!sites || !*sites) return;
  free((*sites)->values);
  free((*sites)->pixels);
  free((*sites)->levels);
  free((*sites)->features);
  free(*sites);
  *sites = NULL;
}
