/* Local windows: how alike the surroundings of two pixels are. All in levels of 1/255 of white, as
 * a mean over the window's pixels and channels. */
#ifndef STYLUT_GUIDE_FLOW_WINDOW_H
#define STYLUT_GUIDE_FLOW_WINDOW_H

#include "guide/flow_pyramid.h"

enum {
  STY_FLOW_MARGIN = 2, /* beyond the radius: a ring around the window, and one more pixel to interpolate with */
  STY_FLOW_MOST_PATCH = (2 * STY_FLOW_MOST_RADIUS + 3) * (2 * STY_FLOW_MOST_RADIUS + 3)
};

typedef struct StyFlowRules {
  StyFlowMethod method;
  int radius;
  int lanes;       /* channels in use */
  float scale;     /* a sum over a window of this radius to a mean, in levels */
  float threshold; /* see StyFlowOptions */
  float tolerance;
} StyFlowRules;

/* A place in the previous picture, by its whole and its broken part. */
typedef struct StyFlowPlace {
  int x, y;
  float right, down; /* 0 .. 1 */
} StyFlowPlace;

static inline bool sty_is_inside(const StyFlowPicture *picture, float x, float y) {
  return x >= 0 && y >= 0 && x <= (float)(picture->width - 1) && y <= (float)(picture->height - 1);
}

/* The place itself, which must be inside the picture. */
StyFlowPlace sty_find_flow_place(float x, float y);

/* The (2 radius + 1)^2 pixels around a place, bilinear, row by row. */
void sty_sample_flow_window(const StyFlowPicture *picture, const StyFlowPlace *place, int radius, StyLanes *out);

/* Mean difference between the window around (x, y) of this frame and that around (x + u, y + v) of
 * the previous one; as published, each less the colour of its centre. Anything above `limit` once that is certain. */
float sty_measure_flow_offset(const StyFlowLevel *level, const StyFlowRules *rules, int x, int y, int u, int v,
                              float limit);

/* Mean difference between the window's pixels and its centre. */
float sty_measure_flow_texture(const StyFlowLevel *level, const StyFlowRules *rules, int x, int y);

/* Mean difference between this frame's window around (x, y) and a sampled one, whose rows are
 * `side` pixels apart; `limit` as above. */
float sty_compare_flow_window(const StyFlowLevel *level, const StyFlowRules *rules, int x, int y,
                              const StyLanes *sampled, int side, float limit);

/* Moves a match by less than a pixel to where the windows are most alike, if that is any better;
 * their mean difference then. */
float sty_refine_flow(const StyFlowLevel *level, const StyFlowRules *rules, int x, int y, StyFlowVector *vector);

#endif
