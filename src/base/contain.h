/* Work that may crash, hang or take all memory, in a process of its own: what libraries make of files that nobody has
 * checked. */
#ifndef STYLUT_BASE_CONTAIN_H
#define STYLUT_BASE_CONTAIN_H

#include <stdbool.h>
#include <stddef.h>

#include "stylut/status.h"

/* One end of the pipe between the two. */
typedef struct StyPipe StyPipe;

typedef struct StyContained {
  const char *name;                                  /* the file, for messages */
  const char *worker;                                /* who is contained, for messages: "the importer" */
  const char *more_seconds, *more_bytes;             /* what gives it more of either, for messages */
  double seconds, bytes;                             /* what the work may take; bytes beyond what is held now */
  StyStatus (*work)(void *context, StyError *error); /* in the child: leaves the result in the context */
  void (*send)(const void *context, StyPipe *pipe);  /* in the child, after success */
  StyStatus (*receive)(void *context, StyPipe *pipe, StyError *error); /* here: fills the context again */
  void *context;
  double peak_bytes; /* filled: the most memory that the child held */
} StyContained;

/* Returns what the work returned, with its message. STY_ERROR_INPUT where it crashed or took too long or too much
 * memory, STY_ERROR_LIBRARY where no process could be made. The child's output is thrown away. */
StyStatus sty_run_contained(StyContained *contained, StyError *error);

/* For `send`; a parent that is gone ends the child. */
void sty_send(StyPipe *pipe, const void *data, size_t size);

/* For `receive`: false when the child ended early or its time is over, which sty_run_contained then says. */
bool sty_receive(StyPipe *pipe, void *data, size_t size);

#endif
