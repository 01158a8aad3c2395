/* A guide image as the frame that the runtime reads, and the runtime's picture as a file. */
#ifndef STYLUT_TOOLS_FRAMES_H
#define STYLUT_TOOLS_FRAMES_H

#include "options.h"
#include "stylut/image.h"
#include "stylut/runtime.h"

/* `frame` points into the buffers that stand beside it. */
typedef struct FilledFrame {
  StyFrame frame;
  uint8_t *guide, *styles, *luma, *albedo;
  uint16_t *objects;
  float *fine, *depth;
  size_t foreign_styles, foreign_objects; /* covered pixels whose ids are no whole numbers in range: taken for 0 */
} FilledFrame;

/* Fills all that the guide has channels for: normals, depth.Z, style.I, object.I, luma.Y (0..1 as bytes), albedo.
 * `style` is the frame's; 0: each pixel's is that of style.I. STY_ERROR_INPUT, which names the guide's file `name`,
 * where one of them is NaN (depths may be). Whatever the outcome, free what it holds with free_frame. */
StyStatus fill_frame(const char *name, const StyImage *guide, int style, FilledFrame *out, StyError *error);
void free_frame(FilledFrame *filled);

/* For commands that make a picture of a frame: --guide and -o OUT.png must be given, nothing else. */
StyStatus require_frame(Options *options, const char *guide);
StyStatus refuse_argument(Options *options, const char *text);

/* Writes RGBA of 8 or 16 bits, as the runtime makes it, to the command's output. `inputs` are names of files, for the
 * history. */
StyStatus write_picture(const Options *options, const char *command, int width, int height, int bits,
                        const void *picture, const char *const *inputs, int input_count, StyError *error);

/* Says what was drawn, as text or as JSON of this schema; warns where `guide` covers nothing. `runtime`: the
 * structures as they were set, for JSON; taken over. */
StyStatus report_picture(const Options *options, const char *schema, const char *guide, const StyFrame *frame,
                         json_t *runtime, StyError *error);

#endif
