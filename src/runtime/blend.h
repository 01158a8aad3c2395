/* One pixel's votes: the formulas of sty_blend_frame, shared by its forms. */
#ifndef STYLUT_RUNTIME_BLEND_H
#define STYLUT_RUNTIME_BLEND_H

#include "matching.h"

typedef struct Blend {
  const StyBundle *bundle;
  const StyFrame *frame;
  const StyMatch *matches;
  int bits;
  void *out;
} Blend;

/* The votes for one pixel. With bases a vote is a difference. 17 * 17 votes of 255 * 255 fit 31 bits. */
typedef struct Tally {
  int32_t colour[3]; /* times the exemplar's alpha */
  int32_t alpha;
  int32_t votes;
} Tally;

/* `weight` votes for one source pixel. */
static inline void add_votes(Tally *tally, const Source *source, int layer, int x, int y, int weight) {
  const unsigned char *texel = get_exemplar(source, layer, x, y);
  const bool based = source->style.flags & STY_FLAG_BASE;
  const unsigned char *base = based ? get_exemplar(source, layer + source->style.layer_count, x, y) : NULL;
  for (int channel = 0; channel < 3; channel++)
    tally->colour[channel] += (texel[channel] - (base ? base[channel] : 0)) * texel[3] * weight;
  tally->alpha += texel[3] * weight;
  tally->votes += weight;
}

/* Equal depths agree even at infinity; NaN agrees with nothing. */
static inline bool is_depth_near(const Source *source, const StyFrame *frame, size_t a, size_t b) {
  float tolerance = source->style.depth_tolerance;
  if (!frame->depth || tolerance == 0 || a == b) return true;
  float depth_a = frame->depth[a], depth_b = frame->depth[b], difference = depth_a - depth_b;
  return depth_a == depth_b || (difference >= -tolerance && difference <= tolerance);
}

/* Half up. Both are below 2^53 and the quotient below 2^16, so that a division of doubles, which is quicker, can't
 * round up to the next integer. */
static inline uint16_t divide_rounded(int64_t dividend, int64_t divisor) {
  return divisor && dividend > 0 ? (uint16_t)((double)(dividend + divisor / 2) / (double)divisor) : 0;
}

/* What the mean of the votes is added to, per channel. */
static inline void find_base(const Blend *blend, const Pixel *pixel, int base[3]) {
  const Source *source = pixel->source;
  base[0] = base[1] = base[2] = 0;
  if (!(source->style.flags & STY_FLAG_BASE)) return;
  const StyMatch own = fall_back(source, blend->frame, pixel->index);
  const unsigned char *texel = get_exemplar(source, own.layer + source->style.layer_count, own.x, own.y);
  for (int channel = 0; channel < 3; channel++) base[channel] = texel[channel];
}

/* Both depths round the same fraction once: scale is 1 or 257 = 65535/255. */
static inline void resolve_votes(const Blend *blend, const Pixel *pixel, const Tally *tally, uint16_t out[4]) {
  const int64_t scale = blend->bits == 8 ? 1 : 257, whole = 255 * 256;
  const uint8_t *albedo = blend->frame->albedo ? blend->frame->albedo + 4 * pixel->index : NULL;
  const int weight = pixel->source->colour_weight;
  int base[3];
  find_base(blend, pixel, base);
  for (int channel = 0; channel < 3; channel++) {
    int64_t colour = tally->colour[channel] + (int64_t)base[channel] * tally->alpha;
    const int64_t most = (int64_t)255 * tally->alpha;
    colour = colour < 0 ? 0 : colour > most ? most : colour;
    const int64_t factor = albedo ? 255 * (256 - weight) + weight * albedo[channel] : whole;
    out[channel] = divide_rounded(colour * factor * scale, tally->alpha * whole);
  }
  const int coverage = blend->frame->guide[4 * pixel->index + 3];
  out[3] = divide_rounded((int64_t)tally->alpha * coverage * scale, (int64_t)tally->votes * 255);
}

static inline void write_pixel(const Blend *blend, size_t index, const uint16_t colour[4]) {
  for (size_t channel = 0; channel < 4; channel++)
    if (blend->bits == 8)
      ((uint8_t *)blend->out)[index * 4 + channel] = (uint8_t)colour[channel];
    else
      ((uint16_t *)blend->out)[index * 4 + channel] = colour[channel];
}

/* The reference for one pixel. */
void sty_blend_pixel(void *blend, const Pixel *pixel);

#endif
