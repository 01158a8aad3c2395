/* The plan of a batch: which steps there are, and what each depends on. */
#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "batch.h"
#include "step.h"
#include "stylut/scene_file.h"

/* ---- files of the work folder ---- */

enum { NAME_SIZE = 512 };

/* To be written once the whole plan is made. */
static StyStatus put_text(const Plan *plan, const char *name, const char *text, StyError *error) {
  if (json_object_set_new(plan->files, name, json_string(text)) == 0) return STY_OK;
  return sty_fail(error, STY_ERROR_INPUT, "%s: found a name that isn't UTF-8, expected one that is", name);
}

/* Spends the recipe. */
static StyStatus put_recipe(const Plan *plan, const char *name, json_t *recipe, StyError *error) {
  char *text = recipe ? json_dumps(recipe, JSON_INDENT(1) | JSON_REAL_PRECISION(17)) : NULL;
  const StyStatus status = text ? put_text(plan, name, text, error) : sty_fail_memory(error, name, 0);
  free(text);
  json_decref(recipe);
  return status;
}

/* ---- the ninja file ---- */

/* A name as ninja reads it. */
static void put_name(Plan *plan, const char *name) {
  for (; *name; name++) {
    if (strchr("$ :", *name)) fputc('$', plan->ninja);
    fputc(*name, plan->ninja);
  }
}

static void put_names(Plan *plan, const json_t *names) {
  const json_t *name;
  size_t i;
  json_array_foreach(names, i, name) {
    fputc(' ', plan->ninja);
    put_name(plan, json_string_value(name));
  }
}

/* One edge of the graph. Its lists are freed when it is put. */
typedef struct Edge {
  const char *recipe;
  json_t *outputs, *inputs; /* names; inputs besides the recipe */
  const json_t *awaited;    /* what must have passed, or NULL */
  const char *depfile;      /* or NULL */
  bool is_wide;             /* uses all threads, or much memory: one such step at a time */
} Edge;

static Edge begin_edge(const char *recipe) {
  return (Edge){.recipe = recipe, .outputs = json_array(), .inputs = json_array()};
}

static void add_name(json_t *names, const char *name) { json_array_append_new(names, json_string(name)); }

static StyStatus add_step(Plan *plan, int bundle, const char *what, StyError *error) {
  if (plan->step_count == plan->step_room) {
    const int room = plan->step_room ? 2 * plan->step_room : 64;
    PlannedStep *steps = realloc(plan->steps, (size_t)room * sizeof *steps);
    if (!steps) return sty_fail_memory(error, "plan", (double)room * sizeof *steps);
    plan->steps = steps;
    plan->step_room = room;
  }
  char *copy = strdup(what);
  if (!copy) return sty_fail_memory(error, "plan", (double)strlen(what));
  plan->steps[plan->step_count++] = (PlannedStep){.what = copy, .bundle = bundle};
  return STY_OK;
}

/* What keeps a bundle from being planned. */
static StyStatus add_failure(Plan *plan, int bundle, StyStatus code, StyError *error) {
  char said[sizeof error->text + 32];
  snprintf(said, sizeof said, "stylut: error: %s\n", error->text);
  const StyStatus status = add_step(plan, bundle, "plan", error);
  if (status) return status;
  PlannedStep *step = &plan->steps[plan->step_count - 1];
  step->state = STEP_FAILED;
  step->code = code;
  step->said = strdup(said);
  error->status = STY_OK;
  return STY_OK;
}

static StyStatus put_edge(Plan *plan, int bundle, const char *what, Edge *edge, StyError *error) {
  fprintf(plan->ninja, "build");
  put_names(plan, edge->outputs);
  fprintf(plan->ninja, ": %s ", edge->depfile ? "step_with_depfile" : "step");
  put_name(plan, edge->recipe);
  fprintf(plan->ninja, " | version");
  put_names(plan, edge->inputs);
  if (json_array_size(edge->awaited) > 0) fprintf(plan->ninja, " ||");
  put_names(plan, edge->awaited);
  fprintf(plan->ninja, "\n  what = %d\n", plan->step_count);
  if (edge->depfile) fprintf(plan->ninja, "  made_of = %s\n", edge->depfile);
  if (edge->is_wide) fprintf(plan->ninja, "  pool = wide\n  threads = $$STYLUT_THREADS\n");
  json_decref(edge->outputs);
  json_decref(edge->inputs);
  return add_step(plan, bundle, what, error);
}

/* ninja keeps exit codes to itself. */
#define COMMAND                                                                    \
  "  command = \"$$STYLUT\" step $in -j $threads || { code=$$?; echo \"" STEP_EXIT \
  "$$code\"; exit $$code; }\n"                                                     \
  "  description = $what\n"                                                        \
  "  restat = 1\n"

static const char *const head =
    "# Written by stylut batch.\n"
    "ninja_required_version = 1.8\n"
    "threads = 1\n"
    "pool wide\n"
    "  depth = 1\n"
    "rule step\n" COMMAND "rule step_with_depfile\n" COMMAND "  depfile = $made_of\n";

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

static StyStatus put_stamp(Plan *plan, const char *path, char name[STAMP_SIZE], StyError *error) {
  char hash[STY_HASH_SIZE];
  name_stamp(STAMPS, path, name);
  StyStatus status = plan->inputs.records.hash(&plan->inputs.records, path, hash, error);
  char *text = status ? NULL : format_stamp(path, hash);
  if (!status && !text) status = sty_fail_memory(error, path, 0);
  if (!status) status = put_text(plan, name, text, error);
  free(text);
  return status;
}

static StyStatus add_input(const Bundle *bundle, const char *name, Edge *edge, StyError *error) {
  char stamp[STAMP_SIZE], *path = sty_join_path(bundle->root, name);
  const StyStatus status = path ? put_stamp(bundle->plan, path, stamp, error) : sty_fail_memory(error, name, 0);
  if (!status) add_name(edge->inputs, stamp);
  free(path);
  return status;
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
  json_t *lut = json_is_object(style->lut) ? json_copy((json_t *)(uintptr_t)style->lut) : json_object();
  if (style->lut_file) json_object_set_new(lut, "file", json_string(find_absolute(bundle, style->lut_file, keeper)));
  if (style->lut_frames) json_object_set_new(lut, "frames", make_names(bundle, style->lut_frames));
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
    json_object_set_new(
        out, "guide",
        json_string(strcmp(style->guide, "sphere") == 0 ? "sphere" : find_absolute(bundle, style->guide, keeper)));
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

/* What all recipes have. `manifest` and `sizes` are of one style or all. */
static json_t *begin_recipe(const Bundle *bundle, const char *kind, const char *output, int number, unsigned parts) {
  return json_pack("{s:s, s:s, s:s, s:o, s:o, s:o, s:s}", "schema", STEP_SCHEMA, "step", kind, "output", output,
                   "manifest", make_manifest(bundle, number, parts), "size", make_size(bundle->packing->size), "sizes",
                   make_sizes(bundle, number), "fit", fit_names[bundle->packing->arguments->fit]);
}

static json_t *take_one(const json_t *list, int number) {
  return json_pack("[O]", json_array_get(list, (size_t)number));
}

/* ---- steps ---- */

static bool is_sphere(const StyManifestStyle *style) { return strcmp(style->guide, "sphere") == 0; }

/* A guide that is a picture has its exemplar's size. */
static StyStatus check_guide_size(const Bundle *bundle, int number, StyError *error) {
  const StyManifestStyle *style = &bundle->packing->manifest.styles[number];
  const Size size = bundle->packing->sizes[number];
  Size found = {0};
  if (is_sphere(style) || sty_is_scene_file(style->guide)) return STY_OK;
  const StyStatus status = measure_picture(bundle->packing, style->guide, &found, error);
  return status ? status : check_guide_fits(style, size, found, error);
}

/* Guides are shared by all styles, of all bundles, that see the same at one size. */
static StyStatus plan_guide(Bundle *bundle, int number, StyError *error) {
  Plan *plan = bundle->plan;
  const StyManifestStyle *style = &bundle->packing->manifest.styles[number];
  const bool is_scene = !is_sphere(style) && sty_is_scene_file(style->guide);
  json_t *keeper = json_array();
  char id[STY_HASH_SIZE], output[NAME_SIZE], recipe_name[NAME_SIZE], depfile[NAME_SIZE], facts[NAME_SIZE],
      what[NAME_SIZE];
  const char *guide = is_sphere(style) ? "sphere" : find_absolute(bundle, style->guide, keeper);
  json_t *manifest = json_pack("{s:s, s:[{s:s, s:s, s:s}]}", "schema", "stylut-bundle/1", "styles", "name", "guide",
                               "exemplar", "-", "guide", guide);
  json_t *recipe =
      json_pack("{s:s, s:s, s:o, s:o, s:[o], s:s}", "schema", STEP_SCHEMA, "step", "guide", "manifest", manifest,
                "size", make_size(bundle->packing->size), "sizes", make_size(bundle->packing->sizes[number]), "fit",
                fit_names[bundle->packing->arguments->fit]);
  json_decref(keeper);
  char *text = recipe ? json_dumps(recipe, JSON_COMPACT | JSON_SORT_KEYS) : NULL;
  if (!text) {
    json_decref(recipe);
    return sty_fail_memory(error, "plan", 0);
  }
  sty_hash_bytes(text, strlen(text), id);
  free(text);
  snprintf(output, sizeof output, "guides/%.16s.ktx2", id);
  snprintf(recipe_name, sizeof recipe_name, "guides/%.16s.json", id);
  snprintf(depfile, sizeof depfile, "guides/%.16s.d", id);
  snprintf(facts, sizeof facts, "guides/%.16s.facts", id);
  add_name(bundle->guides, output);
  add_name(bundle->guide_facts, facts);
  if (json_object_get(plan->guides, output)) {
    json_decref(recipe);
    return STY_OK;
  }
  json_object_set_new(plan->guides, output, json_true());
  json_object_set_new(recipe, "output", json_string(output));
  json_object_set_new(recipe, "facts", json_string(facts));
  Edge edge = begin_edge(recipe_name);
  add_name(edge.outputs, output);
  add_name(edge.outputs, facts);
  if (is_scene) {
    json_object_set_new(recipe, "depfile", json_string(depfile));
    json_object_set_new(recipe, "inputs", json_string(STAMPS));
    edge.depfile = depfile;
    edge.is_wide = true;
  }
  StyStatus status = put_recipe(plan, recipe_name, recipe, error);
  if (!status && !is_sphere(style)) status = add_input(bundle, style->guide, &edge, error);
  snprintf(what, sizeof what, "guide %.400s", is_sphere(style) ? "sphere" : style->guide);
  const StyStatus put = put_edge(plan, bundle->number, what, &edge, error);
  return status ? status : put;
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
  char output[NAME_SIZE], recipe_name[NAME_SIZE], made_of[NAME_SIZE];
  bool has_bases = false;
  name_part(bundle, "exemplars.ktx2", output);
  name_part(bundle, "exemplars.json", recipe_name);
  name_part(bundle, "exemplars.keys", made_of);
  Edge edge = begin_edge(recipe_name);
  edge.is_wide = true;
  add_name(edge.outputs, output);
  json_array_extend(edge.outputs, bundle->masks);
  json_t *keys = json_array();
  StyStatus status = STY_OK;
  for (int i = 0; i < manifest->style_count; i++) {
    json_array_append_new(keys, make_key(bundle, i));
    for (int k = 0; !status && k < manifest->styles[i].parameters.layer_count; k++)
      status = add_input(bundle, manifest->styles[i].exemplars[k], &edge, error);
    if (manifest->styles[i].base > 0)
      has_bases = true, json_array_append(edge.inputs, json_array_get(bundle->guides, (size_t)i));
  }
  json_t *recipe = begin_recipe(bundle, "exemplars", output, -1, WITH_PICTURES | WITH_BASE);
  json_object_set_new(recipe, "keys", keys);
  json_object_set_new(recipe, "made_of", json_string(made_of));
  json_object_set(recipe, "masks", bundle->masks);
  if (has_bases) json_object_set(recipe, "guides", bundle->guides);
  if (!status)
    status = put_recipe(bundle->plan, recipe_name, recipe, error);
  else
    json_decref(recipe);
  const StyStatus put = put_edge(bundle->plan, bundle->number, "exemplars", &edge, error);
  return status ? status : put;
}

static StyStatus plan_guides(Bundle *bundle, StyError *error) {
  char output[NAME_SIZE], recipe_name[NAME_SIZE];
  name_part(bundle, "guides.ktx2", output);
  name_part(bundle, "guides.json", recipe_name);
  Edge edge = begin_edge(recipe_name);
  add_name(edge.outputs, output);
  json_array_extend(edge.inputs, bundle->guides);
  json_array_extend(edge.inputs, bundle->masks);
  json_t *recipe = begin_recipe(bundle, "guides", output, -1, 0);
  json_object_set(recipe, "guides", bundle->guides);
  json_object_set(recipe, "masks", bundle->masks);
  const StyStatus status = put_recipe(bundle->plan, recipe_name, recipe, error);
  const StyStatus put = put_edge(bundle->plan, bundle->number, "source guides", &edge, error);
  return status ? status : put;
}

/* Both steps of a table see its style's guide and mask. */
static void add_source(const Bundle *bundle, int number, json_t *recipe, Edge *edge) {
  json_object_set_new(recipe, "guides", take_one(bundle->guides, number));
  json_object_set_new(recipe, "masks", take_one(bundle->masks, number));
  json_array_append(edge->inputs, json_array_get(bundle->guides, (size_t)number));
  json_array_append(edge->inputs, json_array_get(bundle->masks, (size_t)number));
}

static StyStatus plan_lut_size(Bundle *bundle, int number, StyError *error) {
  char output[NAME_SIZE], recipe_name[NAME_SIZE], what[NAME_SIZE], part[64];
  const StyManifestStyle *style = &bundle->packing->manifest.styles[number];
  if (!has_budget(style)) return STY_OK;
  snprintf(part, sizeof part, "luts/%03d.size", number + 1);
  name_part(bundle, part, output);
  snprintf(part, sizeof part, "luts/%03d.size.json", number + 1);
  name_part(bundle, part, recipe_name);
  add_name(bundle->lut_sizes, output);
  Edge edge = begin_edge(recipe_name);
  edge.is_wide = true;
  add_name(edge.outputs, output);
  json_t *recipe = begin_recipe(bundle, "lut-size", output, number, WITH_PICTURES | WITH_GUIDE | WITH_LUT);
  add_source(bundle, number, recipe, &edge);
  if (bundle->fixed_size) {
    json_object_set_new(recipe, "fixed", json_integer(bundle->fixed_size));
    json_object_set_new(recipe, "fixed_by", json_string(bundle->fixed_by));
  }
  const StyStatus status = put_recipe(bundle->plan, recipe_name, recipe, error);
  snprintf(what, sizeof what, "size for the budget of '%.400s'", style->name);
  const StyStatus put = put_edge(bundle->plan, bundle->number, what, &edge, error);
  return status ? status : put;
}

/* The size that is known before: all others come of budgets. */
static int find_least_size(const Bundle *bundle) {
  if (bundle->fixed_size) return bundle->fixed_size;
  for (int i = 0; i < bundle->packing->manifest.style_count; i++)
    if (!has_budget(&bundle->packing->manifest.styles[i])) return DEFAULT_LUT_SIZE;
  return 2;
}

static StyStatus plan_lut(Bundle *bundle, int number, StyError *error) {
  char output[NAME_SIZE], facts[NAME_SIZE], recipe_name[NAME_SIZE], what[NAME_SIZE], part[64];
  const StyManifestStyle *style = &bundle->packing->manifest.styles[number];
  snprintf(part, sizeof part, "luts/%03d.ktx2", number + 1);
  name_part(bundle, part, output);
  snprintf(part, sizeof part, "luts/%03d.facts", number + 1);
  name_part(bundle, part, facts);
  snprintf(part, sizeof part, "luts/%03d.json", number + 1);
  name_part(bundle, part, recipe_name);
  add_name(bundle->luts, output);
  add_name(bundle->facts, facts);
  Edge edge = begin_edge(recipe_name);
  edge.is_wide = strcmp(style->lut_resolve, "nearest") != 0;
  add_name(edge.outputs, output);
  add_name(edge.outputs, facts);
  json_t *recipe = begin_recipe(bundle, "lut", output, number, WITH_PICTURES | WITH_GUIDE | WITH_LUT);
  add_source(bundle, number, recipe, &edge);
  json_object_set_new(recipe, "facts", json_string(facts));
  json_object_set_new(recipe, "shared", json_string(SHARED_TABLES));
  json_object_set_new(recipe, "lut_size", json_integer(find_least_size(bundle)));
  if (!bundle->fixed_size && json_array_size(bundle->lut_sizes) > 0)
    json_object_set(recipe, "lut_sizes", bundle->lut_sizes);
  json_array_extend(edge.inputs, bundle->lut_sizes);
  StyStatus status = put_recipe(bundle->plan, recipe_name, recipe, error);
  if (!status && style->lut_file) status = add_input(bundle, style->lut_file, &edge, error);
  if (!status && style->lut_file && !is_sphere(style)) status = add_input(bundle, style->guide, &edge, error);
  for (size_t i = 0; !status && i < sty_count_manifest_names(style->lut_frames); i++)
    status = add_input(bundle, sty_get_manifest_name(style->lut_frames, i), &edge, error);
  snprintf(what, sizeof what, "table of '%.400s'", style->name);
  const StyStatus put = put_edge(bundle->plan, bundle->number, what, &edge, error);
  return status ? status : put;
}

/* Audits are for --check; the bundle then waits for them. */
static StyStatus plan_audit(Bundle *bundle, int number, StyError *error) {
  char output[NAME_SIZE], recipe_name[NAME_SIZE], what[NAME_SIZE], part[64];
  const StyManifestStyle *style = &bundle->packing->manifest.styles[number];
  if (!bundle->plan->arguments->check) return STY_OK;
  snprintf(part, sizeof part, "luts/%03d.audit", number + 1);
  name_part(bundle, part, output);
  snprintf(part, sizeof part, "luts/%03d.audit.json", number + 1);
  name_part(bundle, part, recipe_name);
  add_name(bundle->audits, output);
  Edge edge = begin_edge(recipe_name);
  add_name(edge.outputs, output);
  json_t *recipe = begin_recipe(bundle, "audit", output, number, WITH_PICTURES | WITH_CHECK), *facts = json_array();
  add_source(bundle, number, recipe, &edge);
  json_array_append(facts, json_array_get(bundle->facts, (size_t)number));
  json_array_append(facts, json_array_get(bundle->guide_facts, (size_t)number));
  json_object_set_new(recipe, "facts", facts);
  json_object_set_new(recipe, "luts", take_one(bundle->luts, number));
  json_array_extend(edge.inputs, facts);
  json_array_append(edge.inputs, json_array_get(bundle->luts, (size_t)number));
  const StyStatus status = put_recipe(bundle->plan, recipe_name, recipe, error);
  snprintf(what, sizeof what, "audit of '%.400s'", style->name);
  const StyStatus put = put_edge(bundle->plan, bundle->number, what, &edge, error);
  return status ? status : put;
}

static StyStatus plan_luts(Bundle *bundle, StyError *error) {
  char output[NAME_SIZE], recipe_name[NAME_SIZE];
  name_part(bundle, "luts.ktx2", output);
  name_part(bundle, "luts.json", recipe_name);
  Edge edge = begin_edge(recipe_name);
  add_name(edge.outputs, output);
  json_array_extend(edge.inputs, bundle->luts);
  json_t *recipe =
      json_pack("{s:s, s:s, s:s, s:O}", "schema", STEP_SCHEMA, "step", "luts", "output", output, "luts", bundle->luts);
  const StyStatus status = put_recipe(bundle->plan, recipe_name, recipe, error);
  const StyStatus put = put_edge(bundle->plan, bundle->number, "tables", &edge, error);
  return status ? status : put;
}

static StyStatus plan_params(Bundle *bundle, StyError *error) {
  char output[NAME_SIZE], recipe_name[NAME_SIZE];
  name_part(bundle, "params.ktx2", output);
  name_part(bundle, "params.json", recipe_name);
  Edge edge = begin_edge(recipe_name);
  add_name(edge.outputs, output);
  json_t *recipe = begin_recipe(bundle, "params", output, -1, WITH_BASE | WITH_PARAMS), *unorm8 = json_array();
  json_object_set_new(recipe, "unorm8", unorm8);
  for (int i = 0; i < bundle->packing->manifest.style_count; i++) {
    const char *sampling = bundle->packing->manifest.styles[i].lut_sampling; /* NULL: its file knows */
    json_t *facts = json_array_get(bundle->facts, (size_t)i);
    json_array_append_new(unorm8, sampling ? json_boolean(strcmp(sampling, "unorm8") == 0) : json_incref(facts));
    if (!sampling) json_array_append(edge.inputs, facts);
  }
  json_object_set_new(recipe, "jitters", json_integer(count_jitters(bundle->packing)));
  const StyStatus status = put_recipe(bundle->plan, recipe_name, recipe, error);
  const StyStatus put = put_edge(bundle->plan, bundle->number, "parameters", &edge, error);
  return status ? status : put;
}

static StyStatus plan_jitter(Bundle *bundle, StyError *error) {
  char output[NAME_SIZE], recipe_name[NAME_SIZE];
  const PackArguments *arguments = bundle->packing->arguments;
  const json_t *files = bundle->packing->manifest.jitter;
  name_part(bundle, "jitter.ktx2", output);
  name_part(bundle, "jitter.json", recipe_name);
  Edge edge = begin_edge(recipe_name);
  edge.is_wide = true;
  add_name(edge.outputs, output);
  json_t *manifest =
      json_pack("{s:s, s:[{s:s, s:s}]}", "schema", "stylut-bundle/1", "styles", "name", "jitter", "exemplar", "-");
  if (files) json_object_set_new(manifest, "jitter", make_names(bundle, files));
  json_t *recipe = json_pack("{s:s, s:s, s:s, s:o, s:i, s:s, s:I}", "schema", STEP_SCHEMA, "step", "jitter", "output",
                             output, "manifest", manifest, "jitter_frames", arguments->jitter_frames, "jitter_noise",
                             sty_noise_names[arguments->jitter_noise], "seed", (json_int_t)arguments->options.seed);
  StyStatus status = put_recipe(bundle->plan, recipe_name, recipe, error);
  for (size_t i = 0; !status && i < sty_count_manifest_names(files); i++)
    status = add_input(bundle, sty_get_manifest_name(files, i), &edge, error);
  const StyStatus put = put_edge(bundle->plan, bundle->number, "jitter", &edge, error);
  return status ? status : put;
}

static StyStatus plan_whole(Bundle *bundle, StyError *error) {
  char output[NAME_SIZE], folder[NAME_SIZE], recipe_name[NAME_SIZE], part[NAME_SIZE];
  snprintf(folder, sizeof folder, "../%s", bundle->name);
  snprintf(output, sizeof output, "../%s/" STY_BUNDLE_INDEX, bundle->name);
  name_part(bundle, "bundle.json", recipe_name);
  Edge edge = begin_edge(recipe_name);
  add_name(edge.outputs, output);
  for (int i = 0; i < STY_BUNDLE_FILES; i++) {
    name_part(bundle, sty_bundle_files[i], part);
    add_name(edge.inputs, part);
  }
  json_array_extend(edge.inputs, bundle->facts);
  json_array_extend(edge.inputs, bundle->guide_facts);
  edge.awaited = bundle->audits;
  json_t *recipe = json_pack("{s:s, s:s, s:s, s:s, s:s, s:s, s:O, s:O, s:O}", "schema", STEP_SCHEMA, "step", "bundle",
                             "output", output, "parts", bundle->name, "bundle", folder, "root", bundle->root, "facts",
                             bundle->facts, "guide_facts", bundle->guide_facts, "index", bundle->index);
  const StyStatus status = put_recipe(bundle->plan, recipe_name, recipe, error);
  const StyStatus put = put_edge(bundle->plan, bundle->number, "bundle", &edge, error);
  return status ? status : put;
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

static StyStatus plan_manifest(Bundle *bundle, const char *path, StyError *error) {
  Packing *packing = bundle->packing;
  const StyManifestStyle *fixed_by = NULL;
  StyStatus status = sty_read_manifest(path, &packing->manifest, error);
  if (!status) status = check_manifest(packing, error);
  if (!status && !(bundle->root = realpath(packing->manifest.folder, NULL)))
    status = sty_fail(error, STY_ERROR_FILE, "%s: cannot find its folder: %s", path, strerror(errno));
  if (!status) status = measure_exemplars(packing, error);
  for (int i = 0; !status && i < packing->manifest.style_count; i++) status = check_guide_size(bundle, i, error);
  if (!status) status = find_fixed_size(packing, &bundle->fixed_size, &fixed_by, error);
  if (fixed_by) bundle->fixed_by = fixed_by->name;
  if (!status) status = describe_bundle(bundle, error);
  if (!status) status = plan_steps(bundle, error);
  bundle->plan->bundles[bundle->number].styles = packing->manifest.style_count;
  return status;
}

static StyStatus plan_bundle(Plan *plan, int number, StyError *error) {
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
  free(packing);
  return status;
}

/* ---- the whole ---- */

/* Bundles are called as their manifests, without the ending. */
static StyStatus name_bundle(Plan *plan, int number, StyError *error) {
  PlannedBundle *bundle = &plan->bundles[number];
  const char *path = plan->arguments->manifests[number], *base = sty_get_base_name(path), *dot = strrchr(base, '.');
  const size_t length = dot && dot > base ? (size_t)(dot - base) : strlen(base);
  bundle->manifest = strdup(path);
  bundle->name = strndup(base, length);
  if (!bundle->manifest || !bundle->name) return sty_fail_memory(error, path, 0);
  if (length == 0 || length > 200 || strchr(bundle->name, '\n') || *bundle->name == '.' ||
      strcmp(bundle->name, "guides") == 0 || strcmp(bundle->name, STAMPS) == 0 ||
      strcmp(bundle->name, SHARED_TABLES) == 0)
    return sty_fail(error, STY_ERROR_USAGE,
                    "%s: found a name that no bundle can have, expected another for the manifest", path);
  for (int i = 0; i < number; i++)
    if (strcmp(plan->bundles[i].name, bundle->name) == 0)
      return sty_fail(error, STY_ERROR_USAGE,
                      "found manifests %s and %s, whose bundles have one name, expected different names",
                      plan->bundles[i].manifest, path);
  return STY_OK;
}

/* The steps of a bundle whose plan fails are forgotten; with --keep-going that is a failed step among others. */
static StyStatus add_bundle(Plan *plan, int number, FILE *whole, StyError *error) {
  char *text = NULL;
  size_t size = 0;
  const int before = plan->step_count;
  json_t *guides = json_copy(plan->guides);
  plan->ninja = open_memstream(&text, &size);
  StyStatus status = plan->ninja ? plan_bundle(plan, number, error) : sty_fail_memory(error, "plan", 0);
  if (plan->ninja) fclose(plan->ninja);
  plan->ninja = NULL;
  if (!status) fputs(text, whole);
  free(text);
  if (status) {
    while (plan->step_count > before) free(plan->steps[--plan->step_count].what);
    json_object_clear(plan->guides);
    json_object_update(plan->guides, guides);
  }
  json_decref(guides);
  return status && plan->arguments->keep_going ? add_failure(plan, number, status, error) : status;
}

/* Of a file that steps found in others; one that is gone has no hash. */
static StyStatus renew_stamp(Plan *plan, const char *path, StyError *error) {
  char name[STAMP_SIZE];
  if (put_stamp(plan, path, name, NULL) == STY_OK) return STY_OK;
  char *text = format_stamp(path, "missing");
  const StyStatus status = text ? put_text(plan, name, text, error) : sty_fail_memory(error, path, 0);
  free(text);
  return status;
}

static StyStatus renew_stamps(Plan *plan, StyError *error) {
  char *folder_name = sty_join_path(plan->folder, STAMPS);
  DIR *folder = folder_name ? opendir(folder_name) : NULL;
  StyStatus status = folder_name ? STY_OK : sty_fail_memory(error, plan->folder, 0);
  for (const struct dirent *entry; !status && folder && (entry = readdir(folder));) {
    char *stamp = sty_join_path(folder_name, entry->d_name), *path = stamp ? read_stamp(stamp) : NULL;
    if (path) status = renew_stamp(plan, path, error);
    free(path);
    free(stamp);
  }
  if (folder) closedir(folder);
  free(folder_name);
  return status;
}

static StyStatus make_plan(Plan *plan, StyError *error) {
  char *text = NULL;
  size_t size = 0;
  FILE *whole = open_memstream(&text, &size);
  StyStatus status = whole ? renew_stamps(plan, error) : sty_fail_memory(error, "plan", 0);
  if (!status) status = put_text(plan, "version", "stylut " STY_VERSION "\n", error);
  if (!status) fputs(head, whole);
  for (int i = 0; !status && i < plan->bundle_count; i++) status = name_bundle(plan, i, error);
  for (int i = 0; !status && i < plan->bundle_count; i++) status = add_bundle(plan, i, whole, error);
  if (whole) fclose(whole);
  if (!status) status = put_text(plan, "build.ninja", text, error);
  free(text);
  return status;
}

/* ---- on disk ---- */

static StyStatus make_folder(const char *path, StyError *error) {
  if (mkdir(path, 0777) == 0 || errno == EEXIST) return STY_OK;
  return sty_fail(error, STY_ERROR_FILE, "%s: cannot make the folder: %s", path, strerror(errno));
}

static bool holds_text(const char *path, const char *text) {
  unsigned char *held = NULL;
  size_t size = 0;
  const bool holds = sty_read_file(path, 1 << 26, &held, &size, NULL) == STY_OK && size == strlen(text) &&
                     memcmp(held, text, size) == 0;
  free(held);
  return holds;
}

/* Files that stay as they are keep their time. */
static StyStatus write_text(const char *path, const char *text, StyError *error) {
  StyOutput output;
  if (holds_text(path, text)) return STY_OK;
  const StyStatus status = sty_open_output(path, &output, error);
  if (status) return status;
  fputs(text, output.stream);
  return sty_commit_output(&output, error);
}

/* Makes the folders on the way to a file of the work folder. */
static StyStatus make_way(const Plan *plan, const char *name, StyError *error) {
  char *path = sty_join_path(plan->folder, name);
  if (!path) return sty_fail_memory(error, name, 0);
  StyStatus status = STY_OK;
  for (char *slash = path + strlen(plan->folder); !status && (slash = strchr(slash + 1, '/'));) {
    *slash = 0;
    status = make_folder(path, error);
    *slash = '/';
  }
  free(path);
  return status;
}

StyStatus write_plan(Plan *plan, StyError *error) {
  const char *name;
  json_t *text;
  StyStatus status = make_folder(plan->arguments->making.options.output, error);
  if (!status) status = make_folder(plan->folder, error);
  if (!status) status = make_way(plan, STAMPS "/", error);
  if (!status) status = make_way(plan, SHARED_TABLES "/", error);
  json_object_foreach(plan->files, name, text) {
    char *path = sty_join_path(plan->folder, name);
    if (!status) status = path ? make_way(plan, name, error) : sty_fail_memory(error, name, 0);
    if (!status) status = write_text(path, json_string_value(text), error);
    free(path);
  }
  for (int i = 0; i < plan->bundle_count; i++)
    for (int k = 0; k < 2; k++) {
      char folder[NAME_SIZE];
      snprintf(folder, sizeof folder, "%s/%s/", plan->bundles[i].name, k ? "luts" : "masks");
      if (!status) status = make_way(plan, folder, error);
    }
  return status ? status : save_inputs(&plan->inputs, error);
}

StyStatus open_plan(BatchArguments *arguments, Plan *out, StyError *error) {
  *out = (Plan){.arguments = arguments,
                .guides = json_object(),
                .files = json_object(),
                .bundle_count = arguments->manifest_count};
  out->folder = sty_join_path(arguments->making.options.output, WORK_FOLDER);
  out->bundles = calloc((size_t)out->bundle_count, sizeof *out->bundles);
  char *known = out->folder ? sty_join_path(out->folder, "inputs.json") : NULL;
  StyStatus status =
      known && out->bundles ? open_inputs(known, &out->inputs, error) : sty_fail_memory(error, "plan", 0);
  free(known);
  return status ? status : make_plan(out, error);
}

void close_plan(Plan *plan) {
  for (int i = 0; i < plan->step_count; i++) {
    free(plan->steps[i].what);
    free(plan->steps[i].said);
  }
  for (int i = 0; plan->bundles && i < plan->bundle_count; i++) {
    free(plan->bundles[i].manifest);
    free(plan->bundles[i].name);
  }
  close_inputs(&plan->inputs);
  json_decref(plan->guides);
  json_decref(plan->files);
  free(plan->steps);
  free(plan->bundles);
  free(plan->folder);
  *plan = (Plan){.folder = NULL};
}
