#include <math.h>
#include <stdbool.h>

#include "stylut/measure.h"

void sty_lay_on_white(const void *picture, int bits, size_t pixels, float *rgb) {
  for (size_t i = 0; i < pixels; i++) {
    float values[4];
    for (size_t c = 0; c < 4; c++)
      values[c] = bits == 8 ? (float)((const uint8_t *)picture)[4 * i + c] / 255
                            : (float)((const uint16_t *)picture)[4 * i + c] / 65535;
    for (size_t c = 0; c < 3; c++) rgb[c * pixels + i] = values[c] * values[3] + (1 - values[3]);
  }
}

/* Where a pixel of a frame was in the previous one. */
typedef struct Place {
  double x, y;
  size_t nearest; /* the pixel there */
} Place;

static bool find_place(const StyShot *shot, int x, int y, Place *out) {
  const size_t i = (size_t)y * (size_t)shot->width + (size_t)x;
  out->x = x + (shot->motion[0] ? (double)shot->motion[0][i] : 0);
  out->y = y + (shot->motion[1] ? (double)shot->motion[1][i] : 0);
  const double column = floor(out->x + 0.5), row = floor(out->y + 0.5);
  if (!(column >= 0 && row >= 0 && column < shot->width && row < shot->height)) return false;
  out->nearest = (size_t)row * (size_t)shot->width + (size_t)column;
  return true;
}

static bool is_same_surface(const StyShot *previous, size_t there, const StyShot *now, size_t here) {
  const StyMatch *a = &previous->matches[there], *b = &now->matches[here];
  if (a->level == STY_LEVEL_NONE || b->level == STY_LEVEL_NONE || a->style != b->style) return false;
  if (previous->objects && now->objects && previous->objects[there] != now->objects[here]) return false;
  if (!previous->depth || !now->depth) return true;
  const float before = previous->depth[there], after = now->depth[here];
  return before == after || fabsf(before - after) <= STY_SAME_DEPTH * fmaxf(fabsf(before), fabsf(after));
}

static double clamp_to(double value, int count) { return value < 0 ? 0 : value > count - 1 ? count - 1 : value; }

static double fetch(const StyShot *shot, size_t channel, const Place *place) {
  const size_t width = (size_t)shot->width, height = (size_t)shot->height;
  const double x = clamp_to(place->x, shot->width), y = clamp_to(place->y, shot->height);
  const size_t x0 = (size_t)x, y0 = (size_t)y;
  const size_t x1 = x0 + 1 < width ? x0 + 1 : x0, y1 = y0 + 1 < height ? y0 + 1 : y0;
  const double fx = x - (double)x0, fy = y - (double)y0;
  const float *plane = shot->rgb + channel * width * height;
  const double above = (1 - fx) * (double)plane[y0 * width + x0] + fx * (double)plane[y0 * width + x1];
  const double below = (1 - fx) * (double)plane[y1 * width + x0] + fx * (double)plane[y1 * width + x1];
  return (1 - fy) * above + fy * below;
}

static bool is_jump(const StyMatch *a, const StyMatch *b) {
  const int dx = a->x - b->x, dy = a->y - b->y;
  return dx * dx + dy * dy > STY_JUMP * STY_JUMP;
}

void sty_measure_warp(const StyShot *previous, const StyShot *now, StyWarp *out) {
  const size_t pixels = (size_t)now->width * (size_t)now->height;
  double sum = 0, squares = 0;
  size_t count = 0, jumps = 0;
  for (size_t i = 0; i < pixels; i++) {
    Place place;
    if (!find_place(now, (int)(i % (size_t)now->width), (int)(i / (size_t)now->width), &place) ||
        !is_same_surface(previous, place.nearest, now, i))
      continue;
    for (size_t c = 0; c < 3; c++) {
      const double difference = (double)now->rgb[c * pixels + i] - fetch(previous, c, &place);
      sum += fabs(difference);
      squares += difference * difference;
    }
    count++;
    jumps += is_jump(&previous->matches[place.nearest], &now->matches[i]);
  }
  *out = (StyWarp){.pixels = count};
  if (!count) return;
  out->mean = sum / (3 * (double)count);
  out->rms = sqrt(squares / (3 * (double)count));
  out->jumps = (double)jumps / (double)count;
}
