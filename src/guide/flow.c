#include "stylut/flow.h"

#include <math.h>
#include <stdio.h>

#include "guide/flow_audit.h"
#include "guide/flow_search.h"

const StyFlowOptions sty_default_flow_options = {.threshold = 16, .tolerance = 0.5};

enum { ROWS = 8 }; /* of one piece of work */

/* ---- levels --------------------------------------------------------------------- */

typedef struct Work {
  const StyFlowLevel *level, *coarser;
  const StyFlowRules *rules;
  void (*do_row)(const struct Work *work, int y);
} Work;

static void search_row(const Work *work, int y) { sty_search_flow_row(work->level, work->coarser, work->rules, y); }
static void smooth_row(const Work *work, int y) { sty_smooth_flow_row(work->level, y); }

static StyStatus do_rows(void *context, long piece, StyError *error) {
  (void)error;
  const Work *work = context;
  const int begin = (int)piece * ROWS, height = work->level->pictures[0].height;
  for (int y = begin; y < begin + ROWS && y < height; y++) work->do_row(work, y);
  return STY_OK;
}

static StyStatus run_rows(Work *work, const StyRun *run, StyError *error) {
  return sty_parallel_for(run, (work->level->pictures[0].height + ROWS - 1) / ROWS, do_rows, work, error);
}

static StyStatus estimate_level(StyFlowPyramid *pyramid, int index, const StyFlowRules *rules, const StyRun *run,
                                StyError *error) {
  StyFlowLevel *level = &pyramid->levels[index];
  const StyFlowLevel *coarser = index + 1 < pyramid->count ? level + 1 : NULL;
  Work work = {level, coarser, rules, search_row};
  StyStatus status = run_rows(&work, run, error);
  if (status || rules->method == STY_FLOW_PUBLISHED) return status;
  const StyRun quiet = {.threads = sty_get_threads(run)};
  work.do_row = smooth_row;
  status = run_rows(&work, &quiet, error);
  StyFlowVector *smooth = level->spare;
  level->spare = level->vectors;
  level->vectors = smooth;
  return status;
}

/* From the coarsest level to the picture itself; that one is three quarters of the work. */
static StyStatus estimate_levels(StyFlowPyramid *pyramid, const StyFlowRules *rules, const StyRun *run, double begin,
                                 double share, StyError *error) {
  StyStatus status = STY_OK;
  double done = 0;
  for (int l = pyramid->count - 1; !status && l >= 0; l--) {
    const double part = l ? 0.75 * pow(0.25, l) : 1 - done;
    StyShare level = {run, begin + share * done, share * part};
    const StyRun own = sty_share_run(&level);
    status = estimate_level(pyramid, l, rules, &own, error);
    done += part;
  }
  return status;
}

/* ---- the whole ------------------------------------------------------------------ */

static StyStatus check_options(const StyFlowOptions *o, StyError *error) {
  if (o->levels < 0 || o->levels > STY_FLOW_MOST_LEVELS)
    return sty_fail(error, STY_ERROR_USAGE, "levels: found %d, expected 1 to %d, or 0 for all", o->levels,
                    STY_FLOW_MOST_LEVELS);
  if (o->radius < 0 || o->radius > STY_FLOW_MOST_RADIUS)
    return sty_fail(error, STY_ERROR_USAGE, "radius: found %d, expected 1 to %d, or 0 for the method's own", o->radius,
                    STY_FLOW_MOST_RADIUS);
  if (!(o->threshold >= 0) || !(o->tolerance >= 0) || !isfinite(o->threshold) || !isfinite(o->tolerance))
    return sty_fail(error, STY_ERROR_USAGE, "threshold %g and tolerance %g: expected numbers from 0", o->threshold,
                    o->tolerance);
  return STY_OK;
}

static StyFlowRules make_rules(const StyFlowOptions *options, int lanes) {
  const int radius = options->radius ? options->radius : options->method == STY_FLOW_PUBLISHED ? 1 : 2;
  const int side = 2 * radius + 1;
  return (StyFlowRules){.method = options->method,
                        .radius = radius,
                        .lanes = lanes,
                        .scale = 255.0f / (float)(side * side * lanes),
                        .threshold = (float)options->threshold,
                        .tolerance = (float)options->tolerance};
}

/* What an estimate is made of, one way or back. */
typedef struct Plan {
  const char *names[2];
  const StyImage *images[2];
  const float *planes[2][STY_FLOW_MOST_CHANNELS];
  int level_count;
  StyFlowRules rules;
} Plan;

static StyStatus make_plan(const char *const names[2], const StyImage *frame, const StyImage *previous,
                           const StyFlowOptions *options, Plan *out, StyFlowFigures *figures, StyError *error) {
  *out = (Plan){.names = {names[0], names[1]}, .images = {frame, previous}};
  int lanes = 0;
  StyStatus status = check_options(options, error);
  if (!status && (frame->width != previous->width || frame->height != previous->height))
    status = sty_fail(error, STY_ERROR_INPUT, "%s: found %dx%d pixels, and %s has %dx%d, expected one size", names[0],
                      frame->width, frame->height, names[1], previous->width, previous->height);
  if (!status)
    status =
        sty_choose_flow_channels(names, out->images, options->channels, out->planes, &lanes, figures->channels, error);
  if (status) return status;
  out->rules = make_rules(options, lanes);
  out->level_count = sty_count_flow_levels(frame->width, frame->height, options->levels);
  figures->levels = out->level_count;
  figures->radius = out->rules.radius;
  return STY_OK;
}

StyStatus sty_plan_flow(const char *const names[2], const StyImage *frame, const StyImage *previous,
                        const StyFlowOptions *options, StyFlowFigures *figures, StyError *error) {
  StyFlowFigures planned = {0};
  Plan plan;
  const StyStatus status = make_plan(names, frame, previous, options, &plan, &planned, error);
  if (!status) *figures = planned;
  return status;
}

static StyStatus follow_plan(Plan *plan, const StyRun *run, double begin, double share, StyFlowPyramid *out,
                             StyError *error) {
  const StyStatus status = sty_build_flow_pyramid(plan->names, plan->images, plan->planes, plan->rules.lanes,
                                                  plan->level_count, plan->rules.radius + STY_FLOW_MARGIN,
                                                  plan->rules.method == STY_FLOW_COARSE_TO_FINE, out, error);
  return status ? status : estimate_levels(out, &plan->rules, run, begin, share, error);
}

/* The same with the pictures' parts swapped. */
static StyStatus estimate_back(const Plan *plan, const StyRun *run, const StyFlowPyramid *forward, StyImage *flow,
                               StyFlowFigures *figures, StyError *error) {
  Plan swapped = *plan;
  StyFlowPyramid back = {0};
  for (int i = 0; i < 2; i++) {
    swapped.names[i] = plan->names[1 - i];
    swapped.images[i] = plan->images[1 - i];
    for (int c = 0; c < STY_FLOW_MOST_CHANNELS; c++) swapped.planes[i][c] = plan->planes[1 - i][c];
  }
  const StyStatus status = follow_plan(&swapped, run, 0.5, 0.5, &back, error);
  if (!status) sty_compare_flow_back(&forward->levels[0], &back.levels[0], flow, figures);
  sty_close_flow_pyramid(&back);
  return status;
}

static StyStatus create_flow(const StyImage *frame, bool consistency, StyImage **out, StyError *error) {
  static const char *const names[] = {"A", "motion.U", "motion.V", "residual.Y", "origin.I", "consistency.Y"};
  return sty_create_image(frame->width, frame->height, consistency ? 6 : 5, names, 32, out, error);
}

StyStatus sty_estimate_flow(const char *const names[2], const StyImage *frame, const StyImage *previous,
                            const StyFlowOptions *options, const StyRun *run, StyFlowFigures *figures, StyImage **out,
                            StyError *error) {
  StyFlowPyramid pyramid = {0};
  StyFlowFigures found = {0};
  StyImage *flow = NULL;
  Plan plan;
  StyStatus status = make_plan(names, frame, previous, options, &plan, &found, error);
  if (!status) status = follow_plan(&plan, run, 0, options->consistency ? 0.5 : 1, &pyramid, error);
  if (!status) status = create_flow(frame, options->consistency, &flow, error);
  if (!status) status = sty_audit_flow(&pyramid.levels[0], &plan.rules, run, flow, &found, error);
  if (!status && options->consistency) status = estimate_back(&plan, run, &pyramid, flow, &found, error);
  sty_close_flow_pyramid(&pyramid);
  if (status) {
    sty_destroy_image(&flow);
    return status;
  }
  if (figures) *figures = found;
  *out = flow;
  return STY_OK;
}
