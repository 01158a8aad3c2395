/* Two pictures as pyramids of halves, and what flow is known on each level. */
#ifndef STYLUT_GUIDE_FLOW_PYRAMID_H
#define STYLUT_GUIDE_FLOW_PYRAMID_H

#include <stdbool.h>
#include <stddef.h>

#include "stylut/flow.h"

/* The values of a pixel, which vector units take at once; channels that aren't there are 0. */
enum { STY_LANES = STY_FLOW_MOST_CHANNELS };
typedef float StyLanes __attribute__((vector_size(STY_LANES * sizeof(float))));

static inline StyLanes sty_spread_lanes(float value) { return (StyLanes){value, value, value, value}; }

static inline float sty_add_lanes(StyLanes v) { return (v[0] + v[1]) + (v[2] + v[3]); }

static inline StyLanes sty_get_magnitude(StyLanes v) {
  typedef int32_t Bits __attribute__((vector_size(sizeof(StyLanes))));
  const Bits but_sign = {INT32_MAX, INT32_MAX, INT32_MAX, INT32_MAX};
  return (StyLanes)((Bits)v & but_sign);
}

/* A picture with a border that continues its outermost pixels. */
typedef struct StyFlowPicture {
  int width, height, margin;
  ptrdiff_t stride; /* pixels from row to row */
  StyLanes *memory;
  StyLanes *first; /* pixel (0, 0) */
} StyFlowPicture;

static inline const StyLanes *sty_get_flow_pixel(const StyFlowPicture *picture, int x, int y) {
  return picture->first + y * picture->stride + x;
}

/* A motion in pixels of its level, and the level that found it, see origin.I. */
typedef struct StyFlowVector {
  float u, v;
  int origin;
} StyFlowVector;

typedef struct StyFlowLevel {
  int index;                      /* 0: the picture itself */
  StyFlowPicture pictures[2];     /* this frame, the previous one */
  unsigned char *covered;         /* 1 where any of this frame's pixels below is */
  StyFlowVector *vectors, *spare; /* of every pixel */
} StyFlowLevel;

typedef struct StyFlowPyramid {
  int count;
  int lanes; /* channels in use */
  StyFlowLevel levels[STY_FLOW_MOST_LEVELS];
} StyFlowPyramid;

/* Finds the channels that `list` (NULL: the default) names in both pictures, and writes them to
 * `channels`, comma-separated. `planes` are of picture and channel. */
StyStatus sty_choose_flow_channels(const char *const names[2], const StyImage *const images[2], const char *list,
                                   const float *planes[2][STY_FLOW_MOST_CHANNELS], int *count, char channels[256],
                                   StyError *error);

/* How many levels a picture gets, see StyFlowOptions. */
int sty_count_flow_levels(int width, int height, int wanted);

/* Both pyramids, of boxes or `smooth`, the finest from `planes`; `margin` is 2 or more. What isn't covered is 0. The
 * caller closes *out, after a failure too. */
StyStatus sty_build_flow_pyramid(const char *const names[2], const StyImage *const images[2],
                                 const float *planes[2][STY_FLOW_MOST_CHANNELS], int lanes, int levels, int margin,
                                 bool smooth, StyFlowPyramid *out, StyError *error);
void sty_close_flow_pyramid(StyFlowPyramid *pyramid);

#endif
