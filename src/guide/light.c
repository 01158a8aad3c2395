#include "guide/light.h"

#include <math.h>
#include <string.h>

#include "scene/points.h"
#include "scene/vector.h"

/* From hit i to the light: a unit vector, and the distance in trace units; false where they are in one place. */
static bool aim_at_light(const StyScene *scene, const StyLight *light, const StyHits *hits, int i, double to[3],
                         double *distance) {
  double from[3];
  sty_get_trace_point(scene, light->position, from);
  for (int k = 0; k < 3; k++) to[k] = light->is_point ? from[k] - hits->at[k][i] : -light->direction[k];
  *distance = light->is_point ? sqrt(dot_vectors(to, to)) : INFINITY;
  return normalize_vector(to);
}

/* What of the light's colour reaches a surface that faces it, `distance` trace units away. */
static double get_intensity(const StyScene *scene, const StyLight *light, double distance) {
  const double world = distance / scene->scale;
  return light->is_point ? light->intensity / (world * world) : light->intensity;
}

/* Of one light that is not hidden. */
static void reflect(const StyBlock *block, int i, const StyLight *light, const double to[3], double received,
                    StyShine *shine) {
  double shading[3], direction[3], half[3];
  sty_get_lane(block->hits.shading, i, shading);
  sty_get_lane(block->rays.direction, i, direction);
  const StyMaterial *material = block->hits.material[i];
  const double cosine = dot_vectors(shading, to);
  for (int k = 0; k < 3; k++) shine->diffuse[k][i] += block->albedo[k][i] * light->colour[k] * cosine * received;
  if (!(material->specular > 0) || !normalize_vector(direction)) return;
  for (int k = 0; k < 3; k++) half[k] = to[k] - direction[k];
  if (!normalize_vector(half)) return;
  const double lobe = pow(fmax(0, dot_vectors(shading, half)), material->shininess);
  for (int k = 0; k < 3; k++) shine->highlight[k][i] += light->colour[k] * material->specular * lobe * received;
}

/* One light's share for all pixels of a block at once. */
static void add_light(const StyScene *scene, const StyTracer *tracer, const StyLight *light, const StyBlock *block,
                      StyShine *shine) {
  _Alignas(32) int asks[STY_RAYS];
  double to[3], shading[3];
  StyLane ways[3], distances;
  for (int i = 0; i < STY_RAYS; i++) {
    asks[i] = 0;
    if (!block->valid[i] || !aim_at_light(scene, light, &block->hits, i, to, &distances[i])) continue;
    sty_get_lane(block->hits.shading, i, shading);
    for (int k = 0; k < 3; k++) ways[k][i] = to[k];
    if (dot_vectors(shading, to) > 0) asks[i] = -1;
  }
  if (scene->shadows) sty_trace_shadows(tracer, &block->hits, ways, distances, asks);
  for (int i = 0; i < STY_RAYS; i++) {
    if (!asks[i]) continue;
    sty_get_lane(ways, i, to);
    reflect(block, i, light, to, get_intensity(scene, light, distances[i]), shine);
  }
}

void sty_shine_on_block(const StyScene *scene, const StyTracer *tracer, const StyBlock *block, StyShine *shine) {
  memset(shine, 0, sizeof *shine);
  for (int l = 0; l < scene->light_count; l++) add_light(scene, tracer, &scene->lights[l], block, shine);
}

static void add_luminance(const StyLane colours[3], double factor, StyLane luma) {
  EACH_LANE luma[i] += factor * (0.2126 * colours[0][i] + 0.7152 * colours[1][i] + 0.0722 * colours[2][i]);
}

void sty_light_block(const StyScene *scene, const StyTracer *tracer, const StyBlock *block, StyLane luma) {
  StyShine shine;
  memset(luma, 0, sizeof(StyLane));
  add_luminance(block->albedo, scene->ambient, luma);
  if (!scene->light_count) return;
  sty_shine_on_block(scene, tracer, block, &shine);
  add_luminance(shine.diffuse, 1, luma);
  add_luminance(shine.highlight, 1, luma);
}
