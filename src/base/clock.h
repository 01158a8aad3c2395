#ifndef STYLUT_SRC_BASE_CLOCK_H
#define STYLUT_SRC_BASE_CLOCK_H

#include <time.h>

/* Milliseconds of a clock that only goes forward. */
static inline double sty_get_milliseconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

#endif
