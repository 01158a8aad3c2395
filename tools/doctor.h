/* The self-check of `stylut doctor`. */
#ifndef STYLUT_TOOLS_DOCTOR_H
#define STYLUT_TOOLS_DOCTOR_H

#include "options.h"

typedef struct Check {
  const char *name, *what; /* "tables", "every exact engine gives the same" */
  StyStatus (*run)(const char *folder, StyError *error);
} Check;

/* NULL behind the last. Each works with files of a folder of its own; what is wrong is its error. */
extern const Check checks[];

#endif
