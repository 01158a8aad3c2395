/* Rays into a scene and what they meet. Embree finds which triangle or sphere it
 * is; where the ray meets it is worked out again here, in double and from the
 * triangle's number alone, so that values don't depend on the processor's vector
 * units or on how rays travel together. */
#ifndef STYLUT_GUIDE_RAYS_H
#define STYLUT_GUIDE_RAYS_H

#include "guide/lanes.h"
#include "stylut/parallel.h"
#include "stylut/scene.h"

/* Rays travel in blocks: eight at a time with the coherent flag is 2.5 times as
 * fast as one at a time. Directions have any length but zero. */
enum { STY_RAYS = STY_LANES };

typedef struct StyRays {
  StyLane origin[3], direction[3]; /* trace space */
} StyRays;

/* A tree of the scene, which it refers to. */
typedef struct StyTracer StyTracer;

/* One of a block's. */
typedef struct StyRay {
  double origin[3], direction[3]; /* trace space; any length but zero */
} StyRay;

static inline StyRay sty_get_ray(const StyRays *rays, int i) {
  StyRay ray;
  for (int k = 0; k < 3; k++) {
    ray.origin[k] = rays->origin[k][i];
    ray.direction[k] = rays->direction[k][i];
  }
  return ray;
}

static inline void sty_set_ray(StyRays *rays, int i, const StyRay *ray) {
  for (int k = 0; k < 3; k++) {
    rays->origin[k][i] = ray->origin[k];
    rays->direction[k][i] = ray->direction[k];
  }
}

/* What is worked out about hits beside their place, their facet and what they lie on. */
typedef enum StyHitPart {
  STY_HIT_SHADING = 1 << 0,
  STY_HIT_UV = 1 << 1,
  STY_HIT_CURVATURE = 1 << 2, /* with STY_HIT_SHADING */
  STY_HIT_OWNER = 1 << 3,     /* paint, material, style and object */
  STY_HIT_LEAVE = 1 << 4,     /* how rays may leave it */
} StyHitPart;

/* Where a block's rays meet what they meet. */
typedef struct StyHits {
  StyLane at[3];      /* trace space */
  StyLane facet[3];   /* normal of the surface itself, any length, on the viewer's side */
  StyLane shading[3]; /* the normal that light would see, unit length, on the same side */
  StyLane uv[2];
  StyLane curvature;           /* mean, per trace unit, positive where it bulges toward the viewer */
  StyLane off;                 /* what rays that leave start off the surface so as not to meet it again, trace units */
  StyLane weights[3];          /* of the triangle's corners, 0..1, sum 1 */
  unsigned thing[STY_RAYS];    /* index of the object, or the objects' number and the sphere's index */
  unsigned triangle[STY_RAYS]; /* of the object's mesh */
  const StyPaint *paint[STY_RAYS];
  const StyMaterial *material[STY_RAYS]; /* its highlight; its paint is the line above */
  int style[STY_RAYS], object[STY_RAYS]; /* ids */
} StyHits;

/* A vector of a block's. */
static inline void sty_get_lane(const StyLane vectors[3], int i, double out[3]) {
  for (int k = 0; k < 3; k++) out[k] = vectors[k][i];
}

/* The caller closes the tracer before the scene goes. Of the run (NULL: none) it takes stage and progress; one thread
 * builds. STY_ERROR_LIBRARY. */
StyStatus sty_open_tracer(const StyScene *scene, const StyRun *run, StyTracer **out, StyError *error);
void sty_close_tracer(StyTracer **tracer);

/* Most memory that Embree took at a time, bytes. */
double sty_get_tracer_bytes(const StyTracer *tracer);

/* Traces those of a block's rays (trace space) whose valid[i] is -1 (others 0, their rays finite all the same; 32-byte
 * aligned) and clears valid[i] of those that meet nothing; false where none is left. `coherent`: the rays run side by
 * side. `parts` is a set of StyHitPart. Thread-safe. */
bool sty_trace_rays(const StyTracer *tracer, const StyRays *rays, bool coherent, unsigned parts, int *valid,
                    StyHits *hits);

/* Hit i of a block, as hit i of another. */
void sty_copy_hit(const StyHits *hits, int i, StyHits *out);

/* The ray that leaves hit i (STY_HIT_LEAVE) along a unit vector, from a little off the surface, on whichever side it
 * goes to. */
void sty_leave_hit(const StyHits *hits, int i, const double to[3], StyRay *out);

/* Clears asks[i] (-1 or 0; 32-byte aligned) where something stands on the way from hit i (STY_HIT_LEAVE) along
 * to[.][i], a unit vector, within `distances[i]` trace units. Thread-safe. */
void sty_trace_shadows(const StyTracer *tracer, const StyHits *hits, const StyLane to[3], const StyLane distances,
                       int *asks);

/* Texture coordinates of a sphere's point, `out` from its centre: longitude and latitude about the Y axis, u = 1/2 in
 * front, v = 1 at the top. */
void sty_get_sphere_uv(const double out[3], double radius, double uv[2]);

/* The point of `other`, in its trace space, that lies on the same place of the same thing as hit i in `scene`; the two
 * must be alike (sty_check_alike). */
void sty_follow_hit(const StyScene *scene, const StyHits *hits, int i, const StyScene *other, double at[3]);

#endif
