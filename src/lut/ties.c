/* The tie rule over a library's index. Libraries return any of several equally
 * near points (40 % of FLANN's ties differ from a linear scan's), and compare
 * them in arithmetic of their own. So each query asks for a handful, and the
 * rule picks among those at the minimum. Where the whole handful is equally
 * near, it asks for more, then for all within that distance; where even those
 * are too many (the centre of a circle), all points are scanned. */
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "lut/engine.h"

enum { HANDFUL = 2, DOZEN = 16, CROWD = 4096 };

/* A library may have missed a point by rounding when that is nearer than the
 * last one found by less than this: relative to the distance, and in guide
 * units, since 8-bit levels are rounded to float. */
static const double rounding_share = 1e-5, rounding_step = 5e-7;

typedef struct Job {
  const char *name;
  const StySearch *search;
  StyLut *lut;
} Job;

typedef struct Answer {
  size_t point;
  double squared;
  bool settled; /* no point that the library may have missed can be as near */
} Answer;

static Answer choose_point(const StyPoints *points, const int *found, int count, const StyQuery *query) {
  Answer answer = {(size_t)found[0], sty_measure_point(points, (size_t)found[0], query), false};
  double farthest = answer.squared;
  for (int k = 1; k < count; k++) {
    const size_t point = (size_t)found[k];
    const double squared = sty_measure_point(points, point, query);
    if (squared < answer.squared || (squared == answer.squared && point < answer.point)) {
      answer.squared = squared;
      answer.point = point;
    }
    if (squared > farthest) farthest = squared;
  }
  const double unit = points->measure.unit;
  answer.settled = (size_t)count == points->count ||
                   sqrt(farthest) * unit > sqrt(answer.squared) * unit * (1 + rounding_share) + rounding_step;
  return answer;
}

/* All that may be as near as the answer so far. */
static StyStatus search_crowd(const Job *job, const StyQuery *query, int *crowd, Answer *answer, StyError *error) {
  const StyPoints *points = job->search->points;
  const double radius = sqrt(answer->squared) * points->measure.unit * (1 + rounding_share) + rounding_step;
  const float squared = (float)(radius * radius * (1 + rounding_share)) + FLT_MIN;
  const int count = job->search->find_within(job->search, query->at, squared, CROWD, crowd);
  if (count < 0) return sty_fail(error, STY_ERROR_LIBRARY, "engine %s: the library's search failed", job->name);
  if (count > 0 && count < CROWD) {
    *answer = choose_point(points, crowd, count, query);
    return STY_OK;
  }
  answer->point = sty_scan_points(points, query);
  answer->squared = sty_measure_point(points, answer->point, query);
  return STY_OK;
}

static StyStatus search_texel(const Job *job, const StyQuery *query, int *crowd, Answer *answer, StyError *error) {
  const StyPoints *points = job->search->points;
  static const int handfuls[] = {HANDFUL, DOZEN};
  for (size_t h = 0; h < sizeof handfuls / sizeof *handfuls; h++) {
    int found[DOZEN];
    const int count = points->count < (size_t)handfuls[h] ? (int)points->count : handfuls[h];
    if (!job->search->find_nearest(job->search, query->at, count, found))
      return sty_fail(error, STY_ERROR_LIBRARY, "engine %s: the library's search failed", job->name);
    *answer = choose_point(points, found, count, query);
    if (answer->settled) return STY_OK;
  }
  return search_crowd(job, query, crowd, answer, error);
}

static StyStatus search_row(void *context, long j, StyError *error) {
  const Job *job = context;
  const StyMeasure *measure = &job->search->points->measure;
  const int width = job->lut->spec.width;
  int *crowd = malloc(CROWD * sizeof *crowd);
  if (!crowd) return sty_fail_memory(error, job->name, CROWD * sizeof *crowd);
  StyStatus status = STY_OK;
  for (int i = 0; !status && i < width; i++) {
    StyQuery query;
    Answer answer = {0};
    sty_make_query(measure, job->lut, i, (int)j, &query);
    status = search_texel(job, &query, crowd, &answer, error);
    if (!status)
      sty_set_texel(job->lut, measure, (size_t)j * (size_t)width + (size_t)i, job->search->points->pixels[answer.point],
                    answer.squared);
  }
  free(crowd);
  return status;
}

StyStatus sty_search_table(const char *name, const StySearch *search, StyLut *lut, const StyRun *run, StyError *error) {
  Job job = {name, search, lut};
  return sty_parallel_for(run, lut->spec.height, search_row, &job, error);
}
