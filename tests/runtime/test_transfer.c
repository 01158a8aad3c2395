/* sty_transfer_frame against the formula of runtime.h, written out literally. */
#include "fixture.h"

typedef struct Pair {
  int x, y;
} Pair;

/* Texel of a LUT's side that answers for `above` out of `range`, counted from the side's beginning. */
static int address(double above, double range, int side, unsigned flags) {
  const int texel =
      (int)(flags & STY_FLAG_UNORM8 ? floor(above * (side - 1) / range + 0.5) : floor(above * side / range));
  return texel < side ? texel : side - 1;
}

static double clamp_guide(float g) { return isnan(g) ? 0 : g < -1 ? -1 : g > 1 ? 1 : (double)g; }

/* LUT(guide at a frame's pixel) of a style. */
static Pair look_up(const Fixture *fixture, int style, const StyFrame *frame, int x, int y) {
  const size_t i = (size_t)y * (size_t)frame->width + (size_t)x;
  const int side = fixture->lut_side;
  const unsigned flags = fixture->style[style].flags;
  int column, row;
  if (frame->fine) {
    column = address(clamp_guide(frame->fine[2 * i]) + 1, 2, side, flags);
    row = address(1 - clamp_guide(frame->fine[2 * i + 1]), 2, side, flags);
  } else {
    column = address(frame->guide[4 * i], 255, side, flags);
    row = address(255 - frame->guide[4 * i + 1], 255, side, flags);
  }
  const uint8_t *texel = fixture->texels[STY_BUNDLE_LUTS] + 4 * (((style - 1) * side + row) * side + column);
  const double u = texel[0] + 256 * texel[1], v = texel[2] + 256 * texel[3];
  return (Pair){(int)fmin(floor(u * fixture->width / 65535), fixture->width - 1),
                (int)fmin(floor(v * fixture->height / 65535), fixture->height - 1)};
}

static Pair find_seed(const uint8_t *jitter, int x, int y, int h) {
  Pair nearest = {0, 0};
  double least = INFINITY;
  for (int dx = -1; dx <= 1; dx++)
    for (int dy = -1; dy <= 1; dy++) {
      const int bx = (int)floor((double)x / h) + dx, by = (int)floor((double)y / h) + dy;
      const uint8_t *j = jitter + 2 * ((by + 256) % 256 * 256 + (bx + 256) % 256);
      const Pair seed = {(int)floor(h * (bx + j[0] / 255.0)), (int)floor(h * (by + j[1] / 255.0))};
      const double distance = pow(seed.x - x, 2) + pow(seed.y - y, 2);
      if (distance < least) least = distance, nearest = seed;
    }
  return nearest;
}

static StyMatch expect_match(const Fixture *fixture, const StyFrame *frame, int x, int y) {
  const int style = ask_style(fixture, frame, x, y);
  if (!style) return (StyMatch){.x = STY_NO_SOURCE, .y = STY_NO_SOURCE, .level = STY_LEVEL_NONE};
  const uint8_t *jitter = fixture->texels[STY_BUNDLE_JITTER] + 2 * 256 * 256 * (frame->number % fixture->jitters);
  for (int level = fixture->style[style].top_level; level >= 0; level--) {
    const Pair seed = find_seed(jitter, x, y, 1 << level);
    if (seed.x < 0 || seed.y < 0 || seed.x >= frame->width || seed.y >= frame->height) continue;
    if (frame->guide[4 * (seed.y * frame->width + seed.x) + 3] == 0) continue;
    const Pair star = look_up(fixture, style, frame, seed.x, seed.y);
    const Pair candidate = {star.x + (x - seed.x), star.y + (y - seed.y)};
    const uint8_t *source = ask_source(fixture, style, candidate.x, candidate.y);
    if (!source) continue;
    const uint8_t *target = frame->guide + 4 * (y * frame->width + x);
    const int error = abs(source[0] - target[0]) + abs(source[1] - target[1]) + abs(source[2] - target[2]);
    if (error < fixture->style[style].threshold)
      return (StyMatch){.x = (uint16_t)candidate.x,
                        .y = (uint16_t)candidate.y,
                        .level = (uint8_t)level,
                        .style = (uint8_t)(style - 1)};
  }
  const Pair own = look_up(fixture, style, frame, x, y);
  return (StyMatch){
      .x = (uint16_t)own.x, .y = (uint16_t)own.y, .level = STY_LEVEL_FALLBACK, .style = (uint8_t)(style - 1)};
}

static bool is_same(StyMatch a, StyMatch b) { return memcmp(&a, &b, sizeof a) == 0; }

static const StyMatch untouched = {12345, 54321, 77, 78, 79, 80};

/* Matches of one rectangle on an untouched field, in a block of exactly the frame's size. */
static StyMatch *transfer_rect(const Fixture *fixture, const StyFrame *frame, StyRect rect) {
  const size_t pixels = (size_t)frame->width * (size_t)frame->height;
  StyMatch *matches = malloc(pixels * sizeof *matches);
  assert_non_null(matches);
  for (size_t i = 0; i < pixels; i++) matches[i] = untouched;
  assert_int_equal(sty_transfer_frame(&fixture->bundle, frame, rect, matches), STY_RUNTIME_OK);
  return matches;
}

static StyRect get_all(const StyFrame *frame) { return (StyRect){0, 0, frame->width, frame->height}; }

static void expect_matches(const Fixture *fixture, const StyFrame *frame, StyRect rect, const StyMatch *matches,
                           size_t levels[256]) {
  for (int y = 0; y < frame->height; y++)
    for (int x = 0; x < frame->width; x++) {
      const StyMatch found = matches[y * frame->width + x];
      const StyMatch wanted = is_inside(rect, x, y) ? expect_match(fixture, frame, x, y) : untouched;
      if (!is_same(found, wanted))
        fail_msg("(%d, %d) of %dx%d: found %u %u level %u, expected %u %u level %u", x, y, frame->width, frame->height,
                 found.x, found.y, found.level, wanted.x, wanted.y, wanted.level);
      if (levels) levels[found.level]++;
    }
}

static Guides draw_guides(uint64_t *random) {
  static const int spreads[] = {1, 4, 20, 100, 256}, holes[] = {0, 2, 10};
  const int spread = spreads[draw_below(random, 5)];
  return (Guides){draw_below(random, 257 - spread), spread, holes[draw_below(random, 3)]};
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

/* Cells beyond the table of 256 and the highest level, on long strips: the table repeats, nothing overflows. */
static void test_long_frames_and_top_levels(void **state) {
  (void)state;
  static const int sizes[][2] = {{9001, 1}, {1, 9001}, {1031, 3}};
  uint64_t random = 2;
  for (int round = 0; round < CASES(12, 3); round++) {
    const Guides how = {100, 30, 0};
    Fixture *fixture = draw_fixture(&random, &how, 64, 1);
    StyStyle style = fixture->style[1];
    style.top_level = round % 2 ? STY_MAX_LEVEL : 4;
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

static void test_nothing_covered(void **state) {
  (void)state;
  uint64_t random = 4;
  const Guides how = {0, 256, 0};
  Fixture *fixture = draw_fixture(&random, &how, 16, 1);
  const StyFrame frame = draw_frame(&random, &how, fixture, 37, 23);
  for (int i = 0; i < 37 * 23; i++) ((uint8_t *)frame.guide)[4 * i + 3] = 0;
  StyMatch *matches = transfer_rect(fixture, &frame, get_all(&frame));
  const StyMatch none = {.x = STY_NO_SOURCE, .y = STY_NO_SOURCE, .level = STY_LEVEL_NONE};
  for (int i = 0; i < 37 * 23; i++) assert_true(is_same(matches[i], none));
  free(matches);
  destroy_frame(&frame);
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

/* A LUT whose texel for bytes (i, 255-j) holds the covered pixel at the least distance, lowest first among equals. */
static void search_by_force(Fixture *fixture, int side, const uint8_t *guide) {
  static int columns[128 * 128], rows[128 * 128];
  uint32_t pixels[128 * 128], count = 0;
  for (int i = 0; i < side * side; i++) {
    if (!guide[4 * i + 3]) continue;
    columns[count] = guide[4 * i];
    rows[count] = 255 - guide[4 * i + 1];
    pixels[count++] = (uint32_t)i;
  }
  for (int j = 0; j < 256; j++)
    for (int i = 0; i < 256; i++) {
      uint32_t least = UINT32_MAX; /* distance in the high bits, number in the low 14 */
      for (uint32_t k = 0; k < count; k++) {
        const int dx = columns[k] - i, dy = rows[k] - j;
        const uint32_t key = (uint32_t)(dx * dx + dy * dy) << 14 | k;
        least = key < least ? key : least;
      }
      const uint32_t best = pixels[least & 0x3FFF];
      const double u = (best % (uint32_t)side + 0.5) / side, v = (best / (uint32_t)side + 0.5) / side;
      put32(fixture->texels[STY_BUNDLE_LUTS] + 4 * (256 * j + i),
            (uint32_t)floor(u * 65535 + 0.5) | (uint32_t)floor(v * 65535 + 0.5) << 16);
    }
}

/* A sphere styled after itself: every level offers each covered pixel itself, and so does the fallback. */
static void test_sphere_after_itself(void **state) {
  (void)state;
  const int side = CASES(128, 48);
  uint64_t random = 5;
  Fixture *fixture = make_fixture(side, side, 256, 1, 1, 2);
  uint8_t *guide = fixture->texels[STY_BUNDLE_GUIDES];
  for (int i = 0; i < side * side; i++) {
    const double x = (i % side + 0.5) / side * 2 - 1, y = 1 - (i / side + 0.5) / side * 2, square = 1 - x * x - y * y;
    if (square < 0) continue;
    const double n[3] = {x, y, sqrt(square)};
    for (int c = 0; c < 3; c++) guide[4 * i + c] = (uint8_t)floor(n[c] * 127.5 + 128);
    guide[4 * i + 3] = 255;
  }
  fill_random(&random, fixture->texels[STY_BUNDLE_JITTER], count_texel_bytes(fixture, STY_BUNDLE_JITTER));
  search_by_force(fixture, side, guide);
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

static void test_bad_arguments(void **state) {
  (void)state;
  Fixture *fixture = make_fixture(2, 2, 2, 2, 1, 1);
  open_fixture(fixture);
  const uint8_t guide[4 * 6] = {0}, styles[6] = {1, 1, 1, 1, 1, 1};
  StyMatch matches[6];
  const StyFrame good = {.width = 3, .height = 2, .guide = guide, .style = 2};
  const StyRect all = get_all(&good);
  StyFrame frames[9];
  for (int i = 0; i < 9; i++) frames[i] = good;
  frames[0].width = 0;
  frames[1].height = 0;
  frames[2].width = -3;
  frames[3].width = STY_MAX_FRAME_SIDE + 1;
  frames[4].height = STY_MAX_FRAME_SIDE + 1;
  frames[5].guide = NULL;
  frames[6].style = 0;
  frames[7].style = 3;
  frames[8].number = -1;
  for (int i = 0; i < 9; i++)
    assert_int_equal(sty_transfer_frame(&fixture->bundle, &frames[i], (StyRect){0, 0, 0, 0}, matches),
                     STY_RUNTIME_BAD_ARGUMENT);
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
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_equals_the_formula),    cmocka_unit_test(test_long_frames_and_top_levels),
      cmocka_unit_test(test_tiles_equal_the_whole), cmocka_unit_test(test_nothing_covered),
      cmocka_unit_test(test_threshold_is_strict),   cmocka_unit_test(test_sphere_after_itself),
      cmocka_unit_test(test_bad_arguments)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
