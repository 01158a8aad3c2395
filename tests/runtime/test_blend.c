/* sty_blend_frame against the formula of runtime.h, written out literally. */
#include "fixture.h"

static const uint8_t *get_exemplar(const Fixture *fixture, int style, int x, int y) {
  const int layer = fixture->style[style].layer;
  return fixture->texels[STY_BUNDLE_EXEMPLARS] + 4 * ((layer * fixture->height + y) * fixture->width + x);
}

static bool do_depths_agree(const StyFrame *frame, float tolerance, int p, int q) {
  if (!frame->depth || tolerance == 0 || p == q) return true;
  const double a = frame->depth[p], b = frame->depth[q];
  if (isnan(a) || isnan(b)) return false;
  if (isinf(a) || isinf(b)) return a == b;
  return fabs(a - b) <= tolerance;
}

static void expect_pixel(const Fixture *fixture, const StyFrame *frame, const StyMatch *matches, int x, int y, int bits,
                         unsigned wanted[4]) {
  const int style = ask_style(fixture, frame, x, y), p = y * frame->width + x;
  for (int c = 0; c < 4; c++) wanted[c] = 0;
  if (!style) return;
  const int radius = fixture->style[style].radius, highest = bits == 8 ? 255 : 65535;
  double colour[3] = {0, 0, 0}, alpha = 0;
  int votes = 0;
  for (int oy = -radius; oy <= radius; oy++)
    for (int ox = -radius; ox <= radius; ox++) {
      const int nx = x + ox, ny = y + oy, q = ny * frame->width + nx;
      if (nx < 0 || ny < 0 || nx >= frame->width || ny >= frame->height) continue;
      if (ask_style(fixture, frame, nx, ny) != style) continue;
      if (!do_depths_agree(frame, fixture->style[style].depth_tolerance, p, q)) continue;
      if (!ask_source(fixture, style, matches[q].x - ox, matches[q].y - oy)) continue;
      const uint8_t *texel = get_exemplar(fixture, style, matches[q].x - ox, matches[q].y - oy);
      for (int c = 0; c < 3; c++) colour[c] += texel[c] * texel[3];
      alpha += texel[3];
      votes++;
    }
  if (votes == 0) {
    const uint8_t *texel = get_exemplar(fixture, style, matches[p].x, matches[p].y);
    for (int c = 0; c < 3; c++) colour[c] = texel[c] * texel[3];
    alpha = texel[3];
    votes = 1;
  }
  for (int c = 0; c < 3 && alpha > 0; c++) wanted[c] = (unsigned)floor(colour[c] * (highest / 255) / alpha + 0.5);
  wanted[3] = (unsigned)floor(alpha * frame->guide[4 * p + 3] * (highest / 255) / (votes * 255.0) + 0.5);
}

/* One rectangle blended onto bytes of 0xA5, in a block of exactly the frame's size. */
static void *blend_rect(const Fixture *fixture, const StyFrame *frame, StyRect rect, const StyMatch *matches,
                        int bits) {
  const size_t size = (size_t)frame->width * (size_t)frame->height * 4 * (size_t)(bits / 8);
  void *out = malloc(size);
  assert_non_null(out);
  memset(out, 0xA5, size);
  assert_int_equal(sty_blend_frame(&fixture->bundle, frame, rect, matches, bits, out), STY_RUNTIME_OK);
  return out;
}

static unsigned get_component(const void *picture, int bits, int i) {
  return bits == 8 ? ((const uint8_t *)picture)[i] : ((const uint16_t *)picture)[i];
}

static void expect_picture(const Fixture *fixture, const StyFrame *frame, StyRect rect, const StyMatch *matches,
                           int bits, const void *picture) {
  for (int y = 0; y < frame->height; y++)
    for (int x = 0; x < frame->width; x++) {
      unsigned wanted[4];
      expect_pixel(fixture, frame, matches, x, y, bits, wanted);
      for (int c = 0; c < 4; c++) {
        if (!is_inside(rect, x, y)) wanted[c] = bits == 8 ? 0xA5 : 0xA5A5;
        const unsigned found = get_component(picture, bits, 4 * (y * frame->width + x) + c);
        if (found != wanted[c])
          fail_msg("(%d, %d) of %dx%d, component %d at %d bits: found %u, expected %u", x, y, frame->width,
                   frame->height, c, bits, found, wanted[c]);
      }
    }
}

/* Any source pixel where something is stylized: in patches that agree, and alone. */
static StyMatch *draw_matches(uint64_t *random, const Fixture *fixture, const StyFrame *frame) {
  StyMatch *matches = malloc((size_t)frame->width * (size_t)frame->height * sizeof *matches);
  assert_non_null(matches);
  for (int y = 0; y < frame->height; y++)
    for (int x = 0; x < frame->width; x++) {
      StyMatch *match = &matches[y * frame->width + x];
      *match = (StyMatch){.x = STY_NO_SOURCE, .y = STY_NO_SOURCE, .level = STY_LEVEL_NONE};
      if (!ask_style(fixture, frame, x, y)) continue;
      const bool alone = draw_below(random, 4) == 0;
      *match = (StyMatch){.x = (uint16_t)((alone ? draw_below(random, 1 << 15) : x) % fixture->width),
                          .y = (uint16_t)((alone ? draw_below(random, 1 << 15) : y) % fixture->height),
                          .level = STY_LEVEL_FALLBACK};
    }
  return matches;
}

static void test_equals_the_formula(void **state) {
  (void)state;
  uint64_t random = 1;
  for (int round = 0; round < CASES(45, 9); round++) {
    const Guides how = {0, 4, round % 3 * 3};
    Fixture *fixture = draw_fixture(&random, &how, 16, 1 + draw_below(&random, 3));
    StyStyle style = fixture->style[1];
    style.radius = round % (STY_MAX_RADIUS + 1);
    write_style(fixture, 1, &style);
    for (int size = 0; size < FRAME_SIZES; size++) {
      const StyFrame frame = draw_frame(&random, &how, fixture, frame_sizes[size][0], frame_sizes[size][1]);
      StyMatch *matches = draw_matches(&random, fixture, &frame);
      if (draw(&random) & 1)
        assert_int_equal(sty_transfer_frame(&fixture->bundle, &frame, get_all(&frame), matches), STY_RUNTIME_OK);
      for (int bits = 8; bits <= 16; bits += 8) {
        void *picture = blend_rect(fixture, &frame, get_all(&frame), matches, bits);
        expect_picture(fixture, &frame, get_all(&frame), matches, bits, picture);
        free(picture);
      }
      free(matches);
      destroy_frame(&frame);
    }
    destroy_fixture(fixture);
  }
}

/* Tiles give the whole; a rectangle leaves the rest alone and needs no matches beyond the largest radius. */
static void test_tiles_and_rectangles(void **state) {
  (void)state;
  uint64_t random = 2;
  for (int round = 0; round < CASES(30, 6); round++) {
    const int bits = 8 + round % 2 * 8, *size = frame_sizes[round % FRAME_SIZES];
    const Guides how = {0, 4, 8};
    Fixture *fixture = draw_fixture(&random, &how, 16, 3);
    const StyFrame frame = draw_frame(&random, &how, fixture, size[0], size[1]);
    StyMatch *matches = draw_matches(&random, fixture, &frame);
    void *whole = blend_rect(fixture, &frame, get_all(&frame), matches, bits);
    void *tiled = blend_rect(fixture, &frame, (StyRect){0, 0, 0, 0}, matches, bits);
    const int step_x = 1 + draw_below(&random, 40), step_y = 1 + draw_below(&random, 40);
    for (int y = (size[1] - 1) / step_y * step_y; y >= 0; y -= step_y)
      for (int x = 0; x < size[0]; x += step_x) {
        const StyRect tile = {x, y, x + step_x < size[0] ? x + step_x : size[0],
                              y + step_y < size[1] ? y + step_y : size[1]};
        assert_int_equal(sty_blend_frame(&fixture->bundle, &frame, tile, matches, bits, tiled), STY_RUNTIME_OK);
      }
    assert_memory_equal(whole, tiled, (size_t)size[0] * (size_t)size[1] * 4 * (size_t)(bits / 8));

    const StyRect rect = draw_rect(&random, &frame);
    const StyRect grown = {rect.x0 - STY_MAX_RADIUS, rect.y0 - STY_MAX_RADIUS, rect.x1 + STY_MAX_RADIUS,
                           rect.y1 + STY_MAX_RADIUS};
    StyMatch *known = draw_matches(&random, fixture, &frame);
    for (int i = 0; i < size[0] * size[1]; i++)
      if (is_inside(grown, i % size[0], i / size[0])) known[i] = matches[i];
    void *part = blend_rect(fixture, &frame, rect, known, bits);
    expect_picture(fixture, &frame, rect, matches, bits, part);
    free(known);
    free(part);
    free(whole);
    free(tiled);
    free(matches);
    destroy_frame(&frame);
    destroy_fixture(fixture);
  }
}

/* A row of `count` pixels after a source of 3x1: exemplar texels, all in the mask, everything covered fully. */
typedef struct Row {
  Fixture *fixture;
  uint8_t guide[4 * 3];
  float depth[3];
  StyMatch matches[3];
  StyFrame frame;
} Row;

static Row *make_row(int count, int radius, float tolerance, const uint8_t exemplar[12]) {
  Row *row = calloc(1, sizeof *row);
  assert_non_null(row);
  row->fixture = make_fixture(3, 1, 1, 1, 1, 1);
  memcpy(row->fixture->texels[STY_BUNDLE_EXEMPLARS], exemplar, 12);
  const StyStyle style = {.threshold = 24, .radius = radius, .depth_tolerance = tolerance};
  write_style(row->fixture, 1, &style);
  memset(row->fixture->texels[STY_BUNDLE_GUIDES], 255, 12);
  open_fixture(row->fixture);
  memset(row->guide, 255, sizeof row->guide);
  for (int i = 0; i < 3; i++) row->matches[i] = (StyMatch){.x = (uint16_t)i};
  row->frame = (StyFrame){
      .width = count, .height = 1, .guide = row->guide, .depth = tolerance > 0 ? row->depth : NULL, .style = 1};
  return row;
}

static void expect_colour(const Row *row, int x, int bits, unsigned r, unsigned g, unsigned b, unsigned a) {
  void *picture = blend_rect(row->fixture, &row->frame, get_all(&row->frame), row->matches, bits);
  const unsigned wanted[4] = {r, g, b, a};
  for (int c = 0; c < 4; c++) assert_int_equal(get_component(picture, bits, 4 * x + c), wanted[c]);
  free(picture);
}

static void destroy_row(Row *row) {
  destroy_fixture(row->fixture);
  free(row);
}

static void test_radius_0_is_the_exemplar(void **state) {
  (void)state;
  Row *row = make_row(3, 0, 0, (const uint8_t[12]){1, 2, 3, 255, 40, 50, 60, 128, 7, 8, 9, 0});
  expect_colour(row, 0, 8, 1, 2, 3, 255);
  expect_colour(row, 1, 8, 40, 50, 60, 128);
  expect_colour(row, 2, 8, 0, 0, 0, 0);
  expect_colour(row, 1, 16, 40 * 257, 50 * 257, 60 * 257, 128 * 257);
  row->fixture->texels[STY_BUNDLE_GUIDES][4 + 3] = 0; /* a fallback on a masked pixel still has its colour */
  expect_colour(row, 1, 8, 40, 50, 60, 128);
  destroy_row(row);
}

static void test_colours_weigh_by_alpha(void **state) {
  (void)state;
  Row *row = make_row(2, 1, 0, (const uint8_t[12]){200, 10, 0, 255, 100, 255, 7, 0, 0, 0, 0, 0});
  row->matches[1] = (StyMatch){.x = 2};      /* votes texel 1 for pixel 0 */
  expect_colour(row, 0, 8, 200, 10, 0, 128); /* 127.5 up */
  expect_colour(row, 0, 16, 200 * 257, 10 * 257, 0, 32768);
  row->guide[3] = 100; /* 127.5 * 100/255 = 50 */
  expect_colour(row, 0, 8, 200, 10, 0, 50);
  expect_colour(row, 0, 16, 200 * 257, 10 * 257, 0, 50 * 257);
  row->fixture->texels[STY_BUNDLE_EXEMPLARS][7] = 85; /* (200*255 + 100*85)/340 = 175 */
  expect_colour(row, 0, 8, 175, 71, 2, 67);
  row->guide[3] = 0;
  expect_colour(row, 0, 8, 0, 0, 0, 0);
  destroy_row(row);
}

static void test_votes_outside_are_dropped(void **state) {
  (void)state;
  Row *row = make_row(2, 1, 0, (const uint8_t[12]){10, 0, 0, 255, 20, 0, 0, 255, 50, 0, 0, 255});
  row->matches[1].x = 0; /* its vote for pixel 0 would be texel -1 */
  expect_colour(row, 0, 8, 10, 0, 0, 255);
  expect_colour(row, 1, 8, 15, 0, 0, 255); /* pixel 0 votes texel 1 */
  row->matches[0].x = 2;                   /* and now texel 3 */
  expect_colour(row, 1, 8, 10, 0, 0, 255);
  row->matches[1].x = 2; /* votes texel 1 */
  expect_colour(row, 0, 8, 35, 0, 0, 255);
  row->fixture->texels[STY_BUNDLE_GUIDES][4 + 3] = 0;
  expect_colour(row, 0, 8, 50, 0, 0, 255);
  destroy_row(row);
}

static void test_depths_drop_votes(void **state) {
  (void)state;
  const struct {
    float near, other, tolerance;
    bool agree;
  } cases[] = {{1, 1.5f, 0.5f, true},           {1, 1.5f, 0.49f, false},     {1.5f, 1, 0.5f, true},
               {1.5f, 1, 0.49f, false},         {1, 100, 0, true},           {INFINITY, INFINITY, 1, true},
               {-INFINITY, INFINITY, 1, false}, {1, INFINITY, 1e30f, false}, {INFINITY, 1, 1e30f, false},
               {NAN, NAN, 1e30f, false},        {1, NAN, 1e30f, false},      {NAN, 1, 1e30f, false}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    Row *row = make_row(2, 1, cases[i].tolerance, (const uint8_t[12]){10, 0, 0, 255, 30, 0, 0, 255, 0, 0, 0, 0});
    row->matches[1].x = 2;
    row->depth[0] = cases[i].near;
    row->depth[1] = cases[i].other;
    expect_colour(row, 0, 8, cases[i].agree ? 20 : 10, 0, 0, 255);
    destroy_row(row);
  }
}

static void test_bad_arguments(void **state) {
  (void)state;
  Row *row = make_row(3, 1, 0, (const uint8_t[12]){0});
  const StyBundle *bundle = &row->fixture->bundle;
  const StyFrame *frame = &row->frame;
  const StyRect all = get_all(frame);
  uint8_t out[4 * 3];
  static const int depths[] = {0, 1, -8, 15, 32};
  for (int i = 0; i < 5; i++)
    assert_int_equal(sty_blend_frame(bundle, frame, all, row->matches, depths[i], out), STY_RUNTIME_BAD_ARGUMENT);
  static const StyRect rects[] = {{-1, 0, 1, 1}, {0, -1, 1, 1}, {0, 0, 4, 1}, {0, 0, 1, 2}, {2, 0, 1, 1}, {0, 1, 1, 0}};
  for (size_t i = 0; i < sizeof rects / sizeof *rects; i++)
    assert_int_equal(sty_blend_frame(bundle, frame, rects[i], row->matches, 8, out), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_blend_frame(NULL, frame, all, row->matches, 8, out), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_blend_frame(bundle, NULL, all, row->matches, 8, out), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_blend_frame(bundle, frame, all, NULL, 8, out), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_blend_frame(bundle, frame, all, row->matches, 8, NULL), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_blend_frame(bundle, frame, (StyRect){3, 1, 3, 1}, row->matches, 8, out), STY_RUNTIME_OK);
  row->frame.style = 2;
  assert_int_equal(sty_blend_frame(bundle, frame, all, row->matches, 8, out), STY_RUNTIME_BAD_ARGUMENT);
  destroy_row(row);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_equals_the_formula),
                                     cmocka_unit_test(test_tiles_and_rectangles),
                                     cmocka_unit_test(test_radius_0_is_the_exemplar),
                                     cmocka_unit_test(test_colours_weigh_by_alpha),
                                     cmocka_unit_test(test_votes_outside_are_dropped),
                                     cmocka_unit_test(test_depths_drop_votes),
                                     cmocka_unit_test(test_bad_arguments)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
