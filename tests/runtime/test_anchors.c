/* An object that moves by whole pixels, its anchor with it, keeps its matches and its picture; without anchors it swims
 * through the seeds. */
#include "oracle.h"
#include "sphere.h"

enum { WIDTH = 220, HEIGHT = 150, SIDE = 64, RADIUS = 45, CUT = 15, TOP_LEVEL = 4, BLEND = 2 };

/* No seed is farther from its pixel than the diagonal of a cell, nor looks farther around than half a cell. */
enum { REACH = 23 + 8 + BLEND };

typedef struct Scene {
  uint8_t guide[4 * WIDTH * HEIGHT], luma[WIDTH * HEIGHT], albedo[4 * WIDTH * HEIGHT];
  float depth[WIDTH * HEIGHT];
  uint16_t objects[WIDTH * HEIGHT];
  int32_t anchors[2 * 3];
  StyFrame frame;
  StyMatch matches[WIDTH * HEIGHT];
  uint8_t picture[4 * WIDTH * HEIGHT];
} Scene;

/* A lens, flat in its middle and cut off there at one side; texture and light are its own. */
static void draw_lens(Scene *scene, int object, int middle_x, int middle_y, float depth) {
  for (int i = 0; i < WIDTH * HEIGHT; i++) {
    const int dx = i % WIDTH - middle_x, dy = i / WIDTH - middle_y;
    const double r = sqrt(dx * dx + dy * dy) / RADIUS, out = fmax(0, r * 2 - 1), up = sqrt(fmax(0, 1 - out * out));
    if (r >= 1 || dx > CUT) continue;
    put_normal(scene->guide + 4 * i, r > 0 ? out * dx / (r * RADIUS) : 0, r > 0 ? -out * dy / (r * RADIUS) : 0, up);
    scene->luma[i] = (uint8_t)(128 + dx + dy);
    scene->depth[i] = depth + (float)dx / 64;
    scene->objects[i] = (uint16_t)object;
    for (int c = 0; c < 3; c++) scene->albedo[4 * i + c] = (uint8_t)(dx * 3 + dy * 5 + c * 7);
  }
}

/* Object 1 in front of object 2, which has a place of its own or none. */
static Scene *make_scene(const Fixture *fixture, int x, int y, const int *other, bool anchored) {
  Scene *scene = calloc(1, sizeof *scene);
  assert_non_null(scene);
  if (other) draw_lens(scene, 2, other[0], other[1], 9);
  draw_lens(scene, 1, x, y, 5);
  const int32_t anchors[] = {0, 0, x - 1000, y + 777, 3, 5};
  memcpy(scene->anchors, anchors, sizeof anchors);
  scene->frame = (StyFrame){.width = WIDTH,
                            .height = HEIGHT,
                            .guide = scene->guide,
                            .depth = scene->depth,
                            .style = 1,
                            .objects = scene->objects,
                            .luma = scene->luma,
                            .albedo = scene->albedo,
                            .anchors = anchored ? scene->anchors : NULL,
                            .anchor_count = 3,
                            .number = 3};
  const StyRect all = get_all(&scene->frame);
  assert_int_equal(sty_transfer_frame(&fixture->bundle, &scene->frame, all, scene->matches), STY_RUNTIME_OK);
  assert_int_equal(sty_blend_frame(&fixture->bundle, &scene->frame, all, scene->matches, 8, scene->picture),
                   STY_RUNTIME_OK);
  return scene;
}

static Fixture *make_bundle(float scale, int scatter) {
  uint64_t random = 1;
  Fixture *fixture = make_sphere(&random, SIDE, 4);
  const StyStyle style = {.threshold = 40,
                          .top_level = TOP_LEVEL,
                          .radius = BLEND,
                          .depth_tolerance = 1,
                          .luma_weight = 0.3f,
                          .colour_weight = 0.5f,
                          .layer_count = 2,
                          .luma = {0.25f, 0.75f},
                          .jitter_amount = 0.9f,
                          .jitter_period = 2,
                          .scale = scale,
                          .flags = STY_FLAG_UNORM8 | STY_FLAG_OBJECTS | STY_FLAG_BASE,
                          .scatter = scatter};
  write_style(fixture, 1, &style);
  open_fixture(fixture);
  return fixture;
}

/* Pixels of object 1 that show in both, at least `margin` from the frame's edges in the second, and how many differ. */
typedef struct Difference {
  int compared, matches, pixels;
} Difference;

static Difference compare_moved(const Scene *a, const Scene *b, int dx, int dy, int margin) {
  Difference difference = {0, 0, 0};
  const StyRect inner = {margin, margin, WIDTH - margin, HEIGHT - margin};
  for (int i = 0; i < WIDTH * HEIGHT; i++) {
    const int x = i % WIDTH + dx, y = i / WIDTH + dy, j = y * WIDTH + x;
    if (a->objects[i] != 1 || !is_inside(inner, x, y)) continue;
    assert_int_equal(b->objects[j], 1);
    difference.compared++;
    difference.matches += !is_same(a->matches[i], b->matches[j]);
    difference.pixels += memcmp(a->picture + 4 * i, b->picture + 4 * j, 4) != 0;
  }
  return difference;
}

enum { START_X = 70, START_Y = 75 };
static const int moves[][2] = {{1, 0}, {0, 1}, {5, -3}, {37, 13}, {64, 0}, {-13, -20}};

/* Alone, before another object whose flat middle goes on where its own ends, and beside it. */
static void test_moved_objects(void **state) {
  (void)state;
  static const int beside[][2] = {{30, 2}, {60, -10}};
  for (int kind = CASES(0, 1); kind < 6; kind += CASES(1, 3)) {
    Fixture *fixture = make_bundle((float)(1 << kind % 3) / 2, kind < 3 ? 0 : 7);
    Scene *start = make_scene(fixture, START_X, START_Y, NULL, true);
    for (size_t i = 0; i < sizeof moves / sizeof *moves; i++)
      for (int company = 0; company < 3; company++) {
        const int dx = moves[i][0], dy = moves[i][1], x = START_X + dx, y = START_Y + dy;
        const int other[2] = {x + (company ? beside[company - 1][0] : 0), y + (company ? beside[company - 1][1] : 0)};
        Scene *moved = make_scene(fixture, x, y, company ? other : NULL, true);
        const Difference difference = compare_moved(start, moved, dx, dy, 0);
        if (difference.compared < 4000 || difference.matches || difference.pixels)
          fail_msg("kind %d, moved by (%d, %d), company %d: of %d, %d matches and %d pixels differ", kind, dx, dy,
                   company, difference.compared, difference.matches, difference.pixels);
        free(moved);
      }
    free(start);
    destroy_fixture(fixture);
  }
}

/* Seeds outside the frame propose nothing: what is farther from the edge than seeds reach stays. */
static void test_objects_that_leave(void **state) {
  (void)state;
  static const int far[][2] = {{-40, 0}, {150, 5}, {3, -61}, {-40, 55}};
  Fixture *fixture = make_bundle(1, 7);
  Scene *start = make_scene(fixture, START_X, START_Y, NULL, true);
  for (size_t i = 0; i < sizeof far / sizeof *far; i++) {
    Scene *moved = make_scene(fixture, START_X + far[i][0], START_Y + far[i][1], NULL, true);
    const Difference inside = compare_moved(start, moved, far[i][0], far[i][1], REACH),
                     whole = compare_moved(start, moved, far[i][0], far[i][1], 0);
    assert_true(inside.compared > 100 && inside.compared < whole.compared && whole.compared < 4500);
    assert_int_equal(inside.matches, 0);
    assert_int_equal(inside.pixels, 0);
    free(moved);
  }
  free(start);
  destroy_fixture(fixture);
}

static void test_without_anchors(void **state) {
  (void)state;
  Fixture *fixture = make_bundle(1, 0);
  Scene *start = make_scene(fixture, START_X, START_Y, NULL, false);
  for (size_t i = 0; i < sizeof moves / sizeof *moves; i++) {
    Scene *moved = make_scene(fixture, START_X + moves[i][0], START_Y + moves[i][1], NULL, false);
    const Difference difference = compare_moved(start, moved, moves[i][0], moves[i][1], 0);
    assert_true(difference.matches > difference.compared / 4 && difference.pixels > difference.compared / 4);
    free(moved);
  }
  free(start);
  destroy_fixture(fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_moved_objects), cmocka_unit_test(test_objects_that_leave),
                                     cmocka_unit_test(test_without_anchors)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
