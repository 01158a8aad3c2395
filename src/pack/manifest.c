#include <dirent.h>
#include <errno.h>
#include <fnmatch.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "stylut/pack.h"

static const char *const manifest_schema = "stylut-bundle/1";
enum { MOST_NAMES = 256 }; /* jitter tables, and frames */
static const double largest_sigma = 256;
static const double default_slack = 2, largest_slack = 255; /* as of stylut lut */
static const double default_luma_weight = 0.25;

size_t sty_count_manifest_names(const json_t *names) { return json_is_string(names) ? 1 : json_array_size(names); }

const char *sty_get_manifest_name(const json_t *names, size_t i) {
  return json_string_value(json_is_string(names) ? names : json_array_get(names, i));
}

int sty_count_layers(const StyStyle *parameters) {
  return parameters->layer_count * (parameters->flags & STY_FLAG_BASE ? 2 : 1);
}

/* A file name, or a list of them. */
static StyStatus read_names(const StyDocument *document, const StyPath *parent, const json_t *object, const char *key,
                            const char *expected, const json_t **out, StyError *error) {
  const json_t *names = json_object_get(object, key), *name;
  const StyPath path = {parent, key, 0};
  size_t i;
  if (!names) return STY_OK;
  if (json_string_length(names) == 0 && (json_array_size(names) < 1 || json_array_size(names) > MOST_NAMES))
    return sty_fail_value(document, &path, names, expected, error);
  json_array_foreach(names, i, name) if (json_string_length(name) == 0) return sty_fail_value(
      document, &(StyPath){&path, NULL, i}, name, "a file name", error);
  *out = names;
  return STY_OK;
}

static StyStatus read_parameters(const StyDocument *document, const StyPath *style_path, const json_t *params,
                                 StyStyle *out, StyError *error) {
  const char *known[sizeof(StyStyle)] = {NULL}; /* more than there can be */
  if (!params) return STY_OK;
  const StyPath path = {style_path, "params", 0};
  for (int i = 0; sty_parameters[i].name; i++) known[i] = sty_parameters[i].name;
  const StyStatus status = sty_check_keys(document, &path, params, known, error);
  if (status) return status;
  for (const StyParameter *p = sty_parameters; p->name; p++) {
    const json_t *value = json_object_get(params, p->name);
    const bool fits = p->kind == STY_PARAMETER_FLAG    ? json_is_boolean(value)
                      : p->kind == STY_PARAMETER_WHOLE ? json_is_integer(value)
                                                       : json_is_number(value);
    char range[STY_RANGE_SIZE];
    if (value && (!fits || !sty_put_parameter(p, json_is_true(value) ? 1 : json_number_value(value), out)))
      return sty_fail_value(document, &(StyPath){&path, p->name, 0}, value, sty_name_parameter_range(p, range), error);
  }
  return STY_OK;
}

static StyStatus read_lighting(const StyDocument *document, const StyPath *path, const json_t *exemplar, int number,
                               StyManifestStyle *out, StyError *error) {
  static const char *const known[] = {"image", "luma", NULL};
  double luma = -1;
  StyStatus status = sty_check_keys(document, path, exemplar, known, error);
  if (!status) status = sty_get_string(document, path, exemplar, "image", 1, &out->exemplars[number], error);
  if (!status) status = sty_get_number(document, path, exemplar, "luma", 0, 1, &luma, error);
  if (!status && luma < 0)
    status = sty_fail_value(document, path, exemplar, "\"luma\", the luminance that it was painted for", error);
  for (int i = 0; !status && i < number; i++)
    if (out->parameters.luma[i] == (float)luma)
      status = sty_fail_value(document, &(StyPath){path, "luma", 0}, json_object_get(exemplar, "luma"),
                              "a luminance no other exemplar has", error);
  out->parameters.luma[number] = (float)luma;
  return status;
}

/* "exemplar", or "exemplars" by luminance. */
static StyStatus read_exemplars(const StyDocument *document, const StyPath *style_path, const json_t *style,
                                StyManifestStyle *out, StyError *error) {
  const json_t *list = json_object_get(style, "exemplars"), *exemplar;
  const StyPath path = {style_path, "exemplars", 0};
  if (!list) return sty_get_string(document, style_path, style, "exemplar", 1, &out->exemplars[0], error);
  if (json_object_get(style, "exemplar"))
    return sty_fail_value(document, &path, list, "either \"exemplar\" or \"exemplars\"", error);
  const size_t count = json_array_size(list);
  if (count < 1 || count > STY_MAX_LIGHTINGS)
    return sty_fail_value(document, &path, list, "a list of 1 to 4 objects", error);
  size_t i;
  json_array_foreach(list, i, exemplar) {
    const StyStatus status = read_lighting(document, &(StyPath){&path, NULL, i}, exemplar, (int)i, out, error);
    if (status) return status;
  }
  out->parameters.layer_count = (int)count;
  return STY_OK;
}

/* {"p99": 1.0}: lookup errors, as those of sty_audit_lookup. */
static StyStatus read_budget(const StyDocument *document, const StyPath *lut_path, const json_t *lut,
                             StyManifestStyle *out, StyError *error) {
  static const char *const known[] = {"mean", "p99", "max", NULL};
  const json_t *budget = json_object_get(lut, "budget");
  const StyPath path = {lut_path, "budget", 0};
  if (!budget) return STY_OK;
  StyStatus status = sty_check_keys(document, &path, budget, known, error);
  if (!status) status = sty_get_number(document, &path, budget, "mean", 1e-6, 180, &out->lut.most_mean, error);
  if (!status) status = sty_get_number(document, &path, budget, "p99", 1e-6, 180, &out->lut.most_p99, error);
  if (!status) status = sty_get_number(document, &path, budget, "max", 1e-6, 180, &out->lut.most_error, error);
  if (!status && json_object_size(budget) == 0)
    status = sty_fail_value(document, &path, budget, "one of \"mean\", \"p99\", \"max\" in degrees", error);
  if (!status && json_object_get(lut, "size"))
    status = sty_fail_value(document, &path, budget, "either \"size\" or \"budget\"", error);
  return status;
}

static StyStatus read_resolve(const StyDocument *document, const StyPath *path, const json_t *lut,
                              StyManifestStyle *out, StyError *error) {
  static const char *const words[] = {"nearest", "coherent", "frames", "both", NULL};
  int word = 0;
  StyStatus status = sty_get_choice(document, path, lut, "resolve", words, &word, error);
  out->lut.resolve = words[word];
  if (!status) status = sty_get_number(document, path, lut, "slack", 0, largest_slack, &out->lut.slack, error);
  if (!status)
    status = read_names(document, path, lut, "frames", "a guide file, or a list of 1 to 256", &out->lut.frames, error);
  const json_t *slack = json_object_get(lut, "slack"), *resolve = json_object_get(lut, "resolve");
  if (!status && slack && word == 0)
    status = sty_fail_value(document, &(StyPath){path, "slack", 0}, slack, "it with another \"resolve\" than nearest",
                            error);
  if (!status && word != 0 && json_object_get(lut, "budget"))
    status =
        sty_fail_value(document, &(StyPath){path, "resolve", 0}, resolve, "\"nearest\", which budgets are for", error);
  if (!status && word >= 2 && !out->lut.frames)
    status = sty_fail_value(document, &(StyPath){path, "resolve", 0}, resolve, "it with \"frames\" to serve", error);
  if (!status && word < 2 && out->lut.frames)
    status = sty_fail_value(document, &(StyPath){path, "frames", 0}, out->lut.frames,
                            "them with \"resolve\" \"frames\" or \"both\"", error);
  return status;
}

/* "lut" is a file name, or an object that says how to build a table or which
 * file holds it. */
static StyStatus read_lut(const StyDocument *document, const StyPath *style_path, const json_t *style,
                          StyManifestStyle *out, StyError *error) {
  static const char *const built[] = {"file",     "size",  "budget", "engine", "resolve",
                                      "sampling", "slack", "frames", NULL};
  static const char *const brought[] = {"file", "sampling", NULL};
  static const char *const samplings[] = {"unorm8", "centre", NULL};
  const StyPath path = {style_path, "lut", 0};
  const json_t *lut = json_object_get(style, "lut");
  out->lut.written = lut;
  if (!lut) return STY_OK;
  if (json_is_string(lut)) {
    out->lut.sampling = NULL;
    return sty_get_string(document, style_path, style, "lut", 0, &out->lut.file, error);
  }
  if (!json_is_object(lut)) return sty_fail_value(document, &path, lut, "a file name or an object", error);
  const bool is_file = json_object_get(lut, "file");
  int sampling = 0;
  StyStatus status = sty_check_keys(document, &path, lut, is_file ? brought : built, error);
  if (!status) status = sty_get_string(document, &path, lut, "file", 0, &out->lut.file, error);
  if (!status) status = sty_get_integer(document, &path, lut, "size", 2, STY_MAX_LUT_SIDE, &out->lut.size, error);
  if (!status) status = sty_get_string(document, &path, lut, "engine", 0, &out->lut.engine, error);
  if (!status) status = sty_get_choice(document, &path, lut, "sampling", samplings, &sampling, error);
  if (!status) status = read_budget(document, &path, lut, out, error);
  if (!status) status = read_resolve(document, &path, lut, out, error);
  out->lut.sampling = is_file && !json_object_get(lut, "sampling") ? NULL : samplings[sampling];
  return status;
}

static StyStatus read_base(const StyDocument *document, const StyPath *path, const json_t *style, StyManifestStyle *out,
                           StyError *error) {
  const json_t *base = json_object_get(style, "base");
  if (!base) return STY_OK;
  const StyStatus status = sty_get_number(document, path, style, "base", 0, largest_sigma, &out->base, error);
  if (!status && out->base == 0)
    return sty_fail_value(document, &(StyPath){path, "base", 0}, base, "a number above 0, in pixels", error);
  out->parameters.flags |= STY_FLAG_BASE;
  return status;
}

/* What a style is like where neither it nor the defaults say anything. */
static const StyManifestStyle plain_style = {
    .guide = "sphere",
    .lut = {.engine = "auto", .resolve = "nearest", .slack = default_slack, .sampling = "unorm8"},
    .parameters = {.threshold = 24, .top_level = 6, .radius = 1, .layer_count = 1, .jitter_amount = 1, .scale = 1},
};

static StyStatus read_check(const StyDocument *document, const StyPath *path, const json_t *style,
                            StyManifestStyle *out, StyError *error) {
  const json_t *check = json_object_get(style, "check");
  if (check && !json_is_object(check))
    return sty_fail_value(document, &(StyPath){path, "check", 0}, check, "an object of budgets", error);
  if (check) out->check = check;
  return STY_OK;
}

/* What may be said of one style or, as a default, of all. A style's "lut" takes the place of the whole default. */
static StyStatus read_common(const StyDocument *document, const StyPath *path, const json_t *style,
                             StyManifestStyle *out, StyError *error) {
  if (json_object_get(style, "lut")) out->lut = plain_style.lut;
  StyStatus status = sty_get_string(document, path, style, "guide", 0, &out->guide, error);
  if (!status) status = read_base(document, path, style, out, error);
  if (!status && json_object_get(style, "lut")) status = read_lut(document, path, style, out, error);
  if (!status) status = read_check(document, path, style, out, error);
  if (!status) status = read_parameters(document, path, json_object_get(style, "params"), &out->parameters, error);
  return status;
}

static StyStatus read_defaults(const StyDocument *document, StyManifestStyle *out, StyError *error) {
  static const char *const known[] = {"guide", "base", "lut", "params", "check", NULL};
  const json_t *defaults = json_object_get(document->root, "defaults");
  const StyPath path = {NULL, "defaults", 0};
  *out = plain_style;
  if (!defaults) return STY_OK;
  const StyStatus status = sty_check_keys(document, &path, defaults, known, error);
  return status ? status : read_common(document, &path, defaults, out, error);
}

/* ---- styles ---- */

/* A string that the manifest owns; NULL when memory is short. */
static const char *keep_string(StyManifest *manifest, const char *text, size_t length) {
  json_t *string = json_stringn(text, length);
  return json_array_append_new(manifest->made, string) == 0 ? json_string_value(string) : NULL;
}

/* The text with what "{name}" in it stands for. */
static const char *fill_in_name(StyManifest *manifest, const char *text, const char *name) {
  static const char place[] = "{name}";
  const char *at = text ? strstr(text, place) : NULL;
  if (!at) return text;
  const size_t size = strlen(text) + strlen(name);
  char *filled = malloc(size);
  if (!filled) return NULL;
  snprintf(filled, size, "%.*s%s%s", (int)(at - text), text, name, at + strlen(place));
  const char *kept = keep_string(manifest, filled, strlen(filled));
  free(filled);
  return kept;
}

static StyStatus fill_in_names(StyManifest *manifest, StyManifestStyle *style, StyError *error) {
  const bool has_table = style->lut.file;
  style->guide = fill_in_name(manifest, style->guide, style->name);
  style->lut.file = fill_in_name(manifest, style->lut.file, style->name);
  if (style->guide && (style->lut.file || !has_table)) return STY_OK;
  return sty_fail_memory(error, manifest->document.name, 0);
}

/* Whatever stands at `path`, the style's name is its own. */
static StyStatus add_style(StyManifest *manifest, const StyPath *path, const json_t *named,
                           const StyManifestStyle *style, StyError *error) {
  const StyDocument *document = &manifest->document;
  if (manifest->style_count == STY_MAX_STYLES)
    return sty_fail_value(document, path, named, "no more than 256 styles in a bundle", error);
  for (int i = 0; i < manifest->style_count; i++)
    if (strcmp(manifest->styles[i].name, style->name) == 0) {
      char found[512];
      snprintf(found, sizeof found, "'%s'", style->name);
      return sty_fail_found(document, path, found, "a name no other style has", error);
    }
  StyManifestStyle *added = &manifest->styles[manifest->style_count++];
  *added = *style;
  return fill_in_names(manifest, added, error);
}

static int compare_names(const void *a, const void *b) { return strcmp(*(char *const *)a, *(char *const *)b); }

/* The files of a folder that a glob's last part matches, in order; the caller frees them and the list. */
static StyStatus list_matches(const char *folder_name, const char *pattern, char ***out, size_t *count,
                              StyError *error) {
  DIR *folder = opendir(folder_name);
  char **names = NULL;
  size_t found = 0, room = 0;
  StyStatus status = STY_OK;
  if (!folder)
    return sty_fail(error, STY_ERROR_FILE, "%s: cannot read the folder of a glob: %s", folder_name, strerror(errno));
  for (const struct dirent *entry; !status && (entry = readdir(folder));) {
    if (fnmatch(pattern, entry->d_name, FNM_PERIOD) != 0) continue;
    if (found == room) {
      room = room ? 2 * room : 64;
      char **grown = realloc(names, room * sizeof *names);
      if (grown) names = grown;
      if (!grown) status = sty_fail_memory(error, folder_name, (double)(room * sizeof *names));
    }
    if (!status && !(names[found++] = strdup(entry->d_name))) status = sty_fail_memory(error, folder_name, 0);
  }
  closedir(folder);
  if (!status && found) qsort(names, found, sizeof *names, compare_names);
  *out = names;
  *count = found;
  return status;
}

/* One style a file; what is said beside the glob is said of all. */
static StyStatus add_match(StyManifest *manifest, const StyPath *path, const json_t *glob, const char *file,
                           const StyManifestStyle *common, StyError *error) {
  StyManifestStyle style = *common;
  const char *pattern = json_string_value(glob), *base = sty_get_base_name(pattern), *dot = strrchr(file, '.');
  const size_t folder = (size_t)(base - pattern), size = folder + strlen(file) + 1;
  char *path_name = malloc(size);
  if (!path_name) return sty_fail_memory(error, manifest->document.name, (double)size);
  snprintf(path_name, size, "%.*s%s", (int)folder, pattern, file);
  style.exemplars[0] = keep_string(manifest, path_name, strlen(path_name));
  style.name = keep_string(manifest, file, dot && dot > file ? (size_t)(dot - file) : strlen(file));
  free(path_name);
  if (style.exemplars[0] && style.name) return add_style(manifest, path, glob, &style, error);
  char found[512];
  snprintf(found, sizeof found, "a match '%s'", file);
  return sty_fail_found(&manifest->document, path, found, "names in UTF-8", error);
}

static StyStatus read_glob(StyManifest *manifest, const StyPath *style_path, const json_t *style,
                           const StyManifestStyle *common, StyError *error) {
  const StyDocument *document = &manifest->document;
  const StyPath path = {style_path, "glob", 0};
  const json_t *glob = json_object_get(style, "glob");
  const char *pattern = json_string_value(glob);
  if (!pattern || !*pattern)
    return sty_fail_value(document, &path, glob, "a pattern of file names, as \"painted/*.png\"", error);
  char *folder = sty_get_folder(pattern), *place = folder ? sty_join_path(manifest->folder, folder) : NULL;
  char **names = NULL;
  size_t count = 0;
  StyStatus status = place ? list_matches(place, sty_get_base_name(pattern), &names, &count, error)
                           : sty_fail_memory(error, document->name, 0);
  if (!status && count == 0) status = sty_fail_value(document, &path, glob, "a pattern that files match", error);
  for (size_t i = 0; i < count; i++) {
    if (!status) status = add_match(manifest, &path, glob, names[i], common, error);
    free(names[i]);
  }
  free(names);
  free(place);
  free(folder);
  return status;
}

static bool has_parameter(const json_t *style, const char *name) {
  return json_object_get(json_object_get(style, "params"), name);
}

static StyStatus read_style(StyManifest *manifest, const StyPath *path, const json_t *style,
                            const StyManifestStyle *defaults, StyError *error) {
  static const char *const known[] = {"name", "exemplar", "exemplars", "glob",  "guide",
                                      "base", "lut",      "params",    "check", NULL};
  const StyDocument *document = &manifest->document;
  StyManifestStyle read = *defaults;
  read.entry = path->index;
  const json_t *glob = json_object_get(style, "glob");
  StyStatus status = sty_check_keys(document, path, style, known, error);
  if (!status && glob &&
      (json_object_get(style, "name") || json_object_get(style, "exemplar") || json_object_get(style, "exemplars")))
    status = sty_fail_value(document, &(StyPath){path, "glob", 0}, glob, "either \"glob\" or a name and its exemplars",
                            error);
  if (!status && !glob) status = sty_get_string(document, path, style, "name", 1, &read.name, error);
  if (!status && !glob) status = read_exemplars(document, path, style, &read, error);
  if (!status) status = read_common(document, path, style, &read, error);
  if (status) return status;
  if (read.parameters.layer_count > 1 && !has_parameter(style, "luma_weight") &&
      !has_parameter(json_object_get(document->root, "defaults"), "luma_weight"))
    read.parameters.luma_weight = (float)default_luma_weight;
  if (glob) return read_glob(manifest, path, style, &read, error);
  return add_style(manifest, &(StyPath){path, "name", 0}, json_object_get(style, "name"), &read, error);
}

static StyStatus read_styles(StyManifest *manifest, StyError *error) {
  const StyDocument *document = &manifest->document;
  const StyPath styles_path = {NULL, "styles", 0};
  const json_t *styles = json_object_get(document->root, "styles");
  const size_t count = json_array_size(styles);
  if (!json_is_array(styles) || count < 1 || count > STY_MAX_STYLES)
    return sty_fail_value(document, styles ? &styles_path : NULL, styles, "a list \"styles\" of 1 to 256 objects",
                          error);
  StyManifestStyle defaults;
  manifest->styles = calloc(STY_MAX_STYLES, sizeof *manifest->styles);
  manifest->made = json_array();
  if (!manifest->styles || !manifest->made)
    return sty_fail_memory(error, document->name, STY_MAX_STYLES * sizeof *manifest->styles);
  StyStatus status = read_defaults(document, &defaults, error);
  for (size_t i = 0; !status && i < count; i++)
    status = read_style(manifest, &(StyPath){&styles_path, NULL, i}, json_array_get(styles, i), &defaults, error);
  return status;
}

static StyStatus read_root(StyManifest *manifest, StyError *error) {
  static const char *const known[] = {"schema", "defaults", "styles", "jitter", NULL};
  const StyDocument *document = &manifest->document;
  const char *schema = NULL;
  StyStatus status = sty_check_keys(document, NULL, document->root, known, error);
  if (!status) status = sty_get_string(document, NULL, document->root, "schema", 1, &schema, error);
  if (!status && strcmp(schema, manifest_schema) != 0)
    status = sty_fail_value(document, &(StyPath){NULL, "schema", 0}, json_object_get(document->root, "schema"),
                            "\"stylut-bundle/1\"", error);
  if (!status)
    status = read_names(document, NULL, document->root, "jitter", "a picture file, or a list of 1 to 256",
                        &manifest->jitter, error);
  return status ? status : read_styles(manifest, error);
}

StyStatus sty_parse_manifest(StyDocument *document, const char *folder, StyManifest *out, StyError *error) {
  StyManifest manifest = {.document = *document, .folder = strdup(folder)};
  *document = (StyDocument){NULL, NULL, NULL};
  const StyStatus status =
      manifest.folder ? read_root(&manifest, error) : sty_fail_memory(error, folder, (double)strlen(folder));
  if (status)
    sty_close_manifest(&manifest);
  else
    *out = manifest;
  return status;
}

StyStatus sty_read_manifest(const char *path, StyManifest *out, StyError *error) {
  StyDocument document = {NULL, NULL, NULL};
  char *folder = sty_get_folder(path);
  if (!folder) return sty_fail_memory(error, path, (double)strlen(path));
  StyStatus status = sty_read_document(path, &document, error);
  if (!status) status = sty_parse_manifest(&document, folder, out, error);
  free(folder);
  return status;
}

StyStatus sty_fail_manifest_value(const StyManifest *manifest, const StyManifestStyle *style, const char *section,
                                  const char *key, const json_t *found, const char *expected, StyError *error) {
  const json_t *root = manifest->document.root;
  const StyPath styles = {NULL, "styles", 0}, entry = {&styles, NULL, style->entry}, defaults = {NULL, "defaults", 0};
  const bool is_own = json_object_get(json_array_get(json_object_get(root, "styles"), style->entry), section);
  const StyPath path = {is_own ? &entry : &defaults, section, 0};
  return sty_fail_value(&manifest->document, &(StyPath){&path, key, 0}, found, expected, error);
}

void sty_close_manifest(StyManifest *manifest) {
  sty_close_document(&manifest->document);
  free(manifest->folder);
  free(manifest->styles);
  json_decref(manifest->made);
  *manifest = (StyManifest){.style_count = 0};
}
