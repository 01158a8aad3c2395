#include <math.h>

#include "../scratch.h"
#include "stylut/report.h"

/* ---- guides ------------------------------------------------------------------- */

static StyImage *make_guide(int width, int height) {
  static const char *const names[] = {"A", "normal.X", "normal.Y"};
  StyImage *guide = NULL;
  assert_int_equal(sty_create_image(width, height, 3, names, 32, &guide, NULL), STY_OK);
  return guide;
}

static void set_pixel(StyImage *guide, int x, int y, float gx, float gy) {
  const size_t pixels = sty_count_pixels(guide), at = (size_t)y * (size_t)guide->width + (size_t)x;
  guide->data[at] = 1;
  guide->data[pixels + at] = gx;
  guide->data[2 * pixels + at] = gy;
}

/* A sphere in the columns from `left`, of the sphere's own columns those from `first` to `last` alone. */
static void add_sphere(StyImage *guide, int left, int first, int last) {
  const int side = guide->height;
  for (int y = 0; y < side; y++)
    for (int x = first; x <= last; x++) {
      const float gx = (float)(2 * x + 1 - side) / (float)side, gy = (float)(side - 2 * y - 1) / (float)side;
      if (gx * gx + gy * gy <= 1) set_pixel(guide, left + x, y, gx, gy);
    }
}

static StyImage *make_sphere(int side) {
  StyImage *guide = make_guide(side, side);
  add_sphere(guide, 0, 0, side - 1);
  return guide;
}

/* ---- opinions ----------------------------------------------------------------- */

typedef struct Case {
  StyImage *guide;
  StyLut *lut, *exact;
  const StyImage *frame; /* or NULL: directions weigh alike */
  bool of_another;
} Case;

static StyLut *build(const StyImage *guide, int size) {
  StySites *sites = NULL;
  StyLut *lut = NULL;
  const StyEngine *engine = NULL;
  const StyLutSpec spec = {.width = size, .height = size};
  assert_int_equal(sty_find_engine("engine", "auto", &engine, NULL), STY_OK);
  assert_int_equal(sty_collect_sites("guide", guide, &sites, NULL), STY_OK);
  assert_int_equal(sty_build_lut(sites, engine, NULL, &spec, NULL, &lut, NULL), STY_OK);
  sty_destroy_sites(&sites);
  return lut;
}

/* The guide with its exact table, twice; the first may be spoilt. */
static Case open_case(StyImage *guide, int size) {
  return (Case){guide, build(guide, size), build(guide, size), NULL, false};
}

static void close_case(Case *c) {
  sty_destroy_lut(&c->lut);
  sty_destroy_lut(&c->exact);
  sty_destroy_image(&c->guide);
}

/* The opinion; where `page` isn't NULL, the page too, for the caller to free. */
static StyOpinion judge(const Case *c, char **page) {
  static const StyReportFile files[] = {{"table", "a<b>.exr", ""}, {"guide", "guide.exr", ""}};
  const StyAuditOptions options = {.tolerance = 4 * STY_LEVEL,
                                   .weights = c->frame ? STY_WEIGHT_FRAMES : STY_WEIGHT_DISC,
                                   .frames = &c->frame,
                                   .frame_count = c->frame ? 1 : 0};
  StyAudit audit;
  StyAuditMaps maps;
  StyOpinion opinion;
  StyError error = {STY_OK, ""};
  if (sty_audit_lut(c->lut, c->exact, c->guide, &options, NULL, &audit, &maps, &error)) fail_msg("%s", error.text);
  const StyReport report = {files, 2, NULL, c->lut, c->exact, c->guide, &audit, &maps, c->of_another};
  if (sty_judge_report(&report, &opinion, &error)) fail_msg("%s", error.text);
  if (page) {
    size_t size;
    FILE *stream = open_memstream(page, &size);
    assert_non_null(stream);
    assert_int_equal(sty_write_report(&report, stream, &error), STY_OK);
    assert_int_equal(fclose(stream), 0);
    assert_true(size < STY_MOST_REPORT_BYTES);
  }
  sty_free_audit_maps(&maps);
  return opinion;
}

/* The piece of advice that holds `part`, or NULL. */
static const char *find_advice(const StyOpinion *opinion, const char *part) {
  for (int i = 0; i < opinion->advice_count; i++)
    if (strstr(opinion->advice[i], part)) return opinion->advice[i];
  return NULL;
}

static void expect_advice(const StyOpinion *opinion, const char *part) {
  if (find_advice(opinion, part)) return;
  for (int i = 0; i < opinion->advice_count; i++) print_message("- %s\n", opinion->advice[i]);
  fail_msg("no advice holds '%s'", part);
}

static void expect_no_advice(const StyOpinion *opinion, const char *part) {
  const char *found = find_advice(opinion, part);
  if (found) fail_msg("found advice '%s'", found);
}

static void expect_opinion(const StyOpinion *opinion, StyJudgement judgement, const char *headline) {
  if (!strstr(opinion->headline, headline)) fail_msg("'%s' lacks '%s'", opinion->headline, headline);
  assert_int_equal(opinion->judgement, judgement);
}

/* ---- good tables -------------------------------------------------------------- */

static void test_sphere(void **state) {
  (void)state;
  Case c = open_case(make_sphere(64), 48);
  const StyOpinion opinion = judge(&c, NULL);
  expect_opinion(&opinion, STY_JUDGED_GOOD, "Exact: every texel holds the nearest pixel.");
  if (!strstr(opinion.reason, "0 % of the texels; 0 % of neighbouring texels")) fail_msg("%s", opinion.reason);
  /* The rim is all there is to say of a small table in xy. */
  assert_int_equal(opinion.advice_count, 1);
  expect_advice(&opinion, "100 % of the worst hundredth lies in the outer twentieth");
  close_case(&c);
}

static void test_small_table(void **state) {
  (void)state;
  Case c = open_case(make_sphere(64), 6);
  const StyOpinion opinion = judge(&c, NULL);
  expect_opinion(&opinion, STY_JUDGED_FAIR, "nearest pixel, but the table is small for its guide.");
  expect_advice(&opinion, "A larger -s closes the gap");
  close_case(&c);
}

/* Left or right half of a sphere: three of the eight sectors, each (1 - 1/4) / 8 of the disc, aren't there. */
static void test_half_a_sphere(void **state) {
  (void)state;
  static const char *const there[] = {"left", "right"}, *const lacking[] = {"right", "left"};
  StyImage *frame = make_sphere(200);
  for (int side = 0; side < 2; side++) {
    StyImage *guide = make_guide(64, 64);
    add_sphere(guide, 0, side ? 32 : 0, side ? 63 : 31);
    Case c = open_case(guide, 48);
    StyOpinion opinion = judge(&c, NULL);
    expect_opinion(&opinion, STY_JUDGED_FAIR, "nearest pixel, but the guide lacks directions.");
    expect_no_advice(&opinion, "never the answer");
    for (int weighed = 0; weighed < 2; weighed++) {
      const char *advice = find_advice(&opinion, "next to no surface facing ");
      assert_non_null(advice);
      static const char *const heights[] = {"", "upper ", "lower "};
      for (int h = 0; h < 3; h++) {
        char name[32];
        snprintf(name, sizeof name, "%s%s", heights[h], lacking[side]);
        if (!strstr(advice, name)) fail_msg("'%s' lacks '%s'", advice, name);
      }
      if (strstr(advice, there[side]) || strstr(advice, "viewer")) fail_msg("found '%s'", advice);
      if (!strstr(advice, weighed ? "in 28 % of their pixels" : "with --frames to learn"))
        fail_msg("found '%s'", advice);
      c.frame = frame;
      if (!weighed) opinion = judge(&c, NULL);
    }
    close_case(&c);
  }
  sty_destroy_image(&frame);
}

/* A sphere without the directions of one name: within half the radius, or an eighth of the way around. */
static void test_every_direction(void **state) {
  (void)state;
  static const char *const names[] = {"right",      "upper right", "up",          "upper left",       "left",
                                      "lower left", "down",        "lower right", "toward the viewer"};
  for (int n = 0; n < 9; n++) {
    StyImage *guide = make_sphere(64);
    float *covered = sty_find_channel(guide, "A");
    for (size_t i = 0; i < sty_count_pixels(guide); i++) {
      const double x = (double)sty_find_channel(guide, "normal.X")[i],
                   y = (double)sty_find_channel(guide, "normal.Y")[i];
      const double off = fabs(remainder(atan2(y, x) - n * M_PI / 4, 2 * M_PI));
      if (n == 8 ? hypot(x, y) < 0.5 : hypot(x, y) >= 0.5 && off < M_PI / 8) covered[i] = 0;
    }
    Case c = open_case(guide, 48);
    const StyOpinion opinion = judge(&c, NULL);
    char part[64];
    snprintf(part, sizeof part, "no surface facing %s. Name", names[n]);
    expect_advice(&opinion, part);
    close_case(&c);
  }
}

/* Frames that don't ask for what is lacking leave nothing to complain of. */
static void test_half_that_is_enough(void **state) {
  (void)state;
  StyImage *guide = make_guide(64, 64), *frame = make_guide(200, 200);
  add_sphere(guide, 0, 0, 31);
  add_sphere(frame, 0, 0, 99);
  Case c = open_case(guide, 48);
  c.frame = frame;
  const StyOpinion opinion = judge(&c, NULL);
  expect_opinion(&opinion, STY_JUDGED_GOOD, "Exact: every texel holds the nearest pixel.");
  expect_no_advice(&opinion, "no surface facing");
  close_case(&c);
  sty_destroy_image(&frame);
}

/* Three faces of a cube: three directions, each all over its face. */
static void test_cube(void **state) {
  (void)state;
  static const float normals[3][2] = {{-0.7071f, 0.4082f}, {0.7071f, 0.4082f}, {0, -0.8165f}};
  StyImage *guide = make_guide(60, 60);
  for (int y = 0; y < 60; y++)
    for (int x = 0; x < 60; x++) {
      const float *normal = normals[y >= 30 ? 2 : x >= 30];
      set_pixel(guide, x, y, normal[0], normal[1]);
    }
  Case c = open_case(guide, 48);
  const StyOpinion opinion = judge(&c, NULL);
  expect_opinion(&opinion, STY_JUDGED_FAIR, "but the guide lacks directions.");
  expect_advice(&opinion, "The guide shows only 3 directions, ");
  expect_no_advice(&opinion, "no surface facing");
  expect_advice(&opinion, "The guide is ambiguous: for 100 % of the texels");
  close_case(&c);
}

/* Two spheres side by side: all that fits stands 64 pixels apart, 32 from its middle. */
static void test_two_spheres(void **state) {
  (void)state;
  StyImage *guide = make_guide(128, 64);
  add_sphere(guide, 0, 0, 63);
  add_sphere(guide, 64, 0, 63);
  Case c = open_case(guide, 48);
  const StyOpinion opinion = judge(&c, NULL);
  expect_opinion(&opinion, STY_JUDGED_FAIR, "nearest pixel, but the guide is ambiguous.");
  expect_advice(&opinion,
                "for 100 % of the texels the pixels that fit equally well lie in several places or far apart, on "
                "average 32 pixels from their middle");
  expect_advice(&opinion, "but here neighbours choose alike"); /* of equals the first */
  expect_no_advice(&opinion, "--resolve coherent");
  expect_no_advice(&opinion, "no surface facing");
  close_case(&c);
}

/* A table that says it is another guide's, before all other advice. */
static void test_another_guide(void **state) {
  (void)state;
  Case c = open_case(make_sphere(64), 48);
  StyOpinion opinion = judge(&c, NULL);
  expect_no_advice(&opinion, "made of another guide");
  c.of_another = true;
  opinion = judge(&c, NULL);
  assert_true(opinion.advice_count > 0 && strstr(opinion.advice[0], "made of another guide"));
  close_case(&c);
}

/* ---- others ------------------------------------------------------------------- */

static void test_wrong_table(void **state) {
  (void)state;
  Case c = open_case(make_sphere(64), 48);
  for (size_t t = 0; t < sty_count_texels(&c.lut->spec); t++) c.lut->pixels[t] = 32 * 64 + 32;
  const StyOpinion opinion = judge(&c, NULL);
  expect_opinion(&opinion, STY_JUDGED_BAD, "Wrong: hardly any texel holds the nearest pixel.");
  expect_advice(&opinion, "An exact table of this guide would err ");
  close_case(&c);
}

static void test_background(void **state) {
  (void)state;
  Case c = open_case(make_sphere(64), 48);
  c.lut->pixels[24 * 48 + 24] = 0;
  StyOpinion opinion = judge(&c, NULL);
  expect_opinion(&opinion, STY_JUDGED_BAD,
                 "Wrong in places: only over 99.9 % of the texels hold the nearest pixel; 1 points");
  expect_advice(&opinion, "1 texel points at the background");
  expect_advice(&opinion, "(at texel 24, 24)");
  c.lut->pixels[25 * 48 + 24] = 0;
  opinion = judge(&c, NULL);
  expect_advice(&opinion, "2 texels point at the background");
  close_case(&c);
}

/* What a byte can't name of 600 pixels: the warning before, and the finding after. */
static void test_bytes(void **state) {
  (void)state;
  Case c = open_case(make_sphere(600), 64);
  StyOpinion opinion = judge(&c, NULL);
  expect_opinion(&opinion, STY_JUDGED_GOOD, "Exact");
  expect_advice(&opinion, "Keep 16 bits a coordinate: rg8 would name another pixel for 90 % of the texels");
  expect_advice(&opinion, "The table is small for its guide");
  expect_no_advice(&opinion, "it went through rg8");
  StyImage *image = NULL;
  assert_int_equal(sty_encode_lut(c.lut, STY_ENCODE_RG8, &image, NULL), STY_OK);
  sty_destroy_lut(&c.lut);
  assert_int_equal(sty_decode_lut("table", image, &(StyLutHints){.sampling = -1}, &c.lut, NULL), STY_OK);
  sty_destroy_image(&image);
  opinion = judge(&c, NULL);
  expect_opinion(&opinion, STY_JUDGED_FAIR, "Not exact: 9.6 % of the texels hold the nearest pixel");
  expect_advice(&opinion, "of a source of 600 x 600: it went through rg8");
  expect_no_advice(&opinion, "Keep 16 bits");
  close_case(&c);
}

/* ---- the page ----------------------------------------------------------------- */

static void test_page(void **state) {
  (void)state;
  Case c = open_case(make_sphere(64), 48);
  char *page = NULL, *again = NULL;
  const StyOpinion opinion = judge(&c, &page);
  judge(&c, &again);
  assert_string_equal(page, again);
  assert_non_null(strstr(page, opinion.headline));
  assert_non_null(strstr(page, "a&lt;b&gt;.exr"));
  assert_null(strstr(page, "a<b>.exr"));
  assert_null(strstr(page, "{{"));
  free(page);
  free(again);
  close_case(&c);
}

static void test_names_and_failures(void **state) {
  (void)state;
  assert_string_equal(sty_judgement_names[STY_JUDGED_GOOD], "good");
  assert_string_equal(sty_judgement_names[STY_JUDGED_FAIR], "fair");
  assert_string_equal(sty_judgement_names[STY_JUDGED_BAD], "bad");
  assert_null(sty_judgement_names[3]);
  Case c = open_case(make_sphere(16), 16);
  StyAudit audit;
  StyAuditMaps maps;
  assert_int_equal(sty_audit_lut(c.lut, c.exact, c.guide, &(StyAuditOptions){0}, NULL, &audit, &maps, NULL), STY_OK);
  strcpy(c.guide->names[1], "tangent.X");
  const StyReport report = {NULL, 0, NULL, c.lut, c.exact, c.guide, &audit, &maps, false};
  StyOpinion opinion = {.advice_count = -7};
  StyError error;
  expect_message(sty_judge_report(&report, &opinion, &error), STY_ERROR_INPUT, &error, PARTS("normal.X"));
  assert_int_equal(opinion.advice_count, -7);
  sty_free_audit_maps(&maps);
  close_case(&c);
}

/* ---- long names ------------------------------------------------------------------ */

/* A page about so many files with names of so many bytes. */
static StyStatus write_named(int count, size_t bytes, size_t *size) {
  Case c = open_case(make_sphere(40), 32);
  const StyAuditOptions options = {.tolerance = 4 * STY_LEVEL, .weights = STY_WEIGHT_DISC};
  StyAudit audit;
  StyAuditMaps maps;
  assert_int_equal(sty_audit_lut(c.lut, c.exact, c.guide, &options, NULL, &audit, &maps, NULL), STY_OK);
  char *name = calloc(bytes + 1, 1), *page = NULL;
  StyReportFile *files = calloc((size_t)count, sizeof *files);
  assert_non_null(name);
  assert_non_null(files);
  memset(name, 'n', bytes);
  for (int f = 0; f < count; f++) files[f] = (StyReportFile){"frame", name, ""};
  const StyReport report = {files, count, name, c.lut, c.exact, c.guide, &audit, &maps, false};
  FILE *stream = open_memstream(&page, size);
  assert_non_null(stream);
  const StyStatus status = sty_write_report(&report, stream, NULL);
  assert_int_equal(fclose(stream), 0);
  free(page);
  free(files);
  free(name);
  sty_free_audit_maps(&maps);
  close_case(&c);
  return status;
}

static void test_long_names(void **state) {
  (void)state;
  size_t size;
  assert_int_equal(write_named(256, 10500, &size), STY_OK);
  assert_in_range(size, 256 * 10500, STY_MOST_REPORT_BYTES - 1);
  assert_int_equal(write_named(256, 12000, &size), STY_ERROR_INPUT);
  assert_int_equal(size, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_sphere),
      cmocka_unit_test(test_small_table),
      cmocka_unit_test(test_half_a_sphere),
      cmocka_unit_test(test_every_direction),
      cmocka_unit_test(test_half_that_is_enough),
      cmocka_unit_test(test_cube),
      cmocka_unit_test(test_two_spheres),
      cmocka_unit_test(test_another_guide),
      cmocka_unit_test(test_wrong_table),
      cmocka_unit_test(test_background),
      cmocka_unit_test(test_bytes),
      cmocka_unit_test(test_page),
      cmocka_unit_test(test_names_and_failures),
      cmocka_unit_test(test_long_names),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
