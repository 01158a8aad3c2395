#include "view.h"

static bool looks_alike(const StyFrame *frame, size_t index, int x, int y) {
  if (!contains_pixel(frame, x, y)) return true;
  const size_t other = get_pixel_index(frame, x, y);
  if (frame->anchors && get_object(frame, index) != get_object(frame, other)) return false;
  const unsigned char *a = frame->guide + index * 4, *b = frame->guide + other * 4;
  int difference = 0;
  for (int channel = 0; channel < 3; channel++)
    difference += a[channel] > b[channel] ? a[channel] - b[channel] : b[channel] - a[channel];
  return b[3] > 0 && difference <= STY_FLAT_DIFFERENCE;
}

/* On flat surfaces all seeds of a level would copy the same patch: each takes it from elsewhere. */
static Point scatter(const Source *source, const StyFrame *frame, Point seed, Point in_grid, int level, Point found) {
  const int reach = 2 * source->style.scatter + 1, step = (1 << level) / 2;
  const size_t index = get_pixel_index(frame, seed.x, seed.y);
  if (source->style.scatter == 0 || level < STY_SCATTER_LEVEL || !looks_alike(frame, index, seed.x - step, seed.y) ||
      !looks_alike(frame, index, seed.x + step, seed.y) || !looks_alike(frame, index, seed.x, seed.y - step) ||
      !looks_alike(frame, index, seed.x, seed.y + step))
    return found;
  const size_t column = (unsigned)(in_grid.x + 128) % STY_JITTER_SIZE,
               row = (unsigned)(in_grid.y + 128) % STY_JITTER_SIZE;
  const unsigned char *j = source->jitter + (row * STY_JITTER_SIZE + column) * 2;
  const Point moved = {found.x + reach * j[0] / 256 - source->style.scatter,
                       found.y + reach * j[1] / 256 - source->style.scatter};
  return find_source_texel(source, moved.x, moved.y) ? moved : found;
}

static StyMatch match_pixel(const Source *source, const StyFrame *frame, const Pixel *pixel) {
  const Point anchor = get_anchor(frame, pixel->index);
  for (int level = source->style.top_level; level >= 0; level--) {
    const Point in_grid =
        sty_find_seed(source->jitter, source->jitter_amount, (Point){pixel->x - anchor.x, pixel->y - anchor.y}, level);
    const Point seed = {in_grid.x + anchor.x, in_grid.y + anchor.y};
    if (!contains_pixel(frame, seed.x, seed.y)) continue;
    const size_t index = get_pixel_index(frame, seed.x, seed.y);
    if (frame->guide[index * 4 + 3] == 0) continue;
    if (frame->anchors && get_object(frame, index) != get_object(frame, pixel->index)) continue;
    const Point found = scatter(source, frame, seed, in_grid, level, sty_look_up(source, frame, index));
    const Point candidate = {found.x + to_source(source, pixel->x - seed.x),
                             found.y + to_source(source, pixel->y - seed.y)};
    const int lighting = sty_choose_lighting(source, frame, index);
    if (sty_accepts(source, frame, pixel->index, candidate, lighting))
      return (StyMatch){.x = (uint16_t)candidate.x,
                        .y = (uint16_t)candidate.y,
                        .level = (uint8_t)level,
                        .layer = (uint8_t)lighting,
                        .style = source->number};
  }
  return sty_fall_back(source, frame, pixel->index);
}

typedef struct Transfer {
  const StyFrame *frame;
  StyMatch *matches;
} Transfer;

static void transfer_pixel(void *context, const Pixel *pixel) {
  const Transfer *transfer = context;
  transfer->matches[pixel->index] = pixel->source ? match_pixel(pixel->source, transfer->frame, pixel) : no_match;
}

StyRuntimeStatus sty_transfer_frame(const StyBundle *bundle, const StyFrame *frame, StyRect rect, StyMatch *matches) {
  if (!matches || !is_frame_valid(bundle, frame, rect)) return STY_RUNTIME_BAD_ARGUMENT;
  return sty_visit_pixels(bundle, frame, rect, transfer_pixel, &(Transfer){frame, matches});
}
