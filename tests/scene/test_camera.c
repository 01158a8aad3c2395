#include <math.h>

#include "scratch.h"

static void expect_view(const char *text, double azimuth, double elevation) {
  StyView view = {.margin = 0.25};
  StyError error;
  assert_int_equal(sty_parse_view("--view", text, &view, &error), STY_OK);
  assert_true(view.azimuth == azimuth && view.elevation == elevation && view.margin == 0.25);
}

static void test_views(void **state) {
  (void)state;
  expect_view("front", 0, 0);
  expect_view("three-quarter", 35, 20);
  expect_view("-90,45.5", -90, 45.5);
  static const char *const BAD[] = {"", "Front", "front ", "1", "1,", ",1", "1,2,3", "1,91", "nan,0", "1, 2", "361,0"};
  for (size_t i = 0; i < sizeof BAD / sizeof *BAD; i++) {
    StyView view = {.azimuth = 7};
    StyError error = {STY_OK, ""};
    assert_int_equal(sty_parse_view("--view", BAD[i], &view, &error), STY_ERROR_USAGE);
    assert_non_null(strstr(error.text, "--view"));
    assert_true(view.azimuth == 7);
  }
}

/* A jagged strip, 40 vertices; the camera reads nothing but them. */
enum { VERTICES = 40 };
static float cloud[3 * VERTICES + 1];

/* A scene that shows these vertices and nothing else; until the next one. */
static StyScene show_points(size_t count, float *positions) {
  static StyMesh mesh;
  static StyMesh *meshes[] = {&mesh};
  static StyObject object = {.transform = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
  mesh = (StyMesh){.vertex_count = count, .positions = positions, .scale = 1};
  return (StyScene){.meshes = meshes, .mesh_count = 1, .objects = &object, .object_count = 1, .scale = 1};
}

static StyScene make_cloud(void) {
  for (int v = 0; v < VERTICES; v++) {
    cloud[3 * v] = (float)(sin(v * 12.9) * 0.9 + 0.05);
    cloud[3 * v + 1] = (float)(cos(v * 7.3) * 0.3 - 0.4);
    cloud[3 * v + 2] = (float)(sin(v * 3.7 + 1) * 0.6);
  }
  return show_points(VERTICES, cloud);
}

/* Largest |film coordinate| over all vertices, as a share of the half film. */
static void measure_film(const StyScene *scene, const StyCamera *camera, double share[2], double *nearest) {
  share[0] = share[1] = 0;
  *nearest = INFINITY;
  for (size_t v = 0; v < scene->meshes[0]->vertex_count; v++) {
    double s = 0, t = 0, depth = 0;
    for (size_t k = 0; k < 3; k++) {
      const double from_eye = scene->meshes[0]->positions[3 * v + k] - camera->eye[k];
      s += from_eye * camera->right[k];
      t += from_eye * camera->up[k];
      depth -= from_eye * camera->back[k];
    }
    const double distance = camera->perspective ? depth : 1;
    *nearest = fmin(*nearest, depth);
    share[0] = fmax(share[0], fabs(s) / (distance * camera->half_width));
    share[1] = fmax(share[1], fabs(t) / (distance * camera->half_height));
  }
}

static void expect_orthonormal(const StyCamera *camera) {
  const double *axes[3] = {camera->right, camera->up, camera->back};
  for (int i = 0; i < 9; i++) {
    double dot = 0;
    for (int k = 0; k < 3; k++) dot += axes[i / 3][k] * axes[i % 3][k];
    assert_true(fabs(dot - (i / 3 == i % 3)) < 1e-12);
  }
}

static void test_everything_is_in_the_picture(void **state) {
  (void)state;
  static const int SIZES[][2] = {{640, 640}, {1920, 1080}, {100, 700}};
  static const double ANGLES[][2] = {{0, 0}, {35, 20}, {-120, -70}, {90, 90}, {180, 0}};
  static const double MARGINS[] = {0, 0.1, 0.45}, FOVS[] = {0, 1, 35, 170};
  const StyScene scene = make_cloud();
  for (int c = 0; c < 3 * 5 * 3 * 4; c++) {
    const int *size = SIZES[c % 3];
    const double *angles = ANGLES[c / 3 % 5], margin = MARGINS[c / 15 % 3], fov = FOVS[c / 45];
    const StyView view = {angles[0], angles[1], fov > 0, fov, margin, (StyUpAxis)(c % 6)};
    StyCamera camera;
    StyError error;
    assert_int_equal(sty_fit_camera(&scene, &view, size[0], size[1], &camera, &error), STY_OK);
    expect_orthonormal(&camera);
    assert_true(fabs(camera.half_width / camera.half_height - (double)size[0] / size[1]) < 1e-12);
    double share[2], nearest;
    measure_film(&scene, &camera, share, &nearest);
    const double most = fmax(share[0], share[1]);
    assert_true(most <= 1 - 2 * margin + 1e-9);
    assert_true(nearest >= -1e-12);
    /* Tight, unless a wide opening would put the eye on a vertex. */
    if (fov < 100) assert_true(most >= 1 - 2 * margin - 1e-9);
  }
}

static void test_axes_of_views(void **state) {
  (void)state;
  const StyScene scene = make_cloud();
  StyCamera camera;
  const StyView side = {.azimuth = 90}, top = {.elevation = 90};
  assert_int_equal(sty_fit_camera(&scene, &side, 8, 8, &camera, NULL), STY_OK);
  assert_true(camera.back[0] == 1 && camera.right[2] == -1 && camera.up[1] == 1);
  assert_int_equal(sty_fit_camera(&scene, &top, 8, 8, &camera, NULL), STY_OK);
  assert_true(camera.back[1] == 1 && camera.right[0] == 1 && camera.up[2] == -1);
}

/* Whatever points up: the frame is right-handed, and up is up. */
static void test_up_axes(void **state) {
  (void)state;
  static const double UPS[6][3] = {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {-1, 0, 0}};
  const StyScene scene = make_cloud();
  for (int axis = 0; axis < 6; axis++) {
    StyCamera camera;
    const StyView front = {.up = (StyUpAxis)axis}, around = {.up = (StyUpAxis)axis, .azimuth = 77, .elevation = 12};
    assert_int_equal(sty_fit_camera(&scene, &front, 8, 8, &camera, NULL), STY_OK);
    expect_orthonormal(&camera);
    for (int k = 0; k < 3; k++) {
      const int l = (k + 1) % 3, m = (k + 2) % 3;
      assert_true(camera.up[k] == UPS[axis][k]);
      assert_true(camera.right[l] * camera.up[m] - camera.right[m] * camera.up[l] == camera.back[k]);
    }
    assert_int_equal(sty_fit_camera(&scene, &around, 8, 8, &camera, NULL), STY_OK);
    expect_orthonormal(&camera);
    for (int k = 0; k < 3; k++) assert_true(fabs(camera.right[k] * UPS[axis][k]) < 1e-15);
  }
}

static void test_square_film_is_the_spheres(void **state) {
  StyScene *scene = NULL;
  assert_int_equal(read_text_scene(*state, "cube.obj", CUBE_OBJ, -1, &scene, NULL), STY_OK);
  StyCamera camera;
  assert_int_equal(sty_fit_camera(scene, &(StyView){0}, 512, 512, &camera, NULL), STY_OK);
  assert_true(camera.half_width == 1 && camera.half_height == 1);
  assert_true(camera.eye[0] == 0 && camera.eye[1] == 0 && camera.eye[2] == 1);
  sty_destroy_scene(&scene);
}

/* A spike that fits any opening must not reach the eye. */
static void test_spike_keeps_its_distance(void **state) {
  (void)state;
  static float spike[10] = {0, 0, 1, 0.01f, 0, -1, 0, 0.01f, -1};
  const StyScene scene = show_points(3, spike);
  const StyView view = {.perspective = true, .fov = 90};
  StyCamera camera;
  assert_int_equal(sty_fit_camera(&scene, &view, 64, 64, &camera, NULL), STY_OK);
  assert_true(camera.eye[2] > 1.001);
}

static void test_absurd_views(void **state) {
  (void)state;
  const StyScene scene = make_cloud();
  static const StyView VIEWS[] = {{.margin = 0.5},
                                  {.margin = -0.1},
                                  {.margin = NAN},
                                  {.elevation = 91},
                                  {.azimuth = INFINITY},
                                  {.perspective = true, .fov = 0.5},
                                  {.perspective = true, .fov = 171},
                                  {.perspective = true, .fov = NAN}};
  StyCamera camera;
  for (size_t i = 0; i < sizeof VIEWS / sizeof *VIEWS; i++)
    assert_int_equal(sty_fit_camera(&scene, &VIEWS[i], 8, 8, &camera, NULL), STY_ERROR_USAGE);
  assert_int_equal(sty_fit_camera(&scene, &(StyView){0}, 0, 8, &camera, NULL), STY_ERROR_USAGE);
  const StyScene empty = {.scale = 1};
  assert_int_equal(sty_fit_camera(&empty, &(StyView){0}, 8, 8, &camera, NULL), STY_ERROR_INPUT);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_views),
      cmocka_unit_test(test_everything_is_in_the_picture),
      cmocka_unit_test(test_axes_of_views),
      cmocka_unit_test(test_up_axes),
      cmocka_unit_test(test_square_film_is_the_spheres),
      cmocka_unit_test(test_spike_keeps_its_distance),
      cmocka_unit_test(test_absurd_views),
  };
  return cmocka_run_group_tests(tests, open_scratch, close_scratch);
}
