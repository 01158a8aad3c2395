/* What a bundle's index says of the bundle and of how it came about. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pack.h"
#include "stylut/parse.h"

static StyStatus hash_input(const Packing *packing, const char *path, char out[STY_HASH_SIZE], StyError *error) {
  return packing->records ? packing->records->hash(packing->records, path, out, error)
                          : sty_hash_file(path, out, error);
}

StyStatus record_input(const Packing *packing, const char *name, StyError *error) {
  char hash[STY_HASH_SIZE];
  if (!packing->inputs || !name || json_object_get(packing->inputs, name)) return STY_OK;
  char *path = find_file(packing, name, error);
  const StyStatus status = path ? hash_input(packing, path, hash, error) : STY_ERROR_LIBRARY;
  if (!status) json_object_set_new(packing->inputs, name, json_string(hash));
  free(path);
  return status;
}

static StyStatus record_inputs(const Packing *packing, const json_t *names, StyError *error) {
  StyStatus status = STY_OK;
  for (size_t i = 0; !status && i < sty_count_manifest_names(names); i++)
    status = record_input(packing, sty_get_manifest_name(names, i), error);
  return status;
}

StyStatus begin_history(Packing *packing, json_t *index, StyError *error) {
  char hash[STY_HASH_SIZE];
  const StyManifest *manifest = &packing->manifest;
  StyStatus status = hash_input(packing, packing->arguments->manifest, hash, error);
  if (status) return status;
  packing->inputs = json_object();
  json_object_set_new(
      index, "history",
      json_pack("{s:o, s:s, s:o}", "command", get_command_line(&packing->arguments->options, packing->command),
                "manifest", hash, "inputs", packing->inputs));
  status = record_inputs(packing, manifest->jitter, error);
  for (int i = 0; !status && i < manifest->style_count; i++) {
    const StyManifestStyle *style = &manifest->styles[i];
    for (int k = 0; !status && k < style->parameters.layer_count; k++)
      status = record_input(packing, style->exemplars[k], error);
    if (!status && !is_sphere(style)) status = record_input(packing, style->guide, error);
    if (!status) status = record_input(packing, style->lut.file, error);
    if (!status) status = record_inputs(packing, style->lut.frames, error);
  }
  return status;
}

json_t *describe_jitter(const Packing *packing) {
  if (packing->manifest.jitter) return json_pack("{s:O}", "files", packing->manifest.jitter);
  return json_pack("{s:i, s:s, s:I}", "tables", packing->arguments->jitter_frames, "noise",
                   sty_noise_names[packing->arguments->jitter_noise], "seed",
                   (json_int_t)packing->arguments->options.seed);
}

/* Degrees, as people read them. */
static json_t *describe_degrees(double degrees) {
  char text[32];
  snprintf(text, sizeof text, "%.4g", degrees);
  return json_real(strtod(text, NULL));
}

json_t *describe_lookup(const Table *table) {
  return json_pack("{s:o, s:o, s:o}", "mean", describe_degrees(table->lookup.mean), "p99",
                   describe_degrees(table->lookup.p99), "max", describe_degrees(table->lookup.max));
}

static json_t *describe_budget(const StyManifestStyle *style) {
  json_t *out = json_object();
  if (style->lut.most_mean > 0) json_object_set_new(out, "mean", json_real(style->lut.most_mean));
  if (style->lut.most_p99 > 0) json_object_set_new(out, "p99", json_real(style->lut.most_p99));
  if (style->lut.most_error > 0) json_object_set_new(out, "max", json_real(style->lut.most_error));
  return out;
}

json_t *describe_lut(const Packing *packing, int number, const Table *table) {
  const StyManifestStyle *style = &packing->manifest.styles[number];
  json_t *lut = json_pack("{s:i, s:s, s:s}", "size", packing->lut_size, "sampling", table->unorm8 ? "unorm8" : "centre",
                          style->lut.file ? "file" : "engine", style->lut.file ? style->lut.file : style->lut.engine);
  if (!style->lut.file) json_object_set_new(lut, "resolve", json_string(style->lut.resolve));
  if (has_budget(style)) json_object_set_new(lut, "budget", describe_budget(style));
  if (table->is_judged) json_object_set_new(lut, "error", describe_lookup(table));
  return lut;
}

json_t *describe_style(const Packing *packing, int number, const StyStyle *parameters, int layer, const Table *table) {
  const StyManifestStyle *style = &packing->manifest.styles[number];
  json_t *exemplars = json_array();
  for (int i = 0; i < parameters->layer_count; i++)
    json_array_append_new(exemplars, json_pack("{s:s, s:f}", "file", style->exemplars[i], "luma",
                                               sty_shorten_float(parameters->luma[i])));
  json_t *out = json_pack("{s:i, s:s, s:o, s:[ii], s:s, s:o, s:o, s:[ii]}", "id", number + 1, "name", style->name,
                          "exemplars", exemplars, "size", packing->sizes[number].width, packing->sizes[number].height,
                          "guide", style->guide, "lut", describe_lut(packing, number, table), "params",
                          sty_describe_parameters(parameters), "layers", layer, parameters->layer_count);
  if (style->base > 0) json_object_set_new(out, "base", json_real(style->base));
  return out;
}
