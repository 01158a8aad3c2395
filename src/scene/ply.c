#include "scene/ply.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "stylut/file.h"

enum { MAX_ELEMENTS = 32, MAX_PROPERTIES = 256, MAX_LINE = 512 };

typedef struct Property {
  size_t size;       /* bytes of the value, or of one entry of the list */
  size_t count_size; /* bytes of the list's length; 0: not a list */
} Property;

typedef struct Element {
  char name[32];
  unsigned long long count;
  int property_count;
  Property properties[MAX_PROPERTIES];
} Element;

typedef enum Encoding { ENCODING_NONE, ENCODING_ASCII, ENCODING_LITTLE, ENCODING_BIG } Encoding;

typedef struct Ply {
  const unsigned char *at, *end;
  Encoding encoding;
  int element_count;
  Element elements[MAX_ELEMENTS];
} Ply;

/* ---- the header ---- */

/* 0 for names that are no type. */
static size_t get_type_size(const char *name) {
  static const struct {
    const char *name;
    size_t size;
  } TYPES[] = {{"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},  {"short", 2}, {"ushort", 2},
               {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},   {"int32", 4}, {"uint32", 4},
               {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  for (size_t i = 0; i < sizeof TYPES / sizeof *TYPES; i++)
    if (strcmp(name, TYPES[i].name) == 0) return TYPES[i].size;
  return 0;
}

/* The next line, its first MAX_LINE - 1 characters. */
static bool read_line(Ply *ply, char line[MAX_LINE]) {
  const unsigned char *newline = memchr(ply->at, '\n', (size_t)(ply->end - ply->at));
  if (!newline) return false;
  const size_t length = (size_t)(newline - ply->at), kept = length < MAX_LINE ? length : MAX_LINE - 1;
  memcpy(line, ply->at, kept);
  line[kept] = '\0';
  line[strcspn(line, "\r")] = '\0';
  ply->at = newline + 1;
  return true;
}

static bool add_property(Ply *ply, const char *line) {
  char first[16], second[16];
  Property property = {0};
  if (ply->element_count == 0) return false;
  Element *element = &ply->elements[ply->element_count - 1];
  if (sscanf(line, "property list %15s %15s", first, second) == 2) {
    property = (Property){get_type_size(second), get_type_size(first)};
    if (property.count_size == 0) return false;
  } else if (sscanf(line, "property %15s", first) == 1) {
    property.size = get_type_size(first);
  }
  if (property.size == 0 || element->property_count == MAX_PROPERTIES) return false;
  element->properties[element->property_count++] = property;
  return true;
}

static bool add_element(Ply *ply, const char *line) {
  if (ply->element_count == MAX_ELEMENTS) return false;
  Element *element = &ply->elements[ply->element_count++];
  return sscanf(line, "element %31s %llu", element->name, &element->count) == 2;
}

static Encoding get_encoding(const char *line) {
  if (strncmp(line, "format ascii ", 13) == 0) return ENCODING_ASCII;
  if (strncmp(line, "format binary_little_endian ", 28) == 0) return ENCODING_LITTLE;
  return strncmp(line, "format binary_big_endian ", 25) == 0 ? ENCODING_BIG : ENCODING_NONE;
}

static bool read_header_line(Ply *ply, const char *line) {
  if (strncmp(line, "format ", 7) == 0) return (ply->encoding = get_encoding(line)) != ENCODING_NONE;
  if (strncmp(line, "element ", 8) == 0) return add_element(ply, line);
  if (strncmp(line, "property ", 9) == 0) return add_property(ply, line);
  return true;
}

static StyStatus read_header(const char *path, Ply *ply, StyError *error) {
  char line[MAX_LINE];
  bool good = read_line(ply, line) && strcasecmp(line, "ply") == 0;
  if (!good) return sty_fail(error, STY_ERROR_INPUT, "%s: not a mesh: expected 'ply' in the first line", path);
  while (good) {
    if (!read_line(ply, line))
      return sty_fail(error, STY_ERROR_INPUT, "%s: not a whole mesh: it ends within the header", path);
    if (strcmp(line, "end_header") == 0) break;
    good = read_header_line(ply, line);
  }
  if (good && ply->encoding != ENCODING_NONE) return STY_OK;
  return sty_fail(error, STY_ERROR_INPUT, "%s: not a mesh: found '%.60s' in the header, expected PLY 1.0", path, line);
}

/* ---- the items ---- */

static bool is_blank(unsigned char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/* Steps over one word; *value is the whole number at its beginning. */
static bool skip_word(Ply *ply, unsigned long long *value) {
  while (ply->at < ply->end && is_blank(*ply->at)) ply->at++;
  if (ply->at == ply->end) return false;
  *value = 0;
  for (; ply->at < ply->end && *ply->at >= '0' && *ply->at <= '9' && *value < UINT32_MAX; ply->at++)
    *value = *value * 10 + (unsigned long long)(*ply->at - '0');
  while (ply->at < ply->end && !is_blank(*ply->at)) ply->at++;
  return true;
}

static bool skip_bytes(Ply *ply, unsigned long long size) {
  if (size > (unsigned long long)(ply->end - ply->at)) return false;
  ply->at += size;
  return true;
}

static bool skip_count(Ply *ply, size_t size, unsigned long long *count) {
  const unsigned char *bytes = ply->at;
  if (!skip_bytes(ply, size)) return false;
  *count = 0;
  for (size_t i = 0; i < size; i++) *count = *count << 8 | bytes[ply->encoding == ENCODING_BIG ? i : size - 1 - i];
  return true;
}

static bool skip_ascii_property(Ply *ply, const Property *property) {
  unsigned long long count = 1, ignored;
  if (property->count_size > 0 && !skip_word(ply, &count)) return false;
  for (; count > 0; count--)
    if (!skip_word(ply, &ignored)) return false;
  return true;
}

static bool skip_binary_property(Ply *ply, const Property *property) {
  unsigned long long count = 1;
  if (property->count_size > 0 && !skip_count(ply, property->count_size, &count)) return false;
  return count <= UINT32_MAX && skip_bytes(ply, count * property->size);
}

static bool skip_item(Ply *ply, const Element *element) {
  for (int p = 0; p < element->property_count; p++) {
    const Property *property = &element->properties[p];
    if (!(ply->encoding == ENCODING_ASCII ? skip_ascii_property : skip_binary_property)(ply, property)) return false;
  }
  return true;
}

static StyStatus walk_items(const char *path, Ply *ply, StyError *error) {
  for (int e = 0; e < ply->element_count; e++) {
    const Element *element = &ply->elements[e];
    if (element->property_count == 0) continue;
    for (unsigned long long i = 0; i < element->count; i++)
      if (!skip_item(ply, element))
        return sty_fail(error, STY_ERROR_INPUT, "%s: not a whole mesh: it ends in %s %llu, expected %llu of them", path,
                        element->name, i + 1, element->count);
  }
  return STY_OK;
}

StyStatus sty_check_ply(const char *path, StyError *error) {
  StyMapping file;
  StyStatus status = sty_map_file(path, &file, error);
  if (status != STY_OK) return status;
  Ply ply = {.at = file.data, .end = file.data + file.size};
  status = read_header(path, &ply, error);
  if (status == STY_OK) status = walk_items(path, &ply, error);
  sty_unmap_file(&file);
  return status;
}
