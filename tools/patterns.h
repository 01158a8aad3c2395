/* Patterns that toon shading and outlines are roughened with, STY_JITTER_SIZE texels a side, repeating. */
#ifndef STYLUT_TOOLS_PATTERNS_H
#define STYLUT_TOOLS_PATTERNS_H

#include <stdbool.h>
#include <stdint.h>

#include "stylut/runtime.h"
#include "stylut/status.h"

enum { PATTERN_SIDE = STY_JITTER_SIZE };

/* Smooth random hills, `spacing` (a divisor of the side) texels from one to the next, in each of a texel's
 * `channels` (1 or 2) bytes. */
void make_hills(uint64_t seed, int spacing, int channels, uint8_t *out);

/* Strokes along x, uneven as a hand draws them. */
void make_strokes(uint64_t seed, uint8_t *out);

/* Whether open_pattern knows this name, which then is no file's. */
bool is_own_pattern(const char *name);

/* A picture's luminance as a pattern, or our own "hatch" or "noise". The caller frees the texels. */
StyStatus open_pattern(const char *name, uint64_t seed, StyPattern *out, StyError *error);

#endif
