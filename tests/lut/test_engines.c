#include <float.h>
#include <math.h>

#include "../scratch.h"
#include "stylut/guide.h"
#include "stylut/lut.h"

/* ---- guides that try to hurt a search ----------------------------------------- */

typedef enum Kind {
  BYTES,   /* as in an 8-bit file */
  WORDS,   /* as in a 16-bit file */
  FLOATS,  /* anywhere in the square */
  LATTICE, /* few values; texels lie exactly between them */
  ALL_EQUAL,
  CIRCLE,      /* about (0, 0): equally far from the middle, up to rounding */
  MIRRORED,    /* (+-a, +-b), (+-b, +-a): equally far exactly */
  FAR,         /* up to 1000: differences drown in rounding */
  FAR_CLUSTER, /* neighbours in float, far away: hundreds of ties by rounding alone */
  DENORMALS,   /* squares vanish */
  ZEROS,       /* of both signs */
  CLUSTER,     /* neighbours in float, inside the square */
  LINE,        /* one coordinate never changes: a kd-tree can split one way only */
  OUTLIERS,    /* a cluster, and now and then a value far away: bounds of a tree lose their precision */
  KINDS
} Kind;

static float step_floats(float value, int steps) {
  for (int i = 0; i < steps; i++) value = nextafterf(value, INFINITY);
  return value;
}

static void draw_value(Kind kind, const float base[2], uint64_t *random, float g[2]) {
  for (int k = 0; k < 2; k++) {
    switch (kind) {
      case BYTES: g[k] = (float)(2 * draw_below(random, 256) - 255) / 255.0f; break;
      case WORDS: g[k] = (float)(2 * draw_below(random, 65536) - 65535) / 65535.0f; break;
      case LATTICE: g[k] = (float)(draw_below(random, 9) - 4) / 4.0f; break;
      case ALL_EQUAL: g[k] = base[k]; break;
      case MIRRORED: g[k] = draw_below(random, 2) ? base[k] : -base[k]; break;
      case FAR: g[k] = draw_signed(random) * 1000.0f; break;
      case FAR_CLUSTER: g[k] = step_floats(base[k] > 0 ? 999.0f : -999.0f, draw_below(random, 20)); break;
      case DENORMALS: g[k] = draw_signed(random) * powf(10, (float)-draw_below(random, 45)); break;
      case ZEROS: g[k] = (draw_below(random, 2) ? -1.0f : 1.0f) * (draw_below(random, 4) ? 0.0f : 0.5f); break;
      case CLUSTER: g[k] = step_floats(base[k], draw_below(random, 40)); break;
      case OUTLIERS:
        g[k] = draw_below(random, 10) ? base[k] + draw_signed(random) * 1e-3f : draw_signed(random) * 1000;
        break;
      case LINE: g[k] = k == (base[0] > 0) ? base[1] : draw_signed(random); break;
      default: g[k] = draw_signed(random); break;
    }
  }
  if (kind == CIRCLE) {
    const float angle = draw_signed(random) * 3.14159265f, radius = 0.25f + 0.5f * fabsf(base[0]);
    g[0] = radius * cosf(angle);
    g[1] = radius * sinf(angle);
  }
  if (kind == MIRRORED && draw_below(random, 2)) {
    const float first = g[0];
    g[0] = g[1];
    g[1] = first;
  }
}

static StyImage *make_guide(Kind kind, int width, int height, uint64_t *random) {
  static const char *const names[] = {"A", "normal.X", "normal.Y"};
  StyImage *guide = NULL;
  assert_int_equal(sty_create_image(width, height, 3, names, 32, &guide, NULL), STY_OK);
  const int count = width * height, holes = draw_below(random, 2);
  const float base[2] = {draw_signed(random), draw_signed(random)};
  for (int i = 0; i < count; i++) {
    guide->data[i] = (float)(i == count - 1 || !holes || draw_below(random, 3));
    float g[2];
    draw_value(kind, base, random, g);
    guide->data[count + i] = g[0];
    guide->data[2 * count + i] = g[1];
  }
  return guide;
}

static StySites *collect(const StyImage *guide) {
  StySites *sites = NULL;
  assert_int_equal(sty_collect_sites("guide", guide, &sites, NULL), STY_OK);
  return sites;
}

static const StyEngine *find_engine(const char *name) {
  const StyEngine *engine = NULL;
  assert_int_equal(sty_find_engine("-e", name, &engine, NULL), STY_OK);
  return engine;
}

static StyLut *build(const StySites *sites, const char *engine, int size, int sampling, int threads) {
  const StyRun run = {.threads = threads};
  StyLut *lut = NULL;
  StyError error = {STY_OK, ""};
  if (sty_build_lut(sites, find_engine(engine), size, (StySampling)sampling, &run, &lut, &error) != STY_OK)
    fail_msg("%s, size %d: %s", engine, size, error.text);
  return lut;
}

static int random_side(uint64_t *random) {
  const int large = draw_below(random, 12) == 0;
  return 1 + draw_below(random, large ? 64 : 14);
}

/* ---- comparisons --------------------------------------------------------------- */

/* lut.h's definition of exact, word by word: pixel after pixel, in float. */
static void expect_literal(const StyLut *lut, const StyImage *guide, int kind) {
  const int count = guide->width * guide->height;
  const float *a = sty_find_channel(guide, "A"), *x = sty_find_channel(guide, "normal.X"),
              *y = sty_find_channel(guide, "normal.Y");
  assert_int_equal(lut->source_width, guide->width);
  assert_int_equal(lut->source_height, guide->height);
  for (int t = 0; t < lut->size * lut->size; t++) {
    float g[2], least = INFINITY;
    int nearest = -1;
    sty_get_texel_value(lut, t % lut->size, t / lut->size, g);
    for (int p = 0; p < count; p++) {
      if (!(a[p] > 0)) continue;
      const float distance = (g[0] - x[p]) * (g[0] - x[p]) + (g[1] - y[p]) * (g[1] - y[p]);
      if (distance < least) {
        least = distance;
        nearest = p;
      }
    }
    if (lut->pixels[t] != (uint32_t)nearest)
      fail_msg("kind %d, guide %dx%d, table %d, texel %d: pixel %u instead of %d", kind, guide->width, guide->height,
               lut->size, t, lut->pixels[t], nearest);
    const double distance = hypot((double)g[0] - x[nearest], (double)g[1] - y[nearest]);
    if (!(fabs(lut->errors[t] - distance) <= 1e-6 * distance + 1e-30))
      fail_msg("kind %d, texel %d: error %g instead of %g", kind, t, (double)lut->errors[t], distance);
  }
}

static void expect_same(const StyLut *a, const StyLut *b, const char *what) {
  const size_t texels = (size_t)a->size * (size_t)a->size;
  for (size_t t = 0; t < texels; t++)
    if (a->pixels[t] != b->pixels[t] || memcmp(&a->errors[t], &b->errors[t], sizeof(float)))
      fail_msg("%s: texel %zu of size %d: pixel %u error %.9g against pixel %u error %.9g", what, t, a->size,
               a->pixels[t], (double)a->errors[t], b->pixels[t], (double)b->errors[t]);
}

/* ---- tests --------------------------------------------------------------------- */

static void test_names(void **state) {
  (void)state;
  assert_string_equal(sty_engines[0].name, "brute");
  assert_true(sty_engines[0].exact);
  int count = 0;
  for (; sty_engines[count].name; count++) {
    assert_ptr_equal(find_engine(sty_engines[count].name), &sty_engines[count]);
    assert_true(sty_engines[count].summary && sty_engines[count].summary[0]);
  }
  assert_false(find_engine("analytic")->exact);
  assert_true(find_engine("flann-single")->exact);
  assert_true(find_engine("auto")->exact);
  static const char *const bad[] = {"", "Brute", "brut", "brute ", "kd"};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    const StyEngine *engine = NULL;
    StyError error = {STY_OK, ""};
    expect_message(sty_find_engine("--engine", bad[i], &engine, &error), STY_ERROR_USAGE, &error,
                   PARTS("--engine", bad[i], "auto", "brute", "analytic", "flann-single"));
    assert_null(engine);
  }
}

static void test_brute_is_literal(void **state) {
  (void)state;
  static const int sizes[] = {1, 2, 3, 5, 17};
  uint64_t random = 11;
  for (int trial = 0; trial < CASES(1300, 260); trial++) {
    const int kind = trial % KINDS, sampling = draw_below(&random, 2), size = sizes[draw_below(&random, 5)];
    if (sampling == STY_SAMPLE_UNORM8 && size == 1) continue;
    StyImage *guide = make_guide((Kind)kind, random_side(&random), random_side(&random), &random);
    StySites *sites = collect(guide);
    StyLut *lut = build(sites, "brute", size, sampling, 1);
    assert_int_equal(lut->size, size);
    assert_int_equal(lut->sampling, sampling);
    expect_literal(lut, guide, kind);
    sty_destroy_lut(&lut);
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
}

/* Every exact engine gives the bytes of the reference. */
static void test_exact_engines(void **state) {
  (void)state;
  uint64_t random = 12;
  for (int trial = 0; trial < CASES(6000, 600); trial++) {
    const int kind = trial % KINDS, roll = draw_below(&random, 64);
    const int size = roll == 0 ? 256 : roll < 8 ? 64 : roll < 30 ? 17 : 1 + draw_below(&random, 3);
    const int sampling = size == 1 ? STY_SAMPLE_CENTRE : draw_below(&random, 2);
    const int width = size == 256 ? 1 + draw_below(&random, 16) : random_side(&random);
    const int height = size == 256 ? 1 + draw_below(&random, 16) : random_side(&random);
    StyImage *guide = make_guide((Kind)kind, width, height, &random);
    StySites *sites = collect(guide);
    StyLut *reference = build(sites, "brute", size, sampling, 1);
    for (const StyEngine *engine = sty_engines + 1; engine->name; engine++) {
      if (!engine->exact) continue;
      StyLut *lut = build(sites, engine->name, size, sampling, 1);
      char what[100];
      snprintf(what, sizeof what, "%s, kind %d, trial %d, guide %dx%d", engine->name, kind, trial, width, height);
      expect_same(lut, reference, what);
      sty_destroy_lut(&lut);
    }
    sty_destroy_lut(&reference);
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
}

/* Full-size guides of each kind, where trees are deep. */
static void test_exact_engines_on_larger_guides(void **state) {
  (void)state;
  uint64_t random = 13;
  for (int kind = 0; kind < KINDS; kind++) {
    for (int sampling = 0; sampling < 2; sampling++) {
      StyImage *guide = make_guide((Kind)kind, 64, CASES(64, 30), &random);
      StySites *sites = collect(guide);
      StyLut *reference = build(sites, "brute", CASES(101, 40), sampling, 2);
      StyLut *lut = build(sites, "flann-single", CASES(101, 40), sampling, 2);
      expect_same(lut, reference, "large");
      sty_destroy_lut(&lut);
      sty_destroy_lut(&reference);
      sty_destroy_sites(&sites);
      sty_destroy_image(&guide);
    }
  }
}

static void test_threads(void **state) {
  (void)state;
  uint64_t random = 14;
  for (int kind = 0; kind < KINDS; kind++) {
    StyImage *guide = make_guide((Kind)kind, 20, 20, &random);
    StySites *sites = collect(guide);
    for (const StyEngine *engine = sty_engines; engine->name; engine++) {
      if (!engine->exact) continue;
      static const int sizes[] = {1, 2, 3, 64};
      for (int s = 0; s < 4; s++) {
        StyLut *one = build(sites, engine->name, sizes[s], STY_SAMPLE_CENTRE, 1);
        for (int threads = 2; threads <= 3; threads++) {
          StyLut *more = build(sites, engine->name, sizes[s], STY_SAMPLE_CENTRE, threads);
          expect_same(more, one, engine->name);
          sty_destroy_lut(&more);
        }
        sty_destroy_lut(&one);
      }
    }
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
}

static StyImage *make_sphere(int width, int height) {
  StyImage *guide = NULL;
  assert_int_equal(sty_make_sphere_guide(width, height, STY_GUIDE_NORMAL, &guide, NULL), STY_OK);
  return guide;
}

static void test_analytic(void **state) {
  (void)state;
  static const int spheres[][2] = {{1, 1},   {2, 2},     {3, 3},     {16, 16}, {17, 17},
                                   {64, 64}, {100, 100}, {128, 128}, {40, 90}, {200, 33}};
  static const int sizes[] = {2, 3, 17, 64, 100};
  for (size_t s = 0; s < sizeof spheres / sizeof *spheres; s++) {
    const int width = spheres[s][0], height = spheres[s][1];
    StyImage *guide = make_sphere(width, height);
    StySites *sites = collect(guide);
    const float *a = sty_find_channel(guide, "A"), *x = sty_find_channel(guide, "normal.X"),
                *y = sty_find_channel(guide, "normal.Y");
    for (int z = 0; z < CASES(5, 3); z++) {
      for (int sampling = 0; sampling < 2; sampling++) {
        StyLut *lut = build(sites, "analytic", sizes[z], sampling, 1);
        StyLut *reference = build(sites, "flann-single", sizes[z], sampling, 1);
        for (int t = 0; t < lut->size * lut->size; t++) {
          float g[2];
          sty_get_texel_value(lut, t % lut->size, t / lut->size, g);
          const uint32_t p = lut->pixels[t];
          assert_true(p < (uint32_t)(width * height));
          assert_true(a[p] > 0);
          const double dx = fabs((double)g[0] - x[p]), dy = fabs((double)g[1] - y[p]), found = hypot(dx, dy);
          assert_true(fabs(lut->errors[t] - found) <= 1e-6);
          if (g[0] * g[0] + g[1] * g[1] > 1) continue;
          /* Where the pixel under the value isn't covered (the rim), no answer is that close, and half a pixel
           * above the best that can be had is what remains. */
          const double half_x = 1.0 / width + 1e-6, half_y = 1.0 / height + 1e-6;
          if (dx <= half_x && dy <= half_y) continue;
          if (found > reference->errors[t] + hypot(half_x, half_y))
            fail_msg("sphere %dx%d, table %d, sampling %d: (%g, %g) is answered %g off, best %g", width, height,
                     lut->size, sampling, (double)g[0], (double)g[1], found, (double)reference->errors[t]);
          const int column = (int)((g[0] + 1) / 2 * (float)width), row = (int)((1 - g[1]) / 2 * (float)height);
          const int inside = column < width && row < height;
          if (inside && a[row * width + column] > 0) {
            /* On the border of two pixels rounding may pick the other one. */
            const double bx = fabs((double)g[0] - x[row * width + column]),
                         by = fabs((double)g[1] - y[row * width + column]);
            if (bx < half_x - 1e-5 && by < half_y - 1e-5)
              fail_msg("sphere %dx%d, table %d, sampling %d: (%g, %g) is answered (%g, %g) off", width, height,
                       lut->size, sampling, (double)g[0], (double)g[1], dx, dy);
          }
        }
        StyLut *threaded = build(sites, "analytic", sizes[z], sampling, 3);
        expect_same(threaded, lut, "analytic on three threads");
        sty_destroy_lut(&threaded);
        sty_destroy_lut(&reference);
        sty_destroy_lut(&lut);
      }
    }
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
}

static void test_analytic_on_large_spheres(void **state) {
  (void)state;
  static const int spheres[][2] = {{256, 256}, {512, 512}, {512, 300}};
  for (size_t s = 0; s < CASES(3, 1); s++) {
    const int width = spheres[s][0], height = spheres[s][1];
    StyImage *guide = make_sphere(width, height);
    StySites *sites = collect(guide);
    StyLut *lut = build(sites, "analytic", 256, STY_SAMPLE_UNORM8, 2);
    StyLut *reference = build(sites, "flann-single", 256, STY_SAMPLE_UNORM8, 2);
    const double half = hypot(1.0 / width, 1.0 / height);
    for (int t = 0; t < 65536; t++) {
      float g[2];
      sty_get_texel_value(lut, t % 256, t / 256, g);
      if (g[0] * g[0] + g[1] * g[1] > 1) continue;
      assert_true(lut->errors[t] <= reference->errors[t] + half + 1e-6);
      assert_true(lut->errors[t] >= reference->errors[t] - 1e-6);
    }
    sty_destroy_lut(&reference);
    sty_destroy_lut(&lut);
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
}

static void expect_no_sphere(StyImage *guide, const char *what) {
  StySites *sites = collect(guide);
  StyLut *lut = NULL;
  StyError error = {STY_OK, ""};
  const StyStatus status = sty_build_lut(sites, find_engine("analytic"), 16, STY_SAMPLE_CENTRE, NULL, &lut, &error);
  if (status == STY_OK) fail_msg("%s passes as a sphere", what);
  expect_message(status, STY_ERROR_INPUT, &error, PARTS("analytic"));
  assert_null(lut);
  sty_destroy_sites(&sites);
  sty_destroy_image(&guide);
}

static void test_analytic_refuses(void **state) {
  (void)state;
  enum { SIDE = 32, COUNT = SIDE * SIDE };
  uint64_t random = 15;
  expect_no_sphere(make_guide(FLOATS, SIDE, SIDE, &random), "noise");
  expect_no_sphere(make_guide(ALL_EQUAL, SIDE, SIDE, &random), "a plane");

  StyImage *guide = make_sphere(SIDE, SIDE);
  float *a, *x, *y = sty_find_channel(guide, "normal.Y");
  for (int i = 0; i < COUNT; i++) y[i] = -y[i];
  expect_no_sphere(guide, "a sphere upside down");

  guide = make_sphere(SIDE, SIDE);
  x = sty_find_channel(guide, "normal.X");
  x[SIDE / 2 * SIDE + SIDE / 2] += 0.5f;
  expect_no_sphere(guide, "a sphere with a dent");

  /* A sphere that leaves a border. */
  guide = make_sphere(SIDE, SIDE);
  a = sty_find_channel(guide, "A"), x = sty_find_channel(guide, "normal.X"), y = sty_find_channel(guide, "normal.Y");
  for (int i = 0; i < COUNT; i++) {
    x[i] *= 1.25f, y[i] *= 1.25f;
    if (x[i] * x[i] + y[i] * y[i] > 1) a[i] = x[i] = y[i] = 0;
  }
  expect_no_sphere(guide, "a small sphere");
}

/* A sphere with pixels missing is refused, or its answers are covered and still about the best there are. */
static void test_analytic_with_holes(void **state) {
  (void)state;
  enum { SIDE = 40 };
  uint64_t random = 16;
  for (int trial = 0; trial < 60; trial++) {
    StyImage *guide = make_sphere(SIDE, SIDE);
    float *a = sty_find_channel(guide, "A");
    const int cx = draw_below(&random, SIDE), cy = draw_below(&random, SIDE), radius = 1 + draw_below(&random, 12);
    for (int i = 0; i < SIDE * SIDE; i++) {
      const int dx = i % SIDE - cx, dy = i / SIDE - cy;
      if (dx * dx + dy * dy < radius * radius) a[i] = 0;
    }
    StySites *sites = collect(guide);
    StyLut *lut = NULL;
    const StyStatus status = sty_build_lut(sites, find_engine("analytic"), 33, STY_SAMPLE_CENTRE, NULL, &lut, NULL);
    StyLut *reference = build(sites, "brute", 33, STY_SAMPLE_CENTRE, 1);
    if (status != STY_OK) assert_int_equal(status, STY_ERROR_INPUT);
    for (int t = 0; lut && t < 33 * 33; t++) {
      float g[2];
      sty_get_texel_value(lut, t % 33, t / 33, g);
      assert_true(a[lut->pixels[t]] > 0);
      if (g[0] * g[0] + g[1] * g[1] > 1) continue;
      if (lut->errors[t] > reference->errors[t] + 2.0f / SIDE)
        fail_msg("hole of %d at (%d, %d): (%g, %g) is answered %g off, best %g", radius, cx, cy, (double)g[0],
                 (double)g[1], (double)lut->errors[t], (double)reference->errors[t]);
    }
    sty_destroy_lut(&reference);
    sty_destroy_lut(&lut);
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
}

static void test_bad_sizes(void **state) {
  (void)state;
  StyImage *guide = make_sphere(8, 8);
  StySites *sites = collect(guide);
  static const int bad[] = {0, -1, STY_MAX_LUT_SIZE + 1};
  for (const StyEngine *engine = sty_engines; engine->name; engine++) {
    for (int i = 0; i < 3; i++) {
      StyLut *lut = NULL;
      StyError error = {STY_OK, ""};
      assert_int_not_equal(sty_build_lut(sites, engine, bad[i], STY_SAMPLE_CENTRE, NULL, &lut, &error), STY_OK);
      assert_null(lut);
    }
  }
  sty_destroy_sites(&sites);
  sty_destroy_image(&guide);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_names),
      cmocka_unit_test(test_brute_is_literal),
      cmocka_unit_test(test_exact_engines),
      cmocka_unit_test(test_exact_engines_on_larger_guides),
      cmocka_unit_test(test_threads),
      cmocka_unit_test(test_analytic),
      cmocka_unit_test(test_analytic_on_large_spheres),
      cmocka_unit_test(test_analytic_refuses),
      cmocka_unit_test(test_analytic_with_holes),
      cmocka_unit_test(test_bad_sizes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
