/* The graph of a batch as ninja reads it, and the files that it needs. */
#include "batch_graph.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* ---- files of the work folder ---- */

StyStatus put_text(const Plan *plan, const char *name, const char *text, StyError *error) {
  if (json_object_set_new(plan->files, name, json_string(text)) == 0) return STY_OK;
  return sty_fail(error, STY_ERROR_INPUT, "%s: found a name that isn't UTF-8, expected one that is", name);
}

StyStatus put_stamp(Plan *plan, const char *path, char name[STAMP_SIZE], StyError *error) {
  char hash[STY_HASH_SIZE];
  name_stamp(STAMPS, path, name);
  StyStatus status = plan->inputs.records.hash(&plan->inputs.records, path, hash, error);
  char *text = status ? NULL : format_stamp(path, hash);
  if (!status && !text) status = sty_fail_memory(error, path, 0);
  if (!status) status = put_text(plan, name, text, error);
  free(text);
  return status;
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

Edge begin_edge(json_t *recipe, const char *recipe_name) {
  Edge edge = {.recipe = recipe, .outputs = json_array(), .inputs = json_array()};
  snprintf(edge.recipe_name, sizeof edge.recipe_name, "%s", recipe_name);
  return edge;
}

void add_name(json_t *names, const char *name) { json_array_append_new(names, json_string(name)); }

void free_step(PlannedStep *step) {
  free(step->what);
  free(step->recipe);
  free(step->said);
  json_decref(step->makes);
  json_decref(step->takes);
  json_decref(step->awaits);
}

/* Takes all that the step has. */
static StyStatus add_step(Plan *plan, const char *what, PlannedStep *step, StyError *error) {
  if (plan->step_count == plan->step_room) {
    const int room = plan->step_room ? 2 * plan->step_room : 64;
    PlannedStep *steps = realloc(plan->steps, (size_t)room * sizeof *steps);
    if (steps) plan->step_room = room;
    if (steps) plan->steps = steps;
  }
  step->what = strdup(what);
  if (step->what && plan->step_count < plan->step_room) {
    plan->steps[plan->step_count++] = *step;
    return STY_OK;
  }
  free_step(step);
  return sty_fail_memory(error, "plan", (double)(plan->step_count + 1) * sizeof *step);
}

StyStatus add_failure(Plan *plan, int bundle, StyStatus code, StyError *error) {
  PlannedStep step = {.bundle = bundle, .state = STEP_FAILED, .code = code};
  if (asprintf(&step.said, "stylut: error: %s\n", error->text) < 0) step.said = NULL;
  error->status = STY_OK;
  return add_step(plan, "plan", &step, error);
}

static void put_build(Plan *plan, const Edge *edge) {
  fprintf(plan->ninja, "build");
  put_names(plan, edge->outputs);
  fprintf(plan->ninja, ": step ");
  put_name(plan, edge->recipe_name);
  fprintf(plan->ninja, " | version");
  put_names(plan, edge->inputs);
  if (json_array_size(edge->awaited) > 0) fprintf(plan->ninja, " ||");
  put_names(plan, edge->awaited);
  fprintf(plan->ninja, "\n  what = %d\n", plan->step_count);
  if (edge->depfile) fprintf(plan->ninja, "  made_of = %s\n", edge->depfile);
  if (edge->is_wide) fprintf(plan->ninja, "  pool = wide\n  threads = $$STYLUT_THREADS\n");
}

StyStatus put_edge(Plan *plan, int bundle, const char *what, Edge *edge, StyError *error) {
  PlannedStep step = {.bundle = bundle,
                      .is_wide = edge->is_wide,
                      .recipe = strdup(edge->recipe_name),
                      .makes = edge->outputs,
                      .takes = edge->inputs,
                      .awaits = json_incref((json_t *)(uintptr_t)edge->awaited)};
  StyStatus status = edge->status;
  if (!status && !step.recipe) status = sty_fail_memory(error, what, 0);
  if (!status) json_object_set(edge->recipe, "makes", edge->outputs);
  if (!status) json_object_set(edge->recipe, "takes", edge->inputs);
  if (status)
    json_decref(edge->recipe);
  else
    status = put_recipe(plan, edge->recipe_name, edge->recipe, error);
  put_build(plan, edge);
  if (!status) return add_step(plan, what, &step, error);
  free_step(&step);
  return status;
}

/* ninja keeps exit codes to itself. */
const char *const ninja_head =
    "# Written by stylut batch.\n"
    "ninja_required_version = 1.8\n"
    "threads = 1\n"
    "pool wide\n"
    "  depth = 1\n"
    "rule step\n"
    "  command = \"$$STYLUT\" step --due $in -j $threads $$STYLUT_LIMITS || { code=$$?; echo \"" STEP_EXIT
    "$$code\"; exit $$code; }\n"
    "  description = $what\n"
    "  restat = 1\n"
    "  depfile = $made_of\n";

/* ---- on disk ---- */

static StyStatus make_folder(const char *path, StyError *error) {
  if (mkdir(path, 0777) == 0 || errno == EEXIST) return STY_OK;
  return sty_fail(error, STY_ERROR_FILE, "%s: cannot make the folder: %s", path, strerror(errno));
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
