#include <math.h>

#include "../scratch.h"
#include "lut/engine.h"

static uint32_t random_state = 1;

static float draw_between(float low, float high) {
  random_state = random_state * 1664525u + 1013904223u;
  return low + (high - low) * (float)(random_state >> 8) / 16777216.0f;
}

/* A guide of random normals, some of them alike, with holes; byte values where `bits` is 8. */
static StySites *make_sites(int width, int height, int bits) {
  static const char *const names[] = {"A", "normal.X", "normal.Y"};
  StyImage *guide = NULL;
  StySites *sites = NULL;
  StyError error;
  assert_int_equal(sty_create_image(width, height, 3, names, bits, &guide, NULL), STY_OK);
  const size_t pixels = sty_count_pixels(guide);
  for (size_t i = 0; i < pixels; i++) {
    guide->data[i] = draw_between(0, 1) < 0.8f;
    for (size_t k = 1; k < 3; k++) {
      const float value = draw_between(-1, 1), level = roundf(draw_between(0, 255));
      guide->data[k * pixels + i] = bits == 8 ? (2 * level - 255) / 255.0f : value;
      if (i % 9 == 8) guide->data[k * pixels + i] = guide->data[k * pixels + i - 5];
    }
  }
  if (sty_collect_sites("guide", guide, &sites, &error)) fail_msg("%s", error.text);
  sty_destroy_image(&guide);
  return sites;
}

static void lift(StyMetric metric, const float g[2], float out[3]) {
  const float squared = g[0] * g[0] + g[1] * g[1];
  const float length = metric == STY_METRIC_ANGLE && squared > 1 ? sqrtf(squared) : 1;
  out[0] = g[0] / length;
  out[1] = g[1] / length;
  const float rest = 1 - (out[0] * out[0] + out[1] * out[1]);
  out[2] = metric == STY_METRIC_ANGLE && rest > 0 ? sqrtf(rest) : 0;
}

/* The header's rule, in the plainest words. */
static uint32_t find_nearest(const StySites *sites, StyMetric metric, const float g[2], float *distance) {
  float at[3], least = INFINITY;
  uint32_t nearest = 0;
  lift(metric, g, at);
  for (size_t s = 0; s < sites->count; s++) {
    float p[3];
    lift(metric, sites->values + 2 * s, p);
    const float d[3] = {at[0] - p[0], at[1] - p[1], at[2] - p[2]};
    const float squared = metric == STY_METRIC_XY ? d[0] * d[0] + d[1] * d[1] : d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    if (squared >= least) continue;
    least = squared;
    nearest = sites->pixels[s];
  }
  *distance = (float)sqrt((double)least);
  return nearest;
}

static void test_exact_engines_answer_alike(void **state) {
  (void)state;
  for (int bits = 8; bits <= 32; bits += 24)
    for (int metric = STY_METRIC_XY; metric <= STY_METRIC_ANGLE; metric++) {
      StySites *sites = make_sites(41, 23, bits);
      for (int question = 0; question < 40; question++) {
        /* Some at a site's own value, where the distance is 0. */
        const float *own = sites->values + 2 * ((size_t)question * 7 % sites->count);
        const float g[2] = {question % 4 ? draw_between(-1, 1) : own[0], question % 4 ? draw_between(-1, 1) : own[1]};
        float wanted_distance;
        const uint32_t wanted = find_nearest(sites, (StyMetric)metric, g, &wanted_distance);
        for (const StyEngine *engine = sty_engines; engine->name; engine++) {
          uint32_t pixel = 0;
          float distance = -1;
          StyError error;
          if (!engine->exact) continue;
          const StyStatus status =
              sty_ask_engine(sites, engine, NULL, (StyMetric)metric, g, NULL, &pixel, &distance, &error);
          if (status == STY_ERROR_UNAVAILABLE) continue;
          if (status) fail_msg("%s: %s", engine->name, error.text);
          if (pixel != wanted || distance != wanted_distance)
            fail_msg("%s, %d bits, metric %s, value (%g, %g): pixel %u at %g, expected %u at %g", engine->name, bits,
                     sty_metric_names[metric], (double)g[0], (double)g[1], pixel, (double)distance, wanted,
                     (double)wanted_distance);
        }
      }
      sty_destroy_sites(&sites);
    }
}

/* What no library could answer never gets to one. */
static void test_values_without_an_answer(void **state) {
  (void)state;
  static const float bad[] = {NAN, INFINITY, -INFINITY, 1000.001f, -1000.001f, 3e38f};
  StySites *sites = make_sites(9, 9, 32);
  for (const StyEngine *engine = sty_engines; engine->name; engine++)
    for (size_t i = 0; i < 2 * sizeof bad / sizeof *bad; i++) {
      const float g[2] = {i % 2 ? bad[i / 2] : 0, i % 2 ? 0 : bad[i / 2]};
      uint32_t pixel = 77;
      float distance = 77;
      StyError error = {STY_OK, ""};
      assert_int_equal(sty_ask_engine(sites, engine, NULL, STY_METRIC_XY, g, NULL, &pixel, &distance, &error),
                       STY_ERROR_INPUT);
      assert_non_null(strstr(error.text, "guide value: found "));
      assert_true(pixel == 77 && distance == 77);
    }
  sty_destroy_sites(&sites);
}

/* From far away, points closer together than rounding tells apart are ties. */
static void test_far_values(void **state) {
  (void)state;
  static const char *const names[] = {"A", "normal.X", "normal.Y"};
  enum { SIDE = CASES(700, 200), QUESTIONS = CASES(300, 40) };
  StyImage *guide = NULL;
  StySites *sites = NULL;
  static float asked[2 * QUESTIONS];
  assert_int_equal(sty_create_image(SIDE, SIDE, 3, names, 32, &guide, NULL), STY_OK);
  const size_t pixels = sty_count_pixels(guide);
  for (size_t i = 0; i < pixels; i++) {
    guide->data[i] = 1;
    for (size_t k = 1; k < 3; k++) guide->data[k * pixels + i] = draw_between(0, 2e-3f);
  }
  assert_int_equal(sty_collect_sites("guide", guide, &sites, NULL), STY_OK);
  for (int v = 0; v < 2 * QUESTIONS; v++) asked[v] = draw_between(-999, 999);
  const StyEngine *grid = NULL;
  StyLut *answers = NULL;
  assert_int_equal(sty_find_engine("engine", "grid", &grid, NULL), STY_OK);
  assert_int_equal(sty_answer_values(sites, grid, NULL, STY_METRIC_XY, asked, QUESTIONS, NULL, &answers, NULL), STY_OK);
  for (size_t q = 0; q < QUESTIONS; q++) {
    float distance;
    const uint32_t wanted = find_nearest(sites, STY_METRIC_XY, asked + 2 * q, &distance);
    if (answers->pixels[q] != wanted || answers->errors[q] != distance)
      fail_msg("value (%g, %g): pixel %u at %g, expected %u at %g", (double)asked[2 * q], (double)asked[2 * q + 1],
               answers->pixels[q], (double)answers->errors[q], wanted, (double)distance);
  }
  sty_destroy_lut(&answers);
  sty_destroy_sites(&sites);
  sty_destroy_image(&guide);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_exact_engines_answer_alike),
                                     cmocka_unit_test(test_far_values),
                                     cmocka_unit_test(test_values_without_an_answer)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
