/* stylut check LUT --guide GUIDE: the audit, and budgets for CI. */
#include <stdio.h>
#include <stdlib.h>

#include "audits.h"
#include "commands.h"
#include "options.h"
#include "stylut/parse.h"

/* What can be budgeted. */
enum {
  BUDGET_MEAN,
  BUDGET_P99,
  BUDGET_ERROR,
  BUDGET_EXCESS,
  BUDGET_AMBIGUOUS,
  BUDGET_JUMPS,
  BUDGET_UNSTABLE,
  BUDGET_UNUSED,
  BUDGET_COVERAGE,
  BUDGETS
};

typedef struct Arguments {
  AuditCommand base;
  double budgets[BUDGETS]; /* negative: none */
} Arguments;

enum { KEY_BUDGET = 0x200 }; /* and the next BUDGETS - 1 */

static const struct argp_option options_table[] = {
    {NULL, 0, NULL, 0, "Budgets, on the lookup error in degrees:", 20},
    {"max-mean", KEY_BUDGET + BUDGET_MEAN, "DEG", 0, "mean", 0},
    {"max-p99", KEY_BUDGET + BUDGET_P99, "DEG", 0, "99th percentile", 0},
    {"max-error", KEY_BUDGET + BUDGET_ERROR, "DEG", 0, "maximum", 0},
    {NULL, 0, NULL, 0, "Budgets on what else was found:", 21},
    {"max-excess", KEY_BUDGET + BUDGET_EXCESS, "DEG", 0, "mean error above that of the exact table", 0},
    {"max-ambiguous", KEY_BUDGET + BUDGET_AMBIGUOUS, "SHARE", 0, "texels whose pixel is one of several far apart", 0},
    {"max-jumps", KEY_BUDGET + BUDGET_JUMPS, "SHARE", 0, "neighbouring texels on pixels far apart", 0},
    {"max-unstable", KEY_BUDGET + BUDGET_UNSTABLE, "SHARE", 0, "texels that a disturbed guide sends elsewhere", 0},
    {"max-unused", KEY_BUDGET + BUDGET_UNUSED, "SHARE", 0, "covered source pixels that no texel uses", 0},
    {"min-coverage", KEY_BUDGET + BUDGET_COVERAGE, "SHARE", 0, "covered share of the domain, 0 to 1", 0},
    {0},
};

static const char *get_budget_name(int budget) {
  for (const struct argp_option *o = options_table; o->name || o->doc; o++)
    if (o->name && o->key == KEY_BUDGET + budget) return o->name;
  return "";
}

static StyStatus set_budget(Arguments *arguments, int budget, const char *text) {
  char what[32];
  snprintf(what, sizeof what, "--%s", get_budget_name(budget));
  const double largest = budget <= BUDGET_EXCESS ? 180 : 1;
  return sty_parse_number(what, text, 0, largest, &arguments->budgets[budget], &arguments->base.options.error);
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  begin_option(key, text, state);
  if (key >= KEY_BUDGET && key < KEY_BUDGET + BUDGETS) return end_option(set_budget(arguments, key - KEY_BUDGET, text));
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: return end_option(take_audit_argument(&arguments->base, text));
    case ARGP_KEY_END: return end_option(check_audit_arguments(&arguments->base));
    default: return ARGP_ERR_UNKNOWN;
  }
}

static const struct argp_child children[] = {
    {&audit_argp, 0, NULL, 0}, {&seed_argp, 0, NULL, 0}, {&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .options = options_table,
    .parser = parse_option,
    .args_doc = "LUT --guide GUIDE",
    .doc =
        "Audits a table against its guide and holds it to budgets: exit code 6 when one is exceeded.\v"
        "Errors are angles between the normal asked for and the normal of the source pixel given, in degrees: at the "
        "values texels answer for (assignment), and for values in between (lookup). Excess is what is above the error "
        "of the exact table. Near the silhouette a small step turns the normal far, so p99 and max are ruled by the "
        "rim.",
    .children = children,
};

static void print_figures(const char *name, const StyFigures *f) {
  printf("%-11s mean %.3f  p50 %.3f  p95 %.3f  p99 %.3f  max %.3f degrees, at texel (%d, %d), source pixel (%d, %d)\n",
         name, f->mean, f->p50, f->p95, f->p99, f->max, f->texel[0], f->texel[1], f->source[0], f->source[1]);
}

static StyStatus print_audit(const Arguments *arguments, const StyAudit *audit, StyError *error) {
  if (arguments->base.options.json) {
    char *text = sty_format_audit(audit);
    if (!text) return sty_fail_memory(error, "audit", 0);
    puts(text);
    free(text);
    return STY_OK;
  }
  if (arguments->base.options.quiet) return STY_OK;
  print_figures("assignment", &audit->assignment);
  print_figures("lookup", &audit->lookup);
  print_figures("excess", &audit->excess);
  printf("%-11s %.2f %% of the texels hold the nearest pixel\n", "optimal", 100 * audit->optimal);
  if (audit->slack > 0)
    printf("%-11s %.4g levels of choice beyond the nearest; %zu texels take more\n", "slack", audit->slack / STY_LEVEL,
           audit->beyond_slack);
  printf("%-11s %.2f %% of the domain within %g levels\n", "coverage", 100 * audit->coverage,
         audit->tolerance / STY_LEVEL);
  printf("%-11s source pixels by number of texels:", "usage");
  for (int b = 0; b < STY_USAGE_BINS; b++) printf("  %s: %zu", sty_usage_names[b], audit->usage[b]);
  printf("  (%.2f %% unused)\n", 100 * audit->unused);
  printf("%-11s %.2f %% of the texels, mean spread %.1f pixels\n", "ambiguous", 100 * audit->ambiguous, audit->spread);
  printf("%-11s %.2f %% of neighbouring texels lie more than %g source pixels apart\n", "jumps", 100 * audit->jumps,
         audit->jump);
  printf("%-11s %.2f %% of the texels move when the guide is disturbed by its own precision\n", "unstable",
         100 * audit->unstable);
  if (audit->background) printf("%-11s %zu texels point at uncovered source pixels\n", "background", audit->background);
  return STY_OK;
}

/* Each exceeded budget gets its line, so that CI says all at once. */
static StyStatus compare_with_budgets(const Arguments *arguments, const StyAudit *audit) {
  const double found[BUDGETS] = {
      [BUDGET_MEAN] = audit->lookup.mean,   [BUDGET_P99] = audit->lookup.p99,      [BUDGET_ERROR] = audit->lookup.max,
      [BUDGET_EXCESS] = audit->excess.mean, [BUDGET_AMBIGUOUS] = audit->ambiguous, [BUDGET_JUMPS] = audit->jumps,
      [BUDGET_UNSTABLE] = audit->unstable,  [BUDGET_UNUSED] = audit->unused,       [BUDGET_COVERAGE] = audit->coverage,
  };
  StyStatus status = STY_OK;
  for (int b = 0; b < BUDGETS; b++) {
    const bool at_least = b == BUDGET_COVERAGE;
    const double budget = arguments->budgets[b];
    if (budget < 0 || (at_least ? found[b] >= budget : found[b] <= budget)) continue;
    fprintf(stderr, "stylut: error: %s: --%s: found %.4g, expected %s %.4g\n", clean_text(arguments->base.audit.lut),
            get_budget_name(b), found[b], at_least ? "at least" : "at most", budget);
    status = STY_CHECK_FAILED;
  }
  return status;
}

StyStatus run_check(int argc, char **argv) {
  Arguments arguments = {.base.audit = default_audit_arguments};
  Options *options = &arguments.base.options;
  for (int b = 0; b < BUDGETS; b++) arguments.budgets[b] = -1;
  AuditCase subject = {0};
  StyAudit audit;
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (status || options->helped) return finish_command(options, status);
  status = open_audit(&arguments.base, &subject, &options->error);
  if (!status) status = run_audit(&arguments.base, &subject, &audit, NULL, &options->error);
  close_audit(&subject);
  if (!status) status = print_audit(&arguments, &audit, &options->error);
  if (!status) status = compare_with_budgets(&arguments, &audit);
  return finish_command(options, status);
}
