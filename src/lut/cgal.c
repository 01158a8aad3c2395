/* CGAL's kd-tree with sliding midpoints, on collapsed points. */
#include <math.h>

#include "bridge/neighbours.h"
#include "lut/engine.h"

static bool find_nearest(const StySearch *search, const float *at, int count, int *found) {
  return sty_find_neighbours(search->index, at, count, found) == count;
}

static int find_within(const StySearch *search, const float *at, float squared_radius, int most, int *found) {
  return sty_find_neighbours_within(search->index, at, sqrt((double)squared_radius), most, found);
}

StyStatus sty_build_cgal(const StySites *sites, const StyEngineOptions *options, StyLut *lut, const StyRun *run,
                         StyError *error) {
  (void)options;
  StyPoints points;
  StyStatus status = sty_collapse_sites(sites, &lut->spec, &points, error);
  if (status) return status;
  lut->unique = points.count;
  StyNeighbours *tree = NULL;
  status = sty_open_neighbours(points.values, points.count, points.measure.dims, &tree, error);
  if (!status) {
    const StySearch search = {&points, tree, find_nearest, find_within};
    status = sty_search_table("cgal", &search, lut, run, error);
    sty_close_neighbours(&tree);
  }
  sty_free_points(&points);
  return status;
}
