#include <math.h>

#include "../scratch.h"
#include "stylut/chart.h"
#include "stylut/guide.h"

static const StyRun one_thread = {.threads = 1}, two_threads = {.threads = 2};
static const StyAuditOptions by_disc = {.weights = STY_WEIGHT_DISC};

static const StyEngine *get_engine(const char *name) {
  const StyEngine *engine = NULL;
  assert_int_equal(sty_find_engine("-e", name, &engine, NULL), STY_OK);
  return engine;
}

/* A sphere, whose upper left quarter is turned where `other` asks for a guide that isn't one. */
static StyImage *make_guide(int side, bool other) {
  StyImage *guide = NULL;
  assert_int_equal(sty_make_sphere_guide(side, side, STY_GUIDE_NORMAL, &guide, NULL), STY_OK);
  float *x = sty_find_channel(guide, "normal.X");
  for (int i = 0; other && i < side * side; i++)
    if (i % side < side / 2 && i / side < side / 2) x[i] = -x[i];
  return guide;
}

typedef struct Request {
  const char *engines[4];
  int sizes[4], size_count, repeats;
  const StyAuditOptions *audit;
} Request;

static StyStatus measure(const StyImage *guide, const Request *request, const StyRun *run, StyChart *out,
                         StyError *error) {
  const StyEngine *engines[4];
  int count = 0;
  for (; count < 4 && request->engines[count]; count++) engines[count] = get_engine(request->engines[count]);
  const StyChartOptions options = {.sizes = request->sizes,
                                   .size_count = request->size_count,
                                   .engines = engines,
                                   .engine_count = count,
                                   .repeats = request->repeats,
                                   .audit = request->audit ? request->audit : &by_disc};
  StySites *sites = NULL;
  assert_int_equal(sty_collect_sites("guide", guide, &sites, NULL), STY_OK);
  const StyStatus status = sty_measure_chart(sites, guide, &options, run, out, error);
  sty_destroy_sites(&sites);
  return status;
}

/* ---- figures -------------------------------------------------------------------- */

static void test_median(void **state) {
  (void)state;
  assert_true(sty_find_median((double[]){7}, 1) == 7);
  assert_true(sty_find_median((double[]){9, 1, 5}, 3) == 5);
  assert_true(sty_find_median((double[]){9, 1, 5, 7}, 4) == 5);
  assert_true(sty_find_median((double[]){2, 2, 9, 2, 1}, 5) == 2);
}

/* In other words: a point is on the front unless some other is left of it and not above, or below it and not right. */
static void test_front(void **state) {
  (void)state;
  uint64_t seed = 1;
  for (int round = 0; round < CASES(300, 30); round++) {
    StyChartPoint points[24] = {{0}};
    const int count = 1 + draw_below(&seed, 24);
    for (int i = 0; i < count; i++) {
      points[i].bytes = (size_t)draw_below(&seed, 8);
      points[i].milliseconds = draw_below(&seed, 8);
      points[i].lookup.p99 = draw_below(&seed, 8);
      points[i].places[STY_PANEL_TIME] = draw_below(&seed, 4) ? STY_PLACE_BEHIND : STY_PLACE_NONE;
      points[i].places[STY_PANEL_BYTES] = STY_PLACE_BEHIND;
    }
    for (int panel = 0; panel < STY_PANELS; panel++) {
      sty_mark_front(points, count, (StyChartPanel)panel);
      for (int i = 0; i < count; i++) {
        if (panel == STY_PANEL_TIME && points[i].places[panel] == STY_PLACE_NONE) continue;
        bool beaten = false;
        for (int k = 0; k < count; k++) {
          const double x = panel == STY_PANEL_TIME ? points[i].milliseconds : (double)points[i].bytes;
          const double other = panel == STY_PANEL_TIME ? points[k].milliseconds : (double)points[k].bytes;
          const double y = points[i].lookup.p99, other_y = points[k].lookup.p99;
          if (points[k].places[panel] == STY_PLACE_NONE) continue;
          beaten |= (other < x && other_y <= y) || (other_y < y && other <= x);
        }
        assert_int_equal(points[i].places[panel], beaten ? STY_PLACE_BEHIND : STY_PLACE_FRONT);
      }
    }
  }
}

/* What a table prints as equal is equal. */
static void test_front_by_printed_figures(void **state) {
  (void)state;
  StyChartPoint points[2] = {{.bytes = 8, .lookup.p99 = 1.0000001, .places = {0, STY_PLACE_BEHIND}},
                             {.bytes = 8, .lookup.p99 = 1.0000002, .places = {0, STY_PLACE_BEHIND}}};
  sty_mark_front(points, 2, STY_PANEL_BYTES);
  assert_int_equal(points[1].places[STY_PANEL_BYTES], STY_PLACE_FRONT);
}

/* ---- the grid of measurements ----------------------------------------------------- */

/* The table of a point, built, stored and audited by hand. */
static StyFigures audit_point(const StyImage *guide, const StyChartPoint *point) {
  StySites *sites = NULL;
  StyLut *lut = NULL, *stored = NULL;
  StyImage *image = NULL;
  StyFigures figures;
  assert_int_equal(sty_collect_sites("guide", guide, &sites, NULL), STY_OK);
  assert_int_equal(sty_build_lut(sites, point->engine, &point->parameters, &point->spec, &one_thread, &lut, NULL),
                   STY_OK);
  assert_int_equal(sty_encode_lut(lut, point->encoding, &image, NULL), STY_OK);
  assert_int_equal(sty_decode_lut("lut", image, &(StyLutHints){.sampling = -1}, &stored, NULL), STY_OK);
  assert_int_equal(sty_audit_lookup(stored, guide, &by_disc, &figures, NULL), STY_OK);
  sty_destroy_image(&image);
  sty_destroy_lut(&lut);
  sty_destroy_lut(&stored);
  sty_destroy_sites(&sites);
  return figures;
}

static void expect_point(const StyImage *guide, const StyChartPoint *point, int repeats) {
  static const size_t texel_bytes[] = {8, 4, 4, 2};
  const StyFigures figures = audit_point(guide, point);
  assert_int_equal(point->bytes, texel_bytes[point->encoding] * (size_t)(point->spec.width * point->spec.width));
  assert_int_equal(point->runs, repeats);
  assert_true(point->milliseconds > 0);
  assert_true(point->lookup.p99 == figures.p99 && point->lookup.mean == figures.mean);
  const bool plain = point->spec.map == STY_MAP_XY && point->spec.metric == STY_METRIC_XY;
  const bool timed = plain && point->encoding == STY_ENCODE_F32;
  assert_int_equal(point->places[STY_PANEL_TIME] != STY_PLACE_NONE, timed);
  assert_int_equal(point->places[STY_PANEL_BYTES] != STY_PLACE_NONE, point->engine == get_engine("auto"));
}

/* A source of 300 pixels, so that rg8 loses something. */
static void test_points(void **state) {
  (void)state;
  StyImage *guide = make_guide(300, false);
  StyChart chart;
  StyError error;
  const Request request = {{"cgal", "flann-single", "auto", NULL}, {4, 9}, 2, 3, NULL};
  if (measure(guide, &request, &one_thread, &chart, &error)) fail_msg("%s", error.text);
  const int engines = chart.omission_count ? 2 : 3; /* cgal may not be built in */
  assert_int_equal(chart.count, (engines - 1) * 2 + 2 * 2 * 2 * 4);
  for (int p = 0; p < chart.count; p++) {
    expect_point(guide, &chart.points[p], request.repeats);
    if (!p || chart.points[p].spec.width == 4) continue;
    /* By size within a series. */
    assert_int_equal(chart.points[p].spec.width, 9);
    assert_int_equal(chart.points[p - 1].spec.width, 4);
    assert_ptr_equal(chart.points[p - 1].engine, chart.points[p].engine);
    assert_int_equal(chart.points[p - 1].encoding, chart.points[p].encoding);
  }
  sty_free_chart(&chart);
  sty_destroy_image(&guide);
}

static void test_same_on_any_number_of_threads(void **state) {
  (void)state;
  StyImage *guide = make_guide(40, true);
  StyChart charts[2];
  const Request request = {{"grid", "brute", NULL}, {8, 16, 17}, 3, 2, NULL};
  assert_int_equal(measure(guide, &request, &one_thread, &charts[0], NULL), STY_OK);
  assert_int_equal(measure(guide, &request, &two_threads, &charts[1], NULL), STY_OK);
  assert_int_equal(charts[0].count, charts[1].count);
  for (int p = 0; p < charts[0].count; p++) {
    const StyChartPoint *a = &charts[0].points[p], *b = &charts[1].points[p];
    assert_memory_equal(&a->spec, &b->spec, sizeof a->spec);
    assert_memory_equal(&a->lookup, &b->lookup, sizeof a->lookup);
    assert_int_equal(a->places[STY_PANEL_BYTES], b->places[STY_PANEL_BYTES]);
  }
  sty_free_chart(&charts[0]);
  sty_free_chart(&charts[1]);
  sty_destroy_image(&guide);
}

static void test_parameters(void **state) {
  (void)state;
  StyImage *guide = make_guide(20, false);
  StyChart chart;
  char text[STY_PARAMETERS_SIZE];
  const Request request = {{"flann-forest", "flann-auto", NULL}, {8}, 1, 1, NULL};
  assert_int_equal(measure(guide, &request, &one_thread, &chart, NULL), STY_OK);
  assert_int_equal(chart.omission_count, 0);
  assert_int_equal(chart.count, 3 + 1 + 16);
  const StyChartPoint *points = chart.points;
  assert_string_equal(sty_format_parameters(points[0].engine, &points[0].parameters, text), "trees=1 checks=8");
  assert_string_equal(sty_format_parameters(points[2].engine, &points[2].parameters, text), "trees=8 checks=128");
  assert_string_equal(sty_format_parameters(points[3].engine, &points[3].parameters, text), "precision=0.9");
  assert_string_equal(sty_format_parameters(points[4].engine, &points[4].parameters, text), "");
  sty_free_chart(&chart);
  sty_destroy_image(&guide);
}

/* ---- what is left out --------------------------------------------------------------- */

static void test_left_out(void **state) {
  (void)state;
  StyImage *guide = make_guide(300, true);
  StyChart chart;
  /* 53,000 distinct values for each of 220 x 220 texels: 2.6e9 distances. */
  const Request request = {{"analytic", "brute", "grid", NULL}, {4, 220}, 2, 1, NULL};
  assert_int_equal(measure(guide, &request, &one_thread, &chart, NULL), STY_OK);
  assert_int_equal(chart.omission_count, 2);
  assert_string_equal(chart.omissions[0].engine->name, "analytic");
  assert_int_equal(chart.omissions[0].size, 4);
  assert_non_null(strstr(chart.omissions[0].reason, "sphere"));
  assert_string_equal(chart.omissions[1].engine->name, "brute");
  assert_int_equal(chart.omissions[1].size, 220);
  assert_int_equal(chart.count, 1 + 2 * 16);
  assert_string_equal(chart.points[0].engine->name, "brute");
  sty_free_chart(&chart);
  sty_destroy_image(&guide);
}

static void test_failures(void **state) {
  (void)state;
  StyImage *guide = make_guide(20, true), *empty = make_guide(20, false);
  StyChart chart = {.count = -1};
  StyError error;
  const Request none_left = {{"analytic", NULL}, {4}, 1, 1, NULL};
  expect_message(measure(guide, &none_left, &one_thread, &chart, &error), STY_ERROR_INPUT, &error,
                 PARTS("analytic", "sphere"));
  memset(sty_find_channel(empty, "A"), 0, sty_count_pixels(empty) * sizeof(float));
  const StyImage *frames[] = {empty};
  const StyAuditOptions by_frames = {.weights = STY_WEIGHT_FRAMES, .frames = frames, .frame_count = 1};
  const Request framed = {{"grid", NULL}, {4}, 1, 1, &by_frames};
  expect_message(measure(guide, &framed, &one_thread, &chart, &error), STY_ERROR_INPUT, &error, PARTS("frames"));
  assert_int_equal(chart.count, -1);
  sty_destroy_image(&guide);
  sty_destroy_image(&empty);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_median),     cmocka_unit_test(test_front),
      cmocka_unit_test(test_points),     cmocka_unit_test(test_front_by_printed_figures),
      cmocka_unit_test(test_parameters), cmocka_unit_test(test_same_on_any_number_of_threads),
      cmocka_unit_test(test_left_out),   cmocka_unit_test(test_failures),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
