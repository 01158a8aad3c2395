#include "matching.h"

typedef struct LookUp {
  const StyFrame *frame;
  StyMatch *matches;
} LookUp;

static void look_up_pixel(void *context, const Pixel *pixel) {
  const LookUp *look_up = context;
  look_up->matches[pixel->index] = pixel->source ? fall_back(pixel->source, look_up->frame, pixel->index) : no_match;
}

StyRuntimeStatus sty_look_up_frame(const StyBundle *bundle, const StyFrame *frame, StyRect rect, StyMatch *matches) {
  if (!matches || !is_frame_valid(bundle, frame, rect)) return STY_RUNTIME_BAD_ARGUMENT;
  return sty_visit_pixels(bundle, frame, rect, look_up_pixel, &(LookUp){frame, matches});
}
