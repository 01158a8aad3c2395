#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "stylut/measure.h"

enum { SIDE = 96, PIXELS = SIDE * SIDE };

/* A frame of SIDE x SIDE, flat and covered, one chunk at level 2, all mid-grey. */
typedef struct Scene {
  StyShot shot;
  float rgb[3 * PIXELS], u[PIXELS], v[PIXELS], depth[PIXELS];
  uint8_t guide[4 * PIXELS];
  StyMatch matches[PIXELS];
  uint16_t objects[PIXELS];
} Scene;

static Scene *make_scene(void) {
  Scene *scene = calloc(1, sizeof *scene);
  assert_non_null(scene);
  for (int i = 0; i < PIXELS; i++) {
    scene->matches[i] = (StyMatch){(uint16_t)(100 + i % SIDE), (uint16_t)(50 + i / SIDE), 2, 0, 0, 0};
    memset(scene->guide + 4 * (size_t)i, 255, 4);
    scene->depth[i] = 3;
  }
  for (int i = 0; i < 3 * PIXELS; i++) scene->rgb[i] = 0.5f;
  scene->shot = (StyShot){SIDE, SIDE, scene->rgb, scene->guide, scene->matches, {NULL, NULL}, NULL, NULL};
  return scene;
}

static void paint(float *rgb, int i, float value) {
  for (int c = 0; c < 3; c++) rgb[c * PIXELS + i] = value;
}

/* Numbers without any order, the same everywhere. */
static float draw(uint32_t *state) {
  *state = *state * 1664525u + 1013904223u;
  return (float)(*state >> 24) / 255.0f;
}

static void expect_near(double found, double expected, double tolerance) {
  if (!(fabs(found - expected) <= tolerance)) fail_msg("found %.9g, expected %.9g", found, expected);
}

static void test_paper_shows_through(void **state) {
  (void)state;
  const uint8_t bytes[8] = {255, 0, 51, 255, 0, 0, 0, 0};
  const uint16_t words[4] = {0, 65535, 13107, 13107};
  float rgb[6];
  sty_lay_on_white(bytes, 8, 2, rgb);
  const float expected[6] = {1, 1, 0, 1, 0.2f, 1};
  for (int i = 0; i < 6; i++) expect_near((double)rgb[i], (double)expected[i], 1e-6);
  sty_lay_on_white(words, 16, 1, rgb);
  const float thin[3] = {0.8f, 1, 0.84f};
  for (int i = 0; i < 3; i++) expect_near((double)rgb[i], (double)thin[i], 1e-6);
}

/* A picture that moves as the motion says has no error; one that stays has. */
static void test_warp_follows_motion(void **state) {
  (void)state;
  Scene *a = make_scene(), *b = make_scene();
  uint32_t seed = 1;
  for (int i = 0; i < PIXELS; i++) paint(a->rgb, i, draw(&seed));
  for (int i = 0; i < PIXELS; i++) {
    const int from = i % SIDE >= 2 ? i - 2 : i;
    paint(b->rgb, i, a->rgb[from]);
    b->matches[i] = a->matches[from];
    b->u[i] = -2;
  }
  b->shot.motion[0] = b->u, b->shot.motion[1] = b->v;
  StyWarp warp;
  sty_measure_warp(&a->shot, &b->shot, &warp);
  assert_int_equal(warp.pixels, (SIDE - 2) * SIDE);
  assert_true(warp.mean == 0 && warp.rms == 0 && warp.jumps == 0);
  sty_measure_warp(&a->shot, &a->shot, &warp);
  assert_true(warp.pixels == PIXELS && warp.mean == 0);
  b->shot.motion[0] = b->shot.motion[1] = NULL;
  sty_measure_warp(&a->shot, &b->shot, &warp);
  assert_true(warp.pixels == PIXELS && warp.mean > 0.2 && warp.jumps == 0);
  free(a);
  free(b);
}

static void test_warp_of_known_size(void **state) {
  (void)state;
  Scene *a = make_scene(), *b = make_scene();
  for (int i = 0; i < PIXELS; i++) paint(b->rgb, i, i < PIXELS / 4 ? 0.9f : 0.5f);
  for (int i = 0; i < PIXELS / 8; i++) b->matches[i].x = (uint16_t)(b->matches[i].x + 5);
  for (int i = PIXELS / 8; i < PIXELS / 4; i++) b->matches[i].x = (uint16_t)(b->matches[i].x + 4);
  StyWarp warp;
  sty_measure_warp(&a->shot, &b->shot, &warp);
  expect_near(warp.mean, 0.1, 1e-6);
  expect_near(warp.rms, 0.2, 1e-6);
  expect_near(warp.jumps, 0.125, 0);
  free(a);
  free(b);
}

/* Half a pixel is fetched from between two. */
static void test_warp_between_pixels(void **state) {
  (void)state;
  Scene *a = make_scene(), *b = make_scene();
  for (int i = 0; i < PIXELS; i++) {
    paint(a->rgb, i, (float)(i % SIDE) / SIDE);
    paint(b->rgb, i, ((float)(i % SIDE) + 0.25f) / SIDE);
    b->u[i] = 0.25f;
  }
  b->shot.motion[0] = b->u, b->shot.motion[1] = b->v;
  StyWarp warp;
  sty_measure_warp(&a->shot, &b->shot, &warp);
  expect_near(warp.mean, 0.25 / SIDE / SIDE, 1e-7); /* the last column goes on as it ends */
  free(a);
  free(b);
}

static void test_what_was_hidden_does_not_count(void **state) {
  (void)state;
  Scene *a = make_scene(), *b = make_scene();
  for (int i = 0; i < PIXELS; i++) paint(b->rgb, i, 1);
  StyWarp warp;
  a->shot.depth = a->depth, b->shot.depth = b->depth;
  a->shot.objects = a->objects, b->shot.objects = b->objects;
  for (int i = 0; i < SIDE; i++) a->depth[i] = 4;                                 /* something else stood there */
  for (int i = SIDE; i < 2 * SIDE; i++) a->depth[i] = 3.1f;                       /* the same, moved a little */
  for (int i = 2 * SIDE; i < 3 * SIDE; i++) a->objects[i] = 7;                    /* another object */
  for (int i = 3 * SIDE; i < 4 * SIDE; i++) a->matches[i].level = STY_LEVEL_NONE; /* background */
  for (int i = 4 * SIDE; i < 5 * SIDE; i++) a->depth[i] = NAN;
  for (int i = 5 * SIDE; i < 6 * SIDE; i++) a->depth[i] = b->depth[i] = INFINITY;
  for (int i = 6 * SIDE; i < 7 * SIDE; i++) b->u[i] = i % 2 ? NAN : 1e30f;
  b->shot.motion[0] = b->u, b->shot.motion[1] = b->v;
  sty_measure_warp(&a->shot, &b->shot, &warp);
  assert_int_equal(warp.pixels, PIXELS - 5 * SIDE);
  expect_near(warp.mean, 0.5, 1e-6);
  free(a);
  free(b);
}

static double get_ssim(const float *a, const float *b, int width, int height) {
  double value = -2;
  assert_int_equal(sty_measure_ssim(width, height, a, b, &(StyRun){.threads = 2}, &value, NULL), STY_OK);
  return value;
}

static void test_ssim(void **state) {
  (void)state;
  Scene *a = make_scene(), *b = make_scene();
  uint32_t seed = 3;
  assert_true(get_ssim(a->rgb, a->rgb, SIDE, SIDE) == 1);
  /* Constants: (2ab + C1) / (a^2 + b^2 + C1). */
  for (int i = 0; i < PIXELS; i++) paint(b->rgb, i, 0.25f);
  expect_near(get_ssim(a->rgb, b->rgb, SIDE, SIDE), (0.25 + 1e-4) / (0.25 + 0.0625 + 1e-4), 1e-5);
  /* A picture and its negative around one mean: covariance is minus variance. */
  for (int i = 0; i < PIXELS; i++) {
    paint(a->rgb, i, draw(&seed));
    paint(b->rgb, i, 1 - a->rgb[i]);
  }
  assert_true(get_ssim(a->rgb, a->rgb, SIDE, SIDE) == 1);
  assert_true(get_ssim(a->rgb, b->rgb, SIDE, SIDE) < -0.8);
  assert_true(get_ssim(a->rgb, a->rgb, 10, 40) == 1 && get_ssim(a->rgb, b->rgb, 10, 40) == 0);
  free(a);
  free(b);
}

/* One window, against sums over its 121 pixels as the paper has them. */
static void test_ssim_of_one_window(void **state) {
  (void)state;
  float a[3 * 121], b[3 * 121];
  uint32_t seed = 9;
  double weights = 0, mean[2] = {0, 0}, square[2] = {0, 0}, product = 0;
  for (int i = 0; i < 121; i++) {
    a[i] = a[121 + i] = a[242 + i] = draw(&seed);
    b[i] = b[121 + i] = b[242 + i] = 0.5f * a[i] + 0.5f * draw(&seed);
    const int x = i % 11 - 5, y = i / 11 - 5;
    const double w = exp(-(x * x + y * y) / 4.5), p = (double)a[i], q = (double)b[i];
    weights += w;
    mean[0] += w * p, mean[1] += w * q, square[0] += w * p * p, square[1] += w * q * q, product += w * p * q;
  }
  const double ma = mean[0] / weights, mb = mean[1] / weights, cov = product / weights - ma * mb;
  const double va = square[0] / weights - ma * ma, vb = square[1] / weights - mb * mb;
  const double expected = (2 * ma * mb + 1e-4) * (2 * cov + 9e-4) / ((ma * ma + mb * mb + 1e-4) * (va + vb + 9e-4));
  expect_near(get_ssim(a, b, 11, 11), expected, 1e-5);
}

static double get_flip(const float *a, const float *b) {
  double value = -1;
  assert_int_equal(sty_measure_flip(SIDE, SIDE, a, b, &(StyRun){.threads = 2}, &value, NULL), STY_OK);
  return value;
}

/* Plain pictures have no features, so that the colour difference stands alone; numbers by the paper's formulas. */
static void test_flip_of_plain_pictures(void **state) {
  (void)state;
  Scene *a = make_scene(), *b = make_scene();
  assert_true(get_flip(a->rgb, a->rgb) == 0);
  memset(a->rgb, 0, sizeof a->rgb);
  for (int i = 0; i < PIXELS; i++) paint(b->rgb, i, 1);
  expect_near(get_flip(a->rgb, b->rgb), 0.967380, 1e-5);
  assert_true(get_flip(a->rgb, b->rgb) == get_flip(b->rgb, a->rgb));
  /* Green against blue is the most that two colours differ. */
  memset(b->rgb, 0, sizeof b->rgb);
  for (int i = 0; i < PIXELS; i++) a->rgb[PIXELS + i] = b->rgb[2 * PIXELS + i] = 1;
  expect_near(get_flip(a->rgb, b->rgb), 1, 1e-5);
  free(a);
  free(b);
}

/* Paint of all kinds, against the sum that whole kernels of two dimensions give, worked out apart from this code. */
static void test_flip_of_a_small_picture(void **state) {
  (void)state;
  enum { WIDTH = 24, HEIGHT = 16, COUNT = WIDTH * HEIGHT };
  float a[3 * COUNT], b[3 * COUNT];
  uint32_t seed = 7;
  for (int i = 0; i < COUNT; i++)
    for (int c = 0; c < 3; c++) {
      const float edge = i % WIDTH > 9 ? 0.25f : 0;
      a[c * COUNT + i] = draw(&seed);
      b[c * COUNT + i] = 0.5f * a[c * COUNT + i] + edge + 0.25f * draw(&seed);
    }
  double value = -1;
  assert_int_equal(sty_measure_flip(WIDTH, HEIGHT, a, b, NULL, &value, NULL), STY_OK);
  expect_near(value, 0.4274849, 1e-6);
}

/* What differs in edges differs more than its colours do, and what is too fine to be seen, less. */
static void test_flip_of_features(void **state) {
  (void)state;
  Scene *a = make_scene(), *b = make_scene();
  for (int i = 0; i < PIXELS; i++) paint(b->rgb, i, (i % SIDE + i / SIDE) % 2 ? 0.48f : 0.52f);
  const double fine = get_flip(a->rgb, b->rgb);
  for (int i = 0; i < PIXELS; i++) paint(b->rgb, i, i % SIDE < SIDE / 2 ? 0.48f : 0.52f);
  const double edge = get_flip(a->rgb, b->rgb);
  for (int i = 0; i < PIXELS; i++) paint(b->rgb, i, 0.52f);
  const double plain = get_flip(a->rgb, b->rgb);
  assert_true(fine > 0 && fine < plain && plain < edge && edge < 1);
  free(a);
  free(b);
}

static void test_chunks(void **state) {
  (void)state;
  Scene *a = make_scene();
  static const float one[2] = {1, 1}, twice[2] = {2, 2}, half[2] = {0.5f, 0.5f};
  StyChunks chunks;
  assert_int_equal(sty_measure_chunks(&a->shot, one, &chunks, NULL), STY_OK);
  assert_true(chunks.count == 1 && chunks.pixels == PIXELS && chunks.mean == PIXELS && chunks.weighted == PIXELS);
  for (int i = 0; i < PIXELS / 4; i++) a->matches[i].x = (uint16_t)(a->matches[i].x + 9);
  a->matches[PIXELS - 1].level = STY_LEVEL_NONE;
  assert_int_equal(sty_measure_chunks(&a->shot, one, &chunks, NULL), STY_OK);
  const double first = PIXELS / 4, second = PIXELS - first - 1;
  assert_true(chunks.count == 2 && chunks.largest == (size_t)second && chunks.mean == (PIXELS - 1) / 2.0);
  expect_near(chunks.weighted, (first * first + second * second) / (PIXELS - 1), 1e-9);
  /* Style and lighting part pieces, too. */
  a->matches[0].style = 1, a->matches[SIDE / 2].layer = 1;
  assert_int_equal(sty_measure_chunks(&a->shot, one, &chunks, NULL), STY_OK);
  assert_int_equal(chunks.count, 4);
  for (int i = 0; i < PIXELS; i++)
    a->matches[i] = (StyMatch){(uint16_t)(i % SIDE / 2), (uint16_t)(i / SIDE / 2), 1, 0, 0, 0};
  assert_int_equal(sty_measure_chunks(&a->shot, twice, &chunks, NULL), STY_OK);
  assert_int_equal(chunks.count, 1);
  assert_int_equal(sty_measure_chunks(&a->shot, one, &chunks, NULL), STY_OK);
  assert_true(chunks.count > 1000);
  for (int i = 0; i < PIXELS; i++)
    a->matches[i] = (StyMatch){(uint16_t)(i % SIDE * 2), (uint16_t)(i / SIDE * 2), 1, 0, 0, 0};
  assert_int_equal(sty_measure_chunks(&a->shot, half, &chunks, NULL), STY_OK);
  assert_int_equal(chunks.count, 1);
  free(a);
}

static void test_levels(void **state) {
  (void)state;
  Scene *a = make_scene();
  StyLevels levels;
  for (int i = 0; i < PIXELS / 2; i++) a->matches[i].level = STY_LEVEL_NONE;
  for (int i = PIXELS / 2; i < PIXELS * 3 / 4; i++) a->matches[i].level = STY_LEVEL_FALLBACK;
  sty_measure_levels(&a->shot, &levels);
  assert_true(levels.pixels == PIXELS / 2 && levels.fallback == 0.5 && levels.share[2] == 0.5 && levels.share[0] == 0);
  free(a);
}

static StyRepetition get_repetition(const Scene *scene, int threads) {
  StyRepetition found;
  assert_int_equal(sty_measure_repetition(&scene->shot, &(StyRun){.threads = threads}, &found, NULL), STY_OK);
  return found;
}

static void test_repetition(void **state) {
  (void)state;
  Scene *a = make_scene();
  uint32_t seed = 5;
  float tile[20][20];
  StyRepetition found = get_repetition(a, 1);
  assert_true(found.windows == 4 && found.flat == 1 && found.mean == 0); /* plain paint repeats nothing that is seen */
  for (int i = 0; i < 400; i++) tile[i / 20][i % 20] = draw(&seed);
  for (int i = 0; i < PIXELS; i++) paint(a->rgb, i, tile[i / SIDE % 20][i % SIDE % 20]);
  found = get_repetition(a, 2);
  expect_near(found.mean, 1, 1e-12);
  for (int i = 0; i < PIXELS; i++) paint(a->rgb, i, draw(&seed));
  found = get_repetition(a, 1);
  assert_true(found.mean > 0 && found.largest < 0.2);
  for (int i = 0; i < PIXELS; i++) paint(a->rgb, i, (float)(i % SIDE) / SIDE);
  found = get_repetition(a, 1);
  assert_true(found.largest < 0.02); /* a gradient is like itself next door, but only its rounding peaks */
  for (int y = 0; y < SIDE; y++) a->guide[4 * (y * SIDE + 80)] = 200;
  found = get_repetition(a, 1);
  assert_int_equal(found.windows, 2);
  expect_near(found.flat, 64.0 / 96, 1e-12);
  for (int y = 0; y < SIDE; y++) a->guide[4 * (y * SIDE + 80)] = 253;
  assert_int_equal(get_repetition(a, 1).windows, 4);
  a->guide[4 * (PIXELS - 1) + 3] = 0;
  assert_int_equal(get_repetition(a, 1).windows, 3);
  a->shot.height = STY_FLAT_WINDOW - 1;
  assert_int_equal(get_repetition(a, 1).windows, 0);
  free(a);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_paper_shows_through),
      cmocka_unit_test(test_warp_follows_motion),
      cmocka_unit_test(test_warp_of_known_size),
      cmocka_unit_test(test_warp_between_pixels),
      cmocka_unit_test(test_what_was_hidden_does_not_count),
      cmocka_unit_test(test_ssim),
      cmocka_unit_test(test_ssim_of_one_window),
      cmocka_unit_test(test_flip_of_plain_pictures),
      cmocka_unit_test(test_flip_of_a_small_picture),
      cmocka_unit_test(test_flip_of_features),
      cmocka_unit_test(test_chunks),
      cmocka_unit_test(test_levels),
      cmocka_unit_test(test_repetition),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
