/* Scenes for tests of guides: shapes of which every pixel is known, cameras before them, and what they see. */
#ifndef STYLUT_TESTS_STAGE_H
#define STYLUT_TESTS_STAGE_H

#include <math.h>

#include "../scratch.h"
#include "stylut/guide.h"

static inline StyScene *open_stage(void) {
  StyScene *scene = NULL;
  assert_int_equal(sty_create_scene(&scene, NULL), STY_OK);
  scene->ambient = 0;
  return scene;
}

static inline void add_sun(StyScene *scene, const double direction[3]) {
  StyLight light = {.intensity = 1, .colour = {1, 1, 1}};
  memcpy(light.direction, direction, sizeof light.direction);
  assert_int_equal(sty_add_light(scene, &light, NULL), STY_OK);
}

/* The mesh, which the scene takes over, put there by the transform. */
static inline void add_shape(StyScene *scene, StyMesh *mesh, const double transform[3][4]) {
  StyObject object = {.style = 1, .material = sty_white};
  assert_int_equal(sty_add_mesh(scene, &mesh, &object.mesh, NULL), STY_OK);
  memcpy(object.transform, transform, sizeof object.transform);
  assert_int_equal(sty_add_object(scene, &object, NULL), STY_OK);
}

static inline StyImage *trace_from(const StyScene *scene, const StyStand *stand, StyTraceOptions options) {
  StyCamera camera;
  StyImage *guide = NULL;
  StyError error = {STY_OK, ""};
  options.contour = sty_default_contour;
  if (sty_place_camera(scene, stand, options.width, options.height, &camera, &error) ||
      sty_trace_guide(scene, &camera, &options, NULL, NULL, &guide, &error))
    fail_msg("%s", error.text);
  return guide;
}

static inline double look_up(const StyImage *guide, const char *channel, int x, int y) {
  const float *plane = sty_find_channel(guide, channel);
  assert_non_null(plane);
  return (double)plane[(size_t)y * (size_t)guide->width + (size_t)x];
}

/* ---- shapes ---- */

/* Where a surface lies, and its normal, for u and v from 0 to 1; within [-1, 1]^3. */
typedef void Surface(double u, double v, double at[3], double normal[3]);

static inline StyMesh *allocate_mesh(size_t vertices, size_t triangles) {
  StyMesh *mesh = calloc(1, sizeof *mesh);
  assert_non_null(mesh);
  *mesh = (StyMesh){.part_count = 1, .scale = 1, .vertex_count = vertices, .triangle_count = triangles};
  mesh->positions = calloc(3 * vertices + 1, sizeof(float));
  mesh->normals = malloc(3 * vertices * sizeof(float));
  mesh->uvs = malloc(2 * vertices * sizeof(float));
  mesh->indices = malloc(3 * triangles * sizeof(uint32_t));
  mesh->part_ids = malloc(triangles * sizeof(uint32_t));
  assert_true(mesh->positions && mesh->normals && mesh->uvs && mesh->indices && mesh->part_ids);
  for (int k = 0; k < 3; k++) mesh->minimum[k] = -1, mesh->maximum[k] = 1;
  return mesh;
}

/* Columns of u by rows of v, two triangles each. Where the surface closes in u, both ends are the same points. */
static inline StyMesh *make_surface(Surface *surface, int columns, int rows, bool closed_u, bool closed_v) {
  const int across = columns + 1;
  StyMesh *mesh = allocate_mesh((size_t)across * (size_t)(rows + 1), 2 * (size_t)columns * (size_t)rows);
  for (int i = 0; i < across * (rows + 1); i++) {
    const int c = i % across, r = i / across;
    double at[3], normal[3];
    surface((double)(closed_u ? c % columns : c) / columns, (double)(closed_v ? r % rows : r) / rows, at, normal);
    for (int k = 0; k < 3; k++) mesh->positions[3 * i + k] = (float)at[k], mesh->normals[3 * i + k] = (float)normal[k];
    mesh->uvs[2 * i] = (float)c / (float)columns;
    mesh->uvs[2 * i + 1] = (float)r / (float)rows;
  }
  for (int t = 0; t < 2 * columns * rows; t++) {
    const int a = t / 2 / columns * across + t / 2 % columns, b = a + 1, c = b + across, d = a + across;
    const int corners[2][3] = {{a, b, c}, {a, c, d}};
    for (int k = 0; k < 3; k++) mesh->indices[3 * t + k] = (uint32_t)corners[t % 2][k];
    mesh->part_ids[t] = 1;
  }
  return mesh;
}

/* A torus about the z axis: 0.7 from the axis to the tube's middle, the tube 0.3 thick. */
#define TORUS_MIDDLE 0.7
#define TORUS_TUBE 0.3
static inline void place_torus(double u, double v, double at[3], double normal[3]) {
  const double turn = 2 * M_PI * u, around = 2 * M_PI * v;
  const double n[3] = {cos(turn) * cos(around), sin(turn) * cos(around), sin(around)};
  for (int k = 0; k < 3; k++) normal[k] = n[k], at[k] = TORUS_TUBE * n[k];
  at[0] += TORUS_MIDDLE * cos(turn);
  at[1] += TORUS_MIDDLE * sin(turn);
}

/* The square [-1, 1]^2 at z = 0 that faces +z. */
static inline void place_square(double u, double v, double at[3], double normal[3]) {
  for (int k = 0; k < 3; k++) at[k] = k < 2 ? 2 * (k ? v : u) - 1 : 0, normal[k] = k == 2;
}

/* The box [-1, 1]^3, each side of `cells` x `cells` squares; its texture goes over each side once, u along the axis
 * after the side's own. */
static inline StyMesh *make_box(int cells) {
  const int across = cells + 1, points = across * across;
  StyMesh *mesh = allocate_mesh((size_t)(6 * points), (size_t)(12 * cells * cells));
  size_t triangle = 0;
  for (int side = 0; side < 6; side++) {
    const int axis = side / 2, sign = side % 2 ? -1 : 1;
    for (int i = 0; i < points; i++) {
      const int v = side * points + i, place[3] = {sign * cells, 2 * (i % across) - cells, 2 * (i / across) - cells};
      for (int k = 0; k < 3; k++) {
        mesh->positions[3 * v + (axis + k) % 3] = (float)place[k] / (float)cells;
        mesh->normals[3 * v + (axis + k) % 3] = k ? 0 : (float)sign;
      }
      mesh->uvs[2 * v] = (float)(i % across) / (float)cells;
      mesh->uvs[2 * v + 1] = (float)(i / across) / (float)cells;
    }
    for (int i = 0; i < 2 * cells * cells; i++, triangle++) {
      const int a = side * points + i / 2 / cells * across + i / 2 % cells, c = a + across + 1;
      const int odd = i % 2 ? a + across : a + 1; /* left of the diagonal, or right of it */
      const bool ahead = (i % 2 == 0) == (sign > 0);
      const int corners[3] = {a, ahead ? odd : c, ahead ? c : odd};
      for (size_t k = 0; k < 3; k++) mesh->indices[3 * triangle + k] = (uint32_t)corners[k];
      mesh->part_ids[triangle] = 1;
    }
  }
  return mesh;
}

#endif
