/* Whole files: read, hashed, and written so that they appear complete or not
 * at all. */
#ifndef STYLUT_FILE_H
#define STYLUT_FILE_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <sys/types.h>

#include "stylut/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A file in the making: a temporary beside its final path. */
typedef struct StyOutput {
  FILE *stream; /* write here */
  char *path;   /* final name */
  char *temporary;
} StyOutput;

/* Begins `path`. STY_ERROR_FILE when its folder is missing or not writable,
 * STY_ERROR_USAGE for an empty name. */
StyStatus sty_open_output(const char *path, StyOutput *out, StyError *error);

/* Checks that all that was written so far has arrived (full disk). */
StyStatus sty_flush_output(StyOutput *output, StyError *error);

/* Writes `size` bytes at `offset`, around the stream: what is to be before them was flushed. From any thread. */
StyStatus sty_place_output(const StyOutput *output, uint64_t offset, const void *bytes, size_t size, StyError *error);

/* Flushes, checks every earlier write, and renames into place. On failure
 * the temporary is removed. Either way *output is spent. */
StyStatus sty_commit_output(StyOutput *output, StyError *error);

/* Removes the temporary; does nothing on a spent or zeroed output. */
void sty_discard_output(StyOutput *output);

/* A new folder beside `path`, for what is in the making there; the caller frees its name. STY_ERROR_FILE,
 * STY_ERROR_LIBRARY. */
StyStatus sty_make_temporary_folder(const char *path, char **out, StyError *error);

/* renameat2 of a temporary to its final name; 0, or -1 and errno. With RENAME_EXCHANGE the temporary's name stays in
 * use, for what was there, until it is forgotten. */
int sty_rename_temporary(const char *temporary, const char *path, unsigned flags);

/* After a temporary was removed; and for a folder of files, both. */
void sty_forget_temporary(const char *temporary);
void sty_remove_temporary_folder(const char *temporary);

/* From now on SIGINT, SIGTERM and SIGHUP remove what is in the making before they end the program; for the beginning of
 * main, before there are other threads. Children inherit that these signals are blocked: they unblock them. SIGPIPE and
 * SIGXFSZ become errors of writing. */
void sty_clean_up_when_ended(void);

/* A process that those signals end together with this one, by SIGTERM; 0: none any more. */
void sty_end_together(pid_t process);

/* Checks that `path` is a file one can read; says which of missing, a folder,
 * no permission it is otherwise. `size` may be NULL. */
StyStatus sty_check_file(const char *path, uint64_t *size, StyError *error);

/* The whole file, with a NUL behind it that `size` does not count. The caller
 * frees it. Files over `limit` bytes are refused (STY_ERROR_INPUT). */
StyStatus sty_read_file(const char *path, size_t limit, unsigned char **data, size_t *size, StyError *error);

/* A file mapped read-only into memory, for reading bundles in place. */
typedef struct StyMapping {
  const unsigned char *data;
  size_t size;
} StyMapping;
StyStatus sty_map_file(const char *path, StyMapping *out, StyError *error);
void sty_unmap_file(StyMapping *mapping);

/* Part of a mapping that was looked at and isn't wanted for now: its memory is given back, and what it holds comes from
 * the file again when it is looked at the next time. */
void sty_rest_mapped(const void *part, size_t size);

/* SHA-256 in lower-case hexadecimal. */
#define STY_HASH_SIZE 65
void sty_hash_bytes(const void *data, size_t size, char out[STY_HASH_SIZE]);
StyStatus sty_hash_file(const char *path, char out[STY_HASH_SIZE], StyError *error);

/* folder joined with name, unless name is absolute; the folder that holds path
 * ("." for a bare name). The caller frees them; NULL
 * when memory is short. */
char *sty_join_path(const char *folder, const char *name);
char *sty_get_folder(const char *path);

/* What follows the last slash, within `path`; all of it where nothing does. */
const char *sty_get_base_name(const char *path);

#ifdef __cplusplus
}
#endif
#endif
