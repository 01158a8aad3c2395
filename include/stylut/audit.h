/* The audit: what a table costs, in degrees.
 *
 * Angles are between reconstructed unit normals: of a guide value g,
 * (gx, gy, sqrt(1-gx^2-gy^2)), shortened to the unit circle where g lies
 * outside. Figures are over feasible texels (see lut.h). Mind the rim: a step d
 * at radius r turns the normal by d/sqrt(1-r^2), so that in the xy map p99 and
 * max are ruled by the last texels before the silhouette. */
#ifndef STYLUT_AUDIT_H
#define STYLUT_AUDIT_H

#include "stylut/lut.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Guide units per 8-bit level. */
#define STY_LEVEL (2.0 / 255.0)

/* What counts how much. */
typedef enum StyWeights {
  STY_WEIGHT_DISC,   /* every place of the disc alike */
  STY_WEIGHT_SPHERE, /* by solid angle */
  STY_WEIGHT_FRAMES  /* as often as the given frames ask for it */
} StyWeights;
extern const char *const sty_weights_names[]; /* NULL-terminated, in the enum's order */

typedef struct StyAuditOptions {
  double tolerance; /* coverage, guide units */
  double precision; /* of the guide, guide units: for ambiguity and stability. 0: see sty_get_precision */
  double jump;      /* J, source pixels. 0: 4 * longer side of the source / that of the table, 1 at least */
  StyWeights weights;
  const StyImage *const *frames; /* guides, for STY_WEIGHT_FRAMES */
  int frame_count;
  uint64_t seed; /* of the disturbances that stability is measured with */
} StyAuditOptions;

/* A guide's own precision, one step between its values: of 8 and 16 bits, or of
 * float at 1. */
double sty_get_precision(const StyImage *guide);

/* Errors span decades, so they are counted in bins of equal ratio: bin 0 from 0,
 * bin k from STY_LEAST_ERROR * 10^((k-1)/STY_ERROR_BINS_A_DECADE) degrees. */
#define STY_LEAST_ERROR 1e-4
enum { STY_ERROR_BINS_A_DECADE = 24, STY_ERROR_BINS = 152 };

typedef struct StyFigures {
  double mean, p50, p95, p99, max; /* degrees, weighted; percentiles by nearest rank */
  double shares[STY_ERROR_BINS];   /* of the weight, by error; sum 1 */
  /* Where the max is, first in row-major order: texel, guide value asked for,
   * source pixel given. */
  int texel[2];
  float value[2];
  int source[2];
} StyFigures;

enum { STY_USAGE_BINS = 5 };
extern const char *const sty_usage_names[STY_USAGE_BINS]; /* "0", "1", "2-7", "8-19", "20+" */

typedef struct StyAudit {
  StyLutSpec spec;
  StyWeights weights;
  double jump, precision, tolerance; /* as used */
  size_t feasible;                   /* texels; for STY_WEIGHT_FRAMES those that are asked for */
  size_t background;     /* of these, those that point at a source pixel that isn't covered (180 degrees each) */
  double slack;          /* guide units: the table's own (see lut.h); 0: it is meant to hold the nearest */
  size_t beyond_slack;   /* of these texels, where there is a slack, those whose pixel is farther than it allows */
  StyFigures assignment; /* at the values the texels answer for */
  /* For guide values in between: each texel's square is asked for 4 x 4 values
   * spread over it (2 x 2 in tables beyond 1024), those inside the disc, also
   * where the texel's own centre is outside. A unorm8 table is meant for byte
   * guides and is asked for every byte value instead; with 256 texels a side
   * that is its assignment error. Float guides pay up to half a byte more.
   * STY_WEIGHT_FRAMES asks for what the frames' pixels hold. */
  StyFigures lookup;
  StyFigures
      excess;     /* assignment error above that of the exact table; 0 where a texel's distance is the least there is */
  double optimal; /* share of texels whose pixel is as near as any */
  double coverage;              /* share with a source pixel within the tolerance */
  size_t usage[STY_USAGE_BINS]; /* covered source pixels by the number of feasible texels that use them */
  double unused;                /* share of covered source pixels that no feasible texel uses */
  double ambiguous;             /* share of texels whose source pixels within the precision of the least distance fall
                                   into two pieces (8-neighbours) or more, or spread over more than J (RMS from their centroid) */
  double spread;                /* mean of that spread, source pixels */
  double jumps;    /* share of pairs of neighbouring feasible texels whose source pixels are more than J apart */
  double unstable; /* share of texels whose nearest pixel moves by more than J when the guide's values are disturbed
                      by half a step of its precision either way; mean of 8 seeded trials. Of the exact table: it
                      says how much of any table's choice is chance */
} StyAudit;

/* Per texel, row-major; NAN where a texel isn't feasible (assignment and excess: or has no weight). */
typedef struct StyAuditMaps {
  float *assignment, *excess; /* degrees */
  float *pieces;              /* of the source pixels within the precision */
  float *spread;              /* source pixels */
  float *jumps;               /* share of up to four neighbours farther than J */
  float *unstable;            /* share of the trials */
  float *weights;             /* sum 1 */
} StyAuditMaps;
void sty_free_audit_maps(StyAuditMaps *maps);

/* Audits `lut` against the guide it was made for. `exact` is an exact table of
 * the same guide and spec: it says what is covered and what can be had.
 * `maps` may be NULL; the caller frees what it gets. Errors: STY_ERROR_INPUT
 * when sizes don't fit, the guide has no normals, no texel is feasible (unorm8
 * of size 2), or no frame has a covered pixel; STY_ERROR_LIBRARY (memory). */
StyStatus sty_audit_lut(const StyLut *lut, const StyLut *exact, const StyImage *guide, const StyAuditOptions *options,
                        const StyRun *run, StyAudit *out, StyAuditMaps *maps, StyError *error);

/* What an audit can be held to, as the options of `stylut check` and the keys of a manifest's "check" call it. */
typedef struct StyLimit {
  const char *name;
  double largest; /* that makes sense: degrees, or a share */
  bool at_least;  /* the figure must be as large as the budget, not as small */
} StyLimit;
enum { STY_LIMITS = 9 };
extern const StyLimit sty_limits[]; /* NULL behind the last */

/* The figure that a limit is about, and whether it keeps to a budget. */
double sty_get_limited(const StyAudit *audit, int limit);
bool sty_is_within(const StyAudit *audit, int limit, double budget);

/* The lookup error alone (see StyAudit). STY_ERROR_INPUT: sizes don't fit, no
 * normals, no covered pixel in the frames; STY_ERROR_LIBRARY (memory). */
StyStatus sty_audit_lookup(const StyLut *lut, const StyImage *guide, const StyAuditOptions *options, StyFigures *out,
                           StyError *error);

/* ---- the smallest table that will do -------------------------------------------- */

/* A table that was tried. */
typedef struct StyCandidate {
  StyLutSpec spec;
  size_t bytes;      /* of its texture */
  StyFigures lookup; /* encoding included */
} StyCandidate;

enum { STY_MOST_CANDIDATES = 48 };

/* The lookup errors that a table may have, degrees; 0: any. */
typedef struct StyBudget {
  double mean, p99, max;
} StyBudget;

/* The error that takes the largest share of its budget: up to 1 the budget is met. */
double sty_compare_budget(const StyFigures *figures, const StyBudget *budget);

/* Builds exact tables of growing size (each about 1.41 times the last, from 16
 * to 4096 a side), in the given encoding, with the metric and sampling of
 * *spec, and with both maps where `any_map` is set and the sampling allows it;
 * finds the one with the fewest bytes that meets the budget,
 * after three halvings between the first that meets it and the last that
 * doesn't (errors fall only by and large with size). Growing ends two sizes after
 * the budget is met, so that one sees what more would buy, or when three sizes in a
 * row bring no more than 1 %. `candidates` has room for STY_MOST_CANDIDATES and
 * receives all that were tried, by bytes; *chosen is the one to take, or -1 where
 * none will do. */
StyStatus sty_choose_size(const StySites *sites, const StyImage *guide, const StyLutSpec *spec, bool any_map,
                          StyEncoding encoding, const StyAuditOptions *options, const StyBudget *budget,
                          const StyRun *run, StyCandidate *candidates, int *count, int *chosen, StyError *error);

/* The audit as JSON, schema stylut-audit/1; the caller frees it. NULL when
 * memory is short. */
char *sty_format_audit(const StyAudit *audit);

#ifdef __cplusplus
}
#endif
#endif
