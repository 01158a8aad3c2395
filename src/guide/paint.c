#include "guide/paint.h"

#include <stdlib.h>

#include "bridge/texture.h"

struct StyPalette {
  StyTextureMap **textures; /* 1 per texture of the scene */
  int count;
  bool nearest;
};

/* Textures that some object shows: a mesh's own may all be painted over. */
static void mark_used(const StyScene *scene, bool *used) {
  for (int o = 0; o < scene->object_count; o++) {
    const StyObject *object = &scene->objects[o];
    const StyMesh *mesh = scene->meshes[object->mesh];
    if (object->is_painted && object->material.paint.texture >= 0) used[object->material.paint.texture] = true;
    for (int p = 0; !object->is_painted && mesh->paints && p < mesh->part_count; p++)
      if (mesh->paints[p].texture >= 0) used[mesh->paints[p].texture] = true;
  }
  for (int s = 0; s < scene->sphere_count; s++)
    if (scene->spheres[s].material.paint.texture >= 0) used[scene->spheres[s].material.paint.texture] = true;
}

static StyStatus open_used(StyPalette *palette, const StyScene *scene, StyError *error) {
  bool *used = calloc((size_t)scene->texture_count + 1, sizeof *used);
  if (!used) return sty_fail_memory(error, "textures", scene->texture_count);
  mark_used(scene, used);
  StyStatus status = STY_OK;
  for (int t = 0; t < scene->texture_count && !status; t++)
    if (used[t]) status = sty_open_texture_map(scene->textures[t], &palette->textures[t], error);
  free(used);
  return status;
}

StyStatus sty_open_palette(const StyScene *scene, bool nearest, StyPalette **out, StyError *error) {
  StyPalette *palette = calloc(1, sizeof *palette);
  if (palette) palette->textures = calloc((size_t)scene->texture_count + 1, sizeof(StyTextureMap *));
  if (!palette || !palette->textures) {
    free(palette);
    return sty_fail_memory(error, "textures", (double)scene->texture_count * sizeof(StyTextureMap *));
  }
  palette->nearest = nearest;
  palette->count = scene->texture_count;
  const StyStatus status = open_used(palette, scene, error);
  if (status)
    sty_close_palette(&palette);
  else
    *out = palette;
  return status;
}

void sty_close_palette(StyPalette **palette) {
  if (!palette || !*palette) return;
  for (int t = 0; t < (*palette)->count; t++) sty_close_texture_map(&(*palette)->textures[t]);
  free((*palette)->textures);
  free(*palette);
  *palette = NULL;
}

void sty_get_albedo(const StyPalette *palette, const StyHits *hits, int i, StyLane out[3]) {
  const StyPaint *paint = hits->paint[i];
  for (int k = 0; k < 3; k++) out[k][i] = paint->colour[k];
  if (paint->texture < 0) return;
  const double uv[2] = {hits->uv[0][i], hits->uv[1][i]};
  float texel[3];
  sty_sample_texture_map(palette->textures[paint->texture], uv, palette->nearest, texel);
  for (int k = 0; k < 3; k++) out[k][i] *= (double)texel[k];
}
