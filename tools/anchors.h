/* What the seeds of stylized pieces ride on: the screen, or each object's pivot. */
#ifndef STYLUT_TOOLS_ANCHORS_H
#define STYLUT_TOOLS_ANCHORS_H

#include "options.h"
#include "stylut/pivots.h"

/* As asked for by --anchor and --pivots. */
typedef struct AnchorOptions {
  int kind;           /* index of anchor_kinds */
  const char *pivots; /* a file; NULL: the guides' own */
} AnchorOptions;

enum { ANCHOR_SCREEN, ANCHOR_OBJECT };
extern const char *const anchor_kinds[]; /* NULL-terminated */

/* --pivots without --anchor object. */
StyStatus check_anchors(Options *options, const AnchorOptions *anchors);

/* Anchors as StyFrame has them: 2 numbers for each object id below count. NULL: the screen. Owned. */
typedef struct Anchors {
  int32_t *places;
  int count;
} Anchors;

/* Reads --pivots, where it was given, for all frames; free it with sty_free_pivot_file. */
StyStatus open_pivots(const AnchorOptions *anchors, StyPivotFile *out, StyError *error);

/* Those of frame `number`, whose guide this is, by the file or by its own metadata: pivots times `scale` (pixels of the
 * frame per pixel of the guide), rounded half up. Errors name `guide`: no object.I, no pivots. The caller frees the
 * places. */
StyStatus place_anchors(const AnchorOptions *anchors, const StyPivotFile *file, const char *guide,
                        const StyImage *image, int number, double scale, Anchors *out, StyError *error);

#endif
