/* Memory for large arrays. */
#ifndef STYLUT_SRC_BASE_MEMORY_H
#define STYLUT_SRC_BASE_MEMORY_H

#include <stddef.h>

/* Uninitialized, to be freed with free(); NULL when memory is short. Asks for
 * huge pages: handing out small ones is a third of the time that building the
 * table of an 8-bit guide takes, and a tenth of that of tracing a guide. */
void *sty_allocate_large(size_t bytes);

#endif
