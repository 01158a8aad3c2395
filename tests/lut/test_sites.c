#include <math.h>

#include "../scratch.h"
#include "lut/engine.h"

static const char *const CHANNELS[] = {"A", "normal.X", "normal.Y"};

static StyImage *make_guide(int width, int height) {
  StyImage *guide = NULL;
  assert_int_equal(sty_create_image(width, height, 3, CHANNELS, 32, &guide, NULL), STY_OK);
  return guide;
}

static void set_pixel(StyImage *guide, int pixel, float coverage, float x, float y) {
  const size_t plane = sty_count_pixels(guide);
  guide->data[pixel] = coverage;
  guide->data[plane + (size_t)pixel] = x;
  guide->data[2 * plane + (size_t)pixel] = y;
}

static StySites *collect(const StyImage *guide) {
  StySites *sites = NULL;
  assert_int_equal(sty_collect_sites("g.exr", guide, &sites, NULL), STY_OK);
  return sites;
}

static const StyLutSpec SPEC = {4, 4, STY_SAMPLE_CENTRE, STY_MAP_XY, STY_METRIC_XY};

static StyPoints collapse(const StySites *sites, const StyLutSpec *spec) {
  StyPoints points;
  assert_int_equal(sty_collapse_sites(sites, spec, &points, NULL), STY_OK);
  return points;
}

/* Every covered pixel is a site; points are the different places. */
static void test_by_hand(void **state) {
  (void)state;
  StyImage *guide = make_guide(3, 2);
  set_pixel(guide, 0, 0, 5, 5);
  set_pixel(guide, 1, 1, 0.5f, 0.25f);
  set_pixel(guide, 2, 1, -0.5f, 0.25f);
  set_pixel(guide, 3, 1, 0.5f, 0.25f); /* as pixel 1 */
  set_pixel(guide, 4, 0, -0.5f, -0.25f);
  set_pixel(guide, 5, 1, 0.25f, 0.5f);
  StySites *sites = collect(guide);
  assert_int_equal(sites->width, 3);
  assert_int_equal(sites->height, 2);
  assert_int_equal(sites->count, 4);
  static const uint32_t pixels[] = {1, 2, 3, 5};
  static const float values[] = {0.5f, 0.25f, -0.5f, 0.25f, 0.5f, 0.25f, 0.25f, 0.5f};
  assert_memory_equal(sites->pixels, pixels, sizeof pixels);
  assert_memory_equal(sites->values, values, sizeof values);
  assert_null(sites->levels);

  StyPoints points = collapse(sites, &SPEC);
  static const uint32_t few_pixels[] = {1, 2, 5};
  static const float few_values[] = {0.5f, 0.25f, -0.5f, 0.25f, 0.25f, 0.5f};
  assert_int_equal(points.count, 3);
  assert_int_equal(points.measure.dims, 2);
  assert_false(points.measure.integer);
  assert_null(points.levels);
  assert_memory_equal(points.pixels, few_pixels, sizeof few_pixels);
  assert_memory_equal(points.values, few_values, sizeof few_values);
  sty_free_points(&points);
  sty_destroy_sites(&sites);
  assert_null(sites);
  sty_destroy_sites(&sites);
  sty_destroy_image(&guide);
}

/* By angle all of a direction outside the disc is one place on the rim. */
static void test_collapse_by_angle(void **state) {
  (void)state;
  StyImage *guide = make_guide(5, 1);
  set_pixel(guide, 0, 1, 3, 0);
  set_pixel(guide, 1, 1, 0.6f, 0);
  set_pixel(guide, 2, 1, 1, 0);
  set_pixel(guide, 3, 1, 700, 0);
  set_pixel(guide, 4, 1, 0, -2);
  StySites *sites = collect(guide);
  StyLutSpec spec = SPEC;
  spec.metric = STY_METRIC_ANGLE;
  StyPoints points = collapse(sites, &spec);
  assert_int_equal(points.measure.dims, 3);
  assert_int_equal(points.count, 3);
  static const uint32_t pixels[] = {0, 1, 4};
  static const float values[] = {1, 0, 0, 0.6f, 0, 0.8f, 0, -1, 0};
  assert_memory_equal(points.pixels, pixels, sizeof pixels);
  for (int k = 0; k < 9; k++) assert_true(fabsf(points.values[k] - values[k]) < 1e-6f);
  sty_free_points(&points);
  sty_destroy_sites(&sites);
  sty_destroy_image(&guide);
}

/* Against a literal search for duplicates. */
static void test_random_guides(void **state) {
  (void)state;
  uint64_t random = 1;
  for (int trial = 0; trial < 2000; trial++) {
    const int width = 1 + draw_below(&random, 20), height = 1 + draw_below(&random, 20), count = width * height;
    const int levels = 1 + draw_below(&random, 12);
    StyImage *guide = make_guide(width, height);
    for (int i = 0; i < count; i++)
      set_pixel(guide, i, (float)(i == 0 || draw_below(&random, 3)), (float)draw_below(&random, levels) / 8.0f - 0.5f,
                (float)draw_below(&random, levels) / 8.0f - 0.5f);
    const float *a = guide->data, *x = a + count, *y = x + count;
    StySites *sites = collect(guide);
    StyPoints points = collapse(sites, &SPEC);
    size_t covered = 0, found = 0;
    for (int i = 0; i < count; i++) {
      if (!(a[i] > 0)) continue;
      assert_true(covered < sites->count);
      assert_int_equal(sites->pixels[covered], i);
      assert_true(sites->values[2 * covered] == x[i] && sites->values[2 * covered + 1] == y[i]);
      covered++;
      int first = 0;
      while (!(a[first] > 0 && x[first] == x[i] && y[first] == y[i])) first++;
      if (first != i) continue;
      assert_true(found < points.count);
      assert_int_equal(points.pixels[found], i);
      assert_true(points.values[2 * found] == x[i] && points.values[2 * found + 1] == y[i]);
      found++;
    }
    assert_int_equal(sites->count, covered);
    assert_int_equal(points.count, found);
    sty_free_points(&points);
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
}

/* ---- levels --------------------------------------------------------------------- */

static float get_byte_value(int byte) { return (float)(2 * byte - 255) / 255.0f; }

/* All 65,536 values that two bytes may have. */
static void test_levels(void **state) {
  (void)state;
  StyImage *guide = make_guide(256, 256);
  for (int i = 0; i < 65536; i++) set_pixel(guide, i, 1, get_byte_value(i % 256), get_byte_value(i / 256));
  StySites *sites = collect(guide);
  assert_non_null(sites->levels);
  for (int i = 0; i < 65536; i++) {
    assert_int_equal(sites->levels[2 * i], i % 256);
    assert_int_equal(sites->levels[2 * i + 1], i / 256);
  }
  StyPoints points = collapse(sites, &SPEC);
  assert_true(points.measure.integer);
  assert_int_equal(points.count, 65536);
  assert_memory_equal(points.levels, sites->levels, 2 * 65536);
  sty_free_points(&points);
  sty_destroy_sites(&sites);
  sty_destroy_image(&guide);
}

/* One value in many that is no byte's makes it a float guide; an uncovered one doesn't. */
static void test_no_levels(void **state) {
  (void)state;
  static const float others[] = {0, 0.5f, -0.5f, 1.5f, 1000, -1000, 1 + 2.0f / 255, 345.0f / 255, 3, -3, 257.0f / 255};
  static const int places[] = {0, 1, 4095, 4096, 9999};
  StyImage *guide = make_guide(100, 100);
  for (int i = 0; i < 10000; i++) set_pixel(guide, i, 1, get_byte_value(i % 256), get_byte_value(i / 256));
  for (size_t o = 0; o <= 2 * sizeof others / sizeof *others; o++) {
    for (int p = 0; p < 5; p++) {
      const int i = places[p];
      const float x = get_byte_value(i % 256), y = get_byte_value(i / 256);
      /* The last is a neighbour in float. */
      const float other = o / 2 < sizeof others / sizeof *others ? others[o / 2] : nextafterf(x, 2);
      set_pixel(guide, i, 1, o % 2 ? x : other, o % 2 ? other : y);
      StySites *sites = collect(guide);
      if (sites->levels) fail_msg("%.9g passes as a byte", (double)other);
      sty_destroy_sites(&sites);
      set_pixel(guide, i, 0, other, other);
      sites = collect(guide);
      assert_non_null(sites->levels);
      sty_destroy_sites(&sites);
      set_pixel(guide, i, 1, x, y);
    }
  }
  sty_destroy_image(&guide);
}

/* Integers are for square tables of map and metric xy. */
static void test_measures(void **state) {
  (void)state;
  StyImage *bytes = make_guide(1, 1), *floats = make_guide(1, 1);
  set_pixel(bytes, 0, 1, 1, -1);
  set_pixel(floats, 0, 1, 0, 0);
  StySites *with = collect(bytes), *without = collect(floats);
  for (int sampling = 0; sampling < 3; sampling++)
    for (int map = 0; map < 2; map++)
      for (int metric = 0; metric < 2; metric++)
        for (int square = 0; square < 2; square++) {
          const StyLutSpec spec = {4, 3 + square, (StySampling)sampling, (StyMap)map, (StyMetric)metric};
          const bool integer = map == STY_MAP_XY && metric == STY_METRIC_XY && square;
          const int dims = metric == STY_METRIC_ANGLE ? 3 : 2;
          assert_int_equal(sty_choose_measure(with, &spec).integer, integer);
          assert_int_equal(sty_choose_measure(with, &spec).dims, dims);
          assert_false(sty_choose_measure(without, &spec).integer);
          assert_int_equal(sty_choose_measure(without, &spec).dims, dims);
        }
  sty_destroy_sites(&with);
  sty_destroy_sites(&without);
  sty_destroy_image(&bytes);
  sty_destroy_image(&floats);
}

/* ---- refusals ------------------------------------------------------------------- */

static void expect_refusal(StyImage *guide, const char *part) {
  StySites *sites = NULL;
  StyError error = {STY_OK, ""};
  expect_message(sty_collect_sites("some-guide.exr", guide, &sites, &error), STY_ERROR_INPUT, &error,
                 PARTS("some-guide.exr", part));
  assert_null(sites);
}

static void test_no_covered_pixel(void **state) {
  (void)state;
  StyImage *guide = make_guide(4, 4);
  expect_refusal(guide, "");
  /* What isn't covered isn't looked at. */
  set_pixel(guide, 3, 0, NAN, INFINITY);
  expect_refusal(guide, "");
  set_pixel(guide, 4, 1, 0, 0);
  StySites *sites = NULL;
  assert_int_equal(sty_collect_sites("g.exr", guide, &sites, NULL), STY_OK);
  assert_int_equal(sites->count, 1);
  sty_destroy_sites(&sites);
  sty_destroy_image(&guide);
}

static void test_bad_values(void **state) {
  (void)state;
  static const float bad[] = {NAN, INFINITY, -INFINITY, 1000.001f, -1000.001f, 3e38f};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    for (int axis = 0; axis < 2; axis++) {
      StyImage *guide = make_guide(40, 30);
      for (int p = 0; p < 1200; p++) set_pixel(guide, p, 1, 0, 0);
      set_pixel(guide, 40 * 23 + 17, 1, axis ? 0 : bad[i], axis ? bad[i] : 0);
      StySites *sites = NULL;
      StyError error = {STY_OK, ""};
      expect_message(sty_collect_sites("some-guide.exr", guide, &sites, &error), STY_ERROR_INPUT, &error,
                     PARTS("some-guide.exr", "17", "23"));
      assert_null(sites);
      sty_destroy_image(&guide);
    }
  }
}

static void test_outermost_values(void **state) {
  (void)state;
  StyImage *guide = make_guide(2, 1);
  set_pixel(guide, 0, 1, 1000, -1000);
  set_pixel(guide, 1, 1, -1000, 1000);
  StySites *sites = NULL;
  assert_int_equal(sty_collect_sites("g.exr", guide, &sites, NULL), STY_OK);
  assert_int_equal(sites->count, 2);
  sty_destroy_sites(&sites);
  sty_destroy_image(&guide);
}

static void test_missing_channels(void **state) {
  (void)state;
  for (int without = 0; without < 3; without++) {
    const char *names[] = {"A", "normal.X", "normal.Y"};
    names[without] = "other";
    StyImage *guide = NULL;
    assert_int_equal(sty_create_image(2, 2, 3, names, 32, &guide, NULL), STY_OK);
    for (int i = 0; i < 12; i++) guide->data[i] = 1;
    expect_refusal(guide, "");
    sty_destroy_image(&guide);
  }
}

/* -0 and 0 are one place. */
static void test_negative_zero(void **state) {
  (void)state;
  StyImage *guide = make_guide(3, 1);
  set_pixel(guide, 0, 1, -0.0f, 0.0f);
  set_pixel(guide, 1, 1, 0.0f, -0.0f);
  set_pixel(guide, 2, 1, -0.0f, -0.0f);
  StySites *sites = collect(guide);
  assert_int_equal(sites->count, 3);
  for (int i = 0; i < 6; i++) assert_false(signbit(sites->values[i]));
  for (int metric = 0; metric < 2; metric++) {
    StyLutSpec spec = SPEC;
    spec.metric = (StyMetric)metric;
    StyPoints points = collapse(sites, &spec);
    assert_int_equal(points.count, 1);
    assert_int_equal(points.pixels[0], 0);
    sty_free_points(&points);
  }
  sty_destroy_sites(&sites);

  /* Nor does the least float become a zero of another sign when it is shortened. */
  set_pixel(guide, 0, 1, 0, 900);
  set_pixel(guide, 1, 1, -0x1p-149f, 900);
  set_pixel(guide, 2, 1, 0x1p-149f, 900);
  sites = collect(guide);
  StyLutSpec spec = SPEC;
  spec.metric = STY_METRIC_ANGLE;
  StyPoints points = collapse(sites, &spec);
  assert_int_equal(points.count, 1);
  sty_free_points(&points);
  sty_destroy_sites(&sites);
  sty_destroy_image(&guide);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_by_hand),          cmocka_unit_test(test_collapse_by_angle),
      cmocka_unit_test(test_random_guides),    cmocka_unit_test(test_levels),
      cmocka_unit_test(test_no_levels),        cmocka_unit_test(test_measures),
      cmocka_unit_test(test_no_covered_pixel), cmocka_unit_test(test_bad_values),
      cmocka_unit_test(test_outermost_values), cmocka_unit_test(test_missing_channels),
      cmocka_unit_test(test_negative_zero),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
