/* Where a frame shows its objects' pivots, so that pieces of a style can ride along with them.
 *
 * A pivot is one point for all of an object's parts: of a mesh the middle of the box around it in its own file's
 * coordinates, moved by the object's transform, of a sphere its centre. That point stays with a thing that moves or
 * turns as a whole, lies within it, and follows files that hold a place of their own for each frame; a file's origin
 * may lie anywhere.
 *
 * Pixels count from the frame's upper left corner, x right, y down; the first pixel's centre is at 0.5, 0.5.
 *
 * As text, in a guide's attribute stylut:pivots: "1 512.25 300.5; 2 17 40.125", object, x and y of each in the order of
 * their numbers. As JSON that people write, for one frame or by the frame's number:
 *   { "schema": "stylut-pivots/1", "pivots": { "1": [512.25, 300.5], "2": [17, 40] } }
 *   { "schema": "stylut-pivots/1", "frames": { "1": { "1": [512.25, 300.5] }, "2": { "1": [513.5, 300.5] } } }
 *
 * Threads: nothing is kept between calls. Out parameters are written on success; all that fails may do so for lack of
 * memory, STY_ERROR_LIBRARY. */
#ifndef STYLUT_PIVOTS_H
#define STYLUT_PIVOTS_H

#include "stylut/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

#define STY_PIVOTS_ATTRIBUTE "stylut:pivots"

/* Pixels either way, and what object.I can be. */
enum { STY_MAX_PIVOT = 1 << 23, STY_MOST_PIVOT_ID = 65535 };

typedef struct StyPivot {
  int object; /* its object.I, 1 and up */
  double x, y;
} StyPivot;

/* By object, ascending, each once. Owned. */
typedef struct StyPivots {
  StyPivot *items;
  size_t count;
} StyPivots;

void sty_free_pivots(StyPivots *pivots);

/* Those of a finished scene, less what lies behind a perspective camera or beyond STY_MAX_PIVOT. In thousandths of a
 * pixel: what rounding errors leave would otherwise make a pivot between two pixels fall now to one, now to the other.
 */
StyStatus sty_find_pivots(const StyScene *scene, const StyCamera *camera, int width, int height, StyPivots *out,
                          StyError *error);

/* To text, which the caller frees, and back; `name` is for messages. STY_ERROR_INPUT: text of another form. */
StyStatus sty_encode_pivots(const StyPivots *pivots, char **out, StyError *error);
StyStatus sty_decode_pivots(const char *name, const char *text, StyPivots *out, StyError *error);

/* A JSON file's; of frame `number` each, or of all. */
typedef struct StyFramePivots {
  int number;
  StyPivots pivots;
} StyFramePivots;

typedef struct StyPivotFile {
  bool is_for_all; /* frames[0] holds for every number */
  StyFramePivots *frames;
  size_t count;
} StyPivotFile;

/* STY_ERROR_FILE, STY_ERROR_INPUT ("FILE:LINE:COLUMN: KEY: ..."). */
StyStatus sty_read_pivots(const char *path, StyPivotFile *out, StyError *error);
void sty_free_pivot_file(StyPivotFile *file);

/* The file's; NULL: it has none of this frame. */
const StyPivots *sty_get_frame_pivots(const StyPivotFile *file, int number);

#ifdef __cplusplus
}
#endif
#endif
