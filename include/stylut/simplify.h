/* Meshes with no more triangles than a picture shows.
 *
 * Edges collapse (CGAL's Surface_mesh_simplification) until the guide of the scene, at its resolution and from its
 * camera, would change by more than a budget allows; both are rendered to know. Vertices that are left don't move:
 * they keep their normals and texture coordinates. Seams (where neighbours differ in part, normals or texture
 * coordinates) and open borders only lose points that lie along them, and parts keep their numbers. */
#ifndef STYLUT_SIMPLIFY_H
#define STYLUT_SIMPLIFY_H

#include "stylut/guide.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Pictures larger than this have no finer grid to look at silhouettes on. */
#define STY_MOST_SIMPLIFIED_PIXELS (STY_MAX_PIXELS / 4)

/* Silhouettes that move farther than this many pixels are said to move by it. */
#define STY_MOST_SILHOUETTE 4

/* How far a guide is from that of the full scene. */
typedef struct StyGuideChange {
  size_t compared;           /* pixels that both cover */
  double mean, p99, maximum; /* angle between their shading normals, degrees, over those */
  /* By how much silhouettes move, pixels, those between parts included: the Hausdorff distance (maximum norm) of the
   * sets of points that show the same object.I, whichever id has most, on a grid twice as fine as the picture's.
   * A multiple of 1/2. Half a pixel is one step of that grid, which is as good as sampling tells a move at all. */
  double silhouette;
} StyGuideChange;

/* What one render of a scene takes. */
typedef struct StyRenderCost {
  size_t triangles;          /* of all objects, shared ones counted for each */
  double build_ms, trace_ms; /* of the picture itself, normals alone */
  double mesh_bytes;         /* vertices and indices, shared ones once */
  double tree_bytes;         /* see StyTraceTimes */
} StyRenderCost;

typedef struct StySimplifyOptions {
  double max_error;  /* of p99, degrees, 0..180 */
  double silhouette; /* pixels, 0..STY_MOST_SILHOUETTE */
  size_t triangles;  /* 0: as few as the budget allows. Else about so many, all meshes by the same share, whatever the
                        change: it is measured all the same */
} StySimplifyOptions;

typedef struct StySimplification {
  StyRenderCost full, simple;
  StyGuideChange change; /* as rendered; zero where the full meshes stay */
  int trials;            /* renders of simplified meshes; 0: no edge can collapse, or so few were there before */
  double search_ms;      /* all of it, both sides' renders included */
  bool is_simpler;       /* false: nothing could go within the budget, and the scene is as it was */
} StySimplification;

/* What sty_simplify_scene asks of a picture's size and the budgets, before anything is read.
 * STY_ERROR_USAGE: out of range. */
StyStatus sty_check_simplify(int width, int height, const StySimplifyOptions *options, StyError *error);

/* Puts simplified meshes in the place of the scene's, each in turn: a quarter of the triangles as long as the whole
 * picture stays within the budget, then halfway (geometrically) between what does and what doesn't, until the two are
 * within 5 %. The scene's bounds and camera stay those of the full meshes. Meshes should have been repaired
 * (sty_repair_scene). `trace` gives size, flat and frame; its channels don't matter: normals and ids are compared,
 * what other channels show isn't. Deterministic; threads only change the time.
 * On failure the scene is as it was. STY_ERROR_USAGE (sty_check_simplify), STY_ERROR_UNAVAILABLE (a
 * build without CGAL), STY_ERROR_LIBRARY. */
StyStatus sty_simplify_scene(StyScene *scene, const StyCamera *camera, const StyTraceOptions *trace,
                             const StySimplifyOptions *options, const StyRun *run, StySimplification *out,
                             StyError *error);

#ifdef __cplusplus
}
#endif
#endif
