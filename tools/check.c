/* stylut check LUT --guide GUIDE: the audit, and budgets for CI. */
#include <stdio.h>
#include <stdlib.h>

#include "commands.h"
#include "inputs.h"
#include "options.h"
#include "stylut/audit.h"
#include "stylut/parse.h"

typedef struct Arguments {
  Options options;
  const char *lut, *guide;
  double tolerance;                                  /* 8-bit levels */
  double max_mean, max_p99, max_error, min_coverage; /* negative: no budget */
} Arguments;

enum { KEY_GUIDE = 0x200, KEY_TOLERANCE, KEY_MAX_MEAN, KEY_MAX_P99, KEY_MAX_ERROR, KEY_MIN_COVERAGE };

static const struct argp_option options_table[] = {
    {"guide", KEY_GUIDE, "FILE", 0, "the guide the table was made for", 0},
    {"tolerance", KEY_TOLERANCE, "LEVELS", 0,
     "a value is covered when a source pixel lies within so many 8-bit levels (default: 4)", 0},
    {NULL, 0, NULL, 0, "Budgets, on the lookup error in degrees:", 0},
    {"max-mean", KEY_MAX_MEAN, "DEG", 0, "mean", 0},
    {"max-p99", KEY_MAX_P99, "DEG", 0, "99th percentile", 0},
    {"max-error", KEY_MAX_ERROR, "DEG", 0, "maximum", 0},
    {"min-coverage", KEY_MIN_COVERAGE, "SHARE", 0, "covered share of the domain, 0 to 1", 0},
    {0},
};

static StyStatus check_arguments(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  const StyStatus status = require_argument(&arguments->options, arguments->lut, "the table's file name");
  if (status) return status;
  if (!arguments->guide)
    return sty_fail(error, STY_ERROR_USAGE, "option '--guide': found none, expected the guide the table was made for");
  return STY_OK;
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  StyError *error = &arguments->options.error;
  StyStatus status = STY_OK;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: status = take_argument(&arguments->options, &arguments->lut, text); break;
    case ARGP_KEY_END: status = check_arguments(arguments); break;
    case KEY_GUIDE: arguments->guide = text; break;
    case KEY_TOLERANCE: status = sty_parse_number("--tolerance", text, 0, 255, &arguments->tolerance, error); break;
    case KEY_MAX_MEAN: status = sty_parse_number("--max-mean", text, 0, 180, &arguments->max_mean, error); break;
    case KEY_MAX_P99: status = sty_parse_number("--max-p99", text, 0, 180, &arguments->max_p99, error); break;
    case KEY_MAX_ERROR: status = sty_parse_number("--max-error", text, 0, 180, &arguments->max_error, error); break;
    case KEY_MIN_COVERAGE:
      status = sty_parse_number("--min-coverage", text, 0, 1, &arguments->min_coverage, error);
      break;
    default: return ARGP_ERR_UNKNOWN;
  }
  return end_option(status);
}

static const struct argp_child children[] = {{&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .options = options_table,
    .parser = parse_option,
    .args_doc = "LUT --guide GUIDE",
    .doc =
        "Audits a table against its guide and holds it to budgets: exit code 6 when one is exceeded.\v"
        "Errors are angles between the normal asked for and the normal of the source pixel given, in degrees: at the "
        "values texels answer for (assignment), and for values in between (lookup). Near the silhouette a small "
        "step turns the normal far, so p99 and max are ruled by the rim.",
    .children = children,
};

static StyStatus audit(const Arguments *arguments, StyAudit *out, StyError *error) {
  StyImage *guide = NULL;
  StySites *sites = NULL;
  StyLut *lut = NULL, *exact = NULL;
  const StyEngine *engine = NULL;
  StyStatus status = read_guide(arguments->guide, &guide, error);
  if (!status) {
    const StyLutHints hints = {guide->width, guide->height, -1};
    status = read_lut(arguments->lut, &hints, &lut, error);
    if (status) sty_fail(error, status, "%s (its guide being %s)", error->text, arguments->guide);
  }
  if (!status) status = sty_collect_sites(arguments->guide, guide, &sites, error);
  if (!status) status = sty_find_engine("engine", "auto", &engine, error);
  if (!status) {
    const StyRun run = begin_progress(&arguments->options, "auditing");
    status = sty_build_lut(sites, engine, lut->size, lut->sampling, &run, &exact, error);
    end_progress(&arguments->options);
  }
  if (!status) status = sty_audit_lut(lut, exact, guide, arguments->tolerance * STY_LEVEL, out, error);
  sty_destroy_image(&guide);
  sty_destroy_sites(&sites);
  sty_destroy_lut(&lut);
  sty_destroy_lut(&exact);
  return status;
}

static void print_figures(const char *name, const StyFigures *f) {
  printf("%-11s mean %.3f  p50 %.3f  p95 %.3f  p99 %.3f  max %.3f degrees, at texel (%d, %d), source pixel (%d, %d)\n",
         name, f->mean, f->p50, f->p95, f->p99, f->max, f->texel[0], f->texel[1], f->source[0], f->source[1]);
}

static StyStatus print_audit(const Arguments *arguments, const StyAudit *audit_result, StyError *error) {
  if (arguments->options.json) {
    char *text = sty_format_audit(audit_result);
    if (!text) return sty_fail_memory(error, "audit", 0);
    puts(text);
    free(text);
    return STY_OK;
  }
  if (arguments->options.quiet) return STY_OK;
  print_figures("assignment", &audit_result->assignment);
  print_figures("lookup", &audit_result->lookup);
  printf("%-11s %.2f %% of the domain within %g levels\n", "coverage", 100 * audit_result->coverage,
         arguments->tolerance);
  if (audit_result->background)
    printf("%-11s %zu texels point at uncovered source pixels\n", "background", audit_result->background);
  return STY_OK;
}

/* Each exceeded budget gets its line, so that CI says all at once. */
static StyStatus compare_with_budgets(const Arguments *arguments, const StyAudit *result) {
  const struct {
    const char *name;
    double budget, found;
    bool at_least;
  } budgets[] = {
      {"--max-mean", arguments->max_mean, result->lookup.mean, false},
      {"--max-p99", arguments->max_p99, result->lookup.p99, false},
      {"--max-error", arguments->max_error, result->lookup.max, false},
      {"--min-coverage", arguments->min_coverage, result->coverage, true},
  };
  StyStatus status = STY_OK;
  for (size_t i = 0; i < sizeof budgets / sizeof *budgets; i++) {
    if (budgets[i].budget < 0) continue;
    const bool met =
        budgets[i].at_least ? budgets[i].found >= budgets[i].budget : budgets[i].found <= budgets[i].budget;
    if (met) continue;
    fprintf(stderr, "stylut: error: %s: %s: found %.4g, expected %s %.4g\n", arguments->lut, budgets[i].name,
            budgets[i].found, budgets[i].at_least ? "at least" : "at most", budgets[i].budget);
    status = STY_CHECK_FAILED;
  }
  return status;
}

StyStatus run_check(int argc, char **argv) {
  Arguments arguments = {.tolerance = 4, .max_mean = -1, .max_p99 = -1, .max_error = -1, .min_coverage = -1};
  StyAudit result;
  StyError *error = &arguments.options.error;
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (status || arguments.options.helped) return finish_command(&arguments.options, status);
  status = audit(&arguments, &result, error);
  if (!status) status = print_audit(&arguments, &result, error);
  if (!status) status = compare_with_budgets(&arguments, &result);
  return finish_command(&arguments.options, status);
}
