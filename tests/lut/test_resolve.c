#include <math.h>

#include "../scratch.h"
#include "stylut/audit.h"
#include "stylut/guide.h"
#include "stylut/lut.h"

static StyImage *make_sphere(int side) {
  StyImage *guide = NULL;
  assert_int_equal(sty_make_sphere_guide(side, side, STY_GUIDE_NORMAL, &guide, NULL), STY_OK);
  return guide;
}

/* `copies` spheres side by side: every value stands in as many places. */
static StyImage *make_row_of_spheres(int side, int copies) {
  static const char *const names[] = {"A", "normal.X", "normal.Y"};
  StyImage *sphere = make_sphere(side), *row = NULL;
  assert_int_equal(sty_create_image(side * copies, side, 3, names, 32, &row, NULL), STY_OK);
  for (int c = 0; c < 3; c++)
    for (int y = 0; y < side; y++)
      for (int x = 0; x < side * copies; x++)
        sty_find_channel(row, names[c])[y * side * copies + x] =
            sty_find_channel(sphere, names[c])[y * side + x % side];
  sty_destroy_image(&sphere);
  return row;
}

/* Values here and there: as ambiguous as it gets. */
static StyImage *make_noise(int width, int height, int values, uint64_t *random) {
  static const char *const names[] = {"A", "normal.X", "normal.Y"};
  StyImage *guide = NULL;
  assert_int_equal(sty_create_image(width, height, 3, names, 32, &guide, NULL), STY_OK);
  const int count = width * height;
  for (int i = 0; i < count; i++) {
    guide->data[i] = (float)(i == 0 || draw_below(random, 5) > 0);
    for (int c = 1; c < 3; c++) guide->data[c * count + i] = (float)draw_below(random, values) * 2 / (float)values - 1;
  }
  return guide;
}

typedef struct Tables {
  StySites *sites;
  StyLut *nearest, *coherent; /* the latter resolved, one way or another */
} Tables;

/* With other choices than coherent where `options` say so. */
static Tables build_with(const StyImage *guide, StyLutSpec spec, const StyResolveOptions *options, const StyRun *run) {
  Tables t = {0};
  const StyEngine *engine = NULL;
  StyError error = {STY_OK, ""};
  assert_int_equal(sty_find_engine("-e", "auto", &engine, NULL), STY_OK);
  assert_int_equal(sty_collect_sites("guide", guide, &t.sites, NULL), STY_OK);
  assert_int_equal(sty_build_lut(t.sites, engine, NULL, &spec, NULL, &t.nearest, NULL), STY_OK);
  assert_int_equal(sty_build_lut(t.sites, engine, NULL, &spec, NULL, &t.coherent, NULL), STY_OK);
  if (sty_resolve_lut(t.coherent, t.sites, options, run, &error) != STY_OK) fail_msg("%s", error.text);
  return t;
}

static Tables build(const StyImage *guide, StyLutSpec spec, double slack) {
  return build_with(guide, spec, &(StyResolveOptions){.slack = slack, .coherent = true, .guide = guide}, NULL);
}

static void destroy(Tables *t) {
  sty_destroy_sites(&t->sites);
  sty_destroy_lut(&t->nearest);
  sty_destroy_lut(&t->coherent);
}

static double count_jumps(const StyLut *lut) {
  const int width = lut->spec.width, height = lut->spec.height, source = lut->source_width;
  const double jump = 4.0 * (source > lut->source_height ? source : lut->source_height) / width;
  long pairs = 0, jumps = 0;
  for (int t = 0; t < width * height; t++)
    for (int s = 0; s < 2; s++) {
      const int i = t % width + (s == 0), j = t / width + (s == 1);
      if (i >= width || j >= height || !sty_is_feasible(&lut->spec, t % width, t / width) ||
          !sty_is_feasible(&lut->spec, i, j))
        continue;
      const int p = (int)lut->pixels[t], q = (int)lut->pixels[j * width + i];
      pairs++;
      jumps += hypot(p % source - q % source, p / source - q / source) > jump;
    }
  return pairs ? (double)jumps / (double)pairs : 0;
}

/* The distance that the table states is the one its pixel has, and not beyond the slack. */
static void expect_within_slack(const Tables *t, const StyImage *guide, double slack) {
  const float *a = sty_find_channel(guide, "A"), *x = sty_find_channel(guide, "normal.X"),
              *y = sty_find_channel(guide, "normal.Y");
  for (size_t texel = 0; texel < sty_count_texels(&t->coherent->spec); texel++) {
    const uint32_t pixel = t->coherent->pixels[texel];
    float g[2];
    sty_get_texel_value(&t->coherent->spec, (int)texel % t->coherent->spec.width, (int)texel / t->coherent->spec.width,
                        g);
    assert_true(a[pixel] > 0);
    const double distance = (double)t->coherent->errors[texel], least = (double)t->nearest->errors[texel];
    if (!(distance <= least + slack)) fail_msg("texel %zu: %g, beyond %g + %g", texel, distance, least, slack);
    if (t->coherent->spec.metric == STY_METRIC_XY)
      assert_true(fabs(hypot((double)g[0] - x[pixel], (double)g[1] - y[pixel]) - distance) < 1e-6);
  }
}

/* ---- tests --------------------------------------------------------------------- */

static void test_sphere_stays(void **state) {
  (void)state;
  StyImage *guide = make_sphere(128);
  Tables t = build(guide, (StyLutSpec){.width = 64, .height = 64}, 4 * STY_LEVEL);
  assert_memory_equal(t.coherent->pixels, t.nearest->pixels, sty_count_texels(&t.nearest->spec) * 4);
  assert_memory_equal(t.coherent->errors, t.nearest->errors, sty_count_texels(&t.nearest->spec) * 4);
  destroy(&t);
  sty_destroy_image(&guide);
}

/* Three equal spheres: the tie rule alone scatters over them, a coherent table needs one only. */
static void test_copies(void **state) {
  (void)state;
  StyImage *guide = make_row_of_spheres(64, 3);
  for (int metric = 0; metric < 2; metric++) {
    Tables t = build(guide, (StyLutSpec){.width = 64, .height = 64, .metric = (StyMetric)metric}, STY_LEVEL);
    assert_true(count_jumps(t.coherent) <= count_jumps(t.nearest));
    assert_true(count_jumps(t.coherent) < 0.001);
    expect_within_slack(&t, guide, STY_LEVEL);
    destroy(&t);
  }
  sty_destroy_image(&guide);
}

static void test_noise(void **state) {
  (void)state;
  uint64_t random = 7;
  for (int trial = 0; trial < 40; trial++) {
    const double slack = trial % 4 ? draw_below(&random, 40) * STY_LEVEL : 0;
    StyImage *guide =
        make_noise(1 + draw_below(&random, 60), 1 + draw_below(&random, 60), 2 + draw_below(&random, 30), &random);
    const StyLutSpec spec = {1 + draw_below(&random, 40), 1 + draw_below(&random, 40), STY_SAMPLE_CENTRE,
                             (StyMap)draw_below(&random, 2), (StyMetric)draw_below(&random, 2)};
    Tables t = build(guide, spec, slack);
    expect_within_slack(&t, guide, slack);
    destroy(&t);
    sty_destroy_image(&guide);
  }
}

/* The longest picture there may be, whose square of a side is beyond an int: the texels' own values lie at its two
 * ends by turns, and good enough ones at the other. */
static void test_longest_sides(void **state) {
  (void)state;
  enum { SIDE = 65536 };
  static const int sizes[] = {5, 7, 16};
  for (int trial = 0; trial < 6; trial++) {
    const int size = sizes[trial / 2];
    const StyLutSpec spec = {.width = size, .height = size};
    StyImage *guide = NULL;
    assert_int_equal(sty_create_image(trial % 2 ? 1 : SIDE, trial % 2 ? SIDE : 1, 3,
                                      (const char *const[]){"A", "normal.X", "normal.Y"}, 32, &guide, NULL),
                     STY_OK);
    for (int t = 0; t < size * size; t++)
      for (int end = 0; end < 2; end++) {
        const int pixel = end ? SIDE - 1 - t : t;
        float g[2];
        sty_get_texel_value(&spec, t % size, t / size, g);
        guide->data[pixel] = 1;
        guide->data[SIDE + pixel] = g[0];
        guide->data[2 * SIDE + pixel] = g[1] + (t % 2 == end ? 0 : 0.001f);
      }
    Tables t = build(guide, spec, STY_LEVEL);
    assert_true(count_jumps(t.nearest) > 0.4);
    assert_true(count_jumps(t.coherent) == 0);
    expect_within_slack(&t, guide, STY_LEVEL);
    destroy(&t);
    sty_destroy_image(&guide);
  }
}

/* Each value along a whole column, by angle: shorter ways are to be had here for a few more jumps. */
static void test_no_more_jumps(void **state) {
  (void)state;
  for (int size = 24; size <= 64; size += 8) {
    StyImage *guide = make_sphere(64);
    float *a = sty_find_channel(guide, "A"), *x = sty_find_channel(guide, "normal.X"),
          *y = sty_find_channel(guide, "normal.Y");
    for (int i = 0; i < 64 * 64; i++) {
      a[i] = 1;
      x[i] = (float)(2 * (i % 64) - 63) / 64;
      y[i] = 0;
    }
    for (int map = 0; map < 2; map++) {
      Tables t =
          build(guide, (StyLutSpec){size, size, STY_SAMPLE_CENTRE, (StyMap)map, STY_METRIC_ANGLE}, 2 * STY_LEVEL);
      assert_true(count_jumps(t.coherent) <= count_jumps(t.nearest));
      expect_within_slack(&t, guide, 2 * STY_LEVEL);
      destroy(&t);
    }
    sty_destroy_image(&guide);
  }
}

/* A surface that shows each value many times over must come out far calmer. */
static void test_calms(void **state) {
  (void)state;
  uint64_t random = 3;
  StyImage *guide = make_row_of_spheres(48, 4);
  /* A little noise on each copy: now the exact nearest neighbour jumps between them. */
  for (int c = 1; c < 3; c++)
    for (size_t i = 0; i < sty_count_pixels(guide); i++)
      guide->data[(size_t)c * sty_count_pixels(guide) + i] += draw_signed(&random) * 0.004f;
  Tables t = build(guide, (StyLutSpec){.width = 64, .height = 64}, 4 * STY_LEVEL);
  assert_true(count_jumps(t.nearest) > 0.4);
  assert_true(count_jumps(t.coherent) < 0.05);
  expect_within_slack(&t, guide, 4 * STY_LEVEL);
  Tables again = build(guide, (StyLutSpec){.width = 64, .height = 64}, 4 * STY_LEVEL);
  assert_memory_equal(t.coherent->pixels, again.coherent->pixels, sty_count_texels(&t.nearest->spec) * 4);
  destroy(&t);
  destroy(&again);
  sty_destroy_image(&guide);
}

/* ---- frames -------------------------------------------------------------------- */

/* Two spheres side by side; of the left one every second pixel of each row is
 * swapped with its neighbour, so that it has the same values in shattered
 * surroundings. With z, as frames and their guide need. */
static StyImage *make_shattered_and_whole(int side) {
  static const char *const names[] = {"A", "normal.X", "normal.Y", "normal.Z"};
  StyImage *sphere = make_sphere(side), *row = NULL;
  assert_int_equal(sty_create_image(side * 2, side, 4, names, 32, &row, NULL), STY_OK);
  for (int c = 0; c < 4; c++) {
    const float *from = sty_find_channel(sphere, names[c]);
    float *to = sty_find_channel(row, names[c]);
    for (int y = 0; y < side; y++)
      for (int x = 0; x < side; x++) {
        const int far = (x + side / 2) % side; /* half a sphere away */
        to[y * side * 2 + x] = from[y * side + (x % 2 ? far : x)];
        to[y * side * 2 + side + x] = from[y * side + x];
      }
  }
  sty_destroy_image(&sphere);
  return row;
}

/* Share of the feasible texels inside radius 0.9 that use the right half of the source. */
static double count_right(const StyLut *lut) {
  int count = 0, right = 0;
  for (int t = 0; t < (int)sty_count_texels(&lut->spec); t++) {
    float g[2];
    sty_get_texel_value(&lut->spec, t % lut->spec.width, t / lut->spec.width, g);
    if (hypot((double)g[0], (double)g[1]) > 0.9) continue;
    count++;
    right += (int)lut->pixels[t] % lut->source_width >= lut->source_width / 2;
  }
  return (double)right / count;
}

/* Pieces of a whole sphere can only be had from the whole sphere. */
static void test_frames_choose_the_whole(void **state) {
  (void)state;
  StyImage *guide = make_shattered_and_whole(96), *frame = make_sphere(200);
  const StyLutSpec spec = {.width = 64, .height = 64};
  for (int coherent = 0; coherent < 2; coherent++) {
    const StyResolveOptions options = {2 * STY_LEVEL, coherent, guide, (const StyImage *const *)&frame, 1};
    Tables t = build_with(guide, spec, &options, NULL);
    assert_true(count_right(t.nearest) < 0.6);
    const double right = count_right(t.coherent);
    if (!(right > 0.98)) fail_msg("coherent %d: %g of the texels on the whole sphere", coherent, right);
    expect_within_slack(&t, guide, 2 * STY_LEVEL);
    destroy(&t);
  }
  sty_destroy_image(&guide);
  sty_destroy_image(&frame);
}

/* A frame that shows only the right half of the directions serves no others. */
static void test_frames_leave_what_nobody_asks(void **state) {
  (void)state;
  StyImage *guide = make_shattered_and_whole(96), *frame = make_sphere(200);
  float *covered = sty_find_channel(frame, "A");
  for (int p = 0; p < 200 * 200; p++)
    if (p % 200 < 120) covered[p] = 0;
  const StyResolveOptions options = {2 * STY_LEVEL, false, guide, (const StyImage *const *)&frame, 1};
  Tables t = build_with(guide, (StyLutSpec){.width = 64, .height = 64}, &options, NULL);
  int changed = 0;
  for (int texel = 0; texel < 64 * 64; texel++) {
    if (t.coherent->pixels[texel] == t.nearest->pixels[texel]) continue;
    changed++;
    assert_true(texel % 64 > 32);
  }
  assert_true(changed > 100);
  destroy(&t);
  sty_destroy_image(&guide);
  sty_destroy_image(&frame);
}

static void test_frames_noise(void **state) {
  (void)state;
  static const char *const names[] = {"A", "normal.X", "normal.Y", "normal.Z"};
  uint64_t random = 11;
  for (int trial = 0; trial < 30; trial++) {
    StyImage *guides[3]; /* the table's, two frames */
    for (int k = 0; k < 3; k++) {
      const int width = 1 + draw_below(&random, 60), height = 1 + draw_below(&random, 60);
      StyImage *flat = make_noise(width, height, 2 + draw_below(&random, 30), &random);
      assert_int_equal(sty_create_image(width, height, 4, names, 32, &guides[k], NULL), STY_OK);
      memcpy(guides[k]->data, flat->data, (size_t)(width * height) * 3 * sizeof(float));
      sty_destroy_image(&flat);
    }
    const double slack = draw_below(&random, 40) * STY_LEVEL;
    const StyLutSpec spec = {1 + draw_below(&random, 40), 1 + draw_below(&random, 40), STY_SAMPLE_CENTRE,
                             (StyMap)draw_below(&random, 2), (StyMetric)draw_below(&random, 2)};
    const StyResolveOptions options = {slack, trial % 2, guides[0], (const StyImage *const *)guides + 1, 2};
    Tables t = build_with(guides[0], spec, &options, &(StyRun){.threads = 1});
    expect_within_slack(&t, guides[0], slack);
    Tables again = build_with(guides[0], spec, &options, &(StyRun){.threads = 3});
    assert_memory_equal(t.coherent->pixels, again.coherent->pixels, sty_count_texels(&spec) * 4);
    assert_memory_equal(t.coherent->errors, again.coherent->errors, sty_count_texels(&spec) * 4);
    destroy(&t);
    destroy(&again);
    for (int k = 0; k < 3; k++) sty_destroy_image(&guides[k]);
  }
}

static void test_frames_without_normals(void **state) {
  (void)state;
  StyImage *guide = make_shattered_and_whole(32), *frame = NULL;
  static const char *const names[] = {"A", "depth.Z"};
  assert_int_equal(sty_create_image(8, 8, 2, names, 32, &frame, NULL), STY_OK);
  const StyEngine *engine = NULL;
  StySites *sites = NULL;
  StyLut *lut = NULL;
  StyError error;
  assert_int_equal(sty_find_engine("-e", "auto", &engine, NULL), STY_OK);
  assert_int_equal(sty_collect_sites("guide", guide, &sites, NULL), STY_OK);
  const StyLutSpec spec = {.width = 16, .height = 16};
  assert_int_equal(sty_build_lut(sites, engine, NULL, &spec, NULL, &lut, NULL), STY_OK);
  const StyResolveOptions options = {STY_LEVEL, false, guide, (const StyImage *const *)&frame, 1};
  assert_int_equal(sty_resolve_lut(lut, sites, &options, NULL, &error), STY_ERROR_INPUT);
  assert_non_null(strstr(error.text, "expected channels A, normal."));
  sty_destroy_lut(&lut);
  sty_destroy_sites(&sites);
  sty_destroy_image(&guide);
  sty_destroy_image(&frame);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_sphere_stays),
      cmocka_unit_test(test_copies),
      cmocka_unit_test(test_noise),
      cmocka_unit_test(test_longest_sides),
      cmocka_unit_test(test_no_more_jumps),
      cmocka_unit_test(test_calms),
      cmocka_unit_test(test_frames_choose_the_whole),
      cmocka_unit_test(test_frames_leave_what_nobody_asks),
      cmocka_unit_test(test_frames_noise),
      cmocka_unit_test(test_frames_without_normals),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
