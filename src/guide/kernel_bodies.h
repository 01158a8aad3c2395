/* The bodies of kernels.h, for whichever vector unit the file that includes this is compiled for; KERNELS is the
 * table's name. Loops over lanes choose between numbers that are both worked out, since branches would keep compilers
 * from taking lanes together. */
#include <math.h>
#include <string.h>

#include "guide/kernels.h"

/* No lane of a loop has to do with another, and none is to be unrolled before it is made a vector of. */
#define SIMD_LANES _Pragma("omp simd") EACH_LANE

/* ---- vectors, eight at a time ---- */

static inline void subtract_lanes(const StyLane *a, const StyLane *b, StyLane *restrict out) {
  for (int k = 0; k < 3; k++) SIMD_LANES out[k][i] = a[k][i] - b[k][i];
}

static inline void cross_lanes(const StyLane *a, const StyLane *b, StyLane *restrict out) {
  for (int k = 0; k < 3; k++) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    SIMD_LANES out[k][i] = a[l][i] * b[m][i] - a[m][i] * b[l][i];
  }
}

static inline void dot_lanes(const StyLane *a, const StyLane *b, double *restrict out) {
  SIMD_LANES out[i] = a[0][i] * b[0][i] + a[1][i] * b[1][i] + a[2][i] * b[2][i];
}

/* With the same vector for all. */
static inline void project_lanes(const StyLane *a, const double b[3], double *restrict out) {
  SIMD_LANES out[i] = a[0][i] * b[0] + a[1][i] * b[1] + a[2][i] * b[2];
}

/* As normalize_vector: what has no direction stays as it is. */
static inline void normalize_lanes(StyLane *vectors) {
  StyLane squared;
  dot_lanes(vectors, vectors, squared);
  SIMD_LANES {
    const double length = sqrt(squared[i]), inverse = 1 / length;
    const double factor = ((length > 0) & (length < INFINITY) & (inverse < INFINITY)) ? inverse : 1;
    for (int k = 0; k < 3; k++) vectors[k][i] *= factor;
  }
}

/* ---- rays ---- */

static void make_rays(const StyFilm *film, int x, int y, StyRays *restrict rays) {
  const StyCamera *camera = film->camera;
  StyLane s, t;
  for (int row = 0; row < STY_BLOCK_HEIGHT; row++)
    for (int column = 0; column < STY_BLOCK_WIDTH; column++) {
      s[row * STY_BLOCK_WIDTH + column] = film->columns[x + column];
      t[row * STY_BLOCK_WIDTH + column] = film->rows[y + row];
    }
  for (int k = 0; k < 3; k++) {
    const double right = camera->right[k], up = camera->up[k], back = camera->back[k], start = film->start[k];
    if (camera->perspective) {
      SIMD_LANES rays->origin[k][i] = start;
      SIMD_LANES rays->direction[k][i] = s[i] * right + t[i] * up - back;
    } else {
      SIMD_LANES rays->origin[k][i] = start + (s[i] * right + t[i] * up);
      SIMD_LANES rays->direction[k][i] = -back;
    }
  }
}

/* ---- hits ---- */

/* Turned to the side that the ray comes from, which `toward` is positive for. */
static inline void face_lanes(StyLane *vectors, const double *restrict toward) {
  for (int k = 0; k < 3; k++) SIMD_LANES vectors[k][i] = toward[i] < 0 ? -vectors[k][i] : vectors[k][i];
}

static inline void weigh_corners(const StyLane *weights, const StyLane corners[3][3], StyLane *restrict out) {
  for (int k = 0; k < 3; k++)
    SIMD_LANES out[k][i] =
        weights[0][i] * corners[0][k][i] + weights[1][i] * corners[1][k][i] + weights[2][i] * corners[2][k][i];
}

/* Triangles in the rays' space. */
typedef struct Placed {
  StyLane corners[3][3], normals[3][3];
} Placed;

static inline void move_points(const StyLane matrix[3][4], StyLane *points) {
  StyLane moved[3];
  for (int k = 0; k < 3; k++) {
    dot_lanes(matrix[k], points, moved[k]);
    SIMD_LANES moved[k][i] += matrix[k][3][i];
  }
  memcpy(points, moved, sizeof moved);
}

static inline void move_normals(const StyLane cofactors[3][3], StyLane *normals) {
  StyLane moved[3];
  for (int k = 0; k < 3; k++) dot_lanes(cofactors[k], normals, moved[k]);
  memcpy(normals, moved, sizeof moved);
}

static inline void place_triangles(const StyTriangles *triangles, bool shading, Placed *restrict placed) {
  for (int c = 0; c < 3; c++) {
    for (int k = 0; k < 3; k++) SIMD_LANES placed->corners[c][k][i] = (double)triangles->corners[c][k][i];
    if (triangles->is_moved) move_points(triangles->matrix, placed->corners[c]);
    if (!shading) continue;
    for (int k = 0; k < 3; k++) SIMD_LANES placed->normals[c][k][i] = (double)triangles->normals[c][k][i];
    if (triangles->is_moved) move_normals(triangles->cofactors, placed->normals[c]);
  }
}

/* Moeller and Trumbore 1997. */
static inline void find_weights(const StyRays *rays, const StyLane *first, const StyLane *ab, const StyLane *ac,
                                const StyFloatLane found[2], StyLane *restrict weights) {
  StyLane p[3], q[3], from[3], determinant, u, v;
  cross_lanes(rays->direction, ac, p);
  dot_lanes(ab, p, determinant);
  subtract_lanes(rays->origin, first, from);
  cross_lanes(from, ab, q);
  dot_lanes(from, p, u);
  dot_lanes(rays->direction, q, v);
  SIMD_LANES {
    const bool apart = determinant[i] != 0;
    const double inverse = 1 / (apart ? determinant[i] : 1), b_there = u[i] * inverse, c_there = v[i] * inverse;
    const double b = apart ? b_there : (double)found[0][i], c = apart ? c_there : (double)found[1][i];
    const double second = b < 0 ? 0 : b > 1 ? 1 : b, rest = 1 - second;
    const double third = c < 0 ? 0 : c > rest ? rest : c;
    weights[0][i] = 1 - second - third;
    weights[1][i] = second;
    weights[2][i] = third;
  }
}

/* Of the sum of the corners' normals; the facet's, where that is nothing. */
static inline void find_shading(const StyLane *sum, const StyLane *facet, StyLane *restrict shading) {
  StyLane squared, bare, toward;
  dot_lanes(sum, sum, squared);
  dot_lanes(facet, facet, bare);
  SIMD_LANES {
    const bool some = (squared[i] > 0) & (squared[i] < INFINITY);
    const double inverse = 1 / sqrt(some ? squared[i] : bare[i]);
    for (int k = 0; k < 3; k++) shading[k][i] = (some ? sum[k][i] : facet[k][i]) * inverse;
  }
  dot_lanes(shading, facet, toward);
  face_lanes(shading, toward);
}

/* Half the divergence, over the triangle, of the normal that light would see: `sum` before it has unit length,
 * `shading` after that and as the viewer sees it. */
static inline void find_curvature(const Placed *placed, const StyLane *ab, const StyLane *ac, const StyLane *sum,
                                  const StyLane *shading, double *restrict curvature) {
  StyLane size, aa, bb, mixed, along, step[3], on_ab[2], on_ac[2];
  dot_lanes(sum, shading, size); /* negative where it was turned round */
  dot_lanes(ab, ab, aa);
  dot_lanes(ac, ac, bb);
  dot_lanes(ab, ac, mixed);
  for (int e = 0; e < 2; e++) {
    subtract_lanes(placed->normals[e + 1], placed->normals[0], step);
    dot_lanes(step, shading, along);
    for (int k = 0; k < 3; k++) SIMD_LANES step[k][i] -= along[i] * shading[k][i];
    dot_lanes(step, ab, on_ab[e]);
    dot_lanes(step, ac, on_ac[e]);
  }
  SIMD_LANES {
    const double determinant = aa[i] * bb[i] - mixed[i] * mixed[i];
    const double divergence = bb[i] * on_ab[0][i] + aa[i] * on_ac[1][i] - mixed[i] * (on_ac[0][i] + on_ab[1][i]);
    const double mean = divergence / (2 * determinant * size[i]);
    curvature[i] = ((determinant > 0) & (size[i] != 0)) ? mean : 0;
  }
}

/* How far their corners are from the origin, along the axes. */
static inline void find_reach(const StyLane corners[3][3], double *restrict reach) {
  SIMD_LANES reach[i] = 0;
  for (int c = 0; c < 3; c++)
    for (int k = 0; k < 3; k++)
      SIMD_LANES reach[i] = fabs(corners[c][k][i]) > reach[i] ? fabs(corners[c][k][i]) : reach[i];
}

static inline void weigh_uvs(const StyLane *weights, const StyFloatLane uvs[3][2], StyLane *restrict out) {
  for (int k = 0; k < 2; k++)
    SIMD_LANES out[k][i] = weights[0][i] * (double)uvs[0][k][i] + weights[1][i] * (double)uvs[1][k][i] +
                           weights[2][i] * (double)uvs[2][k][i];
}

static void meet_triangles(const StyRays *rays, const StyTriangles *triangles, unsigned parts, StyHits *restrict hits) {
  StyLane ab[3], ac[3], sum[3], away;
  Placed placed;
  place_triangles(triangles, parts & STY_HIT_SHADING, &placed);
  subtract_lanes(placed.corners[1], placed.corners[0], ab);
  subtract_lanes(placed.corners[2], placed.corners[0], ac);
  cross_lanes(ab, ac, hits->facet);
  dot_lanes(hits->facet, rays->direction, away);
  SIMD_LANES away[i] = -away[i];
  face_lanes(hits->facet, away);
  find_weights(rays, placed.corners[0], ab, ac, triangles->found, hits->weights);
  weigh_corners(hits->weights, placed.corners, hits->at);
  if (parts & STY_HIT_UV) weigh_uvs(hits->weights, triangles->uvs, hits->uv);
  if (parts & STY_HIT_LEAVE) find_reach(placed.corners, hits->off);
  if (!(parts & STY_HIT_SHADING)) return;
  weigh_corners(hits->weights, placed.normals, sum);
  find_shading(sum, hits->facet, hits->shading);
  if (parts & STY_HIT_CURVATURE) find_curvature(&placed, ab, ac, sum, hits->shading, hits->curvature);
}

/* ---- what is seen of them ---- */

static inline void bend_to_horizon(const StyRays *rays, StyLane *normals) {
  StyLane along[3], facing, away, bent[3];
  int any = 0;
  dot_lanes(normals, rays->direction, facing);
  for (int i = 0; i < STY_LANES; i++) any |= facing[i] > 0;
  if (!any) return;
  memcpy(along, rays->direction, sizeof along);
  normalize_lanes(along);
  dot_lanes(normals, along, away);
  for (int k = 0; k < 3; k++) SIMD_LANES bent[k][i] = normals[k][i] - away[i] * along[k][i];
  normalize_lanes(bent);
  for (int k = 0; k < 3; k++) SIMD_LANES normals[k][i] = facing[i] > 0 ? bent[k][i] : normals[k][i];
}

/* In axes that are relative to each ray. */
static inline void turn_normals(const StyCamera *camera, const StyRays *rays, const StyLane *normals,
                                StyLane *restrict out) {
  StyLane right[3], up[3], back[3], along;
  for (int k = 0; k < 3; k++) SIMD_LANES back[k][i] = -rays->direction[k][i];
  normalize_lanes(back);
  project_lanes(back, camera->right, along);
  for (int k = 0; k < 3; k++) SIMD_LANES right[k][i] = camera->right[k] - along[i] * back[k][i];
  normalize_lanes(right);
  cross_lanes(back, right, up);
  dot_lanes(normals, right, out[0]);
  dot_lanes(normals, up, out[1]);
  dot_lanes(normals, back, out[2]);
}

static inline void see_normals(const StySight *sight, const StyRays *rays, const StyHits *hits, StyLane *restrict out) {
  const StyCamera *camera = sight->camera;
  StyLane normals[3];
  memcpy(normals, sight->flat ? hits->facet : hits->shading, sizeof normals);
  if (sight->flat)
    normalize_lanes(normals);
  else
    bend_to_horizon(rays, normals);
  if (sight->ray_frame && camera->perspective) {
    turn_normals(camera, rays, normals, out);
    return;
  }
  project_lanes(normals, camera->right, out[0]);
  project_lanes(normals, camera->up, out[1]);
  project_lanes(normals, camera->back, out[2]);
}

static inline void see_places(const StySight *sight, const StyHits *hits, StySamples *restrict samples) {
  const double *eye = sight->camera->eye, *centre = sight->scene->centre, scale = sight->scene->scale;
  StyLane from_eye[3], along;
  for (int k = 0; k < 3; k++) SIMD_LANES from_eye[k][i] = hits->at[k][i] - eye[k];
  project_lanes(from_eye, sight->camera->back, along);
  SIMD_LANES samples->depth[i] = -along[i] / scale;
  if (!(sight->groups & STY_GUIDE_POSITION)) return;
  for (int k = 0; k < 3; k++) SIMD_LANES samples->position[k][i] = hits->at[k][i] / scale + centre[k];
}

static void see_hits(const StySight *sight, const StyRays *rays, const StyHits *hits, StySamples *restrict samples) {
  const unsigned groups = sight->groups;
  if (groups & STY_GUIDE_NORMAL) see_normals(sight, rays, hits, samples->normal);
  if (groups & (STY_GUIDE_DEPTH | STY_GUIDE_POSITION)) see_places(sight, hits, samples);
  if (groups & STY_GUIDE_UV) memcpy(samples->uv, hits->uv, sizeof samples->uv);
  if (groups & STY_GUIDE_CURVATURE) SIMD_LANES samples->curvature[i] = hits->curvature[i] * sight->scene->scale;
  if (groups & STY_GUIDE_OBJECT) SIMD_LANES samples->object[i] = hits->object[i];
  if (groups & STY_GUIDE_STYLE) SIMD_LANES samples->style[i] = hits->style[i];
}

/* ---- pictures ---- */

static void set_samples(const StyChannels *channels, int x, const int valid[STY_LANES], const StySamples *samples,
                        StyStrip *restrict strip) {
  const StyLane *lanes = (const StyLane *)(const void *)samples;
  for (int c = 0; c < channels->count; c++) {
    const double *lane = lanes[channels->channels[c].lane];
    const float miss = channels->channels[c].miss;
    float(*rows)[STY_STRIP_WIDTH] = strip->values[channels->channels[c].lane], values[STY_LANES];
    SIMD_LANES values[i] = valid[i] ? (float)lane[i] : miss;
    for (int row = 0; row < STY_BLOCK_HEIGHT; row++)
      memcpy(&rows[row][x], values + row * STY_BLOCK_WIDTH, STY_BLOCK_WIDTH * sizeof *values);
  }
}

/* The way of the pixel's depth from the line between two neighbours; infinite beside a miss, and 0 at the border, where
 * `inside` is 0 instead of 1. */
static inline double leave_line(const StyOutlines *outlines, int x, int row_before, int before, int row_after,
                                int after, double inside) {
  const bool missing = (outlines->coverage[row_before][before] == 0) | (outlines->coverage[row_after][after] == 0);
  const double here = (double)outlines->depth[1][x];
  const double sum = (double)outlines->depth[row_before][before] + (double)outlines->depth[row_after][after];
  const double way = inside * fabs(sum / 2 - here);
  return missing ? INFINITY : way;
}

static inline double get_turn(const StyOutlines *outlines, int x, int row, int other) {
  double cosine = 0;
  for (int k = 0; k < 3; k++) cosine += (double)outlines->normal[1][k][x] * (double)outlines->normal[row][k][other];
  const double turn = 1 - cosine;
  return outlines->coverage[row][other] == 0 ? 0 : turn;
}

static inline double get_most(double a, double b) { return b > a ? b : a; }

/* `left` and `right` are the neighbours' columns, x itself beyond the border. */
static inline float get_strength(const StyOutlines *outlines, int x, int left, int right, double inside) {
  const double across = leave_line(outlines, x, 1, left, 1, right, inside);
  const double down = leave_line(outlines, x, 0, x, 2, x, outlines->is_border ? 0 : 1);
  const double aside = get_most(get_turn(outlines, x, 1, left), get_turn(outlines, x, 1, right));
  const double around = get_most(get_turn(outlines, x, 0, x), get_turn(outlines, x, 2, x));
  const double footprint = outlines->footprint->constant + outlines->footprint->slope * (double)outlines->depth[1][x];
  const double spans = get_most(across, down) / (footprint * STY_CONTOUR_SPAN), gap = spans < 1 ? spans : 1;
  const double turn = get_most(get_most(0, aside), around);
  const double sum = outlines->weights->depth * gap + outlines->weights->normal * turn;
  const double strength = sum < 0 ? 0 : sum > 1 ? 1 : sum;
  return outlines->coverage[1][x] == 0 ? 0.0f : (float)strength;
}

static void draw_outlines(const StyOutlines *given) {
  const StyOutlines outlines = *given; /* which nothing that is written can be part of */
  const int last = outlines.width - 1;
  float *restrict strength = outlines.strength;
  strength[0] = get_strength(&outlines, 0, 0, last > 0, 0);
#ifndef __clang__ /* whose version 14 says that it can't */
#pragma omp simd
#endif
  for (int x = 1; x < last; x++) strength[x] = get_strength(&outlines, x, x - 1, x + 1, 1);
  if (last > 0) strength[last] = get_strength(&outlines, last, last - 1, last, 0);
}

const StyKernels KERNELS = {make_rays, meet_triangles, see_hits, set_samples, draw_outlines};
