#include "guide/light.h"

#include <math.h>

#include "scene/points.h"
#include "scene/vector.h"

static double get_luminance(const double colour[3]) {
  return 0.2126 * colour[0] + 0.7152 * colour[1] + 0.0722 * colour[2];
}

bool sty_aim_at_light(const StyScene *scene, const StyLight *light, const StyHit *hit, double to[3], double *distance) {
  double from[3];
  sty_get_trace_point(scene, light->position, from);
  for (int k = 0; k < 3; k++) to[k] = light->is_point ? from[k] - hit->at[k] : -light->direction[k];
  *distance = light->is_point ? sqrt(dot_vectors(to, to)) : INFINITY;
  return normalize_vector(to);
}

double sty_get_intensity(const StyScene *scene, const StyLight *light, double distance) {
  const double world = distance / scene->scale;
  return light->is_point ? light->intensity / (world * world) : light->intensity;
}

/* Of one light that is not hidden. */
static double reflect(const StyBlock *block, int i, const StyLight *light, const double to[3], double received) {
  const StyHit *hit = &block->hits[i];
  const StyLane *direction = block->rays.direction;
  double colour[3], half[3], toward[3] = {-direction[0][i], -direction[1][i], -direction[2][i]};
  for (int k = 0; k < 3; k++) colour[k] = block->albedo[i][k] * light->colour[k];
  double luma = get_luminance(colour) * dot_vectors(hit->shading, to);
  if (hit->material->specular > 0 && normalize_vector(toward)) {
    for (int k = 0; k < 3; k++) half[k] = toward[k] + to[k];
    if (normalize_vector(half))
      luma += get_luminance(light->colour) * hit->material->specular *
              pow(fmax(0, dot_vectors(hit->shading, half)), hit->material->shininess);
  }
  return luma * received;
}

/* One light's share for all pixels of a block at once. */
static void add_light(const StyScene *scene, const StyTracer *tracer, const StyLight *light, StyBlock *block) {
  _Alignas(32) int asks[STY_RAYS];
  double to[STY_RAYS][3], distances[STY_RAYS];
  for (int i = 0; i < STY_RAYS; i++) {
    asks[i] = 0;
    if (!block->valid[i] || !sty_aim_at_light(scene, light, &block->hits[i], to[i], &distances[i])) continue;
    if (dot_vectors(block->hits[i].shading, to[i]) > 0) asks[i] = -1;
  }
  if (scene->shadows) sty_trace_shadows(tracer, block->hits, to, distances, asks);
  for (int i = 0; i < STY_RAYS; i++)
    if (asks[i]) block->luma[i] += reflect(block, i, light, to[i], sty_get_intensity(scene, light, distances[i]));
}

void sty_light_block(const StyScene *scene, const StyTracer *tracer, StyBlock *block) {
  for (int i = 0; i < STY_RAYS; i++)
    block->luma[i] = block->valid[i] ? scene->ambient * get_luminance(block->albedo[i]) : 0;
  for (int l = 0; l < scene->light_count; l++) add_light(scene, tracer, &scene->lights[l], block);
}
