/* A scene's points in its trace space, for what has to enclose them all. */
#ifndef STYLUT_SRC_SCENE_POINTS_H
#define STYLUT_SRC_SCENE_POINTS_H

#include "stylut/scene.h"

/* A point of the world in trace space. */
static inline void sty_get_trace_point(const StyScene *scene, const double world[3], double out[3]) {
  for (int k = 0; k < 3; k++) out[k] = (world[k] - scene->centre[k]) * scene->scale;
}

/* From the trace space of an object's mesh to that of the scene. */
void sty_get_object_matrix(const StyScene *scene, const StyObject *object, double out[3][4]);

/* Visits every vertex of every object, with radius 0, and every sphere. */
void sty_visit_points(const StyScene *scene, void (*visit)(void *context, const double at[3], double radius),
                      void *context);

#endif
