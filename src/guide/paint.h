/* The colours of surfaces: what a scene says of them, and its textures. */
#ifndef STYLUT_GUIDE_PAINT_H
#define STYLUT_GUIDE_PAINT_H

#include "guide/rays.h"

typedef struct StyPalette StyPalette;

/* Opens all textures of a scene, which it refers to; the caller closes it first. `nearest`: the texel that holds a
 * place, else bilinear. STY_ERROR_FILE and STY_ERROR_INPUT name the texture that can't be read. */
StyStatus sty_open_palette(const StyScene *scene, bool nearest, StyPalette **out, StyError *error);
void sty_close_palette(StyPalette **palette);

/* Memory that a palette of the scene takes, from its pictures' headers: all of it, and beside that while the largest is
 * read. Errors: those of sty_open_palette that headers show. */
StyStatus sty_estimate_palette(const StyScene *scene, double *bytes, double *decode_bytes, StyError *error);

/* Scene-linear diffuse reflectance at hit i, whose uv and owner are known. Thread-safe; what a look-up has to say
 * sty_check_palette says. */
void sty_get_albedo(const StyPalette *palette, const StyHits *hits, int i, StyLane out[3]);

/* STY_ERROR_LIBRARY names a texture that couldn't be looked up, so that colours are wrong. */
StyStatus sty_check_palette(const StyPalette *palette, StyError *error);

#endif
