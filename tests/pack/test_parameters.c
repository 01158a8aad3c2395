/* Parameters of styles by name: ranges, words, both ways. */
#include <math.h>

#include "../scratch.h"
#include "stylut/pack.h"

static const StyStyle plain = {
    .threshold = 24, .top_level = 6, .radius = 1, .layer_count = 1, .jitter_amount = 1, .scale = 1};

/* Every parameter takes its bounds, and nothing beyond; a refusal changes nothing. */
static void test_ranges(void **state) {
  (void)state;
  for (const StyParameter *p = sty_parameters; p->name; p++) {
    const double good[] = {p->minimum, p->maximum};
    const double bad[] = {p->minimum - 1, p->maximum * 1.01 + 1, NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 2; i++) {
      StyStyle style = plain;
      assert_true(sty_put_parameter(p, good[i], &style));
      assert_true(sty_get_parameter(p, &style) == good[i]);
    }
    for (int i = 0; i < 5; i++) {
      StyStyle style = plain;
      assert_false(sty_put_parameter(p, bad[i], &style));
      assert_memory_equal(&style, &plain, sizeof style);
    }
    StyStyle style = plain;
    assert_int_equal(sty_put_parameter(p, 0.75, &style), p->kind == STY_PARAMETER_NUMBER);
  }
}

/* What any style in range is described as sets it again, by text. */
static void test_values_are_as_people_write_them(void **state) {
  (void)state;
  for (const StyParameter *p = sty_parameters; p->name; p++) {
    StyStyle style = plain;
    if (p->kind != STY_PARAMETER_NUMBER) continue;
    assert_true(sty_put_parameter(p, 0.15, &style));
    assert_true(sty_get_parameter(p, &style) == 0.15);
  }
}

static void test_text(void **state) {
  (void)state;
  StyStyle style = plain, again = plain;
  style.threshold = 766, style.colour_weight = 0.1f, style.depth_tolerance = 1e-20f, style.scale = 0.5f;
  style.jitter_period = 65535, style.scatter = 64, style.flags = STY_FLAG_OBJECTS;
  json_t *described = sty_describe_parameters(&style), *value;
  const char *name;
  json_object_foreach(described, name, value) {
    char text[64];
    if (json_is_boolean(value))
      snprintf(text, sizeof text, "%s", json_is_true(value) ? "true" : "false");
    else
      snprintf(text, sizeof text, "%.9g", json_number_value(value));
    assert_int_equal(sty_set_parameter("set", name, text, &again, NULL), STY_OK);
  }
  json_decref(described);
  assert_memory_equal(&again, &style, sizeof style);
}

/* Flags that follow from textures are left alone. */
static void test_flags(void **state) {
  (void)state;
  StyStyle style = plain;
  style.flags = STY_FLAG_UNORM8 | STY_FLAG_BASE;
  assert_int_equal(sty_set_parameter("set", "objects", "true", &style, NULL), STY_OK);
  assert_int_equal(style.flags, STY_KNOWN_FLAGS);
  assert_int_equal(sty_set_parameter("set", "objects", "false", &style, NULL), STY_OK);
  assert_int_equal(style.flags, STY_FLAG_UNORM8 | STY_FLAG_BASE);
}

static void test_refusals(void **state) {
  (void)state;
  static const struct {
    const char *name, *text, *said;
  } cases[] = {{"thresholds", "1", "expected one of threshold"},
               {"", "1", "expected one of threshold"},
               {"radius", "", "a whole number from 0 to 8"},
               {"radius", "1.5", "a whole number from 0 to 8"},
               {"radius", "1 ", "a whole number from 0 to 8"},
               {"scale", "1.5", "0.5, 1 or 2"},
               {"objects", "1", "true or false"},
               {"objects", "True", "true or false"},
               {"luma_weight", "nan", "a number from 0 to 16"},
               {"flags", "1", "expected one of threshold"}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    StyStyle style = plain;
    StyError error = {STY_OK, ""};
    assert_int_equal(sty_set_parameter("set", cases[i].name, cases[i].text, &style, &error), STY_ERROR_USAGE);
    if (!strstr(error.text, cases[i].said)) fail_msg("%s=%s: %s", cases[i].name, cases[i].text, error.text);
    assert_memory_equal(&style, &plain, sizeof style);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_ranges), cmocka_unit_test(test_values_are_as_people_write_them),
      cmocka_unit_test(test_text), cmocka_unit_test(test_flags), cmocka_unit_test(test_refusals)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
