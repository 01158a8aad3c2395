/* What the passes of the runtime share: little-endian reads, the parts of a
 * bundle that belong to one style, and what a frame shows at a pixel. */
#ifndef STYLUT_RUNTIME_VIEW_H
#define STYLUT_RUNTIME_VIEW_H

#include <stdbool.h>

#include "stylut/runtime.h"

/* Byte by byte, so that neither the host's byte order nor the alignment of a
 * blob matters. */
static inline uint32_t read_u16(const unsigned char *p) { return (uint32_t)p[0] | (uint32_t)p[1] << 8; }

static inline uint32_t read_u32(const unsigned char *p) { return read_u16(p) | read_u16(p + 2) << 16; }

static inline uint64_t read_u64(const unsigned char *p) {
  return (uint64_t)read_u32(p) | (uint64_t)read_u32(p + 4) << 32;
}

static inline const unsigned char *get_layer(const StyTexture *texture, size_t layer) {
  return texture->texels + layer * texture->width * texture->height * texture->texel_size;
}

static inline int count_styles(const StyBundle *bundle) { return (int)bundle->textures[STY_BUNDLE_PARAMS].width; }

/* ---- a style ---- */

/* One style of a bundle, its fractions as the integers that decide. Width and height are those of exemplar and guide.
 */
typedef struct Source {
  StyStyle style;
  uint8_t number; /* as matches name it: the style's less 1 */
  int width, height, lut_side;
  const unsigned char *exemplars, *guide, *lut; /* exemplars: the first layer */
  size_t layer_size;                            /* of exemplars, bytes */
  const unsigned char *jitter;                  /* the table in use */
  int jitter_table, jitter_amount;              /* its layer; 255ths */
  int threshold, luma_weight;                   /* of 256ths of a byte; 256ths */
  int luma[STY_MAX_LIGHTINGS];                  /* bytes */
  int colour_weight;                            /* 256ths */
  int spread;                                   /* log2 of pixels of the frame per source pixel: -2..2 */
} Source;

static inline int round_to(float value, float unit) { return (int)(value * unit + 0.5f); }

static inline StyRuntimeStatus open_source(const StyBundle *bundle, int style, int number, int resolution,
                                           Source *out) {
  const StyRuntimeStatus status = sty_get_style(bundle, style, &out->style);
  if (status != STY_RUNTIME_OK) return status;
  const StyTexture *textures = bundle->textures, *tables = &textures[STY_BUNDLE_JITTER];
  const StyStyle *values = &out->style;
  out->number = (uint8_t)(style - 1);
  out->width = (int)textures[STY_BUNDLE_GUIDES].width;
  out->height = (int)textures[STY_BUNDLE_GUIDES].height;
  out->lut_side = (int)textures[STY_BUNDLE_LUTS].width;
  out->exemplars = get_layer(&textures[STY_BUNDLE_EXEMPLARS], (size_t)values->layer);
  out->layer_size = (size_t)out->width * (size_t)out->height * 4;
  out->guide = get_layer(&textures[STY_BUNDLE_GUIDES], (size_t)style - 1);
  out->lut = get_layer(&textures[STY_BUNDLE_LUTS], (size_t)style - 1);
  out->jitter_table = values->jitter_period ? (int)((uint32_t)(number / values->jitter_period) % tables->layers) : 0;
  out->jitter = get_layer(tables, (size_t)out->jitter_table);
  out->jitter_amount = round_to(values->jitter_amount, 255);
  out->threshold = 256 * values->threshold;
  out->luma_weight = round_to(values->luma_weight, 256);
  out->colour_weight = round_to(values->colour_weight, 256);
  for (int i = 0; i < STY_MAX_LIGHTINGS; i++) out->luma[i] = round_to(values->luma[i], 255);
  out->spread = resolution + (values->scale == 2) - (values->scale == 0.5f);
  return STY_RUNTIME_OK;
}

/* The guide texel at a source pixel, or NULL outside the source or its mask. */
static inline const unsigned char *find_source_texel(const Source *source, int x, int y) {
  if (x < 0 || y < 0 || x >= source->width || y >= source->height) return NULL;
  const unsigned char *texel = source->guide + ((size_t)y * (size_t)source->width + (size_t)x) * 4;
  return texel[3] > 0 ? texel : NULL;
}

static inline const unsigned char *get_exemplar(const Source *source, int layer, int x, int y) {
  return source->exemplars + (size_t)layer * source->layer_size + ((size_t)y * (size_t)source->width + (size_t)x) * 4;
}

/* floor(value / 2^shift), whatever the sign. */
static inline int shift_down(int value, int shift) { return (value - (value & ((1 << shift) - 1))) / (1 << shift); }

/* A distance in the frame, in source pixels. */
static inline int to_source(const Source *source, int distance) {
  return source->spread > 0 ? shift_down(distance, source->spread) : distance * (1 << -source->spread);
}

/* ---- a frame ---- */

typedef struct Point {
  int x, y;
} Point;

static inline bool contains_pixel(const StyFrame *frame, int x, int y) {
  return x >= 0 && y >= 0 && x < frame->width && y < frame->height;
}

static inline size_t get_pixel_index(const StyFrame *frame, int x, int y) {
  return (size_t)y * (size_t)frame->width + (size_t)x;
}

/* The style that a pixel is drawn in; 0 where nothing is stylized. */
static inline int get_pixel_style(const StyBundle *bundle, const StyFrame *frame, size_t index) {
  if (frame->guide[index * 4 + 3] == 0) return 0;
  int style = frame->styles ? frame->styles[index] : frame->style;
  return style <= count_styles(bundle) ? style : 0;
}

static inline int get_object(const StyFrame *frame, size_t index) { return frame->objects ? frame->objects[index] : 0; }

/* Where the seed grid of a pixel begins. */
static inline Point get_anchor(const StyFrame *frame, size_t index) {
  const int object = get_object(frame, index);
  if (!frame->anchors || object >= frame->anchor_count) return (Point){0, 0};
  return (Point){frame->anchors[2 * object], frame->anchors[2 * object + 1]};
}

static inline bool is_rect_inside(StyRect rect, int width, int height) {
  return rect.x0 >= 0 && rect.y0 >= 0 && rect.x0 <= rect.x1 && rect.y0 <= rect.y1 && rect.x1 <= width &&
         rect.y1 <= height;
}

static inline bool is_size_valid(int width, int height) {
  return width >= 1 && height >= 1 && width <= STY_MAX_FRAME_SIDE && height <= STY_MAX_FRAME_SIDE;
}

static inline bool is_frame_valid(const StyBundle *bundle, const StyFrame *frame, StyRect rect) {
  if (!bundle || !frame || !frame->guide || !is_size_valid(frame->width, frame->height)) return false;
  if (!is_rect_inside(rect, frame->width, frame->height) || frame->resolution < -1 || frame->resolution > 1)
    return false;
  if (frame->number < 0 || frame->anchor_count < 0 || frame->seeds_count < 0 || !sty_has_path(frame->path))
    return false;
  for (int i = 0; frame->anchors && i < 2 * frame->anchor_count; i++)
    if (frame->anchors[i] < -STY_MAX_ANCHOR || frame->anchors[i] > STY_MAX_ANCHOR) return false;
  return frame->styles || (frame->style >= 1 && frame->style <= count_styles(bundle));
}

/* Calls a pass for the pixels of a rectangle with the source of each pixel's style, opened once as long as the style
 * stays; NULL where nothing is stylized. */
typedef struct Pixel {
  int x, y;
  size_t index;
  const Source *source;
} Pixel;
typedef void VisitPixel(void *context, const Pixel *pixel);

StyRuntimeStatus sty_visit_pixels(const StyBundle *bundle, const StyFrame *frame, StyRect rect, VisitPixel *visit,
                                  void *context);

static const StyMatch no_match = {STY_NO_SOURCE, STY_NO_SOURCE, STY_LEVEL_NONE, 0, 0, 0};

#endif
