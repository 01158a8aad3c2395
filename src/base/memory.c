#include "base/memory.h"

#include <stdlib.h>
#include <sys/mman.h>

enum { HUGE_PAGE = 1 << 21 };

void *sty_allocate_large(size_t bytes) {
  if (bytes < HUGE_PAGE / 2) return malloc(bytes ? bytes : 1);
  const size_t whole = (bytes + HUGE_PAGE - 1) / HUGE_PAGE * HUGE_PAGE;
  void *memory = whole < bytes ? NULL : aligned_alloc(HUGE_PAGE, whole);
  if (memory) madvise(memory, whole, MADV_HUGEPAGE); /* a wish: whether it comes true changes the time alone */
  return memory;
}
