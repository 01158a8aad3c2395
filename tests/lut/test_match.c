#include <math.h>

#include "../scratch.h"
#include "stylut/match.h"

/* ---- guides of any channels ------------------------------------------------------ */

typedef enum Kind {
  UNIFORM,
  BYTES,   /* as in an 8-bit file */
  LATTICE, /* few values a channel: many pixels are equally near */
  FEW,     /* each value many times */
  ALL_EQUAL,
  LINE,     /* one channel alone says anything */
  PATHS,    /* all channels follow from two numbers, up to noise: as light paths do */
  FAR,      /* up to 1000 */
  CLUSTER,  /* neighbours in float, far out: ties by rounding alone */
  OUTLIERS, /* a cluster, and now and then a value far away */
  DENORMALS,
  ZEROS, /* of both signs */
  KINDS
} Kind;

static float step_floats(float value, int steps) {
  for (int i = 0; i < steps; i++) value = nextafterf(value, INFINITY);
  return value;
}

static float draw_value(Kind kind, int channel, const float path[2], uint64_t *random) {
  const float angle = path[0] * (float)(channel % 5 + 1) + path[1] * (float)(channel % 3);
  switch (kind) {
    case BYTES: return (float)draw_below(random, 256) / 255.0f;
    case LATTICE: return (float)draw_below(random, 3) / 2.0f;
    case FEW: return path[0] > 0 ? 0.25f * (float)channel : path[1] > 0 ? 0.5f : -0.5f;
    case ALL_EQUAL: return 0.1f * (float)channel;
    case LINE: return channel == 0 ? draw_signed(random) : 0.3f;
    case PATHS: return sinf(angle) + 0.01f * draw_signed(random);
    case FAR: return draw_signed(random) * 1000;
    case CLUSTER: return step_floats(channel % 2 ? 999.0f : -999.0f, draw_below(random, 8));
    case OUTLIERS: return draw_below(random, 10) ? draw_signed(random) * 1e-3f : draw_signed(random) * 1000;
    case DENORMALS: return draw_signed(random) * powf(10, (float)-draw_below(random, 45));
    case ZEROS: return (draw_below(random, 2) ? -1.0f : 1.0f) * (draw_below(random, 4) ? 0.0f : 0.5f);
    default: return draw_signed(random);
  }
}

/* Channels A and c.0, c.1, ...; with `holes` two thirds are covered, the last pixel always. */
static StyImage *make_guide(Kind kind, int dims, int width, int height, int holes, uint64_t *random) {
  char text[STY_MOST_DIMS][16];
  const char *names[STY_MOST_DIMS + 1] = {"A"};
  for (int k = 0; k < dims; k++) {
    snprintf(text[k], sizeof text[k], "c.%d", k);
    names[k + 1] = text[k];
  }
  StyImage *guide = NULL;
  assert_int_equal(sty_create_image(width, height, dims + 1, names, 32, &guide, NULL), STY_OK);
  const size_t count = sty_count_pixels(guide);
  for (size_t i = 0; i < count; i++) {
    const float path[2] = {draw_signed(random), draw_signed(random)};
    guide->data[i] = (float)(i == count - 1 || !holes || draw_below(random, 3));
    for (int k = 0; k < dims; k++)
      guide->data[(size_t)(k + 1) * count + i] = guide->data[i] > 0 ? draw_value(kind, k, path, random) : NAN;
  }
  return guide;
}

static StySites *collect(const StyImage *guide) {
  static const StyFeature all = {"c", 1};
  StySites *sites = NULL;
  StyError error = {STY_OK, ""};
  if (sty_collect_features("guide", guide, &all, 1, &sites, &error)) fail_msg("%s", error.text);
  return sites;
}

static const StyEngine *find_engine(const char *name) {
  const StyEngine *engine = NULL;
  assert_int_equal(sty_find_engine("-e", name, &engine, NULL), STY_OK);
  return engine;
}

static int takes(const StyEngine *engine, int dims) { return engine->least_dims <= dims && dims <= engine->most_dims; }

/* NULL where this build goes without the engine. */
static StyField *try_match(const StySites *sites, const StyEngine *engine, const StyEngineOptions *options,
                           const StyImage *target, int threads) {
  const StyRun run = {.threads = threads};
  StyField *field = NULL;
  StyError error = {STY_OK, ""};
  const StyStatus status = sty_match_guide(sites, engine, options, "target", target, &run, &field, &error);
  if (status == STY_ERROR_UNAVAILABLE) return NULL;
  if (status) fail_msg("%s, %d dimensions: %s", engine->name, sites->dims, error.text);
  return field;
}

/* ---- the rule, in the plainest words --------------------------------------------- */

static uint32_t find_nearest(const StyImage *source, const float *weights, const StyImage *target, size_t pixel,
                             float *distance) {
  const size_t here = sty_count_pixels(target), there = sty_count_pixels(source);
  float least = INFINITY;
  uint32_t nearest = STY_NO_PIXEL;
  for (size_t p = 0; p < there; p++) {
    if (!(source->data[p] > 0)) continue;
    float sum = 0;
    for (int k = 1; k < source->channel_count; k++) {
      const float weight = weights ? weights[k - 1] : 1;
      const float a = target->data[(size_t)k * here + pixel] * weight, b = source->data[(size_t)k * there + p] * weight;
      const float square = (a - b) * (a - b);
      sum = sum + square;
    }
    if (!(sum < least)) continue;
    least = sum;
    nearest = (uint32_t)p;
  }
  *distance = (float)sqrt((double)least);
  return nearest;
}

static void expect_literal(const StyField *field, const StyImage *source, const float *weights, const StyImage *target,
                           const char *what, int kind) {
  assert_int_equal(field->width, target->width);
  assert_int_equal(field->height, target->height);
  assert_int_equal(field->source_width, source->width);
  assert_int_equal(field->source_height, source->height);
  size_t matched = 0;
  for (size_t i = 0; i < sty_count_pixels(target); i++) {
    float distance = 0;
    uint32_t pixel = STY_NO_PIXEL;
    if (target->data[i] > 0) pixel = find_nearest(source, weights, target, i, &distance);
    matched += pixel != STY_NO_PIXEL;
    if (field->pixels[i] != pixel || field->errors[i] != distance)
      fail_msg("%s, kind %d, %d channels, pixel %zu: %u at %.9g, expected %u at %.9g", what, kind,
               source->channel_count - 1, i, field->pixels[i], (double)field->errors[i], pixel, (double)distance);
  }
  assert_int_equal(field->matched, matched);
}

static const int DIMS[] = {1, 2, 3, 6, 15, 32};
enum { DIM_COUNT = sizeof DIMS / sizeof *DIMS };

static int random_side(uint64_t *random) { return 1 + draw_below(random, draw_below(random, 6) ? 9 : 25); }

static void test_exact_engines(void **state) {
  (void)state;
  uint64_t random = 31;
  for (int trial = 0; trial < CASES(KINDS * DIM_COUNT * 12, KINDS * DIM_COUNT); trial++) {
    const int kind = trial % KINDS, dims = DIMS[trial / KINDS % DIM_COUNT], holes = draw_below(&random, 2);
    StyImage *source = make_guide((Kind)kind, dims, random_side(&random), random_side(&random), holes, &random);
    /* Other guides of the kind, of another, and the source itself. */
    const int other = draw_below(&random, 3) ? kind : draw_below(&random, KINDS);
    StyImage *target = make_guide((Kind)other, dims, random_side(&random), random_side(&random), holes, &random);
    StySites *sites = collect(source);
    for (const StyEngine *engine = sty_engines; engine->name; engine++) {
      if (!engine->exact || !takes(engine, dims)) continue;
      StyField *field = try_match(sites, engine, NULL, target, 1 + trial % 3);
      if (field) expect_literal(field, source, NULL, target, engine->name, kind);
      sty_destroy_field(&field);
    }
    sty_destroy_sites(&sites);
    sty_destroy_image(&target);
    sty_destroy_image(&source);
  }
}

/* Guides of one and of two pixels; targets of more than a row of what engines are asked at once. */
static void test_few_points(void **state) {
  (void)state;
  uint64_t random = 32;
  for (int trial = 0; trial < 4 * DIM_COUNT; trial++) {
    const int dims = DIMS[trial / 4], width = 1 + trial % 2;
    StyImage *source = make_guide(UNIFORM, dims, width, 1, 0, &random);
    StyImage *target = make_guide(UNIFORM, dims, 257, 3, 1, &random);
    StySites *sites = collect(source);
    for (const StyEngine *engine = sty_engines; engine->name; engine++) {
      if (!takes(engine, dims) || strcmp(engine->name, "analytic") == 0) continue;
      StyField *field = try_match(sites, engine, NULL, target, 2);
      if (!field) continue;
      if (engine->exact) expect_literal(field, source, NULL, target, engine->name, UNIFORM);
      assert_int_equal(field->unique, width);
      for (size_t i = 0; i < sty_count_pixels(target); i++)
        assert_true(target->data[i] > 0 ? field->pixels[i] < (uint32_t)width : field->pixels[i] == STY_NO_PIXEL);
      sty_destroy_field(&field);
    }
    sty_destroy_sites(&sites);
    sty_destroy_image(&target);
    sty_destroy_image(&source);
  }
}

/* Every pixel finds itself, or the first that has the same values. */
static void test_self(void **state) {
  (void)state;
  uint64_t random = 33;
  for (int trial = 0; trial < KINDS * DIM_COUNT; trial++) {
    StyImage *guide = make_guide((Kind)(trial % KINDS), DIMS[trial / KINDS], 30, 20, trial % 2, &random);
    StySites *sites = collect(guide);
    StyField *field = try_match(sites, sty_get_fastest_engine(STY_TASK_CUBE_OR_FIELD, sites->dims), NULL, guide, 2);
    assert_non_null(field);
    const size_t count = sty_count_pixels(guide);
    for (size_t i = 0; i < count; i++) {
      if (!(guide->data[i] > 0)) continue;
      assert_true(field->errors[i] == 0);
      assert_true(field->pixels[i] <= i);
      for (int k = 1; trial % KINDS != DENORMALS && k < guide->channel_count; k++)
        assert_true(guide->data[(size_t)k * count + i] == guide->data[(size_t)k * count + field->pixels[i]]);
    }
    sty_destroy_field(&field);
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
}

static void test_weights(void **state) {
  (void)state;
  static const float weights[] = {0.001f, 3, 250};
  static const StyFeature features[] = {{"c.0", 0.001f}, {"c.1", 3}, {"c.2", 250}};
  uint64_t random = 34;
  for (int trial = 0; trial < 20; trial++) {
    StyImage *source = make_guide(UNIFORM, 3, 20, 20, 1, &random), *target = make_guide(UNIFORM, 3, 15, 9, 1, &random);
    StySites *sites = NULL;
    assert_int_equal(sty_collect_features("s", source, features, 3, &sites, NULL), STY_OK);
    for (const StyEngine *engine = sty_engines; engine->name; engine++) {
      if (!engine->exact || !takes(engine, 3)) continue;
      StyField *field = try_match(sites, engine, NULL, target, 1);
      if (field) expect_literal(field, source, weights, target, engine->name, UNIFORM);
      sty_destroy_field(&field);
    }
    sty_destroy_sites(&sites);
    sty_destroy_image(&target);
    sty_destroy_image(&source);
  }
}

/* A target's channels may stand in another order, among others. */
static void test_channels_by_name(void **state) {
  (void)state;
  uint64_t random = 35;
  StyImage *source = make_guide(UNIFORM, 3, 12, 12, 0, &random), *target = NULL;
  static const char *const names[] = {"other", "c.2", "A", "c.0", "c.1"};
  static const int from[] = {-1, 3, 0, 1, 2};
  assert_int_equal(sty_create_image(12, 12, 5, names, 32, &target, NULL), STY_OK);
  for (int c = 0; c < 5; c++)
    for (int i = 0; i < 144; i++) target->data[c * 144 + i] = from[c] < 0 ? NAN : source->data[from[c] * 144 + i];
  StySites *sites = collect(source);
  StyField *field = try_match(sites, find_engine("brute"), NULL, target, 1);
  for (uint32_t i = 0; i < 144; i++) assert_true(field->pixels[i] == i && field->errors[i] == 0);
  sty_destroy_field(&field);
  sty_destroy_sites(&sites);
  sty_destroy_image(&target);
  sty_destroy_image(&source);
}

static void test_empty_target(void **state) {
  (void)state;
  uint64_t random = 36;
  StyImage *source = make_guide(UNIFORM, 4, 5, 5, 0, &random), *target = make_guide(UNIFORM, 4, 6, 3, 0, &random);
  for (int i = 0; i < 18; i++) target->data[i] = 0;
  StySites *sites = collect(source);
  for (const StyEngine *engine = sty_engines; engine->name; engine++) {
    if (!takes(engine, 4)) continue;
    StyField *field = try_match(sites, engine, NULL, target, 1);
    assert_int_equal(field->matched, 0);
    for (int i = 0; i < 18; i++) assert_true(field->pixels[i] == STY_NO_PIXEL && field->errors[i] == 0);
    sty_destroy_field(&field);
  }
  sty_destroy_sites(&sites);
  sty_destroy_image(&target);
  sty_destroy_image(&source);
}

static void test_refusals(void **state) {
  (void)state;
  uint64_t random = 37;
  for (int d = 0; d < DIM_COUNT; d++) {
    StyImage *guide = make_guide(UNIFORM, DIMS[d], 6, 6, 0, &random);
    StySites *sites = collect(guide);
    for (const StyEngine *engine = sty_engines; engine->name; engine++) {
      StyField *field = NULL;
      StyError error = {STY_OK, ""};
      if (takes(engine, DIMS[d])) continue;
      expect_message(sty_match_guide(sites, engine, NULL, "target", guide, NULL, &field, &error), STY_ERROR_USAGE,
                     &error, PARTS(engine->name, "brute", "flann-single", "flann-forest"));
      assert_null(field);
    }
    StyField *field = NULL;
    StyError error = {STY_OK, ""};
    guide->data[36 + 2 * 6 + 3] = NAN;
    expect_message(sty_match_guide(sites, find_engine("brute"), NULL, "some-target.exr", guide, NULL, &field, &error),
                   STY_ERROR_INPUT, &error, PARTS("some-target.exr", "c.0", "(3, 2)"));
    assert_null(field);
    strcpy(guide->names[DIMS[d]], "c.x");
    expect_message(sty_match_guide(sites, find_engine("brute"), NULL, "some-target.exr", guide, NULL, &field, &error),
                   STY_ERROR_INPUT, &error, PARTS("some-target.exr", "no channel c.", "A", "c.x"));
    assert_null(field);
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
}

/* Answers are covered pixels at the stated distance; with many checks almost all are the nearest. */
static void test_forest(void **state) {
  (void)state;
  uint64_t random = 38;
  static const StyEngineOptions options[] = {{4, 4, 0.9}, {4, 512, 0.9}};
  int right[2] = {0}, asked = 0;
  for (int trial = 0; trial < 6; trial++) {
    StyImage *source = make_guide(PATHS, 15, 60, 50, 1, &random), *target = make_guide(PATHS, 15, 30, 20, 1, &random);
    StySites *sites = collect(source);
    StyField *exact = try_match(sites, find_engine("flann-single"), NULL, target, 1);
    for (int o = 0; o < 2; o++) {
      StyField *field = try_match(sites, find_engine("flann-forest"), &options[o], target, 1 + o);
      for (size_t i = 0; i < sty_count_pixels(target); i++) {
        if (!(target->data[i] > 0)) continue;
        assert_true(source->data[field->pixels[i]] > 0);
        assert_true(field->errors[i] >= exact->errors[i]);
        right[o] += field->pixels[i] == exact->pixels[i];
        asked += o;
      }
      sty_destroy_field(&field);
    }
    sty_destroy_field(&exact);
    sty_destroy_sites(&sites);
    sty_destroy_image(&target);
    sty_destroy_image(&source);
  }
  print_message("flann-forest, 15 channels: recall %.3f with 4 checks, %.3f with 512, over %d pixels\n",
                (double)right[0] / asked, (double)right[1] / asked, asked);
  assert_true(right[0] < right[1]);
  assert_true(right[1] > 0.9 * asked);
}

/* ---- cubes ----------------------------------------------------------------------- */

/* Each texel against the rule, at the place that lut.h says. */
static void test_cubes(void **state) {
  (void)state;
  static const StyFeature features[] = {{"normal.X", 1}, {"normal.Y", 2}, {"luma.Y", 0.5f}};
  static const char *const names[] = {"A", "normal.X", "normal.Y", "luma.Y"};
  static const int sizes[] = {1, 2, 5, 16};
  uint64_t random = 39;
  for (int trial = 0; trial < 8; trial++) {
    const int size = sizes[trial % 4];
    StyImage *guide = make_guide(trial < 4 ? UNIFORM : LATTICE, 3, 17, 11, 1, &random), *texels = NULL;
    for (int c = 0; c < 4; c++) strcpy(guide->names[c], names[c]);
    StySites *sites = NULL;
    assert_int_equal(sty_collect_features("g", guide, features, 3, &sites, NULL), STY_OK);
    assert_int_equal(sty_create_image(size, size * size, 4, names, 32, &texels, NULL), STY_OK);
    const size_t count = sty_count_pixels(texels);
    for (size_t t = 0; t < count; t++) {
      const int i = (int)t % size, j = (int)t / size % size, k = (int)t / size / size;
      texels->data[t] = 1;
      texels->data[count + t] = (float)(2 * i + 1 - size) / (float)size;
      texels->data[2 * count + t] = (float)(size - 2 * j - 1) / (float)size;
      texels->data[3 * count + t] = (float)(2 * k + 1) / (float)(2 * size);
    }
    for (const StyEngine *engine = sty_engines; engine->name; engine++) {
      StyLut *lut = NULL;
      StyError error = {STY_OK, ""};
      const StyStatus status = sty_build_cube(sites, engine, NULL, size, NULL, &lut, &error);
      if (!takes(engine, 3)) {
        expect_message(status, STY_ERROR_USAGE, &error, PARTS(engine->name, "flann-single"));
        assert_null(lut);
        continue;
      }
      if (status == STY_ERROR_UNAVAILABLE) continue;
      assert_int_equal(status, STY_OK);
      assert_int_equal(lut->depth, size);
      assert_int_equal(lut->spec.width, size);
      assert_int_equal(lut->spec.height, size * size);
      assert_string_equal(lut->axes[2].channel, "luma.Y");
      assert_true(lut->axes[1].weight == 2);
      for (size_t t = 0; t < count; t++) {
        static const float weights[] = {1, 2, 0.5f};
        float distance, g[3];
        const uint32_t pixel = find_nearest(guide, weights, texels, t, &distance);
        sty_get_cube_value(lut, (int)t % size, (int)t / size % size, (int)t / size / size, g);
        for (size_t c = 0; c < 3; c++) assert_true(g[c] == texels->data[(c + 1) * count + t]);
        if (engine->exact && (lut->pixels[t] != pixel || lut->errors[t] != distance))
          fail_msg("%s, size %d, texel %zu: %u at %g, expected %u at %g", engine->name, size, t, lut->pixels[t],
                   (double)lut->errors[t], pixel, (double)distance);
      }
      sty_destroy_lut(&lut);
    }
    sty_destroy_image(&texels);
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
}

/* Tables take sites of their own dimensions only. */
static void test_dimensions(void **state) {
  (void)state;
  uint64_t random = 40;
  static const StyLutSpec spec = {4, 4, STY_SAMPLE_CENTRE, STY_MAP_XY, STY_METRIC_XY};
  for (int dims = 1; dims <= 4; dims++) {
    StyImage *guide = make_guide(UNIFORM, dims, 4, 4, 0, &random);
    StySites *sites = collect(guide);
    StyLut *lut = NULL;
    StyError error = {STY_OK, ""};
    if (dims != 2)
      expect_message(sty_build_lut(sites, find_engine("brute"), NULL, &spec, NULL, &lut, &error), STY_ERROR_USAGE,
                     &error, PARTS("dimension"));
    if (dims != 3)
      expect_message(sty_build_cube(sites, find_engine("brute"), NULL, 4, NULL, &lut, &error), STY_ERROR_USAGE, &error,
                     PARTS("dimension"));
    static const int bad[] = {0, -1, STY_MAX_CUBE + 1};
    for (int i = 0; dims == 3 && i < 3; i++)
      expect_message(sty_build_cube(sites, find_engine("brute"), NULL, bad[i], NULL, &lut, &error), STY_ERROR_USAGE,
                     &error, PARTS("size", "256"));
    /* The metric angle is about normals. */
    uint32_t pixel = 7;
    float distance = 7;
    const float g[4] = {0};
    const StyStatus status =
        sty_ask_engine(sites, find_engine("brute"), NULL, STY_METRIC_ANGLE, g, NULL, &pixel, &distance, &error);
    assert_int_equal(status, dims == 2 ? STY_OK : STY_ERROR_USAGE);
    assert_true((pixel == 7) == (dims != 2));
    assert_null(lut);
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
}

/* ---- encoding -------------------------------------------------------------------- */

static void test_encoding(void **state) {
  (void)state;
  StyField *field = NULL;
  assert_int_equal(sty_create_field(3, 2, 1000, 600, &field, NULL), STY_OK);
  for (int i = 0; i < 6; i++) assert_true(field->pixels[i] == STY_NO_PIXEL && field->errors[i] == 0);
  field->pixels[1] = 599 * 1000 + 999;
  field->errors[1] = 0.25f;
  field->pixels[5] = 0;
  StyImage *floats = NULL, *integers = NULL;
  assert_int_equal(sty_encode_field(field, 32, &floats, NULL), STY_OK);
  assert_int_equal(sty_encode_field(field, 16, &integers, NULL), STY_OK);
  static const double expected[4][2] = {{0.9995, 0.0005}, {599.5 / 600, 0.5 / 600}, {0.25, 0}, {1, 1}};
  static const double whole[4][2] = {{999, 0}, {599, 0}, {0, 0}, {65535, 65535}};
  static const char *const names[] = {"u", "v", "error", "A"}, *const letters[] = {"R", "G", "B", "A"};
  assert_int_equal(floats->bits, 32);
  assert_int_equal(integers->bits, 16);
  for (int c = 0; c < 4; c++) {
    const float *f = sty_find_channel(floats, names[c]), *n = sty_find_channel(integers, letters[c]);
    assert_true(f && n);
    for (int i = 0; i < 6; i++) {
      const int place = i == 1 ? 0 : i == 5 ? 1 : -1;
      assert_true(fabs((double)f[i] - (place < 0 ? 0 : expected[c][place])) < 1e-7);
      assert_true(lrint((double)n[i] * 65535) == (place < 0 ? 0 : lrint(whole[c][place])));
    }
  }
  assert_string_equal(sty_find_attribute(floats, "stylut:kind"), "field");
  assert_string_equal(sty_find_attribute(integers, "stylut:source"), "1000x600");
  /* No table. */
  const StyLutHints hints = {0, 0, -1, STY_FOREIGN_NONE};
  StyLut *lut = NULL;
  StyError error = {STY_OK, ""};
  expect_message(sty_decode_lut("field.exr", floats, &hints, &lut, &error), STY_ERROR_INPUT, &error,
                 PARTS("field.exr", "field"));
  sty_destroy_image(&floats);
  sty_destroy_image(&integers);
  sty_destroy_field(&field);
  assert_null(field);
  sty_destroy_field(&field);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_exact_engines),
      cmocka_unit_test(test_few_points),
      cmocka_unit_test(test_self),
      cmocka_unit_test(test_weights),
      cmocka_unit_test(test_channels_by_name),
      cmocka_unit_test(test_empty_target),
      cmocka_unit_test(test_refusals),
      cmocka_unit_test(test_forest),
      cmocka_unit_test(test_cubes),
      cmocka_unit_test(test_dimensions),
      cmocka_unit_test(test_encoding),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
