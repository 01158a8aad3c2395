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

/* Opens a picture that sty_read_image can read: its first three channels, or one for all three. Pictures of 8 and 16
 * bits are sRGB and made scene-linear, float ones are taken as they are; alpha is left out. The caller closes it.
 * Errors: those of sty_read_image, STY_ERROR_INPUT (a pixel that isn't finite). */
StyStatus sty_open_texture_map(const char *path, StyTextureMap **out, StyError *error);
void sty_close_texture_map(StyTextureMap **texture);

/* The colour at uv (v up: 0 is the lower edge), repeated beyond 0..1; black where uv isn't finite. `nearest`: of the
 * texel that holds the place, else bilinear between texels' centres. Thread-safe. */
void sty_sample_texture_map(const StyTextureMap *texture, const double uv[2], bool nearest, float out[3]);

#ifdef __cplusplus
}
#endif
#endif
