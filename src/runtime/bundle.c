#include <math.h>
#include <string.h>

#include "view.h"

/* KTX File Format 2.0, section 3: the fixed header, then one level's index. */
enum {
  OFFSET_FORMAT = 12,
  OFFSET_TYPE_SIZE = 16,
  OFFSET_WIDTH = 20,
  OFFSET_HEIGHT = 24,
  OFFSET_DEPTH = 28,
  OFFSET_LAYERS = 32,
  OFFSET_FACES = 36,
  OFFSET_LEVELS = 40,
  OFFSET_SUPERCOMPRESSION = 44,
  OFFSET_DESCRIPTOR = 48,
  OFFSET_KEY_VALUES = 56,
  OFFSET_GLOBAL_DATA = 64,
  OFFSET_LEVEL = 80,
  HEADER_SIZE = 104
};

static const unsigned char ktx2_identifier[12] = {0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, '\r', '\n', 0x1A, '\n'};

static bool get_format_sizes(uint32_t format, uint32_t *component, uint32_t *texel) {
  switch (format) {
    case STY_VK_R8G8_UNORM: *component = 1, *texel = 2; return true;
    case STY_VK_R8G8B8A8_UNORM:
    case STY_VK_R8G8B8A8_SRGB: *component = 1, *texel = 4; return true;
    case STY_VK_R16G16_UNORM: *component = 2, *texel = 4; return true;
    case STY_VK_R32G32B32A32_SFLOAT: *component = 4, *texel = 16; return true;
    default: return false;
  }
}

static bool is_range_inside(uint64_t offset, uint64_t length, uint64_t size) {
  return offset <= size && length <= size - offset;
}

/* A picture stored bottom-up would be styled upside down without a word, so
 * the orientation counts. The specification's default is "rd". */
static StyRuntimeStatus check_orientation(const unsigned char *pairs, size_t size) {
  static const char expected[] = "KTXorientation\0rd";
  const size_t key_size = strlen(expected) + 1;
  while (size > 0) {
    if (size < 4) return STY_RUNTIME_NOT_KTX2;
    size_t length = read_u32(pairs);
    if (length > size - 4) return STY_RUNTIME_NOT_KTX2;
    bool is_orientation = length >= key_size && memcmp(pairs + 4, expected, key_size) == 0;
    if (is_orientation && (length != sizeof expected || memcmp(pairs + 4, expected, length) != 0))
      return STY_RUNTIME_WRONG_FORMAT;
    size_t padded = 4 + length + (4 - length % 4) % 4;
    if (padded > size) return STY_RUNTIME_NOT_KTX2;
    pairs += padded;
    size -= padded;
  }
  return STY_RUNTIME_OK;
}

StyRuntimeStatus sty_open_texture(StyBlob file, uint32_t format, StyTexture *out) {
  uint32_t component_size, texel_size;
  if (!file.data || !out || !get_format_sizes(format, &component_size, &texel_size)) return STY_RUNTIME_BAD_ARGUMENT;

  const unsigned char *bytes = file.data;
  if (file.size < sizeof ktx2_identifier || memcmp(bytes, ktx2_identifier, sizeof ktx2_identifier) != 0)
    return STY_RUNTIME_NOT_KTX2;
  if (file.size < HEADER_SIZE) return STY_RUNTIME_TRUNCATED;

  uint32_t width = read_u32(bytes + OFFSET_WIDTH), height = read_u32(bytes + OFFSET_HEIGHT);
  uint32_t layers = read_u32(bytes + OFFSET_LAYERS);
  if (read_u32(bytes + OFFSET_FORMAT) != format || read_u32(bytes + OFFSET_DEPTH) != 0 || height == 0 || layers == 0)
    return STY_RUNTIME_WRONG_FORMAT;
  if (read_u32(bytes + OFFSET_FACES) != 1 || read_u32(bytes + OFFSET_LEVELS) != 1) return STY_RUNTIME_WRONG_FORMAT;
  if (read_u32(bytes + OFFSET_SUPERCOMPRESSION) != 0 || read_u64(bytes + OFFSET_GLOBAL_DATA + 8) != 0)
    return STY_RUNTIME_WRONG_FORMAT;
  if (read_u32(bytes + OFFSET_TYPE_SIZE) != component_size || width == 0) return STY_RUNTIME_NOT_KTX2;

  uint64_t descriptor = read_u32(bytes + OFFSET_DESCRIPTOR), descriptor_size = read_u32(bytes + OFFSET_DESCRIPTOR + 4);
  uint64_t pairs = read_u32(bytes + OFFSET_KEY_VALUES), pairs_size = read_u32(bytes + OFFSET_KEY_VALUES + 4);
  uint64_t level = read_u64(bytes + OFFSET_LEVEL), level_size = read_u64(bytes + OFFSET_LEVEL + 8);
  if (!is_range_inside(descriptor, descriptor_size, file.size) || !is_range_inside(pairs, pairs_size, file.size) ||
      !is_range_inside(level, level_size, file.size))
    return STY_RUNTIME_TRUNCATED;

  /* width * height is below 2^64; the divisions keep the rest from wrapping. */
  uint64_t texels = (uint64_t)width * height;
  if (texels > level_size / texel_size || texels * texel_size > level_size / layers) return STY_RUNTIME_TRUNCATED;
  if (level_size != texels * texel_size * layers || read_u64(bytes + OFFSET_LEVEL + 16) != level_size)
    return STY_RUNTIME_NOT_KTX2;

  StyRuntimeStatus status = check_orientation(bytes + pairs, (size_t)pairs_size);
  if (status != STY_RUNTIME_OK) return status;
  *out = (StyTexture){bytes + level, width, height, layers, texel_size};
  return STY_RUNTIME_OK;
}

static bool has_right_shape(int file, const StyTexture *texture) {
  if (texture->width > STY_MAX_SOURCE_SIDE || texture->height > STY_MAX_SOURCE_SIDE) return false;
  switch (file) {
    case STY_BUNDLE_LUTS: return texture->width == texture->height && texture->width <= STY_MAX_LUT_SIDE;
    case STY_BUNDLE_PARAMS:
      return texture->width <= STY_MAX_STYLES && texture->height == STY_PARAM_ROWS && texture->layers == 1;
    case STY_BUNDLE_JITTER: return texture->width == STY_JITTER_SIZE && texture->height == STY_JITTER_SIZE;
    default: return true;
  }
}

/* The first file that doesn't fit those before it, or -1. */
static int find_mismatch(const StyTexture textures[STY_BUNDLE_FILES]) {
  const StyTexture *exemplars = &textures[STY_BUNDLE_EXEMPLARS], *guides = &textures[STY_BUNDLE_GUIDES];
  if (guides->width != exemplars->width || guides->height != exemplars->height) return STY_BUNDLE_GUIDES;
  if (textures[STY_BUNDLE_LUTS].layers != guides->layers) return STY_BUNDLE_LUTS;
  if (textures[STY_BUNDLE_PARAMS].width != guides->layers) return STY_BUNDLE_PARAMS;
  return -1;
}

StyRuntimeStatus sty_open_bundle(const StyBlob files[STY_BUNDLE_FILES], StyBundle *out, int *culprit) {
  static const uint32_t formats[STY_BUNDLE_FILES] = {STY_VK_R8G8B8A8_SRGB, STY_VK_R8G8B8A8_UNORM, STY_VK_R16G16_UNORM,
                                                     STY_VK_R32G32B32A32_SFLOAT, STY_VK_R8G8_UNORM};
  if (!files || !out) return STY_RUNTIME_BAD_ARGUMENT;

  StyBundle bundle;
  StyRuntimeStatus status = STY_RUNTIME_OK;
  int file = 0;
  for (; file < STY_BUNDLE_FILES; file++) {
    status = sty_open_texture(files[file], formats[file], &bundle.textures[file]);
    if (status == STY_RUNTIME_OK && !has_right_shape(file, &bundle.textures[file])) status = STY_RUNTIME_WRONG_FORMAT;
    if (status != STY_RUNTIME_OK) break;
  }
  if (status == STY_RUNTIME_OK) {
    file = find_mismatch(bundle.textures);
    if (file >= 0) status = STY_RUNTIME_MISMATCH;
  }
  if (status == STY_RUNTIME_OK) {
    file = STY_BUNDLE_PARAMS;
    StyStyle ignored;
    for (int style = 1; status == STY_RUNTIME_OK && style <= count_styles(&bundle); style++)
      status = sty_get_style(&bundle, style, &ignored);
  }
  if (status != STY_RUNTIME_OK) {
    if (culprit) *culprit = file;
    return status;
  }
  *out = bundle;
  return STY_RUNTIME_OK;
}

StyRuntimeStatus sty_get_style(const StyBundle *bundle, int style, StyStyle *out) {
  if (!bundle || !out || style < 1 || style > count_styles(bundle)) return STY_RUNTIME_BAD_ARGUMENT;

  const StyTexture *params = &bundle->textures[STY_BUNDLE_PARAMS];
  float rows[STY_PARAM_ROWS][4];
  for (int row = 0; row < STY_PARAM_ROWS; row++) {
    const unsigned char *texel = params->texels + ((size_t)row * params->width + (size_t)style - 1) * 16;
    for (int component = 0; component < 4; component++) {
      uint32_t bits = read_u32(texel + component * 4);
      memcpy(&rows[row][component], &bits, sizeof bits);
    }
  }
  return sty_decode_style((const float(*)[4])rows, bundle->textures[STY_BUNDLE_EXEMPLARS].layers, out);
}
