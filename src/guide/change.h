/* How far a scene's guide is from what it was. */
#ifndef STYLUT_SRC_GUIDE_CHANGE_H
#define STYLUT_SRC_GUIDE_CHANGE_H

#include "stylut/simplify.h"

/* The normals of a scene's guide, and its ids on a grid twice as fine. */
typedef struct StyShape {
  StyImage *normals, *ids;
} StyShape;

/* Renders them. The caller destroys the shape. Errors: those of sty_trace_guide. */
StyStatus sty_render_shape(const StyScene *scene, const StyCamera *camera, const StyTraceOptions *trace,
                           const StyRun *run, StyShape *out, StyRenderCost *cost, StyError *error);
void sty_destroy_shape(StyShape *shape);

/* Of two shapes of the same size. STY_ERROR_LIBRARY (memory). */
StyStatus sty_measure_change(const StyShape *full, const StyShape *simple, const StyRun *run, StyGuideChange *out,
                             StyError *error);

#endif
