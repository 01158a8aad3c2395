/* stylut params BUNDLE [--set [STYLE.]KEY=VALUE]... */
#include <stdio.h>
#include <stdlib.h>

#include "commands.h"
#include "parameters.h"

typedef struct Arguments {
  Options options;
  const char *bundle;
  Settings settings;
} Arguments;

enum { KEY_SET = 0x300, KEY_DRY_RUN };

static const struct argp_option options_table[] = {
    {"set", KEY_SET, "[STYLE.]KEY=VALUE", 0,
     "change a parameter, of all styles or of the one of this name or number; may be repeated", 0},
    {"dry-run", KEY_DRY_RUN, NULL, 0, "print what would be, and change nothing", 0},
    {0}};

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  StyStatus status = STY_OK;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: status = take_argument(&arguments->options, &arguments->bundle, text); break;
    case ARGP_KEY_END: status = require_argument(&arguments->options, arguments->bundle, "the bundle's folder"); break;
    case KEY_SET: status = take_setting(&arguments->options, &arguments->settings, text); break;
    case KEY_DRY_RUN: arguments->options.dry_run = true; break;
    default: return ARGP_ERR_UNKNOWN;
  }
  return end_option(status);
}

static const struct argp_child children[] = {{&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .options = options_table,
    .parser = parse_option,
    .args_doc = "BUNDLE",
    .doc =
        "Prints the parameters of a bundle's styles, and changes them in place: nothing is packed anew, and whoever "
        "opens the bundle meanwhile finds all of the old ones or all of the new. The folder changes places with a new "
        "one "
        "of links to the same textures.\v"
        "threshold (0 to 766): largest error of a piece, 3 * 255 levels at most; top_level (0 to 12): largest piece, "
        "2^level pixels; radius (0 to 8): of the blend; depth_tolerance: largest step of depth that is blended over, "
        "0 for any; objects (true, false): whether other objects are left out of the blend; luma_weight (0 to 16): how "
        "much light counts where a style has several exemplars; colour_weight (0 to 1): how much of the surface's "
        "colour shows; jitter_amount (0 to 1): how far pieces stray from a grid; jitter_period (0 to 65535): frames "
        "until they are laid anew, 0 for never; scale (0.5, 1, 2): of the exemplar; scatter (0 to 64): source pixels "
        "that pieces stray on flat surfaces.",
    .children = children,
};

static json_t *list_styles(const StyLoadedBundle *bundle) {
  const json_t *entries = json_object_get(bundle->index.root, "styles"), *entry;
  json_t *styles = json_array();
  size_t i;
  json_array_foreach(entries, i, entry) {
    StyStyle style;
    if (sty_get_style(&bundle->bundle, (int)i + 1, &style)) continue;
    json_array_append_new(styles, json_pack("{s:i, s:o, s:o}", "id", (int)i + 1, "name",
                                            make_json_text(sty_get_style_name(bundle, (int)i + 1)), "params",
                                            sty_describe_parameters(&style)));
  }
  return styles;
}

static void print_styles(const StyLoadedBundle *bundle) {
  const json_t *entries = json_object_get(bundle->index.root, "styles"), *entry;
  size_t i;
  json_array_foreach(entries, i, entry) {
    StyStyle style;
    if (sty_get_style(&bundle->bundle, (int)i + 1, &style)) continue;
    printf("%zu '%s': ", i + 1, clean_text(sty_get_style_name(bundle, (int)i + 1)));
    print_parameters(&style);
    putchar('\n');
  }
}

static StyStatus print_report(const Arguments *arguments, const StyLoadedBundle *bundle, StyError *error) {
  if (arguments->options.json)
    return print_json(json_pack("{s:s, s:o, s:o}", "schema", "stylut-params/1", "bundle",
                                make_json_text(arguments->bundle), "styles", list_styles(bundle)),
                      error);
  if (!arguments->options.quiet) print_styles(bundle);
  return STY_OK;
}

/* A bundle that says how it was made says how it was changed. */
static void record_edit(const Options *options, StyLoadedBundle *bundle) {
  json_t *history = json_object_get(bundle->index.root, "history"), *edits = json_object_get(history, "edits");
  if (!json_is_object(history)) return;
  if (!edits) json_object_set_new(history, "edits", edits = json_array());
  json_array_append_new(edits, get_command_line(options, "params"));
}

/* Whether the change could be saved. */
static StyStatus check_place(const char *bundle, StyError *error) {
  char *path = realpath(bundle, NULL);
  const StyStatus status = path ? sty_check_bundle_place(path, error) : sty_fail_memory(error, bundle, 0);
  free(path);
  return status;
}

static StyStatus change(const Arguments *arguments, StyLoadedBundle *bundle, StyError *error) {
  const StyStatus status = apply_settings(&arguments->settings, bundle, error);
  if (status || !arguments->settings.count) return status;
  review_bundle_parameters(&arguments->options, bundle);
  if (arguments->options.dry_run) return check_place(arguments->bundle, error);
  record_edit(&arguments->options, bundle);
  return sty_save_parameters(arguments->bundle, bundle, error);
}

static StyStatus run(const Arguments *arguments, StyError *error) {
  StyLoadedBundle bundle;
  StyStatus status = sty_load_bundle(arguments->bundle, NULL, NULL, &bundle, error);
  if (status) return status;
  status = change(arguments, &bundle, error);
  if (!status) status = print_report(arguments, &bundle, error);
  sty_unload_bundle(&bundle);
  return status;
}

StyStatus run_params(int argc, char **argv) {
  Arguments arguments = {.bundle = NULL};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments, &arguments.options.error);
  return finish_command(&arguments.options, status);
}
