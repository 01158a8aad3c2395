#include "info_scene.h"

#include <stdio.h>
#include <string.h>

#include "meshes.h"
#include "stylut/json.h"
#include "stylut/scene_file.h"
#include "stylut/warp.h"

json_t *pack_vector(const double v[3]) { return json_pack("[fff]", v[0], v[1], v[2]); }

static void print_vector(const char *name, const double v[3]) { printf("%s (%g, %g, %g)", name, v[0], v[1], v[2]); }

/* ---- cameras ---- */

static json_t *pack_camera(const StyViewpoint *viewpoint) {
  const StyView *view = &viewpoint->view;
  const StyStand *stand = &viewpoint->stand;
  json_t *camera;
  if (viewpoint->is_fit)
    camera = json_pack("{s:s, s:b, s:f, s:f, s:s}", "type", "fit", "perspective", view->perspective, "azimuth",
                       view->azimuth, "elevation", view->elevation, "up", sty_up_axis_names[view->up]);
  else
    camera =
        json_pack("{s:s, s:o, s:o, s:o}", "type", stand->perspective ? "perspective" : "orthographic", "position",
                  pack_vector(stand->position), "target", pack_vector(stand->target), "up", pack_vector(stand->up));
  if (viewpoint->is_fit ? view->perspective : stand->perspective)
    json_object_set_new(camera, "fov", json_real(viewpoint->is_fit ? view->fov : stand->fov));
  else if (!viewpoint->is_fit)
    json_object_set_new(camera, "height", json_real(stand->height));
  return camera;
}

static void print_camera(const StyViewpoint *viewpoint) {
  const StyView *view = &viewpoint->view;
  const StyStand *stand = &viewpoint->stand;
  const bool perspective = viewpoint->is_fit ? view->perspective : stand->perspective;
  printf("  camera: %s, %s,", viewpoint->is_fit ? "fitted" : "placed", perspective ? "perspective" : "orthographic");
  if (viewpoint->is_fit) {
    printf(" azimuth %g, elevation %g, up %s", view->azimuth, view->elevation, sty_up_axis_names[view->up]);
  } else {
    print_vector(" at", stand->position);
    print_vector(", looks at", stand->target);
    print_vector(", up", stand->up);
  }
  if (perspective)
    printf(", fov %g", viewpoint->is_fit ? view->fov : stand->fov);
  else if (!viewpoint->is_fit)
    printf(", height %g", stand->height);
  putchar('\n');
}

/* ---- lights ---- */

static json_t *pack_lights(const StyScene *scene) {
  json_t *lights = json_array();
  for (int l = 0; l < scene->light_count; l++) {
    const StyLight *light = &scene->lights[l];
    json_array_append_new(lights, json_pack("{s:s, s:o, s:f, s:o}", "type", light->is_point ? "point" : "directional",
                                            light->is_point ? "position" : "direction",
                                            pack_vector(light->is_point ? light->position : light->direction),
                                            "intensity", light->intensity, "color", pack_vector(light->colour)));
  }
  return lights;
}

static void print_lights(const StyScene *scene) {
  for (int l = 0; l < scene->light_count; l++) {
    const StyLight *light = &scene->lights[l];
    printf("  light %d: %s,", l + 1, light->is_point ? "point" : "directional");
    print_vector(light->is_point ? " position" : " direction", light->is_point ? light->position : light->direction);
    printf(", intensity %g", light->intensity);
    print_vector(", color", light->colour);
    putchar('\n');
  }
  printf("  ambient %g, shadows %s\n", scene->ambient, scene->shadows ? "on" : "off");
}

/* ---- materials ---- */

/* Adds to what is said of an object or a sphere; without a paint of its own, it has its mesh's. */
static void pack_material(json_t *surface, const StyScene *scene, const StyMaterial *material, bool is_painted) {
  const int texture = is_painted ? material->paint.texture : -1;
  json_object_set_new(surface, "color", is_painted ? pack_vector(material->paint.colour) : json_null());
  json_object_set_new(surface, "texture", texture < 0 ? json_null() : make_json_text(scene->textures[texture].path));
  json_object_set_new(surface, "specular", json_real(material->specular));
  json_object_set_new(surface, "shininess", json_real(material->shininess));
}

static void print_material(const StyScene *scene, const StyMaterial *material, bool is_painted) {
  const int texture = is_painted ? material->paint.texture : -1;
  if (is_painted)
    print_vector("    color", material->paint.colour);
  else
    printf("    color of its mesh's file");
  if (texture >= 0) printf(", texture %s", clean_text(scene->textures[texture].path));
  if (material->specular > 0) printf(", specular %g, shininess %g", material->specular, material->shininess);
  putchar('\n');
}

/* ---- objects ---- */

static json_t *pack_transform(const double transform[3][4]) {
  json_t *numbers = json_array();
  for (int i = 0; i < 16; i++) json_array_append_new(numbers, json_real(i < 12 ? transform[i / 4][i % 4] : i == 15));
  return numbers;
}

static json_t *pack_objects(const StyScene *scene) {
  json_t *objects = json_array();
  for (int o = 0; o < scene->object_count; o++) {
    const StyObject *object = &scene->objects[o];
    const StyMesh *mesh = scene->meshes[object->mesh];
    json_t *packed =
        json_pack("{s:i, s:o, s:I, s:i, s:i, s:i, s:o}", "mesh", object->mesh + 1, "file", make_json_text(mesh->path),
                  "triangles", (json_int_t)mesh->triangle_count, "style", object->style, "first_id", object->first_id,
                  "parts", mesh->part_count, "transform", pack_transform(object->transform));
    pack_material(packed, scene, &object->material, object->is_painted);
    json_array_append_new(objects, packed);
  }
  return objects;
}

static void print_objects(const StyScene *scene) {
  for (int o = 0; o < scene->object_count; o++) {
    const StyObject *object = &scene->objects[o];
    const StyMesh *mesh = scene->meshes[object->mesh];
    printf("  object %d: %s, %zu triangles, style %d, object.I %d", o + 1, clean_text(mesh->path), mesh->triangle_count,
           object->style, object->first_id);
    if (mesh->part_count > 1) printf(" to %d", object->first_id + mesh->part_count - 1);
    putchar('\n');
    print_material(scene, &object->material, object->is_painted);
    if (memcmp(object->transform, sty_identity, sizeof sty_identity) == 0) continue;
    printf("    transform");
    for (int i = 0; i < 12; i++) printf("%s%g", i && i % 4 == 0 ? ", " : " ", object->transform[i / 4][i % 4]);
    putchar('\n');
  }
}

static json_t *pack_spheres(const StyScene *scene) {
  json_t *spheres = json_array();
  for (int s = 0; s < scene->sphere_count; s++) {
    const StySphere *sphere = &scene->spheres[s];
    json_t *packed = json_pack("{s:o, s:f, s:i, s:i}", "center", pack_vector(sphere->centre), "radius", sphere->radius,
                               "style", sphere->style, "id", sphere->id);
    pack_material(packed, scene, &sphere->material, true);
    json_array_append_new(spheres, packed);
  }
  return spheres;
}

static void print_spheres(const StyScene *scene) {
  for (int s = 0; s < scene->sphere_count; s++) {
    const StySphere *sphere = &scene->spheres[s];
    printf("  sphere %d:", s + 1);
    print_vector(" center", sphere->centre);
    printf(", radius %g, style %d, object.I %d\n", sphere->radius, sphere->style, sphere->id);
    print_material(scene, &sphere->material, true);
  }
}

/* ---- textures ---- */

/* All that may be looked up, those that meshes bring along too. */
static json_t *pack_textures(const StyScene *scene) {
  json_t *textures = json_array();
  for (int t = 0; t < scene->texture_count; t++)
    json_array_append_new(textures, json_pack("{s:o, s:b}", "file", make_json_text(scene->textures[t].path),
                                              "inside_mesh", scene->textures[t].bytes != NULL));
  return textures;
}

static void print_textures(const StyScene *scene) {
  for (int t = 0; t < scene->texture_count; t++)
    printf("  texture %d: %s%s\n", t + 1, clean_text(scene->textures[t].path),
           scene->textures[t].bytes ? ", inside the mesh's file" : "");
}

/* ---- scenes ---- */

static json_t *describe_scene(const StyScene *scene, const StyViewpoint *viewpoint) {
  return json_pack("{s:s, s:s, s:i, s:I, s:o, s:o, s:o, s:o, s:f, s:b, s:o, s:o, s:o}", "schema", "stylut-info/1",
                   "kind", "scene", "meshes", scene->mesh_count, "triangles",
                   (json_int_t)sty_count_scene_triangles(scene), "minimum", pack_vector(scene->minimum), "maximum",
                   pack_vector(scene->maximum), "camera", pack_camera(viewpoint), "lights", pack_lights(scene),
                   "ambient", scene->ambient, "shadows", scene->shadows, "objects", pack_objects(scene), "spheres",
                   pack_spheres(scene), "textures", pack_textures(scene));
}

static void print_scene(const char *path, const StyScene *scene, const StyViewpoint *viewpoint) {
  printf("%s: scene of %d object(s) from %d mesh(es), %zu triangles, and %d sphere(s)\n", clean_text(path),
         scene->object_count, scene->mesh_count, sty_count_scene_triangles(scene), scene->sphere_count);
  print_vector("  from", scene->minimum);
  print_vector(" to", scene->maximum);
  putchar('\n');
  print_camera(viewpoint);
  print_lights(scene);
  print_objects(scene);
  print_spheres(scene);
  print_textures(scene);
}

static StyStatus show_scene(const Options *options, const char *path, StyError *error) {
  StyScene *scene = NULL;
  StyViewpoint viewpoint;
  StyStatus status = sty_read_scene(path, NULL, &scene, &viewpoint, error);
  if (status) return status;
  warn_of_scene(options, scene);
  if (options->json)
    status = print_json(describe_scene(scene, &viewpoint), error);
  else
    print_scene(path, scene, &viewpoint);
  sty_destroy_scene(&scene);
  return status;
}

/* ---- point pairs ---- */

static json_t *describe_pairs(const StyPairs *pairs) {
  json_t *list = json_array();
  for (int i = 0; i < pairs->count; i++) {
    const StyPair *pair = &pairs->pairs[i];
    json_array_append_new(
        list, json_pack("{s:[ff], s:[ff]}", "from", pair->from[0], pair->from[1], "to", pair->to[0], pair->to[1]));
  }
  return json_pack("{s:s, s:s, s:s, s:f, s:s, s:o}", "schema", "stylut-info/1", "kind", "pairs", "warp",
                   sty_warp_kinds[pairs->kind], "alpha", pairs->alpha, "units",
                   pairs->normalized ? "normalized" : "pixels", "pairs", list);
}

static void print_pairs(const char *path, const StyPairs *pairs) {
  printf("%s: %d pair%s of points, %s, warp %s, alpha %g\n", clean_text(path), pairs->count,
         pairs->count == 1 ? "" : "s", pairs->normalized ? "normalized" : "in pixels", sty_warp_kinds[pairs->kind],
         pairs->alpha);
  for (int i = 0; i < pairs->count; i++) {
    const StyPair *pair = &pairs->pairs[i];
    printf("  pair %d: from (%g, %g) to (%g, %g)\n", i + 1, pair->from[0], pair->from[1], pair->to[0], pair->to[1]);
  }
}

static StyStatus show_pairs(const Options *options, const char *path, StyError *error) {
  StyPairs pairs;
  StyStatus status = sty_read_pairs(path, &pairs, error);
  if (status) return status;
  if (options->json)
    status = print_json(describe_pairs(&pairs), error);
  else
    print_pairs(path, &pairs);
  sty_free_pairs(&pairs);
  return status;
}

/* ---- which of them ---- */

StyStatus show_document(const Options *options, const char *path, StyError *error) {
  static const char *const schemas[] = {"stylut-scene/1", "stylut-pairs/1", NULL};
  StyDocument document;
  int kind = 0;
  StyStatus status = sty_read_document(path, &document, error);
  if (status) return status;
  if (json_object_get(document.root, "schema"))
    status = sty_get_choice(&document, NULL, document.root, "schema", schemas, &kind, error);
  else
    status = sty_fail_value(&document, NULL, document.root,
                            "a key \"schema\" of \"stylut-scene/1\" or \"stylut-pairs/1\"", error);
  sty_close_document(&document);
  if (status) return status;
  return kind ? show_pairs(options, path, error) : show_scene(options, path, error);
}
