#include "stylut/warp.h"

#include <math.h>

#include "../scratch.h"

enum { MOST = 32 };

/* Room for pairs, and the pairs in it. */
typedef struct Set {
  StyPair room[MOST];
  StyPairs pairs;
} Set;

static void open_set(Set *set, StyWarpKind kind, int count) {
  memset(set, 0, sizeof *set);
  set->pairs = (StyPairs){.kind = kind, .alpha = 1, .count = count, .pairs = set->room};
}

/* `to` at random within a margin around a picture, `from` by a matrix and an offset. */
static void scatter_pairs(Set *set, const double size[2], const double m[2][2], const double offset[2], uint64_t seed) {
  for (int i = 0; i < set->pairs.count; i++) {
    StyPair *pair = &set->room[i];
    for (int k = 0; k < 2; k++) pair->to[k] = (0.5 + 0.6 * (double)draw_signed(&seed)) * size[k];
    for (int k = 0; k < 2; k++) pair->from[k] = m[k][0] * pair->to[0] + m[k][1] * pair->to[1] + offset[k];
  }
}

static StyImage *warp(const StyPairs *pairs, int width, int height, StyWarpFigures *figures) {
  StyImage *field = NULL;
  StyError error = {STY_OK, ""};
  if (sty_make_warp_guide("some.json", pairs, width, height, NULL, figures, &field, &error)) fail_msg("%s", error.text);
  assert_int_equal(field->width, width);
  assert_int_equal(field->height, height);
  assert_int_equal(field->channel_count, 3);
  return field;
}

/* Where a pixel comes from; false outside the picture. */
static bool get_place(const StyImage *field, int x, int y, double out[2]) {
  const size_t pixel = (size_t)y * (size_t)field->width + (size_t)x;
  out[0] = x + 0.5 + (double)sty_find_channel(field, "motion.U")[pixel];
  out[1] = y + 0.5 + (double)sty_find_channel(field, "motion.V")[pixel];
  return sty_find_channel(field, "A")[pixel] > 0;
}

static void expect_near(const char *what, double found, double expected, double tolerance) {
  if (!(fabs(found - expected) <= tolerance)) fail_msg("%s: found %.9g, expected %.9g", what, found, expected);
}

/* ---- the paper's formulas, as they stand there ----------------------------------- */

static void refer_centroids(const StyPairs *s, const double v[2], double *w, double p[2], double q[2]) {
  double sum = 0;
  p[0] = p[1] = q[0] = q[1] = 0;
  for (int i = 0; i < s->count; i++) {
    const double x = s->pairs[i].to[0] - v[0], y = s->pairs[i].to[1] - v[1];
    w[i] = 1 / pow(sqrt(x * x + y * y), 2 * s->alpha);
    sum += w[i];
    for (int k = 0; k < 2; k++) {
      p[k] += w[i] * s->pairs[i].to[k];
      q[k] += w[i] * s->pairs[i].from[k];
    }
  }
  for (int k = 0; k < 2; k++) {
    p[k] /= sum;
    q[k] /= sum;
  }
}

/* Eq. 5: (v - p*) (sum p^T w p)^-1 sum w p^T q + q*. */
static void refer_affine(const StyPairs *s, const double v[2], const double *w, const double ps[2], const double qs[2],
                         double out[2]) {
  double a[2][2] = {{0, 0}, {0, 0}}, b[2][2] = {{0, 0}, {0, 0}};
  for (int i = 0; i < s->count; i++)
    for (int r = 0; r < 2; r++)
      for (int c = 0; c < 2; c++) {
        a[r][c] += (s->pairs[i].to[r] - ps[r]) * w[i] * (s->pairs[i].to[c] - ps[c]);
        b[r][c] += w[i] * (s->pairs[i].to[r] - ps[r]) * (s->pairs[i].from[c] - qs[c]);
      }
  const double determinant = a[0][0] * a[1][1] - a[0][1] * a[1][0];
  const double inverse[2][2] = {{a[1][1] / determinant, -a[0][1] / determinant},
                                {-a[1][0] / determinant, a[0][0] / determinant}};
  for (int k = 0; k < 2; k++) {
    out[k] = qs[k];
    for (int r = 0; r < 2; r++)
      for (int c = 0; c < 2; c++) out[k] += (v[r] - ps[r]) * inverse[r][c] * b[c][k];
  }
}

/* Eqs. 6 to 8: the sum of q^ A_i with A_i = w_i (p^; -p^perp) (v - p*; -(v - p*)perp)^T, where (x, y)perp = (-y, x);
 * over mu_s, or of the length |v - p*|. */
static void refer_similarity(const StyPairs *s, const double v[2], const double *w, const double ps[2],
                             const double qs[2], double out[2]) {
  const double d[2] = {v[0] - ps[0], v[1] - ps[1]};
  double sum[2] = {0, 0}, mu = 0;
  for (int i = 0; i < s->count; i++) {
    const double p[2] = {s->pairs[i].to[0] - ps[0], s->pairs[i].to[1] - ps[1]};
    const double q[2] = {s->pairs[i].from[0] - qs[0], s->pairs[i].from[1] - qs[1]};
    const double left[2][2] = {{p[0], p[1]}, {p[1], -p[0]}}, right[2][2] = {{d[0], d[1]}, {d[1], -d[0]}};
    mu += w[i] * (p[0] * p[0] + p[1] * p[1]);
    for (int c = 0; c < 2; c++)
      for (int r = 0; r < 2; r++)
        for (int k = 0; k < 2; k++) sum[c] += q[r] * w[i] * left[r][k] * right[c][k];
  }
  const double length = sqrt(sum[0] * sum[0] + sum[1] * sum[1]), distance = sqrt(d[0] * d[0] + d[1] * d[1]);
  const double scale = s->kind == STY_WARP_RIGID ? distance / length : 1 / mu;
  for (int k = 0; k < 2; k++) out[k] = sum[k] * scale + qs[k];
}

static void refer(const StyPairs *s, const double v[2], double out[2]) {
  double w[MOST], p[2], q[2];
  refer_centroids(s, v, w, p, q);
  if (s->kind == STY_WARP_AFFINE)
    refer_affine(s, v, w, p, q, out);
  else
    refer_similarity(s, v, w, p, q, out);
}

static void test_formulas(void **state) {
  (void)state;
  static const double size[2] = {60, 40}, identity[2][2] = {{1, 0}, {0, 1}}, nowhere[2] = {0, 0};
  static const double alphas[] = {0.5, 1, 1.7, 2, 3};
  for (int kind = 0; kind < 3; kind++)
    for (int count = 3; count <= 20; count++) {
      Set set;
      uint64_t seed = (uint64_t)(kind * 100 + count);
      int inside = 0;
      open_set(&set, (StyWarpKind)kind, count);
      scatter_pairs(&set, size, identity, nowhere, seed);
      set.pairs.alpha = alphas[count % 5];
      for (int i = 0; i < count; i++)
        for (int k = 0; k < 2; k++) set.room[i].from[k] += 4 * (double)draw_signed(&seed);
      StyImage *field = warp(&set.pairs, 60, 40, NULL);
      for (int y = 0; y < 40; y++)
        for (int x = 0; x < 60; x++) {
          const double v[2] = {x + 0.5, y + 0.5};
          double found[2], expected[2];
          refer(&set.pairs, v, expected);
          const bool covered = get_place(field, x, y, found);
          const bool should = expected[0] >= 0 && expected[0] < 60 && expected[1] >= 0 && expected[1] < 40;
          assert_int_equal(covered, should);
          inside += covered;
          for (int k = 0; k < 2; k++) expect_near("place", found[k], covered ? expected[k] : v[k], 1e-4);
        }
      assert_true(inside > 1200);
      sty_destroy_image(&field);
    }
}

/* ---- maps that are of the kind, throughout --------------------------------------- */

static void expect_map(StyWarpKind kind, const double m[2][2], const double offset[2], double stretch,
                       double compression) {
  static const double size[2] = {50, 70};
  Set set;
  StyWarpFigures figures;
  open_set(&set, kind, 9);
  scatter_pairs(&set, size, m, offset, 7);
  StyImage *field = warp(&set.pairs, 50, 70, &figures);
  for (int y = 0; y < 70; y++)
    for (int x = 0; x < 50; x++) {
      double found[2];
      if (!get_place(field, x, y, found)) continue;
      for (int k = 0; k < 2; k++)
        expect_near("place", found[k], m[k][0] * (x + 0.5) + m[k][1] * (y + 0.5) + offset[k], 1e-5);
    }
  expect_near("stretch", figures.stretch, stretch, 1e-6);
  expect_near("compression", figures.compression, compression, 1e-6);
  assert_int_equal(figures.folded, 0);
  assert_int_equal(figures.cells, 49 * 69);
  assert_true(figures.measured > 3);
  expect_near("residual", figures.residual_max, 0, 1e-4);
  sty_destroy_image(&field);
}

static void test_maps_of_the_kind(void **state) {
  (void)state;
  static const double identity[2][2] = {{1, 0}, {0, 1}}, turned[2][2] = {{0.96, -0.28}, {0.28, 0.96}};
  static const double grown[2][2] = {{1.2, -0.35}, {0.35, 1.2}}, sheared[2][2] = {{1.5, 0}, {0, 0.5}};
  static const double nowhere[2] = {0, 0}, away[2] = {3.25, -1.5};
  for (int kind = 0; kind < 3; kind++) {
    expect_map((StyWarpKind)kind, identity, nowhere, 1, 1);
    expect_map((StyWarpKind)kind, identity, away, 1, 1);
    expect_map((StyWarpKind)kind, turned, away, 1, 1);
  }
  expect_map(STY_WARP_AFFINE, grown, away, 0.8, 1.25);
  expect_map(STY_WARP_SIMILARITY, grown, away, 0.8, 1.25);
  expect_map(STY_WARP_AFFINE, sheared, away, 2, 1.5);
}

static void test_identity_is_zero(void **state) {
  (void)state;
  static const double size[2] = {31, 17}, identity[2][2] = {{1, 0}, {0, 1}}, nowhere[2] = {0, 0};
  for (int kind = 0; kind < 3; kind++) {
    Set set;
    StyWarpFigures figures;
    open_set(&set, (StyWarpKind)kind, 6);
    scatter_pairs(&set, size, identity, nowhere, 9);
    StyImage *field = warp(&set.pairs, 31, 17, &figures);
    for (int i = 0; i < 31 * 17; i++) {
      expect_near("U", (double)field->data[i], 0, 1e-12);
      expect_near("V", (double)field->data[31 * 17 + i], 0, 1e-12);
      assert_true(field->data[2 * 31 * 17 + i] == 1);
    }
    assert_int_equal(figures.inside, 31 * 17);
    sty_destroy_image(&field);
  }
}

/* ---- what the method promises ----------------------------------------------------- */

static void test_pairs_are_met(void **state) {
  (void)state;
  static const double places[6][4] = {{3, 4, 5, 5},     {20, 6, 22, 4},   {8, 30, 6, 27},
                                      {28, 28, 30, 30}, {15, 15, 14, 19}, {36, 12, 33, 12}};
  for (int kind = 0; kind < 3; kind++)
    for (double alpha = STY_MIN_WARP_ALPHA; alpha <= STY_MAX_WARP_ALPHA; alpha += 0.5) {
      Set set;
      StyWarpFigures figures;
      open_set(&set, (StyWarpKind)kind, 6);
      set.pairs.alpha = alpha;
      for (int i = 0; i < 6; i++)
        set.room[i] = (StyPair){{places[i][2] + 0.25, places[i][3] + 0.5}, {places[i][0] + 0.5, places[i][1] + 0.5}};
      StyImage *field = warp(&set.pairs, 40, 40, &figures);
      for (int i = 0; i < 6; i++) {
        double found[2];
        assert_true(get_place(field, (int)places[i][0], (int)places[i][1], found));
        for (int k = 0; k < 2; k++) expect_near("at a pair", found[k], set.room[i].from[k], 1e-6);
      }
      assert_int_equal(figures.measured, 6);
      expect_near("residual", figures.residual_max, 0, 1e-5);
      sty_destroy_image(&field);
      /* A hair beside the pixels' centres all is the same: no weight runs away. */
      for (int i = 0; i < 6; i++) set.room[i].to[0] += 1e-7;
      field = warp(&set.pairs, 40, 40, NULL);
      for (int i = 0; i < 6; i++) {
        double found[2];
        assert_true(get_place(field, (int)places[i][0], (int)places[i][1], found));
        for (int k = 0; k < 2; k++) expect_near("beside a pair", found[k], set.room[i].from[k], 1e-5);
      }
      sty_destroy_image(&field);
    }
}

/* Two near pairs whose `from` are twice as far apart, seen from afar. */
static void test_rigid_keeps_lengths_where_similarity_scales(void **state) {
  (void)state;
  for (int kind = STY_WARP_SIMILARITY; kind <= STY_WARP_RIGID; kind++) {
    Set set;
    open_set(&set, (StyWarpKind)kind, 2);
    set.room[0] = (StyPair){{206, 200}, {202, 200}};
    set.room[1] = (StyPair){{194, 200}, {198, 200}};
    StyImage *field = warp(&set.pairs, 400, 400, NULL);
    const int y = 199, x = kind == STY_WARP_RIGID ? 390 : 220;
    double a[2], b[2];
    assert_true(get_place(field, x, y, a));
    assert_true(get_place(field, x + 1, y, b));
    expect_near("length of a pixel", sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1])),
                kind == STY_WARP_RIGID ? 1 : 3, 0.01);
    sty_destroy_image(&field);
  }
}

static void test_folds_are_counted(void **state) {
  (void)state;
  Set set;
  StyWarpFigures figures;
  open_set(&set, STY_WARP_AFFINE, 4);
  /* A mirrored picture turns over everywhere. */
  const double corners[4][2] = {{2, 2}, {30, 2}, {2, 30}, {30, 30}};
  for (int i = 0; i < 4; i++)
    set.room[i] = (StyPair){{32 - corners[i][0], corners[i][1]}, {corners[i][0], corners[i][1]}};
  StyImage *field = warp(&set.pairs, 32, 32, &figures);
  assert_int_equal(figures.folded, figures.cells);
  assert_int_equal(figures.stretch_at[0], -1);
  sty_destroy_image(&field);
  /* Two points that change places, others that stay: some of it. */
  set.pairs.kind = STY_WARP_RIGID;
  for (int i = 0; i < 2; i++) set.room[i] = (StyPair){{i ? 12 : 20, 16}, {i ? 20 : 12, 16}};
  for (int i = 2; i < 4; i++) set.room[i] = (StyPair){{corners[i][0], corners[i][1]}, {corners[i][0], corners[i][1]}};
  field = warp(&set.pairs, 32, 32, &figures);
  assert_true(figures.folded > 0 && figures.folded < figures.cells);
  sty_destroy_image(&field);
}

static void test_what_comes_from_outside(void **state) {
  (void)state;
  Set set;
  StyWarpFigures figures;
  open_set(&set, STY_WARP_RIGID, 1);
  set.room[0] = (StyPair){{10, 0}, {0, 0}};
  StyImage *field = warp(&set.pairs, 32, 8, &figures);
  for (int y = 0; y < 8; y++)
    for (int x = 0; x < 32; x++) {
      const bool inside = x < 22;
      assert_true(sty_find_channel(field, "A")[32 * y + x] == (float)inside);
      assert_true(sty_find_channel(field, "motion.U")[32 * y + x] == (inside ? 10 : 0));
      assert_true(sty_find_channel(field, "motion.V")[32 * y + x] == 0);
    }
  assert_int_equal(figures.inside, 22 * 8);
  assert_int_equal(figures.measured, 1);
  sty_destroy_image(&field);
}

static void test_normalized_places(void **state) {
  (void)state;
  Set set, other;
  uint64_t seed = 5;
  open_set(&set, STY_WARP_RIGID, 5);
  other = set;
  other.pairs.pairs = other.room;
  other.pairs.normalized = true;
  for (int i = 0; i < 5; i++)
    for (int k = 0; k < 2; k++) {
      const double side = k ? 32 : 64;
      other.room[i].to[k] = (double)draw_signed(&seed);
      other.room[i].from[k] = (double)draw_signed(&seed);
      set.room[i].to[k] = other.room[i].to[k] * side;
      set.room[i].from[k] = other.room[i].from[k] * side;
    }
  StyImage *a = warp(&set.pairs, 64, 32, NULL), *b = warp(&other.pairs, 64, 32, NULL);
  assert_memory_equal(a->data, b->data, 3 * 64 * 32 * sizeof(float));
  sty_destroy_image(&a);
  sty_destroy_image(&b);
}

static void test_sizes_and_threads(void **state) {
  (void)state;
  static const int sizes[][2] = {{1, 1}, {1, 9}, {9, 1}, {5, 33}, {40, 100}, {3, 64}};
  for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
    const double size[2] = {sizes[s][0], sizes[s][1]}, m[2][2] = {{0.9, 0.2}, {-0.1, 1.1}}, offset[2] = {0.3, 0.2};
    Set set;
    StyImage *one = NULL, *three = NULL;
    StyWarpFigures figures[2];
    open_set(&set, STY_WARP_RIGID, 7);
    set.pairs.alpha = 1.3;
    scatter_pairs(&set, size, m, offset, 8);
    assert_int_equal(sty_make_warp_guide("a", &set.pairs, sizes[s][0], sizes[s][1], &(StyRun){.threads = 1},
                                         &figures[0], &one, NULL),
                     STY_OK);
    assert_int_equal(sty_make_warp_guide("a", &set.pairs, sizes[s][0], sizes[s][1], &(StyRun){.threads = 3},
                                         &figures[1], &three, NULL),
                     STY_OK);
    assert_memory_equal(one->data, three->data, 3 * sizeof(float) * sty_count_pixels(one));
    assert_true(figures[0].stretch == figures[1].stretch && figures[0].compression == figures[1].compression);
    assert_int_equal(figures[0].stretch_at[0], figures[1].stretch_at[0]);
    assert_int_equal(figures[0].stretch_at[1], figures[1].stretch_at[1]);
    assert_int_equal(figures[0].cells, (sizes[s][0] - 1) * (sizes[s][1] - 1));
    sty_destroy_image(&one);
    sty_destroy_image(&three);
  }
}

/* ---- pairs that can't be solved --------------------------------------------------- */

static void expect_refusal(const StyPairs *pairs, StyStatus expected, const char *const *parts) {
  StyImage *field = NULL;
  StyError error = {STY_OK, ""};
  expect_message(sty_make_warp_guide("some.json", pairs, 8, 8, NULL, NULL, &field, &error), expected, &error, parts);
  assert_null(field);
}

static void test_pairs_too_few_for_a_kind(void **state) {
  (void)state;
  Set set;
  StyImage *field;
  for (int count = 0; count <= 5; count++) {
    open_set(&set, STY_WARP_AFFINE, count);
    for (int i = 0; i < count; i++) set.room[i] = (StyPair){{i, i * i}, {1 + 0.5 * i, 2 + 0.25 * i}}; /* on a line */
    if (count)
      expect_refusal(&set.pairs, STY_ERROR_INPUT, PARTS("some.json", "affine", "on one line", "similarity"));
    else
      expect_refusal(&set.pairs, STY_ERROR_INPUT, PARTS("some.json", "0 pairs", "1 to 4096"));
    for (int kind = STY_WARP_SIMILARITY; count && kind <= STY_WARP_RIGID; kind++) {
      set.pairs.kind = (StyWarpKind)kind;
      field = warp(&set.pairs, 8, 8, NULL);
      for (int i = 0; i < 192; i++) assert_true(isfinite(field->data[i]));
      sty_destroy_image(&field);
    }
  }
}

/* What lies on a line but for a share of its length, in the picture and in the source. */
static void test_points_nearly_on_a_line(void **state) {
  (void)state;
  static const double shares[] = {0, 1e-9, 1e-4, 0.01, 0.5};
  for (int is_to = 0; is_to < 2; is_to++)
    for (size_t s = 0; s < sizeof shares / sizeof *shares; s++) {
      Set set;
      open_set(&set, STY_WARP_AFFINE, 3);
      for (int i = 0; i < 3; i++) {
        const double thin[2] = {1 + 2 * i, 2 + i + (i == 1) * 4 * shares[s]}, thick[2] = {1 + i, 1 + i * i};
        memcpy(set.room[i].to, is_to ? thin : thick, sizeof thin);
        memcpy(set.room[i].from, is_to ? thick : thin, sizeof thin);
      }
      if (shares[s] < 1e-3) {
        expect_refusal(&set.pairs, STY_ERROR_INPUT, PARTS("some.json", "on one line", is_to ? "'to'" : "'from'"));
        continue;
      }
      StyImage *field = warp(&set.pairs, 8, 8, NULL);
      sty_destroy_image(&field);
    }
}

static void test_pairs_outside_the_picture(void **state) {
  (void)state;
  Set set;
  StyWarpFigures figures;
  open_set(&set, STY_WARP_RIGID, 4);
  set.room[0] = (StyPair){{0, 0}, {8, 8}}; /* corners are inside */
  set.room[1] = (StyPair){{9, 3}, {3, 3}};
  set.room[2] = (StyPair){{4, 4}, {4, -0.5}};
  set.room[3] = (StyPair){{5, 5}, {5, 5}};
  StyImage *field = warp(&set.pairs, 8, 8, &figures);
  assert_int_equal(figures.outside, 2);
  assert_int_equal(figures.first_outside, 1);
  assert_int_equal(figures.measured, 3);
  sty_destroy_image(&field);
  for (int i = 0; i < 4; i++) set.room[i].to[0] += 9;
  expect_refusal(&set.pairs, STY_ERROR_INPUT, PARTS("some.json", "none of 4 pairs", "(17, 8) of 8x8 pixels"));
  set.pairs.normalized = true;
  expect_refusal(&set.pairs, STY_ERROR_INPUT, PARTS("some.json", "none of 4 pairs", "(136, 64) of 8x8 pixels"));
}

static void test_pairs_that_make_no_sense(void **state) {
  (void)state;
  Set set;
  open_set(&set, STY_WARP_RIGID, 3);
  for (int i = 0; i < 3; i++) set.room[i] = (StyPair){{i, 1}, {2, i}};
  set.room[2].to[1] = 0;
  expect_refusal(&set.pairs, STY_ERROR_INPUT, PARTS("some.json", "'to'", "0 and 2"));
  set.room[2] = (StyPair){{1, 1}, {7, 7}};
  expect_refusal(&set.pairs, STY_ERROR_INPUT, PARTS("some.json", "'from'", "1 and 2"));
  set.room[2].from[0] = NAN;
  expect_refusal(&set.pairs, STY_ERROR_INPUT, PARTS("nan", "pair 2"));
  set.room[2].from[0] = -2e6;
  expect_refusal(&set.pairs, STY_ERROR_INPUT, PARTS("-2e+06", "1e+06"));
  set.room[2].from[0] = 5;
  set.pairs.alpha = 9;
  expect_refusal(&set.pairs, STY_ERROR_USAGE, PARTS("alpha = 9", "0.5 to 4"));
  set.pairs.alpha = NAN;
  expect_refusal(&set.pairs, STY_ERROR_USAGE, PARTS("alpha = nan"));
}

/* ---- files ------------------------------------------------------------------------ */

static StyStatus read_text(Scratch *scratch, const char *text, StyPairs *out, StyError *error) {
  return sty_read_pairs(write_bytes(scratch, "pairs.json", text, strlen(text)), out, error);
}

static void test_files(void **state) {
  StyPairs pairs;
  assert_int_equal(read_text(*state,
                             "{\"schema\": \"stylut-pairs/1\", \"kind\": \"affine\", \"alpha\": 2.5, \"units\": "
                             "\"normalized\", \"pairs\": [{\"from\": [0, 0.25], \"to\": [1, -3]}, {\"to\": [2, 2], "
                             "\"from\": [4, 5]}]}",
                             &pairs, NULL),
                   STY_OK);
  assert_int_equal(pairs.kind, STY_WARP_AFFINE);
  assert_true(pairs.alpha == 2.5 && pairs.normalized);
  assert_int_equal(pairs.count, 2);
  assert_true(pairs.pairs[0].from[1] == 0.25 && pairs.pairs[0].to[1] == -3 && pairs.pairs[1].from[0] == 4);
  sty_free_pairs(&pairs);
  assert_int_equal(
      read_text(*state, "{\"schema\": \"stylut-pairs/1\", \"pairs\": [{\"from\": [0, 0], \"to\": [1, 1]}]}", &pairs,
                NULL),
      STY_OK);
  assert_true(pairs.kind == STY_WARP_RIGID && pairs.alpha == 1 && !pairs.normalized);
  sty_free_pairs(&pairs);
}

#define HEAD "{\"schema\": \"stylut-pairs/1\",\n "
static void test_files_that_are_wrong(void **state) {
  static const char *const cases[][3] = {
      {"", ":1:", "JSON"},
      {"[]", ":1:1:", "an object"},
      {"{\"pairs\": []}", ":1:1:", "schema"},
      {"{\"schema\": \"stylut-pairs/2\"}", ":1:12:", "\"stylut-pairs/1\""},
      {HEAD "\"weights\": 1}", ":2:13:", "unknown key"},
      {HEAD "\"kind\": \"elastic\"}", ":2:10:", "rigid"},
      {HEAD "\"kind\": 3}", ":2:10:", "rigid"},
      {HEAD "\"alpha\": 0}", ":2:11:", "0.5 to 4"},
      {HEAD "\"alpha\": \"1\"}", ":2:11:", "0.5 to 4"},
      {HEAD "\"units\": \"cm\"}", ":2:11:", "normalized"},
      {HEAD "\"kind\": \"rigid\"}", ":1:1:", "pairs"},
      {HEAD "\"pairs\": []}", ":2:11:", "1 to 4096"},
      {HEAD "\"pairs\": {}}", ":2:11:", "1 to 4096"},
      {HEAD "\"pairs\": [3]}", ":2:12:", "an object"},
      {HEAD "\"pairs\": [{\"from\": [1, 2]}]}", ":2:12:", "\"to\""},
      {HEAD "\"pairs\": [{\"to\": [1, 2]}]}", ":2:12:", "\"from\""},
      {HEAD "\"pairs\": [{\"to\": [1, 2], \"from\": [1]}]}", ":2:35:", "2 numbers"},
      {HEAD "\"pairs\": [{\"to\": [1, 2], \"from\": [1, 2e6]}]}", ":2:39:", "1e+06"},
      {HEAD "\"units\": \"normalized\", \"pairs\": [{\"to\": [1, 2], \"from\": [1, 2e3]}]}", ":2:62:", "1000"},
      {HEAD "\"pairs\": [{\"to\": [1, 2], \"from\": [1, 2], \"w\": 1}]}", ":2:48:", "unknown key"},
      {HEAD "\"pairs\": [{\"to\": [1, 2], \"from\": [1, 2]},\n{\"to\": [1, 2], \"from\": [3, 2]}]}",
       ":3:8:", "pairs[0]"},
      {HEAD "\"pairs\": [{\"to\": [1, 2], \"from\": [1, 2]},\n{\"to\": [1, 3], \"from\": [1, 2]}]}",
       ":3:24:", "pairs[0]"},
  };
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    StyPairs pairs = {.count = -7};
    StyError error = {STY_OK, ""};
    expect_message(read_text(*state, cases[c][0], &pairs, &error), STY_ERROR_INPUT, &error,
                   PARTS("pairs.json", cases[c][1], cases[c][2]));
    assert_int_equal(pairs.count, -7);
  }
  StyError error = {STY_OK, ""};
  StyPairs pairs;
  expect_message(sty_read_pairs(path_in(*state, "none.json"), &pairs, &error), STY_ERROR_FILE, &error,
                 PARTS("none.json"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_formulas),
      cmocka_unit_test(test_maps_of_the_kind),
      cmocka_unit_test(test_identity_is_zero),
      cmocka_unit_test(test_pairs_are_met),
      cmocka_unit_test(test_rigid_keeps_lengths_where_similarity_scales),
      cmocka_unit_test(test_folds_are_counted),
      cmocka_unit_test(test_what_comes_from_outside),
      cmocka_unit_test(test_normalized_places),
      cmocka_unit_test(test_sizes_and_threads),
      cmocka_unit_test(test_pairs_too_few_for_a_kind),
      cmocka_unit_test(test_points_nearly_on_a_line),
      cmocka_unit_test(test_pairs_outside_the_picture),
      cmocka_unit_test(test_pairs_that_make_no_sense),
      scratch_test(test_files),
      scratch_test(test_files_that_are_wrong),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
