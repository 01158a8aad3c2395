#include "view.h"

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
