#include "stylut/chart.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "audit/stored.h"
#include "lut/engine.h"

enum { ENCODINGS = 4, MAPS = 2, METRICS = 2 };

/* A table that took so long already, in milliseconds, isn't built again. */
static const double patience = 2000;

/* Distances that `brute` may measure for a table: seconds. */
static const double most_brute_work = 2e9;

/* Quick and rough, as it comes, slow and thorough. */
static const struct { int trees, checks; } forests[] = {{1, 8}, {4, 32}, {8, 128}};
enum { FORESTS = sizeof forests / sizeof *forests };

/* What is built, again and again, for the points that share its time. */
typedef struct Trial {
  const StyEngine *engine;
  StyEngineOptions parameters;
  StyLutSpec spec;
  bool panels[STY_PANELS];
  bool left_out;
  double *times, spent; /* milliseconds */
  int runs;
  int first_point, point_count;
} Trial;

typedef struct Survey {
  const StySites *sites;
  const StyImage *guide;
  const StyChartOptions *options;
  const StyEngine *fastest; /* of the exact ones */
  size_t distinct;          /* values; 0: not counted yet */
  Trial *trials;
  int trial_count;
  /* Tables of the same pixels have the same error: the last one's. */
  StyLut *last;
  StyFigures figures;
  StyChart chart;
} Survey;

double sty_find_median(double *values, int count) {
  for (int i = 1; i < count; i++)
    for (int k = i; k > 0 && values[k] < values[k - 1]; k--) {
      const double value = values[k];
      values[k] = values[k - 1];
      values[k - 1] = value;
    }
  return values[(count - 1) / 2];
}

const char *sty_format_parameters(const StyEngine *engine, const StyEngineOptions *parameters,
                                  char text[STY_PARAMETERS_SIZE]) {
  *text = 0;
  if (engine->build == sty_build_flann_forest)
    snprintf(text, STY_PARAMETERS_SIZE, "trees=%d checks=%d", parameters->trees, parameters->checks);
  if (engine->build == sty_build_flann_auto) snprintf(text, STY_PARAMETERS_SIZE, "precision=%g", parameters->precision);
  return text;
}

/* ---- what to build -------------------------------------------------------------- */

static Trial *add_trial(Survey *s, const StyEngine *engine, StyLutSpec spec) {
  Trial *trial = &s->trials[s->trial_count++];
  *trial = (Trial){.engine = engine, .parameters = sty_default_engine_options, .spec = spec};
  return trial;
}

static void plan_engine(Survey *s, const StyEngine *engine, int size) {
  const StyLutSpec spec = {.width = size, .height = size};
  const bool forest = engine->build == sty_build_flann_forest;
  for (int k = 0; k < (forest ? FORESTS : 1); k++) {
    Trial *trial = add_trial(s, engine, spec);
    trial->panels[STY_PANEL_TIME] = true;
    if (!forest) continue;
    trial->parameters.trees = forests[k].trees;
    trial->parameters.checks = forests[k].checks;
  }
}

/* The table that both panels show is built for both at once. */
static Trial *find_shared_trial(Survey *s, const StyLutSpec *spec) {
  for (int t = s->trial_count; t-- > 0 && s->trials[t].spec.width == spec->width;)
    if (s->trials[t].engine == s->fastest && s->trials[t].spec.map == spec->map &&
        s->trials[t].spec.metric == spec->metric)
      return &s->trials[t];
  return NULL;
}

static void plan_maps(Survey *s, int size) {
  for (int map = 0; map < MAPS; map++)
    for (int metric = 0; metric < METRICS; metric++) {
      const StyLutSpec spec = {size, size, STY_SAMPLE_CENTRE, (StyMap)map, (StyMetric)metric};
      Trial *trial = find_shared_trial(s, &spec);
      if (!trial) trial = add_trial(s, s->fastest, spec);
      trial->panels[STY_PANEL_BYTES] = true;
    }
}

static StyStatus plan_trials(Survey *s, StyError *error) {
  const StyChartOptions *options = s->options;
  const size_t most = (size_t)options->size_count * ((size_t)options->engine_count * FORESTS + MAPS * METRICS);
  s->trials = calloc(most, sizeof *s->trials);
  s->chart.points = calloc(most * ENCODINGS, sizeof *s->chart.points);
  s->chart.omissions = calloc((size_t)options->engine_count, sizeof *s->chart.omissions);
  if (!s->trials || !s->chart.points || !s->chart.omissions)
    return sty_fail_memory(error, "chart", (double)most * ENCODINGS * sizeof *s->chart.points);
  for (int i = 0; i < options->size_count; i++) {
    for (int e = 0; e < options->engine_count; e++) plan_engine(s, options->engines[e], options->sizes[i]);
    plan_maps(s, options->sizes[i]);
  }
  for (int t = 0; t < s->trial_count; t++) {
    s->trials[t].times = calloc((size_t)options->repeats, sizeof *s->trials[t].times);
    if (!s->trials[t].times) return sty_fail_memory(error, "chart", options->repeats * 8.0);
  }
  return STY_OK;
}

/* ---- what is left out ------------------------------------------------------------- */

/* The engine from this trial's size on. */
static void leave_out(Survey *s, const Trial *from, const char *reason) {
  StyChartOmission *omission = &s->chart.omissions[s->chart.omission_count++];
  *omission = (StyChartOmission){.engine = from->engine, .size = from->spec.width};
  snprintf(omission->reason, sizeof omission->reason, "%s", reason);
  for (int t = 0; t < s->trial_count; t++)
    if (s->trials[t].engine == from->engine && s->trials[t].spec.width >= from->spec.width)
      s->trials[t].left_out = true;
}

static StyStatus count_distinct(Survey *s, const StyLutSpec *spec, StyError *error) {
  StyPoints points;
  if (s->distinct) return STY_OK;
  const StyStatus status = sty_collapse_sites(s->sites, spec, &points, error);
  if (status) return status;
  s->distinct = points.count;
  sty_free_points(&points);
  return STY_OK;
}

static StyStatus spare_brute_work(Survey *s, const Trial *trial, StyError *error) {
  const StyStatus status = count_distinct(s, &trial->spec, error);
  if (status) return status;
  const size_t texels = sty_count_texels(&trial->spec);
  if ((double)s->distinct * (double)texels <= most_brute_work) return STY_OK;
  char reason[128];
  snprintf(reason, sizeof reason, "%zu distinct values for each of %zu texels would take it seconds", s->distinct,
           texels);
  leave_out(s, trial, reason);
  return STY_OK;
}

/* ---- measuring -------------------------------------------------------------------- */

static StyStatus audit_table(Survey *s, StyLut **lut, StyFigures *out, StyError *error) {
  const size_t bytes = sty_count_texels(&(*lut)->spec) * sizeof *(*lut)->pixels;
  const StyLutSpec *spec = &(*lut)->spec, *known = s->last ? &s->last->spec : NULL;
  StyStatus status = STY_OK;
  if (!known || known->width != spec->width || known->map != spec->map ||
      memcmp(s->last->pixels, (*lut)->pixels, bytes) != 0)
    status = sty_audit_lookup(*lut, s->guide, s->options->audit, &s->figures, error);
  if (status) return status;
  sty_destroy_lut(&s->last);
  s->last = *lut;
  *lut = NULL;
  *out = s->figures;
  return STY_OK;
}

static StyStatus add_point(Survey *s, const Trial *trial, const StyLut *lut, StyEncoding encoding, StyError *error) {
  StyChartPoint *point = &s->chart.points[s->chart.count];
  StyLut *stored = NULL;
  *point = (StyChartPoint){.engine = trial->engine,
                           .parameters = trial->parameters,
                           .spec = trial->spec,
                           .encoding = encoding,
                           .bytes = sty_count_bytes(&trial->spec, encoding)};
  for (int p = 0; p < STY_PANELS; p++)
    if (trial->panels[p] && (p == STY_PANEL_BYTES || encoding == STY_ENCODE_F32)) point->places[p] = STY_PLACE_BEHIND;
  StyStatus status = sty_restore_lut(lut, encoding, &stored, error);
  if (!status) status = audit_table(s, &stored, &point->lookup, error);
  sty_destroy_lut(&stored);
  s->chart.count += !status;
  return status;
}

static StyStatus add_points(Survey *s, Trial *trial, const StyLut *lut, StyError *error) {
  const int encodings = trial->panels[STY_PANEL_BYTES] ? ENCODINGS : 1;
  StyStatus status = STY_OK;
  trial->first_point = s->chart.count;
  for (int e = 0; !status && e < encodings; e++) status = add_point(s, trial, lut, (StyEncoding)e, error);
  trial->point_count = s->chart.count - trial->first_point;
  return status;
}

static StyStatus run_trial(Survey *s, Trial *trial, int threads, StyError *error) {
  const StyRun quiet = {.threads = threads};
  StyLut *lut = NULL;
  StyError own = {STY_OK, ""};
  const double start = sty_get_milliseconds();
  StyStatus status = sty_build_lut(s->sites, trial->engine, &trial->parameters, &trial->spec, &quiet, &lut, &own);
  const double time = sty_get_milliseconds() - start;
  if ((status == STY_ERROR_INPUT || status == STY_ERROR_UNAVAILABLE) && !trial->panels[STY_PANEL_BYTES]) {
    leave_out(s, trial, own.text);
    return STY_OK;
  }
  if (status) return sty_fail(error, status, "%s", own.text);
  trial->times[trial->runs++] = time;
  trial->spent += time;
  if (trial->runs == 1) status = add_points(s, trial, lut, error);
  sty_destroy_lut(&lut);
  return status;
}

/* All trials, one after the other, and all of them again. */
static StyStatus run_trials(Survey *s, const StyRun *run, StyError *error) {
  const int repeats = s->options->repeats;
  StyStatus status = STY_OK;
  for (int round = 0; round < repeats; round++)
    for (int t = 0; t < s->trial_count; t++) {
      Trial *trial = &s->trials[t];
      if (round == 0 && !trial->left_out && trial->engine->build == sty_build_brute)
        status = spare_brute_work(s, trial, error);
      if (!status && !trial->left_out && trial->spent < patience) status = run_trial(s, trial, run->threads, error);
      if (status) return status;
      if (run->progress)
        run->progress(run->context, (double)(round * s->trial_count + t + 1) / ((double)repeats * s->trial_count));
    }
  return STY_OK;
}

/* ---- points ----------------------------------------------------------------------- */

static double get_cost(const StyChartPoint *point, StyChartPanel panel) {
  return panel == STY_PANEL_TIME ? point->milliseconds : (double)point->bytes;
}

static bool beats(const StyChartPoint *a, const StyChartPoint *b, StyChartPanel panel) {
  const double error_a = round(a->lookup.p99 * 1e6), error_b = round(b->lookup.p99 * 1e6);
  const double cost_a = get_cost(a, panel), cost_b = get_cost(b, panel);
  return error_a <= error_b && cost_a <= cost_b && (error_a < error_b || cost_a < cost_b);
}

void sty_mark_front(StyChartPoint *points, int count, StyChartPanel panel) {
  for (int i = 0; i < count; i++) {
    if (points[i].places[panel] == STY_PLACE_NONE) continue;
    points[i].places[panel] = STY_PLACE_FRONT;
    for (int k = 0; k < count; k++)
      if (points[k].places[panel] != STY_PLACE_NONE && beats(&points[k], &points[i], panel))
        points[i].places[panel] = STY_PLACE_BEHIND;
  }
}

static int compare_points(const void *a, const void *b) {
  const StyChartPoint *x = a, *y = b;
  const int pairs[][2] = {{(int)(x->engine - sty_engines), (int)(y->engine - sty_engines)},
                          {x->parameters.trees, y->parameters.trees},
                          {x->parameters.checks, y->parameters.checks},
                          {(int)x->spec.map, (int)y->spec.map},
                          {(int)x->spec.metric, (int)y->spec.metric},
                          {(int)x->encoding, (int)y->encoding},
                          {x->spec.width, y->spec.width}};
  for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++)
    if (pairs[k][0] != pairs[k][1]) return pairs[k][0] - pairs[k][1];
  return 0;
}

static void set_times(Survey *s) {
  for (int t = 0; t < s->trial_count; t++) {
    Trial *trial = &s->trials[t];
    if (!trial->runs) continue;
    const double median = round(sty_find_median(trial->times, trial->runs) * 1e3) / 1e3;
    for (int p = trial->first_point; p < trial->first_point + trial->point_count; p++) {
      s->chart.points[p].milliseconds = median;
      s->chart.points[p].runs = trial->runs;
    }
  }
}

static StyStatus check_engines_left(const Survey *s, StyError *error) {
  for (int p = 0; p < s->chart.count; p++)
    if (s->chart.points[p].places[STY_PANEL_TIME] != STY_PLACE_NONE) return STY_OK;
  const StyChartOmission *first = &s->chart.omissions[0];
  return sty_fail(error, STY_ERROR_INPUT, "found no engine that can be run, expected one: %s is left out: %s",
                  first->engine->name, first->reason);
}

StyStatus sty_measure_chart(const StySites *sites, const StyImage *guide, const StyChartOptions *options,
                            const StyRun *run, StyChart *out, StyError *error) {
  const StyRun all_cores = {.threads = 0};
  Survey survey = {.sites = sites, .guide = guide, .options = options};
  StyStatus status = sty_find_engine("engine", "auto", &survey.fastest, error);
  if (!status) status = plan_trials(&survey, error);
  if (!status) status = run_trials(&survey, run ? run : &all_cores, error);
  if (!status) status = check_engines_left(&survey, error);
  if (!status) {
    set_times(&survey);
    for (int panel = 0; panel < STY_PANELS; panel++)
      sty_mark_front(survey.chart.points, survey.chart.count, (StyChartPanel)panel);
    qsort(survey.chart.points, (size_t)survey.chart.count, sizeof *survey.chart.points, compare_points);
    *out = survey.chart;
  }
  for (int t = 0; t < survey.trial_count; t++) free(survey.trials[t].times);
  free(survey.trials);
  sty_destroy_lut(&survey.last);
  if (status) sty_free_chart(&survey.chart);
  return status;
}

void sty_free_chart(StyChart *chart) {
  free(chart->points);
  free(chart->omissions);
  *chart = (StyChart){0};
}
