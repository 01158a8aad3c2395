/* stylut step RECIPE.json: one step of a batch, for its ninja file and for other machines. */
#include "step.h"

#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "step_due.h"

typedef struct Arguments {
  Options options;
  const char *recipe;
  bool due;
} Arguments;

enum { KEY_DUE = 0x200 };
static const struct argp_option options_table[] = {
    {"due", KEY_DUE, NULL, 0, "do nothing where it was done with these very files before", 0}, {0}};

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  if (key != KEY_DUE) return parse_only_argument(key, text, state, &arguments->recipe, "a step's recipe");
  begin_option(key, text, state);
  arguments->due = true;
  return 0;
}

static const struct argp_child children[] = {{&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .options = options_table,
    .parser = parse_option,
    .args_doc = "RECIPE.json",
    .doc =
        "Does one step of a batch, as 'stylut batch' wrote it down: a guide, a look-up table, a texture array, a "
        "bundle. "
        "Its ninja file calls this; by hand, in the work folder, it shows what a step that failed does.\v"
        "An output that would hold the same bytes as before stays as it is, so that nothing that depends on it is made "
        "anew.",
    .children = children,
};

typedef struct StepKind {
  const char *name;
  StyStatus (*run)(Step *step, StyError *error);
} StepKind;

static const StepKind kinds[] = {
    {"guide", step_guide},   {"exemplars", step_exemplars}, {"guides", step_guides}, {"lut-size", step_lut_size},
    {"lut", step_lut},       {"luts", step_luts},           {"audit", step_audit},   {"params", step_params},
    {"jitter", step_jitter}, {"bundle", step_bundle},
};
enum { KINDS = sizeof kinds / sizeof *kinds };

static StyStatus read_size(const Step *step, const json_t *pair, Size *out, StyError *error) {
  if (json_unpack((json_t *)(uintptr_t)pair, "[i,i!]", &out->width, &out->height) == 0 && out->width > 0 &&
      out->height > 0 && out->width <= STY_MAX_SOURCE_SIDE && out->height <= STY_MAX_SOURCE_SIDE)
    return STY_OK;
  return sty_fail(error, STY_ERROR_INPUT, "%s: found another size than [width, height], expected sides from 1 to %d",
                  step->recipe.name, STY_MAX_SOURCE_SIDE);
}

/* The bundle's manifest, and what becomes of its pictures. */
static StyStatus read_packing(Step *step, StyError *error) {
  const json_t *root = step->recipe.root, *sizes = json_object_get(root, "sizes");
  json_t *manifest = json_object_get(root, "manifest");
  Packing *packing = &step->packing;
  StyStatus status = STY_OK;
  packing->arguments = &step->arguments;
  packing->guides = json_object();
  if (!json_is_object(manifest)) return STY_OK;
  StyDocument document = {strdup(step->recipe.name), strdup(step->recipe.text), json_incref(manifest)};
  if (!document.name || !document.text) {
    sty_close_document(&document);
    return sty_fail_memory(error, step->recipe.name, (double)strlen(step->recipe.text));
  }
  status = sty_parse_manifest(&document, ".", &packing->manifest, error);
  if (!status && json_object_get(root, "size"))
    status = read_size(step, json_object_get(root, "size"), &packing->size, error);
  for (int i = 0; !status && sizes && i < packing->manifest.style_count; i++)
    status = read_size(step, json_array_get(sizes, (size_t)i), &packing->sizes[i], error);
  return status;
}

static StyStatus read_recipe(Step *step, StyError *error) {
  const StyDocument *recipe = &step->recipe;
  const char *schema = NULL;
  StyStatus status = sty_get_string(recipe, NULL, recipe->root, "schema", 1, &schema, error);
  if (!status && strcmp(schema, STEP_SCHEMA) != 0)
    status = sty_fail_value(recipe, &(StyPath){NULL, "schema", 0}, json_object_get(recipe->root, "schema"),
                            "\"" STEP_SCHEMA "\"", error);
  if (!status) status = sty_get_string(recipe, NULL, recipe->root, "step", 1, &step->kind, error);
  if (!status) status = sty_get_string(recipe, NULL, recipe->root, "output", 1, &step->output, error);
  if (!status) status = sty_get_choice(recipe, NULL, recipe->root, "fit", fit_names, &step->arguments.fit, error);
  return status ? status : read_packing(step, error);
}

static void close_step(Step *step) {
  sty_close_document(&step->recipe);
  sty_close_manifest(&step->packing.manifest);
  json_decref(step->packing.guides);
  json_decref(step->packing.inputs);
  free(step->packing.root);
  free(step);
}

static StyStatus run(const Arguments *arguments, StyError *error) {
  Step *step = calloc(1, sizeof *step);
  if (!step) return sty_fail_memory(error, arguments->recipe, sizeof *step);
  step->arguments = (PackArguments){.options = arguments->options, .jitter_frames = 1};
  StyStatus status = sty_read_document(arguments->recipe, &step->recipe, error);
  if (!status) status = read_recipe(step, error);
  const StepKind *kind = NULL;
  for (int i = 0; !status && i < KINDS; i++)
    if (strcmp(kinds[i].name, step->kind) == 0) kind = &kinds[i];
  if (!status && !kind)
    status = sty_fail_value(&step->recipe, &(StyPath){NULL, "step", 0}, json_object_get(step->recipe.root, "step"),
                            "a step of this version's batches", error);
  if (!status && (!arguments->due || is_step_due(&step->recipe))) {
    json_t *inputs = note_inputs(&step->recipe);
    status = kind->run(step, error);
    if (status)
      json_decref(inputs);
    else
      status = note_done(&step->recipe, inputs, error);
  }
  close_step(step);
  return status;
}

StyStatus run_step(int argc, char **argv) {
  Arguments arguments = {.recipe = NULL};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments, &arguments.options.error);
  return finish_command(&arguments.options, status);
}
