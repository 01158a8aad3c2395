/* What a painter asks of a picture before each stroke, at every scale: which colour, how light, which way, how
 * much goes on. Source: the multiscale buffers of "Real-time image-space painterly rendering" (thesis, 2011),
 * chapter 4, eqs. 4.1 to 4.5.
 *
 * Levels. Level 0 is the picture; a pixel of level M is the mean of the 2x2 pixels of level M-1 below it (eq. 4.2).
 * Sides are halved and rounded up (eq. 4.1 says nothing of odd sides), so that pixel (x, y) of the picture always
 * belongs to pixel (x>>M, y>>M) of level M. Means weigh by coverage: what isn't there, or is transparent, doesn't
 * count. The last level is one pixel, the mean of the picture.
 *
 * Channels, by group; in files of several levels the level stands before the last dot, as in color.2.R:
 *   color.R .G .B        mean colour (eq. 4.2)
 *   luma.Y               its luminance, Rec. 709 weights 0.2126 0.7152 0.0722 (eq. 4.3)
 *   orientation.X .Y     unit vector along the isoline, +X right, +Y up: the gradient turned by 90 degrees as <y, -x>
 *                        (section 4.3.2), so the lighter side lies to its left; 0 0 where there is none
 *   detail.Y             length of the gradient of luma (section 4.3.3), per pixel of its level: a step from 0 to 1 is
 *                        1/2 at every level, and eq. 4.5 gives at most sqrt(1/2) for luma within 0..1
 *   line.X .Y            cos and sin of twice the orientation's angle; 0 0 where there is none
 * A is the picture's alpha, at most 1 (1 without alpha); all else is 0 where A is.
 *
 * Orientation and line say the same, for different readers. A stroke has no sign, but the thesis' vector has one: two
 * lines side by side, one light on dark and one dark on light, get opposite vectors. That does no harm to a painter,
 * who goes along and back; what compares guides by distance, or averages them, wants `line`, which is the same for both
 * and has no jump anywhere (the double-angle representation: Granlund 1978).
 *
 * The gradient is Sobel's (eq. 4.5), where all its pixels are there. Along the border and beside uncovered pixels
 * the thesis leaves open what is outside; here each of its three differences is one-sided or left out, so that neither
 * the picture's frame nor a silhouette counts as detail, and a ramp has the same gradient everywhere. */
#ifndef STYLUT_STROKES_H
#define STYLUT_STROKES_H

#include "stylut/image.h"
#include "stylut/parallel.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum StyStrokeGroup {
  STY_STROKES_COLOUR = 1 << 0,
  STY_STROKES_LUMA = 1 << 1,
  STY_STROKES_ORIENTATION = 1 << 2,
  STY_STROKES_DETAIL = 1 << 3,
  STY_STROKES_LINE = 1 << 4,
} StyStrokeGroup;

#define STY_STROKE_GROUPS 5
#define STY_MAX_STROKE_LEVELS 17 /* of STY_MAX_SIDE pixels */

/* Their names, in the order of the bits; NULL-terminated. */
extern const char *const sty_stroke_groups[STY_STROKE_GROUPS + 1];

typedef struct StyStrokeOptions {
  unsigned groups;  /* StyStrokeGroup */
  int first, count; /* levels to be written */
  bool numbered;    /* the level is part of the channels' names; must be set where count > 1 */
  bool smooth;      /* coarse levels are interpolated between their pixels, else repeated */
  bool srgb; /* values are sRGB's, else scene-linear. 8- and 16-bit pictures hold the former, others the latter */
  double threshold;  /* least detail that has an orientation; 0: any */
  const char *layer; /* read LAYER.R .G .B or LAYER.Y in place of R G B or Y; NULL for those */
} StyStrokeOptions;

/* Above what rounding makes of a constant picture. */
#define STY_DEFAULT_STROKE_THRESHOLD 1e-6

/* The audit of one level, over its covered pixels; percentiles by nearest rank. */
typedef struct StyStrokeLevel {
  int width, height;
  size_t covered;            /* pixels of the level that cover some of the picture */
  size_t flat;               /* of these: without an orientation */
  double p50, p90, p99, max; /* of detail */
} StyStrokeLevel;

typedef struct StyStrokeFigures {
  int count; /* all levels that there are */
  StyStrokeLevel levels[STY_MAX_STROKE_LEVELS];
} StyStrokeFigures;

/* Levels of a picture, the last being one pixel. */
int sty_count_stroke_levels(int width, int height);

/* The channels above at the picture's size, bits = 32; the caller owns *out. The same for any number of threads.
 * A pixel of the picture gets its level's pixel (x>>M, y>>M), exactly; with `smooth`, the mean of the four around
 * it by distance, where lines (as structure tensors: line times detail squared) are averaged and the orientation
 * follows them. `name` is the picture's, for messages; `figures` may be NULL.
 * STY_ERROR_INPUT: no such channels, a table, or a covered value that isn't finite or is beyond 1e30 (the message
 * names its pixel). STY_ERROR_USAGE: levels that there aren't, or more than STY_MAX_CHANNELS channels. */
StyStatus sty_make_stroke_guide(const char *name, const StyImage *picture, const StyStrokeOptions *options,
                                const StyRun *run, StyStrokeFigures *figures, StyImage **out, StyError *error);

#ifdef __cplusplus
}
#endif
#endif
