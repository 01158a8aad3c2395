/* Inputs that several commands read in the same way. */
#ifndef STYLUT_TOOLS_INPUTS_H
#define STYLUT_TOOLS_INPUTS_H

#include "options.h"
#include "stylut/guide.h"
#include "stylut/lut.h"
#include "stylut/runtime.h"

/* Reads a file and turns it into a guide with A and normal.* (see guide.h). Warns where
 * many normals aren't unit vectors, or most face away from the viewer: what was given
 * is then hardly a guide (a painting, say), or one of another convention. */
StyStatus read_guide(const Options *options, const char *path, StyImage **out, StyError *error);

/* Reads a guide for the sake of these channels: as the file has them, or, where it
 * lacks coverage or normals that are asked for, as read_guide finds them. Warns of normals as it does. */
StyStatus read_features(const Options *options, const char *path, const StyFeature *features, int count, StyImage **out,
                        StyError *error);

/* Guides of frames, as --frames takes them. */
enum { MOST_FRAMES = 256 };

typedef struct Frames {
  const char *files[MOST_FRAMES];
  int count;
  bool before_argument; /* --frames came before the command's own argument */
} Frames;

/* One more file; too many are an error. */
StyStatus add_frame(Frames *frames, const char *file, StyError *error);

/* A command's own argument into *slot, then more frames once --frames was given; what
 * may be either, since --frames came first, is an error. */
StyStatus take_argument_or_frame(Options *options, const char **slot, Frames *frames, const char *text);

/* Writes their names behind `count` others; how many there are then. */
int append_frames(const Frames *frames, const char **files, int count);

/* Reads them all into `out`, which is zero and has room for MOST_FRAMES; the
 * caller destroys what it holds, after a failure too. */
StyStatus read_frames(const Options *options, const Frames *frames, StyImage *out[MOST_FRAMES], StyError *error);
void destroy_frames(StyImage *frames[MOST_FRAMES]);

/* Reads a flat table; `hints` say what the file may leave out. Warns, and sets
 * *of_another, where it says that it was made of another file than `guide`; NULL: that isn't
 * known. */
StyStatus read_lut(const Options *options, const char *path, const char *guide, const StyLutHints *hints, StyLut **out,
                   bool *of_another, StyError *error);

/* A bundle's table, which points into a source of this size. */
StyStatus decode_table(const StyTexture *texture, uint32_t layer, StySampling sampling, int source_width,
                       int source_height, StyLut **out, StyError *error);

#endif
