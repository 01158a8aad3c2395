/* Strict parsing of what people type. The whole text must be the value:
 * no blanks around it, nothing behind it, nothing out of range, no NaN.
 * `what` names the option or key in the message, which says what was found
 * and what was expected. Errors: STY_ERROR_USAGE. */
#ifndef STYLUT_PARSE_H
#define STYLUT_PARSE_H

#include <stdint.h>

#include "stylut/status.h"

#ifdef __cplusplus
extern "C" {
#endif

StyStatus sty_parse_integer(const char *what, const char *text, long long minimum, long long maximum, long long *out,
                            StyError *error);
StyStatus sty_parse_number(const char *what, const char *text, double minimum, double maximum, double *out,
                           StyError *error);

/* Bytes: a whole number, or one followed by K, M or G (1024, 1024^2, 1024^3). */
StyStatus sty_parse_bytes(const char *what, const char *text, long long minimum, long long *out, StyError *error);

/* "WxH" or "N" for N x N; each side from 1 to `maximum`. */
StyStatus sty_parse_size(const char *what, const char *text, int maximum, int *width, int *height, StyError *error);

/* The index of `text` in the NULL-terminated list `choices`. The message lists them. */
StyStatus sty_parse_choice(const char *what, const char *text, const char *const *choices, int *out, StyError *error);

/* The number of fewest decimal digits that is this float: 0.15, not 0.150000006. */
double sty_shorten_float(float value);

#ifdef __cplusplus
}
#endif
#endif
