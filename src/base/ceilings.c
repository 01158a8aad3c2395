#include "stylut/ceilings.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "stylut/image.h"
#include "stylut/parse.h"

static struct {
  const char *name;
  long long least, most, value;
  bool is_set;
} ceilings[STY_CEILINGS] = {
    [STY_CEILING_PIXELS] = {"pixels", 1, STY_MAX_PIXELS, STY_MAX_PIXELS, false},
    [STY_CEILING_JSON_BYTES] = {"json-bytes", 1, 1LL << 30, 16LL << 20, false},
    [STY_CEILING_IMPORT_SECONDS] = {"import-seconds", 0, 1000000, 0, false},
    [STY_CEILING_IMPORT_BYTES] = {"import-bytes", 0, 1LL << 50, 0, false},
};

double sty_get_ceiling(StyCeiling ceiling) { return (double)ceilings[ceiling].value; }

StyStatus sty_set_ceiling(const char *what, const char *text, StyError *error) {
  const size_t length = strcspn(text, "=");
  for (int c = 0; c < STY_CEILINGS; c++) {
    if (strlen(ceilings[c].name) != length || strncmp(ceilings[c].name, text, length) != 0 || !text[length]) continue;
    char name[64];
    snprintf(name, sizeof name, "%s %s", what, ceilings[c].name);
    const StyStatus status =
        sty_parse_integer(name, text + length + 1, ceilings[c].least, ceilings[c].most, &ceilings[c].value, error);
    ceilings[c].is_set = !status;
    return status;
  }
  return sty_fail(error, STY_ERROR_USAGE,
                  "%s: found '%s', expected pixels=N, json-bytes=N, import-seconds=N or import-bytes=N", what, text);
}

size_t sty_list_ceilings(const char *before_each, char *out, size_t size) {
  size_t length = 0;
  if (size) *out = 0;
  for (int c = 0; c < STY_CEILINGS; c++)
    if (ceilings[c].is_set)
      length += (size_t)snprintf(out + (length < size ? length : size), length < size ? size - length : 0,
                                 "%s%s%s=%lld", length ? " " : "", before_each, ceilings[c].name, ceilings[c].value);
  return length;
}
