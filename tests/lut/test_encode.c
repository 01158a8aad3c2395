#include <math.h>

#include "../scratch.h"
#include "stylut/lut.h"

static const StyLutHints NO_HINTS = {0, 0, -1, STY_FOREIGN_NONE};

/* Random choices, so that every coordinate of the source occurs in a table of some size. */
static StyLut *make_table(int size, int sampling, int width, int height, uint64_t seed) {
  StyLut *lut = NULL;
  /* The other two are stored with any sampling alike; equal-area goes with centre only. */
  const StyMap map = sampling == STY_SAMPLE_CENTRE && seed % 2 ? STY_MAP_EQUAL_AREA : STY_MAP_XY;
  const StyLutSpec spec = {size, size, (StySampling)sampling, map, seed % 3 ? STY_METRIC_XY : STY_METRIC_ANGLE};
  assert_int_equal(sty_create_lut(&spec, width, height, &lut, NULL), STY_OK);
  for (int t = 0; t < size * size; t++) {
    lut->pixels[t] = (uint32_t)draw_below(&seed, height) * (uint32_t)width + (uint32_t)draw_below(&seed, width);
    lut->errors[t] = fabsf(draw_signed(&seed));
  }
  lut->pixels[0] = 0;
  lut->pixels[size * size - 1] = (uint32_t)width * (uint32_t)height - 1;
  return lut;
}

static void test_names(void **state) {
  (void)state;
  assert_string_equal(sty_encoding_names[STY_ENCODE_F32], "f32");
  assert_string_equal(sty_encoding_names[STY_ENCODE_RG16], "rg16");
  assert_string_equal(sty_encoding_names[STY_ENCODE_RG8X2], "rg8x2");
  assert_string_equal(sty_encoding_names[STY_ENCODE_RG8], "rg8");
  assert_null(sty_encoding_names[4]);
  assert_string_equal(sty_foreign_names[STY_FOREIGN_NONE], "stylut");
  assert_string_equal(sty_foreign_names[STY_FOREIGN_UNITY], "unity");
  assert_string_equal(sty_foreign_names[STY_FOREIGN_RG8], "rg8");
  assert_string_equal(sty_foreign_names[STY_FOREIGN_RG16], "rg16");
  assert_string_equal(sty_foreign_names[STY_FOREIGN_RG8X2], "rg8x2");
  assert_null(sty_foreign_names[5]);
}

/* What is stored, texel by texel, from the header's own words. */
static void expect_layout(const StyLut *lut, StyEncoding encoding, const StyImage *image) {
  const size_t plane = sty_count_pixels(image);
  assert_int_equal(image->width, lut->spec.width);
  assert_int_equal(image->height, lut->spec.height);
  assert_int_equal(image->bits, encoding == STY_ENCODE_F32 ? 32 : encoding == STY_ENCODE_RG16 ? 16 : 8);
  assert_int_equal(image->channel_count, encoding == STY_ENCODE_RG8X2 ? 4 : 3);
  for (size_t t = 0; t < plane; t++) {
    const double u = (lut->pixels[t] % (uint32_t)lut->source_width + 0.5) / lut->source_width;
    const double v = (lut->pixels[t] / (uint32_t)lut->source_width + 0.5) / lut->source_height;
    if (encoding == STY_ENCODE_F32) {
      assert_true(fabs(sty_find_channel(image, "u")[t] - u) < 1e-7);
      assert_true(fabs(sty_find_channel(image, "v")[t] - v) < 1e-7);
      assert_true(sty_find_channel(image, "error")[t] == lut->errors[t]);
      continue;
    }
    double stored[4] = {0};
    const double top = image->bits == 16 ? 65535 : 255;
    for (int c = 0; c < image->channel_count; c++) {
      stored[c] = image->data[plane * (size_t)c + t] * top;
      assert_true(fabs(stored[c] - round(stored[c])) < 0.01);
      stored[c] = round(stored[c]);
    }
    if (encoding == STY_ENCODE_RG8X2) {
      assert_true(stored[0] * 256 + stored[1] == ceil(u * 65535 - 0.5));
      assert_true(stored[2] * 256 + stored[3] == ceil(v * 65535 - 0.5));
    } else {
      assert_true(stored[0] == ceil(u * top - 0.5));
      assert_true(stored[1] == ceil(v * top - 0.5));
      assert_true(stored[2] == 0);
    }
  }
}

static void expect_spec(const StyLutSpec *found, const StyLutSpec *expected) {
  assert_int_equal(found->width, expected->width);
  assert_int_equal(found->height, expected->height);
  assert_int_equal(found->sampling, expected->sampling);
  assert_int_equal(found->map, expected->map);
  assert_int_equal(found->metric, expected->metric);
}

static void test_round_trips(void **state) {
  (void)state;
  static const int sources[][2] = {{1, 1},     {2, 3},     {100, 50},    {254, 254}, {255, 255},
                                   {256, 300}, {512, 512}, {1920, 1080}, {16384, 7}};
  static const int sizes[] = {2, 3, 64};
  for (size_t s = 0; s < sizeof sources / sizeof *sources; s++) {
    for (int z = 0; z < 3; z++) {
      for (int e = 0; e < 4; e++) {
        const int width = sources[s][0], height = sources[s][1], sampling = (int)(s + (size_t)z) % 3;
        StyLut *lut = make_table(sizes[z], sampling, width, height, s * 10 + (size_t)z), *back = NULL;
        StyImage *image = NULL;
        StyError error = {STY_OK, ""};
        assert_int_equal(sty_encode_lut(lut, (StyEncoding)e, &image, NULL), STY_OK);
        expect_layout(lut, (StyEncoding)e, image);
        if (sty_decode_lut("lut.png", image, &NO_HINTS, &back, &error) != STY_OK)
          fail_msg("%s, source %dx%d: %s", sty_encoding_names[e], width, height, error.text);
        expect_spec(&back->spec, &lut->spec);
        assert_int_equal(back->source_width, width);
        assert_int_equal(back->source_height, height);
        const int exact_x = e != STY_ENCODE_RG8 || width <= 256, exact_y = e != STY_ENCODE_RG8 || height <= 256;
        for (size_t t = 0; t < sty_count_texels(&lut->spec); t++) {
          const int dx = abs((int)(back->pixels[t] % (uint32_t)width) - (int)(lut->pixels[t] % (uint32_t)width));
          const int dy = abs((int)(back->pixels[t] / (uint32_t)width) - (int)(lut->pixels[t] / (uint32_t)width));
          assert_true(dx <= (exact_x ? 0 : width / 510 + 1));
          assert_true(dy <= (exact_y ? 0 : height / 510 + 1));
          assert_true(back->errors[t] == (e == STY_ENCODE_F32 ? lut->errors[t] : 0));
        }
        sty_destroy_lut(&back);
        sty_destroy_image(&image);
        sty_destroy_lut(&lut);
      }
    }
  }
}

/* ---- tables of other tools ------------------------------------------------------ */

static StyImage *make_picture(int width, int height, int count, const char *const *names, int bits) {
  StyImage *image = NULL;
  assert_int_equal(sty_create_image(width, height, count, names, bits, &image, NULL), STY_OK);
  return image;
}

static const char *const RGB[] = {"R", "G", "B"};

static void test_foreign_words(void **state) {
  (void)state;
  for (int count = 2; count <= 4; count++) {
    static const char *const names[] = {"R", "G", "B", "A"};
    if (count == 2) continue; /* grey and alpha to every reader of pictures */
    StyImage *image = make_picture(2, 2, count, names, 16);
    static const int words[4][2] = {{0, 65535}, {32768, 100}, {655, 656}, {65535, 0}};
    for (int t = 0; t < 4; t++)
      for (int c = 0; c < 2; c++) image->data[4 * c + t] = (float)words[t][c] / 65535.0f;
    StyLut *lut = NULL;
    StyError error = {STY_OK, ""};
    expect_message(sty_decode_lut("old.png", image, &NO_HINTS, &lut, &error), STY_ERROR_INPUT, &error,
                   PARTS("old.png"));
    assert_null(lut);
    for (int sampling = -1; sampling < 3; sampling++) {
      const StyLutHints hints = {100, 200, sampling, STY_FOREIGN_NONE};
      assert_int_equal(sty_decode_lut("old.png", image, &hints, &lut, &error), STY_OK);
      assert_int_equal(lut->spec.width, 2);
      assert_int_equal(lut->spec.height, 2);
      assert_int_equal(lut->spec.map, STY_MAP_XY);
      assert_int_equal(lut->spec.metric, STY_METRIC_XY);
      assert_int_equal(lut->source_width, 100);
      assert_int_equal(lut->source_height, 200);
      assert_int_equal(lut->spec.sampling, sampling < 0 ? STY_SAMPLE_CENTRE : sampling);
      for (int t = 0; t < 4; t++) {
        const int x = words[t][0] * 100 / 65535, y = words[t][1] * 200 / 65535;
        assert_int_equal(lut->pixels[t], (y < 200 ? y : 199) * 100 + (x < 100 ? x : 99));
      }
      sty_destroy_lut(&lut);
    }
    sty_destroy_image(&image);
  }
}

static void test_foreign_floats(void **state) {
  (void)state;
  static const char *const names[] = {"v", "other", "u"};
  StyImage *image = make_picture(3, 3, 3, names, 32);
  float *u = sty_find_channel(image, "u"), *v = sty_find_channel(image, "v");
  for (int t = 0; t < 9; t++) u[t] = ((float)t + 0.5f) / 10, v[t] = ((float)(8 - t) + 0.5f) / 20;
  const StyLutHints hints = {10, 20, -1, STY_FOREIGN_NONE};
  StyLut *lut = NULL;
  StyError error = {STY_OK, ""};
  assert_int_equal(sty_decode_lut("old.exr", image, &hints, &lut, &error), STY_OK);
  for (int t = 0; t < 9; t++) {
    assert_int_equal(lut->pixels[t], (8 - t) * 10 + t);
    assert_true(lut->errors[t] == 0);
  }
  sty_destroy_lut(&lut);

  /* u = 1 is the far border of the last pixel; anything beyond isn't a coordinate. */
  u[5] = 1;
  v[5] = 0;
  assert_int_equal(sty_decode_lut("old.exr", image, &hints, &lut, &error), STY_OK);
  assert_int_equal(lut->pixels[5], 9);
  sty_destroy_lut(&lut);
  static const float bad[] = {NAN, INFINITY, -INFINITY, -0.01f, 1.01f, 1e30f, -1e30f};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    for (int c = 0; c < 2; c++) {
      float *const texel = &(c ? v : u)[7]; /* (1, 2) */
      const float before = *texel;
      *texel = bad[i];
      expect_message(sty_decode_lut("old.exr", image, &hints, &lut, &error), STY_ERROR_INPUT, &error,
                     PARTS("old.exr", "1", "2"));
      assert_null(lut);
      *texel = before;
    }
  }
  sty_destroy_image(&image);

  static const char *const half[] = {"u", "w"};
  image = make_picture(3, 3, 2, half, 32);
  expect_message(sty_decode_lut("old.exr", image, &hints, &lut, &error), STY_ERROR_INPUT, &error, PARTS("old.exr"));
  assert_null(lut);
  sty_destroy_image(&image);
}

/* ---- tables that are said to be another tool's ------------------------------------- */

/* StyleBlitUnity's are bytes with v from the bottom; what they answer for is the texel's lower left corner. */
static void test_unity(void **state) {
  (void)state;
  StyImage *image = make_picture(3, 2, 3, RGB, 8);
  static const int bytes[6][2] = {{0, 0}, {255, 255}, {128, 0}, {0, 128}, {77, 33}, {254, 1}};
  for (int t = 0; t < 6; t++)
    for (int c = 0; c < 2; c++) image->data[6 * c + t] = (float)bytes[t][c] / 255.0f;
  const StyLutHints hints = {100, 50, -1, STY_FOREIGN_UNITY}, nothing = {0, 0, -1, STY_FOREIGN_UNITY};
  StyLut *lut = NULL;
  StyError error = {STY_OK, ""};
  assert_int_equal(sty_decode_lut("old.png", image, &hints, &lut, &error), STY_OK);
  expect_spec(&lut->spec, &(StyLutSpec){3, 2, STY_SAMPLE_CORNER, STY_MAP_XY, STY_METRIC_XY});
  for (int t = 0; t < 6; t++) {
    const int x = bytes[t][0] * 100 / 255, up = bytes[t][1] * 50 / 255;
    assert_int_equal(lut->pixels[t], (49 - (up < 50 ? up : 49)) * 100 + (x < 100 ? x : 99));
    assert_true(lut->errors[t] == 0);
  }
  sty_destroy_lut(&lut);
  /* The source's size is to be had from nowhere else. */
  expect_message(sty_decode_lut("old.png", image, &nothing, &lut, &error), STY_ERROR_INPUT, &error, PARTS("old.png"));
  assert_null(lut);
  sty_destroy_image(&image);
}

/* A hint overrules what the file says, or doesn't say, of its encoding; squares are asked for. */
static void test_foreign_encodings(void **state) {
  (void)state;
  static const StyEncoding encodings[] = {STY_ENCODE_RG8, STY_ENCODE_RG16, STY_ENCODE_RG8X2};
  static const StyForeign foreigns[] = {STY_FOREIGN_RG8, STY_FOREIGN_RG16, STY_FOREIGN_RG8X2};
  for (int e = 0; e < 3; e++) {
    StyLut *lut = make_table(8, STY_SAMPLE_CENTRE, 60, 70, 7), *back = NULL;
    StyImage *image = NULL;
    StyError error = {STY_OK, ""};
    assert_int_equal(sty_encode_lut(lut, encodings[e], &image, NULL), STY_OK);
    assert_int_equal(sty_set_attribute(image, "stylut:encoding", e ? "rg8" : "rg16", NULL), STY_OK);
    const StyLutHints hints = {60, 70, -1, foreigns[e]};
    if (sty_decode_lut("t.png", image, &hints, &back, &error) != STY_OK) fail_msg("%s", error.text);
    assert_memory_equal(back->pixels, lut->pixels, 64 * sizeof *lut->pixels);
    sty_destroy_lut(&back);
    sty_destroy_image(&image);
    sty_destroy_lut(&lut);
    image = make_picture(4, 3, 4, (const char *const[]){"R", "G", "B", "A"}, e == 1 ? 16 : 8);
    expect_message(sty_decode_lut("wide.png", image, &hints, &back, &error), STY_ERROR_INPUT, &error,
                   PARTS("wide.png", "4", "3"));
    assert_null(back);
    sty_destroy_image(&image);
    /* Words aren't bytes. */
    image = make_picture(4, 4, 4, (const char *const[]){"R", "G", "B", "A"}, e == 1 ? 8 : 16);
    expect_message(sty_decode_lut("deep.png", image, &hints, &back, &error), STY_ERROR_INPUT, &error,
                   PARTS("deep.png"));
    assert_null(back);
    sty_destroy_image(&image);
  }
}

/* The texel is found among many, and named by column and row. */
static void test_bad_texel_is_named(void **state) {
  (void)state;
  StyLut *lut = make_table(64, STY_SAMPLE_CENTRE, 100, 100, 3), *back = NULL;
  StyImage *image = NULL;
  assert_int_equal(sty_encode_lut(lut, STY_ENCODE_F32, &image, NULL), STY_OK);
  float *u = sty_find_channel(image, "u");
  u[64 * 47 + 23] = NAN;
  u[64 * 48 + 1] = NAN;
  StyError error = {STY_OK, ""};
  expect_message(sty_decode_lut("table.exr", image, &NO_HINTS, &back, &error), STY_ERROR_INPUT, &error,
                 PARTS("table.exr", "23", "47"));
  assert_null(back);
  sty_destroy_image(&image);
  sty_destroy_lut(&lut);
}

static void test_shapes(void **state) {
  (void)state;
  const StyLutHints hints = {10, 20, -1, STY_FOREIGN_NONE};
  StyLut *lut = NULL;
  StyError error = {STY_OK, ""};
  StyImage *image = make_picture(31, 17, 3, RGB, 16);
  expect_message(sty_decode_lut("wide.png", image, &hints, &lut, &error), STY_ERROR_INPUT, &error,
                 PARTS("wide.png", "31", "17"));
  sty_destroy_image(&image);
  image = make_picture(4, 4, 1, RGB, 16);
  expect_message(sty_decode_lut("grey.png", image, &hints, &lut, &error), STY_ERROR_INPUT, &error, PARTS("grey.png"));
  sty_destroy_image(&image);
  image = make_picture(STY_MAX_LUT_SIZE + 1, STY_MAX_LUT_SIZE + 1, 2, RGB, 16);
  assert_int_not_equal(sty_decode_lut("huge.png", image, &hints, &lut, &error), STY_OK);
  sty_destroy_image(&image);
  assert_null(lut);
}

/* A table that says another source size than the one at hand: the message names both. */
static void test_source_sizes(void **state) {
  (void)state;
  StyLut *lut = make_table(8, STY_SAMPLE_UNORM8, 123, 77, 5), *back = NULL;
  for (int e = 0; e < 4; e++) {
    StyImage *image = NULL;
    StyError error = {STY_OK, ""};
    assert_int_equal(sty_encode_lut(lut, (StyEncoding)e, &image, NULL), STY_OK);
    const StyLutHints agreeing = {123, 77, STY_SAMPLE_UNORM8, STY_FOREIGN_NONE},
                      other = {124, 77, -1, STY_FOREIGN_NONE}, other_height = {123, 78, -1, STY_FOREIGN_NONE},
                      other_sampling = {123, 77, STY_SAMPLE_CENTRE, STY_FOREIGN_NONE};
    assert_int_equal(sty_decode_lut("t", image, &agreeing, &back, &error), STY_OK);
    sty_destroy_lut(&back);
    expect_message(sty_decode_lut("table.png", image, &other, &back, &error), STY_ERROR_INPUT, &error,
                   PARTS("table.png", "123", "77", "124"));
    expect_message(sty_decode_lut("table.png", image, &other_height, &back, &error), STY_ERROR_INPUT, &error,
                   PARTS("table.png", "123", "77", "78"));
    expect_message(sty_decode_lut("table.png", image, &other_sampling, &back, &error), STY_ERROR_INPUT, &error,
                   PARTS("table.png", "unorm8", "centre"));
    assert_null(back);
    sty_destroy_image(&image);
  }
  sty_destroy_lut(&lut);
}

/* Attributes come from files: whatever they hold, nothing is read past an end. */
static void test_mangled_attributes(void **state) {
  (void)state;
  static const char *const values[] = {"",     "x",      "-1",         "0",          "99999999999999999999",
                                       "nan",  "rg8x2",  "f32",        "unorm8 ",    "65537",
                                       "1e3",  "12x34",  "0x0",        "4294967297", "rg8",
                                       "rg16", "corner", "equal-area", "xy",         "angle"};
  const StyLutHints hints = {123, 77, -1, STY_FOREIGN_NONE};
  int refused = 0;
  for (int e = 0; e < 4; e++) {
    StyLut *lut = make_table(8, STY_SAMPLE_UNORM8, 123, 77, 5);
    StyImage *image = NULL;
    assert_int_equal(sty_encode_lut(lut, (StyEncoding)e, &image, NULL), STY_OK);
    assert_true(image->attribute_count > 0);
    for (int a = 0; a < image->attribute_count; a++) {
      char *const before = image->attributes[a].value;
      for (size_t v = 0; v < sizeof values / sizeof *values; v++) {
        image->attributes[a].value = (char *)(uintptr_t)values[v];
        StyLut *back = NULL;
        StyError error = {STY_OK, ""};
        const StyStatus status = sty_decode_lut("t.png", image, v % 2 ? &hints : &NO_HINTS, &back, &error);
        if (status == STY_OK) {
          for (size_t t = 0; t < sty_count_texels(&back->spec); t++)
            assert_true(back->pixels[t] < (uint32_t)back->source_width * (uint32_t)back->source_height);
        } else {
          expect_message(status, STY_ERROR_INPUT, &error, PARTS("t.png"));
          assert_null(back);
          refused++;
        }
        sty_destroy_lut(&back);
      }
      image->attributes[a].value = before;
    }
    sty_destroy_image(&image);
    sty_destroy_lut(&lut);
  }
  assert_true(refused > 50);
}

/* ---- cubes ----------------------------------------------------------------------- */

static StyLut *make_cube(int size, int width, int height, uint64_t seed) {
  static const StyFeature axes[] = {{"normal.X", 1}, {"normal.Y", 0.3f}, {"luma.Y", 12.5f}};
  StyLut *lut = NULL;
  assert_int_equal(sty_create_cube(size, axes, width, height, &lut, NULL), STY_OK);
  for (int t = 0; t < size * size * size; t++) {
    lut->pixels[t] = (uint32_t)draw_below(&seed, width * height);
    lut->errors[t] = fabsf(draw_signed(&seed));
  }
  return lut;
}

static void test_cubes(void **state) {
  (void)state;
  static const int sizes[] = {1, 2, 7, 20};
  for (int z = 0; z < 4; z++)
    for (int e = 0; e < 4; e++) {
      StyLut *lut = make_cube(sizes[z], 50, 33, (uint64_t)z), *back = NULL;
      StyImage *image = NULL;
      StyError error = {STY_OK, ""};
      assert_int_equal(sty_encode_lut(lut, (StyEncoding)e, &image, NULL), STY_OK);
      expect_layout(lut, (StyEncoding)e, image);
      if (sty_decode_lut("cube", image, &NO_HINTS, &back, &error)) fail_msg("%s", error.text);
      expect_spec(&back->spec, &lut->spec);
      assert_int_equal(back->depth, sizes[z]);
      assert_memory_equal(back->axes, lut->axes, sizeof lut->axes);
      assert_memory_equal(back->pixels, lut->pixels, sty_count_texels(&lut->spec) * sizeof *lut->pixels);
      if (e == STY_ENCODE_F32)
        assert_memory_equal(back->errors, lut->errors, sty_count_texels(&lut->spec) * sizeof *lut->errors);
      sty_destroy_lut(&back);
      sty_destroy_lut(&lut);
      sty_destroy_image(&image);
    }
}

/* One attribute wrong at a time. */
static void test_bad_cubes(void **state) {
  (void)state;
  static const char *const wrong[][3] = {
      {"stylut:depth", "0", "depth"},
      {"stylut:depth", "5", "depth"},
      {"stylut:depth", "4x", "depth"},
      {"stylut:depth", "257", "depth"},
      {"stylut:channels", "a,b", "channels"},
      {"stylut:channels", "a,b,c,d", "channels"},
      {"stylut:channels", "a,b,c:0", "channels"},
      {"stylut:sampling", "unorm8", "unorm8"},
      {"stylut:map", "equal-area", "equal-area"},
      {"stylut:metric", "angle", "angle"},
  };
  for (size_t w = 0; w < sizeof wrong / sizeof *wrong; w++) {
    StyLut *lut = make_cube(4, 9, 9, w), *back = NULL;
    StyImage *image = NULL;
    StyError error = {STY_OK, ""};
    assert_int_equal(sty_encode_lut(lut, STY_ENCODE_F32, &image, NULL), STY_OK);
    assert_int_equal(sty_set_attribute(image, wrong[w][0], wrong[w][1], NULL), STY_OK);
    expect_message(sty_decode_lut("bad-cube.exr", image, &NO_HINTS, &back, &error), STY_ERROR_INPUT, &error,
                   PARTS("bad-cube.exr", wrong[w][2]));
    assert_null(back);
    sty_destroy_lut(&lut);
    sty_destroy_image(&image);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_names),
      cmocka_unit_test(test_round_trips),
      cmocka_unit_test(test_foreign_words),
      cmocka_unit_test(test_foreign_floats),
      cmocka_unit_test(test_unity),
      cmocka_unit_test(test_foreign_encodings),
      cmocka_unit_test(test_bad_texel_is_named),
      cmocka_unit_test(test_shapes),
      cmocka_unit_test(test_source_sizes),
      cmocka_unit_test(test_mangled_attributes),
      cmocka_unit_test(test_cubes),
      cmocka_unit_test(test_bad_cubes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
