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

typedef struct Tiles {
  int width, height;
  PassRect *pass;
  void *context;
} Tiles;

static StyStatus pass_tile(void *context, long i, StyError *error) {
  const Tiles *tiles = context;
  const int across = (tiles->width + TILE - 1) / TILE, x = (int)(i % across) * TILE, y = (int)(i / across) * TILE;
  const StyRect rect = {x, y, x + TILE < tiles->width ? x + TILE : tiles->width,
                        y + TILE < tiles->height ? y + TILE : tiles->height};
  const StyRuntimeStatus status = tiles->pass(tiles->context, rect);
  return status ? sty_fail(error, STY_ERROR_LIBRARY, "runtime: %s", sty_describe_runtime_status(status)) : STY_OK;
}

StyStatus pass_rects(int width, int height, PassRect *pass, void *context, const StyRun *run, StyError *error) {
  Tiles tiles = {width, height, pass, context};
  const long count = (long)((width + TILE - 1) / TILE) * ((height + TILE - 1) / TILE);
  return sty_parallel_for(run, count, pass_tile, &tiles, error);
}

static StyRuntimeStatus transfer_rect(void *context, StyRect rect) {
  const Pass *pass = context;
  return sty_transfer_frame(pass->bundle, pass->frame, rect, pass->found);
}

static StyRuntimeStatus blend_rect(void *context, StyRect rect) {
  const Pass *pass = context;
  return sty_blend_frame(pass->bundle, pass->frame, rect, pass->matches, pass->bits, pass->picture);
}

StyStatus transfer_frame(const StyBundle *bundle, const StyFrame *frame, StyMatch *matches, const StyRun *run,
                         StyError *error) {
  Pass pass = {.bundle = bundle, .frame = frame, .found = matches};
  return pass_rects(frame->width, frame->height, transfer_rect, &pass, run, error);
}

StyStatus blend_frame(const StyBundle *bundle, const StyFrame *frame, const StyMatch *matches, int bits, void *picture,
                      const StyRun *run, StyError *error) {
  Pass pass = {.bundle = bundle, .frame = frame, .matches = matches, .bits = bits, .picture = picture};
  return pass_rects(frame->width, frame->height, blend_rect, &pass, run, error);
}
