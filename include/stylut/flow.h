/* Optical flow: where a picture's pixels were in the picture before, found from the pictures alone.
 *
 * After Krazanowski, "Exploring Real-Time Image Space Painterly Rendering" (thesis, 2011), 4.6: both
 * pictures become pyramids of halves (equation 4.2). On every level the colours around a pixel, in
 * a local window, are compared with those around the same pixel of the previous picture moved in
 * one of 8 directions or not at all (figure 4.3); the most similar wins, if it is similar enough.
 * Pixels that find nothing take what the next coarser level found, if the colours of both match
 * ("optical flow reconciled").
 *
 * Motion counts pixels from this frame to the previous one, +U right, +V down;
 * this frame at p looks like the previous one at p + motion.
 *
 * No picture tells all: stripes that move along themselves, circles that turn about their centre
 * and areas without texture look as if at rest, whatever the method. Where a scene is known, its
 * exact motion is better. */
#ifndef STYLUT_FLOW_H
#define STYLUT_FLOW_H

#include "stylut/image.h"
#include "stylut/parallel.h"

#ifdef __cplusplus
extern "C" {
#endif

#define STY_FLOW_MOST_LEVELS 12
#define STY_FLOW_MOST_RADIUS 4
#define STY_FLOW_MOST_CHANNELS 4
/* Compared values lie within this: the largest of half floats. */
#define STY_FLOW_MOST_VALUE 65504.0f

typedef enum StyFlowMethod {
  /* Each level searches around what the coarser one found, too, two pixels far; levels are smoothed
   * before they are halved (weights 1 3 3 1); colours are compared themselves; matches are refined below
   * the pixel (Lucas and Kanade 1981), and a 3x3 median takes outliers out (Sun, Roth and Black 2010). */
  STY_FLOW_COARSE_TO_FINE,
  /* As published: each level searches on its own, around rest; differences to the window's centre
   * are compared; a match is averaged with the coarser level's. */
  STY_FLOW_PUBLISHED
} StyFlowMethod;

typedef struct StyFlowOptions {
  StyFlowMethod method;
  int levels;       /* 1 .. STY_FLOW_MOST_LEVELS; n reach 2^n - 1 pixels, coarse to fine at least twice that; 0: down
                       to a longer side below 16 pixels */
  int radius;       /* of the window, pixels of each level: 1 (the 8 neighbours) .. STY_FLOW_MOST_RADIUS; 0: 1 as
                       published, else 2 */
  double threshold; /* mean absolute difference, in levels of 1/255, up to which windows match */
  double tolerance; /* the same, below which windows are equally good, or have no texture */
  const char *channels; /* comma-separated, at most STY_FLOW_MOST_CHANNELS; a name without a dot stands for all channels
                           of that layer, too. NULL: the first that both have of R,G,B - full - Y - luma.Y - albedo -
                           normal */
  bool consistency;     /* estimate the way back, too, and compare */
} StyFlowOptions;

extern const StyFlowOptions sty_default_flow_options;

/* What can be said of a flow without knowing the truth. */
typedef struct StyFlowFigures {
  int levels, radius;             /* those used */
  char channels[256];             /* those compared */
  size_t covered;                 /* pixels; all below are counted among them */
  size_t matched;                 /* found a window like theirs in the picture itself */
  size_t inherited;               /* have only what a coarser level found */
  size_t unknown;                 /* nothing found on any level; their motion is 0 */
  size_t ambiguous;               /* another offset, a pixel away, fits as well within the tolerance */
  size_t untextured;              /* window of one colour within the tolerance; all of these are ambiguous */
  double mean_motion, max_motion; /* pixels */
  double mean_residual;           /* levels of 1/255 */
  /* With options.consistency, else 0: motion and the motion found back from there should cancel
   * out. Compared where motion doesn't leave the picture. */
  size_t compared, inconsistent; /* by more than a pixel */
  double mean_inconsistency;     /* pixels */
} StyFlowFigures;

/* Estimates the motion from `frame` to `previous`, pictures or guides of one size, as read from
 * files. Pixels count as covered where channel A is above 0, everywhere without it; what isn't
 * covered is black. *out, which the caller owns, has the channels
 *   A             1 where `frame` is covered, else 0
 *   motion.U .V   see above; 0 where nothing is covered or known
 *   residual.Y    mean absolute colour difference between the windows in both pictures, 1 = white; miss 0
 *   origin.I      the finest level that found it: 1 the picture itself, 2 its half, ...; 0 none
 *   consistency.Y with options.consistency: distance in pixels between a pixel and where its motion and the
 *                 motion back lead; -1 where it leaves the picture; miss 0
 * `names` are of frame and previous, for messages. The result doesn't depend on the number of
 * threads. Safe from any thread. STY_ERROR_INPUT: sizes differ, no channels in common, a covered
 * value that isn't finite or lies beyond STY_FLOW_MOST_VALUE. STY_ERROR_USAGE: options. */
StyStatus sty_estimate_flow(const char *const names[2], const StyImage *frame, const StyImage *previous,
                            const StyFlowOptions *options, const StyRun *run, StyFlowFigures *figures, StyImage **out,
                            StyError *error);

/* Percentiles are the least error that this share of the pixels doesn't exceed. */
typedef struct StyFlowSpread {
  double mean, p50, p95, p99, max;
} StyFlowSpread;

/* As Baker et al., "A Database and Evaluation Methodology for Optical Flow" (2011), 4.1. */
typedef struct StyFlowError {
  size_t pixels;
  StyFlowSpread end_point; /* pixels: length of the difference */
  StyFlowSpread angular;   /* degrees: between (U, V, 1) of both */
  double above_1, above_3; /* share of the pixels with an end-point error above 1 and 3 */
  double mean_truth;       /* length of the true motion, pixels */
  double relative;         /* mean end-point error by mean_truth: 1 is what rest would get; 0 where nothing moves */
} StyFlowError;

/* Checks options, sizes and channels as sty_estimate_flow does, and fills levels, radius and channels. */
StyStatus sty_plan_flow(const char *const names[2], const StyImage *frame, const StyImage *previous,
                        const StyFlowOptions *options, StyFlowFigures *figures, StyError *error);

/* How far a motion is off the true one, over pixels that both cover; both have channels motion.U
 * and motion.V (without A all is covered). `names` are of found and truth. STY_ERROR_INPUT: no
 * motion, sizes differ, a motion that isn't finite or beyond 1e6 pixels, nothing covered by both. */
StyStatus sty_measure_flow(const char *const names[2], const StyImage *found, const StyImage *truth, StyFlowError *out,
                           StyError *error);

/* Motion as a picture of 8 or 16 bits that can be looked at: R = U/scale/2+1/2, G = V/scale/2+1/2,
 * clamped (thesis, 5.4.2), B = 1/2, A = covered; black elsewhere. `scale` is in pixels, above 0. */
StyStatus sty_encode_motion(const StyImage *flow, double scale, int bits, StyImage **out, StyError *error);

#ifdef __cplusplus
}
#endif
#endif
