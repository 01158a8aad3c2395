/* Where eight rays meet eight triangles: written by component, so that a compiler can take several rays at once. */
#ifndef STYLUT_GUIDE_LANES_H
#define STYLUT_GUIDE_LANES_H

#include <stdbool.h>

enum { STY_LANES = 8 };

typedef double StyLane[STY_LANES]; /* one number of each ray */

/* Eight rays; directions of any length but zero. */
typedef struct StyRays {
  StyLane origin[3], direction[3];
} StyRays;

typedef struct StyLanes {
  /* Given: rays, triangles and what the ray caster found, all in one space. */
  const StyRays *rays;
  StyLane corners[3][3]; /* corner by corner */
  StyLane normals[3][3]; /* of the corners, any length; only where `shading` is wanted */
  StyLane found[2];      /* the second and third corner's weight, for rays within the triangle's plane */
  /* Found. */
  StyLane weights[3]; /* of the corners, 0..1, sum 1 (Moeller and Trumbore 1997) */
  StyLane at[3];
  StyLane facet[3];   /* of any length, on the side that the ray comes from */
  StyLane shading[3]; /* of unit length, on the same side; the facet's where the corners' normals have no sum */
} StyLanes;

void sty_meet_triangles(StyLanes *lanes, bool shading);

#endif
