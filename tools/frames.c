#include "frames.h"

#include <stdlib.h>

#include "stylut/guide.h"

void free_frame(FilledFrame *filled) {
  free(filled->guide);
  free(filled->styles);
  free(filled->fine);
  free(filled->depth);
}

static StyStatus allocate_frame(FilledFrame *filled, const StyImage *image, StyError *error) {
  const size_t pixels = sty_count_pixels(image);
  const bool fine = image->bits > 8, depth = sty_find_channel(image, "depth.Z"), styles = filled->frame.style == 0;
  filled->guide = malloc(4 * pixels);
  if (fine) filled->fine = malloc(2 * pixels * sizeof *filled->fine);
  if (depth) filled->depth = malloc(pixels * sizeof *filled->depth);
  if (styles) filled->styles = malloc(pixels);
  if (!filled->guide || (fine && !filled->fine) || (depth && !filled->depth) || (styles && !filled->styles))
    return sty_fail_memory(error, "frame", (double)pixels * 17);
  return STY_OK;
}

/* The guide's bytes, and coverage as the file has it, not just 0 and 255: it becomes the picture's alpha. */
static StyStatus fill_guide(const StyImage *image, uint8_t *guide, StyError *error) {
  const float *alpha = sty_find_channel(image, "A");
  StyImage *encoded = NULL;
  StyStatus status = sty_encode_normals(image, 8, &encoded, error);
  if (!status) status = sty_convert_to_rgba8("guide", encoded, guide, error);
  sty_destroy_image(&encoded);
  for (size_t i = 0; !status && i < sty_count_pixels(image); i++) {
    const float covered = alpha[i] > 0 ? alpha[i] * 255.0f + 0.5f : 0;
    guide[4 * i + 3] = covered < 1 ? covered > 0 : covered < 255 ? (uint8_t)covered : 255;
  }
  return status;
}

StyStatus fill_frame(const StyImage *image, int style, FilledFrame *out, StyError *error) {
  *out = (FilledFrame){.frame = {.width = image->width, .height = image->height, .style = style}};
  StyStatus status = allocate_frame(out, image, error);
  if (!status) status = fill_guide(image, out->guide, error);
  if (status) return status;
  const float *x = sty_find_channel(image, "normal.X"), *y = sty_find_channel(image, "normal.Y");
  const float *depth = sty_find_channel(image, "depth.Z"), *ids = sty_find_channel(image, "style.I");
  for (size_t i = 0; i < sty_count_pixels(image); i++) {
    if (out->fine) out->fine[2 * i] = x[i], out->fine[2 * i + 1] = y[i];
    if (out->depth) out->depth[i] = depth[i];
    if (out->styles) out->styles[i] = ids[i] >= 1 && ids[i] <= 255 ? (uint8_t)ids[i] : 0;
  }
  out->frame.guide = out->guide;
  out->frame.fine = out->fine;
  out->frame.depth = out->depth;
  out->frame.styles = out->styles;
  return STY_OK;
}
