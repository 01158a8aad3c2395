/* stylut's runtime: reads a bundle in place and stylizes frames.
 *
 * C11 with libc and libm only. Nothing is allocated, no file is touched, no
 * state is kept: every function may be called from any thread, on disjoint
 * rectangles of one frame at the same time. The caller owns all buffers and
 * the threads.
 *
 * Method: StyleBlit, parallel form (Sykora et al. 2019; seeds hierarchy,
 * NearestSeed and chunk blending as in the published shaders), with all
 * decisions in integers so that every processor agrees to the last pixel. */
#ifndef STYLUT_RUNTIME_H
#define STYLUT_RUNTIME_H

#include <stddef.h>
#include <stdint.h>

#include "stylut/runtime_format.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum StyRuntimeStatus {
  STY_RUNTIME_OK = 0,
  STY_RUNTIME_BAD_ARGUMENT,  /* null pointer, empty frame, rectangle outside, unknown style */
  STY_RUNTIME_NOT_KTX2,      /* identifier or header is wrong */
  STY_RUNTIME_TRUNCATED,     /* an offset or length points past the end */
  STY_RUNTIME_WRONG_FORMAT,  /* a KTX2 file, but not the texture this place asks for */
  STY_RUNTIME_MISMATCH,      /* the files of the bundle don't fit each other */
  STY_RUNTIME_BAD_PARAMETER, /* a style's parameters are out of range */
} StyRuntimeStatus;

/* One line of English for a status; a static string. */
const char *sty_describe_runtime_status(StyRuntimeStatus status);

/* Bytes of one KTX2 file in memory, at any alignment. */
typedef struct StyBlob {
  const void *data;
  size_t size;
} StyBlob;

/* A texture array inside a blob. */
typedef struct StyTexture {
  const unsigned char *texels; /* layer after layer, rows from the top, no padding */
  uint32_t width, height, layers;
  uint32_t texel_size; /* bytes */
} StyTexture;

/* Checks the header and every offset of untrusted bytes and points *out into
 * them. `format` is one of STY_VK_*; a file of another format, with several
 * levels, or with an orientation other than "rd" gives WRONG_FORMAT. */
StyRuntimeStatus sty_open_texture(StyBlob file, uint32_t format, StyTexture *out);

/* A bundle: five textures that fit each other. Valid as long as the blobs are. */
typedef struct StyBundle {
  StyTexture textures[STY_BUNDLE_FILES];
} StyBundle;

/* `files` in the order of STY_BUNDLE_*. Untrusted input is safe; the parameters
 * of every style are checked too. When it fails on a file and `culprit` isn't
 * NULL, *culprit is the index of the file at fault. */
StyRuntimeStatus sty_open_bundle(const StyBlob files[STY_BUNDLE_FILES], StyBundle *out, int *culprit);

/* The parameters of one style. */
typedef struct StyStyle {
  int threshold;         /* sum of absolute byte differences; accepted when below; 0..STY_MAX_THRESHOLD */
  int top_level;         /* 0..STY_MAX_LEVEL */
  int radius;            /* of blending, pixels, 0..STY_MAX_RADIUS */
  float depth_tolerance; /* scene units; 0 = votes aren't dropped for depth */
  int layer;             /* of the exemplar array */
  unsigned flags;        /* STY_FLAG_* */
} StyStyle;

/* style: 1 .. number of styles (the width of the params texture). BAD_PARAMETER
 * when a value is not finite, not whole where it counts something, or outside
 * the range above; so far also when the layer count is not 1, since styles have
 * one lighting. Luminances, weights, jitter amount, jitter period and exemplar
 * scale are checked (finite; all but luminances not negative) but not used. */
StyRuntimeStatus sty_get_style(const StyBundle *bundle, int style, StyStyle *out);

#define STY_MAX_FRAME_SIDE (1 << 20)

/* What a frame shows, row 0 at the top, rows without padding. */
typedef struct StyFrame {
  int width, height;     /* 1..STY_MAX_FRAME_SIDE */
  const uint8_t *guide;  /* 4 a pixel: n/2+1/2 rounded to bytes, and coverage (above 0) */
  const float *fine;     /* 2 a pixel: n.x and n.y at full precision, to address the LUT; NULL: the bytes.
                            Clamped to -1..1; NaN counts as 0 */
  const float *depth;    /* 1 a pixel, for edge-aware blending; NULL: none */
  const uint8_t *styles; /* 1 a pixel, 0 and ids above the bundle's styles = not stylized; NULL: `style` everywhere */
  int style;             /* 1 and up; used where styles is NULL */
  int jitter_frame;      /* which jitter layer, modulo their number; 0 and up */
} StyFrame;

/* Pixels x0..x1-1, y0..y1-1 of a frame; may be empty. */
typedef struct StyRect {
  int x0, y0, x1, y1;
} StyRect;

/* One entry of the nearest-neighbour field: the source pixel, or STY_NO_SOURCE
 * in both where nothing is stylized, and the level that was accepted. */
typedef struct StyMatch {
  uint16_t x, y;
  uint8_t level; /* top level..0; STY_LEVEL_FALLBACK; STY_LEVEL_NONE */
} StyMatch;
#define STY_NO_SOURCE 0xFFFFu
#define STY_LEVEL_FALLBACK 254 /* no level was accepted: LUT(guide at p) */
#define STY_LEVEL_NONE 255     /* not covered or not stylized */

/* Transfer: fills `matches` (width*height of the frame) inside `rect`.
 * For level = top..0 and h = 2^level: the seed of cell b is
 * floor(h*(b + jitter[b mod 256]/255)); the nearest of the 3x3 cells around the
 * pixel wins (x outer, y inner, strict less-than). u* = LUT(guide at seed); the
 * candidate is u* + (p - seed); it is accepted when it lies inside the source,
 * is covered there, and the sum over x, y, z of absolute byte differences
 * between the frame's guide at p and the source's at the candidate is below the
 * threshold. A seed outside the frame or not covered proposes nothing; one on
 * another style's pixel proposes through the LUT of p's own style. When no level
 * is accepted the match is LUT(guide at p), which always lies inside the source. */
StyRuntimeStatus sty_transfer_frame(const StyBundle *bundle, const StyFrame *frame, StyRect rect, StyMatch *matches);

/* Blend: writes RGBA inside `rect` of `out` (width*height*4 of the frame), as
 * uint8_t for bits == 8 and uint16_t for bits == 16. A pixel is the mean of its
 * (2r+1)^2 neighbours' votes, exemplar[match(p+o) - o], over neighbours of the
 * same style; a vote is dropped when it leaves the source or its mask, or when
 * the depth there differs by more than the tolerance (equal infinities agree,
 * NaN agrees with nothing but itself at o = 0). Where no vote is left, the
 * exemplar at match(p) stands alone. The mean is that of the stored bytes, as in
 * the published method, not of linear light. Colours weigh by the
 * exemplar's alpha; alpha is the mean alpha times the frame's coverage; both are
 * straight, not premultiplied, and rounded once, half up.
 * Pixels not covered or not stylized become 0 0 0 0. Needs the matches of `rect` grown by the
 * largest radius (within the frame). */
StyRuntimeStatus sty_blend_frame(const StyBundle *bundle, const StyFrame *frame, StyRect rect, const StyMatch *matches,
                                 int bits, void *out);

#ifdef __cplusplus
}
#endif
#endif
