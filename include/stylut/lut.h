/* Look-up tables: guide value in, nearest source pixel out.
 *
 * A table covers guide values g = (gx, gy), the x and y of a view-space normal,
 * in [-1, 1]^2; row 0 is gy = +1. Where texel (i, j) of a table of size L looks
 * is a place (x, y) of that square (where width and height differ, L is the
 * width for x and the height for y):
 *   centre: x = (i+1/2)/L*2-1, y = 1-(j+1/2)/L*2
 *   unorm8: x = i/(L-1)*2-1, y = 1-j/(L-1)*2, so that a 256-texel table answers
 *           for every byte value exactly
 *   corner: x = i/L*2-1, y = (L-1-j)/L*2-1, the texel's lower left corner: what
 *           StyleBlitUnity's tables were built for; looked up as centre
 * and which guide value stands there is the map's business:
 *   xy:         g = (x, y), the seeds' own
 *   equal-area: g = (x, y) * sqrt(2-x*x-y*y), Lambert's azimuthal map of the
 *               hemisphere: every texel covers the same solid angle. Places
 *               outside the disc stand for its rim. With centre only.
 * Feasible texels are those with gx^2+gy^2 <= 1 (equal-area: x^2+y^2 <= 1); all
 * are filled.
 *
 * Nearest is by a metric:
 *   xy:    Euclid on (gx, gy)
 *   angle: Euclid on the unit normals (gx, gy, sqrt(1-gx^2-gy^2)), which grows
 *          with the angle between them. Values outside the disc are first
 *          shortened to its rim.
 *
 * Exact means that for every texel the squared distance
 *   (gx-px)*(gx-px) + (gy-py)*(gy-py) [+ (gz-pz)*(gz-pz)]
 * in float, summed from left to right without contraction, equals the minimum
 * over all source pixels, and that of several pixels at the minimum the lowest
 * in row-major order is taken.
 * Where every value of the guide is an 8-bit level, 2*b/255-1, the table is
 * square, and map and metric are xy, the same is computed in integers, since
 * rounding would otherwise decide between pixels that are equally near. All exact
 * engines therefore give the same bytes, on any number of threads and any
 * processor.
 *
 * More dimensions: what is compared may be any 1 to STY_MOST_DIMS channels of a
 * guide, each times a weight (features), by Euclid on the weighted values, summed
 * from the first feature to the last. Where there are three of them a table is a
 * cube: L^3 texels, as L slices of L x L, one below the other from slice 0 at the
 * top, so L wide and L*L high. Texel (i, j) of slice k has its centre at
 *   (i+1/2)/L along the first channel's axis, 1-(j+1/2)/L along the second's,
 *   (k+1/2)/L along the third's
 * from the least to the greatest value of that axis: -1 to 1 for channels named
 * normal.*, 0 to 1 for all others. Sampling centre, map and metric xy; all of its
 * texels count. Where there are more, there are no tables: see match.h. */
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

#define STY_MOST_DIMS 32
#define STY_MAX_CUBE 256 /* texels a side: its slices are as high as an image may be */

/* A channel that counts for the distance: its values times the weight. */
typedef struct StyFeature {
  char channel[STY_MAX_NAME];
  float weight; /* above 0, at most 1000 */
} StyFeature;

/* "NAME[:WEIGHT],...": at most STY_MOST_DIMS names, each once. `what` is for messages. STY_ERROR_USAGE. */
StyStatus sty_parse_features(const char *what, const char *text, StyFeature out[STY_MOST_DIMS], int *count,
                             StyError *error);

/* Room for all that sty_write_features may write. */
#define STY_FEATURES_SIZE (STY_MOST_DIMS * (STY_MAX_NAME + 16))

/* The same text back; weights of 1 are left out. */
void sty_write_features(const StyFeature *features, int count, char out[STY_FEATURES_SIZE]);

/* The values of a guide's covered pixels: what engines search. */
typedef struct StySites {
  int width, height;    /* of the source guide, pixels */
  size_t count;         /* covered pixels */
  float *values;        /* `dims` of each: gx, gy, or its features */
  uint32_t *pixels;     /* row-major index of each, ascending */
  uint8_t *levels;      /* the two bytes of each value gx, gy, or NULL where some value isn't an 8-bit level */
  int dims;             /* 1 to STY_MOST_DIMS */
  StyFeature *features; /* `dims` of them: where the values are from */
} StySites;

/* Collects the covered pixels of a guide (channels A, normal.X, normal.Y; see
 * guide.h). `name` is for messages. STY_ERROR_INPUT: no covered pixel, a coverage that isn't
 * a number, or a value that isn't finite or lies outside STY_MAX_GUIDE_VALUE (the message names
 * the pixel). The caller owns the sites. */
StyStatus sty_collect_sites(const char *name, const StyImage *guide, StySites **out, StyError *error);

/* The same for any channels of a guide with A. A name that is no channel's
 * stands for all channels NAME.*, in the guide's order, each with that weight.
 * STY_ERROR_INPUT as above, for weighted values, and for a channel that isn't
 * there (the message lists what is); STY_ERROR_USAGE: a weight or a number of
 * channels that can't be. `levels` is NULL. */
StyStatus sty_collect_features(const char *name, const StyImage *guide, const StyFeature *features, int count,
                               StySites **out, StyError *error);
void sty_destroy_sites(StySites **sites);

typedef enum StySampling { STY_SAMPLE_CENTRE, STY_SAMPLE_UNORM8, STY_SAMPLE_CORNER } StySampling;
typedef enum StyMap { STY_MAP_XY, STY_MAP_EQUAL_AREA } StyMap;
typedef enum StyMetric { STY_METRIC_XY, STY_METRIC_ANGLE } StyMetric;
/* Names in the enums' order, NULL-terminated. */
extern const char *const sty_sampling_names[], *const sty_map_names[], *const sty_metric_names[];

/* What a table is to be. Ours are square; those of other tools need not be. */
typedef struct StyLutSpec {
  int width, height; /* texels; of a cube the height of all slices: width*width */
  StySampling sampling;
  StyMap map;
  StyMetric metric;
} StyLutSpec;

typedef struct StyLut {
  StyLutSpec spec;
  int source_width, source_height; /* pixels */
  size_t unique;                   /* distinct source values that were searched; 0 where not known */
  uint32_t *pixels;                /* per texel, row-major: index of the source pixel, y*source_width + x */
  float *errors;                   /* per texel: distance to that pixel's value by the metric */
  double slack;                    /* guide units: how much farther than the nearest its pixels may be; 0: none is */
  int depth;                       /* 0: a flat table; of a cube its slices, as many as it is wide */
  StyFeature axes[3];              /* of a cube */
  const float *asked;              /* NULL; while an engine is asked, values in place of the texels' own */
  size_t asked_count;              /* of them; texels beyond stand for the last */
} StyLut;

/* Whether there can be such a table: sides run from 1 (unorm8: 2) to STY_MAX_LUT_SIZE; others,
 * and equal-area with another sampling than centre, give STY_ERROR_USAGE. */
StyStatus sty_check_spec(const StyLutSpec *spec, StyError *error);

/* An empty table, all zero. Errors as of sty_check_spec. */
StyStatus sty_create_lut(const StyLutSpec *spec, int source_width, int source_height, StyLut **out, StyError *error);

/* An empty cube of 1 to STY_MAX_CUBE texels a side. */
StyStatus sty_create_cube(int size, const StyFeature axes[3], int source_width, int source_height, StyLut **out,
                          StyError *error);
void sty_destroy_lut(StyLut **lut);

static inline size_t sty_count_texels(const StyLutSpec *spec) { return (size_t)spec->width * (size_t)spec->height; }

/* The guide value (g[0], g[1]) that texel (i, j) answers for. */
void sty_get_texel_value(const StyLutSpec *spec, int i, int j, float g[2]);

/* Where the axis of a cube's channel starts: -1 for channels named normal.*, 0 for others; all end at 1. */
float sty_get_axis_start(const char *channel);

/* The channels' values, without weights, that texel (i, j) of slice k of a cube answers for. */
void sty_get_cube_value(const StyLut *lut, int i, int j, int k, float g[3]);

/* Whether texel (i, j) is feasible. */
bool sty_is_feasible(const StyLutSpec *spec, int i, int j);

/* The texel (t[0], t[1]) that answers for a guide value within STY_MAX_GUIDE_VALUE; values outside
 * the disc or square that the map covers are clamped. */
void sty_find_texel(const StyLutSpec *spec, const float g[2], int t[2]);

/* What only some engines heed. */
typedef struct StyEngineOptions {
  int trees;        /* flann-forest: 1 to 64 */
  int checks;       /* flann-forest: leaves looked at, 1 and up */
  double precision; /* flann-auto: share of exact answers aimed at, above 0 to 1 */
} StyEngineOptions;
extern const StyEngineOptions sty_default_engine_options; /* 4 trees, 32 checks, 0.9 */

typedef struct StyEngine {
  const char *name;
  const char *summary; /* for --help */
  bool exact;
  int least_dims, most_dims; /* of sites that it takes */
  /* Fills pixels, errors and unique of *lut; `sites` aren't empty and have dims that it takes. */
  StyStatus (*build)(const StySites *sites, const StyEngineOptions *options, StyLut *lut, const StyRun *run,
                     StyError *error);
} StyEngine;

/* All engines; the last has a NULL name. The first is the reference. */
extern const StyEngine sty_engines[];

/* By name; "auto" takes the fastest exact one for flat tables. STY_ERROR_USAGE lists the names. */
StyStatus sty_find_engine(const char *what, const char *name, const StyEngine **out, StyError *error);

/* STY_ERROR_USAGE where an engine doesn't take values of so many dimensions; names those that do. */
StyStatus sty_check_dims(const StyEngine *engine, int dims, StyError *error);

/* The fastest exact engine of this build: for flat tables, which `grid` is made for,
 * or for cubes and fields (match.h) of so many dimensions. */
typedef enum StyTask { STY_TASK_TABLE, STY_TASK_CUBE_OR_FIELD } StyTask;
const StyEngine *sty_get_fastest_engine(StyTask task, int dims);

/* Builds a table from sites of two dimensions; the caller owns it. `options` may
 * be NULL: the defaults. STY_ERROR_UNAVAILABLE: an engine that this build goes
 * without. */
StyStatus sty_build_lut(const StySites *sites, const StyEngine *engine, const StyEngineOptions *options,
                        const StyLutSpec *spec, const StyRun *run, StyLut **out, StyError *error);

/* The same for a cube, from sites of three dimensions, whose features become its
 * axes. STY_ERROR_USAGE names the engines that can, where this one can't. */
StyStatus sty_build_cube(const StySites *sites, const StyEngine *engine, const StyEngineOptions *options, int size,
                         const StyRun *run, StyLut **out, StyError *error);

/* What rules the choice among the source pixels of nearly equal distance. */
typedef struct StyResolveOptions {
  double slack;          /* guide units, 0 or more, above the least distance of each texel */
  bool coherent;         /* neighbouring texels on neighbouring pixels: a pair farther apart than 4 * longer side of the
                            source / longer side of the table, and than 1, is a jump */
  const StyImage *guide; /* the table's own: A, normal.* */
  /* Guides of frames (the same channels): the pixels around which the runtime, with
   * its default threshold, copies the largest pieces into such frames. Together
   * with `coherent` the two are weighed; `coherent` without frames takes the guide
   * itself for one, of little weight. NULL and 0 without frames. A guide or frame
   * without normal.Z is taken to face the viewer everywhere. */
  const StyImage *const *frames;
  int frame_count;
} StyResolveOptions;

/* Replaces source pixels of an exact table of these sites by others within the
 * slack. Deterministic. `coherent` without frames never adds jumps between feasible
 * texels, and leaves a table without any, their neighbours at the rim included, as it
 * is. STY_ERROR_INPUT: a guide without the channels, or not of the table's source. */
StyStatus sty_resolve_lut(StyLut *lut, const StySites *sites, const StyResolveOptions *options, const StyRun *run,
                          StyError *error);

/* What an engine answers to one value (of the sites' dims), wherever the texels of
 * tables stand: the source pixel, by the tie rule for exact engines, and its
 * distance by the metric. Distances are compared in float, of 8-bit guides too.
 * `options` may be NULL: the defaults. Errors as of sty_build_lut; the metric
 * angle takes sites of two dimensions. STY_ERROR_INPUT: a value that isn't finite or
 * lies outside STY_MAX_GUIDE_VALUE. */
StyStatus sty_ask_engine(const StySites *sites, const StyEngine *engine, const StyEngineOptions *options,
                         StyMetric metric, const float *g, const StyRun *run, uint32_t *pixel, float *distance,
                         StyError *error);

/* How a table is stored. With u = (x+1/2)/W, v = (y+1/2)/H of the source pixel:
 *   f32    float channels u, v, error (EXR)
 *   rg16   16 bit, R = u, G = v, B = 0
 *   rg8x2  8 bit, R G = high and low byte of the 16-bit u, B A = of v
 *   rg8    8 bit, R = u, G = v, B = 0: what older plugins use; loses precision
 *          for sources of more than 256 pixels a side
 * Cubes are stored as they stand, and name their depth and axes in attributes.
 * Integers are those of sty_encode_coordinate with a maximum of 255 or 65535. */
typedef enum StyEncoding { STY_ENCODE_F32, STY_ENCODE_RG16, STY_ENCODE_RG8X2, STY_ENCODE_RG8 } StyEncoding;
extern const char *const sty_encoding_names[];

/* The table as an image to be written, with attributes that say what it is. */
StyStatus sty_encode_lut(const StyLut *lut, StyEncoding encoding, StyImage **out, StyError *error);

/* How tables of other tools are to be read. */
typedef enum StyForeign {
  STY_FOREIGN_NONE,  /* by the file's own attributes */
  STY_FOREIGN_UNITY, /* StyleBlitUnity's: rg8, v counted from the bottom, sampling corner, any proportions */
  STY_FOREIGN_RG8,
  STY_FOREIGN_RG16,
  STY_FOREIGN_RG8X2
} StyForeign;
extern const char *const sty_foreign_names[]; /* "stylut", "unity", "rg8", "rg16", "rg8x2", NULL */

/* What isn't said in a table's own attributes. */
typedef struct StyLutHints {
  int source_width, source_height; /* 0: unknown */
  int sampling;                    /* a StySampling, or -1: unknown (centre is assumed) */
  StyForeign foreign;              /* overrules the file's own word on encoding and rows, unity on sampling too */
} StyLutHints;

/* An image back into a table. Without attributes and hints 16-bit pictures are
 * rg16 and float ones with channels u and v are f32; the source size must come
 * from one of them. Only STY_FOREIGN_UNITY need not be square. `errors` stays
 * zero where the encoding has none. STY_ERROR_INPUT names the first bad texel. */
StyStatus sty_decode_lut(const char *name, const StyImage *image, const StyLutHints *hints, StyLut **out,
                         StyError *error);

#ifdef __cplusplus
}
#endif
#endif
