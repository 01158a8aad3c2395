/* The steps of one bundle, and what each depends on. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "batch_graph.h"
#include "inside.h"
#include "stylut/scene_file.h"

/* ---- a bundle ---- */

/* A bundle whose steps are being planned. */
typedef struct Bundle {
  Plan *plan;
  int number;
  const char *name;
  char *root; /* the manifest's folder, from the root */
  Packing *packing;
  int fixed_size; /* of tables, 0: none */
  const char *fixed_by;
  json_t *index;
  json_t *guides, *guide_facts, *masks, *luts, *facts, *lut_sizes, *audits; /* files of the styles */
} Bundle;

static void name_part(const Bundle *bundle, const char *name, char out[NAME_SIZE]) {
  snprintf(out, NAME_SIZE, "%s/%s", bundle->name, name);
}

/* A user's file from the root; freed with `keeper`, a list. */
static const char *find_absolute(const Bundle *bundle, const char *name, json_t *keeper) {
  char *path = sty_join_path(bundle->root, name);
  json_t *string = path ? json_string(path) : NULL;
  free(path);
  return json_array_append_new(keeper, string) == 0 ? json_string_value(string) : "";
}

/* A user's file that a step reads. */
static void add_input(const Bundle *bundle, const char *name, Edge *edge, StyError *error) {
  char stamp[STAMP_SIZE], *path = sty_join_path(bundle->root, name);
  if (!edge->status)
    edge->status = path ? put_stamp(bundle->plan, path, stamp, error) : sty_fail_memory(error, name, 0);
  if (!edge->status) add_name(edge->inputs, stamp);
  free(path);
}

/* ---- manifests of what a step needs, no more ---- */

enum { WITH_PICTURES = 1, WITH_GUIDE = 2, WITH_BASE = 4, WITH_LUT = 8, WITH_PARAMS = 16, WITH_CHECK = 32 };

static json_t *make_names(const Bundle *bundle, const json_t *names) {
  json_t *out = json_array();
  for (size_t i = 0; i < sty_count_manifest_names(names); i++)
    find_absolute(bundle, sty_get_manifest_name(names, i), out);
  return out;
}

static json_t *make_lut(const Bundle *bundle, const StyManifestStyle *style, json_t *keeper) {
  json_t *lut = json_is_object(style->lut.written) ? json_copy((json_t *)(uintptr_t)style->lut.written) : json_object();
  if (style->lut.file) json_object_set_new(lut, "file", json_string(find_absolute(bundle, style->lut.file, keeper)));
  if (style->lut.frames) json_object_set_new(lut, "frames", make_names(bundle, style->lut.frames));
  return lut;
}

static json_t *make_style(const Bundle *bundle, int number, unsigned parts) {
  const StyManifestStyle *style = &bundle->packing->manifest.styles[number];
  json_t *keeper = json_array(), *exemplars = json_array();
  json_t *out = json_pack("{s:s, s:o}", "name", style->name, "exemplars", exemplars);
  for (int k = 0; k < style->parameters.layer_count; k++)
    json_array_append_new(
        exemplars, json_pack("{s:s, s:f}", "image",
                             parts & WITH_PICTURES ? find_absolute(bundle, style->exemplars[k], keeper) : "-", "luma",
                             (double)style->parameters.luma[k]));
  if (parts & WITH_GUIDE)
    json_object_set_new(out, "guide",
                        json_string(is_sphere(style) ? "sphere" : find_absolute(bundle, style->guide, keeper)));
  if (parts & WITH_BASE && style->base > 0) json_object_set_new(out, "base", json_real(style->base));
  if (parts & WITH_LUT) json_object_set_new(out, "lut", make_lut(bundle, style, keeper));
  if (parts & WITH_PARAMS) json_object_set_new(out, "params", sty_describe_parameters(&style->parameters));
  if (parts & WITH_CHECK && style->check) json_object_set(out, "check", (json_t *)(uintptr_t)style->check);
  json_decref(keeper);
  return out;
}

/* One style's manifest, or that of all (-1). */
static json_t *make_manifest(const Bundle *bundle, int number, unsigned parts) {
  json_t *styles = json_array();
  for (int i = 0; i < bundle->packing->manifest.style_count; i++)
    if (number < 0 || i == number) json_array_append_new(styles, make_style(bundle, i, parts));
  return json_pack("{s:s, s:o}", "schema", "stylut-bundle/1", "styles", styles);
}

static json_t *make_size(Size size) { return json_pack("[i,i]", size.width, size.height); }

static json_t *make_sizes(const Bundle *bundle, int number) {
  json_t *out = json_array();
  for (int i = 0; i < bundle->packing->manifest.style_count; i++)
    if (number < 0 || i == number) json_array_append_new(out, make_size(bundle->packing->sizes[i]));
  return out;
}

/* A step whose first output is the bundle's `output`, its recipe called after it. */
static Edge begin_bare_step(const Bundle *bundle, const char *kind, const char *output) {
  char name[NAME_SIZE], recipe_name[NAME_SIZE + 8];
  name_part(bundle, output, name);
  snprintf(recipe_name, sizeof recipe_name, "%s.json", name);
  Edge edge =
      begin_edge(json_pack("{s:s, s:s, s:s}", "schema", STEP_SCHEMA, "step", kind, "output", name), recipe_name);
  add_name(edge.outputs, name);
  return edge;
}

/* With the manifest and the sizes of one style or of all (-1). */
static Edge begin_step(const Bundle *bundle, const char *kind, const char *output, int number, unsigned parts) {
  Edge edge = begin_bare_step(bundle, kind, output);
  json_object_set_new(edge.recipe, "manifest", make_manifest(bundle, number, parts));
  json_object_set_new(edge.recipe, "size", make_size(bundle->packing->size));
  json_object_set_new(edge.recipe, "sizes", make_sizes(bundle, number));
  json_object_set_new(edge.recipe, "fit", json_string(fit_names[bundle->packing->arguments->fit]));
  return edge;
}

static StyStatus end_step(Bundle *bundle, const char *what, Edge *edge, StyError *error) {
  return put_edge(bundle->plan, bundle->number, what, edge, error);
}

/* Another output, which the recipe names as well. */
static void add_output(Edge *edge, const char *key, const char *name) {
  json_object_set_new(edge->recipe, key, json_string(name));
  add_name(edge->outputs, name);
}

/* Files that other steps make, a list, which the recipe names as well. */
static void add_files(Edge *edge, const char *key, json_t *names) {
  json_object_set(edge->recipe, key, names);
  json_array_extend(edge->inputs, names);
}

/* One style's of such a list. */
static void add_file(Edge *edge, const char *key, const json_t *names, int number) {
  json_t *one = json_pack("[O]", json_array_get(names, (size_t)number));
  add_files(edge, key, one);
  json_decref(one);
}

/* The name of a style's own file. */
static void name_style_part(const Bundle *bundle, const char *form, int number, char out[NAME_SIZE]) {
  char part[64];
  snprintf(part, sizeof part, form, number + 1);
  name_part(bundle, part, out);
}

/* ---- steps ---- */

/* A guide that is a picture has its exemplar's size. */
static StyStatus check_guide_size(const Bundle *bundle, int number, StyError *error) {
  const StyManifestStyle *style = &bundle->packing->manifest.styles[number];
  const Size size = bundle->packing->sizes[number];
  Size found = {0};
  if (is_sphere(style) || sty_is_scene_file(style->guide)) return STY_OK;
  const StyStatus status = measure_picture(bundle->packing, style->guide, &found, error);
  return status ? status : check_guide_fits(style, size, found, error);
}

/* What a guide is made by, whoever asks for it. */
static json_t *make_guide_recipe(const Bundle *bundle, int number) {
  const StyManifestStyle *style = &bundle->packing->manifest.styles[number];
  json_t *keeper = json_array();
  const char *guide = is_sphere(style) ? "sphere" : find_absolute(bundle, style->guide, keeper);
  json_t *manifest = json_pack("{s:s, s:[{s:s, s:s, s:s}]}", "schema", "stylut-bundle/1", "styles", "name", "guide",
                               "exemplar", "-", "guide", guide);
  json_decref(keeper);
  return json_pack("{s:s, s:s, s:o, s:o, s:[o], s:s}", "schema", STEP_SCHEMA, "step", "guide", "manifest", manifest,
                   "size", make_size(bundle->packing->size), "sizes", make_size(bundle->packing->sizes[number]), "fit",
                   fit_names[bundle->packing->arguments->fit]);
}

/* Guides are shared by all styles, of all bundles, that see the same at one size: they are called by their recipe. */
static StyStatus plan_guide(Bundle *bundle, int number, StyError *error) {
  Plan *plan = bundle->plan;
  const StyManifestStyle *style = &bundle->packing->manifest.styles[number];
  json_t *recipe = make_guide_recipe(bundle, number);
  char *text = recipe ? json_dumps(recipe, JSON_COMPACT | JSON_SORT_KEYS) : NULL;
  char id[STY_HASH_SIZE], output[NAME_SIZE], facts[NAME_SIZE], depfile[NAME_SIZE], recipe_name[NAME_SIZE],
      what[NAME_SIZE];
  if (!text) {
    json_decref(recipe);
    return sty_fail_memory(error, "plan", 0);
  }
  sty_hash_bytes(text, strlen(text), id);
  free(text);
  snprintf(output, sizeof output, "guides/%.16s.ktx2", id);
  snprintf(facts, sizeof facts, "guides/%.16s.facts", id);
  snprintf(depfile, sizeof depfile, "guides/%.16s.d", id);
  snprintf(recipe_name, sizeof recipe_name, "guides/%.16s.json", id);
  add_name(bundle->guides, output);
  add_name(bundle->guide_facts, facts);
  if (json_object_get(plan->guides, output)) {
    json_decref(recipe);
    return STY_OK;
  }
  json_object_set_new(plan->guides, output, json_true());
  Edge edge = begin_edge(recipe, recipe_name);
  add_output(&edge, "output", output);
  add_output(&edge, "facts", facts);
  if (!is_sphere(style)) add_input(bundle, style->guide, &edge, error);
  if (!is_sphere(style) && sty_is_scene_file(style->guide)) {
    json_object_set_new(recipe, "depfile", json_string(depfile));
    json_object_set_new(recipe, "inputs", json_string(STAMPS));
    if (bundle->packing->root) json_object_set_new(recipe, "root", json_string(bundle->packing->root));
    edge.depfile = depfile;
    edge.is_wide = true;
  }
  snprintf(what, sizeof what, "guide %.400s", is_sphere(style) ? "sphere" : style->guide);
  return end_step(bundle, what, &edge, error);
}

/* What a style's layers are made of; null where that isn't known before. */
static json_t *make_key(const Bundle *bundle, int number) {
  const StyManifestStyle *style = &bundle->packing->manifest.styles[number];
  if (style->base > 0) return json_null();
  char text[STY_MAX_LIGHTINGS * STY_HASH_SIZE + 64] = "", hash[STY_HASH_SIZE];
  for (int k = 0; k < style->parameters.layer_count; k++) {
    const char *known = json_string_value(json_object_get(bundle->packing->inputs, style->exemplars[k]));
    snprintf(text + strlen(text), sizeof text - strlen(text), "%s ", known ? known : "");
  }
  snprintf(text + strlen(text), sizeof text - strlen(text), "%d", bundle->packing->arguments->fit);
  sty_hash_bytes(text, strlen(text), hash);
  return json_string(hash);
}

static StyStatus plan_exemplars(Bundle *bundle, StyError *error) {
  const StyManifest *manifest = &bundle->packing->manifest;
  char made_of[NAME_SIZE];
  json_t *keys = json_array();
  bool has_bases = false;
  Edge edge = begin_step(bundle, "exemplars", "exemplars.ktx2", -1, WITH_PICTURES | WITH_BASE);
  edge.is_wide = true;
  name_part(bundle, "exemplars.keys", made_of);
  json_object_set_new(edge.recipe, "made_of", json_string(made_of));
  json_object_set_new(edge.recipe, "keys", keys);
  json_object_set(edge.recipe, "masks", bundle->masks);
  json_array_extend(edge.outputs, bundle->masks);
  for (int i = 0; i < manifest->style_count; i++) {
    json_array_append_new(keys, make_key(bundle, i));
    if (manifest->styles[i].base > 0) {
      has_bases = true;
      json_array_append(edge.inputs, json_array_get(bundle->guides, (size_t)i));
    }
    for (int k = 0; k < manifest->styles[i].parameters.layer_count; k++)
      add_input(bundle, manifest->styles[i].exemplars[k], &edge, error);
  }
  if (has_bases) json_object_set(edge.recipe, "guides", bundle->guides);
  return end_step(bundle, "exemplars", &edge, error);
}

static StyStatus plan_guides(Bundle *bundle, StyError *error) {
  Edge edge = begin_step(bundle, "guides", "guides.ktx2", -1, 0);
  add_files(&edge, "guides", bundle->guides);
  add_files(&edge, "masks", bundle->masks);
  return end_step(bundle, "source guides", &edge, error);
}

/* What all steps of a style's table look at. */
static Edge begin_table_step(const Bundle *bundle, const char *kind, const char *form, int number, unsigned parts) {
  char output[64];
  snprintf(output, sizeof output, form, number + 1);
  Edge edge = begin_step(bundle, kind, output, number, WITH_PICTURES | parts);
  add_file(&edge, "guides", bundle->guides, number);
  add_file(&edge, "masks", bundle->masks, number);
  return edge;
}

static StyStatus plan_lut_size(Bundle *bundle, int number, StyError *error) {
  static const char form[] = "luts/%03d.size";
  const StyManifestStyle *style = &bundle->packing->manifest.styles[number];
  char output[NAME_SIZE], what[NAME_SIZE];
  if (!has_budget(style)) return STY_OK;
  name_style_part(bundle, form, number, output);
  add_name(bundle->lut_sizes, output);
  Edge edge = begin_table_step(bundle, "lut-size", form, number, WITH_GUIDE | WITH_LUT);
  edge.is_wide = true;
  if (bundle->fixed_size) {
    json_object_set_new(edge.recipe, "fixed", json_integer(bundle->fixed_size));
    json_object_set_new(edge.recipe, "fixed_by", json_string(bundle->fixed_by));
  }
  snprintf(what, sizeof what, "size for the budget of '%.400s'", style->name);
  return end_step(bundle, what, &edge, error);
}

/* The size that is known before: all others come of budgets. */
static int find_least_size(const Bundle *bundle) {
  if (bundle->fixed_size) return bundle->fixed_size;
  for (int i = 0; i < bundle->packing->manifest.style_count; i++)
    if (!has_budget(&bundle->packing->manifest.styles[i])) return DEFAULT_LUT_SIZE;
  return 2;
}

static StyStatus plan_lut(Bundle *bundle, int number, StyError *error) {
  static const char form[] = "luts/%03d.ktx2";
  const StyManifestStyle *style = &bundle->packing->manifest.styles[number];
  char output[NAME_SIZE], facts[NAME_SIZE], what[NAME_SIZE];
  name_style_part(bundle, form, number, output);
  name_style_part(bundle, "luts/%03d.facts", number, facts);
  add_name(bundle->luts, output);
  add_name(bundle->facts, facts);
  Edge edge = begin_table_step(bundle, "lut", form, number, WITH_GUIDE | WITH_LUT);
  edge.is_wide = strcmp(style->lut.resolve, "nearest") != 0;
  add_output(&edge, "facts", facts);
  json_object_set_new(edge.recipe, "shared", json_string(SHARED_TABLES));
  json_object_set_new(edge.recipe, "lut_size", json_integer(find_least_size(bundle)));
  if (bundle->fixed_size) /* budgets were only asked whether they can be met */
    json_array_extend(edge.inputs, bundle->lut_sizes);
  else
    add_files(&edge, "lut_sizes", bundle->lut_sizes);
  if (style->lut.file) add_input(bundle, style->lut.file, &edge, error);
  if (style->lut.file && !is_sphere(style)) add_input(bundle, style->guide, &edge, error);
  for (size_t i = 0; i < sty_count_manifest_names(style->lut.frames); i++)
    add_input(bundle, sty_get_manifest_name(style->lut.frames, i), &edge, error);
  snprintf(what, sizeof what, "table of '%.400s'", style->name);
  return end_step(bundle, what, &edge, error);
}

/* Audits are for --check; the bundle then waits for them. */
static StyStatus plan_audit(Bundle *bundle, int number, StyError *error) {
  static const char form[] = "luts/%03d.audit";
  char output[NAME_SIZE], what[NAME_SIZE];
  if (!bundle->plan->arguments->check) return STY_OK;
  name_style_part(bundle, form, number, output);
  add_name(bundle->audits, output);
  Edge edge = begin_table_step(bundle, "audit", form, number, WITH_CHECK);
  add_file(&edge, "luts", bundle->luts, number);
  add_file(&edge, "facts", bundle->facts, number);
  add_file(&edge, "guide_facts", bundle->guide_facts, number);
  snprintf(what, sizeof what, "audit of '%.400s'", bundle->packing->manifest.styles[number].name);
  return end_step(bundle, what, &edge, error);
}

static StyStatus plan_luts(Bundle *bundle, StyError *error) {
  Edge edge = begin_bare_step(bundle, "luts", "luts.ktx2");
  edge.is_wide = true;
  add_files(&edge, "luts", bundle->luts);
  return end_step(bundle, "tables", &edge, error);
}

static StyStatus plan_params(Bundle *bundle, StyError *error) {
  json_t *unorm8 = json_array();
  Edge edge = begin_step(bundle, "params", "params.ktx2", -1, WITH_BASE | WITH_PARAMS);
  for (int i = 0; i < bundle->packing->manifest.style_count; i++) {
    const char *sampling = bundle->packing->manifest.styles[i].lut.sampling; /* NULL: its file knows */
    json_t *facts = json_array_get(bundle->facts, (size_t)i);
    json_array_append_new(unorm8, sampling ? json_boolean(strcmp(sampling, "unorm8") == 0) : json_incref(facts));
    if (!sampling) json_array_append(edge.inputs, facts);
  }
  json_object_set_new(edge.recipe, "unorm8", unorm8);
  json_object_set_new(edge.recipe, "jitters", json_integer(count_jitters(bundle->packing)));
  return end_step(bundle, "parameters", &edge, error);
}

static StyStatus plan_jitter(Bundle *bundle, StyError *error) {
  const PackArguments *arguments = bundle->packing->arguments;
  const json_t *files = bundle->packing->manifest.jitter;
  json_t *manifest =
      json_pack("{s:s, s:[{s:s, s:s}]}", "schema", "stylut-bundle/1", "styles", "name", "jitter", "exemplar", "-");
  Edge edge = begin_bare_step(bundle, "jitter", "jitter.ktx2");
  edge.is_wide = true;
  if (files) json_object_set_new(manifest, "jitter", make_names(bundle, files));
  json_object_set_new(edge.recipe, "manifest", manifest);
  json_object_set_new(edge.recipe, "jitter_frames", json_integer(arguments->jitter_frames));
  json_object_set_new(edge.recipe, "jitter_noise", json_string(sty_noise_names[arguments->jitter_noise]));
  json_object_set_new(edge.recipe, "seed", json_integer((json_int_t)arguments->options.seed));
  for (size_t i = 0; i < sty_count_manifest_names(files); i++)
    add_input(bundle, sty_get_manifest_name(files, i), &edge, error);
  return end_step(bundle, "jitter", &edge, error);
}

static StyStatus plan_whole(Bundle *bundle, StyError *error) {
  char output[NAME_SIZE], folder[NAME_SIZE], recipe_name[NAME_SIZE], part[NAME_SIZE];
  snprintf(folder, sizeof folder, "../%s", bundle->name);
  snprintf(output, sizeof output, "../%s/" STY_BUNDLE_INDEX, bundle->name);
  name_part(bundle, "bundle.json", recipe_name);
  json_t *recipe = json_pack("{s:s, s:s, s:s, s:s, s:s, s:O}", "schema", STEP_SCHEMA, "step", "bundle", "parts",
                             bundle->name, "bundle", folder, "root", bundle->root, "index", bundle->index);
  Edge edge = begin_edge(recipe, recipe_name);
  edge.awaited = bundle->audits;
  edge.is_wide = true; /* all is hashed */
  add_output(&edge, "output", output);
  for (int i = 0; i < STY_BUNDLE_FILES; i++) {
    name_part(bundle, sty_bundle_files[i], part);
    add_name(edge.inputs, part);
  }
  add_files(&edge, "facts", bundle->facts);
  add_files(&edge, "guide_facts", bundle->guide_facts);
  return end_step(bundle, "bundle", &edge, error);
}

/* The index, but for what only tables can say. */
static StyStatus describe_bundle(Bundle *bundle, StyError *error) {
  Packing *packing = bundle->packing;
  const Table none = {0};
  json_t *styles = json_array();
  int layer = 0;
  json_object_set_new(bundle->index, "styles", styles);
  json_object_set_new(bundle->index, "jitter", describe_jitter(packing));
  for (int i = 0; i < packing->manifest.style_count; i++) {
    const StyStyle *parameters = &packing->manifest.styles[i].parameters;
    json_array_append_new(styles, describe_style(packing, i, parameters, layer, &none));
    layer += sty_count_layers(parameters);
  }
  const StyStatus status = begin_history(packing, bundle->index, error);
  json_incref(packing->inputs); /* hashes that are needed, history or no */
  if (packing->arguments->options.no_history) json_object_del(bundle->index, "history");
  return status;
}

static StyStatus plan_steps(Bundle *bundle, StyError *error) {
  const int styles = bundle->packing->manifest.style_count;
  char name[NAME_SIZE], part[64];
  StyStatus status = STY_OK;
  for (int i = 0; i < styles; i++) {
    snprintf(part, sizeof part, "masks/%03d.pgm", i + 1);
    name_part(bundle, part, name);
    add_name(bundle->masks, name);
  }
  for (int i = 0; !status && i < styles; i++) status = plan_guide(bundle, i, error);
  if (!status) status = plan_exemplars(bundle, error);
  if (!status) status = plan_guides(bundle, error);
  for (int i = 0; !status && i < styles; i++) status = plan_lut_size(bundle, i, error);
  for (int i = 0; !status && i < styles; i++) status = plan_lut(bundle, i, error);
  for (int i = 0; !status && i < styles; i++) status = plan_audit(bundle, i, error);
  if (!status) status = plan_luts(bundle, error);
  if (!status) status = plan_params(bundle, error);
  if (!status) status = plan_jitter(bundle, error);
  return status ? status : plan_whole(bundle, error);
}

static void look_at_exemplars(const Bundle *bundle) {
  const StyManifest *manifest = &bundle->packing->manifest;
  const StyRun run = {.threads = bundle->packing->arguments->options.threads};
  char **paths = calloc((size_t)manifest->style_count * STY_MAX_LIGHTINGS, sizeof *paths);
  int count = 0;
  for (int i = 0; paths && i < manifest->style_count; i++)
    for (int k = 0; k < manifest->styles[i].parameters.layer_count; k++)
      if ((paths[count] = find_file(bundle->packing, manifest->styles[i].exemplars[k], NULL))) count++;
  if (paths) look_at_pictures(&bundle->plan->inputs, paths, count, &run);
  for (int i = 0; i < count; i++) free(paths[i]);
  free(paths);
}

static StyStatus plan_manifest(Bundle *bundle, const char *path, StyError *error) {
  Packing *packing = bundle->packing;
  const StyManifestStyle *fixed_by = NULL;
  StyStatus status = sty_read_manifest(path, &packing->manifest, error);
  if (!status) status = check_manifest(packing, error);
  if (!status) status = check_paths(packing, error);
  if (!status && !(bundle->root = realpath(packing->manifest.folder, NULL)))
    status = sty_fail(error, STY_ERROR_FILE, "%s: cannot find its folder: %s", path, strerror(errno));
  /* From here on files have the names that recipes have for them, so that each is known once. */
  char *folder = status ? NULL : strdup(bundle->root);
  if (!status && !folder) status = sty_fail_memory(error, path, 0);
  if (folder) {
    free(packing->manifest.folder);
    packing->manifest.folder = folder;
  }
  if (!status) look_at_exemplars(bundle);
  if (!status) status = measure_exemplars(packing, error);
  for (int i = 0; !status && i < packing->manifest.style_count; i++) status = check_guide_size(bundle, i, error);
  if (!status) status = find_fixed_size(packing, &bundle->fixed_size, &fixed_by, error);
  if (fixed_by) bundle->fixed_by = fixed_by->name;
  if (!status) status = describe_bundle(bundle, error);
  if (!status) status = plan_steps(bundle, error);
  bundle->plan->bundles[bundle->number].styles = packing->manifest.style_count;
  return status;
}

StyStatus plan_bundle(Plan *plan, int number, StyError *error) {
  const char *path = plan->arguments->manifests[number];
  PackArguments arguments = plan->arguments->making;
  arguments.manifest = path;
  Packing *packing = calloc(1, sizeof *packing);
  if (!packing) return sty_fail_memory(error, path, sizeof *packing);
  *packing =
      (Packing){.arguments = &arguments, .command = "batch", .records = &plan->inputs.records, .guides = json_object()};
  Bundle bundle = {.plan = plan,
                   .number = number,
                   .name = plan->bundles[number].name,
                   .packing = packing,
                   .index = json_object(),
                   .guides = json_array(),
                   .guide_facts = json_array(),
                   .audits = json_array(),
                   .masks = json_array(),
                   .luts = json_array(),
                   .facts = json_array(),
                   .lut_sizes = json_array()};
  const StyStatus status = plan_manifest(&bundle, path, error);
  json_t *const lists[] = {bundle.guide_facts, bundle.audits, bundle.index,     bundle.guides,   bundle.masks,
                           bundle.luts,        bundle.facts,  bundle.lut_sizes, packing->guides, packing->inputs};
  for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) json_decref(lists[i]);
  sty_close_manifest(&packing->manifest);
  free(bundle.root);
  free(packing->root);
  free(packing);
  return status;
}
