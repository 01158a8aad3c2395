/* The image module's one door. Loading OpenImageIO and the hundred libraries
 * behind it takes longer than many a command runs, so it is a module of its
 * own (libstylut_oiio.so), opened when the first picture is read or written. */
#ifndef STYLUT_BRIDGE_CODEC_H
#define STYLUT_BRIDGE_CODEC_H

#include <stdio.h>

#include "stylut/image_io.h"

#ifdef __cplusplus
extern "C" {
#endif

/* As sty_read_image and sty_prepare_image of image_io.h. */
typedef struct StyImageCodec {
  StyStatus (*read)(const char *path, StyImage **out, StyError *error);
  StyStatus (*write)(const char *path, FILE *stream, StyImageFormat format, const StyImage *image, StyError *error);
} StyImageCodec;

#define STY_CODEC_MODULE "libstylut_oiio.so"
#define STY_CODEC_SYMBOL "sty_image_codec"
extern const StyImageCodec sty_image_codec;

#ifdef __cplusplus
}
#endif
#endif
