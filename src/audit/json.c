#include <jansson.h>
#include <math.h>

#include "stylut/audit.h"

/* Six decimals: more would only print noise. */
static double tidy(double value) { return round(value * 1e6) / 1e6; }

static json_t *format_figures(const StyFigures *f) {
  return json_pack("{s:f, s:f, s:f, s:f, s:f, s:{s:[ii], s:[ff], s:[ii]}}", "mean", tidy(f->mean), "p50", tidy(f->p50),
                   "p95", tidy(f->p95), "p99", tidy(f->p99), "max", tidy(f->max), "at", "texel", f->texel[0],
                   f->texel[1], "value", tidy(f->value[0]), tidy(f->value[1]), "source", f->source[0], f->source[1]);
}

char *sty_format_audit(const StyAudit *audit) {
  json_t *root =
      json_pack("{s:s, s:i, s:s, s:I, s:I, s:o, s:o, s:f, s:f}", "schema", "stylut-audit/1", "size", audit->size,
                "sampling", sty_sampling_names[audit->sampling], "feasible", (json_int_t)audit->feasible, "background",
                (json_int_t)audit->background, "assignment", format_figures(&audit->assignment), "lookup",
                format_figures(&audit->lookup), "coverage", tidy(audit->coverage), "tolerance", tidy(audit->tolerance));
  char *text = root ? json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(12)) : NULL;
  json_decref(root);
  return text;
}
