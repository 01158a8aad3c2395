/* Maps made small enough for a page: 16-bit steps, compressed, as text. */
#ifndef STYLUT_SRC_AUDIT_PLANES_H
#define STYLUT_SRC_AUDIT_PLANES_H

#include <jansson.h>

#include "stylut/report.h"

/* Sides beyond these are shown in cells of several texels or pixels. */
enum { STY_MOST_TABLE_CELLS = 512, STY_MOST_GUIDE_CELLS = 384 };

/* Standard base64 with padding; the caller frees it. NULL when memory is short. */
char *sty_encode_base64(const unsigned char *bytes, size_t size);

/* {"width", "height", "step", "planes": {name: {"scale", "data"}}}: one value per
 * cell of step x step texels, row-major. `data` is base64 of raw deflate of the
 * high bytes, then the low bytes, of each value's difference from the one before
 * it in its row (mod 65536, rows begin at 0); value = integer * scale, 65535
 * means none. `x` and `y` are the source pixel of the cell's middle texel; error,
 * excess, pieces, spread, jumps and unstable are the worst in the cell; weight is
 * its sum. `step` is a wish: the largest side decides, too. */
StyStatus sty_pack_table(const StyReport *report, int step, json_t **out, StyError *error);

/* The same of the guide: `gx` and `gy` of the cell's middle pixel, stored as
 * (g+1)/2 and none where nothing is covered; of its covered pixels `ambiguous` and
 * `unused`, shares; `uses`, by how many texels all of them are used. */
StyStatus sty_pack_guide(const StyReport *report, json_t **out, StyError *error);

#endif
