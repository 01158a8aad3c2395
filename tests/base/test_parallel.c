#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "stylut/parallel.h"

static void test_threads(void **state) {
  (void)state;
  const int cores = (int)sysconf(_SC_NPROCESSORS_ONLN);
  for (int t = 1; t <= 5; t++) assert_int_equal(sty_get_threads(&(StyRun){.threads = t}), t);
  /* A process may be confined to fewer cores than the machine has. */
  assert_in_range(sty_get_threads(NULL), 1, cores);
  assert_int_equal(sty_get_threads(&(StyRun){.threads = 0}), sty_get_threads(NULL));
}

static StyStatus count_call(void *context, long i, StyError *error) {
  (void)error;
  unsigned char *calls = context;
  calls[i]++; /* each item has its own byte */
  return STY_OK;
}

static void test_every_item_once(void **state) {
  (void)state;
  static const long counts[] = {0, 1, 2, 3, 7, 64, 1000, 100001};
  for (int threads = 0; threads <= 4; threads++) {
    const StyRun run = {.threads = threads};
    for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
      const long count = counts[c];
      unsigned char *calls = calloc((size_t)count + 1, 1);
      assert_non_null(calls);
      assert_int_equal(sty_parallel_for(&run, count, count_call, calls, NULL), STY_OK);
      for (long i = 0; i < count; i++) assert_int_equal(calls[i], 1);
      assert_int_equal(calls[count], 0);
      free(calls);
    }
  }
  unsigned char calls[10] = {0};
  assert_int_equal(sty_parallel_for(NULL, 10, count_call, calls, NULL), STY_OK);
  for (int i = 0; i < 10; i++) assert_int_equal(calls[i], 1);
}

typedef struct Failing {
  long first, second; /* items that fail */
  int slow;           /* the first of them takes its time */
} Failing;

static StyStatus fail_some(void *context, long i, StyError *error) {
  const Failing *failing = context;
  if (i == failing->first) {
    if (failing->slow) usleep(2000);
    return sty_fail(error, STY_ERROR_INPUT, "item %ld", i);
  }
  if (i == failing->second) return sty_fail(error, STY_ERROR_FILE, "item %ld", i);
  return STY_OK;
}

/* The message is that of the lowest item, even when a higher one fails earlier. */
static void test_lowest_failure(void **state) {
  (void)state;
  for (int threads = 1; threads <= 4; threads++) {
    const StyRun run = {.threads = threads};
    for (int trial = 0; trial < 30; trial++) {
      Failing failing = {.first = 3 + trial, .second = 4 + trial + trial % 7, .slow = trial % 2};
      StyError error = {STY_OK, ""};
      char expected[32];
      snprintf(expected, sizeof expected, "item %ld", failing.first);
      assert_int_equal(sty_parallel_for(&run, 80, fail_some, &failing, &error), STY_ERROR_INPUT);
      assert_int_equal(error.status, STY_ERROR_INPUT);
      assert_string_equal(error.text, expected);
      assert_int_equal(sty_parallel_for(&run, 80, fail_some, &failing, NULL), STY_ERROR_INPUT);
    }
  }
}

static void test_last_item_fails(void **state) {
  (void)state;
  Failing failing = {.first = 999, .second = -1, .slow = 0};
  for (int threads = 1; threads <= 3; threads++)
    assert_int_equal(sty_parallel_for(&(StyRun){.threads = threads}, 1000, fail_some, &failing, NULL), STY_ERROR_INPUT);
}

typedef struct Watch {
  int calls, inside, overlaps;
  double last;
  int outside_range;
} Watch;

static void watch_progress(void *context, double done) {
  Watch *watch = context;
  if (__atomic_fetch_add(&watch->inside, 1, __ATOMIC_SEQ_CST)) watch->overlaps++;
  watch->calls++;
  if (!(done >= 0 && done <= 1)) watch->outside_range++;
  watch->last = done;
  __atomic_fetch_sub(&watch->inside, 1, __ATOMIC_SEQ_CST);
}

static StyStatus do_little(void *context, long i, StyError *error) {
  (void)context;
  (void)error;
  if (i % 64 == 0) usleep(100);
  return STY_OK;
}

static void test_progress(void **state) {
  (void)state;
  for (int threads = 1; threads <= 4; threads++) {
    Watch watch = {0};
    const StyRun run = {.threads = threads, .progress = watch_progress, .context = &watch};
    assert_int_equal(sty_parallel_for(&run, 4000, do_little, NULL, NULL), STY_OK);
    assert_int_equal(watch.overlaps, 0);
    assert_int_equal(watch.outside_range, 0);
    assert_true(watch.calls >= 1);
  }
}

/* Between a sleep and what surrounds it by another clock. */
static void test_clock(void **state) {
  (void)state;
  struct timespec outer[2];
  clock_gettime(CLOCK_MONOTONIC, &outer[0]);
  const double begin = sty_get_milliseconds();
  usleep(3000);
  const double inner = sty_get_milliseconds() - begin;
  clock_gettime(CLOCK_MONOTONIC, &outer[1]);
  assert_true(inner >= 3);
  assert_true(inner <= difftime(outer[1].tv_sec, outer[0].tv_sec) * 1e3 +
                           (double)(outer[1].tv_nsec - outer[0].tv_nsec) * 1e-6 + 1e-3);
}

/* Works for `seconds` at a rate, in steps of a tenth of a second, from where the pace is; what it says at the end. */
static double work_on(StyPace *pace, double *now, double *done, double rate, double seconds) {
  double left = -1;
  for (int step = 0; step < seconds * 10; step++) {
    *now += 100;
    *done += rate / 10;
    left = sty_keep_pace(pace, *now, *done);
  }
  return left / 1000;
}

static void expect_about(double found, double expected) {
  if (!(fabs(found - expected) <= 0.15 * expected)) fail_msg("found %g s left, expected about %g", found, expected);
}

static void test_pace(void **state) {
  (void)state;
  double now = 5e6, done = 0;
  StyPace pace = sty_begin_pace(now);
  assert_true(work_on(&pace, &now, &done, 0.01, 0.9) < 0); /* too early to say */
  expect_about(work_on(&pace, &now, &done, 0.01, 9.1), 90);
  expect_about(work_on(&pace, &now, &done, 0.01, 40), 50);
  /* Four times as slow from here on: it is soon noticed. By the mean rate of all of it 59 s would be left. */
  expect_about(work_on(&pace, &now, &done, 0.0025, 60), 140);
  /* Nothing arrives for a while: the time goes on, and never below 0. */
  const double before = sty_keep_pace(&pace, now, done);
  assert_true(sty_keep_pace(&pace, now + 50, done) == before - 50);
  assert_true(sty_keep_pace(&pace, now + 1e7, 1) >= 0);
}

/* Two results that arrive together are no reason to think that all goes fast. */
static void test_pace_of_bursts(void **state) {
  (void)state;
  StyPace pace = sty_begin_pace(0);
  double left = -1;
  for (int i = 1; i <= 20; i++) {
    sty_keep_pace(&pace, 1000 * i, (2 * i - 1) / 100.0);
    left = sty_keep_pace(&pace, 1000 * i + 1, 2 * i / 100.0);
  }
  expect_about(left / 1000, 30);
}

static void note_stage(void *context, const char *name) { *(const char **)context = name; }

static void test_shares_and_stages(void **state) {
  (void)state;
  Watch watch = {0};
  const StyRun whole = {.threads = 3, .progress = watch_progress, .context = &watch};
  StyShare share = {&whole, 0.25, 0.5};
  const StyRun part = sty_share_run(&share);
  assert_int_equal(part.threads, 3);
  part.progress(part.context, 0.5);
  assert_true(watch.last == 0.5);
  part.progress(part.context, 1);
  assert_true(watch.last == 0.75);
  StyShare of_none = {NULL, 0, 1};
  assert_null(sty_share_run(&of_none).progress);
  const char *name = NULL;
  sty_begin_stage(&(StyRun){.stage = note_stage, .context = (void *)&name}, "reading");
  assert_string_equal(name, "reading");
  sty_begin_stage(NULL, "building");
  sty_begin_stage(&whole, "building");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_threads),        cmocka_unit_test(test_every_item_once),
      cmocka_unit_test(test_lowest_failure), cmocka_unit_test(test_last_item_fails),
      cmocka_unit_test(test_progress),       cmocka_unit_test(test_pace),
      cmocka_unit_test(test_pace_of_bursts), cmocka_unit_test(test_shares_and_stages),
      cmocka_unit_test(test_clock),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
