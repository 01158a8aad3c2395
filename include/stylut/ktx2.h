/* Writing KTX2 texture arrays, layer by layer. KTX File Format 2.0 (Khronos);
 * the formats are those of runtime_format.h. */
#ifndef STYLUT_KTX2_H
#define STYLUT_KTX2_H

#include <stdint.h>

#include "stylut/file.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct StyKtx2 {
  StyOutput output;
  uint64_t offset;     /* of the first layer, bytes */
  uint64_t layer_size; /* bytes of one layer */
  int width, height, layers, written;
} StyKtx2;

/* Begins a 2D array of `layers` layers in one of the formats STY_VK_*, with
 * KTXorientation "rd" and a fixed KTXwriter. A level starts at a multiple of
 * max(4, texel size). STY_ERROR_FILE when the path can't be written. */
StyStatus sty_open_ktx2(const char *path, uint32_t format, int width, int height, int layers, StyKtx2 *out,
                        StyError *error);

/* Writes one layer, 0 .. layers - 1: layer_size bytes, rows from the top, no padding, little-endian components. Each
 * layer once, in any order, from any thread. */
StyStatus sty_place_ktx2_layer(StyKtx2 *texture, int layer, const void *texels, StyError *error);

/* The same of the layer behind those that are written, where all are written in their order by one thread. */
StyStatus sty_write_ktx2_layer(StyKtx2 *texture, const void *texels, StyError *error);

/* Finishes after exactly `layers` layers; the file appears. *texture is spent. */
StyStatus sty_commit_ktx2(StyKtx2 *texture, StyError *error);
void sty_discard_ktx2(StyKtx2 *texture);

/* Commits after success so far (STY_OK), discards after a failure, which it returns. */
StyStatus sty_end_ktx2(StyKtx2 *texture, StyStatus so_far, StyError *error);

/* All of it, from `layers` layers one behind the other. */
StyStatus sty_write_ktx2(const char *path, uint32_t format, int width, int height, int layers, const void *texels,
                         StyError *error);

#ifdef __cplusplus
}
#endif
#endif
