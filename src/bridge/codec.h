/* The image module's one door (libstylut_oiio.so, see module.h): OpenImageIO and the hundred libraries behind it are
 * loaded when the first picture is read or written. */
#ifndef STYLUT_BRIDGE_CODEC_H
#define STYLUT_BRIDGE_CODEC_H

#include <stdio.h>

#include "bridge/texture.h"
#include "stylut/image_io.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A picture on its way into a stream. */
typedef struct StyRowWriter StyRowWriter;

/* As sty_read_image and the writers of image_io.h, and what texture.h has. */
typedef struct StyImageCodec {
  StyStatus (*read)(const char *path, long long most_pixels, StyImage **out, StyError *error);
  StyStatus (*read_shape)(const char *path, long long most_pixels, StyImageShape *out, StyError *error);
  StyStatus (*resize)(const char *name, const StyImage *image, StyImage *out, StyError *error);
  StyStatus (*open_writer)(const char *path, FILE *stream, StyImageFormat format, const StyImage *like, int height,
                           StyRowWriter **out, StyError *error);
  StyStatus (*write_rows)(StyRowWriter *writer, const StyImage *rows, StyError *error);
  StyStatus (*close_writer)(StyRowWriter **writer, StyError *error); /* spends it either way */
  void (*discard_writer)(StyRowWriter **writer);
  StyStatus (*open_texture)(const char *path, long long most_pixels, StyTextureMap **out, StyError *error);
  void (*close_texture)(StyTextureMap **texture);
  bool (*sample_texture)(const StyTextureMap *texture, const double uv[2], bool nearest, float out[3]);
} StyImageCodec;

extern const StyImageCodec sty_image_codec;

#ifdef __cplusplus
}
#endif
#endif
