/* Seeds worked out before: sty_get_seeds_size, sty_plan_seeds and sty_fill_seeds against the formula of runtime.h, and
 * that they change nothing. */
#include "oracle.h"

enum { FARTHEST = STY_MAX_ANCHOR + STY_MAX_FRAME_SIDE };

static const StySeedOffset untouched_offset = {-128, 127};

static StySeedOffset *make_offsets(StyRect area) {
  const size_t size = sty_get_seeds_size(area);
  assert_in_range(size, 1, SIZE_MAX / 2);
  StySeedOffset *offsets = malloc(size);
  assert_non_null(offsets);
  for (size_t i = 0; i < size / sizeof *offsets; i++) offsets[i] = untouched_offset;
  return offsets;
}

static void test_sizes(void **state) {
  (void)state;
  static const struct {
    StyRect area;
    size_t pixels;
  } cases[] = {{{0, 0, 1, 1}, 1},
               {{-3, -5, 7, 2}, 70},
               {{0, 0, 1920, 1080}, (size_t)1920 * 1080},
               {{FARTHEST - 2, -FARTHEST, FARTHEST, 3 - FARTHEST}, 6},
               {{0, 0, 0, 1}, 0},
               {{0, 0, 1, 0}, 0},
               {{3, 0, 1, 1}, 0},
               {{0, 3, 1, 1}, 0},
               {{0, 0, FARTHEST + 1, 1}, 0},
               {{0, 0, 1, FARTHEST + 1}, 0},
               {{-FARTHEST - 1, 0, 1, 1}, 0},
               {{0, -FARTHEST - 1, 1, 1}, 0},
               {{INT32_MIN, INT32_MIN, INT32_MAX, INT32_MAX}, 0}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    assert_int_equal(sty_get_seeds_size(cases[i].area), 12 * cases[i].pixels);
}

/* An area around 0, 0, around cells where the table begins anew, or at the ends of what there is. */
static StyRect draw_area(uint64_t *random) {
  const int width = 1 + draw_below(random, 90), height = 1 + draw_below(random, 90);
  const int x = (int)DRAW_OF(random, -50, 0, -256 * 64 - 20, draw_below(random, 1 << 24), -FARTHEST, FARTHEST - width);
  const int y = (int)DRAW_OF(random, -50, 0, 256 * 32 - 20, -draw_below(random, 1 << 24), -FARTHEST, FARTHEST - height);
  return (StyRect){x, y, x + width, y + height};
}

static void expect_offsets(const Fixture *fixture, const StySeeds *seeds, int y0, int y1) {
  const StyRect area = seeds->area;
  const StySeedOffset *found = seeds->offsets;
  for (int level = 1; level <= STY_SEED_LEVELS; level++)
    for (int y = area.y0; y < area.y1; y++)
      for (int x = area.x0; x < area.x1; x++, found++) {
        StySeedOffset wanted = untouched_offset;
        if (y >= y0 && y < y1) {
          const Pair seed = find_seed(fixture, seeds->table, seeds->amount, x, y, 1 << level);
          assert_in_range(seed.x - x + 128, 0, 255);
          wanted = (StySeedOffset){(int8_t)(seed.x - x), (int8_t)(seed.y - y)};
        }
        if (found->x != wanted.x || found->y != wanted.y)
          fail_msg("level %d at (%d, %d): found %d %d, expected %d %d", level, x, y, found->x, found->y, wanted.x,
                   wanted.y);
      }
}

static void test_equal_the_formula(void **state) {
  (void)state;
  uint64_t random = 1;
  const Guides how = {0, 4, 0};
  for (int round = 0; round < CASES(100, 20); round++) {
    Fixture *fixture = draw_fixture(&random, &how, 8, 2);
    const StyRect area = draw_area(&random);
    const int style = 1 + round % 2, number = (int)DRAW_OF(&random, 0, 1, draw_below(&random, 100), INT32_MAX);
    StySeedOffset *offsets = make_offsets(area);
    StySeeds seeds;
    assert_int_equal(sty_plan_seeds(&fixture->bundle, style, number, area, offsets, &seeds), STY_RUNTIME_OK);
    assert_memory_equal(&seeds.area, &area, sizeof area);
    assert_ptr_equal(seeds.offsets, offsets);
    assert_int_equal(seeds.table, find_table(fixture, style, number));
    assert_int_equal(seeds.amount, round_fraction(fixture->style[style].jitter_amount, 255));
    const int part = area.y0 + draw_below(&random, area.y1 - area.y0);
    assert_int_equal(sty_fill_seeds(&fixture->bundle, &seeds, part, area.y1, STY_PATH_BEST), STY_RUNTIME_OK);
    expect_offsets(fixture, &seeds, part, area.y1);
    assert_int_equal(sty_fill_seeds(&fixture->bundle, &seeds, area.y0, part, STY_PATH_BEST), STY_RUNTIME_OK);
    expect_offsets(fixture, &seeds, area.y0, area.y1);
    free(offsets);
    destroy_fixture(fixture);
  }
}

/* Offsets are bytes: no seed of level 6 is farther, whatever the table. */
static void test_farthest_offsets_fit_bytes(void **state) {
  (void)state;
  uint64_t random = 2;
  Fixture *fixture = make_fixture(1, 1, 1, 1, 1, 1);
  uint8_t *jitter = fixture->texels[STY_BUNDLE_JITTER];
  for (size_t i = 0; i < count_texel_bytes(fixture, STY_BUNDLE_JITTER); i++) jitter[i] = draw(&random) & 1 ? 255 : 0;
  open_fixture(fixture);
  const StyRect area = {-300, -300, 300, 300};
  StySeedOffset *offsets = make_offsets(area);
  StySeeds seeds;
  assert_int_equal(sty_plan_seeds(&fixture->bundle, 1, 0, area, offsets, &seeds), STY_RUNTIME_OK);
  assert_int_equal(sty_fill_seeds(&fixture->bundle, &seeds, -300, 300, STY_PATH_BEST), STY_RUNTIME_OK);
  expect_offsets(fixture, &seeds, -300, 300);
  free(offsets);
  destroy_fixture(fixture);
}

/* Frames with seeds that fit, that answer for a part, and that belong to another table or amount: the same matches. */
static void test_change_nothing(void **state) {
  (void)state;
  uint64_t random = 3;
  enum { MOST = 4 };
  for (int round = 0; round < CASES(60, 12); round++) {
    const Guides how = draw_guides(&random);
    Fixture *fixture = draw_fixture(&random, &how, 32, 2);
    StyFrame frame = draw_frame(&random, &how, fixture, 61, 47);
    StyMatch *without = make_matches(&frame), *with = make_matches(&frame);
    StySeedOffset *offsets[MOST];
    StySeeds seeds[MOST];
    for (int i = 0; i < MOST; i++) {
      const bool fits = draw(&random) & 1;
      const StyRect whole = {-100, -100, 161, 147}, area = fits ? whole : draw_area(&random);
      offsets[i] = make_offsets(area);
      const int number = fits ? frame.number : draw_below(&random, 100);
      assert_int_equal(
          sty_plan_seeds(&fixture->bundle, 1 + draw_below(&random, 2), number, area, offsets[i], &seeds[i]),
          STY_RUNTIME_OK);
      assert_int_equal(sty_fill_seeds(&fixture->bundle, &seeds[i], area.y0, area.y1, STY_PATH_BEST), STY_RUNTIME_OK);
    }
    assert_int_equal(sty_transfer_frame(&fixture->bundle, &frame, get_all(&frame), without), STY_RUNTIME_OK);
    frame.seeds = seeds;
    frame.seeds_count = draw_below(&random, MOST + 1);
    assert_int_equal(sty_transfer_frame(&fixture->bundle, &frame, get_all(&frame), with), STY_RUNTIME_OK);
    assert_memory_equal(without, with, 61 * 47 * sizeof *with);
    for (int i = 0; i < MOST; i++) free(offsets[i]);
    free(without);
    free(with);
    destroy_frame(&frame);
    destroy_fixture(fixture);
  }
}

static void test_bad_arguments(void **state) {
  (void)state;
  Fixture *fixture = make_fixture(1, 1, 1, 2, 1, 3);
  open_fixture(fixture);
  const StyBundle *bundle = &fixture->bundle;
  const StyRect area = {-2, -3, 4, 5}, empty = {0, 0, 0, 1}, far = {0, 0, FARTHEST + 1, 1};
  StySeedOffset *offsets = make_offsets(area);
  StySeeds seeds;
  assert_int_equal(sty_plan_seeds(NULL, 1, 0, area, offsets, &seeds), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_plan_seeds(bundle, 0, 0, area, offsets, &seeds), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_plan_seeds(bundle, 3, 0, area, offsets, &seeds), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_plan_seeds(bundle, 1, -1, area, offsets, &seeds), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_plan_seeds(bundle, 1, 0, empty, offsets, &seeds), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_plan_seeds(bundle, 1, 0, far, offsets, &seeds), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_plan_seeds(bundle, 1, 0, area, NULL, &seeds), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_plan_seeds(bundle, 1, 0, area, offsets, NULL), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_plan_seeds(bundle, 2, 5, area, offsets, &seeds), STY_RUNTIME_OK);
  const StySeeds wrong[] = {{area, 3, 255, offsets}, {area, -1, 255, offsets}, {area, 0, 256, offsets},
                            {area, 0, -1, offsets},  {area, 0, 255, NULL},     {empty, 0, 255, offsets},
                            {far, 0, 255, offsets}};
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
    assert_int_equal(sty_fill_seeds(bundle, &wrong[i], 0, 1, STY_PATH_BEST), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_fill_seeds(NULL, &seeds, 0, 1, STY_PATH_BEST), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_fill_seeds(bundle, NULL, 0, 1, STY_PATH_BEST), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_fill_seeds(bundle, &seeds, -4, 1, STY_PATH_BEST), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_fill_seeds(bundle, &seeds, 0, 6, STY_PATH_BEST), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_fill_seeds(bundle, &seeds, 1, 0, STY_PATH_BEST), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_fill_seeds(bundle, &seeds, 0, 1, STY_PATH_AVX512 + 1), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_fill_seeds(bundle, &seeds, 5, 5, STY_PATH_BEST), STY_RUNTIME_OK);
  expect_offsets(fixture, &(StySeeds){area, 0, 255, offsets}, 0, 0); /* nothing was written */
  free(offsets);
  destroy_fixture(fixture);
}

/* Paths are there or refused, and no number beyond them is one. */
static void test_paths(void **state) {
  (void)state;
  Fixture *fixture = make_fixture(1, 1, 1, 1, 1, 1);
  open_fixture(fixture);
  assert_true(sty_has_path(STY_PATH_BEST) && sty_has_path(STY_PATH_REFERENCE));
  for (int path = -1; path <= STY_PATH_AVX512 + 1; path++) {
    const uint8_t guide[4] = {0, 0, 0, 255};
    const StyFrame frame = {.width = 1, .height = 1, .guide = guide, .style = 1, .path = (StyRuntimePath)path};
    StyMatch match;
    const bool is_there = path >= 0 && path <= STY_PATH_AVX512 && sty_has_path((StyRuntimePath)path);
    assert_int_equal(sty_has_path((StyRuntimePath)path) != 0, is_there);
    const StyRuntimeStatus wanted = is_there ? STY_RUNTIME_OK : STY_RUNTIME_BAD_ARGUMENT;
    uint8_t picture[4];
    assert_int_equal(sty_transfer_frame(&fixture->bundle, &frame, get_all(&frame), &match), wanted);
    match = (StyMatch){.x = 0};
    assert_int_equal(sty_blend_frame(&fixture->bundle, &frame, get_all(&frame), &match, 8, picture), wanted);
  }
  destroy_fixture(fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_sizes),
                                     cmocka_unit_test(test_equal_the_formula),
                                     cmocka_unit_test(test_farthest_offsets_fit_bytes),
                                     cmocka_unit_test(test_change_nothing),
                                     cmocka_unit_test(test_bad_arguments),
                                     cmocka_unit_test(test_paths)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
