/* Files as other programs would write them, of a guide of two spheres. What a program would say is worked out from the
 * spheres' own geometry and the pixels, not by the code under test. */
#ifndef STYLUT_TESTS_FOREIGN_FILES_H
#define STYLUT_TESTS_FOREIGN_FILES_H

#include <math.h>

#include "../scratch.h"
#include "stylut/foreign.h"
#include "stylut/guide.h"
#include "stylut/image_io.h"

enum { WIDTH = 72, HEIGHT = 50, PIXELS = WIDTH * HEIGHT };
enum { BLENDER, ARNOLD, PBRT, HOUDINI, UNITY, PNG, PROGRAMS };

static const double centres[2][3] = {{0.3, 0.2, -0.4}, {-1.4, 0.5, 0.6}}, radii[2] = {1, 0.6};
static const StyStand ours = {
    .perspective = true, .position = {2.5, 1.8, 4}, .target = {-0.2, 0.3, 0}, .up = {0.1, 1, 0.2}, .fov = 42};

static StyNotes notes;

/* ---- the guide that all files are made of -------------------------------------- */

static inline StyImage *trace_original(void) {
  StyScene *scene = NULL;
  StyCamera camera;
  StyImage *guide = NULL;
  const unsigned groups =
      STY_GUIDE_NORMAL | STY_GUIDE_DEPTH | STY_GUIDE_POSITION | STY_GUIDE_OBJECT | STY_GUIDE_STYLE | STY_GUIDE_ALBEDO;
  const StyTraceOptions options = {.width = WIDTH, .height = HEIGHT, .groups = groups};
  assert_int_equal(sty_create_scene(&scene, NULL), STY_OK);
  for (int s = 0; s < 2; s++) {
    StySphere sphere = {.radius = radii[s], .style = 7 * s + 3, .material = sty_white};
    memcpy(sphere.centre, centres[s], sizeof sphere.centre);
    sphere.material.paint.colour[s] = 0.25;
    assert_int_equal(sty_add_sphere(scene, &sphere, NULL), STY_OK);
  }
  assert_int_equal(sty_finish_scene(scene, NULL), STY_OK);
  assert_int_equal(sty_place_camera(scene, &ours, WIDTH, HEIGHT, &camera, NULL), STY_OK);
  assert_int_equal(sty_trace_guide(scene, &camera, &options, NULL, NULL, &guide, NULL), STY_OK);
  sty_destroy_scene(&scene);
  return guide;
}

static inline float at(const StyImage *image, const char *channel, int pixel) {
  const float *plane = sty_find_channel(image, channel);
  if (!plane) fail_msg("no channel %s", channel);
  return plane[pixel];
}

static inline double of(const StyImage *image, const char *layer, int k, int pixel) {
  char name[32];
  snprintf(name, sizeof name, "%s.%c", layer, "XYZ"[k]);
  return (double)at(image, name, pixel);
}

/* The world's normal of a covered pixel: away from its sphere's centre. */
static inline double get_world_normal(const StyImage *guide, int pixel, int k) {
  const int s = (int)at(guide, "object.I", pixel) - 1;
  return (of(guide, "position", k, pixel) - centres[s][k]) / radii[s];
}

/* The point of a pixel from the eye: right, up, and away along the axis. */
static inline double get_eye_position(const StyImage *guide, int pixel, int k) {
  const double depth = (double)at(guide, "depth.Z", pixel), slope = tan(ours.fov * (M_PI / 360)) / HEIGHT;
  if (k == 0) return (2 * (pixel % WIDTH) + 1 - WIDTH) * slope * depth;
  return k == 1 ? (HEIGHT - 2 * (pixel / WIDTH) - 1) * slope * depth : depth;
}

/* ---- worlds -------------------------------------------------------------------- */

typedef enum World { OURS, Z_UP, LEFT_HANDED } World;

static inline void change_world(World world, const double v[3], double out[3]) {
  const double x = v[0], y = v[1], z = v[2];
  out[0] = x;
  out[1] = world == Z_UP ? -z : y;
  out[2] = world == Z_UP ? y : world == LEFT_HANDED ? -z : z;
}

static inline StyStand move_camera(World world) {
  StyStand stand = ours;
  change_world(world, ours.position, stand.position);
  change_world(world, ours.target, stand.target);
  change_world(world, ours.up, stand.up);
  return stand;
}

/* ---- files --------------------------------------------------------------------- */

static inline StyImage *make_file(const char *const *names, int bits) {
  StyImage *file = NULL;
  int count = 0;
  while (names[count]) count++;
  assert_int_equal(sty_create_image(WIDTH, HEIGHT, count, names, bits, &file, NULL), STY_OK);
  return file;
}

static inline void put(StyImage *file, const char *layer, const char *letters, int k, int pixel, double value) {
  char name[64];
  snprintf(name, sizeof name, "%s%s%c", layer, *layer ? "." : "", letters[k]);
  float *plane = sty_find_channel(file, name);
  if (!plane) fail_msg("no channel %s", name);
  plane[pixel] = (float)value;
}

/* Normals and positions as one of the worlds has them. */
static inline void put_world(StyImage *file, const StyImage *guide, const char *normal, const char *position,
                             World world, int pixel) {
  double n[3], p[3];
  for (int k = 0; k < 3; k++) n[k] = get_world_normal(guide, pixel, k), p[k] = of(guide, "position", k, pixel);
  change_world(world, n, n);
  change_world(world, p, p);
  for (int k = 0; k < 3; k++) {
    put(file, normal, "XYZ", k, pixel, n[k]);
    if (position) put(file, position, "XYZ", k, pixel, p[k]);
  }
}

/* Camera space with Z by `toward`: 1 toward the viewer. */
static inline void put_view(StyImage *file, const StyImage *guide, const char *normal, const char *position, int toward,
                            int pixel) {
  for (int k = 0; k < 3; k++) {
    put(file, normal, "XYZ", k, pixel, of(guide, "normal", k, pixel) * (k == 2 ? toward : 1));
    if (position) put(file, position, "XYZ", k, pixel, get_eye_position(guide, pixel, k) * (k == 2 ? -toward : 1));
  }
}

static inline StyImage *make_blender(const StyImage *guide) {
  static const char *const names[] = {"ViewLayer.Combined.R",
                                      "ViewLayer.Combined.G",
                                      "ViewLayer.Combined.B",
                                      "ViewLayer.Combined.A",
                                      "ViewLayer.Depth.Z",
                                      "ViewLayer.DiffCol.B",
                                      "ViewLayer.DiffCol.G",
                                      "ViewLayer.DiffCol.R",
                                      "ViewLayer.IndexMA.X",
                                      "ViewLayer.IndexOB.X",
                                      "ViewLayer.Mist.Z",
                                      "ViewLayer.Normal.X",
                                      "ViewLayer.Normal.Y",
                                      "ViewLayer.Normal.Z",
                                      "ViewLayer.Position.X",
                                      "ViewLayer.Position.Y",
                                      "ViewLayer.Position.Z",
                                      "ViewLayer.UV.A",
                                      "ViewLayer.UV.U",
                                      "ViewLayer.UV.V",
                                      "ViewLayer.Vector.W",
                                      "ViewLayer.Vector.X",
                                      "ViewLayer.Vector.Y",
                                      "ViewLayer.Vector.Z",
                                      NULL};
  StyImage *file = make_file(names, 32);
  for (int i = 0; i < PIXELS; i++) {
    put(file, "ViewLayer.Depth", "Z", 0, i, 1e10);
    for (int k = 0; k < 3; k++) put(file, "ViewLayer.Combined", "RGB", k, i, 0.9); /* the sky */
    put(file, "ViewLayer.Combined", "A", 0, i, 1);
    if (at(guide, "A", i) == 0) continue;
    put_world(file, guide, "ViewLayer.Normal", "ViewLayer.Position", Z_UP, i);
    put(file, "ViewLayer.Depth", "Z", 0, i, (double)at(guide, "depth.Z", i));
    put(file, "ViewLayer.IndexOB", "X", 0, i, (double)at(guide, "object.I", i));
    put(file, "ViewLayer.IndexMA", "X", 0, i, (double)at(guide, "style.I", i));
    for (int k = 0; k < 3; k++) {
      put(file, "ViewLayer.DiffCol", "RGB", k, i,
          (double)guide->data[(size_t)(guide->channel_count - 3 + k) * PIXELS + (size_t)i]);
      put(file, "ViewLayer.Combined", "RGB", k, i, 0.1 * (k + 1));
    }
    put(file, "ViewLayer.UV", "UV", 0, i, 0.25), put(file, "ViewLayer.UV", "UV", 1, i, 0.75);
    put(file, "ViewLayer.Vector", "XY", 0, i, 3), put(file, "ViewLayer.Vector", "XY", 1, i, 2);
  }
  return file;
}

/* `along_ray`: what Z is. */
static inline StyImage *make_arnold(const StyImage *guide, bool along_ray) {
  static const char *const names[] = {"A", "B", "G", "R", "N.X", "N.Y", "N.Z", "P.X", "P.Y", "P.Z", "Z", "id", NULL};
  StyImage *file = make_file(names, 32);
  for (int i = 0; i < PIXELS; i++) {
    sty_find_channel(file, "Z")[i] = INFINITY;
    if (at(guide, "A", i) == 0) continue;
    put_world(file, guide, "N", "P", OURS, i);
    double squared = 0;
    for (int k = 0; k < 3; k++) squared += pow(get_eye_position(guide, i, k), 2);
    sty_find_channel(file, "Z")[i] = along_ray ? (float)sqrt(squared) : at(guide, "depth.Z", i);
    sty_find_channel(file, "id")[i] = at(guide, "object.I", i);
    sty_find_channel(file, "A")[i] = 0.5f;
    for (int k = 0; k < 3; k++) put(file, "", "RGB", k, i, 0.1 * (k + 1));
  }
  return file;
}

static inline StyImage *make_pbrt(const StyImage *guide, bool world) {
  static const char *const names[] = {"R",    "G",    "B",    "Albedo.R", "Albedo.G", "Albedo.B", "P.X",
                                      "P.Y",  "P.Z",  "dzdx", "dzdy",     "N.X",      "N.Y",      "N.Z",
                                      "Ns.X", "Ns.Y", "Ns.Z", "u",        "v",        NULL};
  StyImage *file = make_file(names, 32);
  for (int i = 0; i < PIXELS; i++) {
    if (at(guide, "A", i) == 0) continue;
    if (world)
      put_world(file, guide, "Ns", "P", LEFT_HANDED, i);
    else
      put_view(file, guide, "Ns", "P", -1, i);
    put(file, "N", "XYZ", 0, i, 1); /* facets, not to be taken */
    put(file, "", "u", 0, i, 0.25), put(file, "", "v", 0, i, 0.75);
  }
  return file;
}

static inline StyImage *make_houdini(const StyImage *guide, int toward, const char *depth) {
  const char *const names[] = {"C.R", "C.G", "C.B", "C.A", "N.X", "N.Y", "N.Z", depth, "P.X", "P.Y", "P.Z", NULL};
  StyImage *file = make_file(names, 32);
  for (int i = 0; i < PIXELS; i++) {
    if (at(guide, "A", i) == 0) continue;
    put_view(file, guide, "N", "P", toward, i);
    double squared = 0;
    for (int k = 0; k < 3; k++) squared += pow(get_eye_position(guide, i, k), 2);
    sty_find_channel(file, depth)[i] = strcmp(depth, "hitdist") ? at(guide, "depth.Z", i) : (float)sqrt(squared);
    put(file, "C", "A", 0, i, 1);
  }
  return file;
}

/* n/2+1/2 in `bits`, or n itself. */
static inline StyImage *make_unity(const StyImage *guide, bool world, int bits) {
  static const char *const names[] = {"R", "G", "B", "A", NULL};
  StyImage *file = make_file(names, bits);
  const double top = bits == 8 ? 255 : 65535;
  for (int i = 0; i < PIXELS; i++) {
    if (at(guide, "A", i) == 0) continue;
    for (int k = 0; k < 3; k++) {
      const double n = world ? get_world_normal(guide, i, k) * (k == 2 ? -1 : 1) : of(guide, "normal", k, i);
      put(file, "", "RGB", k, i, bits == 32 ? n : round((n / 2 + 0.5) * top) / top);
    }
    put(file, "", "A", 0, i, 1);
  }
  return file;
}

/* ---- importing ----------------------------------------------------------------- */

static inline void import_with(int program, StySpace space, const StyStand *camera, StyImage **image) {
  const StyForeignOptions options = {.program = program, .space = space, .camera = camera};
  StyError error = {STY_OK, ""};
  if (sty_import_foreign("some.exr", &options, image, &notes, &error)) fail_msg("%s", error.text);
}

static inline int count_notes(StyNoteKind kind) {
  int count = 0;
  for (int n = 0; n < notes.count; n++) count += notes.list[n].kind == kind;
  return count;
}

static inline void expect_note(StyNoteKind kind, const char *part) {
  for (int n = 0; n < notes.count; n++)
    if (notes.list[n].kind == kind && strstr(notes.list[n].text, part)) return;
  for (int n = 0; n < notes.count; n++) print_message("%d: %s\n", (int)notes.list[n].kind, notes.list[n].text);
  fail_msg("no note of kind %d holds '%s'", (int)kind, part);
}

static inline void expect_channel(const StyImage *found, const StyImage *guide, const char *name, double tolerance) {
  for (int i = 0; i < PIXELS; i++) {
    const float a = at(found, name, i), b = at(guide, name, i);
    if (a != b && !(fabs((double)a - (double)b) <= tolerance))
      fail_msg("%s at (%d, %d): %.9g instead of %.9g", name, i % WIDTH, i / WIDTH, (double)a, (double)b);
  }
}

static inline void expect_normals(const StyImage *found, const StyImage *guide, double tolerance) {
  expect_channel(found, guide, "normal.X", tolerance);
  expect_channel(found, guide, "normal.Y", tolerance);
  expect_channel(found, guide, "normal.Z", tolerance);
}

/* Some pixels stay the background. */
static inline void expect_covered(const StyImage *found, const StyImage *guide) {
  int covered = 0;
  for (int i = 0; i < PIXELS; i++) covered += at(guide, "A", i) > 0;
  assert_in_range(covered, PIXELS / 10, PIXELS * 9 / 10);
  expect_channel(found, guide, "A", 0);
}

static inline void expect_constant(const StyImage *found, const StyImage *guide, const char *name, double value) {
  for (int i = 0; i < PIXELS; i++)
    assert_true(fabs((double)at(found, name, i) - (at(guide, "A", i) > 0 ? value : 0)) < 1e-6);
}

#endif
