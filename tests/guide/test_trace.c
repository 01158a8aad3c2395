#include <math.h>

#include "../scene/scratch.h"
#include "stylut/guide.h"
#include "stylut/version.h"

static const unsigned ALL = STY_GUIDE_NORMAL | STY_GUIDE_DEPTH | STY_GUIDE_POSITION | STY_GUIDE_OBJECT |
                            STY_GUIDE_STYLE | STY_GUIDE_ALBEDO | STY_GUIDE_LUMA;

typedef struct Planes {
  const float *coverage, *normal[3], *depth, *position[3], *object;
} Planes;

static Planes get_planes(const StyImage *guide) {
  static const char *const NORMAL[3] = {"normal.X", "normal.Y", "normal.Z"};
  static const char *const POSITION[3] = {"position.X", "position.Y", "position.Z"};
  Planes planes = {.coverage = sty_find_channel(guide, "A"),
                   .depth = sty_find_channel(guide, "depth.Z"),
                   .object = sty_find_channel(guide, "object.I")};
  for (int k = 0; k < 3; k++) {
    planes.normal[k] = sty_find_channel(guide, NORMAL[k]);
    planes.position[k] = sty_find_channel(guide, POSITION[k]);
  }
  return planes;
}

static StyImage *trace(const StyScene *scene, const StyView *view, int width, int height, bool flat, int threads) {
  StyCamera camera;
  StyImage *guide = NULL;
  StyError error = {STY_OK, ""};
  const StyTraceOptions options = {.width = width, .height = height, .groups = ALL, .flat = flat, .contour = {1, 1}};
  const StyRun run = {.threads = threads};
  if (sty_fit_camera(scene, view, width, height, &camera, &error) != STY_OK ||
      sty_trace_guide(scene, &camera, &options, &run, NULL, &guide, &error) != STY_OK)
    fail_msg("%s", error.text);
  return guide;
}

static StyScene *read_scene(Scratch *scratch, const char *text, double crease_angle) {
  StyScene *scene = NULL;
  StyError error = {STY_OK, ""};
  if (read_text_scene(scratch, "some.obj", text, crease_angle, &scene, &error) != STY_OK) fail_msg("%s", error.text);
  return scene;
}

/* ---- a hemisphere of facets so small that it can stand for the sphere ---- */

/* A chord of angle a lies a*a/8 below the arc, and shifts depth and normal by
 * that much over the normal's z. TOLERANCE bounds the shift along rings and
 * across them, out to LAST_Z, the normal's z half a pixel inside the rim. */
enum { SIDE = 64, MAX_RINGS = 1000, MAX_SECTORS = 4096 };
#define TOLERANCE 3e-6
#define LAST_Z 0.175

typedef struct Ring {
  int sectors;
  uint32_t first; /* vertex */
} Ring;

static double get_step(double z) { return sqrt(8 * fmax(z, LAST_Z) * TOLERANCE); }

static Ring add_ring(StyMesh *mesh, double angle) {
  const double radius = sin(angle), z = cos(angle);
  const int sectors = radius > 0 ? 4 * (int)ceil(radius * M_PI_2 / get_step(z) + 1) : 1;
  const Ring ring = {sectors, (uint32_t)mesh->vertex_count};
  assert_true(sectors <= MAX_SECTORS);
  for (int i = 0; i < sectors; i++) {
    const double turn = 2 * M_PI * i / sectors;
    const double at[3] = {radius * cos(turn), radius * sin(turn), z};
    for (int k = 0; k < 3; k++)
      mesh->positions[3 * mesh->vertex_count + (size_t)k] = mesh->normals[3 * mesh->vertex_count + (size_t)k] =
          (float)at[k];
    mesh->vertex_count++;
  }
  return ring;
}

static void add_triangle(StyMesh *mesh, uint32_t a, uint32_t b, uint32_t c) {
  const uint32_t corners[3] = {a, b, c};
  memcpy(&mesh->indices[3 * mesh->triangle_count], corners, sizeof corners);
  mesh->part_ids[mesh->triangle_count++] = 1;
}

/* Triangles between rings of differing numbers of vertices: always from the
 * ring whose next vertex comes first. */
static void stitch_rings(StyMesh *mesh, Ring inner, Ring outer) {
  int i = 0, o = 0;
  while ((inner.sectors > 1 && i < inner.sectors) || o < outer.sectors) {
    const uint32_t at_i = inner.first + (uint32_t)(i % inner.sectors),
                   at_o = outer.first + (uint32_t)(o % outer.sectors);
    const bool take_inner = inner.sectors > 1 && i < inner.sectors &&
                            (o == outer.sectors || (long)(i + 1) * outer.sectors < (long)(o + 1) * inner.sectors);
    if (take_inner)
      add_triangle(mesh, at_i, at_o, inner.first + (uint32_t)(++i % inner.sectors));
    else
      add_triangle(mesh, at_i, at_o, outer.first + (uint32_t)(++o % outer.sectors));
  }
}

static StyMesh *make_hemisphere(void) {
  const size_t most = (size_t)MAX_RINGS * MAX_SECTORS;
  StyMesh *mesh = calloc(1, sizeof *mesh);
  assert_non_null(mesh);
  mesh->positions = calloc(3 * most + 1, sizeof(float));
  mesh->normals = malloc(3 * most * sizeof(float));
  mesh->indices = malloc(6 * most * sizeof(uint32_t));
  mesh->part_ids = malloc(2 * most * sizeof(uint32_t));
  assert_true(mesh->positions && mesh->normals && mesh->indices && mesh->part_ids);
  mesh->scale = 1;
  mesh->part_count = 1;
  double angle = 0;
  Ring inner = add_ring(mesh, 0);
  while (angle < M_PI_2) {
    angle = fmin(angle + get_step(cos(angle + get_step(cos(angle)))), M_PI_2);
    const Ring outer = add_ring(mesh, angle);
    stitch_rings(mesh, inner, outer);
    inner = outer;
  }
  return mesh;
}

static void test_sphere(void **state) {
  (void)state;
  StyMesh *hemisphere = make_hemisphere();
  StyScene *scene = NULL;
  const size_t triangles = hemisphere->triangle_count;
  assert_int_equal(sty_wrap_mesh(&hemisphere, &scene, NULL), STY_OK);
  StyImage *traced = trace(scene, &(StyView){0}, SIDE, SIDE, false, 0), *exact = NULL;
  assert_int_equal(sty_make_sphere_guide(SIDE, SIDE, ALL, &exact, NULL), STY_OK);
  assert_int_equal(traced->channel_count, exact->channel_count);
  for (int c = 0; c < exact->channel_count; c++) assert_string_equal(traced->names[c], exact->names[c]);
  double worst = 0;
  for (int i = 0; i < SIDE * SIDE; i++) {
    const double x = (i % SIDE + 0.5) / SIDE * 2 - 1, y = 1 - (i / SIDE + 0.5) / SIDE * 2;
    if (fabs(sqrt(x * x + y * y) - 1) < 1.0 / SIDE) continue;
    for (int c = 0; c < exact->channel_count; c++) {
      const float found = traced->data[c * SIDE * SIDE + i], expected = exact->data[c * SIDE * SIDE + i];
      if (isinf(expected) || isinf(found))
        assert_true(found == expected);
      else
        worst = fmax(worst, fabs((double)found - expected));
    }
  }
  print_message("%zu triangles, largest difference %.2g\n", triangles, worst);
  assert_true(worst < 1e-5);
  sty_destroy_image(&traced);
  sty_destroy_image(&exact);
  sty_destroy_scene(&scene);
}

/* ---- the rest sees cubes ---- */

static const StyView THREE_QUARTER = {35, 20, false, 0, 0.05, STY_UP_Y},
                     PERSPECTIVE = {35, 20, true, 50, 0.05, STY_UP_Y};

static void test_threads_give_the_same_bytes(void **state) {
  static const StyView *const VIEWS[] = {&THREE_QUARTER, &PERSPECTIVE};
  StyScene *scene = read_scene(*state, CUBE_OBJ, 180);
  for (int v = 0; v < 2; v++) {
    StyImage *first = trace(scene, VIEWS[v], 201, 133, false, 1);
    for (int threads = 2; threads <= 3; threads++) {
      StyImage *other = trace(scene, VIEWS[v], 201, 133, false, threads);
      assert_memory_equal(first->data, other->data,
                          sty_count_pixels(first) * (size_t)first->channel_count * sizeof(float));
      sty_destroy_image(&other);
    }
    sty_destroy_image(&first);
  }
  sty_destroy_scene(&scene);
}

static int count_distinct_normals(const StyImage *guide) {
  const Planes p = get_planes(guide);
  float seen[64][3];
  int count = 0;
  for (size_t i = 0; i < sty_count_pixels(guide); i++) {
    if (p.coverage[i] == 0) continue;
    int s = 0;
    while (s < count && (fabsf(seen[s][0] - p.normal[0][i]) > 1e-5f || fabsf(seen[s][1] - p.normal[1][i]) > 1e-5f ||
                         fabsf(seen[s][2] - p.normal[2][i]) > 1e-5f))
      s++;
    if (s < count || count == 64) continue;
    for (int k = 0; k < 3; k++) seen[count][k] = p.normal[k][i];
    count++;
  }
  return count;
}

static void test_flat_and_crease(void **state) {
  StyScene *smooth = read_scene(*state, CUBE_OBJ, 180), *sharp = read_scene(*state, CUBE_OBJ, 30);
  StyImage *flat = trace(smooth, &THREE_QUARTER, 64, 64, true, 0);
  StyImage *shaded = trace(smooth, &THREE_QUARTER, 64, 64, false, 0);
  StyImage *creased = trace(sharp, &THREE_QUARTER, 64, 64, false, 0);
  assert_int_equal(count_distinct_normals(flat), 3);
  assert_int_equal(count_distinct_normals(creased), 3);
  assert_true(count_distinct_normals(shaded) > 60);
  sty_destroy_image(&flat);
  sty_destroy_image(&shaded);
  sty_destroy_image(&creased);
  sty_destroy_scene(&smooth);
  sty_destroy_scene(&sharp);
}

/* Normals are of unit length and never face away from their ray; the pixel's
 * ray leads to its position, at its depth. */
static void test_normals_face_the_eye(void **state) {
  StyScene *scene = read_scene(*state, CUBE_OBJ, 180);
  enum { WIDTH = 90, HEIGHT = 60 };
  StyImage *guide = trace(scene, &PERSPECTIVE, WIDTH, HEIGHT, false, 0);
  StyCamera camera;
  assert_int_equal(sty_fit_camera(scene, &PERSPECTIVE, WIDTH, HEIGHT, &camera, NULL), STY_OK);
  const Planes p = get_planes(guide);
  int covered = 0, bent = 0;
  for (int i = 0; i < WIDTH * HEIGHT; i++) {
    if (p.coverage[i] == 0) continue;
    const double s = ((i % WIDTH + 0.5) / WIDTH * 2 - 1) * camera.half_width;
    const double t = (1 - (i / WIDTH + 0.5) / HEIGHT * 2) * camera.half_height;
    const double n[3] = {p.normal[0][i], p.normal[1][i], p.normal[2][i]};
    const double toward = (n[2] - s * n[0] - t * n[1]) / sqrt(1 + s * s + t * t);
    assert_true(fabs(sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) - 1) < 1e-6);
    assert_true(toward > -1e-6);
    bent += toward < 1e-6;
    covered++;
    for (int k = 0; k < 3; k++) {
      const double on_ray = camera.eye[k] + p.depth[i] * (s * camera.right[k] + t * camera.up[k] - camera.back[k]);
      assert_true(fabs(on_ray - p.position[k][i]) < 1e-5);
    }
  }
  assert_true(covered > WIDTH * HEIGHT / 10);
  assert_true(bent < covered / 2);
  sty_destroy_image(&guide);
  sty_destroy_scene(&scene);
}

/* Facing the viewer from either side, whatever the winding and the normals. */
static void test_sides(void **state) {
  static const char QUAD[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 %d\nf %s\n";
  static const char *const FACES[] = {"1//1 2//1 3//1 4//1", "4//1 3//1 2//1 1//1"};
  for (int c = 0; c < 8; c++) {
    char text[256];
    snprintf(text, sizeof text, QUAD, c & 1 ? 1 : -1, FACES[c >> 1 & 1]);
    StyScene *scene = read_scene(*state, text, -1);
    StyImage *guide = trace(scene, &(StyView){.azimuth = c & 4 ? 180 : 0}, 8, 8, false, 1);
    const Planes p = get_planes(guide);
    for (int i = 0; i < 64; i++) assert_true(p.coverage[i] == 1 && p.normal[2][i] == 1 && p.depth[i] == 0);
    sty_destroy_image(&guide);
    sty_destroy_scene(&scene);
  }
}

/* Size and place of a mesh don't change what it looks like. */
static void test_tiny_and_far_meshes(void **state) {
  static const struct { double at, edge; } CASES[] = {{0, 1}, {0, 1e-24}, {1e8, 1024}, {0, 1e29}};
  StyImage *first = NULL;
  for (size_t c = 0; c < sizeof CASES / sizeof *CASES; c++) {
    char text[1024];
    print_tetrahedron(text, sizeof text, CASES[c].at, CASES[c].edge);
    StyScene *scene = read_scene(*state, text, 30);
    StyImage *guide = trace(scene, &THREE_QUARTER, 50, 50, false, 0);
    if (!first) first = guide;
    const Planes p = get_planes(guide), q = get_planes(first);
    for (int i = 0; i < 2500; i++) {
      assert_true(p.coverage[i] == q.coverage[i]);
      if (p.coverage[i] == 0) continue;
      for (int k = 0; k < 3; k++) {
        assert_true(fabsf(p.normal[k][i] - q.normal[k][i]) < 1e-5f);
        assert_true(fabs(p.position[k][i] - CASES[c].at - q.position[k][i] * CASES[c].edge) <=
                    1e-5 * CASES[c].edge + 1e-7 * CASES[c].at);
      }
      assert_true(fabs(p.depth[i] - q.depth[i] * CASES[c].edge) <= 1e-5 * CASES[c].edge);
    }
    if (guide != first) sty_destroy_image(&guide);
    sty_destroy_scene(&scene);
  }
  sty_destroy_image(&first);
}

/* Two squares, one behind the other. */
static void test_objects_and_depth(void **state) {
  StyScene *scene = read_scene(*state,
                               "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                               "o back\nf 1 2 3 4\no front\nf 5 6 7 8\n",
                               -1);
  assert_int_equal(scene->meshes[0]->part_count, 2);
  StyImage *guide = trace(scene, &(StyView){0}, 16, 16, false, 1);
  const Planes p = get_planes(guide);
  for (int i = 0; i < 256; i++) {
    const bool front = i % 16 < 8 && i / 16 >= 8;
    assert_true(p.object[i] == (front ? 2 : 1) && p.depth[i] == (front ? 0 : 1));
  }
  sty_destroy_image(&guide);
  sty_destroy_scene(&scene);
}

static void test_only_what_is_asked_for(void **state) {
  StyScene *scene = read_scene(*state, CUBE_OBJ, -1);
  StyCamera camera;
  assert_int_equal(sty_fit_camera(scene, &THREE_QUARTER, 33, 17, &camera, NULL), STY_OK);
  StyTraceTimes times = {.build_ms = -1, .first_ms = -1, .trace_ms = -1};
  for (unsigned groups = 0; groups <= ALL; groups++) {
    StyImage *guide = NULL;
    const StyTraceOptions options = {.width = 33, .height = 17, .groups = groups, .contour = {1, 1}};
    assert_int_equal(sty_trace_guide(scene, &camera, &options, NULL, &times, &guide, NULL), STY_OK);
    assert_int_equal(guide->channel_count, 1 + 3 * (groups & 1) + (groups >> 1 & 1) + 3 * (groups >> 2 & 1) +
                                               (groups >> 3 & 1) + (groups >> 4 & 1) + 3 * (groups >> 5 & 1) +
                                               (groups >> 6));
    assert_true(times.build_ms >= 0 && times.trace_ms >= 0);
    sty_destroy_image(&guide);
  }
  sty_destroy_scene(&scene);
}

static void test_bad_arguments(void **state) {
  StyScene *scene = read_scene(*state, CUBE_OBJ, -1);
  StyCamera camera;
  StyImage *guide = NULL;
  assert_int_equal(sty_fit_camera(scene, &THREE_QUARTER, 8, 8, &camera, NULL), STY_OK);
  const StyTraceOptions options = {.width = 8, .height = 8, .groups = ALL},
                        empty = {.width = 0, .height = 8, .groups = ALL},
                        unknown = {.width = 8, .height = 8, .groups = 1u << 20};
  assert_int_equal(sty_trace_guide(scene, &camera, &empty, NULL, NULL, &guide, NULL), STY_ERROR_INPUT);
  assert_int_equal(sty_trace_guide(scene, &camera, &unknown, NULL, NULL, &guide, NULL), STY_ERROR_USAGE);
  camera.eye[1] = NAN;
  assert_int_equal(sty_trace_guide(scene, &camera, &options, NULL, NULL, &guide, NULL), STY_ERROR_USAGE);
  camera.eye[1] = 1e30;
  assert_int_equal(sty_trace_guide(scene, &camera, &options, NULL, NULL, &guide, NULL), STY_ERROR_USAGE);
  assert_null(guide);
  sty_destroy_scene(&scene);
  assert_int_equal(strncmp(sty_get_ray_library_version(), "Embree 3.", 9), 0);
}

/* ---- what is told while it lasts ---- */

static void note_stage(void *context, const char *name) {
  strcat(context, name);
  strcat(context, " ");
}

static void test_stages(void **state) {
  StyScene *scene = read_scene(*state, CUBE_OBJ, 30);
  StyCamera camera;
  StyImage *guide = NULL;
  char stages[64] = "";
  const StyView view = {.margin = 0.1};
  const StyTraceOptions options = {.width = 8, .height = 8, .groups = STY_GUIDE_NORMAL};
  const StyRun run = {.stage = note_stage, .context = stages};
  assert_int_equal(sty_fit_camera(scene, &view, 8, 8, &camera, NULL), STY_OK);
  assert_int_equal(sty_trace_guide(scene, &camera, &options, &run, NULL, &guide, NULL), STY_OK);
  assert_string_equal(stages, "building tracing ");
  sty_destroy_image(&guide);
  sty_destroy_scene(&scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_sphere),
      cmocka_unit_test(test_threads_give_the_same_bytes),
      cmocka_unit_test(test_flat_and_crease),
      cmocka_unit_test(test_normals_face_the_eye),
      cmocka_unit_test(test_sides),
      cmocka_unit_test(test_tiny_and_far_meshes),
      cmocka_unit_test(test_objects_and_depth),
      cmocka_unit_test(test_only_what_is_asked_for),
      cmocka_unit_test(test_bad_arguments),
      cmocka_unit_test(test_stages),
  };
  return cmocka_run_group_tests(tests, open_scratch, close_scratch);
}
