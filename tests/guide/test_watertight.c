/* Closed meshes have no holes: over ten million rays that can't but meet them. */
#include "stage.h"

enum { SIDE = CASES(1023, 255) };
static size_t rays;

/* Counts the pixels of a picture in which nothing was met. */
static size_t count_holes(const StyScene *scene, const StyStand *stand) {
  StyImage *guide = trace_from(scene, stand, (StyTraceOptions){.width = SIDE, .height = SIDE});
  size_t holes = 0;
  for (size_t i = 0; i < sty_count_pixels(guide); i++) holes += guide->data[i] == 0;
  rays += sty_count_pixels(guide);
  sty_destroy_image(&guide);
  return holes;
}

static void expect_closed(const StyScene *scene, const StyStand *stand, const char *what) {
  const size_t holes = count_holes(scene, stand);
  if (holes)
    fail_msg("%s, from (%g, %g, %g): %zu holes", what, stand->position[0], stand->position[1], stand->position[2],
             holes);
}

/* A ball of bumps and dents, between 0.6 and 1 from its middle, thin triangles at its poles. */
static void place_lumps(double u, double v, double at[3], double normal[3]) {
  const double turn = 2 * M_PI * u, fall = M_PI * v;
  const double radius = 0.8 + 0.2 * sin(37 * turn) * sin(53 * fall) * sin(fall);
  const double pole = v == 0 || v == 1 ? 0 : sin(fall);
  const double n[3] = {pole * sin(turn), cos(fall), pole * cos(turn)};
  for (int k = 0; k < 3; k++) normal[k] = n[k], at[k] = radius * n[k];
}

/* As it lies in its file, and turned, squeezed and moved. */
static const double placings[][3][4] = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
                                        {{1.1, 0.3, -0.2, 1e3}, {-0.4, 0.9, 0.1, -7}, {0.1, 0.2, 0.8, 0.3}}};

static void place_point(const double m[3][4], double x, double y, double z, double out[3]) {
  for (int k = 0; k < 3; k++) out[k] = m[k][0] * x + m[k][1] * y + m[k][2] * z + m[k][3];
}

/* From inside every ray meets the wall, whichever way it goes; six cameras see all there is. */
static void look_around(const StyScene *scene, const double m[3][4], double x, double y, double z, const char *what) {
  for (int way = 0; way < 6; way++) {
    StyStand stand = {.perspective = true, .fov = 91};
    place_point(m, x, y, z, stand.position);
    memcpy(stand.target, stand.position, sizeof stand.target);
    stand.target[way / 2] += way % 2 ? -1 : 1;
    stand.up[(way / 2 + 1) % 3] = 1;
    expect_closed(scene, &stand, what);
  }
}

static void test_from_inside(void **state) {
  (void)state;
  for (int p = 0; p < 2; p++) {
    StyScene *lumps = open_stage(), *torus = open_stage();
    add_shape(lumps, make_surface(place_lumps, 300, 200, true, false), placings[p]);
    add_shape(torus, make_surface(place_torus, 97, 61, true, true), placings[p]);
    assert_int_equal(sty_finish_scene(lumps, NULL), STY_OK);
    assert_int_equal(sty_finish_scene(torus, NULL), STY_OK);
    look_around(lumps, placings[p], 0.1, -0.2, 0.05, "lumps");
    look_around(torus, placings[p], TORUS_MIDDLE, 0.03, -0.1, "torus");
    sty_destroy_scene(&lumps);
    sty_destroy_scene(&torus);
  }
}

/* Before a shape that fills the picture, orthographic and in perspective. */
static void test_from_outside(void **state) {
  (void)state;
  StyScene *scene = open_stage();
  add_shape(scene, make_surface(place_lumps, 300, 200, true, false), placings[0]);
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  static const double eyes[][3] = {{0, 0, 5}, {1, 2, 3}, {0, 5, 0.001}, {-4, 1, -2}};
  for (int e = 0; e < 4; e++) {
    StyStand stand = {.up = {0, 0.8, 0.6}, .height = 0.8};
    memcpy(stand.position, eyes[e], sizeof stand.position);
    expect_closed(scene, &stand, "lumps");
    stand.perspective = true;
    stand.fov = 8; /* over 0.6 at any of these distances */
    expect_closed(scene, &stand, "lumps");
  }
  sty_destroy_scene(&scene);
}

/* Rays that run exactly through vertices and along edges: pixels lie on multiples of 2^-9 (2^-7), vertices on those
 * of 2^-5. */
static void test_through_vertices(void **state) {
  (void)state;
  StyScene *scene = open_stage();
  add_shape(scene, make_box(64), placings[0]);
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  for (int way = 0; way < 6; way++) {
    StyStand stand = {.height = 2.0 * SIDE / (SIDE + 1)};
    stand.position[way / 2] = way % 2 ? -3 : 3;
    stand.up[(way / 2 + 1) % 3] = 1;
    expect_closed(scene, &stand, "box");
  }
  sty_destroy_scene(&scene);
  print_message("%.1f million rays so far\n", (double)rays * 1e-6);
  assert_true(rays >= CASES(10000000u, 600000u));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_from_inside),
      cmocka_unit_test(test_from_outside),
      cmocka_unit_test(test_through_vertices),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
