/* Whether two scenes are the same things at two times. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene/corners.h"
#include "stylut/scene.h"

enum { COUNTS_SIZE = 64 };

static const char *name_counts(const StyScene *scene, char out[COUNTS_SIZE]) {
  const int objects = scene->object_count, spheres = scene->sphere_count;
  snprintf(out, COUNTS_SIZE, "%d object%s and %d sphere%s", objects, objects == 1 ? "" : "s", spheres,
           spheres == 1 ? "" : "s");
  return out;
}

/* For each corner the first one at the same place: how triangles hang together, whatever the vertices are that
 * normals and texture coordinates have made of it. */
static StyStatus list_first_corners(const StyMesh *mesh, uint32_t **out, StyError *error) {
  const size_t corners = 3 * mesh->triangle_count, vertices = mesh->vertex_count;
  size_t places = 0;
  uint32_t *ids = malloc(vertices * sizeof *ids), *firsts = malloc(vertices * sizeof *firsts);
  *out = malloc(corners * sizeof **out);
  StyStatus status = ids && firsts && *out
                         ? sty_number_distinct(mesh->positions, 3 * sizeof *mesh->positions, vertices,
                                               3 * sizeof *mesh->positions, ids, &places, error)
                         : sty_fail_memory(error, sty_name_mesh(mesh), (double)(corners + 2 * vertices) * sizeof *ids);
  for (size_t p = 0; p < places; p++) firsts[p] = UINT32_MAX;
  for (size_t c = 0; c < corners && !status; c++) {
    uint32_t *first = &firsts[ids[mesh->indices[c]]];
    if (*first == UINT32_MAX) *first = (uint32_t)c;
    (*out)[c] = *first;
  }
  free(ids);
  free(firsts);
  return status;
}

/* Corners that are together in one mesh are so in the other, unless one has both places in the same spot: a surface
 * that bends may touch itself. */
static bool agree(const uint32_t *here, const uint32_t *there, size_t corner) {
  const uint32_t a = here[corner], b = there[corner];
  return a == b || (a < b ? here[b] == a : there[a] == b);
}

/* The first triangle of `there` that hangs together with others than in `here`; their number: none does. */
static StyStatus find_other_triangle(const StyMesh *here, const StyMesh *there, size_t *out, StyError *error) {
  const size_t corners = 3 * here->triangle_count;
  *out = here->triangle_count;
  if (memcmp(here->indices, there->indices, corners * sizeof *here->indices) == 0) return STY_OK;
  uint32_t *firsts[2] = {NULL, NULL};
  StyStatus status = list_first_corners(here, &firsts[0], error);
  if (!status) status = list_first_corners(there, &firsts[1], error);
  size_t c = 0;
  while (!status && c < corners && agree(firsts[0], firsts[1], c)) c++;
  for (int i = 0; i < 2; i++) free(firsts[i]);
  *out = c / 3;
  return status;
}

static StyStatus check_meshes(int object, const StyMesh *here, const StyMesh *there, StyError *error) {
  const size_t count = here->triangle_count;
  if (there->triangle_count != count)
    return sty_fail(error, STY_ERROR_INPUT, "object %d: found %zu triangle%s, expected %zu", object + 1,
                    there->triangle_count, there->triangle_count == 1 ? "" : "s", count);
  size_t triangle;
  const StyStatus status = find_other_triangle(here, there, &triangle, error);
  if (status || triangle == count) return status;
  return sty_fail(
      error, STY_ERROR_INPUT,
      "object %d: found that triangle %zu of %s has other neighbours than in %s, expected the same triangles",
      object + 1, triangle + 1, sty_name_mesh(there), sty_name_mesh(here));
}

StyStatus sty_check_alike(const StyScene *scene, const StyScene *other, StyError *error) {
  char found[COUNTS_SIZE], expected[COUNTS_SIZE];
  if (scene->object_count != other->object_count || scene->sphere_count != other->sphere_count)
    return sty_fail(error, STY_ERROR_INPUT, "found %s, expected %s", name_counts(other, found),
                    name_counts(scene, expected));
  const StyMesh **known = calloc((size_t)scene->mesh_count + 1, sizeof(StyMesh *)); /* that a mesh was compared with */
  if (!known) return sty_fail_memory(error, "scene", scene->mesh_count);
  StyStatus status = STY_OK;
  for (int o = 0; o < scene->object_count && !status; o++) {
    const int number = scene->objects[o].mesh;
    const StyMesh *here = scene->meshes[number], *there = other->meshes[other->objects[o].mesh];
    if (here != there && known[number] != there) status = check_meshes(o, here, there, error);
    known[number] = there;
  }
  free(known);
  return status;
}
