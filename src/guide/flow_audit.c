#include "guide/flow_audit.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

typedef struct Planes {
  float *covered, *u, *v, *residual, *origin;
} Planes;

/* One row's figures: rows are added up in their order, so that sums don't depend on threads. */
typedef struct Tally {
  size_t covered, matched, inherited, ambiguous, untextured;
  double motion, max_motion, residual;
} Tally;

typedef struct Audit {
  const StyFlowLevel *level;
  const StyFlowRules *rules;
  Planes planes;
  Tally *tallies;
} Audit;

static float clamp(float value, float top) { return value < 0 ? 0 : value > top ? top : value; }

/* Mean difference between the window of (x, y) and that at its motion's end (clamped to the
 * picture), and whether another one a pixel from there fits as well. */
static float measure_fit(const Audit *audit, int x, int y, const StyFlowVector *vector, bool *ambiguous) {
  const StyFlowPicture *previous = &audit->level->pictures[1];
  const int r = audit->rules->radius, side = 2 * r + 3;
  const StyFlowPlace place = sty_find_flow_place(clamp((float)x + vector->u, (float)(previous->width - 1)),
                                                 clamp((float)y + vector->v, (float)(previous->height - 1)));
  StyLanes patch[STY_FLOW_MOST_PATCH];
  sty_sample_flow_window(previous, &place, r + 1, patch);
  const StyLanes *here = patch + side + 1;
  const float mean = sty_compare_flow_window(audit->level, audit->rules, x, y, here, side, FLT_MAX);
  const float limit = mean + audit->rules->tolerance;
  *ambiguous = false;
  for (int k = 0; k < 9 && !*ambiguous; k++) {
    if (k == 4) continue;
    const StyLanes *other = patch + k / 3 * side + k % 3;
    *ambiguous = sty_compare_flow_window(audit->level, audit->rules, x, y, other, side, limit) <= limit;
  }
  return mean;
}

static void audit_pixel(const Audit *audit, int x, int y, size_t p, Tally *tally) {
  const StyFlowVector *vector = &audit->level->vectors[p];
  bool ambiguous;
  const float mean = measure_fit(audit, x, y, vector, &ambiguous);
  const bool untextured = sty_measure_flow_texture(audit->level, audit->rules, x, y) <= audit->rules->tolerance;
  const double length = sqrt((double)vector->u * (double)vector->u + (double)vector->v * (double)vector->v);
  audit->planes.covered[p] = 1;
  audit->planes.u[p] = vector->u;
  audit->planes.v[p] = vector->v;
  audit->planes.residual[p] = mean / 255;
  audit->planes.origin[p] = (float)vector->origin;
  tally->covered++;
  tally->matched += vector->origin == 1;
  tally->inherited += vector->origin > 1;
  tally->untextured += untextured;
  tally->ambiguous += untextured || ambiguous;
  tally->motion += length;
  tally->max_motion = fmax(tally->max_motion, length);
  tally->residual += (double)mean;
}

static StyStatus audit_row(void *context, long y, StyError *error) {
  (void)error;
  const Audit *audit = context;
  const int width = audit->level->pictures[0].width;
  Tally tally = {0};
  for (int x = 0; x < width; x++) {
    const size_t p = (size_t)y * (size_t)width + (size_t)x;
    if (audit->level->covered[p]) audit_pixel(audit, x, (int)y, p, &tally);
  }
  audit->tallies[y] = tally;
  return STY_OK;
}

static void add_tallies(const Tally *tallies, int count, StyFlowFigures *figures) {
  Tally all = {0};
  for (int i = 0; i < count; i++) {
    all.covered += tallies[i].covered;
    all.matched += tallies[i].matched;
    all.inherited += tallies[i].inherited;
    all.ambiguous += tallies[i].ambiguous;
    all.untextured += tallies[i].untextured;
    all.motion += tallies[i].motion;
    all.max_motion = fmax(all.max_motion, tallies[i].max_motion);
    all.residual += tallies[i].residual;
  }
  const double by = all.covered ? 1 / (double)all.covered : 0;
  figures->covered = all.covered;
  figures->matched = all.matched;
  figures->inherited = all.inherited;
  figures->unknown = all.covered - all.matched - all.inherited;
  figures->ambiguous = all.ambiguous;
  figures->untextured = all.untextured;
  figures->mean_motion = all.motion * by;
  figures->max_motion = all.max_motion;
  figures->mean_residual = all.residual * by;
}

StyStatus sty_audit_flow(const StyFlowLevel *level, const StyFlowRules *rules, const StyRun *run, StyImage *flow,
                         StyFlowFigures *figures, StyError *error) {
  const Planes planes = {sty_find_channel(flow, "A"), sty_find_channel(flow, "motion.U"),
                         sty_find_channel(flow, "motion.V"), sty_find_channel(flow, "residual.Y"),
                         sty_find_channel(flow, "origin.I")};
  const Audit audit = {level, rules, planes, calloc((size_t)flow->height, sizeof(Tally))};
  if (!audit.tallies) return sty_fail_memory(error, "flow", (double)flow->height * sizeof(Tally));
  const StyRun quiet = {.threads = sty_get_threads(run)};
  const StyStatus status = sty_parallel_for(&quiet, flow->height, audit_row, (void *)&audit, error);
  if (!status) add_tallies(audit.tallies, flow->height, figures);
  free(audit.tallies);
  return status;
}

/* ---- there and back ------------------------------------------------------------- */

/* The motion at a place, bilinear; false where none of its four pixels knows one. */
static bool sample_motion(const StyFlowLevel *level, float x, float y, float out[2]) {
  const StyFlowPlace place = sty_find_flow_place(x, y);
  const int width = level->pictures[0].width, height = level->pictures[0].height;
  float sum[2] = {0}, weight = 0;
  for (int k = 0; k < 4; k++) {
    const int i = place.x + (k & 1), j = place.y + (k >> 1);
    if (i >= width || j >= height) continue;
    const size_t p = (size_t)j * (size_t)width + (size_t)i;
    const float w = (k & 1 ? place.right : 1 - place.right) * (k >> 1 ? place.down : 1 - place.down);
    if (!level->covered[p]) continue;
    sum[0] += w * level->vectors[p].u;
    sum[1] += w * level->vectors[p].v;
    weight += w;
  }
  if (!(weight > 0)) return false;
  out[0] = sum[0] / weight;
  out[1] = sum[1] / weight;
  return true;
}

void sty_compare_flow_back(const StyFlowLevel *forward, const StyFlowLevel *back, StyImage *flow,
                           StyFlowFigures *figures) {
  float *plane = sty_find_channel(flow, "consistency.Y");
  size_t p = 0;
  double sum = 0;
  for (int y = 0; y < flow->height; y++)
    for (int x = 0; x < flow->width; x++, p++) {
      if (!forward->covered[p]) continue;
      const float u = forward->vectors[p].u, v = forward->vectors[p].v;
      float home[2];
      plane[p] = -1;
      if (!sty_is_inside(&back->pictures[0], (float)x + u, (float)y + v) ||
          !sample_motion(back, (float)x + u, (float)y + v, home))
        continue;
      const double du = (double)(u + home[0]), dv = (double)(v + home[1]), distance = sqrt(du * du + dv * dv);
      plane[p] = (float)distance;
      figures->compared++;
      figures->inconsistent += distance > 1;
      sum += distance;
    }
  figures->mean_inconsistency = figures->compared ? sum / (double)figures->compared : 0;
}
