#include "lut/near.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int get_bucket_part(double value, double low, double inverse, int count) {
  const double part = (value - low) * inverse;
  return part <= 0 ? 0 : part < count ? (int)part : count - 1;
}

static size_t get_bucket(const StyNear *near, const float at[3]) {
  return (size_t)get_bucket_part(at[1], near->y0, near->inverse, near->rows) * (size_t)near->columns +
         (size_t)get_bucket_part(at[0], near->x0, near->inverse, near->columns);
}

/* Value by value, of each ascending: what qsort_r wants. */
static int compare_values(const void *a, const void *b, void *context) {
  const float *values = context;
  const uint32_t s = *(const uint32_t *)a, t = *(const uint32_t *)b;
  for (int k = 0; k < 2; k++) {
    const float x = values[2 * (size_t)s + (size_t)k], y = values[2 * (size_t)t + (size_t)k];
    if (x != y) return x < y ? -1 : 1;
  }
  return (s > t) - (s < t);
}

static bool have_same_value(const StySites *sites, uint32_t s, uint32_t t) {
  const float *a = sites->values + 2 * (size_t)s, *b = sites->values + 2 * (size_t)t;
  return a[0] == b[0] && a[1] == b[1];
}

/* Sites in `order` bucket by bucket, ascending; `first` says where buckets begin. */
static void sort_into_buckets(StyNear *near, size_t buckets) {
  /* Shifted by two, so that `first` ends up as where buckets begin. */
  for (int pass = 0; pass < 2; pass++) {
    for (size_t s = 0; s < near->sites->count; s++) {
      float at[3];
      sty_lift(near->dims, near->sites->values + 2 * s, at);
      const size_t bucket = get_bucket(near, at);
      if (pass == 0)
        near->first[bucket + 2]++;
      else
        near->order[near->first[bucket + 1]++] = (uint32_t)s;
    }
    for (size_t b = 0; pass == 0 && b < buckets; b++) near->first[b + 2] += near->first[b + 1];
  }
}

/* Within each bucket value by value; from here on `first` counts values. */
static void find_runs(StyNear *near, size_t buckets) {
  uint32_t run = 0, begin = 0;
  for (size_t b = 0; b < buckets; b++) {
    const uint32_t end = near->first[b + 1];
    near->first[b] = run;
    for (uint32_t o = begin + 1; o < end; o++)
      if (!have_same_value(near->sites, near->order[o - 1], near->order[o])) {
        qsort_r(near->order + begin, end - begin, sizeof *near->order, compare_values, near->sites->values);
        break;
      }
    for (uint32_t o = begin; o < end; o++)
      if (o == begin || !have_same_value(near->sites, near->order[o - 1], near->order[o])) near->runs[run++] = o;
    begin = end;
  }
  near->first[buckets] = run;
  near->runs[run] = begin;
}

StyStatus sty_open_near(const StySites *sites, int dims, double radius, StyNear *out, StyError *error) {
  StyNear near = {.sites = sites, .dims = dims};
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (size_t s = 0; s < sites->count; s++) {
    float at[3];
    sty_lift(dims, sites->values + 2 * s, at);
    for (int k = 0; k < 2; k++) {
      low[k] = fmin(low[k], (double)at[k]);
      high[k] = fmax(high[k], (double)at[k]);
    }
  }
  /* No more buckets than sites, and none finer than a query is wide. */
  const double width = high[0] - low[0], height = high[1] - low[1];
  const double most = 4 + sqrt((double)sites->count);
  const double side = fmax(fmax(radius, 1e-30), fmax(width, height) / most);
  near.x0 = low[0];
  near.y0 = low[1];
  near.inverse = 1 / side;
  near.columns = (int)(width / side) + 1;
  near.rows = (int)(height / side) + 1;
  const size_t buckets = (size_t)near.columns * (size_t)near.rows;
  near.first = calloc(buckets + 2, sizeof *near.first);
  near.order = malloc(sites->count * sizeof *near.order);
  near.runs = malloc((sites->count + 1) * sizeof *near.runs);
  if (!near.first || !near.order || !near.runs) {
    sty_close_near(&near);
    return sty_fail_memory(error, "neighbouring pixels", (double)buckets * 4 + (double)sites->count * 8);
  }
  sort_into_buckets(&near, buckets);
  find_runs(&near, buckets);
  *out = near;
  return STY_OK;
}

void sty_close_near(StyNear *near) {
  free(near->first);
  free(near->order);
  free(near->runs);
  *near = (StyNear){0};
}

static bool reserve(uint32_t **array, size_t capacity) {
  uint32_t *grown = realloc(*array, capacity * sizeof *grown);
  if (grown) *array = grown;
  return grown;
}

static bool append_run(StyNearList *list, size_t count, uint32_t run) {
  if (count == list->run_capacity) {
    const size_t capacity = count ? 2 * count : 64;
    if (!reserve(&list->found, capacity) || !reserve(&list->runs, capacity)) return false;
    list->run_capacity = capacity;
  }
  list->found[count] = run;
  return true;
}

/* The sites of the list's runs. */
static bool list_sites(const StyNear *near, StyNearList *list) {
  size_t count = 0;
  for (size_t r = 0; r < list->run_count; r++) count += near->runs[list->runs[r] + 1] - near->runs[list->runs[r]];
  if (list->capacity < count) {
    if (!reserve(&list->sites, 2 * count)) return false;
    list->capacity = 2 * count;
  }
  list->count = 0;
  for (size_t r = 0; r < list->run_count; r++)
    for (uint32_t o = near->runs[list->runs[r]]; o < near->runs[list->runs[r] + 1]; o++)
      list->sites[list->count++] = near->order[o];
  return true;
}

bool sty_list_near(const StyNear *near, const float *at, double radius, StyNearList *list) {
  size_t count = 0;
  const double squared = radius * radius;
  const int left = get_bucket_part(at[0] - radius, near->x0, near->inverse, near->columns);
  const int right = get_bucket_part(at[0] + radius, near->x0, near->inverse, near->columns);
  const int top = get_bucket_part(at[1] - radius, near->y0, near->inverse, near->rows);
  const int bottom = get_bucket_part(at[1] + radius, near->y0, near->inverse, near->rows);
  for (int row = top; row <= bottom; row++) {
    const uint32_t *first = near->first + (size_t)row * (size_t)near->columns;
    for (uint32_t run = first[left]; run < first[right + 1]; run++) {
      float place[3];
      sty_lift(near->dims, near->sites->values + 2 * (size_t)near->order[near->runs[run]], place);
      double sum = 0;
      for (int k = 0; k < near->dims; k++) sum += ((double)at[k] - place[k]) * ((double)at[k] - place[k]);
      if (!(sum <= squared)) continue;
      if (!append_run(list, count, run)) return false;
      count++;
    }
  }
  list->unchanged = list->sites && count == list->run_count &&
                    (!count || memcmp(list->found, list->runs, count * sizeof *list->runs) == 0);
  if (list->unchanged) return true;
  uint32_t *const spare = list->runs;
  list->runs = list->found;
  list->found = spare;
  list->run_count = count;
  return list_sites(near, list);
}

static int compare_sites(const void *a, const void *b) {
  const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
  return (x > y) - (x < y);
}

void sty_sort_near_list(StyNearList *list) {
  if (list->run_count > 1) qsort(list->sites, list->count, sizeof *list->sites, compare_sites);
}

void sty_free_near_list(StyNearList *list) {
  free(list->sites);
  free(list->runs);
  free(list->found);
  *list = (StyNearList){0};
}
