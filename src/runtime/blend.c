#include "view.h"

/* The votes for one pixel. 17 * 17 votes of 255 * 255 fit 32 bits. */
typedef struct Tally {
  uint32_t colour[3]; /* times the exemplar's alpha */
  uint32_t alpha;
  uint32_t votes;
} Tally;

static void add_vote(Tally *tally, const Source *source, int x, int y) {
  const unsigned char *texel = source->exemplar + ((size_t)y * (size_t)source->width + (size_t)x) * 4;
  for (int channel = 0; channel < 3; channel++) tally->colour[channel] += (uint32_t)texel[channel] * texel[3];
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

static Tally count_votes(const StyBundle *bundle, const Source *source, const StyFrame *frame, const StyMatch *matches,
                         int x, int y) {
  Tally tally = {{0, 0, 0}, 0, 0};
  size_t index = get_pixel_index(frame, x, y);
  int style = get_pixel_style(bundle, frame, index), radius = source->style.radius;
  int y_end = y + radius < frame->height ? y + radius : frame->height - 1;
  int x_end = x + radius < frame->width ? x + radius : frame->width - 1;
  for (int ny = y > radius ? y - radius : 0; ny <= y_end; ny++)
    for (int nx = x > radius ? x - radius : 0; nx <= x_end; nx++) {
      size_t neighbour = get_pixel_index(frame, nx, ny);
      if (get_pixel_style(bundle, frame, neighbour) != style || !is_depth_near(source, frame, index, neighbour))
        continue;
      int source_x = matches[neighbour].x - (nx - x), source_y = matches[neighbour].y - (ny - y);
      if (find_source_texel(source, source_x, source_y)) add_vote(&tally, source, source_x, source_y);
    }
  /* A fallback may rest on a masked source pixel; better its colour than a hole. */
  if (tally.votes == 0 && matches[index].x < source->width && matches[index].y < source->height)
    add_vote(&tally, source, matches[index].x, matches[index].y);
  return tally;
}

static uint16_t divide_rounded(uint64_t dividend, uint64_t divisor) {
  return divisor ? (uint16_t)((dividend + divisor / 2) / divisor) : 0;
}

/* Both depths round the same fraction once: scale is 1 or 257 = 65535/255. */
static void resolve_votes(const Tally *tally, uint32_t coverage, uint32_t scale, uint16_t out[4]) {
  for (int channel = 0; channel < 3; channel++)
    out[channel] = divide_rounded((uint64_t)tally->colour[channel] * scale, tally->alpha);
  out[3] = divide_rounded((uint64_t)tally->alpha * coverage * scale, (uint64_t)tally->votes * 255);
}

StyRuntimeStatus sty_blend_frame(const StyBundle *bundle, const StyFrame *frame, StyRect rect, const StyMatch *matches,
                                 int bits, void *out) {
  if (!matches || !out || (bits != 8 && bits != 16) || !is_frame_valid(bundle, frame, rect))
    return STY_RUNTIME_BAD_ARGUMENT;

  uint32_t scale = bits == 8 ? 1 : 257;
  Source source;
  int opened = 0;
  for (int y = rect.y0; y < rect.y1; y++)
    for (int x = rect.x0; x < rect.x1; x++) {
      size_t index = get_pixel_index(frame, x, y);
      uint16_t pixel[4] = {0, 0, 0, 0};
      int style = get_pixel_style(bundle, frame, index);
      if (style != 0) {
        if (style != opened) {
          StyRuntimeStatus status = open_source(bundle, style, &source);
          if (status != STY_RUNTIME_OK) return status;
          opened = style;
        }
        Tally tally = count_votes(bundle, &source, frame, matches, x, y);
        resolve_votes(&tally, frame->guide[index * 4 + 3], scale, pixel);
      }
      for (int channel = 0; channel < 4; channel++)
        if (bits == 8)
          ((uint8_t *)out)[index * 4 + (size_t)channel] = (uint8_t)pixel[channel];
        else
          ((uint16_t *)out)[index * 4 + (size_t)channel] = pixel[channel];
    }
  return STY_RUNTIME_OK;
}
