#include "stylut/strokes.h"

#include <math.h>

#include "../scratch.h"

static const StyStrokeOptions plain = {.groups = (1u << STY_STROKE_GROUPS) - 1, .count = 1, .threshold = 1e-6};

typedef double (*Shade)(double x, double y, const double *parameters);

static StyImage *make_picture(int width, int height, int bits, int count, const char *const *names) {
  StyImage *image = NULL;
  assert_int_equal(sty_create_image(width, height, count, names, bits, &image, NULL), STY_OK);
  return image;
}

static StyImage *make_grey(int width, int height) {
  return make_picture(width, height, 32, 1, (const char *const[]){"Y"});
}

/* A grey picture of what `shade` says at pixel centres. */
static StyImage *draw_grey(int width, int height, Shade shade, const double *parameters) {
  StyImage *image = make_grey(width, height);
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++) image->data[y * width + x] = (float)shade(x + 0.5, y + 0.5, parameters);
  return image;
}

static StyImage *measure(const StyImage *picture, const StyStrokeOptions *options, StyStrokeFigures *figures) {
  StyImage *guide = NULL;
  StyError error = {STY_OK, ""};
  if (sty_make_stroke_guide("some.png", picture, options, NULL, figures, &guide, &error)) fail_msg("%s", error.text);
  assert_int_equal(guide->width, picture->width);
  assert_int_equal(guide->height, picture->height);
  return guide;
}

static double get(const StyImage *guide, const char *channel, int x, int y) {
  const float *plane = sty_find_channel(guide, channel);
  if (!plane) fail_msg("no channel %s", channel);
  return (double)plane[(size_t)y * (size_t)guide->width + (size_t)x];
}

static void expect_near(const char *what, double found, double expected, double tolerance) {
  if (!(fabs(found - expected) <= tolerance)) fail_msg("%s: found %.9g, expected %.9g", what, found, expected);
}

static void expect_refusal(StyImage *picture, const StyStrokeOptions *options, StyStatus expected,
                           const char *const *parts) {
  StyImage *guide = NULL;
  StyError error = {STY_OK, ""};
  expect_message(sty_make_stroke_guide("some.png", picture, options, NULL, NULL, &guide, &error), expected, &error,
                 parts);
  assert_null(guide);
  sty_destroy_image(&picture);
}

/* ---- eqs. 4.1 to 4.3 ------------------------------------------------------------ */

static void test_box_filter_by_hand(void **state) {
  (void)state;
  static const double expected[4][2][3] = {
      {{1, 2, 3}, {6, 7, 8}}, {{4, 6, 7.5}, {11.5, 13.5, 15}}, {{7.5, 10}, {0}}, {{8}, {0}}};
  static const int sizes[4][2] = {{5, 3}, {3, 2}, {2, 1}, {1, 1}};
  StyImage *picture = make_grey(5, 3);
  for (int i = 0; i < 15; i++) picture->data[i] = (float)(i + 1);
  StyStrokeOptions options = plain;
  StyStrokeFigures figures;
  options.count = 4;
  options.numbered = true;
  StyImage *guide = measure(picture, &options, &figures);
  assert_int_equal(figures.count, 4);
  for (int m = 0; m < 4; m++) {
    char channel[32];
    snprintf(channel, sizeof channel, "color.%d.G", m);
    assert_int_equal(figures.levels[m].width, sizes[m][0]);
    assert_int_equal(figures.levels[m].height, sizes[m][1]);
    for (int y = 0; y < 3; y++)
      for (int x = 0; x < 5; x++)
        if (y >> m < 2 && x >> m < 3) expect_near(channel, get(guide, channel, x, y), expected[m][y >> m][x >> m], 0);
  }
  sty_destroy_image(&guide);
  sty_destroy_image(&picture);
}

static void test_means_weigh_by_coverage(void **state) {
  (void)state;
  StyImage *picture = make_picture(2, 2, 32, 2, (const char *const[]){"Y", "A"});
  memcpy(picture->data, (const float[]){1, NAN, 3, 5, 1, 0, 0.5f, 7}, 8 * sizeof(float));
  StyStrokeOptions options = plain;
  options.first = 1;
  StyImage *guide = measure(picture, &options, NULL);
  expect_near("mean", get(guide, "color.B", 0, 0), (1 + 3 * 0.5 + 5) / 2.5, 0);
  expect_near("miss", get(guide, "color.B", 1, 0), 0, 0);
  expect_near("coverage", get(guide, "A", 1, 0), 0, 0);
  expect_near("coverage", get(guide, "A", 0, 1), 0.5, 0);
  expect_near("coverage", get(guide, "A", 1, 1), 1, 0);
  sty_destroy_image(&guide);
  sty_destroy_image(&picture);
}

static void test_luminance_and_spaces(void **state) {
  (void)state;
  static const char *const names[] = {"R", "G", "B"};
  StyImage *picture = make_picture(3, 1, 8, 3, names);
  for (int k = 0; k < 3; k++) picture->data[3 * k + k] = 1; /* red, green, blue */
  picture->data[2] = 128.0f / 255;
  StyStrokeOptions options = plain;
  StyImage *guide = measure(picture, &options, NULL);
  expect_near("red", get(guide, "luma.Y", 0, 0), 0.2126, 1e-7);
  expect_near("green", get(guide, "luma.Y", 1, 0), 0.7152, 1e-7);
  expect_near("128 of 255, linear", get(guide, "color.R", 2, 0), 0.21586050, 1e-7);
  sty_destroy_image(&guide);
  options.srgb = true;
  guide = measure(picture, &options, NULL);
  expect_near("128 of 255, as it is", get(guide, "color.R", 2, 0), 128.0 / 255, 1e-7);
  sty_destroy_image(&guide);
  picture->bits = 32;
  picture->data[2] = 0.21586050f;
  guide = measure(picture, &options, NULL);
  expect_near("0.2159, encoded", get(guide, "color.R", 2, 0), 128.0 / 255, 1e-6);
  sty_destroy_image(&guide);
  options.srgb = false;
  guide = measure(picture, &options, NULL);
  expect_near("0.2159, as it is", get(guide, "color.R", 2, 0), 0.21586050, 1e-7);
  sty_destroy_image(&guide);
  sty_destroy_image(&picture);
}

/* ---- eqs. 4.4 and 4.5 ----------------------------------------------------------- */

static double shade_ramp(double x, double y, const double *p) { return 0.1 + p[0] * x + p[1] * y; }

static void expect_ramp(int width, int height, double a, double b, int level) {
  const double slope[2] = {a, b};
  StyImage *picture = draw_grey(width, height, shade_ramp, slope);
  StyStrokeOptions options = plain;
  options.first = level;
  StyImage *guide = measure(picture, &options, NULL);
  const double length = sqrt(a * a + b * b);
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++) {
      expect_near("detail", get(guide, "detail.Y", x, y), length * (1 << level), 2e-5);
      /* The gradient is (a, -b) with y up, so turned it is (-b, -a). */
      expect_near("orientation.X", get(guide, "orientation.X", x, y), -b / length, 1e-3);
      expect_near("orientation.Y", get(guide, "orientation.Y", x, y), -a / length, 1e-3);
      expect_near("line.X", get(guide, "line.X", x, y), (b * b - a * a) / length / length, 2e-3);
      expect_near("line.Y", get(guide, "line.Y", x, y), 2 * a * b / length / length, 2e-3);
    }
  sty_destroy_image(&guide);
  sty_destroy_image(&picture);
}

/* To the border: no frame counts as detail. */
static void test_ramps(void **state) {
  (void)state;
  expect_ramp(9, 7, 0.01, 0, 0);
  expect_ramp(9, 7, -0.01, 0, 0);
  expect_ramp(9, 7, 0, 0.02, 0);
  expect_ramp(9, 7, 0, -0.02, 0);
  expect_ramp(8, 12, 0.01, 0.03, 0);
  expect_ramp(32, 16, 0.004, -0.003, 1);
  expect_ramp(32, 16, -0.002, -0.003, 3);
}

static void test_sobel_against_the_kernel(void **state) {
  (void)state;
  static const double dx[3][3] = {{-1, 0, 1}, {-2, 0, 2}, {-1, 0, 1}}, dy[3][3] = {{1, 2, 1}, {0, 0, 0}, {-1, -2, -1}};
  StyImage *picture = make_grey(17, 13);
  uint64_t seed = 1;
  for (int i = 0; i < 17 * 13; i++) picture->data[i] = draw_signed(&seed);
  StyImage *guide = measure(picture, &plain, NULL);
  for (int y = 1; y < 12; y++)
    for (int x = 1; x < 16; x++) {
      double right = 0, up = 0;
      for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3; i++) {
          right += dx[j][i] / 8 * (double)picture->data[(y + j - 1) * 17 + x + i - 1];
          up += dy[j][i] / 8 * (double)picture->data[(y + j - 1) * 17 + x + i - 1];
        }
      const double length = sqrt(right * right + up * up);
      expect_near("detail", get(guide, "detail.Y", x, y), length, 1e-6);
      expect_near("orientation.X", get(guide, "orientation.X", x, y), up / length, 1e-4);
      expect_near("orientation.Y", get(guide, "orientation.Y", x, y), -right / length, 1e-4);
    }
  sty_destroy_image(&guide);
  sty_destroy_image(&picture);
}

/* Waves of 16 pixels whose crests run along the angle p[0], y up. */
static double shade_stripes(double x, double y, const double *p) {
  return 0.5 + 0.5 * sin((-sin(p[0]) * x - cos(p[0]) * y) * 2 * 3.14159265358979 / 16);
}

static void test_stripes_at_known_angles(void **state) {
  (void)state;
  for (int degrees = 0; degrees < 360; degrees += 15) {
    const double angle = degrees * 3.14159265358979 / 180;
    StyImage *picture = draw_grey(48, 48, shade_stripes, &angle);
    StyImage *guide = measure(picture, &plain, NULL);
    int seen = 0;
    for (int y = 2; y < 46; y++)
      for (int x = 2; x < 46; x++) {
        if (get(guide, "detail.Y", x, y) < 0.05) continue;
        seen++;
        const double ox = get(guide, "orientation.X", x, y), oy = get(guide, "orientation.Y", x, y);
        expect_near("line.X", get(guide, "line.X", x, y), cos(2 * angle), 0.02);
        expect_near("line.Y", get(guide, "line.Y", x, y), sin(2 * angle), 0.02);
        expect_near("along the stripes", fabs(ox * cos(angle) + oy * sin(angle)), 1, 1e-3);
        /* Left of (ox, oy) is (-oy, ox), y up: (-oy, -ox) with y down. */
        assert_true(shade_stripes(x + 0.5 - oy, y + 0.5 - ox, &angle) > shade_stripes(x + 0.5, y + 0.5, &angle));
      }
    assert_true(seen > 1000);
    sty_destroy_image(&guide);
    sty_destroy_image(&picture);
  }
}

static void test_constant_pictures_have_no_orientation(void **state) {
  (void)state;
  static const char *const channels[] = {"detail.Y", "orientation.X", "orientation.Y", "line.X", "line.Y"};
  StyImage *picture = make_picture(13, 7, 32, 4, (const char *const[]){"R", "G", "B", "A"});
  uint64_t seed = 2;
  for (int i = 0; i < 91; i++) {
    for (int k = 0; k < 3; k++) picture->data[91 * k + i] = 0.3f + 0.1f * (float)k;
    picture->data[91 * 3 + i] = fmaxf(0, draw_signed(&seed));
  }
  for (int m = 0; m < 5; m++) {
    StyStrokeOptions options = plain;
    StyStrokeFigures figures;
    options.first = m;
    options.threshold = 0;
    StyImage *guide = measure(picture, &options, &figures);
    assert_int_equal(figures.levels[m].flat, figures.levels[m].covered);
    assert_true(figures.levels[m].max == 0);
    for (int i = 0; i < 91; i++) {
      const bool covered = picture->data[91 * 3 + i] > 0;
      for (int c = 0; c < 5; c++) expect_near(channels[c], get(guide, channels[c], i % 13, i / 13), 0, 0);
      expect_near("color.G", get(guide, "color.G", i % 13, i / 13), covered ? (double)0.4f : 0, 0);
    }
    sty_destroy_image(&guide);
  }
  sty_destroy_image(&picture);
}

static void test_threshold(void **state) {
  (void)state;
  const double slope[2] = {0.01, 0};
  StyImage *picture = draw_grey(8, 8, shade_ramp, slope);
  StyStrokeOptions options = plain;
  StyStrokeFigures figures;
  options.threshold = 0.011;
  StyImage *guide = measure(picture, &options, &figures);
  assert_int_equal(figures.levels[0].flat, 64);
  assert_int_equal(figures.levels[1].flat, 0);
  expect_near("orientation.Y", get(guide, "orientation.Y", 4, 4), 0, 0);
  expect_near("detail.Y", get(guide, "detail.Y", 4, 4), 0.01, 1e-6);
  sty_destroy_image(&guide);
  sty_destroy_image(&picture);
}

/* A disc on nothing: what shines through from behind doesn't count. */
static void test_silhouettes_are_no_detail(void **state) {
  (void)state;
  StyImage *picture = make_picture(24, 24, 32, 2, (const char *const[]){"Y", "A"});
  for (int y = 0; y < 24; y++)
    for (int x = 0; x < 24; x++) {
      const bool inside = (x - 11.5) * (x - 11.5) + (y - 11.5) * (y - 11.5) < 100;
      picture->data[24 * y + x] = inside ? 0.01f * (float)x : 9;
      picture->data[576 + 24 * y + x] = inside;
    }
  StyImage *guide = measure(picture, &plain, NULL);
  for (int i = 0; i < 576; i++)
    expect_near("detail", get(guide, "detail.Y", i % 24, i / 24), picture->data[576 + i] > 0 ? 0.01 : 0, 1e-6);
  sty_destroy_image(&guide);
  sty_destroy_image(&picture);
}

/* ---- levels at the picture's size ------------------------------------------------ */

static void test_linear_upsampling(void **state) {
  (void)state;
  const double slope[2] = {0.01, -0.02};
  StyImage *picture = draw_grey(40, 24, shade_ramp, slope);
  StyStrokeOptions options = plain;
  options.first = 2;
  options.smooth = true;
  StyImage *guide = measure(picture, &options, NULL);
  for (int y = 2; y < 22; y++)
    for (int x = 2; x < 38; x++) {
      expect_near("luma", get(guide, "luma.Y", x, y), shade_ramp(x + 0.5, y + 0.5, slope), 1e-6);
      expect_near("detail", get(guide, "detail.Y", x, y), 4 * sqrt(0.0005), 1e-5);
    }
  sty_destroy_image(&guide);
  options.first = 0;
  guide = measure(picture, &options, NULL);
  options.smooth = false;
  StyImage *other = measure(picture, &options, NULL);
  assert_memory_equal(guide->data, other->data, sizeof(float) * 10 * 40 * 24);
  sty_destroy_image(&other);
  sty_destroy_image(&guide);
  sty_destroy_image(&picture);
}

static double shade_ridge(double x, double y, const double *p) {
  (void)y;
  return fmax(0, 1 - fabs(x - p[0]) / 8);
}

/* On either side of a light line the gradients oppose each other; the line is one. */
static void test_lines_have_no_sign(void **state) {
  (void)state;
  const double middle = 32;
  StyImage *picture = draw_grey(64, 32, shade_ridge, &middle);
  StyStrokeOptions options = plain;
  options.first = 2;
  options.smooth = true;
  StyImage *guide = measure(picture, &options, NULL);
  for (int x = 26; x < 38; x++) {
    expect_near("line.X", get(guide, "line.X", x, 16), -1, 1e-6);
    expect_near("orientation.X", get(guide, "orientation.X", x, 16), 0, 1e-6);
    expect_near("orientation.Y", fabs(get(guide, "orientation.Y", x, 16)), 1, 1e-6);
  }
  assert_true(get(guide, "orientation.Y", 26, 16) * get(guide, "orientation.Y", 37, 16) < 0);
  sty_destroy_image(&guide);
  sty_destroy_image(&picture);
}

static int compare_floats(const void *a, const void *b) {
  const float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

static void test_percentiles_against_sorting(void **state) {
  (void)state;
  StyImage *picture = make_grey(37, 29);
  uint64_t seed = 3;
  for (int i = 0; i < 37 * 29; i++) picture->data[i] = powf(draw_signed(&seed), 5);
  StyStrokeFigures figures;
  StyImage *guide = measure(picture, &plain, &figures);
  float *details = sty_find_channel(guide, "detail.Y");
  qsort(details, 37 * 29, sizeof *details, compare_floats);
  const double n = 37 * 29;
  assert_true(figures.levels[0].p50 == (double)details[(int)ceil(0.5 * n) - 1]);
  assert_true(figures.levels[0].p90 == (double)details[(int)ceil(0.9 * n) - 1]);
  assert_true(figures.levels[0].p99 == (double)details[(int)ceil(0.99 * n) - 1]);
  assert_true(figures.levels[0].max == (double)details[(int)n - 1]);
  sty_destroy_image(&guide);
  sty_destroy_image(&picture);
}

/* ---- whatever comes -------------------------------------------------------------- */

static void test_all_sizes_and_threads(void **state) {
  (void)state;
  static const int sizes[][2] = {{1, 1}, {1, 7}, {7, 1}, {2, 1}, {3, 5}, {16, 16}, {33, 31}};
  uint64_t seed = 4;
  for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
    StyImage *picture = make_picture(sizes[s][0], sizes[s][1], 8, 4, (const char *const[]){"R", "G", "B", "A"});
    for (size_t i = 0; i < 4 * sty_count_pixels(picture); i++) picture->data[i] = (float)draw_below(&seed, 256) / 255;
    StyStrokeOptions options = plain;
    options.count = sty_count_stroke_levels(sizes[s][0], sizes[s][1]);
    options.numbered = options.smooth = true;
    StyImage *one = NULL, *three = NULL;
    StyStrokeFigures figures;
    assert_int_equal(sty_make_stroke_guide("a", picture, &options, &(StyRun){.threads = 1}, &figures, &one, NULL), 0);
    assert_int_equal(sty_make_stroke_guide("a", picture, &options, &(StyRun){.threads = 3}, &figures, &three, NULL), 0);
    assert_int_equal(one->channel_count, 1 + 9 * options.count);
    assert_int_equal(figures.levels[options.count - 1].width, 1);
    assert_int_equal(figures.levels[options.count - 1].height, 1);
    assert_memory_equal(one->data, three->data, sizeof(float) * sty_count_pixels(one) * (size_t)one->channel_count);
    for (size_t i = 0; i < sty_count_pixels(one) * (size_t)one->channel_count; i++) assert_true(isfinite(one->data[i]));
    sty_destroy_image(&one);
    sty_destroy_image(&three);
    sty_destroy_image(&picture);
  }
}

static void test_layers_and_groups(void **state) {
  (void)state;
  StyImage *picture = make_picture(2, 1, 32, 4, (const char *const[]){"full.R", "full.G", "full.B", "luma.Y"});
  memcpy(picture->data, (const float[]){0, 1, 0, 2, 0, 3, 5, 5}, 8 * sizeof(float));
  StyStrokeOptions options = plain;
  options.layer = "full";
  options.groups = STY_STROKES_COLOUR;
  StyImage *guide = measure(picture, &options, NULL);
  assert_int_equal(guide->channel_count, 4);
  expect_near("blue", get(guide, "color.B", 1, 0), 3, 0);
  sty_destroy_image(&guide);
  options.layer = "luma";
  options.groups = STY_STROKES_LUMA | STY_STROKES_DETAIL;
  guide = measure(picture, &options, NULL);
  assert_int_equal(guide->channel_count, 3);
  expect_near("luma", get(guide, "luma.Y", 1, 0), 5, 0);
  sty_destroy_image(&guide);
  options.layer = "LDE";
  expect_refusal(picture, &options, STY_ERROR_INPUT, PARTS("some.png", "LDE.R", "LDE.Y"));
}

static StyImage *make_odd_picture(float value, float alpha) {
  StyImage *picture = make_picture(3, 2, 32, 2, (const char *const[]){"Y", "A"});
  for (int i = 0; i < 12; i++) picture->data[i] = 1;
  picture->data[4] = value;
  picture->data[10] = alpha;
  return picture;
}

static void test_values_that_are_no_numbers(void **state) {
  (void)state;
  expect_refusal(make_odd_picture(NAN, 1), &plain, STY_ERROR_INPUT, PARTS("some.png", "Y = nan", "(1, 1)"));
  expect_refusal(make_odd_picture(INFINITY, 0.1f), &plain, STY_ERROR_INPUT, PARTS("some.png", "Y = inf", "(1, 1)"));
  expect_refusal(make_odd_picture(-2e30f, 1), &plain, STY_ERROR_INPUT, PARTS("some.png", "(1, 1)", "1e+30"));
  expect_refusal(make_odd_picture(1, NAN), &plain, STY_ERROR_INPUT, PARTS("some.png", "A = nan", "(1, 1)"));
  StyImage *table = make_odd_picture(1, 1);
  assert_int_equal(sty_set_attribute(table, "stylut:kind", "lut", NULL), STY_OK);
  expect_refusal(table, &plain, STY_ERROR_INPUT, PARTS("some.png", "lut", "a picture"));
  expect_refusal(make_picture(1, 1, 8, 2, (const char *const[]){"R", "G"}), &plain, STY_ERROR_INPUT, PARTS("R, G"));
  StyImage *hidden = make_odd_picture(NAN, -1), *guide = measure(hidden, &plain, NULL);
  expect_near("A", get(guide, "A", 1, 1), 0, 0);
  sty_destroy_image(&guide);
  sty_destroy_image(&hidden);
}

static void test_levels_that_are_not_there(void **state) {
  (void)state;
  StyStrokeOptions options = plain;
  options.first = 3;
  expect_refusal(make_grey(4, 3), &options, STY_ERROR_USAGE, PARTS("some.png", "level 3", "0 to 2"));
  options.first = 0;
  options.count = 4;
  options.numbered = true;
  expect_refusal(make_grey(4, 3), &options, STY_ERROR_USAGE, PARTS("level 3", "4x3"));
  options.count = 2;
  options.numbered = false;
  expect_refusal(make_grey(4, 3), &options, STY_ERROR_USAGE, PARTS("2 levels"));
  options.count = 15;
  options.numbered = true;
  expect_refusal(make_grey(1, 65536), &options, STY_ERROR_USAGE, PARTS("136 channels", "128"));
  assert_int_equal(sty_count_stroke_levels(STY_MAX_SIDE, 1), STY_MAX_STROKE_LEVELS);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_box_filter_by_hand),
      cmocka_unit_test(test_means_weigh_by_coverage),
      cmocka_unit_test(test_luminance_and_spaces),
      cmocka_unit_test(test_ramps),
      cmocka_unit_test(test_sobel_against_the_kernel),
      cmocka_unit_test(test_stripes_at_known_angles),
      cmocka_unit_test(test_constant_pictures_have_no_orientation),
      cmocka_unit_test(test_threshold),
      cmocka_unit_test(test_silhouettes_are_no_detail),
      cmocka_unit_test(test_linear_upsampling),
      cmocka_unit_test(test_lines_have_no_sign),
      cmocka_unit_test(test_percentiles_against_sorting),
      cmocka_unit_test(test_all_sizes_and_threads),
      cmocka_unit_test(test_layers_and_groups),
      cmocka_unit_test(test_values_that_are_no_numbers),
      cmocka_unit_test(test_levels_that_are_not_there),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
