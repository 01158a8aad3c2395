#include "bridge/exr.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "stylut/file.h"

/* OpenEXR file layout: magic number, version and flags, then per part attributes
 * (name, type, size, value), each list ended by an empty name; several parts are
 * ended by an empty list. */
static const unsigned char magic[4] = {0x76, 0x2f, 0x31, 0x01};
enum { FLAGS = 5, SEVERAL_PARTS = 0x10, FIRST_HEADER = 8 };

/* Past the text that begins at `at`; `size` when it has no end. */
static size_t skip_text(const unsigned char *data, size_t size, size_t at) {
  const unsigned char *end = memchr(data + at, 0, size - at);
  return end ? (size_t)(end - data) + 1 : size;
}

/* Past the list of attributes that begins at `at`; `size` when it doesn't end before. */
static size_t skip_attributes(const unsigned char *data, size_t size, size_t at) {
  while (at < size && data[at]) {
    at = skip_text(data, size, skip_text(data, size, at));
    if (size - at < 4) return size;
    const uint32_t length =
        data[at] | (uint32_t)data[at + 1] << 8 | (uint32_t)data[at + 2] << 16 | (uint32_t)data[at + 3] << 24;
    at += 4;
    if (length > size - at) return size;
    at += length;
  }
  return at < size ? at + 1 : size;
}

static bool has_whole_header(const unsigned char *data, size_t size) {
  size_t at = FIRST_HEADER;
  do at = skip_attributes(data, size, at);
  while (data[FLAGS] & SEVERAL_PARTS && at < size && data[at]);
  return at < size;
}

StyStatus sty_check_exr(const char *path, StyError *error) {
  StyMapping file;
  if (sty_map_file(path, &file, NULL)) return STY_OK;
  const bool is_exr = file.size > FIRST_HEADER && memcmp(file.data, magic, sizeof magic) == 0;
  const bool whole = !is_exr || has_whole_header(file.data, file.size);
  sty_unmap_file(&file);
  return whole ? STY_OK
               : sty_fail(error, STY_ERROR_INPUT,
                          "%s: found an EXR header that doesn't end in the file, expected a whole picture", path);
}
