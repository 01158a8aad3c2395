/* What tracing a picture will take, without doing it. */
#include "guide/bands.h"
#include "guide/contour.h"
#include "guide/paint.h"
#include "guide/paths.h"
#include "guide/trace.h"

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

/* What hits are asked for beside what the camera's rays meet. */
static void count_rays(const StyScene *scene, const StyTraceOptions *options, StyTraceEstimate *estimate) {
  const double pixels = (double)options->width * options->height, lights = scene->shadows ? scene->light_count : 0;
  double asked = options->groups & STY_GUIDE_LUMA ? 1 : 0;
  estimate->camera_rays = pixels;
  if (options->groups & STY_GUIDE_PATHS) {
    const double surfaces = sty_count_path_surfaces(options->groups), samples = options->paths.samples;
    estimate->paths = pixels * samples;
    estimate->path_rays = estimate->paths * surfaces;
    asked += 1 + samples * (surfaces - 1);
  }
  estimate->shadow_rays = pixels * lights * asked;
}

static void count_bytes(const StyScene *scene, const StyTraceOptions *options, StyTraceEstimate *estimate) {
  const double triangles = count_tree_triangles(scene);
  estimate->build_bytes = BUILD_BYTES * triangles;
  estimate->tree_bytes = TREE_BYTES * triangles;
  estimate->channels = count_channels(options->groups);
  estimate->rows = sty_choose_band_rows(options->width, options->height);
  const double channel = (double)options->width * estimate->rows * sizeof(float);
  estimate->band_bytes = 2 * channel * estimate->channels;
  if (options->groups & STY_GUIDE_CONTOUR) estimate->band_bytes += channel * count_channels(STY_CONTOUR_SOURCES);
}

StyStatus sty_estimate_trace(const StyScene *scene, const StyCamera *camera, const StyTraceOptions *options,
                             StyTraceEstimate *out, StyError *error) {
  StyTraceEstimate estimate = {0};
  StyStatus status = sty_check_trace(scene, camera, options, error);
  if (!status && options->groups & STY_GUIDE_COLOURED)
    status = sty_estimate_palette(scene, &estimate.texture_bytes, &estimate.decode_bytes, error);
  if (status) return status;
  count_rays(scene, options, &estimate);
  count_bytes(scene, options, &estimate);
  *out = estimate;
  return STY_OK;
}
