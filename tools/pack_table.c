/* Look-up tables of a bundle's styles, all of one size. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "inputs.h"
#include "pack.h"
#include "stylut/audit.h"
#include "stylut/image_io.h"

/* "unorm8" or "centre", as the manifest's reader made sure; -1 for none. */
static int get_sampling(const char *name) {
  return !name ? -1 : strcmp(name, "unorm8") == 0 ? STY_SAMPLE_UNORM8 : STY_SAMPLE_CENTRE;
}

static StyStatus collect(const StyManifestStyle *style, const StyImage *guide, StySites **out, StyError *error) {
  char name[512]; /* only what is covered by both counts */
  snprintf(name, sizeof name, "%.200s (guide %.200s)", style->exemplars[0], style->guide);
  return sty_collect_sites(name, guide, out, error);
}

/* ---- sizes ---- */

/* Which size a style insists on: that of "size", or of its table's file; 0: none. */
static StyStatus get_fixed_size(const Packing *packing, const StyManifestStyle *style, int *out, StyError *error) {
  *out = style->lut.size;
  if (!style->lut.file) return STY_OK;
  Size size = {0};
  const StyStatus status = measure_picture(packing, style->lut.file, &size, error);
  if (!status) *out = size.width;
  return status;
}

bool has_budget(const StyManifestStyle *style) {
  return style->lut.most_mean > 0 || style->lut.most_p99 > 0 || style->lut.most_error > 0;
}

static StyBudget get_budget(const StyManifestStyle *style) {
  return (StyBudget){style->lut.most_mean, style->lut.most_p99, style->lut.most_error};
}

/* The figure that is over its budget. */
static StyStatus fail_budget(const StyManifestStyle *style, const StyFigures *found, const char *at, int size,
                             StyError *error) {
  const struct {
    const char *name;
    double found, most;
  } figures[] = {{"p99", found->p99, style->lut.most_p99},
                 {"mean", found->mean, style->lut.most_mean},
                 {"max", found->max, style->lut.most_error}};
  int over = 0;
  while (over < 2 && !(figures[over].most > 0 && figures[over].found > figures[over].most)) over++;
  return sty_fail(error, STY_CHECK_FAILED,
                  "style '%s': budget: found %s %.4g degrees %s (table of %d a side), expected at most %.4g",
                  style->name, figures[over].name, figures[over].found, at, size, figures[over].most);
}

StyStatus choose_lut_size(const Packing *packing, int number, const StyImage *guide, int *out, StyError *error) {
  const StyManifestStyle *style = &packing->manifest.styles[number];
  const StyBudget budget = get_budget(style);
  const StyLutSpec spec = {.sampling = (StySampling)get_sampling(style->lut.sampling)};
  const StyAuditOptions options = {.weights = STY_WEIGHT_DISC};
  const StyRun run = {.threads = packing->arguments->options.threads};
  StyCandidate candidates[STY_MOST_CANDIDATES];
  int count = 0, chosen = -1;
  StySites *sites = NULL;
  StyStatus status = collect(style, guide, &sites, error);
  if (!status)
    status = sty_choose_size(sites, guide, &spec, false, STY_ENCODE_RG16, &options, &budget, &run, candidates, &count,
                             &chosen, error);
  if (!status && chosen < 0) {
    int best = 0;
    for (int c = 1; c < count; c++)
      if (sty_compare_budget(&candidates[c].lookup, &budget) < sty_compare_budget(&candidates[best].lookup, &budget))
        best = c;
    status = fail_budget(style, &candidates[best].lookup, "at best", candidates[best].spec.width, error);
  }
  if (!status) *out = candidates[chosen].spec.width;
  sty_destroy_sites(&sites);
  return status;
}

static StyStatus fail_sizes(const StyManifestStyle *a, int size_a, const StyManifestStyle *b, int size_b,
                            StyError *error) {
  return sty_fail(error, STY_ERROR_INPUT,
                  "found LUTs of %d texels a side for style '%s' and %d for '%s', expected one size in a bundle",
                  size_a, a->name, size_b, b->name);
}

/* The size that a style insists on and all others take; 0: none does. */
StyStatus find_fixed_size(const Packing *packing, int *out, const StyManifestStyle **by, StyError *error) {
  const StyManifestStyle *styles = packing->manifest.styles;
  *out = 0;
  for (int i = 0; i < packing->manifest.style_count; i++) {
    int size = 0;
    const StyStatus status = get_fixed_size(packing, &styles[i], &size, error);
    if (status) return status;
    if (size && *out && size != *out) return fail_sizes(*by, *out, &styles[i], size, error);
    if (!size || *out) continue;
    *out = size;
    *by = &styles[i];
  }
  return STY_OK;
}

StyStatus check_lut_size(int fixed, const char *fixed_by, const StyManifestStyle *style, int size, StyError *error) {
  if (!fixed || size <= fixed) return STY_OK;
  return sty_fail(
      error, STY_ERROR_INPUT,
      "found a LUT of %d texels a side for style '%s', expected the %d that the budget of style '%s' takes: "
      "one size serves a bundle",
      fixed, fixed_by, size, style->name);
}

/* What a style's budget takes, if it has one. */
static StyStatus find_needed_size(const Packing *packing, int number, int *out, StyError *error) {
  *out = DEFAULT_LUT_SIZE; /* what styles get that ask for nothing */
  if (!has_budget(&packing->manifest.styles[number])) return STY_OK;
  Guide guide;
  Source source = {0};
  StyStatus status = open_guide(packing, number, &guide, error);
  if (!status) status = open_source(packing, number, &guide, &source, error);
  if (!status) status = choose_lut_size(packing, number, source.guide, out, error);
  close_source(&source);
  close_guide(&guide);
  return status;
}

StyStatus settle_lut_size(Packing *packing, StyError *error) {
  const StyManifestStyle *styles = packing->manifest.styles, *fixed_by = NULL;
  int fixed = 0, needed = 0;
  StyStatus status = find_fixed_size(packing, &fixed, &fixed_by, error);
  for (int i = 0; !status && i < packing->manifest.style_count; i++) {
    int size = 0;
    status = find_needed_size(packing, i, &size, error);
    if (!status && has_budget(&styles[i]))
      status = check_lut_size(fixed, fixed ? fixed_by->name : NULL, &styles[i], size, error);
    if (size > needed) needed = size;
  }
  packing->lut_size = fixed ? fixed : needed;
  return status;
}

/* ---- tables ---- */

static StyStatus read_table(const Packing *packing, int number, StyLut **out, StyError *error) {
  const StyManifestStyle *style = &packing->manifest.styles[number];
  const Size size = packing->sizes[number];
  const StyLutHints hints = {size.width, size.height, get_sampling(style->lut.sampling), STY_FOREIGN_NONE};
  const bool has_file = !is_sphere(style);
  char *path = find_file(packing, style->lut.file, error);
  char *guide = has_file ? find_file(packing, style->guide, error) : NULL;
  bool of_another;
  StyStatus status = path && (guide || !has_file)
                         ? read_lut(&packing->arguments->options, path, guide, &hints, out, &of_another, error)
                         : STY_ERROR_LIBRARY;
  free(path);
  free(guide);
  if (!status && ((*out)->spec.map != STY_MAP_XY || (*out)->spec.sampling == STY_SAMPLE_CORNER)) {
    status =
        sty_fail(error, STY_ERROR_INPUT, "%s: found a LUT of map %s and sampling %s, expected xy and centre or unorm8",
                 style->lut.file, sty_map_names[(*out)->spec.map], sty_sampling_names[(*out)->spec.sampling]);
    sty_destroy_lut(out);
  }
  return status;
}

/* Reads the frames that a table is to serve into `frames`, which has room for MOST_FRAMES. */
static StyStatus open_frames(const Packing *packing, const StyManifestStyle *style, StyImage *frames[MOST_FRAMES],
                             StyError *error) {
  StyStatus status = STY_OK;
  for (size_t i = 0; !status && i < sty_count_manifest_names(style->lut.frames); i++) {
    char *path = find_file(packing, sty_get_manifest_name(style->lut.frames, i), error);
    status = path ? read_guide(&packing->arguments->options, path, &frames[i], error) : STY_ERROR_LIBRARY;
    free(path);
  }
  return status;
}

static StyStatus resolve(const Packing *packing, const StyManifestStyle *style, const StyImage *guide,
                         const StySites *sites, StyLut *lut, StyError *error) {
  if (strcmp(style->lut.resolve, "nearest") == 0) return STY_OK;
  StyImage *frames[MOST_FRAMES] = {NULL};
  const StyResolveOptions options = {.slack = style->lut.slack * STY_LEVEL,
                                     .coherent = strcmp(style->lut.resolve, "frames") != 0,
                                     .guide = guide,
                                     .frames = style->lut.frames ? (const StyImage *const *)frames : NULL,
                                     .frame_count = (int)sty_count_manifest_names(style->lut.frames)};
  const StyRun run = {.threads = packing->arguments->options.threads};
  StyStatus status = open_frames(packing, style, frames, error);
  if (!status) status = sty_resolve_lut(lut, sites, &options, &run, error);
  destroy_frames(frames);
  return status;
}

static StyStatus build_table(const Packing *packing, const StyManifestStyle *style, const StyImage *guide, StyLut **out,
                             StyError *error) {
  const StyEngine *engine = NULL;
  StySites *sites = NULL;
  StyStatus status = sty_find_engine("engine", style->lut.engine, &engine, error);
  if (!status) status = collect(style, guide, &sites, error);
  const StyRun run = {.threads = packing->arguments->options.threads};
  const StyLutSpec spec = {.width = packing->lut_size,
                           .height = packing->lut_size,
                           .sampling = (StySampling)get_sampling(style->lut.sampling)};
  if (!status) status = sty_build_lut(sites, engine, NULL, &spec, &run, out, error);
  if (!status) status = resolve(packing, style, guide, sites, *out, error);
  if (status) sty_destroy_lut(out);
  sty_destroy_sites(&sites);
  return status;
}

/* Where a pixel along a side of the table's source lies in the bundle: built tables have its size already. */
static uint32_t fit_place(const Packing *packing, uint32_t pixel, uint32_t from, uint32_t to) {
  return packing->arguments->fit == FIT_RESIZE ? (uint32_t)((2ULL * pixel + 1) * to / (2ULL * from)) : pixel;
}

static void encode_lut(const Packing *packing, const StyLut *lut, const StyImage *guide, Table *out) {
  const float *covered = sty_find_channel(guide, "A");
  const uint32_t from[2] = {(uint32_t)lut->source_width, (uint32_t)lut->source_height};
  const uint32_t to[2] = {(uint32_t)packing->size.width, (uint32_t)packing->size.height};
  for (size_t t = 0; t < sty_count_texels(&lut->spec); t++) {
    uint32_t place[2] = {lut->pixels[t] % from[0], lut->pixels[t] / from[0]};
    for (int k = 0; k < 2; k++) {
      place[k] = fit_place(packing, place[k], from[k], to[k]);
      out->texels[2 * t + (size_t)k] = (uint16_t)sty_encode_coordinate(place[k], to[k], 65535);
    }
    out->holes += !(covered[(size_t)place[1] * to[0] + place[0]] > 0);
  }
}

/* Tables of pictures of another size can't be held against the guide, nor the smallest ones of bytes. */
static StyStatus judge_table(const StyManifestStyle *style, const StyLut *lut, const StyImage *guide, Table *out,
                             StyError *error) {
  const StyAuditOptions options = {.weights = STY_WEIGHT_DISC};
  const StyBudget budget = get_budget(style);
  out->is_judged = lut->source_width == guide->width && lut->source_height == guide->height && lut->spec.width > 2;
  if (!out->is_judged) return STY_OK;
  const StyStatus status = sty_audit_lookup(lut, guide, &options, &out->lookup, error);
  if (status || sty_compare_budget(&out->lookup, &budget) <= 1) return status;
  return fail_budget(style, &out->lookup, "in the table that was made", lut->spec.width, error);
}

StyStatus make_table(const Packing *packing, int number, const StyImage *guide, Table *out, StyError *error) {
  const StyManifestStyle *style = &packing->manifest.styles[number];
  Table table = {0};
  StyLut *lut = NULL;
  StyStatus status =
      style->lut.file ? read_table(packing, number, &lut, error) : build_table(packing, style, guide, &lut, error);
  if (status) return status;
  const size_t size = sty_count_texels(&lut->spec) * 2 * sizeof *table.texels;
  table.texels = malloc(size);
  table.unorm8 = lut->spec.sampling == STY_SAMPLE_UNORM8;
  if (!table.texels) status = sty_fail_memory(error, style->name, (double)size);
  if (!status) status = judge_table(style, lut, guide, &table, error);
  if (!status) encode_lut(packing, lut, guide, &table);
  sty_destroy_lut(&lut);
  if (status)
    free(table.texels);
  else
    *out = table;
  return status;
}
