/* One guide value's way through a table, step by step: value -> texel -> stored
 * source pixel, beside the answer that would have been right.
 *
 * Distances are by the table's metric in guide units (see lut.h), angles between
 * reconstructed normals in degrees (see audit.h). */
#ifndef STYLUT_PROBE_H
#define STYLUT_PROBE_H

#include "stylut/audit.h"
#include "stylut/lut.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A source pixel as an answer to some guide value. */
typedef struct StyNeighbour {
  int pixel[2];
  bool covered;    /* the rest means something only then */
  float value[2];  /* the pixel's own */
  double distance; /* of the two values */
  double degrees;
} StyNeighbour;

typedef struct StyProbeOptions {
  double precision; /* of the guide, guide units; 0: see sty_get_precision */
  double jump;      /* J, source pixels; 0: as in the audit */
} StyProbeOptions;

typedef struct StyProbe {
  float value[2];  /* as asked; -0 is 0 */
  bool inside;     /* the disc */
  int texel[2];    /* the one that answers */
  float own[2];    /* the value which that texel stands for */
  double distance; /* between the two */
  double degrees;
  /* The stored pixel, as an answer to the value asked and to the texel's own. */
  StyNeighbour stored, stored_at_texel;
  bool nearest;          /* no source pixel is nearer to the value asked */
  bool nearest_at_texel; /* or to the texel's own: what an exact table holds */
  /* The right answers to the same two, by looking at every source pixel: in float
   * to the first, and to the second as tables are built (for 8-bit guides in integers). */
  StyNeighbour best, best_at_texel;
  /* The nearest pixel to the value asked that has another value than `best`. */
  bool has_runner_up; /* else all covered pixels have one value */
  StyNeighbour runner_up;
  /* Source pixels within the precision of the least distance, as in the audit,
   * for the value asked. */
  double precision, jump; /* as used */
  size_t choice;          /* how many */
  size_t pieces;          /* connected ones (8-neighbours) */
  double spread;          /* RMS distance from their centroid, pixels */
  bool ambiguous;         /* two pieces or more, or a spread above J */
} StyProbe;

/* Sends a value, in [-1, 1] each, through a table. `sites` are those of `guide`,
 * the guide that the table was made for. STY_ERROR_INPUT: the table is for a
 * source of another size; STY_ERROR_LIBRARY: memory. */
StyStatus sty_probe_lut(const StyLut *lut, const StyImage *guide, const StySites *sites, const float value[2],
                        const StyProbeOptions *options, StyProbe *out, StyError *error);

/* What an engine answers to the same value; errors as of sty_ask_engine. */
StyStatus sty_probe_engine(const StySites *sites, const StyEngine *engine, StyMetric metric, const float value[2],
                           const StyRun *run, StyNeighbour *out, StyError *error);

#ifdef __cplusplus
}
#endif
#endif
