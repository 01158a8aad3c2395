#include "lut/near.h"

#include <math.h>
#include <stdlib.h>

static int get_bucket_part(double value, double low, double inverse, int count) {
  const double part = (value - low) * inverse;
  return part <= 0 ? 0 : part < count ? (int)part : count - 1;
}

static size_t get_bucket(const StyNear *near, const float at[3]) {
  return (size_t)get_bucket_part(at[1], near->y0, near->inverse, near->rows) * (size_t)near->columns +
         (size_t)get_bucket_part(at[0], near->x0, near->inverse, near->columns);
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
  if (!near.first || !near.order) {
    sty_close_near(&near);
    return sty_fail_memory(error, "neighbouring pixels", (double)(buckets + sites->count) * 4);
  }
  /* Shifted by two, so that `first` ends up as where buckets begin. */
  for (int pass = 0; pass < 2; pass++) {
    for (size_t s = 0; s < sites->count; s++) {
      float at[3];
      sty_lift(dims, sites->values + 2 * s, at);
      const size_t bucket = get_bucket(&near, at);
      if (pass == 0)
        near.first[bucket + 2]++;
      else
        near.order[near.first[bucket + 1]++] = (uint32_t)s;
    }
    for (size_t b = 0; pass == 0 && b < buckets; b++) near.first[b + 2] += near.first[b + 1];
  }
  *out = near;
  return STY_OK;
}

void sty_close_near(StyNear *near) {
  free(near->first);
  free(near->order);
  *near = (StyNear){0};
}

static bool append_site(StyNearList *list, uint32_t site) {
  if (list->count == list->capacity) {
    const size_t capacity = list->capacity ? 2 * list->capacity : 64;
    uint32_t *sites = realloc(list->sites, capacity * sizeof *sites);
    if (!sites) return false;
    list->sites = sites;
    list->capacity = capacity;
  }
  list->sites[list->count++] = site;
  return true;
}

static int compare_sites(const void *a, const void *b) {
  const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
  return (x > y) - (x < y);
}

bool sty_list_near(const StyNear *near, const float *at, double radius, StyNearList *list) {
  list->count = 0;
  const double squared = radius * radius;
  const int left = get_bucket_part(at[0] - radius, near->x0, near->inverse, near->columns);
  const int right = get_bucket_part(at[0] + radius, near->x0, near->inverse, near->columns);
  const int top = get_bucket_part(at[1] - radius, near->y0, near->inverse, near->rows);
  const int bottom = get_bucket_part(at[1] + radius, near->y0, near->inverse, near->rows);
  for (int row = top; row <= bottom; row++) {
    const uint32_t *first = near->first + (size_t)row * (size_t)near->columns;
    for (size_t o = first[left]; o < first[right + 1]; o++) {
      float place[3];
      sty_lift(near->dims, near->sites->values + 2 * (size_t)near->order[o], place);
      double sum = 0;
      for (int k = 0; k < near->dims; k++) sum += ((double)at[k] - place[k]) * ((double)at[k] - place[k]);
      if (sum <= squared && !append_site(list, near->order[o])) return false;
    }
  }
  if (list->count > 1) qsort(list->sites, list->count, sizeof *list->sites, compare_sites);
  return true;
}
