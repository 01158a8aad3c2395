/* Simplified meshes, and what of the guide they change, measured here again. */
#include "stylut/simplify.h"

#include <math.h>

#include "../scene/scratch.h"

enum { SIDE = 160 };

static StyScene *read_scene(Scratch *scratch, const char *text, double crease_angle) {
  StyScene *scene = NULL;
  StyError error = {STY_OK, ""};
  if (read_text_scene(scratch, "some.obj", text, crease_angle, &scene, &error) != STY_OK) fail_msg("%s", error.text);
  return scene;
}

static StyCamera fit_camera(const StyScene *scene, double azimuth, double elevation) {
  StyCamera camera;
  const StyView view = {.azimuth = azimuth, .elevation = elevation, .margin = 0.05};
  assert_int_equal(sty_fit_camera(scene, &view, SIDE, SIDE, &camera, NULL), STY_OK);
  return camera;
}

static StyImage *trace(const StyScene *scene, const StyCamera *camera, int side) {
  const StyTraceOptions options = {
      .width = side, .height = side, .groups = STY_GUIDE_NORMAL | STY_GUIDE_OBJECT | STY_GUIDE_UV};
  StyImage *guide = NULL;
  assert_int_equal(sty_trace_guide(scene, camera, &options, NULL, NULL, &guide, NULL), STY_OK);
  return guide;
}

static StySimplification simplify(StyScene *scene, const StyCamera *camera, const StySimplifyOptions *options,
                                  int threads) {
  const StyTraceOptions shape = {.width = SIDE, .height = SIDE};
  StySimplification done;
  StyError error = {STY_OK, ""};
  if (sty_simplify_scene(scene, camera, &shape, options, &(StyRun){.threads = threads}, &done, &error) != STY_OK)
    fail_msg("%s", error.text);
  return done;
}

/* Share of the pixels that both cover whose normals differ by more than so many degrees. */
static double get_share_beyond(const StyImage *a, const StyImage *b, double degrees) {
  static const char *const NAMES[3] = {"normal.X", "normal.Y", "normal.Z"};
  const float *in_a = sty_find_channel(a, "A"), *in_b = sty_find_channel(b, "A");
  size_t count = 0, beyond = 0;
  for (size_t i = 0; i < sty_count_pixels(a); i++) {
    double dot = 0;
    if (in_a[i] == 0 || in_b[i] == 0) continue;
    for (int k = 0; k < 3; k++) dot += (double)sty_find_channel(a, NAMES[k])[i] * sty_find_channel(b, NAMES[k])[i];
    count++;
    beyond += acos(fmin(dot, 1)) * (180 / M_PI) > degrees;
  }
  assert_true(count > 1000);
  return (double)beyond / (double)count;
}

/* Whether everything that one of two planes shows is within a step in the other. */
static bool is_near(const float *a, const float *b, int side) {
  for (int y = 0; y < side; y++)
    for (int x = 0; x < side; x++) {
      bool found = false;
      for (int j = y - 1; j <= y + 1; j++)
        for (int i = x - 1; i <= x + 1; i++)
          found |= i >= 0 && j >= 0 && i < side && j < side && b[j * side + i] == a[y * side + x];
      if (!found) return false;
    }
  return true;
}

/* A grid of N x N quads bent into something, as OBJ. */
static char *write_grid(int n, bool closed, void (*place)(double u, double v, double out[3])) {
  const size_t size = (size_t)(n + 1) * (size_t)(n + 1) * 160 + 64;
  char *text = malloc(size), *at = text;
  const int columns = closed ? n : n + 1;
  assert_non_null(text);
  for (int j = 0; j <= n; j++)
    for (int i = 0; i < columns; i++) {
      double p[3];
      place((double)i / n, (double)j / n, p);
      at += sprintf(at, "v %.9g %.9g %.9g\n", p[0], p[1], p[2]);
    }
  for (int j = 0; j < n; j++)
    for (int i = 0; i < n; i++) {
      const int a = j * columns + i + 1, b = j * columns + (i + 1) % columns + 1;
      at += sprintf(at, "f %d %d %d %d\n", a, b, b + columns, a + columns);
    }
  return text;
}

static void place_plane(double u, double v, double out[3]) { out[0] = 2 * u - 1, out[1] = 2 * v - 1, out[2] = 0; }

static void place_sphere(double u, double v, double out[3]) {
  const double turn = 2 * M_PI * u, rise = M_PI * (0.001 + 0.998 * v);
  out[0] = sin(rise) * cos(turn), out[1] = -cos(rise), out[2] = -sin(rise) * sin(turn);
}

#ifdef STY_WITH_CGAL

/* What weights that are rounded elsewhere make of the same normal, degrees. */
#define ROUNDING 1e-4

static const StySimplifyOptions ONE_DEGREE = {1, 0.5, 0};

static void test_plane(void **state) {
  char *text = write_grid(60, false, place_plane);
  StyScene *scene = read_scene(*state, text, -1);
  const StyCamera camera = fit_camera(scene, 20, 15);
  StyImage *before = trace(scene, &camera, 2 * SIDE);
  const StySimplification done = simplify(scene, &camera, &(StySimplifyOptions){ROUNDING, 0, 0}, 0);
  StyImage *after = trace(scene, &camera, 2 * SIDE);
  print_message("plane: %zu of %zu triangles\n", done.simple.triangles, done.full.triangles);
  assert_int_equal(done.full.triangles, 7200);
  assert_true(done.is_simpler && done.simple.triangles <= 8);
  assert_true(done.change.maximum <= ROUNDING && done.change.silhouette == 0);
  assert_memory_equal(sty_find_channel(before, "object.I"), sty_find_channel(after, "object.I"),
                      4 * SIDE * SIDE * sizeof(float));
  sty_destroy_image(&before);
  sty_destroy_image(&after);
  sty_destroy_scene(&scene);
  free(text);
}

/* What is measured here again: error, silhouettes, and that the mesh is worth its name. */
static void test_sphere(void **state) {
  char *text = write_grid(120, true, place_sphere);
  StyScene *scene = read_scene(*state, text, -1);
  const StyCamera camera = fit_camera(scene, 20, 15);
  StyImage *before = trace(scene, &camera, SIDE), *fine_before = trace(scene, &camera, 2 * SIDE);
  const StySimplification done = simplify(scene, &camera, &ONE_DEGREE, 0);
  StyImage *after = trace(scene, &camera, SIDE), *fine_after = trace(scene, &camera, 2 * SIDE);
  print_message("sphere: %zu of %zu triangles, p99 %g, silhouette %g\n", done.simple.triangles, done.full.triangles,
                done.change.p99, done.change.silhouette);
  assert_true(done.is_simpler && done.simple.triangles < done.full.triangles / 10);
  assert_int_equal(done.simple.triangles, sty_count_scene_triangles(scene));
  assert_true(done.change.p99 <= 1 && done.change.silhouette <= 0.5 && done.change.maximum >= done.change.p99);
  assert_true(get_share_beyond(before, after, 1.0001) <= 0.01);
  assert_true(get_share_beyond(before, after, done.change.p99 * 0.98) > 0.01);
  const float *a = sty_find_channel(fine_before, "object.I"), *b = sty_find_channel(fine_after, "object.I");
  assert_true(is_near(a, b, 2 * SIDE) && is_near(b, a, 2 * SIDE));
  sty_destroy_image(&before);
  sty_destroy_image(&after);
  sty_destroy_image(&fine_before);
  sty_destroy_image(&fine_after);
  sty_destroy_scene(&scene);
  free(text);
}

/* By number: far too few are taken, and what that changes is told. */
static void test_count(void **state) {
  char *text = write_grid(80, true, place_sphere);
  StyScene *scene = read_scene(*state, text, -1);
  const StyCamera camera = fit_camera(scene, 0, 0);
  const StySimplification done = simplify(scene, &camera, &(StySimplifyOptions){1, 0.5, 100}, 0);
  assert_in_range(done.simple.triangles, 90, 100);
  assert_true(done.change.p99 > 1 && done.change.silhouette > 0.5);
  assert_true(done.simple.tree_bytes < done.full.tree_bytes && done.simple.mesh_bytes < done.full.mesh_bytes / 10);
  sty_destroy_scene(&scene);
  free(text);
}

static void test_same_for_any_threads(void **state) {
  char *text = write_grid(40, true, place_sphere);
  StyScene *scenes[2];
  for (int s = 0; s < 2; s++) {
    scenes[s] = read_scene(*state, text, -1);
    const StyCamera camera = fit_camera(scenes[s], 10, 5);
    simplify(scenes[s], &camera, &ONE_DEGREE, s ? 3 : 1);
  }
  const StyMesh *a = scenes[0]->meshes[0], *b = scenes[1]->meshes[0];
  assert_true(a->triangle_count < 3200);
  assert_int_equal(a->triangle_count, b->triangle_count);
  assert_memory_equal(a->indices, b->indices, 3 * a->triangle_count * sizeof *a->indices);
  assert_memory_equal(a->positions, b->positions, 3 * a->vertex_count * sizeof *a->positions);
  for (int s = 0; s < 2; s++) sty_destroy_scene(&scenes[s]);
  free(text);
}

/* A cube of fine faces comes down to its twelve triangles, each face with its own normals. */
static void write_cube(char *text, int n) {
  static const int AXES[6][3] = {{0, 1, 2}, {1, 0, 2}, {1, 2, 0}, {2, 1, 0}, {2, 0, 1}, {0, 2, 1}};
  int first = 1;
  for (int f = 0; f < 6; f++) {
    const double side = f % 2 ? -1 : 1;
    for (int j = 0; j <= n; j++)
      for (int i = 0; i <= n; i++) {
        double p[3];
        p[AXES[f][0]] = 2.0 * i / n - 1, p[AXES[f][1]] = 2.0 * j / n - 1, p[AXES[f][2]] = side;
        text += sprintf(text, "v %.9g %.9g %.9g\n", p[0], p[1], p[2]);
      }
    for (int j = 0; j < n; j++)
      for (int i = 0; i < n; i++) {
        const int a = first + j * (n + 1) + i;
        text += sprintf(text, "f %d %d %d %d\n", a, a + 1, a + n + 2, a + n + 1);
      }
    first += (n + 1) * (n + 1);
  }
}

static void test_cube(void **state) {
  char *text = malloc(1 << 20);
  assert_non_null(text);
  write_cube(text, 16);
  StyScene *scene = read_scene(*state, text, 30);
  const StyCamera camera = fit_camera(scene, 30, 20);
  const StySimplification done = simplify(scene, &camera, &(StySimplifyOptions){ROUNDING, 0, 0}, 0);
  print_message("cube: %zu of %zu triangles\n", done.simple.triangles, done.full.triangles);
  assert_int_equal(done.full.triangles, 3072);
  assert_int_equal(done.simple.triangles, 12);
  assert_true(done.change.maximum <= ROUNDING);
  sty_destroy_scene(&scene);
  free(text);
}

/* Parts and texture coordinates: a plane of two parts, its picture cut where they meet. */
static void test_seams(void **state) {
  char *text = malloc(1 << 20), *at = text;
  assert_non_null(text);
  enum { N = 20 };
  for (int j = 0; j <= N; j++)
    for (int i = 0; i <= N; i++) at += sprintf(at, "v %g %g 0\n", i / 10.0 - 1, j / 10.0 - 1);
  for (int part = 0; part < 2; part++)
    for (int j = 0; j <= N; j++)
      for (int i = 0; i <= N; i++) at += sprintf(at, "vt %g %g\n", i / 40.0 + (part ? 0.5 : 0), j / 40.0);
  for (int part = 0; part < 2; part++) {
    at += sprintf(at, "g part%d\nusemtl m%d\n", part, part);
    for (int j = 0; j < N; j++)
      for (int i = part ? N / 2 : 0; i < (part ? N : N / 2); i++) {
        const int p[4] = {j * (N + 1) + i + 1, j * (N + 1) + i + 2, (j + 1) * (N + 1) + i + 2,
                          (j + 1) * (N + 1) + i + 1};
        at += sprintf(at, "f");
        for (int k = 0; k < 4; k++) at += sprintf(at, " %d/%d", p[k], p[k] + part * (N + 1) * (N + 1));
        at += sprintf(at, "\n");
      }
  }
  StyScene *scene = read_scene(*state, text, -1);
  const StyCamera camera = fit_camera(scene, 0, 0);
  assert_int_equal(scene->meshes[0]->part_count, 2);
  StyImage *before = trace(scene, &camera, SIDE);
  const StySimplification done = simplify(scene, &camera, &(StySimplifyOptions){ROUNDING, 0, 0}, 0);
  StyImage *after = trace(scene, &camera, SIDE);
  print_message("parts: %zu of %zu triangles\n", done.simple.triangles, done.full.triangles);
  assert_true(done.simple.triangles <= 12);
  static const char *const NAMES[] = {"object.I", "uv.U", "uv.V"};
  for (int c = 0; c < 3; c++)
    for (size_t i = 0; i < SIDE * SIDE; i++)
      assert_true(fabsf(sty_find_channel(before, NAMES[c])[i] - sty_find_channel(after, NAMES[c])[i]) < 1e-5F);
  sty_destroy_image(&before);
  sty_destroy_image(&after);
  sty_destroy_scene(&scene);
  free(text);
}

/* Four corners can't go. */
static void test_nothing_to_gain(void **state) {
  char text[1024];
  print_tetrahedron(text, sizeof text, 0, 1);
  StyScene *scene = read_scene(*state, text, 30);
  const StyMesh *mesh = scene->meshes[0];
  const StyCamera camera = fit_camera(scene, 30, 20);
  const StySimplification done = simplify(scene, &camera, &ONE_DEGREE, 0);
  assert_false(done.is_simpler);
  assert_ptr_equal(scene->meshes[0], mesh);
  assert_int_equal(done.simple.triangles, 4);
  sty_destroy_scene(&scene);
}

#else

static void test_without_cgal(void **state) {
  char *text = write_grid(8, true, place_sphere);
  StyScene *scene = read_scene(*state, text, -1);
  const StyCamera camera = fit_camera(scene, 0, 0);
  const StyTraceOptions shape = {.width = SIDE, .height = SIDE};
  StySimplification done;
  StyError error;
  (void)place_plane, (void)trace, (void)simplify, (void)get_share_beyond, (void)is_near;
  assert_int_equal(sty_simplify_scene(scene, &camera, &shape, &(StySimplifyOptions){1, 0.5, 0}, NULL, &done, &error),
                   STY_ERROR_UNAVAILABLE);
  sty_destroy_scene(&scene);
  free(text);
}

#endif

static void test_bad_options(void **state) {
  static const StySimplifyOptions BAD[] = {{-1, 0.5, 0}, {181, 0.5, 0}, {NAN, 0.5, 0}, {1, -0.5, 0}, {1, 99, 0}};
  char text[1024];
  print_tetrahedron(text, sizeof text, 0, 1);
  StyScene *scene = read_scene(*state, text, 30);
  const StyCamera camera = fit_camera(scene, 30, 20);
  StySimplification done;
  StyTraceOptions shape = {.width = SIDE, .height = SIDE};
  for (size_t i = 0; i < sizeof BAD / sizeof *BAD; i++)
    assert_int_equal(sty_simplify_scene(scene, &camera, &shape, &BAD[i], NULL, &done, NULL), STY_ERROR_USAGE);
  shape.width = shape.height = 16384;
  assert_int_equal(sty_simplify_scene(scene, &camera, &shape, &(StySimplifyOptions){1, 0.5, 0}, NULL, &done, NULL),
                   STY_ERROR_USAGE);
  sty_destroy_scene(&scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
#ifdef STY_WITH_CGAL
      cmocka_unit_test(test_plane),
      cmocka_unit_test(test_sphere),
      cmocka_unit_test(test_count),
      cmocka_unit_test(test_same_for_any_threads),
      cmocka_unit_test(test_cube),
      cmocka_unit_test(test_seams),
      cmocka_unit_test(test_nothing_to_gain),
#else
      cmocka_unit_test(test_without_cgal),
#endif
      cmocka_unit_test(test_bad_options),
  };
  return cmocka_run_group_tests(tests, open_scratch, close_scratch);
}
