#include "scene/soup.h"

#include <stdlib.h>
#include <string.h>

#include "scene/corners.h"

static StyStatus fill_soup(const StyMesh *mesh, const uint32_t *ids, StySoup *soup, StyError *error) {
  const size_t triangles = mesh->triangle_count, bytes = 12 * soup->point_count + 16 * triangles;
  soup->points = malloc(3 * soup->point_count * sizeof *soup->points);
  soup->corners = malloc(3 * triangles * sizeof *soup->corners);
  soup->triangles = malloc(triangles * sizeof *soup->triangles);
  if (!soup->points || !soup->corners || !soup->triangles) return sty_fail_memory(error, "triangles", (double)bytes);
  for (size_t v = 0; v < mesh->vertex_count; v++)
    memcpy(&soup->points[3 * (size_t)ids[v]], &mesh->positions[3 * v], 3 * sizeof *soup->points);
  for (size_t c = 0; c < 3 * triangles; c++) soup->corners[c] = ids[mesh->indices[c]];
  for (size_t t = 0; t < triangles; t++) soup->triangles[t] = (uint32_t)t;
  return STY_OK;
}

StyStatus sty_make_soup(const StyMesh *mesh, StySoup *out, StyError *error) {
  StySoup soup = {.mesh = mesh, .triangle_count = mesh->triangle_count};
  uint32_t *ids = malloc(mesh->vertex_count * sizeof *ids);
  if (!ids) return sty_fail_memory(error, "points", (double)(mesh->vertex_count * sizeof *ids));
  StyStatus status = sty_number_distinct(mesh->positions, 3 * sizeof *mesh->positions, mesh->vertex_count,
                                         3 * sizeof *mesh->positions, ids, &soup.point_count, error);
  if (!status) status = fill_soup(mesh, ids, &soup, error);
  free(ids);
  if (status)
    sty_destroy_soup(&soup);
  else
    *out = soup;
  return status;
}

void sty_destroy_soup(StySoup *soup) {
  free(soup->points);
  free(soup->corners);
  free(soup->triangles);
  *soup = (StySoup){0};
}

/* ---- copies ---- */

/* A triangle by its points, in rising order. */
typedef struct Key {
  uint32_t points[3], triangle;
} Key;

static int compare_keys(const void *a, const void *b) {
  const Key *x = a, *y = b;
  for (int k = 0; k < 3; k++)
    if (x->points[k] != y->points[k]) return x->points[k] < y->points[k] ? -1 : 1;
  return (x->triangle > y->triangle) - (x->triangle < y->triangle);
}

static void swap_if_greater(uint32_t *a, uint32_t *b) {
  if (*a <= *b) return;
  const uint32_t kept = *a;
  *a = *b;
  *b = kept;
}

static Key make_key(const StySoup *soup, size_t t) {
  Key key = {.triangle = (uint32_t)t};
  memcpy(key.points, &soup->corners[3 * t], sizeof key.points);
  swap_if_greater(&key.points[0], &key.points[1]);
  swap_if_greater(&key.points[1], &key.points[2]);
  swap_if_greater(&key.points[0], &key.points[1]);
  return key;
}

static const uint32_t COPY = UINT32_MAX;

StyStatus sty_drop_copies(StySoup *soup, size_t *copies, StyError *error) {
  const size_t count = soup->triangle_count;
  Key *keys = malloc(count * sizeof *keys);
  if (!keys) return sty_fail_memory(error, "triangles", (double)(count * sizeof *keys));
  for (size_t t = 0; t < count; t++) keys[t] = make_key(soup, t);
  qsort(keys, count, sizeof *keys, compare_keys);
  for (size_t i = 1; i < count; i++)
    if (memcmp(keys[i].points, keys[i - 1].points, sizeof keys->points) == 0) soup->triangles[keys[i].triangle] = COPY;
  free(keys);
  soup->triangle_count = 0;
  for (size_t t = 0; t < count; t++) {
    if (soup->triangles[t] == COPY) continue;
    memmove(&soup->corners[3 * soup->triangle_count], &soup->corners[3 * t], 3 * sizeof *soup->corners);
    soup->triangles[soup->triangle_count++] = soup->triangles[t];
  }
  *copies = count - soup->triangle_count;
  return STY_OK;
}
