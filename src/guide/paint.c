#include "guide/paint.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include "bridge/texture.h"
#include "stylut/image_io.h"

struct StyPalette {
  const StyScene *scene;
  StyTextureMap **textures; /* 1 per texture of the scene */
  int *files;               /* those of pictures inside a mesh's file; -1: another's */
  atomic_bool *failed;      /* whether a look-up did; 1 per texture */
  int count;
  bool nearest;
};

static void mark_used(const StyPaint *paint, bool *used) {
  if (paint->texture >= 0) used[paint->texture] = true;
}

/* 1 per texture, to be freed: whether something shows it; a mesh's own may all be painted over. NULL: no memory. */
static bool *list_used(const StyScene *scene, StyError *error) {
  bool *used = calloc((size_t)scene->texture_count + 1, sizeof *used);
  if (!used) {
    sty_fail_memory(error, "textures", scene->texture_count);
    return NULL;
  }
  for (int o = 0; o < scene->object_count; o++) {
    const StyObject *object = &scene->objects[o];
    const StyMesh *mesh = scene->meshes[object->mesh];
    for (int p = 0; p < mesh->part_count; p++) mark_used(sty_get_paint(object, mesh, p), used);
  }
  for (int s = 0; s < scene->sphere_count; s++) mark_used(&scene->spheres[s].material.paint, used);
  return used;
}

/* Files that must be left to open beside those of pictures that came inside others. */
enum { SPARE_FILES = 16 };

/* A file without a place for what came inside another: picture libraries read files. Its path lives as long as it. */
static StyStatus make_file(const StyPicture *picture, int *file, char path[32], StyError *error) {
  struct rlimit files;
  *file = memfd_create("picture", MFD_CLOEXEC);
  if (getrlimit(RLIMIT_NOFILE, &files) == 0 && (*file < 0 || (rlim_t)*file + SPARE_FILES > files.rlim_cur))
    return sty_fail(error, STY_ERROR_LIBRARY,
                    "%s: found no room for another open file, expected more than the %llu that 'ulimit -n' grants",
                    picture->path, (unsigned long long)files.rlim_cur);
  for (size_t done = 0; *file >= 0 && done < picture->size;) {
    const ssize_t written = write(*file, picture->bytes + done, picture->size - done);
    if (written <= 0) return sty_fail_memory(error, picture->path, (double)picture->size);
    done += (size_t)written;
  }
  snprintf(path, 32, "/proc/self/fd/%d", *file);
  return *file >= 0 ? STY_OK : sty_fail_memory(error, picture->path, (double)picture->size);
}

/* What is wrong with a picture, the cause beginning with its file's path: said with who names it or, of one inside a
 * mesh's file, with what that is called. */
static StyStatus blame_picture(const StyPicture *picture, const char *path, const StyError *cause, StyError *error) {
  const char *by = picture->named_by ? picture->named_by : "", *colon = picture->named_by ? ": " : "";
  if (!picture->bytes) return sty_fail(error, cause->status, "%s%s%s", by, colon, cause->text);
  const size_t length = strncmp(cause->text, path, strlen(path)) == 0 ? strlen(path) : 0;
  return sty_fail(error, cause->status, "%s%s", picture->path, cause->text + length);
}

static StyStatus open_picture(StyPalette *palette, const StyPicture *picture, int number, StyError *error) {
  char inner[32];
  const char *path = picture->bytes ? inner : picture->path;
  StyError cause;
  StyStatus status = picture->bytes ? make_file(picture, &palette->files[number], inner, error) : STY_OK;
  if (!status && sty_open_texture_map(path, &palette->textures[number], &cause))
    status = blame_picture(picture, path, &cause, error);
  return status;
}

static StyStatus measure_picture(const StyPicture *picture, StyImageShape *shape, StyError *error) {
  char inner[32];
  const char *path = picture->bytes ? inner : picture->path;
  int file = -1;
  StyError cause;
  StyStatus status = picture->bytes ? make_file(picture, &file, inner, error) : STY_OK;
  if (!status && sty_read_image_shape(path, shape, &cause)) status = blame_picture(picture, path, &cause, error);
  if (file >= 0) close(file);
  return status;
}

static StyStatus open_used(StyPalette *palette, const StyScene *scene, StyError *error) {
  bool *used = list_used(scene, error);
  if (!used) return STY_ERROR_LIBRARY;
  StyStatus status = STY_OK;
  for (int t = 0; t < scene->texture_count && !status; t++)
    if (used[t]) status = open_picture(palette, &scene->textures[t], t, error);
  free(used);
  return status;
}

StyStatus sty_estimate_palette(const StyScene *scene, double *bytes, double *decode_bytes, StyError *error) {
  bool *used = list_used(scene, error);
  if (!used) return STY_ERROR_LIBRARY;
  StyStatus status = STY_OK;
  *bytes = *decode_bytes = 0;
  for (int t = 0; t < scene->texture_count && !status; t++) {
    StyImageShape shape = {0};
    if (used[t]) status = measure_picture(&scene->textures[t], &shape, error);
    const double texels = (double)shape.width * shape.height;
    *bytes += 3 * sizeof(float) * texels + (double)scene->textures[t].size;
    *decode_bytes = fmax(*decode_bytes, texels * shape.channels * sizeof(float));
  }
  free(used);
  return status;
}

StyStatus sty_open_palette(const StyScene *scene, bool nearest, StyPalette **out, StyError *error) {
  const size_t count = (size_t)scene->texture_count;
  StyPalette *palette = calloc(1, sizeof *palette);
  if (!palette) return sty_fail_memory(error, "textures", sizeof *palette);
  palette->textures = calloc(count + 1, sizeof(StyTextureMap *));
  palette->files = malloc((count + 1) * sizeof *palette->files);
  palette->failed = calloc(count + 1, sizeof *palette->failed);
  palette->scene = scene;
  palette->nearest = nearest;
  StyStatus status = STY_OK;
  if (palette->textures && palette->files && palette->failed) {
    palette->count = scene->texture_count;
    for (size_t t = 0; t < count; t++) palette->files[t] = -1;
    status = open_used(palette, scene, error);
  } else {
    status = sty_fail_memory(error, "textures", (double)count * sizeof(StyTextureMap *));
  }
  if (status)
    sty_close_palette(&palette);
  else
    *out = palette;
  return status;
}

void sty_close_palette(StyPalette **palette) {
  if (!palette || !*palette) return;
  for (int t = 0; t < (*palette)->count; t++) {
    sty_close_texture_map(&(*palette)->textures[t]);
    if ((*palette)->files[t] >= 0) close((*palette)->files[t]);
  }
  free((*palette)->textures);
  free((*palette)->files);
  free((*palette)->failed);
  free(*palette);
  *palette = NULL;
}

void sty_get_albedo(const StyPalette *palette, const StyHits *hits, int i, StyLane out[3]) {
  const StyPaint *paint = hits->paint[i];
  for (int k = 0; k < 3; k++) out[k][i] = paint->colour[k];
  if (paint->texture < 0) return;
  const double uv[2] = {hits->uv[0][i], hits->uv[1][i]};
  float texel[3];
  if (!sty_sample_texture_map(palette->textures[paint->texture], uv, palette->nearest, texel))
    atomic_store_explicit(&palette->failed[paint->texture], true, memory_order_relaxed);
  for (int k = 0; k < 3; k++) out[k][i] *= (double)texel[k];
}

StyStatus sty_check_palette(const StyPalette *palette, StyError *error) {
  for (int t = 0; t < palette->count; t++)
    if (atomic_load_explicit(&palette->failed[t], memory_order_relaxed))
      return sty_fail(error, STY_ERROR_LIBRARY,
                      "%s: found no colour when it was looked up, expected a picture that stays and memory for it",
                      palette->scene->textures[t].path);
  return STY_OK;
}
