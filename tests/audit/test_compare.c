#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "stylut/compare.h"

static StyImage *make_image(int width, int height, const char *const *names, int channels, int bits) {
  StyImage *image = NULL;
  assert_int_equal(sty_create_image(width, height, channels, names, bits, &image, NULL), STY_OK);
  return image;
}

static const char *const two_names[] = {"Y", "Z"};
static const StyCompareOptions strict = {.fail = 0, .hard_fail = INFINITY};

static StyComparison compare(const StyImage *a, const StyImage *b, const StyCompareOptions *options, int threads) {
  StyComparison found;
  StyError error;
  const StyRun run = {.threads = threads};
  if (sty_compare_images("a", a, "b", b, options, &run, &found, NULL, &error)) fail_msg("%s", error.text);
  return found;
}

static void test_largest_is_the_first(void **state) {
  (void)state;
  StyImage *a = make_image(4, 3, two_names, 2, 32), *b = make_image(4, 3, two_names, 2, 32);
  float *y = sty_find_channel(b, "Y"), *z = sty_find_channel(b, "Z");
  y[9] = -2, z[5] = 2, y[5] = 1, z[0] = 0.5f;
  const StyComparison found = compare(a, b, &(StyCompareOptions){.fail = 0.5, .hard_fail = 1.5}, 1);
  assert_int_equal(found.differing, 3);
  assert_int_equal(found.failing, 2);
  assert_int_equal(found.hard_failing, 2);
  assert_true(found.max == 2 && found.finite_max == 2 && found.infinite == 0);
  assert_int_equal(found.channel, 1);
  assert_int_equal(found.x, 1);
  assert_int_equal(found.y, 1);
  assert_true(found.found[0] == 0 && found.found[1] == 2);
  assert_true(fabs(found.mean - 5.5 / 24) < 1e-15);
  assert_true(fabs(found.rms - sqrt(9.25 / 24)) < 1e-15);
  sty_destroy_image(&a);
  sty_destroy_image(&b);
}

static void test_odd_values(void **state) {
  (void)state;
  static const struct {
    float a, b;
    bool infinite;
  } pairs[] = {{NAN, NAN, false},          {NAN, -NAN, false},  {INFINITY, INFINITY, false},
               {0.0f, -0.0f, false},       {NAN, 0, true},      {0, NAN, true},
               {INFINITY, NAN, true},      {INFINITY, 1, true}, {1, -INFINITY, true},
               {INFINITY, -INFINITY, true}};
  for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
    StyImage *a = make_image(1, 1, two_names, 1, 32), *b = make_image(1, 1, two_names, 1, 32);
    a->data[0] = pairs[i].a, b->data[0] = pairs[i].b;
    const StyComparison found = compare(a, b, &strict, 1);
    assert_int_equal(found.differing, pairs[i].infinite);
    assert_int_equal(found.infinite, pairs[i].infinite);
    assert_int_equal(found.hard_failing, 0); /* nothing is beyond infinity */
    assert_true(found.mean == 0 && found.rms == 0 && found.finite_max == 0);
    sty_destroy_image(&a);
    sty_destroy_image(&b);
  }
}

/* One level is the same number wherever it stands. */
static void test_levels(void **state) {
  (void)state;
  StyImage *a = make_image(255, 1, two_names, 1, 8), *b = make_image(255, 1, two_names, 1, 16);
  for (int v = 0; v < 255; v++) a->data[v] = (float)v / 255.0f, b->data[v] = (float)(257 * (v + 1)) / 65535.0f;
  const StyComparison found = compare(a, b, &(StyCompareOptions){.fail = 1.0 / 255, .hard_fail = 1.0 / 255}, 1);
  assert_int_equal(found.differing, 255);
  assert_int_equal(found.failing, 0); /* as much as the limit isn't more */
  assert_int_equal(found.hard_failing, 0);
  assert_true(found.max == 1.0 / 255);
  sty_destroy_image(&a);
  sty_destroy_image(&b);
}

static void test_threads(void **state) {
  (void)state;
  StyImage *a = make_image(61, 47, two_names, 2, 32), *b = make_image(61, 47, two_names, 2, 32);
  uint32_t random = 1;
  for (size_t i = 0; i < 2 * sty_count_pixels(a); i++) {
    random = random * 1664525u + 1013904223u;
    a->data[i] = (float)(random >> 8) / 16777216.0f;
    b->data[i] = random % 7 ? a->data[i] : (float)(random >> 20) / 4096.0f;
  }
  const StyComparison one = compare(a, b, &strict, 1), four = compare(a, b, &strict, 4);
  assert_true(one.differing > 100 && one.differing < sty_count_pixels(a));
  assert_true(one.mean == four.mean && one.rms == four.rms && one.max == four.max);
  assert_true(one.differing == four.differing && one.x == four.x && one.y == four.y && one.channel == four.channel);
  sty_destroy_image(&a);
  sty_destroy_image(&b);
}

static void test_pairs_that_do_not_fit(void **state) {
  (void)state;
  static const char *const other_names[] = {"Y", "Q"}, *const turned_names[] = {"Z", "Y"};
  StyImage *a = make_image(4, 3, two_names, 2, 32);
  StyImage *misfits[] = {make_image(3, 4, two_names, 2, 32), make_image(4, 3, two_names, 1, 32),
                         make_image(4, 3, other_names, 2, 32)};
  for (size_t i = 0; i < sizeof misfits / sizeof *misfits; i++)
    for (int turn = 0; turn < 2; turn++) {
      StyComparison found = {.pixels = 42};
      StyError error;
      assert_int_equal(sty_compare_images("first", turn ? misfits[i] : a, "second", turn ? a : misfits[i], &strict,
                                          NULL, &found, NULL, &error),
                       STY_FILES_DIFFER);
      assert_non_null(strstr(error.text, "first and second: found "));
      assert_int_equal(found.pixels, 42); /* written only on success */
    }
  StyImage *turned = make_image(4, 3, turned_names, 2, 32);
  sty_find_channel(a, "Z")[3] = sty_find_channel(turned, "Z")[3] = 5;
  assert_int_equal(compare(a, turned, &strict, 1).differing, 0);
  for (size_t i = 0; i < sizeof misfits / sizeof *misfits; i++) sty_destroy_image(&misfits[i]);
  sty_destroy_image(&turned);
  sty_destroy_image(&a);
}

/* Ever lighter, from black over the ramp to white. */
static void test_heat_is_monotone(void **state) {
  (void)state;
  enum { COUNT = 1001 };
  float values[COUNT + 1];
  for (int i = 0; i < COUNT; i++) values[i] = (float)i / 1000.0f;
  values[COUNT] = INFINITY;
  StyImage *heat = NULL;
  assert_int_equal(sty_paint_heat(values, COUNT + 1, 1, 1, &heat, NULL), STY_OK);
  const float *r = sty_find_channel(heat, "R"), *g = sty_find_channel(heat, "G"), *b = sty_find_channel(heat, "B");
  float before = -1;
  for (int i = 0; i <= COUNT; i++) {
    /* Linear light of sRGB, roughly. */
    const float light = 0.2126f * powf(r[i], 2.2f) + 0.7152f * powf(g[i], 2.2f) + 0.0722f * powf(b[i], 2.2f);
    if (!(light > before)) fail_msg("value %d of %d isn't lighter than the one before", i, COUNT);
    before = light;
  }
  assert_true(r[0] == 0 && g[0] == 0 && b[0] == 0);
  assert_true(r[COUNT] == 1 && g[COUNT] == 1 && b[COUNT] == 1);
  sty_destroy_image(&heat);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_largest_is_the_first),
      cmocka_unit_test(test_odd_values),
      cmocka_unit_test(test_levels),
      cmocka_unit_test(test_threads),
      cmocka_unit_test(test_pairs_that_do_not_fit),
      cmocka_unit_test(test_heat_is_monotone),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
