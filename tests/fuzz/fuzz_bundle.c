/* The runtime on a bundle in memory. The input has a section for each of the
 * five files: how many bytes of the input are the file's own (two bytes), how
 * many more follow (three bytes; jitter alone is 128 KiB), and the own ones. */
#include "fuzz.h"
#include "stylut/runtime.h"

enum { WIDTH = 13, HEIGHT = 9, MOST_FOLLOWING = 1 << 18 };

static const uint32_t formats[STY_BUNDLE_FILES] = {STY_VK_R8G8B8A8_SRGB, STY_VK_R8G8B8A8_UNORM, STY_VK_R16G16_UNORM,
                                                   STY_VK_R32G32B32A32_SFLOAT, STY_VK_R8G8_UNORM};

/* A file in a block of exactly its size. */
static StyBlob take_file(Supply *supply) {
  size_t own = take_number(supply, 2);
  const size_t following = take_number(supply, 3) % (MOST_FOLLOWING + 1);
  if (own > supply->size) own = supply->size;
  unsigned char *bytes = malloc(own + following);
  require(bytes);
  for (size_t i = 0; i < own; i++) bytes[i] = (unsigned char)take(supply);
  memset(bytes + own, 167, following);
  return (StyBlob){bytes, own + following};
}

static void check_texture(StyBlob file, uint32_t format) {
  StyTexture texture;
  if (sty_open_texture(file, format, &texture)) return;
  const size_t offset = (size_t)(texture.texels - (const unsigned char *)file.data);
  require(texture.width && texture.height && texture.layers && texture.texel_size);
  const size_t size = (size_t)texture.width * texture.height * texture.layers * texture.texel_size;
  require(offset <= file.size && size <= file.size - offset);
}

static void check_matches(const StyBundle *bundle, const StyFrame *frame, const StyMatch *matches) {
  const StyTexture *source = &bundle->textures[STY_BUNDLE_GUIDES];
  for (int i = 0; i < WIDTH * HEIGHT; i++) {
    if (frame->guide[4 * i + 3] && matches[i].level != STY_LEVEL_NONE)
      require(matches[i].x < source->width && matches[i].y < source->height);
    else
      require(matches[i].x == STY_NO_SOURCE && matches[i].y == STY_NO_SOURCE && matches[i].level == STY_LEVEL_NONE);
  }
}

/* Draws a small frame of what is left of the input. */
static void draw_frame(const StyBundle *bundle, const Supply *supply) {
  uint8_t guide[4 * WIDTH * HEIGHT], styles[WIDTH * HEIGHT];
  float fine[2 * WIDTH * HEIGHT], depth[WIDTH * HEIGHT];
  StyMatch matches[WIDTH * HEIGHT];
  uint16_t picture[4 * WIDTH * HEIGHT];
  for (size_t i = 0; i < sizeof guide; i++) guide[i] = peek(supply, i);
  for (size_t i = 0; i < WIDTH * HEIGHT; i++) styles[i] = peek(supply, 3 * i + 1) & 3;
  for (size_t i = 0; i < 2 * WIDTH * HEIGHT; i++) fine[i] = (float)peek(supply, i + 5) / 100 - 1.2f;
  for (size_t i = 0; i < WIDTH * HEIGHT; i++) depth[i] = (float)peek(supply, i + 7);
  const unsigned kind = peek(supply, 0);
  const StyFrame frame = {.width = WIDTH,
                          .height = HEIGHT,
                          .guide = guide,
                          .fine = kind & 1 ? fine : NULL,
                          .depth = kind & 2 ? depth : NULL,
                          .styles = kind & 4 ? styles : NULL,
                          .style = 1,
                          .luma = kind & 16 ? styles : NULL,
                          .albedo = kind & 32 ? guide : NULL,
                          .number = (int)kind};
  const StyRect all = {0, 0, WIDTH, HEIGHT};
  require(sty_transfer_frame(bundle, &frame, all, matches) == STY_RUNTIME_OK);
  check_matches(bundle, &frame, matches);
  require(sty_blend_frame(bundle, &frame, all, matches, kind & 8 ? 16 : 8, picture) == STY_RUNTIME_OK);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  Supply supply = {data, size};
  StyBlob files[STY_BUNDLE_FILES];
  for (int f = 0; f < STY_BUNDLE_FILES; f++) {
    files[f] = take_file(&supply);
    check_texture(files[f], formats[f]);
  }
  StyBundle bundle;
  int culprit = -1;
  const StyRuntimeStatus status = sty_open_bundle(files, &bundle, &culprit);
  if (status) {
    require(culprit >= 0 && culprit < STY_BUNDLE_FILES);
    require(*sty_describe_runtime_status(status));
  } else {
    draw_frame(&bundle, &supply);
  }
  for (int f = 0; f < STY_BUNDLE_FILES; f++) free((void *)(uintptr_t)files[f].data);
  return 0;
}
