/* A guide image as the frame that the runtime reads. */
#ifndef STYLUT_TOOLS_FRAMES_H
#define STYLUT_TOOLS_FRAMES_H

#include "stylut/image.h"
#include "stylut/runtime.h"

/* `frame` points into the buffers that stand beside it. */
typedef struct FilledFrame {
  StyFrame frame;
  uint8_t *guide, *styles;
  float *fine, *depth;
} FilledFrame;

/* Fills all that the guide has channels for. `style` is the frame's; 0: each pixel's is that of style.I. Whatever the
 * outcome, free what it holds with free_frame. */
StyStatus fill_frame(const StyImage *guide, int style, FilledFrame *out, StyError *error);
void free_frame(FilledFrame *filled);

#endif
