#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

enum { HUGE_PAGE = 1 << 21 };

void *sty_allocate_large(size_t bytes) {
  if (bytes < HUGE_PAGE / 2) return malloc(bytes ? bytes : 1);
  const size_t whole = (bytes + HUGE_PAGE - 1) / HUGE_PAGE * HUGE_PAGE;
  void *memory = whole < bytes ? NULL : aligned_alloc(HUGE_PAGE, whole);
  if (memory) madvise(memory, whole, MADV_HUGEPAGE); /* a wish: whether it comes true changes the time alone */
  return memory;
}

double sty_get_held_addresses(void) {
  FILE *file = fopen("/proc/self/statm", "r");
  unsigned long pages = 0;
  if (file && fscanf(file, "%lu", &pages) != 1) pages = 0;
  if (file) fclose(file);
  return (double)pages * (double)sysconf(_SC_PAGESIZE);
}

double sty_get_address_room(void) {
  struct rlimit found;
  if (getrlimit(RLIMIT_AS, &found) != 0 || found.rlim_cur == RLIM_INFINITY) return HUGE_VAL;
  return fmax((double)found.rlim_cur - sty_get_held_addresses(), 0);
}
