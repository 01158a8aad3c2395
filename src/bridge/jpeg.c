#include "bridge/jpeg.h"

#include <stdbool.h>
#include <stddef.h>

#include "stylut/file.h"

enum { MARKER = 0xFF, START_OF_IMAGE = 0xD8, START_OF_SCAN = 0xDA, END_OF_IMAGE = 0xD9 };

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

StyStatus sty_check_jpeg(const char *path, StyError *error) {
  StyMapping file;
  if (sty_map_file(path, &file, NULL)) return STY_OK;
  const bool is_jpeg =
      file.size > 3 && file.data[0] == MARKER && file.data[1] == START_OF_IMAGE && file.data[2] == MARKER;
  bool complete = !is_jpeg;
  /* Inside a scan a byte 0xFF is followed by 0 unless it is a marker. */
  for (size_t at = complete ? file.size : find_scan(file.data, file.size); !complete && at + 1 < file.size; at++)
    complete = file.data[at] == MARKER && file.data[at + 1] == END_OF_IMAGE;
  sty_unmap_file(&file);
  return complete
             ? STY_OK
             : sty_fail(error, STY_ERROR_INPUT, "%s: found a JPEG without its end, expected a whole picture", path);
}
