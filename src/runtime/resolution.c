#include "matching.h"
#include "picture.h"

/* ---- half resolution: from matches of half a frame to those of the whole ---- */

typedef struct Expansion {
  const StyFrame *half, *frame;
  const StyMatch *half_matches;
  StyMatch *matches;
} Expansion;

/* Where pieces are moved, so is the half's match. */
static Tilt find_tilt(const Source *source, const StyFrame *half, size_t index, const StyMatch *parent) {
  const unsigned char *there = find_source_texel(source, parent->x, parent->y);
  return source->style.scatter && there ? get_tilt(half->guide + 4 * index, there) : (Tilt){{0}};
}

static void expand_pixel(void *context, const Pixel *pixel) {
  const Expansion *expansion = context;
  StyMatch *match = &expansion->matches[pixel->index];
  *match = no_match;
  if (!pixel->source) return;
  const Source *source = pixel->source;
  const size_t half_index = get_pixel_index(expansion->half, pixel->x / 2, pixel->y / 2);
  const StyMatch *parent = &expansion->half_matches[half_index];
  const Point candidate = {parent->x + to_source(source, pixel->x % 2), parent->y + to_source(source, pixel->y % 2)};
  if (parent->level != STY_LEVEL_NONE && parent->style == source->number && parent->layer < source->style.layer_count &&
      accepts(source, expansion->frame, pixel->index, find_tilt(source, expansion->half, half_index, parent), candidate,
              parent->layer))
    *match = (StyMatch){.x = (uint16_t)candidate.x,
                        .y = (uint16_t)candidate.y,
                        .level = parent->level,
                        .layer = parent->layer,
                        .style = parent->style};
  else
    *match = fall_back(source, expansion->frame, pixel->index);
}

StyRuntimeStatus sty_expand_matches(const StyBundle *bundle, const StyFrame *half, const StyMatch *half_matches,
                                    const StyFrame *frame, StyRect rect, StyMatch *matches) {
  if (!half_matches || !matches || !is_frame_valid(bundle, frame, rect) ||
      !is_frame_valid(bundle, half, (StyRect){0, 0, 0, 0}))
    return STY_RUNTIME_BAD_ARGUMENT;
  if (half->width != (frame->width + 1) / 2 || half->height != (frame->height + 1) / 2 ||
      half->resolution != frame->resolution - 1)
    return STY_RUNTIME_BAD_ARGUMENT;
  return sty_visit_pixels(bundle, frame, rect, expand_pixel, &(Expansion){half, frame, half_matches, matches});
}

/* ---- double resolution: from a picture of twice the size to its own ---- */

StyRuntimeStatus sty_halve_picture(int width, int height, int bits, const void *picture, StyRect rect, void *out) {
  if (!picture || !out || (bits != 8 && bits != 16) || !is_size_valid(width, height) ||
      !is_rect_inside(rect, width, height))
    return STY_RUNTIME_BAD_ARGUMENT;
  for (int y = rect.y0; y < rect.y1; y++)
    for (int x = rect.x0; x < rect.x1; x++) {
      uint64_t colour[3] = {0, 0, 0}, alpha = 0;
      for (int i = 0; i < 4; i++) {
        const size_t from = ((size_t)(2 * y + i / 2) * 2 * (size_t)width + (size_t)(2 * x + i % 2)) * 4;
        const uint64_t weight = read_component(picture, bits, from + 3);
        for (size_t channel = 0; channel < 3; channel++)
          colour[channel] += weight * read_component(picture, bits, from + channel);
        alpha += weight;
      }
      const size_t to = ((size_t)y * (size_t)width + (size_t)x) * 4;
      for (size_t channel = 0; channel < 3; channel++)
        write_component(out, bits, to + channel, alpha ? (colour[channel] + alpha / 2) / alpha : 0);
      write_component(out, bits, to + 3, (alpha + 2) / 4);
    }
  return STY_RUNTIME_OK;
}
