/* The shaders beside the C path, over drawn bundles and frames. */
#include "../runtime/fixture.h"
#include "drawings.h"
#include "twins.h"

/* What came of the pixels, so that a test can tell that it saw all of it. */
typedef struct Tally {
  size_t levels[256], layers[STY_MAX_LIGHTINGS], partly;
  size_t toons, lines[256]; /* frames; coverages */
} Tally;

static void count_pixels(Tally *tally, const StyMatch *matches, const uint8_t *picture, size_t pixels) {
  for (size_t i = 0; i < pixels; i++) {
    tally->levels[matches[i].level]++;
    tally->layers[matches[i].layer]++;
    tally->partly += picture[4 * i + 3] > 0 && picture[4 * i + 3] < 255;
  }
}

static void check_frame(const Gpu *gpu, const StyBundle *bundle, const StyFrame *frame, Tally *tally) {
  const size_t pixels = (size_t)frame->width * (size_t)frame->height;
  StyMatch *matches = allocate(pixels, sizeof *matches);
  uint8_t *picture = allocate(pixels, 4);
  check_passes(gpu, bundle, frame, matches, picture);
  count_pixels(tally, matches, picture, pixels);
  free(matches);
  free(picture);
}

/* ---- toon and outlines ---- */

/* Slants, steps and what isn't a number, so that slopes and gaps are of every kind. */
static void draw_depth(uint64_t *random, StyFrame *frame) {
  float *depth = (float *)(uintptr_t)frame->depth;
  const float slope_x = (float)draw_below(random, 100) / 37, slope_y = (float)draw_below(random, 100) / 41;
  for (int i = 0; depth && i < frame->width * frame->height; i++) {
    const int x = i % frame->width, y = i / frame->width, step = (x / 9 * 7 + y / 11 * 5) % 4;
    if (draw_below(random, 30)) depth[i] = (float)x * slope_x + (float)y * slope_y + (float)(step * step) * 1.7f;
  }
}

/* Normals that bend by steps, so that cells turn. */
static void bend_guide(uint64_t *random, StyFrame *frame) {
  static const int steps[] = {0, 1, 3};
  const int across = steps[draw_below(random, 3)], down = steps[draw_below(random, 3)];
  uint8_t *guide = (uint8_t *)(uintptr_t)frame->guide;
  const int moving = 1 + draw_below(random, 3);
  for (int i = 0; i < frame->width * frame->height; i++)
    for (int c = 0; c < moving; c++)
      guide[4 * i + c] = (uint8_t)(i % frame->width * across + i / frame->width * down + 80 * c);
}

static StyPattern draw_pattern(uint64_t *random, size_t texel, uint8_t *texels) {
  const StyPattern pattern = {texels, 1 + draw_below(random, 40), 1 + draw_below(random, 40)};
  fill_random(random, texels, texel * 1600);
  return draw_below(random, 4) ? pattern : (StyPattern){NULL, 0, 0};
}

static StyToon draw_toon(uint64_t *random, const Fixture *fixture, uint8_t *pattern) {
  const int table = draw_below(random, fixture->jitters), table_size = 2 * STY_JITTER_SIZE * STY_JITTER_SIZE;
  StyToon toon = {.band_count = 1 + draw_below(random, STY_MAX_BANDS),
                  .colour_weight = draw_below(random, 257),
                  .style = draw_below(random, 2),
                  .pattern = draw_pattern(random, 1, pattern),
                  .pattern_weight = draw_below(random, STY_MAX_PATTERN_WEIGHT + 1),
                  .jitter = fixture->bundle.textures[STY_BUNDLE_JITTER].texels + table * table_size,
                  .jitter_amount = draw_below(random, 256)};
  if (draw_below(random, 4))
    toon.cell_level = STY_MIN_CELL_LEVEL + draw_below(random, STY_MAX_CELL_LEVEL - STY_MIN_CELL_LEVEL + 1);
  fill_random(random, toon.thresholds, sizeof toon.thresholds);
  fill_random(random, toon.colours[0], sizeof toon.colours);
  return toon;
}

/* Small and large weights. */
static int draw_weight(uint64_t *random) {
  return (int)DRAW_OF(random, 0, draw_below(random, 300), draw_below(random, STY_MAX_OUTLINE_WEIGHT + 1),
                      STY_MAX_OUTLINE_WEIGHT);
}

static StyOutline draw_outline(uint64_t *random, uint8_t *noise) {
  static const float tolerances[] = {0.1f, 0.75f, 2, 1e30f};
  return (StyOutline){.silhouette_weight = draw_weight(random),
                      .object_weight = draw_weight(random),
                      .normal_weight = draw_weight(random),
                      .depth_weight = draw_weight(random),
                      .normal_tolerance = draw_below(random, 300),
                      .depth_tolerance = tolerances[draw_below(random, 4)],
                      .noise = draw_pattern(random, 1, noise),
                      .noise_weight = draw_weight(random),
                      .threshold = draw_weight(random)};
}

static StyLine draw_line(uint64_t *random, uint8_t *wobble) {
  return (StyLine){
      .width = (int)DRAW_OF(random, STY_MIN_LINE_WIDTH, 256 + draw_below(random, 1024),
                            STY_MIN_LINE_WIDTH + draw_below(random, STY_MAX_LINE_WIDTH - STY_MIN_LINE_WIDTH),
                            STY_MAX_LINE_WIDTH),
      .wobble = draw_pattern(random, 2, wobble),
      .wobble_amount = (int)DRAW_OF(random, 0, draw_below(random, 700), STY_MAX_WOBBLE)};
}

/* Of the twins' frame, or of what it is with a stride. */
static void draw_all(const Twins *twins, uint64_t *random, const Fixture *fixture, const StyFrame *frame, int stride,
                     Tally *tally) {
  static uint8_t pattern[1600], noise[1600], wobble[3200];
  const size_t pixels = (size_t)frame->width * (size_t)frame->height;
  uint8_t *picture = allocate(pixels, 4), *lines = allocate(pixels, 1), colour[4];
  fill_random(random, picture, 4 * pixels);
  const StyToon toon = draw_toon(random, fixture, pattern);
  if (frame->luma) check_toon(twins, frame, stride, &toon, picture), tally->toons++;
  for (int i = 0; i < 3; i++) {
    const StyOutline outline = draw_outline(random, noise);
    const StyLine line = draw_line(random, wobble);
    fill_random(random, colour, sizeof colour);
    check_outline(twins, frame, stride, &outline, &line, colour, draw_below(random, 2), picture, lines);
    for (size_t k = 0; k < pixels; k++) tally->lines[lines[k]]++;
  }
  free(picture), free(lines);
}

static void check_drawings(const Gpu *gpu, uint64_t *random, const Fixture *fixture, StyFrame *frame, Tally *tally) {
  if (draw_below(random, 3)) bend_guide(random, frame);
  draw_depth(random, frame);
  const StyFrame half = take_half_frame(frame);
  Twins twins = open_twins(gpu, &fixture->bundle, frame);
  draw_all(&twins, random, fixture, frame, 1, tally);
  draw_all(&twins, random, fixture, &half, 2, tally);
  close_twins(&twins);
  destroy_half_frame(&half);
}

/* Rows of four pixels: a slope, then a gap of it and the tolerance times a power of two, or the tolerance alone, and a
 * float more or less, so that every rounding decides. */
static void draw_edges(uint64_t *random, float tolerance, int pixels, float *depth) {
  for (int i = 0; i + 4 <= pixels; i += 4) {
    const float slope = draw_signed(random), thrice = draw_below(random, 4) ? 3 * fabsf(slope) : 0;
    const float gap = thrice > 0 ? thrice + ldexpf(tolerance, draw_below(random, STY_MAX_GAP_GRADE)) : tolerance;
    const float specials[] = {NAN, INFINITY, -2e30f, 1000 * draw_signed(random), 1e30f};
    depth[i + 1] = 10 * draw_signed(random);
    depth[i] = depth[i + 1] - slope;
    const float next = depth[i + 1] + (thrice > 0 || draw_below(random, 2) ? gap : -gap);
    depth[i + 2] = nextafterf(next, next + (float)(draw_below(random, 3) - 1));
    depth[i + 3] = specials[draw_below(random, 5)];
  }
}

/* Depths at the very edge of what makes a contour, and which side it is on. */
static void check_edges(const Gpu *gpu, uint64_t *random) {
  enum { WIDTH = 128, HEIGHT = 64, PIXELS = WIDTH * HEIGHT };
  static const float tolerances[] = {0.1f, 0.75f, 1.0f / 3};
  static uint8_t guide[4 * PIXELS], noise[PIXELS], contours[PIXELS];
  static float depth[PIXELS];
  Fixture *fixture = draw_fixture(random, &(Guides){0, 256, 0}, 2, 1);
  const StyFrame frame = {.width = WIDTH, .height = HEIGHT, .guide = guide, .depth = depth};
  fill_random(random, guide, sizeof guide);
  fill_random(random, noise, sizeof noise);
  for (int i = 0; i < PIXELS; i++) guide[4 * i + 3] = 255;
  for (int t = 0; t < 3; t++) {
    draw_edges(random, tolerances[t], PIXELS, depth);
    Twins twins = open_twins(gpu, &fixture->bundle, &frame);
    StyOutline outline = {.depth_weight = 1, .depth_tolerance = tolerances[t]};
    for (; outline.threshold < STY_MAX_GAP_GRADE; outline.threshold++)
      check_contours(&twins, &frame, 1, &outline, contours);
    outline.noise = (StyPattern){noise, WIDTH, HEIGHT}, outline.noise_weight = 6, outline.threshold = 1;
    check_contours(&twins, &frame, 1, &outline, contours);
    outline = (StyOutline){.normal_weight = 1, .depth_tolerance = tolerances[t]};
    check_contours(&twins, &frame, 1, &outline, contours);
    close_twins(&twins);
  }
  destroy_fixture(fixture);
}

/* Normals at the very edge of what turns a cell: half a byte from sample to sample, on the mean. */
static void check_slants(const Gpu *gpu, uint64_t *random) {
  enum { SIDE = 64, PIXELS = SIDE * SIDE };
  static uint8_t guide[4 * PIXELS], luma[PIXELS], pattern[1600], picture[4 * PIXELS];
  Fixture *fixture = draw_fixture(random, &(Guides){0, 256, 0}, 2, 1);
  const StyFrame frame = {.width = SIDE, .height = SIDE, .guide = guide, .luma = luma};
  for (int i = 0; i < PIXELS; i++) {
    const uint8_t texel[4] = {(uint8_t)draw_below(random, 2), draw_below(random, 12) == 0, 0, 255};
    memcpy(guide + 4 * i, texel, sizeof texel);
  }
  fill_random(random, luma, sizeof luma);
  Twins twins = open_twins(gpu, &fixture->bundle, &frame);
  for (int level = STY_MIN_CELL_LEVEL; level <= STY_MAX_CELL_LEVEL; level++) {
    StyToon toon = draw_toon(random, fixture, pattern);
    toon.band_count = STY_MAX_BANDS, toon.style = 0, toon.cell_level = level;
    toon.pattern = (StyPattern){pattern, 40, 40}, toon.pattern_weight = 256;
    check_toon(&twins, &frame, 1, &toon, picture);
  }
  close_twins(&twins);
  destroy_fixture(fixture);
}

/* Few contours, so that lines end where they should: widths on both sides of where they reach a pixel farther. */
static void check_widths(const Gpu *gpu, uint64_t *random) {
  enum { WIDTH = 60, HEIGHT = 75, PIXELS = WIDTH * HEIGHT };
  static uint8_t contours[PIXELS], lines[PIXELS], wobble[3200];
  const Twins twins = {.gpu = gpu};
  for (int width = 256; width <= STY_MAX_LINE_WIDTH; width += width % 2 ? 511 : 1) {
    memset(contours, 0, sizeof contours);
    for (int i = 0; i < 3; i++) contours[draw_below(random, PIXELS)] = 255;
    const StyLine line = {width, draw_pattern(random, 2, wobble), draw_below(random, STY_MAX_WOBBLE + 1)};
    const GLuint texture = check_lines(&twins, WIDTH, HEIGHT, contours, &line, lines);
    glDeleteTextures(1, &texture);
  }
}

/* All of one guide, so that pieces scatter wherever their object's surroundings let them; they come from a source that
 * spreads so far. */
static void check_flat_frame(const Gpu *gpu, uint64_t *random, int spread, int threshold, int top_level, Tally *tally) {
  const Guides how = {100, 1, 0};
  Fixture *fixture = draw_fixture(random, &(Guides){100 - spread / 2, spread, 0}, 64, 1);
  StyStyle style = fixture->style[1];
  style.threshold = threshold, style.top_level = top_level, style.scatter = 12, style.luma_weight = 0;
  write_style(fixture, 1, &style);
  StyFrame frame = draw_frame(random, &how, fixture, 130, 70);
  while (!frame.objects || !frame.anchors) {
    destroy_frame(&frame);
    frame = draw_frame(random, &how, fixture, 130, 70);
  }
  check_frame(gpu, &fixture->bundle, &frame, tally);
  destroy_frame(&frame);
  destroy_fixture(fixture);
}

/* Distances whose squares are 1 less than another's: floats round their roots up. The line's end tells them apart. */
static void check_roots(const Gpu *gpu) {
  enum { SIDE = 40 };
  static const int ways[][2] = {{5868, 5556}, {6354, 5022}, {6918, 4482}, {7212, 3768}, {7452, 3648}, {8052, 684}};
  static uint8_t contours[SIDE * SIDE], lines[SIDE * SIDE];
  const Twins twins = {.gpu = gpu};
  for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
    const int x = (ways[i][0] + 128) / 256, y = (ways[i][1] + 128) / 256;
    const uint8_t rest[2] = {(uint8_t)(128 + 256 * x - ways[i][0]), (uint8_t)(128 + 256 * y - ways[i][1])};
    memset(contours, 0, sizeof contours);
    contours[SIDE * y + x] = 255;
    const StyLine line = {.width = STY_MAX_LINE_WIDTH, .wobble = {rest, 1, 1}, .wobble_amount = 128};
    const GLuint texture = check_lines(&twins, SIDE, SIDE, contours, &line, lines);
    assert_in_range(lines[0], 1, 254);
    glDeleteTextures(1, &texture);
  }
}

static void check_drawn_frames(const char *dialect, uint64_t random) {
  static const int sides[] = {1, 2, 7, 64, 255, 256}, spreads[] = {1, 1, 2, 4, 20, 256}, holes[] = {0, 2, 10};
  Tally tally = {{0}, {0}, 0, 0, {0}};
  Gpu gpu = open_gpu(dialect);
  /* Few frames of each bundle: the renderer compiles a pass anew for other sizes of textures. */
  for (int round = 0; round < 20; round++) {
    const int spread = spreads[draw_below(&random, 6)], *size = frame_sizes[round % FRAME_SIZES];
    const Guides how = {draw_below(&random, 257 - spread), spread, holes[round % 3]};
    Fixture *fixture = draw_fixture(&random, &how, sides[round % 6], 1 + draw_below(&random, 4));
    StyFrame frame = draw_frame(&random, &how, fixture, size[0], size[1]);
    check_frame(&gpu, &fixture->bundle, &frame, &tally);
    uint64_t apart = random; /* so that what is drawn here changes nothing for the frames to come */
    check_drawings(&gpu, &apart, fixture, &frame, &tally);
    destroy_frame(&frame);
    destroy_fixture(fixture);
  }
  check_flat_frame(&gpu, &random, 1, STY_MAX_THRESHOLD, 6, &tally);
  check_flat_frame(&gpu, &random, 20, 24, 5, &tally);
  check_slants(&gpu, &random);
  check_edges(&gpu, &random);
  check_widths(&gpu, &random);
  check_roots(&gpu);
  close_gpu(&gpu);
  for (int level = 0; level <= 6; level++) assert_in_range(tally.levels[level], 1, SIZE_MAX);
  for (int layer = 0; layer < STY_MAX_LIGHTINGS; layer++) assert_in_range(tally.layers[layer], 1, SIZE_MAX);
  assert_in_range(tally.levels[STY_LEVEL_FALLBACK], 1, SIZE_MAX);
  assert_in_range(tally.levels[STY_LEVEL_NONE], 1, SIZE_MAX);
  assert_in_range(tally.partly, 1, SIZE_MAX);
  assert_in_range(tally.toons, 10, SIZE_MAX);
  for (int coverage = 0; coverage < 256; coverage += 255) assert_in_range(tally.lines[coverage], 100, SIZE_MAX);
}

static void test_glsl_330(void **state) {
  (void)state;
  check_drawn_frames("330", 1);
}

static void test_glsl_es_300(void **state) {
  (void)state;
  check_drawn_frames("es300", 2);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_glsl_330), cmocka_unit_test(test_glsl_es_300)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
