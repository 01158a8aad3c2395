/* The one table of guide channels, and how a picture gets them.
 *
 * To add a channel group: a bit in StyChannelGroup, a field of StySamples, a row
 * in STY_CHANNEL_GROUPS; then fill the field in sphere.c and trace.c where the
 * group is asked for. Names, allocation, miss values and --channels follow. */
#ifndef STYLUT_GUIDE_CHANNELS_H
#define STYLUT_GUIDE_CHANNELS_H

#include <stddef.h>

#include "guide/lanes.h"
#include "stylut/guide.h"

#define STY_GROUP_CHANNELS 3 /* at most, per group */
#define STY_GROUP_COUNT 16

/* Light by the ways it came, scene-linear; see StyPathOptions. */
typedef struct StyPathSamples {
  StyLane full[3], lde[3], lse[3], ld12e[3], lie[3];
} StyPathSamples;

/* What a guide says about the pixels of a block; only the groups asked for are set. */
typedef struct StySamples {
  StyLane coverage; /* 1 */
  StyLane normal[3];
  StyLane depth;
  StyLane position[3];
  StyLane object;
  StyLane style;
  StyLane uv[2];
  StyLane albedo[3];
  StyLane luma;
  StyLane curvature;
  StyLane motion[2];
  StyPathSamples paths;
} StySamples;

typedef struct StyChannelGroupInfo {
  unsigned group;   /* StyChannelGroup */
  const char *name; /* as people type it */
  int count;        /* channels, 1 .. STY_GROUP_CHANNELS */
  const char *channels[STY_GROUP_CHANNELS];
  float miss;   /* value of every channel where nothing is hit */
  size_t field; /* offset of `count` lanes in StySamples */
} StyChannelGroupInfo;

extern const StyChannelGroupInfo STY_CHANNEL_GROUPS[STY_GROUP_COUNT];

/* A channel that samples are written into. */
typedef struct StyGuidePlane {
  float *values;
  float miss;
  size_t field; /* offset of its lane in StySamples */
} StyGuidePlane;

/* A guide image with its planes at hand. */
typedef struct StyGuide {
  StyImage *image;
  int plane_count;
  StyGuidePlane planes[1 + STY_GROUP_COUNT * STY_GROUP_CHANNELS];
} StyGuide;

/* A guide of channel A and those of `groups`, all 0. The caller owns out->image. STY_ERROR_USAGE for unknown groups. */
StyStatus sty_create_guide(int width, int height, unsigned groups, StyGuide *out, StyError *error);

/* The planes of an image that sty_create_guide made for these groups; without outlines, which aren't samples. */
StyGuide sty_view_guide(StyImage *image, unsigned groups);

/* Makes misses of a rectangle's pixels, outlines apart; what lies outside the guide is left out. */
void sty_clear_pixels(const StyGuide *guide, int x, int y, int width, int height);

#endif
