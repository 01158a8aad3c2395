/* Look-up tables: guide value in, nearest source pixel out.
 *
 * A table of size L covers guide values g = (gx, gy), the x and y of a view-space
 * normal, in [-1, 1]^2; row 0 is gy = +1. Where a texel looks:
 *   centre: texel (i, j) answers for gx = (i+1/2)/L*2-1, gy = 1-(j+1/2)/L*2
 *   unorm8: texel (i, j) answers for gx = i/(L-1)*2-1, gy = 1-j/(L-1)*2, so that a
 *           256-texel table answers for every byte value exactly
 * Feasible texels are those with gx^2+gy^2 <= 1; all are filled.
 *
 * Exact means that for every texel the distance
 *   (gx-px)*(gx-px) + (gy-py)*(gy-py)   in float, without contraction
 * equals the minimum over all source pixels, and that of several pixels at the
 * minimum the lowest in row-major order is taken. All exact engines therefore
 * give the same bytes, on any number of threads. */
#ifndef STYLUT_LUT_H
#define STYLUT_LUT_H

#include <stdbool.h>
#include <stdint.h>

#include "stylut/image.h"
#include "stylut/parallel.h"

#ifdef __cplusplus
extern "C" {
#endif

#define STY_MAX_LUT_SIZE 8192

/* The guide's values, duplicates collapsed: what engines search. */
typedef struct StySites {
  int width, height;  /* of the source guide, pixels */
  size_t point_count; /* covered pixels */
  size_t count;       /* distinct values */
  float *values;      /* gx, gy of each; in ascending order of `pixels` */
  uint32_t *pixels;   /* row-major index of the lowest pixel with this value */
} StySites;

/* Collects the covered pixels of a guide (channels A, normal.X, normal.Y; see
 * guide.h). `name` is for messages. STY_ERROR_INPUT: no covered pixel, or a
 * value that isn't finite or lies outside [-1000, 1000] (the message names the
 * pixel). The caller owns the sites. */
StyStatus sty_collect_sites(const char *name, const StyImage *guide, StySites **out, StyError *error);
void sty_destroy_sites(StySites **sites);

typedef enum StySampling { STY_SAMPLE_CENTRE, STY_SAMPLE_UNORM8 } StySampling;
extern const char *const sty_sampling_names[]; /* NULL-terminated, in the enum's order */

typedef struct StyLut {
  int size;
  StySampling sampling;
  int source_width, source_height; /* pixels */
  uint32_t *pixels;                /* per texel, row-major: index of the source pixel, y*source_width + x */
  float *errors;                   /* per texel: guide distance to that pixel's value, in units of g */
} StyLut;

/* Sizes run from 1 (unorm8: 2) to STY_MAX_LUT_SIZE; others give STY_ERROR_USAGE. */
StyStatus sty_create_lut(int size, StySampling sampling, int source_width, int source_height, StyLut **out,
                         StyError *error);
void sty_destroy_lut(StyLut **lut);

/* The guide value (g[0], g[1]) that texel (i, j) answers for. */
void sty_get_texel_value(const StyLut *lut, int i, int j, float g[2]);

/* The texel (t[0], t[1]) that answers for a guide value; values outside
 * [-1, 1] are clamped. */
void sty_find_texel(const StyLut *lut, const float g[2], int t[2]);

typedef struct StyEngine {
  const char *name;
  const char *summary; /* for --help */
  bool exact;
  /* Fills pixels and errors of *lut; `sites` aren't empty. */
  StyStatus (*build)(const StySites *sites, StyLut *lut, const StyRun *run, StyError *error);
} StyEngine;

/* All engines; the last has a NULL name. The first is the reference. */
extern const StyEngine sty_engines[];

/* By name; "auto" takes the fastest exact one. STY_ERROR_USAGE lists the names. */
StyStatus sty_find_engine(const char *what, const char *name, const StyEngine **out, StyError *error);

/* Builds a table; the caller owns it. */
StyStatus sty_build_lut(const StySites *sites, const StyEngine *engine, int size, StySampling sampling,
                        const StyRun *run, StyLut **out, StyError *error);

/* How a table is stored. With u = (x+1/2)/W, v = (y+1/2)/H of the source pixel:
 *   f32    float channels u, v, error (EXR)
 *   rg16   16 bit, R = u, G = v, B = 0
 *   rg8x2  8 bit, R G = high and low byte of the 16-bit u, B A = of v
 *   rg8    8 bit, R = u, G = v, B = 0: what older plugins use; loses precision
 *          for sources of 255 pixels and more
 * Integers are round(u*M) with M = 255 or 65535; read back as value*W/M rounded
 * down, at most W-1. */
typedef enum StyEncoding { STY_ENCODE_F32, STY_ENCODE_RG16, STY_ENCODE_RG8X2, STY_ENCODE_RG8 } StyEncoding;
extern const char *const sty_encoding_names[];

/* One coordinate there and back. */
uint32_t sty_encode_coordinate(uint32_t pixel, uint32_t side, uint32_t maximum);
uint32_t sty_decode_coordinate(uint32_t value, uint32_t side, uint32_t maximum);

/* The table as an image to be written, with attributes that say what it is. */
StyStatus sty_encode_lut(const StyLut *lut, StyEncoding encoding, StyImage **out, StyError *error);

/* What isn't said in a table's own attributes. */
typedef struct StyLutHints {
  int source_width, source_height; /* 0: unknown */
  int sampling;                    /* a StySampling, or -1: unknown (centre is assumed) */
} StyLutHints;

/* An image back into a table. Tables of other tools carry no attributes: then
 * 16-bit pictures are rg16, float ones with channels u and v are f32, and the
 * source size must come from the hints. `errors` stays zero where the encoding
 * has none. STY_ERROR_INPUT names the first bad texel. */
StyStatus sty_decode_lut(const char *name, const StyImage *image, const StyLutHints *hints, StyLut **out,
                         StyError *error);

#ifdef __cplusplus
}
#endif
#endif
