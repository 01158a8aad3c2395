/* stylut validate BUNDLE */
#include <stdio.h>

#include "commands.h"
#include "options.h"
#include "stylut/pack.h"

typedef struct Arguments {
  Options options;
  const char *bundle;
  json_t *findings;
  int errors; /* that were printed */
} Arguments;

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  return parse_only_argument(key, text, state, &arguments->bundle, "the bundle's folder");
}

static const struct argp_child children[] = {{&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .parser = parse_option,
    .args_doc = "BUNDLE",
    .doc =
        "Verifies a bundle: index, lengths, SHA-256, KTX2 headers, parameters. Exit code 3 when anything is wrong, 2 "
        "when a file is missing.\v"
        "Findings carry permanent numbers: B1 the index can't be read, B2 a file is missing, B3 it has another length "
        "than the index says, B4 another SHA-256, B5 it isn't the texture that belongs there, B6 textures don't fit "
        "each other, B7 parameters are out of range, B8 the index lists other styles than the textures hold; what to "
        "do: pack anew, or change parameters by 'params' alone. A warning: B9 table entries point to where the "
        "exemplar has no paint; pack without \"lut\" makes a table that doesn't.",
    .children = children,
};

static void take_finding(void *context, const StyFinding *finding) {
  Arguments *arguments = context;
  if (arguments->findings) {
    json_array_append_new(arguments->findings, json_pack("{s:i, s:b, s:s, s:o}", "number", (int)finding->number,
                                                         "warning", (int)finding->warning, "file", finding->file,
                                                         "text", make_json_text(finding->text)));
  } else if (!arguments->options.quiet) {
    printf("B%d %s: %s: %s\n", (int)finding->number, finding->warning ? "warning" : "error", finding->file,
           finding->text);
    arguments->errors += !finding->warning;
  }
}

/* The bundle's status, or that of printing where the bundle is good. */
static StyStatus print_findings(json_t *findings, StyStatus status, StyError *error) {
  json_t *report = json_pack("{s:s, s:b, s:o}", "schema", "stylut-validate/1", "valid", !status, "findings", findings);
  const StyStatus printed = print_json(report, status ? NULL : error);
  return status ? status : printed;
}

StyStatus run_validate(int argc, char **argv) {
  Arguments arguments = {.bundle = NULL};
  StyError *error = &arguments.options.error;
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) {
    StyLoadedBundle bundle;
    if (arguments.options.json) arguments.findings = json_array();
    status = sty_load_bundle(arguments.bundle, take_finding, &arguments, &bundle, error);
    if (!status && !arguments.options.json && !arguments.options.quiet)
      printf("%s: valid, %zu style(s)\n", clean_text(arguments.bundle),
             json_array_size(json_object_get(bundle.index.root, "styles")));
    if (status && status != STY_ERROR_LIBRARY && arguments.errors)
      sty_fail(error, status, "%s: found %d error%s, printed beside this, expected a valid bundle", arguments.bundle,
               arguments.errors, arguments.errors == 1 ? "" : "s");
    if (!status) sty_unload_bundle(&bundle);
    if (arguments.options.json) status = print_findings(arguments.findings, status, error);
  }
  return finish_command(&arguments.options, status);
}
