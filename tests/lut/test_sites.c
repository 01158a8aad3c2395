#include <math.h>

#include "../scratch.h"
#include "stylut/lut.h"

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

static void test_collapse(void **state) {
  (void)state;
  StyImage *guide = make_guide(3, 2);
  set_pixel(guide, 0, 0, 5, 5);
  set_pixel(guide, 1, 1, 0.5f, 0.25f);
  set_pixel(guide, 2, 1, -0.5f, 0.25f);
  set_pixel(guide, 3, 1, 0.5f, 0.25f); /* as pixel 1 */
  set_pixel(guide, 4, 0, -0.5f, -0.25f);
  set_pixel(guide, 5, 1, 0.25f, 0.5f);
  StySites *sites = NULL;
  assert_int_equal(sty_collect_sites("g.exr", guide, &sites, NULL), STY_OK);
  assert_int_equal(sites->width, 3);
  assert_int_equal(sites->height, 2);
  assert_int_equal(sites->point_count, 4);
  assert_int_equal(sites->count, 3);
  static const uint32_t pixels[] = {1, 2, 5};
  static const float values[] = {0.5f, 0.25f, -0.5f, 0.25f, 0.25f, 0.5f};
  assert_memory_equal(sites->pixels, pixels, sizeof pixels);
  assert_memory_equal(sites->values, values, sizeof values);
  sty_destroy_sites(&sites);
  assert_null(sites);
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
    StySites *sites = NULL;
    assert_int_equal(sty_collect_sites("g.exr", guide, &sites, NULL), STY_OK);
    size_t points = 0, found = 0;
    for (int i = 0; i < count; i++) {
      if (!(a[i] > 0)) continue;
      points++;
      int first = 0;
      while (!(a[first] > 0 && x[first] == x[i] && y[first] == y[i])) first++;
      if (first != i) continue;
      assert_true(found < sites->count);
      assert_int_equal(sites->pixels[found], i);
      assert_true(sites->values[2 * found] == x[i] && sites->values[2 * found + 1] == y[i]);
      found++;
    }
    assert_int_equal(sites->point_count, points);
    assert_int_equal(sites->count, found);
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
}

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

/* Distances to -0 and 0 are the same, so that a table can only ever name the lower pixel. */
static void test_negative_zero(void **state) {
  (void)state;
  StyImage *guide = make_guide(2, 1);
  set_pixel(guide, 0, 1, -0.0f, 0.0f);
  set_pixel(guide, 1, 1, 0.0f, -0.0f);
  StySites *sites = NULL;
  assert_int_equal(sty_collect_sites("g.exr", guide, &sites, NULL), STY_OK);
  assert_int_equal(sites->point_count, 2);
  assert_int_equal(sites->pixels[0], 0);
  for (size_t i = 1; i < sites->count; i++) assert_int_equal(sites->pixels[i], i);
  sty_destroy_sites(&sites);
  sty_destroy_image(&guide);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_collapse),         cmocka_unit_test(test_random_guides),
      cmocka_unit_test(test_no_covered_pixel), cmocka_unit_test(test_bad_values),
      cmocka_unit_test(test_outermost_values), cmocka_unit_test(test_missing_channels),
      cmocka_unit_test(test_negative_zero),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
