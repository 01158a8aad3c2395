/* How one pixel is matched: the formulas of runtime.h. */
#ifndef STYLUT_RUNTIME_MATCHING_H
#define STYLUT_RUNTIME_MATCHING_H

#include "view.h"

/* Where a coordinate g in [-1,1] falls along a LUT's side. Called with gx for
 * the column and with -gy for the row, since rows count from the top. */
static inline int address_fine(float g, int side, unsigned flags) {
  if (g != g) g = 0;
  g = g < -1 ? -1 : g > 1 ? 1 : g;
  float unit = g * 0.5f + 0.5f;
  /* Rounded to half cells in one operation each, so that no processor can fuse a second one into it. */
  int cells = flags & STY_FLAG_UNORM8 ? ((int)(unit * (float)(2 * (side - 1))) + 1) / 2 : (int)(unit * (float)side);
  return cells < side ? cells : side - 1;
}

/* The same for a byte that stands for g = (2b-255)/255. 255 is odd, so rounding
 * never meets a tie and 255 - b may stand in for -g. */
static inline int address_byte(int b, int side, unsigned flags) {
  int cells = flags & STY_FLAG_UNORM8 ? (2 * b * (side - 1) + 255) / 510 : b * side / 255;
  return cells < side ? cells : side - 1;
}

static inline int decode_coordinate(uint32_t value, int side) {
  int coordinate = (int)(value * (uint32_t)side / 65535);
  return coordinate < side ? coordinate : side - 1;
}

/* LUT(guide at a frame's pixel). */
static inline Point look_up(const Source *source, const StyFrame *frame, size_t index) {
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

static inline int get_difference(int a, int b) { return a > b ? a - b : b - a; }

/* The lighting nearest to a pixel's luminance. */
static inline int choose_lighting(const Source *source, const StyFrame *frame, size_t index) {
  int chosen = 0;
  for (int i = 1; frame->luma && i < source->style.layer_count; i++)
    if (get_difference(frame->luma[index], source->luma[i]) < get_difference(frame->luma[index], source->luma[chosen]))
      chosen = i;
  return chosen;
}

/* Guides of a place that a piece was moved to, less those of where it belongs: bytes. */
typedef struct Tilt {
  int bytes[3];
} Tilt;

static inline Tilt get_tilt(const unsigned char *from, const unsigned char *to) {
  return (Tilt){{to[0] - from[0], to[1] - from[1], to[2] - from[2]}};
}

/* Whether a pixel, tilted so, takes a source pixel in this lighting. */
static inline bool accepts(const Source *source, const StyFrame *frame, size_t index, Tilt tilt, Point candidate,
                           int lighting) {
  const unsigned char *there = find_source_texel(source, candidate.x, candidate.y), *here = frame->guide + index * 4;
  if (!there) return false;
  int error = 0;
  for (int channel = 0; channel < 3; channel++)
    error += 256 * get_difference(here[channel] + tilt.bytes[channel], there[channel]);
  if (frame->luma) error += source->luma_weight * get_difference(frame->luma[index], source->luma[lighting]);
  return error < source->threshold;
}

/* LUT(guide at p) in the lighting nearest to p. */
static inline StyMatch fall_back(const Source *source, const StyFrame *frame, size_t index) {
  const Point own = look_up(source, frame, index);
  return (StyMatch){.x = (uint16_t)own.x,
                    .y = (uint16_t)own.y,
                    .level = STY_LEVEL_FALLBACK,
                    .layer = (uint8_t)choose_lighting(source, frame, index),
                    .style = source->number};
}

/* floor(h * (b + amount * jitter)): h*b is whole, so only the jitter is rounded. */
static inline Point place_seed(const unsigned char *jitter, int amount, int cell_x, int cell_y, int h) {
  const size_t column = (unsigned)cell_x % STY_JITTER_SIZE, row = (unsigned)cell_y % STY_JITTER_SIZE;
  const unsigned char *j = jitter + (row * STY_JITTER_SIZE + column) * 2;
  const int reach = h * amount;
  return (Point){h * cell_x + reach * j[0] / (255 * 255), h * cell_y + reach * j[1] / (255 * 255)};
}

/* The order of the loops and the strict comparison decide between seeds that
 * are equally near. */
static inline Point find_seed(const unsigned char *jitter, int amount, Point p, int level) {
  const int cell_x = shift_down(p.x, level), cell_y = shift_down(p.y, level);
  Point nearest = {0, 0};
  int least = INT32_MAX;
  for (int dx = -1; dx <= 1; dx++)
    for (int dy = -1; dy <= 1; dy++) {
      const Point seed = place_seed(jitter, amount, cell_x + dx, cell_y + dy, 1 << level);
      const int distance = (seed.x - p.x) * (seed.x - p.x) + (seed.y - p.y) * (seed.y - p.y);
      if (distance < least) {
        least = distance;
        nearest = seed;
      }
    }
  return nearest;
}

static inline bool looks_alike(const StyFrame *frame, size_t index, int x, int y) {
  if (!contains_pixel(frame, x, y)) return true;
  const size_t other = get_pixel_index(frame, x, y);
  if (frame->anchors && get_object(frame, index) != get_object(frame, other)) return false;
  const unsigned char *a = frame->guide + index * 4, *b = frame->guide + other * 4;
  int difference = 0;
  for (int channel = 0; channel < 3; channel++)
    difference += a[channel] > b[channel] ? a[channel] - b[channel] : b[channel] - a[channel];
  return b[3] > 0 && difference <= STY_FLAT_DIFFERENCE;
}

/* What a seed proposes to the pixels that it is nearest to. */
typedef struct Proposal {
  bool is_made, is_moved;
  Point found; /* u* */
  Tilt tilt;   /* where it is moved */
  int lighting, object;
} Proposal;

/* On flat surfaces all seeds of a level would copy the same patch: each takes it from elsewhere, as if the surface
 * faced that way there. */
static inline void scatter(const Source *source, const StyFrame *frame, Point seed, Point in_grid, int level,
                           Proposal *proposal) {
  const int reach = 2 * source->style.scatter + 1, step = (1 << level) / 2;
  const size_t index = get_pixel_index(frame, seed.x, seed.y);
  if (source->style.scatter == 0 || level < STY_SCATTER_LEVEL || !looks_alike(frame, index, seed.x - step, seed.y) ||
      !looks_alike(frame, index, seed.x + step, seed.y) || !looks_alike(frame, index, seed.x, seed.y - step) ||
      !looks_alike(frame, index, seed.x, seed.y + step))
    return;
  const size_t column = (unsigned)(in_grid.x + 128) % STY_JITTER_SIZE,
               row = (unsigned)(in_grid.y + 128) % STY_JITTER_SIZE;
  const unsigned char *j = source->jitter + (row * STY_JITTER_SIZE + column) * 2;
  const Point found = proposal->found;
  const Point moved = {found.x + reach * j[0] / 256 - source->style.scatter,
                       found.y + reach * j[1] / 256 - source->style.scatter};
  const unsigned char *from = find_source_texel(source, found.x, found.y),
                      *to = find_source_texel(source, moved.x, moved.y);
  if (!from || !to) return;
  proposal->found = moved;
  proposal->is_moved = true;
  proposal->tilt = get_tilt(from, to);
}

/* `seed` is a pixel of the frame or outside of it, `in_grid` the same less the anchor. */
static inline Proposal propose(const Source *source, const StyFrame *frame, Point seed, Point in_grid, int level) {
  Proposal proposal = {.is_made = false};
  if (!contains_pixel(frame, seed.x, seed.y)) return proposal;
  const size_t index = get_pixel_index(frame, seed.x, seed.y);
  if (frame->guide[index * 4 + 3] == 0) return proposal;
  proposal.is_made = true;
  proposal.found = look_up(source, frame, index);
  proposal.lighting = choose_lighting(source, frame, index);
  proposal.object = get_object(frame, index);
  scatter(source, frame, seed, in_grid, level, &proposal);
  return proposal;
}

#endif
