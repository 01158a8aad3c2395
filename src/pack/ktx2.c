#include "stylut/ktx2.h"

#include <stdbool.h>
#include <string.h>

#include "stylut/runtime_format.h"

/* What the header and its data format descriptor say of a format (KTX 2.0,
 * sections 3 and 4; Khronos Data Format 1.3, section 5). */
typedef struct Format {
  uint32_t vk;
  uint32_t channels, channel_bytes;
  bool srgb, is_float;
} Format;

static const Format formats[] = {
    {STY_VK_R8G8_UNORM, 2, 1, false, false},         {STY_VK_R8G8B8A8_UNORM, 4, 1, false, false},
    {STY_VK_R8G8B8A8_SRGB, 4, 1, true, false},       {STY_VK_R16G16_UNORM, 2, 2, false, false},
    {STY_VK_R32G32B32A32_SFLOAT, 4, 4, false, true},
};

static const Format *find_format(uint32_t vk) {
  for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
    if (formats[i].vk == vk) return &formats[i];
  return NULL;
}

/* The head of the file, little-endian words appended one by one. */
typedef struct Head {
  unsigned char bytes[512];
  size_t size;
} Head;

static void put32(Head *head, uint32_t value) {
  for (int k = 0; k < 4; k++) head->bytes[head->size++] = (unsigned char)(value >> 8 * k);
}

static void put64(Head *head, uint64_t value) {
  put32(head, (uint32_t)value);
  put32(head, (uint32_t)(value >> 32));
}

static void put_entry(Head *head, const char *key, const char *value) {
  const size_t key_size = strlen(key) + 1, value_size = strlen(value) + 1;
  put32(head, (uint32_t)(key_size + value_size));
  memcpy(head->bytes + head->size, key, key_size);
  memcpy(head->bytes + head->size + key_size, value, value_size);
  head->size += (key_size + value_size + 3) & ~(size_t)3;
}

enum { HEADER_SIZE = 80, LEVEL_INDEX_SIZE = 24, DESCRIPTOR_SIZE = 24, SAMPLE_SIZE = 16 };

static void put_descriptor(Head *head, const Format *format) {
  enum { MODEL_RGBSDA = 1, PRIMARIES_BT709 = 1, TRANSFER_LINEAR = 1, TRANSFER_SRGB = 2, VERSION_1_3 = 2 };
  enum { CHANNEL_ALPHA = 15, QUALIFIER_LINEAR = 0x10, QUALIFIER_SIGNED = 0x40, QUALIFIER_FLOAT = 0x80 };
  const uint32_t block = DESCRIPTOR_SIZE + SAMPLE_SIZE * format->channels, bits = 8 * format->channel_bytes;
  put32(head, block + 4);
  put32(head, 0); /* Khronos, basic descriptor */
  put32(head, VERSION_1_3 | block << 16);
  put32(head, MODEL_RGBSDA | PRIMARIES_BT709 << 8 | (uint32_t)(format->srgb ? TRANSFER_SRGB : TRANSFER_LINEAR) << 16);
  put32(head, 0); /* a texel is a block of 1 x 1 */
  put32(head, format->channels * format->channel_bytes);
  put32(head, 0);
  for (uint32_t c = 0; c < format->channels; c++) {
    const bool alpha = c == 3;
    uint32_t channel = alpha ? CHANNEL_ALPHA : c;
    if (alpha && format->srgb) channel |= QUALIFIER_LINEAR;
    if (format->is_float) channel |= QUALIFIER_SIGNED | QUALIFIER_FLOAT;
    put32(head, c * bits | (bits - 1) << 16 | channel << 24);
    put32(head, 0);
    /* The values that stand for 0 (or -1) and 1. */
    put32(head, format->is_float ? 0xBF800000u : 0);
    put32(head, format->is_float ? 0x3F800000u : bits == 8 ? 0xFFu : 0xFFFFu);
  }
}

static void put_head(Head *head, const Format *format, int width, int height, int layers, uint64_t level_size) {
  static const unsigned char identifier[12] = {0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, '\r', '\n', 0x1A, '\n'};
  const uint32_t texel = format->channels * format->channel_bytes;
  Head descriptor = {{0}, 0}, metadata = {{0}, 0};
  put_descriptor(&descriptor, format);
  put_entry(&metadata, "KTXorientation", "rd");
  put_entry(&metadata, "KTXwriter", "stylut");
  const size_t descriptor_at = HEADER_SIZE + LEVEL_INDEX_SIZE, metadata_at = descriptor_at + descriptor.size;
  const size_t alignment = texel > 4 ? texel : 4;
  const size_t level_at = (metadata_at + metadata.size + alignment - 1) / alignment * alignment;

  memcpy(head->bytes, identifier, sizeof identifier);
  head->size = sizeof identifier;
  put32(head, format->vk);
  put32(head, format->channel_bytes);
  put32(head, (uint32_t)width);
  put32(head, (uint32_t)height);
  put32(head, 0); /* depth: two-dimensional */
  put32(head, (uint32_t)layers);
  put32(head, 1); /* faces */
  put32(head, 1); /* levels */
  put32(head, 0); /* no supercompression */
  put32(head, (uint32_t)descriptor_at);
  put32(head, (uint32_t)descriptor.size);
  put32(head, (uint32_t)metadata_at);
  put32(head, (uint32_t)metadata.size);
  put64(head, 0);
  put64(head, 0);
  put64(head, level_at);
  put64(head, level_size);
  put64(head, level_size);
  memcpy(head->bytes + head->size, descriptor.bytes, descriptor.size);
  memcpy(head->bytes + metadata_at, metadata.bytes, metadata.size);
  head->size = level_at;
}

StyStatus sty_open_ktx2(const char *path, uint32_t format_number, int width, int height, int layers, StyKtx2 *out,
                        StyError *error) {
  const Format *format = find_format(format_number);
  if (!format || width < 1 || height < 1 || layers < 1)
    return sty_fail(error, STY_ERROR_USAGE,
                    "%s: found format %u, %dx%d texels and %d layers, expected a known format and at least one of each",
                    path, format_number, width, height, layers);
  const uint64_t texels = (uint64_t)width * (uint64_t)height, texel = format->channels * format->channel_bytes;
  if (texels > (uint64_t)INT64_MAX / texel / (uint64_t)layers)
    return sty_fail(error, STY_ERROR_USAGE, "%s: found %dx%d texels and %d layers, expected fewer than 2^63 bytes",
                    path, width, height, layers);
  StyKtx2 texture = {.width = width, .height = height, .layers = layers, .layer_size = texels * texel};
  StyStatus status = sty_open_output(path, &texture.output, error);
  if (status) return status;
  Head head = {{0}, 0};
  put_head(&head, format, width, height, layers, texture.layer_size * (uint64_t)layers);
  fwrite(head.bytes, 1, head.size, texture.output.stream);
  status = sty_flush_output(&texture.output, error);
  texture.offset = head.size;
  if (status)
    sty_discard_output(&texture.output);
  else
    *out = texture;
  return status;
}

StyStatus sty_place_ktx2_layer(StyKtx2 *texture, int layer, const void *texels, StyError *error) {
  if (layer < 0 || layer >= texture->layers)
    return sty_fail(error, STY_ERROR_USAGE, "%s: found layer %d, expected one of the %d", texture->output.path, layer,
                    texture->layers);
  const StyStatus status = sty_place_output(&texture->output, texture->offset + (uint64_t)layer * texture->layer_size,
                                            texels, (size_t)texture->layer_size, error);
  if (!status) __atomic_fetch_add(&texture->written, 1, __ATOMIC_RELAXED);
  return status;
}

StyStatus sty_write_ktx2_layer(StyKtx2 *texture, const void *texels, StyError *error) {
  return sty_place_ktx2_layer(texture, texture->written, texels, error);
}

StyStatus sty_commit_ktx2(StyKtx2 *texture, StyError *error) {
  if (texture->written == texture->layers) return sty_commit_output(&texture->output, error);
  const StyStatus status = sty_fail(error, STY_ERROR_USAGE, "%s: found %d layers, expected %d", texture->output.path,
                                    texture->written, texture->layers);
  sty_discard_output(&texture->output);
  return status;
}

void sty_discard_ktx2(StyKtx2 *texture) { sty_discard_output(&texture->output); }

StyStatus sty_end_ktx2(StyKtx2 *texture, StyStatus so_far, StyError *error) {
  if (!so_far) return sty_commit_ktx2(texture, error);
  sty_discard_ktx2(texture);
  return so_far;
}

StyStatus sty_write_ktx2(const char *path, uint32_t format, int width, int height, int layers, const void *texels,
                         StyError *error) {
  StyKtx2 texture;
  StyStatus status = sty_open_ktx2(path, format, width, height, layers, &texture, error);
  if (status) return status;
  for (int i = 0; !status && i < layers; i++)
    status = sty_write_ktx2_layer(&texture, (const char *)texels + (size_t)i * texture.layer_size, error);
  return sty_end_ktx2(&texture, status, error);
}
