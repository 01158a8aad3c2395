#include "stylut/status.h"

#include <stdarg.h>
#include <stdio.h>

StyStatus sty_fail(StyError *error, StyStatus status, const char *format, ...) {
  if (!error) return status;
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(error->text, sizeof error->text, format, arguments);
  va_end(arguments);
  /* File names may hold anything; a terminal must not obey it. */
  for (char *c = error->text; *c; c++)
    if ((unsigned char)*c < 0x20 || *c == 0x7f) *c = '?';
  error->status = status;
  return status;
}

StyStatus sty_fail_memory(StyError *error, const char *what, double bytes) {
  return sty_fail(error, STY_ERROR_LIBRARY, "%s: found too little memory, expected room for %.0f bytes", what, bytes);
}
