#include "scene/fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene/faults.h"
#include "scene/vector.h"

bool sty_has_area(const double a[3], const double b[3], const double c[3]) {
  double ab[3], ac[3], normal[3];
  subtract_vectors(b, a, ab);
  subtract_vectors(c, a, ac);
  cross_vectors(ab, ac, normal);
  return dot_vectors(normal, normal) > 0;
}

bool sty_set_mesh_space(StyMesh *mesh) {
  double extent = 0;
  for (int k = 0; k < 3; k++) {
    mesh->centre[k] = (mesh->minimum[k] + mesh->maximum[k]) / 2;
    extent = fmax(extent, mesh->maximum[k] - mesh->minimum[k]);
  }
  mesh->scale = 2 / extent;
  return extent > 0 && isfinite(mesh->scale);
}

bool sty_keeps_triangle(StyMesh *mesh, const float *const corners[3]) {
  double at[3][3];
  for (int i = 0; i < 9; i++) at[i / 3][i % 3] = corners[i / 3][i % 3];
  if (sty_has_area(at[0], at[1], at[2])) return true;
  bool repeated = false;
  for (int k = 0; k < 3; k++) repeated |= memcmp(corners[k], corners[(k + 1) % 3], 3 * sizeof(float)) == 0;
  mesh->repeated_faces += repeated;
  mesh->flat_faces += !repeated;
  return false;
}

static void get_corners(const StyMesh *mesh, size_t triangle, const float *out[3]) {
  for (size_t k = 0; k < 3; k++) out[k] = &mesh->positions[3 * (size_t)mesh->indices[3 * triangle + k]];
}

static StyStatus check_vertices(const StyMesh *mesh, StyError *error) {
  StyStatus status = STY_OK;
  for (size_t v = 0; v < mesh->vertex_count && !status; v++)
    status = sty_check_vertex(mesh->path, v, 0, &mesh->positions[3 * v], mesh->uvs ? &mesh->uvs[2 * v] : NULL, error);
  return status;
}

static StyStatus measure_triangles(StyMesh *mesh, StyError *error) {
  for (int k = 0; k < 3; k++) mesh->minimum[k] = INFINITY, mesh->maximum[k] = -INFINITY;
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    const float *corners[3];
    double world[3][3];
    get_corners(mesh, t, corners);
    for (size_t k = 0; k < 3; k++) {
      for (int i = 0; i < 3; i++) world[k][i] = corners[k][i];
      const StyStatus status = sty_check_world(mesh->path, mesh->indices[3 * t + k], 0, world[k], error);
      if (status) return status;
    }
    if (!sty_has_area(world[0], world[1], world[2])) continue;
    for (int i = 0; i < 9; i++) {
      mesh->minimum[i % 3] = fmin(mesh->minimum[i % 3], world[i / 3][i % 3]);
      mesh->maximum[i % 3] = fmax(mesh->maximum[i % 3], world[i / 3][i % 3]);
    }
  }
  return sty_set_mesh_space(mesh) ? STY_OK : sty_fail_flat(mesh->path, mesh->triangle_count, error);
}

/* Adding zero turns negative zero into zero: positions compare by their bytes. */
static void move_vertices(StyMesh *mesh) {
  for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
    mesh->positions[i] = (float)((mesh->positions[i] - mesh->centre[i % 3]) * mesh->scale) + 0.0f;
}

/* Rounding to trace space may have flattened some that had an area. */
static StyStatus drop_flat_triangles(StyMesh *mesh, StyError *error) {
  const size_t count = mesh->triangle_count;
  mesh->triangle_count = 0;
  for (size_t t = 0; t < count; t++) {
    const float *corners[3];
    get_corners(mesh, t, corners);
    if (!sty_keeps_triangle(mesh, corners)) continue;
    memmove(&mesh->indices[3 * mesh->triangle_count++], &mesh->indices[3 * t], 3 * sizeof *mesh->indices);
  }
  return mesh->triangle_count > 0 ? STY_OK : sty_fail_flat(mesh->path, count, error);
}

/* The vertices that have a number move there; none moves up. */
static void move_down(float *values, size_t size, const uint32_t *numbers, size_t count) {
  for (size_t v = 0; v < count; v++)
    if (values && numbers[v] != UINT32_MAX)
      memmove(&values[size * numbers[v]], &values[size * v], size * sizeof *values);
}

static StyStatus drop_vertices(StyMesh *mesh, const unsigned char *is_used, StyError *error) {
  const size_t count = mesh->vertex_count;
  uint32_t *numbers = malloc(count * sizeof *numbers);
  if (!numbers) return sty_fail_memory(error, "mesh vertices", (double)(count * sizeof *numbers));
  mesh->vertex_count = 0;
  for (size_t v = 0; v < count; v++) numbers[v] = is_used[v] ? (uint32_t)mesh->vertex_count++ : UINT32_MAX;
  move_down(mesh->positions, 3, numbers, count);
  move_down(mesh->normals, 3, numbers, count);
  move_down(mesh->uvs, 2, numbers, count);
  for (size_t c = 0; c < 3 * mesh->triangle_count; c++) mesh->indices[c] = numbers[mesh->indices[c]];
  free(numbers);
  return STY_OK;
}

static StyStatus drop_unused_vertices(StyMesh *mesh, StyError *error) {
  unsigned char *is_used = calloc(mesh->vertex_count, 1);
  if (!is_used) return sty_fail_memory(error, "mesh vertices", (double)mesh->vertex_count);
  for (size_t c = 0; c < 3 * mesh->triangle_count; c++) is_used[mesh->indices[c]] = 1;
  const bool all = !memchr(is_used, 0, mesh->vertex_count);
  const StyStatus status = all ? STY_OK : drop_vertices(mesh, is_used, error);
  free(is_used);
  return status;
}

StyStatus sty_fit_mesh(StyMesh *mesh, StyError *error) {
  StyStatus status = check_vertices(mesh, error);
  if (!status) status = measure_triangles(mesh, error);
  if (status) return status;
  move_vertices(mesh);
  status = drop_flat_triangles(mesh, error);
  return status ? status : drop_unused_vertices(mesh, error);
}
