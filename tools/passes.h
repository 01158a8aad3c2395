/* The runtime's passes over a whole frame, on all threads of a run. */
#ifndef STYLUT_TOOLS_PASSES_H
#define STYLUT_TOOLS_PASSES_H

#include "stylut/parallel.h"
#include "stylut/runtime.h"

/* As sty_transfer_frame and sty_blend_frame for one rectangle (see runtime.h). */
StyStatus transfer_frame(const StyBundle *bundle, const StyFrame *frame, StyMatch *matches, const StyRun *run,
                         StyError *error);
StyStatus blend_frame(const StyBundle *bundle, const StyFrame *frame, const StyMatch *matches, int bits, void *picture,
                      const StyRun *run, StyError *error);

/* Calls pass(context, rect) for rectangles that make up a frame of this size. */
typedef StyRuntimeStatus PassRect(void *context, StyRect rect);
StyStatus pass_rects(int width, int height, PassRect *pass, void *context, const StyRun *run, StyError *error);

/* The path that STYLUT_VECTOR names (plain, avx2, avx512), where there is one; else the best. */
StyRuntimePath get_asked_path(void);

#endif
