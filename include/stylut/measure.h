/* Figures about stylized frames, so that a change of settings can be judged: how steadily pictures follow the motion,
 * how much changes from frame to frame, how large the copied pieces are, and whether flat areas repeat themselves.
 *
 * All are the same for any number of threads. */
#ifndef STYLUT_MEASURE_H
#define STYLUT_MEASURE_H

#include <stddef.h>
#include <stdint.h>

#include "stylut/parallel.h"
#include "stylut/runtime.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A stylized frame; all of one size, rows from the top, without padding. Borrowed. */
typedef struct StyShot {
  int width, height;
  const float *rgb;        /* 3 planes, 0..1, sRGB-encoded: see sty_lay_on_white */
  const uint8_t *guide;    /* 4 a pixel, as StyFrame has it */
  const StyMatch *matches; /* 1 a pixel */
  const float *motion[2];  /* pixels to the previous frame, +U right and +V down; NULL: none */
  const float *depth;      /* NULL: none */
  const uint16_t *objects; /* NULL: none */
} StyShot;

/* RGBA of 8 or 16 bits to 3 planes of 0..1, as on white paper. `pixels`: how many. */
void sty_lay_on_white(const void *picture, int bits, size_t pixels, float *rgb);

/* ---- from one frame to the next ------------------------------------------------ */

/* Over the pixels that both frames show: the place that the motion names, rounded, is covered, belongs to the same
 * object and style, and its depth differs by at most STY_SAME_DEPTH of the larger. */
typedef struct StyWarp {
  size_t pixels;
  double mean, rms; /* of |difference| over R, G, B against the previous picture at the exact place, bilinear; 0..1 */
  double jumps;     /* share whose source pixel is more than STY_JUMP pixels from that of the place in question */
} StyWarp;
#define STY_SAME_DEPTH 0.05f
#define STY_JUMP 4

/* Both shots have one size. Without motion in `now` nothing moves. All 0 where no pixel is shown by both. */
void sty_measure_warp(const StyShot *previous, const StyShot *now, StyWarp *out);

/* Structural similarity of two pictures' luma (Wang, Bovik, Sheikh, Simoncelli 2004: Gaussian window of 11x11 pixels,
 * sigma 1.5, K = 0.01 and 0.03): the mean over all windows inside the picture; 1 for equal ones. Pictures that hold no
 * window: that of equal ones is 1, else 0. Errors: memory. */
StyStatus sty_measure_ssim(int width, int height, const float *a, const float *b, const StyRun *run, double *out,
                           StyError *error);

/* LDR-FLIP (Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild 2020) at 67 pixels per degree: mean over
 * the picture, 0 (equal) .. 1. Errors: memory. */
StyStatus sty_measure_flip(int width, int height, const float *reference, const float *test, const StyRun *run,
                           double *out, StyError *error);

/* ---- one frame ----------------------------------------------------------------- */

/* Chunks: pieces in which neighbouring pixels (of four) show neighbouring source pixels of one style and lighting. */
typedef struct StyChunks {
  size_t count, pixels;
  double mean;     /* pixels a chunk */
  double weighted; /* the same as pixels see it: mean over pixels of the area of their chunk */
  size_t largest;
} StyChunks;

/* `scales`: pixels per source pixel, by style less 1. Errors: memory. */
StyStatus sty_measure_chunks(const StyShot *shot, const float *scales, StyChunks *out, StyError *error);

typedef struct StyLevels {
  size_t pixels;                   /* stylized */
  double share[STY_MAX_LEVEL + 1]; /* of them, by level */
  double fallback;
} StyLevels;
void sty_measure_levels(const StyShot *shot, StyLevels *out);

/* Repetition on flat areas: windows of STY_FLAT_WINDOW pixels a side, every half of that, in which the guide's bytes
 * lie within STY_FLAT_STEPS of each other and all is covered. In each, the picture's luma (bytes) is correlated with
 * itself, moved by up to half a window; what counts is the peak (as high as its 8 neighbours) at least STY_LEAST_LAG
 * pixels away that rises most above the lowest value, not below 0, on the straight way to it; 0 where there is none.
 * Luma that varies by less than a byte doesn't correlate. */
typedef struct StyRepetition {
  size_t windows;
  double flat;          /* share of the covered pixels that lie in such windows */
  double mean, largest; /* of the windows' peaks, 0..1 */
  double shown;         /* pixels of flat areas per source pixel that they show, 1 and up; 0 without such areas */
} StyRepetition;
#define STY_FLAT_WINDOW 64
#define STY_FLAT_STEPS 2
#define STY_LEAST_LAG 4
StyStatus sty_measure_repetition(const StyShot *shot, const StyRun *run, StyRepetition *out, StyError *error);

/* Where those windows are, by size and guide alone: 255 on pixels that lie in one, else 0. `mask`: width*height. */
void sty_mark_flat(const StyShot *shot, uint8_t *mask);

#ifdef __cplusplus
}
#endif
#endif
