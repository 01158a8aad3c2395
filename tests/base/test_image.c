#include <math.h>

#include "../scratch.h"

static const char *const RGBA[] = {"R", "G", "B", "A"};

static void test_new_image(void **state) {
  (void)state;
  static const int bits[] = {8, 16, 32};
  for (int b = 0; b < 3; b++) {
    const char *names[] = {"normal.X", "A", "z"};
    StyImage *image = NULL;
    assert_int_equal(sty_create_image(5, 3, 3, names, bits[b], &image, NULL), STY_OK);
    assert_int_equal(image->width, 5);
    assert_int_equal(image->height, 3);
    assert_int_equal(image->channel_count, 3);
    assert_int_equal(image->bits, bits[b]);
    assert_int_equal(sty_count_pixels(image), 15);
    assert_int_equal(image->attribute_count, 0);
    for (int c = 0; c < 3; c++) {
      assert_string_equal(image->names[c], names[c]);
      assert_ptr_equal(sty_find_channel(image, names[c]), image->data + 15 * c);
    }
    for (int i = 0; i < 45; i++) assert_true(image->data[i] == 0 && !signbit(image->data[i]));
    assert_null(sty_find_channel(image, "a"));
    assert_null(sty_find_channel(image, "normal"));
    assert_null(sty_find_channel(image, ""));
    sty_destroy_image(&image);
    assert_null(image);
    sty_destroy_image(&image);
  }
  sty_destroy_image(NULL);
}

static void test_limits(void **state) {
  (void)state;
  static const int sizes[][2] = {{0, 1},
                                 {1, 0},
                                 {-1, 1},
                                 {1, -5},
                                 {STY_MAX_SIDE + 1, 1},
                                 {1, STY_MAX_SIDE + 1},
                                 {16385, 16384},
                                 {STY_MAX_SIDE, STY_MAX_SIDE},
                                 {INT32_MAX, INT32_MAX},
                                 {INT32_MIN, INT32_MIN}};
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
    StyImage *image = NULL;
    StyError error = {STY_OK, ""};
    expect_message(sty_create_image(sizes[i][0], sizes[i][1], 4, RGBA, 8, &image, &error), STY_ERROR_INPUT, &error,
                   PARTS(""));
    assert_null(image);
  }
  StyImage *image = NULL;
  assert_int_equal(sty_create_image(STY_MAX_SIDE, 1, 1, RGBA, 8, &image, NULL), STY_OK);
  sty_destroy_image(&image);
  assert_int_equal(sty_create_image(1, STY_MAX_SIDE, 1, RGBA, 8, &image, NULL), STY_OK);
  sty_destroy_image(&image);
  assert_int_equal(sty_create_image(1, 1, 0, RGBA, 8, &image, NULL), STY_ERROR_INPUT);
  assert_int_equal(sty_create_image(1, 1, -1, RGBA, 8, &image, NULL), STY_ERROR_INPUT);
  const char *many[STY_MAX_CHANNELS + 1];
  for (int i = 0; i <= STY_MAX_CHANNELS; i++) many[i] = "n";
  assert_int_equal(sty_create_image(1, 1, STY_MAX_CHANNELS + 1, many, 8, &image, NULL), STY_ERROR_INPUT);
  assert_null(image);
}

static void test_long_names(void **state) {
  (void)state;
  char name[STY_MAX_NAME + 8];
  memset(name, 'n', sizeof name);
  name[STY_MAX_NAME - 1] = 0;
  const char *names[] = {name};
  StyImage *image = NULL;
  assert_int_equal(sty_create_image(2, 2, 1, names, 32, &image, NULL), STY_OK);
  assert_string_equal(image->names[0], name);
  assert_non_null(sty_find_channel(image, name));
  sty_destroy_image(&image);
  /* One byte more doesn't fit: refused or cut, but never past the end. */
  name[STY_MAX_NAME - 1] = 'n';
  name[STY_MAX_NAME] = 0;
  if (sty_create_image(2, 2, 1, names, 32, &image, NULL) == STY_OK) {
    assert_true(strlen(image->names[0]) < STY_MAX_NAME);
    sty_destroy_image(&image);
  }
}

static void test_attributes(void **state) {
  (void)state;
  StyImage *image = NULL;
  assert_int_equal(sty_create_image(1, 1, 1, RGBA, 8, &image, NULL), STY_OK);
  assert_null(sty_find_attribute(image, "stylut:seed"));
  char name[64] = "stylut:seed", value[64] = "7";
  assert_int_equal(sty_set_attribute(image, name, value, NULL), STY_OK);
  strcpy(name, "overwritten"); /* both are copied */
  strcpy(value, "overwritten");
  assert_string_equal(sty_find_attribute(image, "stylut:seed"), "7");
  assert_int_equal(sty_set_attribute(image, "stylut:seed", "a longer value than before", NULL), STY_OK);
  assert_string_equal(sty_find_attribute(image, "stylut:seed"), "a longer value than before");
  assert_int_equal(image->attribute_count, 1);
  for (int i = 0; i < 100; i++) {
    snprintf(name, sizeof name, "stylut:key%d", i);
    snprintf(value, sizeof value, "value %d", i * i);
    assert_int_equal(sty_set_attribute(image, name, value, NULL), STY_OK);
  }
  assert_int_equal(image->attribute_count, 101);
  for (int i = 0; i < 100; i++) {
    snprintf(name, sizeof name, "stylut:key%d", i);
    snprintf(value, sizeof value, "value %d", i * i);
    assert_string_equal(sty_find_attribute(image, name), value);
  }
  /* A value may be handed back to its own attribute. */
  assert_int_equal(sty_set_attribute(image, "stylut:key5", sty_find_attribute(image, "stylut:key5"), NULL), STY_OK);
  assert_string_equal(sty_find_attribute(image, "stylut:key5"), "value 25");
  assert_int_equal(sty_set_attribute(image, "stylut:empty", "", NULL), STY_OK);
  assert_string_equal(sty_find_attribute(image, "stylut:empty"), "");
  sty_destroy_image(&image);
}

static void test_rgba8_of_bytes(void **state) {
  (void)state;
  for (int count = 1; count <= 4; count++) {
    StyImage *image = NULL;
    assert_int_equal(sty_create_image(256, 1, count, RGBA, 8, &image, NULL), STY_OK);
    for (int c = 0; c < count; c++)
      for (int i = 0; i < 256; i++) image->data[256 * c + i] = (float)((i + 50 * c) % 256) / 255.0f;
    uint8_t out[1024];
    assert_int_equal(sty_convert_to_rgba8("a.png", image, out, NULL), STY_OK);
    for (int i = 0; i < 256; i++) {
      const int second = (i + 50) % 256, third = (i + 100) % 256, fourth = (i + 150) % 256;
      assert_int_equal(out[4 * i + 0], i);
      assert_int_equal(out[4 * i + 1], count < 3 ? i : second);
      assert_int_equal(out[4 * i + 2], count < 3 ? i : third);
      assert_int_equal(out[4 * i + 3], count == 2 ? second : count == 4 ? fourth : 255);
    }
    sty_destroy_image(&image);
  }
}

static void test_rgba8_of_words(void **state) {
  (void)state;
  StyImage *image = NULL;
  assert_int_equal(sty_create_image(256, 256, 1, RGBA, 16, &image, NULL), STY_OK);
  for (int i = 0; i < 65536; i++) image->data[i] = (float)i / 65535.0f;
  uint8_t *out = malloc(4 * 65536);
  assert_non_null(out);
  assert_int_equal(sty_convert_to_rgba8("a.png", image, out, NULL), STY_OK);
  /* 65535 = 255 * 257, and no word lies halfway. */
  for (int i = 0; i < 65536; i++) assert_int_equal(out[4 * i], (i + 128) / 257);
  free(out);
  sty_destroy_image(&image);
}

static void test_rgba8_refusals(void **state) {
  (void)state;
  const char *names[] = {"R", "G", "B", "A", "Z"};
  uint8_t out[20];
  StyError error;
  StyImage *image = NULL;
  assert_int_equal(sty_create_image(1, 1, 3, names, 32, &image, NULL), STY_OK);
  expect_message(sty_convert_to_rgba8("float.exr", image, out, &error), STY_ERROR_INPUT, &error, PARTS("float.exr"));
  sty_destroy_image(&image);
  assert_int_equal(sty_create_image(1, 1, 5, names, 8, &image, NULL), STY_OK);
  expect_message(sty_convert_to_rgba8("five.png", image, out, &error), STY_ERROR_INPUT, &error, PARTS("five.png", "5"));
  sty_destroy_image(&image);
}

static void test_coordinates(void **state) {
  (void)state;
  /* 16 bit is exact for every source side that a bundle may have. */
  static const uint32_t sides[] = {1,   2,    3,    5,    17,   100,   254,   255,   256,   257,  511,
                                   512, 1000, 1023, 4096, 5000, 16384, 32768, 65534, 65535, 65536};
  for (size_t s = 0; s < sizeof sides / sizeof *sides; s++) {
    const uint32_t side = sides[s];
    for (uint32_t p = 0; p < side; p++) {
      const uint32_t word = sty_encode_coordinate(p, side, 65535), byte = sty_encode_coordinate(p, side, 255);
      assert_int_equal(word, ((2 * (uint64_t)p + 1) * 65535 + side - 1) / (2 * (uint64_t)side));
      assert_true(byte <= 255);
      assert_int_equal(sty_decode_coordinate(word, side, 65535), p);
      const int64_t back = sty_decode_coordinate(byte, side, 255), off = llabs(back - (int64_t)p);
      if (side <= 256) assert_int_equal(off, 0);
      /* A byte is a 255th of the side, half of it either way, and what rounding down adds. */
      assert_true(off <= (int64_t)(side / 510 + 1));
    }
    assert_int_equal(sty_decode_coordinate(0, side, 65535), 0);
    assert_int_equal(sty_decode_coordinate(65535, side, 65535), side - 1);
    assert_int_equal(sty_decode_coordinate(255, side, 255), side - 1);
  }
  /* The two roundings, for every word and a few sides: floor(v*W/M), at most W-1. */
  static const uint32_t few[] = {1, 3, 100, 512, 32767, 32768, 65536};
  for (size_t s = 0; s < sizeof few / sizeof *few; s++)
    for (uint64_t v = 0; v <= 65535; v++) {
      const uint64_t pixel = v * few[s] / 65535;
      assert_int_equal(sty_decode_coordinate((uint32_t)v, few[s], 65535), pixel < few[s] ? pixel : few[s] - 1);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_new_image),      cmocka_unit_test(test_limits),
      cmocka_unit_test(test_long_names),     cmocka_unit_test(test_attributes),
      cmocka_unit_test(test_rgba8_of_bytes), cmocka_unit_test(test_rgba8_of_words),
      cmocka_unit_test(test_rgba8_refusals), cmocka_unit_test(test_coordinates),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
