/* stylut batch MANIFEST.json... -o FOLDER */
#include "batch.h"

#include <stdlib.h>
#include <unistd.h>

#include "commands.h"
#include "stylut/parse.h"

static const char *const executors[] = {"ninja", "slurm", NULL};

enum { KEY_JUNIT = 0x400, KEY_CHECK, KEY_EXECUTOR, KEY_SBATCH };
static const struct argp_option options_table[] = {
    {"keep-going", 'k', NULL, 0, "go on with what doesn't need a step that failed, and say all failures at the end",
     UNRECORDED},
    {"check", KEY_CHECK, NULL, 0,
     "audit every table, hold it to its style's \"check\", and pack no bundle of which one fails", UNRECORDED},
    {"junit", KEY_JUNIT, "FILE.xml", 0, "write what came of each step as JUnit XML, for CI", UNRECORDED},
    {"executor", KEY_EXECUTOR, "ninja|slurm", 0,
     "who does the steps: ninja, on this machine (default), or Slurm, as job arrays on a cluster that shares the "
     "folder; "
     "-j then is the CPUs of a step that uses several (default: 1)",
     UNRECORDED},
    {"sbatch", KEY_SBATCH, "OPTION", 0, "an option for Slurm's sbatch, as --partition=main; may be repeated",
     UNRECORDED},
    {0}};

static StyStatus add_manifest(BatchArguments *arguments, const char *text) {
  const size_t size = (size_t)(arguments->manifest_count + 1) * sizeof *arguments->manifests;
  const char **longer = realloc(arguments->manifests, size);
  if (!longer) return sty_fail_memory(&arguments->making.options.error, text, (double)size);
  arguments->manifests = longer;
  arguments->manifests[arguments->manifest_count++] = text;
  return STY_OK;
}

static StyStatus add_sbatch(BatchArguments *arguments, const char *text) {
  if (arguments->sbatch_count == MOST_SBATCH)
    return sty_fail(&arguments->making.options.error, STY_ERROR_USAGE,
                    "--sbatch: found more than %d, expected at most that", MOST_SBATCH);
  arguments->sbatch[arguments->sbatch_count++] = text;
  return STY_OK;
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  BatchArguments *arguments = state->input;
  Options *options = &arguments->making.options;
  StyStatus status = STY_OK;
  const OptionNeed sbatch_need = {"sbatch", arguments->executor == BY_SLURM, "--executor slurm"};
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: status = add_manifest(arguments, text); break;
    case ARGP_KEY_END:
      status = require_argument(options, arguments->manifest_count ? "" : NULL, "one or more manifests");
      if (!status) status = require_output(options);
      if (!status) status = check_needs(options, &sbatch_need, 1);
      if (!status && arguments->junit) status = require_folder(options, arguments->junit);
      break;
    case 'k': arguments->keep_going = true; break;
    case KEY_CHECK: arguments->check = true; break;
    case KEY_EXECUTOR:
      status = sty_parse_choice("--executor", text, executors, &arguments->executor, &options->error);
      break;
    case KEY_SBATCH: status = add_sbatch(arguments, text); break;
    case KEY_JUNIT: arguments->junit = text; break;
    default: return ARGP_ERR_UNKNOWN;
  }
  return end_option(status);
}

static const struct argp_child children[] = {
    {&making_argp, 0, NULL, 0}, {&output_argp, 0, NULL, 0}, {&seed_argp, 0, NULL, 0}, {&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .options = options_table,
    .parser = parse_option,
    .args_doc = "MANIFEST.json... -o FOLDER",
    .doc =
        "Packs a bundle for each manifest into a folder, FOLDER/NAME for NAME.json, and makes only what has changed "
        "since the last time: guides, tables and textures are steps of their own, which ninja takes in parallel. What "
        "was interrupted goes on where it was.\v"
        "Manifests are those of 'stylut pack'. Changes are told by content: a file that was touched, or checked out "
        "anew, costs nothing. FOLDER/" WORK_FOLDER
        " holds what is in between, among it build.ninja and the recipe of each step ('stylut step' does one); it may "
        "be removed at any time, and everything is made anew then. Exit code: that of the first step that failed.",
    .children = children,
};

/* The first failure's. */
static StyStatus find_failure(const Plan *plan) {
  for (int i = 0; i < plan->step_count; i++)
    if (plan->steps[i].state == STEP_FAILED) return plan->steps[i].code ? plan->steps[i].code : STY_ERROR_LIBRARY;
  return STY_OK;
}

/* Where nothing was made yet, all is to be done, and a dry run leaves no trace of that. */
static StyStatus do_plan(Plan *plan, StyError *error) {
  const bool dry = plan->arguments->making.options.dry_run;
  if (dry && access(plan->folder, F_OK) != 0) {
    for (int i = 0; i < plan->step_count; i++)
      if (plan->steps[i].state == STEP_LEFT) plan->steps[i].state = STEP_DONE;
    return STY_OK;
  }
  StyStatus status = write_plan(plan, error);
  if (!status) status = (plan->arguments->executor == BY_SLURM ? run_by_slurm : run_by_ninja)(plan, dry, error);
  if (!status && !dry) prune_tables(plan);
  return status;
}

static StyStatus run(BatchArguments *arguments) {
  StyError *error = &arguments->making.options.error;
  const double start = sty_get_milliseconds();
  Plan plan;
  StyStatus status = open_plan(arguments, &plan, error);
  if (!status) status = do_plan(&plan, error);
  if (!status) status = report_plan(&plan, sty_get_milliseconds() - start, error);
  const StyStatus failed = status ? STY_OK : find_failure(&plan);
  close_plan(&plan);
  return failed ? failed : status; /* the report has said why */
}

StyStatus run_batch(int argc, char **argv) {
  BatchArguments arguments = {.making = {.jitter_frames = 1}};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.making.options.helped) status = run(&arguments);
  free(arguments.manifests);
  return finish_command(&arguments.making.options, status);
}
