/* What a PLY file is asked before the importer gets it, and binary files of triangles, which are read here; all other
 * parsing of meshes is a library's, in a process of its own. */
#include <math.h>

#include "fuzz.h"
#include "scene/normals.h"
#include "scene/ply.h"

static bool is_whole(const uint8_t *data, size_t size) {
  StyError error;
  const StyStatus status = sty_check_ply(put_file("mesh.ply", data, size), &error);
  if (status) require_message(status, &error);
  return !status;
}

/* What follows a whole file changes nothing. */
static bool is_whole_with_more(const uint8_t *data, size_t size) {
  static const char more[] = "\n3 0 1 2\n";
  uint8_t *longer = malloc(size + sizeof more);
  require(longer);
  if (size) memcpy(longer, data, size);
  memcpy(longer + size, more, sizeof more);
  const bool whole = is_whole(longer, size + sizeof more);
  free(longer);
  return whole;
}

static void check_mesh(const StyMesh *mesh) {
  require(mesh->triangle_count > 0 && mesh->vertex_count > 0 && mesh->part_count == 1);
  for (size_t c = 0; c < 3 * mesh->triangle_count; c++) require(mesh->indices[c] < mesh->vertex_count);
  for (size_t i = 0; i < 3 * mesh->vertex_count; i++) {
    require(fabsf(mesh->positions[i]) <= 1.0001F);
    require(fabsf(mesh->normals[i]) <= 1.0001F);
  }
}

/* The reader takes nothing that the check refuses. */
static void read_triangles(const uint8_t *data, size_t size, bool whole) {
  static const StyRun run = {.threads = 1};
  StyError error;
  StyMesh *mesh = NULL;
  const StyStatus status = sty_read_ply(put_file("mesh.ply", data, size), size % 2, &run, &mesh, &error);
  if (status) {
    require(!mesh);
    require_message(status, &error);
  }
  if (!mesh) return;
  require(whole);
  require(sty_compute_normals(mesh, (double)(size % 181), &run, &error) == STY_OK);
  check_mesh(mesh);
  sty_destroy_mesh(&mesh);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const bool whole = is_whole(data, size);
  if (whole) require(is_whole_with_more(data, size));
  read_triangles(data, size, whole);
  return 0;
}
