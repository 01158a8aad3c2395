/* PLY files: are they complete, and those that hold triangles in binary. */
#ifndef STYLUT_SCENE_PLY_H
#define STYLUT_SCENE_PLY_H

#include "stylut/mesh.h"

/* Reads the header of `path` and walks through the items that it announces.
 * STY_ERROR_INPUT when the header isn't PLY 1.0 or the file ends too early:
 * Assimp waits forever for the rest of some headers, reads on past the end of
 * binary items, and makes up faces where text ends. */
StyStatus sty_check_ply(const char *path, StyError *error);

/* By its ending, of any case. */
bool sty_is_ply(const char *path);

/* Reads a binary file of triangles into a mesh of one part, with nothing beside it but what sty_fit_mesh takes: an
 * importer's lists of faces alone are larger than all of that mesh. Leaves *out alone, and returns STY_OK, where a file
 * holds anything else (text, polygons, strips, texture coordinates per face), for the importer. Normals are NULL where
 * the file has none or they aren't kept, and zero where it has no direction. Errors: those of sty_check_ply and
 * sty_read_mesh. */
StyStatus sty_read_ply(const char *path, bool keep_normals, const StyRun *run, StyMesh **out, StyError *error);

#endif
