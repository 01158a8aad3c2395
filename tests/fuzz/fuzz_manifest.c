/* Manifests: the fuzzer's bytes are the file. */
#include "fuzz.h"
#include "stylut/pack.h"

static void check_style(const StyManifestStyle *style) {
  require(*style->name && *style->guide && *style->lut.engine && *style->lut.resolve);
  require(style->parameters.layer_count >= 1 && style->parameters.layer_count <= STY_MAX_LIGHTINGS);
  for (int i = 0; i < style->parameters.layer_count; i++) require(*style->exemplars[i]);
  require(style->base > 0 || !(style->parameters.flags & STY_FLAG_BASE));
  require(!style->lut.file || *style->lut.file);
  require(style->lut.sampling || style->lut.file);
  require(style->lut.size == 0 || (style->lut.size >= 2 && style->lut.size <= STY_MAX_LUT_SIDE));
  for (const StyParameter *p = sty_parameters; p->name; p++) {
    const double value = sty_get_parameter(p, &style->parameters);
    require(value >= p->minimum && value <= p->maximum);
  }
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
  for (size_t i = 0; i < sty_count_manifest_names(manifest.jitter); i++)
    require(*sty_get_manifest_name(manifest.jitter, i));
  for (int i = 0; i < manifest.style_count; i++) {
    check_style(&manifest.styles[i]);
    for (int k = 0; k < i; k++) require(strcmp(manifest.styles[k].name, manifest.styles[i].name) != 0);
  }
  sty_close_manifest(&manifest);
  return 0;
}
