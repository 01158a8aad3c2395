/* Points that every halving of the square shares out evenly, whatever their key. */
#include "base/sobol.h"

#include "../scene/scratch.h"

enum { BITS = 8, COUNT = 1 << BITS };

/* Each of the rectangles 2^-a wide and 2^-(BITS-a) high has one of the points. */
static void test_every_rectangle(void **state) {
  (void)state;
  for (uint64_t key = 0; key < 20; key++)
    for (int a = 0; a <= BITS; a++) {
      int found[COUNT] = {0};
      for (uint32_t i = 0; i < COUNT; i++) {
        double at[2];
        sty_draw_pair(key, i, at);
        assert_true(at[0] >= 0 && at[0] < 1 && at[1] >= 0 && at[1] < 1);
        const int x = (int)(at[0] * (1 << a)), y = (int)(at[1] * (1 << (BITS - a)));
        assert_int_equal(found[x << (BITS - a) | y]++, 0);
      }
    }
}

/* Points of the same number under two keys have nothing to do with each other: their products average 1/4. */
static void test_keys_are_apart(void **state) {
  (void)state;
  double sums[4] = {0};
  for (uint64_t key = 0; key < COUNT; key++)
    for (uint32_t i = 0; i < COUNT; i++) {
      double a[2], b[2];
      sty_draw_pair(sty_mix_bits(2 * key + 1), i, a);
      sty_draw_pair(sty_mix_bits(2 * key + 2), i, b);
      for (int k = 0; k < 4; k++) sums[k] += a[k / 2] * b[k % 2];
    }
  /* The product of two uniform numbers has the variance 7/144; 5 sigma of so many. */
  for (int k = 0; k < 4; k++) assert_true(sums[k] / COUNT / COUNT > 0.25 - 5 * 0.2205 / COUNT);
  for (int k = 0; k < 4; k++) assert_true(sums[k] / COUNT / COUNT < 0.25 + 5 * 0.2205 / COUNT);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_every_rectangle),
      cmocka_unit_test(test_keys_are_apart),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
