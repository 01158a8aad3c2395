/* Meshes, and their way from the process that imports them. */
#include "stylut/mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/contain.h"
#include "base/memory.h"
#include "scene/corners.h"
#include "scene/import.h"
#include "scene/normals.h"
#include "scene/picture.h"
#include "scene/ply.h"
#include "stylut/ceilings.h"
#include "stylut/file.h"

static const double DEFAULT_CREASE_ANGLE = 60;

/* What an import may take: good files need a small part of it. */
static const double LEAST_SECONDS = 20, BYTES_PER_SECOND = 4e6;
static const double LEAST_ADDRESSES = 200e6, ADDRESSES_PER_BYTE = 16; /* and what they take, where addresses are few */
static const double LEAST_BYTES = 2.0 * 1024 * 1024 * 1024, MEMORY_PER_BYTE = 64;

typedef struct Reading {
  const char *path;
  bool keep_normals;
  StyMesh *mesh;
} Reading;

/* ---- the mesh's arrays ---------------------------------------------------------- */

static size_t count_positions(const StyMesh *mesh) { return 3 * mesh->vertex_count + 1; }

static bool allocate_arrays(StyMesh *mesh, bool has_uvs, bool has_parts) {
  mesh->positions = malloc(count_positions(mesh) * sizeof *mesh->positions);
  mesh->normals = malloc(3 * mesh->vertex_count * sizeof *mesh->normals);
  mesh->uvs = has_uvs ? malloc(2 * mesh->vertex_count * sizeof *mesh->uvs) : NULL;
  mesh->indices = malloc(3 * mesh->triangle_count * sizeof *mesh->indices);
  mesh->part_ids = has_parts ? malloc(mesh->triangle_count * sizeof *mesh->part_ids) : NULL;
  mesh->paints = malloc((size_t)mesh->part_count * sizeof *mesh->paints);
  mesh->textures = calloc((size_t)mesh->texture_count + 1, sizeof *mesh->textures);
  return mesh->positions && mesh->normals && (!has_uvs || mesh->uvs) && mesh->indices &&
         (!has_parts || mesh->part_ids) && mesh->paints && mesh->textures;
}

static void send_text(StyPipe *pipe, const char *text) {
  const size_t length = text ? strlen(text) : 0;
  sty_send(pipe, &length, sizeof length);
  sty_send(pipe, text, length);
}

static void send_mesh(const void *context, StyPipe *pipe) {
  const StyMesh *mesh = ((const Reading *)context)->mesh;
  sty_send(pipe, mesh, sizeof *mesh); /* whose pointers only say what is there */
  sty_send(pipe, mesh->positions, count_positions(mesh) * sizeof *mesh->positions);
  sty_send(pipe, mesh->normals, 3 * mesh->vertex_count * sizeof *mesh->normals);
  if (mesh->uvs) sty_send(pipe, mesh->uvs, 2 * mesh->vertex_count * sizeof *mesh->uvs);
  sty_send(pipe, mesh->indices, 3 * mesh->triangle_count * sizeof *mesh->indices);
  if (mesh->part_ids) sty_send(pipe, mesh->part_ids, mesh->triangle_count * sizeof *mesh->part_ids);
  sty_send(pipe, mesh->paints, (size_t)mesh->part_count * sizeof *mesh->paints);
  for (int t = 0; t < mesh->texture_count; t++) {
    const StyPicture *picture = &mesh->textures[t];
    send_text(pipe, picture->path);
    send_text(pipe, picture->named_by);
    sty_send(pipe, &picture->size, sizeof picture->size);
    sty_send(pipe, picture->bytes, picture->size);
  }
  send_text(pipe, mesh->lost_materials);
}

enum { MOST_TEXT_BYTES = 1 << 20, MOST_PICTURE_BYTES = 1 << 30 };

static bool receive_text(StyPipe *pipe, char **out) {
  size_t length = 0;
  if (!sty_receive(pipe, &length, sizeof length) || length > MOST_TEXT_BYTES) return false;
  if (length == 0) return true; /* no text */
  *out = calloc(length + 1, 1);
  return *out && sty_receive(pipe, *out, length);
}

static bool receive_picture(StyPipe *pipe, StyPicture *out) {
  if (!receive_text(pipe, &out->path) || !out->path || !receive_text(pipe, &out->named_by)) return false;
  if (!sty_receive(pipe, &out->size, sizeof out->size) || out->size > MOST_PICTURE_BYTES) return false;
  if (out->size) out->bytes = malloc(out->size);
  return out->size == 0 || (out->bytes && sty_receive(pipe, out->bytes, out->size));
}

static bool receive_arrays(StyPipe *pipe, StyMesh *mesh) {
  bool whole = sty_receive(pipe, mesh->positions, count_positions(mesh) * sizeof *mesh->positions) &&
               sty_receive(pipe, mesh->normals, 3 * mesh->vertex_count * sizeof *mesh->normals) &&
               (!mesh->uvs || sty_receive(pipe, mesh->uvs, 2 * mesh->vertex_count * sizeof *mesh->uvs)) &&
               sty_receive(pipe, mesh->indices, 3 * mesh->triangle_count * sizeof *mesh->indices) &&
               (!mesh->part_ids || sty_receive(pipe, mesh->part_ids, mesh->triangle_count * sizeof *mesh->part_ids)) &&
               sty_receive(pipe, mesh->paints, (size_t)mesh->part_count * sizeof *mesh->paints);
  for (int t = 0; whole && t < mesh->texture_count; t++) whole = receive_picture(pipe, &mesh->textures[t]);
  return whole && receive_text(pipe, &mesh->lost_materials);
}

/* An importer that wrote where it shouldn't may have sent anything. */
static bool is_sound(const StyMesh *mesh) {
  for (size_t i = 0; i < 3 * mesh->triangle_count; i++)
    if (mesh->indices[i] >= mesh->vertex_count) return false;
  for (size_t t = 0; mesh->part_ids && t < mesh->triangle_count; t++)
    if (mesh->part_ids[t] < 1 || mesh->part_ids[t] > (uint32_t)mesh->part_count) return false;
  for (int p = 0; p < mesh->part_count; p++)
    if (mesh->paints[p].texture >= mesh->texture_count) return false;
  return true;
}

static bool is_possible(const StyMesh *mesh) {
  return mesh->triangle_count > 0 && mesh->triangle_count <= STY_MAX_TRIANGLES && mesh->vertex_count > 0 &&
         mesh->vertex_count <= 3 * mesh->triangle_count && mesh->part_count > 0 &&
         (size_t)mesh->part_count <= mesh->triangle_count && (mesh->part_ids || mesh->part_count == 1) &&
         mesh->texture_count >= 0 && mesh->texture_count <= mesh->part_count;
}

static StyStatus receive_mesh(void *context, StyPipe *pipe, StyError *error) {
  Reading *reading = context;
  StyMesh *mesh = calloc(1, sizeof *mesh), sent;
  reading->mesh = mesh;
  if (!mesh) return sty_fail_memory(error, reading->path, sizeof *mesh);
  bool whole = sty_receive(pipe, &sent, sizeof sent) && is_possible(&sent);
  if (whole) {
    *mesh = sent;
    mesh->textures = NULL; /* pointers are the child's until all are set */
    mesh->lost_materials = NULL;
    mesh->path = strdup(reading->path);
    if (!allocate_arrays(mesh, sent.uvs, sent.part_ids) || !mesh->path)
      return sty_fail_memory(error, reading->path, 36.0 * (double)mesh->vertex_count);
    whole = receive_arrays(pipe, mesh) && is_sound(mesh);
  }
  return whole ? STY_OK
               : sty_fail(error, STY_ERROR_INPUT,
                          "%s: the importer ended before the mesh was whole; expected a file "
                          "that it can read",
                          reading->path);
}

static StyStatus import_mesh(void *context, StyError *error) {
  Reading *reading = context;
  return sty_import_mesh(reading->path, reading->keep_normals, &reading->mesh, error);
}

static StyStatus run_importer(const char *path, bool keep_normals, StyMesh **out, StyError *error) {
  uint64_t size = 0;
  Reading reading = {path, keep_normals, NULL};
  sty_check_file(path, &size, NULL); /* what is wrong with it, the import says */
  const double room = sty_get_address_room(), needed = LEAST_ADDRESSES + (double)size * ADDRESSES_PER_BYTE;
  if (room < needed) return sty_fail_memory(error, path, needed);
  const double seconds = sty_get_ceiling(STY_CEILING_IMPORT_SECONDS), bytes = sty_get_ceiling(STY_CEILING_IMPORT_BYTES);
  StyContained contained = {.name = path,
                            .worker = "the importer",
                            .seconds = seconds > 0 ? seconds : LEAST_SECONDS + (double)size / BYTES_PER_SECOND,
                            .bytes = bytes > 0 ? bytes : fmax(LEAST_BYTES, (double)size * MEMORY_PER_BYTE),
                            .more_seconds = "--limit import-seconds=N",
                            .more_bytes = "--limit import-bytes=N",
                            .work = import_mesh,
                            .send = send_mesh,
                            .receive = receive_mesh,
                            .context = &reading};
  StyStatus status = sty_open_importer(error);
  if (!status) status = sty_run_contained(&contained, error);
  if (status)
    sty_destroy_mesh(&reading.mesh);
  else
    *out = reading.mesh;
  if (!status) (*out)->import_bytes = contained.peak_bytes;
  return status;
}

/* ---- the mesh ------------------------------------------------------------------- */

StyStatus sty_read_mesh(const char *path, const StyMeshOptions *options, StyMesh **out, StyError *error) {
  const double asked = options ? options->crease_angle : -1, crease_angle = asked < 0 ? DEFAULT_CREASE_ANGLE : asked;
  const StyRun *run = options ? options->run : NULL;
  if (isnan(asked) || asked > 180)
    return sty_fail(error, STY_ERROR_USAGE, "crease angle: found %g, expected 0 to 180 degrees", asked);
  StyMesh *mesh = NULL;
  sty_begin_stage(run, "reading");
  StyStatus status = sty_is_ply(path) ? sty_read_ply(path, asked < 0, run, &mesh, error) : STY_OK;
  if (!status && !mesh) status = run_importer(path, asked < 0, &mesh, error);
  sty_begin_stage(run, "smoothing");
  if (!status) status = sty_compute_normals(mesh, crease_angle, run, error);
  if (status)
    sty_destroy_mesh(&mesh);
  else
    *out = mesh;
  return status;
}

double sty_get_mesh_bytes(const StyMesh *mesh) {
  const size_t vertex = 6 * sizeof(float) + (mesh->uvs ? 2 * sizeof(float) : 0);
  const size_t triangle = 3 * sizeof(uint32_t) + (mesh->part_ids ? sizeof(uint32_t) : 0);
  return (double)(mesh->vertex_count * vertex + mesh->triangle_count * triangle);
}

void sty_destroy_pictures(StyPicture *pictures, int count) {
  for (int p = 0; pictures && p < count; p++) {
    free(pictures[p].path);
    free(pictures[p].named_by);
    free(pictures[p].bytes);
  }
  free(pictures);
}

void sty_destroy_mesh(StyMesh **mesh) {
  if (!mesh || !*mesh) return;
  free((*mesh)->path);
  free((*mesh)->lost_materials);
  free((*mesh)->positions);
  free((*mesh)->normals);
  free((*mesh)->uvs);
  free((*mesh)->paints);
  sty_destroy_pictures((*mesh)->textures, (*mesh)->texture_count);
  free((*mesh)->indices);
  free((*mesh)->part_ids);
  free(*mesh);
  *mesh = NULL;
}
