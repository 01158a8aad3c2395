#include <stdlib.h>

#include "audit/luma.h"

typedef struct Job {
  const float *in;
  int width, height;
  const Filter *filter;
  float *out;
} Job;

static int clamp(int i, int count) { return i < 0 ? 0 : i < count ? i : count - 1; }

/* A row's columns under the filter's list for down. */
static void filter_down(const Job *job, int y, double *columns) {
  const int radius = job->filter->radius;
  for (int x = 0; x < job->width; x++) columns[x] = 0;
  for (int k = -radius; k <= radius; k++) {
    const float *row = job->in + (size_t)clamp(y + k, job->height) * (size_t)job->width;
    const double weight = job->filter->down[k + radius];
    for (int x = 0; x < job->width; x++) columns[x] += weight * (double)row[x];
  }
}

static StyStatus filter_row(void *context, long y, StyError *error) {
  const Job *job = context;
  const int radius = job->filter->radius;
  double *columns = malloc((size_t)job->width * sizeof *columns);
  if (!columns) return sty_fail_memory(error, "measures", (double)job->width * sizeof *columns);
  filter_down(job, (int)y, columns);
  float *out = job->out + (size_t)y * (size_t)job->width;
  for (int x = 0; x < job->width; x++) {
    double sum = 0;
    for (int k = -radius; k <= radius; k++) sum += job->filter->across[k + radius] * columns[clamp(x + k, job->width)];
    out[x] = (float)sum;
  }
  free(columns);
  return STY_OK;
}

StyStatus sty_filter_plane(const float *in, int width, int height, const Filter *filter, const StyRun *run, float *out,
                           StyError *error) {
  return sty_parallel_for(run, height, filter_row, &(Job){in, width, height, filter, out}, error);
}
