#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "stylut/pack.h"

static const char *const manifest_schema = "stylut-bundle/1";
static const double largest_depth_tolerance = 1e30;

static StyStatus read_parameters(const StyDocument *document, const StyPath *style_path, const json_t *params,
                                 StyStyle *out, StyError *error) {
  static const char *const known[] = {"threshold", "top_level", "radius", "depth_tolerance", NULL};
  if (!params) return STY_OK;
  const StyPath path = {style_path, "params", 0};
  double tolerance = 0;
  StyStatus status = sty_check_keys(document, &path, params, known, error);
  if (!status)
    status = sty_get_integer(document, &path, params, "threshold", 0, STY_MAX_THRESHOLD, &out->threshold, error);
  if (!status) status = sty_get_integer(document, &path, params, "top_level", 0, STY_MAX_LEVEL, &out->top_level, error);
  if (!status) status = sty_get_integer(document, &path, params, "radius", 0, STY_MAX_RADIUS, &out->radius, error);
  if (!status)
    status = sty_get_number(document, &path, params, "depth_tolerance", 0, largest_depth_tolerance, &tolerance, error);
  out->depth_tolerance = (float)tolerance;
  return status;
}

/* "lut" is a file name, or an object that says how to build a table or which
 * file holds it. */
static StyStatus read_lut(const StyDocument *document, const StyPath *style_path, const json_t *style,
                          StyManifestStyle *out, StyError *error) {
  static const char *const known[] = {"file", "size", "engine", "resolve", "sampling", NULL};
  static const char *const file_only[] = {"file", "sampling", NULL};
  const StyPath path = {style_path, "lut", 0};
  const json_t *lut = json_object_get(style, "lut");
  if (!lut) return STY_OK;
  if (json_is_string(lut)) {
    out->lut_sampling = NULL;
    return sty_get_string(document, style_path, style, "lut", 0, &out->lut_file, error);
  }
  if (!json_is_object(lut)) return sty_fail_value(document, &path, lut, "a file name or an object", error);
  const bool is_file = json_object_get(lut, "file");
  const char *resolve = "nearest";
  if (is_file) out->lut_sampling = NULL;
  StyStatus status = sty_check_keys(document, &path, lut, is_file ? file_only : known, error);
  if (!status) status = sty_get_string(document, &path, lut, "file", 0, &out->lut_file, error);
  if (!status) status = sty_get_integer(document, &path, lut, "size", 2, STY_MAX_LUT_SIDE, &out->lut_size, error);
  if (!status) status = sty_get_string(document, &path, lut, "engine", 0, &out->lut_engine, error);
  if (!status) status = sty_get_string(document, &path, lut, "sampling", 0, &out->lut_sampling, error);
  if (!status) status = sty_get_string(document, &path, lut, "resolve", 0, &resolve, error);
  const char *sampling = out->lut_sampling;
  if (!status && sampling && strcmp(sampling, "unorm8") != 0 && strcmp(sampling, "centre") != 0)
    status = sty_fail_value(document, &(StyPath){&path, "sampling", 0}, json_object_get(lut, "sampling"),
                            "\"unorm8\" or \"centre\"", error);
  if (!status && strcmp(resolve, "nearest") != 0)
    status = sty_fail_value(document, &(StyPath){&path, "resolve", 0}, json_object_get(lut, "resolve"), "\"nearest\"",
                            error);
  return status;
}

static StyStatus read_style(const StyDocument *document, const StyPath *path, const json_t *style,
                            StyManifestStyle *out, StyError *error) {
  static const char *const known[] = {"name", "exemplar", "guide", "lut", "params", NULL};
  *out = (StyManifestStyle){
      .guide = "sphere",
      .lut_engine = "auto",
      .lut_size = 256,
      .lut_sampling = "unorm8",
      .parameters = {.threshold = 24, .top_level = 6, .radius = 1, .layer_count = 1, .jitter_amount = 1, .scale = 1},
  };
  StyStatus status = sty_check_keys(document, path, style, known, error);
  if (!status) status = sty_get_string(document, path, style, "name", 1, &out->name, error);
  if (!status) status = sty_get_string(document, path, style, "exemplar", 1, &out->exemplar, error);
  if (!status) status = sty_get_string(document, path, style, "guide", 0, &out->guide, error);
  if (!status) status = read_lut(document, path, style, out, error);
  if (!status) status = read_parameters(document, path, json_object_get(style, "params"), &out->parameters, error);
  return status;
}

static StyStatus read_styles(StyManifest *manifest, StyError *error) {
  const StyDocument *document = &manifest->document;
  const StyPath styles_path = {NULL, "styles", 0};
  const json_t *styles = json_object_get(document->root, "styles");
  const size_t count = json_array_size(styles);
  if (!json_is_array(styles) || count < 1 || count > STY_MAX_STYLES)
    return sty_fail_value(document, styles ? &styles_path : NULL, styles, "a list \"styles\" of 1 to 256 objects",
                          error);
  manifest->styles = calloc(count, sizeof *manifest->styles);
  if (!manifest->styles) return sty_fail_memory(error, document->name, (double)(count * sizeof *manifest->styles));
  manifest->style_count = (int)count;
  for (size_t i = 0; i < count; i++) {
    const StyPath path = {&styles_path, NULL, i};
    const json_t *style = json_array_get(styles, i);
    const StyStatus status = read_style(document, &path, style, &manifest->styles[i], error);
    if (status) return status;
    for (size_t k = 0; k < i; k++)
      if (strcmp(manifest->styles[k].name, manifest->styles[i].name) == 0)
        return sty_fail_value(document, &(StyPath){&path, "name", 0}, json_object_get(style, "name"),
                              "a name no other style has", error);
  }
  return STY_OK;
}

StyStatus sty_read_manifest(const char *path, StyManifest *out, StyError *error) {
  static const char *const known[] = {"schema", "styles", "jitter", NULL};
  StyManifest manifest = {.folder = sty_get_folder(path)};
  if (!manifest.folder) return sty_fail_memory(error, path, (double)strlen(path));
  StyStatus status = sty_read_document(path, &manifest.document, error);
  const StyDocument *document = &manifest.document;
  const char *schema = NULL;
  if (!status) status = sty_check_keys(document, NULL, document->root, known, error);
  if (!status) status = sty_get_string(document, NULL, document->root, "schema", 1, &schema, error);
  if (!status && strcmp(schema, manifest_schema) != 0)
    status = sty_fail_value(document, &(StyPath){NULL, "schema", 0}, json_object_get(document->root, "schema"),
                            "\"stylut-bundle/1\"", error);
  if (!status) status = sty_get_string(document, NULL, document->root, "jitter", 0, &manifest.jitter, error);
  if (!status) status = read_styles(&manifest, error);
  if (status)
    sty_close_manifest(&manifest);
  else
    *out = manifest;
  return status;
}

void sty_close_manifest(StyManifest *manifest) {
  sty_close_document(&manifest->document);
  free(manifest->folder);
  free(manifest->styles);
  *manifest = (StyManifest){.style_count = 0};
}
