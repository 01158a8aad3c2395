/* The shaders beside the C path, over drawn bundles and frames. */
#include "../runtime/fixture.h"
#include "twins.h"

/* What came of the pixels, so that a test can tell that it saw all of it. */
typedef struct Tally {
  size_t levels[256], layers[STY_MAX_LIGHTINGS], partly;
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

/* All of one guide, so that pieces scatter wherever their object's surroundings let them; they come from a source that
 * spreads so far. */
static void check_flat_frame(const Gpu *gpu, uint64_t *random, int spread, int threshold, Tally *tally) {
  const Guides how = {100, 1, 0};
  Fixture *fixture = draw_fixture(random, &(Guides){100 - spread / 2, spread, 0}, 64, 1);
  StyStyle style = fixture->style[1];
  style.threshold = threshold, style.top_level = 5, style.scatter = 12, style.luma_weight = 0;
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

static void check_drawn_frames(const char *dialect, uint64_t random) {
  static const int sides[] = {1, 2, 7, 64, 255, 256}, spreads[] = {1, 1, 2, 4, 20, 256}, holes[] = {0, 2, 10};
  Tally tally = {{0}, {0}, 0};
  Gpu gpu = open_gpu(dialect);
  /* Few frames of each bundle: the renderer compiles a pass anew for other sizes of textures. */
  for (int round = 0; round < 20; round++) {
    const int spread = spreads[draw_below(&random, 6)], *size = frame_sizes[round % FRAME_SIZES];
    const Guides how = {draw_below(&random, 257 - spread), spread, holes[round % 3]};
    Fixture *fixture = draw_fixture(&random, &how, sides[round % 6], 1 + draw_below(&random, 4));
    const StyFrame frame = draw_frame(&random, &how, fixture, size[0], size[1]);
    check_frame(&gpu, &fixture->bundle, &frame, &tally);
    destroy_frame(&frame);
    destroy_fixture(fixture);
  }
  check_flat_frame(&gpu, &random, 1, STY_MAX_THRESHOLD, &tally);
  check_flat_frame(&gpu, &random, 20, 24, &tally);
  close_gpu(&gpu);
  for (int level = 0; level <= 6; level++) assert_in_range(tally.levels[level], 1, SIZE_MAX);
  for (int layer = 0; layer < STY_MAX_LIGHTINGS; layer++) assert_in_range(tally.layers[layer], 1, SIZE_MAX);
  assert_in_range(tally.levels[STY_LEVEL_FALLBACK], 1, SIZE_MAX);
  assert_in_range(tally.levels[STY_LEVEL_NONE], 1, SIZE_MAX);
  assert_in_range(tally.partly, 1, SIZE_MAX);
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
