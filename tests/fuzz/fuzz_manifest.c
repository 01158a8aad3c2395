/* Manifests: the fuzzer's bytes are the file. */
#include "fuzz.h"
#include "stylut/pack.h"

static void check_style(const StyManifestStyle *style) {
  require(*style->name && *style->exemplar && *style->guide && *style->lut_engine);
  require(!style->lut_file || *style->lut_file);
  require(style->lut_sampling || style->lut_file);
  require(style->lut_size >= 2 && style->lut_size <= STY_MAX_LUT_SIDE);
  require(style->parameters.threshold >= 0 && style->parameters.threshold <= STY_MAX_THRESHOLD);
  require(style->parameters.top_level >= 0 && style->parameters.top_level <= STY_MAX_LEVEL);
  require(style->parameters.radius >= 0 && style->parameters.radius <= STY_MAX_RADIUS);
  require(style->parameters.depth_tolerance >= 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  StyManifest manifest;
  StyError error;
  const StyStatus status = sty_read_manifest(put_file("manifest.json", data, size), &manifest, &error);
  if (status) {
    require_message(status, &error);
    return 0;
  }
  require(manifest.style_count >= 1 && manifest.style_count <= STY_MAX_STYLES);
  require(!manifest.jitter || *manifest.jitter);
  for (int i = 0; i < manifest.style_count; i++) {
    check_style(&manifest.styles[i]);
    for (int k = 0; k < i; k++) require(strcmp(manifest.styles[k].name, manifest.styles[i].name) != 0);
  }
  sty_close_manifest(&manifest);
  return 0;
}
