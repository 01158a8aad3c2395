/* The one table of guide channels, and how a picture gets them.
 * CONTRIBUTING.md says how to add a channel. */
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
  float miss; /* value of every channel where nothing is hit */
  int lane;   /* the first of `count` in StySamples */
} StyChannelGroupInfo;

extern const StyChannelGroupInfo STY_CHANNEL_GROUPS[STY_GROUP_COUNT];

#define STY_GUIDE_CHANNELS (1 + STY_GROUP_COUNT * STY_GROUP_CHANNELS) /* at most */

/* Channels that samples are written into: A and those of some groups, but no outlines, which aren't samples. */
typedef struct StyChannels {
  int count;
  struct StySampledChannel {
    const char *name;
    int lane; /* of StySamples */
    float miss;
  } channels[STY_GUIDE_CHANNELS];
} StyChannels;

StyChannels sty_list_channels(unsigned groups);

/* A guide image with its planes at hand, in the channels' order. */
typedef struct StyGuide {
  StyImage *image;
  StyChannels channels;
  float *planes[STY_GUIDE_CHANNELS];
} StyGuide;

/* A guide of channel A and those of `groups`, all 0. The caller owns out->image. STY_ERROR_USAGE for unknown groups. */
StyStatus sty_create_guide(int width, int height, unsigned groups, StyGuide *out, StyError *error);

/* The planes of an image that sty_create_guide made for these groups. */
StyGuide sty_view_guide(StyImage *image, unsigned groups);

/* A row of blocks on its way into guides. Samples of one block touch as many cache lines as there are channels and
 * rows, so that they are gathered here and then written in whole lines. */
enum { STY_STRIP_WIDTH = 32 };

typedef struct StyStrip {
  float values[sizeof(StySamples) / sizeof(StyLane)][STY_BLOCK_HEIGHT][STY_STRIP_WIDTH]; /* by lanes of StySamples */
} StyStrip;

/* Misses all over. */
void sty_clear_strip(const StyChannels *channels, StyStrip *strip);

/* Writes a strip whose first pixel is (x, y); what lies outside the guide is left out. */
void sty_write_strip(const StyStrip *strip, int x, int y, const StyGuide *guide);

/* Other threads will see the strips that this one has written. */
void sty_finish_strips(void);

#endif
