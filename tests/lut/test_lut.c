#include <math.h>

#include "../scratch.h"
#include "stylut/lut.h"

static const int SIZES[] = {1, 2, 3, 4, 5, 17, 64, 100, 255, 256, 257, 1000, 1024, 4096, STY_MAX_LUT_SIZE};
enum { SIZE_COUNT = sizeof SIZES / sizeof *SIZES };

/* Value and texel lookup need no more of a table than this. */
static StyLut describe(int size, StySampling sampling) { return (StyLut){.size = size, .sampling = sampling}; }

static int exists(int size, int sampling) { return size > 1 || sampling == STY_SAMPLE_CENTRE; }

static void test_new_table(void **state) {
  (void)state;
  StyLut *lut = NULL;
  assert_int_equal(sty_create_lut(7, STY_SAMPLE_UNORM8, 30, 20, &lut, NULL), STY_OK);
  assert_int_equal(lut->size, 7);
  assert_int_equal(lut->sampling, STY_SAMPLE_UNORM8);
  assert_int_equal(lut->source_width, 30);
  assert_int_equal(lut->source_height, 20);
  for (int i = 0; i < 49; i++) assert_true(lut->pixels[i] == 0 && lut->errors[i] == 0);
  sty_destroy_lut(&lut);
  assert_null(lut);
  sty_destroy_lut(&lut);
}

static void test_bad_sizes(void **state) {
  (void)state;
  static const int bad[] = {0, -1, STY_MAX_LUT_SIZE + 1, INT32_MAX, INT32_MIN};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    StyLut *lut = NULL;
    StyError error = {STY_OK, ""};
    assert_int_not_equal(sty_create_lut(bad[i], STY_SAMPLE_CENTRE, 4, 4, &lut, &error), STY_OK);
    assert_null(lut);
    assert_true(error.text[0] != 0);
  }
  /* Texels that answer for both ends of [-1, 1] need to be two. */
  StyLut *lut = NULL;
  assert_int_not_equal(sty_create_lut(1, STY_SAMPLE_UNORM8, 4, 4, &lut, NULL), STY_OK);
  assert_null(lut);
  assert_int_equal(sty_create_lut(1, STY_SAMPLE_CENTRE, 4, 4, &lut, NULL), STY_OK);
  sty_destroy_lut(&lut);
}

static void test_names(void **state) {
  (void)state;
  assert_string_equal(sty_sampling_names[STY_SAMPLE_CENTRE], "centre");
  assert_string_equal(sty_sampling_names[STY_SAMPLE_UNORM8], "unorm8");
  assert_null(sty_sampling_names[2]);
}

static void test_texel_values(void **state) {
  (void)state;
  for (int s = 0; s < SIZE_COUNT; s++) {
    const int size = SIZES[s];
    const StyLut centre = describe(size, STY_SAMPLE_CENTRE), unorm8 = describe(size, STY_SAMPLE_UNORM8);
    for (int i = 0; i < size; i++) {
      float g[2];
      sty_get_texel_value(&centre, i, size - 1 - i, g);
      /* The bottom row counted from below has the same value as the column. */
      assert_true(fabs(g[0] - ((i + 0.5) / size * 2 - 1)) < 1e-6);
      assert_true(fabs(g[1] - ((i + 0.5) / size * 2 - 1)) < 1e-6);
      if (size == 1) continue;
      sty_get_texel_value(&unorm8, i, size - 1 - i, g);
      assert_true(fabs(g[0] - ((double)i / (size - 1) * 2 - 1)) < 1e-6);
      assert_true(fabs(g[1] - ((double)i / (size - 1) * 2 - 1)) < 1e-6);
    }
  }
}

/* A 256-texel unorm8 table answers for what an 8-bit guide holds, to the bit: (2b-255)/255. */
static void test_byte_values(void **state) {
  (void)state;
  const StyLut lut = describe(256, STY_SAMPLE_UNORM8);
  for (int b = 0; b < 256; b++) {
    float g[2];
    sty_get_texel_value(&lut, b, 255 - b, g);
    assert_true(g[0] == (float)(2 * b - 255) / 255.0f);
    assert_true(g[1] == (float)(2 * b - 255) / 255.0f);
  }
}

static void test_there_and_back(void **state) {
  (void)state;
  for (int s = 0; s < SIZE_COUNT; s++) {
    for (int sampling = 0; sampling < 2; sampling++) {
      if (!exists(SIZES[s], sampling)) continue;
      const StyLut lut = describe(SIZES[s], (StySampling)sampling);
      const int size = lut.size, step = size > 300 ? 61 : 1; /* rows and columns are independent */
      for (int j = 0; j < size; j += step) {
        for (int i = 0; i < size; i++) {
          float g[2];
          int t[2] = {-1, -1};
          sty_get_texel_value(&lut, i, j, g);
          sty_find_texel(&lut, g, t);
          if (t[0] != i || t[1] != j)
            fail_msg("%d, sampling %d: (%d,%d) gives (%d,%d)", size, sampling, i, j, t[0], t[1]);
          float turned[2] = {g[1], g[0]};
          sty_find_texel(&lut, turned, t);
          if (t[0] != size - 1 - j || t[1] != size - 1 - i)
            fail_msg("%d, sampling %d: (%d,%d) turned gives (%d,%d)", size, sampling, i, j, t[0], t[1]);
        }
      }
    }
  }
}

/* The texel found is the one whose value is nearest, along either axis. */
static void test_nearest_texel(void **state) {
  (void)state;
  uint64_t random = 5;
  for (int s = 0; s < SIZE_COUNT; s++) {
    for (int sampling = 0; sampling < 2; sampling++) {
      if (!exists(SIZES[s], sampling)) continue;
      const StyLut lut = describe(SIZES[s], (StySampling)sampling);
      for (int trial = 0; trial < 2000; trial++) {
        const float g[2] = {draw_signed(&random), draw_signed(&random)};
        int t[2];
        sty_find_texel(&lut, g, t);
        assert_in_range(t[0], 0, lut.size - 1);
        assert_in_range(t[1], 0, lut.size - 1);
        float value[2];
        sty_get_texel_value(&lut, t[0], t[1], value);
        const double half = sampling == STY_SAMPLE_CENTRE ? 1.0 / lut.size : 1.0 / (lut.size - 1);
        assert_true(fabs(value[0] - g[0]) <= half + 1e-6);
        assert_true(fabs(value[1] - g[1]) <= half + 1e-6);
      }
    }
  }
}

static void test_clamping(void **state) {
  (void)state;
  static const float beyond[] = {1, 1.0001f, 2, 1e9f, 3.4e38f, INFINITY};
  for (int s = 0; s < SIZE_COUNT; s++) {
    for (int sampling = 0; sampling < 2; sampling++) {
      if (!exists(SIZES[s], sampling)) continue;
      const StyLut lut = describe(SIZES[s], (StySampling)sampling);
      for (size_t b = 0; b < sizeof beyond / sizeof *beyond; b++) {
        int t[2];
        sty_find_texel(&lut, (float[]){beyond[b], beyond[b]}, t);
        assert_true(t[0] == lut.size - 1 && t[1] == 0);
        sty_find_texel(&lut, (float[]){-beyond[b], -beyond[b]}, t);
        assert_true(t[0] == 0 && t[1] == lut.size - 1);
      }
      /* NaN finds some texel of the table, whatever it is. */
      int t[2] = {-1, -1};
      sty_find_texel(&lut, (float[]){NAN, -NAN}, t);
      assert_in_range(t[0], 0, lut.size - 1);
      assert_in_range(t[1], 0, lut.size - 1);
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_new_table),     cmocka_unit_test(test_bad_sizes),   cmocka_unit_test(test_names),
      cmocka_unit_test(test_texel_values),  cmocka_unit_test(test_byte_values), cmocka_unit_test(test_there_and_back),
      cmocka_unit_test(test_nearest_texel), cmocka_unit_test(test_clamping),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
