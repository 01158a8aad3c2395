/* sty_open_texture, sty_open_bundle and sty_get_style: what they take, and all that they refuse. */
#include <float.h>

#include "fixture.h"

static unsigned char *get_bytes(const Fixture *fixture, int file) { return (void *)fixture->files[file].data; }

static Fixture *make_small(void) {
  uint64_t random = 7;
  const Guides how = {0, 256, 4};
  Fixture *fixture = make_fixture(5, 3, 4, 3, 2, 2);
  for (int file = 0; file < STY_BUNDLE_FILES; file++)
    if (file != STY_BUNDLE_PARAMS) fill_random(&random, fixture->texels[file], count_texel_bytes(fixture, file));
  draw_guide(&random, &how, fixture->texels[STY_BUNDLE_GUIDES], 5 * 3 * 3);
  open_fixture(fixture);
  return fixture;
}

static void expect_refusal(const Fixture *fixture, StyRuntimeStatus wanted, int at_fault) {
  StyBundle bundle;
  int culprit = -1;
  const StyRuntimeStatus status = sty_open_bundle(fixture->files, &bundle, &culprit);
  if (status != wanted) fail_msg("'%s', not %d", sty_describe_runtime_status(status), wanted);
  assert_int_equal(culprit, at_fault);
  assert_int_equal(sty_open_bundle(fixture->files, &bundle, NULL), wanted);
}

static void expect_inside(StyBlob file, const StyTexture *texture) {
  const unsigned char *data = file.data;
  assert_in_range((uintptr_t)texture->texels, (uintptr_t)data, (uintptr_t)(data + file.size));
  const uint64_t room = (uint64_t)(data + file.size - texture->texels);
  assert_true(texture->width && texture->height && texture->layers && texture->texel_size);
  assert_true((uint64_t)texture->width * texture->height <= room / texture->texel_size / texture->layers);
}

static void test_textures_of_a_good_bundle(void **state) {
  (void)state;
  static const uint32_t sizes[STY_BUNDLE_FILES][4] = {
      {5, 3, 2, 4}, {5, 3, 3, 4}, {4, 4, 3, 4}, {3, 5, 1, 16}, {256, 256, 2, 2}};
  Fixture *fixture = make_small();
  for (int file = 0; file < STY_BUNDLE_FILES; file++) {
    const StyTexture *texture = &fixture->bundle.textures[file];
    assert_ptr_equal(texture->texels, fixture->texels[file]);
    const uint32_t found[4] = {texture->width, texture->height, texture->layers, texture->texel_size};
    assert_memory_equal(found, sizes[file], sizeof found);
  }
  destroy_fixture(fixture);
}

/* Blobs may lie at odd addresses. */
static void test_any_alignment(void **state) {
  (void)state;
  Fixture *fixture = make_small();
  unsigned char *blocks[STY_BUNDLE_FILES];
  StyBlob files[STY_BUNDLE_FILES];
  for (int file = 0; file < STY_BUNDLE_FILES; file++) {
    blocks[file] = malloc(fixture->files[file].size + 1);
    assert_non_null(blocks[file]);
    memcpy(blocks[file] + 1, fixture->files[file].data, fixture->files[file].size);
    files[file] = (StyBlob){blocks[file] + 1, fixture->files[file].size};
  }
  StyBundle bundle;
  assert_int_equal(sty_open_bundle(files, &bundle, NULL), STY_RUNTIME_OK);
  uint8_t guide[4 * 35], picture[2][4 * 35];
  uint64_t random = 8;
  draw_guide(&random, &(Guides){0, 256, 4}, guide, 35);
  const StyFrame frame = {.width = 7, .height = 5, .guide = guide, .style = 2};
  const StyRect all = {0, 0, 7, 5};
  for (int i = 0; i < 2; i++) {
    StyMatch matches[35];
    const StyBundle *one = i ? &bundle : &fixture->bundle;
    assert_int_equal(sty_transfer_frame(one, &frame, all, matches), STY_RUNTIME_OK);
    assert_int_equal(sty_blend_frame(one, &frame, all, matches, 8, picture[i]), STY_RUNTIME_OK);
  }
  assert_memory_equal(picture[0], picture[1], sizeof picture[0]);
  for (int file = 0; file < STY_BUNDLE_FILES; file++) free(blocks[file]);
  destroy_fixture(fixture);
}

/* Only the head of a prefix is copied: no reader may care for the values of texels that are cut off. */
static void test_truncated_files(void **state) {
  (void)state;
  Fixture *fixture = make_small();
  for (int file = 0; file < STY_BUNDLE_FILES; file++) {
    const StyBlob whole = fixture->files[file];
    for (size_t size = 0; size < whole.size; size += size < 700 || size + 300 > whole.size ? 1 : CASES(1, 131)) {
      unsigned char *prefix = malloc(size);
      assert_true(prefix || !size);
      memcpy(prefix, whole.data, size < 700 ? size : 700);
      fixture->files[file] = (StyBlob){prefix, size};
      expect_refusal(fixture, size < 12 ? STY_RUNTIME_NOT_KTX2 : STY_RUNTIME_TRUNCATED, file);
      free(prefix);
    }
    fixture->files[file] = whole;
  }
  destroy_fixture(fixture);
}

/* Every other value of each byte of a file's head: refused, or read within the blobs to the end. */
static void test_changed_bytes(void **state) {
  (void)state;
  Fixture *fixture = make_small();
  uint8_t guide[4 * 6], picture[4 * 6];
  StyMatch matches[6];
  uint64_t random = 9;
  draw_guide(&random, &(Guides){0, 256, 0}, guide, 6);
  const StyFrame frame = {.width = 3, .height = 2, .guide = guide, .style = 3, .number = 5};
  const StyRect all = {0, 0, 3, 2};
  size_t taken = 0, refused = 0;
  for (int file = 0; file < STY_BUNDLE_FILES; file++)
    for (int at = 0; at < 256; at++)
      for (int flip = 1; flip < 256; flip += CASES(1, flip)) {
        StyBundle bundle;
        StyTexture texture;
        get_bytes(fixture, file)[at] ^= (unsigned char)flip;
        if (sty_open_texture(fixture->files[file], layouts[file].vk, &texture) == STY_RUNTIME_OK)
          expect_inside(fixture->files[file], &texture);
        if (sty_open_bundle(fixture->files, &bundle, NULL) == STY_RUNTIME_OK) {
          for (int i = 0; i < STY_BUNDLE_FILES; i++) expect_inside(fixture->files[i], &bundle.textures[i]);
          assert_int_equal(sty_transfer_frame(&bundle, &frame, all, matches), STY_RUNTIME_OK);
          assert_int_equal(sty_blend_frame(&bundle, &frame, all, matches, 8, picture), STY_RUNTIME_OK);
          assert_int_equal(sty_look_up_frame(&bundle, &frame, all, matches), STY_RUNTIME_OK);
          taken++;
        } else {
          refused++;
        }
        get_bytes(fixture, file)[at] ^= (unsigned char)flip;
      }
  assert_true(taken > 0 && refused > 0);
  open_fixture(fixture);
  destroy_fixture(fixture);
}

/* Words of a header (where, what) and the status they bring. */
static void expect_refused_words(StyRuntimeStatus wanted, const uint32_t *words, size_t count) {
  for (size_t i = 0; i < count; i += 2) {
    Fixture *fixture = make_small();
    put32(get_bytes(fixture, 0) + words[i], words[i + 1]);
    StyTexture texture;
    const StyRuntimeStatus found = sty_open_texture(fixture->files[0], layouts[0].vk, &texture);
    if (found != wanted) fail_msg("%u at %u: found %d, expected %d", words[i + 1], words[i], found, wanted);
    expect_refusal(fixture, wanted, 0);
    destroy_fixture(fixture);
  }
}

static void test_headers(void **state) {
  (void)state;
  enum { TYPE_SIZE = 16, WIDTH = 20, HEIGHT = 24, DEPTH = 28, LAYERS = 32, FACES = 36, LEVELS = 40, SCHEME = 44 };
  enum { DESCRIPTOR = 48, PAIRS = 56, GLOBAL_SIZE = 72, LEVEL = 80, LEVEL_SIZE = 88, INFLATED = 96 };
  const uint32_t end = 0xFFFFFFFF;
  const uint32_t wrong[] = {0,     0x58544BAA, 4,         0xBB313120, TYPE_SIZE, 2, TYPE_SIZE,    0,
                            WIDTH, 0,          PAIRS + 4, 26,         INFLATED,  1, INFLATED + 4, 1};
  const uint32_t other[] = {12,    44, 12,     0, HEIGHT, 0, DEPTH,  1, LAYERS,      0,
                            FACES, 6,  LEVELS, 0, LEVELS, 2, SCHEME, 2, GLOBAL_SIZE, 1};
  const uint32_t ended[] = {WIDTH,     6,   WIDTH,      end, HEIGHT,         4,   HEIGHT,         end,
                            LAYERS,    3,   LAYERS,     end, DESCRIPTOR,     end, DESCRIPTOR + 4, end,
                            PAIRS,     end, PAIRS + 4,  end, LEVEL,          end, LEVEL + 4,      end,
                            LEVEL + 4, 1,   LEVEL_SIZE, end, LEVEL_SIZE + 4, end, LEVEL_SIZE,     5 * 3 * 4 * 2 - 1};
  expect_refused_words(STY_RUNTIME_NOT_KTX2, wrong, sizeof wrong / sizeof *wrong);
  expect_refused_words(STY_RUNTIME_WRONG_FORMAT, other, sizeof other / sizeof *other);
  expect_refused_words(STY_RUNTIME_TRUNCATED, ended, sizeof ended / sizeof *ended);
}

/* A level whose end wraps around 2^64 into the file, and an empty one. */
static void test_levels_without_texels(void **state) {
  (void)state;
  for (int file = 0; file < STY_BUNDLE_FILES; file++) {
    Fixture *fixture = make_small();
    unsigned char *bytes = get_bytes(fixture, file);
    put64(bytes + 80, 0 - (uint64_t)16);
    expect_refusal(fixture, STY_RUNTIME_TRUNCATED, file);
    put64(bytes + 80, 104);
    put64(bytes + 88, 0);
    put64(bytes + 96, 0);
    put32(bytes + 20, 0);
    expect_refusal(fixture, STY_RUNTIME_NOT_KTX2, file);
    destroy_fixture(fixture);
  }
}

/* Sizes, as powers of two, whose product wraps around 2^64 to what the level index says. */
static void test_products_that_wrap(void **state) {
  (void)state;
  static const int powers[][3] = {{31, 31, 0}, {31, 31, 2}, {16, 16, 30}, {31, 30, 1}, {0, 31, 31}};
  for (size_t i = 0; i < sizeof powers / sizeof *powers; i++)
    for (int file = 0; file < STY_BUNDLE_FILES; file++) {
      Fixture *fixture = make_small();
      unsigned char *bytes = get_bytes(fixture, file);
      uint64_t wrapped = layouts[file].channels * layouts[file].channel_size;
      for (int k = 0; k < 3; k++) {
        put32(bytes + (k < 2 ? 20 + 4 * k : 32), 1u << powers[i][k]);
        wrapped <<= powers[i][k];
      }
      put64(bytes + 88, wrapped);
      put64(bytes + 96, wrapped);
      expect_refusal(fixture, STY_RUNTIME_TRUNCATED, file);
      destroy_fixture(fixture);
    }
}

static void test_orientation(void **state) {
  (void)state;
  static const struct {
    const char *pairs;
    size_t size;
    StyRuntimeStatus status;
  } cases[] = {{"", 0, STY_RUNTIME_OK}, /* "rd" is what the specification takes then */
               {"\22\0\0\0KTXorientation\0rd\0\0\0", 24, STY_RUNTIME_OK},
               {"\22\0\0\0KTXorientation\0ru\0\0\0", 24, STY_RUNTIME_WRONG_FORMAT},
               {"\22\0\0\0KTXorientation\0ld\0\0\0", 24, STY_RUNTIME_WRONG_FORMAT},
               {"\21\0\0\0KTXorientation\0r\0\0\0\0", 24, STY_RUNTIME_WRONG_FORMAT},
               {"\23\0\0\0KTXorientation\0rdi\0\0", 24, STY_RUNTIME_WRONG_FORMAT},
               {"\4\0\0\0A\0b\0\22\0\0\0KTXorientation\0ru\0\0\0", 32, STY_RUNTIME_WRONG_FORMAT},
               {"\5\0\0\0A\0bc\0\0\0\0\22\0\0\0KTXorientation\0rd\0\0\0", 36, STY_RUNTIME_OK},
               {"\25\0\0\0KTXorientations\0ruin\0\0\0\0", 28, STY_RUNTIME_OK}, /* another key */
               {"\22\0\0\0KTXorientation\0rd", 22, STY_RUNTIME_NOT_KTX2},      /* the padding counts */
               {"\22\0\0", 3, STY_RUNTIME_NOT_KTX2},
               {"\25\0\0\0KTXorientation\0rd\0\0\0", 24, STY_RUNTIME_NOT_KTX2},
               {"\377\377\377\377KTXorientation\0rd\0\0\0", 24, STY_RUNTIME_NOT_KTX2},
               {"\375\377\377\377KTXorientation\0rd\0\0\0", 24, STY_RUNTIME_NOT_KTX2}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    const StyBlob plain = make_file(STY_BUNDLE_GUIDES, 5, 3, 2);
    unsigned char *bytes = malloc(plain.size + cases[i].size);
    assert_non_null(bytes);
    memcpy(bytes, plain.data, plain.size);
    memcpy(bytes + plain.size, cases[i].pairs, cases[i].size);
    put32(bytes + 56, cases[i].size ? (uint32_t)plain.size : 0);
    put32(bytes + 60, (uint32_t)cases[i].size);
    StyTexture texture;
    const StyBlob file = {bytes, plain.size + cases[i].size};
    const StyRuntimeStatus status = sty_open_texture(file, STY_VK_R8G8B8A8_UNORM, &texture);
    if (status != cases[i].status) fail_msg("case %zu: found %d", i, status);
    free(bytes);
    free((void *)plain.data);
  }
}

/* Each file in every other's place, and of another shape than its place or its neighbours ask for. */
static void test_files_that_do_not_belong(void **state) {
  (void)state;
  static const struct {
    int file, width, height, layers;
    StyRuntimeStatus status;
    int culprit;
  } cases[] = {
      {STY_BUNDLE_EXEMPLARS, 6, 3, 2, STY_RUNTIME_MISMATCH, STY_BUNDLE_GUIDES},
      {STY_BUNDLE_GUIDES, 5, 4, 3, STY_RUNTIME_MISMATCH, STY_BUNDLE_GUIDES},
      {STY_BUNDLE_GUIDES, STY_MAX_SOURCE_SIDE + 1, 1, 3, STY_RUNTIME_WRONG_FORMAT, STY_BUNDLE_GUIDES},
      {STY_BUNDLE_LUTS, 4, 4, 2, STY_RUNTIME_MISMATCH, STY_BUNDLE_LUTS},
      {STY_BUNDLE_LUTS, 4, 4, 4, STY_RUNTIME_MISMATCH, STY_BUNDLE_LUTS},
      {STY_BUNDLE_LUTS, 4, 5, 3, STY_RUNTIME_WRONG_FORMAT, STY_BUNDLE_LUTS},
      {STY_BUNDLE_LUTS, STY_MAX_LUT_SIDE + 1, STY_MAX_LUT_SIDE + 1, 1, STY_RUNTIME_WRONG_FORMAT, STY_BUNDLE_LUTS},
      {STY_BUNDLE_PARAMS, 2, 5, 1, STY_RUNTIME_MISMATCH, STY_BUNDLE_PARAMS},
      {STY_BUNDLE_PARAMS, 4, 5, 1, STY_RUNTIME_MISMATCH, STY_BUNDLE_PARAMS},
      {STY_BUNDLE_PARAMS, 3, 4, 1, STY_RUNTIME_WRONG_FORMAT, STY_BUNDLE_PARAMS},
      {STY_BUNDLE_PARAMS, 3, 5, 2, STY_RUNTIME_WRONG_FORMAT, STY_BUNDLE_PARAMS},
      {STY_BUNDLE_PARAMS, STY_MAX_STYLES + 1, 5, 1, STY_RUNTIME_WRONG_FORMAT, STY_BUNDLE_PARAMS},
      {STY_BUNDLE_JITTER, 128, 256, 1, STY_RUNTIME_WRONG_FORMAT, STY_BUNDLE_JITTER},
      {STY_BUNDLE_JITTER, 256, 255, 1, STY_RUNTIME_WRONG_FORMAT, STY_BUNDLE_JITTER}};
  Fixture *fixture = make_small();
  for (int place = 0; place < STY_BUNDLE_FILES; place++)
    for (int file = 0; file < STY_BUNDLE_FILES; file++) {
      const StyBlob right = fixture->files[place];
      if (file == place) continue;
      fixture->files[place] = fixture->files[file];
      expect_refusal(fixture, STY_RUNTIME_WRONG_FORMAT, place);
      fixture->files[place] = right;
    }
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    StyBlob *place = &fixture->files[cases[i].file];
    const StyBlob right = *place;
    *place = make_file(cases[i].file, (uint32_t)cases[i].width, (uint32_t)cases[i].height, (uint32_t)cases[i].layers);
    expect_refusal(fixture, cases[i].status, cases[i].culprit);
    free((void *)place->data);
    *place = right;
  }
  destroy_fixture(fixture);
}

/* What a component of the parameters may be: from `low` to `high`, whole or any number, and no flag or layer count
 * speaks of layers that aren't there (the small bundle has two). */
static const struct {
  double low, high;
  bool is_whole;
} ranges[4 * STY_PARAM_ROWS] = {{0, STY_MAX_THRESHOLD, true},
                                {0, STY_MAX_LEVEL, true},
                                {0, STY_MAX_RADIUS, true},
                                {0, FLT_MAX, false},
                                {0, STY_MAX_LUMA_WEIGHT, false},
                                {0, 1, false},
                                {0, 1, true},
                                {1, 2, true},
                                {0, 1, false},
                                {0, 1, false},
                                {0, 1, false},
                                {0, 1, false},
                                {0, 1, false},
                                {0, STY_MAX_PERIOD, true},
                                {0.5, 2, false},
                                {0, STY_KNOWN_FLAGS, true},
                                {0, STY_MAX_SCATTER, true},
                                {0, 0, true},
                                {0, 0, true},
                                {0, 0, true}};

static bool is_in_range(int component, float value) {
  const double low = ranges[component].low, high = ranges[component].high;
  if (component == 14) return value == 0.5f || value == 1 || value == 2;
  return value >= low && value <= high && (!ranges[component].is_whole || (double)value == floor((double)value));
}

static void test_parameters(void **state) {
  (void)state;
  Fixture *fixture = make_small();
  for (int i = 0; i < 4 * STY_PARAM_ROWS * 3; i++) { /* every component of every style */
    const int c = i % (4 * STY_PARAM_ROWS), style = 1 + i / (4 * STY_PARAM_ROWS);
    const float low = (float)ranges[c].low, high = (float)ranges[c].high;
    const float values[] = {NAN,     INFINITY,    -INFINITY, -1,   -1e-9f,
                            low - 1, high + 1,    high * 2,  0.5f, 1.5f,
                            0.75f,   high + 0.5f, low,       high, nextafterf(high, INFINITY)};
    unsigned char *at = fixture->texels[STY_BUNDLE_PARAMS] + 16 * (c / 4 * 3 + style - 1) + 4 * (c % 4), kept[4];
    memcpy(kept, at, 4);
    for (size_t k = 0; k < sizeof values / sizeof *values; k++) {
      const bool is_fine = is_in_range(c, values[k]);
      StyStyle read;
      put_float(at, values[k]);
      const StyRuntimeStatus found = sty_get_style(&fixture->bundle, style, &read);
      if (found != (is_fine ? STY_RUNTIME_OK : STY_RUNTIME_BAD_PARAMETER))
        fail_msg("component %d of style %d = %g: found %d", c, style, (double)values[k], found);
      if (is_fine)
        open_fixture(fixture);
      else
        expect_refusal(fixture, STY_RUNTIME_BAD_PARAMETER, STY_BUNDLE_PARAMS);
    }
    memcpy(at, kept, 4);
  }
  destroy_fixture(fixture);
}

/* Lightings and their bases must be among the layers. */
static void test_layers_that_are_not_there(void **state) {
  (void)state;
  static const struct {
    int layer, count;
    unsigned flags;
    bool is_fine;
  } cases[] = {{0, 4, 0, true},
               {1, 3, 0, true},
               {1, 4, 0, false},
               {4, 1, 0, false},
               {3, 1, 0, true},
               {0, 2, STY_FLAG_BASE, true},
               {0, 3, STY_FLAG_BASE, false},
               {1, 2, STY_FLAG_BASE, false},
               {2, 1, STY_FLAG_BASE, true},
               {3, 1, STY_FLAG_BASE, false}};
  Fixture *fixture = make_fixture(1, 1, 1, 1, 4, 1);
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    StyStyle read;
    write_style(
        fixture, 1,
        &(StyStyle){.layer = cases[i].layer, .layer_count = cases[i].count, .scale = 1, .flags = cases[i].flags});
    fixture->bundle.textures[STY_BUNDLE_PARAMS] = (StyTexture){fixture->texels[STY_BUNDLE_PARAMS], 1, 5, 1, 16};
    fixture->bundle.textures[STY_BUNDLE_EXEMPLARS].layers = 4;
    assert_int_equal(sty_get_style(&fixture->bundle, 1, &read),
                     cases[i].is_fine ? STY_RUNTIME_OK : STY_RUNTIME_BAD_PARAMETER);
  }
  destroy_fixture(fixture);
}

static void test_styles(void **state) {
  (void)state;
  uint64_t random = 10;
  Fixture *fixture = make_fixture(1, 1, 1, STY_MAX_STYLES, 9, 1);
  for (int style = 1; style <= STY_MAX_STYLES; style++) {
    const StyStyle values = {.threshold = draw_below(&random, STY_MAX_THRESHOLD + 1),
                             .top_level = draw_below(&random, STY_MAX_LEVEL + 1),
                             .radius = draw_below(&random, STY_MAX_RADIUS + 1),
                             .depth_tolerance = fabsf(draw_signed(&random)),
                             .luma_weight = (float)draw_below(&random, 17),
                             .colour_weight = (float)draw_below(&random, 9) / 8,
                             .layer = draw_below(&random, 6),
                             .layer_count = 1 + draw_below(&random, 4),
                             .luma = {0, 0.25f, (float)draw_below(&random, 9) / 8, 1},
                             .jitter_amount = (float)draw_below(&random, 9) / 8,
                             .jitter_period = draw_below(&random, STY_MAX_PERIOD + 1),
                             .scale = (float)(1 << draw_below(&random, 3)) / 2,
                             .flags = (unsigned)draw_below(&random, 4),
                             .scatter = draw_below(&random, STY_MAX_SCATTER + 1)};
    write_style(fixture, style, &values);
  }
  open_fixture(fixture);
  StyStyle found;
  for (int style = 1; style <= STY_MAX_STYLES; style++) {
    const StyStyle *wanted = &fixture->style[style];
    assert_int_equal(sty_get_style(&fixture->bundle, style, &found), STY_RUNTIME_OK);
    assert_true(found.threshold == wanted->threshold && found.top_level == wanted->top_level);
    assert_true(found.radius == wanted->radius && found.depth_tolerance == wanted->depth_tolerance);
    assert_true(found.luma_weight == wanted->luma_weight && found.colour_weight == wanted->colour_weight);
    assert_true(found.layer == wanted->layer && found.layer_count == wanted->layer_count);
    assert_memory_equal(found.luma, wanted->luma, sizeof found.luma);
    assert_true(found.jitter_amount == wanted->jitter_amount && found.jitter_period == wanted->jitter_period);
    assert_true(found.scale == wanted->scale && found.flags == wanted->flags && found.scatter == wanted->scatter);
  }
  static const int numbers[] = {0, -1, INT32_MIN, STY_MAX_STYLES + 1, INT32_MAX};
  for (int i = 0; i < 5; i++)
    assert_int_equal(sty_get_style(&fixture->bundle, numbers[i], &found), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_get_style(NULL, 1, &found), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_get_style(&fixture->bundle, 1, NULL), STY_RUNTIME_BAD_ARGUMENT);
  destroy_fixture(fixture);
}

/* Encoded and decoded is the same style, to the bit, whatever it says; what lies in rows comes back, too. */
static void test_encoded_styles(void **state) {
  (void)state;
  uint64_t random = 11;
  Fixture *fixture = make_fixture(1, 1, 1, 1, 8, 1);
  const Guides how = {0, 100, 0};
  for (int round = 0; round < 500; round++) {
    const StyStyle style = draw_style(&random, &how, fixture);
    float rows[STY_PARAM_ROWS][4], again[STY_PARAM_ROWS][4];
    StyStyle found;
    memset(rows, 0xFF, sizeof rows);
    sty_encode_style(&style, rows);
    write_style(fixture, 1, &style);
    for (int i = 0; i < 4 * STY_PARAM_ROWS; i++) {
      unsigned char bytes[4];
      put_float(bytes, rows[i / 4][i % 4]);
      assert_memory_equal(bytes, fixture->texels[STY_BUNDLE_PARAMS] + 4 * i, 4);
    }
    assert_int_equal(sty_decode_style((const float(*)[4])rows, 8, &found), STY_RUNTIME_OK);
    sty_encode_style(&found, again);
    assert_memory_equal(rows, again, sizeof rows);
    assert_memory_equal(&found, &style, sizeof found);
    const int layers = style.layer + style.layer_count * (style.flags & STY_FLAG_BASE ? 2 : 1);
    StyStyle left = {.threshold = 77};
    assert_int_equal(sty_decode_style((const float(*)[4])rows, (uint32_t)layers, &found), STY_RUNTIME_OK);
    assert_int_equal(sty_decode_style((const float(*)[4])rows, (uint32_t)layers - 1, &left), STY_RUNTIME_BAD_PARAMETER);
    assert_int_equal(left.threshold, 77);
    assert_int_equal(sty_decode_style(NULL, 8, &found), STY_RUNTIME_BAD_ARGUMENT);
    assert_int_equal(sty_decode_style((const float(*)[4])rows, 8, NULL), STY_RUNTIME_BAD_ARGUMENT);
  }
  destroy_fixture(fixture);
}

/* Structures that change without a new number would break programs in silence: raise STY_RUNTIME_ABI with these. */
static void test_interface_number(void **state) {
  (void)state;
  assert_int_equal(sty_get_runtime_abi(), STY_RUNTIME_ABI);
  assert_int_equal(STY_RUNTIME_ABI, 1);
  if (sizeof(void *) != 8) return;
  assert_int_equal(sizeof(StyBlob), 16);
  assert_int_equal(sizeof(StyTexture), 24);
  assert_int_equal(sizeof(StyBundle), 120);
  assert_int_equal(sizeof(StyStyle), 68);
  assert_int_equal(sizeof(StyFrame), 112);
  assert_int_equal(offsetof(StyFrame, path), 108);
  assert_int_equal(sizeof(StyRect), 16);
  assert_int_equal(sizeof(StyMatch), 8);
  assert_int_equal(sizeof(StySeeds), 32);
  assert_int_equal(STY_BUNDLE_FILES * 1000 + STY_PARAM_ROWS, 5005);
}

static void test_bad_arguments(void **state) {
  (void)state;
  Fixture *fixture = make_small();
  StyBundle bundle;
  StyTexture texture;
  const StyBlob good = fixture->files[0];
  assert_int_equal(sty_open_bundle(NULL, &bundle, NULL), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_open_bundle(fixture->files, NULL, NULL), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_open_texture(good, layouts[0].vk, NULL), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_open_texture(good, 0, &texture), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_open_texture((StyBlob){NULL, 0}, layouts[0].vk, &texture), STY_RUNTIME_BAD_ARGUMENT);
  StyBlob files[STY_BUNDLE_FILES];
  memcpy(files, fixture->files, sizeof files);
  files[STY_BUNDLE_LUTS].data = NULL;
  int culprit = -1;
  assert_int_equal(sty_open_bundle(files, &bundle, &culprit), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(culprit, STY_BUNDLE_LUTS);
  destroy_fixture(fixture);
}

static void test_descriptions(void **state) {
  (void)state;
  for (int a = STY_RUNTIME_OK; a <= STY_RUNTIME_BAD_PARAMETER + 1; a++) {
    const char *text = sty_describe_runtime_status((StyRuntimeStatus)a);
    assert_true(text && *text && !strchr(text, '\n'));
    for (int b = STY_RUNTIME_OK; b < a; b++)
      assert_string_not_equal(text, sty_describe_runtime_status((StyRuntimeStatus)b));
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_textures_of_a_good_bundle),
                                     cmocka_unit_test(test_any_alignment),
                                     cmocka_unit_test(test_truncated_files),
                                     cmocka_unit_test(test_changed_bytes),
                                     cmocka_unit_test(test_headers),
                                     cmocka_unit_test(test_levels_without_texels),
                                     cmocka_unit_test(test_products_that_wrap),
                                     cmocka_unit_test(test_orientation),
                                     cmocka_unit_test(test_files_that_do_not_belong),
                                     cmocka_unit_test(test_parameters),
                                     cmocka_unit_test(test_layers_that_are_not_there),
                                     cmocka_unit_test(test_styles),
                                     cmocka_unit_test(test_encoded_styles),
                                     cmocka_unit_test(test_interface_number),
                                     cmocka_unit_test(test_bad_arguments),
                                     cmocka_unit_test(test_descriptions)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
