/* sty_blend_frame against the formula of runtime.h, written out literally. */
#include "oracle.h"

/* Texel of a layer, counted from the style's first. */
static const uint8_t *get_layer_texel(const Fixture *fixture, int style, int layer, int x, int y) {
  return fixture->texels[STY_BUNDLE_EXEMPLARS] +
         4 * (((fixture->style[style].layer + layer) * fixture->height + y) * fixture->width + x);
}

/* The sums of votes: of colours times alpha, of alphas. */
typedef struct Votes {
  double colour[3], alpha;
  int count;
} Votes;

static void add_vote(const Fixture *fixture, int style, int lighting, int x, int y, Votes *votes) {
  const bool based = fixture->style[style].flags & STY_FLAG_BASE;
  const uint8_t *texel = get_layer_texel(fixture, style, lighting, x, y);
  for (int c = 0; c < 3; c++) {
    const int base = based ? get_layer_texel(fixture, style, fixture->style[style].layer_count + lighting, x, y)[c] : 0;
    votes->colour[c] += (texel[c] - base) * texel[3];
  }
  votes->alpha += texel[3];
  votes->count++;
}

static bool do_depths_agree(const StyFrame *frame, float tolerance, int p, int q) {
  if (!frame->depth || tolerance == 0 || p == q) return true;
  const double a = frame->depth[p], b = frame->depth[q];
  if (isnan(a) || isnan(b)) return false;
  if (isinf(a) || isinf(b)) return a == b;
  return fabs(a - b) <= tolerance;
}

static bool may_vote(const Fixture *fixture, const StyFrame *frame, int style, int x, int y, int nx, int ny) {
  if (!is_in_frame(frame, nx, ny) || ask_style(fixture, frame, nx, ny) != style) return false;
  if ((fixture->style[style].flags & STY_FLAG_OBJECTS) && get_object(frame, x, y) != get_object(frame, nx, ny))
    return false;
  return do_depths_agree(frame, fixture->style[style].depth_tolerance, y * frame->width + x, ny * frame->width + nx);
}

static Votes count_votes(const Fixture *fixture, const StyFrame *frame, const StyMatch *matches, int style, int x,
                         int y) {
  Votes votes = {{0, 0, 0}, 0, 0};
  const int radius = fixture->style[style].radius;
  const double s = (double)fixture->style[style].scale * pow(2, frame->resolution);
  for (int oy = -radius; oy <= radius; oy++)
    for (int ox = -radius; ox <= radius; ox++) {
      if (!may_vote(fixture, frame, style, x, y, x + ox, y + oy)) continue;
      const StyMatch match = matches[(y + oy) * frame->width + x + ox];
      const int sx = match.x - (int)floor(ox / s), sy = match.y - (int)floor(oy / s);
      if (match.layer < fixture->style[style].layer_count && ask_source(fixture, style, sx, sy))
        add_vote(fixture, style, match.layer, sx, sy, &votes);
    }
  const StyMatch own = matches[y * frame->width + x];
  const bool is_there =
      own.x < fixture->width && own.y < fixture->height && own.layer < fixture->style[style].layer_count;
  if (votes.count == 0 && is_there) add_vote(fixture, style, own.layer, own.x, own.y, &votes);
  return votes;
}

/* Clamped, coloured, not yet rounded; 0..1. */
static double expect_colour_of(const Fixture *fixture, const StyFrame *frame, int style, int x, int y, int c,
                               const Votes *votes) {
  if (votes->alpha == 0) return 0;
  double sum = votes->colour[c]; /* times alpha, so that nothing is rounded on the way */
  if (fixture->style[style].flags & STY_FLAG_BASE) {
    const Pair own = look_up(fixture, style, frame, x, y);
    const int layer = fixture->style[style].layer_count + choose_lighting(fixture, style, frame, x, y);
    sum += votes->alpha * get_layer_texel(fixture, style, layer, own.x, own.y)[c];
  }
  sum = fmin(fmax(sum, 0), 255 * votes->alpha);
  const int weight = round_fraction(fixture->style[style].colour_weight, 256);
  const int albedo = frame->albedo ? frame->albedo[4 * get_index(frame, x, y) + (size_t)c] : 255;
  return sum * (255 * (256 - weight) + weight * albedo) / (votes->alpha * 255 * 256);
}

static void expect_pixel(const Fixture *fixture, const StyFrame *frame, const StyMatch *matches, int x, int y, int bits,
                         unsigned wanted[4]) {
  const int style = ask_style(fixture, frame, x, y);
  for (int c = 0; c < 4; c++) wanted[c] = 0;
  if (!style) return;
  const double scale = bits == 8 ? 1 : 257;
  const Votes votes = count_votes(fixture, frame, matches, style, x, y);
  if (votes.count == 0) return;
  for (int c = 0; c < 3; c++)
    wanted[c] = (unsigned)floor(expect_colour_of(fixture, frame, style, x, y, c, &votes) * scale + 0.5);
  const int coverage = frame->guide[4 * get_index(frame, x, y) + 3];
  wanted[3] = (unsigned)floor(votes.alpha * coverage * scale / (votes.count * 255.0) + 0.5);
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

/* Any source pixel where something is stylized: in patches that agree, and alone; one in twenty matches is noise. */
static StyMatch *draw_matches(uint64_t *random, const Fixture *fixture, const StyFrame *frame) {
  StyMatch *matches = malloc((size_t)frame->width * (size_t)frame->height * sizeof *matches);
  assert_non_null(matches);
  for (int y = 0; y < frame->height; y++)
    for (int x = 0; x < frame->width; x++) {
      StyMatch *match = &matches[y * frame->width + x];
      const int style = ask_style(fixture, frame, x, y);
      *match = no_match;
      if (draw_below(random, 20) == 0) {
        fill_random(random, (unsigned char *)match, sizeof *match);
        if (draw(random) & 1) match->x %= fixture->width + 1, match->y %= fixture->height + 1;
        continue;
      }
      if (!style) continue;
      const bool alone = draw_below(random, 4) == 0;
      *match = (StyMatch){.x = (uint16_t)((alone ? draw_below(random, 1 << 15) : x) % fixture->width),
                          .y = (uint16_t)((alone ? draw_below(random, 1 << 15) : y) % fixture->height),
                          .level = STY_LEVEL_FALLBACK,
                          .layer = (uint8_t)draw_below(random, fixture->style[style].layer_count),
                          .style = (uint8_t)(style - 1)};
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

/* What decides, beside the matches' places and the exemplar. */
enum { RADIUS, DEPTH, LIGHTING, OBJECTS, BASE, COLOUR_WEIGHT, ALBEDO, SCALE, RESOLUTION, FINE, FEATURES };

static void take_away(int feature, Fixture *fixture, StyFrame *frame, StyMatch *matches) {
  for (int style = 1; style <= fixture->styles; style++) {
    StyStyle *values = &fixture->style[style];
    if (feature == RADIUS) values->radius = 0;
    if (feature == DEPTH) values->depth_tolerance = 0;
    if (feature == OBJECTS) values->flags &= ~STY_FLAG_OBJECTS;
    if (feature == BASE) values->flags &= ~STY_FLAG_BASE;
    if (feature == COLOUR_WEIGHT) values->colour_weight = 1;
    if (feature == SCALE) values->scale = 1;
  }
  for (int i = 0; feature == LIGHTING && i < frame->width * frame->height; i++) matches[i].layer = 0;
  if (feature == ALBEDO) frame->albedo = NULL;
  if (feature == RESOLUTION) frame->resolution = 0;
  if (feature == FINE) frame->fine = NULL;
}

/* None of what the other tests draw is idle: each feature changes pixels, so that they would notice its loss. */
static void test_every_feature_decides(void **state) {
  (void)state;
  uint64_t random = 4;
  size_t changed[FEATURES] = {0};
  const Guides how = {0, 4, 6};
  for (int round = 0; round < 24; round++) {
    Fixture *fixture = draw_fixture(&random, &how, 16, 2);
    const StyFrame frame = draw_frame(&random, &how, fixture, 19, 11);
    StyMatch *matches = draw_matches(&random, fixture, &frame);
    uint16_t *picture = blend_rect(fixture, &frame, get_all(&frame), matches, 16);
    for (int feature = 0; feature < FEATURES; feature++) {
      Fixture lesser = *fixture;
      StyFrame plainer = frame;
      StyMatch fewer[19 * 11];
      memcpy(fewer, matches, sizeof fewer);
      take_away(feature, &lesser, &plainer, fewer);
      for (int i = 0; i < 19 * 11; i++) {
        unsigned wanted[4];
        expect_pixel(&lesser, &plainer, fewer, i % 19, i / 19, 16, wanted);
        changed[feature] += wanted[0] != picture[4 * i] || wanted[3] != picture[4 * i + 3];
      }
    }
    free(picture);
    free(matches);
    destroy_frame(&frame);
    destroy_fixture(fixture);
  }
  for (int feature = 0; feature < FEATURES; feature++)
    if (changed[feature] < 100) fail_msg("feature %d changed %zu pixels", feature, changed[feature]);
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

/* One pixel of a bundle with a base: exemplar - base + own base, clamped before it is coloured. */
static void test_bases_to_the_number(void **state) {
  (void)state;
  static const struct {
    int exemplar, base, own_base, albedo;
    float weight;
    unsigned wanted;
  } cases[] = {{100, 60, 30, 255, 1, 70},   {100, 60, 30, 51, 1, 14},   {250, 10, 200, 255, 1, 255},
               {250, 10, 200, 128, 1, 128}, {10, 250, 30, 255, 1, 0},   {100, 60, 30, 0, 1, 0},
               {100, 60, 30, 0, 0, 70},     {100, 60, 30, 0, 0.5f, 35}, {100, 60, 30, 127, 0.1f, 66}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    Fixture *fixture = make_fixture(2, 1, 1, 1, 2, 1);
    const StyStyle style = {
        .layer_count = 1, .scale = 1, .colour_weight = cases[i].weight, .flags = STY_FLAG_BASE}; /* LUT: pixel 0 */
    write_style(fixture, 1, &style);
    memset(fixture->texels[STY_BUNDLE_GUIDES], 255, 8);
    const uint8_t texels[16] = {0,
                                0,
                                0,
                                255,
                                (uint8_t)cases[i].exemplar,
                                0,
                                0,
                                255,
                                (uint8_t)cases[i].own_base,
                                0,
                                0,
                                0,
                                (uint8_t)cases[i].base,
                                0,
                                0,
                                0};
    memcpy(fixture->texels[STY_BUNDLE_EXEMPLARS], texels, sizeof texels);
    open_fixture(fixture);
    const uint8_t guide[4] = {0, 0, 0, 255}, albedo[4] = {(uint8_t)cases[i].albedo, 0, 0, 0};
    const StyFrame frame = {.width = 1, .height = 1, .guide = guide, .albedo = albedo, .style = 1};
    const StyMatch match = {.x = 1};
    uint8_t *picture = blend_rect(fixture, &frame, get_all(&frame), &match, 8);
    assert_int_equal(picture[0], cases[i].wanted);
    free(picture);
    destroy_fixture(fixture);
  }
}

/* The neighbour is dropped only where the flag asks for it. */
static void test_objects_drop_votes(void **state) {
  (void)state;
  for (int flag = 0; flag < 2; flag++)
    for (int other = 0; other < 2; other++) {
      Row *row = make_row(2, 1, 0, (const uint8_t[12]){10, 0, 0, 255, 30, 0, 0, 255, 0, 0, 0, 0});
      const uint16_t objects[2] = {0, (uint16_t)(other ? 65535 : 0)};
      row->matches[1].x = 2;
      row->frame.objects = objects;
      row->fixture->style[1].flags = flag ? STY_FLAG_OBJECTS : 0;
      write_style(row->fixture, 1, &row->fixture->style[1]);
      expect_colour(row, 0, 8, flag && other ? 10 : 20, 0, 0, 255);
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
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_equals_the_formula),     cmocka_unit_test(test_every_feature_decides),
      cmocka_unit_test(test_bases_to_the_number),    cmocka_unit_test(test_objects_drop_votes),
      cmocka_unit_test(test_tiles_and_rectangles),   cmocka_unit_test(test_radius_0_is_the_exemplar),
      cmocka_unit_test(test_colours_weigh_by_alpha), cmocka_unit_test(test_votes_outside_are_dropped),
      cmocka_unit_test(test_depths_drop_votes),      cmocka_unit_test(test_bad_arguments)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
