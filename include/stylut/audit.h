/* The audit: what a table costs, in degrees.
 *
 * Angles are between reconstructed unit normals: of a guide value g,
 * (gx, gy, sqrt(1-gx^2-gy^2)), shortened to the unit circle where g lies
 * outside. Figures are over feasible texels (gx^2+gy^2 <= 1), uniform in the
 * disc. Mind the rim: a step d at radius r turns the normal by d/sqrt(1-r^2),
 * so that p99 and max are ruled by the last texels before the silhouette. */
#ifndef STYLUT_AUDIT_H
#define STYLUT_AUDIT_H

#include "stylut/lut.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct StyFigures {
  double mean, p50, p95, p99, max; /* degrees; percentiles by nearest rank */
  /* Where the max is, first in row-major order: texel, guide value asked for,
   * source pixel given. */
  int texel[2];
  float value[2];
  int source[2];
} StyFigures;

typedef struct StyAudit {
  int size;
  StySampling sampling;
  size_t feasible;       /* texels */
  size_t background;     /* feasible texels that point at a source pixel that isn't covered (180 degrees each) */
  StyFigures assignment; /* at the values the texels answer for */
  /* For guide values in between: each texel's square is asked for 4 x 4 values
   * spread over it (2 x 2 in tables beyond 1024), those inside the disc, also
   * where the texel's own centre is outside. A unorm8 table is meant for byte
   * guides and is asked for every byte value instead; with 256 texels a side
   * that is its assignment error. Float guides pay up to half a byte more. */
  StyFigures lookup;
  double tolerance; /* guide units */
  double coverage;  /* share of feasible texels with a source pixel within the tolerance */
} StyAudit;

/* Guide units per 8-bit level. */
#define STY_LEVEL (2.0 / 255.0)

/* Audits `lut` against the guide it was made for. `exact` is an exact table of
 * the same guide, size and sampling: it says what is covered (a table's own
 * choices may be poor). Errors: STY_ERROR_INPUT when sizes don't fit,
 * the guide has no normals, or no texel is feasible (unorm8 of size 2);
 * STY_ERROR_LIBRARY (memory). */
StyStatus sty_audit_lut(const StyLut *lut, const StyLut *exact, const StyImage *guide, double tolerance, StyAudit *out,
                        StyError *error);

/* The audit as JSON, schema stylut-audit/1; the caller frees it. NULL when
 * memory is short. */
char *sty_format_audit(const StyAudit *audit);

#ifdef __cplusplus
}
#endif
#endif
