#include "bridge/whole.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "stylut/file.h"

/* ---- JPEG ---------------------------------------------------------------------- */

enum { MARKER = 0xFF, START_OF_SCAN = 0xDA, END_OF_IMAGE = 0xD9 };

/* Where the first scan's data begins, past the segments before it (thumbnails
 * among them have ends of their own); `size` when there is none. */
static size_t find_scan(const unsigned char *data, size_t size) {
  size_t at = 2;
  while (at + 4 <= size && data[at] == MARKER) {
    const size_t length = (size_t)data[at + 2] << 8 | data[at + 3];
    const int marker = data[at + 1];
    at += marker == MARKER ? 1 : 2 + length;
    if (marker == START_OF_SCAN) return at < size ? at : size;
  }
  return size;
}

static bool is_whole_jpeg(const unsigned char *data, size_t size) {
  /* Inside a scan a byte 0xFF is followed by 0 unless it is a marker. */
  for (size_t at = find_scan(data, size); at + 1 < size; at++)
    if (data[at] == MARKER && data[at + 1] == END_OF_IMAGE) return true;
  return false;
}

/* ---- PNG: chunks of length, type, data, checksum ---------------------------------- */

/* Up to the end mark; what follows, and a missing end mark, are the reader's business. */
static bool is_whole_png(const unsigned char *data, size_t size) {
  enum { FIRST_CHUNK = 8, AROUND_DATA = 12 };
  for (size_t at = FIRST_CHUNK; size - at >= AROUND_DATA && memcmp(data + at + 4, "IEND", 4) != 0;) {
    const uint32_t length =
        (uint32_t)data[at] << 24 | (uint32_t)data[at + 1] << 16 | (uint32_t)data[at + 2] << 8 | (uint32_t)data[at + 3];
    if (length > size - at - AROUND_DATA) return false;
    at += AROUND_DATA + length;
  }
  return true;
}

/* ---- EXR: magic number, version and flags, then per part attributes (name, type,
 * size, value), each list ended by an empty name; several parts end with an empty
 * list ------------------------------------------------------------------------------ */

/* Past the text that begins at `at`; `size` when it has no end. */
static size_t skip_text(const unsigned char *data, size_t size, size_t at) {
  const unsigned char *end = memchr(data + at, 0, size - at);
  return end ? (size_t)(end - data) + 1 : size;
}

/* Past the list of attributes that begins at `at`; `size` when it doesn't end before.
 * OpenEXR goes by the types where they have a size of their own: damage is found
 * here, not malice. */
static size_t skip_attributes(const unsigned char *data, size_t size, size_t at) {
  while (at < size && data[at]) {
    at = skip_text(data, size, skip_text(data, size, at));
    if (size - at < 4) return size;
    const uint32_t length =
        (uint32_t)data[at] | (uint32_t)data[at + 1] << 8 | (uint32_t)data[at + 2] << 16 | (uint32_t)data[at + 3] << 24;
    at += 4;
    if (length > size - at) return size;
    at += length;
  }
  return at < size ? at + 1 : size;
}

static bool is_whole_exr(const unsigned char *data, size_t size) {
  enum { FLAGS = 5, SEVERAL_PARTS = 0x10, FIRST_HEADER = 8 };
  size_t at = FIRST_HEADER;
  do at = skip_attributes(data, size, at);
  while (data[FLAGS] & SEVERAL_PARTS && at < size && data[at]);
  return at < size;
}

/* ---- which of them ---------------------------------------------------------------- */

typedef struct Kind {
  const char *name, *begin, *lack;
  size_t size; /* of `begin` */
  bool (*is_whole)(const unsigned char *data, size_t size);
} Kind;

static const Kind kinds[] = {
    {"a JPEG", "\xff\xd8\xff", "without its end", 3, is_whole_jpeg},
    {"a PNG", "\x89PNG\r\n\x1a\n", "with a chunk that reaches beyond the file", 8, is_whole_png},
    {"an EXR", "\x76\x2f\x31\x01", "with a header that reaches beyond the file", 4, is_whole_exr},
};

StyStatus sty_check_whole(const char *path, StyError *error) {
  enum { LEAST = 8 }; /* bytes; none of them is shorter */
  StyMapping file;
  if (sty_map_file(path, &file, NULL)) return STY_OK;
  const Kind *cut = NULL;
  for (size_t k = 0; file.size > LEAST && k < sizeof kinds / sizeof *kinds; k++)
    if (memcmp(file.data, kinds[k].begin, kinds[k].size) == 0 && !kinds[k].is_whole(file.data, file.size))
      cut = &kinds[k];
  sty_unmap_file(&file);
  return cut ? sty_fail(error, STY_ERROR_INPUT, "%s: found %s %s, expected a whole picture", path, cut->name, cut->lack)
             : STY_OK;
}
