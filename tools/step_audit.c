/* The step that audits a table as it is shipped. */
#include <stdlib.h>
#include <string.h>

#include "audits.h"
#include "step.h"
#include "stylut/ktx2.h"

/* The table's sampling, and the precision that its guide was read with. */
static StyStatus read_facts(const Step *step, StySampling *sampling, int *bits, StyError *error) {
  StyDocument guide = {NULL, NULL, NULL};
  const char *table_file = get_step_file(step, "facts", 0, error);
  const char *guide_file = table_file ? get_step_file(step, "guide_facts", 0, error) : NULL;
  StyStatus status = guide_file ? read_sampling(table_file, sampling, error) : STY_ERROR_INPUT;
  if (!status) status = sty_read_document(guide_file, &guide, error);
  if (!status) status = sty_get_integer(&guide, NULL, guide.root, "bits", 8, 32, bits, error);
  sty_close_document(&guide);
  return status;
}

/* The table as whoever reads the bundle finds it. */
static StyStatus open_shipped(const Step *step, const StyImage *guide, StySampling sampling, StyLut **out,
                              StyError *error) {
  StyMapping mapping;
  StyTexture texture;
  const char *file = get_step_file(step, "luts", 0, error);
  StyStatus status = file ? map_texture(file, STY_VK_R16G16_UNORM, &mapping, &texture, error) : STY_ERROR_INPUT;
  if (status) return status;
  status = decode_table(&texture, 0, sampling, guide->width, guide->height, out, error);
  sty_unmap_file(&mapping);
  return status;
}

/* All that is over its budget, in one message. */
static StyStatus hold_to_limits(const Step *step, const StyAudit *audit, StyError *error) {
  const StyManifestStyle *style = step->packing.manifest.styles;
  char text[1024] = "";
  for (int l = 0; l < STY_LIMITS; l++) {
    const json_t *budget = json_object_get(style->check, sty_limits[l].name);
    const double value = json_number_value(budget);
    if (!budget || sty_is_within(audit, l, value)) continue;
    snprintf(text + strlen(text), sizeof text - strlen(text), "%s%s: found %.4g, expected %s %.4g", *text ? "; " : "",
             sty_limits[l].name, sty_get_limited(audit, l), sty_limits[l].at_least ? "at least" : "at most", value);
  }
  return *text ? sty_fail(error, STY_CHECK_FAILED, "style '%s': %s", style->name, text) : STY_OK;
}

static StyStatus audit_table(const Step *step, const StyLut *lut, const StyImage *guide, StyAudit *out,
                             StyError *error) {
  const StyManifestStyle *style = step->packing.manifest.styles;
  const StyAuditOptions options = {.tolerance = default_audit_arguments.tolerance * STY_LEVEL,
                                   .weights = STY_WEIGHT_DISC};
  const StyRun run = {.threads = step->arguments.options.threads};
  const StyEngine *engine = NULL;
  StySites *sites = NULL;
  StyLut *exact = NULL;
  StyStatus status = sty_find_engine("engine", "auto", &engine, error);
  if (!status) status = sty_collect_sites(style->exemplars[0], guide, &sites, error);
  if (!status) status = sty_build_lut(sites, engine, NULL, &lut->spec, &run, &exact, error);
  if (!status) status = sty_audit_lut(lut, exact, guide, &options, &run, out, NULL, error);
  if (status) sty_fail(error, status, "style '%s': %s", style->name, error->text);
  sty_destroy_lut(&exact);
  sty_destroy_sites(&sites);
  return status;
}

/* The figures are written whether they keep to their budgets or not. */
StyStatus step_audit(Step *step, StyError *error) {
  StySampling sampling;
  int bits = 32;
  StyImage *guide = NULL;
  StyLut *lut = NULL;
  Overlap overlap;
  StyAudit audit;
  StyStatus status = read_facts(step, &sampling, &bits, error);
  if (!status) status = open_masked_guide(step, 0, &guide, &overlap, error);
  if (!status) status = open_shipped(step, guide, sampling, &lut, error);
  if (!status) {
    guide->bits = bits;
    status = audit_table(step, lut, guide, &audit, error);
  }
  char *text = status ? NULL : sty_format_audit(&audit);
  json_t *value = text ? json_loads(text, 0, NULL) : NULL;
  if (!status && !value) status = sty_fail_memory(error, "audit", 0);
  if (!status) status = put_value(step->output, value, error);
  free(text);
  sty_destroy_lut(&lut);
  sty_destroy_image(&guide);
  return status ? status : hold_to_limits(step, &audit, error);
}
