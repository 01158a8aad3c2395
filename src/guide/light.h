/* Light on what rays have met: Lambert's diffuse share and Blinn and Phong's highlight (Blinn 1977), with shadows. */
#ifndef STYLUT_GUIDE_LIGHT_H
#define STYLUT_GUIDE_LIGHT_H

#include "guide/rays.h"

/* What a block of rays sees; pixels with valid[i] = 0 see nothing. */
typedef struct StyBlock {
  StyRays rays;
  StyHit hits[STY_RAYS];
  double albedo[STY_RAYS][3]; /* scene-linear */
  double luma[STY_RAYS];      /* scene-linear */
  _Alignas(32) int valid[STY_RAYS];
} StyBlock;

/* From a hit to the light: a unit vector, and the distance in trace units; false where they are in one place. */
bool sty_aim_at_light(const StyScene *scene, const StyLight *light, const StyHit *hit, double to[3], double *distance);

/* What of the light's colour reaches a surface that faces it, `distance` trace units away. */
double sty_get_intensity(const StyScene *scene, const StyLight *light, double distance);

/* Fills block->luma from hits and albedo. Thread-safe. */
void sty_light_block(const StyScene *scene, const StyTracer *tracer, StyBlock *block);

#endif
