#include <math.h>

#include "../scratch.h"
#include "stylut/lut.h"

static const int SIZES[] = {1, 2, 3, 4, 5, 17, 64, 100, 255, 256, 257, 1000, 1024, 4096, STY_MAX_LUT_SIZE};
enum { SIZE_COUNT = sizeof SIZES / sizeof *SIZES, SAMPLINGS = 3 };

static StyLutSpec describe(int size, StySampling sampling) {
  return (StyLutSpec){size, size, sampling, STY_MAP_XY, STY_METRIC_XY};
}

static StyLutSpec describe_equal_area(int size) {
  return (StyLutSpec){size, size, STY_SAMPLE_CENTRE, STY_MAP_EQUAL_AREA, STY_METRIC_XY};
}

static int exists(int size, int sampling) { return size > 1 || sampling != STY_SAMPLE_UNORM8; }

static void test_new_table(void **state) {
  (void)state;
  StyLut *lut = NULL;
  const StyLutSpec spec = {7, 5, STY_SAMPLE_UNORM8, STY_MAP_XY, STY_METRIC_ANGLE};
  assert_int_equal(sty_create_lut(&spec, 30, 20, &lut, NULL), STY_OK);
  assert_int_equal(lut->spec.width, 7);
  assert_int_equal(lut->spec.height, 5);
  assert_int_equal(lut->spec.sampling, STY_SAMPLE_UNORM8);
  assert_int_equal(lut->spec.map, STY_MAP_XY);
  assert_int_equal(lut->spec.metric, STY_METRIC_ANGLE);
  assert_int_equal(lut->source_width, 30);
  assert_int_equal(lut->source_height, 20);
  assert_int_equal(lut->unique, 0);
  assert_int_equal(sty_count_texels(&lut->spec), 35);
  for (int i = 0; i < 35; i++) assert_true(lut->pixels[i] == 0 && lut->errors[i] == 0);
  sty_destroy_lut(&lut);
  assert_null(lut);
  sty_destroy_lut(&lut);
}

static void expect_refusal(StyLutSpec spec) {
  StyLut *lut = NULL;
  StyError error = {STY_OK, ""};
  expect_message(sty_create_lut(&spec, 4, 4, &lut, &error), STY_ERROR_USAGE, &error, PARTS("LUT"));
  assert_null(lut);
}

static void test_bad_specs(void **state) {
  (void)state;
  static const int bad[] = {0, -1, STY_MAX_LUT_SIZE + 1, INT32_MAX, INT32_MIN};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    expect_refusal(describe(bad[i], STY_SAMPLE_CENTRE));
    expect_refusal((StyLutSpec){bad[i], 8, STY_SAMPLE_CENTRE, STY_MAP_XY, STY_METRIC_XY});
    expect_refusal((StyLutSpec){8, bad[i], STY_SAMPLE_CENTRE, STY_MAP_XY, STY_METRIC_XY});
  }
  /* Texels that answer for both ends of [-1, 1] need to be two. */
  expect_refusal(describe(1, STY_SAMPLE_UNORM8));
  expect_refusal((StyLutSpec){1, 8, STY_SAMPLE_UNORM8, STY_MAP_XY, STY_METRIC_XY});
  expect_refusal((StyLutSpec){8, 1, STY_SAMPLE_UNORM8, STY_MAP_XY, STY_METRIC_XY});
  expect_refusal((StyLutSpec){8, 8, STY_SAMPLE_UNORM8, STY_MAP_EQUAL_AREA, STY_METRIC_XY});
  expect_refusal((StyLutSpec){8, 8, STY_SAMPLE_CORNER, STY_MAP_EQUAL_AREA, STY_METRIC_ANGLE});
  for (int sampling = 0; sampling < SAMPLINGS; sampling++) {
    StyLut *lut = NULL;
    if (!exists(1, sampling)) continue;
    assert_int_equal(
        sty_create_lut(&(StyLutSpec){1, 1, (StySampling)sampling, STY_MAP_XY, STY_METRIC_XY}, 4, 4, &lut, NULL),
        STY_OK);
    sty_destroy_lut(&lut);
  }
}

static void test_names(void **state) {
  (void)state;
  assert_string_equal(sty_sampling_names[STY_SAMPLE_CENTRE], "centre");
  assert_string_equal(sty_sampling_names[STY_SAMPLE_UNORM8], "unorm8");
  assert_string_equal(sty_sampling_names[STY_SAMPLE_CORNER], "corner");
  assert_null(sty_sampling_names[SAMPLINGS]);
  assert_string_equal(sty_map_names[STY_MAP_XY], "xy");
  assert_string_equal(sty_map_names[STY_MAP_EQUAL_AREA], "equal-area");
  assert_null(sty_map_names[2]);
  assert_string_equal(sty_metric_names[STY_METRIC_XY], "xy");
  assert_string_equal(sty_metric_names[STY_METRIC_ANGLE], "angle");
  assert_null(sty_metric_names[2]);
}

/* ---- where texels look ------------------------------------------------------------ */

/* The header's formulas, in double. */
static void get_place(const StyLutSpec *spec, int i, int j, double place[2]) {
  const double w = spec->width, h = spec->height;
  switch (spec->sampling) {
    case STY_SAMPLE_CENTRE: place[0] = (i + 0.5) / w * 2 - 1, place[1] = 1 - (j + 0.5) / h * 2; break;
    case STY_SAMPLE_UNORM8: place[0] = i / (w - 1) * 2 - 1, place[1] = 1 - j / (h - 1) * 2; break;
    default: place[0] = i / w * 2 - 1, place[1] = (h - 1 - j) / h * 2 - 1; break;
  }
}

static void expect_values(const StyLutSpec *spec, int i, int j) {
  double place[2];
  float g[2];
  get_place(spec, i, j, place);
  const double squared = place[0] * place[0] + place[1] * place[1];
  double stretch = 1;
  if (spec->map == STY_MAP_EQUAL_AREA) stretch = squared > 1 ? 1 / sqrt(squared) : sqrt(2 - squared);
  sty_get_texel_value(spec, i, j, g);
  for (int k = 0; k < 2; k++)
    if (!(fabs(g[k] - place[k] * stretch) < 1e-6))
      fail_msg("%dx%d, %s, %s: texel (%d, %d) has %g instead of %g", spec->width, spec->height,
               sty_sampling_names[spec->sampling], sty_map_names[spec->map], i, j, (double)g[k], place[k] * stretch);
  /* On the very rim rounding decides. */
  if (fabs(squared - 1) > 1e-6) assert_int_equal(sty_is_feasible(spec, i, j), squared <= 1);
}

static void test_texel_values(void **state) {
  (void)state;
  uint64_t random = 4;
  for (int s = 0; s < SIZE_COUNT; s++) {
    for (int sampling = 0; sampling < SAMPLINGS; sampling++) {
      if (!exists(SIZES[s], sampling)) continue;
      const StyLutSpec spec = describe(SIZES[s], (StySampling)sampling);
      for (int i = 0; i < SIZES[s]; i++) expect_values(&spec, i, draw_below(&random, SIZES[s]));
    }
    const StyLutSpec spec = describe_equal_area(SIZES[s]);
    for (int i = 0; i < SIZES[s]; i++) expect_values(&spec, i, draw_below(&random, SIZES[s]));
  }
  /* Where sides differ, the width is x's and the height y's. */
  for (int trial = 0; trial < 5000; trial++) {
    const StySampling sampling = (StySampling)draw_below(&random, SAMPLINGS);
    const StyLutSpec spec = {2 + draw_below(&random, 50), 2 + draw_below(&random, 50), sampling,
                             sampling ? STY_MAP_XY : (StyMap)draw_below(&random, 2), STY_METRIC_XY};
    expect_values(&spec, draw_below(&random, spec.width), draw_below(&random, spec.height));
  }
}

/* A 256-texel unorm8 table answers for what an 8-bit guide holds, to the bit: (2b-255)/255. */
static void test_byte_values(void **state) {
  (void)state;
  const StyLutSpec spec = describe(256, STY_SAMPLE_UNORM8);
  for (int b = 0; b < 256; b++) {
    float g[2];
    sty_get_texel_value(&spec, b, 255 - b, g);
    assert_true(g[0] == (float)(2 * b - 255) / 255.0f);
    assert_true(g[1] == (float)(2 * b - 255) / 255.0f);
  }
}

/* The rim itself is feasible; the places outside stand for it. */
static void test_rim(void **state) {
  (void)state;
  const StyLutSpec unorm8 = describe(3, STY_SAMPLE_UNORM8), corner = describe(2, STY_SAMPLE_CORNER);
  assert_true(sty_is_feasible(&unorm8, 0, 1) && sty_is_feasible(&unorm8, 1, 0) && sty_is_feasible(&unorm8, 2, 1));
  assert_false(sty_is_feasible(&unorm8, 0, 0));
  /* Two corner texels a side look at -1 and 0. */
  assert_true(sty_is_feasible(&corner, 1, 0) && sty_is_feasible(&corner, 0, 0) && sty_is_feasible(&corner, 1, 1));
  assert_false(sty_is_feasible(&corner, 0, 1));
  for (int s = 0; s < SIZE_COUNT; s++) {
    const StyLutSpec spec = describe_equal_area(SIZES[s]);
    const int step = SIZES[s] > 300 ? 97 : 1;
    for (int j = 0; j < SIZES[s]; j += step)
      for (int i = 0; i < SIZES[s]; i += step) {
        float g[2];
        sty_get_texel_value(&spec, i, j, g);
        const double length = hypot((double)g[0], (double)g[1]);
        assert_true(length <= 1 + 1e-6);
        if (!sty_is_feasible(&spec, i, j)) assert_true(fabs(length - 1) < 1e-6);
      }
  }
}

/* The share of the hemisphere below a height is the share of texels whose normals lie there. */
static void test_equal_area(void **state) {
  (void)state;
  const StyLutSpec spec = describe_equal_area(400);
  int feasible = 0, low[10] = {0};
  for (int j = 0; j < 400; j++)
    for (int i = 0; i < 400; i++) {
      if (!sty_is_feasible(&spec, i, j)) continue;
      float g[2];
      sty_get_texel_value(&spec, i, j, g);
      const double z = sqrt(fmax(0, 1 - (double)g[0] * g[0] - (double)g[1] * g[1]));
      feasible++;
      for (int k = 0; k < 10; k++) low[k] += z < (k + 1) / 10.0;
    }
  for (int k = 0; k < 9; k++) assert_true(fabs((double)low[k] / feasible - (k + 1) / 10.0) < 0.003);
}

/* ---- and back ------------------------------------------------------------------- */

/* A value between this texel and the next: what is looked up like it. Corner values are looked up half a texel on. */
static void get_asked(const StyLutSpec *spec, int i, int j, float g[2]) {
  sty_get_texel_value(spec, i, j, g);
  if (spec->sampling != STY_SAMPLE_CORNER) return;
  g[0] += 1 / (float)spec->width;
  g[1] += 1 / (float)spec->height;
}

static void test_there_and_back(void **state) {
  (void)state;
  for (int s = 0; s < SIZE_COUNT; s++) {
    for (int sampling = 0; sampling < SAMPLINGS; sampling++) {
      if (!exists(SIZES[s], sampling)) continue;
      const StyLutSpec spec = describe(SIZES[s], (StySampling)sampling);
      const int size = spec.width, step = size > 300 ? 61 : 1; /* rows and columns are independent */
      for (int j = 0; j < size; j += step) {
        for (int i = 0; i < size; i++) {
          float g[2];
          int t[2] = {-1, -1};
          get_asked(&spec, i, j, g);
          sty_find_texel(&spec, g, t);
          if (t[0] != i || t[1] != j)
            fail_msg("%d, sampling %d: (%d,%d) gives (%d,%d)", size, sampling, i, j, t[0], t[1]);
          float turned[2] = {g[1], g[0]};
          sty_find_texel(&spec, turned, t);
          if (t[0] != size - 1 - j || t[1] != size - 1 - i)
            fail_msg("%d, sampling %d: (%d,%d) turned gives (%d,%d)", size, sampling, i, j, t[0], t[1]);
        }
      }
    }
  }
}

/* Near the rim of an equal-area table a step in float is many texels of the largest sizes: not those. */
static void test_there_and_back_by_area(void **state) {
  (void)state;
  for (int s = 0; s < SIZE_COUNT; s++) {
    const StyLutSpec spec = describe_equal_area(SIZES[s]);
    if (SIZES[s] > 300) continue;
    for (int j = 0; j < SIZES[s]; j++)
      for (int i = 0; i < SIZES[s]; i++) {
        if (!sty_is_feasible(&spec, i, j)) continue;
        float g[2];
        int t[2];
        sty_get_texel_value(&spec, i, j, g);
        sty_find_texel(&spec, g, t);
        if (t[0] != i || t[1] != j) fail_msg("%d, equal-area: (%d,%d) gives (%d,%d)", SIZES[s], i, j, t[0], t[1]);
      }
  }
  const StyLutSpec oblong = {30, 20, STY_SAMPLE_CENTRE, STY_MAP_EQUAL_AREA, STY_METRIC_XY};
  for (int t = 0; t < 600; t++) {
    if (!sty_is_feasible(&oblong, t % 30, t / 30)) continue;
    float g[2];
    int found[2];
    sty_get_texel_value(&oblong, t % 30, t / 30, g);
    sty_find_texel(&oblong, g, found);
    assert_true(found[0] == t % 30 && found[1] == t / 30);
  }
}

/* The texel found is the one whose value is nearest, along either axis. */
static void test_nearest_texel(void **state) {
  (void)state;
  uint64_t random = 5;
  for (int s = 0; s < SIZE_COUNT; s++) {
    for (int sampling = 0; sampling < SAMPLINGS; sampling++) {
      if (!exists(SIZES[s], sampling)) continue;
      const StyLutSpec spec = describe(SIZES[s], (StySampling)sampling);
      for (int trial = 0; trial < 2000; trial++) {
        const float g[2] = {draw_signed(&random), draw_signed(&random)};
        int t[2];
        sty_find_texel(&spec, g, t);
        assert_in_range(t[0], 0, spec.width - 1);
        assert_in_range(t[1], 0, spec.height - 1);
        float value[2];
        get_asked(&spec, t[0], t[1], value);
        const double half = sampling == STY_SAMPLE_UNORM8 ? 1.0 / (spec.width - 1) : 1.0 / spec.width;
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
    for (int sampling = 0; sampling < SAMPLINGS; sampling++) {
      if (!exists(SIZES[s], sampling)) continue;
      const StyLutSpec spec = describe(SIZES[s], (StySampling)sampling);
      for (size_t b = 0; b < sizeof beyond / sizeof *beyond; b++) {
        int t[2];
        sty_find_texel(&spec, (float[]){beyond[b], beyond[b]}, t);
        assert_true(t[0] == spec.width - 1 && t[1] == 0);
        sty_find_texel(&spec, (float[]){-beyond[b], -beyond[b]}, t);
        assert_true(t[0] == 0 && t[1] == spec.height - 1);
      }
      /* NaN finds some texel of the table, whatever it is. */
      int t[2] = {-1, -1};
      sty_find_texel(&spec, (float[]){NAN, -NAN}, t);
      assert_in_range(t[0], 0, spec.width - 1);
      assert_in_range(t[1], 0, spec.height - 1);
    }
  }
}

/* Values outside the disc find what its rim finds in the same direction. */
static void test_clamping_by_area(void **state) {
  (void)state;
  static const float lengths[] = {1.0001f, 2, 1000, 1e9f, 1e18f};
  uint64_t random = 6;
  for (int s = 0; s < SIZE_COUNT; s++) {
    const StyLutSpec spec = describe_equal_area(SIZES[s]);
    for (int trial = 0; trial < 300; trial++) {
      const float angle = draw_signed(&random) * 3.14159265f;
      const float rim[2] = {cosf(angle), sinf(angle)};
      for (size_t l = 0; l < sizeof lengths / sizeof *lengths; l++) {
        int t[2];
        sty_find_texel(&spec, (float[]){rim[0] * lengths[l], rim[1] * lengths[l]}, t);
        const double h[2] = {((double)rim[0] * 0.5 + 0.5) * SIZES[s], (0.5 - (double)rim[1] * 0.5) * SIZES[s]};
        for (int k = 0; k < 2; k++) {
          assert_in_range(t[k], 0, SIZES[s] - 1);
          assert_true(fabs(t[k] + 0.5 - h[k]) <= 0.5 + 2e-6 * SIZES[s]);
        }
      }
    }
    int t[2] = {-1, -1};
    sty_find_texel(&spec, (float[]){NAN, INFINITY}, t);
    assert_in_range(t[0], 0, SIZES[s] - 1);
    assert_in_range(t[1], 0, SIZES[s] - 1);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_new_table),
      cmocka_unit_test(test_bad_specs),
      cmocka_unit_test(test_names),
      cmocka_unit_test(test_texel_values),
      cmocka_unit_test(test_byte_values),
      cmocka_unit_test(test_rim),
      cmocka_unit_test(test_equal_area),
      cmocka_unit_test(test_there_and_back),
      cmocka_unit_test(test_there_and_back_by_area),
      cmocka_unit_test(test_nearest_texel),
      cmocka_unit_test(test_clamping),
      cmocka_unit_test(test_clamping_by_area),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
