/* What is worked out for a block of eight pixels, or for a row of them, at once: one source (kernel_bodies.h), compiled
 * for each kind of vector unit. All of them give the same bytes. */
#ifndef STYLUT_GUIDE_KERNELS_H
#define STYLUT_GUIDE_KERNELS_H

#include "guide/channels.h"
#include "guide/contour.h"
#include "guide/film.h"
#include "guide/rays.h"

/* The triangles that eight rays meet, as their meshes have them. */
typedef struct StyTriangles {
  StyFloatLane corners[3][3]; /* corner by corner */
  StyFloatLane normals[3][3]; /* of the corners; only with STY_HIT_SHADING */
  StyFloatLane uvs[3][2];     /* of the corners; only with STY_HIT_UV */
  StyFloatLane found[2];      /* the second and third corner's weight, for rays within the triangle's plane */
  bool is_moved;              /* some stand elsewhere in the rays' space than in their meshes' */
  StyLane matrix[3][4], cofactors[3][3]; /* then what moves places and normals, see StyPlaced */
} StyTriangles;

/* How hits are seen. */
typedef struct StySight {
  const StyScene *scene;
  const StyCamera *camera;
  unsigned groups; /* that samples are made of */
  bool flat;       /* facet normals instead of shading normals */
  bool ray_frame;  /* normals relative to the ray */
} StySight;

/* A row of outlines, and what they are made from: the row above, the row itself and the row below; at the picture's
 * border the row itself stands in for the one that isn't there. */
typedef struct StyOutlines {
  int width;
  bool is_border; /* the first or last row of the picture */
  const float *coverage[3], *depth[3], *normal[3][3];
  const StyContourWeights *weights;
  const StyFootprint *footprint;
  float *strength;
} StyOutlines;

typedef struct StyKernels {
  /* Rays through the block of pixels whose first is (x, y). */
  void (*make_rays)(const StyFilm *film, int x, int y, StyRays *rays);
  /* Fills at, facet, weights and what `parts`, of StyHitPart, asks for, and off with how far the corners are from the
   * origin along an axis; the rest belongs to the caller. */
  void (*meet_triangles)(const StyRays *rays, const StyTriangles *triangles, unsigned parts, StyHits *hits);
  /* Fills what of normal, depth, position, uv, curvature, object and style is among the sight's groups. */
  void (*see_hits)(const StySight *sight, const StyRays *rays, const StyHits *hits, StySamples *samples);
  /* Puts the valid ones (-1; others 0, whose samples may be anything) into the strip's block whose first column is x,
   * and misses in the others' place. */
  void (*set_samples)(const StyChannels *channels, int x, const int valid[STY_LANES], const StySamples *samples,
                      StyStrip *strip);
  void (*draw_outlines)(const StyOutlines *outlines);
} StyKernels;

/* For this processor, see base/processor.h. */
const StyKernels *sty_get_kernels(void);

extern const StyKernels sty_kernels_plain;
#ifdef __x86_64__
extern const StyKernels sty_kernels_avx2, sty_kernels_avx512;
#endif

#endif
