#include "matching.h"

typedef struct Brute {
  const StyBundle *bundle;
  const StyFrame *frame;
  StyMatch *matches;
} Brute;

/* Copies what fits of the source, u* laid on p, onto what is still empty. */
static void copy_chunk(const Brute *brute, const Source *source, const Pixel *p) {
  const StyFrame *frame = brute->frame;
  const Point star = look_up(source, frame, p->index);
  const int lighting = choose_lighting(source, frame, p->index);
  for (int source_y = 0; source_y < source->height; source_y++)
    for (int source_x = 0; source_x < source->width; source_x++) {
      const int x = p->x + source_x - star.x, y = p->y + source_y - star.y;
      if (!contains_pixel(frame, x, y)) continue;
      const size_t index = get_pixel_index(frame, x, y);
      StyMatch *match = &brute->matches[index];
      if (match->level == STY_LEVEL_NONE && get_pixel_style(brute->bundle, frame, index) == source->number + 1 &&
          accepts(source, frame, index, (Tilt){{0}}, (Point){source_x, source_y}, lighting))
        *match = (StyMatch){
            .x = (uint16_t)source_x, .y = (uint16_t)source_y, .layer = (uint8_t)lighting, .style = source->number};
    }
}

static void empty_pixel(void *context, const Pixel *pixel) {
  ((const Brute *)context)->matches[pixel->index] = no_match;
}

static void fill_pixel(void *context, const Pixel *pixel) {
  const Brute *brute = context;
  StyMatch *match = &brute->matches[pixel->index];
  if (!pixel->source || match->level != STY_LEVEL_NONE) return;
  copy_chunk(brute, pixel->source, pixel);
  if (match->level == STY_LEVEL_NONE) *match = fall_back(pixel->source, brute->frame, pixel->index);
}

StyRuntimeStatus sty_transfer_brute(const StyBundle *bundle, const StyFrame *frame, StyMatch *matches) {
  if (!frame || !matches) return STY_RUNTIME_BAD_ARGUMENT;
  const StyRect all = {0, 0, frame->width, frame->height};
  if (!is_frame_valid(bundle, frame, all) || frame->resolution != 0) return STY_RUNTIME_BAD_ARGUMENT;
  Brute brute = {bundle, frame, matches};
  const StyRuntimeStatus status = sty_visit_pixels(bundle, frame, all, empty_pixel, &brute);
  return status ? status : sty_visit_pixels(bundle, frame, all, fill_pixel, &brute);
}
