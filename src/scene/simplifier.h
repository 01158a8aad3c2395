/* One mesh with ever fewer triangles. */
#ifndef STYLUT_SRC_SCENE_SIMPLIFIER_H
#define STYLUT_SRC_SCENE_SIMPLIFIER_H

#include "stylut/mesh.h"

/* A mesh on its way down, to which it refers. */
typedef struct StySimplifier StySimplifier;

/* What counts as much: normals that turn by `angle` radians, and a surface that moves by `distance`, trace units. */
typedef struct StyTolerance {
  double angle, distance; /* above 0 */
} StyTolerance;

/* STY_ERROR_UNAVAILABLE (a build without CGAL), STY_ERROR_LIBRARY. */
StyStatus sty_open_simplifier(const StyMesh *mesh, const StyTolerance *tolerance, StySimplifier **out, StyError *error);
void sty_close_simplifier(StySimplifier **simplifier);

/* A mesh of about `target` triangles, or as few as it comes to, from what was kept last (at first all of it). Its
 * vertices are some of the mesh's, as they are: normals and texture coordinates are those of the original surface.
 * Seams, where neighbours differ in part, normals or texture coordinates, and open borders stay where they are but for
 * points that lie along them; a part keeps its number. The caller owns it. */
StyStatus sty_simplify_to(StySimplifier *simplifier, size_t target, StyMesh **out, StyError *error);

/* What was made last is where the next call starts from. */
void sty_keep_simplified(StySimplifier *simplifier);

#endif
