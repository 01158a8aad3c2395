/* Two frames of a texture under a known motion: analytic, so that frames between pixels are exact. */
#ifndef STYLUT_TESTS_FLOW_PAIRS_H
#define STYLUT_TESTS_FLOW_PAIRS_H

#include <math.h>
#include <stdint.h>

#include "stylut/image.h"

/* A place of this frame to one of the previous: p' = matrix (p - centre) + centre + shift. */
typedef struct Movement {
  double matrix[4];
  double shift[2];
} Movement;

/* The value of a texture's channel at a place, 0..1; `scene` is the middle of the picture. */
typedef double (*Texture)(double x, double y, int channel, const double centre[2]);

typedef struct FlowPair {
  StyImage *frame, *previous, *truth; /* R G B; A motion.U motion.V */
} FlowPair;

static inline Movement move_by(double u, double v) { return (Movement){{1, 0, 0, 1}, {u, v}}; }

static inline Movement turn_and_zoom(double degrees, double zoom) {
  const double c = cos(degrees * (M_PI / 180)) * zoom, s = sin(degrees * (M_PI / 180)) * zoom;
  return (Movement){{c, -s, s, c}, {0, 0}};
}

/* ---- textures ---- */

static inline double draw_lattice(int x, int y, int key) {
  uint64_t z = (uint64_t)(uint32_t)x | (uint64_t)(uint32_t)y << 32;
  z = (z ^ (z >> 30) ^ (uint64_t)key * 0x9e3779b97f4a7c15u) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return (double)((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
}

static inline double fade(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }

static inline double draw_noise(double x, double y, int key) {
  const int i = (int)floor(x), j = (int)floor(y);
  const double s = fade(x - i), t = fade(y - j);
  const double top = draw_lattice(i, j, key) * (1 - s) + draw_lattice(i + 1, j, key) * s;
  const double bottom = draw_lattice(i, j + 1, key) * (1 - s) + draw_lattice(i + 1, j + 1, key) * s;
  return top * (1 - t) + bottom * t;
}

/* Value noise of cells of 64, 32, ... 4 pixels, each a bit weaker than the one before. */
static inline double cloud(double x, double y, int channel, const double centre[2]) {
  (void)centre;
  double sum = 0, amplitude = 0.35, cell = 64;
  for (int octave = 0; octave < 5; octave++, amplitude *= 0.75, cell /= 2)
    sum += amplitude * (draw_noise(x / cell + 17 * octave, y / cell, 8 * channel + octave) - 0.5);
  return fmin(fmax(0.5 + sum, 0), 1);
}

/* Horizontal stripes, 16 pixels from one to the next. */
static inline double stripes(double x, double y, int channel, const double centre[2]) {
  (void)x;
  (void)channel;
  return 0.5 + 0.4 * sin((y - centre[1]) * (2 * M_PI / 16));
}

/* Circles around the picture's middle, as far from each other. */
static inline double circles(double x, double y, int channel, const double centre[2]) {
  (void)channel;
  return 0.5 + 0.4 * sin(hypot(x - centre[0], y - centre[1]) * (2 * M_PI / 16));
}

static inline double uniform(double x, double y, int channel, const double centre[2]) {
  (void)x;
  (void)y;
  (void)centre;
  return 0.25 + 0.125 * channel;
}

/* ---- frames ---- */

static inline float quantize(double value, int bits) {
  const double top = bits == 8 ? 255 : 65535;
  return bits == 32 ? (float)value : (float)floor(value * top + 0.5) / (float)top;
}

static inline void paint(const StyImage *image, Texture texture, const Movement *movement, const double centre[2]) {
  const size_t pixels = sty_count_pixels(image);
  for (size_t p = 0; p < pixels; p++) {
    const double x = (double)(p % (size_t)image->width) + 0.5 - centre[0];
    const double y = (double)(p / (size_t)image->width) + 0.5 - centre[1];
    const double *m = movement->matrix;
    const double mx = m[0] * x + m[1] * y + movement->shift[0] + centre[0];
    const double my = m[2] * x + m[3] * y + movement->shift[1] + centre[1];
    for (int c = 0; c < 3; c++) image->data[(size_t)c * pixels + p] = quantize(texture(mx, my, c, centre), image->bits);
  }
}

static inline void paint_truth(const StyImage *truth, const Movement *movement, const double centre[2]) {
  const size_t pixels = sty_count_pixels(truth);
  const double *m = movement->matrix;
  for (size_t p = 0; p < pixels; p++) {
    const double x = (double)(p % (size_t)truth->width) + 0.5 - centre[0];
    const double y = (double)(p / (size_t)truth->width) + 0.5 - centre[1];
    truth->data[p] = 1;
    truth->data[pixels + p] = (float)(m[0] * x + m[1] * y + movement->shift[0] - x);
    truth->data[2 * pixels + p] = (float)(m[2] * x + m[3] * y + movement->shift[1] - y);
  }
}

static inline FlowPair make_pair(int width, int height, int bits, Texture texture, Movement movement) {
  static const char *const colours[] = {"R", "G", "B"}, *const motion[] = {"A", "motion.U", "motion.V"};
  const Movement rest = move_by(0, 0);
  const double centre[2] = {width / 2.0, height / 2.0};
  FlowPair pair = {NULL, NULL, NULL};
  if (sty_create_image(width, height, 3, colours, bits, &pair.frame, NULL) ||
      sty_create_image(width, height, 3, colours, bits, &pair.previous, NULL) ||
      sty_create_image(width, height, 3, motion, 32, &pair.truth, NULL))
    return pair;
  paint(pair.frame, texture, &movement, centre);
  paint(pair.previous, texture, &rest, centre);
  paint_truth(pair.truth, &movement, centre);
  return pair;
}

/* A disc with a texture of its own moves by (u, v) over a background that moves by (2, 0). */
static inline FlowPair make_disc_pair(int width, int height, int u, int v) {
  FlowPair pair = make_pair(width, height, 8, cloud, move_by(2, 0));
  if (!pair.truth) return pair;
  const size_t pixels = sty_count_pixels(pair.frame);
  const double centre[2] = {width / 2.0, height / 2.0}, away = 5000;
  for (size_t p = 0; p < pixels; p++) {
    const double x = (double)(p % (size_t)width) + 0.5, y = (double)(p / (size_t)width) + 0.5;
    const bool now = hypot(x - centre[0], y - centre[1]) < 0.3 * height;
    const bool before = hypot(x - u - centre[0], y - v - centre[1]) < 0.3 * height;
    for (int c = 0; c < 3; c++) {
      const size_t at = (size_t)c * pixels + p;
      if (now) pair.frame->data[at] = quantize(cloud(x + u + away, y + v, c, centre), 8);
      if (before) pair.previous->data[at] = quantize(cloud(x + away, y, c, centre), 8);
    }
    if (now) pair.truth->data[pixels + p] = (float)u;
    if (now) pair.truth->data[2 * pixels + p] = (float)v;
  }
  return pair;
}

static inline void destroy_pair(FlowPair *pair) {
  sty_destroy_image(&pair->frame);
  sty_destroy_image(&pair->previous);
  sty_destroy_image(&pair->truth);
}

#endif
