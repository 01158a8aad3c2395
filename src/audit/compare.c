#include "stylut/compare.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- what can be compared ----------------------------------------------------- */

/* A channel of `a` that `b` hasn't, or NULL. */
static const char *find_lone_channel(const StyImage *a, const StyImage *b) {
  for (int c = 0; c < a->channel_count; c++)
    if (!sty_find_channel(b, a->names[c])) return a->names[c];
  return NULL;
}

static StyStatus check_pair(const char *name_a, const StyImage *a, const char *name_b, const StyImage *b,
                            StyError *error) {
  if (a->width != b->width || a->height != b->height)
    return sty_fail(error, STY_FILES_DIFFER, "%s and %s: found %dx%d and %dx%d pixels, expected the same size", name_a,
                    name_b, a->width, a->height, b->width, b->height);
  const char *only_a = find_lone_channel(a, b), *only_b = find_lone_channel(b, a);
  if (!only_a && !only_b) return STY_OK;
  return sty_fail(error, STY_FILES_DIFFER, "%s and %s: found channel %s in the %s only, expected the same channels",
                  name_a, name_b, only_a ? only_a : only_b, only_a ? "first" : "second");
}

/* ---- differences -------------------------------------------------------------- */

/* What was found in one row. */
typedef struct Row {
  size_t differing, failing, hard_failing, infinite;
  double sum, squares, finite_max;
  double max;
  int channel, x;
} Row;

typedef struct Job {
  const StyImage *a;
  const float *planes_a[STY_MAX_CHANNELS], *planes_b[STY_MAX_CHANNELS];
  bool integers;
  const StyCompareOptions *options;
  Row *rows;
  float *largest;
} Job;

static double get_difference(const Job *job, float a, float b) {
  if (a == b || (isnan(a) && isnan(b))) return 0;
  const double difference = fabs((double)a - (double)b);
  if (isnan(difference)) return INFINITY;
  return job->integers ? round(difference * 65535) / 65535 : difference;
}

/* Adds one value's difference to its row. */
static void add_difference(Row *row, double difference, int channel, int x) {
  if (isinf(difference)) {
    row->infinite++;
  } else {
    row->sum += difference;
    row->squares += difference * difference;
    row->finite_max = fmax(row->finite_max, difference);
  }
  if (difference <= row->max) return;
  row->max = difference;
  row->channel = channel;
  row->x = x;
}

static StyStatus compare_row(void *context, long y, StyError *error) {
  (void)error;
  const Job *job = context;
  Row row = {0};
  const size_t begin = (size_t)y * (size_t)job->a->width;
  for (int x = 0; x < job->a->width; x++) {
    double largest = 0;
    for (int c = 0; c < job->a->channel_count; c++) {
      const size_t at = begin + (size_t)x;
      const double difference = get_difference(job, job->planes_a[c][at], job->planes_b[c][at]);
      if (!(difference > 0)) continue;
      add_difference(&row, difference, c, x);
      largest = fmax(largest, difference);
    }
    row.differing += largest > 0;
    row.failing += largest > job->options->fail;
    row.hard_failing += largest > job->options->hard_fail;
    if (job->largest) job->largest[begin + (size_t)x] = (float)largest;
  }
  job->rows[y] = row;
  return STY_OK;
}

/* Rows are added up in their order, so that the sums don't depend on threads. */
static void add_rows(const Job *job, StyComparison *out) {
  const StyImage *a = job->a;
  StyComparison sum = {.pixels = sty_count_pixels(a), .values = sty_count_pixels(a) * (size_t)a->channel_count};
  for (int y = 0; y < a->height; y++) {
    const Row *row = &job->rows[y];
    sum.differing += row->differing;
    sum.failing += row->failing;
    sum.hard_failing += row->hard_failing;
    sum.infinite += row->infinite;
    sum.mean += row->sum;
    sum.rms += row->squares;
    sum.finite_max = fmax(sum.finite_max, row->finite_max);
    if (row->max <= sum.max) continue;
    sum.max = row->max;
    sum.channel = row->channel;
    sum.x = row->x;
    sum.y = y;
  }
  const double finite = (double)(sum.values - sum.infinite);
  sum.mean = finite > 0 ? sum.mean / finite : 0;
  sum.rms = finite > 0 ? sqrt(sum.rms / finite) : 0;
  const size_t at = (size_t)sum.y * (size_t)a->width + (size_t)sum.x;
  if (sum.max > 0) sum.found[0] = job->planes_a[sum.channel][at], sum.found[1] = job->planes_b[sum.channel][at];
  *out = sum;
}

StyStatus sty_compare_images(const char *name_a, const StyImage *a, const char *name_b, const StyImage *b,
                             const StyCompareOptions *options, const StyRun *run, StyComparison *out, float *largest,
                             StyError *error) {
  StyStatus status = check_pair(name_a, a, name_b, b, error);
  if (status) return status;
  Job job = {.a = a, .integers = a->bits < 32 && b->bits < 32, .options = options, .largest = largest};
  for (int c = 0; c < a->channel_count; c++) {
    job.planes_a[c] = a->data + (size_t)c * sty_count_pixels(a);
    job.planes_b[c] = sty_find_channel(b, a->names[c]);
  }
  job.rows = calloc((size_t)a->height, sizeof *job.rows);
  if (!job.rows) return sty_fail_memory(error, "comparison", (double)a->height * sizeof *job.rows);
  status = sty_parallel_for(run, a->height, compare_row, &job, error);
  if (!status) add_rows(&job, out);
  free(job.rows);
  return status;
}

/* ---- heat map ----------------------------------------------------------------- */

/* Viridis (van der Walt, Smith, 2015, CC0) at each eighth. */
static const uint8_t ramp[][3] = {{68, 1, 84},    {71, 45, 123}, {59, 82, 139},  {44, 114, 142}, {33, 145, 140},
                                  {40, 174, 128}, {94, 201, 98}, {173, 220, 48}, {253, 231, 37}};
enum { RAMP_STEPS = sizeof ramp / sizeof *ramp - 1 };

static void get_heat(double value, double top, float rgb[3]) {
  if (!(value > 0) || isinf(value)) {
    rgb[0] = rgb[1] = rgb[2] = value > 0 ? 1 : 0;
    return;
  }
  const double place = RAMP_STEPS * (value < top ? sqrt(value / top) : 1);
  const int step = place < RAMP_STEPS ? (int)place : RAMP_STEPS - 1;
  for (int k = 0; k < 3; k++)
    rgb[k] = (float)((ramp[step][k] + (place - step) * (ramp[step + 1][k] - ramp[step][k])) / 255);
}

StyStatus sty_paint_heat(const float *values, int width, int height, double top, StyImage **out, StyError *error) {
  static const char *const names[] = {"R", "G", "B"};
  StyImage *image = NULL;
  const StyStatus status = sty_create_image(width, height, 3, names, 8, &image, error);
  if (status) return status;
  const size_t pixels = sty_count_pixels(image);
  for (size_t i = 0; i < pixels; i++) {
    float rgb[3];
    get_heat((double)values[i], top, rgb);
    for (size_t k = 0; k < 3; k++) image->data[k * pixels + i] = rgb[k];
  }
  *out = image;
  return STY_OK;
}
