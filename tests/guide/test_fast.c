/* What makes guides fast, beside what it must equal: bands and the whole, vector units and plain C, outlines by rows
 * and their formula, and rays that aren't cast where nothing can be seen. */
#include <math.h>
#include <stdlib.h>

#include "../scene/scratch.h"
#include "stylut/guide.h"

enum { WIDTH = 173, HEIGHT = 333 };

static const unsigned ALL = STY_GUIDE_NORMAL | STY_GUIDE_DEPTH | STY_GUIDE_POSITION | STY_GUIDE_OBJECT |
                            STY_GUIDE_STYLE | STY_GUIDE_UV | STY_GUIDE_ALBEDO | STY_GUIDE_LUMA | STY_GUIDE_CURVATURE |
                            STY_GUIDE_CONTOUR;

static double draw_number(double low, double high) { return low + (high - low) * rand() / RAND_MAX; }

static void add_moved_cube(StyScene *scene, int mesh) {
  StyObject object = {.mesh = mesh, .style = 2, .material = sty_white};
  const double turn = draw_number(0, 6), size = draw_number(0.2, 0.8);
  const double rows[3][4] = {{size * cos(turn), 0, size * sin(turn), draw_number(-2, 2)},
                             {0, size, 0, draw_number(-2, 2)},
                             {-size * sin(turn), 0, size * cos(turn), draw_number(-2, 2)}};
  memcpy(object.transform, rows, sizeof rows);
  assert_int_equal(sty_add_object(scene, &object, NULL), STY_OK);
}

/* Some cubes and spheres; with a ball at each corner of a large cube around them, if asked. */
static StyScene *make_scene(Scratch *scratch, unsigned seed, bool surrounded) {
  StyScene *scene = NULL;
  StyMesh *mesh = NULL;
  int number;
  srand(seed);
  assert_int_equal(sty_create_scene(&scene, NULL), STY_OK);
  assert_int_equal(read_text_mesh(scratch, "cube.obj", CUBE_OBJ, 30, &mesh, NULL), STY_OK);
  assert_int_equal(sty_add_mesh(scene, &mesh, &number, NULL), STY_OK);
  for (int i = 0; i < 4; i++) add_moved_cube(scene, number);
  for (int i = 0; i < 3; i++) {
    const StySphere sphere = {.centre = {draw_number(-2, 2), draw_number(-2, 2), draw_number(-2, 2)},
                              .radius = draw_number(0.1, 0.7),
                              .style = 1,
                              .material = sty_white};
    assert_int_equal(sty_add_sphere(scene, &sphere, NULL), STY_OK);
  }
  for (int c = 0; surrounded && c < 8; c++) {
    const StySphere sphere = {.centre = {c & 1 ? 30 : -30, c & 2 ? 30 : -30, c & 4 ? 30 : -30},
                              .radius = 0.01,
                              .style = 9,
                              .material = sty_white};
    assert_int_equal(sty_add_sphere(scene, &sphere, NULL), STY_OK);
  }
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  return scene;
}

static StyStand draw_stand(bool perspective) {
  return (StyStand){.perspective = perspective,
                    .position = {draw_number(3, 6), draw_number(-3, 3), draw_number(3, 6)},
                    .target = {draw_number(-1, 1), draw_number(-1, 1), draw_number(-1, 1)},
                    .up = {0, 1, 0},
                    .fov = draw_number(20, 110),
                    .height = draw_number(3, 12)};
}

static StyTraceOptions make_options(void) {
  return (StyTraceOptions){.width = WIDTH, .height = HEIGHT, .groups = ALL, .contour = {1, 0.5}};
}

static StyCamera place(const StyScene *scene, const StyStand *stand) {
  StyCamera camera;
  assert_int_equal(sty_place_camera(scene, stand, WIDTH, HEIGHT, &camera, NULL), STY_OK);
  return camera;
}

static StyImage *trace(const StyScene *scene, const StyStand *stand) {
  const StyTraceOptions options = make_options();
  const StyCamera camera = place(scene, stand);
  StyImage *guide = NULL;
  assert_int_equal(sty_trace_guide(scene, &camera, &options, NULL, NULL, &guide, NULL), STY_OK);
  return guide;
}

static size_t count_covered(const StyImage *guide) {
  const float *coverage = sty_find_channel(guide, "A");
  size_t count = 0;
  for (size_t i = 0; i < sty_count_pixels(guide); i++) count += coverage[i] > 0;
  return count;
}

static void assert_same_bytes(const StyImage *a, const StyImage *b) {
  assert_int_equal(a->channel_count, b->channel_count);
  for (int c = 0; c < a->channel_count; c++) {
    const size_t count = sty_count_pixels(a);
    if (memcmp(a->data + (size_t)c * count, b->data + (size_t)c * count, count * sizeof(float)))
      fail_msg("found other values of %s", a->names[c]);
  }
}

/* ---- bands ---------------------------------------------------------------------- */

typedef struct Stack {
  StyImage *whole;
  int rows;
} Stack;

static StyStatus add_rows(void *context, StyImage *rows, StyError *error) {
  (void)error;
  Stack *stack = context;
  const size_t count = sty_count_pixels(rows), whole = sty_count_pixels(stack->whole);
  assert_true(stack->rows + rows->height <= HEIGHT);
  for (size_t c = 0; c < (size_t)rows->channel_count; c++)
    memcpy(stack->whole->data + c * whole + (size_t)stack->rows * WIDTH, rows->data + c * count, count * sizeof(float));
  stack->rows += rows->height;
  return STY_OK;
}

/* Outlines, which look beyond a band, too. */
static void test_bands_are_the_whole(void **state) {
  const StyTraceOptions options = make_options();
  for (unsigned seed = 1; seed < 5; seed++) {
    StyScene *scene = make_scene(*state, seed, false);
    const StyStand stand = draw_stand(seed % 2);
    const StyCamera camera = place(scene, &stand);
    StyImage *whole = trace(scene, &stand);
    assert_true(count_covered(whole) > 1000);
    for (int threads = 1; threads <= 2; threads++) {
      Stack stack = {trace(scene, &stand), 0};
      memset(stack.whole->data, 1, sty_count_pixels(whole) * sizeof(float));
      const StyRun run = {.threads = threads};
      assert_int_equal(sty_trace_rows(scene, &camera, &options, &run, &(StyRowSink){add_rows, &stack}, NULL, NULL),
                       STY_OK);
      assert_int_equal(stack.rows, HEIGHT);
      assert_same_bytes(stack.whole, whole);
      sty_destroy_image(&stack.whole);
    }
    sty_destroy_image(&whole);
    sty_destroy_scene(&scene);
  }
}

/* ---- vector units --------------------------------------------------------------- */

static void test_units_agree(void **state) {
  static const char *const units[] = {"plain", "avx2", "avx512"};
  for (unsigned seed = 1; seed < 5; seed++) {
    StyScene *scene = make_scene(*state, seed, false);
    const StyStand stand = draw_stand(seed % 2);
    StyImage *guides[3];
    for (int u = 0; u < 3; u++) {
      assert_int_equal(setenv("STYLUT_VECTOR", units[u], 1), 0);
      guides[u] = trace(scene, &stand);
      if (u > 0) assert_same_bytes(guides[0], guides[u]);
    }
    unsetenv("STYLUT_VECTOR");
    for (int u = 0; u < 3; u++) sty_destroy_image(&guides[u]);
    sty_destroy_scene(&scene);
  }
}

/* ---- outlines ------------------------------------------------------------------- */

typedef struct Planes {
  const float *coverage, *depth, *normal[3];
} Planes;

static Planes get_planes(const StyImage *guide) {
  return (Planes){
      sty_find_channel(guide, "A"),
      sty_find_channel(guide, "depth.Z"),
      {sty_find_channel(guide, "normal.X"), sty_find_channel(guide, "normal.Y"), sty_find_channel(guide, "normal.Z")}};
}

static size_t clamp_place(int x, int y) {
  const int column = x < 0 ? 0 : x < WIDTH ? x : WIDTH - 1, row = y < 0 ? 0 : y < HEIGHT ? y : HEIGHT - 1;
  return (size_t)row * WIDTH + (size_t)column;
}

/* As StyContourWeights says it, pixel by pixel. */
static double get_outline(const Planes *planes, int x, int y, const StyContourWeights *weights, double width) {
  const size_t here = clamp_place(x, y);
  double gap = 0, turn = 0;
  for (int axis = 0; axis < 2; axis++) {
    const int dx = axis == 0, dy = axis == 1;
    const size_t ends[2] = {clamp_place(x - dx, y - dy), clamp_place(x + dx, y + dy)};
    const bool missing = planes->coverage[ends[0]] == 0 || planes->coverage[ends[1]] == 0;
    const bool border = ends[0] == here || ends[1] == here;
    const double middle = ((double)planes->depth[ends[0]] + (double)planes->depth[ends[1]]) / 2;
    gap = fmax(gap, missing ? INFINITY : border ? 0 : fabs(middle - (double)planes->depth[here]));
    for (int e = 0; e < 2; e++) {
      double cosine = planes->coverage[ends[e]] == 0 ? 1 : 0;
      for (int k = 0; k < 3; k++) cosine += (double)planes->normal[k][here] * (double)planes->normal[k][ends[e]];
      turn = fmax(turn, 1 - cosine);
    }
  }
  return fmin(weights->depth * fmin(gap / (width * STY_CONTOUR_SPAN), 1) + weights->normal * turn, 1);
}

static void test_outlines_are_their_formula(void **state) {
  const StyContourWeights weights = make_options().contour;
  for (unsigned seed = 1; seed < 9; seed++) {
    StyScene *scene = make_scene(*state, seed, false);
    const StyStand stand = draw_stand(false);
    StyImage *guide = trace(scene, &stand);
    const Planes planes = get_planes(guide);
    const float *found = sty_find_channel(guide, "contour.Y");
    size_t strong = 0;
    for (int y = 0; y < HEIGHT; y++)
      for (int x = 0; x < WIDTH; x++) {
        const size_t i = clamp_place(x, y);
        const double wanted = planes.coverage[i] == 0 ? 0 : get_outline(&planes, x, y, &weights, stand.height / HEIGHT);
        assert_true(fabs((double)found[i] - wanted) < 1e-6);
        strong += wanted > 0.5;
      }
    assert_true(strong > 100);
    sty_destroy_image(&guide);
    sty_destroy_scene(&scene);
  }
}

/* ---- what is in sight ------------------------------------------------------------- */

/* With balls far out, all of the picture is looked at; what is seen of the rest stays what it is. Trace space is
 * another then, so that pixels right at an edge may fall to its other side. */
static void test_nothing_in_sight_is_left_out(void **state) {
  for (unsigned seed = 1; seed < 21; seed++) {
    StyScene *scene = make_scene(*state, seed, false);
    const StyStand stand = draw_stand(seed % 2);
    StyScene *surrounded = make_scene(*state, seed, true);
    StyImage *guides[2] = {trace(scene, &stand), trace(surrounded, &stand)};
    const float *ids[2] = {sty_find_channel(guides[0], "object.I"), sty_find_channel(guides[1], "object.I")};
    const float *styles = sty_find_channel(guides[1], "style.I");
    size_t apart = 0;
    for (size_t i = 0; i < sty_count_pixels(guides[0]); i++) apart += styles[i] != 9 && ids[0][i] != ids[1][i];
    assert_in_range(apart, 0, 12);
    for (int g = 0; g < 2; g++) sty_destroy_image(&guides[g]);
    sty_destroy_scene(&surrounded);
    sty_destroy_scene(&scene);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_bands_are_the_whole, open_scratch, close_scratch),
      cmocka_unit_test_setup_teardown(test_units_agree, open_scratch, close_scratch),
      cmocka_unit_test_setup_teardown(test_outlines_are_their_formula, open_scratch, close_scratch),
      cmocka_unit_test_setup_teardown(test_nothing_in_sight_is_left_out, open_scratch, close_scratch),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
