/* Scenes of several objects: spheres that are exact, instances that are where a moved mesh would be,
 * light by its formulas. */
#include <math.h>

#include "../scene/scratch.h"
#include "stylut/guide.h"

static const unsigned ALL = STY_GUIDE_NORMAL | STY_GUIDE_DEPTH | STY_GUIDE_POSITION | STY_GUIDE_OBJECT |
                            STY_GUIDE_STYLE | STY_GUIDE_ALBEDO | STY_GUIDE_LUMA;
enum { SIDE = 96 };

static StyScene *open_scene(void) {
  StyScene *scene = NULL;
  assert_int_equal(sty_create_scene(&scene, NULL), STY_OK);
  return scene;
}

static int add_cube(Scratch *scratch, StyScene *scene) {
  StyMesh *mesh = NULL;
  int number = -1;
  assert_int_equal(read_text_mesh(scratch, "cube.obj", CUBE_OBJ, 30, &mesh, NULL), STY_OK);
  assert_int_equal(sty_add_mesh(scene, &mesh, &number, NULL), STY_OK);
  assert_null(mesh);
  return number;
}

static void add_object(StyScene *scene, int mesh, const double transform[3][4], int style) {
  StyObject object = {.mesh = mesh, .style = style, .material = sty_white};
  memcpy(object.transform, transform, sizeof object.transform);
  assert_int_equal(sty_add_object(scene, &object, NULL), STY_OK);
}

static void add_sphere(StyScene *scene, double x, double y, double z, double radius, int style) {
  const StySphere sphere = {.centre = {x, y, z}, .radius = radius, .style = style, .material = sty_white};
  assert_int_equal(sty_add_sphere(scene, &sphere, NULL), STY_OK);
}

static StyImage *trace_from(StyScene *scene, const StyStand *stand) {
  StyCamera camera;
  StyImage *guide = NULL;
  StyError error = {STY_OK, ""};
  const StyTraceOptions options = {.width = SIDE, .height = SIDE, .groups = ALL, .contour = {1, 1}};
  if (sty_place_camera(scene, stand, SIDE, SIDE, &camera, &error) ||
      sty_trace_guide(scene, &camera, &options, NULL, NULL, &guide, &error))
    fail_msg("%s", error.text);
  return guide;
}

static float at(const StyImage *guide, const char *channel, int x, int y) {
  const float *plane = sty_find_channel(guide, channel);
  assert_non_null(plane);
  return plane[y * guide->width + x];
}

/* The largest difference of all channels; pixels that only one covers count in *edges. A good part is covered. */
static double compare(const StyImage *a, const StyImage *b, bool mirrored, int *edges) {
  double worst = 0;
  int covered = 0;
  *edges = 0;
  assert_int_equal(a->channel_count, b->channel_count);
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++) {
      const int other = mirrored ? SIDE - 1 - x : x;
      if (at(a, "A", x, y) != at(b, "A", other, y)) {
        ++*edges;
        continue;
      }
      if (at(a, "A", x, y) == 0) continue;
      covered++;
      for (int c = 0; c < a->channel_count; c++) {
        const bool flips = mirrored && (strcmp(a->names[c], "normal.X") == 0 || strcmp(a->names[c], "position.X") == 0);
        const double found = (double)at(b, a->names[c], other, y) * (flips ? -1 : 1);
        worst = fmax(worst, fabs((double)at(a, a->names[c], x, y) - found));
      }
    }
  assert_in_range(covered, SIDE * SIDE / 20, SIDE * SIDE);
  return worst;
}

/* A sphere that fills the film is the analytic one, wherever in the world it lies and however large it is. */
static void test_sphere_is_exact(void **state) {
  (void)state;
  static const double places[][4] = {
      {0, 0, 0, 1}, {2, -1, 3, 0.7}, {1e8, -1e8, 5e7, 30}, {0, 0, 0, 1e-20}, {1, 1, 1, 1e20}};
  StyImage *exact = NULL;
  assert_int_equal(sty_make_sphere_guide(SIDE, SIDE, ALL, &exact, NULL), STY_OK);
  for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
    const double *p = places[i], r = p[3];
    StyScene *scene = open_scene();
    add_sphere(scene, p[0], p[1], p[2], r, 1);
    assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
    const StyStand stand = {
        .position = {p[0], p[1], p[2] + r}, .target = {p[0], p[1], p[2]}, .up = {0, 1, 0}, .height = 2 * r};
    StyImage *traced = trace_from(scene, &stand);
    for (int y = 0; y < SIDE; y++)
      for (int x = 0; x < SIDE; x++) {
        const double u = (x + 0.5) / SIDE * 2 - 1, v = (y + 0.5) / SIDE * 2 - 1;
        if (fabs(u * u + v * v - 1) < 1e-5) continue;
        assert_true(at(traced, "A", x, y) == at(exact, "A", x, y));
        if (at(exact, "A", x, y) == 0) continue;
        static const char *const normals[] = {"normal.X", "normal.Y", "normal.Z"};
        for (int k = 0; k < 3; k++)
          assert_true(fabsf(at(traced, normals[k], x, y) - at(exact, normals[k], x, y)) < 1e-5f);
        assert_true(fabs((double)at(traced, "depth.Z", x, y) - (double)at(exact, "depth.Z", x, y) * r) < 1e-5 * r);
        assert_true(at(traced, "object.I", x, y) == 1 && at(traced, "style.I", x, y) == 1);
      }
    sty_destroy_image(&traced);
    sty_destroy_scene(&scene);
  }
  sty_destroy_image(&exact);
}

/* Seen from its centre it is a room: every pixel covered, at the radius' distance, facing inward. */
static void test_inside_a_sphere(void **state) {
  (void)state;
  StyScene *scene = open_scene();
  add_sphere(scene, 1, 2, 3, 5, 2);
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  const StyStand stand = {.perspective = true, .position = {1, 2, 3}, .target = {9, 2, 3}, .up = {0, 1, 0}, .fov = 90};
  StyImage *guide = trace_from(scene, &stand);
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++) {
      double squared = 0;
      static const char *const positions[] = {"position.X", "position.Y", "position.Z"};
      for (int k = 0; k < 3; k++) squared += pow((double)at(guide, positions[k], x, y) - (k + 1), 2);
      assert_true(fabs(sqrt(squared) - 5) < 1e-5);
      assert_true(at(guide, "normal.Z", x, y) > 0.5f);
    }
  sty_destroy_image(&guide);
  sty_destroy_scene(&scene);
}

/* A sphere that grows and moves takes its points along. */
static void test_growing_sphere(void **state) {
  (void)state;
  static const StyStand stand = {.position = {0, 0, 9}, .target = {0, 0, 0}, .up = {0, 1, 0}, .height = 6};
  StyScene *now = open_scene(), *before = open_scene();
  StyCamera camera, then;
  StyImage *guide = NULL;
  add_sphere(now, 0.5, 0.25, 0, 2, 1);
  add_sphere(before, 0, 0, 1, 1, 1);
  assert_int_equal(sty_finish_scene(now, NULL), STY_OK);
  assert_int_equal(sty_finish_scene(before, NULL), STY_OK);
  assert_int_equal(sty_place_camera(now, &stand, SIDE, SIDE, &camera, NULL), STY_OK);
  assert_int_equal(sty_place_camera(before, &stand, SIDE, SIDE, &then, NULL), STY_OK);
  const StyTraceOptions options = {
      .width = SIDE, .height = SIDE, .groups = STY_GUIDE_MOTION | STY_GUIDE_POSITION, .previous = {before, &then}};
  assert_int_equal(sty_trace_guide(now, &camera, &options, NULL, NULL, &guide, NULL), STY_OK);
  const double pixels = SIDE / 6.0;
  int covered = 0;
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++) {
      if (at(guide, "A", x, y) == 0) continue;
      const double px = (double)at(guide, "position.X", x, y), py = (double)at(guide, "position.Y", x, y);
      covered++;
      assert_true(fabs((double)at(guide, "motion.U", x, y) - ((px - 0.5) / 2 - px) * pixels) < 1e-4);
      assert_true(fabs((double)at(guide, "motion.V", x, y) + ((py - 0.25) / 2 - py) * pixels) < 1e-4);
    }
  assert_in_range(covered, SIDE * SIDE / 5, SIDE * SIDE);
  sty_destroy_image(&guide);
  sty_destroy_scene(&now);
  sty_destroy_scene(&before);
}

/* The cube through a transform is the cube whose vertices were moved. */
static void test_instances(void **state) {
  static const double moved[3][4] = {{1.3, 0, 0.1, 2.1}, {0, 0.55, 0.25, -1.1}, {0, 0, 1.9, 0.5}};
  static const StyStand stand = {
      .perspective = true, .position = {4, 6, 12}, .target = {1, -1, 0}, .up = {0, 1, 0}, .fov = 40};
  char text[1024] = "";
  for (int v = 0; v < 8; v++) {
    const int bits = v ^ (v >> 1 & 1);
    const double p[3] = {bits & 1 ? 1 : -1, bits & 2 ? 1 : -1, bits & 4 ? 1 : -1};
    double q[3];
    for (int i = 0; i < 3; i++) q[i] = moved[i][0] * p[0] + moved[i][1] * p[1] + moved[i][2] * p[2] + moved[i][3];
    snprintf(text + strlen(text), sizeof text - strlen(text), "v %.9g %.9g %.9g\n", q[0], q[1], q[2]);
  }
  snprintf(text + strlen(text), sizeof text - strlen(text), "%s", strchr(CUBE_OBJ, 'f'));
  StyScene *instanced = open_scene(), *written = NULL;
  add_object(instanced, add_cube(*state, instanced), moved, 1);
  assert_int_equal(sty_finish_scene(instanced, NULL), STY_OK);
  assert_int_equal(read_text_scene(*state, "moved.obj", text, 30, &written, NULL), STY_OK);
  StyImage *a = trace_from(instanced, &stand), *b = trace_from(written, &stand);
  int edges;
  const double worst = compare(a, b, false, &edges);
  print_message("instance: largest difference %.2g, %d pixels at edges\n", worst, edges);
  assert_true(worst < 2e-5);
  assert_in_range(edges, 0, 2);
  sty_destroy_image(&a);
  sty_destroy_image(&b);
  sty_destroy_scene(&instanced);
  sty_destroy_scene(&written);
}

/* Mirror the scene, mirror the guide. */
static void test_mirror(void **state) {
  static const double plain[3][4] = {{0.5, 0.2, 0, 1}, {-0.2, 0.5, 0, 0.3}, {0, 0, 0.5, -0.2}},
                      mirrored[3][4] = {{-0.5, -0.2, 0, -1}, {-0.2, 0.5, 0, 0.3}, {0, 0, 0.5, -0.2}};
  static const StyStand stand = {
      .perspective = true, .position = {0, 1, 7}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fov = 45};
  StyImage *guides[2];
  for (int side = 0; side < 2; side++) {
    StyScene *scene = open_scene();
    add_object(scene, add_cube(*state, scene), side ? mirrored : plain, 3);
    add_sphere(scene, side ? 1.2 : -1.2, 0.4, 0.5, 0.8, 4);
    assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
    guides[side] = trace_from(scene, &stand);
    sty_destroy_scene(&scene);
  }
  int edges;
  const double worst = compare(guides[0], guides[1], true, &edges);
  print_message("mirrored: largest difference %.2g, %d pixels at edges\n", worst, edges);
  assert_true(worst < 1e-5);
  assert_in_range(edges, 0, 2);
  for (int side = 0; side < 2; side++) sty_destroy_image(&guides[side]);
}

/* A row of four things, each with its id and style. */
static void test_ids(void **state) {
  StyScene *scene = open_scene();
  const int cube = add_cube(*state, scene);
  for (int i = 0; i < 3; i++) {
    const double transform[3][4] = {{0.4, 0, 0, i - 1.5}, {0, 0.4, 0, 0}, {0, 0, 0.4, 0}};
    add_object(scene, cube, transform, 10 * i);
  }
  add_sphere(scene, 1.5, 0, 0, 0.4, 255);
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  const StyStand stand = {.position = {0, 0, 5}, .target = {0, 0, 0}, .up = {0, 1, 0}, .height = 4};
  StyImage *guide = trace_from(scene, &stand);
  static const float styles[4] = {0, 10, 20, 255};
  for (int i = 0; i < 4; i++) {
    const int x = SIDE / 8 + i * SIDE / 4;
    assert_true(at(guide, "object.I", x, SIDE / 2) == (float)(i + 1));
    assert_true(at(guide, "style.I", x, SIDE / 2) == styles[i]);
  }
  sty_destroy_image(&guide);
  sty_destroy_scene(&scene);
}

static const StyStand IN_FRONT = {.position = {0, 0, 5}, .target = {0, 0, 0}, .up = {0, 1, 0}, .height = 2};

/* ---- frames ------------------------------------------------------------------- */

static StyImage *trace_frame(StyScene *scene, const StyStand *stand, bool ray_frame) {
  StyCamera camera;
  StyImage *guide = NULL;
  const StyTraceOptions options = {.width = SIDE, .height = SIDE, .groups = STY_GUIDE_NORMAL, .ray_frame = ray_frame};
  assert_int_equal(sty_place_camera(scene, stand, SIDE, SIDE, &camera, NULL), STY_OK);
  assert_int_equal(sty_trace_guide(scene, &camera, &options, NULL, NULL, &guide, NULL), STY_OK);
  return guide;
}

/* Orthographic, both frames are one. A wall that faces a perspective camera has one normal in its frame; by ray, the
 * one whose z is the cosine between the ray and the wall's, and whose x and y lead back to the middle. */
static void test_ray_frame(void **state) {
  static const double wall[3][4] = {{40, 0, 0, 0}, {0, 40, 0, 0}, {0, 0, 0.01, -0.01}};
  static const StyStand across = {
      .perspective = true, .position = {0, 0, 3}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fov = 90};
  StyScene *scene = open_scene();
  add_object(scene, add_cube(*state, scene), wall, 1);
  add_sphere(scene, 0, 0, 100, 1, 1); /* nowhere in the picture */
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  StyImage *by_camera = trace_frame(scene, &across, false), *by_ray = trace_frame(scene, &across, true);
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++) {
      const double u = (x + 0.5) / SIDE * 2 - 1, v = 1 - (y + 0.5) / SIDE * 2, length = sqrt(u * u + v * v + 1);
      assert_true(at(by_camera, "normal.Z", x, y) == 1);
      assert_true(fabs((double)at(by_ray, "normal.Z", x, y) - 1 / length) < 1e-6);
      assert_true((double)at(by_ray, "normal.X", x, y) * u > 0);
      double squared = 0;
      static const char *const normals[] = {"normal.X", "normal.Y", "normal.Z"};
      for (int k = 0; k < 3; k++) squared += pow((double)at(by_ray, normals[k], x, y), 2);
      assert_true(fabs(squared - 1) < 1e-6);
    }
  sty_destroy_image(&by_camera);
  sty_destroy_image(&by_ray);
  by_camera = trace_frame(scene, &IN_FRONT, false);
  by_ray = trace_frame(scene, &IN_FRONT, true);
  assert_memory_equal(by_camera->data, by_ray->data, 4 * sty_count_pixels(by_ray) * sizeof *by_ray->data);
  sty_destroy_image(&by_camera);
  sty_destroy_image(&by_ray);
  sty_destroy_scene(&scene);
}

/* ---- light -------------------------------------------------------------------- */

static void add_sun(StyScene *scene, double x, double y, double z, double intensity) {
  const StyLight light = {.direction = {x, y, z}, .intensity = intensity, .colour = {1, 1, 1}};
  assert_int_equal(sty_add_light(scene, &light, NULL), STY_OK);
}

static void add_lamp(StyScene *scene, double x, double y, double z, double intensity) {
  const StyLight light = {.is_point = true, .position = {x, y, z}, .intensity = intensity, .colour = {1, 1, 1}};
  assert_int_equal(sty_add_light(scene, &light, NULL), STY_OK);
}

/* Lambert on a sphere: reflectance times the cosine, and the ambient part everywhere. */
static void test_lambert(void **state) {
  (void)state;
  for (int coloured = 0; coloured < 2; coloured++) {
    StyScene *scene = open_scene();
    add_sphere(scene, 0, 0, 0, 1, 1);
    const double colour[3] = {0.9, 0.3, 0.1}, white[3] = {1, 1, 1};
    memcpy(scene->spheres[0].material.paint.colour, coloured ? colour : white, sizeof colour);
    add_sun(scene, -3, 0, -4, 2);
    scene->ambient = 0.25;
    assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
    StyImage *guide = trace_from(scene, &IN_FRONT);
    const double reflectance = coloured ? 0.2126 * 0.9 + 0.7152 * 0.3 + 0.0722 * 0.1 : 1;
    for (int y = 0; y < SIDE; y++)
      for (int x = 0; x < SIDE; x++) {
        if (at(guide, "A", x, y) == 0) continue;
        const double cosine = (double)at(guide, "normal.X", x, y) * 0.6 + (double)at(guide, "normal.Z", x, y) * 0.8;
        const double expected = reflectance * (0.25 + 2 * fmax(0, cosine));
        assert_true(fabs((double)at(guide, "luma.Y", x, y) - expected) < 2e-6);
        assert_true(at(guide, "albedo.R", x, y) == (coloured ? 0.9f : 1.0f));
      }
    sty_destroy_image(&guide);
    sty_destroy_scene(&scene);
  }
}

/* A point light over a plate of a flattened cube: intensity over the distance squared, times the cosine. */
static void test_point_light(void **state) {
  static const double plate[3][4] = {{4, 0, 0, 0}, {0, 4, 0, 0}, {0, 0, 0.01, -0.01}};
  StyScene *scene = open_scene();
  add_object(scene, add_cube(*state, scene), plate, 1);
  add_lamp(scene, 0.3, -0.2, 1.5, 7);
  scene->ambient = 0;
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  StyImage *guide = trace_from(scene, &IN_FRONT);
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++) {
      const double dx = (x + 0.5) / SIDE * 2 - 1 - 0.3, dy = 1 - (y + 0.5) / SIDE * 2 + 0.2;
      const double squared = dx * dx + dy * dy + 1.5 * 1.5;
      assert_true(fabs((double)at(guide, "luma.Y", x, y) - 7 * 1.5 / pow(squared, 1.5)) < 2e-5);
    }
  sty_destroy_image(&guide);
  sty_destroy_scene(&scene);
}

/* The shadow that a ball above a plate throws straight down is a disc of its radius, to the pixel; a light behind
 * things reaches nothing; without shadows everything is lit. */
static void test_shadows(void **state) {
  static const double plate[3][4] = {{4, 0, 0, 0}, {0, 4, 0, 0}, {0, 0, 0.01, -0.01}};
  static const StyStand above = {.position = {0, 0, 0.5}, .target = {0, 0, 0}, .up = {0, 1, 0}, .height = 2};
  for (int shadows = 0; shadows < 2; shadows++) {
    StyScene *scene = open_scene();
    add_object(scene, add_cube(*state, scene), plate, 1);
    add_sphere(scene, 0.1, 0.2, 3, 0.6, 1); /* behind the camera */
    add_sun(scene, 0, 0, -1, 1);
    add_sun(scene, 0, 0, 1, 1);
    scene->ambient = 0;
    scene->shadows = shadows;
    assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
    StyImage *guide = trace_from(scene, &above);
    int dark = 0;
    for (int y = 0; y < SIDE; y++)
      for (int x = 0; x < SIDE; x++) {
        const double dx = (x + 0.5) / SIDE * 2 - 1 - 0.1, dy = 1 - (y + 0.5) / SIDE * 2 - 0.2;
        const double beyond = sqrt(dx * dx + dy * dy) - 0.6;
        if (fabs(beyond) < 1e-4) continue;
        const bool hidden = shadows && beyond < 0;
        dark += hidden;
        assert_true(at(guide, "luma.Y", x, y) == (hidden ? 0.0f : 1.0f));
      }
    assert_true(shadows ? dark > 2000 : dark == 0);
    sty_destroy_image(&guide);
    sty_destroy_scene(&scene);
  }
}

/* A surface doesn't stand in its own light: no dark specks on a lit sphere far from the terminator. */
static void test_no_acne(void **state) {
  StyScene *scene = open_scene();
  const int cube = add_cube(*state, scene);
  add_sphere(scene, 1e6, 0, 0, 1, 1);
  for (int i = 0; i < 20; i++) {
    const double transform[3][4] = {{0.3, 0.1 * sin(i), 0, 1e6 + cos(i * 1.7) * 4},
                                    {0, 0.3, 0, sin(i * 2.3) * 4},
                                    {0.1, 0, 0.3, -3 + cos(i * 0.9)}};
    add_object(scene, cube, transform, 1);
  }
  add_sun(scene, 0, 0, -1, 1);
  scene->ambient = 0;
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  const StyStand stand = {.position = {1e6, 0, 50}, .target = {1e6, 0, 0}, .up = {0, 1, 0}, .height = 10};
  StyImage *guide = trace_from(scene, &stand);
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++)
      if (at(guide, "A", x, y) > 0) assert_true(fabsf(at(guide, "luma.Y", x, y) - at(guide, "normal.Z", x, y)) < 1e-5f);
  sty_destroy_image(&guide);
  sty_destroy_scene(&scene);
}

/* The highlight of Blinn and Phong beside its formula. */
static void test_highlight(void **state) {
  (void)state;
  StyScene *scene = open_scene();
  add_sphere(scene, 0, 0, 0, 1, 1);
  scene->spheres[0].material = (StyMaterial){.paint = {{0, 0, 0}, -1}, .specular = 0.5, .shininess = 20};
  add_sun(scene, -3, 0, -4, 2);
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  StyImage *guide = trace_from(scene, &IN_FRONT);
  const double length = sqrt(0.6 * 0.6 + 1.8 * 1.8);
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++) {
      if (at(guide, "A", x, y) == 0) continue;
      const double nx = (double)at(guide, "normal.X", x, y), nz = (double)at(guide, "normal.Z", x, y);
      const double lit = nx * 0.6 + nz * 0.8 > 0 ? 0.5 * 2 * pow(fmax(0, (nx * 0.6 + nz * 1.8) / length), 20) : 0;
      if (fabs(nx * 0.6 + nz * 0.8) > 1e-6) assert_true(fabs((double)at(guide, "luma.Y", x, y) - lit) < 1e-5);
    }
  sty_destroy_image(&guide);
  sty_destroy_scene(&scene);
}

/* The same bytes on any number of threads. */
static void test_threads(void **state) {
  StyScene *scene = open_scene();
  const int cube = add_cube(*state, scene);
  for (int i = 0; i < 50; i++) {
    const double transform[3][4] = {
        {0.3, 0.1 * sin(i), 0, cos(i * 1.7) * 4}, {0, 0.3, 0, sin(i * 2.3) * 4}, {0.1, 0, 0.3, cos(i * 0.9)}};
    add_object(scene, cube, transform, i % 4);
    add_sphere(scene, cos(i * 2.9) * 4, sin(i * 1.1) * 4, sin(i * 3.3), 0.25, i % 3);
  }
  add_sun(scene, 1, -2, -3, 1);
  add_lamp(scene, 0, 6, 2, 9);
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  StyCamera camera;
  const StyView view = {.azimuth = 20, .elevation = 30, .perspective = true, .fov = 50};
  assert_int_equal(sty_fit_camera(scene, &view, SIDE, SIDE, &camera, NULL), STY_OK);
  StyImage *first = NULL;
  for (int threads = 1; threads <= 4; threads++) {
    StyImage *guide = NULL;
    const StyTraceOptions options = {.width = SIDE, .height = SIDE, .groups = ALL, .contour = {1, 1}};
    const StyRun run = {.threads = threads};
    assert_int_equal(sty_trace_guide(scene, &camera, &options, &run, NULL, &guide, NULL), STY_OK);
    if (!first) {
      first = guide;
      continue;
    }
    assert_memory_equal(first->data, guide->data,
                        (size_t)guide->channel_count * sty_count_pixels(guide) * sizeof *guide->data);
    sty_destroy_image(&guide);
  }
  sty_destroy_image(&first);
  sty_destroy_scene(&scene);
}

static void test_refused(void **state) {
  (void)state;
  StyScene *scene = open_scene();
  assert_int_equal(sty_finish_scene(scene, NULL), STY_ERROR_INPUT);
  const StySphere none = {.radius = 0}, odd = {.radius = NAN}, far = {.centre = {1e31, 0, 0}, .radius = 1};
  assert_int_equal(sty_add_sphere(scene, &none, NULL), STY_ERROR_INPUT);
  assert_int_equal(sty_add_sphere(scene, &odd, NULL), STY_ERROR_INPUT);
  assert_int_equal(sty_add_sphere(scene, &far, NULL), STY_OK);
  assert_int_equal(sty_finish_scene(scene, NULL), STY_ERROR_INPUT);
  const StyLight aimless = {.intensity = 1};
  assert_int_equal(sty_add_light(scene, &aimless, NULL), STY_ERROR_INPUT);
  for (int i = 0; i < STY_MOST_LIGHTS; i++) add_lamp(scene, i, 0, 0, 1);
  const StyLight lamp = {.is_point = true};
  assert_int_equal(sty_add_light(scene, &lamp, NULL), STY_ERROR_INPUT);
  sty_destroy_scene(&scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_sphere_is_exact),
      cmocka_unit_test(test_inside_a_sphere),
      cmocka_unit_test(test_instances),
      cmocka_unit_test(test_mirror),
      cmocka_unit_test(test_ids),
      cmocka_unit_test(test_threads),
      cmocka_unit_test(test_ray_frame),
      cmocka_unit_test(test_lambert),
      cmocka_unit_test(test_point_light),
      cmocka_unit_test(test_shadows),
      cmocka_unit_test(test_growing_sphere),
      cmocka_unit_test(test_no_acne),
      cmocka_unit_test(test_highlight),
      cmocka_unit_test(test_refused),
  };
  return cmocka_run_group_tests(tests, open_scratch, close_scratch);
}
