#include <math.h>

#include "../scratch.h"
#include "stylut/lut.h"

/* ---- the text -------------------------------------------------------------------- */

static void expect_text(const char *text, int count, const char *last, float weight) {
  StyFeature features[STY_MOST_DIMS];
  StyError error = {STY_OK, ""};
  int found = -1;
  if (sty_parse_features("--channels", text, features, &found, &error)) fail_msg("'%s': %s", text, error.text);
  assert_int_equal(found, count);
  assert_string_equal(features[count - 1].channel, last);
  assert_true(features[count - 1].weight == weight);
  /* And back. */
  char back[STY_FEATURES_SIZE];
  StyFeature again[STY_MOST_DIMS];
  sty_write_features(features, count, back);
  assert_int_equal(sty_parse_features("again", back, again, &found, &error), STY_OK);
  assert_int_equal(found, count);
  for (int f = 0; f < count; f++) {
    assert_string_equal(again[f].channel, features[f].channel);
    assert_true(again[f].weight == features[f].weight);
  }
}

/* `count` names of `length` characters. */
static const char *make_names(int count, int length) {
  static char text[STY_FEATURES_SIZE * 2];
  size_t used = 0;
  for (int n = 0; n < count; n++)
    used += (size_t)snprintf(text + used, sizeof text - used, "%s%0*d", n ? "," : "", length, n);
  return text;
}

static void test_text(void **state) {
  (void)state;
  expect_text("normal.X", 1, "normal.X", 1);
  expect_text("normal.X,normal.Y,luma.Y:0.5", 3, "luma.Y", 0.5f);
  expect_text("normal:2,full", 2, "full", 1);
  expect_text("a:0.001,b:1000,c:0.333333333", 3, "c", 0.333333333f);
  expect_text(make_names(STY_MOST_DIMS, STY_MAX_NAME - 1), STY_MOST_DIMS, strrchr(make_names(32, 127), ',') + 1, 1);
  char text[STY_FEATURES_SIZE];
  const StyFeature features[] = {{"a.X", 1}, {"b", 0.25f}, {"c", 3}};
  sty_write_features(features, 3, text);
  assert_string_equal(text, "a.X,b:0.25,c:3");
}

static void test_bad_text(void **state) {
  (void)state;
  const char *const bad[] = {"",    ",",     "a,",    ",a",    "a,,b", ":1",      "a:",       "a:0",    "a:-1",
                             "a:x", "a:1:2", "a:nan", "a:1e9", "a: 1", "a,b,a:2", "a:0.0005", "a:1001", "a,:2"};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    StyFeature features[STY_MOST_DIMS];
    StyError error = {STY_OK, ""};
    int count = -1;
    if (!sty_parse_features("--channels", bad[i], features, &count, &error)) fail_msg("'%s' passes", bad[i]);
    expect_message(error.status, STY_ERROR_USAGE, &error, PARTS("--channels"));
    assert_int_equal(count, -1);
  }
  StyFeature features[STY_MOST_DIMS];
  StyError error = {STY_OK, ""};
  int count = -1;
  expect_message(sty_parse_features("-c", make_names(STY_MOST_DIMS + 1, 3), features, &count, &error), STY_ERROR_USAGE,
                 &error, PARTS("-c", "more than 32"));
  expect_message(sty_parse_features("-c", make_names(1, STY_MAX_NAME), features, &count, &error), STY_ERROR_USAGE,
                 &error, PARTS("-c", "127"));
  expect_message(sty_parse_features("-c", make_names(1, 4000), features, &count, &error), STY_ERROR_USAGE, &error,
                 PARTS("-c"));
}

/* ---- collecting ------------------------------------------------------------------ */

/* A 5 x 4 guide; pixel 7 is uncovered and holds no numbers. */
static StyImage *make_guide(void) {
  static const char *const names[] = {"normal.X", "full.R", "A", "full.G", "full.B", "fuller.R", "luma.Y", "full"};
  StyImage *guide = NULL;
  assert_int_equal(sty_create_image(5, 4, 7, names, 32, &guide, NULL), STY_OK);
  for (int c = 0; c < 7; c++)
    for (int i = 0; i < 20; i++)
      guide->data[c * 20 + i] = c == 2 ? (float)(i != 7) : i == 7 ? NAN : (float)(100 * c + i);
  return guide;
}

static void expect_sites(const StyImage *guide, const StyFeature *features, int count, const int *channels,
                         const float *weights, int dims) {
  StySites *sites = NULL;
  StyError error = {STY_OK, ""};
  if (sty_collect_features("g.exr", guide, features, count, &sites, &error)) fail_msg("%s", error.text);
  assert_int_equal(sites->dims, dims);
  assert_int_equal(sites->count, 19);
  assert_int_equal(sites->width, 5);
  assert_int_equal(sites->height, 4);
  assert_null(sites->levels);
  for (int k = 0; k < dims; k++) {
    assert_string_equal(sites->features[k].channel, guide->names[channels[k]]);
    assert_true(sites->features[k].weight == weights[k]);
  }
  for (int s = 0; s < 19; s++) {
    const int pixel = s + (s >= 7);
    assert_int_equal(sites->pixels[s], pixel);
    for (int k = 0; k < dims; k++)
      assert_true(sites->values[s * dims + k] == guide->data[channels[k] * 20 + pixel] * weights[k]);
  }
  sty_destroy_sites(&sites);
}

/* A group is all that is called NAME.something, in the guide's order, and nothing else. */
static void test_groups(void **state) {
  (void)state;
  StyImage *guide = make_guide();
  expect_sites(guide, (StyFeature[]){{"luma.Y", 0.5f}}, 1, (int[]){6}, (float[]){0.5f}, 1);
  expect_sites(guide, (StyFeature[]){{"full", 0.25f}, {"normal", 2}}, 2, (int[]){1, 3, 4, 0},
               (float[]){0.25f, 0.25f, 0.25f, 2}, 4);
  expect_sites(guide, (StyFeature[]){{"luma.Y", 1}, {"full.G", 1}, {"A", 1}}, 3, (int[]){6, 3, 2}, (float[]){1, 1, 1},
               3);
  sty_destroy_image(&guide);
}

static void expect_refusal(const StyImage *guide, const StyFeature *features, int count, StyStatus status,
                           const char *part) {
  StySites *sites = NULL;
  StyError error = {STY_OK, ""};
  expect_message(sty_collect_features("some-guide.exr", guide, features, count, &sites, &error), status, &error,
                 PARTS("some-guide.exr", part));
  assert_null(sites);
}

static void test_refusals(void **state) {
  (void)state;
  StyImage *guide = make_guide();
  /* What isn't there is named, and what is. */
  expect_refusal(guide, (StyFeature[]){{"luma.Y", 1}, {"full.A", 1}}, 2, STY_ERROR_INPUT, "no channel full.A");
  expect_refusal(guide, (StyFeature[]){{"uv", 1}}, 1, STY_ERROR_INPUT, "normal.X, full.R, A, full.G, full.B, fuller.R");
  expect_refusal(guide, (StyFeature[]){{"ful", 1}}, 1, STY_ERROR_INPUT, "no channel ful");
  expect_refusal(guide, NULL, 0, STY_ERROR_USAGE, "no channels");
  expect_refusal(guide, (StyFeature[]){{"full.G", 1}, {"full", 1}}, 2, STY_ERROR_USAGE, "full.G twice");
  static const float weights[] = {0, -1, NAN, INFINITY, 1001};
  for (size_t w = 0; w < sizeof weights / sizeof *weights; w++)
    expect_refusal(guide, (StyFeature[]){{"full.G", weights[w]}}, 1, STY_ERROR_USAGE, "weight");
  /* The weighted value counts. */
  expect_refusal(guide, (StyFeature[]){{"normal.X", 1}, {"full.R", 10}}, 2, STY_ERROR_INPUT,
                 "full.R = 101 times 10 at pixel (1, 0)");
  static const float bad[] = {NAN, INFINITY, -INFINITY, 1000.001f, -1000.001f, 3e38f};
  for (size_t b = 0; b < sizeof bad / sizeof *bad; b++) {
    guide->data[6 * 20 + 13] = bad[b];
    expect_refusal(guide, (StyFeature[]){{"normal.X", 1}, {"luma.Y", 1}}, 2, STY_ERROR_INPUT, "at pixel (3, 2)");
    expect_refusal(guide, (StyFeature[]){{"normal.X", 1}, {"luma.Y", 1}}, 2, STY_ERROR_INPUT, "luma.Y");
  }
  for (int i = 0; i < 20; i++) guide->data[2 * 20 + i] = 0;
  expect_refusal(guide, (StyFeature[]){{"normal.X", 1}}, 1, STY_ERROR_INPUT, "no covered pixel");
  strcpy(guide->names[2], "alpha");
  expect_refusal(guide, (StyFeature[]){{"normal.X", 1}}, 1, STY_ERROR_INPUT, "no channel A");
  sty_destroy_image(&guide);
}

/* A layer of more channels than can be compared. */
static void test_too_many(void **state) {
  (void)state;
  char text[STY_MOST_DIMS + 2][16];
  const char *names[STY_MOST_DIMS + 2] = {"A"};
  for (int c = 1; c < STY_MOST_DIMS + 2; c++) {
    snprintf(text[c], sizeof text[c], "c.%d", c);
    names[c] = text[c];
  }
  for (int more = 0; more < 2; more++) {
    StyImage *guide = NULL;
    StySites *sites = NULL;
    assert_int_equal(sty_create_image(1, 1, STY_MOST_DIMS + 1 + more, names, 32, &guide, NULL), STY_OK);
    guide->data[0] = 1;
    const StyFeature all = {"c", 1};
    if (more)
      expect_refusal(guide, &all, 1, STY_ERROR_USAGE, "more than 32");
    else
      assert_int_equal(sty_collect_features("g", guide, &all, 1, &sites, NULL), STY_OK);
    if (sites) assert_int_equal(sites->dims, STY_MOST_DIMS);
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_text),     cmocka_unit_test(test_bad_text), cmocka_unit_test(test_groups),
      cmocka_unit_test(test_refusals), cmocka_unit_test(test_too_many),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
