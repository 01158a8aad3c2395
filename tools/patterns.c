#include "patterns.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "stylut/image_io.h"
#include "stylut/pack.h"

enum { RANDOM_BYTES = 2 * STY_JITTER_SIZE * STY_JITTER_SIZE };

/* 0..256 to 0..256, level at both ends: 3t^2 - 2t^3. */
static int ease(int t) { return (int)((3 * 256 - 2 * (int64_t)t) * t * t / 65536); }

static int mix(int a, int b, int share) { return (a * (256 - share) + b * share) / 256; }

/* A byte between the random ones of a grid. */
static int raise_hill(const uint8_t *random, int channel, int x, int y, int spacing) {
  const int cells = PATTERN_SIDE / spacing, column = x / spacing, row = y / spacing;
  const int next_column = (column + 1) % cells, next_row = (row + 1) % cells;
  const int right = ease(x % spacing * 256 / spacing), down = ease(y % spacing * 256 / spacing);
  const uint8_t *above = random + 2 * row * STY_JITTER_SIZE + channel;
  const uint8_t *below = random + 2 * next_row * STY_JITTER_SIZE + channel;
  return mix(mix(above[2 * column], above[2 * next_column], right),
             mix(below[2 * column], below[2 * next_column], right), down);
}

void make_hills(uint64_t seed, int spacing, int channels, uint8_t *out) {
  uint8_t random[RANDOM_BYTES];
  sty_make_jitter(seed, random);
  for (int y = 0; y < PATTERN_SIDE; y++)
    for (int x = 0; x < PATTERN_SIDE; x++)
      for (int c = 0; c < channels; c++)
        out[channels * (y * PATTERN_SIDE + x) + c] = (uint8_t)raise_hill(random, c, x, y, spacing);
}

void make_strokes(uint64_t seed, uint8_t *out) {
  uint8_t random[RANDOM_BYTES];
  enum { BETWEEN = 8 }; /* strokes, texels */
  sty_make_jitter(seed, random);
  for (int y = 0; y < PATTERN_SIDE; y++)
    for (int x = 0; x < PATTERN_SIDE; x++) {
      const int bent = 256 * y + 4 * (raise_hill(random, 0, x, y, 32) - 128);
      const int phase = ((bent % (256 * BETWEEN)) + 256 * BETWEEN) % (256 * BETWEEN);
      const int ridge = phase < 128 * BETWEEN ? phase : 256 * BETWEEN - phase;
      const int pressure = raise_hill(random, 1, x, y, 16) - 128;
      const int value = ridge * 200 / (128 * BETWEEN) + 28 + pressure / 4;
      out[y * PATTERN_SIDE + x] = (uint8_t)(value < 0 ? 0 : value > 255 ? 255 : value);
    }
}

static StyStatus read_pattern(const char *path, StyPattern *out, StyError *error) {
  StyImage *image = NULL;
  uint8_t *rgba = NULL;
  StyStatus status = sty_read_image(path, &image, error);
  if (!status && (image->width > STY_MAX_PATTERN_SIDE || image->height > STY_MAX_PATTERN_SIDE))
    status = sty_fail(error, STY_ERROR_INPUT, "%s: found %dx%d pixels, expected at most %d a side", path, image->width,
                      image->height, STY_MAX_PATTERN_SIDE);
  if (!status && !(rgba = malloc(4 * sty_count_pixels(image))))
    status = sty_fail_memory(error, path, 4 * (double)sty_count_pixels(image));
  if (!status) status = sty_convert_to_rgba8(path, image, rgba, error);
  if (!status) {
    /* Rec. 709's weights, of encoded values: what looks grey is what counts. */
    for (size_t i = 0; i < sty_count_pixels(image); i++)
      rgba[i] = (uint8_t)((54 * rgba[4 * i] + 183 * rgba[4 * i + 1] + 19 * rgba[4 * i + 2] + 128) / 256);
    *out = (StyPattern){rgba, image->width, image->height};
  } else {
    free(rgba);
  }
  sty_destroy_image(&image);
  return status;
}

bool is_own_pattern(const char *name) { return strcmp(name, "hatch") == 0 || strcmp(name, "noise") == 0; }

StyStatus open_pattern(const char *name, uint64_t seed, StyPattern *out, StyError *error) {
  if (!is_own_pattern(name) && !strchr(name, '.') && access(name, F_OK) != 0)
    return sty_fail(error, STY_ERROR_USAGE, "--texture: found '%s', expected hatch, noise or a picture's name", name);
  if (!is_own_pattern(name)) return read_pattern(name, out, error);
  uint8_t *texels = malloc(PATTERN_SIDE * PATTERN_SIDE);
  if (!texels) return sty_fail_memory(error, name, PATTERN_SIDE * PATTERN_SIDE);
  if (strcmp(name, "hatch") == 0)
    make_strokes(seed, texels);
  else
    make_hills(seed, 8, 1, texels);
  *out = (StyPattern){texels, PATTERN_SIDE, PATTERN_SIDE};
  return STY_OK;
}
