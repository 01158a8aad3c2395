#include "blend.h"

#include "runs.h"

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
      if (find_source_texel(source, source_x, source_y)) add_votes(&tally, source, match->layer, source_x, source_y, 1);
    }
  /* A fallback may rest on a masked source pixel; better its colour than a hole. */
  const StyMatch *own = &blend->matches[pixel->index];
  if (tally.votes == 0 && own->x < source->width && own->y < source->height && own->layer < source->style.layer_count)
    add_votes(&tally, source, own->layer, own->x, own->y, 1);
  return tally;
}

void sty_blend_pixel(void *context, const Pixel *pixel) {
  const Blend *blend = context;
  uint16_t colour[4] = {0, 0, 0, 0};
  if (pixel->source) {
    const Tally tally = count_votes(blend, pixel);
    resolve_votes(blend, pixel, &tally, colour);
  }
  write_pixel(blend, pixel->index, colour);
}

StyRuntimeStatus sty_blend_frame(const StyBundle *bundle, const StyFrame *frame, StyRect rect, const StyMatch *matches,
                                 int bits, void *out) {
  if (!matches || !out || (bits != 8 && bits != 16) || !is_frame_valid(bundle, frame, rect))
    return STY_RUNTIME_BAD_ARGUMENT;
  Blend blend = {bundle, frame, matches, bits, out};
  switch (sty_choose_path(frame->path)) {
    case STY_PATH_PORTABLE: return sty_blend_portable(&blend, rect);
    case STY_PATH_AVX2: return sty_blend_avx2(&blend, rect);
    case STY_PATH_AVX512: return sty_blend_avx512(&blend, rect);
    default: return sty_visit_pixels(bundle, frame, rect, sty_blend_pixel, &blend);
  }
}
