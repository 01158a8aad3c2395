/* Meshes as they come: what is wrong with a file's triangles, and putting it right.
 *
 * A soup is triangles that need not be the surface of anything. It renders as it is; what suffers are
 * computed normals, where neighbours are wound against each other or a triangle lies there twice.
 * Points are places: vertices at the same coordinates, to the bit, are one point, whatever their normals
 * and texture coordinates. Edges join two points.
 *
 * Threads: nothing is kept between calls. A mesh or scene may be surveyed by several threads at a time; one that is
 * repaired must be seen by no other. Nothing here is handed over: the caller owns what it passes. */
#ifndef STYLUT_REPAIR_H
#define STYLUT_REPAIR_H

#include "stylut/mesh.h"
#include "stylut/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct StyMeshSurvey {
  size_t vertices;   /* of the file, as StyMesh.vertices_read */
  size_t points;     /* that triangles use: vertices - points is what merging saves */
  size_t triangles;  /* those with an area, copies included */
  size_t repeated;   /* faces left out at reading, two corners of which are the same point */
  size_t flat;       /* faces left out at reading, others without area */
  size_t copies;     /* triangles on the same three points as an earlier one; what follows leaves them aside */
  size_t clashes;    /* edges of two triangles that run the same way along it: one of them is turned round */
  size_t tangles;    /* edges of more than two triangles */
  size_t borders;    /* edges of one triangle */
  size_t holes;      /* loops that borders form; those that touch count as one */
  size_t components; /* of triangles that share edges */
} StyMeshSurvey;

/* Looks at a mesh and changes nothing. Needs memory for some 70 bytes a triangle. STY_ERROR_LIBRARY: memory. *out is
 * written on success. */
StyStatus sty_survey_mesh(const StyMesh *mesh, StyMeshSurvey *out, StyError *error);

typedef struct StyRepair {
  StyMeshSurvey found, left; /* before and after; clashes and tangles that are left render as well */
  size_t removed;            /* copies */
  size_t turned;             /* triangles turned round; of each component the fewer side turns */
} StyRepair;

/* Takes copies out, the first stays, and turns triangles so that neighbours agree (Gueziec et al. 2001; CGAL's
 * orient_polygon_soup, which is called only where neighbours clash). Then normals that were computed are computed
 * again; those of the file stay. Holes are counted, not filled. A mesh that has nothing to repair keeps every byte.
 * On failure the mesh is as it was. STY_ERROR_UNAVAILABLE (neighbours clash, and this is a build without CGAL),
 * STY_ERROR_LIBRARY (memory, or CGAL failed). *out is written on success. */
StyStatus sty_repair_mesh(StyMesh *mesh, StyRepair *out, StyError *error);

/* All meshes of a scene, each once, and the sums. Errors: those of the one mesh; meshes before it that were repaired
 * stay so. */
StyStatus sty_survey_scene(const StyScene *scene, StyMeshSurvey *out, StyError *error);
StyStatus sty_repair_scene(StyScene *scene, StyRepair *out, StyError *error);

#ifdef __cplusplus
}
#endif
#endif
