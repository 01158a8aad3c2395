#include "stylut/probe.h"

#include <math.h>
#include <stdlib.h>

#include "audit/ambiguity.h"
#include "audit/figures.h"
#include "lut/engine.h"

/* ---- neighbours --------------------------------------------------------------- */

/* The site of a source pixel, or sites->count where it isn't covered. */
static size_t find_site(const StySites *sites, uint32_t pixel) {
  size_t low = 0, high = sites->count;
  while (low < high) {
    const size_t middle = (low + high) / 2;
    if (sites->pixels[middle] < pixel)
      low = middle + 1;
    else
      high = middle;
  }
  return low < sites->count && sites->pixels[low] == pixel ? low : sites->count;
}

/* A pixel as an answer to g, at a distance that was measured. */
static StyNeighbour describe_pixel(const StySites *sites, uint32_t pixel, const float g[2], double distance) {
  const size_t site = find_site(sites, pixel);
  StyNeighbour out = {.pixel = {(int)(pixel % (uint32_t)sites->width), (int)(pixel / (uint32_t)sites->width)},
                      .covered = site < sites->count};
  if (!out.covered) return out;
  out.value[0] = sites->values[2 * site];
  out.value[1] = sites->values[2 * site + 1];
  out.distance = distance;
  out.degrees = sty_measure_angle(g, out.value);
  return out;
}

/* ---- asking one question ------------------------------------------------------ */

/* A question to all source pixels. */
typedef struct Question {
  const float *value;
  StyQuery query;
  StyPoints points;
  size_t nearest; /* point */
} Question;

/* In float, as tables keep it: equally near pixels must not seem to differ. */
static double get_distance(const StyPoints *points, double squared) {
  return (double)(float)(sqrt(squared) * points->measure.unit);
}

static StyNeighbour describe_point(const StySites *sites, const Question *question, size_t point) {
  const double squared = sty_measure_point(&question->points, point, &question->query);
  return describe_pixel(sites, question->points.pixels[point], question->value,
                        get_distance(&question->points, squared));
}

/* The squared distance of one site by the question's own measure. */
static StyStatus measure_site(const StySites *sites, size_t site, const StyLutSpec *spec, const Question *question,
                              double *squared, StyError *error) {
  StySites one = *sites;
  one.count = 1;
  one.values += 2 * site;
  one.pixels += site;
  if (one.levels) one.levels += 2 * site;
  StyPoints point;
  const StyStatus status = sty_collapse_sites(&one, spec, &point, error);
  if (status) return status;
  *squared = sty_measure_point(&point, 0, &question->query);
  sty_free_points(&point);
  return STY_OK;
}

/* What the table stores as an answer to the question, and whether nothing is nearer. */
static StyStatus judge_pixel(const StySites *sites, uint32_t pixel, const StyLutSpec *spec, const Question *question,
                             StyNeighbour *out, bool *nearest, StyError *error) {
  const size_t site = find_site(sites, pixel);
  double squared = INFINITY;
  if (site < sites->count) {
    const StyStatus status = measure_site(sites, site, spec, question, &squared, error);
    if (status) return status;
  }
  *nearest = squared <= sty_measure_point(&question->points, question->nearest, &question->query);
  *out = describe_pixel(sites, pixel, question->value, get_distance(&question->points, squared));
  return STY_OK;
}

/* ---- the texel's own value ---------------------------------------------------- */

static StyStatus ask_texel(const StyLut *lut, const StySites *sites, uint32_t pixel, StyProbe *out, StyError *error) {
  Question question = {.value = out->own};
  StyStatus status = sty_collapse_sites(sites, &lut->spec, &question.points, error);
  if (status) return status;
  sty_make_query(&question.points.measure, lut, out->texel[0], out->texel[1], &question.query);
  question.nearest = sty_scan_points(&question.points, &question.query);
  out->best_at_texel = describe_point(sites, &question, question.nearest);
  status = judge_pixel(sites, pixel, &lut->spec, &question, &out->stored_at_texel, &out->nearest_at_texel, error);
  sty_free_points(&question.points);
  return status;
}

/* ---- the value asked ---------------------------------------------------------- */

/* The nearest of all points but one; the lowest of equally near ones. */
static size_t find_runner_up(const Question *question) {
  size_t second = question->points.count;
  double least = INFINITY;
  for (size_t p = 0; p < question->points.count; p++) {
    const double squared = sty_measure_point(&question->points, p, &question->query);
    if (p == question->nearest || squared >= least) continue;
    least = squared;
    second = p;
  }
  return second;
}

static StyStatus measure_ambiguity(const StySites *sites, const Question *question, StyProbe *out, StyError *error) {
  StyNear near;
  StyAmbiguity choice;
  StyStatus status = sty_open_near(sites, question->points.measure.dims, out->precision, &near, error);
  if (status) return status;
  status = sty_measure_choice(&near, question->query.at, out->best.distance, out->precision, &choice, error);
  sty_close_near(&near);
  if (status) return status;
  out->choice = choice.pixels;
  out->pieces = choice.pieces;
  out->spread = choice.spread;
  out->ambiguous = choice.pieces >= 2 || choice.spread > out->jump;
  return STY_OK;
}

static StyStatus ask_value(const StyLut *lut, const StySites *sites, uint32_t pixel, StyProbe *out, StyError *error) {
  /* As sty_ask_engine does: nothing but texels' places can be measured in integers. */
  const StyLutSpec spec = {1, 1, STY_SAMPLE_CENTRE, STY_MAP_XY, lut->spec.metric};
  StySites values = *sites;
  values.levels = NULL;
  Question question = {.value = out->value};
  StyStatus status = sty_collapse_sites(&values, &spec, &question.points, error);
  if (status) return status;
  sty_lift(question.points.measure.dims, out->value, question.query.at);
  question.nearest = sty_scan_points(&question.points, &question.query);
  out->best = describe_point(sites, &question, question.nearest);
  const size_t second = find_runner_up(&question);
  out->has_runner_up = second < question.points.count;
  if (out->has_runner_up) out->runner_up = describe_point(sites, &question, second);
  status = judge_pixel(&values, pixel, &spec, &question, &out->stored, &out->nearest, error);
  if (!status) status = measure_ambiguity(sites, &question, out, error);
  sty_free_points(&question.points);
  return status;
}

/* ---- the whole ---------------------------------------------------------------- */

/* By the metric, in guide units. */
static double measure_values(StyMetric metric, const float a[2], const float b[2]) {
  const int dims = metric == STY_METRIC_ANGLE ? 3 : 2;
  float p[3], q[3];
  sty_lift(dims, a, p);
  sty_lift(dims, b, q);
  return (double)(float)sqrt((double)sty_square_distance(dims, p, q));
}

static void find_texel(const StyLut *lut, const float value[2], StyProbe *out) {
  for (int k = 0; k < 2; k++) out->value[k] = value[k] + 0.0f;
  out->inside = out->value[0] * out->value[0] + out->value[1] * out->value[1] <= 1;
  sty_find_texel(&lut->spec, out->value, out->texel);
  sty_get_texel_value(&lut->spec, out->texel[0], out->texel[1], out->own);
  out->distance = measure_values(lut->spec.metric, out->value, out->own);
  out->degrees = sty_measure_angle(out->value, out->own);
}

StyStatus sty_probe_lut(const StyLut *lut, const StyImage *guide, const StySites *sites, const float value[2],
                        const StyProbeOptions *options, StyProbe *out, StyError *error) {
  if (lut->source_width != guide->width || lut->source_height != guide->height)
    return sty_fail(error, STY_ERROR_INPUT,
                    "found a LUT for a source of %dx%d pixels, expected one for the guide's %dx%d", lut->source_width,
                    lut->source_height, guide->width, guide->height);
  StyProbe probe = {.precision = options->precision > 0 ? options->precision : sty_get_precision(guide),
                    .jump = options->jump > 0 ? options->jump : sty_get_jump(&lut->spec, guide->width, guide->height)};
  find_texel(lut, value, &probe);
  const uint32_t pixel = lut->pixels[(size_t)probe.texel[1] * (size_t)lut->spec.width + (size_t)probe.texel[0]];
  StyStatus status = ask_texel(lut, sites, pixel, &probe, error);
  if (!status) status = ask_value(lut, sites, pixel, &probe, error);
  if (!status) *out = probe;
  return status;
}

StyStatus sty_probe_engine(const StySites *sites, const StyEngine *engine, StyMetric metric, const float value[2],
                           const StyRun *run, StyNeighbour *out, StyError *error) {
  uint32_t pixel = 0;
  float distance = 0;
  const StyStatus status = sty_ask_engine(sites, engine, NULL, metric, value, run, &pixel, &distance, error);
  if (!status) *out = describe_pixel(sites, pixel, value, (double)distance);
  return status;
}
