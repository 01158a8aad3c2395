/* Numbered files: one frame, or a sequence by a pattern such as frame.%04d.exr. */
#ifndef STYLUT_TOOLS_SEQUENCE_H
#define STYLUT_TOOLS_SEQUENCE_H

#include "options.h"

/* Numbers of frames in rising order; a file that is no pattern is the one frame 0. */
typedef struct Sequence {
  bool is_pattern;
  int *numbers;
  int count, missing; /* missing: numbers asked for without a file */
} Sequence;

/* Whether a name has a place for a number, %d or %0Nd. Another % is an error, as are two places. */
StyStatus find_pattern(const char *option, const char *name, bool *out, StyError *error);

/* Refuses a name that has one, for what is one file: `expected` says of what. */
StyStatus refuse_pattern(const char *option, const char *name, const char *expected, StyError *error);

/* The name of one frame; NULL without memory. The caller frees it. */
char *name_frame(const char *pattern, int number);

/* The frames of `pattern`: those of `range` ("A-B", "A-BxSTEP"), or, where it is NULL, those on disk. Frames that have
 * no file are an error unless `skip_missing`. The caller frees the numbers. */
StyStatus list_frames(const char *pattern, const char *range, bool skip_missing, Sequence *out, StyError *error);

#endif
