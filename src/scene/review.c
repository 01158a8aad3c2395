/* What is odd about a scene that can be rendered all the same. */
#include <stdarg.h>
#include <stdio.h>

#include "stylut/file.h"
#include "stylut/scene.h"

typedef struct Review {
  const StyScene *scene;
  void (*tell)(void *context, const char *line);
  void *context;
} Review;

__attribute__((format(printf, 2, 3))) static void tell(const Review *review, const char *format, ...) {
  char line[1024];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  sty_clean_text(line);
  review->tell(review->context, line);
}

static void review_materials(const Review *review) {
  for (int m = 0; m < review->scene->mesh_count; m++) {
    const StyMesh *mesh = review->scene->meshes[m];
    if (mesh->lost_materials)
      tell(review, "%s: found no material file %s, expected it beside the mesh", mesh->path, mesh->lost_materials);
  }
}

static void review_textures(const Review *review) {
  StyError error;
  for (int t = 0; t < review->scene->texture_count; t++) {
    const StyPicture *picture = &review->scene->textures[t];
    if (picture->bytes || sty_check_file(picture->path, NULL, &error) == STY_OK) continue;
    tell(review, "%s%s%s", picture->named_by ? picture->named_by : "", picture->named_by ? ": " : "", error.text);
  }
}

static bool is_textured(const StyObject *object, const StyMesh *mesh) {
  if (object->is_painted) return object->material.paint.texture >= 0;
  bool textured = false;
  for (int p = 0; mesh->paints && p < mesh->part_count; p++) textured |= mesh->paints[p].texture >= 0;
  return textured;
}

static void review_objects(const Review *review) {
  for (int o = 0; o < review->scene->object_count; o++) {
    const StyObject *object = &review->scene->objects[o];
    const StyMesh *mesh = review->scene->meshes[object->mesh];
    if (!mesh->uvs && is_textured(object, mesh))
      tell(review,
           "object %d: found a texture on %s, which has no texture coordinates, expected some: it shows one texel "
           "all over",
           o + 1, sty_name_mesh(mesh));
  }
}

void sty_review_scene(const StyScene *scene, void (*tell_line)(void *context, const char *line), void *context) {
  const Review review = {scene, tell_line, context};
  review_materials(&review);
  review_textures(&review);
  review_objects(&review);
}
