/* What `stylut lut` is asked for. */
#ifndef STYLUT_TOOLS_LUT_ARGUMENTS_H
#define STYLUT_TOOLS_LUT_ARGUMENTS_H

#include "inputs.h"
#include "options.h"
#include "stylut/lut.h"

/* As --resolve names them in lut_resolve_names. */
typedef enum LutResolve { RESOLVE_NEAREST, RESOLVE_COHERENT, RESOLVE_FRAMES, RESOLVE_BOTH } LutResolve;
extern const char *const lut_resolve_names[];

enum { MAP_ANY = -1 };

typedef struct LutArguments {
  Options options;
  const char *guide;
  int size;                  /* texels a side; 0: the smallest that meets the budget */
  int sampling, map, metric; /* the spec's enums; map MAP_ANY: either */
  double max_p99;            /* degrees; 0: no budget */
  Frames frames;
  const StyEngine *engine;
  StyFeature features[STY_MOST_DIMS]; /* of a cube */
  int feature_count;                  /* 0: a flat table */
  long long max_memory;               /* bytes; 0: not given */
  int resolve;                        /* a LutResolve */
  double slack;                       /* 8-bit levels */
  int encoding;                       /* a StyEncoding */
} LutArguments;

/* Reads and checks the command line; where this succeeds and help wasn't all that was
 * asked for, everything is set and goes together. */
StyStatus parse_lut_arguments(int argc, char **argv, LutArguments *out);

/* Of a cube: its texels, and the bytes of table and picture. */
void measure_cube(const LutArguments *arguments, double *texels, double *bytes);

#endif
