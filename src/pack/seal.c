#include "pack/seal.h"

#include <stdlib.h>
#include <string.h>

StyStatus sty_seal_index(const json_t *index, char out[STY_HASH_SIZE], StyError *error) {
  json_t *rest = json_copy((json_t *)(uintptr_t)index);
  json_object_del(rest, STY_SEAL_KEY);
  char *text = json_dumps(rest, JSON_COMPACT | JSON_SORT_KEYS | JSON_REAL_PRECISION(STY_INDEX_PRECISION));
  json_decref(rest);
  if (!text) return sty_fail_memory(error, "index", 0);
  sty_hash_bytes(text, strlen(text), out);
  free(text);
  return STY_OK;
}
