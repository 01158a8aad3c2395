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
  /* Called where another stage of the work begins, whose progress starts at 0: its name, a word that outlives the run;
   * NULL for none. */
  void (*stage)(void *context, const char *name);
  void *context;
} StyRun;

/* Part of a run (NULL: one per core), whose progress goes from `begin` to `begin` + `part` of the whole's. */
typedef struct StyShare {
  const StyRun *run;
  double begin, part; /* 0..1 */
} StyShare;

/* The run that such a part is done with, as long as `share` stays where it is. */
StyRun sty_share_run(StyShare *share);

/* Says that a stage begins. */
void sty_begin_stage(const StyRun *run, const char *name);

/* The number of threads `run` (NULL: one per core) asks for. */
int sty_get_threads(const StyRun *run);

/* How fast work goes. Where it is uneven, what it did lately counts: the last quarter of its time for about two thirds.
 */
typedef struct StyPace {
  double start, then; /* ms */
  double done;        /* at `then`, 0..1 */
  double rate;        /* per ms; 0: not known */
} StyPace;

StyPace sty_begin_pace(double now);

/* Milliseconds that the rest will take when `done` (0..1) is done; negative where it is too early to say. */
double sty_keep_pace(StyPace *pace, double now, double done);

/* Milliseconds of a clock that only goes forward; what counts is the difference. */
double sty_get_milliseconds(void);

/* Where addresses are limited (ulimit -v), takes what the calling thread's stack may grow by, as one that can't grow
 * ends the process without a word. For the beginning of a program. STY_ERROR_LIBRARY: there isn't room even for that.
 */
StyStatus sty_claim_stack(StyError *error);

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
