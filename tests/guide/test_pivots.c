/* Pivots: where they are seen, as text, and from JSON. */
#include "stylut/pivots.h"

#include <math.h>

#include "../scene/scratch.h"
#include "stylut/scene_file.h"

static StyPivots find(Scratch *scratch, const char *camera, int width, int height) {
  static const char corners[] = "v 2 0 0\nv 4 0 0\nv 2 1 0\nv 2 0 -3\nf 1 2 3\nf 1 3 4\n";
  char text[1024], mesh[800];
  snprintf(text, sizeof text,
           "{ \"schema\": \"stylut-scene/1\", \"camera\": { %s },"
           "  \"objects\": [ { \"mesh\": \"m.obj\", \"transform\": [0,-1,0,0.5, 1,0,0,1, 0,0,1,1.5, 0,0,0,1] } ],"
           "  \"spheres\": [ { \"center\": [2,1,-4], \"radius\": 1 }, { \"center\": [0,0,30], \"radius\": 1 } ] }",
           camera);
  write_bytes(scratch, "m.obj", corners, sizeof corners - 1);
  snprintf(mesh, sizeof mesh, "%s", scratch->path);
  write_bytes(scratch, "s.json", text, strlen(text));
  StyScene *scene = NULL;
  StyViewpoint viewpoint;
  StyCamera lens;
  StyPivots pivots;
  StyError error;
  const StyMeshOptions options = {.crease_angle = -1};
  assert_int_equal(sty_read_scene(scratch->path, &options, &scene, &viewpoint, &error), STY_OK);
  assert_int_equal(sty_set_camera(scene, &viewpoint, width, height, &lens, &error), STY_OK);
  assert_int_equal(sty_find_pivots(scene, &lens, width, height, &pivots, &error), STY_OK);
  sty_destroy_scene(&scene);
  unlink(scratch->path);
  unlink(mesh);
  return pivots;
}

static void expect_pivot(const StyPivots *pivots, size_t i, int object, double x, double y) {
  assert_true(i < pivots->count);
  assert_int_equal(pivots->items[i].object, object);
  if (pivots->items[i].x != x || pivots->items[i].y != y)
    fail_msg("found %.17g %.17g, expected %.17g %.17g", pivots->items[i].x, pivots->items[i].y, x, y);
}

/* The box's middle (3, 0.5, -1.5) is turned to (-0.5, 3, -1.5) and moved to (0, 4, 0). */
static void test_orthographic(void **state) {
  StyPivots pivots =
      find(*state, "\"type\": \"orthographic\", \"position\": [0,0,9], \"target\": [0,0,0], \"height\": 16", 320, 160);
  assert_int_equal(pivots.count, 3);
  expect_pivot(&pivots, 0, 1, 160, 40);
  expect_pivot(&pivots, 1, 2, 180, 70);
  expect_pivot(&pivots, 2, 3, 160, 80); /* behind the eye, but on the film */
  sty_free_pivots(&pivots);
}

/* 53.13 degrees: the film's half at distance 1 is 1/2. The sphere behind the eye has no place. */
static void test_perspective(void **state) {
  char camera[160];
  snprintf(camera, sizeof camera,
           "\"type\": \"perspective\", \"position\": [0,0,16], \"target\": [0,0,0], \"fov\": %.17g",
           2 * atan(0.5) * 180 / M_PI);
  StyPivots pivots = find(*state, camera, 321, 321);
  assert_int_equal(pivots.count, 2);
  expect_pivot(&pivots, 0, 1, 160.5, 80.25);
  expect_pivot(&pivots, 1, 2, 192.6, 144.45); /* 2/20 and 1/20 of 1/2, from the middle, in halves of the picture */
  sty_free_pivots(&pivots);
}

static void test_text(void **state) {
  (void)state;
  StyPivot items[] = {{1, 512.25, 300.5}, {2, -0.0, -17}, {65535, 8388608, -0.001}};
  const StyPivots pivots = {items, 3};
  StyPivots back;
  StyError error;
  char *text = NULL;
  assert_int_equal(sty_encode_pivots(&pivots, &text, &error), STY_OK);
  assert_string_equal(text, "1 512.25 300.5; 2 0 -17; 65535 8388608 -0.001");
  assert_int_equal(sty_decode_pivots("g.exr", text, &back, &error), STY_OK);
  assert_int_equal(back.count, 3);
  for (size_t i = 0; i < 3; i++) expect_pivot(&back, i, items[i].object, items[i].x, items[i].y);
  sty_free_pivots(&back);
  free(text);
  assert_int_equal(sty_encode_pivots(&(StyPivots){items, 0}, &text, &error), STY_OK);
  assert_string_equal(text, "");
  assert_int_equal(sty_decode_pivots("g.exr", text, &back, &error), STY_OK);
  assert_int_equal(back.count, 0);
  sty_free_pivots(&back);
  free(text);
}

static void test_bad_text(void **state) {
  (void)state;
  static const char *const bad[] = {"x",           "1",      "1 2",      "1 2 x",        "0 1 2",        "65536 1 2",
                                    "1 2 3;",      "1 2 3,", "1 2 3; x", "2 1 1; 1 1 1", "1 1 1; 1 1 1", "1 nan 2",
                                    "1 8388609 2", "1 2 inf"};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    StyPivots pivots = {NULL, 7};
    StyError error;
    if (sty_decode_pivots("g.exr", bad[i], &pivots, &error) != STY_ERROR_INPUT) fail_msg("'%s' passes", bad[i]);
    assert_ptr_equal(strstr(error.text, "g.exr: found '"), error.text);
    assert_int_equal(pivots.count, 7);
  }
}

static StyStatus read_json(Scratch *scratch, const char *text, StyPivotFile *out, StyError *error) {
  const StyStatus status = sty_read_pivots(write_bytes(scratch, "p.json", text, strlen(text)), out, error);
  unlink(scratch->path);
  return status;
}

static void test_json(void **state) {
  StyPivotFile file;
  StyError error;
  assert_int_equal(
      read_json(*state, "{\"schema\":\"stylut-pivots/1\",\"pivots\":{\"7\":[1,2.5],\"3\":[-4,0]}}", &file, &error),
      STY_OK);
  const StyPivots *pivots = sty_get_frame_pivots(&file, 12);
  assert_non_null(pivots);
  assert_int_equal(pivots->count, 2);
  expect_pivot(pivots, 0, 3, -4, 0);
  expect_pivot(pivots, 1, 7, 1, 2.5);
  sty_free_pivot_file(&file);
  assert_int_equal(
      read_json(*state, "{\"schema\":\"stylut-pivots/1\",\"frames\":{\"12\":{\"1\":[5,6]},\"0\":{}}}", &file, &error),
      STY_OK);
  assert_null(sty_get_frame_pivots(&file, 1));
  assert_int_equal(sty_get_frame_pivots(&file, 0)->count, 0);
  expect_pivot(sty_get_frame_pivots(&file, 12), 0, 1, 5, 6);
  sty_free_pivot_file(&file);
}

static void test_bad_json(void **state) {
  static const struct {
    const char *text, *message;
  } bad[] = {
      {"{\n \"pivots\": {}}", "p.json:1:1: found none, expected a key \"schema\""},
      {"{\"schema\":\"stylut-pivots/2\"}", ":1:11: schema: found \"stylut-pivots/2\", expected \"stylut-pivots/1\""},
      {"{\"schema\":\"stylut-pivots/1\"}", ":1:1: found neither \"pivots\" nor \"frames\", expected one of them"},
      {"{\"schema\":\"stylut-pivots/1\",\"pivots\":{},\"frames\":{}}", "found \"pivots\" and \"frames\""},
      {"{\"schema\":\"stylut-pivots/1\",\"pivot\":{}}", "pivot: found an unknown key"},
      {"{\"schema\":\"stylut-pivots/1\",\"pivots\":[]}", ":1:38: pivots: found a list of 0, expected an object"},
      {"{\"schema\":\"stylut-pivots/1\",\n\"pivots\":{\"0\":[1,2]}}",
       ":2:15: pivots.0: found \"0\", expected a number"},
      {"{\"schema\":\"stylut-pivots/1\",\"pivots\":{\"01\":[1,2]}}", "pivots.01: found \"01\""},
      {"{\"schema\":\"stylut-pivots/1\",\"pivots\":{\"1\":[1]}}", "pivots.1: found a list of 1, expected a list of 2"},
      {"{\"schema\":\"stylut-pivots/1\",\"pivots\":{\"1\":[1,1e9]}}", "pivots.1[1]: found 1000000000, expected"},
      {"{\"schema\":\"stylut-pivots/1\",\"frames\":{\"-1\":{}}}", "frames.-1: found \"-1\", expected a number from 0"},
      {"{\"schema\":\"stylut-pivots/1\",\"frames\":{\"1\":{},\"2\":3}}", "frames.2: found 3, expected an object"},
      {"{\"schema\":\"stylut-pivots/1\",\"frames\":{\"1\":{\"1\":[0,0]},\"1\":{}}}", "duplicate"},
  };
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    StyPivotFile file = {.count = 7};
    StyError error = {STY_OK, ""};
    if (read_json(*state, bad[i].text, &file, &error) != STY_ERROR_INPUT || !strstr(error.text, bad[i].message))
      fail_msg("'%s': found '%s', expected '%s'", bad[i].text, error.text, bad[i].message);
    assert_int_equal(file.count, 7);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_orthographic), cmocka_unit_test(test_perspective), cmocka_unit_test(test_text),
      cmocka_unit_test(test_bad_text),     cmocka_unit_test(test_json),        cmocka_unit_test(test_bad_json),
  };
  return cmocka_run_group_tests(tests, open_scratch, close_scratch);
}
