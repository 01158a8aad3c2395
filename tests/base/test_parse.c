#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "stylut/parse.h"

/* The message says which option, what was found and what was expected. */
static void expect_usage(StyStatus status, const StyError *error, const char *found) {
  if (status != STY_ERROR_USAGE) fail_msg("'%s' gives status %d", found, status);
  assert_int_equal(error->status, STY_ERROR_USAGE);
  if (!strstr(error->text, "--what")) fail_msg("'%s' doesn't name the option", error->text);
  if (!strstr(error->text, found)) fail_msg("'%s' doesn't quote '%s'", error->text, found);
}

static void test_integers(void **state) {
  (void)state;
  static const struct {
    const char *text;
    long long value;
  } good[] = {{"0", 0},
              {"7", 7},
              {"-7", -7},
              {"007", 7},
              {"9223372036854775807", INT64_MAX},
              {"-9223372036854775808", INT64_MIN},
              {"123456789", 123456789}};
  for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
    long long value = 42;
    StyError error;
    if (sty_parse_integer("--what", good[i].text, INT64_MIN, INT64_MAX, &value, &error) != STY_OK)
      fail_msg("'%s': %s", good[i].text, error.text);
    assert_true(value == good[i].value);
  }
}

static void test_bad_integers(void **state) {
  (void)state;
  static const char *const bad[] = {"",
                                    " ",
                                    " 1",
                                    "1 ",
                                    "1x",
                                    "x",
                                    "1.0",
                                    "1e3",
                                    "0x10",
                                    "--1",
                                    "1-",
                                    "1,000",
                                    "1_0",
                                    "\t1",
                                    "1\n",
                                    "nan",
                                    "inf",
                                    "-",
                                    "9223372036854775808",
                                    "-9223372036854775809",
                                    "99999999999999999999999999999"};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    long long value = 42;
    StyError error;
    const StyStatus status = sty_parse_integer("--what", bad[i], INT64_MIN, INT64_MAX, &value, &error);
    /* Control characters are shown as '?'. */
    expect_usage(status, &error, strpbrk(bad[i], "\t\n") ? "1" : bad[i]);
    assert_true(value == 42);
  }
}

static void test_integer_range(void **state) {
  (void)state;
  for (int v = -5; v <= 15; v++) {
    char text[16];
    snprintf(text, sizeof text, "%d", v);
    long long value = 42;
    StyError error;
    const StyStatus status = sty_parse_integer("--what", text, -2, 10, &value, &error);
    if (v >= -2 && v <= 10) {
      assert_int_equal(status, STY_OK);
      assert_int_equal(value, v);
    } else {
      expect_usage(status, &error, text);
      assert_non_null(strstr(error.text, "-2"));
      assert_non_null(strstr(error.text, "10"));
      assert_int_equal(value, 42);
    }
  }
}

static void test_numbers(void **state) {
  (void)state;
  static const struct {
    const char *text;
    double value;
  } good[] = {{"0", 0},    {"1.5", 1.5},   {"-2.25", -2.25}, {"1e3", 1e3}, {"1E-3", 1e-3},
              {".5", 0.5}, {"100", 100.0}, {"-1e5", -1e5},   {"0.1", 0.1}, {"99999.999", 99999.999}};
  for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
    double value = 42;
    StyError error;
    if (sty_parse_number("--what", good[i].text, -1e6, 1e6, &value, &error) != STY_OK)
      fail_msg("'%s': %s", good[i].text, error.text);
    assert_true(value == good[i].value);
  }
}

static void test_bad_numbers(void **state) {
  (void)state;
  static const char *const bad[] = {"",       " ",      " 1",  "1 ",   "1x",       "x",   "1.0.0", "1,5", "nan",
                                    "NaN",    "-nan",   "inf", "-inf", "infinity", "INF", "1e",    "--1", "1e999",
                                    "-1e999", "nan(1)", "\n1", "1\t",  "e5",       ".",   "-"};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    double value = 42;
    StyError error;
    const StyStatus status = sty_parse_number("--what", bad[i], -HUGE_VAL, HUGE_VAL, &value, &error);
    expect_usage(status, &error, strpbrk(bad[i], "\t\n") ? "1" : bad[i]);
    assert_true(value == 42);
  }
}

static void test_number_range(void **state) {
  (void)state;
  StyError error;
  double value = 42;
  assert_int_equal(sty_parse_number("--what", "0.25", 0.25, 0.75, &value, &error), STY_OK);
  assert_true(value == 0.25);
  assert_int_equal(sty_parse_number("--what", "0.75", 0.25, 0.75, &value, &error), STY_OK);
  assert_true(value == 0.75);
  expect_usage(sty_parse_number("--what", "0.2499999", 0.25, 0.75, &value, &error), &error, "0.2499999");
  assert_non_null(strstr(error.text, "0.25"));
  assert_non_null(strstr(error.text, "0.75"));
  expect_usage(sty_parse_number("--what", "0.7500001", 0.25, 0.75, &value, &error), &error, "0.7500001");
  assert_true(value == 0.75);
}

static void test_sizes(void **state) {
  (void)state;
  static const struct {
    const char *text;
    int width, height;
  } good[] = {{"1", 1, 1}, {"512", 512, 512}, {"1920x1080", 1920, 1080}, {"1x4096", 1, 4096}, {"4096x1", 4096, 1}};
  for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
    int width = 0, height = 0;
    StyError error;
    if (sty_parse_size("--what", good[i].text, 4096, &width, &height, &error) != STY_OK)
      fail_msg("'%s': %s", good[i].text, error.text);
    assert_int_equal(width, good[i].width);
    assert_int_equal(height, good[i].height);
  }
  static const char *const bad[] = {"",
                                    "0",
                                    "0x5",
                                    "5x0",
                                    "-1",
                                    "-1x5",
                                    "5x-1",
                                    "5x",
                                    "x5",
                                    "x",
                                    "5x5x5",
                                    "5 x 5",
                                    " 5x5",
                                    "5x5 ",
                                    "4097",
                                    "4097x1",
                                    "1x4097",
                                    "5,5",
                                    "1e2",
                                    "5.0x5",
                                    "0x10x5",
                                    "99999999999999999999",
                                    "1x99999999999999999999",
                                    "5*5"};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    int width = 42, height = 43;
    StyError error;
    expect_usage(sty_parse_size("--what", bad[i], 4096, &width, &height, &error), &error, bad[i]);
    assert_int_equal(width, 42);
    assert_int_equal(height, 43);
  }
}

static void test_choices(void **state) {
  (void)state;
  static const char *const colours[] = {"red", "green", "blue", NULL};
  for (int i = 0; i < 3; i++) {
    int chosen = -1;
    assert_int_equal(sty_parse_choice("--what", colours[i], colours, &chosen, NULL), STY_OK);
    assert_int_equal(chosen, i);
  }
  static const char *const bad[] = {"", "Red", "re", "redd", "red ", " red", "yellow"};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    int chosen = 42;
    StyError error;
    expect_usage(sty_parse_choice("--what", bad[i], colours, &chosen, &error), &error, bad[i]);
    for (int c = 0; c < 3; c++) assert_non_null(strstr(error.text, colours[c]));
    assert_int_equal(chosen, 42);
  }
}

static void test_bytes(void **state) {
  (void)state;
  static const struct {
    const char *text;
    long long value;
  } good[] = {{"5", 5},
              {"1073741824", 1LL << 30},
              {"1K", 1024},
              {"3M", 3LL << 20},
              {"2G", 2LL << 30},
              {"007K", 7168},
              {"9223372036854775807", INT64_MAX},
              {"8589934591G", 8589934591LL << 30}};
  for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
    long long value = 42;
    StyError error;
    if (sty_parse_bytes("--what", good[i].text, 5, &value, &error) != STY_OK)
      fail_msg("'%s': %s", good[i].text, error.text);
    if (value != good[i].value) fail_msg("'%s' gives %lld", good[i].text, value);
  }
  static const char *const bad[] = {"",
                                    "4",
                                    "0K",
                                    "K",
                                    "-1K",
                                    "1k",
                                    "1T",
                                    "1.5G",
                                    "1KK",
                                    "1 K",
                                    "G1",
                                    "1e3",
                                    "8589934592G",
                                    "9223372036854775808",
                                    "000000000000000000000000000001"};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    long long value = 42;
    StyError error;
    expect_usage(sty_parse_bytes("--what", bad[i], 5, &value, &error), &error, bad[i]);
    assert_true(value == 42);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_integers), cmocka_unit_test(test_bad_integers), cmocka_unit_test(test_integer_range),
      cmocka_unit_test(test_numbers),  cmocka_unit_test(test_bad_numbers),  cmocka_unit_test(test_number_range),
      cmocka_unit_test(test_sizes),    cmocka_unit_test(test_choices),      cmocka_unit_test(test_bytes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
