/* Displacement fields from pairs of points, by moving least squares. Source: S. Schaefer, T. McPhail, J. Warren,
 * "Image Deformation Using Moving Least Squares", SIGGRAPH 2006, section 2.
 *
 * A pair says: what the source shows at `from` shall appear at `to`. The field answers the other way round, since
 * that is how pictures are filled: for a pixel of the output, where in the source it comes from. So the paper's p are
 * our `to`, its q our `from`, and for each place v its function
 *   f(v) = (v - p*) M + q*,  p* = sum w_i p_i / sum w_i,  q* = sum w_i q_i / sum w_i,  w_i = 1 / |p_i - v|^(2 alpha)
 * with the M of its class that minimizes sum w_i |(p_i - p*) M - (q_i - q*)|^2 (eqs. 1 to 4): any matrix (eq. 5), a
 * rotation and a scale (eqs. 6 and 7), a rotation alone (eq. 8). f(to) = from at every pair, and f is smooth elsewhere.
 * It isn't the inverse of the function that the pairs give the other way round, but where that is affine throughout.
 *
 * Places are in pixels of a width x height picture, source and output alike: +x right, +y down, pixel (x, y)'s centre
 * at (x+1/2, y+1/2).
 *
 * Channels of a field:
 *   motion.U .V   pixels from the output's pixel to where it comes from in the source, +U right, +V down
 *   A             1 where that lies inside the picture, else 0, and motion is 0 too */
#ifndef STYLUT_WARP_H
#define STYLUT_WARP_H

#include "stylut/image.h"
#include "stylut/parallel.h"

#ifdef __cplusplus
extern "C" {
#endif

#define STY_MAX_PAIRS 4096
#define STY_MAX_PAIR_COORDINATE 1e6 /* pixels; 1e3 where they are normalized */
#define STY_SAME_POINT 1e-9         /* points nearer than this in x and in y are the same; in the units of the pairs */
#define STY_MIN_WARP_ALPHA 0.5
#define STY_MAX_WARP_ALPHA 4.0

typedef enum StyWarpKind { STY_WARP_AFFINE, STY_WARP_SIMILARITY, STY_WARP_RIGID } StyWarpKind;

/* Their names, NULL-terminated. */
extern const char *const sty_warp_kinds[];

typedef struct StyPair {
  double from[2], to[2]; /* in the source, in the output */
} StyPair;

typedef struct StyPairs {
  StyWarpKind kind;
  double alpha;    /* how fast a pair's influence fades: STY_MIN_WARP_ALPHA .. STY_MAX_WARP_ALPHA */
  bool normalized; /* places are shares of the picture's sides, (0, 0) its upper left corner and (1, 1) its lower right
                    */
  int count;       /* 1 .. STY_MAX_PAIRS */
  StyPair *pairs;
} StyPairs;

/* Reads a file of pairs:
 *   { "schema": "stylut-pairs/1", "kind": "affine|similarity|rigid", "alpha": 1, "units": "pixels|normalized",
 *     "pairs": [ { "from": [x, y], "to": [x, y] }, ... ] }
 * where kind (rigid), alpha (1) and units (pixels) may be left out. The caller frees *out. STY_ERROR_FILE;
 * STY_ERROR_INPUT with line and column, also for a point that two pairs name: one place can't come from two. */
StyStatus sty_read_pairs(const char *path, StyPairs *out, StyError *error);
void sty_free_pairs(StyPairs *pairs);

/* The audit of a field. Stretch and compression are the extreme singular values of the map between neighbouring
 * pixels, over those that aren't folded; 1 for both where it is rigid. */
typedef struct StyWarpFigures {
  size_t inside;                        /* pixels with A = 1 */
  int outside, first_outside;           /* pairs of which a point lies outside the picture, and the first of them */
  int measured;                         /* pairs whose `to` lies inside the picture; only these have a residual: */
  double residual_mean, residual_max;   /* pixels between `from` and the field's answer at `to`, read bilinearly */
  double stretch;                       /* largest length in the output of one pixel of the source */
  double compression;                   /* most pixels of the source that come to lie on one of the output, by length */
  int stretch_at[2], compression_at[2]; /* pixels; -1 -1 where all is folded or there is one row or column */
  size_t cells, folded; /* 2x2 neighbourhoods; of these: where the map turns over, its Jacobian's determinant <= 0 */
} StyWarpFigures;

/* The field, bits = 32; the caller owns *out. The same for any number of threads. Takes time in proportion to pixels
 * times pairs. `name` is the pairs', for messages; `figures` may be NULL.
 * One pair gives a translation, whatever the kind but affine. STY_ERROR_INPUT: no pairs or too many, a place that isn't
 * finite or lies too far away, a point that two pairs name, no pair with its `to` inside the picture, kind
 * affine where all `to` or all `from` lie on a line, to a thousandth of its length (or there are fewer than three);
 * STY_ERROR_USAGE: another alpha. */
StyStatus sty_make_warp_guide(const char *name, const StyPairs *pairs, int width, int height, const StyRun *run,
                              StyWarpFigures *figures, StyImage **out, StyError *error);

#ifdef __cplusplus
}
#endif
#endif
