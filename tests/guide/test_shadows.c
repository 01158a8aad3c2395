/* Rays that leave surfaces for the lights: no surface stands in its own light, however it lies in the scene, and what
 * is small beside the ground still throws its shadow from where it stands. */
#include "stage.h"

enum { SIDE = 64, SCENES = 400 };

static double draw_between(uint64_t *state, double low, double high) {
  return low + (high - low) * (double)(draw(state) >> 11) * 0x1p-53;
}

static void draw_direction(uint64_t *state, double out[3]) {
  double length = 0;
  for (int k = 0; k < 3; k++) out[k] = draw_between(state, -1, 1), length += out[k] * out[k];
  for (int k = 0; k < 3; k++) out[k] /= sqrt(length);
}

/* Turned, stretched by up to `most` along each axis before and after that, and moved. */
static void draw_transform(uint64_t *state, double most, double shift, double out[3][4]) {
  double x[3], y[3], z[3], before[3];
  draw_direction(state, x);
  draw_direction(state, y);
  for (int k = 0; k < 3; k++) z[k] = x[(k + 1) % 3] * y[(k + 2) % 3] - x[(k + 2) % 3] * y[(k + 1) % 3];
  for (int k = 0; k < 3; k++) before[k] = pow(most, draw_between(state, 0, 1));
  for (int i = 0; i < 3; i++) {
    const double after = pow(most, draw_between(state, 0, 1));
    out[i][0] = after * x[i] * before[0];
    out[i][1] = after * y[i] * before[1];
    out[i][2] = after * z[i] * before[2];
    out[i][3] = shift * draw_between(state, -1, 1);
  }
}

/* The sun shines from `to` on the scene, which is let go: seen along -z, the luminance of everything that faces it is
 * that of a surface that nothing hides. Returns how many pixels that are. */
static int expect_lit(StyScene *scene, const StyStand *stand, const double to[3]) {
  const double from[3] = {-to[0], -to[1], -to[2]};
  int lit = 0;
  add_sun(scene, from);
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  StyImage *guide = trace_from(
      scene, stand, (StyTraceOptions){.width = SIDE, .height = SIDE, .groups = STY_GUIDE_NORMAL | STY_GUIDE_LUMA});
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++) {
      if (look_up(guide, "A", x, y) == 0) continue;
      const double cosine = look_up(guide, "normal.X", x, y) * to[0] + look_up(guide, "normal.Y", x, y) * to[1] +
                            look_up(guide, "normal.Z", x, y) * to[2];
      if (cosine < 1e-4) continue;
      lit++;
      assert_true(fabs(look_up(guide, "luma.Y", x, y) - cosine) < 1e-5);
    }
  sty_destroy_image(&guide);
  sty_destroy_scene(&scene);
  return lit;
}

/* One convex thing in a scene that something else, far away behind it, makes large; light from anywhere. */
static void test_own_light(void **state) {
  (void)state;
  uint64_t random = 7;
  int lit = 0;
  for (int s = 0; s < SCENES; s++) {
    StyScene *scene = open_stage();
    double transform[3][4], to[3], centre[3] = {0, 0, 0}, reach = 0;
    const double shift = pow(10, draw_between(&random, -2, 5));
    draw_transform(&random, s % 2 ? 30 : 300, shift, transform);
    for (int i = 0; i < 3; i++) {
      centre[i] = transform[i][3];
      for (int j = 0; j < 3; j++) reach = fmax(reach, fabs(transform[i][j]));
    }
    const StySphere far = {.centre = {0, 0, -4 * (shift + reach)}, .radius = reach * 1e-3, .material = sty_white};
    const StySphere ball = {.centre = {centre[0], centre[1], centre[2]}, .radius = reach, .material = sty_white};
    assert_int_equal(sty_add_sphere(scene, s % 3 ? &far : &ball, NULL), STY_OK);
    if (s % 3 == 0) assert_int_equal(sty_add_sphere(scene, &far, NULL), STY_OK);
    if (s % 3 == 1) add_shape(scene, make_surface(place_square, 1, 1, false, false), transform);
    if (s % 3 == 2) add_shape(scene, make_box(3), transform);
    draw_direction(&random, to);
    to[2] = fabs(to[2]);
    StyStand stand = {.position = {centre[0], centre[1], centre[2] + 3 * reach}, .up = {0, 1, 0}, .height = 2 * reach};
    memcpy(stand.target, centre, sizeof stand.target);
    lit += expect_lit(scene, &stand, to);
  }
  assert_true(lit > SCENES * SIDE * SIDE / 8);
}

/* A sheet whose place in the mesh and the object's in the scene take each other away: numbers are small, roundings not.
 */
static void test_far_from_the_middle(void **state) {
  (void)state;
  uint64_t random = 3;
  int lit = 0;
  for (int s = 0; s < SCENES; s++) {
    StyScene *scene = open_stage();
    StyMesh *mesh = make_surface(place_square, 2, 1, false, false);
    double to[3], turned[3][4];
    draw_direction(&random, to);
    to[2] = fabs(to[2]);
    const double size = 1e-3 * draw_between(&random, 1, 2);
    /* The right half's end far away, the left half small at the origin of the world. */
    for (size_t v = 0; v < mesh->vertex_count; v++) {
      float *at = &mesh->positions[3 * v];
      const double x = (double)at[0], y = (double)at[1];
      at[0] = (float)(x > 0.5 ? 1 : -1 + size * (x + 1));
      at[1] = (float)(-1 + size * (y + 1));
      at[2] = -1;
    }
    draw_transform(&random, 30, 0, turned);
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) turned[i][3] += turned[i][j];
    for (int side = -1; side <= 1; side += 2) {
      const StySphere far = {.centre = {20 * side, 0, 20 * side}, .radius = 1e-3, .material = sty_white};
      assert_int_equal(sty_add_sphere(scene, &far, NULL), STY_OK);
    }
    add_shape(scene, mesh, turned);
    const StyStand stand = {.position = {0, 0, 5}, .up = {0, 1, 0}, .height = 4e-3};
    lit += expect_lit(scene, &stand, to);
  }
  assert_true(lit > SCENES * SIDE * SIDE / 32);
}

/* Where only the smooth normal faces the sun, the facet is left on the other side, and doesn't hide itself. */
static void test_facet_turned_away(void **state) {
  (void)state;
  static const double whole[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}, from[3] = {-1, 0, 0.2};
  static const StyStand above = {.position = {0, 0, 1}, .up = {0, 1, 0}, .height = 1};
  StyScene *scene = open_stage();
  StyMesh *mesh = make_surface(place_square, 1, 1, false, false);
  for (size_t v = 0; v < mesh->vertex_count; v++) mesh->normals[3 * v] = 0.8f, mesh->normals[3 * v + 2] = 0.6f;
  add_shape(scene, mesh, whole);
  add_sun(scene, from);
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  StyImage *guide = trace_from(scene, &above, (StyTraceOptions){.width = 8, .height = 8, .groups = STY_GUIDE_LUMA});
  const double cosine = (0.8 - 0.6 * 0.2) / sqrt(1.04);
  for (int i = 0; i < 64; i++) assert_true(fabs(look_up(guide, "luma.Y", i % 8, i / 8) - cosine) < 1e-5);
  sty_destroy_image(&guide);
  sty_destroy_scene(&scene);
}

/* A lamp in the plane of a ceiling shines down from it, and one above it doesn't. */
static void test_lamp_at_the_ceiling(void **state) {
  (void)state;
  static const double floor_at[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, -1}},
                      ceiling[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 1}};
  static const StyStand inside = {.position = {0, 0, 0.5}, .up = {0, 1, 0}, .height = 1};
  for (int above = 0; above < 2; above++) {
    const StyLight lamp = {
        .is_point = true, .position = {0.2, -0.1, 1 + 1e-3 * above}, .intensity = 1, .colour = {1, 1, 1}};
    StyScene *scene = open_stage();
    add_shape(scene, make_surface(place_square, 1, 1, false, false), floor_at);
    add_shape(scene, make_surface(place_square, 1, 1, false, false), ceiling);
    assert_int_equal(sty_add_light(scene, &lamp, NULL), STY_OK);
    assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
    StyImage *guide = trace_from(scene, &inside, (StyTraceOptions){.width = 8, .height = 8, .groups = STY_GUIDE_LUMA});
    for (int i = 0; i < 64; i++) assert_true((look_up(guide, "luma.Y", i % 8, i / 8) > 0) == !above);
    sty_destroy_image(&guide);
    sty_destroy_scene(&scene);
  }
}

/* A box of side 1 on ground that is up to 100,000 wide, the sun at 45 degrees: its shadow is a rectangle that begins at
 * the box. */
static void test_contact(void **state) {
  (void)state;
  static const double slanting[3] = {1, 0, -1};
  for (double width = 10; width <= 1e5; width *= 10) {
    StyScene *scene = open_stage();
    const double ground[3][4] = {{width / 2, 0, 0, width / 5}, {0, width / 2, 0, width / 7}, {0, 0, width / 2, 0}};
    const double stands[3][4] = {{0.5, 0, 0, 0}, {0, 0.5, 0, 0}, {0, 0, 0.5, 0.5}};
    add_shape(scene, make_surface(place_square, 1, 1, false, false), ground);
    add_shape(scene, make_box(1), stands);
    add_sun(scene, slanting);
    assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
    const StyStand above = {.position = {0, 0, 10}, .target = {0, 0, 0}, .up = {0, 1, 0}, .height = 4};
    StyImage *guide = trace_from(
        scene, &above, (StyTraceOptions){.width = SIDE, .height = SIDE, .groups = STY_GUIDE_OBJECT | STY_GUIDE_LUMA});
    /* Off by how far off the ground rays start, at most. */
    const double slack = 1e-3 + width * 1e-6;
    int dark = 0;
    for (int y = 0; y < SIDE; y++)
      for (int x = 0; x < SIDE; x++) {
        const double right = (x + 0.5) / SIDE * 4 - 2, up = 2 - (y + 0.5) / SIDE * 4;
        if (look_up(guide, "object.I", x, y) != 1) continue;
        const double beyond = fmax(fmax(0.5 - right, right - 1.5), fabs(up) - 0.5); /* of the shadow's rectangle */
        if (fabs(beyond) < slack) continue;
        dark += beyond < 0;
        if ((look_up(guide, "luma.Y", x, y) == 0) != (beyond < 0))
          fail_msg("ground %g wide: luma %g at (%g, %g)", width, look_up(guide, "luma.Y", x, y), right, up);
      }
    assert_in_range(dark, 140, 256);
    sty_destroy_image(&guide);
    sty_destroy_scene(&scene);
  }
}

/* More light than a channel can hold is refused, not written as infinite. */
static void test_too_much_light(void **state) {
  (void)state;
  static const double tiny[3][4] = {{1e-20, 0, 0, 0}, {0, 1e-20, 0, 0}, {0, 0, 1e-20, 0}};
  static const StyStand above = {.position = {0, 0, 1e-20}, .up = {0, 1, 0}, .height = 2e-20};
  const unsigned lit[] = {STY_GUIDE_LUMA, STY_GUIDE_FULL};
  for (int i = 0; i < 4; i++) {
    const StyLight lamp = {
        .is_point = true, .position = {0, 0, 2e-20}, .intensity = i / 2 ? 1e-6 : 1e30, .colour = {1, 1, 1}};
    const StyTraceOptions options = {.width = 8, .height = 8, .groups = lit[i % 2], .paths = {1, 0}};
    StyScene *scene = open_stage();
    StyCamera camera;
    StyImage *guide = NULL;
    StyError error = {STY_OK, ""};
    add_shape(scene, make_surface(place_square, 1, 1, false, false), tiny);
    assert_int_equal(sty_add_light(scene, &lamp, NULL), STY_OK);
    assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
    assert_int_equal(sty_place_camera(scene, &above, 8, 8, &camera, NULL), STY_OK);
    const StyStatus status = sty_trace_guide(scene, &camera, &options, NULL, NULL, &guide, &error);
    assert_int_equal(status, i / 2 ? STY_OK : STY_ERROR_INPUT);
    assert_int_equal(strstr(error.text, "found") != NULL && strstr(error.text, "pixel (") != NULL, status != STY_OK);
    sty_destroy_image(&guide);
    sty_destroy_scene(&scene);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_own_light),         cmocka_unit_test(test_far_from_the_middle),
      cmocka_unit_test(test_facet_turned_away), cmocka_unit_test(test_lamp_at_the_ceiling),
      cmocka_unit_test(test_contact),           cmocka_unit_test(test_too_much_light)};
  return cmocka_run_group_tests_name("shadows", tests, NULL, NULL);
}
