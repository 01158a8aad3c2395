#include <float.h>
#include <math.h>

#include <time.h>

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
  CIRCLE,       /* about (0, 0): equally far from the middle, up to rounding */
  MIRRORED,     /* (+-a, +-b), (+-b, +-a): equally far exactly */
  FAR,          /* up to 1000: differences drown in rounding */
  FAR_CLUSTER,  /* neighbours in float, far away: hundreds of ties by rounding alone */
  DENORMALS,    /* squares vanish */
  ZEROS,        /* of both signs */
  CLUSTER,      /* neighbours in float, inside the square */
  LINE,         /* one coordinate never changes: a kd-tree can split one way only */
  OUTLIERS,     /* a cluster, and now and then a value far away: bounds of a tree lose their precision */
  TWO_CLUSTERS, /* far apart, nothing between */
  FEW_BYTES,    /* texels lie exactly between values, and each value is many pixels */
  RIM,          /* on the unit circle and just beside it, inside and outside */
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
      case FEW_BYTES: g[k] = (float)(2 * 51 * draw_below(random, 6) - 255) / 255.0f; break;
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
  if (kind == TWO_CLUSTERS) {
    const float side = draw_below(random, 2) ? 0.9f : -0.9f;
    for (int k = 0; k < 2; k++) g[k] = side + 0.05f * g[k] * base[k];
  }
  if (kind == RIM) {
    const float angle = draw_signed(random) * 3.14159265f;
    const float radius = step_floats(0.9999995f, draw_below(random, 20)) * (draw_below(random, 4) ? 1.0f : 1.5f);
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

/* ---- tables --------------------------------------------------------------------- */

/* All that a table may be, by number: sampling, map and metric. */
enum { LOOKS = 8 };

static StyLutSpec describe(int size, int look) {
  static const StySampling samplings[] = {STY_SAMPLE_CENTRE, STY_SAMPLE_UNORM8, STY_SAMPLE_CORNER, STY_SAMPLE_CENTRE};
  return (StyLutSpec){size, size, samplings[look % 4], look % 4 == 3 ? STY_MAP_EQUAL_AREA : STY_MAP_XY,
                      look < 4 ? STY_METRIC_XY : STY_METRIC_ANGLE};
}

static int exists(const StyLutSpec *spec) {
  return spec->sampling != STY_SAMPLE_UNORM8 || (spec->width > 1 && spec->height > 1);
}

/* NULL where this build goes without the engine. */
static StyLut *try_build(const StySites *sites, const StyEngine *engine, const StyLutSpec *spec, int threads) {
  const StyRun run = {.threads = threads};
  StyLut *lut = NULL;
  StyError error = {STY_OK, ""};
  const StyStatus status = sty_build_lut(sites, engine, NULL, spec, &run, &lut, &error);
  if (status == STY_ERROR_UNAVAILABLE) return NULL;
  if (status != STY_OK) fail_msg("%s, size %dx%d: %s", engine->name, spec->width, spec->height, error.text);
  return lut;
}

static StyLut *build_as(const StySites *sites, const char *engine, StyLutSpec spec, int threads) {
  StyLut *lut = try_build(sites, find_engine(engine), &spec, threads);
  assert_non_null(lut);
  return lut;
}

static StyLut *build(const StySites *sites, const char *engine, int size, int sampling, int threads) {
  return build_as(sites, engine, (StyLutSpec){size, size, (StySampling)sampling, STY_MAP_XY, STY_METRIC_XY}, threads);
}

static int random_side(uint64_t *random) {
  const int large = draw_below(random, 12) == 0;
  return 1 + draw_below(random, large ? 64 : 14);
}

/* ---- comparisons --------------------------------------------------------------- */

/* What lut.h says of distances: whether they are whole numbers, else in how many dimensions. */
typedef struct Rule {
  const StyLutSpec *spec;
  bool integer;
  int dims;
} Rule;

/* The byte of this value, or -1. */
static int find_byte(float value) {
  for (int b = 0; b < 256; b++)
    if (value == (float)(2 * b - 255) / 255.0f) return b;
  return -1;
}

static Rule choose_rule(const StyLutSpec *spec, const StyImage *guide) {
  const bool plain = spec->map == STY_MAP_XY && spec->metric == STY_METRIC_XY && spec->width == spec->height;
  const size_t count = sty_count_pixels(guide);
  bool bytes = plain;
  for (size_t p = 0; bytes && p < count; p++)
    bytes =
        !(guide->data[p] > 0) || (find_byte(guide->data[count + p]) >= 0 && find_byte(guide->data[2 * count + p]) >= 0);
  return (Rule){spec, bytes, spec->metric == STY_METRIC_ANGLE ? 3 : 2};
}

/* A unit normal: shortened to the rim where it lies outside the disc. */
static void lift(const float g[2], float n[3]) {
  const float squared = g[0] * g[0] + g[1] * g[1], length = squared > 1 ? sqrtf(squared) : 1;
  n[0] = g[0] / length;
  n[1] = g[1] / length;
  const float rest = 1 - (n[0] * n[0] + n[1] * n[1]);
  n[2] = rest > 0 ? sqrtf(rest) : 0;
}

/* Twice a texel's place less twice a value, both of one axis, in 255ths of a level times the texels; `i` counts
 * from where bytes are 0. */
static int64_t get_steps(const StyLutSpec *spec, int i, float value) {
  const int64_t b = find_byte(value), n = spec->width;
  switch (spec->sampling) {
    case STY_SAMPLE_CENTRE: return 255 * (2 * (int64_t)i + 1) - 2 * n * b; /* (i+1/2)/n = b/255 */
    case STY_SAMPLE_UNORM8: return 2 * (255 * (int64_t)i - (n - 1) * b);   /* i/(n-1) = b/255 */
    default: return 2 * (255 * (int64_t)i - n * b);                        /* i/n = b/255 */
  }
}

/* The squared distance to compare, and the distance itself. */
static double measure_literally(const Rule *rule, int i, int j, const float p[2], double *distance) {
  float g[2];
  sty_get_texel_value(rule->spec, i, j, g);
  if (rule->integer) {
    const int64_t dx = get_steps(rule->spec, i, p[0]), dy = get_steps(rule->spec, rule->spec->height - 1 - j, p[1]);
    const int n = rule->spec->sampling == STY_SAMPLE_UNORM8 ? rule->spec->width - 1 : rule->spec->width;
    *distance = sqrt((double)(dx * dx + dy * dy)) / 255 / n;
    return (double)(dx * dx + dy * dy);
  }
  if (rule->dims == 2) {
    *distance = hypot((double)g[0] - p[0], (double)g[1] - p[1]);
    return (double)((g[0] - p[0]) * (g[0] - p[0]) + (g[1] - p[1]) * (g[1] - p[1]));
  }
  float a[3], b[3];
  lift(g, a);
  lift(p, b);
  *distance = hypot(hypot((double)a[0] - b[0], (double)a[1] - b[1]), (double)a[2] - b[2]);
  return (double)((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/* lut.h's definition of exact, word by word: pixel after pixel. */
static void expect_literal(const StyLut *lut, const StyImage *guide, int kind) {
  const int count = guide->width * guide->height, width = lut->spec.width;
  const float *a = sty_find_channel(guide, "A"), *x = sty_find_channel(guide, "normal.X"),
              *y = sty_find_channel(guide, "normal.Y");
  const Rule rule = choose_rule(&lut->spec, guide);
  assert_int_equal(lut->source_width, guide->width);
  assert_int_equal(lut->source_height, guide->height);
  for (int t = 0; t < width * lut->spec.height; t++) {
    double least = INFINITY, distance = 0;
    int nearest = -1;
    for (int p = 0; p < count; p++) {
      if (!(a[p] > 0)) continue;
      double here;
      const double squared = measure_literally(&rule, t % width, t / width, (const float[]){x[p], y[p]}, &here);
      if (squared < least) {
        least = squared;
        distance = here;
        nearest = p;
      }
    }
    if (lut->pixels[t] != (uint32_t)nearest)
      fail_msg("kind %d, guide %dx%d, table %dx%d, %s, %s, %s, texel %d: pixel %u instead of %d", kind, guide->width,
               guide->height, width, lut->spec.height, sty_sampling_names[lut->spec.sampling],
               sty_map_names[lut->spec.map], sty_metric_names[lut->spec.metric], t, lut->pixels[t], nearest);
    /* Squares of what is smaller than that vanish in float. */
    if (!(fabs(lut->errors[t] - distance) <= 1e-6 * distance + 1e-22))
      fail_msg("kind %d, texel %d: error %g instead of %g", kind, t, (double)lut->errors[t], distance);
  }
}

static void expect_same(const StyLut *a, const StyLut *b, const char *what) {
  const StyLutSpec *spec = &a->spec;
  assert_memory_equal(spec, &b->spec, sizeof *spec);
  assert_int_equal(a->unique, b->unique);
  for (size_t t = 0; t < sty_count_texels(spec); t++)
    if (a->pixels[t] != b->pixels[t] || memcmp(&a->errors[t], &b->errors[t], sizeof(float)))
      fail_msg("%s: texel %zu of a table %dx%d, %s, %s, %s: pixel %u error %.9g against pixel %u error %.9g", what, t,
               spec->width, spec->height, sty_sampling_names[spec->sampling], sty_map_names[spec->map],
               sty_metric_names[spec->metric], a->pixels[t], (double)a->errors[t], b->pixels[t], (double)b->errors[t]);
}

/* Vector units that the grid may use; what the processor lacks is its widest once more. */
static const char *const UNITS[] = {"plain", "avx2", "avx512"};
enum { UNIT_COUNT = sizeof UNITS / sizeof *UNITS };

/* Every exact engine gives the bytes of the reference; the grid under each vector unit. More threads than one are
 * for every eighth trial, as they cost more than small tables do. */
static void expect_exact_engines(const StySites *sites, StyLutSpec spec, int trial, const char *what) {
  StyLut *reference = build_as(sites, "brute", spec, 1);
  char text[200];
  for (const StyEngine *engine = sty_engines + 1; engine->name; engine++) {
    if (!engine->exact) continue;
    const int units = strcmp(engine->name, "grid") ? 1 : UNIT_COUNT;
    for (int u = 0; u < units; u++) {
      setenv("STYLUT_VECTOR", UNITS[u], 1);
      StyLut *lut = try_build(sites, engine, &spec, trial % 8 ? 1 : 1 + (trial / 8 + u) % 3);
      unsetenv("STYLUT_VECTOR");
      snprintf(text, sizeof text, "%s (%s), %s", engine->name, units > 1 ? UNITS[u] : "", what);
      if (lut) expect_same(lut, reference, text);
      sty_destroy_lut(&lut);
    }
  }
  sty_destroy_lut(&reference);
}

/* ---- tests --------------------------------------------------------------------- */

static void test_names(void **state) {
  (void)state;
  static const struct {
    const char *name;
    bool exact;
  } expected[] = {{"brute", true},         {"analytic", false},   {"flann-single", true}, {"cgal", true},
                  {"flann-forest", false}, {"flann-auto", false}, {"grid", true}};
  int count = 0;
  for (; sty_engines[count].name; count++) {
    assert_string_equal(sty_engines[count].name, expected[count].name);
    assert_int_equal(sty_engines[count].exact, expected[count].exact);
    assert_ptr_equal(find_engine(sty_engines[count].name), &sty_engines[count]);
    assert_true(sty_engines[count].summary && sty_engines[count].summary[0]);
  }
  assert_int_equal(count, sizeof expected / sizeof *expected);
  assert_true(find_engine("auto")->exact);
  assert_int_equal(sty_default_engine_options.trees, 4);
  assert_int_equal(sty_default_engine_options.checks, 32);
  assert_true(sty_default_engine_options.precision == 0.9);
  static const char *const bad[] = {"", "Brute", "brut", "brute ", "kd"};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    const StyEngine *engine = NULL;
    StyError error = {STY_OK, ""};
    expect_message(sty_find_engine("--engine", bad[i], &engine, &error), STY_ERROR_USAGE, &error,
                   PARTS("--engine", bad[i], "auto", "brute", "analytic", "flann-single", "cgal", "flann-forest",
                         "flann-auto", "grid"));
    assert_null(engine);
  }
}

static void test_brute_is_literal(void **state) {
  (void)state;
  static const int sizes[] = {1, 2, 3, 5, 17};
  uint64_t random = 11;
  for (int trial = 0; trial < CASES(KINDS * LOOKS * 12, KINDS * LOOKS * 2); trial++) {
    const int kind = trial % KINDS;
    StyLutSpec spec = describe(sizes[draw_below(&random, 5)], trial / KINDS % LOOKS);
    if (draw_below(&random, 8) == 0) spec.height = sizes[draw_below(&random, 5)];
    if (!exists(&spec)) continue;
    StyImage *guide = make_guide((Kind)kind, random_side(&random), random_side(&random), &random);
    StySites *sites = collect(guide);
    StyLut *lut = build_as(sites, "brute", spec, 1);
    assert_memory_equal(&lut->spec, &spec, sizeof spec);
    expect_literal(lut, guide, kind);
    sty_destroy_lut(&lut);
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
}

static void test_exact_engines(void **state) {
  (void)state;
  uint64_t random = 12;
  for (int trial = 0; trial < CASES(KINDS * LOOKS * 14, KINDS * LOOKS * 3); trial++) {
    const int kind = trial % KINDS, roll = draw_below(&random, 256);
    const int size = roll == 0 ? 256 : roll < 16 ? 64 : roll < 120 ? 17 : 1 + draw_below(&random, 5);
    StyLutSpec spec = describe(size, trial / KINDS % LOOKS);
    if (size < 64 && draw_below(&random, 8) == 0) spec.height = 1 + draw_below(&random, 30);
    if (!exists(&spec)) continue;
    const int width = size == 256 ? 1 + draw_below(&random, 16) : random_side(&random);
    const int height = size == 256 ? 1 + draw_below(&random, 16) : random_side(&random);
    StyImage *guide = make_guide((Kind)kind, width, height, &random);
    StySites *sites = collect(guide);
    char what[100];
    snprintf(what, sizeof what, "kind %d, trial %d, guide %dx%d", kind, trial, width, height);
    expect_exact_engines(sites, spec, trial, what);
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
}

/* Full-size guides of each kind, where trees are deep. */
static void test_exact_engines_on_larger_guides(void **state) {
  (void)state;
  uint64_t random = 13;
  for (int kind = 0; kind < KINDS; kind++) {
    for (int look = kind % 2; look < LOOKS; look += 2) {
      StyImage *guide = make_guide((Kind)kind, 64, CASES(64, 30), &random);
      StySites *sites = collect(guide);
      char what[100];
      snprintf(what, sizeof what, "large, kind %d", kind);
      expect_exact_engines(sites, describe(CASES(41, 30), look), look, what);
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
      static const int sizes[] = {1, 3, 64};
      for (int s = 0; s < 3; s++) {
        const StyLutSpec spec = describe(sizes[s], (kind + s) % 2 ? 0 : 4);
        StyLut *one = try_build(sites, engine, &spec, 1);
        for (int threads = 2; one && threads <= 3; threads++) {
          StyLut *more = try_build(sites, engine, &spec, threads);
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

/* ---- guides as they come -------------------------------------------------------- */

static StyImage *make_sphere(int width, int height) {
  StyImage *guide = NULL;
  assert_int_equal(sty_make_sphere_guide(width, height, STY_GUIDE_NORMAL, &guide, NULL), STY_OK);
  return guide;
}

typedef enum Dense {
  SPHERE,       /* a float guide's */
  WORD_SPHERE,  /* a 16-bit file's */
  BYTE_SPHERE,  /* an 8-bit file's */
  NOISY_SPHERE, /* about as a painter's; some values outside the disc */
  PLANE,        /* all of the square and a bit beyond, in float steps */
  COARSE_PLANE, /* several pixels to most values, none of them a byte's */
  HOLED_SPHERE, /* with large and small holes */
  CROWDED,      /* a third of the pixels has one value */
  TWO_SPHERES,  /* a dense half and a sparse one */
  DENSES
} Dense;

static float round_to(float value, float steps) { return roundf(value * steps) / steps; }

/* Guides with about a value per pixel all over: what cells are for. */
static StyImage *make_dense(Dense kind, int side, uint64_t *random) {
  StyImage *guide = make_sphere(side, side);
  float *a = sty_find_channel(guide, "A"), *x = sty_find_channel(guide, "normal.X"),
        *y = sty_find_channel(guide, "normal.Y");
  const int hole[3] = {draw_below(random, side), draw_below(random, side), draw_below(random, side / 3)};
  for (int i = 0; i < side * side; i++) {
    const int px = i % side, py = i / side;
    const float place[2] = {(float)(2 * px + 1 - side) / (float)side, (float)(side - 2 * py - 1) / (float)side};
    const float jitter[2] = {draw_signed(random), draw_signed(random)};
    if (kind == PLANE || kind == COARSE_PLANE) {
      a[i] = 1;
      x[i] = place[0] * 1.1f + jitter[0] / (float)side;
      y[i] = place[1] * 1.1f + jitter[1] / (float)side;
    }
    if (kind == COARSE_PLANE) x[i] = round_to(x[i], (float)side / 5), y[i] = round_to(y[i], (float)side / 5);
    if (!(a[i] > 0)) continue;
    if (kind == NOISY_SPHERE) x[i] += jitter[0] * 0.03f, y[i] += jitter[1] * 0.03f;
    if (kind == WORD_SPHERE) x[i] = round_to(x[i], 32767.5f), y[i] = round_to(y[i], 32767.5f);
    if (kind == BYTE_SPHERE) {
      x[i] = (float)(2 * (int)roundf((x[i] + 1) * 127.5f) - 255) / 255.0f;
      y[i] = (float)(2 * (int)roundf((y[i] + 1) * 127.5f) - 255) / 255.0f;
    }
    if (kind == HOLED_SPHERE)
      a[i] = (float)(hypot(px - hole[0], py - hole[1]) > hole[2] && draw_below(random, 50) != 0);
    if (kind == CROWDED && draw_below(random, 3) == 0) x[i] = 0.125f, y[i] = -0.25f;
    if (kind == TWO_SPHERES) {
      x[i] = px < side / 2 ? x[i] : x[i] * 0.2f;
      y[i] = px < side / 2 ? y[i] : y[i] * 0.2f;
    }
  }
  return guide;
}

/* One place for each 3 x 3 of the grid's cells, by preference in a corner: nothing sparser still passes as dense, and
 * texels in between are as far from their points as they can be. Islands of 3 x 3 such places leave gaps of two. */
static StyImage *make_sparse(int regions, bool islands, uint64_t *random) {
  static const float corners[] = {0.02f, 0.5f, 0.98f};
  const int side = 3 * regions, count = side * side;
  StyImage *guide = make_sphere(side, side);
  float *a = sty_find_channel(guide, "A"), *x = sty_find_channel(guide, "normal.X"),
        *y = sty_find_channel(guide, "normal.Y");
  int *pixels = calloc((size_t)count, sizeof *pixels); /* one of each region's */
  assert_non_null(pixels);
  for (int r = 0; r < regions * regions; r++) {
    const int rx = r % regions, ry = r / regions, p = pixels[r] = ry * 3 * side + rx * 3;
    x[p] = -1 + ((float)rx + corners[draw_below(random, 3)]) * 2 / (float)regions;
    y[p] = -1 + ((float)ry + corners[draw_below(random, 3)]) * 2 / (float)regions;
  }
  /* Duplicates make up the point per cell that lays out the cells. */
  for (int p = 0; p < count; p++) {
    int rx = p % side / 3, ry = p / side / 3;
    while (islands && (rx % 5 > 2 || ry % 5 > 2)) rx = draw_below(random, regions), ry = draw_below(random, regions);
    a[p] = 1;
    x[p] = x[pixels[ry * regions + rx]];
    y[p] = y[pixels[ry * regions + rx]];
  }
  x[1] = y[1] = -1;
  x[4] = y[4] = 1;
  free(pixels);
  return guide;
}

static void test_sparse_guides(void **state) {
  (void)state;
  uint64_t random = 23;
  for (int trial = 0; trial < CASES(12, 3); trial++) {
    StyImage *guide = make_sparse(CASES(32, 20), trial % 2, &random);
    StySites *sites = collect(guide);
    expect_exact_engines(sites, describe(CASES(120, 60) + trial, trial / 2 % 4), trial,
                         trial % 2 ? "islands" : "sparse");
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
}

static void test_dense_guides(void **state) {
  (void)state;
  uint64_t random = 17;
  for (int kind = 0; kind < DENSES; kind++) {
    for (int trial = 0; trial < CASES(4, 2); trial++) {
      const int side = CASES(96, 48) + draw_below(&random, CASES(105, 30));
      StyImage *guide = make_dense((Dense)kind, side, &random);
      StySites *sites = collect(guide);
      assert_int_equal(sites->levels != NULL, kind == BYTE_SPHERE);
      char what[100];
      snprintf(what, sizeof what, "dense %d, side %d", kind, side);
      /* Cells serve the metric xy; by angle all is the tree's. */
      const int look = (trial + kind) % 4 + (trial == 3) * 4;
      expect_exact_engines(sites, describe(30 + draw_below(&random, 40), look), trial, what);
      sty_destroy_sites(&sites);
      sty_destroy_image(&guide);
    }
  }
}

/* Enough points for several threads to sort them together. */
static void test_threads_sort_alike(void **state) {
  (void)state;
  enum { SIDE = CASES(300, 200) };
  uint64_t random = 23;
  for (int kind = 0; kind < DENSES + KINDS; kind++) {
    StyImage *guide =
        kind < DENSES ? make_dense((Dense)kind, SIDE, &random) : make_guide((Kind)(kind - DENSES), SIDE, SIDE, &random);
    StySites *sites = collect(guide);
    StyLutSpec spec = describe(40, 0);
    spec.metric = kind % 2 ? STY_METRIC_ANGLE : STY_METRIC_XY;
    StyLut *one = build_as(sites, "grid", spec, 1), *reference = build_as(sites, "flann-single", spec, 2);
    expect_same(one, reference, "grid");
    for (int threads = 2; threads <= 8; threads = 2 * threads - 1) {
      StyLut *more = build_as(sites, "grid", spec, threads);
      expect_same(more, one, "grid");
      assert_int_equal(more->unique, one->unique);
      sty_destroy_lut(&more);
    }
    sty_destroy_lut(&one);
    sty_destroy_lut(&reference);
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
}

/* A small table asks far between, a large one many times of each pixel. */
static void test_dense_guide_at_many_sizes(void **state) {
  (void)state;
  static const int sizes[] = {1, 2, 3, 4, 5, 7, 8, 9, 90};
  uint64_t random = 18;
  for (int kind = 0; kind < DENSES; kind += 3) {
    StyImage *guide = make_dense((Dense)kind, 100, &random);
    StySites *sites = collect(guide);
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++)
      for (int look = 0; look < CASES(4, 1); look++) {
        const StyLutSpec spec = describe(sizes[s], look);
        if (exists(&spec)) expect_exact_engines(sites, spec, look, "dense guide");
      }
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
}

/* All of [-1, 1]^2 at random: cells, regions that are empty by chance, and a tree for those. */
static void test_uniform_points(void **state) {
  (void)state;
  uint64_t random = 19;
  for (int trial = 0; trial < CASES(6, 1); trial++) {
    StyImage *guide = make_guide(trial % 2 ? WORDS : FLOATS, CASES(141, 50), CASES(142, 50), &random);
    StySites *sites = collect(guide);
    expect_exact_engines(sites, describe(50 + trial, trial < 4 ? trial : trial + 1), trial, "uniform");
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
}

/* Nothing prunes a circle seen from its middle. */
static void test_circle(void **state) {
  (void)state;
  enum { COUNT = 5000 };
  StyImage *guide = NULL;
  assert_int_equal(
      sty_create_image(COUNT / 50, 50, 3, (const char *const[]){"A", "normal.X", "normal.Y"}, 32, &guide, NULL),
      STY_OK);
  for (int i = 0; i < COUNT; i++) {
    const double angle = i * 2 * acos(-1) / COUNT;
    guide->data[i] = 1;
    guide->data[COUNT + i] = (float)cos(angle);
    guide->data[2 * COUNT + i] = (float)sin(angle);
  }
  StySites *sites = collect(guide);
  for (int look = 0; look < LOOKS; look++)
    for (int size = 33; size < 35; size++) expect_exact_engines(sites, describe(size, look), look, "circle");
  sty_destroy_sites(&sites);
  sty_destroy_image(&guide);
}

/* A million pixels of one value: whoever searches them one by one is lost. */
static void test_duplicates(void **state) {
  (void)state;
  enum { SIDE = CASES(1000, 300), SIZE = CASES(256, 64) };
  StyImage *guide = NULL;
  assert_int_equal(
      sty_create_image(SIDE, SIDE, 3, (const char *const[]){"A", "normal.X", "normal.Y"}, 32, &guide, NULL), STY_OK);
  const size_t count = sty_count_pixels(guide);
  static const float values[][2] = {{0.3f, -0.2f}, {1, -1}, {0, 0}};
  for (int v = 0; v < 3; v++) {
    for (size_t i = 0; i < count; i++) {
      guide->data[i] = (float)(i > 1234);
      guide->data[count + i] = values[v][0];
      guide->data[2 * count + i] = values[v][1];
    }
    StySites *sites = collect(guide);
    for (int look = 0; look < LOOKS; look += 4)
      for (const StyEngine *engine = sty_engines; engine->name; engine++) {
        if (!engine->exact) continue;
        const StyLutSpec spec = describe(SIZE, look);
        const clock_t begin = clock();
        StyLut *lut = try_build(sites, engine, &spec, 1);
        const double seconds = (double)(clock() - begin) / CLOCKS_PER_SEC;
        if (!lut) continue;
        if (seconds > CASES(3, 30)) fail_msg("%s takes %.1f s for one value", engine->name, seconds);
        assert_int_equal(lut->unique, 1);
        for (size_t t = 0; t < SIZE * SIZE; t++) assert_int_equal(lut->pixels[t], 1235);
        sty_destroy_lut(&lut);
      }
    sty_destroy_sites(&sites);
  }
  sty_destroy_image(&guide);
}

/* ---- approximate engines -------------------------------------------------------- */

typedef struct Quality {
  int texels, right;
  double excess, worst; /* distance above the least, guide units */
} Quality;

/* What the answers are worth; each must be a covered pixel whose distance is the one stated. */
static void judge(const StyLut *lut, const StyLut *reference, const StySites *sites, Quality *quality) {
  const size_t pixels = (size_t)sites->width * (size_t)sites->height;
  bool *covered = calloc(pixels, sizeof *covered);
  assert_non_null(covered);
  for (size_t s = 0; s < sites->count; s++) covered[sites->pixels[s]] = true;
  for (size_t t = 0; t < sty_count_texels(&lut->spec); t++) {
    assert_true(lut->pixels[t] < pixels);
    assert_true(covered[lut->pixels[t]]);
    assert_true(lut->errors[t] >= reference->errors[t]);
    const double above = (double)lut->errors[t] - reference->errors[t];
    quality->texels++;
    quality->right += above == 0;
    quality->excess += above;
    quality->worst = fmax(quality->worst, above);
  }
  free(covered);
}

static void report(const char *name, const char *what, const Quality *q) {
  print_message("%s, %s: recall %.4f, excess %.3g on average, %.3g at most, over %d texels\n", name, what,
                (double)q->right / q->texels, q->excess / q->texels, q->worst, q->texels);
}

/* FLANN shuffles by the system's own randomness: not even a forest is the same from run to run. */
static void expect_approximate(const char *name, const StySites *sites, StyLutSpec spec, int threads,
                               Quality *quality) {
  StyLut *reference = build_as(sites, "brute", spec, 1), *lut = build_as(sites, name, spec, threads);
  assert_int_equal(lut->unique, reference->unique);
  judge(lut, reference, sites, quality);
  sty_destroy_lut(&lut);
  sty_destroy_lut(&reference);
}

static void test_forest(void **state) {
  (void)state;
  uint64_t random = 20;
  Quality small = {0}, dense = {0};
  for (int trial = 0; trial < CASES(KINDS * LOOKS, KINDS * 2); trial++) {
    StyImage *guide = make_guide((Kind)(trial % KINDS), random_side(&random), random_side(&random), &random);
    StySites *sites = collect(guide);
    expect_approximate("flann-forest", sites, describe(2 + draw_below(&random, 16), trial / KINDS % LOOKS),
                       1 + trial % 3, &small);
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
  report("flann-forest", "small guides", &small);
  for (int kind = 0; kind < CASES(DENSES, 2); kind++) {
    StyImage *guide = make_dense((Dense)kind, CASES(128, 50), &random);
    StySites *sites = collect(guide);
    expect_approximate("flann-forest", sites, describe(32, kind % LOOKS), 2, &dense);
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
  report("flann-forest", "dense guides", &dense);
}

/* More checks, better answers; a thousand of them are all of this guide. */
static void test_forest_options(void **state) {
  (void)state;
  uint64_t random = 21;
  StyImage *guide = make_guide(FLOATS, 30, 30, &random);
  StySites *sites = collect(guide);
  const StyLutSpec spec = describe(40, 0);
  StyLut *reference = build_as(sites, "brute", spec, 1);
  int right[3];
  static const StyEngineOptions options[] = {{1, 1, 0.9}, {4, 32, 0.9}, {64, 100000, 0.9}};
  for (int o = 0; o < 3; o++) {
    StyLut *lut = NULL;
    assert_int_equal(sty_build_lut(sites, find_engine("flann-forest"), &options[o], &spec, NULL, &lut, NULL), STY_OK);
    Quality quality = {0};
    judge(lut, reference, sites, &quality);
    right[o] = quality.right;
    sty_destroy_lut(&lut);
  }
  assert_true(right[0] < right[1] && right[1] <= right[2]);
  assert_int_equal(right[2], 1600);
  sty_destroy_lut(&reference);
  sty_destroy_sites(&sites);
  sty_destroy_image(&guide);
}

/* Checks are chosen by a sample. */
static void test_autotuned(void **state) {
  (void)state;
  uint64_t random = 22;
  Quality small = {0};
  for (int trial = 0; trial < CASES(8, 4); trial++) {
    StyImage *guide =
        make_guide((Kind)(trial % KINDS), 1 + draw_below(&random, 30), 1 + draw_below(&random, 30), &random);
    StySites *sites = collect(guide);
    expect_approximate("flann-auto", sites, describe(2 + draw_below(&random, 16), trial % LOOKS), 1 + trial % 3,
                       &small);
    sty_destroy_sites(&sites);
    sty_destroy_image(&guide);
  }
  report("flann-auto", "small guides", &small);
}

/* ---- the lit sphere --------------------------------------------------------------- */

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
      for (int look = 0; look < 4; look++) {
        const StyLutSpec spec = describe(sizes[z], look);
        StyLut *lut = build_as(sites, "analytic", spec, 1), *reference = build_as(sites, "flann-single", spec, 1);
        for (int t = 0; t < sizes[z] * sizes[z]; t++) {
          float g[2];
          sty_get_texel_value(&lut->spec, t % sizes[z], t / sizes[z], g);
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
            fail_msg("sphere %dx%d, table %d, look %d: (%g, %g) is answered %g off, best %g", width, height, sizes[z],
                     look, (double)g[0], (double)g[1], found, (double)reference->errors[t]);
          const int column = (int)((g[0] + 1) / 2 * (float)width), row = (int)((1 - g[1]) / 2 * (float)height);
          const int inside = column < width && row < height;
          if (inside && a[row * width + column] > 0) {
            /* On the border of two pixels rounding may pick the other one. */
            const double bx = fabs((double)g[0] - x[row * width + column]),
                         by = fabs((double)g[1] - y[row * width + column]);
            if (bx < half_x - 1e-5 && by < half_y - 1e-5)
              fail_msg("sphere %dx%d, table %d, look %d: (%g, %g) is answered (%g, %g) off", width, height, sizes[z],
                       look, (double)g[0], (double)g[1], dx, dy);
          }
        }
        StyLut *threaded = build_as(sites, "analytic", spec, 3);
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
      sty_get_texel_value(&lut->spec, t % 256, t / 256, g);
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
  const StyLutSpec spec = describe(16, 0);
  StyLut *lut = NULL;
  StyError error = {STY_OK, ""};
  const StyStatus status = sty_build_lut(sites, find_engine("analytic"), NULL, &spec, NULL, &lut, &error);
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

  /* The place is nearest by xy only. */
  guide = make_sphere(SIDE, SIDE);
  StySites *sites = collect(guide);
  const StyLutSpec spec = describe(16, 4);
  StyLut *lut = NULL;
  StyError error = {STY_OK, ""};
  expect_message(sty_build_lut(sites, find_engine("analytic"), NULL, &spec, NULL, &lut, &error), STY_ERROR_USAGE,
                 &error, PARTS("analytic", "angle", "xy"));
  assert_null(lut);
  sty_destroy_sites(&sites);
  sty_destroy_image(&guide);
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
    const StyLutSpec spec = describe(33, 0);
    StyLut *lut = NULL;
    const StyStatus status = sty_build_lut(sites, find_engine("analytic"), NULL, &spec, NULL, &lut, NULL);
    StyLut *reference = build(sites, "brute", 33, STY_SAMPLE_CENTRE, 1);
    if (status != STY_OK) assert_int_equal(status, STY_ERROR_INPUT);
    for (int t = 0; lut && t < 33 * 33; t++) {
      float g[2];
      sty_get_texel_value(&spec, t % 33, t / 33, g);
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
      const StyLutSpec spec = describe(bad[i], 0);
      assert_int_equal(sty_build_lut(sites, engine, NULL, &spec, NULL, &lut, &error), STY_ERROR_USAGE);
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
      cmocka_unit_test(test_dense_guides),
      cmocka_unit_test(test_sparse_guides),
      cmocka_unit_test(test_threads_sort_alike),
      cmocka_unit_test(test_dense_guide_at_many_sizes),
      cmocka_unit_test(test_uniform_points),
      cmocka_unit_test(test_circle),
      cmocka_unit_test(test_duplicates),
      cmocka_unit_test(test_forest),
      cmocka_unit_test(test_forest_options),
      cmocka_unit_test(test_autotuned),
      cmocka_unit_test(test_analytic),
      cmocka_unit_test(test_analytic_on_large_spheres),
      cmocka_unit_test(test_analytic_refuses),
      cmocka_unit_test(test_analytic_with_holes),
      cmocka_unit_test(test_bad_sizes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
