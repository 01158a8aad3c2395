/* Light-path channels beside what is known of light: Lambert, furnaces, the integrating sphere, mirrors. */
#include <math.h>

#include "../scratch.h"
#include "stylut/guide.h"

enum { SIDE = 48 };
static const char *const PATHS[] = {"full", "LDE", "LSE", "LD12E", "LIE"};
enum { FULL, LDE, LSE, LD12E, LIE };

/* ---- scenes ---- */

static StyScene *open_scene(double ambient) {
  StyScene *scene = NULL;
  assert_int_equal(sty_create_scene(&scene, NULL), STY_OK);
  scene->ambient = ambient;
  return scene;
}

static StyMaterial make_material(double red, double green, double blue, double specular, double shininess) {
  return (StyMaterial){.paint = {{red, green, blue}, -1}, .specular = specular, .shininess = shininess};
}

static void add_sphere(StyScene *scene, double x, double y, double z, double radius, StyMaterial material) {
  const StySphere sphere = {.centre = {x, y, z}, .radius = radius, .style = 1, .material = material};
  assert_int_equal(sty_add_sphere(scene, &sphere, NULL), STY_OK);
}

static int add_mesh(Scratch *scratch, StyScene *scene, const char *text, double crease) {
  StyMesh *mesh = NULL;
  int number = -1;
  assert_int_equal(read_text_mesh(scratch, "some.obj", text, crease, &mesh, NULL), STY_OK);
  assert_int_equal(sty_add_mesh(scene, &mesh, &number, NULL), STY_OK);
  return number;
}

static void add_object(StyScene *scene, int mesh, const double transform[3][4], StyMaterial material) {
  StyObject object = {.mesh = mesh, .style = 1, .material = material, .is_painted = true};
  memcpy(object.transform, transform, sizeof object.transform);
  assert_int_equal(sty_add_object(scene, &object, NULL), STY_OK);
}

static void add_sun(StyScene *scene, double x, double y, double z, double red, double green, double blue) {
  const StyLight light = {.direction = {x, y, z}, .intensity = 1, .colour = {red, green, blue}};
  assert_int_equal(sty_add_light(scene, &light, NULL), STY_OK);
}

static void add_lamp(StyScene *scene, double x, double y, double z, double intensity) {
  const StyLight light = {.is_point = true, .position = {x, y, z}, .intensity = intensity, .colour = {1, 1, 1}};
  assert_int_equal(sty_add_light(scene, &light, NULL), STY_OK);
}

static const char *const WALL_OBJ = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";
static const double BACK[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, -1}},
                    FRONT[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 1}},
                    FLOOR[3][4] = {{1, 0, 0, 0}, {0, 0, 1, -1}, {0, 1, 0, 0}},
                    CEILING[3][4] = {{1, 0, 0, 0}, {0, 0, 1, 1}, {0, 1, 0, 0}},
                    LEFT[3][4] = {{0, 0, 1, -1}, {1, 0, 0, 0}, {0, 1, 0, 0}},
                    RIGHT[3][4] = {{0, 0, 1, 1}, {1, 0, 0, 0}, {0, 1, 0, 0}};

/* A closed room of grey walls, the left one red, with a lamp and a box; a ball in it is glossy where `specular` is. */
static StyScene *open_room(Scratch *scratch, double specular) {
  StyScene *scene = open_scene(0);
  const int wall = add_mesh(scratch, scene, WALL_OBJ, 30), cube = add_mesh(scratch, scene, CUBE_OBJ, 30);
  const StyMaterial grey = make_material(0.7, 0.7, 0.7, 0, 1), red = make_material(0.7, 0.1, 0.1, 0, 1);
  static const double box[3][4] = {{0.25, 0, 0.1, -0.35}, {0, 0.5, 0, -0.5}, {-0.1, 0, 0.25, -0.4}};
  add_object(scene, wall, BACK, grey);
  add_object(scene, wall, FRONT, grey);
  add_object(scene, wall, FLOOR, grey);
  add_object(scene, wall, CEILING, grey);
  add_object(scene, wall, LEFT, red);
  add_object(scene, wall, RIGHT, grey);
  add_object(scene, cube, box, grey);
  add_sphere(scene, 0.4, -0.65, 0.1, 0.3, make_material(0.4, 0.4, 0.5, specular, 100));
  add_lamp(scene, 0.05, 0.5, 0.1, 0.5);
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  return scene;
}

static const StyStand IN_FRONT = {.position = {0, 0, 5}, .target = {0, 0, 0}, .up = {0, 1, 0}, .height = 2};
static const StyStand IN_THE_ROOM = {
    .perspective = true, .position = {0.02, 0.03, 0.97}, .target = {0, 0, -1}, .up = {0, 1, 0}, .fov = 70};

/* ---- pictures ---- */

static const StyTraceOptions ALL_PATHS = {.width = SIDE,
                                          .height = SIDE,
                                          .groups = STY_GUIDE_PATHS | STY_GUIDE_LUMA | STY_GUIDE_NORMAL,
                                          .contour = {1, 1},
                                          .paths = {16, 0}};

static StyImage *trace(const StyScene *scene, const StyStand *stand, const StyTraceOptions *options, int threads) {
  StyCamera camera;
  StyImage *guide = NULL;
  StyError error = {STY_OK, ""};
  const StyRun run = {.threads = threads};
  if (sty_place_camera(scene, stand, options->width, options->height, &camera, &error) ||
      sty_trace_guide(scene, &camera, options, &run, NULL, &guide, &error))
    fail_msg("%s", error.text);
  return guide;
}

static StyImage *trace_paths(StyScene *scene, const StyStand *stand, int samples, uint64_t seed) {
  StyTraceOptions options = ALL_PATHS;
  options.paths = (StyPathOptions){samples, seed};
  if (scene->scale == 0) assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  return trace(scene, stand, &options, 0);
}

static const float *find(const StyImage *guide, const char *name) {
  const float *plane = sty_find_channel(guide, name);
  if (!plane) fail_msg("no channel %s", name);
  return plane;
}

static const float *find_path(const StyImage *guide, int path, int colour) {
  char name[16];
  snprintf(name, sizeof name, "%s.%c", PATHS[path], "RGB"[colour]);
  return find(guide, name);
}

/* All five channels of one colour at a pixel. */
static void get_paths(const StyImage *guide, size_t pixel, int colour, double out[5]) {
  for (int p = 0; p < 5; p++) out[p] = (double)find_path(guide, p, colour)[pixel];
}

static void expect_near(const char *what, double found, double expected, double tolerance) {
  if (!(fabs(found - expected) <= tolerance))
    fail_msg("%s: found %.9g, expected %.9g within %.2g", what, found, expected, tolerance);
}

/* Every covered pixel holds these, in all colours; NAN: whatever. */
static void expect_everywhere(const StyImage *guide, const double expected[5], double tolerance) {
  const float *covered = find(guide, "A");
  int seen = 0;
  for (size_t i = 0; i < sty_count_pixels(guide); i++)
    for (int k = 0; k < 3; k++) {
      double found[5];
      get_paths(guide, i, k, found);
      seen += covered[i] > 0;
      for (int p = 0; p < 5; p++)
        if (!isnan(expected[p])) expect_near(PATHS[p], found[p], covered[i] > 0 ? expected[p] : 0, tolerance);
    }
  assert_true(seen > SIDE * SIDE / 2);
}

/* Over covered pixels. */
typedef struct Mean {
  double value, error; /* sigma of the mean, of what pixels vary by */
  int count;
} Mean;

static Mean get_mean(const StyImage *guide, const float *plane) {
  const float *covered = find(guide, "A");
  double sum = 0, squares = 0;
  Mean mean = {0};
  for (size_t i = 0; i < sty_count_pixels(guide); i++) {
    if (covered[i] == 0) continue;
    mean.count++;
    sum += (double)plane[i];
    squares += (double)plane[i] * (double)plane[i];
  }
  mean.value = sum / mean.count;
  mean.error = sqrt(fmax(0, squares / mean.count - mean.value * mean.value) / mean.count);
  return mean;
}

/* ---- direct light ---- */

/* On a lone ball every way is one surface long: Lambert's cosine, and nothing else. */
static void test_lambert(void **state) {
  (void)state;
  StyScene *scene = open_scene(0);
  const double albedo[3] = {0.9, 0.5, 0.1}, sun[3] = {2, 1, 0.5};
  add_sphere(scene, 0, 0, 0, 1, make_material(albedo[0], albedo[1], albedo[2], 0, 1));
  add_sun(scene, -3, 0, -4, sun[0], sun[1], sun[2]);
  StyImage *guide = trace_paths(scene, &IN_FRONT, 1, 0);
  for (size_t i = 0; i < sty_count_pixels(guide); i++) {
    const double cosine = (double)find(guide, "normal.X")[i] * 0.6 + (double)find(guide, "normal.Z")[i] * 0.8;
    for (int k = 0; k < 3; k++) {
      double found[5];
      const double expected = albedo[k] * sun[k] * fmax(0, cosine);
      get_paths(guide, i, k, found);
      expect_near("LDE", found[LDE], expected, 2e-6);
      assert_true(found[FULL] == found[LDE] && found[LD12E] == found[LDE] && found[LSE] == 0 && found[LIE] == 0);
    }
  }
  sty_destroy_image(&guide);
  sty_destroy_scene(&scene);
}

/* In a room with shadows and a highlight: LDE + LSE is luma, and no sample changes it. */
static void test_direct_is_luma(void **state) {
  static const double weights[3] = {0.2126, 0.7152, 0.0722};
  StyScene *scene = open_room(*state, 0.5);
  StyImage *one = trace_paths(scene, &IN_THE_ROOM, 1, 0), *more = trace_paths(scene, &IN_THE_ROOM, 8, 5);
  int highlit = 0;
  for (size_t i = 0; i < sty_count_pixels(one); i++) {
    double sum = 0;
    for (int k = 0; k < 3; k++) {
      double found[5], again[5];
      get_paths(one, i, k, found);
      get_paths(more, i, k, again);
      assert_true(found[LDE] == again[LDE] && found[LSE] == again[LSE]);
      highlit += found[LSE] > 0.01;
      sum += weights[k] * (found[LDE] + found[LSE]);
    }
    const double luma = (double)find(one, "luma.Y")[i];
    expect_near("luminance of LDE + LSE", sum, luma, 2e-7 * luma);
  }
  assert_true(highlit > 3);
  sty_destroy_image(&one);
  sty_destroy_image(&more);
  sty_destroy_scene(&scene);
}

/* ---- furnaces ---- */

/* White in white surroundings can't be seen: on a ball, on a cube, and on a cube whose normals are smoothed. */
static void test_white_furnace(void **state) {
  static const double expected[5] = {1, 1, 0, 1, 0};
  static const StyStand aside = {.position = {3, 2, 5}, .target = {0, 0, 0}, .up = {0, 1, 0}, .height = 2};
  for (int shape = 0; shape < 3; shape++) {
    StyScene *scene = open_scene(1);
    if (shape == 0)
      add_sphere(scene, 0, 0, 0, 1, sty_white);
    else
      add_object(scene, add_mesh(*state, scene, CUBE_OBJ, shape == 1 ? 30 : 180), sty_identity, sty_white);
    StyImage *guide = trace_paths(scene, &aside, 16, 0);
    expect_everywhere(guide, expected, 1e-6);
    sty_destroy_image(&guide);
    sty_destroy_scene(&scene);
  }
}

/* Albedo and highlight add up, to 1 at most; which of the two a way takes is a matter of chance, by their share. */
static void test_glossy_furnace(void **state) {
  (void)state;
  static const double albedos[] = {0.3, 0, 1}, speculars[] = {0.5, 1, 0.25}, totals[] = {0.8, 1, 1};
  for (int i = 0; i < 3; i++) {
    StyScene *scene = open_scene(1);
    add_sphere(scene, 0, 0, 0, 1, make_material(albedos[i], albedos[i], albedos[i], speculars[i], 30));
    StyImage *guide = trace_paths(scene, &IN_FRONT, 16, 3);
    const double expected[5] = {totals[i], NAN, NAN, NAN, 0};
    expect_everywhere(guide, expected, 1e-6);
    const Mean mean = get_mean(guide, find_path(guide, LSE, 1));
    const double share = speculars[i] / totals[i];
    const double sigma = totals[i] * sqrt(share * (1 - share) / (16.0 * mean.count));
    print_message("highlight in the furnace: %.5f of %.5f, sigma %.5f\n", mean.value, speculars[i], sigma);
    expect_near("LSE", mean.value, speculars[i], 3 * sigma + 1e-6);
    sty_destroy_image(&guide);
    sty_destroy_scene(&scene);
  }
}

/* Things in each other's way: never brighter than the surroundings; white ones, however long the ways, as bright. */
static void test_crowded_furnace(void **state) {
  for (int glossy = 0; glossy < 2; glossy++) {
    StyScene *scene = open_scene(1);
    const int cube = add_mesh(*state, scene, CUBE_OBJ, 180);
    const StyMaterial material = make_material(1, glossy ? 0.5 : 1, 1, glossy ? 0.6 : 0, 20);
    for (int i = 0; i < 30; i++) {
      const double transform[3][4] = {
          {0.2, 0.1 * sin(i), 0, cos(i * 1.7) * 0.8}, {0, 0.2, 0, sin(i * 2.3) * 0.8}, {0.1, 0, 0.2, cos(i * 0.9)}};
      add_object(scene, cube, transform, material);
      add_sphere(scene, cos(i * 2.9) * 0.8, sin(i * 1.1) * 0.8, sin(i * 3.3), 0.2, material);
    }
    StyImage *guide = trace_paths(scene, &IN_FRONT, 16, 0);
    for (size_t i = 0; i < 3 * sty_count_pixels(guide); i++) assert_true(find_path(guide, FULL, 0)[i] <= 1.000001f);
    const Mean mean = get_mean(guide, find_path(guide, FULL, 1));
    print_message("crowded furnace: %.5f\n", mean.value);
    if (glossy)
      assert_true(mean.value > 0.3 && mean.value < 0.95);
    else
      assert_true(mean.value > 0.999);
    sty_destroy_image(&guide);
    sty_destroy_scene(&scene);
  }
}

/* ---- bounces ---- */

/* Inside a sphere of radius r and albedo a, every place sees every other alike, so that all of a lamp's light that
 * bounces is even, wherever the lamp is: a^2 I/r^2 for the first bounce, 1/(1-a) of it for all. */
static void test_integrating_sphere(void **state) {
  (void)state;
  static const StyStand inside = {
      .perspective = true, .position = {-1, 0.2, 0}, .target = {5, 0, 1}, .up = {0, 1, 0}, .fov = 80};
  const double albedo[3] = {0.8, 0.5, 0.2}, r = 2, intensity = 3;
  StyScene *scene = open_scene(0);
  add_sphere(scene, 0, 0, 0, r, make_material(albedo[0], albedo[1], albedo[2], 0, 1));
  add_lamp(scene, 0.4, 0.8, 0.1, intensity);
  StyImage *guide = trace_paths(scene, &inside, 64, 0);
  float *second = malloc(sty_count_pixels(guide) * sizeof *second);
  assert_non_null(second);
  for (int k = 0; k < 3; k++) {
    for (size_t i = 0; i < sty_count_pixels(guide); i++)
      second[i] = find_path(guide, LD12E, k)[i] - find_path(guide, LDE, k)[i];
    const double once = albedo[k] * albedo[k] * intensity / (r * r), all = once / (1 - albedo[k]);
    const Mean first = get_mean(guide, second), every = get_mean(guide, find_path(guide, LIE, k));
    print_message("albedo %.1f: LDDE %.4f of %.4f (sigma %.4f), LIE %.4f of %.4f (sigma %.4f)\n", albedo[k],
                  first.value, once, first.error, every.value, all, every.error);
    assert_true(every.error < 0.02 * all);
    expect_near("LDDE", first.value, once, 3 * first.error);
    expect_near("LIE", every.value, all, 3 * every.error);
  }
  free(second);
  sty_destroy_image(&guide);
  sty_destroy_scene(&scene);
}

/* full is the sum of its parts; where nothing is glossy, of those that have channels. */
static void test_sum_of_parts(void **state) {
  for (int glossy = 0; glossy < 2; glossy++) {
    StyScene *scene = open_room(*state, glossy ? 0.5 : 0);
    StyImage *guide = trace_paths(scene, &IN_THE_ROOM, 16, 0);
    double most = 0;
    for (size_t i = 0; i < sty_count_pixels(guide); i++)
      for (int k = 0; k < 3; k++) {
        double p[5];
        get_paths(guide, i, k, p);
        const double rest = p[FULL] - p[LDE] - p[LSE] - p[LIE];
        most = fmax(most, rest);
        assert_true(rest > -1e-6 * (1 + p[FULL]));
        if (!glossy) assert_true(rest < 1e-6 * (1 + p[FULL]) && p[LSE] == 0);
        assert_true(p[LD12E] >= p[LDE] && p[LD12E] <= (p[LDE] + p[LIE]) * 1.000001);
      }
    if (glossy) assert_true(most > 0.05);
    sty_destroy_image(&guide);
    sty_destroy_scene(&scene);
  }
}

/* A polished plate shows the wall behind the viewer, dimmed by its `specular`; light that comes back to it from there
 * again adds next to nothing. */
static void test_mirror(void **state) {
  static const double plate[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
                      wall[3][4] = {{50, 0, 0, 0}, {0, 50, 0, 0}, {0, 0, 1, 20}};
  StyScene *scene = open_scene(0);
  const int mesh = add_mesh(*state, scene, WALL_OBJ, 30);
  scene->shadows = false;
  add_object(scene, mesh, plate, make_material(0, 0, 0, 0.6, 10000));
  add_object(scene, mesh, wall, make_material(0.5, 0.5, 0.5, 0, 1));
  add_sun(scene, 0, 0, 1, 2, 2, 2);
  StyImage *guide = trace_paths(scene, &IN_FRONT, 16, 0);
  static const double expected[5] = {NAN, 0, 0, 0, 0};
  expect_everywhere(guide, expected, 0);
  for (size_t i = 0; i < sty_count_pixels(guide); i++) assert_true(find_path(guide, FULL, 0)[i] > 0.599999f);
  expect_near("full", get_mean(guide, find_path(guide, FULL, 0)).value, 0.6, 0.003);
  sty_destroy_image(&guide);
  sty_destroy_scene(&scene);
}

/* Light that only a polished wall throws on a plate is in none of the parts that have channels. */
static void test_thrown_light(void **state) {
  static const double plate[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},
                      wall[3][4] = {{50, 0, 0, 0}, {0, 50, 0, 0}, {0, 0, 1, 20}};
  StyScene *scene = open_scene(0);
  const int mesh = add_mesh(*state, scene, WALL_OBJ, 30);
  scene->shadows = false;
  add_object(scene, mesh, plate, make_material(0.5, 0.5, 0.5, 0, 1));
  add_object(scene, mesh, wall, make_material(0, 0, 0, 0.8, 1));
  add_sun(scene, 0, 0, 1, 2, 2, 2);
  StyImage *guide = trace_paths(scene, &IN_FRONT, 16, 0);
  static const double expected[5] = {NAN, 0, 0, 0, 0};
  expect_everywhere(guide, expected, 0);
  const double mean = get_mean(guide, find_path(guide, FULL, 0)).value;
  /* Highlights of the exponent 1 fall from 0.8 * 2 where the plate is faced. */
  assert_true(mean > 0.5 * 0.8 * 2 * 0.7 && mean < 0.5 * 0.8 * 2);
  sty_destroy_image(&guide);
  sty_destroy_scene(&scene);
}

/* Beside the red wall the grey ones are redder than far from it. */
static void test_red_wall_bleeds(void **state) {
  StyScene *scene = open_room(*state, 0);
  StyImage *guide = trace_paths(scene, &IN_THE_ROOM, 64, 0);
  double sums[2][2] = {{0}};
  /* Columns of the back wall, which fills the middle of the picture. */
  for (int y = SIDE / 2 - 8; y < SIDE / 2; y++)
    for (int x = 0; x < 4; x++)
      for (int side = 0; side < 2; side++)
        for (int k = 0; k < 2; k++)
          sums[side][k] += (double)find_path(guide, LIE, k)[y * SIDE + SIDE / 2 + (side ? 8 + x : -12 + x)];
  print_message("red over green by the red wall %.3f, far from it %.3f\n", sums[0][0] / sums[0][1],
                sums[1][0] / sums[1][1]);
  assert_true(sums[0][0] / sums[0][1] > 1.05 * (sums[1][0] / sums[1][1]));
  assert_true(sums[1][0] / sums[1][1] > 1);
  sty_destroy_image(&guide);
  sty_destroy_scene(&scene);
}

/* ---- sampling ---- */

static double get_rms(const StyImage *a, const StyImage *b, int path) {
  const float *left = find_path(a, path, 0), *right = find_path(b, path, 0);
  double sum = 0;
  for (size_t i = 0; i < 3 * sty_count_pixels(a); i++) sum += pow((double)left[i] - (double)right[i], 2);
  return sqrt(sum / 3 / (double)sty_count_pixels(a));
}

/* Twice the samples, at least about the root of a half of the noise: the difference of two seeds tells it. */
static void test_more_samples_less_noise(void **state) {
  StyScene *scene = open_room(*state, 0.5);
  double last = 0, first = 0;
  for (int samples = 8; samples <= 128; samples *= 2) {
    StyImage *a = trace_paths(scene, &IN_THE_ROOM, samples, 1), *b = trace_paths(scene, &IN_THE_ROOM, samples, 2);
    const double noise = get_rms(a, b, FULL);
    print_message("%3d samples: noise %.5f\n", samples, noise);
    if (last > 0) assert_true(noise < 0.85 * last && noise > 0.4 * last);
    if (!(first > 0)) first = noise;
    last = noise;
    sty_destroy_image(&a);
    sty_destroy_image(&b);
  }
  assert_true(last < first / 4);
  sty_destroy_scene(&scene);
}

/* One sample on a plate takes one lobe or the other: pixels agree with those beside them, and with those of other
 * blocks, tiles and bands, half of the time. */
static void test_pixels_are_apart(void **state) {
  static const double plate[3][4] = {{4, 0, 0, 0}, {0, 4, 0, 0}, {0, 0, 1, 0}};
  static const int steps[][2] = {{1, 0}, {0, 1}, {4, 0}, {0, 2}, {32, 0}, {0, 32}, {32, 32}, {0, 128}};
  StyTraceOptions options = ALL_PATHS;
  options.width = options.height = 256, options.paths.samples = 1;
  StyScene *scene = open_scene(1);
  add_object(scene, add_mesh(*state, scene, WALL_OBJ, 30), plate, make_material(0.5, 0.5, 0.5, 0.5, 20));
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  StyImage *guide = trace(scene, &IN_FRONT, &options, 0);
  const float *lobe = find_path(guide, LSE, 0);
  for (size_t s = 0; s < sizeof steps / sizeof *steps; s++) {
    int same = 0, count = 0;
    for (int y = 0; y < 256 - steps[s][1]; y++)
      for (int x = 0; x < 256 - steps[s][0]; x++, count++)
        same += lobe[y * 256 + x] == lobe[(y + steps[s][1]) * 256 + x + steps[s][0]];
    expect_near("share of pixels alike", (double)same / count, 0.5, 4 * 0.5 / sqrt(count));
  }
  sty_destroy_image(&guide);
  sty_destroy_scene(&scene);
}

/* A pixel's values hang on its place alone: not on threads, on bands, which contours shift, or on what else is asked
 * for; on the seed they do. */
static void test_same_bytes(void **state) {
  StyScene *scene = open_room(*state, 0.5);
  scene->ambient = 0.1;
  StyTraceOptions options = ALL_PATHS;
  options.height = 300, options.width = 37, options.paths.samples = 3;
  StyImage *first = trace(scene, &IN_THE_ROOM, &options, 1);
  const size_t size = 3 * sty_count_pixels(first) * sizeof(float);
  for (int threads = 1; threads <= 4; threads++)
    for (int p = 0; p <= 5; p++) {
      options.groups = p < 5 ? (unsigned)STY_GUIDE_FULL << p : STY_GUIDE_PATHS;
      if (threads > 2) options.groups |= STY_GUIDE_CONTOUR;
      StyImage *guide = trace(scene, &IN_THE_ROOM, &options, threads);
      for (int q = 0; q < 5; q++)
        if (p == q || p == 5) assert_memory_equal(find_path(first, q, 0), find_path(guide, q, 0), size);
      sty_destroy_image(&guide);
    }
  options.paths.seed = 1;
  StyImage *other = trace(scene, &IN_THE_ROOM, &options, 2);
  assert_memory_not_equal(find_path(first, FULL, 0), find_path(other, FULL, 0), size);
  sty_destroy_image(&other);
  sty_destroy_image(&first);
  sty_destroy_scene(&scene);
}

static void test_refused(void **state) {
  StyScene *scene = open_room(*state, 0);
  StyCamera camera;
  assert_int_equal(sty_place_camera(scene, &IN_THE_ROOM, SIDE, SIDE, &camera, NULL), STY_OK);
  static const int wrong[] = {-1, 0, STY_MOST_SAMPLES + 1};
  for (int i = 0; i < 3; i++) {
    StyImage *guide = NULL;
    StyError error;
    StyTraceOptions options = ALL_PATHS;
    options.paths.samples = wrong[i];
    const StyStatus status = sty_trace_guide(scene, &camera, &options, NULL, NULL, &guide, &error);
    expect_message(status, STY_ERROR_USAGE, &error, PARTS("samples", "expected 1 to 65536"));
    assert_null(guide);
  }
  unsigned groups = 0;
  assert_int_equal(sty_parse_channels("--channels", "paths", &groups, NULL), STY_OK);
  assert_int_equal(groups, STY_GUIDE_PATHS);
  assert_int_equal(sty_parse_channels("--channels", "all", &groups, NULL), STY_OK);
  assert_int_equal(groups & STY_GUIDE_PATHS, 0);
  sty_destroy_scene(&scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_lambert),
      cmocka_unit_test(test_direct_is_luma),
      cmocka_unit_test(test_white_furnace),
      cmocka_unit_test(test_glossy_furnace),
      cmocka_unit_test(test_crowded_furnace),
      cmocka_unit_test(test_integrating_sphere),
      cmocka_unit_test(test_sum_of_parts),
      cmocka_unit_test(test_mirror),
      cmocka_unit_test(test_thrown_light),
      cmocka_unit_test(test_red_wall_bleeds),
      cmocka_unit_test(test_more_samples_less_noise),
      cmocka_unit_test(test_pixels_are_apart),
      cmocka_unit_test(test_same_bytes),
      cmocka_unit_test(test_refused),
  };
  return cmocka_run_group_tests(tests, open_scratch, close_scratch);
}
