#include "stylut/parallel.h"

#include <omp.h>
#include <time.h>

int sty_get_threads(const StyRun *run) {
  const int threads = run && run->threads > 0 ? run->threads : omp_get_num_procs();
  return threads < 1 ? 1 : threads;
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
