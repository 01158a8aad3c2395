#include "stylut/parallel.h"

#include <math.h>
#include <omp.h>
#include <time.h>

#include "base/memory.h"

int sty_get_threads(const StyRun *run) {
  const int threads = run && run->threads > 0 ? run->threads : omp_get_num_procs();
  /* OpenMP ends the process where a thread finds no room; half of it is left to the work. */
  const double room = sty_get_address_room() / (2 * STY_THREAD_ADDRESSES);
  return threads < 1 || room < 1 ? 1 : room < threads ? (int)room : threads;
}

static void report_share(void *context, double done) {
  const StyShare *share = context;
  const double whole = share->begin + done * share->part; /* rounding may take the last part beyond 1 */
  share->run->progress(share->run->context, whole < 1 ? whole : 1);
}

StyRun sty_share_run(StyShare *share) {
  const StyRun *run = share->run;
  return (StyRun){
      .threads = sty_get_threads(run), .progress = run && run->progress ? report_share : NULL, .context = share};
}

void sty_begin_stage(const StyRun *run, const char *name) {
  if (run && run->stage) run->stage(run->context, name);
}

/* Work is looked at so long, ms, before it is judged, and after that each time this much has gone by. */
static const double FIRST_LOOK = 1000, LOOK = 100;

StyPace sty_begin_pace(double now) { return (StyPace){.start = now, .then = now}; }

double sty_keep_pace(StyPace *pace, double now, double done) {
  const double passed = now - pace->then, elapsed = now - pace->start;
  if (passed >= LOOK && elapsed >= FIRST_LOOK) {
    const double rate = (done - pace->done) / passed, weight = 1 - exp(-passed / (elapsed / 4));
    pace->rate += (pace->rate > 0 ? weight : 1) * (rate - pace->rate);
    pace->then = now;
    pace->done = done;
  }
  const double left = pace->rate > 0 ? (1 - pace->done) / pace->rate - (now - pace->then) : -1;
  return pace->rate > 0 && left < 0 ? 0 : left;
}

double sty_get_milliseconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

StyStatus sty_parallel_for(const StyRun *run, long count, StyStatus (*body)(void *context, long i, StyError *error),
                           void *context, StyError *error) {
  long failed = count; /* lowest item that failed */
  StyError first = {STY_OK, ""};
  long done = 0;
#pragma omp parallel for schedule(dynamic, 1) num_threads(sty_get_threads(run)) if (count > 1)
  for (long i = 0; i < count; i++) {
    long known;
#pragma omp atomic read
    known = failed;
    /* Items are handed out in order, so every item below a failed one runs. */
    if (i > known) continue;
    StyError own = {STY_OK, ""};
    const StyStatus status = body(context, i, &own);
#pragma omp critical(sty_parallel_for)
    {
      done++;
      if (status != STY_OK && i < failed) {
#pragma omp atomic write
        failed = i;
        first = own;
        first.status = status;
      }
      if (run && run->progress) run->progress(run->context, (double)done / (double)count);
    }
  }
  if (first.status != STY_OK && error) *error = first;
  return first.status;
}

enum { STACK = 2 << 20, PAGE = 4096 };

/* Not inlined, so that its room is given back to those that come after. */
static __attribute__((noinline)) void touch_stack(void) {
  volatile char room[STACK];
  for (size_t i = 0; i < STACK; i += PAGE) room[i] = 0;
  (void)room[0];
}

StyStatus sty_claim_stack(StyError *error) {
  const double room = sty_get_address_room();
  if (isinf(room)) return STY_OK;
  if (room < 2.0 * STACK)
    return sty_fail(error, STY_ERROR_LIBRARY, "found %.1f MB of addresses left, expected 4 or more (ulimit -v)",
                    room / 1e6);
  touch_stack();
  return STY_OK;
}
