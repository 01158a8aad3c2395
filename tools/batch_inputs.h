/* What a batch is made of, by content: each file from outside has a stamp in the work folder, "SHA-256  NAME" as
 * sha256sum prints it, which is only written anew when the file's content is another. Steps depend on stamps, so that
 * a file that was touched, or checked out again, costs nothing. */
#ifndef STYLUT_TOOLS_BATCH_INPUTS_H
#define STYLUT_TOOLS_BATCH_INPUTS_H

#include "pack.h"

/* A stamp's name: the folder's and 33 more. */
enum { STAMP_SIZE = 128 };
void name_stamp(const char *folder, const char *path, char out[STAMP_SIZE]);

/* What it holds; and whose it is, NULL where it isn't one. The caller frees both; NULL, too, when memory is short. */
char *format_stamp(const char *path, const char *hash);
char *read_stamp(const char *stamp);

/* Hashes a file and brings its stamp in `folder` up to date; its name goes to `stamp`. */
StyStatus stamp_input(const char *folder, const char *path, char stamp[STAMP_SIZE], StyError *error);

/* A file that holds this text already stays as it is, and keeps its time. */
StyStatus write_text(const char *path, const char *text, StyError *error);

/* What is known of files from the last time, so that what hasn't changed since isn't read again. */
typedef struct Inputs {
  Records records; /* looks here first */
  char *file;      /* where it is kept */
  json_t *known;   /* by path */
  json_t *fresh;   /* the same, of files that changed a moment ago: not kept */
  bool is_new;     /* something was learned */
} Inputs;

/* Hashes and measures pictures that aren't known, by all threads, so that it is done when they are asked for. */
void look_at_pictures(Inputs *inputs, char **paths, int count, const StyRun *run);

/* A file that is missing or isn't as it should be is as if nothing were known. */
StyStatus open_inputs(const char *file, Inputs *out, StyError *error);
StyStatus save_inputs(Inputs *inputs, StyError *error);
void close_inputs(Inputs *inputs);

#endif
