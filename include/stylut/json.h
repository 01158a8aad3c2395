/* JSON files that people write: read strictly, and complained about with line
 * and column. Jansson parses; it forgets where a value stood, so the place is
 * looked up in the text again when a message needs it. */
#ifndef STYLUT_JSON_H
#define STYLUT_JSON_H

#include <jansson.h>
#include <stddef.h>

#include "stylut/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct StyDocument {
  char *name; /* as given, for messages */
  char *text;
  json_t *root; /* an object */
} StyDocument;

/* Reads a file of at most 16 MiB. A UTF-8 byte order mark is passed over. Duplicate
 * keys, anything behind the value and a root that isn't an object are errors. STY_ERROR_FILE, STY_ERROR_INPUT. */
StyStatus sty_read_document(const char *path, StyDocument *out, StyError *error);
void sty_close_document(StyDocument *document);

/* Writes indented JSON with a newline behind it; reals have nine digits. The file appears whole or not at all.
 * STY_ERROR_FILE, STY_ERROR_LIBRARY. */
StyStatus sty_write_json(const char *path, const json_t *value, StyError *error);

/* A place inside a document: the way to a value from the root. */
typedef struct StyPath {
  const struct StyPath *parent; /* NULL for the root's own path */
  const char *key;              /* or NULL: */
  size_t index;
} StyPath;

/* The way there, as "objects[2].mesh", nothing for NULL; and with where that stands, as
 * "shot.json:12:15: objects[2].mesh", for what is wrong with something else that a value names. What doesn't fit is cut
 * off. */
#define STY_PLACE_SIZE 1024
void sty_name_path(const StyPath *path, char *out, size_t size);
void sty_name_place(const StyDocument *document, const StyPath *path, char *out, size_t size);

/* STY_ERROR_INPUT "FILE:LINE:COLUMN: KEY: found ..., expected EXPECTED" for the
 * value at `path` (NULL: the root). */
StyStatus sty_fail_value(const StyDocument *document, const StyPath *path, const json_t *found, const char *expected,
                         StyError *error);

/* The same, with what was found in words. */
StyStatus sty_fail_found(const StyDocument *document, const StyPath *path, const char *found, const char *expected,
                         StyError *error);

/* Refuses keys of the object at `path` that aren't in the NULL-terminated list. */
StyStatus sty_check_keys(const StyDocument *document, const StyPath *path, const json_t *object,
                         const char *const *known, StyError *error);

/* Typed values of an object, by key. A missing key leaves *out as it is, unless
 * `required`. Strings stay owned by the document. */
StyStatus sty_get_string(const StyDocument *document, const StyPath *path, const json_t *object, const char *key,
                         int required, const char **out, StyError *error);
StyStatus sty_get_number(const StyDocument *document, const StyPath *path, const json_t *object, const char *key,
                         double minimum, double maximum, double *out, StyError *error);
StyStatus sty_get_integer(const StyDocument *document, const StyPath *path, const json_t *object, const char *key,
                          int minimum, int maximum, int *out, StyError *error);

/* `count` of them, each finite and within the bounds. */
StyStatus sty_get_numbers(const StyDocument *document, const StyPath *path, const json_t *object, const char *key,
                          double minimum, double maximum, int count, double *out, StyError *error);

/* One of a NULL-terminated list of words, by its index. */
StyStatus sty_get_choice(const StyDocument *document, const StyPath *path, const json_t *object, const char *key,
                         const char *const *words, int *out, StyError *error);

#ifdef __cplusplus
}
#endif
#endif
