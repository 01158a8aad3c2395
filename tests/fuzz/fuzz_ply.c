/* Binary PLY files of triangles, and the check that other PLY files pass before the importer gets them. */
#include <math.h>

#include "fuzz.h"
#include "scene/normals.h"
#include "scene/ply.h"

static void check_mesh(const StyMesh *mesh) {
  require(mesh->triangle_count > 0 && mesh->vertex_count > 0 && mesh->part_count == 1);
  for (size_t c = 0; c < 3 * mesh->triangle_count; c++) require(mesh->indices[c] < mesh->vertex_count);
  for (size_t i = 0; i < 3 * mesh->vertex_count; i++) {
    require(fabsf(mesh->positions[i]) <= 1.0001F);
    require(fabsf(mesh->normals[i]) <= 1.0001F);
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static const StyRun run = {.threads = 1};
  const char *path = put_file("mesh.ply", data, size);
  StyError error;
  StyMesh *mesh = NULL;
  StyStatus status = sty_check_ply(path, &error);
  if (status) require_message(status, &error);
  const bool is_whole = !status;
  status = sty_read_ply(path, size % 2, &run, &mesh, &error);
  if (status) {
    require(!mesh);
    require_message(status, &error);
  }
  if (!mesh) return 0;
  require(is_whole);
  status = sty_compute_normals(mesh, (double)(size % 181), &run, &error);
  require(!status);
  check_mesh(mesh);
  sty_destroy_mesh(&mesh);
  return 0;
}
