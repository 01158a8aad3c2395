#include "batch_inputs.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static void name_stamp(const char *folder, const char *path, char out[STAMP_SIZE]) {
  char id[STY_HASH_SIZE];
  sty_hash_bytes(path, strlen(path), id);
  snprintf(out, STAMP_SIZE, "%.*s/%.32s", STAMP_SIZE - 34, folder, id);
}

/* Whether the file begins with the hash; what follows is the same as long as the name is. */
static bool has_hash(const char *stamp, const char *hash) {
  unsigned char *text = NULL;
  size_t size = 0;
  const bool opened = sty_read_file(stamp, 1 << 16, &text, &size, NULL) == STY_OK;
  const bool is_same = opened && size > strlen(hash) && memcmp(text, hash, strlen(hash)) == 0;
  free(text);
  return is_same;
}

StyStatus stamp_input(const char *folder, const char *path, char stamp[STAMP_SIZE], char hash[STY_HASH_SIZE],
                      StyError *error) {
  StyOutput output;
  StyStatus status = sty_hash_file(path, hash, error);
  name_stamp(folder, path, stamp);
  if (status || has_hash(stamp, hash)) return status;
  status = sty_open_output(stamp, &output, error);
  if (status) return status;
  fprintf(output.stream, "%s  %s\n", hash, path);
  return sty_commit_output(&output, error);
}
