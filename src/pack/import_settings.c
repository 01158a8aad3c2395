#include "pack/import_settings.h"

#include <stdbool.h>
#include <stdlib.h>

#include "stylut/pack.h"

/* What the shaders read (src/runtime/glsl): exemplars are sRGB, but blended as they are encoded, so that no sampler may
 * decode them; coordinates of LUTs are whole numbers. */
typedef struct Use {
  const char *unity;  /* GraphicsFormat */
  const char *unreal; /* EPixelFormat */
  const char *godot;  /* RenderingDevice.DataFormat */
  const char *encoding;
  bool repeats;
} Use;

static const Use uses[STY_BUNDLE_FILES] = {
    [STY_BUNDLE_EXEMPLARS] = {"R8G8B8A8_UNorm", "PF_R8G8B8A8", "DATA_FORMAT_R8G8B8A8_UNORM",
                              "sRGB, to be read as it is encoded", false},
    [STY_BUNDLE_GUIDES] = {"R8G8B8A8_UNorm", "PF_R8G8B8A8", "DATA_FORMAT_R8G8B8A8_UNORM", "linear", false},
    [STY_BUNDLE_LUTS] = {"R16G16_UInt", "PF_R16G16_UINT", "DATA_FORMAT_R16G16_UINT", "linear", false},
    [STY_BUNDLE_PARAMS] = {"R32G32B32A32_SFloat", "PF_A32B32G32R32F", "DATA_FORMAT_R32G32B32A32_SFLOAT", "linear",
                           false},
    [STY_BUNDLE_JITTER] = {"R8G8_UNorm", "PF_R8G8", "DATA_FORMAT_R8G8_UNORM", "linear", true},
};

static json_t *describe_texture(const StyKtx2 *texture, const Use *use) {
  return json_pack("{s:i, s:i, s:i, s:I, s:I, s:s}", "width", texture->width, "height", texture->height, "layers",
                   texture->layers, "offset", (json_int_t)texture->offset, "layer_bytes",
                   (json_int_t)texture->layer_size, "encoding", use->encoding);
}

static json_t *describe_unity(const Use *use) {
  return json_pack("{s:s, s:s, s:b, s:b, s:s, s:s, s:s}", "graphicsFormat", use->unity, "dimension", "Tex2DArray",
                   "sRGBTexture", 0, "mipmapEnabled", 0, "textureCompression", "Uncompressed", "filterMode", "Point",
                   "wrapMode", use->repeats ? "Repeat" : "Clamp");
}

static json_t *describe_unreal(const Use *use) {
  const char *address = use->repeats ? "TA_Wrap" : "TA_Clamp";
  return json_pack("{s:s, s:b, s:b, s:s, s:s, s:s, s:s}", "PixelFormat", use->unreal, "SRGB", 0, "CompressionNone", 1,
                   "MipGenSettings", "TMGS_NoMipmaps", "Filter", "TF_Nearest", "AddressX", address, "AddressY",
                   address);
}

static json_t *describe_godot(const Use *use) {
  const char *mode = use->repeats ? "SAMPLER_REPEAT_MODE_REPEAT" : "SAMPLER_REPEAT_MODE_CLAMP_TO_EDGE";
  return json_pack("{s:s, s:s, s:i, s:s, s:s, s:s, s:s}", "format", use->godot, "texture_type", "TEXTURE_TYPE_2D_ARRAY",
                   "mipmaps", 1, "mag_filter", "SAMPLER_FILTER_NEAREST", "min_filter", "SAMPLER_FILTER_NEAREST",
                   "repeat_u", mode, "repeat_v", mode);
}

static json_t *describe_settings(const StyKtx2 textures[STY_BUNDLE_FILES]) {
  json_t *files = json_object(), *unity = json_object(), *unreal = json_object(), *godot = json_object();
  for (int i = 0; i < STY_BUNDLE_FILES; i++) {
    json_object_set_new(files, sty_bundle_files[i], describe_texture(&textures[i], &uses[i]));
    json_object_set_new(unity, sty_bundle_files[i], describe_unity(&uses[i]));
    json_object_set_new(unreal, sty_bundle_files[i], describe_unreal(&uses[i]));
    json_object_set_new(godot, sty_bundle_files[i], describe_godot(&uses[i]));
  }
  return json_pack("{s:s, s:s, s:o, s:o, s:o, s:o}", "schema", "stylut-import-settings/1", "note",
                   "Texels begin at `offset`, layer by layer, row 0 at the top, little-endian, without padding.",
                   "textures", files, "unity", unity, "unreal", unreal, "godot", godot);
}

StyStatus sty_write_import_settings(const StyBundleFolder *folder, const StyKtx2 textures[STY_BUNDLE_FILES],
                                    StyError *error) {
  char *file = sty_name_bundle_file(folder, STY_IMPORT_SETTINGS, error);
  if (!file) return STY_ERROR_LIBRARY;
  json_t *settings = describe_settings(textures);
  const StyStatus status = sty_write_json(file, settings, error);
  json_decref(settings);
  free(file);
  return status;
}
