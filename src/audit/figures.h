/* Angles, and figures over many of them. */
#ifndef STYLUT_SRC_AUDIT_FIGURES_H
#define STYLUT_SRC_AUDIT_FIGURES_H

#include "stylut/audit.h"

/* A guide's planes. */
typedef struct StyGuidePlanes {
  const float *covered, *x, *y;
} StyGuidePlanes;

/* STY_ERROR_INPUT: no normals. */
StyStatus sty_find_planes(const StyImage *guide, StyGuidePlanes *out, StyError *error);

/* Degrees between the normals of guide value g and of a source pixel; 180 for uncovered ones. */
double sty_measure_pixel(const StyGuidePlanes *guide, uint32_t pixel, const float g[2]);

/* Degrees between the normals of two guide values. */
double sty_measure_angle(const float a[2], const float b[2]);

/* Errors with their weights, and where the largest is. */
typedef struct StySample {
  float error, weight;
} StySample;

typedef struct StyTally {
  StySample *samples; /* room for `capacity` */
  size_t count, capacity;
  double sum, weight; /* of error times weight, and of the weights */
  double *bins;       /* weights by the halves of an error's bits; see figures.c */
  StyFigures figures;
} StyTally;

StyStatus sty_open_tally(size_t capacity, StyTally *out, StyError *error);
void sty_close_tally(StyTally *tally);

/* Adds an error; one of no weight doesn't count. */
void sty_add_error(StyTally *tally, double angle, double weight, const int texel[2], const float g[2], uint32_t pixel,
                   int source_width);

/* Of a tally that is not empty. */
StyFigures sty_finish_tally(StyTally *tally);

#endif
