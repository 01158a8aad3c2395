#include "view.h"

/* The votes for one pixel. With bases a vote is a difference. 17 * 17 votes of 255 * 255 fit 31 bits. */
typedef struct Tally {
  int32_t colour[3]; /* times the exemplar's alpha */
  int32_t alpha;
  int32_t votes;
} Tally;

static void add_vote(Tally *tally, const Source *source, int layer, int x, int y) {
  const unsigned char *texel = get_exemplar(source, layer, x, y);
  const bool based = source->style.flags & STY_FLAG_BASE;
  const unsigned char *base = based ? get_exemplar(source, layer + source->style.layer_count, x, y) : NULL;
  for (int channel = 0; channel < 3; channel++)
    tally->colour[channel] += (texel[channel] - (base ? base[channel] : 0)) * texel[3];
  tally->alpha += texel[3];
  tally->votes++;
}

/* Equal depths agree even at infinity; NaN agrees with nothing. */
static bool is_depth_near(const Source *source, const StyFrame *frame, size_t a, size_t b) {
  float tolerance = source->style.depth_tolerance;
  if (!frame->depth || tolerance == 0 || a == b) return true;
  float depth_a = frame->depth[a], depth_b = frame->depth[b], difference = depth_a - depth_b;
  return depth_a == depth_b || (difference >= -tolerance && difference <= tolerance);
}

typedef struct Blend {
  const StyBundle *bundle;
  const StyFrame *frame;
  const StyMatch *matches;
  int bits;
  void *out;
} Blend;

/* Whether a neighbour may vote for a pixel. */
static bool may_vote(const Blend *blend, const Pixel *pixel, size_t neighbour) {
  const StyFrame *frame = blend->frame;
  const Source *source = pixel->source;
  return get_pixel_style(blend->bundle, frame, neighbour) == source->number + 1 &&
         blend->matches[neighbour].layer < source->style.layer_count &&
         is_depth_near(source, frame, pixel->index, neighbour) &&
         (!(source->style.flags & STY_FLAG_OBJECTS) || get_object(frame, pixel->index) == get_object(frame, neighbour));
}

static Tally count_votes(const Blend *blend, const Pixel *pixel) {
  Tally tally = {{0, 0, 0}, 0, 0};
  const Source *source = pixel->source;
  const StyFrame *frame = blend->frame;
  const int x = pixel->x, y = pixel->y, radius = source->style.radius;
  int y_end = y + radius < frame->height ? y + radius : frame->height - 1;
  int x_end = x + radius < frame->width ? x + radius : frame->width - 1;
  for (int ny = y > radius ? y - radius : 0; ny <= y_end; ny++)
    for (int nx = x > radius ? x - radius : 0; nx <= x_end; nx++) {
      const size_t neighbour = get_pixel_index(frame, nx, ny);
      if (!may_vote(blend, pixel, neighbour)) continue;
      const StyMatch *match = &blend->matches[neighbour];
      const int source_x = match->x - to_source(source, nx - x), source_y = match->y - to_source(source, ny - y);
      if (find_source_texel(source, source_x, source_y)) add_vote(&tally, source, match->layer, source_x, source_y);
    }
  /* A fallback may rest on a masked source pixel; better its colour than a hole. */
  const StyMatch *own = &blend->matches[pixel->index];
  if (tally.votes == 0 && own->x < source->width && own->y < source->height && own->layer < source->style.layer_count)
    add_vote(&tally, source, own->layer, own->x, own->y);
  return tally;
}

static uint16_t divide_rounded(int64_t dividend, int64_t divisor) {
  return divisor && dividend > 0 ? (uint16_t)((dividend + divisor / 2) / divisor) : 0;
}

/* What the mean of the votes is added to, per channel. */
static void find_base(const Blend *blend, const Pixel *pixel, int base[3]) {
  const Source *source = pixel->source;
  base[0] = base[1] = base[2] = 0;
  if (!(source->style.flags & STY_FLAG_BASE)) return;
  const StyMatch own = sty_fall_back(source, blend->frame, pixel->index);
  const unsigned char *texel = get_exemplar(source, own.layer + source->style.layer_count, own.x, own.y);
  for (int channel = 0; channel < 3; channel++) base[channel] = texel[channel];
}

/* Both depths round the same fraction once: scale is 1 or 257 = 65535/255. */
static void resolve_votes(const Blend *blend, const Pixel *pixel, const Tally *tally, uint16_t out[4]) {
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

static void blend_pixel(void *context, const Pixel *pixel) {
  const Blend *blend = context;
  uint16_t colour[4] = {0, 0, 0, 0};
  if (pixel->source) {
    const Tally tally = count_votes(blend, pixel);
    resolve_votes(blend, pixel, &tally, colour);
  }
  for (size_t channel = 0; channel < 4; channel++)
    if (blend->bits == 8)
      ((uint8_t *)blend->out)[pixel->index * 4 + channel] = (uint8_t)colour[channel];
    else
      ((uint16_t *)blend->out)[pixel->index * 4 + channel] = colour[channel];
}

StyRuntimeStatus sty_blend_frame(const StyBundle *bundle, const StyFrame *frame, StyRect rect, const StyMatch *matches,
                                 int bits, void *out) {
  if (!matches || !out || (bits != 8 && bits != 16) || !is_frame_valid(bundle, frame, rect))
    return STY_RUNTIME_BAD_ARGUMENT;
  return sty_visit_pixels(bundle, frame, rect, blend_pixel, &(Blend){bundle, frame, matches, bits, out});
}
