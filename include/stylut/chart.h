/* What tables of a guide cost and what they are worth: builds them by many
 * engines, sizes, maps, metrics and encodings, for charts of
 *   time  against lookup p99: engines, their parameters, sizes; map xy, metric xy,
 *         nothing lost to an encoding
 *   bytes against lookup p99: maps, metrics, encodings, sizes; the fastest exact
 *         engine, since all exact ones give the same table
 * so that what doesn't matter to a chart isn't multiplied into it. */
#ifndef STYLUT_CHART_H
#define STYLUT_CHART_H

#include "stylut/audit.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { STY_MOST_CHART_SIZES = 16 };

typedef struct StyChartOptions {
  const int *sizes; /* texels a side, ascending, each once */
  int size_count;   /* 1 to STY_MOST_CHART_SIZES */
  const StyEngine *const *engines;
  int engine_count;             /* 1 and up */
  int repeats;                  /* builds that a time is the median of, 1 and up */
  const StyAuditOptions *audit; /* weights and frames */
} StyChartOptions;

typedef enum StyChartPanel { STY_PANEL_TIME, STY_PANEL_BYTES, STY_PANELS } StyChartPanel;

/* A point's place in a chart. On the front: no other point of the chart is as
 * good in both figures and better in one. Figures count as they are printed, to
 * the microsecond and the millionth of a degree. */
typedef enum StyChartPlace { STY_PLACE_NONE, STY_PLACE_BEHIND, STY_PLACE_FRONT } StyChartPlace;

/* One table. */
typedef struct StyChartPoint {
  const StyEngine *engine;
  StyEngineOptions parameters; /* as far as the engine heeds any */
  StyLutSpec spec;
  StyEncoding encoding;
  size_t bytes;        /* of its texture */
  double milliseconds; /* of a build, without encoding: the median, to the microsecond */
  int runs;            /* builds: fewer than asked for where they take seconds */
  StyFigures lookup;   /* encoding included */
  StyChartPlace places[STY_PANELS];
} StyChartPoint;

/* Tables that weren't built. */
typedef struct StyChartOmission {
  const StyEngine *engine;
  int size; /* this one and larger ones */
  char reason[512];
} StyChartOmission;

typedef struct StyChart {
  StyChartPoint *points; /* by engine, parameters, map, metric, encoding, then size */
  int count;
  StyChartOmission *omissions; /* an engine each */
  int omission_count;
} StyChart;

/* Measures; sty_free_chart frees what it gets. An engine that refuses the guide or
 * isn't built in is left out and listed; so is `brute` where its work would take
 * seconds. All of the chart but times, and points of engines that aren't exact,
 * is the same from run to run. Builds take turns, so that all of them meet the same
 * weather on the machine. Errors: STY_ERROR_INPUT when no engine is left; those
 * of sty_build_lut and sty_audit_lookup. */
StyStatus sty_measure_chart(const StySites *sites, const StyImage *guide, const StyChartOptions *options,
                            const StyRun *run, StyChart *out, StyError *error);
void sty_free_chart(StyChart *chart);

/* "trees=4 checks=32", or "" for engines without parameters. Returns `text`. */
enum { STY_PARAMETERS_SIZE = 64 };
const char *sty_format_parameters(const StyEngine *engine, const StyEngineOptions *parameters,
                                  char text[STY_PARAMETERS_SIZE]);

/* Marks the front of one panel among the points that have a place in it. */
void sty_mark_front(StyChartPoint *points, int count, StyChartPanel panel);

/* The median of `count` (1 and up) values, of an even number the lower one; sorts them. */
double sty_find_median(double *values, int count);

#ifdef __cplusplus
}
#endif
#endif
