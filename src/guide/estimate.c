/* What tracing a picture will take, without doing it. */
#include "guide/bands.h"
#include "guide/contour.h"
#include "guide/paths.h"

/* What Embree 3's trees took per triangle, while they were built and then, on tori of 0.5 to 50 million triangles with
 * eight-wide nodes; spheres count as triangles. */
static const double BUILD_BYTES = 100, TREE_BYTES = 71;

static int count_channels(unsigned groups) {
  int count = 1; /* A */
  for (int g = 0; g < STY_GROUP_COUNT; g++)
    if (groups & STY_CHANNEL_GROUPS[g].group) count += STY_CHANNEL_GROUPS[g].count;
  return count;
}

/* Meshes that several objects show have one tree. */
static double count_tree_triangles(const StyScene *scene) {
  double count = scene->sphere_count;
  for (int m = 0; m < scene->mesh_count; m++) count += (double)scene->meshes[m]->triangle_count;
  return count;
}

StyTraceEstimate sty_estimate_trace(const StyScene *scene, const StyTraceOptions *options) {
  const double pixels = (double)options->width * options->height, lights = scene->shadows ? scene->light_count : 0;
  const int rows = sty_choose_band_rows(options->width, options->height);
  const double triangles = count_tree_triangles(scene);
  StyTraceEstimate estimate = {
      .camera_rays = pixels, .build_bytes = BUILD_BYTES * triangles, .tree_bytes = TREE_BYTES * triangles};
  double asked = options->groups & STY_GUIDE_LUMA ? 1 : 0;
  if (options->groups & STY_GUIDE_PATHS) {
    const double surfaces = sty_count_path_surfaces(options->groups), samples = options->paths.samples;
    estimate.paths = pixels * samples;
    estimate.path_rays = estimate.paths * surfaces;
    asked += 1 + samples * (surfaces - 1);
  }
  estimate.shadow_rays = pixels * lights * asked;
  estimate.band_bytes = 2.0 * options->width * rows * count_channels(options->groups) * sizeof(float);
  if (options->groups & STY_GUIDE_CONTOUR)
    estimate.band_bytes += (double)options->width * rows * count_channels(STY_CONTOUR_SOURCES) * sizeof(float);
  return estimate;
}
