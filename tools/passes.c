#include "passes.h"

/* Frames are worked on in squares of so many pixels a side. */
enum { TILE = 64 };

typedef struct Pass {
  const StyBundle *bundle;
  const StyFrame *frame;
  const StyMatch *matches; /* of blend */
  StyMatch *found;         /* of transfer */
  int bits;
  void *picture;
} Pass;

static long count_tiles(const StyFrame *frame) {
  return (long)((frame->width + TILE - 1) / TILE) * ((frame->height + TILE - 1) / TILE);
}

static StyRect get_tile(const StyFrame *frame, long i) {
  const int across = (frame->width + TILE - 1) / TILE;
  const int x = (int)(i % across) * TILE, y = (int)(i / across) * TILE;
  return (StyRect){x, y, x + TILE < frame->width ? x + TILE : frame->width,
                   y + TILE < frame->height ? y + TILE : frame->height};
}

static StyStatus explain(StyRuntimeStatus status, StyError *error) {
  return status ? sty_fail(error, STY_ERROR_LIBRARY, "runtime: %s", sty_describe_runtime_status(status)) : STY_OK;
}

static StyStatus transfer_tile(void *context, long i, StyError *error) {
  const Pass *pass = context;
  return explain(sty_transfer_frame(pass->bundle, pass->frame, get_tile(pass->frame, i), pass->found), error);
}

static StyStatus blend_tile(void *context, long i, StyError *error) {
  const Pass *pass = context;
  return explain(
      sty_blend_frame(pass->bundle, pass->frame, get_tile(pass->frame, i), pass->matches, pass->bits, pass->picture),
      error);
}

StyStatus transfer_frame(const StyBundle *bundle, const StyFrame *frame, StyMatch *matches, const StyRun *run,
                         StyError *error) {
  Pass pass = {.bundle = bundle, .frame = frame, .found = matches};
  return sty_parallel_for(run, count_tiles(frame), transfer_tile, &pass, error);
}

StyStatus blend_frame(const StyBundle *bundle, const StyFrame *frame, const StyMatch *matches, int bits, void *picture,
                      const StyRun *run, StyError *error) {
  Pass pass = {.bundle = bundle, .frame = frame, .matches = matches, .bits = bits, .picture = picture};
  return sty_parallel_for(run, count_tiles(frame), blend_tile, &pass, error);
}
