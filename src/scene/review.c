/* What is odd about a scene that can be rendered all the same. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "scene/points.h"
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
    if (mesh->lost_materials) tell(review, "%s: found no %s, which it names", mesh->path, mesh->lost_materials);
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

/* ---- textures without coordinates ---- */

/* 1 per part, to be freed: whether it has coordinates other than the 0 that stands for none; NULL: no memory. */
static bool *list_placed_parts(const StyMesh *mesh) {
  bool *placed = calloc((size_t)mesh->part_count, sizeof *placed);
  for (size_t t = 0; placed && mesh->uvs && t < mesh->triangle_count; t++)
    for (size_t c = 0; c < 3 && !placed[sty_get_part(mesh, t) - 1]; c++) {
      const float *uv = &mesh->uvs[2 * (size_t)mesh->indices[3 * t + c]];
      placed[sty_get_part(mesh, t) - 1] = uv[0] != 0 || uv[1] != 0;
    }
  return placed;
}

static bool is_textured(const StyObject *object, const StyMesh *mesh, int part) {
  return sty_get_paint(object, mesh, part)->texture >= 0;
}

/* The first part that has a texture and no coordinates; the number of parts: there is none. */
static int find_bare_part(const StyObject *object, const StyMesh *mesh) {
  int part = 0;
  while (part < mesh->part_count && !is_textured(object, mesh, part)) part++;
  bool *placed = part < mesh->part_count ? list_placed_parts(mesh) : NULL;
  while (part < mesh->part_count && (!placed || placed[part] || !is_textured(object, mesh, part))) part++;
  free(placed);
  return part;
}

static void review_coordinates(const Review *review) {
  for (int o = 0; o < review->scene->object_count; o++) {
    const StyObject *object = &review->scene->objects[o];
    const StyMesh *mesh = review->scene->meshes[object->mesh];
    const int part = find_bare_part(object, mesh);
    if (part < mesh->part_count)
      tell(
          review,
          "object %d: found a texture on part %d of %s, which has no texture coordinates, expected some: the texture's "
          "corner is its colour all over",
          o + 1, part + 1, sty_name_mesh(mesh));
  }
}

/* ---- things too small for floats ---- */

/* Rays are traced in floats, as shares of the scene: of smaller things, they may miss the surface. */
static const double LEAST_EXTENT = 1e-5;

/* Half the longest side of an object's box, as a share of the scene's. */
static double measure_object(const StyScene *scene, const StyObject *object) {
  const StyMesh *mesh = scene->meshes[object->mesh];
  double matrix[3][4], most = 0;
  sty_get_object_matrix(scene, object, matrix);
  for (int i = 0; i < 3; i++) {
    double half = 0;
    for (int j = 0; j < 3; j++) half += fabs(matrix[i][j]) * (mesh->maximum[j] - mesh->minimum[j]) / 2 * mesh->scale;
    most = fmax(most, half);
  }
  return most;
}

static void tell_of_size(const Review *review, const char *what, int number, double extent) {
  if (extent < LEAST_EXTENT)
    tell(review, "%s %d: found it to be %.2g of the scene's size, expected at least %g: rays may miss its surface",
         what, number, extent, LEAST_EXTENT);
}

static void review_sizes(const Review *review) {
  const StyScene *scene = review->scene;
  for (int o = 0; o < scene->object_count; o++)
    tell_of_size(review, "object", o + 1, measure_object(scene, &scene->objects[o]));
  for (int s = 0; s < scene->sphere_count; s++)
    tell_of_size(review, "sphere", s + 1, scene->spheres[s].radius * scene->scale);
}

void sty_review_scene(const StyScene *scene, void (*tell_line)(void *context, const char *line), void *context) {
  const Review review = {scene, tell_line, context};
  review_materials(&review);
  review_textures(&review);
  review_coordinates(&review);
  review_sizes(&review);
}
