/* Is a PLY file complete? */
#ifndef STYLUT_SCENE_PLY_H
#define STYLUT_SCENE_PLY_H

#include "stylut/status.h"

/* Reads the header of `path` and walks through the items that it announces.
 * STY_ERROR_INPUT when the header isn't PLY 1.0 or the file ends too early:
 * Assimp waits forever for the rest of some headers, reads on past the end of
 * binary items, and makes up faces where text ends. */
StyStatus sty_check_ply(const char *path, StyError *error);

#endif
