#include "stylut/scene_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "stylut/file.h"
#include "stylut/json.h"

static const char *const scene_schema = "stylut-scene/1";
static const double default_ambient = 0.1, default_shininess = 32;

/* What is read, and the meshes that were read for it. */
typedef struct Reading {
  StyDocument document;
  char *folder;
  const StyMeshOptions *options;
  StyScene *scene;
  const char **names; /* of the scene's meshes, as the file has them; owned by the document */
} Reading;

/* ---- what the parts share ------------------------------------------------------ */

static StyStatus require_key(const StyDocument *document, const StyPath *path, const json_t *object, const char *key,
                             const char *expected, StyError *error) {
  char found[64];
  if (json_object_get(object, key)) return STY_OK;
  snprintf(found, sizeof found, "no key \"%s\"", key);
  return sty_fail_found(document, path, found, expected, error);
}

/* Keys of another type than the one that goes without saying: there they would be unknown. */
static StyStatus check_type_given(const StyDocument *document, const StyPath *path, const json_t *object,
                                  const char *const *keys, const char *expected, StyError *error) {
  char found[64];
  for (int k = 0; keys[k] && !json_object_get(object, "type"); k++) {
    if (!json_object_get(object, keys[k])) continue;
    snprintf(found, sizeof found, "a \"%s\" but no \"type\"", keys[k]);
    return sty_fail_found(document, path, found, expected, error);
  }
  return STY_OK;
}

/* What is wrong with something that a value stands for or names, with the value's place. */
static StyStatus place_error(const StyDocument *document, const StyPath *path, StyStatus status, const char *text,
                             StyError *error) {
  char place[STY_PLACE_SIZE];
  sty_name_place(document, path, place, sizeof place);
  return sty_fail(error, status, "%s: %s", place, text);
}

/* "found ...", of a message that begins with what it is about. */
static const char *skip_subject(const char *text) {
  const char *found = strstr(text, "found ");
  return found ? found : text;
}

/* A list of the root's, object by object. */
static StyStatus read_list(Reading *reading, const char *key, int most,
                           StyStatus (*read)(Reading *, const StyPath *, const json_t *, StyError *), StyError *error) {
  const StyDocument *document = &reading->document;
  const json_t *list = json_object_get(document->root, key);
  const StyPath path = {NULL, key, 0};
  char expected[64];
  if (!list) return STY_OK;
  snprintf(expected, sizeof expected, "a list of at most %d %s", most, key);
  if (!json_is_array(list) || json_array_size(list) > (size_t)most)
    return sty_fail_value(document, &path, list, expected, error);
  StyStatus status = STY_OK;
  for (size_t i = 0; !status && i < json_array_size(list); i++)
    status = read(reading, &(StyPath){&path, NULL, i}, json_array_get(list, i), error);
  return status;
}

/* ---- camera ------------------------------------------------------------------- */

static StyStatus read_fit(const StyDocument *document, const StyPath *path, const json_t *camera, const double up[3],
                          StyView *out, StyError *error) {
  static const char *const known[] = {"type", "view", "fov", "up", NULL};
  const char *view = "front";
  StyError cause;
  StyStatus status = sty_check_keys(document, path, camera, known, error);
  if (!status) status = sty_get_string(document, path, camera, "view", 0, &view, error);
  *out = sty_default_view;
  out->perspective = json_object_get(camera, "fov");
  if (!status) status = sty_get_number(document, path, camera, "fov", 1, 170, &out->fov, error);
  if (!status && sty_parse_view("view", view, out, &cause))
    return sty_fail_value(document, &(StyPath){path, "view", 0}, json_object_get(camera, "view"),
                          "\"front\", \"three-quarter\" or \"AZIMUTH,ELEVATION\" in degrees", error);
  if (status || sty_find_up_axis(up, &out->up)) return status;
  char found[64];
  snprintf(found, sizeof found, "[%g, %g, %g]", up[0], up[1], up[2]);
  return sty_fail_found(document, &(StyPath){path, "up", 0}, found,
                        "an axis of the world, as [0, 0, 1], for a camera of type \"fit\"", error);
}

/* Whatever the scene: that it looks somewhere, and knows what is up. */
static StyStatus check_stand(const StyDocument *document, const StyPath *path, const StyStand *stand, StyError *error) {
  const StyScene world = {.scale = 1};
  StyCamera camera;
  StyError cause;
  const StyStatus status = sty_place_camera(&world, stand, 1, 1, &camera, &cause);
  return status ? place_error(document, path, status, skip_subject(cause.text), error) : STY_OK;
}

static StyStatus read_stand(const StyDocument *document, const StyPath *path, const json_t *camera, StyStand *out,
                            StyError *error) {
  static const char *const perspective[] = {"type", "position", "target", "up", "fov", NULL};
  static const char *const orthographic[] = {"type", "position", "target", "up", "height", NULL};
  const double most = STY_MAX_COORDINATE;
  out->fov = sty_default_view.fov;
  StyStatus status = sty_check_keys(document, path, camera, out->perspective ? perspective : orthographic, error);
  if (!status) status = require_key(document, path, camera, "position", "where the camera stands", error);
  if (!status) status = require_key(document, path, camera, "target", "what it looks at", error);
  if (!status && !out->perspective)
    status = require_key(document, path, camera, "height", "how much of the world it sees", error);
  if (!status) status = sty_get_numbers(document, path, camera, "position", -most, most, 3, out->position, error);
  if (!status) status = sty_get_numbers(document, path, camera, "target", -most, most, 3, out->target, error);
  if (!status) status = sty_get_number(document, path, camera, "fov", 1, 170, &out->fov, error);
  if (!status) status = sty_get_number(document, path, camera, "height", 1 / most, most, &out->height, error);
  return status ? status : check_stand(document, path, out, error);
}

static StyStatus read_camera(const StyDocument *document, StyViewpoint *out, StyError *error) {
  static const char *const types[] = {"fit", "orthographic", "perspective", NULL};
  static const char *const typed[] = {"position", "target", "height", NULL};
  const json_t *camera = json_object_get(document->root, "camera");
  const StyPath path = {NULL, "camera", 0};
  int type = 0;
  *out = (StyViewpoint){.is_fit = true, .view = sty_default_view, .stand.up = {0, 1, 0}};
  if (!camera) return STY_OK;
  if (!json_is_object(camera)) return sty_fail_value(document, &path, camera, "an object", error);
  StyStatus status = check_type_given(
      document, &path, camera, typed,
      "\"type\": \"perspective\" or \"orthographic\" (without one it is \"fit\", which finds its own place)", error);
  if (!status) status = sty_get_choice(document, &path, camera, "type", types, &type, error);
  if (!status)
    status = sty_get_numbers(document, &path, camera, "up", -STY_MAX_COORDINATE, STY_MAX_COORDINATE, 3, out->stand.up,
                             error);
  if (status) return status;
  out->is_fit = type == 0;
  out->stand.perspective = type == 2;
  return out->is_fit ? read_fit(document, &path, camera, out->stand.up, &out->view, error)
                     : read_stand(document, &path, camera, &out->stand, error);
}

/* ---- lights ------------------------------------------------------------------- */

static StyStatus get_switch(const StyDocument *document, const char *key, bool *out, StyError *error) {
  const json_t *value = json_object_get(document->root, key);
  if (!value) return STY_OK;
  if (!json_is_boolean(value)) return sty_fail_value(document, &(StyPath){NULL, key, 0}, value, "true or false", error);
  *out = json_is_true(value);
  return STY_OK;
}

static StyStatus read_light(Reading *reading, const StyPath *path, const json_t *value, StyError *error) {
  static const char *const directional[] = {"type", "direction", "intensity", "color", NULL};
  static const char *const point[] = {"type", "position", "intensity", "color", NULL};
  static const char *const types[] = {"directional", "point", NULL}, *const typed[] = {"position", NULL};
  const StyDocument *document = &reading->document;
  const double most = STY_MAX_COORDINATE;
  StyLight light = {.intensity = 1, .colour = {1, 1, 1}};
  StyError cause;
  int type = 0;
  if (!json_is_object(value)) return sty_fail_value(document, path, value, "an object", error);
  StyStatus status =
      check_type_given(document, path, value, typed,
                       "\"type\": \"point\" (without one it is \"directional\", which has no place)", error);
  if (!status) status = sty_get_choice(document, path, value, "type", types, &type, error);
  light.is_point = type == 1;
  if (!status) status = sty_check_keys(document, path, value, light.is_point ? point : directional, error);
  if (!status)
    status = light.is_point ? require_key(document, path, value, "position", "where the light stands", error)
                            : require_key(document, path, value, "direction", "the way the light shines", error);
  if (!status) status = sty_get_numbers(document, path, value, "direction", -most, most, 3, light.direction, error);
  if (!status) status = sty_get_numbers(document, path, value, "position", -most, most, 3, light.position, error);
  if (!status) status = sty_get_number(document, path, value, "intensity", 0, most, &light.intensity, error);
  if (!status) status = sty_get_numbers(document, path, value, "color", 0, 1e6, 3, light.colour, error);
  if (status) return status;
  status = sty_add_light(reading->scene, &light, &cause);
  const StyPath direction = {path, "direction", 0};
  return status ? place_error(document, &direction, status, skip_subject(cause.text), error) : STY_OK;
}

static StyStatus read_lighting(Reading *reading, StyError *error) {
  const StyDocument *document = &reading->document;
  StyScene *scene = reading->scene;
  StyStatus status = read_list(reading, "lights", STY_MOST_LIGHTS, read_light, error);
  if (scene->light_count) scene->ambient = default_ambient;
  if (!status) status = sty_get_number(document, NULL, document->root, "ambient", 0, 1e6, &scene->ambient, error);
  return status ? status : get_switch(document, "shadows", &scene->shadows, error);
}

/* ---- objects ------------------------------------------------------------------ */

/* The number of a mesh that the value at `path` names, which is read unless an object before has named it. */
static StyStatus find_mesh(Reading *reading, const StyPath *path, const char *name, int *number, StyError *error) {
  for (int m = 0; m < reading->scene->mesh_count; m++)
    if (strcmp(reading->names[m], name) == 0) {
      *number = m;
      return STY_OK;
    }
  StyMesh *mesh = NULL;
  StyError cause;
  char *file = sty_join_path(reading->folder, name);
  StyStatus status = file ? sty_read_mesh(file, reading->options, &mesh, &cause) : sty_fail_memory(&cause, name, 0);
  free(file);
  if (!status) status = sty_add_mesh(reading->scene, &mesh, number, &cause);
  if (!status) reading->names[*number] = name;
  return status ? place_error(&reading->document, path, status, cause.text, error) : STY_OK;
}

static StyStatus read_transform(const StyDocument *document, const StyPath *object_path, const json_t *object,
                                double out[3][4], StyError *error) {
  double m[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  const StyStatus status = sty_get_numbers(document, object_path, object, "transform", -STY_MAX_COORDINATE,
                                           STY_MAX_COORDINATE, 16, m, error);
  if (status) return status;
  memcpy(out, m, 12 * sizeof *m);
  for (size_t i = 12; i < 16; i++) {
    const StyPath path = {object_path, "transform", 0};
    const json_t *value = json_array_get(json_object_get(object, "transform"), i);
    if (m[i] != (i == 15))
      return sty_fail_value(document, &(StyPath){&path, NULL, i}, value,
                            i < 15 ? "0, since the last row is 0, 0, 0, 1" : "1, since the last row is 0, 0, 0, 1",
                            error);
  }
  return STY_OK;
}

/* The texture that an object or a sphere names, beside the file. */
static StyStatus read_texture(Reading *reading, const StyPath *path, const json_t *value, int *out, StyError *error) {
  const char *name = NULL;
  StyStatus status = sty_get_string(&reading->document, path, value, "texture", 0, &name, error);
  if (status || !name) return status;
  char *texture = sty_join_path(reading->folder, name), key[128], named_by[STY_PLACE_SIZE];
  sty_name_path(&(StyPath){path, "texture", 0}, key, sizeof key);
  snprintf(named_by, sizeof named_by, "%.800s: %s", reading->document.name, key);
  status = texture ? sty_add_texture(reading->scene, texture, named_by, out, error) : sty_fail_memory(error, name, 0);
  free(texture);
  return status;
}

static StyStatus read_material(Reading *reading, const StyPath *path, const json_t *value, StyMaterial *out,
                               StyError *error) {
  const StyDocument *document = &reading->document;
  *out = sty_white;
  out->shininess = default_shininess;
  StyStatus status = sty_get_numbers(document, path, value, "color", 0, 1, 3, out->paint.colour, error);
  if (!status) status = read_texture(reading, path, value, &out->paint.texture, error);
  if (!status) status = sty_get_number(document, path, value, "specular", 0, 1, &out->specular, error);
  if (!status) status = sty_get_number(document, path, value, "shininess", 1, 10000, &out->shininess, error);
  return status;
}

static StyStatus read_object(Reading *reading, const StyPath *path, const json_t *value, StyError *error) {
  static const char *const known[] = {"mesh", "transform", "style", "color", "texture", "specular", "shininess", NULL};
  const StyDocument *document = &reading->document;
  const char *name = NULL;
  StyObject object = {.style = 1};
  object.is_painted = json_object_get(value, "color") || json_object_get(value, "texture");
  StyError cause;
  StyStatus status = sty_check_keys(document, path, value, known, error);
  if (!status) status = require_key(document, path, value, "mesh", "the name of a mesh file", error);
  if (!status) status = sty_get_string(document, path, value, "mesh", 1, &name, error);
  if (!status) status = sty_get_integer(document, path, value, "style", 0, STY_MOST_STYLE, &object.style, error);
  if (!status) status = read_material(reading, path, value, &object.material, error);
  if (!status) status = read_transform(document, path, value, object.transform, error);
  if (!status) status = find_mesh(reading, &(StyPath){path, "mesh", 0}, name, &object.mesh, error);
  if (status) return status;
  status = sty_add_object(reading->scene, &object, &cause);
  const StyPath transform = {path, "transform", 0};
  return status ? place_error(document, &transform, status, skip_subject(cause.text), error) : STY_OK;
}

static StyStatus read_sphere(Reading *reading, const StyPath *path, const json_t *value, StyError *error) {
  static const char *const known[] = {"center", "radius", "style", "color", "texture", "specular", "shininess", NULL};
  const StyDocument *document = &reading->document;
  StySphere sphere = {.radius = 1, .style = 1};
  StyStatus status = sty_check_keys(document, path, value, known, error);
  if (!status)
    status = sty_get_numbers(document, path, value, "center", -STY_MAX_COORDINATE, STY_MAX_COORDINATE, 3, sphere.centre,
                             error);
  if (!status)
    status = sty_get_number(document, path, value, "radius", 1 / STY_MAX_COORDINATE, STY_MAX_COORDINATE, &sphere.radius,
                            error);
  if (!status) status = sty_get_integer(document, path, value, "style", 0, STY_MOST_STYLE, &sphere.style, error);
  if (!status) status = read_material(reading, path, value, &sphere.material, error);
  if (status) return status;
  StyError cause;
  status = sty_add_sphere(reading->scene, &sphere, &cause);
  return status ? place_error(document, path, status, skip_subject(cause.text), error) : STY_OK;
}

/* ---- the whole ---------------------------------------------------------------- */

static StyStatus read_head(Reading *reading, StyViewpoint *viewpoint, StyError *error) {
  static const char *const known[] = {"schema", "camera", "objects", "spheres", "lights", "ambient", "shadows", NULL};
  const StyDocument *document = &reading->document;
  const char *schema = NULL;
  StyStatus status = sty_check_keys(document, NULL, document->root, known, error);
  if (!status) status = require_key(document, NULL, document->root, "schema", "\"stylut-scene/1\" there", error);
  if (!status) status = sty_get_string(document, NULL, document->root, "schema", 1, &schema, error);
  if (!status && strcmp(schema, scene_schema) != 0)
    return sty_fail_value(document, &(StyPath){NULL, "schema", 0}, json_object_get(document->root, "schema"),
                          "\"stylut-scene/1\"", error);
  return status ? status : read_camera(document, viewpoint, error);
}

static StyStatus read_all(Reading *reading, StyViewpoint *viewpoint, StyError *error) {
  StyStatus status = read_head(reading, viewpoint, error);
  if (!status) status = sty_create_scene(&reading->scene, error);
  if (status) return status;
  const size_t objects = json_array_size(json_object_get(reading->document.root, "objects"));
  reading->names = calloc(objects + 1, sizeof *reading->names);
  if (!reading->names) return sty_fail_memory(error, reading->document.name, (double)objects * sizeof *reading->names);
  status = read_list(reading, "objects", STY_MOST_OBJECTS, read_object, error);
  if (!status) status = read_list(reading, "spheres", STY_MOST_OBJECTS, read_sphere, error);
  if (!status) status = read_lighting(reading, error);
  if (status) return status;
  StyError cause;
  status = sty_finish_scene(reading->scene, &cause);
  return status ? sty_fail(error, status, "%s: %s", reading->document.name, skip_subject(cause.text)) : STY_OK;
}

bool sty_is_scene_file(const char *path) {
  const char *dot = strrchr(path, '.');
  return dot && strcasecmp(dot, ".json") == 0;
}

StyStatus sty_read_scene(const char *path, const StyMeshOptions *options, StyScene **out, StyViewpoint *viewpoint,
                         StyError *error) {
  Reading reading = {.folder = sty_get_folder(path), .options = options};
  StyViewpoint found;
  if (!reading.folder) return sty_fail_memory(error, path, (double)strlen(path));
  StyStatus status = sty_read_document(path, &reading.document, error);
  if (!status) status = read_all(&reading, &found, error);
  if (status) {
    sty_destroy_scene(&reading.scene);
  } else {
    *out = reading.scene;
    *viewpoint = found;
  }
  free(reading.names);
  free(reading.folder);
  sty_close_document(&reading.document);
  return status;
}

StyStatus sty_read_stand(const char *path, StyStand *out, StyError *error) {
  static const StyPath camera = {NULL, "camera", 0}, type = {&camera, "type", 0};
  Reading reading = {0};
  StyViewpoint found;
  StyStatus status = sty_read_document(path, &reading.document, error);
  if (!status) status = read_head(&reading, &found, error);
  if (!status)
    status = require_key(&reading.document, NULL, reading.document.root, "camera", "one that stands somewhere", error);
  if (!status && found.is_fit) {
    const json_t *given = json_object_get(reading.document.root, "camera"), *fit = json_object_get(given, "type");
    status = sty_fail_value(&reading.document, fit ? &type : &camera, fit ? fit : given,
                            "a camera of type \"perspective\" or \"orthographic\"", error);
  }
  if (!status) *out = found.stand;
  sty_close_document(&reading.document);
  return status;
}

static StyStatus check_reach(const StyCamera *camera, StyError *error) {
  const double half = fmax(camera->half_width, camera->half_height);
  double farthest = 0;
  for (int k = 0; k < 3; k++) farthest = fmax(farthest, fabs(camera->eye[k]));
  if (farthest <= STY_MAX_CAMERA && half <= STY_MAX_CAMERA) return STY_OK;
  return sty_fail(error, STY_ERROR_INPUT,
                  "camera: found it %.3g scene sizes away, its film %.3g wide, expected at most %g and %g",
                  farthest / 2, half, STY_MAX_CAMERA / 2, STY_MAX_CAMERA);
}

StyStatus sty_set_camera(const StyScene *scene, const StyViewpoint *viewpoint, int width, int height, StyCamera *out,
                         StyError *error) {
  StyCamera camera;
  StyStatus status = viewpoint->is_fit ? sty_fit_camera(scene, &viewpoint->view, width, height, &camera, error)
                                       : sty_place_camera(scene, &viewpoint->stand, width, height, &camera, error);
  if (!status) status = check_reach(&camera, error);
  if (!status) *out = camera;
  return status;
}
