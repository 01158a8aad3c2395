#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "lut/engine.h"

StyMeasure sty_choose_measure(const StySites *sites, const StyLutSpec *spec) {
  const bool angle = spec->metric == STY_METRIC_ANGLE;
  if (!sites->levels || angle || spec->map != STY_MAP_XY || spec->width != spec->height)
    return (StyMeasure){.dims = angle ? 3 : sites->dims, .angle = angle, .unit = 1};
  /* With L texels: 255(2i+1) - 2L b for centres; 255 i - (L-1) b for bytes; 255 i - L b for corners. */
  const bool centre = spec->sampling == STY_SAMPLE_CENTRE;
  const int n = spec->sampling == STY_SAMPLE_UNORM8 ? spec->width - 1 : spec->width;
  return (StyMeasure){
      .dims = 2, .integer = true, .scale = centre ? 2 * n : n, .unit = (centre ? 1.0 : 2.0) / (255.0 * n)};
}

void sty_lift(int dims, const float g[2], float out[3]) {
  out[0] = g[0];
  out[1] = g[1];
  if (dims == 2) return;
  const float squared = g[0] * g[0] + g[1] * g[1];
  if (squared > 1) {
    const float length = sqrtf(squared);
    /* What vanishes may leave a -0, which isn't to be another value than 0. */
    out[0] = out[0] / length + 0.0f;
    out[1] = out[1] / length + 0.0f;
  }
  out[2] = sty_get_height(out[0], out[1]);
}

float sty_get_height(float x, float y) {
  const float rest = 1 - (x * x + y * y);
  return rest > 0 ? sqrtf(rest) : 0;
}

void sty_get_asked_value(const StyLut *lut, int dims, int i, int j, float *g) {
  if (lut->asked) {
    const size_t texel = (size_t)j * (size_t)lut->spec.width + (size_t)i, last = lut->asked_count - 1;
    memcpy(g, lut->asked + (size_t)dims * (texel < last ? texel : last), (size_t)dims * sizeof *g);
  } else if (lut->depth) {
    sty_get_cube_value(lut, i, j % lut->depth, j / lut->depth, g);
    for (int k = 0; k < 3; k++) g[k] *= lut->axes[k].weight;
  } else {
    sty_get_texel_value(&lut->spec, i, j, g);
  }
}

/* A value of a site or texel in the metric's space. */
static void place_value(const StyMeasure *measure, const float *value, float *out) {
  if (measure->angle)
    sty_lift(3, value, out);
  else
    memcpy(out, value, (size_t)measure->dims * sizeof *out);
}

void sty_make_query(const StyMeasure *measure, const StyLut *lut, int i, int j, StyQuery *out) {
  float g[STY_MOST_DIMS];
  sty_get_asked_value(lut, measure->angle ? 2 : measure->dims, i, j, g);
  place_value(measure, g, out->at);
  if (!measure->integer) return;
  const int up = lut->spec.height - 1 - j;
  const bool centre = lut->spec.sampling == STY_SAMPLE_CENTRE;
  out->steps[0] = 255.0 * (centre ? 2 * i + 1 : i);
  out->steps[1] = 255.0 * (centre ? 2 * up + 1 : up);
}

void sty_set_texel(StyLut *lut, const StyMeasure *measure, size_t texel, uint32_t pixel, double squared) {
  lut->pixels[texel] = pixel;
  lut->errors[texel] = (float)(sqrt(squared) * measure->unit);
}

/* ---- collapsing --------------------------------------------------------------- */

static uint64_t get_hash(const float *value, size_t dims) {
  uint64_t hash = 0;
  for (size_t k = 0; k < dims; k += 2) {
    uint64_t pair = 0;
    memcpy(&pair, value + k, (dims - k < 2 ? dims - k : 2) * sizeof *value);
    hash = sty_mix_bits(hash ^ pair);
  }
  return hash;
}

/* Appends the point unless an earlier one has the same place. `slots` is an open
 * hash table of point number + 1; pixels come in ascending order, so the first
 * to arrive is the lowest. */
static bool add_point(StyPoints *points, uint32_t *slots, size_t mask, const float *value, uint32_t pixel) {
  const size_t dims = (size_t)points->measure.dims;
  size_t slot = (size_t)get_hash(value, dims) & mask;
  while (slots[slot]) {
    if (memcmp(points->values + dims * (size_t)(slots[slot] - 1), value, dims * sizeof *value) == 0) return false;
    slot = (slot + 1) & mask;
  }
  memcpy(points->values + dims * points->count, value, dims * sizeof *value);
  points->pixels[points->count++] = pixel;
  slots[slot] = (uint32_t)points->count;
  return true;
}

StyStatus sty_collapse_sites(const StySites *sites, const StyLutSpec *spec, StyPoints *out, StyError *error) {
  StyPoints points = {.measure = sty_choose_measure(sites, spec)};
  const size_t dims = (size_t)points.measure.dims;
  size_t slot_count = 16;
  while (slot_count < sites->count + sites->count / 2) slot_count *= 2;
  uint32_t *slots = calloc(slot_count, sizeof *slots);
  points.values = malloc(sites->count * dims * sizeof *points.values);
  points.pixels = malloc(sites->count * sizeof *points.pixels);
  points.levels = points.measure.integer ? malloc(sites->count * 2) : NULL;
  if (!slots || !points.values || !points.pixels || (points.measure.integer && !points.levels)) {
    free(slots);
    sty_free_points(&points);
    return sty_fail_memory(error, "LUT points", (double)sites->count * (double)(4 * dims + 8) + (double)slot_count * 4);
  }
  for (size_t s = 0; s < sites->count; s++) {
    float value[STY_MOST_DIMS];
    place_value(&points.measure, sites->values + (size_t)sites->dims * s, value);
    if (add_point(&points, slots, slot_count - 1, value, sites->pixels[s]) && points.levels)
      memcpy(points.levels + 2 * (points.count - 1), sites->levels + 2 * s, 2);
  }
  free(slots);
  *out = points;
  return STY_OK;
}

void sty_free_points(StyPoints *points) {
  free(points->values);
  free(points->pixels);
  free(points->levels);
  *points = (StyPoints){0};
}
