/* Where flat windows are. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "stylut/measure.h"

enum { WIDTH = 150, HEIGHT = 100, W = STY_FLAT_WINDOW };

static uint8_t guide[4 * WIDTH * HEIGHT], mask[WIDTH * HEIGHT];

static void fill_guide(void) {
  for (int i = 0; i < WIDTH * HEIGHT; i++) memcpy(guide + 4 * i, (uint8_t[]){128, 128, 255, 255}, 4);
}

/* How many pixels the mask has, all of them in x0..x1-1, y0..y1-1. */
static int count_mask(int x0, int y0, int x1, int y1) {
  int count = 0;
  memset(mask, 7, sizeof mask);
  sty_mark_flat(&(StyShot){.width = WIDTH, .height = HEIGHT, .guide = guide}, mask);
  for (int i = 0; i < WIDTH * HEIGHT; i++) {
    const int x = i % WIDTH, y = i / WIDTH;
    assert_true(mask[i] == 0 || mask[i] == 255);
    if (mask[i]) assert_true(x >= x0 && x < x1 && y >= y0 && y < y1);
    count += mask[i] > 0;
  }
  return count;
}

static void test_all(void **state) {
  (void)state;
  fill_guide();
  assert_int_equal(count_mask(0, 0, 128, 96), 128 * 96); /* what whole windows hold */
}

static void test_steps(void **state) {
  (void)state;
  fill_guide();
  uint8_t *texel = guide + 4 * (10 * WIDTH + 10); /* in the first window alone */
  texel[0] += STY_FLAT_STEPS;
  assert_int_equal(count_mask(0, 0, 128, 96), 128 * 96);
  texel[0]++;
  assert_int_equal(count_mask(0, 0, 128, 96), 128 * 96 - W / 2 * (W / 2));
  texel[0] = 128;
  texel[3] = 0;
  assert_int_equal(count_mask(0, 0, 128, 96), 128 * 96 - W / 2 * (W / 2));
}

static void test_small(void **state) {
  (void)state;
  memset(mask, 7, sizeof mask);
  sty_mark_flat(&(StyShot){.width = W - 1, .height = W, .guide = guide}, mask);
  for (int i = 0; i < (W - 1) * W; i++) assert_int_equal(mask[i], 0);
  assert_int_equal(mask[(W - 1) * W], 7);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_all), cmocka_unit_test(test_steps),
                                     cmocka_unit_test(test_small)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
