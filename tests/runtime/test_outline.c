/* Outlines against the formulas of runtime.h, written out literally; distances against a search of the whole window. */
#include "fixture.h"

static int wrap(int a, int n) { return (a % n + n) % n; }

static int divide_down(int a, int b) { return (int)floor((double)a / b); }

static bool contains(const StyFrame *frame, int x, int y) {
  return x >= 0 && y >= 0 && x < frame->width && y < frame->height;
}

static size_t at(const StyFrame *frame, int x, int y) { return (size_t)y * (size_t)frame->width + (size_t)x; }

static bool is_covered(const StyFrame *frame, int x, int y) { return frame->guide[4 * at(frame, x, y) + 3] > 0; }

/* A pixel's depth; NaN where it has none. */
static float ask_depth(const StyFrame *frame, int x, int y) {
  if (!frame->depth || !contains(frame, x, y) || !is_covered(frame, x, y)) return NAN;
  const float z = frame->depth[at(frame, x, y)];
  return fabsf(z) <= STY_MAX_DEPTH ? z : NAN;
}

static const int directions[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};

/* NaN, which is greater than nothing, where there is none. */
static float expect_gap(const StyFrame *frame, int x, int y, int dx, int dy) {
  const float p = ask_depth(frame, x, y), q = ask_depth(frame, x + dx, y + dy);
  const float before = ask_depth(frame, x - dx, y - dy), beyond = ask_depth(frame, x + 2 * dx, y + 2 * dy);
  /* fminf and fmaxf pass over NaN */
  return q - p - fmaxf(3 * fminf(fabsf(p - before), fabsf(beyond - q)), p - before);
}

static int expect_grade(const StyFrame *frame, const StyOutline *outline, int x, int y) {
  int most = 0;
  for (int d = 0; d < 4; d++) {
    const float gap = expect_gap(frame, x, y, directions[d][0], directions[d][1]);
    int grade = 0;
    for (int i = 0; i < 8; i++) grade += gap > ldexpf(outline->depth_tolerance, i);
    if (grade > most) most = grade;
  }
  return most;
}

static int expect_border(const StyFrame *frame, const StyOutline *outline, int x, int y, const int *direction) {
  const int qx = x + direction[0], qy = y + direction[1];
  if (!contains(frame, qx, qy)) return 0;
  if (!is_covered(frame, qx, qy)) return outline->silhouette_weight;
  const uint8_t *a = frame->guide + 4 * at(frame, x, y), *b = frame->guide + 4 * at(frame, qx, qy);
  const int own = frame->objects ? frame->objects[at(frame, x, y)] : 0;
  const int other = frame->objects ? frame->objects[at(frame, qx, qy)] : 0;
  bool is_ours = qx > x || qy > y;
  if (own != other) is_ours = own > other;
  if (expect_gap(frame, qx, qy, -direction[0], -direction[1]) > outline->depth_tolerance) is_ours = false;
  if (expect_gap(frame, x, y, direction[0], direction[1]) > outline->depth_tolerance) is_ours = true;
  if (!is_ours) return 0;
  const int bend = abs(a[0] - b[0]) + abs(a[1] - b[1]) + abs(a[2] - b[2]) - outline->normal_tolerance;
  return (own != other ? outline->object_weight : 0) + (bend > 0 ? bend * outline->normal_weight : 0);
}

static bool expect_contour(const StyFrame *frame, const StyOutline *outline, int x, int y) {
  if (!is_covered(frame, x, y)) return false;
  double border = 0;
  for (int d = 0; d < 4; d++) border = fmax(border, expect_border(frame, outline, x, y, directions[d]));
  const double strength = border + (double)outline->depth_weight * expect_grade(frame, outline, x, y);
  const StyPattern *noise = &outline->noise;
  const double less = noise->texels ? noise->texels[wrap(y, noise->height) * noise->width + wrap(x, noise->width)] : 0;
  return 256 * strength - outline->noise_weight * less > 256.0 * outline->threshold;
}

/* Random steps, planes and specials of depth; ids and normals in patches. */
typedef struct Scene {
  StyFrame frame;
  StyOutline outline;
  uint8_t *guide, *noise;
  float *depth;
  uint16_t *objects;
} Scene;

static void draw_scene(uint64_t *random, int width, int height, Scene *s) {
  static const float specials[] = {NAN, INFINITY, -INFINITY, 2e30f, -2e30f, -1, 0};
  const size_t pixels = (size_t)width * (size_t)height;
  const int noise_side = 1 + draw_below(random, 30), patch = 1 + draw_below(random, 8);
  s->guide = malloc(4 * pixels), s->noise = malloc((size_t)(noise_side * noise_side));
  s->depth = malloc(pixels * sizeof *s->depth), s->objects = malloc(2 * pixels);
  assert_true(s->guide && s->noise && s->depth && s->objects);
  fill_random(random, s->noise, (size_t)(noise_side * noise_side));
  for (int i = 0; i < width * height; i++) {
    const int x = i % width, y = i / width, place = x / patch * 7 + y / patch * 13;
    s->objects[i] = (uint16_t)(place % 3);
    for (int c = 0; c < 3; c++) s->guide[4 * i + c] = (uint8_t)(place * 20 + draw_below(random, 8));
    s->guide[4 * i + 3] = (uint8_t)(draw_below(random, 12) ? 1 + draw_below(random, 255) : 0);
    s->depth[i] = (float)(place % 5) + 0.125f * (float)x + 0.015625f * (float)draw_below(random, 3);
    if (!draw_below(random, 25)) s->depth[i] = specials[draw_below(random, 7)];
  }
  s->frame = (StyFrame){.width = width, .height = height, .guide = s->guide};
  if (draw_below(random, 3)) s->frame.depth = s->depth;
  if (draw(random) & 1) s->frame.objects = s->objects;
  s->outline = (StyOutline){.silhouette_weight = draw_below(random, 2) * draw_below(random, 600),
                            .object_weight = draw_below(random, 2) * draw_below(random, 600),
                            .normal_weight = draw_below(random, 2) * draw_below(random, 20),
                            .depth_weight = draw_below(random, 3) * 100,
                            .normal_tolerance = draw_below(random, 100),
                            .depth_tolerance = 0.03125f * (float)(1 << draw_below(random, 5)),
                            .noise_weight = draw_below(random, 600),
                            .threshold = draw_below(random, 300)};
  if (draw(random) & 1) s->outline.noise = (StyPattern){s->noise, noise_side, noise_side};
}

static void destroy_scene(Scene *s) { free(s->guide), free(s->noise), free(s->depth), free(s->objects); }

static void test_contours_equal_the_formula(void **state) {
  (void)state;
  uint64_t random = 1;
  size_t found[2] = {0, 0};
  for (int round = 0; round < CASES(300, 40); round++) {
    const int *size = frame_sizes[round % FRAME_SIZES];
    Scene s;
    draw_scene(&random, size[0], size[1], &s);
    const StyRect rect = round % 3 ? (StyRect){0, 0, size[0], size[1]} : draw_rect(&random, &s.frame);
    uint8_t *contours = malloc((size_t)(size[0] * size[1]));
    memset(contours, 77, (size_t)(size[0] * size[1]));
    assert_int_equal(sty_find_contours(&s.frame, &s.outline, rect, contours), STY_RUNTIME_OK);
    for (int y = 0; y < size[1]; y++)
      for (int x = 0; x < size[0]; x++) {
        const bool line = is_inside(rect, x, y) && expect_contour(&s.frame, &s.outline, x, y);
        const int wanted = !is_inside(rect, x, y) ? 77 : line ? 255 : 0;
        if (contours[at(&s.frame, x, y)] != wanted)
          fail_msg("round %d (%d, %d): found %d, expected %d", round, x, y, contours[at(&s.frame, x, y)], wanted);
        found[line]++;
      }
    free(contours);
    destroy_scene(&s);
  }
  assert_in_range(found[1], 1000, SIZE_MAX);
  assert_in_range(found[0], 1000, SIZE_MAX);
}

/* Planes have no gap, under perspective and at a grazing angle too; a step has one line, in front. */
static void test_planes_and_steps(void **state) {
  (void)state;
  enum { SIDE = 64 };
  uint8_t guide[4 * SIDE * SIDE], contours[SIDE * SIDE];
  float depth[SIDE * SIDE];
  memset(guide, 255, sizeof guide);
  const StyFrame frame = {.width = SIDE, .height = SIDE, .guide = guide, .depth = depth};
  const StyOutline outline = {.depth_weight = 1, .depth_tolerance = 0.02f};
  const StyRect all = {0, 0, SIDE, SIDE};
  for (int kind = 0; kind < 3; kind++) {
    for (int i = 0; i < SIDE * SIDE; i++) {
      const float x = (float)(i % SIDE), y = (float)(i / SIDE);
      depth[i] = kind == 0   ? 2 + x * 0.9f + y * 3
                 : kind == 1 ? 1 / (0.0035f + 0.003f * y + 0.0001f * x)
                 : x < 20    ? 5
                             : 4;
    }
    assert_int_equal(sty_find_contours(&frame, &outline, all, contours), STY_RUNTIME_OK);
    for (int i = 0; i < SIDE * SIDE; i++) assert_int_equal(contours[i], kind == 2 && i % SIDE == 20 ? 255 : 0);
  }
}

/* Where balls cut through each other, all of the line is the larger id's, to both its ends. */
static void test_cuts_are_one_line(void **state) {
  (void)state;
  enum { SIDE = 128, COVERED = 255 };
  static const float balls[2][4] = {{45, 60, 0, 40}, {80, 70, -6, 42}}; /* x, y, z, radius */
  uint8_t guide[4 * SIDE * SIDE] = {0}, contours[SIDE * SIDE];
  uint16_t objects[SIDE * SIDE] = {0};
  float depth[SIDE * SIDE];
  for (int i = 0; i < SIDE * SIDE; i++) {
    depth[i] = INFINITY;
    for (int b = 0; b < 2; b++) {
      const float dx = (float)(i % SIDE) - balls[b][0], dy = (float)(i / SIDE) - balls[b][1];
      const float rest = balls[b][3] * balls[b][3] - dx * dx - dy * dy;
      if (rest < 0 || balls[b][2] - sqrtf(rest) >= depth[i]) continue;
      depth[i] = balls[b][2] - sqrtf(rest);
      objects[i] = (uint16_t)(1 + b);
      guide[4 * i + 3] = COVERED;
    }
  }
  const StyFrame frame = {.width = SIDE, .height = SIDE, .guide = guide, .depth = depth, .objects = objects};
  const StyOutline outline = {.object_weight = 1, .depth_weight = 1, .depth_tolerance = 0.2f};
  assert_int_equal(sty_find_contours(&frame, &outline, (StyRect){0, 0, SIDE, SIDE}, contours), STY_RUNTIME_OK);
  int length = 0, more = 0;
  for (int y = 1; y + 1 < SIDE; y++)
    for (int x = 1; x + 1 < SIDE; x++) {
      const int i = y * SIDE + x;
      const bool borders = objects[i] == 2 && (objects[i - 1] == 1 || objects[i + 1] == 1 || objects[i - SIDE] == 1 ||
                                               objects[i + SIDE] == 1);
      if (borders && !contours[i]) fail_msg("(%d, %d): found no line", x, y);
      if (objects[i] == 1) assert_int_equal(contours[i], 0);
      length += borders;
      more += contours[i] && !borders; /* where the nearer ball is about to hide the other */
    }
  assert_in_range(length, 50, 150);
  assert_in_range(more, 0, length / 10);
}

/* ---- lines ---- */

typedef struct Drawing {
  int width, height;
  uint8_t *contours;
  StyLine line;
  uint8_t wobble[2 * 9 * 5];
} Drawing;

static void draw_drawing(uint64_t *random, int width, int height, Drawing *d) {
  static const int widths[] = {STY_MIN_LINE_WIDTH, 129, 256, 300, 640, 2000, 5001, STY_MAX_LINE_WIDTH};
  static const int sparse[] = {2, 20, 400, 3000, 1000000};
  const int one_in = sparse[draw_below(random, 5)];
  *d = (Drawing){.width = width, .height = height, .contours = malloc((size_t)(width * height))};
  assert_non_null(d->contours);
  for (int i = 0; i < width * height; i++) d->contours[i] = draw_below(random, one_in) ? 0 : 255;
  fill_random(random, d->wobble, sizeof d->wobble);
  d->line.width = widths[draw_below(random, 8)];
  if (draw(random) & 1) d->line.wobble = (StyPattern){d->wobble, 9, 5};
  d->line.wobble_amount = draw_below(random, 3) * draw_below(random, STY_MAX_WOBBLE / 2 + 1);
}

static int clamp(int value, int most) { return value < 0 ? 0 : value > most ? most : value; }

/* Without a wobble by all contours in the window; with one a column answers for the pixel that is looked at, not for
 * the place in it. */
static int expect_line(const Drawing *d, int x, int y) {
  const StyLine *line = &d->line;
  const int reach = (line->width + 767) / 512 + 1;
  int hx = 0, hy = 0;
  if (line->wobble.texels) {
    const uint8_t *j = d->wobble + 2 * (wrap(y, 5) * 9 + wrap(x, 9));
    hx = divide_down(line->wobble_amount * (j[0] - 128), 128);
    hy = divide_down(line->wobble_amount * (j[1] - 128), 128);
  }
  const int sx = divide_down(hx + 128, 256), sy = divide_down(hy + 128, 256);
  const int qx = clamp(x + sx, d->width - 1), qy = clamp(y + sy, d->height - 1);
  double least = INFINITY;
  for (int i = -reach; i <= reach; i++) {
    int nearest = 1000;
    for (int k = -reach; k <= reach; k++)
      if (qx + i >= 0 && qx + i < d->width && qy + k >= 0 && qy + k < d->height &&
          d->contours[(qy + k) * d->width + qx + i]) {
        if (!line->wobble.texels) least = fmin(least, 65536.0 * (i * i + k * k));
        if (abs(k) < abs(nearest)) nearest = k;
      }
    if (line->wobble.texels && nearest != 1000)
      least = fmin(least, pow(256 * i - (hx - 256 * sx), 2) + pow(256 * nearest - (hy - 256 * sy), 2));
  }
  const double coverage = fmin(fmin(256, line->width), divide_down(line->width + 256, 2) - floor(sqrt(least)));
  return coverage > 0 ? (int)floor(coverage * 255 / 256 + 0.5) : 0;
}

/* Columns and lines of a whole drawing by tiles of a random size, from the end. */
static void draw_tiles(uint64_t *random, const Drawing *d, uint8_t *lines) {
  const int width = d->width, height = d->height, step = 1 + draw_below(random, 40);
  int8_t *columns = malloc((size_t)(width * height));
  assert_non_null(columns);
  for (int pass = 0; pass < 2; pass++)
    for (int y = (height - 1) / step * step; y >= 0; y -= step)
      for (int x = 0; x < width; x += step) {
        const StyRect tile = {x, y, x + step < width ? x + step : width, y + step < height ? y + step : height};
        assert_int_equal(pass ? sty_draw_lines(width, height, columns, &d->line, tile, lines)
                              : sty_measure_columns(width, height, d->contours, &d->line, tile, columns),
                         STY_RUNTIME_OK);
      }
  free(columns);
}

static void test_lines_equal_a_search(void **state) {
  (void)state;
  uint64_t random = 2;
  size_t partly = 0;
  for (int round = 0; round < CASES(80, 40); round++) {
    const int *size = frame_sizes[round % FRAME_SIZES];
    Drawing d;
    draw_drawing(&random, size[0], size[1], &d);
    uint8_t *lines = malloc((size_t)(size[0] * size[1]));
    assert_non_null(lines);
    draw_tiles(&random, &d, lines);
    for (int i = 0; i < size[0] * size[1]; i++) {
      const int wanted = expect_line(&d, i % size[0], i / size[0]);
      if (lines[i] != wanted)
        fail_msg("round %d (%d, %d): found %d, expected %d", round, i % size[0], i / size[0], lines[i], wanted);
      partly += lines[i] > 0 && lines[i] < 255;
    }
    free(lines);
    free(d.contours);
  }
  assert_in_range(partly, 100, SIZE_MAX);
}

/* A rectangle needs no more around it than the header says, and leaves the rest alone. */
static void test_rectangles_need_what_is_said(void **state) {
  (void)state;
  uint64_t random = 3;
  for (int round = 0; round < CASES(30, 8); round++) {
    Drawing d;
    draw_drawing(&random, 130, 70, &d);
    const StyFrame frame = {.width = 130, .height = 70};
    const StyRect rect = draw_rect(&random, &frame);
    const int reach = sty_get_line_reach(&d.line), around = reach + d.line.wobble_amount / 256 + 1;
    uint8_t whole[130 * 70], part[130 * 70];
    int8_t columns[130 * 70], measured[130 * 70];
    const StyRect all = {0, 0, 130, 70};
    assert_int_equal(sty_measure_columns(130, 70, d.contours, &d.line, all, columns), STY_RUNTIME_OK);
    assert_int_equal(sty_draw_lines(130, 70, columns, &d.line, all, whole), STY_RUNTIME_OK);
    memset(measured, 55, sizeof measured);
    memset(part, 66, sizeof part);
    for (int i = 0; i < 130 * 70; i++) {
      const int x = i % 130, y = i / 130;
      if (!is_inside((StyRect){rect.x0 - around, rect.y0 - around, rect.x1 + around, rect.y1 + around}, x, y))
        columns[i] = 0;
      if (!is_inside((StyRect){rect.x0, rect.y0 - reach, rect.x1, rect.y1 + reach}, x, y)) d.contours[i] ^= 255;
    }
    assert_int_equal(sty_measure_columns(130, 70, d.contours, &d.line, rect, measured), STY_RUNTIME_OK);
    assert_int_equal(sty_draw_lines(130, 70, columns, &d.line, rect, part), STY_RUNTIME_OK);
    for (int i = 0; i < 130 * 70; i++) {
      const bool inside = is_inside(rect, i % 130, i / 130);
      assert_int_equal(part[i], inside ? whole[i] : 66);
      assert_int_equal(measured[i], inside ? columns[i] : 55);
    }
    free(d.contours);
  }
}

/* A straight contour is covered as a stripe of that width about it. */
static void test_widths(void **state) {
  (void)state;
  static const struct {
    int width, coverage[4]; /* 0, 1, 2, 3 pixels off */
  } cases[] = {{128, {128, 0, 0, 0}},   {256, {255, 0, 0, 0}},    {512, {255, 128, 0, 0}},
               {768, {255, 255, 0, 0}}, {900, {255, 255, 66, 0}}, {STY_MAX_LINE_WIDTH, {255, 255, 255, 255}}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    uint8_t contours[9 * 9] = {0}, lines[9 * 9];
    int8_t columns[9 * 9];
    for (int y = 0; y < 9; y++) contours[9 * y + 4] = 255;
    const StyLine line = {.width = cases[i].width};
    assert_int_equal(sty_measure_columns(9, 9, contours, &line, (StyRect){0, 0, 9, 9}, columns), STY_RUNTIME_OK);
    assert_int_equal(sty_draw_lines(9, 9, columns, &line, (StyRect){0, 0, 9, 9}, lines), STY_RUNTIME_OK);
    for (int y = 0; y < 9; y++)
      for (int k = 0; k < 4; k++) {
        assert_int_equal(lines[9 * y + 4 + k], cases[i].coverage[k]);
        assert_int_equal(lines[9 * y + 4 - k], cases[i].coverage[k]);
      }
  }
}

static void test_lines_on_pictures(void **state) {
  (void)state;
  uint64_t random = 4;
  for (int round = 0; round < 4; round++) {
    const bool beyond = round & 1;
    const int count = 2000, most = round & 2 ? 65535 : 255;
    uint8_t lines[2000], colour[4], narrow[4 * 2000];
    uint16_t wide[4 * 2000];
    fill_random(&random, colour, 4);
    fill_random(&random, lines, sizeof lines);
    for (int i = 0; i < 4 * count; i++) {
      const int ends[] = {0, most, draw_below(&random, most + 1)};
      wide[i] = (uint16_t)ends[draw_below(&random, 3)];
      narrow[i] = (uint8_t)wide[i];
      if (i % 50 == 0) lines[i / 4] = (uint8_t)(i % 100 ? 0 : 255);
    }
    uint16_t before[4 * 2000];
    memcpy(before, wide, sizeof before);
    void *picture = most == 255 ? (void *)narrow : (void *)wide;
    assert_int_equal(
        sty_lay_lines(count, 1, lines, colour, beyond, (StyRect){1, 0, count, 1}, most == 255 ? 8 : 16, picture),
        STY_RUNTIME_OK);
    for (int i = 0; i < count; i++)
      for (int c = 0; c < 4; c++) {
        const double a = before[4 * i + 3], l = lines[i] * colour[3], u = 255 * 255, p = before[4 * i + c];
        const double e = l * most + a * (u - l), mine = c < 3 ? colour[c] * (double)(most / 255) : 0;
        double wanted = c == 3    ? (beyond ? floor(e / u + 0.5) : a)
                        : !beyond ? floor((mine * l + p * (u - l)) / u + 0.5)
                        : e > 0   ? floor((mine * l * most + p * a * (u - l)) / e + 0.5)
                                  : 0;
        if (i == 0) wanted = p; /* outside the rectangle */
        assert_int_equal(most == 255 ? narrow[4 * i + c] : wide[4 * i + c], (int)wanted);
      }
  }
}

static void test_bad_arguments(void **state) {
  (void)state;
  uint8_t guide[4] = {1, 1, 1, 1}, out[8];
  int8_t columns[1] = {0};
  const StyRect all = {0, 0, 1, 1}, outside = {0, 0, 1, 2};
  const StyFrame frame = {.width = 1, .height = 1, .guide = guide};
  const StyOutline good = {.depth_tolerance = 1};
  const StyOutline bad[] = {{.depth_tolerance = 0},
                            {.depth_tolerance = -1},
                            {.depth_tolerance = NAN},
                            {.depth_tolerance = INFINITY},
                            {.depth_tolerance = 1, .depth_weight = -1},
                            {.depth_tolerance = 1, .normal_weight = STY_MAX_OUTLINE_WEIGHT + 1},
                            {.depth_tolerance = 1, .silhouette_weight = -1},
                            {.depth_tolerance = 1, .object_weight = -1},
                            {.depth_tolerance = 1, .noise_weight = -1},
                            {.depth_tolerance = 1, .threshold = -1},
                            {.depth_tolerance = 1, .normal_tolerance = STY_MAX_THRESHOLD + 1},
                            {.depth_tolerance = 1, .noise = {out, 1, 0}}};
  assert_int_equal(sty_find_contours(&frame, &good, all, out), STY_RUNTIME_OK);
  assert_int_equal(out[0], 0);
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    if (sty_find_contours(&frame, &bad[i], all, out) != STY_RUNTIME_BAD_ARGUMENT) fail_msg("outline %zu passed", i);
  assert_int_equal(sty_find_contours(NULL, &good, all, out), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_find_contours(&frame, NULL, all, out), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_find_contours(&frame, &good, outside, out), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_find_contours(&frame, &good, all, NULL), STY_RUNTIME_BAD_ARGUMENT);
  const StyLine lines[] = {{.width = 127},
                           {.width = STY_MAX_LINE_WIDTH + 1},
                           {.width = 256, .wobble_amount = -1},
                           {.width = 256, .wobble_amount = STY_MAX_WOBBLE + 1},
                           {.width = 256, .wobble = {out, 0, 1}}};
  for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
    assert_int_equal(sty_measure_columns(1, 1, out, &lines[i], all, columns), STY_RUNTIME_BAD_ARGUMENT);
    assert_int_equal(sty_draw_lines(1, 1, columns, &lines[i], all, out), STY_RUNTIME_BAD_ARGUMENT);
  }
  const StyLine line = {.width = 256};
  assert_int_equal(sty_measure_columns(0, 1, out, &line, all, columns), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_draw_lines(1, 1, columns, &line, outside, out), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_lay_lines(1, 1, out, guide, 1, all, 32, out), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_lay_lines(1, 1, NULL, guide, 1, all, 8, out), STY_RUNTIME_BAD_ARGUMENT);
  assert_int_equal(sty_lay_lines(1, 1, out, guide, 1, outside, 8, out), STY_RUNTIME_BAD_ARGUMENT);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_contours_equal_the_formula),
                                     cmocka_unit_test(test_planes_and_steps),
                                     cmocka_unit_test(test_cuts_are_one_line),
                                     cmocka_unit_test(test_lines_equal_a_search),
                                     cmocka_unit_test(test_rectangles_need_what_is_said),
                                     cmocka_unit_test(test_widths),
                                     cmocka_unit_test(test_lines_on_pictures),
                                     cmocka_unit_test(test_bad_arguments)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
