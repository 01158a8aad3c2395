/* Light on what rays have met: Lambert's diffuse share and Blinn and Phong's highlight (Blinn 1977), with shadows. */
#ifndef STYLUT_GUIDE_LIGHT_H
#define STYLUT_GUIDE_LIGHT_H

#include "guide/rays.h"

/* What a block of rays sees; pixels with valid[i] = 0 see nothing. */
typedef struct StyBlock {
  StyRays rays;
  StyHits hits;
  StyLane albedo[3]; /* scene-linear */
  _Alignas(32) int valid[STY_RAYS];
} StyBlock;

/* What surfaces send back of the lights that they see, scene-linear. */
typedef struct StyShine {
  StyLane diffuse[3], highlight[3];
} StyShine;

/* What the scene's lights, ambient apart, do at the hits, seen back along the rays; 0 where valid[i] is. Thread-safe.
 */
void sty_shine_on_block(const StyScene *scene, const StyTracer *tracer, const StyBlock *block, StyShine *shine);

/* Luminance of the surfaces: ambient light, wherever it comes from, and what the others do. Thread-safe. */
void sty_light_block(const StyScene *scene, const StyTracer *tracer, const StyBlock *block, StyLane luma);

#endif
