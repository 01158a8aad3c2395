/* Door to CGAL. Geometry in, geometry out; what it means is the caller's.
 *
 * Built without CGAL (STY_WITH_CGAL not defined) every function here fails
 * with STY_ERROR_UNAVAILABLE. No exception crosses. */
#ifndef STYLUT_BRIDGE_CGAL_H
#define STYLUT_BRIDGE_CGAL_H

#include <stddef.h>
#include <stdint.h>

#include "stylut/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A continuous function of space, negative inside, positive outside. Called
 * from the calling thread only. It must not throw or longjmp. */
typedef double StyField(void *context, const double point[3]);

/* Where the surface is and how finely to mesh it. */
typedef struct StyFieldBounds {
  double center[3]; /* must lie inside, where the field is negative */
  double radius;    /* of a ball round `center` that holds the whole surface */
  double angle;     /* smallest angle of a triangle, degrees; over 30 may not end */
  double size;      /* largest circumradius of a triangle's surface ball */
  double distance;  /* largest gap between a triangle and the surface */
} StyFieldBounds;

typedef struct StyFieldMesh {
  double (*vertices)[3];
  size_t vertex_count;
  uint32_t (*triangles)[3]; /* consistently oriented */
  size_t triangle_count;
} StyFieldMesh;

/* Meshes the zero set of `field` as a closed manifold (Boissonnat and Oudot,
 * "Provably good sampling and meshing of surfaces", 2005; CGAL's
 * make_surface_mesh). The same call gives the same mesh. The caller frees it
 * with sty_destroy_field_mesh. Parts that the bounds cannot resolve, and parts
 * not connected to the piece round `center`, may be missing.
 * Errors: STY_ERROR_INPUT (bounds not finite and positive, center not inside,
 * no surface found), STY_ERROR_LIBRARY (CGAL failed, memory). */
StyStatus sty_mesh_field(StyField *field, void *context, const StyFieldBounds *bounds, StyFieldMesh *out,
                         StyError *error);

/* Frees what *mesh holds and zeroes it. */
void sty_destroy_field_mesh(StyFieldMesh *mesh);

#ifdef __cplusplus
}
#endif
#endif
