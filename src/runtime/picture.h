/* What passes over pictures share: components, patterns, frames read without a bundle. */
#ifndef STYLUT_RUNTIME_PICTURE_H
#define STYLUT_RUNTIME_PICTURE_H

#include "view.h"

/* The largest integer whose square is at most `value`. */
static inline int find_root(uint32_t value) {
  uint32_t root = 0;
  for (uint32_t bit = 1u << 15; bit > 0; bit >>= 1)
    if ((root + bit) * (root + bit) <= value) root += bit;
  return (int)root;
}

static inline int find_remainder(int value, int divisor) {
  const int remainder = value % divisor;
  return remainder < 0 ? remainder + divisor : remainder;
}

/* The texel of a pattern at a place in its endless repetition. */
static inline const uint8_t *get_texel(const StyPattern *pattern, int x, int y, int texel_size) {
  const int column = find_remainder(x, pattern->width), row = find_remainder(y, pattern->height);
  return pattern->texels + ((size_t)row * (size_t)pattern->width + (size_t)column) * (size_t)texel_size;
}

static inline bool is_pattern_valid(const StyPattern *pattern) {
  return !pattern->texels || (pattern->width >= 1 && pattern->height >= 1 && pattern->width <= STY_MAX_PATTERN_SIDE &&
                              pattern->height <= STY_MAX_PATTERN_SIDE);
}

static inline bool is_within(int value, int lowest, int highest) { return value >= lowest && value <= highest; }

static inline bool is_covered(const StyFrame *frame, size_t index) { return frame->guide[4 * index + 3] > 0; }

static inline int measure_difference(const uint8_t *a, const uint8_t *b) {
  int sum = 0;
  for (int c = 0; c < 3; c++) sum += a[c] > b[c] ? a[c] - b[c] : b[c] - a[c];
  return sum;
}

/* Whether passes without a bundle can read a frame. */
static inline bool is_plain_frame_valid(const StyFrame *frame, StyRect rect) {
  if (!frame || !frame->guide || !is_size_valid(frame->width, frame->height) || frame->anchor_count < 0 ||
      !is_rect_inside(rect, frame->width, frame->height))
    return false;
  for (int i = 0; frame->anchors && i < 2 * frame->anchor_count; i++)
    if (!is_within(frame->anchors[i], -STY_MAX_ANCHOR, STY_MAX_ANCHOR)) return false;
  return true;
}

/* Components of pictures of 8 or 16 bits. */
static inline uint32_t read_component(const void *picture, int bits, size_t i) {
  return bits == 8 ? ((const uint8_t *)picture)[i] : ((const uint16_t *)picture)[i];
}

static inline void write_component(void *picture, int bits, size_t i, uint64_t value) {
  if (bits == 8)
    ((uint8_t *)picture)[i] = (uint8_t)value;
  else
    ((uint16_t *)picture)[i] = (uint16_t)value;
}

#endif
