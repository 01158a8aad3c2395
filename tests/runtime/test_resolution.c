/* Half and double resolution: sty_expand_matches and sty_halve_picture against the formulas of runtime.h. */
#include "oracle.h"
#include "sphere.h"

/* ---- half ---- */

/* The pixels (2x, 2y) of a plane. */
static void *take_half(const StyFrame *frame, const void *plane, size_t texel) {
  if (!plane) return NULL;
  const int width = (frame->width + 1) / 2, height = (frame->height + 1) / 2;
  char *half = malloc((size_t)width * (size_t)height * texel);
  assert_non_null(half);
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++)
      memcpy(half + texel * (size_t)(y * width + x), (const char *)plane + texel * get_index(frame, 2 * x, 2 * y),
             texel);
  return half;
}

/* Anchors stay the whole frame's: destroy with free_half. */
static StyFrame make_half(const StyFrame *frame) {
  StyFrame half = *frame;
  half.width = (frame->width + 1) / 2;
  half.height = (frame->height + 1) / 2;
  half.resolution = frame->resolution - 1;
  half.guide = take_half(frame, frame->guide, 4);
  half.fine = take_half(frame, frame->fine, 2 * sizeof(float));
  half.depth = take_half(frame, frame->depth, sizeof(float));
  half.styles = take_half(frame, frame->styles, 1);
  half.objects = take_half(frame, frame->objects, sizeof(uint16_t));
  half.luma = take_half(frame, frame->luma, 1);
  half.albedo = take_half(frame, frame->albedo, 4);
  return half;
}

static void free_half(StyFrame *half) {
  half->anchors = NULL;
  destroy_frame(half);
}

static StyMatch expect_expanded(const Fixture *fixture, const StyFrame *half, const StyMatch *half_matches,
                                const StyFrame *frame, int x, int y) {
  const int style = ask_style(fixture, frame, x, y);
  const StyMatch parent = half_matches[get_index(half, x / 2, y / 2)];
  if (!style) return no_match;
  if (parent.level != STY_LEVEL_NONE && parent.style == style - 1 && parent.layer < fixture->style[style].layer_count) {
    const Pair candidate = move_on(fixture, style, frame, (Pair){parent.x, parent.y}, x % 2, y % 2);
    const uint8_t *there = ask_source(fixture, style, parent.x, parent.y);
    int tilt[3] = {0, 0, 0};
    for (int c = 0; c < 3 && there && fixture->style[style].scatter > 0; c++)
      tilt[c] = there[c] - half->guide[4 * get_index(half, x / 2, y / 2) + (size_t)c];
    if (is_accepted_tilted(fixture, style, frame, x, y, tilt, candidate, parent.layer))
      return make_match(candidate, parent.level, parent.layer, style);
  }
  return expect_fallback(fixture, frame, x, y);
}

/* How often pixels took what their half's pixel had, moved on and not, and fell back. */
typedef struct Ways {
  size_t stayed, moved, fell_back, other_style;
} Ways;

static void count_way(const StyFrame *half, const StyMatch *half_matches, StyMatch found, int x, int y, Ways *ways) {
  const StyMatch parent = half_matches[get_index(half, x / 2, y / 2)];
  if (found.level == STY_LEVEL_FALLBACK && parent.level != STY_LEVEL_NONE)
    ways->other_style += parent.style != found.style, ways->fell_back++;
  else if (found.level != STY_LEVEL_NONE)
    ways->stayed += found.x == parent.x && found.y == parent.y, ways->moved += found.x != parent.x;
}

static void expect_expansion(const Fixture *fixture, const StyFrame *frame, StyRect rect, Ways *ways) {
  StyFrame half = make_half(frame);
  StyMatch *half_matches = make_matches(&half), *matches = make_matches(frame);
  const StyRect needed = {rect.x0 / 2, rect.y0 / 2, (rect.x1 + 1) / 2, (rect.y1 + 1) / 2};
  assert_int_equal(sty_transfer_frame(&fixture->bundle, &half, needed, half_matches), STY_RUNTIME_OK);
  for (int i = 0; i < half.width * half.height; i += 20) /* noise does no harm */
    half_matches[i] = (StyMatch){(uint16_t)(i % (fixture->width + 1)),
                                 (uint16_t)(i % (fixture->height + 1)),
                                 3,
                                 (uint8_t)(i / 20 % 8),
                                 (uint8_t)(i % 3),
                                 0};
  assert_int_equal(sty_expand_matches(&fixture->bundle, &half, half_matches, frame, rect, matches), STY_RUNTIME_OK);
  for (int y = 0; y < frame->height; y++)
    for (int x = 0; x < frame->width; x++) {
      const StyMatch found = matches[y * frame->width + x];
      const bool is_ours = is_inside(rect, x, y);
      expect_same_match(frame, x, y, found,
                        is_ours ? expect_expanded(fixture, &half, half_matches, frame, x, y) : untouched);
      if (is_ours) count_way(&half, half_matches, found, x, y, ways);
    }
  free(half_matches);
  free(matches);
  free_half(&half);
}

static void test_expansion_equals_the_formula(void **state) {
  (void)state;
  uint64_t random = 1;
  Ways ways = {0, 0, 0, 0};
  for (int round = 0; round < CASES(80, 16); round++) {
    const Guides how = draw_guides(&random);
    Fixture *fixture = draw_fixture(&random, &how, 32, 1 + draw_below(&random, 3));
    for (int size = 0; size < FRAME_SIZES; size++) {
      StyFrame frame = draw_frame(&random, &how, fixture, frame_sizes[size][0], frame_sizes[size][1]);
      frame.resolution = draw_below(&random, 2);
      expect_expansion(fixture, &frame, round % 2 ? get_all(&frame) : draw_rect(&random, &frame), &ways);
      destroy_frame(&frame);
    }
    destroy_fixture(fixture);
  }
  assert_in_range(ways.stayed, 1000, SIZE_MAX);
  assert_in_range(ways.moved, 1000, SIZE_MAX);
  assert_in_range(ways.fell_back, 1000, SIZE_MAX);
  assert_in_range(ways.other_style, 1000, SIZE_MAX);
}

/* A sphere styled after itself, by way of half its pixels: nearly all come to themselves. */
static void test_sphere_by_half(void **state) {
  (void)state;
  enum { SIDE = 96 };
  uint64_t random = 2;
  Fixture *fixture = make_sphere(&random, SIDE, 1);
  const StyStyle style = {.threshold = 24, .top_level = 5, .flags = STY_FLAG_UNORM8};
  write_style(fixture, 1, &style);
  open_fixture(fixture);
  const StyFrame frame = {.width = SIDE, .height = SIDE, .guide = fixture->texels[STY_BUNDLE_GUIDES], .style = 1};
  StyFrame half = make_half(&frame);
  StyMatch *half_matches = make_matches(&half), *matches = make_matches(&frame);
  assert_int_equal(sty_transfer_frame(&fixture->bundle, &half, get_all(&half), half_matches), STY_RUNTIME_OK);
  assert_int_equal(sty_expand_matches(&fixture->bundle, &half, half_matches, &frame, get_all(&frame), matches),
                   STY_RUNTIME_OK);
  for (int i = 0; i < SIDE * SIDE; i++)
    if (frame.guide[4 * i + 3]) assert_true(matches[i].x == i % SIDE && matches[i].y == i / SIDE);
  free(half_matches);
  free(matches);
  free_half(&half);
  destroy_fixture(fixture);
}

static void test_bad_expansions(void **state) {
  (void)state;
  Fixture *fixture = make_fixture(1, 1, 1, 1, 1, 1);
  open_fixture(fixture);
  const uint8_t guide[4 * 15] = {0};
  const StyFrame frame = {.width = 5, .height = 3, .guide = guide, .style = 1};
  const StyFrame good = {.width = 3, .height = 2, .resolution = -1, .guide = guide, .style = 1};
  const StyRect all = get_all(&frame);
  StyMatch half_matches[6] = {{0}}, matches[15];
  const StyBundle *bundle = &fixture->bundle;
  StyFrame halves[5] = {good, good, good, good, good};
  halves[0].width = 2;
  halves[1].height = 1;
  halves[2].resolution = 0;
  halves[3].guide = NULL;
  halves[4].width = 5;
  for (int i = 0; i < 5; i++)
    assert_int_equal(sty_expand_matches(bundle, &halves[i], half_matches, &frame, all, matches),
                     STY_RUNTIME_BAD_ARGUMENT);
  StyFrame lowest = frame, below = good;
  lowest.resolution = -1;
  below.resolution = -2;
  assert_int_equal(sty_expand_matches(bundle, &below, half_matches, &lowest, all, matches), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_expand_matches(NULL, &good, half_matches, &frame, all, matches), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_expand_matches(bundle, NULL, half_matches, &frame, all, matches), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_expand_matches(bundle, &good, NULL, &frame, all, matches), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_expand_matches(bundle, &good, half_matches, NULL, all, matches), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_expand_matches(bundle, &good, half_matches, &frame, all, NULL), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_expand_matches(bundle, &good, half_matches, &frame, (StyRect){0, 0, 6, 3}, matches),
                   STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_expand_matches(bundle, &good, half_matches, &frame, all, matches), STY_RUNTIME_OK);
  destroy_fixture(fixture);
}

/* ---- double ---- */

static unsigned get_component(const void *picture, int bits, size_t i) {
  return bits == 8 ? ((const uint8_t *)picture)[i] : ((const uint16_t *)picture)[i];
}

static void expect_mean(const void *picture, int width, int bits, int x, int y, unsigned wanted[4]) {
  double colour[3] = {0, 0, 0}, alpha = 0;
  for (int k = 0; k < 4; k++) {
    const size_t i = 4 * (size_t)((2 * y + k / 2) * 2 * width + 2 * x + k % 2);
    const double a = get_component(picture, bits, i + 3);
    for (size_t c = 0; c < 3; c++) colour[c] += a * get_component(picture, bits, i + c);
    alpha += a;
  }
  for (int c = 0; c < 3; c++) wanted[c] = alpha > 0 ? (unsigned)floor(colour[c] / alpha + 0.5) : 0;
  wanted[3] = (unsigned)floor(alpha / 4 + 0.5);
}

static void test_halving_equals_the_formula(void **state) {
  (void)state;
  uint64_t random = 3;
  for (int round = 0; round < CASES(60, 12); round++) {
    const int bits = 8 + round % 2 * 8, width = frame_sizes[round % FRAME_SIZES][0],
              height = frame_sizes[round % FRAME_SIZES][1];
    const size_t texel = 4 * (size_t)(bits / 8), size = (size_t)width * (size_t)height * texel;
    unsigned char *picture = malloc(4 * size), *out = malloc(size);
    assert_true(picture && out);
    fill_random(&random, picture, 4 * size);
    for (size_t i = 0; i < 4 * size; i += texel) /* in half of them alpha is none, or all */
      if (draw(&random) & 1) memset(picture + i + texel / 4 * 3, draw(&random) & 1 ? 255 : 0, texel / 4);
    memset(out, 0xA5, size);
    const StyFrame frame = {.width = width, .height = height};
    const StyRect rect = draw_rect(&random, &frame);
    assert_int_equal(sty_halve_picture(width, height, bits, picture, rect, out), STY_RUNTIME_OK);
    for (int i = 0; i < width * height; i++) {
      unsigned wanted[4];
      expect_mean(picture, width, bits, i % width, i / width, wanted);
      for (int c = 0; c < 4; c++) {
        if (!is_inside(rect, i % width, i / width)) wanted[c] = bits == 8 ? 0xA5 : 0xA5A5;
        assert_int_equal(get_component(out, bits, 4 * (size_t)i + (size_t)c), wanted[c]);
      }
    }
    free(picture);
    free(out);
  }
}

/* A frame of twice the sphere's pixels, resolution 1: each pixel takes its source pixel or, where the seed's place is
 * odd, the one beside it, and the picture's size is the sphere's. */
static void test_sphere_by_double(void **state) {
  (void)state;
  enum { SIDE = 64, TWICE = 2 * SIDE };
  static uint8_t guide[4 * TWICE * TWICE], picture[4 * TWICE * TWICE], out[4 * SIDE * SIDE];
  static StyMatch matches[TWICE * TWICE];
  uint64_t random = 4;
  Fixture *fixture = make_sphere(&random, SIDE, 1);
  memset(fixture->texels[STY_BUNDLE_EXEMPLARS], 255, count_texel_bytes(fixture, STY_BUNDLE_EXEMPLARS));
  const StyStyle style = {.threshold = 40, .top_level = 5, .radius = 1, .flags = STY_FLAG_UNORM8};
  write_style(fixture, 1, &style);
  open_fixture(fixture);
  for (int i = 0; i < TWICE * TWICE; i++)
    memcpy(guide + 4 * i, fixture->texels[STY_BUNDLE_GUIDES] + 4 * (i / TWICE / 2 * SIDE + i % TWICE / 2), 4);
  const StyFrame frame = {.width = TWICE, .height = TWICE, .resolution = 1, .guide = guide, .style = 1};
  assert_int_equal(sty_transfer_frame(&fixture->bundle, &frame, get_all(&frame), matches), STY_RUNTIME_OK);
  assert_int_equal(sty_blend_frame(&fixture->bundle, &frame, get_all(&frame), matches, 8, picture), STY_RUNTIME_OK);
  assert_int_equal(sty_halve_picture(SIDE, SIDE, 8, picture, (StyRect){0, 0, SIDE, SIDE}, out), STY_RUNTIME_OK);
  for (int i = 0; i < TWICE * TWICE; i++)
    if (guide[4 * i + 3]) assert_true(abs(matches[i].x - i % TWICE / 2) <= 1 && abs(matches[i].y - i / TWICE / 2) <= 1);
  for (int i = 0; i < SIDE * SIDE; i++)
    assert_memory_equal(out + 4 * i, fixture->texels[STY_BUNDLE_GUIDES][4 * i + 3] ? "\377\377\377\377" : "\0\0\0\0",
                        4);
  destroy_fixture(fixture);
}

static void test_bad_halvings(void **state) {
  (void)state;
  uint8_t picture[4 * 24], out[4 * 6];
  memset(picture, 7, sizeof picture);
  const StyRect all = {0, 0, 3, 2};
  static const int sizes[][3] = {{0, 2, 8}, {3, 0, 8},  {-3, 2, 8},
                                 {3, 2, 0}, {3, 2, 32}, {STY_MAX_FRAME_SIDE + 1, 2, 8}};
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
    assert_int_equal(sty_halve_picture(sizes[i][0], sizes[i][1], sizes[i][2], picture, (StyRect){0, 0, 0, 0}, out),
                     STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_halve_picture(3, 2, 8, NULL, all, out), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_halve_picture(3, 2, 8, picture, all, NULL), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_halve_picture(3, 2, 8, picture, (StyRect){0, 0, 4, 2}, out), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_halve_picture(3, 2, 8, picture, (StyRect){2, 0, 1, 2}, out), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_halve_picture(3, 2, 8, picture, all, out), STY_RUNTIME_OK);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_expansion_equals_the_formula),
                                     cmocka_unit_test(test_sphere_by_half),
                                     cmocka_unit_test(test_bad_expansions),
                                     cmocka_unit_test(test_halving_equals_the_formula),
                                     cmocka_unit_test(test_sphere_by_double),
                                     cmocka_unit_test(test_bad_halvings)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
