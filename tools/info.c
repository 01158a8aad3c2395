/* stylut info FILE: what a picture, table, mesh or bundle holds. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "commands.h"
#include "info_scene.h"
#include "meshes.h"
#include "options.h"
#include "parameters.h"
#include "stylut/image_io.h"
#include "stylut/pack.h"
#include "stylut/scene_file.h"

typedef struct Arguments {
  Options options;
  const char *file;
} Arguments;

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  return parse_only_argument(key, text, state, &arguments->file,
                             "a picture, a table, a mesh, a scene, point pairs or a bundle");
}

static const struct argp_child children[] = {{&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .parser = parse_option,
    .args_doc = "FILE",
    .doc =
        "Says what a picture, guide, table, mesh, scene file, file of point pairs or bundle holds: size, channels with "
        "their ranges, how it was made; of a scene its camera, lights, objects, spheres and textures; of a mesh what "
        "of "
        "it is broken, which 'guide scene --repair' puts right.",
    .children = children,
};

/* ---- pictures ---- */

typedef struct Range {
  float minimum, maximum; /* over finite values */
  size_t not_finite;
} Range;

static Range measure_channel(const float *plane, size_t pixels) {
  Range range = {INFINITY, -INFINITY, 0};
  for (size_t i = 0; i < pixels; i++) {
    if (!isfinite(plane[i])) {
      range.not_finite++;
      continue;
    }
    if (plane[i] < range.minimum) range.minimum = plane[i];
    if (plane[i] > range.maximum) range.maximum = plane[i];
  }
  if (range.not_finite == pixels) range.minimum = range.maximum = 0;
  return range;
}

static json_t *describe_image(const StyImage *image) {
  const size_t pixels = sty_count_pixels(image);
  json_t *channels = json_array(), *attributes = json_object();
  for (int c = 0; c < image->channel_count; c++) {
    const Range range = measure_channel(image->data + (size_t)c * pixels, pixels);
    json_array_append_new(channels, json_pack("{s:o, s:f, s:f, s:I}", "name", make_json_text(image->names[c]),
                                              "minimum", (double)range.minimum, "maximum", (double)range.maximum,
                                              "not_finite", (json_int_t)range.not_finite));
  }
  for (int i = 0; i < image->attribute_count; i++)
    json_object_set_new(attributes, image->attributes[i].name, make_json_text(image->attributes[i].value));
  return json_pack("{s:s, s:[ii], s:i, s:o, s:o}", "schema", "stylut-info/1", "size", image->width, image->height,
                   "bits", image->bits, "channels", channels, "attributes", attributes);
}

static void print_image(const char *path, const json_t *report) {
  const json_t *size = json_object_get(report, "size"), *channels = json_object_get(report, "channels"), *value;
  const char *key;
  size_t i;
  printf("%s: %lldx%lld pixels, %lld-bit %s\n", clean_text(path), json_integer_value(json_array_get(size, 0)),
         json_integer_value(json_array_get(size, 1)), json_integer_value(json_object_get(report, "bits")),
         json_integer_value(json_object_get(report, "bits")) == 32 ? "float" : "integer");
  json_array_foreach(channels, i, value) {
    const long long odd = json_integer_value(json_object_get(value, "not_finite"));
    printf("  %-14s %g to %g", clean_text(json_string_value(json_object_get(value, "name"))),
           json_real_value(json_object_get(value, "minimum")), json_real_value(json_object_get(value, "maximum")));
    if (odd) printf(", %lld not finite", odd);
    putchar('\n');
  }
  json_object_foreach(json_object_get(report, "attributes"), key, value)
      printf("  %s = %s\n", clean_text(key), clean_text(json_string_value(value)));
}

static StyStatus show_image(const Arguments *arguments, StyError *error) {
  StyImage *image = NULL;
  const StyStatus status = sty_read_image(arguments->file, &image, error);
  if (status) return status;
  json_t *report = describe_image(image);
  sty_destroy_image(&image);
  if (arguments->options.json) return print_json(report, error);
  print_image(arguments->file, report);
  json_decref(report);
  return STY_OK;
}

/* ---- bundles ---- */

static void print_style(int number, const json_t *entry, const StyStyle *style) {
  const char *name = json_string_value(json_object_get(entry, "name"));
  printf("  style %d '%s': ", number, clean_text(name ? name : ""));
  for (int i = 0; i < style->layer_count && style->layer_count > 1; i++)
    printf("%s%g%s", i ? ", " : "exemplars for luma ", (double)style->luma[i], i == style->layer_count - 1 ? ", " : "");
  if (style->flags & STY_FLAG_BASE) printf("bases of %g pixels, ", json_number_value(json_object_get(entry, "base")));
  print_parameters(style);
  printf(", %s table\n", style->flags & STY_FLAG_UNORM8 ? "unorm8" : "centre");
}

static void print_bundle(const char *path, const StyLoadedBundle *loaded) {
  const StyTexture *textures = loaded->bundle.textures;
  const json_t *styles = json_object_get(loaded->index.root, "styles"), *entry;
  size_t i;
  printf("%s: bundle of %zu style(s)\n", clean_text(path), json_array_size(styles));
  for (int t = 0; t < STY_BUNDLE_FILES; t++)
    printf("  %-15s %ux%u, %u layer(s), %zu bytes\n", sty_bundle_files[t], textures[t].width, textures[t].height,
           textures[t].layers, loaded->files[t].size);
  json_array_foreach(styles, i, entry) {
    StyStyle style;
    if (!sty_get_style(&loaded->bundle, (int)i + 1, &style)) print_style((int)i + 1, entry, &style);
  }
}

static StyStatus show_bundle(const Arguments *arguments, StyError *error) {
  StyLoadedBundle bundle;
  StyStatus status = sty_load_bundle(arguments->file, NULL, NULL, &bundle, error);
  if (status) return status;
  if (arguments->options.json)
    status = print_json(json_incref(bundle.index.root), error);
  else
    print_bundle(arguments->file, &bundle);
  sty_unload_bundle(&bundle);
  return status;
}

/* ---- meshes ---- */

static StyStatus show_mesh(const Arguments *arguments, StyError *error) {
  StyMesh *mesh = NULL;
  StyMeshSurvey survey = {0};
  StyStatus status = sty_read_mesh(arguments->file, &(StyMeshOptions){.crease_angle = -1}, &mesh, error);
  if (!status) status = sty_survey_mesh(mesh, &survey, error);
  if (!status && arguments->options.json) {
    status = print_json(json_pack("{s:s, s:s, s:i, s:o, s:o, s:o}", "schema", "stylut-info/1", "kind", "mesh", "parts",
                                  mesh->part_count, "minimum", pack_vector(mesh->minimum), "maximum",
                                  pack_vector(mesh->maximum), "survey", pack_survey(&survey)),
                        error);
  } else if (!status) {
    printf("%s: mesh of %d part(s) from (%g, %g, %g) to (%g, %g, %g)\n", clean_text(arguments->file), mesh->part_count,
           mesh->minimum[0], mesh->minimum[1], mesh->minimum[2], mesh->maximum[0], mesh->maximum[1], mesh->maximum[2]);
    print_survey(&survey);
  }
  sty_destroy_mesh(&mesh);
  return status;
}

StyStatus run_info(int argc, char **argv) {
  Arguments arguments = {.file = NULL};
  StyError *error = &arguments.options.error;
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  struct stat info;
  if (!status && !arguments.options.helped) {
    const bool is_folder = stat(arguments.file, &info) == 0 && S_ISDIR(info.st_mode);
    status = is_folder                           ? show_bundle(&arguments, error)
             : sty_is_scene_file(arguments.file) ? show_document(&arguments.options, arguments.file, error)
             : sty_is_mesh_file(arguments.file)  ? show_mesh(&arguments, error)
                                                 : show_image(&arguments, error);
  }
  return finish_command(&arguments.options, status);
}
