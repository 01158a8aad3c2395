#include "scene/ply.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "scene/corners.h"
#include "scene/faults.h"
#include "scene/fit.h"
#include "scene/vector.h"
#include "stylut/file.h"

enum { MAX_ELEMENTS = 32, MAX_PROPERTIES = 256, MAX_LINE = 512 };

/* Bytes of a file that are held at a time; more than any item without lists has. */
enum { BLOCK = 1 << 22 };

typedef enum Kind { KIND_SIGNED, KIND_UNSIGNED, KIND_FLOAT } Kind;

typedef struct Type {
  size_t size; /* 0: none */
  Kind kind;
} Type;

typedef struct Property {
  char name[32];
  Type type;  /* of the value, or of one entry of the list */
  Type count; /* of the list's length; none: not a list */
} Property;

typedef struct Element {
  char name[32];
  unsigned long long count;
  int property_count;
  Property properties[MAX_PROPERTIES];
} Element;

typedef enum Encoding { ENCODING_NONE, ENCODING_ASCII, ENCODING_LITTLE, ENCODING_BIG } Encoding;

/* A file on its way through a block. It isn't mapped: who shortens a mapped file ends those that read it. */
typedef struct Ply {
  int file;
  const StyRun *run; /* for progress; NULL: none */
  unsigned char *block;
  const unsigned char *at, *end; /* what is left of the block */
  uint64_t size, read;           /* of the file; up to the block's end */
  Encoding encoding;
  int element_count;
  Element elements[MAX_ELEMENTS];
} Ply;

/* ---- bytes ---- */

static StyStatus open_ply(const char *path, const StyRun *run, Ply *out, StyError *error) {
  Ply ply = {.run = run};
  const StyStatus status = sty_check_file(path, &ply.size, error);
  if (status) return status;
  ply.at = ply.end = ply.block = malloc(BLOCK);
  if (!ply.block) return sty_fail_memory(error, path, BLOCK);
  ply.file = open(path, O_RDONLY | O_CLOEXEC);
  if (ply.file < 0) {
    free(ply.block);
    return sty_fail(error, STY_ERROR_FILE, "%s: %s; expected a file to read", path, strerror(errno));
  }
  *out = ply;
  return STY_OK;
}

static void close_ply(Ply *ply) {
  close(ply->file);
  free(ply->block);
}

/* As many bytes as fit behind those that are left. */
static void fill_block(Ply *ply) {
  size_t held = (size_t)(ply->end - ply->at);
  memmove(ply->block, ply->at, held);
  while (held < BLOCK) {
    const ssize_t got = pread(ply->file, ply->block + held, BLOCK - held, (off_t)ply->read);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    held += (size_t)got;
    ply->read += (uint64_t)got;
  }
  ply->at = ply->block;
  ply->end = ply->block + held;
  if (ply->run && ply->run->progress)
    ply->run->progress(ply->run->context, fmin(1, (double)ply->read / (double)ply->size));
}

/* The next bytes, at most BLOCK; NULL: the file ends before. */
static const unsigned char *take_bytes(Ply *ply, size_t size) {
  if ((size_t)(ply->end - ply->at) < size) fill_block(ply);
  if ((size_t)(ply->end - ply->at) < size) return NULL;
  ply->at += size;
  return ply->at - size;
}

static uint64_t count_left(const Ply *ply) {
  const uint64_t left = ply->size > ply->read ? ply->size - ply->read : 0;
  return left + (uint64_t)(ply->end - ply->at);
}

/* ---- the header ---- */

static Type get_type(const char *name) {
  static const struct {
    const char *name;
    Type type;
  } TYPES[] = {{"char", {1, KIND_SIGNED}},    {"uchar", {1, KIND_UNSIGNED}},  {"int8", {1, KIND_SIGNED}},
               {"uint8", {1, KIND_UNSIGNED}}, {"short", {2, KIND_SIGNED}},    {"ushort", {2, KIND_UNSIGNED}},
               {"int16", {2, KIND_SIGNED}},   {"uint16", {2, KIND_UNSIGNED}}, {"int", {4, KIND_SIGNED}},
               {"uint", {4, KIND_UNSIGNED}},  {"int32", {4, KIND_SIGNED}},    {"uint32", {4, KIND_UNSIGNED}},
               {"float", {4, KIND_FLOAT}},    {"float32", {4, KIND_FLOAT}},   {"double", {8, KIND_FLOAT}},
               {"float64", {8, KIND_FLOAT}}};
  for (size_t i = 0; i < sizeof TYPES / sizeof *TYPES; i++)
    if (strcmp(name, TYPES[i].name) == 0) return TYPES[i].type;
  return (Type){0, KIND_SIGNED};
}

/* The next line, its first MAX_LINE - 1 characters. */
static bool read_line(Ply *ply, char line[MAX_LINE]) {
  size_t length = 0;
  const unsigned char *c;
  while ((c = take_bytes(ply, 1)) && *c != '\n')
    if (length < MAX_LINE - 1) line[length++] = (char)*c;
  line[length] = '\0';
  line[strcspn(line, "\r")] = '\0';
  return c;
}

static bool add_property(Ply *ply, const char *line) {
  char first[16], second[16];
  Property property = {0};
  if (ply->element_count == 0) return false;
  Element *element = &ply->elements[ply->element_count - 1];
  if (sscanf(line, "property list %15s %15s %31s", first, second, property.name) >= 2) {
    property.type = get_type(second);
    property.count = get_type(first);
    if (property.count.size == 0) return false;
  } else if (sscanf(line, "property %15s %31s", first, property.name) >= 1) {
    property.type = get_type(first);
  }
  if (property.type.size == 0 || element->property_count == MAX_PROPERTIES) return false;
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
  const unsigned char *c = take_bytes(ply, 1);
  while (c && is_blank(*c)) c = take_bytes(ply, 1);
  if (!c) return false;
  *value = 0;
  for (; c && *c >= '0' && *c <= '9' && *value < UINT32_MAX; c = take_bytes(ply, 1))
    *value = *value * 10 + (unsigned long long)(*c - '0');
  while (c && !is_blank(*c)) c = take_bytes(ply, 1);
  return true;
}

static bool skip_bytes(Ply *ply, unsigned long long size) {
  if (size > count_left(ply)) return false;
  const size_t held = (size_t)(ply->end - ply->at);
  ply->at += size < held ? size : held;
  ply->read += size < held ? 0 : size - held;
  return true;
}

static bool skip_count(Ply *ply, size_t size, unsigned long long *count) {
  const unsigned char *bytes = take_bytes(ply, size);
  if (!bytes) return false;
  *count = 0;
  for (size_t i = 0; i < size; i++) *count = *count << 8 | bytes[ply->encoding == ENCODING_BIG ? i : size - 1 - i];
  return true;
}

static bool skip_ascii_property(Ply *ply, const Property *property) {
  unsigned long long count = 1, ignored;
  if (property->count.size > 0 && !skip_word(ply, &count)) return false;
  for (; count > 0; count--)
    if (!skip_word(ply, &ignored)) return false;
  return true;
}

static bool skip_binary_property(Ply *ply, const Property *property) {
  unsigned long long count = 1;
  if (property->count.size > 0 && !skip_count(ply, property->count.size, &count)) return false;
  return count <= UINT32_MAX && skip_bytes(ply, count * property->type.size);
}

static bool skip_item(Ply *ply, const Element *element) {
  for (int p = 0; p < element->property_count; p++) {
    const Property *property = &element->properties[p];
    if (!(ply->encoding == ENCODING_ASCII ? skip_ascii_property : skip_binary_property)(ply, property)) return false;
  }
  return true;
}

static StyStatus fail_short(const char *path, const Element *element, unsigned long long item, StyError *error) {
  return sty_fail(error, STY_ERROR_INPUT, "%s: not a whole mesh: it ends in %s %llu, expected %llu of them", path,
                  element->name, item + 1, element->count);
}

static StyStatus skip_element(const char *path, Ply *ply, const Element *element, StyError *error) {
  if (element->property_count == 0) return STY_OK;
  for (unsigned long long i = 0; i < element->count; i++)
    if (!skip_item(ply, element)) return fail_short(path, element, i, error);
  return STY_OK;
}

static StyStatus walk_items(const char *path, Ply *ply, StyError *error) {
  StyStatus status = STY_OK;
  for (int e = 0; e < ply->element_count && !status; e++) status = skip_element(path, ply, &ply->elements[e], error);
  return status;
}

StyStatus sty_check_ply(const char *path, StyError *error) {
  Ply ply;
  StyStatus status = open_ply(path, NULL, &ply, error);
  if (status != STY_OK) return status;
  status = read_header(path, &ply, error);
  if (status == STY_OK) status = walk_items(path, &ply, error);
  close_ply(&ply);
  return status;
}

/* ---- triangles ---- */

/* What of a file goes into the mesh. Places of values are counted from a vertex' beginning. */
typedef struct Layout {
  int vertices, faces; /* indices of elements */
  size_t stride;       /* of a vertex */
  const Property *position[3], *normal[3], *uv[2];
  size_t places[MAX_PROPERTIES];
  int corners; /* which property of a face is the list of its vertices */
} Layout;

typedef struct Reader {
  const char *path;
  Ply ply;
  Layout layout;
  StyMesh *mesh;
  size_t face; /* the one being read */
} Reader;

static int find_element(const Ply *ply, const char *name) {
  for (int e = 0; e < ply->element_count; e++)
    if (strcmp(ply->elements[e].name, name) == 0) return e;
  return -1;
}

/* NULL where there is none by this name or it is a list. */
static const Property *find_scalar(const Element *element, const char *name) {
  for (int p = 0; p < element->property_count; p++)
    if (strcmp(element->properties[p].name, name) == 0)
      return element->properties[p].count.size ? NULL : &element->properties[p];
  return NULL;
}

/* All of them, or none. */
static bool find_scalars(const Element *element, int count, const char *const *names, const Property **out) {
  bool all = true;
  for (int i = 0; i < count; i++) all &= (out[i] = find_scalar(element, names[i])) != NULL;
  if (!all) out[0] = NULL;
  return all;
}

static bool lay_out_vertices(const Element *element, Layout *layout) {
  static const char *const position[] = {"x", "y", "z"}, *const normal[] = {"nx", "ny", "nz"};
  static const char *const uvs[][2] = {{"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}};
  layout->stride = 0;
  for (int p = 0; p < element->property_count; p++) {
    if (element->properties[p].count.size) return false;
    layout->places[p] = layout->stride;
    layout->stride += element->properties[p].type.size;
  }
  find_scalars(element, 3, normal, layout->normal);
  for (size_t i = 0; i < sizeof uvs / sizeof *uvs; i++)
    if (find_scalars(element, 2, uvs[i], layout->uv)) break;
  return find_scalars(element, 3, position, layout->position);
}

static bool lay_out_faces(const Element *element, Layout *layout) {
  layout->corners = -1;
  for (int p = 0; p < element->property_count; p++) {
    const Property *property = &element->properties[p];
    if (property->count.size == 0) continue;
    const bool corners = strcmp(property->name, "vertex_indices") == 0 || strcmp(property->name, "vertex_index") == 0;
    if (!corners || layout->corners >= 0) return false; /* lists of something else: texture coordinates */
    if (property->type.kind == KIND_FLOAT || property->count.kind == KIND_FLOAT) return false;
    layout->corners = p;
  }
  return layout->corners >= 0;
}

static bool lay_out(const Ply *ply, Layout *layout) {
  layout->vertices = find_element(ply, "vertex");
  layout->faces = find_element(ply, "face");
  return ply->encoding != ENCODING_ASCII && layout->vertices >= 0 && layout->faces > layout->vertices &&
         find_element(ply, "tristrips") < 0 && lay_out_vertices(&ply->elements[layout->vertices], layout) &&
         lay_out_faces(&ply->elements[layout->faces], layout);
}

/* Bytes in the order of this machine's numbers, at the low end. */
static uint64_t read_bits(const unsigned char *at, size_t size, Encoding encoding) {
  uint64_t bits = 0;
  for (size_t i = 0; i < size; i++) bits = bits << 8 | at[encoding == ENCODING_BIG ? i : size - 1 - i];
  return bits;
}

static long long read_integer(const unsigned char *at, Type type, Encoding encoding) {
  const uint64_t bits = read_bits(at, type.size, encoding), sign = (uint64_t)1 << (8 * type.size - 1);
  return type.kind == KIND_SIGNED && bits & sign ? (long long)(bits | ~(sign - 1)) : (long long)bits;
}

static float read_number(const unsigned char *at, Type type, Encoding encoding) {
  if (type.kind != KIND_FLOAT) return (float)read_integer(at, type, encoding);
  const uint64_t bits = read_bits(at, type.size, encoding);
  const uint32_t low = (uint32_t)bits;
  float narrow;
  double wide;
  memcpy(&narrow, &low, sizeof narrow);
  memcpy(&wide, &bits, sizeof wide);
  return type.size == sizeof narrow ? narrow : (float)wide;
}

static void read_numbers(const Reader *reader, const unsigned char *vertex, const Property *const *properties,
                         size_t count, float *out) {
  const Property *first = reader->ply.elements[reader->layout.vertices].properties;
  for (size_t i = 0; i < count; i++) {
    const size_t place = reader->layout.places[properties[i] - first];
    out[i] = read_number(vertex + place, properties[i]->type, reader->ply.encoding);
  }
}

/* Zero where it has no direction. */
static void straighten(float normal[3]) {
  double exact[3] = {(double)normal[0], (double)normal[1], (double)normal[2]};
  const bool good = normalize_vector(exact);
  for (int k = 0; k < 3; k++) normal[k] = good ? (float)exact[k] + 0.0f : 0;
}

static StyStatus read_vertices(Reader *reader, const Element *element, StyError *error) {
  const Layout *layout = &reader->layout;
  StyMesh *mesh = reader->mesh;
  const unsigned long long held = count_left(&reader->ply) / layout->stride;
  if (held < element->count) return fail_short(reader->path, element, held, error);
  if (element->count > 3 * STY_MAX_TRIANGLES)
    return sty_fail(error, STY_ERROR_INPUT, "%s: found %llu vertices, expected at most %zu", reader->path,
                    element->count, 3 * STY_MAX_TRIANGLES);
  const size_t count = mesh->vertex_count = mesh->vertices_read = (size_t)element->count;
  mesh->positions = malloc((3 * count + 1) * sizeof *mesh->positions);
  if (layout->normal[0]) mesh->normals = malloc((3 * count + 1) * sizeof *mesh->normals);
  if (layout->uv[0]) mesh->uvs = malloc((2 * count + 1) * sizeof *mesh->uvs);
  if (!mesh->positions || (layout->normal[0] && !mesh->normals) || (layout->uv[0] && !mesh->uvs))
    return sty_fail_memory(error, reader->path, (double)count * 36);
  mesh->positions[3 * count] = 0;
  for (size_t v = 0; v < count; v++) {
    const unsigned char *vertex = take_bytes(&reader->ply, layout->stride);
    if (!vertex) return fail_short(reader->path, element, v, error);
    read_numbers(reader, vertex, layout->position, 3, &mesh->positions[3 * v]);
    if (mesh->normals) read_numbers(reader, vertex, layout->normal, 3, &mesh->normals[3 * v]);
    if (mesh->normals) straighten(&mesh->normals[3 * v]);
    if (mesh->uvs) read_numbers(reader, vertex, layout->uv, 2, &mesh->uvs[2 * v]);
  }
  return STY_OK;
}

/* Empty faces, points and lines are left out, as the importer does. */
static StyStatus read_corners(Reader *reader, const Property *property, bool *is_plain, StyError *error) {
  StyMesh *mesh = reader->mesh;
  Ply *ply = &reader->ply;
  const Element *element = &ply->elements[reader->layout.faces];
  unsigned long long count = 0;
  if (!skip_count(ply, property->count.size, &count) || count > UINT32_MAX)
    return fail_short(reader->path, element, reader->face, error);
  *is_plain = count <= 3;
  const unsigned char *at = *is_plain ? take_bytes(ply, count * property->type.size) : NULL;
  if (*is_plain && !at) return fail_short(reader->path, element, reader->face, error);
  if (count != 3) return STY_OK;
  for (size_t k = 0; k < 3; k++) {
    const long long index = read_integer(at + k * property->type.size, property->type, ply->encoding);
    if (index < 0 || index >= (long long)mesh->vertex_count)
      return sty_fail_index(reader->path, reader->face, 0, (long)index, mesh->vertex_count, error);
    mesh->indices[3 * mesh->triangle_count + k] = (uint32_t)index;
  }
  mesh->triangle_count++;
  return STY_OK;
}

static StyStatus read_face(Reader *reader, const Element *element, bool *is_plain, StyError *error) {
  StyStatus status = STY_OK;
  for (int p = 0; p < element->property_count && !status; p++) {
    if (p == reader->layout.corners)
      status = read_corners(reader, &element->properties[p], is_plain, error);
    else if (!skip_bytes(&reader->ply, element->properties[p].type.size))
      status = fail_short(reader->path, element, reader->face, error);
  }
  return status;
}

static StyStatus read_faces(Reader *reader, const Element *element, bool *is_plain, StyError *error) {
  StyMesh *mesh = reader->mesh;
  const unsigned long long left = count_left(&reader->ply);
  if (element->count > left) return fail_short(reader->path, element, left, error); /* each takes a byte at least */
  if (element->count > STY_MAX_TRIANGLES) return sty_fail_triangles(reader->path, error);
  const size_t count = (size_t)element->count;
  mesh->indices = malloc((3 * count + 1) * sizeof *mesh->indices);
  if (!mesh->indices) return sty_fail_memory(error, reader->path, (double)(3 * count * sizeof *mesh->indices));
  StyStatus status = STY_OK;
  for (reader->face = 0; reader->face < count && *is_plain && !status; reader->face++)
    status = read_face(reader, element, is_plain, error);
  return status;
}

/* Elements of other kinds are only walked through. */
static StyStatus read_elements(Reader *reader, bool *is_plain, StyError *error) {
  StyStatus status = STY_OK;
  for (int e = 0; e < reader->ply.element_count && *is_plain && !status; e++) {
    const Element *element = &reader->ply.elements[e];
    if (e == reader->layout.vertices)
      status = read_vertices(reader, element, error);
    else if (e == reader->layout.faces)
      status = read_faces(reader, element, is_plain, error);
    else
      status = skip_element(reader->path, &reader->ply, element, error);
  }
  return status;
}

static StyStatus create_mesh(Reader *reader, StyError *error) {
  StyMesh *mesh = reader->mesh = calloc(1, sizeof *mesh);
  if (!mesh) return sty_fail_memory(error, reader->path, sizeof *mesh);
  mesh->path = strdup(reader->path);
  mesh->part_count = 1;
  mesh->paints = malloc(sizeof *mesh->paints);
  if (!mesh->path || !mesh->paints) return sty_fail_memory(error, reader->path, sizeof *mesh->paints);
  *mesh->paints = (StyPaint){{1, 1, 1}, -1};
  return STY_OK;
}

static StyStatus read_triangles(Reader *reader, bool *is_plain, StyError *error) {
  StyStatus status = create_mesh(reader, error);
  if (!status) status = read_elements(reader, is_plain, error);
  if (status || !*is_plain) return status;
  if (reader->mesh->triangle_count == 0) return sty_fail_empty(reader->path, error);
  return sty_fit_mesh(reader->mesh, error);
}

bool sty_is_ply(const char *path) {
  const size_t length = strlen(path);
  return length >= 4 && strcasecmp(path + length - 4, ".ply") == 0;
}

StyStatus sty_read_ply(const char *path, bool keep_normals, const StyRun *run, StyMesh **out, StyError *error) {
  Reader reader = {.path = path};
  StyStatus status = open_ply(path, run, &reader.ply, error);
  if (status) return status;
  status = read_header(path, &reader.ply, error);
  bool is_plain = !status && lay_out(&reader.ply, &reader.layout);
  if (!keep_normals) reader.layout.normal[0] = NULL;
  if (is_plain) status = read_triangles(&reader, &is_plain, error);
  close_ply(&reader.ply);
  if (status || !is_plain)
    sty_destroy_mesh(&reader.mesh);
  else
    *out = reader.mesh;
  return status;
}
