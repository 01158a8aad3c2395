/* Other programs, beside this one. */
#ifndef STYLUT_TOOLS_SPAWN_H
#define STYLUT_TOOLS_SPAWN_H

#include <sys/types.h>

/* Starts a program of PATH, words[0], with these words (NULL behind the last) and descriptors; signals are heeded as by
 * default, none blocked. Its descriptors beyond the three are those without close-on-exec. 0, or the error's number. */
int spawn_program(const char *const *words, int in, int out, int said, pid_t *child);

#endif
