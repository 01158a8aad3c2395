/* Memory for large arrays. */
#ifndef STYLUT_SRC_BASE_MEMORY_H
#define STYLUT_SRC_BASE_MEMORY_H

#include <stddef.h>

/* Uninitialized, to be freed with free(); NULL when memory is short. Asks for
 * huge pages: handing out small ones is a third of the time that building the
 * table of an 8-bit guide takes, and a tenth of that of tracing a guide. */
void *sty_allocate_large(size_t bytes);

/* Addresses that this process holds, in bytes, and those that it may still ask for: HUGE_VAL where nothing limits them
 * (ulimit -v). Libraries that end the process where memory is short aren't called without room. */
double sty_get_held_addresses(void);
double sty_get_address_room(void);

/* What a thread takes of it: its stack, and its part of malloc's memory. */
#define STY_THREAD_ADDRESSES 80e6

#endif
