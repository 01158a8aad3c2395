/* The canvas, the marks one can make on it, and the dice that place them.
 *
 * Only + - * / and sqrt are used on the way to a pixel: these are rounded the
 * same everywhere, so the pictures are the same bytes with every compiler,
 * processor and C library (given -ffp-contract=off). For the same reason
 * angles are handed around as tangents, and light is stored as the square of
 * the display value instead of through the sRGB curve. */
#ifndef PAINT_CANVAS_H
#define PAINT_CANVAS_H

#include <stdbool.h>
#include <stdint.h>

#include "stylut/image.h"

#define CANVAS_SIDE 512
#define CANVAS_PIXELS (CANVAS_SIDE * CANVAS_SIDE)

/* Marks start this far outside too, so that the rim is as densely worked as
 * the middle. */
#define CANVAS_MARGIN 24.0f

typedef struct Color {
  float r, g, b; /* linear light, 0..1 */
} Color;

typedef struct Random {
  uint64_t state;
} Random;

typedef struct Canvas {
  Color *color;
  float *tooth;     /* paper grain, 0 valley .. 1 hill, mean about 1/2 */
  float *relief;    /* thickness of the paint, pixels */
  float *distance;  /* scratch of sweep_path: distance to the path */
  float *along;     /* scratch */
  float *across;    /* scratch */
  int *touched;     /* scratch: pixels of the current stroke */
  int *stroke_mark; /* scratch: the last stroke that touched a pixel */
  int stroke_count;
  unsigned char *claimed; /* nonzero where marks of this layer keep others away */
} Canvas;

#define PATH_POINTS 48

/* A stroke's spine: evenly spaced points, and how hard the hand presses. */
typedef struct Path {
  int count;
  float step; /* pixels between points */
  float x[PATH_POINTS], y[PATH_POINTS];
  float pressure[PATH_POINTS];
} Path;

/* One pixel under a stroke. */
typedef struct Touch {
  int pixel;
  float x, y;     /* its centre */
  float along;    /* pixels from the start; negative or beyond the length past the ends */
  float across;   /* signed pixels from the spine, positive to the right of the travel */
  float distance; /* pixels from the spine, measured round its ends */
  float pressure;
} Touch;

typedef void TouchPixel(Canvas *canvas, const Touch *touch, const void *brush);

/* NULL when memory is short. */
Canvas *create_canvas(Color paper);
void destroy_canvas(Canvas *canvas);

/* Calls `paint` once for each pixel within `reach` of the spine. */
void sweep_path(Canvas *canvas, const Path *path, float reach, TouchPixel *paint, const void *brush);

float get_path_length(const Path *path);

/* Keeping marks apart, so that they stay readable as marks. */
void clear_claims(Canvas *canvas);
void claim_disc(Canvas *canvas, float x, float y, float radius);
void claim_path(Canvas *canvas, const Path *path, float radius);
bool is_claimed(const Canvas *canvas, float x, float y);

/* Shortens the path to its longest unclaimed run; false when that is below
 * `length` pixels. */
bool trim_to_free(const Canvas *canvas, Path *path, float length);

/* Opaque paint over what is there. */
void cover(Canvas *canvas, int pixel, Color color, float opacity);

/* Transparent paint: `pigment` is the colour that a layer of density 1 leaves
 * of white. */
void glaze(Canvas *canvas, int pixel, Color pigment, float density);

/* Average lightness as the eye sees it, 0..1, around a point. */
float measure_lightness(const Canvas *canvas, float x, float y, float radius);

/* Fills the paper's grain with bumps `size` pixels wide. */
void roughen_paper(Canvas *canvas, float size, uint32_t seed);

/* The picture with a ragged edge just outside the disc. */
StyStatus develop_canvas(const Canvas *canvas, StyImage **out, StyError *error);

/* A colour by its display values 0..255. */
Color mix_from_bytes(int r, int g, int b);
Color mix_colors(Color a, Color b, float share_of_b);

/* The colour at `position` 0..1 along evenly spaced stops. */
Color pick_from_ramp(const Color *stops, int count, float position);

float draw_unit(Random *random);
float draw_between(Random *random, float low, float high);
bool draw_chance(Random *random, float probability);

/* The k-th place of a sequence that covers the canvas and its margin evenly
 * however early it is stopped, shaken a little. */
void draw_place(Random *random, int k, float *x, float *y);

/* Smooth noise 0..1 with features about one unit wide; `make_fractal_noise`
 * adds two finer octaves. */
float make_noise(float x, float y, uint32_t seed);
float make_fractal_noise(float x, float y, uint32_t seed);

float clamp_unit(float value);
float ease(float from, float to, float value);

#endif
