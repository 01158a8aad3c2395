/* What surfaces carry from pixel to pixel: texture coordinates, textures, curvature, outlines, motion. */
#include <math.h>

#include "../scene/scratch.h"
#include "stylut/guide.h"
#include "stylut/image_io.h"

enum { SIDE = 64 };
static const StyStand IN_FRONT = {.position = {0, 0, 5}, .target = {0, 0, 0}, .up = {0, 1, 0}, .height = 2};

static StyScene *open_scene(void) {
  StyScene *scene = NULL;
  assert_int_equal(sty_create_scene(&scene, NULL), STY_OK);
  return scene;
}

static int add_mesh(Scratch *scratch, StyScene *scene, const char *text, double crease) {
  StyMesh *mesh = NULL;
  int number = -1;
  assert_int_equal(read_text_mesh(scratch, "mesh.obj", text, crease, &mesh, NULL), STY_OK);
  assert_int_equal(sty_add_mesh(scene, &mesh, &number, NULL), STY_OK);
  return number;
}

static StyObject *add_object(StyScene *scene, int mesh, double x, double y, double z) {
  StyObject object = {.mesh = mesh, .style = 1, .material = sty_white};
  memcpy(object.transform, sty_identity, sizeof object.transform);
  const double to[3] = {x, y, z};
  for (int k = 0; k < 3; k++) object.transform[k][3] = to[k];
  assert_int_equal(sty_add_object(scene, &object, NULL), STY_OK);
  return &scene->objects[scene->object_count - 1];
}

static void add_sphere(StyScene *scene, double x, double y, double z, double radius) {
  const StySphere sphere = {.centre = {x, y, z}, .radius = radius, .style = 1, .material = sty_white};
  assert_int_equal(sty_add_sphere(scene, &sphere, NULL), STY_OK);
}

static StyCamera place(const StyScene *scene, const StyStand *stand, const StyTraceOptions *options) {
  StyCamera camera;
  StyError error = {STY_OK, ""};
  if (sty_place_camera(scene, stand, options->width, options->height, &camera, &error)) fail_msg("%s", error.text);
  return camera;
}

static StyImage *trace(const StyScene *scene, const StyStand *stand, const StyTraceOptions *options) {
  const StyCamera camera = place(scene, stand, options);
  StyImage *guide = NULL;
  StyError error = {STY_OK, ""};
  if (sty_trace_guide(scene, &camera, options, NULL, NULL, &guide, &error)) fail_msg("%s", error.text);
  return guide;
}

static double at(const StyImage *guide, const char *channel, int x, int y) {
  const float *plane = sty_find_channel(guide, channel);
  assert_non_null(plane);
  return (double)plane[y * guide->width + x];
}

static void close_all(StyScene **scene, StyImage **guide) {
  sty_destroy_image(guide);
  sty_destroy_scene(scene);
}

/* ---- texture coordinates and textures ------------------------------------------- */

/* Fills the film of IN_FRONT; u and v go from 0 to `repeats`. */
static int add_quad(Scratch *scratch, StyScene *scene, double repeats) {
  char text[512];
  snprintf(text, sizeof text,
           "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt %g 0\nvt %g %g\nvt 0 %g\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n",
           repeats, repeats, repeats, repeats);
  return add_mesh(scratch, scene, text, -1);
}

static void test_uv(void **state) {
  StyScene *scene = open_scene();
  add_object(scene, add_quad(*state, scene, 1), 0, 0, 0);
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  const StyTraceOptions options = {.width = SIDE, .height = SIDE, .groups = STY_GUIDE_UV};
  StyImage *guide = trace(scene, &IN_FRONT, &options);
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++) {
      assert_true(fabs(at(guide, "uv.U", x, y) - (x + 0.5) / SIDE) < 1e-6);
      assert_true(fabs(at(guide, "uv.V", x, y) - (1 - (y + 0.5) / SIDE)) < 1e-6);
    }
  close_all(&scene, &guide);
}

/* A sphere's are longitude and latitude, and those of `guide sphere`. */
static void test_uv_of_spheres(void **state) {
  (void)state;
  StyScene *scene = open_scene();
  StyImage *exact = NULL;
  add_sphere(scene, 0, 0, 0, 1);
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  const StyTraceOptions options = {.width = SIDE, .height = SIDE, .groups = STY_GUIDE_UV};
  StyImage *guide = trace(scene, &IN_FRONT, &options);
  assert_int_equal(sty_make_sphere_guide(SIDE, SIDE, STY_GUIDE_UV, &exact, NULL), STY_OK);
  for (size_t i = 0; i < 3 * sty_count_pixels(guide); i++)
    assert_true(fabs((double)guide->data[i] - (double)exact->data[i]) < 1e-4);
  assert_true(at(guide, "uv.V", SIDE / 2, 1) > 0.9 && at(guide, "uv.U", SIDE - 3, SIDE / 2) > 0.65);
  sty_destroy_image(&exact);
  close_all(&scene, &guide);
}

static double decode(double value) { return value <= 0.04045 ? value / 12.92 : pow((value + 0.055) / 1.055, 2.4); }

/* A picture whose every texel differs; the caller unlinks it. */
static const char *write_texture(Scratch *scratch, const char *name, int side, int bits, StyImage **out) {
  static const char *const names[] = {"R", "G", "B"};
  assert_int_equal(sty_create_image(side, side, 3, names, bits, out, NULL), STY_OK);
  for (int c = 0; c < 3; c++)
    for (int i = 0; i < side * side; i++)
      (*out)->data[c * side * side + i] = (float)((7 * i + 83 * c) % 256) / (bits == 32 ? 64.0f : 255.0f);
  snprintf(scratch->path, sizeof scratch->path, "%s/%s", scratch->folder, name);
  assert_int_equal(sty_write_image(scratch->path, *out, NULL), STY_OK);
  return scratch->path;
}

static StyImage *trace_textured(Scratch *scratch, const char *texture, double repeats, int side, bool nearest) {
  StyScene *scene = open_scene();
  StyObject *object = add_object(scene, add_quad(scratch, scene, repeats), 0, 0, 0);
  object->is_painted = true;
  object->material.paint.colour[1] = 0.5;
  assert_int_equal(sty_add_texture(scene, texture, NULL, &object->material.paint.texture, NULL), STY_OK);
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  const StyTraceOptions options = {
      .width = side, .height = side, .groups = STY_GUIDE_ALBEDO, .nearest_texels = nearest};
  StyImage *guide = trace(scene, &IN_FRONT, &options);
  sty_destroy_scene(&scene);
  return guide;
}

/* Where a pixel's centre is a texel's, both filters give it: row 0 at v = 1, scene-linear, times the colour. */
static void check_texels(Scratch *scratch, const char *name, int bits, int repeats) {
  StyImage *texture = NULL;
  const int side = SIDE / repeats;
  char *path = strdup(write_texture(scratch, name, side, bits, &texture));
  for (int nearest = 0; nearest <= 1; nearest++) {
    StyImage *guide = trace_textured(scratch, path, repeats, SIDE, nearest);
    static const char *const names[] = {"albedo.R", "albedo.G", "albedo.B"};
    for (int c = 0; c < 3; c++)
      for (int i = 0; i < SIDE * SIDE; i++) {
        const int x = i % SIDE, y = i / SIDE, texel = y % side * side + x % side;
        const double value = (double)texture->data[c * side * side + texel];
        const double expected = (bits == 32 ? value : decode(value)) * (c == 1 ? 0.5 : 1);
        assert_true(fabs(at(guide, names[c], x, y) - expected) < (nearest ? 1e-6 : 2e-4) * fmax(1, expected));
      }
    sty_destroy_image(&guide);
  }
  unlink(path);
  free(path);
  sty_destroy_image(&texture);
}

static void test_texels(void **state) {
  check_texels(*state, "byte.png", 8, 1);
  check_texels(*state, "word.png", 16, 1);
  check_texels(*state, "float.exr", 32, 1);
  check_texels(*state, "again.png", 8, 4);
}

/* Between texels' centres, bilinear goes straight in scene-linear light, where nearest steps. */
static void test_between_texels(void **state) {
  Scratch *scratch = *state;
  StyImage *texture = NULL;
  static const char *const names[] = {"R", "G", "B"};
  assert_int_equal(sty_create_image(2, 1, 3, names, 8, &texture, NULL), STY_OK);
  for (int c = 0; c < 3; c++) texture->data[2 * c + 1] = 1; /* black, white */
  snprintf(scratch->path, sizeof scratch->path, "%s/two.png", scratch->folder);
  char *path = strdup(scratch->path);
  assert_int_equal(sty_write_image(path, texture, NULL), STY_OK);
  StyImage *smooth = trace_textured(scratch, path, 1, SIDE, false),
           *hard = trace_textured(scratch, path, 1, SIDE, true);
  for (int x = SIDE / 4; x < 3 * SIDE / 4; x++) {
    const double u = (x + 0.5) / SIDE;
    assert_true(fabs(at(smooth, "albedo.R", x, 3) - (u * 2 - 0.5)) < 0.005); /* the library's steps are 1/256 */
    assert_true(at(hard, "albedo.R", x, 3) == (u > 0.5));
  }
  unlink(path);
  free(path);
  sty_destroy_image(&texture);
  sty_destroy_image(&smooth);
  sty_destroy_image(&hard);
}

/* The mesh file's own materials, part by part; the object's paint covers them. */
static void test_materials(void **state) {
  Scratch *scratch = *state;
  static const char library[] = "newmtl red\nKd 0.75 0.25 0.125\nnewmtl skin\nKd 1 1 1\nmap_Kd skin.png\n";
  static const char text[] =
      "mtllib two.mtl\nv -1 -1 0\nv 0 -1 0\nv 0 1 0\nv -1 1 0\nv 1 -1 0\nv 1 1 0\nvt 0.5 0.5\n"
      "usemtl red\nf 1/1 2/1 3/1 4/1\nusemtl skin\nf 2/1 5/1 6/1 3/1\n";
  StyImage *texture = NULL, *guide = NULL;
  char *files[2] = {strdup(write_texture(scratch, "skin.png", 1, 8, &texture)),
                    strdup(write_bytes(scratch, "two.mtl", library, strlen(library)))};
  for (int painted = 0; painted <= 1; painted++) {
    StyScene *scene = open_scene();
    StyObject *object = add_object(scene, add_mesh(scratch, scene, text, -1), 0, 0, 0);
    object->is_painted = painted;
    assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
    assert_int_equal(scene->texture_count, 1);
    const StyTraceOptions options = {.width = SIDE, .height = SIDE, .groups = STY_GUIDE_ALBEDO};
    if (painted) unlink(files[0]); /* not asked for */
    guide = trace(scene, &IN_FRONT, &options);
    assert_true(fabs(at(guide, "albedo.R", 9, 9) - (painted ? 1 : 0.75)) < 1e-6);
    assert_true(fabs(at(guide, "albedo.G", 9, 9) - (painted ? 1 : 0.25)) < 1e-6);
    assert_true(fabs(at(guide, "albedo.G", SIDE - 9, 9) - (painted ? 1 : decode(83 / 255.0))) < 1e-6);
    close_all(&scene, &guide);
  }
  for (int i = 0; i < 2; i++) {
    unlink(files[i]);
    free(files[i]);
  }
  sty_destroy_image(&texture);
}

static void test_bad_textures(void **state) {
  Scratch *scratch = *state;
  StyScene *scene = open_scene();
  StyObject *object = add_object(scene, add_quad(scratch, scene, 1), 0, 0, 0);
  StyImage *guide = NULL;
  StyError error;
  object->is_painted = true;
  assert_int_equal(sty_add_texture(scene, write_bytes(scratch, "no.png", "no picture", 10), "wall.json",
                                   &object->material.paint.texture, NULL),
                   STY_OK);
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  StyTraceOptions options = {.width = 8, .height = 8, .groups = STY_GUIDE_LUMA};
  const StyCamera camera = place(scene, &IN_FRONT, &options);
  assert_int_equal(sty_trace_guide(scene, &camera, &options, NULL, NULL, &guide, &error), STY_ERROR_INPUT);
  assert_non_null(strstr(error.text, "wall.json: "));
  assert_non_null(strstr(error.text, "no.png: found"));
  unlink(scratch->path);
  assert_int_equal(sty_trace_guide(scene, &camera, &options, NULL, NULL, &guide, &error), STY_ERROR_FILE);
  options.groups = STY_GUIDE_NORMAL; /* needs no texture */
  assert_int_equal(sty_trace_guide(scene, &camera, &options, NULL, NULL, &guide, &error), STY_OK);
  close_all(&scene, &guide);
}

/* A square from -1 to 1 in a glTF file that holds its picture, a file of its own, as base64 text. */
static const char GLTF[] =
    "{\"asset\": {\"version\": \"2.0\"}, \"scene\": 0, \"scenes\": [{\"nodes\": [0]}], \"nodes\": [{\"mesh\": 0}],"
    "\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0, \"TEXCOORD_0\": 1}, \"indices\": 2, "
    "\"material\": "
    "0}]}],"
    "\"materials\": [{\"pbrMetallicRoughness\": {\"baseColorTexture\": {\"index\": 0}}}], \"textures\": [{\"source\": "
    "0}],"
    "\"images\": [{\"uri\": \"data:image/png;base64,%s\"}],"
    "\"accessors\": [{\"bufferView\": 0, \"componentType\": 5126, \"count\": 4, \"type\": \"VEC3\","
    "\"min\": [-1, -1, 0], \"max\": [1, 1, 0]},"
    "{\"bufferView\": 1, \"componentType\": 5126, \"count\": 4, \"type\": \"VEC2\"},"
    "{\"bufferView\": 2, \"componentType\": 5123, \"count\": 6, \"type\": \"SCALAR\"}],"
    "\"bufferViews\": [{\"buffer\": 0, \"byteOffset\": 0, \"byteLength\": 48},"
    "{\"buffer\": 0, \"byteOffset\": 48, \"byteLength\": 32}, {\"buffer\": 0, \"byteOffset\": 80, \"byteLength\": 12}],"
    "\"buffers\": [{\"byteLength\": 92, \"uri\": \"data:application/octet-stream;base64,"
    "AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAACAPwAAgD8AAAAAAACAvwAAgD8AAAAAAAAAAAAAgD8AAIA/AACAPwAAgD8AAAAAAAAAAAAAAAAAAAEA"
    "AgAAAAIAAwA=\"}]}";

/* Of 2x2 pixels: red, green; blue, white. */
static const char PICTURE[] =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAEklEQVR4nGP4z8DAAMIM/4EAAB/uBfsL2WiLAAAAAElFTkSuQmCC";

/* A scene of that square, with whatever picture inside. */
static StyScene *open_gltf(Scratch *scratch, const char *picture) {
  char *text = NULL;
  StyScene *scene = NULL;
  StyError error;
  assert_true(asprintf(&text, GLTF, picture) > 0);
  if (read_text_scene(scratch, "inside.gltf", text, -1, &scene, &error)) fail_msg("%s", error.text);
  free(text);
  return scene;
}

static void test_pictures_inside_files(void **state) {
  static const double colours[2][2][3] = {{{1, 0, 0}, {0, 1, 0}}, {{0, 0, 1}, {1, 1, 1}}};
  static const char *const channels[] = {"albedo.R", "albedo.G", "albedo.B"};
  StyScene *scene = open_gltf(*state, PICTURE);
  const StyTraceOptions options = {.width = SIDE, .height = SIDE, .groups = STY_GUIDE_ALBEDO, .nearest_texels = true};
  StyImage *guide = trace(scene, &IN_FRONT, &options);
  for (int y = 0; y < 2; y++)
    for (int x = 0; x < 2; x++)
      for (int c = 0; c < 3; c++)
        assert_true((double)at(guide, channels[c], 9 + x * (SIDE - 18), 9 + y * (SIDE - 18)) == colours[y][x][c]);
  close_all(&scene, &guide);
}

static void test_bad_pictures_inside_files(void **state) {
  StyScene *scene = open_gltf(*state, "bm8gcGljdHVyZQ==");
  StyTraceOptions options = {.width = 8, .height = 8, .groups = STY_GUIDE_ALBEDO};
  const StyCamera camera = place(scene, &IN_FRONT, &options);
  StyImage *guide = NULL;
  StyError error;
  assert_int_equal(sty_trace_guide(scene, &camera, &options, NULL, NULL, &guide, &error), STY_ERROR_INPUT);
  assert_non_null(strstr(error.text, "inside.gltf: picture 1: found no readable picture"));
  options.groups = STY_GUIDE_NORMAL; /* needs no texture */
  assert_int_equal(sty_trace_guide(scene, &camera, &options, NULL, NULL, &guide, &error), STY_OK);
  close_all(&scene, &guide);
}

/* ---- curvature ------------------------------------------------------------------ */

/* 1/r on a sphere, whatever the scene's size; negative from inside. */
static void test_curvature_of_spheres(void **state) {
  (void)state;
  static const double radii[] = {1, 0.25, 1e6};
  const StyTraceOptions options = {.width = SIDE, .height = SIDE, .groups = STY_GUIDE_CURVATURE};
  for (int i = 0; i < 3; i++) {
    StyScene *scene = open_scene();
    add_sphere(scene, 0, 0, 0, radii[i]);
    assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
    const StyStand stand = {.position = {0, 0, 2 * radii[i]}, .up = {0, 1, 0}, .height = 2 * radii[i]};
    const StyStand inside = {.perspective = true, .target = {0, 0, -1}, .up = {0, 1, 0}, .fov = 90};
    StyImage *guide = trace(scene, &stand, &options), *hollow = trace(scene, &inside, &options);
    assert_true(fabs(at(guide, "curvature.Y", SIDE / 3, SIDE / 3) * radii[i] - 1) < 1e-6);
    assert_true(fabs(at(hollow, "curvature.Y", SIDE / 3, SIDE / 3) * radii[i] + 1) < 1e-6);
    sty_destroy_image(&hollow);
    close_all(&scene, &guide);
  }
}

enum { FACETS = 48 };

/* An open tube of radius 1/2 along y, from -half to half. */
static char *print_tube(double half) {
  char *text = malloc(FACETS * 160);
  size_t used = 0;
  for (int i = 0; i < FACETS; i++) {
    const double x = 0.5 * sin(2 * M_PI * i / FACETS), z = 0.5 * cos(2 * M_PI * i / FACETS);
    used += (size_t)sprintf(text + used, "v %.9g %g %.9g\nv %.9g %g %.9g\n", x, -half, z, x, half, z);
  }
  for (int i = 0; i < FACETS; i++)
    used += (size_t)sprintf(text + used, "f %d %d %d %d\n", 2 * i + 1, (2 * i + 2) % (2 * FACETS) + 1,
                            (2 * i + 3) % (2 * FACETS) + 1, 2 * i + 2);
  return text;
}

/* Of a tube half of 1/r, from its smoothed normals; of a plane 0. */
static void test_curvature_of_meshes(void **state) {
  char *tube = print_tube(0.03); /* triangles as high as wide */
  StyScene *scene = open_scene();
  add_object(scene, add_mesh(*state, scene, tube, 90), 0, 0, 0);
  add_object(scene, add_quad(*state, scene, 1), 0, 0, -3);
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  const StyTraceOptions options = {.width = SIDE, .height = SIDE, .groups = STY_GUIDE_CURVATURE};
  StyImage *guide = trace(scene, &IN_FRONT, &options);
  for (int x = SIDE / 4 + 2; x < 3 * SIDE / 4 - 2; x++)
    assert_true(fabs(at(guide, "curvature.Y", x, SIDE / 2) - 1) < 0.02);
  assert_true(at(guide, "curvature.Y", 3, 3) == 0);
  free(tube);
  close_all(&scene, &guide);
}

/* ---- outlines ------------------------------------------------------------------- */

static StyImage *trace_outline(const StyScene *scene, const StyStand *stand, double depth, double normal) {
  const StyTraceOptions options = {
      .width = SIDE, .height = SIDE, .groups = STY_GUIDE_CONTOUR, .contour = {depth, normal}};
  return trace(scene, stand, &options);
}

/* A slanted plane has none but its silhouette, near and far in perspective as well. */
static void test_planes_have_no_outline(void **state) {
  StyScene *scene = open_scene();
  add_object(scene, add_quad(*state, scene, 1), 0, 0, 0);
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  const StyStand stands[] = {{.position = {4, 3, 2}, .up = {0, 1, 0}, .height = 3},
                             {.perspective = true, .position = {2, 1, 1}, .up = {0, 1, 0}, .fov = 60}};
  for (int s = 0; s < 2; s++) {
    StyImage *guide = trace_outline(scene, &stands[s], 1, 1);
    int inside = 0, edge = 0;
    for (int y = 1; y < SIDE - 1; y++)
      for (int x = 1; x < SIDE - 1; x++) {
        if (at(guide, "A", x, y) == 0) continue;
        const bool whole = at(guide, "A", x - 1, y) > 0 && at(guide, "A", x + 1, y) > 0 &&
                           at(guide, "A", x, y - 1) > 0 && at(guide, "A", x, y + 1) > 0;
        assert_true(whole ? at(guide, "contour.Y", x, y) < 0.02 : at(guide, "contour.Y", x, y) == 1);
        *(whole ? &inside : &edge) += 1;
      }
    assert_true(inside > SIDE && edge > SIDE / 2);
    sty_destroy_image(&guide);
  }
  sty_destroy_scene(&scene);
}

/* A step of d pixels in depth counts d/2 of STY_CONTOUR_SPAN (the middle of both neighbours), a right angle 1. */
static void test_steps_and_edges(void **state) {
  StyScene *scene = open_scene();
  const int quad = add_quad(*state, scene, 1);
  const double pixel = 2.0 / SIDE, step = 8 * pixel;
  add_object(scene, quad, 1, 0, step);
  add_object(scene, quad, 0, 0, 0);
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  StyImage *guide = trace_outline(scene, &IN_FRONT, 1, 1);
  for (int x = 1; x < SIDE - 1; x++) {
    const double expected = x == SIDE / 2 || x == SIDE / 2 - 1 ? 4.0 / STY_CONTOUR_SPAN : 0;
    assert_true(fabs(at(guide, "contour.Y", x, SIDE / 2) - expected) < 1e-5);
  }
  sty_destroy_image(&guide);
  guide = trace_outline(scene, &IN_FRONT, 0.5, 1);
  assert_true(fabs(at(guide, "contour.Y", SIDE / 2, SIDE / 2) - 2.0 / STY_CONTOUR_SPAN) < 1e-5);
  close_all(&scene, &guide);
  scene = open_scene();
  add_object(scene, add_mesh(*state, scene, CUBE_OBJ, 30), 0, 0, 0);
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  const StyStand corner = {.position = {5, 0, 5}, .up = {0, 1, 0}, .height = 1};
  guide = trace_outline(scene, &corner, 0, 0.75);
  for (int x = 0; x < SIDE; x++) {
    const double expected = x == SIDE / 2 || x == SIDE / 2 - 1 ? 0.75 : 0;
    assert_true(fabs(at(guide, "contour.Y", x, SIDE / 2) - expected) < 1e-5);
  }
  close_all(&scene, &guide);
}

/* ---- motion --------------------------------------------------------------------- */

static StyImage *trace_motion(const StyScene *now, const StyScene *then, const StyStand *from, const StyStand *to) {
  StyTraceOptions options = {.width = SIDE, .height = SIDE, .groups = STY_GUIDE_MOTION | STY_GUIDE_POSITION};
  const StyCamera before = place(then, to, &options);
  options.previous = (StyPrevious){then, &before};
  return trace(now, from, &options);
}

static StyScene *build_pair(Scratch *scratch, double cube_x, double cube_y, double sphere_x) {
  StyScene *scene = open_scene();
  add_object(scene, add_mesh(scratch, scene, CUBE_OBJ, 30), cube_x, cube_y, -3);
  add_sphere(scene, sphere_x, 0, 0, 0.3);
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  return scene;
}

/* Each thing by its own way, whole pixels: the cube came from 3 to the left and 2 above, the sphere from 5 to the
 * right. */
static void test_objects_move(void **state) {
  const double pixel = 2.0 / SIDE;
  StyScene *then = build_pair(*state, 0, 0, 0), *now = build_pair(*state, 3 * pixel, -2 * pixel, -5 * pixel);
  StyImage *guide = trace_motion(now, then, &IN_FRONT, &IN_FRONT);
  int cube = 0, sphere = 0;
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++) {
      if (at(guide, "A", x, y) == 0) continue;
      const bool ball = at(guide, "position.Z", x, y) > -1;
      assert_true(fabs(at(guide, "motion.U", x, y) - (ball ? 5 : -3)) < 1e-4);
      assert_true(fabs(at(guide, "motion.V", x, y) - (ball ? 0 : -2)) < 1e-4);
      *(ball ? &sphere : &cube) += 1;
    }
  assert_true(cube > SIDE && sphere > SIDE);
  sty_destroy_scene(&then);
  close_all(&now, &guide);
}

/* The camera moves and turns, in perspective: the world's point seen by the old camera, by its formula. */
static void test_camera_moves(void **state) {
  static const StyStand now = {
      .perspective = true, .position = {1, 2, 6}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fov = 40};
  static const StyStand then = {
      .perspective = true, .position = {0, 0, 5}, .target = {0, 0, 0}, .up = {0, 1, 0}, .fov = 40};
  StyScene *scene = build_pair(*state, 0, 0, 0.5);
  StyImage *guide = trace_motion(scene, scene, &now, &then);
  const double focus = SIDE / 2.0 / tan(20 * M_PI / 180);
  int covered = 0;
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++) {
      if (at(guide, "A", x, y) == 0) continue;
      const double depth = 5 - at(guide, "position.Z", x, y);
      const double u = SIDE / 2.0 + focus * at(guide, "position.X", x, y) / depth;
      const double v = SIDE / 2.0 - focus * at(guide, "position.Y", x, y) / depth;
      assert_true(fabs(at(guide, "motion.U", x, y) - (u - x - 0.5)) < 1e-4);
      assert_true(fabs(at(guide, "motion.V", x, y) - (v - y - 0.5)) < 1e-4);
      covered++;
    }
  assert_true(covered > SIDE * SIDE / 32);
  sty_destroy_image(&guide);
  const StyStand away = {
      .perspective = true, .position = {0, 0, -9}, .target = {0, 0, -20}, .up = {0, 1, 0}, .fov = 40};
  guide = trace_motion(scene, scene, &now, &away); /* all of it is behind that one */
  for (size_t i = 0; i < sty_count_pixels(guide); i++) assert_true(sty_find_channel(guide, "motion.U")[i] == 0);
  close_all(&scene, &guide);
}

/* A mesh that bends keeps its triangles: each point where its own triangle was. */
static void test_meshes_bend(void **state) {
  StyScene *now = open_scene(), *then = open_scene();
  add_object(now, add_quad(*state, now, 1), 0, 0, 0);
  static const char sheared[] =
      "v -1.5 -1 0\nv 0.5 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";
  add_object(then, add_mesh(*state, then, sheared, -1), 0, 0, 0);
  assert_int_equal(sty_finish_scene(now, NULL), STY_OK);
  assert_int_equal(sty_finish_scene(then, NULL), STY_OK);
  StyImage *guide = trace_motion(now, then, &IN_FRONT, &IN_FRONT);
  for (int y = 0; y < SIDE; y++)
    for (int x = 0; x < SIDE; x++) {
      const double down = (y + 0.5) / SIDE; /* the lower edge was half a unit, a quarter of the film, to the left */
      assert_true(fabs(at(guide, "motion.U", x, y) + down * SIDE / 4) < 1e-4);
      assert_true(fabs(at(guide, "motion.V", x, y)) < 1e-4);
    }
  sty_destroy_scene(&then);
  close_all(&now, &guide);
}

static void test_motion_needs_a_like_scene(void **state) {
  StyScene *pair = build_pair(*state, 0, 0, 0), *other = open_scene();
  add_sphere(other, 0, 0, 0, 1);
  assert_int_equal(sty_finish_scene(other, NULL), STY_OK);
  StyTraceOptions options = {.width = 8, .height = 8, .groups = STY_GUIDE_MOTION};
  const StyCamera camera = place(pair, &IN_FRONT, &options);
  StyImage *guide = NULL;
  StyError error;
  assert_int_equal(sty_trace_guide(pair, &camera, &options, NULL, NULL, &guide, &error), STY_ERROR_USAGE);
  options.previous = (StyPrevious){other, &camera};
  assert_int_equal(sty_trace_guide(pair, &camera, &options, NULL, NULL, &guide, &error), STY_ERROR_INPUT);
  assert_string_equal(error.text, "found 0 objects and 1 sphere, expected 1 object and 1 sphere");
  assert_int_equal(sty_make_sphere_guide(8, 8, STY_GUIDE_MOTION, &guide, &error), STY_ERROR_USAGE);
  assert_null(guide);
  sty_destroy_scene(&pair);
  sty_destroy_scene(&other);
}

/* ---- rows ----------------------------------------------------------------------- */

static StyStatus take_two(void *context, StyImage *rows, StyError *error) {
  (void)rows;
  int *calls = context;
  return ++*calls < 2 ? STY_OK : sty_fail(error, STY_ERROR_FILE, "found no room on call %d", *calls);
}

/* A sink that fails is asked no more, and its word goes out. */
static void test_sinks_may_fail(void **state) {
  (void)state;
  StyScene *scene = open_scene();
  add_sphere(scene, 0, 0, 0, 1);
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  const StyTraceOptions options = {.width = 8, .height = 20000, .groups = STY_GUIDE_NORMAL};
  const StyCamera camera = place(scene, &IN_FRONT, &options);
  int calls = 0;
  StyError error;
  assert_int_equal(sty_trace_rows(scene, &camera, &options, NULL, &(StyRowSink){take_two, &calls}, NULL, &error),
                   STY_ERROR_FILE);
  assert_string_equal(error.text, "found no room on call 2");
  assert_int_equal(calls, 2);
  sty_destroy_scene(&scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_uv, open_scratch, close_scratch),
      cmocka_unit_test(test_uv_of_spheres),
      cmocka_unit_test_setup_teardown(test_texels, open_scratch, close_scratch),
      cmocka_unit_test_setup_teardown(test_between_texels, open_scratch, close_scratch),
      cmocka_unit_test_setup_teardown(test_materials, open_scratch, close_scratch),
      cmocka_unit_test_setup_teardown(test_bad_textures, open_scratch, close_scratch),
      cmocka_unit_test_setup_teardown(test_pictures_inside_files, open_scratch, close_scratch),
      cmocka_unit_test_setup_teardown(test_bad_pictures_inside_files, open_scratch, close_scratch),
      cmocka_unit_test(test_curvature_of_spheres),
      cmocka_unit_test_setup_teardown(test_curvature_of_meshes, open_scratch, close_scratch),
      cmocka_unit_test_setup_teardown(test_planes_have_no_outline, open_scratch, close_scratch),
      cmocka_unit_test_setup_teardown(test_steps_and_edges, open_scratch, close_scratch),
      cmocka_unit_test_setup_teardown(test_objects_move, open_scratch, close_scratch),
      cmocka_unit_test_setup_teardown(test_camera_moves, open_scratch, close_scratch),
      cmocka_unit_test_setup_teardown(test_meshes_bend, open_scratch, close_scratch),
      cmocka_unit_test_setup_teardown(test_motion_needs_a_like_scene, open_scratch, close_scratch),
      cmocka_unit_test(test_sinks_may_fail),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
