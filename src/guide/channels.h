/* The one table of guide channels, and how a picture gets them.
 *
 * To add a channel group: a bit in StyChannelGroup, a field of StySample, a row
 * in STY_CHANNEL_GROUPS; then fill the field in sphere.c and trace.c where the
 * group is asked for. Names, allocation, miss values and --channels follow. */
#ifndef STYLUT_GUIDE_CHANNELS_H
#define STYLUT_GUIDE_CHANNELS_H

#include <stddef.h>

#include "stylut/guide.h"

#define STY_GROUP_CHANNELS 3 /* at most, per group */
#define STY_GROUP_COUNT 11

/* What a guide says about one covered pixel; only the groups asked for are set. */
typedef struct StySample {
  double normal[3];
  double depth;
  double position[3];
  double object;
  double style;
  double uv[2];
  double albedo[3];
  double luma;
  double curvature;
  double contour;
  double motion[2];
} StySample;

typedef struct StyChannelGroupInfo {
  unsigned group;   /* StyChannelGroup */
  const char *name; /* as people type it */
  int count;        /* channels, 1 .. STY_GROUP_CHANNELS */
  const char *channels[STY_GROUP_CHANNELS];
  float miss;   /* value of every channel where nothing is hit */
  size_t field; /* offset of `count` doubles in StySample */
} StyChannelGroupInfo;

extern const StyChannelGroupInfo STY_CHANNEL_GROUPS[STY_GROUP_COUNT];

/* A guide image with its planes at hand. */
typedef struct StyGuide {
  StyImage *image;
  float *coverage;
  int group_count;
  struct StyGuidePlanes {
    const StyChannelGroupInfo *info;
    float *planes[STY_GROUP_CHANNELS];
  } groups[STY_GROUP_COUNT];
} StyGuide;

/* A guide of channel A and those of `groups`, with nothing hit anywhere. The
 * caller owns out->image. STY_ERROR_USAGE for unknown groups. */
StyStatus sty_create_guide(int width, int height, unsigned groups, StyGuide *out, StyError *error);

/* Replaces *image by `rows` of its rows, from `first`, and the channels of `groups`, where it has more. */
StyStatus sty_select_channels(StyImage **image, int first, int rows, unsigned groups, StyError *error);

/* Marks a pixel as covered by what `sample` says. */
void sty_set_sample(const StyGuide *guide, size_t pixel, const StySample *sample);

/* As a new one, with nothing hit anywhere. */
void sty_clear_guide(const StyGuide *guide);

/* The planes of an image that sty_create_guide made for these groups. */
StyGuide sty_view_guide(StyImage *image, unsigned groups);

#endif
