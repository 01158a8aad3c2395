/* Work in a process of its own: what comes back, and what is said when nothing does. */
#include "base/contain.h"

#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "stylut/parallel.h"

typedef enum Deed { SUCCEED, REFUSE, CRASH, ABORT, HANG, LEAVE, PRINT, DEVOUR, CUT_SHORT, HANG_LATER } Deed;

typedef struct Job {
  Deed deed;
  size_t size;
  unsigned char *bytes;
  double peak_bytes;
} Job;

/* Seen, so that no compiler leaves the eating out. */
static char *volatile eaten;

static StyStatus devour(StyError *error) {
  for (size_t taken = 0; taken < (size_t)1 << 32; taken += 1 << 26) {
    char *memory = malloc(1 << 26);
    if (!memory) return sty_fail_memory(error, "the feast", 1 << 26);
    eaten = memory;
    memset(memory, 1, 1 << 26);
  }
  return STY_OK;
}

static StyStatus work(void *context, StyError *error) {
  Job *job = context;
  switch (job->deed) {
    case REFUSE: return sty_fail(error, STY_ERROR_USAGE, "found this, expected that");
    case CRASH: raise(SIGSEGV); break;
    case ABORT: abort();
    case HANG:
      for (;;) pause();
    case LEAVE: _exit(7);
    case DEVOUR: return devour(error);
    case PRINT: fprintf(stderr, "a library's noise\n"); break;
    default: break;
  }
  job->bytes = malloc(job->size);
  for (size_t i = 0; i < job->size; i++) job->bytes[i] = (unsigned char)(i * 7 + i / 251);
  return STY_OK;
}

static void send(const void *context, StyPipe *pipe) {
  const Job *job = context;
  sty_send(pipe, job->bytes, job->deed == CUT_SHORT || job->deed == HANG_LATER ? job->size / 2 : job->size);
  if (job->deed == HANG_LATER)
    for (;;) pause();
}

static StyStatus receive(void *context, StyPipe *pipe, StyError *error) {
  Job *job = context;
  job->bytes = malloc(job->size);
  return sty_receive(pipe, job->bytes, job->size) ? STY_OK : sty_fail(error, STY_ERROR_INPUT, "cut short");
}

static StyStatus run(Deed deed, size_t size, double seconds, Job *job, StyError *error) {
  *job = (Job){.deed = deed, .size = size};
  StyContained contained = {"some.file", "the worker", "more time", "more memory", seconds, 256e6,
                            work,        send,         receive,     job,           0};
  *error = (StyError){STY_OK, ""};
  const StyStatus status = sty_run_contained(&contained, error);
  job->peak_bytes = contained.peak_bytes;
  return status;
}

static void test_results_come_back(void **state) {
  (void)state;
  static const size_t sizes[] = {0, 1, 65536, 10000003};
  for (int s = 0; s < 4; s++)
    for (int noisy = 0; noisy <= 1; noisy++) {
      Job job;
      StyError error;
      assert_int_equal(run(noisy ? PRINT : SUCCEED, sizes[s], 60, &job, &error), STY_OK);
      for (size_t i = 0; i < job.size; i++) assert_int_equal(job.bytes[i], (unsigned char)(i * 7 + i / 251));
      assert_true(job.peak_bytes > (double)sizes[s] && job.peak_bytes < 1e9);
      free(job.bytes);
    }
}

static void expect_failure(Deed deed, double seconds, StyStatus status, const char *words) {
  Job job;
  StyError error;
  assert_int_equal(run(deed, 1 << 20, seconds, &job, &error), status);
  if (!strstr(error.text, words)) fail_msg("found '%s', expected '%s' in it", error.text, words);
  free(job.bytes);
}

static void test_failures_are_told(void **state) {
  (void)state;
  expect_failure(REFUSE, 60, STY_ERROR_USAGE, "found this, expected that");
  expect_failure(CRASH, 60, STY_ERROR_INPUT, "some.file: the worker crashed on it (signal 11)");
  expect_failure(ABORT, 60, STY_ERROR_INPUT, "(signal 6)");
  expect_failure(LEAVE, 60, STY_ERROR_INPUT, "some.file: the worker gave up");
  expect_failure(CUT_SHORT, 60, STY_ERROR_INPUT, "cut short");
}

static void test_time_is_limited(void **state) {
  (void)state;
  const double start = sty_get_milliseconds();
  expect_failure(HANG, 0.2, STY_ERROR_INPUT, "some.file: the worker was still at it after 0 s");
  expect_failure(HANG_LATER, 0.2, STY_ERROR_INPUT, "cut short");
  assert_true(sty_get_milliseconds() - start < 30000);
}

static void test_memory_is_limited(void **state) {
  (void)state;
#if defined(__SANITIZE_ADDRESS__)
  skip();
#else
  expect_failure(DEVOUR, 60, STY_ERROR_LIBRARY, "the feast");
#endif
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_results_come_back),
      cmocka_unit_test(test_failures_are_told),
      cmocka_unit_test(test_time_is_limited),
      cmocka_unit_test(test_memory_is_limited),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
