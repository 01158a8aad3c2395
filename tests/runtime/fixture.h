/* Bundles and frames in memory for tests of the runtime: files laid out by hand
 * (KTX File Format 2.0), filled with a random sequence that is the same everywhere. */
#ifndef STYLUT_TESTS_FIXTURE_H
#define STYLUT_TESTS_FIXTURE_H

#include <math.h>
#include <stdbool.h>

#include "../scratch.h"
#include "stylut/runtime.h"

enum { HEADER_SIZE = 104 };

static const struct {
  uint32_t vk, channels, channel_size, transfer, lower, upper;
} layouts[STY_BUNDLE_FILES] = {{STY_VK_R8G8B8A8_SRGB, 4, 1, 2, 0, 255},
                               {STY_VK_R8G8B8A8_UNORM, 4, 1, 1, 0, 255},
                               {STY_VK_R16G16_UNORM, 2, 2, 1, 0, 65535},
                               {STY_VK_R32G32B32A32_SFLOAT, 4, 4, 1, 0xBF800000, 0x3F800000},
                               {STY_VK_R8G8_UNORM, 2, 1, 1, 0, 255}};

static inline void put32(unsigned char *at, uint32_t value) {
  for (int i = 0; i < 4; i++) at[i] = (unsigned char)(value >> 8 * i);
}

static inline void put64(unsigned char *at, uint64_t value) {
  put32(at, (uint32_t)value);
  put32(at + 4, (uint32_t)(value >> 32));
}

static inline void put_float(unsigned char *at, float value) {
  uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  put32(at, bits);
}

/* Where the parts of a file lie. */
typedef struct Parts {
  size_t descriptor, descriptor_size, pairs, pairs_size, level, level_size;
} Parts;

static inline Parts find_parts(int file, uint32_t width, uint32_t height, uint32_t layers) {
  const size_t texel = layouts[file].channels * layouts[file].channel_size;
  Parts parts = {.descriptor = HEADER_SIZE, .descriptor_size = 4 + 24 + 16 * layouts[file].channels, .pairs_size = 24};
  parts.pairs = parts.descriptor + parts.descriptor_size;
  parts.level = (parts.pairs + parts.pairs_size + 15) / 16 * 16;
  parts.level_size = texel * width * height * layers;
  return parts;
}

/* An array texture of the kind that belongs at `file`, all texels 0, in a block of exactly its size. */
static inline StyBlob make_file(int file, uint32_t width, uint32_t height, uint32_t layers) {
  static const unsigned char identifier[12] = {0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, '\r', '\n', 0x1A, '\n'};
  const uint32_t channels = layouts[file].channels, size = layouts[file].channel_size;
  const Parts parts = find_parts(file, width, height, layers);
  unsigned char *bytes = calloc(1, parts.level + parts.level_size);
  assert_non_null(bytes);
  memcpy(bytes, identifier, sizeof identifier);
  const uint32_t words[] = {layouts[file].vk,
                            size,
                            width,
                            height,
                            0,
                            layers,
                            1,
                            1,
                            0,
                            (uint32_t)parts.descriptor,
                            (uint32_t)parts.descriptor_size,
                            (uint32_t)parts.pairs,
                            (uint32_t)parts.pairs_size};
  for (size_t i = 0; i < sizeof words / sizeof *words; i++) put32(bytes + 12 + 4 * i, words[i]);
  put64(bytes + 80, parts.level);
  put64(bytes + 88, parts.level_size);
  put64(bytes + 96, parts.level_size);
  unsigned char *d = bytes + parts.descriptor;
  put32(d, (uint32_t)parts.descriptor_size);
  put32(d + 8, 2 | (uint32_t)(parts.descriptor_size - 4) << 16);
  put32(d + 12, 1 | 1 << 8 | layouts[file].transfer << 16);
  put32(d + 20, channels * size);
  for (uint32_t c = 0; c < channels; c++) {
    const uint32_t type = (c == 3 ? 15u : c) | (file == STY_BUNDLE_EXEMPLARS && c == 3 ? 0x10u : 0u) |
                          (file == STY_BUNDLE_PARAMS ? 0xC0u : 0u);
    put32(d + 28 + 16 * c, 8 * size * c | (8 * size - 1) << 16 | type << 24);
    put32(d + 36 + 16 * c, layouts[file].lower);
    put32(d + 40 + 16 * c, layouts[file].upper);
  }
  put32(bytes + parts.pairs, 18);
  memcpy(bytes + parts.pairs + 4, "KTXorientation\0rd", 18);
  return (StyBlob){bytes, parts.level + parts.level_size};
}

typedef struct Fixture {
  int width, height, lut_side, styles, exemplars, jitters;
  StyBlob files[STY_BUNDLE_FILES];
  unsigned char *texels[STY_BUNDLE_FILES]; /* inside the files */
  StyStyle style[STY_MAX_STYLES + 1];      /* from 1 */
  StyBundle bundle;
} Fixture;

/* Parameters that say no scale are plain: one lighting, full jitter, a new table each frame, scale 1. */
static inline void write_style(Fixture *fixture, int style, const StyStyle *given) {
  StyStyle values = *given;
  if (values.scale == 0) values.layer_count = 1, values.jitter_amount = 1, values.jitter_period = 1, values.scale = 1;
  const float rows[STY_PARAM_ROWS][4] = {
      {(float)values.threshold, (float)values.top_level, (float)values.radius, values.depth_tolerance},
      {values.luma_weight, values.colour_weight, (float)values.layer, (float)values.layer_count},
      {values.luma[0], values.luma[1], values.luma[2], values.luma[3]},
      {values.jitter_amount, (float)values.jitter_period, values.scale, (float)values.flags},
      {(float)values.scatter, 0, 0, 0}};
  for (int row = 0; row < STY_PARAM_ROWS; row++)
    for (int c = 0; c < 4; c++)
      put_float(fixture->texels[STY_BUNDLE_PARAMS] + 16 * (row * fixture->styles + style - 1) + 4 * c, rows[row][c]);
  fixture->style[style] = values;
}

/* Texels are 0, styles have threshold 24 and nothing else: fill, then open_fixture. */
static inline Fixture *make_fixture(int width, int height, int lut_side, int styles, int exemplars, int jitters) {
  Fixture *fixture = calloc(1, sizeof *fixture);
  assert_non_null(fixture);
  *fixture = (Fixture){width, height, lut_side, styles, exemplars, jitters, {{0}}, {0}, {{0}}, {{{0}}}};
  const int shapes[STY_BUNDLE_FILES][3] = {{width, height, exemplars},
                                           {width, height, styles},
                                           {lut_side, lut_side, styles},
                                           {styles, STY_PARAM_ROWS, 1},
                                           {STY_JITTER_SIZE, STY_JITTER_SIZE, jitters}};
  for (int file = 0; file < STY_BUNDLE_FILES; file++) {
    const uint32_t w = (uint32_t)shapes[file][0], h = (uint32_t)shapes[file][1], layers = (uint32_t)shapes[file][2];
    fixture->files[file] = make_file(file, w, h, layers);
    fixture->texels[file] = (unsigned char *)fixture->files[file].data + find_parts(file, w, h, layers).level;
  }
  const StyStyle plain = {.threshold = 24};
  for (int style = 1; style <= styles; style++) write_style(fixture, style, &plain);
  return fixture;
}

static inline void open_fixture(Fixture *fixture) {
  int culprit = -1;
  StyBlob files[STY_BUNDLE_FILES];
  memcpy(files, fixture->files, sizeof files);
  const StyRuntimeStatus status = sty_open_bundle(files, &fixture->bundle, &culprit);
  if (status) fail_msg("file %d: %s", culprit, sty_describe_runtime_status(status));
}

static inline void destroy_fixture(Fixture *fixture) {
  for (int file = 0; file < STY_BUNDLE_FILES; file++) free((void *)fixture->files[file].data);
  free(fixture);
}

/* How guide bytes are drawn: from `spread` values from `base`, so that thresholds decide; covered with
 * probability 1 - 1/holes, wholly if holes is 0. */
typedef struct Guides {
  int base, spread, holes;
} Guides;

static inline void draw_guide(uint64_t *random, const Guides *how, uint8_t *guide, size_t pixels) {
  for (size_t i = 0; i < pixels; i++) {
    for (size_t c = 0; c < 3; c++) guide[4 * i + c] = (uint8_t)(how->base + draw_below(random, how->spread));
    guide[4 * i + 3] = (uint8_t)(how->holes && !draw_below(random, how->holes) ? 0 : 1 + draw_below(random, 255));
  }
}

static inline void fill_random(uint64_t *random, unsigned char *bytes, size_t count) {
  for (size_t i = 0; i < count; i++) bytes[i] = (unsigned char)draw(random);
}

static inline size_t count_texel_bytes(const Fixture *fixture, int file) {
  return fixture->files[file].size - (size_t)(fixture->texels[file] - (const unsigned char *)fixture->files[file].data);
}

/* One of `count` numbers. */
#define DRAW_OF(random, ...) \
  (((const double[]){__VA_ARGS__})[draw_below(random, (int)(sizeof((double[]){__VA_ARGS__}) / sizeof(double)))])

/* Any parameters that the bundle's layers allow; fractions that no byte and no 256th holds among them. */
static inline StyStyle draw_style(uint64_t *random, const Guides *how, const Fixture *fixture) {
  StyStyle values = {
      .threshold = (int)DRAW_OF(random, 0, 1, 24, draw_below(random, 3 * how->spread), STY_MAX_THRESHOLD),
      .top_level = draw_below(random, 7),
      .radius = draw_below(random, STY_MAX_RADIUS + 1),
      .depth_tolerance = (float)DRAW_OF(random, 0, 0.25, 0.5, 100),
      .luma_weight = (float)DRAW_OF(random, 0, 0.1, 0.3, 1, draw_below(random, 1600) / 100.0, 16),
      .colour_weight = (float)DRAW_OF(random, 0, 0.1, 0.5, draw_below(random, 1000) / 1000.0, 1),
      .layer_count = 1 + draw_below(random, fixture->exemplars < 4 ? fixture->exemplars : 4),
      .jitter_amount = (float)DRAW_OF(random, 0, 0.1, 0.5, draw_below(random, 1000) / 1000.0, 1),
      .jitter_period = (int)DRAW_OF(random, 0, 1, 2, 7, STY_MAX_PERIOD),
      .scale = (float)DRAW_OF(random, 0.5, 1, 1, 2),
      .flags = (unsigned)draw_below(random, STY_KNOWN_FLAGS + 1),
      .scatter = (int)DRAW_OF(random, 0, 1, draw_below(random, 12), STY_MAX_SCATTER)};
  if (2 * values.layer_count > fixture->exemplars) values.flags &= ~STY_FLAG_BASE;
  const int layers = values.layer_count * (values.flags & STY_FLAG_BASE ? 2 : 1);
  values.layer = draw_below(random, fixture->exemplars - layers + 1);
  for (int i = 0; i < STY_MAX_LIGHTINGS; i++) values.luma[i] = (float)draw_below(random, 101) / 100;
  return values;
}

/* A bundle of random texels and styles, opened. Every eighth jitter byte is 255, every eighth 0. */
static inline Fixture *draw_fixture(uint64_t *random, const Guides *how, int lut_side, int styles) {
  Fixture *fixture = make_fixture(1 + draw_below(random, 40), 1 + draw_below(random, 40), lut_side, styles,
                                  1 + draw_below(random, 8), 1 + draw_below(random, 3));
  fill_random(random, fixture->texels[STY_BUNDLE_EXEMPLARS], count_texel_bytes(fixture, STY_BUNDLE_EXEMPLARS));
  fill_random(random, fixture->texels[STY_BUNDLE_LUTS], count_texel_bytes(fixture, STY_BUNDLE_LUTS));
  fill_random(random, fixture->texels[STY_BUNDLE_JITTER], count_texel_bytes(fixture, STY_BUNDLE_JITTER));
  for (size_t i = 0; i < count_texel_bytes(fixture, STY_BUNDLE_JITTER); i += 8) {
    fixture->texels[STY_BUNDLE_JITTER][i + (size_t)draw_below(random, 4)] = 255;
    fixture->texels[STY_BUNDLE_JITTER][i + 4 + (size_t)draw_below(random, 4)] = 0;
  }
  for (int i = 0; i < 4; i++) fixture->texels[STY_BUNDLE_LUTS][i] = i & 2 ? 0 : 255; /* the far end and the near one */
  draw_guide(random, how, fixture->texels[STY_BUNDLE_GUIDES], count_texel_bytes(fixture, STY_BUNDLE_GUIDES) / 4);
  for (int style = 1; style <= styles; style++) {
    const StyStyle values = draw_style(random, how, fixture);
    write_style(fixture, style, &values);
  }
  open_fixture(fixture);
  return fixture;
}

/* Where objects' grids begin: around the frame, far outside it, as far as can be. */
static inline int32_t *draw_anchors(uint64_t *random, int count) {
  int32_t *anchors = malloc(2 * sizeof *anchors * (size_t)(count ? count : 1));
  assert_non_null(anchors);
  for (int i = 0; i < 2 * count; i++)
    anchors[i] = (int32_t)DRAW_OF(random, 0, draw_below(random, 200) - 100, draw_below(random, 200) - 100,
                                  draw_below(random, 200000) - 100000, STY_MAX_ANCHOR, -STY_MAX_ANCHOR);
  return anchors;
}

/* Random guide, and each of all that a frame may have besides in half of the frames. Full precision and depth are
 * multiples of powers of two, so that float arithmetic on them is exact. Objects are patches of 16 by 16 pixels; some
 * have no anchor where there are any. */
static inline StyFrame draw_frame(uint64_t *random, const Guides *how, const Fixture *fixture, int width, int height) {
  static const float specials[] = {NAN, INFINITY, -INFINITY, 1.5f, -1.5f, 1, -1, 0};
  static const float depths[] = {0, 0.25f, 0.5f, 0.75f, 50, 200, INFINITY, -INFINITY, NAN};
  enum { OBJECTS = 6 };
  const size_t pixels = (size_t)width * (size_t)height;
  uint8_t *guide = malloc(4 * pixels), *styles = malloc(pixels), *luma = malloc(pixels), *albedo = malloc(4 * pixels);
  float *fine = malloc(2 * pixels * sizeof *fine), *depth = malloc(pixels * sizeof *depth);
  uint16_t *objects = malloc(pixels * sizeof *objects);
  assert_true(guide && styles && fine && depth && luma && albedo && objects);
  draw_guide(random, how, guide, pixels);
  for (size_t i = 0; i < 2 * pixels; i++)
    fine[i] =
        draw_below(random, 16) ? (float)(draw_below(random, 2049) - 1024) / 1024 : specials[draw_below(random, 8)];
  for (size_t i = 0; i < pixels; i++) depth[i] = depths[draw_below(random, 9)];
  for (size_t i = 0; i < pixels; i++)
    styles[i] = (uint8_t)(draw_below(random, 8) ? 1 + draw_below(random, fixture->styles)
                                                : draw_below(random, 2) * (255 - draw_below(random, 3)));
  fill_random(random, luma, pixels);
  fill_random(random, albedo, 4 * pixels);
  const uint64_t patches = draw(random);
  for (size_t i = 0; i < pixels; i++) {
    uint64_t patch = patches + i % (size_t)width / 16 * 1000003 + i / (size_t)width / 16;
    objects[i] = (uint16_t)(draw_below(&patch, OBJECTS) ? draw_below(&patch, OBJECTS) : 65535);
  }
  StyFrame frame = {.width = width,
                    .height = height,
                    .resolution = (int)DRAW_OF(random, -1, 0, 0, 1),
                    .guide = guide,
                    .fine = fine,
                    .depth = depth,
                    .styles = styles,
                    .style = 1 + draw_below(random, fixture->styles),
                    .objects = objects,
                    .luma = luma,
                    .albedo = albedo,
                    .anchor_count = draw_below(random, OBJECTS + 1),
                    .number = (int)DRAW_OF(random, draw_below(random, 10), draw_below(random, 1 << 30), INT32_MAX)};
  frame.anchors = draw_anchors(random, frame.anchor_count);
  if (draw(random) & 1) free(fine), frame.fine = NULL;
  if (draw(random) & 1) free(depth), frame.depth = NULL;
  if (draw(random) & 1) free(styles), frame.styles = NULL;
  if (draw(random) & 1) free(luma), frame.luma = NULL;
  if (draw(random) & 1) free(albedo), frame.albedo = NULL;
  if (draw(random) & 1) free(objects), frame.objects = NULL;
  if (draw(random) & 1) free((void *)frame.anchors), frame.anchors = NULL, frame.anchor_count = 0;
  return frame;
}

static inline void destroy_frame(const StyFrame *frame) {
  free((void *)frame->guide);
  free((void *)frame->fine);
  free((void *)frame->depth);
  free((void *)frame->styles);
  free((void *)frame->luma);
  free((void *)frame->albedo);
  free((void *)frame->objects);
  free((void *)frame->anchors);
}

/* Sizes of frames that tests go through: single pixels, rows, columns, odd. */
static const int frame_sizes[][2] = {{1, 1}, {1, 41}, {53, 1}, {37, 23}, {130, 70}};
enum { FRAME_SIZES = 5 };

/* The style of a pixel as a frame says it, 0 = not stylized. */
static inline int ask_style(const Fixture *fixture, const StyFrame *frame, int x, int y) {
  const size_t i = (size_t)y * (size_t)frame->width + (size_t)x;
  const int style = frame->styles ? frame->styles[i] : frame->style;
  return frame->guide[4 * i + 3] > 0 && style <= fixture->styles ? style : 0;
}

/* The guide texel of a source pixel; NULL outside the source or its mask. */
static inline const uint8_t *ask_source(const Fixture *fixture, int style, int x, int y) {
  if (x < 0 || x >= fixture->width || y < 0 || y >= fixture->height) return NULL;
  const uint8_t *texel =
      fixture->texels[STY_BUNDLE_GUIDES] + 4 * (((style - 1) * fixture->height + y) * fixture->width + x);
  return texel[3] > 0 ? texel : NULL;
}

/* A rectangle in a frame, at least one pixel. */
static inline StyRect draw_rect(uint64_t *random, const StyFrame *frame) {
  StyRect rect = {draw_below(random, frame->width), draw_below(random, frame->height), 0, 0};
  rect.x1 = rect.x0 + 1 + draw_below(random, frame->width - rect.x0);
  rect.y1 = rect.y0 + 1 + draw_below(random, frame->height - rect.y0);
  return rect;
}

static inline StyRect get_all(const StyFrame *frame) { return (StyRect){0, 0, frame->width, frame->height}; }

static inline bool is_inside(StyRect rect, int x, int y) {
  return x >= rect.x0 && y >= rect.y0 && x < rect.x1 && y < rect.y1;
}

#endif
