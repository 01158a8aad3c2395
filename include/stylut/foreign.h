/* Guides of other programs: their channels, axes and units turned into ours (guide.h).
 *
 * What is known of each program (and what isn't, and is warned of):
 *   blender   multi-layer EXR, LAYER.Pass.Component. Normal and Position are world space; Depth is the
 *             distance along the view axis (of Cycles' panoramas along the ray) and 1e10 at a miss, which
 *             16-bit floats hold as 65504 or infinity. Vector.X and .Y lead to the previous frame, pixels,
 *             up. IndexOB is an object's number, IndexMA a material's: it is taken for the style.
 *   arnold    N and P are world space, the camera's own frame is +X right, +Y up, looking along -Z. Z is a
 *             depth; whether along the axis or the ray is found out where P and the camera are known.
 *             motionvector goes by the shutter and is left out.
 *   pbrt      the gbuffer film of pbrt-v4: Ns is the shading normal; Ns and P are camera space ("string
 *             coordinatesystem" "camera", the default), left-handed with +Z away from the viewer, or world space.
 *   houdini   Mantra's natural space is the camera's: N and P are taken for that, and the normals' majority
 *             tells which way its Z points; Pz and hitPz are along the axis, hitdist along the ray. Files of world
 *             space, as Karma may write, want STY_SPACE_WORLD.
 *   unity     n/2+1/2 in R G B of 8 or 16 bit, n itself in float ones; world space (as
 *             Camera.RenderRequestMode.Normal writes), left-handed. View space there is OpenGL's, that is ours.
 *   png       n/2+1/2 in R G B of 8 or 16 bit, view space, +Y up (or down: flip_y): as sty_import_guide reads them.
 *
 * A pixel is covered where its normal isn't zero, its depth (where there is one) isn't a miss, and its alpha (where
 * there is one) is above 0. */
#ifndef STYLUT_FOREIGN_H
#define STYLUT_FOREIGN_H

#include "stylut/image.h"
#include "stylut/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* NULL-terminated, in the order above. */
extern const char *const sty_guide_programs[];

typedef enum StySpace { STY_SPACE_USUAL, STY_SPACE_VIEW, STY_SPACE_WORLD } StySpace;

typedef struct StyForeignOptions {
  int program;            /* index in sty_guide_programs */
  StySpace space;         /* of the normals, and of positions where the program's share it */
  bool flip_y;            /* the file's normals have Y down */
  const StyStand *camera; /* in the file's own world, left-handed where the program's is; NULL: not known */
} StyForeignOptions;

typedef enum StyNoteKind {
  STY_NOTE_TAKEN,    /* "normal from ViewLayer.Normal.X .Y .Z" */
  STY_NOTE_ASSUMED,  /* a convention that was gone by */
  STY_NOTE_WARNING,  /* a guess, or what is most likely a mistake */
  STY_NOTE_LEFT_OUT, /* a channel of the file, by name */
} StyNoteKind;

#define STY_NOTE_SIZE 512
#define STY_MOST_NOTES (STY_MAX_CHANNELS + 32)

/* What was made of a file; about 80 KiB. */
typedef struct StyNotes {
  int count;
  struct StyNote {
    StyNoteKind kind;
    char text[STY_NOTE_SIZE]; /* one line, control characters replaced */
  } list[STY_MOST_NOTES];
} StyNotes;

/* Turns a picture as read from a file into a guide, in its place: *image is replaced, and its attributes are kept.
 * Normals of float files, and those that the camera turns, are made unit vectors where they are within 10 % of it;
 * integers stay what they say. A depth along the ray, or positions in camera space, need the camera and are else left
 * out with a warning. luma.Y is the Rec. 709 luminance of the picture itself, alpha divided out. `name` is for
 * messages; *notes is written on success.
 * STY_ERROR_INPUT: no normals where the program has them, channels that show another of these programs, values of a
 * covered pixel that aren't finite, normals beyond STY_MAX_GUIDE_VALUE or others beyond STY_MAX_COORDINATE (the message
 * names the pixel), what sty_place_camera refuses. STY_ERROR_USAGE: world
 * space without a camera. Thread-safe. */
StyStatus sty_import_foreign(const char *name, const StyForeignOptions *options, StyImage **image, StyNotes *notes,
                             StyError *error);

#ifdef __cplusplus
}
#endif
#endif
