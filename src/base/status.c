#include "stylut/status.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void sty_clean_text(char *text) {
  for (char *c = text; *c; c++)
    if ((unsigned char)*c < 0x20 || *c == 0x7f) *c = '?';
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
