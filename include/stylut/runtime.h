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

/* The number of this interface. It grows by one whenever a structure, a constant or the meaning of a function here or
 * in runtime_format.h changes, so that a program built before would err; new functions leave it. Where header and
 * library may not be of one version, a program compares both when it starts. */
#define STY_RUNTIME_ABI 1
int sty_get_runtime_abi(void);

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

/* The parameters of one style, as the parameter texture has them. Fractions decide as integers, rounded half up: luma
 * and jitter_amount in 255ths, luma_weight and colour_weight in 256ths; the product is a float (0.7f * 255 = 178.5 is
 * 179), so that graphics processors agree. */
typedef struct StyStyle {
  int threshold;                 /* sum of absolute byte differences; accepted when below; 0..STY_MAX_THRESHOLD */
  int top_level;                 /* 0..STY_MAX_LEVEL */
  int radius;                    /* of blending, pixels, 0..STY_MAX_RADIUS */
  float depth_tolerance;         /* scene units; 0 = votes aren't dropped for depth */
  float luma_weight;             /* of the luminance difference (alpha of thesis eq. 3.3.1), 0..STY_MAX_LUMA_WEIGHT */
  float colour_weight;           /* of the frame's albedo, 0 (none) .. 1 */
  int layer;                     /* first of the exemplar array */
  int layer_count;               /* lightings, 1..STY_MAX_LIGHTINGS; with STY_FLAG_BASE as many bases follow */
  float luma[STY_MAX_LIGHTINGS]; /* luminance that each lighting was painted for, 0..1 */
  float jitter_amount;           /* how far seeds leave their cell's corner, in cells, 0..1 */
  int jitter_period;             /* frames that a jitter table lasts, 0..STY_MAX_PERIOD; 0 = always the first table */
  float scale;                   /* pixels of the picture per source pixel: 0.5, 1 or 2 */
  unsigned flags;                /* STY_FLAG_* */
  int scatter;                   /* source pixels by which pieces move on flat surfaces, 0..STY_MAX_SCATTER */
} StyStyle;

/* style: 1 .. number of styles (the width of the params texture). BAD_PARAMETER
 * when a value is not finite, not whole where it counts something, outside the
 * range above, or speaks of layers that the bundle lacks. */
StyRuntimeStatus sty_get_style(const StyBundle *bundle, int style, StyStyle *out);

/* The texels of one style, and back; `exemplars` is the number of layers that there are. */
void sty_encode_style(const StyStyle *style, float rows[STY_PARAM_ROWS][4]);
StyRuntimeStatus sty_decode_style(const float rows[STY_PARAM_ROWS][4], uint32_t exemplars, StyStyle *out);

/* Which code does the work. All give the same bytes; tests and benchmarks choose,
 * everyone else leaves 0. The reference is the formulas as they stand below. */
typedef enum StyRuntimePath {
  STY_PATH_BEST,
  STY_PATH_REFERENCE,
  STY_PATH_PORTABLE,
  STY_PATH_AVX2,
  STY_PATH_AVX512
} StyRuntimePath;

/* Whether this processor and build have a path; those they lack are BAD_ARGUMENT in a frame. */
int sty_has_path(StyRuntimePath path);

#define STY_MAX_FRAME_SIDE (1 << 20)
#define STY_MAX_ANCHOR (1 << 24)

typedef struct StySeeds StySeeds;

/* What a frame shows, row 0 at the top, rows without padding. Zero what isn't used. */
typedef struct StyFrame {
  int width, height;       /* 1..STY_MAX_FRAME_SIDE */
  int resolution;          /* of its pixels beside the picture's: -1 half, 0 the same, 1 double */
  const uint8_t *guide;    /* 4 a pixel: n/2+1/2 rounded to bytes, and coverage (above 0) */
  const float *fine;       /* 2 a pixel: n.x and n.y at full precision, to address the LUT; NULL: the bytes.
                              Clamped to -1..1; NaN counts as 0 */
  const float *depth;      /* 1 a pixel, for edge-aware blending; NULL: none */
  const uint8_t *styles;   /* 1 a pixel, 0 and ids above the bundle's styles = not stylized; NULL: `style` everywhere */
  int style;               /* 1 and up; used where styles is NULL */
  const uint16_t *objects; /* object ids, 1 a pixel, for STY_FLAG_OBJECTS and anchors; NULL: all are 0 */
  const uint8_t *luma;     /* luminance, 1 a pixel: 0..1 rounded to bytes; NULL: lightings are not chosen by light
                              (always the first, no luminance error) */
  const uint8_t *albedo;   /* 4 a pixel: R G B encoded as the exemplar's (sRGB), the fourth isn't read; NULL: white */
  const int32_t *anchors;  /* 2 an object id (x, y): where the object's seed grid begins, pixels of this frame, at
                              most STY_MAX_ANCHOR either way; NULL: at the frame's corner for all. An object that moves
                              by whole pixels with its anchor keeps its matches, save near the frame's edges, where it
                              loses seeds */
  int anchor_count;        /* object ids that have one: 0 .. anchor_count-1; the others' is 0, 0 */
  int number;              /* of the frame in its sequence, 0 and up: chooses the jitter table */
  const StySeeds *seeds;   /* seeds_count of them worked out before (see sty_plan_seeds), to save time: they change
                              nothing, those that don't fit are left alone; NULL: none */
  int seeds_count;
  StyRuntimePath path;
} StyFrame;

/* Pixels x0..x1-1, y0..y1-1 of a frame; may be empty. */
typedef struct StyRect {
  int x0, y0, x1, y1;
} StyRect;

/* One entry of the nearest-neighbour field: the source pixel, and how it was found. */
typedef struct StyMatch {
  uint16_t x, y;  /* STY_NO_SOURCE in both where nothing is stylized */
  uint8_t level;  /* top level..0; STY_LEVEL_FALLBACK; STY_LEVEL_NONE */
  uint8_t layer;  /* lighting, 0..layer_count-1 of the style */
  uint8_t style;  /* that the pixel is drawn in, less 1 (0..255) */
  uint8_t unused; /* 0 */
} StyMatch;
#define STY_NO_SOURCE 0xFFFFu
#define STY_LEVEL_FALLBACK 254 /* no level was accepted: LUT(guide at p) */
#define STY_LEVEL_NONE 255     /* not covered or not stylized: layer and style are 0 */

/* ---- seeds ---------------------------------------------------------------------
 * The seed of cell b at level l, h = 2^l, is h*b + floor(h * jitter[b mod 256] * a / (255*255)), a = the amount rounded
 * to 255ths; the nearest of the 3x3 cells around a pixel wins (x outer, y inner, strict less-than). The table is layer
 * floor(number / period) mod layers. The grid begins at the frame's corner, or at the anchor of the pixel's object.
 *
 * Which seed is nearest depends on place, jitter table and amount alone, so a caller whose jitter lasts keeps the
 * answers: 12 bytes a pixel. */

/* Nearest seeds of levels 1..STY_SEED_LEVELS for one table and amount. */
#define STY_SEED_LEVELS 6
typedef struct StySeedOffset {
  int8_t x, y; /* seed - pixel */
} StySeedOffset;
struct StySeeds {
  StyRect area;           /* pixels less anchor that it answers for, any within STY_MAX_ANCHOR + STY_MAX_FRAME_SIDE */
  int table, amount;      /* layer of the jitter texture, 255ths */
  StySeedOffset *offsets; /* levels 1..STY_SEED_LEVELS, each an area, row after row */
};

/* Bytes that the offsets of an area take; 0 where it is empty or too large. */
size_t sty_get_seeds_size(StyRect area);

/* Points *out to `offsets` (which stay the caller's) for what `style` asks for in frame `number`. Then fill all rows,
 * area.y0 .. area.y1-1, in parts and from as many threads as you like. */
StyRuntimeStatus sty_plan_seeds(const StyBundle *bundle, int style, int number, StyRect area, StySeedOffset *offsets,
                                StySeeds *out);
StyRuntimeStatus sty_fill_seeds(const StyBundle *bundle, const StySeeds *seeds, int y0, int y1, StyRuntimePath path);

/* ---- transfer ------------------------------------------------------------------
 * All four fill `matches` (width*height of the frame) inside `rect`. */

/* StyleBlit, parallel form (thesis 000, algorithm 1). For level = top..0 the nearest seed proposes u* = LUT(guide at
 * seed); the candidate is u* + (p - seed) / S, S = scale *
 * 2^resolution, rounded down; the lighting is that of least |luma byte at seed - luma byte of the lighting|, the
 * first among equals. It is accepted when it lies inside the source, is covered there, and 256 * D + w * |luma at p -
 * luma of the lighting| < 256 * threshold, D = sum over x, y, z of absolute byte differences between the frame's guide
 * at p and the source's at the candidate, w = 256 * luma_weight rounded (eq. 3.3.1). A seed outside the frame or not
 * covered proposes nothing, nor does one of another object where there are anchors; one on another style's pixel
 * proposes through the LUT of p's own style. When no level is accepted the match is LUT(guide at p), which always lies
 * inside the source, in the lighting nearest to p.
 *
 * scatter: a seed of level STY_SCATTER_LEVEL and up is flat when the guide h/2 to its left, right, above and below
 * differs by at most STY_FLAT_DIFFERENCE (summed bytes; places outside the frame agree, uncovered ones don't, nor,
 * where there are anchors, another object's). Its u*
 * moves by floor((2*scatter + 1) * j / 256) - scatter, j = the jitter table's bytes (x, y) at ((seed - anchor + 128)
 * mod 256), unless either place is outside the source or its mask; in D the frame's guide then counts as tilted with
 * it: by the source's guide (bytes) at the moved u* less that at u*. */
StyRuntimeStatus sty_transfer_frame(const StyBundle *bundle, const StyFrame *frame, StyRect rect, StyMatch *matches);
#define STY_SCATTER_LEVEL 3
#define STY_FLAT_DIFFERENCE 2

/* The lit sphere (matcap): LUT(guide at p) for every pixel, in the lighting nearest to p. */
StyRuntimeStatus sty_look_up_frame(const StyBundle *bundle, const StyFrame *frame, StyRect rect, StyMatch *matches);

/* StyleBlit as it was first stated (thesis 001, algorithm 1), over the whole frame: in row order, a pixel that is still
 * empty copies all source pixels around u* = LUT(guide at p) that land on empty pixels of its style and are accepted as
 * above, as level 0; if it is empty then, it falls back. Scale, jitter, scatter and anchors have no part in it;
 * resolution must be 0. Time: chunks times source pixels. A reference for small pictures. */
StyRuntimeStatus sty_transfer_brute(const StyBundle *bundle, const StyFrame *frame, StyMatch *matches);

/* Transfer at half resolution, second step: `half` is a frame of the pixels (2x, 2y) of `frame`, (width+1)/2 by
 * (height+1)/2 with resolution one less, `half_matches` its matches (needed around rect/2). Pixel (x, y) moves on from
 * the match of (x/2, y/2) by (x%2, y%2) / S where that is of its style and is accepted as above, and keeps
 * its level and lighting; else it falls back. With scatter, the frame's guide counts as tilted by the source's guide at
 * that match, where it is covered, less `half`'s guide at (x/2, y/2). */
StyRuntimeStatus sty_expand_matches(const StyBundle *bundle, const StyFrame *half, const StyMatch *half_matches,
                                    const StyFrame *frame, StyRect rect, StyMatch *matches);

/* ---- pictures ------------------------------------------------------------------ */

/* Blend: writes RGBA inside `rect` of `out` (width*height*4 of the frame), as
 * uint8_t for bits == 8 and uint16_t for bits == 16. A pixel is the mean of its
 * (2r+1)^2 neighbours' votes, exemplar[match(p+o) - o / S] (o / S rounded down) in the neighbour's lighting, over
 * neighbours of the same style; a vote is dropped when it leaves the source or its mask, when the depth there differs
 * by more than the tolerance (equal infinities agree, NaN agrees with nothing but itself at o = 0; thesis 000, 3.3.1),
 * or, with STY_FLAG_OBJECTS, when the object is another. Where no vote is left, that of match(p) itself stands alone.
 * The mean is that of the stored bytes, as in the published method, not of linear light. Colours weigh by the
 * exemplar's alpha; alpha is the mean alpha times the frame's coverage; both are
 * straight, not premultiplied, and rounded once, half up.
 *
 * With STY_FLAG_BASE (thesis 000, 2.2.3) votes give exemplar - base, and the pixel's own base, at LUT(guide at p) in
 * the lighting nearest to p, is added to their mean and the sum clamped. Colour (3.3.2): the colour is then
 * multiplied by 1 - w + w * albedo, w = colour_weight rounded to 256ths; products of encoded values are close to those
 * of light, encoded.
 *
 * Pixels not covered or not stylized become 0 0 0 0. Needs the matches of `rect` grown by the largest radius (within
 * the frame). Matches that another bundle or frame left do no harm: places and lightings that the style lacks don't
 * vote, and a pixel without any vote becomes 0 0 0 0. */
StyRuntimeStatus sty_blend_frame(const StyBundle *bundle, const StyFrame *frame, StyRect rect, const StyMatch *matches,
                                 int bits, void *out);

/* Double resolution, last step: every pixel of `rect` in `out` (width*height) is the mean of four of `picture`
 * (2*width by 2*height), RGBA of 8 or 16 bits; colours weigh by alpha, all is rounded once, half up. */
StyRuntimeStatus sty_halve_picture(int width, int height, int bits, const void *picture, StyRect rect, void *out);

/* ---- patterns ------------------------------------------------------------------
 * What the two passes below are roughened with: a picture that repeats without end in both directions. They need no
 * bundle, and of a frame what they name; its other members must be as for the passes above, but for `style` and
 * `path`, which aren't read. Quotients are rounded down, mod is never negative, isqrt(n) is the largest integer whose
 * square is at most n. */
#define STY_MAX_PATTERN_SIDE 4096
typedef struct StyPattern {
  const uint8_t *texels; /* rows from the top, no padding: 1 byte a texel, or 2 where displacements are asked for;
                            NULL: none */
  int width, height;     /* 1..STY_MAX_PATTERN_SIDE */
} StyPattern;

/* ---- toon shading (thesis 000, 3.4.1) -------------------------------------------
 * Luminance in steps. A pattern makes the steps' borders ragged or hatched; cut into cells, each turned the way the
 * surface bends most, it shows the shape. */
#define STY_MAX_BANDS 8
#define STY_MAX_PATTERN_WEIGHT 2048
#define STY_MIN_CELL_LEVEL 2
#define STY_MAX_CELL_LEVEL 8

typedef struct StyToon {
  int band_count;                        /* 1..STY_MAX_BANDS, from the darkest */
  uint8_t thresholds[STY_MAX_BANDS - 1]; /* luminance, bytes, from which band 1, 2, ... is taken */
  uint8_t colours[STY_MAX_BANDS][4];     /* R G B A, encoded as pictures are, straight */
  int colour_weight;                     /* of the frame's albedo, 256ths, 0 (none) .. 256: bands are factors */
  int style;                             /* only pixels that frame->styles gives this style; 0: all covered ones */
  StyPattern pattern;                    /* 128 leaves the luminance as it is */
  int pattern_weight;                    /* luminance per texel's unit, 256ths, 0..STY_MAX_PATTERN_WEIGHT */
  int cell_level;        /* cells of about 2^level pixels, STY_MIN_CELL_LEVEL..STY_MAX_CELL_LEVEL; 0: the
                            pattern isn't turned */
  const uint8_t *jitter; /* of cells: STY_JITTER_SIZE squared, 2 bytes a texel; a bundle's layer, say */
  int jitter_amount;     /* 255ths, 0..255 */
} StyToon;

/* Needs frame->luma; takes albedo, objects and anchors where they are given. Writes RGBA inside `rect` of `out`, 8 or
 * 16 bits, as sty_blend_frame does.
 *
 * The band is the number of thresholds t (of band_count - 1) with 256 * t <= 256 * luma + pattern_weight * (k - 128), k
 * = pattern at (x mod width, y mod height), (x, y) = p - a, a = anchor of p's object. The colour is multiplied by 1 - w
 * + w * albedo, w = colour_weight, the alpha by the frame's coverage; each is rounded once, half up. Other pixels
 * become 0 0 0 0.
 *
 * Cells: s = the seed of cell_level nearest to p - a (see seeds above), d = p - a - s. The pattern is turned about it:
 * (x, y) = s + ((d.x * c + d.y * n + 2048) / 4096, (d.y * c - d.x * n + 2048) / 4096), (c, n) from the guide at the 5x5
 * samples a + s + 2^(cell_level - 2) * (i, j), i, j = -2..2. A pair of samples next to each other counts where both lie
 * in the frame, are covered, and are of p's object; its length is isqrt(4096 * sum of squared byte differences). With X
 * the sum and m the number of pairs along x, Y and l along y: where X < 32 * m + (m = 0) and Y < 32 * l + (l = 0),
 * nothing is turned: (4096, 0). Else (u, v) = (X * l, Y * m), or (X, Y) where m * l = 0, halved until both are below
 * 2048, r = isqrt(256 * (u * u + v * v)), (c, n) = (65536 * u / r, 65536 * v / r). The angle is 0..90 degrees: lengths
 * don't tell up from down. */
StyRuntimeStatus sty_shade_toon(const StyFrame *frame, const StyToon *toon, StyRect rect, int bits, void *out);

/* ---- outlines (thesis 000, 3.4.2) ------------------------------------------------
 * Four passes, each over any rectangles: which pixels are contours, how far up or down each column the nearest one is,
 * the lines, and their colour on a picture. */

typedef struct StyOutline {
  int silhouette_weight; /* where p's neighbour isn't covered; weights are 0..STY_MAX_OUTLINE_WEIGHT, 0 = off */
  int object_weight;     /* where it is of another object */
  int normal_weight;     /* per byte by which their normals differ beyond the tolerance */
  int depth_weight;      /* per doubling of the gap behind p, from the tolerance on */
  int normal_tolerance;  /* sum of absolute byte differences, 0..STY_MAX_THRESHOLD */
  float depth_tolerance; /* scene units, above 0, finite; about 1/200 of what the frame is deep */
  StyPattern noise;      /* lessens strengths, so that weak contours break up */
  int noise_weight;      /* strength per texel's unit, 256ths, 0..STY_MAX_OUTLINE_WEIGHT */
  int threshold;         /* contours are stronger than that, 0..STY_MAX_OUTLINE_WEIGHT */
} StyOutline;
#define STY_MAX_OUTLINE_WEIGHT 65535
#define STY_MAX_GAP_GRADE 8
#define STY_MAX_DEPTH 1e30f

/* First: 255 in `contours` (width*height bytes) at contours, else 0. Takes the frame's depth and objects where they are
 * given; other pixels of it are looked at to a distance of 2.
 *
 * p is a contour when it is covered and 256 * (depth term + the largest border term of its neighbours left, right,
 * above and below) - noise_weight * noise at (p.x mod width, p.y mod height) > 256 * threshold. Places outside the
 * frame aren't neighbours.
 *
 * Border term, neighbour q: not covered: silhouette_weight. Covered, and the border p's: object_weight, if the objects
 * differ, + normal_weight * max(0, D - normal_tolerance), D = sum of absolute byte differences of their guides; else 0.
 * A border is p's where the gap from p to q (below) is more than the tolerance, q's where that from q to p is; else
 * that of the larger object id; else the left or upper pixel's. So lines are one pixel thin, in front, and whole where
 * surfaces cut through each other.
 *
 * Depth term: depth_weight * the largest grade of the four. A pixel has a depth when it is covered, and that is a
 * number within STY_MAX_DEPTH of 0. The gap to q is z(q) - z(p) - max(3 * slope, z(p) - z(b)), slope = the least of
 * |z(p) - z(b)|, b beyond p, and |z(e) - z(q)|, e beyond q, of those that have a depth; no slope or no z(q), no gap.
 * Planes have none, however they slant, nor have surfaces where others cut through them. The grade is the number of i
 * in 0..STY_MAX_GAP_GRADE-1 with gap > 2^i * depth_tolerance. Float arithmetic, each operation rounded; subtract z(p)
 * before what is in brackets. */
StyRuntimeStatus sty_find_contours(const StyFrame *frame, const StyOutline *outline, StyRect rect, uint8_t *contours);

typedef struct StyLine {
  int width;         /* pixels, 256ths: STY_MIN_LINE_WIDTH..STY_MAX_LINE_WIDTH */
  StyPattern wobble; /* 2 bytes a texel, right and down, 128 = stay; smooth, or lines fray */
  int wobble_amount; /* pixels at 128 +- 128, 256ths, 0..STY_MAX_WOBBLE */
} StyLine;
#define STY_MIN_LINE_WIDTH 128
#define STY_MAX_LINE_WIDTH 16384
#define STY_MAX_WOBBLE 4096

/* Contours farther away don't matter: R = (width + 767) / 512 + 1 pixels. */
int sty_get_line_reach(const StyLine *line);

/* Second: for each pixel of `rect` in `columns` (width*height) the rows from it to the nearest contour in its column,
 * -R..R, upward where two are equally near; STY_NO_CONTOUR where there is none. Needs the contours of `rect` grown up
 * and down by R. */
StyRuntimeStatus sty_measure_columns(int width, int height, const uint8_t *contours, const StyLine *line, StyRect rect,
                                     int8_t *columns);
#define STY_NO_CONTOUR 127

/* Third: how much of each pixel is line, in `lines` (width*height bytes). Needs the columns of `rect` grown by R +
 * wobble_amount / 256 + 1. With the columns this is the exact Euclidean distance to the nearest contour (Meijster et
 * al. 2000, bounded).
 *
 * h = wobble_amount * (j - 128) / 128, j = wobble at (p.x mod width, p.y mod height), right and down; q = p + (h + 128)
 * / 256, f = h - 256 * (q - p), then q is clamped to the frame. The distance L = isqrt of the least (256 * i - f.x)^2 +
 * (256 * columns[q + (i, 0)] - f.y)^2 over i = -R..R; coverage = min(256, width, (width + 256) / 2 - L), at least 0, of
 * 256, times 255 / 256, rounded half up. */
StyRuntimeStatus sty_draw_lines(int width, int height, const int8_t *columns, const StyLine *line, StyRect rect,
                                uint8_t *lines);

/* Fourth: lays a colour (R G B A, straight) over a picture (RGBA of 8 or 16 bits, straight) where lines are, in place.
 * M = 255 or 65535, l = lines * colour's alpha, U = 255 * 255. With `beyond`, over (Porter and Duff 1984): E = l * M +
 * alpha * (U - l), alpha' = E / U, C' = (C * M / 255 * l * M + picture * alpha * (U - l)) / E, 0 where E is. Without,
 * atop, so that nothing is drawn beyond what the picture shows: alpha stays, C' = (C * M / 255 * l + picture * (U - l))
 * / U. Rounded once, half up. */
StyRuntimeStatus sty_lay_lines(int width, int height, const uint8_t *lines, const uint8_t colour[4], int beyond,
                               StyRect rect, int bits, void *picture);

#ifdef __cplusplus
}
#endif
#endif
