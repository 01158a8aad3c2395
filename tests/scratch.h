/* What file and table tests share beside the scratch folder: whole files,
 * folder trees, messages, and a random sequence that is the same everywhere. */
#ifndef STYLUT_TESTS_FILES_H
#define STYLUT_TESTS_FILES_H

#include <dirent.h>
#include <sys/stat.h>

#include "scene/scratch.h"
#include "stylut/image.h"

/* The path of `name` in the scratch folder; valid until the next use of *scratch. */
static inline const char *path_in(Scratch *scratch, const char *name) {
  snprintf(scratch->path, sizeof scratch->path, "%s/%s", scratch->folder, name);
  return scratch->path;
}

/* The whole file; the caller frees it. */
static inline unsigned char *read_bytes(const char *path, size_t *size) {
  FILE *file = fopen(path, "rb");
  if (!file) fail_msg("%s cannot be opened", path);
  fseek(file, 0, SEEK_END);
  *size = (size_t)ftell(file);
  rewind(file);
  unsigned char *bytes = malloc(*size + 1);
  assert_non_null(bytes);
  assert_int_equal(fread(bytes, 1, *size, file), *size);
  fclose(file);
  return bytes;
}

/* Entries of a folder; -1 when there is no such folder. */
static inline int count_entries(const char *path) {
  DIR *folder = opendir(path);
  if (!folder) return -1;
  int count = 0;
  for (const struct dirent *entry; (entry = readdir(folder)) != NULL;)
    if (strcmp(entry->d_name, ".") && strcmp(entry->d_name, "..")) count++;
  closedir(folder);
  return count;
}

/* Removes a file, or a folder with the plain files in it. */
static inline void remove_folder(const char *path) {
  char inside[2048];
  DIR *folder = opendir(path);
  if (folder) {
    for (const struct dirent *entry; (entry = readdir(folder)) != NULL;) {
      if (snprintf(inside, sizeof inside, "%s/%s", path, entry->d_name) < (int)sizeof inside) unlink(inside);
    }
    closedir(folder);
  }
  rmdir(path);
}

/* In place of close_scratch where one test's failure mustn't leave files to the next. */
static inline int empty_scratch(void **state) {
  Scratch *scratch = *state;
  char inside[2048];
  DIR *folder = opendir(scratch->folder);
  if (folder) {
    for (const struct dirent *entry; (entry = readdir(folder)) != NULL;) {
      snprintf(inside, sizeof inside, "%s/%s", scratch->folder, entry->d_name);
      if (!strcmp(entry->d_name, ".") || !strcmp(entry->d_name, "..")) continue;
      if (unlink(inside)) remove_folder(inside);
    }
    closedir(folder);
  }
  rmdir(scratch->folder);
  free(scratch);
  return 0;
}
#define scratch_test(test) cmocka_unit_test_setup_teardown(test, open_scratch, empty_scratch)

/* Fails unless the call failed with `expected` in one printable line that holds every one of the NULL-terminated
 * `parts`. */
static inline void expect_message(StyStatus status, StyStatus expected, const StyError *error,
                                  const char *const *parts) {
  if (status != expected) fail_msg("status %d instead of %d, message '%s'", status, expected, error->text);
  assert_int_equal(error->status, expected);
  if (!error->text[0]) fail_msg("no message");
  for (const char *c = error->text; *c; c++)
    if ((unsigned char)*c < 32 || *c == 127) fail_msg("control character %d in '%s'", *c, error->text);
  for (; *parts; parts++)
    if (!strstr(error->text, *parts)) fail_msg("'%s' lacks '%s'", error->text, *parts);
}
#define PARTS(...) \
  (const char *const[]) { __VA_ARGS__, NULL }

/* Sanitized code runs many times slower; property tests draw fewer cases there. */
#ifndef __has_feature
#define __has_feature(x) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || __has_feature(address_sanitizer) || defined(STY_DEBUG)
#define CASES(many, few) (few)
#else
#define CASES(many, few) (many)
#endif

/* splitmix64 (Steele et al. 2014). */
static inline uint64_t draw(uint64_t *state) {
  uint64_t z = (*state += 0x9E3779B97F4A7C15u);
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

/* 0 .. below-1. */
static inline int draw_below(uint64_t *state, int below) { return (int)(draw(state) % (uint64_t)below); }

/* -1 .. 1, 24 bits. */
static inline float draw_signed(uint64_t *state) { return (float)(draw(state) >> 40) / 8388608.0f - 1; }

#endif
