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

/* One style of a bundle. Width and height are those of exemplar and guide. */
typedef struct Source {
  StyStyle style;
  int width, height, lut_side;
  const unsigned char *exemplar, *guide, *lut;
} Source;

static inline StyRuntimeStatus open_source(const StyBundle *bundle, int style, Source *out) {
  StyRuntimeStatus status = sty_get_style(bundle, style, &out->style);
  if (status != STY_RUNTIME_OK) return status;
  const StyTexture *textures = bundle->textures;
  out->width = (int)textures[STY_BUNDLE_GUIDES].width;
  out->height = (int)textures[STY_BUNDLE_GUIDES].height;
  out->lut_side = (int)textures[STY_BUNDLE_LUTS].width;
  out->exemplar = get_layer(&textures[STY_BUNDLE_EXEMPLARS], (size_t)out->style.layer);
  out->guide = get_layer(&textures[STY_BUNDLE_GUIDES], (size_t)style - 1);
  out->lut = get_layer(&textures[STY_BUNDLE_LUTS], (size_t)style - 1);
  return STY_RUNTIME_OK;
}

/* The guide texel at a source pixel, or NULL outside the source or its mask. */
static inline const unsigned char *find_source_texel(const Source *source, int x, int y) {
  if (x < 0 || y < 0 || x >= source->width || y >= source->height) return NULL;
  const unsigned char *texel = source->guide + ((size_t)y * (size_t)source->width + (size_t)x) * 4;
  return texel[3] > 0 ? texel : NULL;
}

static inline int count_styles(const StyBundle *bundle) { return (int)bundle->textures[STY_BUNDLE_PARAMS].width; }

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

static inline bool is_frame_valid(const StyBundle *bundle, const StyFrame *frame, StyRect rect) {
  if (!bundle || !frame || !frame->guide) return false;
  if (frame->width < 1 || frame->height < 1 || frame->width > STY_MAX_FRAME_SIDE || frame->height > STY_MAX_FRAME_SIDE)
    return false;
  if (rect.x0 < 0 || rect.y0 < 0 || rect.x0 > rect.x1 || rect.y0 > rect.y1) return false;
  if (rect.x1 > frame->width || rect.y1 > frame->height || frame->jitter_frame < 0) return false;
  return frame->styles || (frame->style >= 1 && frame->style <= count_styles(bundle));
}

#endif
