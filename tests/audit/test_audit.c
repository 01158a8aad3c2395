#include <jansson.h>
#include <math.h>

#include "../scratch.h"
#include "stylut/audit.h"
#include "stylut/guide.h"

static const StyEngine *exact_engine(void) {
  const StyEngine *engine = NULL;
  assert_int_equal(sty_find_engine("-e", "auto", &engine, NULL), STY_OK);
  return engine;
}

static const StyRun ONE_THREAD = {.threads = 1};

static StyLutSpec describe(int size, StySampling sampling) {
  return (StyLutSpec){size, size, sampling, STY_MAP_XY, STY_METRIC_XY};
}

static StyLut *build_as(const StyImage *guide, StyLutSpec spec) {
  StySites *sites = NULL;
  StyLut *lut = NULL;
  assert_int_equal(sty_collect_sites("guide", guide, &sites, NULL), STY_OK);
  assert_int_equal(sty_build_lut(sites, exact_engine(), NULL, &spec, &ONE_THREAD, &lut, NULL), STY_OK);
  sty_destroy_sites(&sites);
  return lut;
}

static StyLut *build(const StyImage *guide, int size, StySampling sampling) {
  return build_as(guide, describe(size, sampling));
}

static StyImage *make_sphere(int width, int height) {
  StyImage *guide = NULL;
  assert_int_equal(sty_make_sphere_guide(width, height, STY_GUIDE_NORMAL, &guide, NULL), STY_OK);
  return guide;
}

static StyImage *make_guide(int width, int height, const float *values) {
  static const char *const names[] = {"A", "normal.X", "normal.Y"};
  StyImage *guide = NULL;
  assert_int_equal(sty_create_image(width, height, 3, names, 32, &guide, NULL), STY_OK);
  const int count = width * height;
  for (int i = 0; i < count; i++)
    for (int c = 0; c < 3; c++) guide->data[c * count + i] = values[3 * i + c];
  return guide;
}

/* `maps` may be NULL. */
static StyAudit audit_by(const StyLut *lut, const StyLut *exact, const StyImage *guide, StyAuditOptions options,
                         int threads, StyAuditMaps *maps) {
  const StyRun run = {.threads = threads};
  StyAudit out;
  StyError error = {STY_OK, ""};
  if (sty_audit_lut(lut, exact, guide, &options, &run, &out, maps, &error) != STY_OK) fail_msg("%s", error.text);
  return out;
}

static StyAudit audit(const StyLut *lut, const StyLut *exact, const StyImage *guide, double tolerance) {
  return audit_by(lut, exact, guide, (StyAuditOptions){.tolerance = tolerance}, 1, NULL);
}

static void expect_near(double found, double expected, double tolerance, const char *what) {
  if (!(fabs(found - expected) <= tolerance)) fail_msg("%s: %.9g instead of %.9g", what, found, expected);
}

/* Texels at (+-1/2, +-1/2); the source holds the upper two exactly, and the lower two are 60 degrees away:
 * (-1/2, -1/2, sqrt(1/2)) . (-1/2, 1/2, sqrt(1/2)) = 1/2. */
static void test_by_hand(void **state) {
  (void)state;
  StyImage *guide = make_guide(3, 1, (const float[]){1, 0.5f, 0.5f, 0, 9, 9, 1, -0.5f, 0.5f});
  StyLut *lut = build(guide, 2, STY_SAMPLE_CENTRE);
  StyAudit out = audit(lut, lut, guide, 0.5);
  assert_int_equal(out.spec.width, 2);
  assert_int_equal(out.spec.height, 2);
  assert_int_equal(out.spec.sampling, STY_SAMPLE_CENTRE);
  assert_int_equal(out.feasible, 4);
  assert_int_equal(out.background, 0);
  assert_true(out.tolerance == 0.5);
  expect_near(out.coverage, 0.5, 1e-12, "coverage");
  expect_near(out.assignment.mean, 30, 1e-5, "mean");
  expect_near(out.assignment.p50, 0, 1e-5, "p50"); /* rank 2 of 4 */
  expect_near(out.assignment.p95, 60, 1e-5, "p95");
  expect_near(out.assignment.p99, 60, 1e-5, "p99");
  expect_near(out.assignment.max, 60, 1e-5, "max");
  /* Of the two texels at 60 degrees the first one, or the second where rounding makes it the larger. */
  assert_int_equal(out.assignment.texel[1], 1);
  assert_in_range(out.assignment.texel[0], 0, 1);
  assert_true(out.assignment.value[0] == (out.assignment.texel[0] ? 0.5f : -0.5f) && out.assignment.value[1] == -0.5f);
  assert_int_equal(out.assignment.source[0], out.assignment.texel[0] ? 0 : 2);
  assert_int_equal(out.assignment.source[1], 0);
  /* Within means up to: the lower texels are exactly 1 away. */
  expect_near(audit(lut, lut, guide, 1.0).coverage, 1, 1e-12, "coverage within 1");
  expect_near(audit(lut, lut, guide, 0.999).coverage, 0.5, 1e-12, "coverage within 0.999");
  expect_near(audit(lut, lut, guide, 0).coverage, 0.5, 1e-12, "coverage within 0");

  /* A worse choice for one texel: (1/2, 1/2) gets (-1/2, 1/2), 60 degrees. Coverage asks what could be had. */
  StyLut *worse = build(guide, 2, STY_SAMPLE_CENTRE);
  worse->pixels[1] = 2;
  out = audit(worse, lut, guide, 0.5);
  expect_near(out.assignment.mean, 45, 1e-5, "mean of the worse table");
  expect_near(out.assignment.p50, 60, 1e-5, "p50 of the worse table");
  expect_near(out.coverage, 0.5, 1e-12, "coverage of the worse table");

  /* And background for another. */
  worse->pixels[2] = 1;
  out = audit(worse, lut, guide, 0.5);
  assert_int_equal(out.background, 1);
  expect_near(out.assignment.mean, (0 + 60 + 180 + 60) / 4.0, 1e-5, "mean with background");
  expect_near(out.assignment.max, 180, 1e-9, "max with background");
  assert_int_equal(out.assignment.texel[0], 0);
  assert_int_equal(out.assignment.texel[1], 1);
  assert_int_equal(out.assignment.source[0], 1);
  expect_near(out.lookup.max, 180, 1e-9, "lookup with background");
  sty_destroy_lut(&worse);
  sty_destroy_lut(&lut);
  sty_destroy_image(&guide);
}

/* One texel at (0, 0), asked for 4 x 4 values at +-1/4 and +-3/4; no normal has the values in the corners, which lie
 * outside the disc. */
static void test_lookup_by_hand(void **state) {
  (void)state;
  StyImage *guide = make_guide(1, 1, (const float[]){1, 0, 0});
  StyLut *lut = build(guide, 1, STY_SAMPLE_CENTRE);
  const StyAudit out = audit(lut, lut, guide, 0.1);
  const double degrees = 180 / acos(-1);
  const double near = asin(sqrt(0.125)) * degrees, middle = asin(sqrt(0.625)) * degrees;
  assert_int_equal(out.feasible, 1);
  expect_near(out.assignment.max, 0, 1e-9, "assignment");
  expect_near(out.lookup.mean, (4 * near + 8 * middle) / 12, 1e-4, "mean");
  expect_near(out.lookup.p50, middle, 1e-4, "p50");
  expect_near(out.lookup.max, middle, 1e-4, "max");
  assert_true(fabsf(out.lookup.value[0]) + fabsf(out.lookup.value[1]) == 1);
  sty_destroy_lut(&lut);
  sty_destroy_image(&guide);
}

static void test_sphere(void **state) {
  (void)state;
  StyImage *guide = make_sphere(256, 256);
  for (int sampling = 0; sampling < 3; sampling++) {
    StyLut *lut = build(guide, 128, (StySampling)sampling);
    const StyAudit out = audit(lut, lut, guide, STY_LEVEL);
    assert_int_equal(out.background, 0);
    expect_near(out.coverage, 1, 1e-12, "coverage");
    assert_true(out.assignment.mean < 0.5);
    assert_true(out.assignment.p50 <= out.assignment.p95 && out.assignment.p95 <= out.assignment.p99);
    assert_true(out.assignment.p99 <= out.assignment.max && out.assignment.p50 < 0.5);
    /* Half a texel of 1/64 on average, about half a degree. */
    assert_true(out.lookup.mean > out.assignment.mean && out.lookup.mean < 1.5);
    assert_true(out.lookup.max >= out.assignment.max);
    sty_destroy_lut(&lut);
  }
  sty_destroy_image(&guide);
}

static void test_half_a_sphere(void **state) {
  (void)state;
  StyImage *guide = make_sphere(100, 100);
  float *a = sty_find_channel(guide, "A");
  for (int i = 0; i < 10000; i++)
    if (i % 100 >= 50) a[i] = 0;
  StyLut *lut = build(guide, 64, STY_SAMPLE_CENTRE);
  const StyAudit out = audit(lut, lut, guide, 0.02);
  expect_near(out.coverage, 0.5, 0.02, "coverage");
  assert_int_equal(out.background, 0);
  assert_true(out.assignment.max > 80);
  sty_destroy_lut(&lut);
  sty_destroy_image(&guide);
}

/* Byte guides ask a unorm8 table of 256 for its texels' own values, smaller
 * tables for values between. */
static void test_byte_lookups(void **state) {
  (void)state;
  StyImage *guide = make_sphere(256, 256);
  StyLut *whole = build(guide, 256, STY_SAMPLE_UNORM8), *small = build(guide, 16, STY_SAMPLE_UNORM8);
  const StyAudit exact = audit(whole, whole, guide, STY_LEVEL), coarse = audit(small, small, guide, STY_LEVEL);
  expect_near(exact.lookup.mean, exact.assignment.mean, 1e-9, "mean");
  assert_true(exact.lookup.p99 == exact.assignment.p99);
  assert_true(exact.lookup.max == exact.assignment.max);
  assert_true(coarse.lookup.mean > 2 && coarse.lookup.mean > 4 * coarse.assignment.mean);
  sty_destroy_lut(&whole);
  sty_destroy_lut(&small);
  sty_destroy_image(&guide);
}

/* Texels whose centre is outside the disc are looked up at its rim all the same. */
static void test_rim_lookups(void **state) {
  (void)state;
  StyImage *guide = make_sphere(128, 128);
  StyLut *lut = build(guide, 64, STY_SAMPLE_CENTRE);
  const StyAudit before = audit(lut, lut, guide, STY_LEVEL);
  for (int t = 0; t < 64 * 64; t++) {
    float g[2];
    sty_get_texel_value(&lut->spec, t % 64, t / 64, g);
    if (g[0] * g[0] + g[1] * g[1] > 1) lut->pixels[t] = 64 * 128 + 64;
  }
  const StyAudit after = audit(lut, lut, guide, STY_LEVEL);
  assert_true(after.assignment.max == before.assignment.max);
  assert_true(after.lookup.max > 80 && before.lookup.max < 30);
  sty_destroy_lut(&lut);
  sty_destroy_image(&guide);
}

/* ---- the assignment figures, computed again ---------------------------------------- */

static void get_normal(double x, double y, double n[3]) {
  const double r = sqrt(x * x + y * y), scale = r > 1 ? 1 / r : 1;
  n[0] = x * scale;
  n[1] = y * scale;
  n[2] = r >= 1 ? 0 : sqrt(1 - r * r);
}

static int compare(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double rank(const double *sorted, int count, int percent) {
  return sorted[(count * percent + 99) / 100 - 1]; /* ceil(p n), counted from 1 */
}

static void expect_figures(const StyLut *lut, const StyLut *exact, const StyImage *guide, double tolerance) {
  const StyAudit out = audit(lut, exact, guide, tolerance);
  const float *a = sty_find_channel(guide, "A"), *x = sty_find_channel(guide, "normal.X"),
              *y = sty_find_channel(guide, "normal.Y");
  const int size = lut->spec.width, texels = size * size;
  double *angles = malloc((size_t)texels * sizeof *angles), sum = 0, max = -1, at_max = -1;
  assert_non_null(angles);
  int count = 0, background = 0, covered = 0;
  for (int t = 0; t < texels; t++) {
    float g[2];
    sty_get_texel_value(&lut->spec, t % size, t / size, g);
    if (g[0] * g[0] + g[1] * g[1] > 1) continue;
    const uint32_t p = lut->pixels[t];
    double asked[3], given[3], angle = 180;
    get_normal(g[0], g[1], asked);
    get_normal(x[p], y[p], given);
    if (a[p] > 0) {
      /* The chord between two unit vectors is 2 sin(angle/2). */
      const double chord =
          sqrt(pow(asked[0] - given[0], 2) + pow(asked[1] - given[1], 2) + pow(asked[2] - given[2], 2));
      angle = 2 * asin(fmin(1, chord / 2)) * 180 / acos(-1);
    } else {
      background++;
    }
    if (exact->errors[t] <= tolerance) covered++;
    if (t == out.assignment.texel[1] * size + out.assignment.texel[0]) {
      at_max = angle;
      assert_true(out.assignment.value[0] == g[0] && out.assignment.value[1] == g[1]);
      assert_int_equal(out.assignment.source[1] * guide->width + out.assignment.source[0], p);
    }
    angles[count++] = angle;
    sum += angle;
    if (angle > max) max = angle;
  }
  assert_int_equal(out.feasible, count);
  assert_int_equal(out.background, background);
  qsort(angles, (size_t)count, sizeof *angles, compare);
  const double near = 2e-5; /* acos of a double near 1 is good to about this */
  expect_near(out.assignment.mean, sum / count, near, "mean");
  expect_near(out.assignment.p50, rank(angles, count, 50), near, "p50");
  expect_near(out.assignment.p95, rank(angles, count, 95), near, "p95");
  expect_near(out.assignment.p99, rank(angles, count, 99), near, "p99");
  expect_near(out.assignment.max, max, near, "max");
  expect_near(at_max, max, near, "the error at the place of the max");
  expect_near(out.coverage, (double)covered / count, 1e-9, "coverage");
  free(angles);
}

static void test_random_tables(void **state) {
  (void)state;
  uint64_t random = 21;
  for (int trial = 0; trial < CASES(400, 60); trial++) {
    const int width = 1 + draw_below(&random, 30), height = 1 + draw_below(&random, 30);
    const int size = 3 + draw_below(&random, 40); /* two rows of a unorm8 table are all corners */
    StyImage *guide = make_sphere(width, height);
    const size_t plane = sty_count_pixels(guide);
    if (trial % 3 == 0) { /* not a sphere any more, some of it outside the disc */
      float *nx = sty_find_channel(guide, "normal.X"), *ny = sty_find_channel(guide, "normal.Y");
      for (size_t i = 0; i < plane; i++) nx[i] = draw_signed(&random), ny[i] = draw_signed(&random);
    }
    sty_find_channel(guide, "A")[plane / 2] = 1;
    StyLutSpec spec = describe(size, (StySampling)draw_below(&random, 3));
    spec.metric = (StyMetric)draw_below(&random, 2);
    StyLut *exact = build_as(guide, spec), *lut = build_as(guide, spec);
    for (int i = draw_below(&random, 4) * size; i > 0; i--)
      lut->pixels[draw_below(&random, size * size)] = (uint32_t)draw_below(&random, (int)plane);
    expect_figures(lut, exact, guide, draw_below(&random, 10) * STY_LEVEL);
    sty_destroy_lut(&lut);
    sty_destroy_lut(&exact);
    sty_destroy_image(&guide);
  }
}

static void test_all_background(void **state) {
  (void)state;
  StyImage *guide = make_guide(2, 1, (const float[]){1, 0, 0, 0, 0, 0});
  StyLut *exact = build(guide, 9, STY_SAMPLE_CENTRE), *lut = build(guide, 9, STY_SAMPLE_CENTRE);
  for (int t = 0; t < 81; t++) lut->pixels[t] = 1;
  const StyAudit out = audit(lut, exact, guide, 0.1);
  assert_int_equal(out.background, out.feasible);
  assert_true(out.assignment.mean == 180 && out.assignment.p50 == 180 && out.assignment.max == 180);
  assert_true(out.lookup.mean == 180 && out.lookup.p99 == 180);
  /* The first feasible texel in row-major order. */
  int first = 0;
  for (float g[2]; sty_get_texel_value(&lut->spec, first % 9, first / 9, g), g[0] * g[0] + g[1] * g[1] > 1;) first++;
  assert_int_equal(out.assignment.texel[1] * 9 + out.assignment.texel[0], first);
  sty_destroy_lut(&lut);
  sty_destroy_lut(&exact);
  sty_destroy_image(&guide);
}

/* ---- excess ----------------------------------------------------------------------- */

/* An exact table leaves nothing to be had, by any metric and map. */
static void test_nothing_above_the_exact(void **state) {
  (void)state;
  uint64_t random = 22;
  for (int trial = 0; trial < CASES(60, 12); trial++) {
    StyImage *guide = make_sphere(1 + draw_below(&random, 30), 1 + draw_below(&random, 30));
    float *nx = sty_find_channel(guide, "normal.X");
    for (size_t i = 0; trial % 3 == 0 && i < sty_count_pixels(guide); i++) nx[i] = draw_signed(&random) * 1.2f;
    StyLutSpec spec = describe(3 + draw_below(&random, 30), (StySampling)(trial % 3));
    spec.map = trial % 6 == 0 ? STY_MAP_EQUAL_AREA : STY_MAP_XY;
    spec.metric = (StyMetric)(trial / 3 % 2);
    StyLut *lut = build_as(guide, spec);
    const StyAudit out = audit(lut, lut, guide, STY_LEVEL);
    assert_true(out.optimal == 1);
    assert_true(out.excess.mean == 0 && out.excess.p99 == 0 && out.excess.max == 0);
    sty_destroy_lut(&lut);
    sty_destroy_image(&guide);
  }
}

/* The guide of test_by_hand: upper texels exact, lower ones 60 degrees off. */
static void test_excess_by_hand(void **state) {
  (void)state;
  StyImage *guide = make_guide(4, 1, (const float[]){1, 0.5f, 0.5f, 0, 9, 9, 1, -0.5f, 0.5f, 1, 0.5f, 0.5f});
  StyLut *exact = build(guide, 2, STY_SAMPLE_CENTRE), *lut = build(guide, 2, STY_SAMPLE_CENTRE);
  lut->pixels[1] = 2; /* 60 degrees instead of none */
  StyAuditMaps maps;
  StyAudit out = audit_by(lut, exact, guide, (StyAuditOptions){.tolerance = 0.5}, 1, &maps);
  expect_near(out.optimal, 0.75, 1e-6, "optimal");
  expect_near(out.excess.mean, 15, 1e-5, "mean excess");
  expect_near(out.excess.max, 60, 1e-5, "max excess");
  expect_near(out.excess.p50, 0, 1e-9, "p50 excess");
  assert_true(out.excess.texel[0] == 1 && out.excess.texel[1] == 0);
  assert_true(out.excess.source[0] == 2 && out.excess.value[0] == 0.5f);
  for (int t = 0; t < 4; t++) {
    expect_near((double)maps.excess[t], t == 1 ? 60 : 0, 1e-4, "excess map");
    expect_near((double)maps.assignment[t], t == 0 ? 0 : 60, 1e-4, "assignment map");
  }
  sty_free_audit_maps(&maps);
  assert_null(maps.assignment);

  lut->pixels[2] = 1; /* background: 180 instead of 60 */
  out = audit(lut, exact, guide, 0.5);
  expect_near(out.optimal, 0.5, 1e-6, "optimal");
  expect_near(out.excess.mean, (60 + 120) / 4.0, 1e-5, "mean excess");
  expect_near(out.excess.max, 120, 1e-5, "max excess");

  /* Another pixel of the same value is as good. */
  memcpy(lut->pixels, exact->pixels, 4 * sizeof *lut->pixels);
  assert_int_equal(lut->pixels[1], 0);
  lut->pixels[1] = 3;
  out = audit(lut, exact, guide, 0.5);
  assert_true(out.optimal == 1);
  assert_true(out.excess.max == 0);
  sty_destroy_lut(&lut);
  sty_destroy_lut(&exact);
  sty_destroy_image(&guide);
}

/* By xy the nearer value isn't always the smaller angle: that is no excess, as less can't be had of this metric. */
static void test_excess_is_by_the_metric(void **state) {
  (void)state;
  /* Of (0.96, 1/8), for the texel at 0.875: 0.085 away by xy, 13.4 degrees; of (0.78, 1/8) 0.095 and 10. */
  StyImage *guide = make_guide(2, 1, (const float[]){1, 0.96f, 0.125f, 1, 0.78f, 0.125f});
  StyLutSpec spec = describe(8, STY_SAMPLE_CENTRE);
  const int texel = 3 * 8 + 7;
  StyLut *by_xy = build_as(guide, spec);
  assert_int_equal(by_xy->pixels[texel], 0);
  spec.metric = STY_METRIC_ANGLE;
  StyLut *by_angle = build_as(guide, spec);
  assert_int_equal(by_angle->pixels[texel], 1);
  StyAuditMaps maps;
  /* Each metric's choice is optimal by its own, and is worse by the other's, though its angle is the smaller one. */
  by_xy->pixels[texel] = 1;
  StyLut *exact = build_as(guide, by_xy->spec);
  StyAudit out = audit_by(by_xy, exact, guide, (StyAuditOptions){.tolerance = 0.1}, 1, &maps);
  assert_true(out.optimal < 1 && maps.excess[texel] == 0);
  sty_free_audit_maps(&maps);
  sty_destroy_lut(&exact);
  exact = build_as(guide, spec);
  by_angle->pixels[texel] = 0;
  out = audit_by(by_angle, exact, guide, (StyAuditOptions){.tolerance = 0.1}, 1, &maps);
  assert_true(out.optimal < 1 && maps.excess[texel] > 3 && maps.excess[texel] < 4);
  sty_free_audit_maps(&maps);
  sty_destroy_lut(&exact);
  sty_destroy_lut(&by_xy);
  sty_destroy_lut(&by_angle);
  sty_destroy_image(&guide);
}

/* ---- usage and jumps ---------------------------------------------------------------- */

static void test_usage(void **state) {
  (void)state;
  enum { SIZE = 16, PIXELS = 9 };
  float values[3 * PIXELS];
  for (int p = 0; p < PIXELS; p++) values[3 * p] = p != 3, values[3 * p + 1] = (float)p / 20, values[3 * p + 2] = 0;
  StyImage *guide = make_guide(PIXELS, 1, values);
  StyLut *exact = build(guide, SIZE, STY_SAMPLE_CENTRE), *lut = build(guide, SIZE, STY_SAMPLE_CENTRE);
  static const int uses[PIXELS] = {7, 8, 19, 5 /* not covered */, 20, 1, 2, 0, 1000};
  for (int t = 0, pixel = 0, used = 0; t < SIZE * SIZE; t++) {
    lut->pixels[t] = 7; /* what infeasible texels use doesn't count */
    if (!sty_is_feasible(&lut->spec, t % SIZE, t / SIZE)) continue;
    while (used == uses[pixel]) used = 0, pixel++;
    lut->pixels[t] = (uint32_t)pixel;
    used++;
  }
  const StyAudit out = audit(lut, exact, guide, STY_LEVEL);
  static const size_t expected[STY_USAGE_BINS] = {1, 1, 2, 2, 2};
  for (int b = 0; b < STY_USAGE_BINS; b++)
    if (out.usage[b] != expected[b]) fail_msg("%s: %zu instead of %zu", sty_usage_names[b], out.usage[b], expected[b]);
  expect_near(out.unused, 1.0 / 8, 1e-12, "unused");
  assert_int_equal(out.background, 5);
  sty_destroy_lut(&lut);
  sty_destroy_lut(&exact);
  sty_destroy_image(&guide);
}

/* Left and right half use pixels 63 apart. Of rows 4, 6, 8, 8, 8, 8, 6 and 4 texels wide, each crosses the middle once;
 * there are 44 pairs side by side, and as many one above the other. */
static void test_two_plateaus(void **state) {
  (void)state;
  StyImage *guide = make_sphere(64, 64);
  float *a = sty_find_channel(guide, "A");
  for (int i = 0; i < 4096; i++) a[i] = 1;
  StyLut *exact = build(guide, 8, STY_SAMPLE_CENTRE), *lut = build(guide, 8, STY_SAMPLE_CENTRE);
  for (int t = 0; t < 64; t++) lut->pixels[t] = t % 8 < 4 ? 64 * 30 : 64 * 30 + 63;
  StyAuditMaps maps;
  StyAudit out = audit_by(lut, exact, guide, (StyAuditOptions){.tolerance = STY_LEVEL}, 1, &maps);
  expect_near(out.jump, 32, 1e-12, "jump");
  expect_near(out.jumps, 8.0 / 88, 1e-6, "jumps");
  for (int t = 0; t < 64; t++) {
    const int i = t % 8, j = t / 8;
    if (!sty_is_feasible(&lut->spec, i, j)) {
      assert_true(isnan(maps.jumps[t]));
      continue;
    }
    /* At the top and the bottom one of four neighbours is missing. */
    const double share = i == 3 || i == 4 ? 1.0 / (j == 0 || j == 7 ? 3 : 4) : 0;
    expect_near((double)maps.jumps[t], share, 1e-6, "jumps map");
  }
  sty_free_audit_maps(&maps);
  /* More than J: not at J itself. */
  out = audit_by(lut, exact, guide, (StyAuditOptions){.tolerance = STY_LEVEL, .jump = 63}, 1, NULL);
  expect_near(out.jump, 63, 1e-12, "jump");
  expect_near(out.jumps, 0, 1e-12, "jumps");
  out = audit_by(lut, exact, guide, (StyAuditOptions){.tolerance = STY_LEVEL, .jump = 62.9}, 1, NULL);
  expect_near(out.jumps, 8.0 / 88, 1e-6, "jumps");
  /* One below the other counts alike. */
  for (int t = 0; t < 64; t++) lut->pixels[t] = t / 8 < 4 ? 30 : 64 * 63 + 30;
  out = audit(lut, exact, guide, STY_LEVEL);
  expect_near(out.jumps, 8.0 / 88, 1e-6, "jumps");
  sty_destroy_lut(&lut);
  sty_destroy_lut(&exact);
  sty_destroy_image(&guide);
}

/* ---- ambiguity ---------------------------------------------------------------------- */

/* Pixels of a WIDTH x HEIGHT picture, row by row: '#' have the value (0.25, 0), 'o' another that is far from it, ' '
 * are uncovered. The table's texel at (0.25, 0.25) is asked. */
static void expect_pieces(int width, int height, const char *picture, int pieces, double spread) {
  float values[3 * 64];
  for (int p = 0; p < width * height; p++) {
    values[3 * p] = picture[p] != ' ';
    values[3 * p + 1] = picture[p] == '#' ? 0.25f : -0.75f;
    values[3 * p + 2] = 0;
  }
  StyImage *guide = make_guide(width, height, values);
  StyLut *lut = build(guide, 4, STY_SAMPLE_CENTRE);
  StyAuditMaps maps;
  audit_by(lut, lut, guide, (StyAuditOptions){.tolerance = STY_LEVEL}, 1, &maps);
  const int texel = 4 + 2;
  if (maps.pieces[texel] != (float)pieces)
    fail_msg("'%s': %g pieces instead of %d", picture, (double)maps.pieces[texel], pieces);
  expect_near((double)maps.spread[texel], spread, 1e-5, picture);
  sty_free_audit_maps(&maps);
  sty_destroy_lut(&lut);
  sty_destroy_image(&guide);
}

static void test_pieces_by_hand(void **state) {
  (void)state;
  expect_pieces(1, 1, "#", 1, 0);
  expect_pieces(3, 1, "#o#", 2, 1);
  expect_pieces(3, 1, "# #", 2, 1);
  expect_pieces(3, 1, "##o", 1, 0.5);
  expect_pieces(2, 2, "#oo#", 1, sqrt(0.5));
  expect_pieces(2, 2, "o##o", 1, sqrt(0.5));
  expect_pieces(3, 3,
                "#oo"
                "ooo"
                "oo#",
                2, sqrt(2));
  expect_pieces(3, 3,
                "###"
                "#o#"
                "###",
                1, sqrt(1.5));
  /* One that is two until its last row joins them. */
  expect_pieces(5, 3,
                "#ooo#"
                "#ooo#"
                "o###o",
                1, sqrt(18.0 / 7 + 14.0 / 7 - 64.0 / 49));
  expect_pieces(5, 4,
                "#o#o#"
                "#o#o#"
                "ooooo"
                "#####",
                4, sqrt(26.0 / 11 + 48.0 / 11 - 324.0 / 121));
}

/* Two patches of the same nine values, 37 columns apart: whatever is asked, both can answer. */
static void test_two_patches(void **state) {
  (void)state;
  StyImage *guide = NULL;
  static const char *const names[] = {"A", "normal.X", "normal.Y"};
  static const float steps[3] = {-0.5f, 0.1f, 0.6f};
  assert_int_equal(sty_create_image(40, 3, 3, names, 32, &guide, NULL), STY_OK);
  for (int p = 0; p < 120; p++) {
    const int x = p % 40;
    if (x > 2 && x < 37) continue;
    guide->data[p] = 1;
    guide->data[120 + p] = steps[x % 37];
    guide->data[240 + p] = steps[p / 40];
  }
  StyLut *lut = build(guide, 5, STY_SAMPLE_CENTRE);
  StyAuditMaps maps;
  /* J is 4 * 40 / 5 pixels, so that it is the pieces that tell. */
  StyAudit out = audit_by(lut, lut, guide, (StyAuditOptions){.tolerance = STY_LEVEL}, 1, &maps);
  expect_near(out.jump, 32, 1e-12, "jump");
  assert_true(out.ambiguous == 1);
  expect_near(out.spread, 18.5, 1e-4, "spread");
  for (int t = 0; t < 25; t++) {
    if (!sty_is_feasible(&lut->spec, t % 5, t / 5)) continue;
    assert_true(maps.pieces[t] == 2);
    expect_near((double)maps.spread[t], 18.5, 1e-4, "spread map");
  }
  sty_free_audit_maps(&maps);
  sty_destroy_lut(&lut);
  sty_destroy_image(&guide);
}

/* On a float sphere every value has its own place. */
static void test_sphere_is_unambiguous(void **state) {
  (void)state;
  static const int sides[] = {50, 64, 101};
  for (int s = 0; s < 3; s++) {
    StyImage *guide = make_sphere(sides[s], sides[s]);
    for (int look = 0; look < 4; look++) {
      StyLutSpec spec = describe(40, look < 3 ? (StySampling)look : STY_SAMPLE_CENTRE);
      spec.map = look == 3 ? STY_MAP_EQUAL_AREA : STY_MAP_XY;
      StyLut *lut = build_as(guide, spec);
      const StyAudit out = audit(lut, lut, guide, STY_LEVEL);
      expect_near(out.ambiguous, 0, 1e-12, "ambiguous");
      expect_near(out.unstable, 0, 1e-12, "unstable");
      assert_true(out.spread < 0.71);
      sty_destroy_lut(&lut);
    }
    sty_destroy_image(&guide);
  }
}

/* Of a guide that shows one value everywhere, chance picks the pixel. */
static void test_flat_guide_is_unstable(void **state) {
  (void)state;
  StyImage *guide = make_sphere(64, 64);
  for (size_t i = 0; i < 4096; i++) {
    guide->data[i] = 1;
    sty_find_channel(guide, "normal.X")[i] = sty_find_channel(guide, "normal.Y")[i] = 1.0f / 255;
    sty_find_channel(guide, "A")[i] = 1;
  }
  guide->bits = 8;
  StyLut *lut = build(guide, 32, STY_SAMPLE_CENTRE);
  StyAuditMaps maps;
  const StyAudit out = audit_by(lut, lut, guide, (StyAuditOptions){.tolerance = STY_LEVEL}, 1, &maps);
  /* Eight pixels around the corner are 50 of 4,096. */
  assert_true(out.unstable > 0.9 && out.unstable <= 1);
  assert_true(out.ambiguous == 1);
  for (int t = 0; t < 1024; t++) {
    if (!sty_is_feasible(&lut->spec, t % 32, t / 32)) continue;
    assert_true(maps.pieces[t] == 1);
    expect_near((double)maps.unstable[t] * 8, round((double)maps.unstable[t] * 8), 1e-5, "eighths");
  }
  sty_free_audit_maps(&maps);
  sty_destroy_lut(&lut);
  sty_destroy_image(&guide);
}

/* ---- weights ------------------------------------------------------------------------ */

static void expect_weights(const StyImage *guide, StyLutSpec spec, StyWeights weights) {
  StyLut *lut = build_as(guide, spec);
  StyAuditMaps maps;
  const StyAudit out =
      audit_by(lut, lut, guide, (StyAuditOptions){.tolerance = STY_LEVEL, .weights = weights}, 1, &maps);
  double sum = 0, mean = 0, middle = 0;
  size_t feasible = 0;
  const int size = spec.width, centre = size / 2 * size + size / 2;
  for (int t = 0; t < size * size; t++) {
    const bool inside = sty_is_feasible(&spec, t % size, t / size);
    const float *const planes[] = {maps.assignment, maps.excess,   maps.pieces, maps.spread,
                                   maps.jumps,      maps.unstable, maps.weights};
    for (int p = 0; p < 7; p++) assert_int_equal(isnan(planes[p][t]), !inside);
    if (!inside) continue;
    feasible++;
    sum += (double)maps.weights[t];
    mean += (double)maps.weights[t] * (double)maps.assignment[t];
    float g[2];
    sty_get_texel_value(&spec, t % size, t / size, g);
    const double z = sqrt(fmax(0, 1 - (double)g[0] * g[0] - (double)g[1] * g[1]));
    /* As much of the disc, or of the sphere, as the texel covers; the last texels before the rim are bounded. */
    if (z < 0.5) continue;
    double share = spec.map == STY_MAP_XY ? 1 : z;
    if (weights == STY_WEIGHT_SPHERE) share /= z;
    if (t == centre) middle = share;
    if (t < centre) continue;
    expect_near((double)maps.weights[t] / (double)maps.weights[centre], share / middle, 1e-5, "share");
  }
  assert_int_equal(out.feasible, feasible);
  assert_int_equal(out.weights, weights);
  expect_near(sum, 1, 1e-5, "sum of weights");
  expect_near(out.assignment.mean, mean, 1e-4, "weighted mean");
  sty_free_audit_maps(&maps);
  sty_destroy_lut(&lut);
}

static void test_weights(void **state) {
  (void)state;
  assert_string_equal(sty_weights_names[STY_WEIGHT_DISC], "disc");
  assert_string_equal(sty_weights_names[STY_WEIGHT_SPHERE], "sphere");
  assert_string_equal(sty_weights_names[STY_WEIGHT_FRAMES], "frames");
  assert_null(sty_weights_names[3]);
  StyImage *guide = make_sphere(60, 50);
  for (int weights = 0; weights < 2; weights++) {
    for (int sampling = 0; sampling < 3; sampling++)
      expect_weights(guide, describe(21, (StySampling)sampling), (StyWeights)weights);
    StyLutSpec spec = describe(21, STY_SAMPLE_CENTRE);
    spec.map = STY_MAP_EQUAL_AREA;
    expect_weights(guide, spec, (StyWeights)weights);
  }
  sty_destroy_image(&guide);
}

/* A percentile by weight: where one texel asks for all, it is all. */
static void test_frames_that_ask_for_one_texel(void **state) {
  (void)state;
  StyImage *guide = make_guide(2, 1, (const float[]){1, 0.5f, 0.5f, 1, -0.5f, 0.5f});
  StyLut *lut = build(guide, 2, STY_SAMPLE_CENTRE);
  /* Three pixels look at (1/2, -1/2) and about there; what isn't covered asks for nothing. */
  StyImage *frame = make_guide(4, 1, (const float[]){1, 0.5f, -0.5f, 0, -0.5f, 0.5f, 1, 0.5f, -0.5f, 1, 0.5f, 0.5f});
  const StyImage *const frames[] = {frame, frame};
  StyAuditOptions options = {.tolerance = 0.5, .weights = STY_WEIGHT_FRAMES, .frames = frames, .frame_count = 1};
  sty_find_channel(frame, "A")[3] = 0;
  StyAuditMaps maps;
  StyAudit out = audit_by(lut, lut, guide, options, 1, &maps);
  assert_int_equal(out.feasible, 1);
  expect_near(out.assignment.mean, 60, 1e-5, "mean");
  expect_near(out.assignment.p50, 60, 1e-5, "p50");
  expect_near(out.assignment.max, 60, 1e-5, "max");
  assert_true(out.assignment.texel[0] == 1 && out.assignment.texel[1] == 1);
  expect_near(out.lookup.mean, 60, 1e-5, "lookup mean");
  expect_near(out.lookup.max, 60, 1e-5, "lookup max");
  expect_near(out.coverage, 0, 1e-12, "coverage");
  for (int t = 0; t < 4; t++) assert_true(maps.weights[t] == (t == 3));
  sty_free_audit_maps(&maps);
  assert_int_equal(out.usage[0], 1);
  assert_int_equal(out.usage[1], 1);

  /* The fourth asks for (1/2, 1/2), which the table has exactly: a third, over one frame or two. */
  sty_find_channel(frame, "A")[3] = 1;
  for (options.frame_count = 1; options.frame_count <= 2; options.frame_count++) {
    out = audit_by(lut, lut, guide, options, 1, &maps);
    assert_int_equal(out.feasible, 2);
    expect_near(out.assignment.mean, 40, 1e-4, "mean");
    expect_near(out.lookup.mean, 40, 1e-4, "lookup mean");
    expect_near(out.coverage, 1.0 / 3, 1e-6, "coverage");
    expect_near((double)maps.weights[1], 1.0 / 3, 1e-6, "weight");
    expect_near((double)maps.weights[3], 2.0 / 3, 1e-6, "weight");
    assert_true(maps.weights[0] == 0 && maps.weights[2] == 0);
    sty_free_audit_maps(&maps);
  }

  /* Frames that ask for nothing. */
  StyError error = {STY_OK, ""};
  options.frame_count = 2;
  for (int p = 0; p < 4; p++) sty_find_channel(frame, "A")[p] = 0;
  expect_message(sty_audit_lut(lut, lut, guide, &options, &ONE_THREAD, &out, NULL, &error), STY_ERROR_INPUT, &error,
                 PARTS("frame"));
  options.frame_count = 0;
  expect_message(sty_audit_lut(lut, lut, guide, &options, &ONE_THREAD, &out, NULL, &error), STY_ERROR_INPUT, &error,
                 PARTS("frame"));
  sty_destroy_image(&frame);
  sty_destroy_lut(&lut);
  sty_destroy_image(&guide);
}

/* More pixels than a float can count one by one: 17 frames of 2^20 ask for one texel, one frame for another. */
static void test_many_frames(void **state) {
  (void)state;
  enum { FRAMES = 18, SIDE = 1024 };
  if (CASES(false, true)) skip(); /* takes 700 MB */
  StyImage *guide = make_guide(2, 1, (const float[]){1, 0.5f, 0.5f, 1, -0.5f, 0.5f});
  StyLut *lut = build(guide, 2, STY_SAMPLE_CENTRE);
  float *values = malloc(SIDE * SIDE * 3 * sizeof *values);
  assert_non_null(values);
  const StyImage *frames[FRAMES];
  for (int f = 0; f < 2; f++) {
    for (size_t i = 0; i < SIDE * SIDE; i++) memcpy(values + 3 * i, (const float[]){1, f ? -0.5f : 0.5f, 0.5f}, 12);
    frames[f] = make_guide(SIDE, SIDE, values);
  }
  for (int f = 2; f < FRAMES; f++) frames[f] = frames[1];
  StyAuditMaps maps;
  audit_by(lut, lut, guide, (StyAuditOptions){.weights = STY_WEIGHT_FRAMES, .frames = frames, .frame_count = FRAMES}, 1,
           &maps);
  expect_near((double)maps.weights[0], 17.0 / 18, 1e-6, "weight");
  expect_near((double)maps.weights[1], 1.0 / 18, 1e-6, "weight");
  sty_free_audit_maps(&maps);
  free(values);
  for (int f = 0; f < 2; f++) sty_destroy_image((StyImage **)&frames[f]);
  sty_destroy_lut(&lut);
  sty_destroy_image(&guide);
}

/* ---- options ------------------------------------------------------------------------ */

static void test_defaults_and_overrides(void **state) {
  (void)state;
  StyImage *guide = make_sphere(60, 90);
  StyLut *lut = build(guide, 20, STY_SAMPLE_CENTRE);
  static const int bits[] = {8, 16, 32};
  const double steps[] = {2.0 / 255, 2.0 / 65535, 1.1920928955078125e-7};
  for (int b = 0; b < 3; b++) {
    guide->bits = bits[b];
    expect_near(sty_get_precision(guide), steps[b], 1e-15, "precision");
    const StyAudit out = audit(lut, lut, guide, 0.1);
    expect_near(out.precision, steps[b], 1e-15, "default precision");
    expect_near(out.jump, 4 * 90 / 20.0, 1e-12, "default jump");
    expect_near(out.tolerance, 0.1, 1e-15, "tolerance");
  }
  /* Pixels about a texel within 0.1: a disc of radius 3 x 4.5 pixels, whose RMS radius is beyond 2, not beyond 20. */
  StyAuditOptions options = {.tolerance = 0.1, .precision = 0.1, .jump = 2};
  StyAudit out = audit_by(lut, lut, guide, options, 1, NULL);
  expect_near(out.precision, 0.1, 1e-15, "precision");
  expect_near(out.jump, 2, 1e-15, "jump");
  assert_true(out.ambiguous > 0.9 && out.spread > 2 && out.spread < 5);
  options.jump = 20;
  out = audit_by(lut, lut, guide, options, 1, NULL);
  expect_near(out.ambiguous, 0, 1e-12, "ambiguous");
  expect_near(out.unstable, 0, 1e-12, "unstable");
  /* Half a step of 1 either way moves everything. */
  options.precision = 1, options.jump = 3;
  assert_true(audit_by(lut, lut, guide, options, 1, NULL).unstable > 0.5);
  sty_destroy_lut(&lut);
  sty_destroy_image(&guide);
}

/* The same figures and maps on any number of threads; of stability, those of the seed. */
static void test_threads(void **state) {
  (void)state;
  StyImage *guide = make_sphere(70, 70);
  guide->bits = 8;
  for (int metric = 0; metric < 2; metric++) {
    StyLutSpec spec = describe(50, STY_SAMPLE_CENTRE);
    spec.metric = (StyMetric)metric;
    StyLut *lut = build_as(guide, spec);
    StyAuditOptions options = {.tolerance = STY_LEVEL, .precision = 0.05, .jump = 1, .seed = 5};
    StyAuditMaps first;
    const StyAudit one = audit_by(lut, lut, guide, options, 1, &first);
    char *expected = sty_format_audit(&one);
    assert_true(one.unstable > 0 && one.unstable < 1);
    for (int threads = 1; threads <= 4; threads++) {
      StyAuditMaps maps;
      const StyAudit more = audit_by(lut, lut, guide, options, threads, &maps);
      char *text = sty_format_audit(&more);
      assert_string_equal(text, expected);
      const float *const a[] = {first.assignment, first.excess,   first.pieces, first.spread,
                                first.jumps,      first.unstable, first.weights};
      const float *const b[] = {maps.assignment, maps.excess,   maps.pieces, maps.spread,
                                maps.jumps,      maps.unstable, maps.weights};
      for (int p = 0; p < 7; p++) assert_memory_equal(a[p], b[p], 2500 * sizeof(float));
      free(text);
      sty_free_audit_maps(&maps);
    }
    options.seed = 6;
    const StyAudit other = audit_by(lut, lut, guide, options, 1, NULL);
    assert_true(other.unstable != one.unstable && fabs(other.unstable - one.unstable) < 0.05);
    assert_true(other.spread == one.spread);
    free(expected);
    sty_free_audit_maps(&first);
    sty_destroy_lut(&lut);
  }
  sty_destroy_image(&guide);
}

/* ---- refusals ----------------------------------------------------------------------- */

static void test_what_does_not_fit(void **state) {
  (void)state;
  StyImage *guide = make_sphere(8, 8), *other = make_sphere(8, 9);
  StyLutSpec spec = describe(16, STY_SAMPLE_CENTRE);
  StyLut *lut = build_as(guide, spec), *foreign = build_as(other, spec);
  spec.metric = STY_METRIC_ANGLE;
  StyLut *by_angle = build_as(guide, spec);
  spec.metric = STY_METRIC_XY, spec.map = STY_MAP_EQUAL_AREA;
  StyLut *by_area = build_as(guide, spec);
  spec.map = STY_MAP_XY, spec.height = 17;
  StyLut *oblong = build_as(guide, spec), *larger = build(guide, 17, STY_SAMPLE_CENTRE);
  StyLut *smaller = build(guide, 3, STY_SAMPLE_CENTRE), *unorm8 = build(guide, 16, STY_SAMPLE_UNORM8);
  StyLut *corners = build(guide, 2, STY_SAMPLE_UNORM8);
  const StyAuditOptions options = {.tolerance = 0.1};
  StyAudit out;
  StyAuditMaps maps;
  memset(&out, 7, sizeof out);
  memset(&maps, 7, sizeof maps);
  const StyAudit before = out;
  const StyAuditMaps maps_before = maps;
  StyError error;
  expect_message(sty_audit_lut(lut, lut, other, &options, NULL, &out, &maps, &error), STY_ERROR_INPUT, &error,
                 PARTS("8", "9"));
  StyLut *const exacts[] = {larger, smaller, unorm8, foreign, by_angle, by_area, oblong};
  for (int e = 0; e < 7; e++)
    expect_message(sty_audit_lut(lut, exacts[e], guide, &options, NULL, &out, &maps, &error), STY_ERROR_INPUT, &error,
                   PARTS(""));
  expect_message(sty_audit_lut(foreign, lut, guide, &options, NULL, &out, &maps, &error), STY_ERROR_INPUT, &error,
                 PARTS(""));
  expect_message(sty_audit_lut(corners, corners, guide, &options, NULL, &out, &maps, &error), STY_ERROR_INPUT, &error,
                 PARTS("feasible"));
  StyImage *blind = NULL;
  assert_int_equal(sty_create_image(8, 8, 1, (const char *const[]){"A"}, 32, &blind, NULL), STY_OK);
  expect_message(sty_audit_lut(lut, lut, blind, &options, NULL, &out, &maps, &error), STY_ERROR_INPUT, &error,
                 PARTS("normal"));
  const StyImage *const frames[] = {blind};
  const StyAuditOptions by_frames = {.weights = STY_WEIGHT_FRAMES, .frames = frames, .frame_count = 1};
  expect_message(sty_audit_lut(lut, lut, guide, &by_frames, NULL, &out, &maps, &error), STY_ERROR_INPUT, &error,
                 PARTS("normal"));
  assert_memory_equal(&out, &before, sizeof out);
  assert_memory_equal(&maps, &maps_before, sizeof maps);
  sty_destroy_image(&blind);
  for (int e = 0; e < 7; e++) sty_destroy_lut((StyLut *[]){exacts[e]});
  sty_destroy_lut(&corners);
  sty_destroy_lut(&lut);
  sty_destroy_image(&guide);
  sty_destroy_image(&other);
}

/* ---- JSON --------------------------------------------------------------------------- */

static void expect_number(const json_t *object, const char *key, double expected) {
  const json_t *value = json_object_get(object, key);
  if (!json_is_number(value)) fail_msg("%s is missing or no number", key);
  expect_near(json_number_value(value), expected, 1e-5, key);
}

static void expect_json_figures(const json_t *object, const StyFigures *figures) {
  assert_true(json_is_object(object));
  expect_number(object, "mean", figures->mean);
  expect_number(object, "p50", figures->p50);
  expect_number(object, "p95", figures->p95);
  expect_number(object, "p99", figures->p99);
  expect_number(object, "max", figures->max);
  const json_t *at = json_object_get(object, "at");
  static const char *const places[] = {"texel", "value", "source"};
  for (int p = 0; p < 3; p++) {
    const json_t *pair = json_object_get(at, places[p]);
    assert_int_equal(json_array_size(pair), 2);
    for (size_t k = 0; k < 2; k++)
      expect_near(json_number_value(json_array_get(pair, k)),
                  p == 0   ? figures->texel[k]
                  : p == 1 ? (double)figures->value[k]
                           : figures->source[k],
                  1e-5, places[p]);
  }
}

static void test_json(void **state) {
  (void)state;
  StyImage *guide = make_sphere(20, 30);
  for (int sampling = 0; sampling < 3; sampling++) {
    StyLut *lut = build(guide, 15, (StySampling)sampling);
    lut->pixels[7 * 15 + 7] = 0; /* a corner: background */
    const StyAudit out = audit(lut, lut, guide, STY_LEVEL);
    char *text = sty_format_audit(&out);
    assert_non_null(text);
    json_error_t at;
    json_t *root = json_loads(text, JSON_REJECT_DUPLICATES, &at);
    if (!root) fail_msg("%s in %s", at.text, text);
    assert_string_equal(json_string_value(json_object_get(root, "schema")), "stylut-audit/1");
    assert_string_equal(json_string_value(json_object_get(root, "sampling")), sty_sampling_names[sampling]);
    assert_string_equal(json_string_value(json_object_get(root, "map")), "xy");
    assert_string_equal(json_string_value(json_object_get(root, "metric")), "xy");
    assert_string_equal(json_string_value(json_object_get(root, "weights")), "disc");
    expect_number(root, "size", 15);
    expect_number(root, "feasible", (double)out.feasible);
    expect_number(root, "background", 1);
    expect_number(root, "coverage", out.coverage);
    expect_number(root, "tolerance", STY_LEVEL);
    expect_json_figures(json_object_get(root, "assignment"), &out.assignment);
    expect_json_figures(json_object_get(root, "lookup"), &out.lookup);
    expect_json_figures(json_object_get(root, "excess"), &out.excess);
    expect_number(root, "optimal", out.optimal);
    expect_number(root, "unused", out.unused);
    expect_number(root, "ambiguous", out.ambiguous);
    expect_number(root, "spread", out.spread);
    expect_number(root, "jumps", out.jumps);
    expect_number(root, "unstable", out.unstable);
    expect_number(root, "jump", out.jump);
    expect_number(root, "precision", out.precision);
    for (int b = 0; b < STY_USAGE_BINS; b++)
      expect_number(json_object_get(root, "usage"), sty_usage_names[b], (double)out.usage[b]);
    json_decref(root);
    free(text);
    sty_destroy_lut(&lut);
  }
  sty_destroy_image(&guide);
}

/* ---- the smallest table that will do ---------------------------------------------- */

static void test_choose_size(void **state) {
  (void)state;
  StyImage *guide = make_sphere(60, 60);
  StySites *sites = NULL;
  StyCandidate candidates[STY_MOST_CANDIDATES];
  const StyAuditOptions options = {.weights = STY_WEIGHT_DISC};
  int count, chosen;
  assert_int_equal(sty_collect_sites("guide", guide, &sites, NULL), STY_OK);
  for (int any_map = 0; any_map < 2; any_map++) {
    const StyLutSpec spec = describe(1, STY_SAMPLE_CENTRE);
    assert_int_equal(sty_choose_size(sites, guide, &spec, any_map, STY_ENCODE_RG16, &options, &(StyBudget){.p99 = 6},
                                     &ONE_THREAD, candidates, &count, &chosen, NULL),
                     STY_OK);
    assert_in_range(chosen, 0, count - 1);
    for (int c = 0; c < count; c++) {
      if (c) assert_true(candidates[c - 1].bytes <= candidates[c].bytes);
      assert_true(c >= chosen ? candidates[chosen].lookup.p99 <= 6 : candidates[c].lookup.p99 > 6);
      assert_true(any_map || candidates[c].spec.map == STY_MAP_XY);
    }
  }
  /* Equal areas are for centres. */
  StyLutSpec odd = describe(1, STY_SAMPLE_UNORM8);
  odd.map = STY_MAP_EQUAL_AREA;
  StyError error = {STY_OK, ""};
  expect_message(sty_choose_size(sites, guide, &odd, false, STY_ENCODE_RG16, &options, &(StyBudget){.p99 = 6},
                                 &ONE_THREAD, candidates, &count, &chosen, &error),
                 STY_ERROR_USAGE, &error, PARTS("unorm8", "equal-area"));
  assert_int_equal(sty_choose_size(sites, guide, &odd, true, STY_ENCODE_RG16, &options, &(StyBudget){.p99 = 90},
                                   &ONE_THREAD, candidates, &count, &chosen, &error),
                   STY_OK);
  sty_destroy_sites(&sites);
  sty_destroy_image(&guide);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_by_hand),
      cmocka_unit_test(test_lookup_by_hand),
      cmocka_unit_test(test_sphere),
      cmocka_unit_test(test_half_a_sphere),
      cmocka_unit_test(test_byte_lookups),
      cmocka_unit_test(test_rim_lookups),
      cmocka_unit_test(test_random_tables),
      cmocka_unit_test(test_all_background),
      cmocka_unit_test(test_nothing_above_the_exact),
      cmocka_unit_test(test_excess_by_hand),
      cmocka_unit_test(test_excess_is_by_the_metric),
      cmocka_unit_test(test_usage),
      cmocka_unit_test(test_two_plateaus),
      cmocka_unit_test(test_pieces_by_hand),
      cmocka_unit_test(test_two_patches),
      cmocka_unit_test(test_sphere_is_unambiguous),
      cmocka_unit_test(test_flat_guide_is_unstable),
      cmocka_unit_test(test_weights),
      cmocka_unit_test(test_frames_that_ask_for_one_texel),
      cmocka_unit_test(test_many_frames),
      cmocka_unit_test(test_defaults_and_overrides),
      cmocka_unit_test(test_threads),
      cmocka_unit_test(test_what_does_not_fit),
      cmocka_unit_test(test_json),
      cmocka_unit_test(test_choose_size),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
