/* Nearest-neighbour fields: a frame's pixels matched with a guide's one by one.
 *
 * Where what is compared has too many dimensions for a table (lut.h), each
 * covered pixel of a target is asked for on its own: its features are weighted as
 * the source's are, and the answer is the source pixel at the least distance, by
 * lut.h's arithmetic and tie rule. So a guide matched with itself by an exact
 * engine gives every pixel itself, or the first that has the same values, and
 * distance 0. */
#ifndef STYLUT_MATCH_H
#define STYLUT_MATCH_H

#include "stylut/lut.h"

#ifdef __cplusplus
extern "C" {
#endif

#define STY_NO_PIXEL UINT32_MAX

typedef struct StyField {
  int width, height;               /* of the target, pixels */
  int source_width, source_height; /* pixels */
  size_t matched;                  /* covered pixels of the target */
  size_t unique;                   /* distinct source values that were searched */
  uint32_t *pixels;                /* per target pixel: that of the source, y*source_width + x, or STY_NO_PIXEL */
  float *errors;                   /* per target pixel: the distance of its features to that pixel's; 0 where none */
} StyField;

/* A field in which no pixel is matched; the caller owns it. */
StyStatus sty_create_field(int width, int height, int source_width, int source_height, StyField **out, StyError *error);
void sty_destroy_field(StyField **field);

/* Matches a target's covered pixels (channel A; there may be none) by the channels
 * and weights that the sites' features name. `name` is the target's, for messages;
 * `options` may be NULL: the defaults. STY_ERROR_INPUT: a channel that the target
 * lacks, or a value as sty_collect_features refuses; STY_ERROR_USAGE: more
 * dimensions than the engine takes. */
StyStatus sty_match_guide(const StySites *source, const StyEngine *engine, const StyEngineOptions *options,
                          const char *name, const StyImage *target, const StyRun *run, StyField **out, StyError *error);

/* The field as an image to be written:
 *   32 bits  float channels u = (x+1/2)/W, v = (y+1/2)/H, error, A (1 where matched)
 *   16 bits  R = x, G = y, B = 0, A = 65535 where matched: whole numbers of the file
 * All are 0 where nothing is matched. */
StyStatus sty_encode_field(const StyField *field, int bits, StyImage **out, StyError *error);

#ifdef __cplusplus
}
#endif
#endif
