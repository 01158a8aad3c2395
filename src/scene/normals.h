/* Smooth normals of triangles that share vertices. */
#ifndef STYLUT_SCENE_NORMALS_H
#define STYLUT_SCENE_NORMALS_H

#include "stylut/mesh.h"

/* Fills the normals that aren't known (zero): the mean of the facet normals
 * around the vertex' point, weighted by the facets' angles there (Thuermer and
 * Wuethrich 1998), so that it doesn't depend on how faces are cut into
 * triangles. Facets belong together when they share an edge that bends by at
 * most `crease_angle` degrees; a vertex on which others meet becomes several.
 * mesh->crease_angle becomes the angle, or -1 where a normal was known.
 * Triangles must have area. Takes some bytes per vertex beside the mesh itself;
 * the result doesn't depend on the threads of `run` (NULL: one per core). */
StyStatus sty_compute_normals(StyMesh *mesh, double crease_angle, const StyRun *run, StyError *error);

#endif
