/* Which scenes can be the same things at two times. */
#include "../scratch.h"
#include "stylut/scene.h"

/* A cube, whose upper face is at z = 1 and turned by nothing. */
#define POINTS "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
#define FACES "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4\n"

static StyScene *read_scene(Scratch *scratch, const char *text) {
  StyScene *scene = NULL;
  StyError error = {STY_OK, ""};
  if (read_text_scene(scratch, "mesh.obj", text, -1, &scene, &error)) fail_msg("%s", error.text);
  return scene;
}

static StyStatus compare(Scratch *scratch, const char *here, const char *there, StyError *error) {
  StyScene *scene = read_scene(scratch, here), *other = read_scene(scratch, there);
  const StyStatus status = sty_check_alike(scene, other, error);
  assert_int_equal(sty_check_alike(other, scene, NULL), status);
  sty_destroy_scene(&scene);
  sty_destroy_scene(&other);
  return status;
}

static void test_bent(void **state) {
  static const char *const others[] = {
      /* moved and stretched */
      "v -2 0 0\nv 3 0 0\nv 3 1 0\nv -2 1 0\nv -2 0 9\nv 3 0 9\nv 3 1 9\nv -2 1 9\n" FACES,
      /* nearly flat, so that computed normals are shared across edges that were hard */
      "v -2 -2 0\nv 2 -2 0\nv 2 2 0\nv -2 2 0\nv -1 -1 0.1\nv 1 -1 0.1\nv 1 1 0.1\nv -1 1 0.1\n" FACES,
      /* two corners in one spot, which no triangle has both of */
      "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 -1 -1\nv -1 1 1\n" FACES,
      /* of four corners each, with texture coordinates of their own */
      POINTS
      "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 4/2 3/3 2/4\nf 5/1 6/2 7/3 8/4\nf 1/1 2/2 6/3 5/4\n"
      "f 3/1 4/2 8/3 7/4\nf 2/1 3/2 7/3 6/4\nf 1/1 5/2 8/3 4/4\n"};
  for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
    StyError error = {STY_OK, ""};
    if (compare(*state, POINTS FACES, others[i], &error)) fail_msg("case %zu: %s", i, error.text);
  }
}

static void test_other_triangles(void **state) {
  static const struct {
    const char *text, *part;
  } cases[] = {
      {POINTS "f 1 4 3 2\nf 1 2 6 5\nf 5 6 7 8\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4\n",
       "object 1: found that triangle 5 of"},
      {POINTS "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 6 7 3 2\nf 1 5 8 4\n", "triangle 9 of"},
      {POINTS "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n", "triangle 11 of"},
      {POINTS "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\n", "object 1: found 6 triangles, expected 12"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    StyError error = {STY_OK, ""};
    assert_int_equal(compare(*state, POINTS FACES, cases[i].text, &error), STY_ERROR_INPUT);
    if (!strstr(error.text, cases[i].part)) fail_msg("'%s' lacks '%s'", error.text, cases[i].part);
  }
}

/* Instances: the second object's mesh is looked at, too. */
static void test_objects(void **state) {
  static const char other[] = POINTS "f 5 6 7 8\nf 1 4 3 2\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4\n";
  StyScene *scenes[2];
  for (int s = 0; s < 2; s++) {
    StyMesh *mesh = NULL;
    scenes[s] = read_scene(*state, POINTS FACES);
    assert_int_equal(read_text_mesh(*state, "mesh.obj", s ? other : POINTS FACES, -1, &mesh, NULL), STY_OK);
    StyObject object = scenes[s]->objects[0];
    assert_int_equal(sty_add_mesh(scenes[s], &mesh, &object.mesh, NULL), STY_OK);
    if (!s) object.mesh = 0;
    assert_int_equal(sty_add_object(scenes[s], &object, NULL), STY_OK);
    assert_int_equal(sty_finish_scene(scenes[s], NULL), STY_OK);
  }
  StyError error = {STY_OK, ""};
  assert_int_equal(sty_check_alike(scenes[0], scenes[0], &error), STY_OK);
  assert_int_equal(sty_check_alike(scenes[0], scenes[1], &error), STY_ERROR_INPUT);
  assert_non_null(strstr(error.text, "object 2: found that triangle"));
  assert_int_equal(sty_add_sphere(scenes[1], &(StySphere){.radius = 1}, NULL), STY_OK);
  assert_int_equal(sty_check_alike(scenes[0], scenes[1], &error), STY_ERROR_INPUT);
  assert_string_equal(error.text, "found 2 objects and 1 sphere, expected 2 objects and 0 spheres");
  for (int s = 0; s < 2; s++) sty_destroy_scene(&scenes[s]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_bent),
      cmocka_unit_test(test_other_triangles),
      cmocka_unit_test(test_objects),
  };
  return cmocka_run_group_tests(tests, open_scratch, close_scratch);
}
