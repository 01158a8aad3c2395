/* The bodies of kernels.h, for whichever vector unit the file that includes this is compiled for; KERNELS is the
 * table's name. Loops over lanes choose between numbers that are both worked out, since branches would keep compilers
 * from taking lanes together. */
#include <math.h>
#include <string.h>

#include "guide/kernels.h"

/* ---- vectors, eight at a time ---- */

static inline void subtract_lanes(const StyLane *a, const StyLane *b, StyLane *restrict out) {
  for (int k = 0; k < 3; k++) EACH_LANE out[k][i] = a[k][i] - b[k][i];
}

static inline void cross_lanes(const StyLane *a, const StyLane *b, StyLane *restrict out) {
  for (int k = 0; k < 3; k++) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    EACH_LANE out[k][i] = a[l][i] * b[m][i] - a[m][i] * b[l][i];
  }
}

static inline void dot_lanes(const StyLane *a, const StyLane *b, double *restrict out) {
  EACH_LANE out[i] = a[0][i] * b[0][i] + a[1][i] * b[1][i] + a[2][i] * b[2][i];
}

/* With the same vector for all. */
static inline void project_lanes(const StyLane *a, const double b[3], double *restrict out) {
  EACH_LANE out[i] = a[0][i] * b[0] + a[1][i] * b[1] + a[2][i] * b[2];
}

/* As normalize_vector: what has no direction stays as it is. */
static inline void normalize_lanes(StyLane *vectors) {
  StyLane squared;
  dot_lanes(vectors, vectors, squared);
  EACH_LANE {
    const double length = sqrt(squared[i]), inverse = 1 / length;
    const double factor = (length > 0) & (length < INFINITY) & (inverse < INFINITY) ? inverse : 1;
    for (int k = 0; k < 3; k++) vectors[k][i] *= factor;
  }
}

/* ---- rays ---- */

static void make_rays(const StyFilm *film, int x, int y, StyRays *restrict rays) {
  const StyCamera *camera = film->camera;
  StyLane s, t;
  EACH_LANE {
    s[i] = film->columns[x + i % STY_BLOCK_WIDTH];
    t[i] = film->rows[y + i / STY_BLOCK_WIDTH];
  }
  for (int k = 0; k < 3; k++) {
    const double right = camera->right[k], up = camera->up[k], back = camera->back[k], start = film->start[k];
    if (camera->perspective) {
      EACH_LANE rays->origin[k][i] = start;
      EACH_LANE rays->direction[k][i] = s[i] * right + t[i] * up - back;
    } else {
      EACH_LANE rays->origin[k][i] = start + (s[i] * right + t[i] * up);
      EACH_LANE rays->direction[k][i] = -back;
    }
  }
}

/* ---- hits ---- */

/* Turned to the side that the ray comes from, which `toward` is positive for. */
static inline void face_lanes(StyLane *vectors, const double *restrict toward) {
  for (int k = 0; k < 3; k++) EACH_LANE vectors[k][i] = toward[i] < 0 ? -vectors[k][i] : vectors[k][i];
}

/* Of `count` numbers at each corner. */
static inline void weigh_corners(const StyLane *weights, const StyLane *a, const StyLane *b, const StyLane *c,
                                 int count, StyLane *restrict out) {
  for (int k = 0; k < count; k++)
    EACH_LANE out[k][i] = weights[0][i] * a[k][i] + weights[1][i] * b[k][i] + weights[2][i] * c[k][i];
}

/* Moeller and Trumbore 1997. */
static inline void find_weights(const StyRays *rays, const StyTriangles *triangles, const StyLane *ab,
                                const StyLane *ac, StyLane *restrict weights) {
  StyLane p[3], q[3], from[3], determinant, u, v;
  cross_lanes(rays->direction, ac, p);
  dot_lanes(ab, p, determinant);
  subtract_lanes(rays->origin, triangles->corners[0], from);
  cross_lanes(from, ab, q);
  dot_lanes(from, p, u);
  dot_lanes(rays->direction, q, v);
  EACH_LANE {
    const bool apart = determinant[i] != 0;
    const double inverse = 1 / (apart ? determinant[i] : 1), b_there = u[i] * inverse, c_there = v[i] * inverse;
    const double b = apart ? b_there : triangles->found[0][i], c = apart ? c_there : triangles->found[1][i];
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
  EACH_LANE {
    const bool some = (squared[i] > 0) & (squared[i] < INFINITY);
    const double inverse = 1 / sqrt(some ? squared[i] : bare[i]);
    for (int k = 0; k < 3; k++) shading[k][i] = (some ? sum[k][i] : facet[k][i]) * inverse;
  }
  dot_lanes(shading, facet, toward);
  face_lanes(shading, toward);
}

/* Half the divergence, over the triangle, of the normal that light would see: `sum` before it has unit length,
 * `shading` after that and as the viewer sees it. */
static inline void find_curvature(const StyTriangles *triangles, const StyLane *ab, const StyLane *ac,
                                  const StyLane *sum, const StyLane *shading, double *restrict curvature) {
  StyLane size, aa, bb, mixed, along, slopes[2][3], on_ab[2], on_ac[2];
  dot_lanes(sum, shading, size); /* negative where it was turned round */
  dot_lanes(ab, ab, aa);
  dot_lanes(ac, ac, bb);
  dot_lanes(ab, ac, mixed);
  for (int e = 0; e < 2; e++) {
    subtract_lanes(triangles->normals[e + 1], triangles->normals[0], slopes[e]);
    dot_lanes(slopes[e], shading, along);
    for (int k = 0; k < 3; k++) EACH_LANE slopes[e][k][i] = (slopes[e][k][i] - along[i] * shading[k][i]) / size[i];
    dot_lanes(slopes[e], ab, on_ab[e]);
    dot_lanes(slopes[e], ac, on_ac[e]);
  }
  EACH_LANE {
    const double determinant = aa[i] * bb[i] - mixed[i] * mixed[i];
    const double divergence = bb[i] * on_ab[0][i] + aa[i] * on_ac[1][i] - mixed[i] * (on_ac[0][i] + on_ab[1][i]);
    const double mean = divergence / determinant / 2;
    curvature[i] = (determinant > 0) & (size[i] != 0) ? mean : 0;
  }
}

static void meet_triangles(const StyRays *rays, const StyTriangles *triangles, unsigned parts, StyHits *restrict hits) {
  StyLane ab[3], ac[3], sum[3], away;
  const StyLane(*normals)[3] = triangles->normals;
  subtract_lanes(triangles->corners[1], triangles->corners[0], ab);
  subtract_lanes(triangles->corners[2], triangles->corners[0], ac);
  cross_lanes(ab, ac, hits->facet);
  dot_lanes(hits->facet, rays->direction, away);
  EACH_LANE away[i] = -away[i];
  face_lanes(hits->facet, away);
  find_weights(rays, triangles, ab, ac, hits->weights);
  weigh_corners(hits->weights, triangles->corners[0], triangles->corners[1], triangles->corners[2], 3, hits->at);
  if (parts & STY_HIT_UV)
    weigh_corners(hits->weights, triangles->uvs[0], triangles->uvs[1], triangles->uvs[2], 2, hits->uv);
  if (!(parts & STY_HIT_SHADING)) return;
  weigh_corners(hits->weights, normals[0], normals[1], normals[2], 3, sum);
  find_shading(sum, hits->facet, hits->shading);
  if (parts & STY_HIT_CURVATURE) find_curvature(triangles, ab, ac, sum, hits->shading, hits->curvature);
}

/* ---- what is seen of them ---- */

static inline void bend_to_horizon(const StyRays *rays, StyLane *normals) {
  StyLane along[3], facing, away, bent[3];
  int any = 0;
  dot_lanes(normals, rays->direction, facing);
  EACH_LANE any |= facing[i] > 0;
  if (!any) return;
  memcpy(along, rays->direction, sizeof along);
  normalize_lanes(along);
  dot_lanes(normals, along, away);
  for (int k = 0; k < 3; k++) EACH_LANE bent[k][i] = normals[k][i] - away[i] * along[k][i];
  normalize_lanes(bent);
  for (int k = 0; k < 3; k++) EACH_LANE normals[k][i] = facing[i] > 0 ? bent[k][i] : normals[k][i];
}

/* In axes that are relative to each ray. */
static inline void turn_normals(const StyCamera *camera, const StyRays *rays, const StyLane *normals,
                                StyLane *restrict out) {
  StyLane right[3], up[3], back[3], along;
  for (int k = 0; k < 3; k++) EACH_LANE back[k][i] = -rays->direction[k][i];
  normalize_lanes(back);
  project_lanes(back, camera->right, along);
  for (int k = 0; k < 3; k++) EACH_LANE right[k][i] = camera->right[k] - along[i] * back[k][i];
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
  for (int k = 0; k < 3; k++) EACH_LANE from_eye[k][i] = hits->at[k][i] - eye[k];
  project_lanes(from_eye, sight->camera->back, along);
  EACH_LANE samples->depth[i] = -along[i] / scale;
  if (!(sight->groups & STY_GUIDE_POSITION)) return;
  for (int k = 0; k < 3; k++) EACH_LANE samples->position[k][i] = hits->at[k][i] / scale + centre[k];
}

static void see_hits(const StySight *sight, const StyRays *rays, const StyHits *hits, StySamples *restrict samples) {
  const unsigned groups = sight->groups;
  if (groups & STY_GUIDE_NORMAL) see_normals(sight, rays, hits, samples->normal);
  if (groups & (STY_GUIDE_DEPTH | STY_GUIDE_POSITION)) see_places(sight, hits, samples);
  if (groups & STY_GUIDE_UV) memcpy(samples->uv, hits->uv, sizeof samples->uv);
  if (groups & STY_GUIDE_CURVATURE) EACH_LANE samples->curvature[i] = hits->curvature[i] * sight->scene->scale;
  if (groups & STY_GUIDE_OBJECT) EACH_LANE samples->object[i] = hits->object[i];
  if (groups & STY_GUIDE_STYLE) EACH_LANE samples->style[i] = hits->style[i];
}

/* ---- pictures ---- */

/* A row of a block: `from` is that of its columns that is the first to be written. */
static inline void set_row(float *plane, const float *values, int count) {
  if (count == STY_BLOCK_WIDTH)
    memcpy(plane, values, STY_BLOCK_WIDTH * sizeof *plane);
  else
    memcpy(plane, values, (size_t)count * sizeof *plane);
}

static void set_samples(const StyGuide *guide, int x, int y, const int valid[STY_LANES], const StySamples *samples) {
  const int width = guide->image->width, height = guide->image->height;
  const int columns = width - x < STY_BLOCK_WIDTH ? width - x : STY_BLOCK_WIDTH;
  for (int p = 0; p < guide->plane_count; p++) {
    const StyGuidePlane *plane = &guide->planes[p];
    const double *lane = (const double *)(const void *)((const char *)samples + plane->field);
    float values[STY_LANES];
    EACH_LANE {
      const float value = (float)lane[i];
      values[i] = valid[i] ? value : plane->miss;
    }
    for (int row = 0; row < STY_BLOCK_HEIGHT; row++)
      if (y + row >= 0 && y + row < height)
        set_row(plane->values + (size_t)(y + row) * (size_t)width + (size_t)x, values + row * STY_BLOCK_WIDTH, columns);
  }
}

/* The way of the pixel's depth from the line between two neighbours; infinite beside a miss. */
static inline double leave_line(const StyOutlines *outlines, int x, int row_before, int before, int row_after,
                                int after, bool is_border) {
  const bool missing = (outlines->coverage[row_before][before] == 0) | (outlines->coverage[row_after][after] == 0);
  const double here = (double)outlines->depth[1][x];
  const double sum = (double)outlines->depth[row_before][before] + (double)outlines->depth[row_after][after];
  const double way = is_border ? 0 : fabs(sum / 2 - here);
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
static inline float get_strength(const StyOutlines *outlines, int x, int left, int right, bool at_side) {
  const double across = leave_line(outlines, x, 1, left, 1, right, at_side);
  const double down = leave_line(outlines, x, 0, x, 2, x, outlines->is_border);
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
  strength[0] = get_strength(&outlines, 0, 0, last > 0, true);
  for (int x = 1; x < last; x++) strength[x] = get_strength(&outlines, x, x - 1, x + 1, false);
  if (last > 0) strength[last] = get_strength(&outlines, last, last - 1, last, true);
}

const StyKernels KERNELS = {make_rays, meet_triangles, see_hits, set_samples, draw_outlines};
