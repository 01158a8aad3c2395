#include "matching.h"
#include "runs.h"

static StyMatch match_pixel(const Source *source, const StyFrame *frame, const Pixel *pixel) {
  const Point anchor = get_anchor(frame, pixel->index);
  for (int level = source->style.top_level; level >= 0; level--) {
    const Point in_grid =
        find_seed(source->jitter, source->jitter_amount, (Point){pixel->x - anchor.x, pixel->y - anchor.y}, level);
    const Point seed = {in_grid.x + anchor.x, in_grid.y + anchor.y};
    const Proposal proposal = propose(source, frame, seed, in_grid, level);
    if (!proposal.is_made || (frame->anchors && proposal.object != get_object(frame, pixel->index))) continue;
    const Point candidate = {proposal.found.x + to_source(source, pixel->x - seed.x),
                             proposal.found.y + to_source(source, pixel->y - seed.y)};
    if (accepts(source, frame, pixel->index, proposal.tilt, candidate, proposal.lighting))
      return (StyMatch){.x = (uint16_t)candidate.x,
                        .y = (uint16_t)candidate.y,
                        .level = (uint8_t)level,
                        .layer = (uint8_t)proposal.lighting,
                        .style = source->number};
  }
  return fall_back(source, frame, pixel->index);
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
  switch (sty_choose_path(frame->path)) {
    case STY_PATH_PORTABLE: return sty_transfer_portable(bundle, frame, rect, matches);
    case STY_PATH_AVX2: return sty_transfer_avx2(bundle, frame, rect, matches);
    case STY_PATH_AVX512: return sty_transfer_avx512(bundle, frame, rect, matches);
    default: return sty_visit_pixels(bundle, frame, rect, transfer_pixel, &(Transfer){frame, matches});
  }
}
