#include "stylut/scene.h"

#include <stdlib.h>
#include <string.h>

#include "scene/picture.h"
#include "scene/points.h"
#include "scene/vector.h"

const StyMaterial sty_white = {.paint = {{1, 1, 1}, -1}, .shininess = 1};
const double sty_identity[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};

StyStatus sty_create_scene(StyScene **out, StyError *error) {
  StyScene *scene = calloc(1, sizeof *scene);
  if (!scene) return sty_fail_memory(error, "scene", sizeof *scene);
  *scene = (StyScene){.ambient = 1, .shadows = true};
  *out = scene;
  return STY_OK;
}

void sty_destroy_scene(StyScene **scene) {
  if (!scene || !*scene) return;
  for (int m = 0; m < (*scene)->mesh_count; m++) sty_destroy_mesh(&(*scene)->meshes[m]);
  free((*scene)->meshes);
  free((*scene)->objects);
  free((*scene)->spheres);
  free((*scene)->lights);
  sty_destroy_pictures((*scene)->textures, (*scene)->texture_count);
  free(*scene);
  *scene = NULL;
}

/* Room for one more element of a list whose capacity is the power of two at its count. */
static StyStatus grow(void **list, int count, size_t size, const char *what, StyError *error) {
  if (count & (count - 1)) return STY_OK;
  const size_t capacity = count ? 2 * (size_t)count : 1;
  void *grown = realloc(*list, capacity * size);
  if (!grown) return sty_fail_memory(error, what, (double)(capacity * size));
  *list = grown;
  return STY_OK;
}

static StyStatus check_count(const StyScene *scene, StyError *error) {
  if (scene->object_count + scene->sphere_count < STY_MOST_OBJECTS) return STY_OK;
  return sty_fail(error, STY_ERROR_INPUT, "scene: found more than %d objects and spheres, expected no more",
                  STY_MOST_OBJECTS);
}

static int find_texture(const StyScene *scene, const char *path) {
  for (int t = 0; t < scene->texture_count; t++)
    if (strcmp(scene->textures[t].path, path) == 0) return t;
  return -1;
}

/* Takes what the picture owns over, unless it fails. */
static StyStatus append_texture(StyScene *scene, const StyPicture *picture, StyError *error) {
  if (scene->texture_count == STY_MOST_TEXTURES)
    return sty_fail(error, STY_ERROR_INPUT, "scene: found more than %d textures, expected no more", STY_MOST_TEXTURES);
  void *list = scene->textures;
  const StyStatus status = grow(&list, scene->texture_count, sizeof *scene->textures, "textures", error);
  scene->textures = list;
  if (!status) scene->textures[scene->texture_count++] = *picture;
  return status;
}

/* Takes the picture over, unless it fails or the scene has it. */
static StyStatus take_texture(StyScene *scene, StyPicture *picture, int *number, StyError *error) {
  const int known = find_texture(scene, picture->path);
  const StyStatus status = known < 0 ? append_texture(scene, picture, error) : STY_OK;
  if (status) return status;
  *number = known < 0 ? scene->texture_count - 1 : known;
  if (known < 0) *picture = (StyPicture){0};
  return STY_OK;
}

StyStatus sty_add_texture(StyScene *scene, const char *path, const char *named_by, int *number, StyError *error) {
  StyPicture picture = {.path = strdup(path), .named_by = named_by ? strdup(named_by) : NULL};
  const bool whole = picture.path && (!named_by || picture.named_by);
  const StyStatus status =
      whole ? take_texture(scene, &picture, number, error) : sty_fail_memory(error, path, (double)strlen(path));
  free(picture.path);
  free(picture.named_by);
  return status;
}

/* The mesh's textures become the scene's. */
static StyStatus take_textures(StyScene *scene, StyMesh *mesh, StyError *error) {
  int *numbers = malloc(((size_t)mesh->texture_count + 1) * sizeof *numbers);
  if (!numbers) return sty_fail_memory(error, "textures", mesh->texture_count);
  StyStatus status = STY_OK;
  for (int t = 0; t < mesh->texture_count && !status; t++)
    status = take_texture(scene, &mesh->textures[t], &numbers[t], error);
  for (int p = 0; mesh->paints && p < mesh->part_count && !status; p++)
    if (mesh->paints[p].texture >= 0) mesh->paints[p].texture = numbers[mesh->paints[p].texture];
  free(numbers);
  sty_destroy_pictures(mesh->textures, mesh->texture_count);
  mesh->textures = NULL;
  mesh->texture_count = 0;
  return status;
}

StyStatus sty_add_mesh(StyScene *scene, StyMesh **mesh, int *number, StyError *error) {
  void *list = scene->meshes;
  StyStatus status = grow(&list, scene->mesh_count, sizeof *scene->meshes, "meshes", error);
  scene->meshes = list;
  if (!status) status = take_textures(scene, *mesh, error);
  if (status) {
    sty_destroy_mesh(mesh);
    return status;
  }
  *number = scene->mesh_count;
  scene->meshes[scene->mesh_count++] = *mesh;
  *mesh = NULL;
  return STY_OK;
}

/* A volume that floats, in which rays are cast, can tell from none. */
static bool is_regular(const double m[3][4]) {
  double size = 1, cross[3];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 4; j++)
      if (!isfinite(m[i][j])) return false;
  cross_vectors(m[1], m[2], cross);
  const double volume = dot_vectors(m[0], cross);
  for (int i = 0; i < 3; i++) size *= sqrt(dot_vectors(m[i], m[i]));
  return fabs(volume) > 2e-7 * size && isfinite(volume);
}

StyStatus sty_add_object(StyScene *scene, const StyObject *object, StyError *error) {
  if (!is_regular(object->transform))
    return sty_fail(error, STY_ERROR_INPUT,
                    "transform: found one that makes things flat, expected three rows that point in three directions");
  void *list = scene->objects;
  StyStatus status = check_count(scene, error);
  if (!status) status = grow(&list, scene->object_count, sizeof *scene->objects, "objects", error);
  scene->objects = list;
  if (!status) scene->objects[scene->object_count++] = *object;
  return status;
}

StyStatus sty_add_sphere(StyScene *scene, const StySphere *sphere, StyError *error) {
  if (!(sphere->radius > 0))
    return sty_fail(error, STY_ERROR_INPUT, "sphere: found radius %g, expected one above 0", sphere->radius);
  void *list = scene->spheres;
  StyStatus status = check_count(scene, error);
  if (!status) status = grow(&list, scene->sphere_count, sizeof *scene->spheres, "spheres", error);
  scene->spheres = list;
  if (!status) scene->spheres[scene->sphere_count++] = *sphere;
  return status;
}

StyStatus sty_add_light(StyScene *scene, const StyLight *light, StyError *error) {
  double direction[3] = {light->direction[0], light->direction[1], light->direction[2]};
  if (!light->is_point && !normalize_vector(direction))
    return sty_fail(error, STY_ERROR_INPUT, "light: found the direction (%g, %g, %g), expected one with a length",
                    light->direction[0], light->direction[1], light->direction[2]);
  if (scene->light_count == STY_MOST_LIGHTS)
    return sty_fail(error, STY_ERROR_INPUT, "scene: found more than %d lights, expected no more", STY_MOST_LIGHTS);
  void *list = scene->lights;
  const StyStatus status = grow(&list, scene->light_count, sizeof *scene->lights, "lights", error);
  scene->lights = list;
  if (!status) scene->lights[scene->light_count++] = *light;
  return status;
}

/* ---- points ------------------------------------------------------------------- */

void sty_get_object_matrix(const StyScene *scene, const StyObject *object, double out[3][4]) {
  const StyMesh *mesh = scene->meshes[object->mesh];
  for (int i = 0; i < 3; i++) {
    const double *row = object->transform[i];
    double moved = row[3] - scene->centre[i];
    for (int j = 0; j < 3; j++) {
      /* In this order a mesh that stands alone keeps its own trace space to the bit. */
      out[i][j] = row[j] * (scene->scale / mesh->scale);
      moved += row[j] * mesh->centre[j];
    }
    out[i][3] = moved * scene->scale;
  }
}

static void visit_object(const double matrix[3][4], const StyMesh *mesh,
                         void (*visit)(void *context, const double at[3], double radius), void *context) {
  for (size_t v = 0; v < mesh->vertex_count; v++) {
    const float *p = &mesh->positions[3 * v];
    double at[3];
    for (int i = 0; i < 3; i++) at[i] = matrix[i][0] * p[0] + matrix[i][1] * p[1] + matrix[i][2] * p[2] + matrix[i][3];
    visit(context, at, 0);
  }
}

void sty_visit_points(const StyScene *scene, void (*visit)(void *context, const double at[3], double radius),
                      void *context) {
  for (int o = 0; o < scene->object_count; o++) {
    double matrix[3][4];
    sty_get_object_matrix(scene, &scene->objects[o], matrix);
    visit_object(matrix, scene->meshes[scene->objects[o].mesh], visit, context);
  }
  for (int s = 0; s < scene->sphere_count; s++) {
    double at[3];
    sty_get_trace_point(scene, scene->spheres[s].centre, at);
    visit(context, at, scene->spheres[s].radius * scene->scale);
  }
}

/* ---- the whole ---------------------------------------------------------------- */

static void extend_bounds(void *context, const double at[3], double radius) {
  StyScene *scene = context;
  for (int k = 0; k < 3; k++) {
    scene->minimum[k] = fmin(scene->minimum[k], at[k] - radius);
    scene->maximum[k] = fmax(scene->maximum[k], at[k] + radius);
  }
}

static bool is_alone(const StyScene *scene) {
  return scene->object_count == 1 && scene->sphere_count == 0 &&
         memcmp(scene->objects->transform, sty_identity, sizeof sty_identity) == 0;
}

/* World bounds: with trace space the same as the world, points come in the world's coordinates. */
static void measure_bounds(StyScene *scene) {
  scene->scale = 1;
  for (int k = 0; k < 3; k++) {
    scene->centre[k] = 0;
    scene->minimum[k] = INFINITY;
    scene->maximum[k] = -INFINITY;
  }
  sty_visit_points(scene, extend_bounds, scene);
}

/* The space of the mesh that stands alone, so that its vertices need not be moved. */
static void copy_space(StyScene *scene, const StyMesh *mesh) {
  memcpy(scene->minimum, mesh->minimum, sizeof scene->minimum);
  memcpy(scene->maximum, mesh->maximum, sizeof scene->maximum);
  memcpy(scene->centre, mesh->centre, sizeof scene->centre);
  scene->scale = mesh->scale;
}

static StyStatus set_trace_space(StyScene *scene, StyError *error) {
  double extent = 0;
  for (int k = 0; k < 3; k++) {
    if (!(fabs(scene->minimum[k]) <= STY_MAX_COORDINATE && fabs(scene->maximum[k]) <= STY_MAX_COORDINATE))
      return sty_fail(error, STY_ERROR_INPUT, "scene: found coordinates from %g to %g, expected them within %g",
                      scene->minimum[k], scene->maximum[k], STY_MAX_COORDINATE);
    scene->centre[k] = (scene->minimum[k] + scene->maximum[k]) / 2;
    extent = fmax(extent, scene->maximum[k] - scene->minimum[k]);
  }
  scene->scale = 2 / extent;
  return extent > 0 && isfinite(scene->scale)
             ? STY_OK
             : sty_fail(error, STY_ERROR_INPUT, "scene: found no extent, expected something to see");
}

/* The extent of an object in the direction where it is thinnest, as a share of the scene's: that of a mesh is 1 in its
 * own trace space, and the inverse of the matrix enlarges by no more than its norm. */
static double measure_thickness(const StyScene *scene, const StyObject *object) {
  double m[3][4], cofactors[3][3], squared = 0;
  sty_get_object_matrix(scene, object, m);
  for (int i = 0; i < 3; i++) {
    cross_vectors(m[(i + 1) % 3], m[(i + 2) % 3], cofactors[i]);
    squared += dot_vectors(cofactors[i], cofactors[i]);
  }
  return fabs(dot_vectors(m[0], cofactors[0])) / sqrt(squared);
}

/* Embree brings rays to an object's own space, and aborts the program where they reach 1e18 there: more than
 * STY_MAX_CAMERA over the thickness, with room to spare. */
static StyStatus check_thickness(const StyScene *scene, StyError *error) {
  for (int o = 0; o < scene->object_count; o++) {
    const double thickness = measure_thickness(scene, &scene->objects[o]);
    if (!(thickness >= STY_MIN_THICKNESS))
      return sty_fail(error, STY_ERROR_INPUT,
                      "scene: found object %d only %.3g of the scene's size thick, expected at least %g", o + 1,
                      thickness, STY_MIN_THICKNESS);
  }
  return STY_OK;
}

StyStatus sty_finish_scene(StyScene *scene, StyError *error) {
  if (scene->object_count + scene->sphere_count == 0)
    return sty_fail(error, STY_ERROR_INPUT, "scene: found nothing in it, expected an object or a sphere");
  int id = 1;
  for (int o = 0; o < scene->object_count; o++) {
    scene->objects[o].first_id = id;
    id += scene->meshes[scene->objects[o].mesh]->part_count;
  }
  for (int s = 0; s < scene->sphere_count; s++) scene->spheres[s].id = id++;
  if (is_alone(scene)) {
    copy_space(scene, scene->meshes[scene->objects->mesh]);
    return STY_OK;
  }
  measure_bounds(scene);
  const StyStatus status = set_trace_space(scene, error);
  return status ? status : check_thickness(scene, error);
}

StyStatus sty_wrap_mesh(StyMesh **mesh, StyScene **out, StyError *error) {
  StyScene *scene = NULL;
  StyObject object = {.style = 1, .material = sty_white};
  memcpy(object.transform, sty_identity, sizeof sty_identity);
  StyStatus status = sty_create_scene(&scene, error);
  if (status) {
    sty_destroy_mesh(mesh);
    return status;
  }
  status = sty_add_mesh(scene, mesh, &object.mesh, error);
  if (!status) status = sty_add_object(scene, &object, error);
  if (!status) status = sty_finish_scene(scene, error);
  if (status)
    sty_destroy_scene(&scene);
  else
    *out = scene;
  return status;
}

size_t sty_count_scene_triangles(const StyScene *scene) {
  size_t count = 0;
  for (int o = 0; o < scene->object_count; o++) count += scene->meshes[scene->objects[o].mesh]->triangle_count;
  return count;
}
