#include "stylut/parse.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* strtoll and strtod skip leading blanks and take "+", "nan", "inf" and
 * hexadecimal; what people type here starts with a digit, '-' or '.'. */
static int starts_like_number(const char *text) {
  return isdigit((unsigned char)text[0]) || ((text[0] == '-' || text[0] == '.') && text[1] != '\0');
}

StyStatus sty_parse_integer(const char *what, const char *text, long long minimum, long long maximum, long long *out,
                            StyError *error) {
  char *end = NULL;
  errno = 0;
  const long long value = starts_like_number(text) ? strtoll(text, &end, 10) : 0;
  if (!end || end == text || *end || errno || value < minimum || value > maximum)
    return sty_fail(error, STY_ERROR_USAGE, "%s: found '%s', expected a whole number from %lld to %lld", what, text,
                    minimum, maximum);
  *out = value;
  return STY_OK;
}

StyStatus sty_parse_number(const char *what, const char *text, double minimum, double maximum, double *out,
                           StyError *error) {
  char *end = NULL;
  const int plain = starts_like_number(text) && strspn(text, "0123456789+-.eE") == strlen(text);
  const double value = plain ? strtod(text, &end) : NAN;
  if (!end || end == text || *end || !isfinite(value) || value < minimum || value > maximum)
    return sty_fail(error, STY_ERROR_USAGE, "%s: found '%s', expected a number from %g to %g", what, text, minimum,
                    maximum);
  *out = value;
  return STY_OK;
}

StyStatus sty_parse_bytes(const char *what, const char *text, long long minimum, long long *out, StyError *error) {
  static const char suffixes[] = "KMG";
  char digits[24] = "";
  const size_t length = strlen(text);
  const char *suffix = length ? strchr(suffixes, text[length - 1]) : NULL;
  const int shift = suffix ? 10 * (int)(suffix - suffixes + 1) : 0;
  long long number;
  if (length < sizeof digits) memcpy(digits, text, suffix ? length - 1 : length);
  if (sty_parse_integer(what, digits, 0, LLONG_MAX >> shift, &number, NULL) || number << shift < minimum)
    return sty_fail(error, STY_ERROR_USAGE,
                    "%s: found '%s', expected bytes: a whole number from %lld, or one followed by K, M or G", what,
                    text, minimum);
  *out = number << shift;
  return STY_OK;
}

StyStatus sty_parse_size(const char *what, const char *text, int maximum, int *width, int *height, StyError *error) {
  char first[16] = "";
  const char *cross = strchr(text, 'x');
  const size_t length = cross ? (size_t)(cross - text) : strlen(text);
  long long w, h;
  if (length < sizeof first) memcpy(first, text, length);
  StyStatus status = sty_parse_integer(what, first, 1, maximum, &w, NULL);
  h = w = status ? 0 : w;
  if (!status && cross) status = sty_parse_integer(what, cross + 1, 1, maximum, &h, NULL);
  if (status)
    return sty_fail(error, status, "%s: found '%s', expected WIDTHxHEIGHT or one side, from 1 to %d pixels", what, text,
                    maximum);
  *width = (int)w;
  *height = (int)h;
  return STY_OK;
}

StyStatus sty_parse_choice(const char *what, const char *text, const char *const *choices, int *out, StyError *error) {
  char list[512] = "";
  for (int i = 0; choices[i]; i++) {
    if (strcmp(text, choices[i]) == 0) {
      *out = i;
      return STY_OK;
    }
    const size_t used = strlen(list);
    if (used + strlen(choices[i]) + 3 < sizeof list) {
      if (used) strcat(list, ", ");
      strcat(list, choices[i]);
    }
  }
  return sty_fail(error, STY_ERROR_USAGE, "%s: found '%s', expected one of %s", what, text, list);
}

double sty_shorten_float(float value) {
  char text[32];
  double shortened = (double)value;
  for (int digits = 6; digits <= 9; digits++) {
    snprintf(text, sizeof text, "%.*g", digits, (double)value);
    shortened = strtod(text, NULL);
    if ((float)shortened == value) break;
  }
  return shortened;
}
