/* Meshes that are broken in known ways, and what is made of them. */
#include "stylut/repair.h"

#include "scratch.h"

static StyMesh *read_mesh(Scratch *scratch, const char *name, const char *text, double crease_angle) {
  StyMesh *mesh = NULL;
  StyError error = {STY_OK, ""};
  if (read_text_mesh(scratch, name, text, crease_angle, &mesh, &error) != STY_OK) fail_msg("%s", error.text);
  return mesh;
}

static StyMeshSurvey survey(Scratch *scratch, const char *name, const char *text) {
  StyMesh *mesh = read_mesh(scratch, name, text, -1);
  StyMeshSurvey found;
  assert_int_equal(sty_survey_mesh(mesh, &found, NULL), STY_OK);
  sty_destroy_mesh(&mesh);
  return found;
}

static bool is_manifold(const StyMeshSurvey *s) { return !s->clashes && !s->tangles; }

/* The cube [-1, 1]^3 of 12 triangles, clean, and with three triangles turned round, two given twice (one of them
 * turned), one with a repeated index and one without area. */
#define CUBE_TAIL "3 2 3 7\n3 2 7 6\n3 1 2 6\n3 1 6 5\n3 0 4 7\n3 0 7 3\n"
#define CLEAN_CUBE                                                                    \
  "OFF\n8 12 0\n-1 -1 -1\n1 -1 -1\n1 1 -1\n-1 1 -1\n-1 -1 1\n1 -1 1\n1 1 1\n-1 1 1\n" \
  "3 0 3 2\n3 0 2 1\n3 4 5 6\n3 4 6 7\n3 0 1 5\n3 0 5 4\n" CUBE_TAIL
#define DIRTY_CUBE                                                                    \
  "OFF\n8 16 0\n-1 -1 -1\n1 -1 -1\n1 1 -1\n-1 1 -1\n-1 -1 1\n1 -1 1\n1 1 1\n-1 1 1\n" \
  "3 0 2 3\n3 0 2 1\n3 4 6 5\n3 0 0 1\n3 4 6 7\n3 0 1 5\n3 4 5 6\n3 0 4 5\n3 0 2 1\n" CUBE_TAIL "3 0 0 0\n"

static void test_clean_cube(void **state) {
  const StyMeshSurvey found = survey(*state, "cube.off", CLEAN_CUBE);
  assert_int_equal(found.points, 8);
  assert_int_equal(found.triangles, 12);
  assert_int_equal(found.components, 1);
  assert_int_equal(found.repeated + found.flat + found.copies + found.clashes + found.tangles + found.borders, 0);
  assert_int_equal(found.holes, 0);
}

/* Two shells, one of them open in two places, and a face that stands on an edge of the other. */
static void test_counts(void **state) {
  static const char TEXT[] =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 1\nv 5 0 0\nv 6 0 0\nv 6 1 0\nv 5 1 0\nv 5 0 1\nv 6 0 1\nv 6 1 1\n"
      "v 5 1 1\nv 9 9 9\nv 0 2 0\n"
      "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nf 1 2 5\n"        /* a tetrahedron and a fin */
      "f 6 7 11 10\nf 7 8 12 11\nf 8 9 13 12\nf 9 6 10 13\n" /* a tube */
      "f 1 3 15\n";                                          /* no area */
  const StyMeshSurvey found = survey(*state, "shells.obj", TEXT);
  assert_int_equal(found.triangles, 13);
  assert_int_equal(found.flat, 1);
  assert_int_equal(found.repeated, 0);
  assert_int_equal(found.tangles, 1);
  assert_int_equal(found.components, 2);
  assert_int_equal(found.borders, 2 + 8);
  assert_int_equal(found.holes, 3);
}

#ifdef STY_WITH_CGAL

/* Sharp edges stay sharp and smooth ones smooth only where neighbours agree: so computed normals tell. */
static void test_dirty_cube(void **state) {
  StyMesh *clean = read_mesh(*state, "clean.off", CLEAN_CUBE, 120),
          *dirty = read_mesh(*state, "dirty.off", DIRTY_CUBE, 120);
  StyRepair repair;
  assert_true(dirty->vertex_count > clean->vertex_count);
  assert_int_equal(sty_repair_mesh(dirty, &repair, NULL), STY_OK);
  assert_int_equal(repair.found.triangles, 14);
  assert_int_equal(repair.found.repeated, 2);
  assert_int_equal(repair.found.copies, 2);
  assert_int_equal(repair.removed, 2);
  assert_int_equal(repair.turned, 3);
  assert_true(repair.found.clashes > 0);
  assert_true(is_manifold(&repair.left));
  assert_int_equal(repair.left.triangles, 12);
  assert_int_equal(repair.left.copies, 0);
  assert_int_equal(repair.found.holes, 0);
  assert_int_equal(dirty->triangle_count, clean->triangle_count);
  assert_int_equal(dirty->vertex_count, clean->vertex_count);
  for (size_t c = 0; c < 3 * clean->triangle_count; c++) {
    const size_t v = clean->indices[c], w = dirty->indices[c];
    assert_memory_equal(&clean->positions[3 * v], &dirty->positions[3 * w], 3 * sizeof(float));
    for (size_t k = 0; k < 3; k++)
      assert_true(clean->normals[3 * v + k] - dirty->normals[3 * w + k] < 1e-6F &&
                  dirty->normals[3 * w + k] - clean->normals[3 * v + k] < 1e-6F);
  }
  sty_destroy_mesh(&clean);
  sty_destroy_mesh(&dirty);
}

/* The fewer side turns, whichever the first triangle is on. */
static void test_fewer_turn(void **state) {
  static const char TEXT[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 0 0\nf 1 3 2\nf 1 3 4\nf 1 4 5\n";
  StyMesh *mesh = read_mesh(*state, "sheet.obj", TEXT, -1);
  StyRepair repair;
  assert_int_equal(sty_repair_mesh(mesh, &repair, NULL), STY_OK);
  assert_int_equal(repair.found.clashes, 1);
  assert_int_equal(repair.turned, 1);
  for (size_t v = 0; v < mesh->vertex_count; v++) assert_true(mesh->normals[3 * v + 2] == 1);
  sty_destroy_mesh(&mesh);
}

/* A Moebius strip has no two sides; it stays a soup. */
static void test_strip_of_one_side(void **state) {
  static const char TEXT[] =
      "v 1 0 -0.3\nv 1 0 0.3\nv -0.5 0.9 -0.2\nv -0.5 0.9 0.2\nv -0.5 -0.9 0.2\nv -0.5 -0.9 -0.1\n"
      "f 1 2 3\nf 2 4 3\nf 3 4 5\nf 4 6 5\nf 5 6 2\nf 6 1 2\n";
  StyMesh *mesh = read_mesh(*state, "strip.obj", TEXT, -1);
  StyRepair repair;
  assert_int_equal(sty_repair_mesh(mesh, &repair, NULL), STY_OK);
  assert_false(is_manifold(&repair.left));
  assert_int_equal(mesh->triangle_count, 6);
  sty_destroy_mesh(&mesh);
}

#else

static void test_without_cgal(void **state) {
  StyMesh *dirty = read_mesh(*state, "dirty.off", DIRTY_CUBE, -1);
  StyRepair repair;
  StyError error;
  assert_int_equal(sty_repair_mesh(dirty, &repair, &error), STY_ERROR_UNAVAILABLE);
  assert_int_equal(dirty->triangle_count, 14);
  sty_destroy_mesh(&dirty);
}

#endif

static void test_nothing_to_repair(void **state) {
  StyMesh *mesh = read_mesh(*state, "clean.off", CLEAN_CUBE, -1);
  const float *positions = mesh->positions;
  StyRepair repair;
  assert_int_equal(sty_repair_mesh(mesh, &repair, NULL), STY_OK);
  assert_int_equal(repair.removed + repair.turned, 0);
  assert_true(is_manifold(&repair.left));
  assert_ptr_equal(mesh->positions, positions);
  sty_destroy_mesh(&mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_clean_cube),        cmocka_unit_test(test_counts),
#ifdef STY_WITH_CGAL
      cmocka_unit_test(test_dirty_cube),        cmocka_unit_test(test_fewer_turn),
      cmocka_unit_test(test_strip_of_one_side),
#else
      cmocka_unit_test(test_without_cgal),
#endif
      cmocka_unit_test(test_nothing_to_repair),
  };
  return cmocka_run_group_tests(tests, open_scratch, close_scratch);
}
