#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "flow_pairs.h"
#include "stylut/flow.h"

static const char *const NAMES[2] = {"now.png", "before.png"};
static const char *const ERROR_NAMES[2] = {"flow.exr", "truth.exr"};

/* Pixels from the border that a test leaves out, here and where a pixel was. */
enum { BORDER = 8 };

static StyImage *estimate(const FlowPair *pair, const StyFlowOptions *options, StyFlowFigures *figures) {
  StyImage *flow = NULL;
  StyError error = {STY_OK, ""};
  assert_non_null(pair->truth);
  if (sty_estimate_flow(NAMES, pair->frame, pair->previous, options, NULL, figures, &flow, &error))
    fail_msg("%s", error.text);
  return flow;
}

static void leave_out_border(const StyImage *truth) {
  const size_t pixels = sty_count_pixels(truth);
  for (size_t p = 0; p < pixels; p++) {
    const double x = (double)(p % (size_t)truth->width), y = (double)(p / (size_t)truth->width);
    const double fx = x + (double)truth->data[pixels + p], fy = y + (double)truth->data[2 * pixels + p];
    const double right = truth->width - 1 - BORDER, bottom = truth->height - 1 - BORDER;
    if (fmin(fmin(x, y), fmin(fx, fy)) < BORDER || fmax(x, fx) > right || fmax(y, fy) > bottom) truth->data[p] = 0;
  }
}

static StyFlowError measure(const StyImage *flow, const StyImage *truth) {
  StyFlowError found;
  StyError error = {STY_OK, ""};
  if (sty_measure_flow(ERROR_NAMES, flow, truth, &found, &error)) fail_msg("%s", error.text);
  return found;
}

/* The error in the interior. */
static StyFlowError judge(FlowPair pair, const StyFlowOptions *options, StyFlowFigures *figures) {
  StyImage *flow = estimate(&pair, options, figures);
  leave_out_border(pair.truth);
  const StyFlowError found = measure(flow, pair.truth);
  sty_destroy_image(&flow);
  destroy_pair(&pair);
  return found;
}

/* Prints what was found, so that the log says how far a bound is from it. */
static void expect_at_most(const char *what, double found, double most) {
  print_message("%-40s %.4f (at most %g)\n", what, found, most);
  if (!(found <= most)) fail_msg("%s: found %g, expected at most %g", what, found, most);
}

/* ---- what can be seen ------------------------------------------------------------ */

static void test_whole_translations_are_exact(void **state) {
  (void)state;
  static const int shifts[][2] = {{1, 0}, {0, -1}, {3, 2}, {5, -3}, {-11, 6}, {17, 11}};
  for (size_t s = 0; s < sizeof shifts / sizeof *shifts; s++) {
    const Movement movement = move_by(shifts[s][0], shifts[s][1]);
    const StyFlowError found = judge(make_pair(320, 240, 8, cloud, movement), &sty_default_flow_options, NULL);
    assert_true(found.pixels > 20000);
    print_message("(%d, %d): ", shifts[s][0], shifts[s][1]);
    expect_at_most("max", found.end_point.max, 0);
    assert_true(fabs(found.mean_truth - hypot(shifts[s][0], shifts[s][1])) < 1e-9);
  }
}

static void test_every_format(void **state) {
  (void)state;
  static const int depths[] = {8, 16, 32};
  for (int d = 0; d < 3; d++)
    assert_true(
        judge(make_pair(121, 97, depths[d], cloud, move_by(2, -4)), &sty_default_flow_options, NULL).end_point.max ==
        0);
}

static void test_below_the_pixel(void **state) {
  (void)state;
  StyFlowError found = judge(make_pair(240, 180, 8, cloud, move_by(0.3, 0.6)), &sty_default_flow_options, NULL);
  expect_at_most("(0.3, 0.6): mean", found.end_point.mean, 0.04);
  expect_at_most("(0.3, 0.6): p99", found.end_point.p99, 0.1);
  found = judge(make_pair(240, 180, 8, cloud, move_by(4.5, 2.25)), &sty_default_flow_options, NULL);
  expect_at_most("(4.5, 2.25): mean", found.end_point.mean, 0.04);
  expect_at_most("(4.5, 2.25): p99", found.end_point.p99, 0.1);
}

static void test_turning_and_zooming(void **state) {
  (void)state;
  StyFlowError found = judge(make_pair(320, 240, 8, cloud, turn_and_zoom(3, 1)), &sty_default_flow_options, NULL);
  expect_at_most("3 degrees: mean", found.end_point.mean, 0.06);
  expect_at_most("3 degrees: max", found.end_point.max, 0.6);
  found = judge(make_pair(320, 240, 8, cloud, turn_and_zoom(10, 1)), &sty_default_flow_options, NULL);
  expect_at_most("10 degrees: mean", found.end_point.mean, 0.15);
  expect_at_most("10 degrees: p99", found.end_point.p99, 0.45);
  found = judge(make_pair(320, 240, 8, cloud, turn_and_zoom(0, 1.1)), &sty_default_flow_options, NULL);
  expect_at_most("zoom 1.1: mean", found.end_point.mean, 0.12);
  expect_at_most("zoom 1.1: p99", found.end_point.p99, 0.4);
}

static void test_two_motions(void **state) {
  (void)state;
  StyFlowOptions options = sty_default_flow_options;
  options.consistency = true;
  StyFlowFigures figures;
  const StyFlowError found = judge(make_disc_pair(320, 240, -6, 4), &options, &figures);
  expect_at_most("disc over background: p50", found.end_point.p50, 0);
  expect_at_most("disc over background: mean", found.end_point.mean, 0.25);
  expect_at_most("disc over background: above 1 pixel", found.above_1, 0.04);
  /* What the disc uncovers has no match, and the way back says so, whichever way it moves. */
  static const int ways[][2] = {{-6, 4}, {-6, 0}, {2, 6}};
  for (size_t w = 0; w < sizeof ways / sizeof *ways; w++) {
    judge(make_disc_pair(320, 240, ways[w][0], ways[w][1]), &options, &figures);
    const double inconsistent = (double)figures.inconsistent / (double)figures.compared;
    print_message("disc by (%d, %d): %.4f inconsistent\n", ways[w][0], ways[w][1], inconsistent);
    assert_true(inconsistent > 0.01 && inconsistent < 0.1);
  }
}

static void test_identical_pictures_rest(void **state) {
  (void)state;
  static const Texture textures[] = {cloud, stripes, circles, uniform};
  for (size_t t = 0; t < sizeof textures / sizeof *textures; t++)
    for (int method = 0; method < 2; method++) {
      StyFlowOptions options = sty_default_flow_options;
      options.method = (StyFlowMethod)method;
      options.consistency = true;
      FlowPair pair = make_pair(75, 61, 8, textures[t], move_by(0, 0));
      StyFlowFigures figures;
      StyImage *flow = estimate(&pair, &options, &figures);
      assert_true(figures.max_motion == 0 && figures.mean_residual == 0);
      assert_true(figures.mean_inconsistency == 0 && figures.inconsistent == 0);
      assert_int_equal(figures.covered, 75 * 61);
      sty_destroy_image(&flow);
      destroy_pair(&pair);
    }
}

/* ---- what cannot, section 4.6.3 -------------------------------------------------- */

static double share(size_t part, const StyFlowFigures *figures) { return (double)part / (double)figures->covered; }

static void test_uniform_pictures_are_ambiguous(void **state) {
  (void)state;
  StyFlowFigures figures;
  const StyFlowError found = judge(make_pair(64, 64, 8, uniform, move_by(3, 1)), &sty_default_flow_options, &figures);
  assert_true(figures.max_motion == 0 && fabs(found.relative - 1) < 1e-6);
  assert_true(share(figures.ambiguous, &figures) == 1 && share(figures.untextured, &figures) == 1);
  assert_int_equal(figures.unknown, figures.covered);
}

/* "stripes moving along the stripe direction": an error of 100 %, as the thesis expects (6.4.6). */
static void test_stripes_along_themselves(void **state) {
  (void)state;
  for (int method = 0; method < 2; method++) {
    StyFlowOptions options = sty_default_flow_options;
    options.method = (StyFlowMethod)method;
    StyFlowFigures figures;
    const StyFlowError found = judge(make_pair(160, 120, 8, stripes, move_by(3, 0)), &options, &figures);
    assert_true(found.relative == 1 && found.end_point.mean == 3);
    assert_true(share(figures.ambiguous, &figures) == 1 && figures.untextured == 0);
  }
}

/* Across, or aslant: what can be seen of the motion is found, the aperture hides the rest. */
static void test_stripes_across_themselves(void **state) {
  (void)state;
  StyFlowFigures figures;
  StyFlowError found = judge(make_pair(160, 120, 8, stripes, move_by(0, 3)), &sty_default_flow_options, &figures);
  expect_at_most("stripes by (0, 3): max", found.end_point.max, 0);
  assert_true(share(figures.ambiguous, &figures) == 1);
  found = judge(make_pair(160, 120, 8, stripes, move_by(3, 3)), &sty_default_flow_options, &figures);
  expect_at_most("stripes by (3, 3): distance from 3", fabs(found.end_point.mean - 3), 1e-6);
  /* Beyond half a period they seem to move the other way. */
  found = judge(make_pair(160, 120, 8, stripes, move_by(0, 12)), &sty_default_flow_options, &figures);
  assert_true(found.end_point.p50 > 1);
  print_message("stripes by (0, 12), of period 16: p50 %.4f\n", found.end_point.p50);
}

/* "concentric circles rotating around the center of the circles": nothing says that they move, nor
 * that this isn't known. */
static void test_circles_turning(void **state) {
  (void)state;
  for (int method = 0; method < 2; method++) {
    StyFlowOptions options = sty_default_flow_options;
    options.method = (StyFlowMethod)method;
    StyFlowFigures figures;
    const StyFlowError found = judge(make_pair(160, 120, 8, circles, turn_and_zoom(5, 1)), &options, &figures);
    expect_at_most("circles by 5 degrees: distance from 100 %", fabs(found.relative - 1), 1e-6);
    expect_at_most("circles by 5 degrees: ambiguous", share(figures.ambiguous, &figures), 0.2);
  }
}

/* A pattern that repeats every 16 pixels: found while it moves by less than half of that. */
static void test_circles_moving(void **state) {
  (void)state;
  StyFlowError found = judge(make_pair(320, 240, 8, circles, move_by(2, 0)), &sty_default_flow_options, NULL);
  expect_at_most("circles by (2, 0): p99", found.end_point.p99, 0);
  found = judge(make_pair(320, 240, 8, circles, move_by(12, 0)), &sty_default_flow_options, NULL);
  print_message("circles by (12, 0), of period 16: mean %.4f\n", found.end_point.mean);
  assert_true(found.end_point.mean > 1);
}

static void add_noise(const StyImage *image, int key, double sigma) {
  for (size_t i = 0; i < 3 * sty_count_pixels(image); i++) {
    double sum = -2;
    for (int k = 0; k < 4; k++) sum += draw_lattice((int)i, k, key);
    const double value = (double)image->data[i] + sum * sqrt(3) * sigma / 255;
    image->data[i] = quantize(fmin(fmax(value, 0), 1), 8);
  }
}

/* Noise hides that stripes are ambiguous, until the tolerance is above it. */
static void test_tolerance(void **state) {
  (void)state;
  static const double tolerances[] = {0, 0.5, 2};
  double shares[3];
  for (int t = 0; t < 3; t++) {
    FlowPair pair = make_pair(160, 120, 8, stripes, move_by(0, 0));
    add_noise(pair.frame, 101, 1);
    add_noise(pair.previous, 102, 1);
    StyFlowOptions options = sty_default_flow_options;
    options.tolerance = tolerances[t];
    StyFlowFigures figures;
    judge(pair, &options, &figures);
    shares[t] = share(figures.ambiguous, &figures);
    print_message("noisy stripes, tolerance %g: %.4f ambiguous\n", tolerances[t], shares[t]);
  }
  assert_true(shares[0] < 0.5 && shares[0] < shares[1] && shares[1] <= shares[2] && shares[2] > 0.99);
}

/* 6.4.6: the picture's noise and the flow's error. */
static void test_noise(void **state) {
  (void)state;
  static const double levels[] = {1, 4, 16}, most[] = {0.12, 0.4, 3};
  double before = 0;
  for (int n = 0; n < 3; n++) {
    FlowPair pair = make_pair(240, 180, 8, cloud, move_by(4.5, 2.25));
    add_noise(pair.frame, 101, levels[n]);
    add_noise(pair.previous, 102, levels[n]);
    const StyFlowError found = judge(pair, &sty_default_flow_options, NULL);
    print_message("noise of %2g levels: ", levels[n]);
    expect_at_most("mean", found.end_point.mean, most[n]);
    assert_true(found.end_point.mean > before);
    before = found.end_point.mean;
  }
}

/* As published, levels that search on their own and are averaged: short motion comes through in part. */
static void test_published_method(void **state) {
  (void)state;
  StyFlowOptions options = sty_default_flow_options;
  options.method = STY_FLOW_PUBLISHED;
  const StyFlowError one = judge(make_pair(240, 180, 8, cloud, move_by(1, 0)), &options, NULL);
  expect_at_most("published, (1, 0): relative", one.relative, 0.35);
  const StyFlowError five = judge(make_pair(240, 180, 8, cloud, move_by(5, -3)), &options, NULL);
  expect_at_most("published, (5, -3): relative", five.relative, 1);
  const StyFlowError ours = judge(make_pair(240, 180, 8, cloud, move_by(5, -3)), &sty_default_flow_options, NULL);
  assert_true(ours.end_point.mean < five.end_point.mean);
}

/* ---- properties ------------------------------------------------------------------ */

static void test_threads_give_the_same_bytes(void **state) {
  (void)state;
  FlowPair pair = make_pair(131, 77, 8, cloud, turn_and_zoom(7, 1.03));
  StyFlowOptions options = sty_default_flow_options;
  options.consistency = true;
  StyFlowFigures first;
  StyImage *expected = estimate(&pair, &options, &first);
  static const int threads[] = {1, 2, 3, 8, 1};
  for (size_t t = 0; t < sizeof threads / sizeof *threads; t++) {
    const StyRun run = {.threads = threads[t]};
    StyFlowFigures figures;
    StyImage *flow = NULL;
    assert_int_equal(sty_estimate_flow(NAMES, pair.frame, pair.previous, &options, &run, &figures, &flow, NULL),
                     STY_OK);
    assert_memory_equal(flow->data, expected->data, 6 * sty_count_pixels(flow) * sizeof(float));
    assert_true(figures.mean_motion == first.mean_motion && figures.mean_residual == first.mean_residual);
    sty_destroy_image(&flow);
  }
  sty_destroy_image(&expected);
  destroy_pair(&pair);
}

/* Both pictures mirrored: so is the motion, up to what ties and rounding decide. */
static void mirror(const StyImage *image) {
  for (size_t row = 0; row < (size_t)image->height * (size_t)image->channel_count; row++) {
    float *first = image->data + row * (size_t)image->width;
    for (int x = 0; x < image->width / 2; x++) {
      const float kept = first[x];
      first[x] = first[image->width - 1 - x];
      first[image->width - 1 - x] = kept;
    }
  }
}

static void test_mirrored_pictures(void **state) {
  (void)state;
  FlowPair pair = make_pair(128, 96, 8, cloud, move_by(4.25, -2.5));
  StyImage *flow = estimate(&pair, &sty_default_flow_options, NULL);
  mirror(pair.frame);
  mirror(pair.previous);
  StyImage *mirrored = estimate(&pair, &sty_default_flow_options, NULL);
  mirror(mirrored);
  float *u = sty_find_channel(mirrored, "motion.U");
  for (size_t p = 0; p < sty_count_pixels(mirrored); p++) u[p] = -u[p];
  leave_out_border(pair.truth);
  memcpy(sty_find_channel(flow, "A"), pair.truth->data, sty_count_pixels(flow) * sizeof(float));
  expect_at_most("mirrored: p99 of the difference", measure(mirrored, flow).end_point.p99, 0.05);
  sty_destroy_image(&flow);
  sty_destroy_image(&mirrored);
  destroy_pair(&pair);
}

static void test_sizes(void **state) {
  (void)state;
  static const int sizes[][2] = {{1, 1}, {1, 9}, {9, 1}, {2, 2}, {3, 5}, {17, 16}, {33, 31}, {200, 3}};
  for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++)
    for (int method = 0; method < 2; method++)
      for (int radius = 0; radius <= STY_FLOW_MOST_RADIUS; radius++) {
        StyFlowOptions options = {.method = (StyFlowMethod)method, .radius = radius, .threshold = 16, .tolerance = 0.5};
        options.levels = radius % 2 ? STY_FLOW_MOST_LEVELS : 0;
        options.consistency = true;
        FlowPair pair = make_pair(sizes[s][0], sizes[s][1], 8, cloud, move_by(1, 1));
        StyFlowFigures figures;
        StyImage *flow = estimate(&pair, &options, &figures);
        for (size_t i = 0; i < 6 * sty_count_pixels(flow); i++) assert_true(isfinite(flow->data[i]));
        assert_int_equal(figures.matched + figures.inherited + figures.unknown, sizes[s][0] * sizes[s][1]);
        sty_destroy_image(&flow);
        destroy_pair(&pair);
      }
}

/* Only what is covered is counted and moves; what isn't may hold anything. */
static void test_coverage(void **state) {
  (void)state;
  enum { SIDE = 64 };
  static const char *const names[] = {"normal.X", "normal.Y", "normal.Z", "A", "depth.Z"};
  StyImage *images[2] = {NULL, NULL}, *flow = NULL;
  const double centre[2] = {0, 0};
  for (int i = 0; i < 2; i++) {
    assert_int_equal(sty_create_image(SIDE, SIDE, 5, names, 32, &images[i], NULL), STY_OK);
    for (int p = 0; p < SIDE * SIDE; p++) {
      const int x = p % SIDE + (i ? 0 : 2), y = p / SIDE;
      const bool covered = hypot(x - 32, y - 32) < 20;
      for (int c = 0; c < 3; c++) images[i]->data[c * SIDE * SIDE + p] = covered ? (float)cloud(x, y, c, centre) : NAN;
      images[i]->data[3 * SIDE * SIDE + p] = covered;
      images[i]->data[4 * SIDE * SIDE + p] = INFINITY;
    }
  }
  StyFlowFigures figures;
  assert_int_equal(
      sty_estimate_flow(NAMES, images[0], images[1], &sty_default_flow_options, NULL, &figures, &flow, NULL), STY_OK);
  assert_string_equal(figures.channels, "normal.X,normal.Y,normal.Z");
  size_t covered = 0, right = 0;
  for (int p = 0; p < SIDE * SIDE; p++) {
    const bool here = images[0]->data[3 * SIDE * SIDE + p] > 0;
    covered += here;
    assert_true(flow->data[p] == (here ? 1 : 0));
    for (int c = 1; !here && c < 5; c++) assert_true(flow->data[c * SIDE * SIDE + p] == 0);
    right += here && flow->data[SIDE * SIDE + p] == 2 && flow->data[2 * SIDE * SIDE + p] == 0;
  }
  assert_int_equal(figures.covered, covered);
  assert_true((double)right > 0.99 * (double)covered);
  for (int i = 0; i < 2; i++) sty_destroy_image(&images[i]);
  sty_destroy_image(&flow);
}

/* ---- refusals -------------------------------------------------------------------- */

static void expect_refusal(const StyImage *frame, const StyImage *previous, const StyFlowOptions *options,
                           StyStatus expected, const char *a, const char *b) {
  StyError error = {STY_OK, ""};
  StyImage *flow = NULL;
  assert_int_equal(sty_estimate_flow(NAMES, frame, previous, options, NULL, NULL, &flow, &error), expected);
  assert_null(flow);
  if (!strstr(error.text, a) || !strstr(error.text, b)) fail_msg("'%s' lacks '%s' or '%s'", error.text, a, b);
}

static void test_refusals(void **state) {
  (void)state;
  FlowPair pair = make_pair(20, 10, 8, cloud, move_by(0, 0)), other = make_pair(20, 11, 8, cloud, move_by(0, 0));
  StyFlowOptions options = sty_default_flow_options;
  expect_refusal(pair.frame, other.previous, &options, STY_ERROR_INPUT, "20x10", "20x11");
  expect_refusal(pair.frame, pair.truth, &options, STY_ERROR_INPUT, "now.png and before.png", "no channels in common");
  options.channels = "depth";
  expect_refusal(pair.frame, pair.previous, &options, STY_ERROR_INPUT, "now.png", "depth");
  options.channels = "R,,B";
  expect_refusal(pair.frame, pair.previous, &options, STY_ERROR_USAGE, "found an empty name", "'R,,B'");
  options.channels = "R,G,B,R,G";
  expect_refusal(pair.frame, pair.previous, &options, STY_ERROR_USAGE, "more than 4", "G");
  options = sty_default_flow_options;
  options.levels = 13;
  expect_refusal(pair.frame, pair.previous, &options, STY_ERROR_USAGE, "levels", "13");
  options = sty_default_flow_options;
  options.radius = 5;
  expect_refusal(pair.frame, pair.previous, &options, STY_ERROR_USAGE, "radius", "5");
  options = sty_default_flow_options;
  options.tolerance = NAN;
  expect_refusal(pair.frame, pair.previous, &options, STY_ERROR_USAGE, "tolerance", "nan");
  options = sty_default_flow_options;
  pair.previous->data[20 * 3 + 7] = NAN;
  expect_refusal(pair.frame, pair.previous, &options, STY_ERROR_INPUT, "before.png", "(7, 3)");
  pair.frame->data[5] = 1e30f;
  expect_refusal(pair.frame, pair.previous, &options, STY_ERROR_INPUT, "now.png", "(5, 0)");
  destroy_pair(&pair);
  destroy_pair(&other);
}

/* ---- the error itself ------------------------------------------------------------ */

static StyImage *make_motion(int width, float u, float v) {
  static const char *const names[] = {"motion.U", "motion.V", "A"};
  StyImage *image = NULL;
  assert_int_equal(sty_create_image(width, 1, 3, names, 32, &image, NULL), STY_OK);
  for (int x = 0; x < width; x++) {
    image->data[x] = u;
    image->data[width + x] = v;
    image->data[2 * width + x] = 1;
  }
  return image;
}

static void test_error_figures(void **state) {
  (void)state;
  StyImage *found = make_motion(200, 1, 0), *truth = make_motion(200, 0, 0);
  /* 100 pixels are right, then by 1, 2, ... 99; one isn't covered. */
  for (int x = 100; x < 200; x++) truth->data[x] = (float)(x - 100);
  for (int x = 0; x < 100; x++) truth->data[x] = 1;
  for (int x = 100; x < 200; x++) found->data[x] = 0;
  truth->data[2 * 200 + 199] = 0;
  truth->data[199] = NAN;
  const StyFlowError e = measure(found, truth);
  assert_int_equal(e.pixels, 199);
  assert_true(e.end_point.max == 98 && e.end_point.p50 == 0 && e.end_point.p95 == 89 && e.end_point.p99 == 97);
  assert_true(fabs(e.end_point.mean - 98 * 99 / 2 / 199.0) < 1e-12);
  assert_true(fabs(e.above_1 - 97 / 199.0) < 1e-12 && fabs(e.above_3 - 95 / 199.0) < 1e-12);
  assert_true(fabs(e.mean_truth - (100 + 98 * 99 / 2) / 199.0) < 1e-12);
  assert_true(fabs(e.relative - e.end_point.mean / e.mean_truth) < 1e-12);
  sty_destroy_image(&found);
  sty_destroy_image(&truth);
  found = make_motion(1, 0, 0);
  truth = make_motion(1, 0, 1);
  assert_true(fabs(measure(found, truth).angular.mean - 45) < 1e-5);
  sty_destroy_image(&found);
  found = make_motion(1, 0, -1);
  assert_true(fabs(measure(found, truth).angular.mean - 90) < 1e-5);
  sty_destroy_image(&found);
  sty_destroy_image(&truth);
}

static void test_error_refusals(void **state) {
  (void)state;
  StyImage *found = make_motion(3, 1, 0), *truth = make_motion(4, 1, 0);
  StyFlowError out = {.pixels = 77};
  StyError error;
  assert_int_equal(sty_measure_flow(ERROR_NAMES, found, truth, &out, &error), STY_ERROR_INPUT);
  assert_non_null(strstr(error.text, "truth.exr: found 4x1 pixels, and flow.exr has 3x1"));
  sty_destroy_image(&truth);
  truth = make_motion(3, 1, INFINITY);
  assert_int_equal(sty_measure_flow(ERROR_NAMES, found, truth, &out, &error), STY_ERROR_INPUT);
  assert_non_null(strstr(error.text, "truth.exr: found the motion (1, inf) at pixel (0, 0)"));
  for (int x = 0; x < 3; x++) truth->data[6 + x] = 0;
  assert_int_equal(sty_measure_flow(ERROR_NAMES, found, truth, &out, &error), STY_ERROR_INPUT);
  assert_non_null(strstr(error.text, "no pixel"));
  strcpy(truth->names[1], "motion.W");
  assert_int_equal(sty_measure_flow(ERROR_NAMES, found, truth, &out, &error), STY_ERROR_INPUT);
  assert_non_null(strstr(error.text, "truth.exr: found no motion"));
  assert_int_equal(out.pixels, 77);
  sty_destroy_image(&found);
  sty_destroy_image(&truth);
}

static void test_motion_as_picture(void **state) {
  (void)state;
  StyImage *flow = make_motion(4, 0, 0), *picture = NULL;
  flow->data[0] = 2;
  flow->data[4] = -1;
  flow->data[1] = -9;
  flow->data[8 + 3] = 0;
  assert_int_equal(sty_encode_motion(flow, 2, 8, &picture, NULL), STY_OK);
  assert_int_equal(picture->bits, 8);
  static const int expected[4][4] = {{255, 0, 128, 0}, {64, 128, 128, 0}, {128, 128, 128, 0}, {255, 255, 255, 0}};
  for (int c = 0; c < 4; c++)
    for (int x = 0; x < 4; x++) assert_int_equal(lrintf(picture->data[4 * c + x] * 255), expected[c][x]);
  sty_destroy_image(&picture);
  assert_int_equal(sty_encode_motion(flow, 0, 8, &picture, NULL), STY_ERROR_USAGE);
  sty_destroy_image(&flow);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_whole_translations_are_exact),
      cmocka_unit_test(test_every_format),
      cmocka_unit_test(test_below_the_pixel),
      cmocka_unit_test(test_turning_and_zooming),
      cmocka_unit_test(test_two_motions),
      cmocka_unit_test(test_identical_pictures_rest),
      cmocka_unit_test(test_uniform_pictures_are_ambiguous),
      cmocka_unit_test(test_stripes_along_themselves),
      cmocka_unit_test(test_stripes_across_themselves),
      cmocka_unit_test(test_circles_turning),
      cmocka_unit_test(test_circles_moving),
      cmocka_unit_test(test_noise),
      cmocka_unit_test(test_tolerance),
      cmocka_unit_test(test_published_method),
      cmocka_unit_test(test_threads_give_the_same_bytes),
      cmocka_unit_test(test_mirrored_pictures),
      cmocka_unit_test(test_sizes),
      cmocka_unit_test(test_coverage),
      cmocka_unit_test(test_refusals),
      cmocka_unit_test(test_error_figures),
      cmocka_unit_test(test_error_refusals),
      cmocka_unit_test(test_motion_as_picture),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
