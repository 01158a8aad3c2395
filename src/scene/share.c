#include "scene/share.h"

#include <stdlib.h>
#include <string.h>

StyStatus sty_share_vertices(StyMesh *mesh, const StyCorner *corners, bool has_uvs, StyError *error) {
  const size_t count = 3 * mesh->triangle_count, size = has_uvs ? sizeof *corners : offsetof(StyCorner, uv);
  mesh->indices = malloc(count * sizeof *mesh->indices);
  if (!mesh->indices) return sty_fail_memory(error, "mesh indices", (double)(count * sizeof *mesh->indices));
  StyStatus status =
      sty_number_distinct(corners, sizeof *corners, count, size, mesh->indices, &mesh->vertex_count, error);
  if (status != STY_OK) return status;
  mesh->positions = calloc(3 * mesh->vertex_count + 1, sizeof *mesh->positions);
  mesh->normals = malloc(3 * mesh->vertex_count * sizeof *mesh->normals);
  if (has_uvs) mesh->uvs = malloc(2 * mesh->vertex_count * sizeof *mesh->uvs);
  if (!mesh->positions || !mesh->normals || (has_uvs && !mesh->uvs))
    return sty_fail_memory(error, "mesh vertices", (double)mesh->vertex_count * sizeof *corners);
  for (size_t c = 0; c < count; c++) {
    memcpy(&mesh->positions[3 * (size_t)mesh->indices[c]], corners[c].position, sizeof corners->position);
    memcpy(&mesh->normals[3 * (size_t)mesh->indices[c]], corners[c].normal, sizeof corners->normal);
    if (has_uvs) memcpy(&mesh->uvs[2 * (size_t)mesh->indices[c]], corners[c].uv, sizeof corners->uv);
  }
  return STY_OK;
}

StyCorner sty_get_corner(const StyMesh *mesh, size_t corner) {
  StyCorner out = {0};
  const size_t vertex = mesh->indices[corner];
  memcpy(out.position, &mesh->positions[3 * vertex], sizeof out.position);
  memcpy(out.normal, &mesh->normals[3 * vertex], sizeof out.normal);
  if (mesh->uvs) memcpy(out.uv, &mesh->uvs[2 * vertex], sizeof out.uv);
  return out;
}
