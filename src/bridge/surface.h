/* Door to CGAL's surfaces: winding a soup's triangles alike, and collapsing edges.
 *
 * Triangles are three numbers of points each, points three floats each. CGAL hangs or crashes on triangles that name
 * a point twice, so that these are refused. Built without CGAL (STY_WITH_CGAL not defined) whatever can fail does,
 * with STY_ERROR_UNAVAILABLE. No exception crosses. */
#ifndef STYLUT_BRIDGE_SURFACE_H
#define STYLUT_BRIDGE_SURFACE_H

#include <stddef.h>
#include <stdint.h>

#include "stylut/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct StyTriangles {
  const float *points;
  size_t point_count;
  const uint32_t *corners; /* 3 per triangle */
  size_t triangle_count;
} StyTriangles;

/* The same triangles as a surface: neighbours agree, and points at which it was none are there several times. */
typedef struct StyWinding {
  uint32_t *corners;     /* 3 per triangle; numbers from point_count of the triangles on are added points */
  unsigned char *turned; /* 1 per triangle: whether it is wound the other way */
  uint32_t *origins;     /* the old point of every point, added ones included */
  size_t point_count;
} StyWinding;

/* CGAL's orient_polygon_soup (Gueziec et al., "Cutting and stitching", 2001). The first triangle of a piece rules it.
 * The caller frees the winding with sty_destroy_winding. STY_ERROR_INPUT (a triangle that names a point twice, or one
 * that isn't there), STY_ERROR_LIBRARY (CGAL failed, memory). */
StyStatus sty_wind_triangles(const StyTriangles *triangles, StyWinding *out, StyError *error);
void sty_destroy_winding(StyWinding *winding);

/* A surface whose edges can be collapsed. */
typedef struct StySurface StySurface;

/* What a collapse must leave alone, and what it costs. An edge between triangles of differing groups, or with a
 * triangle on one side only, is part of a seam. A point within a seam goes only along it, and not at all where seams
 * meet or end. */
typedef struct StyCollapseRules {
  const uint32_t *groups;     /* 1 per triangle */
  const float *normals;       /* 9 per triangle, of its corners; a point has one within a group */
  const unsigned char *fixed; /* 1 per point of the triangles: those that never go */
  double angle, distance;     /* turned normals and moved surface that count as much, radians and points' units */
} StyCollapseRules;

/* Everything given is copied. STY_ERROR_INPUT (not a surface), STY_ERROR_LIBRARY. */
StyStatus sty_open_surface(const StyTriangles *triangles, const StyWinding *winding, const StyCollapseRules *rules,
                           StySurface **out, StyError *error);
StyStatus sty_copy_surface(const StySurface *surface, StySurface **out, StyError *error);
void sty_close_surface(StySurface **surface);

/* Collapses edges, cheapest first, until at most `target` triangles are there or no edge is left that may go. A point
 * that goes costs the area around it, times the square of how far its normal and its place are from what the new
 * triangles have there (as Hoppe 1999 measures attributes), and what the points that it stands for cost before. Costs
 * of geometry alone, such as Lindstrom and Turk's, give up eyes and mouths, which are flat and turn sharply. A collapse
 * pulls one point into the other: points never move, so that what belongs to them stays theirs; and never turns a
 * triangle by 90 degrees or more. The same call gives the same surface. STY_ERROR_LIBRARY. */
StyStatus sty_collapse_surface(StySurface *surface, size_t target, StyError *error);

size_t sty_count_surface(const StySurface *surface);

/* Writes triangles by the numbers of the old points, and the number that each had among the triangles first given;
 * sty_count_surface says how many there are. */
void sty_list_surface(const StySurface *surface, uint32_t *corners, uint32_t *numbers);

#ifdef __cplusplus
}
#endif
#endif
