/* The plan of a batch: bundles one by one, and what they share. */
#include <dirent.h>
#include <stdlib.h>
#include <string.h>

#include "batch_graph.h"

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
    while (plan->step_count > before) free_step(&plan->steps[--plan->step_count]);
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
  if (!status) fputs(ninja_head, whole);
  for (int i = 0; !status && i < plan->bundle_count; i++) status = name_bundle(plan, i, error);
  for (int i = 0; !status && i < plan->bundle_count; i++) status = add_bundle(plan, i, whole, error);
  if (whole) fclose(whole);
  if (!status) status = put_text(plan, "build.ninja", text, error);
  free(text);
  return status;
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
  for (int i = 0; i < plan->step_count; i++) free_step(&plan->steps[i]);
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
