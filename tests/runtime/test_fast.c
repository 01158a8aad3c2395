/* Every fast form against the reference: the same bytes on random bundles and frames, in whole and in parts, and on
 * what hurts: chunks of a pixel, rows longer than a run, thresholds that nothing passes, guides that are all alike. */
#include "fixture.h"

static const StyRuntimePath paths[] = {STY_PATH_PORTABLE, STY_PATH_AVX2, STY_PATH_AVX512, STY_PATH_BEST};
enum { PATHS = 4 };

/* How often something was seen that a fast form treats apart, by name; each must have been. */
enum {
  SEEN_SCATTER,
  SEEN_ANCHOR,
  SEEN_SPREAD,
  SEEN_LIGHTING,
  SEEN_BASE,
  SEEN_ALBEDO,
  SEEN_DEPTH,
  SEEN_KEPT,
  SEEN_FINE,
  KINDS
};
static size_t seen[KINDS];

static int draw_from(uint64_t *random, const int *values, int count) { return values[draw_below(random, count)]; }

static StyStyle draw_wild_style(uint64_t *random, const Fixture *fixture, int spread) {
  static const int tops[] = {0, 2, 4, 6, 6, 6, 7, STY_MAX_LEVEL}, radii[] = {0, 1, 1, 1, 2, 4, STY_MAX_RADIUS};
  static const float amounts[] = {1, 1, 0.5f, 0, 0.3f}, scales[] = {1, 1, 1, 0.5f, 2};
  const int thresholds[] = {0, 1, 24, spread, 2 * spread, STY_MAX_THRESHOLD};
  StyStyle style = {.threshold = draw_from(random, thresholds, 6),
                    .top_level = draw_from(random, tops, 8),
                    .radius = draw_from(random, radii, 7),
                    .depth_tolerance = (float)draw_below(random, 3) / 4,
                    .luma_weight = (float)draw_below(random, 5) / 8,
                    .colour_weight = (float)draw_below(random, 3) / 2,
                    .layer_count = 1 + draw_below(random, STY_MAX_LIGHTINGS),
                    .jitter_amount = amounts[draw_below(random, 5)],
                    .jitter_period = draw_below(random, 3),
                    .scale = scales[draw_below(random, 5)],
                    .flags = (unsigned)draw_below(random, 1 + (int)STY_KNOWN_FLAGS),
                    .scatter = draw_below(random, 4) ? 0 : draw_below(random, 9)};
  for (int i = 0; i < STY_MAX_LIGHTINGS; i++) style.luma[i] = (float)draw_below(random, 256) / 255;
  const int layers = style.flags & STY_FLAG_BASE ? 2 * style.layer_count : style.layer_count;
  style.layer = draw_below(random, fixture->exemplars - layers + 1);
  return style;
}

/* A bundle whose sources are smooth where `is_smooth`, so that chunks grow. */
static Fixture *draw_bundle(uint64_t *random, const Guides *how, bool is_smooth) {
  static const int sides[] = {1, 2, 17, 64, 256};
  Fixture *fixture = make_fixture(1 + draw_below(random, 90), 1 + draw_below(random, 90), draw_from(random, sides, 5),
                                  1 + draw_below(random, 6), 8 + draw_below(random, 3), 1 + draw_below(random, 3));
  for (int file = 0; file < STY_BUNDLE_FILES; file++)
    if (file != STY_BUNDLE_PARAMS && file != STY_BUNDLE_GUIDES)
      fill_random(random, fixture->texels[file], count_texel_bytes(fixture, file));
  for (size_t i = 0; i < count_texel_bytes(fixture, STY_BUNDLE_JITTER); i += 16)
    fixture->texels[STY_BUNDLE_JITTER][i + (size_t)draw_below(random, 16)] = 255;
  uint8_t *guide = fixture->texels[STY_BUNDLE_GUIDES];
  const size_t pixels = count_texel_bytes(fixture, STY_BUNDLE_GUIDES) / 4;
  draw_guide(random, how, guide, pixels);
  for (size_t i = 0; is_smooth && i < pixels; i++) {
    guide[4 * i] = (uint8_t)(how->base + (int)(i % (size_t)fixture->width) * how->spread / (2 * fixture->width));
    guide[4 * i + 1] = (uint8_t)(how->base + (int)(i / (size_t)fixture->width) % fixture->height * how->spread /
                                                 (2 * fixture->height));
  }
  for (int style = 1; style <= fixture->styles; style++) {
    const StyStyle values = draw_wild_style(random, fixture, how->spread);
    write_style(fixture, style, &values);
  }
  open_fixture(fixture);
  return fixture;
}

/* Buffers of exactly a frame's size, so that whoever reads beyond them is seen. */
typedef struct Buffers {
  uint8_t *guide, *styles, *luma, *albedo;
  uint16_t *objects;
  float *fine, *depth;
  int32_t anchors[6];
} Buffers;

static void *fill(uint64_t *random, size_t size) {
  unsigned char *bytes = malloc(size);
  assert_non_null(bytes);
  fill_random(random, bytes, size);
  return bytes;
}

static void smooth(uint64_t *random, const Guides *how, StyFrame *frame, uint8_t *guide) {
  const int slope = 1 + draw_below(random, 4);
  for (int i = 0; i < frame->width * frame->height; i++) {
    const int x = i % frame->width, y = i / frame->width;
    guide[4 * i] = (uint8_t)(how->base + (x / slope + y / 7) % how->spread);
    guide[4 * i + 1] = (uint8_t)(how->base + (y / slope + x / 31) % how->spread);
  }
}

static StyFrame draw_all(uint64_t *random, const Guides *how, const Fixture *fixture, int width, int height,
                         bool is_smooth, Buffers *buffers) {
  const size_t pixels = (size_t)width * (size_t)height;
  *buffers = (Buffers){.guide = malloc(4 * pixels),
                       .styles = malloc(pixels),
                       .luma = fill(random, pixels),
                       .albedo = fill(random, 4 * pixels),
                       .objects = malloc(2 * pixels),
                       .fine = malloc(8 * pixels),
                       .depth = malloc(4 * pixels)};
  assert_true(buffers->guide && buffers->styles && buffers->objects && buffers->fine && buffers->depth);
  StyFrame frame = {
      .width = width, .height = height, .resolution = draw_below(random, 5) ? 0 : draw_below(random, 3) - 1};
  draw_guide(random, how, buffers->guide, pixels);
  if (is_smooth) smooth(random, how, &frame, buffers->guide);
  const int patch = 1 + draw_below(random, 40);
  for (size_t i = 0; i < pixels; i++) {
    const int cell = (int)(i % (size_t)width) / patch + (int)(i / (size_t)width) / patch;
    buffers->styles[i] = (uint8_t)(cell % (fixture->styles + 2));
    buffers->objects[i] = (uint16_t)(cell / 2 % 4);
    buffers->depth[i] = draw_below(random, 50) ? (float)(cell % 3) / 2 : NAN;
    buffers->fine[2 * i] = draw_below(random, 50) ? draw_signed(random) * 1.2f : NAN;
    buffers->fine[2 * i + 1] = draw_signed(random) * 1.2f;
  }
  for (int i = 0; i < 6; i++) buffers->anchors[i] = draw_below(random, 4000) - 2000;
  frame.guide = buffers->guide;
  frame.style = 1 + draw_below(random, fixture->styles);
  frame.number = draw_below(random, 9);
  if (draw(random) & 1) frame.styles = buffers->styles;
  if (draw(random) & 1) frame.luma = buffers->luma;
  if (draw(random) & 1) frame.albedo = buffers->albedo;
  if (draw(random) & 1) frame.objects = buffers->objects;
  if (draw(random) & 1) frame.depth = buffers->depth;
  if (draw_below(random, 3) == 0) frame.fine = buffers->fine;
  if (draw_below(random, 4) == 0) frame.anchors = buffers->anchors, frame.anchor_count = 3;
  return frame;
}

static void free_buffers(Buffers *buffers) {
  void *const all[] = {buffers->guide,   buffers->styles, buffers->luma, buffers->albedo,
                       buffers->objects, buffers->fine,   buffers->depth};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
}

static void note(const Fixture *fixture, const StyFrame *frame) {
  for (int s = frame->styles ? 1 : frame->style; s <= (frame->styles ? fixture->styles : frame->style); s++) {
    const StyStyle *style = &fixture->style[s];
    seen[SEEN_SCATTER] += style->scatter > 0;
    seen[SEEN_ANCHOR] += frame->anchors != NULL;
    seen[SEEN_SPREAD] += style->scale != 1 || frame->resolution;
    seen[SEEN_LIGHTING] += frame->luma && style->layer_count > 1;
    seen[SEEN_BASE] += (style->flags & STY_FLAG_BASE) != 0;
    seen[SEEN_ALBEDO] += frame->albedo && style->colour_weight > 0;
    seen[SEEN_DEPTH] += frame->depth && style->depth_tolerance > 0;
    seen[SEEN_KEPT] += frame->seeds_count > 0;
    seen[SEEN_FINE] += frame->fine != NULL;
  }
}

static void expect_same(const char *what, StyRuntimePath path, const StyFrame *frame, const void *found,
                        const void *wanted, size_t texel) {
  const size_t pixels = (size_t)frame->width * (size_t)frame->height;
  for (size_t i = 0; i < pixels; i++)
    if (memcmp((const char *)found + i * texel, (const char *)wanted + i * texel, texel) != 0)
      fail_msg("%s of path %d: pixel (%zu, %zu) of %dx%d differs", what, path, i % (size_t)frame->width,
               i / (size_t)frame->width, frame->width, frame->height);
}

/* Transfers and blends by one path, in tiles of a random size. */
static void draw_picture(uint64_t *random, const Fixture *fixture, const StyFrame *frame, int bits, StyMatch *matches,
                         void *picture) {
  for (int pass = 0; pass < 2; pass++) {
    const int across = 1 + draw_below(random, 400), down = 1 + draw_below(random, 60);
    for (int y = 0; y < frame->height; y += down)
      for (int x = 0; x < frame->width; x += across) {
        const StyRect tile = {x, y, x + across < frame->width ? x + across : frame->width,
                              y + down < frame->height ? y + down : frame->height};
        assert_int_equal(pass ? sty_blend_frame(&fixture->bundle, frame, tile, matches, bits, picture)
                              : sty_transfer_frame(&fixture->bundle, frame, tile, matches),
                         STY_RUNTIME_OK);
      }
  }
}

/* Seeds for an area that has the frame, or lacks a part of it. */
static StySeedOffset *keep_seeds(uint64_t *random, const Fixture *fixture, StyFrame *frame, StySeeds *seeds) {
  const int margin = draw_below(random, 12) - 4;
  const StyRect area = {-margin, -margin, frame->width + margin, frame->height + margin};
  const size_t size = sty_get_seeds_size(area);
  if (size == 0) return NULL;
  StySeedOffset *offsets = malloc(size);
  assert_non_null(offsets);
  assert_int_equal(
      sty_plan_seeds(&fixture->bundle, frame->style ? frame->style : 1, frame->number, area, offsets, seeds),
      STY_RUNTIME_OK);
  assert_int_equal(sty_fill_seeds(&fixture->bundle, seeds, area.y0, area.y1, STY_PATH_REFERENCE), STY_RUNTIME_OK);
  frame->seeds = seeds;
  frame->seeds_count = 1;
  return offsets;
}

static void compare_paths(uint64_t *random, const Fixture *fixture, StyFrame *frame) {
  const size_t pixels = (size_t)frame->width * (size_t)frame->height;
  const int bits = draw(random) & 1 ? 8 : 16;
  StyMatch *wanted = malloc(pixels * sizeof *wanted), *found = malloc(pixels * sizeof *found);
  unsigned char *picture = malloc(pixels * 8), *other = malloc(pixels * 8);
  assert_true(wanted && found && picture && other);
  StySeeds seeds;
  frame->path = STY_PATH_REFERENCE;
  draw_picture(random, fixture, frame, bits, wanted, picture);
  StySeedOffset *kept = draw(random) & 1 ? keep_seeds(random, fixture, frame, &seeds) : NULL;
  note(fixture, frame);
  for (int p = 0; p < PATHS; p++) {
    if (!sty_has_path(paths[p])) continue;
    frame->path = paths[p];
    memset(found, 0x5A, pixels * sizeof *found);
    memset(other, 0x5A, pixels * 8);
    draw_picture(random, fixture, frame, bits, found, other);
    expect_same("matches", paths[p], frame, found, wanted, sizeof *found);
    expect_same("picture", paths[p], frame, other, picture, (size_t)bits / 2);
  }
  free(kept);
  free(wanted);
  free(found);
  free(picture);
  free(other);
}

static void test_all_paths_give_the_same_bytes(void **state) {
  (void)state;
  static const int sizes[][2] = {{1, 1}, {2, 1}, {1, 3}, {300, 3}, {3, 90}, {97, 61}, {530, 37}, {256, 20}, {241, 24}};
  static const int spreads[] = {1, 6, 40, 200};
  uint64_t random = 41;
  for (int round = 0; round < CASES(260, 40); round++) {
    const int spread = draw_from(&random, spreads, 4);
    const Guides how = {draw_below(&random, 257 - spread), spread, draw_below(&random, 3) * 4};
    const bool is_smooth = draw_below(&random, 3) > 0;
    Fixture *fixture = draw_bundle(&random, &how, is_smooth);
    Buffers buffers;
    const int *size = sizes[draw_below(&random, 9)];
    StyFrame frame = draw_all(&random, &how, fixture, size[0], size[1], is_smooth, &buffers);
    compare_paths(&random, fixture, &frame);
    free_buffers(&buffers);
    destroy_fixture(fixture);
  }
  for (int kind = 0; kind < KINDS; kind++)
    if (seen[kind] < 5) fail_msg("kind %d was seen %zu times only", kind, seen[kind]);
}

/* Matches that no transfer makes: outside the source, of lightings that the style lacks, of other styles. */
static void test_blending_any_matches(void **state) {
  (void)state;
  uint64_t random = 42;
  for (int round = 0; round < CASES(60, 12); round++) {
    const Guides how = {0, 256, draw_below(&random, 3)};
    Fixture *fixture = draw_bundle(&random, &how, false);
    Buffers buffers;
    StyFrame frame =
        draw_all(&random, &how, fixture, 1 + draw_below(&random, 300), 1 + draw_below(&random, 30), false, &buffers);
    const size_t pixels = (size_t)frame.width * (size_t)frame.height;
    StyMatch *matches = fill(&random, pixels * sizeof *matches);
    for (size_t i = 0; i < pixels; i++) {
      if (draw(&random) & 1) matches[i].x %= 90, matches[i].y %= 90, matches[i].layer %= 5;
      if (i > 0 && draw_below(&random, 4)) matches[i] = matches[i - 1], matches[i].x++;
    }
    const StyRect all = {0, 0, frame.width, frame.height};
    unsigned char *wanted = malloc(8 * pixels), *found = malloc(8 * pixels);
    assert_true(wanted && found);
    frame.path = STY_PATH_REFERENCE;
    assert_int_equal(sty_blend_frame(&fixture->bundle, &frame, all, matches, 16, wanted), STY_RUNTIME_OK);
    for (int p = 0; p < PATHS; p++) {
      if (!sty_has_path(paths[p])) continue;
      frame.path = paths[p];
      assert_int_equal(sty_blend_frame(&fixture->bundle, &frame, all, matches, 16, found), STY_RUNTIME_OK);
      expect_same("picture", paths[p], &frame, found, wanted, 8);
    }
    free(wanted);
    free(found);
    free(matches);
    free_buffers(&buffers);
    destroy_fixture(fixture);
  }
}

static void test_seeds_of_all_paths(void **state) {
  (void)state;
  uint64_t random = 43;
  const Guides how = {0, 256, 0};
  for (int round = 0; round < CASES(24, 6); round++) {
    Fixture *fixture = draw_bundle(&random, &how, false);
    const int x = draw_below(&random, 4000) - 2000, y = draw_below(&random, 4000) - 2000;
    const StyRect area = {x, y, x + 1 + draw_below(&random, round % 4 ? 90 : 1400),
                          y + 1 + draw_below(&random, round % 4 ? 700 : 40)};
    const size_t size = sty_get_seeds_size(area);
    StySeedOffset *wanted = malloc(size), *found = malloc(size);
    assert_true(wanted && found);
    StySeeds seeds;
    assert_int_equal(sty_plan_seeds(&fixture->bundle, 1, round, area, wanted, &seeds), STY_RUNTIME_OK);
    assert_int_equal(sty_fill_seeds(&fixture->bundle, &seeds, area.y0, area.y1, STY_PATH_REFERENCE), STY_RUNTIME_OK);
    for (int p = 0; p < PATHS; p++) {
      if (!sty_has_path(paths[p])) continue;
      memset(found, 0x5A, size);
      seeds.offsets = found;
      const int middle = (area.y0 + area.y1) / 2;
      assert_int_equal(sty_fill_seeds(&fixture->bundle, &seeds, middle, area.y1, paths[p]), STY_RUNTIME_OK);
      assert_int_equal(sty_fill_seeds(&fixture->bundle, &seeds, area.y0, middle, paths[p]), STY_RUNTIME_OK);
      assert_memory_equal(found, wanted, size);
    }
    free(wanted);
    free(found);
    destroy_fixture(fixture);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_all_paths_give_the_same_bytes),
                                     cmocka_unit_test(test_blending_any_matches),
                                     cmocka_unit_test(test_seeds_of_all_paths)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
