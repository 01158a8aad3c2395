#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "lut/engine.h"

const char *const sty_sampling_names[] = {"centre", "unorm8", "corner", NULL};
const char *const sty_map_names[] = {"xy", "equal-area", NULL};
const char *const sty_metric_names[] = {"xy", "angle", NULL};

StyStatus sty_allocate_lut(const StyLutSpec *spec, int source_width, int source_height, StyLut **out, StyError *error) {
  if (source_width < 1 || source_height < 1 || source_width > STY_MAX_SIDE || source_height > STY_MAX_SIDE)
    return sty_fail(error, STY_ERROR_INPUT, "LUT: found a source of %d x %d pixels, expected sides of 1 to %d",
                    source_width, source_height, STY_MAX_SIDE);
  const size_t texels = sty_count_texels(spec);
  StyLut *lut = calloc(1, sizeof *lut);
  if (lut) {
    *lut = (StyLut){.spec = *spec, .source_width = source_width, .source_height = source_height};
    lut->pixels = sty_allocate_large(texels * sizeof *lut->pixels);
    lut->errors = sty_allocate_large(texels * sizeof *lut->errors);
  }
  if (!lut || !lut->pixels || !lut->errors) {
    sty_destroy_lut(&lut);
    return sty_fail_memory(error, "LUT", (double)texels * 8);
  }
  *out = lut;
  return STY_OK;
}

static void clear_texels(StyLut *lut) {
  const size_t texels = sty_count_texels(&lut->spec);
  memset(lut->pixels, 0, texels * sizeof *lut->pixels);
  memset(lut->errors, 0, texels * sizeof *lut->errors);
}

StyStatus sty_check_spec(const StyLutSpec *spec, StyError *error) {
  const int smallest = spec->sampling == STY_SAMPLE_UNORM8 ? 2 : 1;
  const int shorter = spec->width < spec->height ? spec->width : spec->height;
  const int longer = spec->width > spec->height ? spec->width : spec->height;
  if (shorter < smallest || longer > STY_MAX_LUT_SIZE)
    return sty_fail(error, STY_ERROR_USAGE, "LUT size: found %d, expected %d to %d",
                    shorter < smallest ? shorter : longer, smallest, STY_MAX_LUT_SIZE);
  if (spec->sampling != STY_SAMPLE_CENTRE && spec->map != STY_MAP_XY)
    return sty_fail(error, STY_ERROR_USAGE, "LUT: found sampling %s with map %s, expected sampling centre",
                    sty_sampling_names[spec->sampling], sty_map_names[spec->map]);
  return STY_OK;
}

StyStatus sty_create_lut(const StyLutSpec *spec, int source_width, int source_height, StyLut **out, StyError *error) {
  StyStatus status = sty_check_spec(spec, error);
  if (!status) status = sty_allocate_lut(spec, source_width, source_height, out, error);
  if (!status) clear_texels(*out);
  return status;
}

StyStatus sty_create_cube(int size, const StyFeature axes[3], int source_width, int source_height, StyLut **out,
                          StyError *error) {
  if (size < 1 || size > STY_MAX_CUBE)
    return sty_fail(error, STY_ERROR_USAGE, "LUT size: found %d, expected 1 to %d for three dimensions", size,
                    STY_MAX_CUBE);
  const StyLutSpec spec = {size, size * size, STY_SAMPLE_CENTRE, STY_MAP_XY, STY_METRIC_XY};
  StyLut *lut = NULL;
  const StyStatus status = sty_allocate_lut(&spec, source_width, source_height, &lut, error);
  if (status) return status;
  clear_texels(lut);
  lut->depth = size;
  memcpy(lut->axes, axes, sizeof lut->axes);
  *out = lut;
  return STY_OK;
}

void sty_destroy_lut(StyLut **lut) {
  if (!lut || !*lut) return;
  free((*lut)->pixels);
  free((*lut)->errors);
  free(*lut);
  *lut = NULL;
}

/* Where texel (i, j) looks, in the table's square. */
static void get_place(const StyLutSpec *spec, int i, int j, float place[2]) {
  const int columns = spec->width, rows = spec->height;
  if (spec->sampling == STY_SAMPLE_CENTRE) {
    place[0] = (float)(2 * i + 1 - columns) / (float)columns;
    place[1] = (float)(rows - 2 * j - 1) / (float)rows;
  } else if (spec->sampling == STY_SAMPLE_UNORM8) {
    place[0] = (float)(2 * i - (columns - 1)) / (float)(columns - 1);
    place[1] = (float)((rows - 1) - 2 * j) / (float)(rows - 1);
  } else {
    place[0] = (float)(2 * i - columns) / (float)columns;
    place[1] = (float)(rows - 2 * j - 2) / (float)rows;
  }
}

static float square_length(const float v[2]) { return v[0] * v[0] + v[1] * v[1]; }

void sty_get_texel_value(const StyLutSpec *spec, int i, int j, float g[2]) {
  get_place(spec, i, j, g);
  if (spec->map == STY_MAP_XY) return;
  const float squared = square_length(g), stretch = squared > 1 ? 1 / sqrtf(squared) : sqrtf(2 - squared);
  g[0] *= stretch;
  g[1] *= stretch;
}

float sty_get_axis_start(const char *channel) { return strncmp(channel, "normal.", 7) == 0 ? -1 : 0; }

/* `step` of the steps 0, 1, ... along an axis. */
static float get_axis_value(const StyLut *lut, int axis, int step) {
  return sty_get_axis_start(lut->axes[axis].channel) < 0 ? (float)(2 * step + 1 - lut->depth) / (float)lut->depth
                                                         : (float)(2 * step + 1) / (float)(2 * lut->depth);
}

void sty_get_cube_value(const StyLut *lut, int i, int j, int k, float g[3]) {
  g[0] = get_axis_value(lut, 0, i);
  g[1] = get_axis_value(lut, 1, lut->depth - 1 - j);
  g[2] = get_axis_value(lut, 2, k);
}

double sty_get_jump(const StyLutSpec *spec, int source_width, int source_height) {
  const double source = source_width > source_height ? source_width : source_height;
  const double table = spec->width > spec->height ? spec->width : spec->height;
  return source > table / 4 ? 4 * source / table : 1;
}

bool sty_is_feasible(const StyLutSpec *spec, int i, int j) {
  float place[2];
  get_place(spec, i, j, place);
  return square_length(place) <= 1;
}

static int clamp_texel(float t, int size) { return t > 0 ? t < (float)size ? (int)t : size - 1 : 0; }

void sty_find_texel(const StyLutSpec *spec, const float g[2], int t[2]) {
  float place[2] = {g[0], g[1]};
  if (spec->map == STY_MAP_EQUAL_AREA) {
    /* Lambert's map: the normal over sqrt(1+z). */
    const float squared = square_length(g);
    const float shrink = squared > 1 ? 1 / sqrtf(squared) : 1 / sqrtf(1 + sqrtf(1 - squared));
    place[0] *= shrink;
    place[1] *= shrink;
  }
  const float h[2] = {place[0] * 0.5f + 0.5f, 0.5f - place[1] * 0.5f};
  const int sides[2] = {spec->width, spec->height};
  for (int k = 0; k < 2; k++)
    t[k] = spec->sampling == STY_SAMPLE_UNORM8 ? clamp_texel(roundf(h[k] * (float)(sides[k] - 1)), sides[k])
                                               : clamp_texel(floorf(h[k] * (float)sides[k]), sides[k]);
}
