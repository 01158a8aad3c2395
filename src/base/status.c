#include "stylut/status.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void sty_clean_text(char *text) {
  for (unsigned char *c = (unsigned char *)text; *c; c++) {
    if (*c < 0x20 || *c == 0x7f) *c = '?';
    if (*c == 0xc2 && c[1] >= 0x80 && c[1] < 0xa0)
      c[0] = c[1] = '?'; /* U+0080 to U+009F, ESC and [ in one among them */
  }
}

StyStatus sty_fail(StyError *error, StyStatus status, const char *format, ...) {
  if (!error) return status;
  /* The arguments may well be the text of this very error. */
  char text[sizeof error->text];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  sty_clean_text(text);
  memcpy(error->text, text, sizeof text);
  error->status = status;
  return status;
}

StyStatus sty_fail_memory(StyError *error, const char *what, double bytes) {
  return sty_fail(error, STY_ERROR_LIBRARY, "%s: found too little memory, expected room for %.0f bytes", what, bytes);
}
