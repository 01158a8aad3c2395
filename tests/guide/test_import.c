#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "stylut/guide.h"

static StyImage *make_picture(int width, int height, int bits, int count, const char *const *names) {
  StyImage *image = NULL;
  assert_int_equal(sty_create_image(width, height, count, names, bits, &image, NULL), STY_OK);
  return image;
}

static void expect_refusal(StyImage *image, const char *text) {
  StyImage *before = image;
  StyError error = {STY_OK, ""};
  assert_int_equal(sty_import_guide("some.png", &image, &error), STY_ERROR_INPUT);
  assert_ptr_equal(image, before);
  if (!strstr(error.text, "some.png") || !strstr(error.text, text)) fail_msg("'%s' lacks '%s'", error.text, text);
  sty_destroy_image(&image);
}

/* Every integer gives exactly (2b - top)/top. */
static void expect_exact_integers(int bits, int top) {
  StyImage *image = make_picture(256, (top + 1) / 256, bits, 4, (const char *const[]){"R", "G", "B", "A"});
  for (int b = 0; b <= top; b++) {
    for (int c = 0; c < 3; c++) sty_find_channel(image, c == 0 ? "R" : c == 1 ? "G" : "B")[b] = (float)b / (float)top;
    sty_find_channel(image, "A")[b] = b % 2 ? 1.0f / (float)top : 0;
  }
  assert_int_equal(sty_import_guide("some.png", &image, NULL), STY_OK);
  assert_int_equal(image->bits, bits);
  assert_int_equal(image->channel_count, 4);
  for (int b = 0; b <= top; b++) {
    const float expected = b % 2 ? (float)(2 * b - top) / (float)top : 0;
    assert_true(sty_find_channel(image, "A")[b] == (b % 2 ? 1.0f / (float)top : 0));
    assert_true(sty_find_channel(image, "normal.X")[b] == expected);
    assert_true(sty_find_channel(image, "normal.Z")[b] == expected);
  }
  sty_destroy_image(&image);
}

static void test_integers(void **state) {
  (void)state;
  expect_exact_integers(8, 255);
  expect_exact_integers(16, 65535);
}

static void test_black_is_background(void **state) {
  (void)state;
  StyImage *image = make_picture(2, 1, 8, 3, (const char *const[]){"R", "G", "B"});
  sty_find_channel(image, "B")[1] = 1;
  assert_int_equal(sty_set_attribute(image, "stylut:seed", "7", NULL), STY_OK);
  assert_int_equal(sty_import_guide("some.png", &image, NULL), STY_OK);
  assert_true(sty_find_channel(image, "A")[0] == 0 && sty_find_channel(image, "A")[1] == 1);
  assert_true(sty_find_channel(image, "normal.X")[0] == 0 && sty_find_channel(image, "normal.X")[1] == -1);
  assert_true(sty_find_channel(image, "normal.Z")[1] == 1);
  assert_string_equal(sty_find_attribute(image, "stylut:seed"), "7");
  sty_destroy_image(&image);
}

static void test_named_normals(void **state) {
  (void)state;
  static const char *const NAMES[] = {"normal.X", "normal.Y", "normal.Z", "depth.Z", "style.I", "object.I", "R"};
  StyImage *image = make_picture(3, 1, 32, 7, NAMES);
  sty_find_channel(image, "normal.Z")[1] = 0.3f;
  sty_find_channel(image, "depth.Z")[1] = 5;
  sty_find_channel(image, "style.I")[1] = 2;
  sty_find_channel(image, "object.I")[2] = 9;
  assert_int_equal(sty_import_guide("some.exr", &image, NULL), STY_OK);
  assert_int_equal(image->channel_count, 7);
  assert_int_equal(image->bits, 32);
  assert_true(sty_find_channel(image, "A")[0] == 0 && sty_find_channel(image, "A")[1] == 1);
  assert_true(sty_find_channel(image, "normal.Z")[1] == 0.3f);
  assert_true(sty_find_channel(image, "depth.Z")[1] == 5 && sty_find_channel(image, "style.I")[1] == 2);
  assert_true(sty_find_channel(image, "object.I")[2] == 9);
  sty_destroy_image(&image);
}

static void test_empty_guides_pass(void **state) {
  (void)state;
  StyImage *image = make_picture(3, 3, 8, 4, (const char *const[]){"R", "G", "B", "A"});
  assert_int_equal(sty_import_guide("some.png", &image, NULL), STY_OK);
  sty_destroy_image(&image);
}

static void test_no_normals(void **state) {
  (void)state;
  expect_refusal(make_picture(2, 2, 8, 1, (const char *const[]){"Y"}), "no normals");
  expect_refusal(make_picture(2, 2, 16, 2, (const char *const[]){"Y", "A"}), "no normals");
  expect_refusal(make_picture(2, 2, 32, 3, (const char *const[]){"R", "G", "B"}), "no normals");
  expect_refusal(make_picture(2, 2, 32, 3, (const char *const[]){"A", "normal.X", "normal.Y"}), "no normals");
}

static void test_non_finite_normals(void **state) {
  (void)state;
  static const char *const NAMES[] = {"normal.X", "normal.Y", "normal.Z", "A"};
  StyImage *image = make_picture(4, 3, 32, 4, NAMES);
  sty_find_channel(image, "normal.Y")[6] = NAN;
  sty_find_channel(image, "normal.Y")[5] = INFINITY;
  sty_find_channel(image, "A")[6] = 1;
  expect_refusal(image, "(2, 1)");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_integers),      cmocka_unit_test(test_black_is_background),
      cmocka_unit_test(test_named_normals), cmocka_unit_test(test_empty_guides_pass),
      cmocka_unit_test(test_no_normals),    cmocka_unit_test(test_non_finite_normals),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
