/* sty_shade_toon against the formulas of runtime.h, written out literally. */
#include "fixture.h"

typedef struct Place {
  int x, y;
} Place;

static int divide_down(int64_t a, int64_t b) { return (int)floor((double)a / (double)b); }

static int wrap(int a, int n) { return (a % n + n) % n; }

static Place get_anchor(const StyFrame *frame, size_t i) {
  const int object = frame->objects ? frame->objects[i] : 0;
  if (!frame->anchors || object >= frame->anchor_count) return (Place){0, 0};
  return (Place){frame->anchors[2 * object], frame->anchors[2 * object + 1]};
}

static Place expect_seed(const StyToon *toon, Place p) {
  const int h = 1 << toon->cell_level;
  Place nearest = {0, 0};
  double least = INFINITY;
  for (int dx = -1; dx <= 1; dx++)
    for (int dy = -1; dy <= 1; dy++) {
      const int bx = divide_down(p.x, h) + dx, by = divide_down(p.y, h) + dy;
      const uint8_t *j = toon->jitter + 2 * (wrap(by, 256) * 256 + wrap(bx, 256));
      const Place seed = {h * bx + divide_down((int64_t)h * j[0] * toon->jitter_amount, 255 * 255),
                          h * by + divide_down((int64_t)h * j[1] * toon->jitter_amount, 255 * 255)};
      const double distance = pow(seed.x - p.x, 2) + pow(seed.y - p.y, 2);
      if (distance < least) least = distance, nearest = seed;
    }
  return nearest;
}

/* The guide at a sample if it counts for an object. */
static const uint8_t *ask_sample(const StyFrame *frame, int object, int x, int y) {
  if (x < 0 || y < 0 || x >= frame->width || y >= frame->height) return NULL;
  const size_t i = (size_t)y * (size_t)frame->width + (size_t)x;
  return frame->guide[4 * i + 3] && (frame->objects ? frame->objects[i] : 0) == object ? frame->guide + 4 * i : NULL;
}

static void add_length(const uint8_t *a, const uint8_t *b, int *sum, int *pairs) {
  if (!a || !b) return;
  *sum += (int)floor(sqrt(4096 * (pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2))));
  ++*pairs;
}

/* (c, n) of the header for the cell around a seed in the frame. */
static Place expect_turn(const StyFrame *frame, const StyToon *toon, int object, Place seed) {
  const int step = 1 << (toon->cell_level - 2);
  int across = 0, m = 0, down = 0, l = 0;
  for (int i = -2; i <= 2; i++)
    for (int j = -2; j <= 2; j++) {
      const uint8_t *here = ask_sample(frame, object, seed.x + step * i, seed.y + step * j);
      if (i < 2) add_length(here, ask_sample(frame, object, seed.x + step * (i + 1), seed.y + step * j), &across, &m);
      if (j < 2) add_length(here, ask_sample(frame, object, seed.x + step * i, seed.y + step * (j + 1)), &down, &l);
    }
  if (across < 32 * m + (m == 0) && down < 32 * l + (l == 0)) return (Place){4096, 0};
  const bool both = m > 0 && l > 0;
  int u = both ? across * l : across, v = both ? down * m : down;
  for (; u >= 2048 || v >= 2048; u >>= 1, v >>= 1) {
  }
  const int r = (int)floor(sqrt(256.0 * (u * u + v * v)));
  return (Place){65536 * u / r, 65536 * v / r};
}

static int expect_band(const StyFrame *frame, const StyToon *toon, int px, int py, size_t *turned) {
  const size_t i = (size_t)py * (size_t)frame->width + (size_t)px;
  int luma = 256 * frame->luma[i];
  if (toon->pattern.texels) {
    const Place a = get_anchor(frame, i);
    Place place = {px - a.x, py - a.y};
    if (toon->cell_level) {
      const Place s = expect_seed(toon, place), d = {place.x - s.x, place.y - s.y};
      const Place turn =
          expect_turn(frame, toon, frame->objects ? frame->objects[i] : 0, (Place){s.x + a.x, s.y + a.y});
      place.x = s.x + divide_down(d.x * turn.x + d.y * turn.y + 2048, 4096);
      place.y = s.y + divide_down(d.y * turn.x - d.x * turn.y + 2048, 4096);
      *turned += turn.y != 0;
    }
    const int column = wrap(place.x, toon->pattern.width), row = wrap(place.y, toon->pattern.height);
    luma += toon->pattern_weight * (toon->pattern.texels[row * toon->pattern.width + column] - 128);
  }
  int band = 0;
  for (int t = 0; t < toon->band_count - 1; t++) band += 256 * toon->thresholds[t] <= luma;
  return band;
}

static void expect_pixel(const StyFrame *frame, const StyToon *toon, int x, int y, int bits, double out[4],
                         size_t *turned) {
  const size_t i = (size_t)y * (size_t)frame->width + (size_t)x;
  const int style = frame->styles ? frame->styles[i] : frame->style;
  for (int c = 0; c < 4; c++) out[c] = 0;
  if (!frame->guide[4 * i + 3] || (toon->style && toon->style != style)) return;
  const uint8_t *colour = toon->colours[expect_band(frame, toon, x, y, turned)];
  const double scale = bits == 8 ? 1 : 257;
  for (size_t c = 0; c < 3; c++) {
    const double factor =
        frame->albedo ? 255 * (256 - toon->colour_weight) + toon->colour_weight * frame->albedo[4 * i + c] : 255 * 256;
    out[c] = floor((colour[c] * factor * scale) / (255 * 256) + 0.5);
  }
  out[3] = floor(colour[3] * frame->guide[4 * i + 3] * scale / 255 + 0.5);
}

static unsigned get_component(const void *picture, int bits, size_t i) {
  return bits == 8 ? ((const uint8_t *)picture)[i] : ((const uint16_t *)picture)[i];
}

/* A frame, its toon and all that they point to. */
typedef struct Scene {
  StyFrame frame;
  StyToon toon;
  uint8_t *guide, *luma, *albedo, *styles, *pattern;
  uint16_t *objects;
  int32_t anchors[6];
  uint8_t jitter[2 * 256 * 256];
} Scene;

/* Normals in slants that differ by object, so that cells turn and some don't. */
static void draw_scene(uint64_t *random, int width, int height, Scene *s) {
  static const int steps[] = {0, 0, 1, 3, 9};
  const size_t pixels = (size_t)width * (size_t)height;
  const int pattern_width = 1 + draw_below(random, 40), pattern_height = 1 + draw_below(random, 40);
  s->guide = malloc(4 * pixels), s->luma = malloc(pixels), s->albedo = malloc(4 * pixels), s->styles = malloc(pixels);
  s->objects = malloc(2 * pixels), s->pattern = malloc((size_t)(pattern_width * pattern_height));
  assert_true(s->guide && s->luma && s->albedo && s->styles && s->objects && s->pattern);
  const int slope_x = steps[draw_below(random, 5)], slope_y = steps[draw_below(random, 5)];
  const int split = draw_below(random, width + 1), holes = draw_below(random, 2) * 20;
  for (size_t i = 0; i < pixels; i++) {
    const int x = (int)i % width, y = (int)i / width;
    s->objects[i] = (uint16_t)(x < split ? 1 : 2 + draw_below(random, 200) / 199);
    for (size_t c = 0; c < 3; c++)
      s->guide[4 * i + c] = (uint8_t)(x * slope_x + y * slope_y * (1 + s->objects[i]) + (int)c * 90);
    s->guide[4 * i + 3] = (uint8_t)(holes && !draw_below(random, holes) ? 0 : 1 + draw_below(random, 255));
    s->styles[i] = (uint8_t)draw_below(random, 3);
  }
  fill_random(random, s->luma, pixels);
  fill_random(random, s->albedo, 4 * pixels);
  fill_random(random, s->pattern, (size_t)(pattern_width * pattern_height));
  fill_random(random, s->jitter, sizeof s->jitter);
  for (int i = 0; i < 6; i++) s->anchors[i] = draw_below(random, 400) - 200;
  s->frame = (StyFrame){.width = width, .height = height, .guide = s->guide, .luma = s->luma, .style = 1};
  if (draw(random) & 1) s->frame.albedo = s->albedo;
  if (draw(random) & 1) s->frame.styles = s->styles;
  if (draw(random) & 1) s->frame.objects = s->objects;
  if (draw(random) & 1) s->frame.anchors = s->anchors, s->frame.anchor_count = 3;
  s->toon = (StyToon){.band_count = 1 + draw_below(random, 8), .colour_weight = draw_below(random, 257)};
  fill_random(random, s->toon.thresholds, sizeof s->toon.thresholds);
  fill_random(random, s->toon.colours[0], sizeof s->toon.colours);
  s->toon.style = draw_below(random, 3) / 2;
  if (draw_below(random, 4)) s->toon.pattern = (StyPattern){s->pattern, pattern_width, pattern_height};
  s->toon.pattern_weight = draw_below(random, STY_MAX_PATTERN_WEIGHT + 1);
  s->toon.cell_level = draw_below(random, 4) ? 2 + draw_below(random, 7) : 0;
  s->toon.jitter = s->jitter;
  s->toon.jitter_amount = draw_below(random, 256);
}

static void destroy_scene(Scene *s) {
  free(s->guide), free(s->luma), free(s->albedo), free(s->styles), free(s->objects), free(s->pattern);
}

static void *shade(const Scene *s, StyRect rect, int bits) {
  const size_t bytes = (size_t)s->frame.width * (size_t)s->frame.height * 4 * (size_t)(bits / 8);
  void *picture = malloc(bytes);
  assert_non_null(picture);
  memset(picture, 99, bytes);
  assert_int_equal(sty_shade_toon(&s->frame, &s->toon, rect, bits, picture), STY_RUNTIME_OK);
  return picture;
}

static void test_equals_the_formula(void **state) {
  (void)state;
  uint64_t random = 1;
  size_t turned = 0;
  Scene *s = malloc(sizeof *s);
  for (int round = 0; round < CASES(150, 20); round++) {
    const int *size = frame_sizes[round % FRAME_SIZES], bits = 8 + round % 2 * 8;
    draw_scene(&random, size[0], size[1], s);
    const StyRect rect = round % 3 ? (StyRect){0, 0, size[0], size[1]} : draw_rect(&random, &s->frame);
    void *picture = shade(s, rect, bits);
    for (int y = 0; y < size[1]; y++)
      for (int x = 0; x < size[0]; x++) {
        const unsigned untouched = bits == 8 ? 99 : 99 * 257;
        double wanted[4] = {untouched, untouched, untouched, untouched};
        if (is_inside(rect, x, y)) expect_pixel(&s->frame, &s->toon, x, y, bits, wanted, &turned);
        for (int c = 0; c < 4; c++)
          if (get_component(picture, bits, (size_t)(4 * (y * size[0] + x) + c)) != wanted[c])
            fail_msg("round %d (%d, %d) channel %d: found %u, expected %g", round, x, y, c,
                     get_component(picture, bits, (size_t)(4 * (y * size[0] + x) + c)), wanted[c]);
      }
    free(picture);
    destroy_scene(s);
  }
  free(s);
  assert_in_range(turned, 1000, SIZE_MAX);
}

static void test_tiles_make_the_whole(void **state) {
  (void)state;
  uint64_t random = 2;
  Scene *s = malloc(sizeof *s);
  for (int round = 0; round < CASES(30, 6); round++) {
    const int *size = frame_sizes[round % FRAME_SIZES];
    draw_scene(&random, size[0], size[1], s);
    void *whole = shade(s, (StyRect){0, 0, size[0], size[1]}, 8), *tiled = shade(s, (StyRect){0, 0, 0, 0}, 8);
    const int step = 1 + draw_below(&random, 30);
    for (int y = (size[1] - 1) / step * step; y >= 0; y -= step)
      for (int x = 0; x < size[0]; x += step) {
        const StyRect tile = {x, y, x + step < size[0] ? x + step : size[0], y + step < size[1] ? y + step : size[1]};
        assert_int_equal(sty_shade_toon(&s->frame, &s->toon, tile, 8, tiled), STY_RUNTIME_OK);
      }
    assert_memory_equal(whole, tiled, (size_t)(4 * size[0] * size[1]));
    free(whole);
    free(tiled);
    destroy_scene(s);
  }
  free(s);
}

/* Normals that bend along y alone turn the pattern by a right angle; along x, and where they bend by less than half a
 * byte from sample to sample, not at all. */
static void test_turns_with_the_surface(void **state) {
  (void)state;
  uint64_t random = 3;
  Scene *s = malloc(sizeof *s);
  draw_scene(&random, 64, 64, s);
  s->frame = (StyFrame){.width = 64, .height = 64, .guide = s->guide, .luma = s->luma, .style = 1};
  const uint8_t stripes[2] = {0, 255};
  s->toon = (StyToon){.band_count = 2,
                      .thresholds = {128},
                      .colours = {{0, 0, 0, 255}, {255, 255, 255, 255}},
                      .pattern = {stripes, 2, 1},
                      .pattern_weight = 256,
                      .cell_level = 4,
                      .jitter = s->jitter};
  static const struct {
    int along_x, along_y; /* 16ths of a byte per pixel */
    bool turns;
  } cases[] = {{0, 0, false}, {32, 0, false}, {0, 32, true}, {0, 2, true}, {0, 1, false}};
  for (int k = 0; k < 5; k++) {
    for (int i = 0; i < 64 * 64; i++) {
      const uint8_t texel[4] = {(uint8_t)((i % 64 * cases[k].along_x + i / 64 * cases[k].along_y) / 16), 0, 0, 255};
      memcpy(s->guide + 4 * i, texel, 4);
      s->luma[i] = 128;
    }
    uint8_t *picture = shade(s, (StyRect){0, 0, 64, 64}, 8);
    for (int i = 0; i < 64 * 56; i++) /* seeds are even, so that stripes meet; the last cells lack samples */
      assert_int_equal(picture[4 * i], (cases[k].turns ? i / 64 : i) % 2 * 255);
    free(picture);
  }
  destroy_scene(s);
  free(s);
}

static void test_bad_arguments(void **state) {
  (void)state;
  uint64_t random = 4;
  uint8_t out[4];
  Scene *s = malloc(sizeof *s);
  draw_scene(&random, 1, 1, s);
  s->toon = (StyToon){.band_count = 1};
  const StyRect all = {0, 0, 1, 1};
  assert_int_equal(sty_shade_toon(&s->frame, &s->toon, all, 8, out), STY_RUNTIME_OK);
  const StyToon bad[] = {{.band_count = 0},
                         {.band_count = STY_MAX_BANDS + 1},
                         {.band_count = 1, .colour_weight = 257},
                         {.band_count = 1, .style = -1},
                         {.band_count = 1, .pattern_weight = STY_MAX_PATTERN_WEIGHT + 1},
                         {.band_count = 1, .pattern = {out, 0, 1}},
                         {.band_count = 1, .pattern = {out, 1, STY_MAX_PATTERN_SIDE + 1}},
                         {.band_count = 1, .cell_level = 3},
                         {.band_count = 1, .cell_level = 1, .jitter = s->jitter},
                         {.band_count = 1, .cell_level = 9, .jitter = s->jitter},
                         {.band_count = 1, .jitter_amount = 256}};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    if (sty_shade_toon(&s->frame, &bad[i], all, 8, out) != STY_RUNTIME_BAD_ARGUMENT) fail_msg("case %zu passed", i);
  assert_int_equal(sty_shade_toon(NULL, &s->toon, all, 8, out), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_shade_toon(&s->frame, NULL, all, 8, out), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_shade_toon(&s->frame, &s->toon, all, 8, NULL), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_shade_toon(&s->frame, &s->toon, all, 12, out), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_shade_toon(&s->frame, &s->toon, (StyRect){0, 0, 2, 1}, 8, out), STY_RUNTIME_BAD_ARGUMENT);
  s->frame.luma = NULL;
  assert_int_equal(sty_shade_toon(&s->frame, &s->toon, all, 8, out), STY_RUNTIME_BAD_ARGUMENT);
  destroy_scene(s);
  free(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_equals_the_formula), cmocka_unit_test(test_tiles_make_the_whole),
      cmocka_unit_test(test_turns_with_the_surface), cmocka_unit_test(test_bad_arguments)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
