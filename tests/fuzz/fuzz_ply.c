/* What a PLY file is asked before the importer gets it; all other parsing of meshes is a library's, in a process of
 * its own. */
#include "fuzz.h"
#include "scene/ply.h"

static bool is_whole(const uint8_t *data, size_t size) {
  StyError error;
  const StyStatus status = sty_check_ply(put_file("mesh.ply", data, size), &error);
  if (status) require_message(status, &error);
  return !status;
}

/* What follows a whole file changes nothing. */
static bool is_whole_with_more(const uint8_t *data, size_t size) {
  static const char more[] = "\n3 0 1 2\n";
  uint8_t *longer = malloc(size + sizeof more);
  require(longer);
  if (size) memcpy(longer, data, size);
  memcpy(longer + size, more, sizeof more);
  const bool whole = is_whole(longer, size + sizeof more);
  free(longer);
  return whole;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (is_whole(data, size)) require(is_whole_with_more(data, size));
  return 0;
}
