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

static json_t *format_usage(const StyAudit *audit) {
  json_t *usage = json_object();
  for (int b = 0; b < STY_USAGE_BINS; b++)
    json_object_set_new(usage, sty_usage_names[b], json_integer((json_int_t)audit->usage[b]));
  return usage;
}

char *sty_format_audit(const StyAudit *audit) {
  const StyLutSpec *spec = &audit->spec;
  json_t *root = json_pack("{s:s, s:i, s:s, s:s, s:s, s:s, s:I, s:I, s:f, s:I}", "schema", "stylut-audit/1", "size",
                           spec->width, "sampling", sty_sampling_names[spec->sampling], "map", sty_map_names[spec->map],
                           "metric", sty_metric_names[spec->metric], "weights", sty_weights_names[audit->weights],
                           "feasible", (json_int_t)audit->feasible, "background", (json_int_t)audit->background,
                           "slack", audit->slack, "beyond_slack", (json_int_t)audit->beyond_slack);
  json_t *figures =
      json_pack("{s:o, s:o, s:o, s:f, s:f, s:f, s:o, s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "assignment",
                format_figures(&audit->assignment), "lookup", format_figures(&audit->lookup), "excess",
                format_figures(&audit->excess), "optimal", tidy(audit->optimal), "coverage", tidy(audit->coverage),
                "tolerance", tidy(audit->tolerance), "usage", format_usage(audit), "unused", tidy(audit->unused),
                "ambiguous", tidy(audit->ambiguous), "spread", tidy(audit->spread), "jumps", tidy(audit->jumps),
                "unstable", tidy(audit->unstable), "jump", tidy(audit->jump), "precision", audit->precision);
  if (root && spec->height != spec->width) json_object_set_new(root, "height", json_integer(spec->height));
  char *text = NULL;
  if (root && figures && json_object_update(root, figures) == 0)
    text = json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(12));
  json_decref(root);
  json_decref(figures);
  return text;
}
