/* One frame of stylize: read, dressed, written. */
#ifndef STYLUT_TOOLS_STYLIZE_FRAME_H
#define STYLUT_TOOLS_STYLIZE_FRAME_H

#include "anchors.h"
#include "frames.h"
#include "stylut/pack.h"

typedef enum Method { METHOD_STYLEBLIT, METHOD_LIT_SPHERE, METHOD_BRUTE } Method;
typedef enum Resolution { RESOLUTION_HALF, RESOLUTION_FULL, RESOLUTION_DOUBLE } Resolution;

/* What all frames have in common. */
typedef struct Request {
  const Options *options;
  const char *bundle_path;
  const StyLoadedBundle *loaded; /* names of styles */
  const StyBundle *bundle;       /* the same, parameters perhaps changed */
  const char *style;             /* --style */
  int method, resolution, bits;
  const AnchorOptions *anchors;
  const StyPivotFile *pivots;
  StyRuntimePath path;
} Request;

/* Pictures that a frame becomes. */
enum { OUTPUT_PICTURE, OUTPUT_FIELD, OUTPUT_CHUNKS, OUTPUT_FLAT, OUTPUTS };

/* Names of one frame; all but those of guide and picture may be NULL. */
typedef struct FrameFiles {
  const char *guide, *outputs[OUTPUTS];
  int number;
} FrameFiles;

/* What may be amiss with a frame. */
typedef enum ReviewKind {
  REVIEW_LUMA, /* channels that a style goes by */
  REVIEW_ALBEDO,
  REVIEW_DEPTH,
  REVIEW_OBJECT,
  REVIEW_EMPTY,    /* shows nothing */
  REVIEW_HOPELESS, /* hardly any piece fits */
  REVIEW_UNNAMED,  /* styles that the bundle doesn't have */
  REVIEW_OBJECTS,  /* objects that a frame can't tell apart */
  REVIEW_KINDS
} ReviewKind;

/* A frame and all that is computed for it. The picture has width x height pixels, matches are those of the frame. */
typedef struct Work {
  FilledFrame filled;
  Anchors anchors;
  float *motion; /* U, then V; NULL: the guide has none */
  StyMatch *matches;
  void *picture;
  int width, height;
  size_t covered, fallback;
  int lacking[REVIEW_EMPTY]; /* the first style that goes by a channel the guide hasn't; 0: none */
  size_t unnamed;            /* pixels whose style.I is that of no style */
  double times[4];           /* read, transfer, blend, write */
} Work;

/* Reads a frame's guide and fills the frame. */
StyStatus open_work(const Request *request, const FrameFiles *files, Work *out, StyError *error);
void close_work(Work *work);

/* Draws the picture. */
StyStatus draw_work(const Request *request, const FrameFiles *files, Work *work, const StyRun *run, StyError *error);

/* All or none: what was asked for appears once everything is written. */
StyStatus write_work(const Request *request, const FrameFiles *files, Work *work, StyError *error);

/* In how many frames each was. */
typedef struct Review {
  int counts[REVIEW_KINDS];
} Review;

/* Warns of the first frame of each kind; the end, of how many more there were. Channels can be reviewed of an opened
 * frame, too, all else of a drawn one. `guide`: the sequence's. */
void review_channels(const Request *request, const FrameFiles *files, const Work *work, Review *review);
void review_work(const Request *request, const FrameFiles *files, const Work *work, Review *review);
void end_review(const Request *request, const char *guide, const Review *review);

/* Whether all that was asked for is there, made by this command of these inputs. */
bool is_kept(const Request *request, const FrameFiles *files);

#endif
