/* stylut check LUT --guide GUIDE: the audit, and budgets for CI. */
#include <stdio.h>
#include <stdlib.h>

#include "audits.h"
#include "commands.h"
#include "options.h"
#include "stylut/parse.h"

typedef struct Arguments {
  AuditCommand base;
  double budgets[STY_LIMITS]; /* negative: none */
} Arguments;

enum { KEY_BUDGET = 0x200 }; /* and the next STY_LIMITS - 1, in the order of sty_limits */

static const struct argp_option options_table[] = {
    {NULL, 0, NULL, 0, "Budgets, on the lookup error in degrees:", 20},
    {"max-mean", KEY_BUDGET, "DEG", 0, "mean", 0},
    {"max-p99", KEY_BUDGET + 1, "DEG", 0, "99th percentile", 0},
    {"max-error", KEY_BUDGET + 2, "DEG", 0, "maximum", 0},
    {NULL, 0, NULL, 0, "Budgets on what else was found:", 21},
    {"max-excess", KEY_BUDGET + 3, "DEG", 0, "mean error above that of the exact table", 0},
    {"max-ambiguous", KEY_BUDGET + 4, "SHARE", 0, "texels whose pixel is one of several far apart", 0},
    {"max-jumps", KEY_BUDGET + 5, "SHARE", 0, "neighbouring texels on pixels far apart", 0},
    {"max-unstable", KEY_BUDGET + 6, "SHARE", 0, "texels that a disturbed guide sends elsewhere", 0},
    {"max-unused", KEY_BUDGET + 7, "SHARE", 0, "covered source pixels that no texel uses", 0},
    {"min-coverage", KEY_BUDGET + 8, "SHARE", 0, "covered share of the domain, 0 to 1", 0},
    {0},
};

static StyStatus set_budget(Arguments *arguments, int budget, const char *text) {
  char what[32];
  snprintf(what, sizeof what, "--%s", sty_limits[budget].name);
  return sty_parse_number(what, text, 0, sty_limits[budget].largest, &arguments->budgets[budget],
                          &arguments->base.options.error);
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  begin_option(key, text, state);
  if (key >= KEY_BUDGET && key < KEY_BUDGET + STY_LIMITS)
    return end_option(set_budget(arguments, key - KEY_BUDGET, text));
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
  StyStatus status = STY_OK;
  for (int b = 0; b < STY_LIMITS; b++) {
    const double budget = arguments->budgets[b];
    if (budget < 0 || sty_is_within(audit, b, budget)) continue;
    fprintf(stderr, "stylut: error: %s: --%s: found %.4g, expected %s %.4g\n", clean_text(arguments->base.audit.lut),
            sty_limits[b].name, sty_get_limited(audit, b), sty_limits[b].at_least ? "at least" : "at most", budget);
    status = STY_CHECK_FAILED;
  }
  return status;
}

StyStatus run_check(int argc, char **argv) {
  Arguments arguments = {.base.audit = default_audit_arguments};
  Options *options = &arguments.base.options;
  for (int b = 0; b < STY_LIMITS; b++) arguments.budgets[b] = -1;
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
