#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "stylut/status.h"

static void test_exit_codes(void **state) {
  (void)state;
  /* Scripts rely on these numbers. */
  assert_int_equal(STY_OK, 0);
  assert_int_equal(STY_ERROR_USAGE, 1);
  assert_int_equal(STY_ERROR_FILE, 2);
  assert_int_equal(STY_ERROR_INPUT, 3);
  assert_int_equal(STY_ERROR_LIBRARY, 4);
  assert_int_equal(STY_ERROR_UNAVAILABLE, 5);
  assert_int_equal(STY_CHECK_FAILED, 6);
  assert_int_equal(STY_FILES_DIFFER, 7);
}

static void test_message(void **state) {
  (void)state;
  StyError error;
  memset(&error, 'x', sizeof error);
  assert_int_equal(sty_fail(&error, STY_ERROR_INPUT, "%s: %d of %d", "a.png", 3, 7), STY_ERROR_INPUT);
  assert_int_equal(error.status, STY_ERROR_INPUT);
  assert_string_equal(error.text, "a.png: 3 of 7");
}

static void test_without_error(void **state) {
  (void)state;
  assert_int_equal(sty_fail(NULL, STY_ERROR_FILE, "%s", "text"), STY_ERROR_FILE);
  assert_int_equal(sty_fail_memory(NULL, "a table", 5), STY_ERROR_LIBRARY);
}

/* File names may hold anything; the message stays one line that a terminal can show. */
static void test_control_characters(void **state) {
  (void)state;
  for (int c = 1; c < 256; c++) {
    const char name[] = {'a', (char)c, 'b', 0};
    StyError error;
    sty_fail(&error, STY_ERROR_FILE, "%s", name);
    assert_int_equal(strlen(error.text), 3);
    char text[] = {'a', (char)c, 'b', 0};
    sty_clean_text(text);
    assert_string_equal(text, error.text);
    const int shown = (unsigned char)error.text[1];
    if (c < 32 || c == 127) {
      assert_int_equal(shown, '?');
    } else {
      assert_int_equal(shown, c); /* UTF-8 passes */
    }
  }
}

static void test_long_message(void **state) {
  (void)state;
  char name[5000];
  memset(name, 'n', sizeof name);
  name[sizeof name - 1] = 0;
  struct {
    StyError error;
    unsigned char guard[16];
  } boxed;
  memset(&boxed, 0xA5, sizeof boxed);
  assert_int_equal(sty_fail(&boxed.error, STY_ERROR_USAGE, "%s", name), STY_ERROR_USAGE);
  assert_true(strlen(boxed.error.text) < sizeof boxed.error.text);
  assert_true(strlen(boxed.error.text) > 1000);
  for (size_t i = 0; i < sizeof boxed.guard; i++) assert_int_equal(boxed.guard[i], 0xA5);
}

/* A message may well quote an earlier one, the same buffer included. */
static void test_quoting_itself(void **state) {
  (void)state;
  StyError error, earlier;
  sty_fail(&error, STY_ERROR_INPUT, "cause");
  earlier = error;
  sty_fail(&error, STY_ERROR_FILE, "while reading: %s", earlier.text);
  assert_string_equal(error.text, "while reading: cause");
  assert_int_equal(error.status, STY_ERROR_FILE);
}

static void test_memory(void **state) {
  (void)state;
  StyError error;
  assert_int_equal(sty_fail_memory(&error, "the frobnicator", 3e9), STY_ERROR_LIBRARY);
  assert_int_equal(error.status, STY_ERROR_LIBRARY);
  assert_non_null(strstr(error.text, "the frobnicator"));
  assert_int_equal(sty_fail_memory(&error, "x", 0), STY_ERROR_LIBRARY);
  assert_int_equal(sty_fail_memory(&error, "x", 1e300), STY_ERROR_LIBRARY);
  assert_true(strlen(error.text) < sizeof error.text);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_exit_codes),    cmocka_unit_test(test_message),
      cmocka_unit_test(test_without_error), cmocka_unit_test(test_control_characters),
      cmocka_unit_test(test_long_message),  cmocka_unit_test(test_quoting_itself),
      cmocka_unit_test(test_memory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
