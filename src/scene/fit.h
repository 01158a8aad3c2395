/* Meshes on their way from a file's coordinates to trace space. */
#ifndef STYLUT_SCENE_FIT_H
#define STYLUT_SCENE_FIT_H

#include "stylut/mesh.h"

/* Takes the place of positions that are as in the file: checks them, and texture coordinates, finds the bounds of what
 * has an area, moves all to trace space, and lets go of triangles without area and of vertices that none uses. Indices
 * must be in range. In place: takes a number per vertex for a while, and that only where a vertex goes.
 * STY_ERROR_INPUT names mesh->path. */
StyStatus sty_fit_mesh(StyMesh *mesh, StyError *error);

/* Trace space for bounds that are known: centre and scale. False where there is nothing between them. */
bool sty_set_mesh_space(StyMesh *mesh);

/* Whether a triangle has an area. */
bool sty_has_area(const double a[3], const double b[3], const double c[3]);

/* The same of three positions of a mesh; where it hasn't, counts it among the faces that were left out. */
bool sty_keeps_triangle(StyMesh *mesh, const float *const corners[3]);

#endif
