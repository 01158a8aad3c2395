/* The runtime on a bundle in memory. The input has a section for each of the
 * five files: how many bytes of the input are the file's own (two bytes), how
 * many more follow (three bytes; jitter alone is 128 KiB), and the own ones. */
#include "fuzz.h"
#include "stylut/runtime.h"

enum { WIDTH = 13, HEIGHT = 9, PIXELS = WIDTH * HEIGHT, OBJECTS = 3, MOST_FOLLOWING = 1 << 18 };

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
  for (int i = 0; i < frame->width * frame->height; i++) {
    if (frame->guide[4 * i + 3] && matches[i].level != STY_LEVEL_NONE)
      require(matches[i].x < source->width && matches[i].y < source->height && matches[i].layer < STY_MAX_LIGHTINGS);
    else
      require(matches[i].x == STY_NO_SOURCE && matches[i].y == STY_NO_SOURCE && matches[i].level == STY_LEVEL_NONE);
  }
}

/* All that a frame may show. */
typedef struct Planes {
  uint8_t guide[4 * PIXELS], styles[PIXELS], luma[PIXELS], albedo[4 * PIXELS];
  float fine[2 * PIXELS], depth[PIXELS];
  uint16_t objects[PIXELS];
  int32_t anchors[2 * OBJECTS];
  StySeedOffset offsets[STY_SEED_LEVELS * PIXELS];
  StySeeds seeds;
} Planes;

/* What a frame has: bits of the first two bytes of what is left, and its number. */
enum {
  FINE = 1,
  DEPTH = 2,
  STYLES = 4,
  WIDE = 8,
  LUMA = 16,
  ALBEDO = 32,
  OBJECT = 64,
  ANCHORS = 128,
  HALF = 1 << 8,
  DOUBLE = 1 << 9,
  SEEDS = 1 << 10,
  BRUTE = 1 << 11,
  LATE = 1 << 12
};

static void fill_planes(const Supply *supply, Planes *planes) {
  for (size_t i = 0; i < sizeof planes->guide; i++) planes->guide[i] = peek(supply, i);
  for (size_t i = 0; i < sizeof planes->albedo; i++) planes->albedo[i] = peek(supply, 5 * i + 2);
  for (size_t i = 0; i < 2 * PIXELS; i++) planes->fine[i] = (float)peek(supply, i + 5) / 100 - 1.2f;
  for (size_t i = 0; i < PIXELS; i++) {
    planes->styles[i] = peek(supply, 3 * i + 1) & 3;
    planes->luma[i] = peek(supply, 7 * i + 3);
    planes->depth[i] = (float)peek(supply, i + 7);
    planes->objects[i] = peek(supply, i / 3 + 4) & 3;
  }
  for (size_t i = 0; i < 2 * OBJECTS; i++) {
    Supply digits = {supply->bytes + (supply->size > i + 4 ? i : 0), supply->size > i + 4 ? 4 : 0};
    planes->anchors[i] = (int32_t)take_number(&digits, 4) % (STY_MAX_ANCHOR + 1);
  }
}

static StyFrame make_frame(Planes *planes, unsigned kind) {
  return (StyFrame){.width = WIDTH,
                    .height = HEIGHT,
                    .resolution = kind & HALF     ? -1
                                  : kind & DOUBLE ? 1
                                                  : 0,
                    .guide = planes->guide,
                    .fine = kind & FINE ? planes->fine : NULL,
                    .depth = kind & DEPTH ? planes->depth : NULL,
                    .styles = kind & STYLES ? planes->styles : NULL,
                    .style = 1,
                    .objects = kind & OBJECT ? planes->objects : NULL,
                    .luma = kind & LUMA ? planes->luma : NULL,
                    .albedo = kind & ALBEDO ? planes->albedo : NULL,
                    .anchors = kind & ANCHORS ? planes->anchors : NULL,
                    .anchor_count = OBJECTS,
                    .number = kind & LATE ? INT32_MAX : (int)kind};
}

/* Matches by every path, with seeds worked out before and without: one answer. */
static void transfer(const StyBundle *bundle, StyFrame *frame, Planes *planes, unsigned kind, StyMatch *matches) {
  StyMatch others[PIXELS];
  const StyRect all = {0, 0, WIDTH, HEIGHT}, area = {-3, -2, WIDTH - 3, HEIGHT - 2};
  frame->path = STY_PATH_REFERENCE;
  require(sty_transfer_frame(bundle, frame, all, matches) == STY_RUNTIME_OK);
  if (kind & SEEDS) {
    require(sty_get_seeds_size(area) == sizeof planes->offsets);
    require(sty_plan_seeds(bundle, 1, frame->number, area, planes->offsets, &planes->seeds) == STY_RUNTIME_OK);
    require(sty_fill_seeds(bundle, &planes->seeds, area.y0, area.y1, STY_PATH_BEST) == STY_RUNTIME_OK);
    frame->seeds = &planes->seeds;
    frame->seeds_count = 1;
  }
  for (int path = STY_PATH_BEST; path <= STY_PATH_AVX512; path++) {
    frame->path = (StyRuntimePath)path;
    if (!sty_has_path(frame->path)) continue;
    require(sty_transfer_frame(bundle, frame, all, others) == STY_RUNTIME_OK);
    require(memcmp(matches, others, sizeof others) == 0);
  }
}

static void blend(const StyBundle *bundle, StyFrame *frame, const StyMatch *matches, int bits) {
  uint16_t picture[4 * PIXELS] = {0}, other[4 * PIXELS] = {0}, halved[4 * PIXELS];
  const StyRect all = {0, 0, WIDTH, HEIGHT}, half = {0, 0, WIDTH / 2, HEIGHT / 2};
  frame->path = STY_PATH_REFERENCE;
  require(sty_blend_frame(bundle, frame, all, matches, bits, picture) == STY_RUNTIME_OK);
  frame->path = STY_PATH_BEST;
  require(sty_blend_frame(bundle, frame, all, matches, bits, other) == STY_RUNTIME_OK);
  require(memcmp(picture, other, sizeof picture) == 0);
  require(sty_halve_picture(WIDTH / 2, HEIGHT / 2, bits, picture, half, halved) == STY_RUNTIME_OK);
}

/* The frame's upper left half as the half of it. */
static void expand(const StyBundle *bundle, const StyFrame *frame, StyMatch *matches) {
  StyMatch half_matches[PIXELS];
  const StyRect all = {0, 0, WIDTH, HEIGHT};
  StyFrame half = *frame;
  half.width = (WIDTH + 1) / 2;
  half.height = (HEIGHT + 1) / 2;
  half.resolution = frame->resolution - 1;
  const StyRect half_all = {0, 0, half.width, half.height};
  require(sty_transfer_frame(bundle, &half, half_all, half_matches) == STY_RUNTIME_OK);
  require(sty_expand_matches(bundle, &half, half_matches, frame, all, matches) == STY_RUNTIME_OK);
  check_matches(bundle, frame, matches);
}

/* Draws a small frame of what is left of the input, by every pass. */
static void draw_frame(const StyBundle *bundle, const Supply *supply) {
  static Planes planes;
  StyMatch matches[PIXELS];
  const StyRect all = {0, 0, WIDTH, HEIGHT};
  const unsigned kind = peek(supply, 0) | (unsigned)peek(supply, 1) << 8;
  const int bits = kind & WIDE ? 16 : 8;
  fill_planes(supply, &planes);
  StyFrame frame = make_frame(&planes, kind);
  transfer(bundle, &frame, &planes, kind, matches);
  check_matches(bundle, &frame, matches);
  blend(bundle, &frame, matches, bits);
  require(sty_look_up_frame(bundle, &frame, all, matches) == STY_RUNTIME_OK);
  check_matches(bundle, &frame, matches);
  if (frame.resolution >= 0) {
    expand(bundle, &frame, matches);
    blend(bundle, &frame, matches, bits);
  }
  if (!(kind & BRUTE) || frame.resolution != 0) return;
  require(sty_transfer_brute(bundle, &frame, matches) == STY_RUNTIME_OK);
  check_matches(bundle, &frame, matches);
  blend(bundle, &frame, matches, bits);
}

/* Parameters that were taken come back. */
static void check_styles(const StyBundle *bundle) {
  for (int style = 1; style <= (int)bundle->textures[STY_BUNDLE_PARAMS].width; style++) {
    StyStyle values, again;
    float rows[STY_PARAM_ROWS][4];
    require(sty_get_style(bundle, style, &values) == STY_RUNTIME_OK);
    sty_encode_style(&values, rows);
    const uint32_t layers = bundle->textures[STY_BUNDLE_EXEMPLARS].layers;
    require(sty_decode_style((const float(*)[4])rows, layers, &again) == STY_RUNTIME_OK);
    require(memcmp(&values, &again, sizeof values) == 0);
  }
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
    check_styles(&bundle);
    draw_frame(&bundle, &supply);
  }
  for (int f = 0; f < STY_BUNDLE_FILES; f++) free((void *)(uintptr_t)files[f].data);
  return 0;
}
