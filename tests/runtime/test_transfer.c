/* sty_transfer_frame against the formula of runtime.h, written out literally. */
#include "oracle.h"
#include "sphere.h"

/* Matches of one rectangle on an untouched field, in a block of exactly the frame's size. */
static StyMatch *transfer_rect(const Fixture *fixture, const StyFrame *frame, StyRect rect) {
  StyMatch *matches = make_matches(frame);
  assert_int_equal(sty_transfer_frame(&fixture->bundle, frame, rect, matches), STY_RUNTIME_OK);
  return matches;
}

static void expect_matches(const Fixture *fixture, const StyFrame *frame, StyRect rect, const StyMatch *matches,
                           size_t levels[256]) {
  for (int y = 0; y < frame->height; y++)
    for (int x = 0; x < frame->width; x++) {
      const StyMatch found = matches[y * frame->width + x];
      expect_same_match(frame, x, y, found, is_inside(rect, x, y) ? expect_match(fixture, frame, x, y) : untouched);
      if (levels) levels[found.level]++;
    }
}

static void test_equals_the_formula(void **state) {
  (void)state;
  static const int sides[] = {1, 2, 7, 64, 255, 256};
  uint64_t random = 1;
  size_t levels[256] = {0};
  for (int round = 0; round < CASES(120, 20); round++) {
    const Guides how = draw_guides(&random);
    Fixture *fixture = draw_fixture(&random, &how, sides[round % 6], 1 + draw_below(&random, 4));
    for (int size = 0; size < FRAME_SIZES; size++) {
      const StyFrame frame = draw_frame(&random, &how, fixture, frame_sizes[size][0], frame_sizes[size][1]);
      StyMatch *matches = transfer_rect(fixture, &frame, get_all(&frame));
      expect_matches(fixture, &frame, get_all(&frame), matches, levels);
      free(matches);
      destroy_frame(&frame);
    }
    destroy_fixture(fixture);
  }
  /* Every way out was taken. */
  for (int level = 0; level <= 6; level++) assert_in_range(levels[level], 1, SIZE_MAX);
  assert_in_range(levels[STY_LEVEL_FALLBACK], 1, SIZE_MAX);
  assert_in_range(levels[STY_LEVEL_NONE], 1, SIZE_MAX);
}

/* What decides, beside guides and LUT. */
enum {
  LUMA,
  LUMA_WEIGHT,
  FIRST_LAYER_ONLY,
  SCALE,
  RESOLUTION,
  AMOUNT,
  TABLE,
  ANCHORS,
  OBJECTS,
  SCATTER,
  FINE,
  FEATURES
};

/* Takes one feature away. */
static void take_away(int feature, Fixture *fixture, StyFrame *frame) {
  for (int style = 1; style <= fixture->styles; style++) {
    StyStyle *values = &fixture->style[style];
    if (feature == LUMA_WEIGHT) values->luma_weight = 0;
    if (feature == FIRST_LAYER_ONLY) values->layer_count = 1;
    if (feature == SCALE) values->scale = 1;
    if (feature == AMOUNT) values->jitter_amount = 1;
    if (feature == TABLE) values->jitter_period = 0;
    if (feature == SCATTER) values->scatter = 0;
  }
  if (feature == LUMA) frame->luma = NULL;
  if (feature == RESOLUTION) frame->resolution = 0;
  if (feature == ANCHORS) frame->anchors = NULL;
  if (feature == OBJECTS) frame->objects = NULL;
  if (feature == FINE) frame->fine = NULL;
}

/* None of what the other tests draw is idle: each feature changes matches, so that they would notice its loss. */
static void test_every_feature_decides(void **state) {
  (void)state;
  uint64_t random = 1;
  size_t changed[FEATURES] = {0};
  for (int round = 0; round < CASES(120, 40); round++) {
    const Guides how = draw_guides(&random);
    Fixture *fixture = draw_fixture(&random, &how, 64, 1 + draw_below(&random, 4));
    const StyFrame frame = draw_frame(&random, &how, fixture, 37, 23);
    StyMatch *matches = transfer_rect(fixture, &frame, get_all(&frame));
    for (int feature = 0; feature < FEATURES; feature++) {
      Fixture lesser = *fixture;
      StyFrame plainer = frame;
      take_away(feature, &lesser, &plainer);
      for (int y = 0; y < frame.height; y++)
        for (int x = 0; x < frame.width; x++)
          changed[feature] += !is_same(expect_match(&lesser, &plainer, x, y), matches[y * frame.width + x]);
    }
    free(matches);
    destroy_frame(&frame);
    destroy_fixture(fixture);
  }
  for (int feature = 0; feature < FEATURES; feature++)
    if (changed[feature] < 100) fail_msg("feature %d changed %zu matches", feature, changed[feature]);
}

/* Cells beyond the table of 256 and the highest level, on long strips: the table repeats, nothing overflows. */
static void test_long_frames_and_top_levels(void **state) {
  (void)state;
  static const int sizes[][2] = {{9001, 1}, {1, 9001}, {1031, 3}};
  uint64_t random = 2;
  for (int round = 0; round < CASES(12, 3); round++) {
    const Guides how = {100, 30, 0};
    Fixture *fixture = draw_fixture(&random, &how, 64, 1);
    StyStyle style = fixture->style[1];
    style.top_level = round % 4 ? STY_MAX_LEVEL - round % 4 + 1 : 4;
    write_style(fixture, 1, &style);
    const StyFrame frame = draw_frame(&random, &how, fixture, sizes[round % 3][0], sizes[round % 3][1]);
    StyMatch *matches = transfer_rect(fixture, &frame, get_all(&frame));
    expect_matches(fixture, &frame, get_all(&frame), matches, NULL);
    free(matches);
    destroy_frame(&frame);
    destroy_fixture(fixture);
  }
}

static void test_tiles_equal_the_whole(void **state) {
  (void)state;
  uint64_t random = 3;
  for (int round = 0; round < CASES(40, 6); round++) {
    const Guides how = draw_guides(&random);
    Fixture *fixture = draw_fixture(&random, &how, 32, 3);
    const int *size = frame_sizes[round % FRAME_SIZES];
    const StyFrame frame = draw_frame(&random, &how, fixture, size[0], size[1]);
    const int step_x = 1 + draw_below(&random, 40), step_y = 1 + draw_below(&random, 40);
    StyMatch *whole = transfer_rect(fixture, &frame, get_all(&frame));
    StyMatch *tiled = transfer_rect(fixture, &frame, (StyRect){0, 0, 0, 0});
    for (int y = (size[1] - 1) / step_y * step_y; y >= 0; y -= step_y)
      for (int x = 0; x < size[0]; x += step_x) {
        const StyRect tile = {x, y, x + step_x < size[0] ? x + step_x : size[0],
                              y + step_y < size[1] ? y + step_y : size[1]};
        assert_int_equal(sty_transfer_frame(&fixture->bundle, &frame, tile, tiled), STY_RUNTIME_OK);
      }
    for (int i = 0; i < size[0] * size[1]; i++) assert_true(is_same(whole[i], tiled[i]));
    const StyRect rect = draw_rect(&random, &frame);
    StyMatch *part = transfer_rect(fixture, &frame, rect);
    expect_matches(fixture, &frame, rect, part, NULL);
    free(whole);
    free(tiled);
    free(part);
    destroy_frame(&frame);
    destroy_fixture(fixture);
  }
}

/* Frames where no pixel is stylized, by any pass: not covered, or of styles that the bundle lacks. */
static void test_nothing_covered(void **state) {
  (void)state;
  enum { PIXELS = 37 * 23 };
  uint64_t random = 4;
  const Guides how = {0, 256, 0};
  Fixture *fixture = draw_fixture(&random, &how, 16, 1);
  for (int covered = 0; covered < 2; covered++) {
    uint8_t guide[4 * PIXELS], styles[PIXELS], picture[4 * PIXELS];
    StyMatch matches[4][PIXELS];
    draw_guide(&random, &how, guide, PIXELS);
    for (int i = 0; i < PIXELS; i++) guide[4 * i + 3] = (uint8_t)covered;
    for (int i = 0; i < PIXELS; i++) styles[i] = i % 2 ? 0 : i % 3 ? 2 : 255;
    const StyFrame frame = {.width = 37, .height = 23, .guide = guide, .styles = covered ? styles : NULL, .style = 1};
    const StyFrame half = {
        .width = 19, .height = 12, .resolution = -1, .guide = guide, .styles = frame.styles, .style = 1};
    const StyRect all = get_all(&frame);
    memset(matches, 0, sizeof matches);
    assert_int_equal(sty_transfer_frame(&fixture->bundle, &frame, all, matches[0]), STY_RUNTIME_OK);
    assert_int_equal(sty_look_up_frame(&fixture->bundle, &frame, all, matches[1]), STY_RUNTIME_OK);
    assert_int_equal(sty_transfer_brute(&fixture->bundle, &frame, matches[2]), STY_RUNTIME_OK);
    assert_int_equal(sty_expand_matches(&fixture->bundle, &half, matches[0], &frame, all, matches[3]), STY_RUNTIME_OK);
    for (int i = 0; i < 4 * PIXELS; i++) assert_true(is_same(matches[i / PIXELS][i % PIXELS], no_match));
    memset(picture, 1, sizeof picture);
    assert_int_equal(sty_blend_frame(&fixture->bundle, &frame, all, matches[0], 8, picture), STY_RUNTIME_OK);
    for (size_t i = 0; i < sizeof picture; i++) assert_int_equal(picture[i], 0);
  }
  destroy_fixture(fixture);
}

/* Accepted when below the threshold: an error of 24 passes at 25 only, and never decides by itself at 766. */
static void test_threshold_is_strict(void **state) {
  (void)state;
  static const int cases[][3] = {{24, 24, STY_LEVEL_FALLBACK},   {24, 25, 0},  {0, 0, STY_LEVEL_FALLBACK}, {0, 1, 0},
                                 {765, 765, STY_LEVEL_FALLBACK}, {765, 766, 0}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    Fixture *fixture = make_fixture(1, 1, 1, 1, 1, 1);
    const StyStyle style = {.threshold = cases[i][1]};
    write_style(fixture, 1, &style);
    fixture->texels[STY_BUNDLE_GUIDES][3] = 1;
    open_fixture(fixture);
    const int error = cases[i][0];
    const uint8_t guide[4] = {(uint8_t)(error / 3), (uint8_t)(error / 3), (uint8_t)(error - error / 3 * 2), 255};
    const StyFrame frame = {.width = 1, .height = 1, .guide = guide, .style = 1};
    StyMatch *match = transfer_rect(fixture, &frame, get_all(&frame));
    assert_int_equal(match->level, cases[i][2]);
    free(match);
    destroy_fixture(fixture);
  }
}

/* A sphere styled after itself: every level offers each covered pixel itself, and so does the fallback. */
static void test_sphere_after_itself(void **state) {
  (void)state;
  const int side = CASES(128, 48);
  uint64_t random = 5;
  Fixture *fixture = make_sphere(&random, side, 1);
  const uint8_t *guide = fixture->texels[STY_BUNDLE_GUIDES];
  for (int threshold = 0; threshold <= 24; threshold += 24) {
    const StyStyle style = {.threshold = threshold, .top_level = 6, .flags = STY_FLAG_UNORM8};
    write_style(fixture, 1, &style);
    open_fixture(fixture);
    const StyFrame frame = {.width = side, .height = side, .guide = guide, .style = 1, .number = 1};
    StyMatch *matches = transfer_rect(fixture, &frame, get_all(&frame));
    for (int i = 0; i < side * side; i++) {
      assert_int_equal(matches[i].x, guide[4 * i + 3] ? i % side : (int)STY_NO_SOURCE);
      assert_int_equal(matches[i].y, guide[4 * i + 3] ? i / side : (int)STY_NO_SOURCE);
      if (guide[4 * i + 3]) assert_int_equal(matches[i].level == STY_LEVEL_FALLBACK, threshold == 0);
    }
    free(matches);
  }
  destroy_fixture(fixture);
}

/* Luminance decides by the number: guide and source agree, luma is 10 beside lightings of 0 and 20. */
static void test_luminance_to_the_number(void **state) {
  (void)state;
  static const struct {
    float weight;
    int threshold, luma, level, lighting;
  } cases[] = {{1, 10, 10, STY_LEVEL_FALLBACK, 0},
               {1, 11, 10, 0, 0},
               {1, 10, 11, 0, 1},
               {0.1f, 1, 10, STY_LEVEL_FALLBACK, 0},
               {0.1f, 1, 9, 0, 0},
               {0.1f, 2, 255, STY_LEVEL_FALLBACK, 1},
               {16, 160, 10, STY_LEVEL_FALLBACK, 0},
               {16, 161, 10, 0, 0},
               {0, 1, 255, 0, 1},
               {0, 1, 0, 0, 0}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    Fixture *fixture = make_fixture(1, 1, 1, 1, 2, 1);
    const StyStyle style = {.threshold = cases[i].threshold,
                            .luma_weight = cases[i].weight,
                            .layer_count = 2,
                            .luma = {0, 20 / 255.0f},
                            .scale = 1};
    write_style(fixture, 1, &style);
    fixture->texels[STY_BUNDLE_GUIDES][3] = 1;
    open_fixture(fixture);
    const uint8_t guide[4] = {0, 0, 0, 255}, luma = (uint8_t)cases[i].luma;
    StyFrame frame = {.width = 1, .height = 1, .guide = guide, .luma = &luma, .style = 1};
    StyMatch *match = transfer_rect(fixture, &frame, get_all(&frame));
    expect_same_match(&frame, 0, 0, *match, make_match((Pair){0, 0}, cases[i].level, cases[i].lighting, 1));
    free(match);
    frame.luma = NULL; /* no luminance error, always the first */
    match = transfer_rect(fixture, &frame, get_all(&frame));
    expect_same_match(&frame, 0, 0, *match, make_match((Pair){0, 0}, 0, 0, 1));
    free(match);
    destroy_fixture(fixture);
  }
}

/* Which table a frame has, seen from the seeds: every table puts them elsewhere. */
static void test_tables_last_for_their_period(void **state) {
  (void)state;
  static const int cases[][3] = {{0, 999, 0},
                                 {1, 0, 0},
                                 {1, 4, 1},
                                 {2, 1, 0},
                                 {2, 5, 2},
                                 {7, 20, 2},
                                 {7, 21, 0},
                                 {65535, 65534, 0},
                                 {65535, 65535, 1},
                                 {65535, 131070, 2},
                                 {1, 3000, 0},
                                 {1, INT32_MAX, INT32_MAX % 3},
                                 {65535, INT32_MAX, INT32_MAX / 65535 % 3}};
  uint64_t random = 6;
  const Guides how = {100, 30, 0};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    Fixture *fixture = make_fixture(40, 40, 64, 1, 1, 3);
    for (int file = STY_BUNDLE_EXEMPLARS; file < STY_BUNDLE_FILES; file++)
      if (file != STY_BUNDLE_PARAMS) fill_random(&random, fixture->texels[file], count_texel_bytes(fixture, file));
    memset(fixture->texels[STY_BUNDLE_GUIDES], 255, count_texel_bytes(fixture, STY_BUNDLE_GUIDES));
    const StyStyle style = {.threshold = STY_MAX_THRESHOLD,
                            .top_level = 4,
                            .layer_count = 1,
                            .jitter_amount = 1,
                            .jitter_period = cases[i][0],
                            .scale = 1};
    write_style(fixture, 1, &style);
    open_fixture(fixture);
    uint8_t guide[4 * 37 * 23];
    draw_guide(&random, &how, guide, 37 * 23);
    StyFrame frame = {.width = 37, .height = 23, .guide = guide, .style = 1};
    StyMatch *matches[4];
    for (int table = 0; table < 4; table++) {
      fixture->style[1].jitter_period = table < 3 ? 1 : cases[i][0];
      write_style(fixture, 1, &fixture->style[1]);
      frame.number = table < 3 ? table : cases[i][1];
      matches[table] = transfer_rect(fixture, &frame, get_all(&frame));
    }
    for (int table = 0; table < 3; table++)
      assert_int_equal(memcmp(matches[3], matches[table], 37 * 23 * sizeof **matches) == 0, table == cases[i][2]);
    for (int table = 0; table < 4; table++) free(matches[table]);
    destroy_fixture(fixture);
  }
}

static void test_bad_arguments(void **state) {
  (void)state;
  Fixture *fixture = make_fixture(2, 2, 2, 2, 1, 1);
  open_fixture(fixture);
  const uint8_t guide[4 * 6] = {0}, styles[6] = {1, 1, 1, 1, 1, 1};
  StyMatch matches[6];
  const StyFrame good = {.width = 3, .height = 2, .guide = guide, .style = 2};
  const StyRect all = get_all(&good);
  const int32_t anchors[] = {0, STY_MAX_ANCHOR + 1}, low[] = {-STY_MAX_ANCHOR - 1, 0};
  enum { FRAMES = 17 };
  StyFrame frames[FRAMES];
  for (int i = 0; i < FRAMES; i++) frames[i] = good;
  frames[0].width = 0;
  frames[1].height = 0;
  frames[2].width = -3;
  frames[3].width = STY_MAX_FRAME_SIDE + 1;
  frames[4].height = STY_MAX_FRAME_SIDE + 1;
  frames[5].guide = NULL;
  frames[6].style = 0;
  frames[7].style = 3;
  frames[8].number = -1;
  frames[9].resolution = -2;
  frames[10].resolution = 2;
  frames[11].anchor_count = -1;
  frames[11].anchors = anchors;
  frames[12].anchor_count = 1;
  frames[12].anchors = anchors;
  frames[13].anchor_count = 1;
  frames[13].anchors = low;
  frames[14].path = STY_PATH_AVX512 + 1;
  frames[15].path = (StyRuntimePath)-1;
  frames[16].seeds_count = -1;
  const StyRect nothing = {0, 0, 0, 0};
  uint8_t picture[4 * 6];
  for (int i = 0; i < FRAMES; i++) { /* no pass takes them */
    assert_int_equal(sty_transfer_frame(&fixture->bundle, &frames[i], nothing, matches), STY_RUNTIME_BAD_ARGUMENT);
    assert_int_equal(sty_look_up_frame(&fixture->bundle, &frames[i], nothing, matches), STY_RUNTIME_BAD_ARGUMENT);
    assert_int_equal(sty_transfer_brute(&fixture->bundle, &frames[i], matches), STY_RUNTIME_BAD_ARGUMENT);
    assert_int_equal(sty_blend_frame(&fixture->bundle, &frames[i], nothing, matches, 8, picture),
                     STY_RUNTIME_BAD_ARGUMENT);
  }
  static const StyRect rects[] = {{-1, 0, 1, 1}, {0, -1, 1, 1}, {0, 0, 4, 1}, {0, 0, 1, 3}, {2, 0, 1, 1}, {0, 2, 1, 1}};
  for (size_t i = 0; i < sizeof rects / sizeof *rects; i++)
    assert_int_equal(sty_transfer_frame(&fixture->bundle, &good, rects[i], matches), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_transfer_frame(NULL, &good, all, matches), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_transfer_frame(&fixture->bundle, NULL, all, matches), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_transfer_frame(&fixture->bundle, &good, all, NULL), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_transfer_frame(&fixture->bundle, &good, (StyRect){3, 2, 3, 2}, matches), STY_RUNTIME_OK);
  StyFrame styled = good;
  styled.styles = styles;
  styled.style = 0;
  assert_int_equal(sty_transfer_frame(&fixture->bundle, &styled, all, matches), STY_RUNTIME_OK);
  destroy_fixture(fixture);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_equals_the_formula),
                                     cmocka_unit_test(test_every_feature_decides),
                                     cmocka_unit_test(test_luminance_to_the_number),
                                     cmocka_unit_test(test_tables_last_for_their_period),
                                     cmocka_unit_test(test_long_frames_and_top_levels),
                                     cmocka_unit_test(test_tiles_equal_the_whole),
                                     cmocka_unit_test(test_nothing_covered),
                                     cmocka_unit_test(test_threshold_is_strict),
                                     cmocka_unit_test(test_sphere_after_itself),
                                     cmocka_unit_test(test_bad_arguments)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
