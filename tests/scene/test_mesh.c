#include <math.h>

#include "scratch.h"
#include "stylut/version.h"

static void expect_refusal(Scratch *scratch, const char *name, const char *text, StyStatus expected,
                           const char *expected_text) {
  StyMesh *scene = NULL;
  StyError error = {STY_OK, ""};
  assert_int_equal(read_text_mesh(scratch, name, text, -1, &scene, &error), expected);
  assert_null(scene);
  if (!strstr(error.text, name) || !strstr(error.text, expected_text))
    fail_msg("'%s' names neither '%s' nor '%s'", error.text, name, expected_text);
}

static StyMesh *read_scene(Scratch *scratch, const char *name, const char *text, double crease_angle) {
  StyMesh *scene = NULL;
  StyError error = {STY_OK, ""};
  if (read_text_mesh(scratch, name, text, crease_angle, &scene, &error) != STY_OK) fail_msg("%s", error.text);
  return scene;
}

static double get_facet(const StyMesh *scene, size_t t, double normal[3]) {
  double e[2][3];
  for (int i = 0; i < 2; i++)
    for (int k = 0; k < 3; k++)
      e[i][k] = (double)scene->positions[3 * scene->indices[3 * t + (size_t)i + 1] + (size_t)k] -
                scene->positions[3 * scene->indices[3 * t] + (size_t)k];
  for (int k = 0; k < 3; k++) normal[k] = e[0][(k + 1) % 3] * e[1][(k + 2) % 3] - e[0][(k + 2) % 3] * e[1][(k + 1) % 3];
  const double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
  for (int k = 0; k < 3; k++) normal[k] /= length;
  return length / 2;
}

/* Largest difference between a corner's normal and its facet's. */
static double get_facet_deviation(const StyMesh *scene) {
  double worst = 0;
  for (size_t t = 0; t < scene->triangle_count; t++) {
    double facet[3];
    get_facet(scene, t, facet);
    for (size_t i = 0; i < 9; i++)
      worst = fmax(worst, fabs(facet[i % 3] - scene->normals[3 * scene->indices[3 * t + i / 3] + i % 3]));
  }
  return worst;
}

static void expect_outward(const StyMesh *scene) {
  for (size_t t = 0; t < scene->triangle_count; t++) {
    double facet[3], outward = 0;
    assert_true(get_facet(scene, t, facet) > 0);
    for (size_t k = 0; k < 3; k++) outward += facet[k] * scene->normals[3 * scene->indices[3 * t] + k];
    assert_true(outward > 0);
  }
}

static void test_cube_is_cut_and_shared(void **state) {
  StyMesh *scene = read_scene(*state, "cube.obj", CUBE_OBJ, 30);
  assert_int_equal(scene->triangle_count, 12);
  assert_int_equal(scene->vertex_count, 24);
  assert_int_equal(scene->part_count, 1);
  for (int k = 0; k < 3; k++) {
    assert_true(scene->minimum[k] == -1 && scene->maximum[k] == 1 && scene->centre[k] == 0);
  }
  assert_true(scene->scale == 1);
  sty_destroy_mesh(&scene);
  assert_null(scene);
  sty_destroy_mesh(&scene);
}

static void test_crease_angle(void **state) {
  StyMesh *sharp = read_scene(*state, "cube.obj", CUBE_OBJ, 30);
  assert_true(get_facet_deviation(sharp) < 1e-7);
  sty_destroy_mesh(&sharp);
  StyMesh *smooth = read_scene(*state, "cube.obj", CUBE_OBJ, 180);
  assert_int_equal(smooth->vertex_count, 8);
  for (size_t i = 0; i < 24; i++) assert_true(fabs(smooth->normals[i] - smooth->positions[i] / sqrt(3)) < 1e-6);
  sty_destroy_mesh(&smooth);
}

/* Shared indices are where importers like to get smooth normals wrong. */
static void test_smooth_normals_of_indexed_files(void **state) {
  static const char CUBE_OFF[] =
      "OFF\n8 6 0\n-1 -1 -1\n1 -1 -1\n1 1 -1\n-1 1 -1\n-1 -1 1\n1 -1 1\n1 1 1\n-1 1 1\n"
      "4 0 3 2 1\n4 4 5 6 7\n4 0 1 5 4\n4 2 3 7 6\n4 1 2 6 5\n4 0 4 7 3\n";
  StyMesh *scene = read_scene(*state, "cube.off", CUBE_OFF, 180);
  assert_int_equal(scene->vertex_count, 8);
  for (size_t i = 0; i < 24; i++) assert_true(fabs(scene->normals[i] - scene->positions[i] / sqrt(3)) < 1e-6);
  sty_destroy_mesh(&scene);
}

static void test_file_normals(void **state) {
  static const char TILTED[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 3 4\nvn 0 0 0\nvn nan 0 1\nf 1//1 2//2 3//3\n";
  StyMesh *scene = read_scene(*state, "tilted.obj", TILTED, -1);
  assert_int_equal(scene->vertex_count, 3);
  assert_true(fabs(scene->normals[1] - 0.6) < 1e-6 && fabs(scene->normals[2] - 0.8) < 1e-6);
  assert_true(scene->normals[5] == 1 && scene->normals[8] == 1);
  sty_destroy_mesh(&scene);
  scene = read_scene(*state, "tilted.obj", TILTED, 60);
  for (size_t v = 0; v < 3; v++) assert_true(scene->normals[3 * v + 2] == 1);
  sty_destroy_mesh(&scene);
}

static void test_stl_normals_do_not_count(void **state) {
  char text[4096] = "solid cube\n";
  static const int QUADS[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {1, 3, 7, 5}, {0, 4, 6, 2}};
  for (int q = 0; q < 6; q++)
    for (int half = 0; half < 2; half++) {
      strcat(text, "facet normal 0 0 1\nouter loop\n");
      for (int c = 0; c < 3; c++) {
        const int v = QUADS[q][c == 0 ? 0 : c + half];
        snprintf(text + strlen(text), sizeof text - strlen(text), "vertex %d %d %d\n", v & 1, v >> 1 & 1, v >> 2);
      }
      strcat(text, "endloop\nendfacet\n");
    }
  strcat(text, "endsolid cube\n");
  StyMesh *scene = read_scene(*state, "cube.stl", text, -1);
  assert_int_equal(scene->triangle_count, 12);
  assert_true(get_facet_deviation(scene) < 1e-7);
  sty_destroy_mesh(&scene);
  scene = read_scene(*state, "cube.stl", text, 100);
  assert_int_equal(scene->vertex_count, 8);
  sty_destroy_mesh(&scene);
}

static void test_tiny_and_far_meshes(void **state) {
  static const struct { double at, edge; } CASES[] = {{0, 1e-24}, {0, 1e-30}, {1e8, 4096}, {-1e8, 1024}, {0, 1e29}};
  for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
    char text[1024];
    print_tetrahedron(text, sizeof text, CASES[i].at, CASES[i].edge);
    StyMesh *scene = read_scene(*state, "tetrahedron.obj", text, 30);
    assert_int_equal(scene->triangle_count, 4);
    float low = 1, high = -1;
    for (size_t v = 0; v < 3 * scene->vertex_count; v++) {
      low = fminf(low, scene->positions[v]);
      high = fmaxf(high, scene->positions[v]);
    }
    assert_true(low == -1 && high == 1);
    assert_true(get_facet_deviation(scene) < 1e-6);
    assert_true(fabs(scene->maximum[0] - CASES[i].at - CASES[i].edge) <= 1e-6 * CASES[i].edge);
    sty_destroy_mesh(&scene);
  }
}

/* The polygons of tiny meshes are cut as those of others. */
static void test_tiny_polygons(void **state) {
  static const char ARROW[] = "v 0 0 0\nv %1$s 0 0\nv %1$s %1$s 0\nv 0 %1$s 0\nv %2$s %2$s 0\nf 1 2 3 4 5\n";
  for (int tiny = 0; tiny < 2; tiny++) {
    char text[256];
    snprintf(text, sizeof text, ARROW, tiny ? "4e-24" : "4", tiny ? "1.5e-24" : "1.5");
    StyMesh *scene = read_scene(*state, "arrow.obj", text, -1);
    assert_int_equal(scene->triangle_count, 3);
    double area = 0, normal[3];
    for (size_t t = 0; t < 3; t++) area += get_facet(scene, t, normal);
    assert_true(fabs(area - 4 * (1 - 0.375 * 0.5)) < 1e-5);
    sty_destroy_mesh(&scene);
  }
}

static void test_flat_triangles_are_left_out(void **state) {
  StyMesh *scene =
      read_scene(*state, "some.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv 90 0 0\nf 1 2 5\nf 1 2 3\n", -1);
  assert_int_equal(scene->triangle_count, 1);
  assert_true(scene->maximum[0] == 1);
  sty_destroy_mesh(&scene);
}

static void test_empty_faces_are_left_out(void **state) {
  static const char TEXT[] =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 3\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0\n3 0 1 2\n0\n";
  StyMesh *scene = read_scene(*state, "some.ply", TEXT, -1);
  assert_int_equal(scene->triangle_count, 1);
  sty_destroy_mesh(&scene);
}

static void test_bad_geometry(void **state) {
  expect_refusal(*state, "nan.obj", "v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n", STY_ERROR_INPUT, "nan");
  expect_refusal(*state, "inf.obj", "v 0 0 0\nv 1 0 0\nv 0 1e39 0\nf 1 2 3\n", STY_ERROR_INPUT, "inf");
  expect_refusal(*state, "huge.obj", "v 0 0 0\nv 3e38 0 0\nv 0 -3e38 0\nf 1 2 3\n", STY_ERROR_INPUT, "3e+38");
  expect_refusal(*state, "flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", STY_ERROR_INPUT, "area");
  expect_refusal(*state, "point.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", STY_ERROR_INPUT, "area");
  expect_refusal(*state, "lines.obj", "v 0 0 0\nv 1 0 0\nv 2 1 0\nl 1 2\nl 2 3\n", STY_ERROR_INPUT, "no faces");
}

static void test_bad_indices(void **state) {
  static const char HEADER[] =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
  char text[512];
  snprintf(text, sizeof text, "%s3 0 1 3\n", HEADER);
  expect_refusal(*state, "over.ply", text, STY_ERROR_INPUT, "index 3");
  snprintf(text, sizeof text, "%s3 0 1 -1\n", HEADER);
  expect_refusal(*state, "under.ply", text, STY_ERROR_INPUT, "index -1");
  expect_refusal(*state, "over.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", STY_ERROR_INPUT, "range");
  expect_refusal(*state, "over.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", STY_ERROR_INPUT, "face");
}

/* A triangle, ASCII and binary; every proper beginning must be refused. */
static void test_truncated_ply(void **state) {
  Scratch *scratch = *state;
  static const char FORMAT[] =
      "ply\nformat %s 1.0\ncomment one triangle\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  static const float VERTICES[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  static const unsigned char FACE[13] = {3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0};
  for (int binary = 0; binary < 2; binary++) {
    char file[512];
    size_t size = (size_t)snprintf(file, sizeof file, FORMAT, binary ? "binary_little_endian" : "ascii");
    if (binary) {
      memcpy(file + size, VERTICES, sizeof VERTICES);
      memcpy(file + size + sizeof VERTICES, FACE, sizeof FACE);
      size += sizeof VERTICES + sizeof FACE;
    } else {
      size += (size_t)snprintf(file + size, sizeof file - size, "0 0 0\n1 0 0\n0 1 0\n3 0 1 2");
    }
    for (size_t cut = 0; cut <= size; cut++) {
      StyMesh *scene = NULL;
      StyError error = {STY_OK, ""};
      const StyStatus status = sty_read_mesh(write_bytes(scratch, "part.ply", file, cut), NULL, &scene, &error);
      unlink(scratch->path);
      if (status != (cut == size ? STY_OK : STY_ERROR_INPUT)) fail_msg("%zu of %zu bytes: %s", cut, size, error.text);
      if (status != STY_OK) assert_non_null(strstr(error.text, "part.ply"));
      sty_destroy_mesh(&scene);
    }
  }
}

static void test_not_a_mesh(void **state) {
  Scratch *scratch = *state;
  static const char *const NAMES[] = {"text.obj", "text.ply", "text.stl", "text.gltf",
                                      "text.glb", "text.fbx", "text.off"};
  for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; i++) {
    expect_refusal(scratch, NAMES[i], "once upon a time\nthere was no mesh here at all\n", STY_ERROR_INPUT, "mesh");
    expect_refusal(scratch, NAMES[i], "", STY_ERROR_INPUT, "expected");
  }
  expect_refusal(scratch, "picture.png", "PNG", STY_ERROR_INPUT, ".glb");
  StyMesh *scene = NULL;
  StyError error;
  char path[768];
  snprintf(path, sizeof path, "%s/missing.obj", scratch->folder);
  assert_int_equal(sty_read_mesh(path, NULL, &scene, &error), STY_ERROR_FILE);
  assert_non_null(strstr(error.text, "missing.obj"));
  const StyMeshOptions beyond = {.crease_angle = 181};
  assert_int_equal(sty_read_mesh(path, &beyond, &scene, &error), STY_ERROR_USAGE);
}

/* Three corners of a right-angled triangle at the origin, normals along +Z,
 * and indices 0 1 2, as glTF buffer. */
#define GLTF_TRIANGLE                                                                                             \
  "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1},\"indices\":2}]}],"                 \
  "\"buffers\":[{\"byteLength\":78,\"uri\":\"data:application/octet-stream;base64,"                               \
  "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/AAABAAIA\"}]," \
  "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":36},"         \
  "{\"buffer\":0,\"byteOffset\":72,\"byteLength\":6}],"                                                           \
  "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"                       \
  "{\"bufferView\":1,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"                                      \
  "{\"bufferView\":2,\"componentType\":5123,\"count\":3,\"type\":\"SCALAR\"}]"

static void test_node_transforms(void **state) {
  static const char TREE[] =
      "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
      "\"nodes\":[{\"children\":[1,2,3]},{\"mesh\":0},{\"mesh\":0,\"scale\":[-1,1,1]},"
      "{\"mesh\":0,\"translation\":[0,0,5],\"scale\":[2,4,1],\"rotation\":[0.70710678,0,0,0.70710678]}]," GLTF_TRIANGLE
      "}";
  StyMesh *scene = read_scene(*state, "tree.gltf", TREE, -1);
  assert_int_equal(scene->triangle_count, 3);
  assert_int_equal(scene->part_count, 3);
  for (size_t t = 0; t < 3; t++) assert_int_equal(scene->part_ids[t], t + 1);
  expect_outward(scene);
  assert_true(get_facet_deviation(scene) < 1e-6);
  static const double LOW[3] = {-1, 0, 0}, HIGH[3] = {2, 1, 9};
  for (int k = 0; k < 3; k++) {
    assert_true(fabs(scene->minimum[k] - LOW[k]) < 1e-5);
    assert_true(fabs(scene->maximum[k] - HIGH[k]) < 1e-5);
  }
  sty_destroy_mesh(&scene);
}

static void test_deep_trees(void **state) {
  enum { DEPTH = 400 };
  static char text[DEPTH * 24 + 4096];
  strcpy(text, "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[");
  size_t used = strlen(text);
  for (int i = 0; i < DEPTH; i++)
    used += (size_t)snprintf(text + used, sizeof text - used, "{\"children\":[%d]},", i + 1);
  strcat(text, "{\"mesh\":0}]," GLTF_TRIANGLE "}");
  expect_refusal(*state, "deep.gltf", text, STY_ERROR_INPUT, "nested");
}

static void test_version(void **state) {
  (void)state;
  assert_int_equal(strncmp(sty_get_mesh_library_version(), "Assimp 5.", 9), 0);
}

/* The largest coordinate, and one just beyond: the same answer whatever the format, though a float's 1e30 is more. */
static void test_largest_coordinate(void **state) {
  static const char *const texts[][2] = {
      {"a.obj", "v 0 0 0\nv %s 0 0\nv 0 -%s 0\nf 1 2 3\n"},
      {"a.off", "OFF\n3 1 0\n0 0 0\n%s 0 0\n0 -%s 0\n3 0 1 2\n"},
      {"a.stl",
       "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex %s 0 0\nvertex 0 -%s 0\nendloop\n"
       "endfacet\nendsolid a\n"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
       "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n%s 0 0\n0 -%s 0\n3 0 1 2\n"},
      {"b.ply",
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
       "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n%s 0 0\n0 -%s 0\n3 0 1 2\n"}};
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
    for (int beyond = 0; beyond < 2; beyond++) {
      char *text = NULL;
      StyMesh *mesh = NULL;
      StyError error = {STY_OK, ""};
      const char *value = beyond ? "1.001e30" : "1e30";
      assert_true(asprintf(&text, texts[i][1], value, value) > 0);
      const StyStatus status = read_text_mesh(*state, texts[i][0], text, -1, &mesh, &error);
      if (status != (beyond ? STY_ERROR_INPUT : STY_OK)) fail_msg("%s of %s: '%s'", texts[i][0], value, error.text);
      if (beyond) assert_non_null(strstr(error.text, "expected coordinates from -1e+30 to 1e+30"));
      sty_destroy_mesh(&mesh);
      free(text);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_cube_is_cut_and_shared),
      cmocka_unit_test(test_crease_angle),
      cmocka_unit_test(test_smooth_normals_of_indexed_files),
      cmocka_unit_test(test_file_normals),
      cmocka_unit_test(test_stl_normals_do_not_count),
      cmocka_unit_test(test_tiny_and_far_meshes),
      cmocka_unit_test(test_tiny_polygons),
      cmocka_unit_test(test_flat_triangles_are_left_out),
      cmocka_unit_test(test_empty_faces_are_left_out),
      cmocka_unit_test(test_bad_geometry),
      cmocka_unit_test(test_bad_indices),
      cmocka_unit_test(test_truncated_ply),
      cmocka_unit_test(test_not_a_mesh),
      cmocka_unit_test(test_node_transforms),
      cmocka_unit_test(test_deep_trees),
      cmocka_unit_test(test_version),
      cmocka_unit_test(test_largest_coordinate),
  };
  return cmocka_run_group_tests(tests, open_scratch, close_scratch);
}
