/* How long work is run: threads, progress, and the time it takes. */
#ifndef STYLUT_PARALLEL_H
#define STYLUT_PARALLEL_H

#include "stylut/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct StyRun {
  int threads; /* 1 or more; 0 means one per core */
  /* Called now and then with the share done (0..1), from one thread at a
   * time; NULL for none. */
  void (*progress)(void *context, double done);
  void *context;
} StyRun;

/* The number of threads `run` (NULL: one per core) asks for. */
int sty_get_threads(const StyRun *run);

/* Milliseconds of a clock that only goes forward; what counts is the difference. */
double sty_get_milliseconds(void);

/* Calls body(context, i, error) for every i in 0..count-1, in any order, on the
 * threads of `run`. Which thread does what must not change the result. Returns
 * the failure of the lowest i, so that messages don't depend on timing; once
 * an item has failed, items not yet begun are skipped. */
StyStatus sty_parallel_for(const StyRun *run, long count, StyStatus (*body)(void *context, long i, StyError *error),
                           void *context, StyError *error);

#ifdef __cplusplus
}
#endif
#endif
