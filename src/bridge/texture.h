/* Door to OpenImageIO's texture system: pictures that are looked up by place, kept in tiles so that many large ones
 * don't fill the memory. */
#ifndef STYLUT_BRIDGE_TEXTURE_H
#define STYLUT_BRIDGE_TEXTURE_H

#include <stdbool.h>

#include "stylut/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct StyTextureMap StyTextureMap;

/* The brightest that a texel may be, a million times white. */
#define STY_MAX_TEXEL 1e6f

/* Opens a picture that sty_read_image can read, by its channels R G B, or one for all three: Y, or the only one of a
 * picture without layers. Pictures of 8 and 16 bits are sRGB and made scene-linear, float ones are taken as they are;
 * alpha, and layers, are left out. The caller closes it. From one thread at a time for the same path.
 * Errors: those of sty_read_image, STY_ERROR_INPUT (other channels, which the message lists; a texel that isn't from 0
 * to STY_MAX_TEXEL, with its pixel). */
StyStatus sty_open_texture_map(const char *path, StyTextureMap **out, StyError *error);
void sty_close_texture_map(StyTextureMap **texture);

/* The colour at uv (v up: 0 is the lower edge), repeated beyond 0..1; black where uv isn't finite. `nearest`: of the
 * texel that holds the place, else bilinear between texels' centres. False, and any colour: the picture, parts of
 * which may be read again, is gone or doesn't fit the memory. Thread-safe. */
bool sty_sample_texture_map(const StyTextureMap *texture, const double uv[2], bool nearest, float out[3]);

#ifdef __cplusplus
}
#endif
#endif
