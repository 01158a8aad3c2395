/* Light by the ways it came: a path tracer from what a picture's rays have met, see StyPathOptions. */
#ifndef STYLUT_GUIDE_PATHS_H
#define STYLUT_GUIDE_PATHS_H

#include "guide/channels.h"
#include "guide/light.h"
#include "guide/paint.h"

/* What paths lead through. */
typedef struct StyPathWorld {
  const StyScene *scene;
  const StyTracer *tracer;
  const StyPalette *palette;
  unsigned parts;  /* StyHitPart: of hits, those that colour and light take */
  unsigned groups; /* of StyChannelGroup; ways that none of these holds need not be walked */
  StyPathOptions options;
} StyPathWorld;

/* The most surfaces that a way meets: ways with more aren't in any channel of these groups. */
int sty_count_path_surfaces(unsigned groups);

/* Fills `paths` where block->valid is set, from hits and albedo; (x, y) is the block's first pixel in the picture.
 * Thread-safe. */
void sty_trace_paths(const StyPathWorld *world, const StyBlock *block, int x, int y, StyPathSamples *paths);

#endif
