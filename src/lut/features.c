#include <stdio.h>
#include <string.h>

#include "stylut/lut.h"
#include "stylut/parse.h"

/* "NAME" or "NAME:WEIGHT", the first `length` characters of `text`. */
static StyStatus parse_feature(const char *what, const char *text, size_t length, StyFeature *out, StyError *error) {
  char item[STY_MAX_NAME + 32];
  double weight = 1;
  if (length == 0 || length >= sizeof item || text[0] == ':')
    return sty_fail(error, STY_ERROR_USAGE, "%s: found '%.*s', expected CHANNEL or CHANNEL:WEIGHT", what,
                    (int)(length < 64 ? length : 64), text);
  snprintf(item, sizeof item, "%.*s", (int)length, text);
  char *colon = strchr(item, ':');
  if (colon) *colon = '\0';
  if (strlen(item) >= STY_MAX_NAME)
    return sty_fail(error, STY_ERROR_USAGE, "%s: found '%s', expected a name of at most %d characters", what, item,
                    STY_MAX_NAME - 1);
  const StyStatus status = colon ? sty_parse_number(what, colon + 1, 1e-3, 1e3, &weight, error) : STY_OK;
  if (status) return status;
  *out = (StyFeature){.weight = (float)weight};
  strcpy(out->channel, item);
  return STY_OK;
}

StyStatus sty_parse_features(const char *what, const char *text, StyFeature out[STY_MOST_DIMS], int *count,
                             StyError *error) {
  StyFeature features[STY_MOST_DIMS];
  int found = 0;
  for (const char *at = text;; at++) {
    const size_t length = strcspn(at, ",");
    if (found == STY_MOST_DIMS)
      return sty_fail(error, STY_ERROR_USAGE, "%s: found more than %d channels, expected at most that", what,
                      STY_MOST_DIMS);
    const StyStatus status = parse_feature(what, at, length, &features[found], error);
    if (status) return status;
    for (int f = 0; f < found; f++)
      if (strcmp(features[f].channel, features[found].channel) == 0)
        return sty_fail(error, STY_ERROR_USAGE, "%s: found '%s' twice, expected it once", what, features[f].channel);
    found++;
    at += length;
    if (!*at) break;
  }
  memcpy(out, features, (size_t)found * sizeof *out);
  *count = found;
  return STY_OK;
}

void sty_write_features(const StyFeature *features, int count, char out[STY_FEATURES_SIZE]) {
  size_t used = 0;
  out[0] = '\0';
  for (int f = 0; f < count; f++) {
    used += (size_t)snprintf(out + used, STY_FEATURES_SIZE - used, "%s%s", f ? "," : "", features[f].channel);
    if (features[f].weight != 1)
      used += (size_t)snprintf(out + used, STY_FEATURES_SIZE - used, ":%.9g", (double)features[f].weight);
  }
}
