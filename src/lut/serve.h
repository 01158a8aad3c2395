/* How well source pixels serve frames. The runtime copies pieces: around a seed
 * whose texel holds source pixel u, a frame's pixel at seed + d gets u + d for as
 * long as the two guides agree there (see runtime.h). So the pixel of a texel that
 * makes large pieces is one whose surroundings look like the surroundings of the
 * frame pixels that ask for this texel. */
#ifndef STYLUT_SRC_LUT_SERVE_H
#define STYLUT_SRC_LUT_SERVE_H

#include "stylut/lut.h"

/* Pieces are measured along rays, step by step, which each asker turns by one of so
 * many angles. */
enum { STY_TURNS = 4, STY_RAYS = 4, STY_STEPS = 4 };

/* A guide as the runtime compares it: bytes in a margin of uncovered ones. */
typedef struct StyPatch {
  int pitch;
  uint8_t (*bytes)[4]; /* x, y, z, 0; of the pixel (0, 0) */
  uint8_t (*block)[4];
  int32_t offsets[STY_TURNS][STY_RAYS][STY_STEPS];
} StyPatch;

/* A frame's pixel that asks for a texel. */
typedef struct StyAsker {
  uint16_t frame, x, y; /* frame STY_NO_FRAME: none; memory counts, there are eight a texel */
} StyAsker;
enum { STY_NO_FRAME = 0xffff };

enum { STY_MOST_ASKERS = 8 }; /* a texel, evenly chosen of all that there are */

typedef struct StyServe {
  StyPatch source, *frames;
  int frame_count;
  StyAsker (*askers)[STY_MOST_ASKERS]; /* per texel */
} StyServe;

/* `guide` is the table's, with normals; frames are guides of any size. The caller closes it. */
StyStatus sty_open_serve(const StyLut *lut, const StyImage *guide, const StyImage *const *frames, int frame_count,
                         StyServe *out, StyError *error);
void sty_close_serve(StyServe *serve);

/* Whether frames ask for the texel, or for one so near that it borrows from it. */
static inline bool sty_has_askers(const StyServe *serve, size_t texel) {
  return serve->askers[texel][0].frame != STY_NO_FRAME;
}

/* The mean size, pixels, of the pieces that source pixel (x, y) would make around
 * those that ask for the texel, at most STY_LARGEST_PIECE; 0 where nobody asks. */
enum { STY_LARGEST_PIECE = 5027 };
float sty_measure_service(const StyServe *serve, size_t texel, int x, int y);

#endif
