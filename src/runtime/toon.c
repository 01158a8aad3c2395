#include "matching.h"
#include "picture.h"

/* The turn of the cell around a seed, for one object. */
typedef struct Turn {
  Point seed;       /* in the frame */
  int object;       /* -1: none is known yet */
  int cosine, sine; /* 4096ths */
} Turn;

/* Turns worked out lately: neighbouring pixels share theirs. Which are kept changes nothing but time. */
enum { KEPT_TURNS = 64 };

typedef struct Shading {
  const StyFrame *frame;
  const StyToon *toon;
  Turn turns[KEPT_TURNS];
} Shading;

/* The differences of normals between samples along one axis. */
typedef struct Slope {
  int sum, pairs; /* 64ths of a byte */
} Slope;

/* The guide of the sample, or NULL where it doesn't count. */
static const uint8_t *find_sample(const Shading *shading, const Turn *cell, int column, int row) {
  const StyFrame *frame = shading->frame;
  const int step = 1 << (shading->toon->cell_level - STY_MIN_CELL_LEVEL);
  const int x = cell->seed.x + step * (column - 2), y = cell->seed.y + step * (row - 2);
  if (!contains_pixel(frame, x, y)) return NULL;
  const size_t index = get_pixel_index(frame, x, y);
  return is_covered(frame, index) && get_object(frame, index) == cell->object ? frame->guide + 4 * index : NULL;
}

static void add_pair(Slope *slope, const uint8_t *a, const uint8_t *b) {
  if (!a || !b) return;
  uint32_t squared = 0;
  for (int c = 0; c < 3; c++) squared += (uint32_t)((a[c] - b[c]) * (a[c] - b[c]));
  slope->sum += find_root(4096 * squared);
  slope->pairs++;
}

/* Less than half a byte, on the mean, is how a plane is rounded. */
static bool is_flat(const Slope *slope) { return slope->sum < 32 * slope->pairs || slope->pairs == 0; }

static void turn_cell(const Shading *shading, Turn *cell) {
  Slope along[2] = {{0, 0}, {0, 0}};
  for (int row = 0; row < 5; row++)
    for (int column = 0; column < 5; column++) {
      const uint8_t *sample = find_sample(shading, cell, column, row);
      if (column < 4) add_pair(&along[0], sample, find_sample(shading, cell, column + 1, row));
      if (row < 4) add_pair(&along[1], sample, find_sample(shading, cell, column, row + 1));
    }
  cell->cosine = 4096;
  cell->sine = 0;
  if (is_flat(&along[0]) && is_flat(&along[1])) return;
  const bool both = along[0].pairs > 0 && along[1].pairs > 0;
  int u = along[0].sum * (both ? along[1].pairs : 1), v = along[1].sum * (both ? along[0].pairs : 1);
  while (u >= 2048 || v >= 2048) u /= 2, v /= 2;
  const int length = find_root(256 * (uint32_t)(u * u + v * v));
  cell->cosine = 65536 * u / length;
  cell->sine = 65536 * v / length;
}

static const Turn *find_turn(Shading *shading, Point seed, int object) {
  const unsigned slot = ((unsigned)seed.x * 31u + (unsigned)seed.y * 17u + (unsigned)object) % KEPT_TURNS;
  Turn *turn = &shading->turns[slot];
  if (turn->object != object || turn->seed.x != seed.x || turn->seed.y != seed.y) {
    *turn = (Turn){.seed = seed, .object = object};
    turn_cell(shading, turn);
  }
  return turn;
}

/* Where in the pattern a pixel lies. */
static Point place_pixel(Shading *shading, int x, int y, size_t index) {
  const StyToon *toon = shading->toon;
  const Point anchor = get_anchor(shading->frame, index), p = {x - anchor.x, y - anchor.y};
  if (toon->cell_level == 0) return p;
  const Point seed = find_seed(toon->jitter, toon->jitter_amount, p, toon->cell_level);
  const Turn *turn =
      find_turn(shading, (Point){seed.x + anchor.x, seed.y + anchor.y}, get_object(shading->frame, index));
  const int dx = p.x - seed.x, dy = p.y - seed.y;
  return (Point){seed.x + shift_down(dx * turn->cosine + dy * turn->sine + 2048, 12),
                 seed.y + shift_down(dy * turn->cosine - dx * turn->sine + 2048, 12)};
}

static const uint8_t *choose_band(Shading *shading, int x, int y, size_t index) {
  const StyToon *toon = shading->toon;
  int luma = 256 * shading->frame->luma[index], band = 0;
  if (toon->pattern.texels && toon->pattern_weight > 0) {
    const Point place = place_pixel(shading, x, y, index);
    luma += toon->pattern_weight * (*get_texel(&toon->pattern, place.x, place.y, 1) - 128);
  }
  for (int i = 0; i < toon->band_count - 1; i++) band += 256 * toon->thresholds[i] <= luma;
  return toon->colours[band];
}

static bool is_shaded(const Shading *shading, size_t index) {
  const StyFrame *frame = shading->frame;
  const int style = frame->styles ? frame->styles[index] : frame->style;
  return is_covered(frame, index) && (shading->toon->style == 0 || shading->toon->style == style);
}

static void shade_pixel(Shading *shading, int x, int y, int bits, void *out) {
  const StyFrame *frame = shading->frame;
  const size_t index = get_pixel_index(frame, x, y);
  const uint64_t scale = bits == 8 ? 1 : 257, whole = 255 * 256;
  if (!is_shaded(shading, index)) {
    for (size_t c = 0; c < 4; c++) write_component(out, bits, 4 * index + c, 0);
    return;
  }
  const uint8_t *colour = choose_band(shading, x, y, index), *albedo = frame->albedo;
  const uint64_t weight = (uint64_t)shading->toon->colour_weight;
  for (size_t c = 0; c < 3; c++) {
    const uint64_t factor = albedo ? 255 * (256 - weight) + weight * albedo[4 * index + c] : whole;
    write_component(out, bits, 4 * index + c, (colour[c] * factor * scale + whole / 2) / whole);
  }
  write_component(out, bits, 4 * index + 3, (colour[3] * frame->guide[4 * index + 3] * scale + 127) / 255);
}

static bool is_toon_valid(const StyToon *toon) {
  return toon && is_within(toon->band_count, 1, STY_MAX_BANDS) && is_within(toon->colour_weight, 0, 256) &&
         is_within(toon->style, 0, STY_MAX_STYLES) && is_pattern_valid(&toon->pattern) &&
         is_within(toon->pattern_weight, 0, STY_MAX_PATTERN_WEIGHT) && is_within(toon->jitter_amount, 0, 255) &&
         (toon->cell_level == 0 ||
          (toon->jitter && is_within(toon->cell_level, STY_MIN_CELL_LEVEL, STY_MAX_CELL_LEVEL)));
}

StyRuntimeStatus sty_shade_toon(const StyFrame *frame, const StyToon *toon, StyRect rect, int bits, void *out) {
  if (!out || (bits != 8 && bits != 16) || !is_plain_frame_valid(frame, rect) || !frame->luma || !is_toon_valid(toon))
    return STY_RUNTIME_BAD_ARGUMENT;
  Shading shading = {.frame = frame, .toon = toon};
  for (int i = 0; i < KEPT_TURNS; i++) shading.turns[i].object = -1;
  for (int y = rect.y0; y < rect.y1; y++)
    for (int x = rect.x0; x < rect.x1; x++) shade_pixel(&shading, x, y, bits, out);
  return STY_RUNTIME_OK;
}
