/* Is a PLY file complete? */
#ifndef STYLUT_SCENE_PLY_H
#define STYLUT_SCENE_PLY_H

#include "stylut/status.h"

/* Walks through the items that the header of `path` announces and returns
 * STY_ERROR_INPUT when the file ends before they do: Assimp reads on past the
 * end and makes up faces. A header that isn't understood passes; Assimp will
 * say what is wrong with it. */
StyStatus sty_check_ply(const char *path, StyError *error);

#endif
