/* The named-channel float image: the one picture type of stylut.
 *
 * Frame: row 0 is the top; pixel (x, y) has its centre at (x+1/2, y+1/2).
 * Shape: planar; channel c occupies data[c*width*height ...], row-major.
 * Values of 8- and 16-bit files are v/255 and v/65535, exactly as divided in
 * float, so that the integer can be had back by rounding. Nothing is ever
 * colour-converted and alpha is never multiplied in. */
#ifndef STYLUT_IMAGE_H
#define STYLUT_IMAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "stylut/status.h"

#ifdef __cplusplus
extern "C" {
#endif

#define STY_MAX_CHANNELS 128
#define STY_MAX_NAME 128           /* bytes of a channel name, with its NUL */
#define STY_MAX_SIDE 65536         /* pixels */
#define STY_MAX_PIXELS (1LL << 28) /* 16384 x 16384 */
/* Guide values that are compared lie within this; no search library is ever handed one beyond. */
#define STY_MAX_GUIDE_VALUE 1000.0f

/* What a file says about itself beside its pixels: `stylut:...` keys. */
typedef struct StyAttribute {
  char *name;
  char *value;
} StyAttribute;

typedef struct StyImage {
  int width, height; /* pixels, both at least 1 */
  int channel_count; /* 1 .. STY_MAX_CHANNELS */
  int bits;          /* precision of the values: 8 or 16 (integers), 32 (float) */
  char (*names)[STY_MAX_NAME];
  float *data;
  int attribute_count;
  StyAttribute *attributes;
} StyImage;

/* A new image with all values zero; the caller owns it. `names` holds
 * channel_count channel names. Fails with STY_ERROR_LIBRARY when memory is
 * short and STY_ERROR_INPUT for sizes beyond the limits above. */
StyStatus sty_create_image(int width, int height, int channel_count, const char *const *names, int bits, StyImage **out,
                           StyError *error);

/* Frees and nulls *image; does nothing for NULL. */
void sty_destroy_image(StyImage **image);

/* All of it; the caller owns *out. STY_ERROR_LIBRARY: memory. */
StyStatus sty_copy_image(const StyImage *image, StyImage **out, StyError *error);

/* Pixels of one channel. */
static inline size_t sty_count_pixels(const StyImage *image) { return (size_t)image->width * (size_t)image->height; }

/* The plane of the channel of this name, or NULL. Names compare exactly. */
float *sty_find_channel(const StyImage *image, const char *name);

/* The place of a pixel along a side as an integer, (pixel+1/2)/side*maximum rounded to the
 * nearest, halves down, and back: value*side/maximum rounded down, at most side-1. Exact for
 * sides up to maximum+1. */
uint32_t sty_encode_coordinate(uint32_t pixel, uint32_t side, uint32_t maximum);
uint32_t sty_decode_coordinate(uint32_t value, uint32_t side, uint32_t maximum);

/* RGBA bytes, 4 * width * height, of an 8- or 16-bit picture: 1 channel is
 * grey, 2 are grey and alpha, 3 are R G B, 4 are R G B A in this order; alpha is 255
 * where there is none; 16 bits are rounded to 8. STY_ERROR_INPUT for float
 * pictures and other counts; `name` is for the message. */
StyStatus sty_convert_to_rgba8(const char *name, const StyImage *image, uint8_t *out, StyError *error);

/* Copies name and value; replaces an attribute of the same name. */
StyStatus sty_set_attribute(StyImage *image, const char *name, const char *value, StyError *error);

/* The attribute's value, or NULL. */
const char *sty_find_attribute(const StyImage *image, const char *name);

#ifdef __cplusplus
}
#endif
#endif
