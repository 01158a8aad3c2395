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

static StyLut *build(const StyImage *guide, int size, StySampling sampling) {
  StySites *sites = NULL;
  StyLut *lut = NULL;
  assert_int_equal(sty_collect_sites("guide", guide, &sites, NULL), STY_OK);
  assert_int_equal(sty_build_lut(sites, exact_engine(), size, sampling, NULL, &lut, NULL), STY_OK);
  sty_destroy_sites(&sites);
  return lut;
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

static StyAudit audit(const StyLut *lut, const StyLut *exact, const StyImage *guide, double tolerance) {
  StyAudit out;
  StyError error = {STY_OK, ""};
  if (sty_audit_lut(lut, exact, guide, tolerance, &out, &error) != STY_OK) fail_msg("%s", error.text);
  return out;
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
  assert_int_equal(out.size, 2);
  assert_int_equal(out.sampling, STY_SAMPLE_CENTRE);
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
  for (int sampling = 0; sampling < 2; sampling++) {
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
  assert_true(exact.lookup.mean == exact.assignment.mean && exact.lookup.p99 == exact.assignment.p99);
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
    sty_get_texel_value(lut, t % 64, t / 64, g);
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
  const int texels = lut->size * lut->size;
  double *angles = malloc((size_t)texels * sizeof *angles), sum = 0, max = -1, at_max = -1;
  assert_non_null(angles);
  int count = 0, background = 0, covered = 0;
  for (int t = 0; t < texels; t++) {
    float g[2];
    sty_get_texel_value(lut, t % lut->size, t / lut->size, g);
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
    if (t == out.assignment.texel[1] * lut->size + out.assignment.texel[0]) {
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
    const StySampling sampling = (StySampling)draw_below(&random, 2);
    StyLut *exact = build(guide, size, sampling), *lut = build(guide, size, sampling);
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
  for (float g[2]; sty_get_texel_value(lut, first % 9, first / 9, g), g[0] * g[0] + g[1] * g[1] > 1;) first++;
  assert_int_equal(out.assignment.texel[1] * 9 + out.assignment.texel[0], first);
  sty_destroy_lut(&lut);
  sty_destroy_lut(&exact);
  sty_destroy_image(&guide);
}

static void test_sizes_that_do_not_fit(void **state) {
  (void)state;
  StyImage *guide = make_sphere(8, 8), *other = make_sphere(8, 9);
  StyLut *lut = build(guide, 16, STY_SAMPLE_CENTRE), *larger = build(guide, 17, STY_SAMPLE_CENTRE);
  StyLut *smaller = build(guide, 3, STY_SAMPLE_CENTRE);
  StyLut *unorm8 = build(guide, 16, STY_SAMPLE_UNORM8), *foreign = build(other, 16, STY_SAMPLE_CENTRE);
  StyAudit out;
  memset(&out, 7, sizeof out);
  const StyAudit before = out;
  StyError error;
  expect_message(sty_audit_lut(lut, lut, other, 0.1, &out, &error), STY_ERROR_INPUT, &error, PARTS("8", "9"));
  expect_message(sty_audit_lut(lut, larger, guide, 0.1, &out, &error), STY_ERROR_INPUT, &error, PARTS(""));
  expect_message(sty_audit_lut(lut, smaller, guide, 0.1, &out, &error), STY_ERROR_INPUT, &error, PARTS(""));
  expect_message(sty_audit_lut(lut, unorm8, guide, 0.1, &out, &error), STY_ERROR_INPUT, &error, PARTS(""));
  expect_message(sty_audit_lut(lut, foreign, guide, 0.1, &out, &error), STY_ERROR_INPUT, &error, PARTS(""));
  expect_message(sty_audit_lut(foreign, lut, guide, 0.1, &out, &error), STY_ERROR_INPUT, &error, PARTS(""));
  assert_memory_equal(&out, &before, sizeof out);
  sty_destroy_lut(&lut);
  sty_destroy_lut(&larger);
  sty_destroy_lut(&smaller);
  sty_destroy_lut(&unorm8);
  sty_destroy_lut(&foreign);
  sty_destroy_image(&guide);
  sty_destroy_image(&other);
}

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
  for (int sampling = 0; sampling < 2; sampling++) {
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
    expect_number(root, "size", 15);
    expect_number(root, "feasible", (double)out.feasible);
    expect_number(root, "background", 1);
    expect_number(root, "coverage", out.coverage);
    expect_number(root, "tolerance", STY_LEVEL);
    expect_json_figures(json_object_get(root, "assignment"), &out.assignment);
    expect_json_figures(json_object_get(root, "lookup"), &out.lookup);
    json_decref(root);
    free(text);
    sty_destroy_lut(&lut);
  }
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
      cmocka_unit_test(test_sizes_that_do_not_fit),
      cmocka_unit_test(test_json),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
