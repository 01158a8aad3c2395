#include "passes.h"

#include <stdlib.h>
#include <string.h>

/* Frames are worked on in bands of so many rows: runs of pixels are longest there. */
enum { BAND = 32 };

typedef struct Pass {
  const StyBundle *bundle;
  const StyFrame *frame;
  const StyMatch *matches; /* of blend */
  StyMatch *found;         /* of transfer */
  int bits;
  void *picture;
} Pass;

typedef struct Bands {
  int width, height;
  PassRect *pass;
  void *context;
} Bands;

static StyStatus pass_band(void *context, long i, StyError *error) {
  const Bands *bands = context;
  const int y = (int)i * BAND;
  const StyRect rect = {0, y, bands->width, y + BAND < bands->height ? y + BAND : bands->height};
  const StyRuntimeStatus status = bands->pass(bands->context, rect);
  return status ? sty_fail(error, STY_ERROR_LIBRARY, "runtime: %s", sty_describe_runtime_status(status)) : STY_OK;
}

StyStatus pass_rects(int width, int height, PassRect *pass, void *context, const StyRun *run, StyError *error) {
  Bands bands = {width, height, pass, context};
  return sty_parallel_for(run, (height + BAND - 1) / BAND, pass_band, &bands, error);
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

StyRuntimePath get_asked_path(void) {
  static const struct {
    const char *name;
    StyRuntimePath path;
  } units[] = {{"plain", STY_PATH_PORTABLE}, {"avx2", STY_PATH_AVX2}, {"avx512", STY_PATH_AVX512}};
  const char *asked = getenv("STYLUT_VECTOR");
  for (int i = 0; asked && i < 3; i++)
    if (strcmp(asked, units[i].name) == 0 && sty_has_path(units[i].path)) return units[i].path;
  return STY_PATH_BEST;
}
