/* The model on the table: a ball that fills the canvas, lit from the upper
 * left, with a soft terminator, light thrown back from below, a highlight. */
#ifndef PAINT_SPHERE_H
#define PAINT_SPHERE_H

#include "canvas.h"

typedef struct Vector {
  float x, y, z; /* +X right, +Y up, +Z toward the viewer */
} Vector;

typedef struct Shade {
  float light;     /* 0 deepest shadow .. 1 fully lit, reflected light included */
  float highlight; /* 0 .. 1 */
  float reflected; /* 0 .. 1: how much of the light comes from below */
} Shade;

/* Outside the disc the rim goes on, so that strokes may overshoot. */
Vector find_normal(float x, float y);
Shade observe_sphere(float x, float y);

/* A stroke of `length` pixels centred on (x, y), following the parallels
 * of the ball, turned from them by the angle whose tangent is `turn`; `wobble` is
 * the unsteadiness of the hand, as a tangent. Pressure is 1 throughout. */
void trace_form(Path *path, float x, float y, float length, float turn, float wobble, Random *random);

#endif
