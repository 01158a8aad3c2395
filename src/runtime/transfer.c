#include "view.h"

typedef struct Point {
  int x, y;
} Point;

/* Where a coordinate g in [-1,1] falls along a LUT's side. Called with gx for
 * the column and with -gy for the row, since rows count from the top. */
static int address_fine(float g, int side, unsigned flags) {
  if (g != g) g = 0;
  g = g < -1 ? -1 : g > 1 ? 1 : g;
  float unit = g * 0.5f + 0.5f;
  int cells = flags & STY_FLAG_UNORM8 ? (int)(unit * (float)(side - 1) + 0.5f) : (int)(unit * (float)side);
  return cells < side ? cells : side - 1;
}

/* The same for a byte that stands for g = (2b-255)/255. 255 is odd, so rounding
 * never meets a tie and 255 - b may stand in for -g. */
static int address_byte(int b, int side, unsigned flags) {
  int cells = flags & STY_FLAG_UNORM8 ? (2 * b * (side - 1) + 255) / 510 : b * side / 255;
  return cells < side ? cells : side - 1;
}

static int decode_coordinate(uint32_t value, int side) {
  int coordinate = (int)(value * (uint32_t)side / 65535);
  return coordinate < side ? coordinate : side - 1;
}

/* LUT(guide at a frame's pixel). */
static Point look_up(const Source *source, const StyFrame *frame, size_t index) {
  int side = source->lut_side, column, row;
  unsigned flags = source->style.flags;
  if (frame->fine) {
    column = address_fine(frame->fine[index * 2], side, flags);
    row = address_fine(-frame->fine[index * 2 + 1], side, flags);
  } else {
    column = address_byte(frame->guide[index * 4], side, flags);
    row = address_byte(255 - frame->guide[index * 4 + 1], side, flags);
  }
  const unsigned char *texel = source->lut + ((size_t)row * (size_t)side + (size_t)column) * 4;
  return (Point){decode_coordinate(read_u16(texel), source->width),
                 decode_coordinate(read_u16(texel + 2), source->height)};
}

/* floor(h * (b + jitter/255)): h*b is whole, so only the jitter is rounded. */
static Point place_seed(const unsigned char *jitter, int cell_x, int cell_y, int h) {
  size_t column = (unsigned)cell_x % STY_JITTER_SIZE, row = (unsigned)cell_y % STY_JITTER_SIZE;
  const unsigned char *j = jitter + (row * STY_JITTER_SIZE + column) * 2;
  return (Point){h * cell_x + h * j[0] / 255, h * cell_y + h * j[1] / 255};
}

/* The order of the loops and the strict comparison decide between seeds that
 * are equally near. */
static Point find_nearest_seed(const unsigned char *jitter, Point p, int h) {
  Point nearest = {0, 0};
  int least = INT32_MAX;
  for (int dx = -1; dx <= 1; dx++)
    for (int dy = -1; dy <= 1; dy++) {
      Point seed = place_seed(jitter, p.x / h + dx, p.y / h + dy, h);
      int distance = (seed.x - p.x) * (seed.x - p.x) + (seed.y - p.y) * (seed.y - p.y);
      if (distance < least) {
        least = distance;
        nearest = seed;
      }
    }
  return nearest;
}

static int sum_differences(const unsigned char *a, const unsigned char *b) {
  int sum = 0;
  for (int channel = 0; channel < 3; channel++)
    sum += a[channel] > b[channel] ? a[channel] - b[channel] : b[channel] - a[channel];
  return sum;
}

static StyMatch match_pixel(const Source *source, const unsigned char *jitter, const StyFrame *frame, Point p) {
  size_t index = get_pixel_index(frame, p.x, p.y);
  for (int level = source->style.top_level; level >= 0; level--) {
    Point seed = find_nearest_seed(jitter, p, 1 << level);
    if (!contains_pixel(frame, seed.x, seed.y)) continue;
    size_t seed_index = get_pixel_index(frame, seed.x, seed.y);
    if (frame->guide[seed_index * 4 + 3] == 0) continue;
    Point found = look_up(source, frame, seed_index);
    Point candidate = {found.x + p.x - seed.x, found.y + p.y - seed.y};
    const unsigned char *texel = find_source_texel(source, candidate.x, candidate.y);
    if (texel && sum_differences(frame->guide + index * 4, texel) < source->style.threshold)
      return (StyMatch){(uint16_t)candidate.x, (uint16_t)candidate.y, (uint8_t)level};
  }
  Point own = look_up(source, frame, index);
  return (StyMatch){(uint16_t)own.x, (uint16_t)own.y, STY_LEVEL_FALLBACK};
}

StyRuntimeStatus sty_transfer_frame(const StyBundle *bundle, const StyFrame *frame, StyRect rect, StyMatch *matches) {
  if (!matches || !is_frame_valid(bundle, frame, rect)) return STY_RUNTIME_BAD_ARGUMENT;

  const StyTexture *tables = &bundle->textures[STY_BUNDLE_JITTER];
  const unsigned char *jitter = get_layer(tables, (size_t)frame->jitter_frame % tables->layers);
  Source source;
  int opened = 0;
  for (int y = rect.y0; y < rect.y1; y++)
    for (int x = rect.x0; x < rect.x1; x++) {
      size_t index = get_pixel_index(frame, x, y);
      int style = get_pixel_style(bundle, frame, index);
      if (style == 0) {
        matches[index] = (StyMatch){STY_NO_SOURCE, STY_NO_SOURCE, STY_LEVEL_NONE};
        continue;
      }
      if (style != opened) {
        StyRuntimeStatus status = open_source(bundle, style, &source);
        if (status != STY_RUNTIME_OK) return status;
        opened = style;
      }
      matches[index] = match_pixel(&source, jitter, frame, (Point){x, y});
    }
  return STY_RUNTIME_OK;
}
