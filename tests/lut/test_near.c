#include "lut/near.h"

#include <math.h>

#include "../scratch.h"

typedef enum Kind { FLOATS, BYTES, ALL_EQUAL, LINE, FAR, TWO_CLUSTERS, KINDS } Kind;

/* Sites without a guide: pixels ascend, with gaps. */
static StySites make_sites(Kind kind, size_t count, uint64_t *random) {
  StySites sites = {.width = 1000, .height = 1000, .count = count};
  sites.values = malloc(2 * count * sizeof *sites.values);
  sites.pixels = malloc(count * sizeof *sites.pixels);
  assert_true(sites.values && sites.pixels);
  const float base[2] = {draw_signed(random), draw_signed(random)};
  for (size_t s = 0; s < count; s++) {
    sites.pixels[s] = (uint32_t)(3 * s + 1);
    const float side = draw_below(random, 2) ? 0.8f : -0.8f;
    for (int k = 0; k < 2; k++) {
      float *g = &sites.values[2 * s + (size_t)k];
      switch (kind) {
        case BYTES: *g = (float)(2 * draw_below(random, 256) - 255) / 255.0f; break;
        case ALL_EQUAL: *g = base[k]; break;
        case LINE: *g = k ? base[k] : draw_signed(random); break;
        case FAR: *g = 1000 * draw_signed(random); break;
        case TWO_CLUSTERS: *g = side + draw_signed(random) * 0.01f; break;
        default: *g = draw_signed(random); break;
      }
    }
  }
  return sites;
}

static void free_sites(StySites *sites) {
  free(sites->values);
  free(sites->pixels);
}

static double measure(const StySites *sites, int dims, size_t site, const float at[3]) {
  float place[3];
  sty_lift(dims, sites->values + 2 * site, place);
  double sum = 0;
  for (int k = 0; k < dims; k++) sum += ((double)at[k] - place[k]) * ((double)at[k] - place[k]);
  return sum;
}

/* Every site within the radius, no other, in ascending order once sorted; how many. */
static size_t expect_list(const StyNear *near, const float at[3], double radius, StyNearList *list, const char *what) {
  assert_true(sty_list_near(near, at, radius, list));
  sty_sort_near_list(list);
  size_t found = 0;
  for (size_t s = 0; s < near->sites->count; s++) {
    if (!(measure(near->sites, near->dims, s, at) <= radius * radius)) continue;
    if (found >= list->count || list->sites[found] != s)
      fail_msg("%s: site %zu, within %g of (%g, %g), isn't number %zu of the list", what, s, radius, (double)at[0],
               (double)at[1], found);
    found++;
  }
  if (found != list->count) fail_msg("%s: %zu sites within %g, %zu listed", what, found, radius, list->count);
  return found;
}

static void test_against_a_scan(void **state) {
  (void)state;
  uint64_t random = 31;
  static const double wanted[] = {0, 1e-7, 0.001, 0.02, 0.3, 5};
  size_t listed = 0, unchanged = 0;
  for (int trial = 0; trial < CASES(1200, 200); trial++) {
    const Kind kind = (Kind)(trial % KINDS);
    const int dims = 2 + trial / KINDS % 2;
    StySites sites = make_sites(kind, 1 + (size_t)draw_below(&random, trial % 10 ? 60 : 3000), &random);
    StyNear near;
    assert_int_equal(sty_open_near(&sites, dims, wanted[draw_below(&random, 6)], &near, NULL), STY_OK);
    StyNearList list = {0}; /* one for all queries: what it held before doesn't matter */
    char what[60];
    snprintf(what, sizeof what, "kind %d, trial %d, %zu sites", (int)kind, trial, sites.count);
    for (int query = 0; query < 30; query++) {
      /* Somewhere, or at a site; also with a radius that isn't the one asked for, and up to a site exactly. */
      const size_t site = (size_t)draw_below(&random, (int)sites.count);
      float g[2] = {draw_signed(&random) * 1.5f, draw_signed(&random) * 1.5f}, at[3];
      if (query % 2) memcpy(g, sites.values + 2 * site, sizeof g);
      sty_lift(dims, g, at);
      double radius = wanted[draw_below(&random, 6)];
      if (query % 3 == 0) radius = sqrt(measure(&sites, dims, (size_t)draw_below(&random, (int)sites.count), at));
      listed += expect_list(&near, at, radius, &list, what);
      unchanged += list.unchanged;
      if (query % 2) assert_true(list.count > 0); /* itself at least */
    }
    sty_free_near_list(&list);
    sty_close_near(&near);
    free_sites(&sites);
  }
  assert_true(listed > CASES(10000, 1500) && unchanged > CASES(1000, 150));
}

static void test_by_hand(void **state) {
  (void)state;
  float values[] = {0, 0, 0.5f, 0, 0, 0, 0.5f, 0.25f, -3, 0};
  uint32_t pixels[] = {1, 2, 3, 5, 8};
  const StySites sites = {.width = 10, .height = 1, .count = 5, .values = values, .pixels = pixels};
  StyNear near;
  StyNearList list = {0};
  assert_int_equal(sty_open_near(&sites, 2, 0.25, &near, NULL), STY_OK);
  static const float middle[3] = {0, 0, 1}, right[3] = {0.5f, 0, 0}, left[3] = {-1, 0, 0};
  assert_true(sty_list_near(&near, middle, 0, &list));
  assert_true(list.count == 2 && list.sites[0] == 0 && list.sites[1] == 2 && !list.unchanged);
  assert_true(sty_list_near(&near, middle, 0.1, &list));
  assert_true(list.count == 2 && list.sites[0] == 0 && list.sites[1] == 2 && list.unchanged);
  assert_true(sty_list_near(&near, right, 0.25, &list)); /* up to the radius itself */
  assert_true(list.count == 2 && list.sites[0] == 1 && list.sites[1] == 3);
  assert_true(sty_list_near(&near, right, 0.2499, &list));
  assert_true(list.count == 1 && list.sites[0] == 1);
  assert_true(sty_list_near(&near, left, 0.9, &list));
  assert_int_equal(list.count, 0);
  assert_true(sty_list_near(&near, middle, 10, &list));
  assert_int_equal(list.count, 5);
  sty_sort_near_list(&list);
  for (uint32_t s = 0; s < 5; s++) assert_int_equal(list.sites[s], s);
  sty_close_near(&near);
  sty_free_near_list(&list);
  assert_null(near.first);
  /* By angle the last is at the rim. */
  assert_int_equal(sty_open_near(&sites, 3, 0.25, &near, NULL), STY_OK);
  assert_true(sty_list_near(&near, left, 1e-6, &list));
  assert_true(list.count == 1 && list.sites[0] == 4);
  sty_close_near(&near);
  sty_free_near_list(&list);
}

/* However small the radius, buckets are no more than sites, about. */
static void test_buckets_are_bounded(void **state) {
  (void)state;
  uint64_t random = 32;
  for (int kind = 0; kind < KINDS; kind++) {
    StySites sites = make_sites((Kind)kind, 10000, &random);
    for (int dims = 2; dims <= 3; dims++) {
      static const double radii[] = {0, 1e-30, 1e-7, 0.1, 1e6};
      for (int r = 0; r < 5; r++) {
        StyNear near;
        assert_int_equal(sty_open_near(&sites, dims, radii[r], &near, NULL), STY_OK);
        assert_true((double)near.columns * near.rows <= 1.2 * 10000);
        sty_close_near(&near);
      }
    }
    free_sites(&sites);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_by_hand),
      cmocka_unit_test(test_against_a_scan),
      cmocka_unit_test(test_buckets_are_bounded),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
