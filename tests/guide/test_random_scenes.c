/* Random scenes of meshes, spheres and lights: their mirror images have mirrored guides, and guides hold the same bytes
 * whatever they are made with. */
#include "stage.h"

enum { WIDTH = 123, HEIGHT = 97, SCENES = CASES(40, 2) };

static const unsigned SHAPE = STY_GUIDE_NORMAL | STY_GUIDE_DEPTH | STY_GUIDE_POSITION | STY_GUIDE_OBJECT |
                              STY_GUIDE_STYLE | STY_GUIDE_ALBEDO | STY_GUIDE_LUMA | STY_GUIDE_UV | STY_GUIDE_CURVATURE |
                              STY_GUIDE_CONTOUR | STY_GUIDE_MOTION;

static double draw_value(uint64_t *chance, double size) { return size * (double)draw_signed(chance); }

static void draw_vector(uint64_t *chance, double size, double out[3]) {
  for (int k = 0; k < 3; k++) out[k] = draw_value(chance, size);
}

static StyMaterial draw_material(uint64_t *chance) {
  StyMaterial material = {.paint = {{0, 0, 0}, -1}, .specular = 0.5, .shininess = 12};
  for (int k = 0; k < 3; k++) material.paint.colour[k] = 0.5 + draw_value(chance, 0.5);
  return material;
}

/* A box or a torus, anyhow turned and sheared. `shift` is where the frame has moved it to. */
static void draw_object(uint64_t *chance, StyScene *scene, double side, const double shift[3]) {
  double m[3][4];
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) m[i][j] = draw_value(chance, 0.3) + (i == j) * 0.7;
    m[i][3] = draw_value(chance, 2) + shift[i];
  }
  for (int j = 0; j < 4; j++) m[0][j] *= side;
  add_shape(scene, draw(chance) % 2 ? make_box(3) : make_surface(place_torus, 48, 24, true, true), m);
  StyObject *object = &scene->objects[scene->object_count - 1];
  object->style = draw_below(chance, 256);
  object->material = draw_material(chance);
}

static void draw_sphere(uint64_t *chance, StyScene *scene, double side, const double shift[3]) {
  StySphere sphere = {.radius = 0.6 + draw_value(chance, 0.4), .style = draw_below(chance, 256)};
  draw_vector(chance, 2, sphere.centre);
  for (int k = 0; k < 3; k++) sphere.centre[k] += shift[k];
  sphere.centre[0] *= side;
  sphere.material = draw_material(chance);
  assert_int_equal(sty_add_sphere(scene, &sphere, NULL), STY_OK);
}

static void draw_lights(uint64_t *chance, StyScene *scene, double side) {
  StyLight sun = {.direction = {draw_value(chance, 1) * side, -1, draw_value(chance, 1)}, .intensity = 0.7};
  StyLight lamp = {.is_point = true, .position = {draw_value(chance, 4) * side, 5, 4}, .intensity = 20};
  for (int k = 0; k < 3; k++) sun.colour[k] = lamp.colour[k] = 1;
  assert_int_equal(sty_add_light(scene, &sun, NULL), STY_OK);
  assert_int_equal(sty_add_light(scene, &lamp, NULL), STY_OK);
  scene->ambient = 0.1;
}

/* Scene number `number`, or its mirror image (side -1), at frame 0 or 1. */
static StyScene *draw_scene(uint64_t number, double side, int frame) {
  uint64_t chance = number;
  StyScene *scene = open_stage();
  double shift[3];
  const int objects = 2 + draw_below(&chance, 3), spheres = 1 + draw_below(&chance, 3);
  for (int i = 0; i < objects + spheres; i++) {
    draw_vector(&chance, frame ? 0.2 : 0, shift);
    (i < objects ? draw_object : draw_sphere)(&chance, scene, side, shift);
  }
  draw_lights(&chance, scene, side);
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  return scene;
}

static StyStand draw_stand(uint64_t number, double side) {
  uint64_t chance = number;
  StyStand stand = {.perspective = number % 2, .fov = 50, .height = 7};
  stand.position[0] = side * draw_value(&chance, 4);
  stand.position[1] = draw_value(&chance, 3);
  stand.position[2] = 7;
  stand.up[0] = side * draw_value(&chance, 0.3);
  stand.up[1] = 1;
  return stand;
}

static StyImage *trace_drawn(uint64_t number, double side, const StyRun *run, StyTraceOptions options) {
  StyScene *scene = draw_scene(number, side, 0), *before = draw_scene(number, side, 1);
  const StyStand stand = draw_stand(number, side);
  StyCamera camera, was;
  StyImage *guide = NULL;
  StyError error = {STY_OK, ""};
  options.width = WIDTH;
  options.height = HEIGHT;
  options.contour = sty_default_contour;
  options.previous = (StyPrevious){before, &was};
  assert_int_equal(sty_place_camera(scene, &stand, WIDTH, HEIGHT, &camera, NULL), STY_OK);
  assert_int_equal(sty_place_camera(before, &stand, WIDTH, HEIGHT, &was, NULL), STY_OK);
  if (sty_trace_guide(scene, &camera, &options, run, NULL, &guide, &error)) fail_msg("%s", error.text);
  sty_destroy_scene(&scene);
  sty_destroy_scene(&before);
  return guide;
}

/* ---- mirror the scene, mirror the guide ------------------------------------------ */

/* Of a channel in the mirror. The longitude of a sphere, the last objects of a scene, runs the other way. */
static double mirror_value(const char *channel, double value, bool is_sphere) {
  if (strcmp(channel, "normal.X") == 0 || strcmp(channel, "position.X") == 0 || strcmp(channel, "motion.U") == 0)
    return -value;
  return is_sphere && strcmp(channel, "uv.U") == 0 ? 1 - value : value;
}

/* How many pixels of a channel differ by more than 1e-4 of 1 or of the value, where that is more. */
static int count_odd(const StyImage *guide, const StyImage *mirrored, const char *channel, int objects) {
  int odd = 0;
  for (int y = 0; y < HEIGHT; y++)
    for (int x = 0; x < WIDTH; x++) {
      const bool is_sphere = look_up(guide, "object.I", x, y) > objects;
      const double expected = mirror_value(channel, look_up(guide, channel, x, y), is_sphere);
      const double found = look_up(mirrored, channel, WIDTH - 1 - x, y);
      const double difference = fabs(expected - found);
      odd += expected != found && !(difference <= 1e-4 * fmax(1, fabs(expected)));
    }
  return odd;
}

/* Outside of 0.2 % of the pixels, at edges of things, of shadows and of outlines. */
static void test_mirror(void **state) {
  (void)state;
  int worst = 0;
  for (uint64_t number = 1; number <= SCENES; number++) {
    StyScene *scene = draw_scene(number, 1, 0);
    const int objects = scene->object_count;
    sty_destroy_scene(&scene);
    StyImage *guide = trace_drawn(number, 1, NULL, (StyTraceOptions){.groups = SHAPE});
    StyImage *mirrored = trace_drawn(number, -1, NULL, (StyTraceOptions){.groups = SHAPE});
    int covered = 0;
    for (size_t i = 0; i < sty_count_pixels(guide); i++) covered += guide->data[i] > 0;
    assert_true(covered > WIDTH * HEIGHT / 30);
    for (int c = 0; c < guide->channel_count; c++) {
      const int odd = count_odd(guide, mirrored, guide->names[c], objects);
      if (odd > worst) worst = odd;
      if (odd > WIDTH * HEIGHT / 500)
        fail_msg("scene %d, %s: %d of %d pixels differ", (int)number, guide->names[c], odd, covered);
    }
    sty_destroy_image(&guide);
    sty_destroy_image(&mirrored);
  }
  print_message("mirrored: at most %d of %d pixels differ\n", worst, WIDTH * HEIGHT);
}

/* ---- the same bytes -------------------------------------------------------------- */

static void expect_same(const StyImage *a, const StyImage *b, const char *what, uint64_t number) {
  assert_int_equal(a->channel_count, b->channel_count);
  for (int c = 0; c < a->channel_count; c++) {
    const size_t count = sty_count_pixels(a);
    if (memcmp(a->data + (size_t)c * count, b->data + (size_t)c * count, count * sizeof *a->data) != 0)
      fail_msg("scene %d: %s changes with %s", (int)number, a->names[c], what);
  }
}

/* On one thread and on two, on every vector unit that the processor has. */
static void test_threads_and_units(void **state) {
  (void)state;
  static const char *const units[] = {"plain", "avx2", "avx512"};
  const StyTraceOptions options = {.groups = SHAPE | STY_GUIDE_PATHS, .paths = {2, 7}};
  for (uint64_t number = 1; number <= 3; number++) {
    StyImage *first = trace_drawn(number, 1, &(StyRun){.threads = 1}, options);
    StyImage *second = trace_drawn(number, 1, &(StyRun){.threads = 2}, options);
    expect_same(first, second, "threads", number);
    sty_destroy_image(&second);
    for (int u = 0; u < 3; u++) {
      setenv("STYLUT_VECTOR", units[u], 1);
      second = trace_drawn(number, 1, &(StyRun){.threads = 2}, options);
      unsetenv("STYLUT_VECTOR");
      expect_same(first, second, units[u], number);
      sty_destroy_image(&second);
    }
    sty_destroy_image(&first);
  }
}

/* Orthographic, the frame of the ray is the camera's. */
static void test_frames(void **state) {
  (void)state;
  for (uint64_t number = 2; number <= SCENES; number += 2) {
    StyImage *by_camera = trace_drawn(number, 1, NULL, (StyTraceOptions){.groups = SHAPE});
    StyImage *by_ray = trace_drawn(number, 1, NULL, (StyTraceOptions){.groups = SHAPE, .ray_frame = true});
    expect_same(by_camera, by_ray, "the frame", number);
    sty_destroy_image(&by_camera);
    sty_destroy_image(&by_ray);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_mirror),
      cmocka_unit_test(test_threads_and_units),
      cmocka_unit_test(test_frames),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
