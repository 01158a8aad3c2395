#include <math.h>

#include "scratch.h"
#include "stylut/scene_file.h"

static const char CUBE[] = CUBE_OBJ;

/* Reads scene.json with this text beside cube.obj. */
static StyStatus read_text(Scratch *scratch, const char *text, StyScene **scene, StyViewpoint *viewpoint,
                           StyError *error) {
  char mesh[sizeof scratch->path];
  write_bytes(scratch, "cube.obj", CUBE, strlen(CUBE));
  memcpy(mesh, scratch->path, sizeof mesh);
  const StyStatus status =
      sty_read_scene(write_bytes(scratch, "scene.json", text, strlen(text)), NULL, scene, viewpoint, error);
  unlink(scratch->path);
  unlink(mesh);
  return status;
}

static StyScene *read_good(Scratch *scratch, const char *text, StyViewpoint *viewpoint) {
  StyScene *scene = NULL;
  StyError error = {STY_OK, ""};
  if (read_text(scratch, text, &scene, viewpoint, &error)) fail_msg("%s", error.text);
  return scene;
}

/* ---- what is read ------------------------------------------------------------- */

static void test_whole(void **state) {
  StyViewpoint viewpoint;
  StyScene *scene = read_good(
      *state,
      "{\"schema\": \"stylut-scene/1\",\n \"camera\": {\"type\": \"perspective\", \"position\": [0, 1, 6], \"target\": "
      "[0, 0, 0], \"up\": [0, 0.5, 0], \"fov\": 40},\n \"objects\": [{\"mesh\": \"cube.obj\"}, {\"mesh\": "
      "\"cube.obj\", "
      "\"style\": 7, \"transform\": [2, 0, 0, 10, 0, 1, 0, -3, 0, 0, 0.5, 4, 0, 0, 0, 1]}],\n"
      "\"spheres\": [{\"center\": [0, 5, 0], \"radius\": 2, \"style\": 0}]}",
      &viewpoint);
  assert_int_equal(scene->mesh_count, 1); /* shared */
  assert_int_equal(scene->object_count, 2);
  assert_int_equal(scene->sphere_count, 1);
  assert_int_equal(sty_count_scene_triangles(scene), 24);
  assert_int_equal(scene->objects[0].style, 1);
  assert_int_equal(scene->objects[1].style, 7);
  assert_int_equal(scene->spheres[0].style, 0);
  assert_int_equal(scene->objects[0].first_id, 1);
  assert_int_equal(scene->objects[1].first_id, 2);
  assert_int_equal(scene->spheres[0].id, 3);
  static const double low[3] = {-2, -4, -2}, high[3] = {12, 7, 4.5};
  for (int k = 0; k < 3; k++) {
    assert_true(fabs(scene->minimum[k] - low[k]) < 1e-6);
    assert_true(fabs(scene->maximum[k] - high[k]) < 1e-6);
    assert_true(fabs(scene->centre[k] - (low[k] + high[k]) / 2) < 1e-6);
  }
  assert_true(fabs(scene->scale - 2.0 / 14) < 1e-7);
  assert_true(!viewpoint.is_fit && viewpoint.stand.perspective && viewpoint.stand.fov == 40);
  assert_true(viewpoint.stand.position[2] == 6 && viewpoint.stand.up[1] == 0.5);
  sty_destroy_scene(&scene);
}

static void test_defaults(void **state) {
  StyViewpoint viewpoint;
  StyScene *scene = read_good(*state, "{\"schema\": \"stylut-scene/1\", \"spheres\": [{}]}", &viewpoint);
  assert_true(scene->spheres[0].radius == 1 && scene->spheres[0].style == 1 && scene->spheres[0].centre[1] == 0);
  assert_true(viewpoint.is_fit && !viewpoint.view.perspective && viewpoint.view.azimuth == 0);
  StyCamera camera;
  assert_int_equal(sty_set_camera(scene, &viewpoint, 64, 64, &camera, NULL), STY_OK);
  assert_true(fabs(camera.half_width - 1 / 0.9) < 1e-12 && fabs(camera.eye[2] - 1) < 1e-12);
  sty_destroy_scene(&scene);
  scene =
      read_good(*state,
                "{\"schema\": \"stylut-scene/1\", \"camera\": {\"view\": \"90,0\", \"up\": [0, 0, 1], \"fov\": 20}, "
                "\"objects\": [{\"mesh\": \"cube.obj\"}]}",
                &viewpoint);
  assert_true(viewpoint.is_fit && viewpoint.view.perspective && viewpoint.view.up == STY_UP_Z);
  assert_true(viewpoint.view.azimuth == 90 && viewpoint.view.fov == 20);
  sty_destroy_scene(&scene);
}

/* A camera that stands: its axes and film, in the trace space of a sphere of radius 2 about the origin. */
static void test_stands(void **state) {
  StyViewpoint viewpoint;
  StyCamera camera;
  StyScene *scene = read_good(*state,
                              "{\"schema\": \"stylut-scene/1\", \"camera\": {\"type\": \"orthographic\", \"position\": "
                              "[0, 8, 0], \"target\": [0, 0, 0], \"up\": [0, 0, -3], \"height\": 6}, \"spheres\": "
                              "[{\"radius\": 2}]}",
                              &viewpoint);
  assert_int_equal(sty_set_camera(scene, &viewpoint, 200, 100, &camera, NULL), STY_OK);
  static const double right[3] = {1, 0, 0}, up[3] = {0, 0, -1}, back[3] = {0, 1, 0};
  for (int k = 0; k < 3; k++) {
    assert_true(fabs(camera.right[k] - right[k]) < 1e-15 && fabs(camera.up[k] - up[k]) < 1e-15);
    assert_true(fabs(camera.back[k] - back[k]) < 1e-15);
  }
  assert_true(fabs(camera.half_height - 1.5) < 1e-15 && fabs(camera.half_width - 3) < 1e-15);
  assert_true(fabs(camera.eye[1] - 4) < 1e-15);
  StyStand stand = viewpoint.stand;
  StyError error = {STY_OK, ""};
  stand.up[2] = 0;
  stand.up[1] = 1; /* which it looks along */
  assert_int_equal(sty_place_camera(scene, &stand, 8, 8, &camera, &error), STY_ERROR_INPUT);
  assert_non_null(strstr(error.text, "up"));
  stand = viewpoint.stand;
  memcpy(stand.target, stand.position, sizeof stand.target);
  assert_int_equal(sty_place_camera(scene, &stand, 8, 8, &camera, &error), STY_ERROR_INPUT);
  assert_int_equal(sty_place_camera(scene, &viewpoint.stand, 0, 8, &camera, &error), STY_ERROR_USAGE);
  sty_destroy_scene(&scene);
}

/* Of a file that names meshes which aren't there, and lacks what a scene needs. */
static void test_camera_alone(void **state) {
  Scratch *scratch = *state;
  static const char good[] =
      "{\"schema\": \"stylut-scene/1\", \"camera\": {\"type\": \"perspective\", \"position\": [1, 2, 3], "
      "\"target\": [0, 0, 1], \"up\": [0, 0, 1], \"fov\": 50}, \"objects\": [{\"mesh\": \"none.obj\"}]}";
  static const char *const bad[][2] = {
      {"{\"schema\": \"stylut-scene/1\", \"camera\": {\"type\": \"fit\"}}", "camera.type: found \"fit\""},
      {"{\"schema\": \"stylut-scene/1\", \"camera\": {}}", "camera: found"},
      {"{\"schema\": \"stylut-scene/1\"}", "no key \"camera\""}};
  StyStand stand = {.fov = 1};
  StyError error = {STY_OK, ""};
  assert_int_equal(sty_read_stand(write_bytes(scratch, "camera.json", good, strlen(good)), &stand, &error), STY_OK);
  assert_true(stand.perspective && stand.position[2] == 3 && stand.target[2] == 1 && stand.up[1] == 0 &&
              stand.fov == 50);
  for (int b = 0; b < 3; b++) {
    write_bytes(scratch, "camera.json", bad[b][0], strlen(bad[b][0]));
    assert_int_equal(sty_read_stand(scratch->path, &stand, &error), STY_ERROR_INPUT);
    if (!strstr(error.text, bad[b][1])) fail_msg("'%s' lacks '%s'", error.text, bad[b][1]);
    assert_true(stand.fov == 50);
  }
  unlink(scratch->path);
}

/* ---- what is refused ---------------------------------------------------------- */

#define HEAD "{\"schema\": \"stylut-scene/1\",\n"
#define LIGHTS_4 \
  "{\"direction\": [0, 0, 1]}, {\"direction\": [0, 0, 1]}, {\"direction\": [0, 0, 1]}, {\"direction\": [0, 0, 1]}, "
#define LIGHTS_16 LIGHTS_4 LIGHTS_4 LIGHTS_4 LIGHTS_4
#define LIGHTS_64 LIGHTS_16 LIGHTS_16 LIGHTS_16 LIGHTS_16

static void test_refused(void **state) {
  static const struct {
    const char *text, *parts[3];
  } cases[] = {
      {"[]", {"an object"}},
      {"{}", {"schema"}},
      {"{\"schema\": \"stylut-scene/2\", \"spheres\": [{}]}", {"stylut-scene/1", ":1:12:"}},
      {HEAD "\"sphere\": []}", {":2:11:", "sphere", "unknown key"}},
      {HEAD "\"objects\": []}", {"nothing in it"}},
      {HEAD "\"objects\": {}}", {":2:12:", "a list"}},
      {HEAD "\"objects\": [7]}", {":2:13:", "objects[0]", "an object"}},
      {HEAD "\"objects\": [{\"mesh\": \"\"}]}", {":2:22: objects[0].mesh: found \"\""}},
      {HEAD "\"objects\": [{\"style\": 1}]}", {":2:13: objects[0]: found no key \"mesh\", expected"}},
      {HEAD "\"objects\": [{\"mesh\": \"cube.obj\", \"style\": 256}]}", {"objects[0].style", "256", "0 to 255"}},
      {HEAD "\"objects\": [{\"mesh\": \"cube.obj\", \"style\": 1.5}]}", {"objects[0].style", "1.5"}},
      {HEAD "\"objects\": [{\"mesh\": \"cube.obj\", \"transform\": [1, 2]}]}", {"transform", "a list of 2", "16"}},
      {HEAD "\"objects\": [{\"mesh\": \"cube.obj\", \"transform\": [1,0,0,0, 0,1,0,0, 0,0,1,\"x\", 0,0,0,1]}]}",
       {"transform[11]", "\"x\""}},
      {HEAD "\"objects\": [{\"mesh\": \"cube.obj\", \"transform\": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,2]}]}",
       {":2:81: objects[0].transform[15]: found 2, expected 1"}},
      {HEAD "\"objects\": [{\"mesh\": \"cube.obj\", \"transform\": [1,0,0,0, 0,1,0,0, 1,1,0,0, 0,0,0,1]}]}",
       {"objects[0].transform: found one that makes things flat", "three directions"}},
      {HEAD "\"objects\": [{\"mesh\": \"cube.obj\", \"transform\": [0,0,0,0, 0,0,0,0, 0,0,0,0, 0,0,0,1]}]}",
       {"objects[0].transform: found one that makes things flat", "three directions"}},
      {HEAD "\"objects\": [{\"mesh\": \"cube.obj\", \"transform\": [1,0,0,2e30, 0,1,0,0, 0,0,1,0, 0,0,0,1]}]}",
       {"transform[3]", "1e+30"}},
      {HEAD "\"spheres\": [{\"radius\": 0}]}", {"spheres[0].radius", "found 0"}},
      {HEAD "\"spheres\": [{\"radius\": -1}]}", {"spheres[0].radius"}},
      {HEAD "\"spheres\": [{\"centre\": [0, 0, 0]}]}", {"centre", "unknown key", "center"}},
      {HEAD "\"spheres\": [{\"center\": [0, 0]}]}", {"spheres[0].center", "a list of 2", "3 numbers"}},
      {HEAD "\"spheres\": [{\"color\": [1, 2, 0]}]}", {"spheres[0].color[1]", "found 2", "0 to 1"}},
      {HEAD "\"spheres\": [{\"shininess\": 0}]}", {"spheres[0].shininess", "1 to 10000"}},
      {HEAD "\"spheres\": [{}], \"lights\": [{\"type\": \"spot\"}]}", {"lights[0].type", "spot", "directional"}},
      {HEAD "\"spheres\": [{}], \"lights\": [{\"type\": \"point\"}]}",
       {":2:29: lights[0]: found no key \"position\"", "where the light stands"}},
      {HEAD "\"spheres\": [{}], \"lights\": [{\"position\": [0, 0, 1]}]}",
       {":2:29: lights[0]: found a \"position\" but no \"type\"", "\"point\""}},
      {HEAD "\"spheres\": [{}], \"lights\": {}}", {":2:28: lights: found an object", "at most 64 lights"}},
      {HEAD "\"spheres\": [{}],\n\"lights\": [" LIGHTS_64 "{\"direction\": [0, 0, 1]}]}",
       {":3:11: lights: found a list of 65", "at most 64 lights"}},
      {HEAD "\"spheres\": [{}], \"lights\": [{}]}", {"lights[0]", "direction"}},
      {HEAD "\"spheres\": [{}], \"lights\": [{\"direction\": [0, 0, 0]}]}",
       {":2:43: lights[0].direction: found the direction (0, 0, 0)", "with a length"}},
      {HEAD "\"spheres\": [{}], \"lights\": [{\"direction\": [0, 0, 1], \"intensity\": -1}]}", {"intensity", "-1"}},
      {HEAD "\"spheres\": [{}], \"shadows\": 1}", {"shadows", "true or false"}},
      {HEAD "\"spheres\": [{}], \"ambient\": \"dim\"}", {"ambient", "dim"}},
      {HEAD "\"spheres\": [{}], \"camera\": 1}", {"camera", "an object"}},
      {HEAD "\"spheres\": [{}], \"camera\": {\"type\": \"fisheye\"}}", {"camera.type", "fisheye", "perspective"}},
      {HEAD "\"spheres\": [{}], \"camera\": {\"type\": \"perspective\"}}",
       {":2:28: camera: found no key \"position\"", "where the camera stands"}},
      {HEAD "\"spheres\": [{}], \"camera\": {\"position\": [0, 0, 5], \"target\": [0, 0, 0]}}",
       {":2:28: camera: found a \"position\" but no \"type\"", "\"perspective\" or \"orthographic\""}},
      {HEAD "\"spheres\": [{}], \"camera\": {\"type\": \"perspective\", \"position\": [0,0,9], \"target\": [0,0,9]}}",
       {":2:28: camera: found position and target in one place"}},
      {HEAD "\"spheres\": [{}], \"camera\": {\"type\": \"perspective\", \"position\": [0,9,0], \"target\": [0,0,0]}}",
       {":2:28: camera: found the up (0, 1, 0)", "doesn't look along"}},
      {HEAD "\"spheres\": [{}], \"camera\": {\"type\": \"orthographic\", \"position\": [0,0,9], \"target\": [0,0,0]}}",
       {"height"}},
      {HEAD "\"spheres\": [{}], \"camera\": {\"view\": \"behind\"}}", {"camera.view", "behind", "three-quarter"}},
      {HEAD "\"spheres\": [{}], \"camera\": {\"up\": [1, 1, 0]}}", {":2:35: camera.up: found [1, 1, 0]", "axis"}},
      {HEAD "\"spheres\": [{}], \"camera\": {\"height\": 2}}", {"camera: found a \"height\" but no \"type\""}},
      {HEAD "\"spheres\": [{}], \"camera\": {\"type\": \"fit\", \"height\": 2}}", {"camera.height", "unknown key"}},
      {HEAD "\"spheres\": [{}], \"camera\": {\"fov\": 171}}", {"camera.fov", "171"}},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    StyScene *scene = NULL;
    StyViewpoint viewpoint;
    StyError error = {STY_OK, ""};
    if (read_text(*state, cases[i].text, &scene, &viewpoint, &error) != STY_ERROR_INPUT)
      fail_msg("case %zu: found '%s', expected an input error", i, error.text);
    assert_null(scene);
    assert_non_null(strstr(error.text, "scene.json"));
    for (int p = 0; p < 3 && cases[i].parts[p]; p++)
      if (!strstr(error.text, cases[i].parts[p]))
        fail_msg("case %zu: '%s' lacks '%s'", i, error.text, cases[i].parts[p]);
  }
}

static void test_lights(void **state) {
  StyViewpoint viewpoint;
  StyScene *scene = read_good(*state,
                              HEAD
                              "\"spheres\": [{\"color\": [1, 0.5, 0], \"specular\": 0.25}, {}],\n"
                              "\"lights\": [{\"direction\": [0, -1, 0]}, {\"type\": \"point\", \"position\": [1, 2, "
                              "3], \"intensity\": 5, \"color\": [2, 0, 1]}], \"shadows\": false}",
                              &viewpoint);
  assert_int_equal(scene->light_count, 2);
  assert_true(!scene->lights[0].is_point && scene->lights[0].intensity == 1 && scene->lights[0].direction[1] == -1);
  assert_true(scene->lights[1].is_point && scene->lights[1].intensity == 5 && scene->lights[1].position[2] == 3);
  assert_true(scene->lights[1].colour[0] == 2 && scene->ambient == 0.1 && !scene->shadows);
  assert_true(scene->spheres[0].material.paint.colour[1] == 0.5 && scene->spheres[0].material.specular == 0.25);
  assert_true(scene->spheres[0].material.shininess == 32 && scene->spheres[1].material.paint.colour[1] == 1);
  sty_destroy_scene(&scene);
  scene = read_good(*state, HEAD "\"spheres\": [{}], \"lights\": []}", &viewpoint);
  assert_true(scene->ambient == 1 && scene->shadows); /* evenly lit */
  sty_destroy_scene(&scene);
  scene = read_good(*state, HEAD "\"spheres\": [{}], \"ambient\": 0.5}", &viewpoint);
  assert_true(scene->ambient == 0.5);
  sty_destroy_scene(&scene);
}

static void test_missing_mesh(void **state) {
  StyScene *scene = NULL;
  StyViewpoint viewpoint;
  StyError error = {STY_OK, ""};
  assert_int_equal(read_text(*state, HEAD "\"objects\": [{\"mesh\": \"cone.obj\"}]}", &scene, &viewpoint, &error),
                   STY_ERROR_FILE);
  assert_non_null(strstr(error.text, "scene.json:2:22: objects[0].mesh: "));
  assert_non_null(strstr(error.text, "cone.obj: "));
  assert_null(scene);
  assert_int_equal(read_text(*state, HEAD "\"objects\": [{\"mesh\": \"scene.json\"}]}", &scene, &viewpoint, &error),
                   STY_ERROR_INPUT);
  assert_non_null(strstr(error.text, "scene.json:2:22: objects[0].mesh: "));
  assert_null(scene);
}

/* What editors put before a file's first character doesn't count. */
static void test_byte_order_mark(void **state) {
  StyViewpoint viewpoint;
  StyScene *scene = read_good(*state, "\xef\xbb\xbf" HEAD "\"spheres\": [{}]}", &viewpoint);
  StyError error = {STY_OK, ""};
  sty_destroy_scene(&scene);
  assert_int_equal(read_text(*state, "\xef\xbb\xbf{\"sphere\": []}", &scene, &viewpoint, &error), STY_ERROR_INPUT);
  assert_non_null(strstr(error.text, ":1:12: sphere"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_whole),        cmocka_unit_test(test_defaults),        cmocka_unit_test(test_stands),
      cmocka_unit_test(test_camera_alone), cmocka_unit_test(test_refused),         cmocka_unit_test(test_lights),
      cmocka_unit_test(test_missing_mesh), cmocka_unit_test(test_byte_order_mark),
  };
  return cmocka_run_group_tests(tests, open_scratch, close_scratch);
}
