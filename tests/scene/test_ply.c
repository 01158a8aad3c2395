/* Binary PLY files of triangles, which are read here rather than by the importer: the same meshes from both. */
#include <math.h>

#include "scratch.h"

/* A roof of four triangles with a ridge, all its vertices shared, and one that nothing uses. */
enum { VERTICES = 7, FACES = 4 };
static const float POINTS[VERTICES][3] = {{0, 0, 0}, {2, 0, 0}, {9, 9, 9}, {0, 1, 1}, {2, 1, 1}, {0, 2, 0}, {2, 2, 0}};
static const float NORMALS[VERTICES][3] = {{0, -2, 2}, {0, -1, 1}, {1, 0, 0}, {0, 0, 0},
                                           {0, 0, 4},  {0, 1, 1},  {0, 1, 1}};
static const int TRIANGLES[FACES][3] = {{0, 1, 4}, {0, 4, 3}, {3, 4, 6}, {3, 6, 5}};

/* How a file is written. */
typedef struct Shape {
  const char *format;                  /* of PLY */
  const char *number, *index, *length; /* types */
  const char *list;                    /* name of the list of vertices */
  bool with_normals, with_uvs, with_extras;
} Shape;

typedef struct Text {
  unsigned char bytes[4096];
  size_t size;
} Text;

static void add_bytes(Text *text, const void *value, size_t size, bool is_big) {
  for (size_t i = 0; i < size; i++)
    text->bytes[text->size++] = ((const unsigned char *)value)[is_big ? size - 1 - i : i];
}

static void add_value(Text *text, const Shape *shape, const char *type, double value) {
  const bool is_big = strstr(shape->format, "big");
  const int8_t c = (int8_t)(int)value;
  const int16_t s = (int16_t)(int)value;
  const int32_t i = (int32_t)value;
  const float f = (float)value;
  if (strcmp(shape->format, "ascii") == 0) {
    text->size += (size_t)sprintf((char *)text->bytes + text->size, "%.9g ", value);
    return;
  }
  if (strstr(type, "char")) add_bytes(text, &c, sizeof c, is_big);
  if (strstr(type, "short")) add_bytes(text, &s, sizeof s, is_big);
  if (strstr(type, "int")) add_bytes(text, &i, sizeof i, is_big);
  if (strcmp(type, "float") == 0) add_bytes(text, &f, sizeof f, is_big);
  if (strcmp(type, "double") == 0) add_bytes(text, &value, sizeof value, is_big);
}

static void add_header(Text *text, const Shape *shape) {
  char *at = (char *)text->bytes;
  at += sprintf(at, "ply\nformat %s 1.0\n", shape->format);
  if (shape->with_extras)
    at += sprintf(at, "element camera 2\nproperty double tilt\nproperty list uchar short marks\n");
  at += sprintf(at, "element vertex %d\n", VERTICES);
  for (int k = 0; k < 3; k++) at += sprintf(at, "property %s %c\n", shape->number, "xyz"[k]);
  if (shape->with_extras) at += sprintf(at, "property uchar red\n");
  if (shape->with_normals) at += sprintf(at, "property float nx\nproperty float ny\nproperty float nz\n");
  if (shape->with_uvs) at += sprintf(at, "property float u\nproperty float v\n");
  at += sprintf(at, "element face %d\n", FACES);
  if (shape->with_extras) at += sprintf(at, "property short flags\n");
  at += sprintf(at, "property list %s %s %s\nend_header\n", shape->length, shape->index, shape->list);
  text->size = (size_t)(at - (char *)text->bytes);
}

static void add_line_end(Text *text, const Shape *shape) {
  if (strcmp(shape->format, "ascii") == 0) text->bytes[text->size++] = '\n';
}

static void add_vertices(Text *text, const Shape *shape) {
  for (int v = 0; v < VERTICES; v++) {
    for (int k = 0; k < 3; k++) add_value(text, shape, shape->number, (double)POINTS[v][k]);
    if (shape->with_extras) add_value(text, shape, "uchar", 200);
    for (int k = 0; k < 3 && shape->with_normals; k++) add_value(text, shape, "float", (double)NORMALS[v][k]);
    for (int k = 0; k < 2 && shape->with_uvs; k++) add_value(text, shape, "float", (double)POINTS[v][k] / 2);
    add_line_end(text, shape);
  }
}

static Text write_shape(const Shape *shape) {
  Text text = {.size = 0};
  add_header(&text, shape);
  for (int i = 0; i < 2 && shape->with_extras; i++) {
    add_value(&text, shape, "double", 0.5);
    add_value(&text, shape, "uchar", i + 1);
    for (int m = 0; m <= i; m++) add_value(&text, shape, "short", 7);
    add_line_end(&text, shape);
  }
  add_vertices(&text, shape);
  for (int t = 0; t < FACES; t++) {
    if (shape->with_extras) add_value(&text, shape, "short", 1);
    add_value(&text, shape, shape->length, 3);
    for (int k = 0; k < 3; k++) add_value(&text, shape, shape->index, TRIANGLES[t][k]);
    add_line_end(&text, shape);
  }
  return text;
}

static StyStatus read_text(Scratch *scratch, const Text *text, double crease_angle, int threads, StyMesh **mesh,
                           StyError *error) {
  const StyRun run = {.threads = threads};
  const StyMeshOptions options = {.crease_angle = crease_angle, .run = &run};
  const StyStatus status = sty_read_mesh(write_bytes(scratch, "a.ply", text->bytes, text->size), &options, mesh, error);
  unlink(scratch->path);
  return status;
}

static StyMesh *read_shape(Scratch *scratch, const Shape *shape, double crease_angle) {
  StyMesh *mesh = NULL;
  StyError error;
  const Text text = write_shape(shape);
  if (read_text(scratch, &text, crease_angle, 0, &mesh, &error)) fail_msg("%s: %s", shape->format, error.text);
  return mesh;
}

/* Triangle by triangle, whatever the numbers of vertices. */
static void expect_same_mesh(const StyMesh *found, const StyMesh *expected) {
  assert_int_equal(found->triangle_count, expected->triangle_count);
  assert_int_equal(found->vertex_count, expected->vertex_count);
  assert_int_equal(found->vertices_read, expected->vertices_read);
  assert_int_equal(found->part_count, expected->part_count);
  assert_true(found->scale == expected->scale && found->crease_angle == expected->crease_angle);
  assert_memory_equal(found->centre, expected->centre, sizeof found->centre);
  assert_int_equal(!found->uvs, !expected->uvs);
  for (size_t c = 0; c < 3 * found->triangle_count; c++) {
    const size_t a = found->indices[c], b = expected->indices[c];
    assert_memory_equal(&found->positions[3 * a], &expected->positions[3 * b], 3 * sizeof(float));
    assert_memory_equal(&found->normals[3 * a], &expected->normals[3 * b], 3 * sizeof(float));
    if (found->uvs) assert_memory_equal(&found->uvs[2 * a], &expected->uvs[2 * b], 2 * sizeof(float));
  }
}

/* The importer reads the text, so that import_bytes tells who read what. */
static void test_binary_is_as_text(void **state) {
  static const char *const formats[] = {"binary_little_endian", "binary_big_endian"};
  static const char *const types[][3] = {{"float", "int", "uchar"},
                                         {"double", "uint", "uchar"},
                                         {"short", "ushort", "int"},
                                         {"int", "uchar", "ushort"},
                                         {"float", "char", "char"}};
  for (int mode = 0; mode < 8; mode++)
    for (size_t f = 0; f < 2; f++)
      for (size_t t = 0; t < sizeof types / sizeof *types; t++) {
        Shape shape = {formats[f], types[t][0], types[t][1], types[t][2], f ? "vertex_index" : "vertex_indices",
                       mode & 1,   mode & 2,    mode & 4};
        StyMesh *found = read_shape(*state, &shape, mode & 1 ? -1 : 30);
        shape.format = "ascii";
        shape.with_extras = false; /* of which none goes into the mesh */
        StyMesh *expected = read_shape(*state, &shape, mode & 1 ? -1 : 30);
        assert_true(found->import_bytes == 0 && expected->import_bytes > 0);
        assert_int_equal(found->vertices_read, VERTICES);
        expect_same_mesh(found, expected);
        sty_destroy_mesh(&found);
        sty_destroy_mesh(&expected);
      }
}

static const Shape PLAIN = {"binary_little_endian", "float", "int", "uchar", "vertex_indices", false, false, false};

static void test_computed_normals(void **state) {
  StyMesh *smooth = read_shape(*state, &PLAIN, 180), *hard = read_shape(*state, &PLAIN, 30);
  assert_int_equal(smooth->vertex_count, 6); /* without the unused one */
  assert_int_equal(hard->vertex_count, 8);   /* the ridge twice */
  const float *ridge = &smooth->normals[3 * smooth->indices[5]];
  assert_true(fabsf(ridge[0]) < 1e-6F && fabsf(ridge[1]) < 1e-6F && ridge[2] > 0.999F);
  const float *side = &hard->normals[3 * hard->indices[5]];
  assert_true(fabs(side[1] + sqrt(0.5)) < 1e-6 && fabs(side[2] - sqrt(0.5)) < 1e-6);
  sty_destroy_mesh(&smooth);
  sty_destroy_mesh(&hard);
}

/* Polygons, text, strips and texture coordinates of faces. */
static void test_others_go_to_the_importer(void **state) {
  static const char QUAD[] =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar uchar vertex_indices\nend_header\n";
  static const float SQUARE[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  static const unsigned char FACE[] = {4, 0, 1, 2, 3};
  Text text = {.size = sizeof QUAD - 1};
  memcpy(text.bytes, QUAD, text.size);
  memcpy(text.bytes + text.size, SQUARE, sizeof SQUARE);
  memcpy(text.bytes + text.size + sizeof SQUARE, FACE, sizeof FACE);
  text.size += sizeof SQUARE + sizeof FACE;
  StyMesh *mesh = NULL;
  StyError error;
  assert_int_equal(read_text(*state, &text, -1, 0, &mesh, &error), STY_OK);
  assert_int_equal(mesh->triangle_count, 2);
  assert_true(mesh->import_bytes > 0);
  sty_destroy_mesh(&mesh);
}

/* What stands at `at` bytes before the end of the plain file becomes `value`. */
static void expect_refusal(Scratch *scratch, size_t at, const void *value, size_t size, const char *expected) {
  Text text = write_shape(&PLAIN);
  memcpy(text.bytes + text.size - at, value, size);
  StyMesh *mesh = NULL;
  StyError error;
  assert_int_equal(read_text(scratch, &text, -1, 0, &mesh, &error), STY_ERROR_INPUT);
  assert_null(mesh);
  if (!strstr(error.text, expected) || !strstr(error.text, "a.ply")) fail_msg("'%s' lacks '%s'", error.text, expected);
}

static void test_refusals(void **state) {
  static const size_t FACE = 13, ALL_FACES = FACES * 13, VERTEX = 12;
  const int32_t over = VERTICES, under = -1;
  const float nan = NAN, huge = 3e38F;
  expect_refusal(*state, 4, &over, 4, "face 4 of mesh 1 (counted from 1) asks for vertex index 7, expected 0 to 6");
  expect_refusal(*state, FACE + 4, &under, 4, "face 3 of mesh 1 (counted from 1) asks for vertex index -1");
  expect_refusal(*state, ALL_FACES + VERTEX, &nan, 4, "vertex 7 of mesh 1 (counted from 1) is (nan");
  expect_refusal(*state, ALL_FACES + VERTEX, &huge, 4, "lies at (3e+38");
  Text text = write_shape(&PLAIN);
  memset(text.bytes + text.size - ALL_FACES - VERTICES * VERTEX, 0, VERTICES * VERTEX);
  StyMesh *mesh = NULL;
  StyError error;
  assert_int_equal(read_text(*state, &text, -1, 0, &mesh, &error), STY_ERROR_INPUT);
  assert_non_null(strstr(error.text, "none of its 4 triangles has an area"));
}

/* A header that promises more than memory holds is refused by the size of the file. */
static void test_promises(void **state) {
  static const char *const from[] = {"element vertex 7", "element face 4"}, *const to[] = {"element vertex 4000000000",
                                                                                           "element face 4000000000"};
  for (int i = 0; i < 2; i++) {
    const Text text = write_shape(&PLAIN);
    Text more = {.size = 0};
    const unsigned char *at = memmem(text.bytes, text.size, from[i], strlen(from[i]));
    assert_non_null(at);
    const size_t before = (size_t)(at - text.bytes), rest = text.size - before - strlen(from[i]);
    memcpy(more.bytes, text.bytes, before);
    memcpy(more.bytes + before, to[i], strlen(to[i]));
    memcpy(more.bytes + before + strlen(to[i]), at + strlen(from[i]), rest);
    more.size = before + strlen(to[i]) + rest;
    StyMesh *mesh = NULL;
    StyError error;
    assert_int_equal(read_text(*state, &more, -1, 0, &mesh, &error), STY_ERROR_INPUT);
    assert_non_null(strstr(error.text, "expected 4000000000 of them"));
  }
}

/* A grid of boxes' sides: more points than a block has, hard edges and smooth ones. */
static char *write_waves(size_t side, size_t *size) {
  const size_t vertices = side * side, faces = 2 * (side - 1) * (side - 1);
  char *bytes = malloc(512 + 12 * vertices + 13 * faces);
  assert_non_null(bytes);
  *size =
      (size_t)sprintf(bytes,
                      "ply\nformat binary_little_endian 1.0\nelement vertex %zu\nproperty float x\nproperty float y\n"
                      "property float z\nelement face %zu\nproperty list uchar int vertex_indices\nend_header\n",
                      vertices, faces);
  for (size_t v = 0; v < vertices; v++) {
    const float at[3] = {(float)(v / side), (float)(v % side), (float)(v / side % 7 == 0) + (float)(v % side % 5 == 0)};
    memcpy(bytes + *size, at, sizeof at);
    *size += sizeof at;
  }
  for (size_t f = 0; f < faces; f++) {
    const size_t cell = f / 2, corner = cell / (side - 1) * side + cell % (side - 1);
    const int32_t first = (int32_t)corner, across = (int32_t)(corner + side + 1),
                  third = (int32_t)(f % 2 ? corner + 1 : corner + side);
    const int32_t corners[3] = {first, f % 2 ? across : third, f % 2 ? third : across};
    bytes[(*size)++] = 3;
    memcpy(bytes + *size, corners, sizeof corners);
    *size += sizeof corners;
  }
  return bytes;
}

static void test_threads_change_nothing(void **state) {
  Scratch *scratch = *state;
  size_t size;
  char *text = write_waves(400, &size);
  StyMesh *meshes[2] = {NULL, NULL};
  for (int i = 0; i < 2; i++) {
    const StyRun run = {.threads = i ? 3 : 1};
    const StyMeshOptions options = {.crease_angle = 40, .run = &run};
    assert_int_equal(sty_read_mesh(write_bytes(scratch, "waves.ply", text, size), &options, &meshes[i], NULL), STY_OK);
    unlink(scratch->path);
  }
  free(text);
  assert_true(meshes[0]->vertex_count > 160000);         /* some were split */
  for (size_t v = 0; v < meshes[0]->vertex_count; v++) { /* of every block */
    const float *n = &meshes[0]->normals[3 * v];
    assert_true(fabsf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-5F);
  }
  assert_int_equal(meshes[0]->vertex_count, meshes[1]->vertex_count);
  assert_memory_equal(meshes[0]->indices, meshes[1]->indices, 3 * meshes[0]->triangle_count * sizeof(uint32_t));
  assert_memory_equal(meshes[0]->normals, meshes[1]->normals, 3 * meshes[0]->vertex_count * sizeof(float));
  for (int i = 0; i < 2; i++) sty_destroy_mesh(&meshes[i]);
}

/* Somebody shortens the file while it is read. */
static void shorten(void *context, double done) {
  const Scratch *scratch = context;
  if (done < 0.5) assert_int_equal(truncate(scratch->path, 5 << 20), 0);
}

static void test_shortened(void **state) {
  Scratch *scratch = *state;
  size_t size;
  char *text = write_waves(700, &size);
  assert_true(size > 16 << 20);
  const StyRun run = {.progress = shorten, .context = scratch};
  StyMesh *mesh = NULL;
  StyError error = {STY_OK, ""};
  assert_int_equal(sty_read_mesh(write_bytes(scratch, "waves.ply", text, size),
                                 &(StyMeshOptions){.crease_angle = 40, .run = &run}, &mesh, &error),
                   STY_ERROR_INPUT);
  assert_null(mesh);
  assert_non_null(strstr(error.text, "waves.ply: not a whole mesh: it ends in vertex "));
  unlink(scratch->path);
  free(text);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_binary_is_as_text),
      cmocka_unit_test(test_computed_normals),
      cmocka_unit_test(test_others_go_to_the_importer),
      cmocka_unit_test(test_refusals),
      cmocka_unit_test(test_promises),
      cmocka_unit_test(test_threads_change_nothing),
      cmocka_unit_test(test_shortened),
  };
  return cmocka_run_group_tests(tests, open_scratch, close_scratch);
}
