#include "stylut/json.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "stylut/ceilings.h"
#include "stylut/file.h"

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

static void locate(const char *text, const char *place, int *line, int *column) {
  const char *start = text;
  *line = 1;
  for (const char *c = text; c < place; c++)
    if (*c == '\n') {
      ++*line;
      start = c + 1;
    }
  *column = (int)(place - start) + 1;
}

/* Jansson passes over zero bytes behind numbers; what looks values up in the text would end there. */
static StyStatus check_text(const char *name, const char *text, size_t size, StyError *error) {
  int line, column;
  const char *zero = memchr(text, 0, size);
  if (!zero) return STY_OK;
  locate(text, zero, &line, &column);
  return sty_fail(error, STY_ERROR_INPUT, "%s:%d:%d: found a zero byte, expected text", name, line, column);
}

/* What jansson says; of a comma behind the last value it would say that the bracket after it, maybe lines below, is
 * wrong. */
static StyStatus fail_syntax(const StyDocument *document, size_t size, const json_error_t *cause, StyError *error) {
  const size_t end = (size_t)cause->position < size ? (size_t)cause->position : size;
  const char *c = document->text + end - (end > 0); /* the token's last character */
  const bool closes = *c == '}' || *c == ']';
  do c -= c > document->text;
  while (closes && c > document->text && is_blank(*c));
  int line = cause->line, column = cause->column > 0 ? cause->column : 1;
  if (!closes || *c != ',')
    return sty_fail(error, STY_ERROR_INPUT, "%s:%d:%d: found invalid JSON: %s", document->name, line, column,
                    cause->text);
  locate(document->text, c, &line, &column);
  return sty_fail(error, STY_ERROR_INPUT, "%s:%d:%d: found a comma behind the last value, expected none",
                  document->name, line, column);
}

/* Some editors on Windows begin every file with it. */
static size_t drop_byte_order_mark(char *text, size_t size) {
  static const char mark[] = "\xef\xbb\xbf";
  const size_t length = strlen(mark);
  if (strncmp(text, mark, length) != 0) return size;
  memmove(text, text + length, size - length + 1); /* and the NUL */
  return size - length;
}

static StyStatus parse(StyDocument *document, size_t size, StyError *error) {
  size = drop_byte_order_mark(document->text, size);
  const StyStatus status = check_text(document->name, document->text, size, error);
  if (status) return status;
  json_error_t cause;
  document->root = json_loadb(document->text, size, JSON_REJECT_DUPLICATES, &cause);
  if (!document->root) return fail_syntax(document, size, &cause, error);
  return json_is_object(document->root) ? STY_OK : sty_fail_value(document, NULL, document->root, "an object", error);
}

StyStatus sty_read_document(const char *path, StyDocument *out, StyError *error) {
  unsigned char *bytes = NULL;
  size_t size = 0;
  uint64_t length = 0;
  const double most = sty_get_ceiling(STY_CEILING_JSON_BYTES);
  StyStatus status = sty_check_file(path, &length, error);
  if (!status && (double)length > most)
    status = sty_fail(error, STY_ERROR_INPUT, "%s: found %llu bytes, expected at most %.0f (--limit json-bytes=N)",
                      path, (unsigned long long)length, most);
  if (!status) status = sty_read_file(path, (size_t)most, &bytes, &size, error);
  if (status) return status;
  StyDocument document = {strdup(path), (char *)bytes, NULL};
  status = document.name ? parse(&document, size, error) : sty_fail_memory(error, path, (double)strlen(path));
  if (status)
    sty_close_document(&document);
  else
    *out = document;
  return status;
}

void sty_close_document(StyDocument *document) {
  json_decref(document->root);
  free(document->text);
  free(document->name);
  *document = (StyDocument){NULL, NULL, NULL};
}

/* ---- where a value stands ---- The text is known to be valid JSON without zero bytes. */

static const char *skip_blanks(const char *c) { return c + strspn(c, " \t\r\n"); }

static const char *skip_string(const char *c) {
  for (c++; *c && *c != '"'; c++)
    if (*c == '\\' && c[1]) c++;
  return *c ? c + 1 : c;
}

/* Past a whole value: nesting is counted, strings are stepped over. */
static const char *skip_value(const char *c) {
  int depth = 0;
  do {
    c = skip_blanks(c);
    if (*c == '"')
      c = skip_string(c);
    else if (*c == '{' || *c == '[')
      depth++, c++;
    else if (*c == '}' || *c == ']')
      depth--, c++;
    else if (*c == ',' || *c == ':')
      c++;
    else
      c += strcspn(c, " \t\r\n,:{}[]\"");
  } while (depth > 0 && *c);
  return c;
}

/* Keys are compared as jansson reads them, escapes resolved. */
static int is_key(const char *quoted, const char *end, const char *key) {
  json_t *string = json_loadb(quoted, (size_t)(end - quoted), JSON_DECODE_ANY, NULL);
  const int same = string && strcmp(json_string_value(string), key) == 0;
  json_decref(string);
  return same;
}

static const char *find_place(const char *text, const StyPath *path) {
  if (!path) return skip_blanks(text);
  const char *c = skip_blanks(find_place(text, path->parent) + 1); /* past { or [ */
  for (size_t i = 0; *c && *c != '}' && *c != ']'; i++) {
    const char *value = c;
    int here = !path->key && i == path->index;
    if (path->key) {
      const char *end = skip_string(c);
      here = is_key(c, end, path->key);
      value = skip_blanks(skip_blanks(end) + 1);
    }
    if (here) return value;
    c = skip_blanks(skip_value(value));
    if (*c == ',') c = skip_blanks(c + 1);
  }
  return c;
}

/* ---- messages and typed access ---- */

void sty_name_path(const StyPath *path, char *out, size_t size) {
  if (!path) {
    *out = 0;
    return;
  }
  sty_name_path(path->parent, out, size);
  const size_t used = strlen(out);
  if (path->key)
    snprintf(out + used, size - used, "%s%s", used ? "." : "", path->key);
  else
    snprintf(out + used, size - used, "[%zu]", path->index);
}

void sty_name_place(const StyDocument *document, const StyPath *path, char *out, size_t size) {
  int line, column;
  char where[256];
  locate(document->text, find_place(document->text, path), &line, &column);
  sty_name_path(path, where, sizeof where);
  snprintf(out, size, "%s:%d:%d%s%s", document->name, line, column, *where ? ": " : "", where);
}

static const char *name_type(const json_t *value) {
  static const char *const names[] = {"an object", "a list", "a string", "an integer",
                                      "a number",  "true",   "false",    "null"};
  return value ? names[json_typeof(value)] : "nothing";
}

StyStatus sty_fail_found(const StyDocument *document, const StyPath *path, const char *found, const char *expected,
                         StyError *error) {
  char place[STY_PLACE_SIZE];
  sty_name_place(document, path, place, sizeof place);
  return sty_fail(error, STY_ERROR_INPUT, "%s: found %s, expected %s", place, found, expected);
}

StyStatus sty_fail_value(const StyDocument *document, const StyPath *path, const json_t *found, const char *expected,
                         StyError *error) {
  char text[128];
  if (json_is_string(found))
    snprintf(text, sizeof text, "\"%.100s\"", json_string_value(found));
  else if (json_is_number(found))
    snprintf(text, sizeof text, "%.12g", json_number_value(found));
  else if (json_is_array(found))
    snprintf(text, sizeof text, "a list of %zu", json_array_size(found));
  else
    snprintf(text, sizeof text, "%s", name_type(found));
  return sty_fail_found(document, path, text, expected, error);
}

StyStatus sty_check_keys(const StyDocument *document, const StyPath *path, const json_t *object,
                         const char *const *known, StyError *error) {
  if (!json_is_object(object)) return sty_fail_value(document, path, object, "an object", error);
  char list[512] = "one of the keys";
  for (int k = 0; known[k]; k++) {
    const size_t used = strlen(list);
    snprintf(list + used, sizeof list - used, "%s %s", k ? "," : "", known[k]);
  }
  for (void *i = json_object_iter((json_t *)(uintptr_t)object); i;
       i = json_object_iter_next((json_t *)(uintptr_t)object, i)) {
    const char *key = json_object_iter_key(i);
    int k = 0;
    while (known[k] && strcmp(known[k], key) != 0) k++;
    if (!known[k]) return sty_fail_found(document, &(StyPath){path, key, 0}, "an unknown key", list, error);
  }
  return STY_OK;
}

StyStatus sty_get_string(const StyDocument *document, const StyPath *path, const json_t *object, const char *key,
                         int required, const char **out, StyError *error) {
  const json_t *value = json_object_get(object, key);
  if (!value && !required) return STY_OK;
  if (!value) {
    char expected[160];
    snprintf(expected, sizeof expected, "a key \"%.100s\"", key);
    return sty_fail_found(document, path, "none", expected, error);
  }
  if (!json_is_string(value) || !*json_string_value(value))
    return sty_fail_value(document, &(StyPath){path, key, 0}, value, "a string that isn't empty", error);
  *out = json_string_value(value);
  return STY_OK;
}

StyStatus sty_get_number(const StyDocument *document, const StyPath *path, const json_t *object, const char *key,
                         double minimum, double maximum, double *out, StyError *error) {
  const json_t *value = json_object_get(object, key);
  if (!value) return STY_OK;
  const double number = json_number_value(value);
  if (!json_is_number(value) || !(number >= minimum && number <= maximum)) {
    char expected[96];
    snprintf(expected, sizeof expected, "a number from %g to %g", minimum, maximum);
    return sty_fail_value(document, &(StyPath){path, key, 0}, value, expected, error);
  }
  *out = number;
  return STY_OK;
}

StyStatus sty_get_integer(const StyDocument *document, const StyPath *path, const json_t *object, const char *key,
                          int minimum, int maximum, int *out, StyError *error) {
  const json_t *value = json_object_get(object, key);
  if (!value) return STY_OK;
  const json_int_t number = json_integer_value(value);
  if (!json_is_integer(value) || number < minimum || number > maximum) {
    char expected[96];
    snprintf(expected, sizeof expected, "a whole number from %d to %d", minimum, maximum);
    return sty_fail_value(document, &(StyPath){path, key, 0}, value, expected, error);
  }
  *out = (int)number;
  return STY_OK;
}

StyStatus sty_get_numbers(const StyDocument *document, const StyPath *path, const json_t *object, const char *key,
                          double minimum, double maximum, int count, double *out, StyError *error) {
  const json_t *list = json_object_get(object, key);
  const StyPath list_path = {path, key, 0};
  char expected[96];
  if (!list) return STY_OK;
  snprintf(expected, sizeof expected, "a list of %d numbers", count);
  if (!json_is_array(list) || json_array_size(list) != (size_t)count)
    return sty_fail_value(document, &list_path, list, expected, error);
  snprintf(expected, sizeof expected, "a number from %g to %g", minimum, maximum);
  for (size_t i = 0; i < (size_t)count; i++) {
    const json_t *value = json_array_get(list, i);
    const double number = json_number_value(value);
    if (!json_is_number(value) || !(number >= minimum && number <= maximum))
      return sty_fail_value(document, &(StyPath){&list_path, NULL, i}, value, expected, error);
    out[i] = number;
  }
  return STY_OK;
}

StyStatus sty_get_choice(const StyDocument *document, const StyPath *path, const json_t *object, const char *key,
                         const char *const *words, int *out, StyError *error) {
  const json_t *value = json_object_get(object, key);
  if (!value) return STY_OK;
  char expected[160] = "";
  for (int w = 0; words[w]; w++) {
    if (json_is_string(value) && strcmp(json_string_value(value), words[w]) == 0) {
      *out = w;
      return STY_OK;
    }
    const size_t used = strlen(expected);
    snprintf(expected + used, sizeof expected - used, "%s\"%s\"", w ? ", " : "one of ", words[w]);
  }
  return sty_fail_value(document, &(StyPath){path, key, 0}, value, expected, error);
}

StyStatus sty_write_json(const char *path, const json_t *value, StyError *error) {
  StyOutput output;
  const StyStatus status = sty_open_output(path, &output, error);
  if (status) return status;
  if (json_dumpf(value, output.stream, JSON_INDENT(2) | JSON_REAL_PRECISION(9)) != 0) {
    sty_discard_output(&output);
    return sty_fail_memory(error, path, 0);
  }
  fputc('\n', output.stream);
  return sty_commit_output(&output, error);
}
