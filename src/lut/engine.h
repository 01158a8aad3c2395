/* What the engines share: how distances are measured, the points that library
 * engines search, the tie rule; and their build functions, for the table in
 * engines.c. */
#ifndef STYLUT_SRC_LUT_ENGINE_H
#define STYLUT_SRC_LUT_ENGINE_H

#include "stylut/lut.h"

StyStatus sty_build_brute(const StySites *sites, const StyEngineOptions *options, StyLut *lut, const StyRun *run,
                          StyError *error);
StyStatus sty_build_analytic(const StySites *sites, const StyEngineOptions *options, StyLut *lut, const StyRun *run,
                             StyError *error);
StyStatus sty_build_flann_single(const StySites *sites, const StyEngineOptions *options, StyLut *lut, const StyRun *run,
                                 StyError *error);
StyStatus sty_build_flann_forest(const StySites *sites, const StyEngineOptions *options, StyLut *lut, const StyRun *run,
                                 StyError *error);
StyStatus sty_build_flann_auto(const StySites *sites, const StyEngineOptions *options, StyLut *lut, const StyRun *run,
                               StyError *error);
StyStatus sty_build_cgal(const StySites *sites, const StyEngineOptions *options, StyLut *lut, const StyRun *run,
                         StyError *error);
StyStatus sty_build_grid(const StySites *sites, const StyEngineOptions *options, StyLut *lut, const StyRun *run,
                         StyError *error);

/* ---- what is asked ------------------------------------------------------------ */

/* sty_collect_features with the features of another guide's sites, for a guide that
 * need not show anything: then there are no sites. */
StyStatus sty_collect_target(const char *name, const StyImage *guide, const StySites *source, StySites **out,
                             StyError *error);

/* sty_create_lut without its limits, and with texels that are yet to be set; until then they
 * take no memory. */
StyStatus sty_allocate_lut(const StyLutSpec *spec, int source_width, int source_height, StyLut **out, StyError *error);

/* sty_ask_engine for `count` values, 1 or more: a table of any shape, whose first `count` texels are the answers. */
StyStatus sty_answer_values(const StySites *sites, const StyEngine *engine, const StyEngineOptions *options,
                            StyMetric metric, const float *values, size_t count, const StyRun *run, StyLut **out,
                            StyError *error);

/* Where neighbouring texels' source pixels are farther apart than so many pixels,
 * they are said to jump: four times as far as on a sphere. */
double sty_get_jump(const StyLutSpec *spec, int source_width, int source_height);

/* ---- the one distance that all exact engines agree on ------------------------- */

/* How distances are measured for a guide and a table. In integers, texels and
 * levels stand on one scale of fine steps: byte b at `scale * b`. */
typedef struct StyMeasure {
  int dims;     /* of points: those of the sites, or 3 for the metric angle */
  bool angle;   /* points are lifted from two dimensions */
  bool integer; /* levels are compared in integers (held in double, where all of them are exact) */
  int scale;    /* integer steps per level */
  double unit;  /* guide units per integer step; 1 for float distances */
} StyMeasure;

StyMeasure sty_choose_measure(const StySites *sites, const StyLutSpec *spec);

/* A guide value as a point of the metric's space: for `angle` (3 dims) the third
 * coordinate is added and values outside the disc are shortened to its rim. */
void sty_lift(int dims, const float g[2], float out[3]);

/* The third coordinate of a lifted point. */
float sty_get_height(float x, float y);

typedef struct StyQuery {
  float at[STY_MOST_DIMS]; /* in the metric's space */
  double steps[2];         /* for integer measures: the texel's place in steps */
} StyQuery;

/* The value (of the sites' dims) that texel (i, j) is to answer for: its own, unless another is asked. */
void sty_get_asked_value(const StyLut *lut, int dims, int i, int j, float *g);

void sty_make_query(const StyMeasure *measure, const StyLut *lut, int i, int j, StyQuery *out);

/* Squared, in the shape that lut.h states: rounding depends on it. */
static inline float sty_square_distance(int dims, const float a[], const float b[]) {
  float sum = (a[0] - b[0]) * (a[0] - b[0]);
  for (int k = 1; k < dims; k++) sum = sum + (a[k] - b[k]) * (a[k] - b[k]);
  return sum;
}

/* The same in integers, to a site of these two levels. */
static inline double sty_square_steps(const StyMeasure *measure, const StyQuery *query, const uint8_t levels[2]) {
  const double dx = query->steps[0] - measure->scale * (double)levels[0];
  const double dy = query->steps[1] - measure->scale * (double)levels[1];
  return dx * dx + dy * dy;
}

/* Writes a texel's answer: the source pixel, and the squared distance measured. */
void sty_set_texel(StyLut *lut, const StyMeasure *measure, size_t texel, uint32_t pixel, double squared);

/* u or v of a source pixel, as floats store it. */
float sty_get_coordinate(uint32_t pixel, uint32_t side);

/* ---- points ------------------------------------------------------------------- */

/* Sites in the metric's space, each value once: what brute force and the
 * libraries search. None of them may see the same point a million times. */
typedef struct StyPoints {
  StyMeasure measure;
  size_t count;
  float *values;    /* measure.dims of each */
  uint32_t *pixels; /* the lowest with this value, ascending */
  uint8_t *levels;  /* two of each for integer measures, else NULL */
} StyPoints;

StyStatus sty_collapse_sites(const StySites *sites, const StyLutSpec *spec, StyPoints *out, StyError *error);
void sty_free_points(StyPoints *points);

static inline double sty_measure_point(const StyPoints *points, size_t point, const StyQuery *query) {
  if (!points->measure.integer)
    return (double)sty_square_distance(points->measure.dims, query->at,
                                       points->values + (size_t)points->measure.dims * point);
  return sty_square_steps(&points->measure, query, points->levels + 2 * point);
}

/* The nearest point by looking at each; ties go to the lowest pixel. */
size_t sty_scan_points(const StyPoints *points, const StyQuery *query);

/* ---- ties --------------------------------------------------------------------- */

/* A library's exact index over points. Which of several equally near ones it
 * returns is a matter of chance, so the tie rule asks for more of them. Both
 * functions may be called from several threads at once. */
typedef struct StySearch {
  const StyPoints *points;
  void *index;
  /* The `count` (at most points->count) nearest, any order; false: the library failed. */
  bool (*find_nearest)(const struct StySearch *search, const float *at, int count, int *found);
  /* Up to `most` points within the squared radius, any order: how many, or -1 when the library failed. */
  int (*find_within)(const struct StySearch *search, const float *at, float squared_radius, int most, int *found);
} StySearch;

/* Fills the table through a library's index, by the tie rule. `name` is the engine's, for messages. */
StyStatus sty_search_table(const char *name, const StySearch *search, StyLut *lut, const StyRun *run, StyError *error);

#endif
