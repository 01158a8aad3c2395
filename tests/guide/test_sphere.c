#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "stylut/guide.h"

static const unsigned ALL = STY_GUIDE_NORMAL | STY_GUIDE_DEPTH | STY_GUIDE_POSITION | STY_GUIDE_OBJECT |
                            STY_GUIDE_STYLE | STY_GUIDE_ALBEDO | STY_GUIDE_LUMA;

static void test_values(void **state) {
  (void)state;
  enum { WIDTH = 37, HEIGHT = 20 };
  StyImage *guide = NULL;
  assert_int_equal(sty_make_sphere_guide(WIDTH, HEIGHT, ALL, &guide, NULL), STY_OK);
  assert_int_equal(guide->channel_count, 14);
  assert_int_equal(guide->bits, 32);
  const float *coverage = sty_find_channel(guide, "A"), *depth = sty_find_channel(guide, "depth.Z");
  const float *nx = sty_find_channel(guide, "normal.X"), *ny = sty_find_channel(guide, "normal.Y"),
              *nz = sty_find_channel(guide, "normal.Z"), *pz = sty_find_channel(guide, "position.Z"),
              *object = sty_find_channel(guide, "object.I");
  for (int i = 0; i < WIDTH * HEIGHT; i++) {
    const double x = (i % WIDTH + 0.5) / WIDTH * 2 - 1, y = 1 - (i / WIDTH + 0.5) / HEIGHT * 2;
    const double rest = 1 - x * x - y * y;
    assert_true(coverage[i] == (rest >= 0));
    if (rest >= 0) {
      assert_true(nx[i] == (float)x && ny[i] == (float)y && nz[i] == (float)sqrt(rest));
      assert_true(depth[i] == (float)(1 - sqrt(rest)) && pz[i] == nz[i] && object[i] == 1);
    } else {
      assert_true(nx[i] == 0 && ny[i] == 0 && nz[i] == 0 && pz[i] == 0 && object[i] == 0 && isinf(depth[i]));
    }
  }
  sty_destroy_image(&guide);
}

static void test_only_what_is_asked_for(void **state) {
  (void)state;
  StyImage *guide = NULL;
  assert_int_equal(sty_make_sphere_guide(4, 4, STY_GUIDE_DEPTH, &guide, NULL), STY_OK);
  assert_int_equal(guide->channel_count, 2);
  assert_non_null(sty_find_channel(guide, "depth.Z"));
  sty_destroy_image(&guide);
  assert_int_equal(sty_make_sphere_guide(4, 4, 0, &guide, NULL), STY_OK);
  assert_int_equal(guide->channel_count, 1);
  sty_destroy_image(&guide);
}

static void test_bad_sizes(void **state) {
  (void)state;
  StyImage *guide = NULL;
  StyError error;
  assert_int_equal(sty_make_sphere_guide(0, 4, ALL, &guide, &error), STY_ERROR_INPUT);
  assert_int_equal(sty_make_sphere_guide(STY_MAX_SIDE + 1, 1, ALL, &guide, &error), STY_ERROR_INPUT);
  assert_int_equal(sty_make_sphere_guide(4, 4, 1u << 30, &guide, &error), STY_ERROR_USAGE);
  assert_null(guide);
}

static void test_channel_names(void **state) {
  (void)state;
  unsigned groups = 0;
  StyError error;
  assert_int_equal(sty_parse_channels("-c", "normal", &groups, &error), STY_OK);
  assert_int_equal(groups, STY_GUIDE_NORMAL);
  assert_int_equal(sty_parse_channels("-c", "depth,object,depth", &groups, &error), STY_OK);
  assert_int_equal(groups, STY_GUIDE_DEPTH | STY_GUIDE_OBJECT);
  assert_int_equal(sty_parse_channels("-c", "all", &groups, &error), STY_OK);
  assert_int_equal(groups, ALL | STY_GUIDE_UV | STY_GUIDE_CURVATURE | STY_GUIDE_CONTOUR);
  static const char *const BAD[] = {"", ",", "normal,", ",normal", "norm", "normals", "Normal", "normal depth"};
  for (size_t i = 0; i < sizeof BAD / sizeof *BAD; i++) {
    groups = 99;
    assert_int_equal(sty_parse_channels("-c", BAD[i], &groups, &error), STY_ERROR_USAGE);
    assert_int_equal(groups, 99);
    assert_non_null(strstr(error.text, "normal, depth, position, object"));
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_values),
      cmocka_unit_test(test_only_what_is_asked_for),
      cmocka_unit_test(test_bad_sizes),
      cmocka_unit_test(test_channel_names),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
