/* sty_look_up_frame, the lit sphere, against the formula of runtime.h. */
#include "oracle.h"

static void test_equals_the_formula(void **state) {
  (void)state;
  static const int sides[] = {1, 2, 7, 64, 255, 256};
  uint64_t random = 1;
  size_t lightings[STY_MAX_LIGHTINGS] = {0};
  for (int round = 0; round < CASES(60, 24); round++) {
    const Guides how = draw_guides(&random);
    Fixture *fixture = draw_fixture(&random, &how, sides[round % 6], 1 + draw_below(&random, 4));
    for (int size = 0; size < FRAME_SIZES; size++) {
      const StyFrame frame = draw_frame(&random, &how, fixture, frame_sizes[size][0], frame_sizes[size][1]);
      const StyRect rect = round % 2 ? get_all(&frame) : draw_rect(&random, &frame);
      StyMatch *matches = make_matches(&frame);
      assert_int_equal(sty_look_up_frame(&fixture->bundle, &frame, rect, matches), STY_RUNTIME_OK);
      for (int y = 0; y < frame.height; y++)
        for (int x = 0; x < frame.width; x++) {
          const StyMatch found = matches[y * frame.width + x];
          expect_same_match(&frame, x, y, found,
                            is_inside(rect, x, y) ? expect_fallback(fixture, &frame, x, y) : untouched);
          if (found.level == STY_LEVEL_FALLBACK) lightings[found.layer]++;
        }
      free(matches);
      destroy_frame(&frame);
    }
    destroy_fixture(fixture);
  }
  for (int i = 0; i < STY_MAX_LIGHTINGS; i++) assert_in_range(lightings[i], 100, SIZE_MAX);
}

/* NaN is 0, and what lies beyond -1..1 is its end, at either way of addressing. */
static void test_guides_that_are_no_normals(void **state) {
  (void)state;
  static const float odd[] = {NAN, INFINITY, -INFINITY, 7, -7}, plain[] = {0, 1, -1, 1, -1};
  uint64_t random = 2;
  for (unsigned flags = 0; flags <= STY_FLAG_UNORM8; flags++) {
    Fixture *fixture = make_fixture(200, 100, 16, 1, 1, 1);
    fill_random(&random, fixture->texels[STY_BUNDLE_LUTS], count_texel_bytes(fixture, STY_BUNDLE_LUTS));
    write_style(fixture, 1, &(StyStyle){.layer_count = 1, .scale = 1, .flags = flags});
    open_fixture(fixture);
    const uint8_t guide[4] = {0, 0, 0, 1};
    for (int i = 0; i < 25; i++) {
      StyMatch found[2];
      for (int k = 0; k < 2; k++) {
        const float *values = k ? plain : odd, fine[2] = {values[i % 5], values[i / 5]};
        const StyFrame frame = {.width = 1, .height = 1, .guide = guide, .fine = fine, .style = 1};
        assert_int_equal(sty_look_up_frame(&fixture->bundle, &frame, get_all(&frame), &found[k]), STY_RUNTIME_OK);
      }
      assert_true(is_same(found[0], found[1]));
    }
    destroy_fixture(fixture);
  }
}

static void test_bad_arguments(void **state) {
  (void)state;
  Fixture *fixture = make_fixture(2, 2, 2, 1, 1, 1);
  open_fixture(fixture);
  const uint8_t guide[4] = {0, 0, 0, 255};
  StyMatch match = untouched;
  StyFrame frame = {.width = 1, .height = 1, .guide = guide, .style = 1};
  const StyRect all = get_all(&frame);
  assert_int_equal(sty_look_up_frame(NULL, &frame, all, &match), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_look_up_frame(&fixture->bundle, NULL, all, &match), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_look_up_frame(&fixture->bundle, &frame, all, NULL), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_look_up_frame(&fixture->bundle, &frame, (StyRect){0, 0, 2, 1}, &match),
                   STY_RUNTIME_BAD_ARGUMENT);
  frame.style = 2;
  assert_int_equal(sty_look_up_frame(&fixture->bundle, &frame, all, &match), STY_RUNTIME_BAD_ARGUMENT);
  assert_true(is_same(match, untouched));
  destroy_fixture(fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_equals_the_formula),
                                     cmocka_unit_test(test_guides_that_are_no_normals),
                                     cmocka_unit_test(test_bad_arguments)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
