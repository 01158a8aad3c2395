#include "view.h"

/* Where a coordinate g in [-1,1] falls along a LUT's side. Called with gx for
 * the column and with -gy for the row, since rows count from the top. */
static int address_fine(float g, int side, unsigned flags) {
  if (g != g) g = 0;
  g = g < -1 ? -1 : g > 1 ? 1 : g;
  float unit = g * 0.5f + 0.5f;
  /* Rounded to half cells in one operation each, so that no processor can fuse a second one into it. */
  int cells = flags & STY_FLAG_UNORM8 ? ((int)(unit * (float)(2 * (side - 1))) + 1) / 2 : (int)(unit * (float)side);
  return cells < side ? cells : side - 1;
}

/* The same for a byte that stands for g = (2b-255)/255. 255 is odd, so rounding
 * never meets a tie and 255 - b may stand in for -g. */
static int address_byte(int b, int side, unsigned flags) {
  int cells = flags & STY_FLAG_UNORM8 ? (2 * b * (side - 1) + 255) / 510 : b * side / 255;
  return cells < side ? cells : side - 1;
}

static int decode_coordinate(uint32_t value, int side) {
  int coordinate = (int)(value * (uint32_t)side / 65535);
  return coordinate < side ? coordinate : side - 1;
}

Point sty_look_up(const Source *source, const StyFrame *frame, size_t index) {
  int side = source->lut_side, column, row;
  unsigned flags = source->style.flags;
  if (frame->fine) {
    column = address_fine(frame->fine[index * 2], side, flags);
    row = address_fine(-frame->fine[index * 2 + 1], side, flags);
  } else {
    column = address_byte(frame->guide[index * 4], side, flags);
    row = address_byte(255 - frame->guide[index * 4 + 1], side, flags);
  }
  const unsigned char *texel = source->lut + ((size_t)row * (size_t)side + (size_t)column) * 4;
  return (Point){decode_coordinate(read_u16(texel), source->width),
                 decode_coordinate(read_u16(texel + 2), source->height)};
}

static int get_difference(int a, int b) { return a > b ? a - b : b - a; }

int sty_choose_lighting(const Source *source, const StyFrame *frame, size_t index) {
  int chosen = 0;
  for (int i = 1; frame->luma && i < source->style.layer_count; i++)
    if (get_difference(frame->luma[index], source->luma[i]) < get_difference(frame->luma[index], source->luma[chosen]))
      chosen = i;
  return chosen;
}

bool sty_accepts(const Source *source, const StyFrame *frame, size_t index, Point candidate, int lighting) {
  const unsigned char *there = find_source_texel(source, candidate.x, candidate.y), *here = frame->guide + index * 4;
  if (!there) return false;
  int error = 0;
  for (int channel = 0; channel < 3; channel++) error += 256 * get_difference(here[channel], there[channel]);
  if (frame->luma) error += source->luma_weight * get_difference(frame->luma[index], source->luma[lighting]);
  return error < source->threshold;
}

StyMatch sty_fall_back(const Source *source, const StyFrame *frame, size_t index) {
  const Point own = sty_look_up(source, frame, index);
  return (StyMatch){.x = (uint16_t)own.x,
                    .y = (uint16_t)own.y,
                    .level = STY_LEVEL_FALLBACK,
                    .layer = (uint8_t)sty_choose_lighting(source, frame, index),
                    .style = source->number};
}

StyRuntimeStatus sty_visit_pixels(const StyBundle *bundle, const StyFrame *frame, StyRect rect, VisitPixel *visit,
                                  void *context) {
  Source source;
  int opened = 0;
  for (int y = rect.y0; y < rect.y1; y++)
    for (int x = rect.x0; x < rect.x1; x++) {
      const size_t index = get_pixel_index(frame, x, y);
      const int style = get_pixel_style(bundle, frame, index);
      if (style != 0 && style != opened) {
        const StyRuntimeStatus status = open_source(bundle, style, frame->number, frame->resolution, &source);
        if (status != STY_RUNTIME_OK) return status;
        opened = style;
      }
      visit(context, &(Pixel){x, y, index, style ? &source : NULL});
    }
  return STY_RUNTIME_OK;
}
