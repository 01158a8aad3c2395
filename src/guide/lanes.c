#include "guide/lanes.h"

#include <math.h>

#define EACH_LANE for (int i = 0; i < STY_LANES; i++)

static inline void subtract(const StyLane *a, const StyLane *b, StyLane *out) {
  for (int k = 0; k < 3; k++) EACH_LANE out[k][i] = a[k][i] - b[k][i];
}

static inline void cross(const StyLane *restrict a, const StyLane *restrict b, StyLane *restrict out) {
  for (int k = 0; k < 3; k++) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    EACH_LANE out[k][i] = a[l][i] * b[m][i] - a[m][i] * b[l][i];
  }
}

static inline void dot(const StyLane *a, const StyLane *b, double *restrict out) {
  EACH_LANE out[i] = a[0][i] * b[0][i] + a[1][i] * b[1][i] + a[2][i] * b[2][i];
}

static inline void weigh(const StyLanes *lanes, const StyLane corners[3][3], StyLane *restrict out) {
  const StyLane *w = lanes->weights;
  for (int k = 0; k < 3; k++)
    EACH_LANE out[k][i] = w[0][i] * corners[0][k][i] + w[1][i] * corners[1][k][i] + w[2][i] * corners[2][k][i];
}

/* Turned to the side that the ray comes from, which `toward` is positive for. */
static inline void face(StyLane *vectors, const double *restrict toward) {
  for (int k = 0; k < 3; k++) EACH_LANE vectors[k][i] = toward[i] < 0 ? -vectors[k][i] : vectors[k][i];
}

static inline void find_weights(StyLanes *lanes, const StyLane *ab, const StyLane *ac) {
  StyLane p[3], q[3], from[3], determinant, u, v;
  cross(lanes->rays->direction, ac, p);
  dot(ab, p, determinant);
  subtract(lanes->rays->origin, lanes->corners[0], from);
  cross(from, ab, q);
  dot(from, p, u);
  dot(lanes->rays->direction, q, v);
  EACH_LANE {
    const bool apart = determinant[i] != 0;
    const double inverse = 1 / (apart ? determinant[i] : 1);
    const double b = apart ? u[i] * inverse : lanes->found[0][i], c = apart ? v[i] * inverse : lanes->found[1][i];
    const double second = b < 0 ? 0 : b > 1 ? 1 : b, rest = 1 - second;
    const double third = c < 0 ? 0 : c > rest ? rest : c;
    lanes->weights[0][i] = 1 - second - third;
    lanes->weights[1][i] = second;
    lanes->weights[2][i] = third;
  }
}

/* The normal of a triangle whose corners' sum to nothing is its facet's. */
static inline void find_shading(StyLanes *lanes) {
  StyLane squared, bare, toward;
  weigh(lanes, lanes->normals, lanes->shading);
  dot(lanes->shading, lanes->shading, squared);
  dot(lanes->facet, lanes->facet, bare);
  EACH_LANE {
    const bool none = !(squared[i] > 0 && squared[i] < INFINITY);
    const double inverse = 1 / sqrt(none ? bare[i] : squared[i]);
    for (int k = 0; k < 3; k++) lanes->shading[k][i] = (none ? lanes->facet[k][i] : lanes->shading[k][i]) * inverse;
  }
  dot(lanes->shading, lanes->facet, toward);
  face(lanes->shading, toward);
}

void sty_meet_triangles(StyLanes *lanes, bool shading) {
  StyLane ab[3], ac[3], away;
  subtract(lanes->corners[1], lanes->corners[0], ab);
  subtract(lanes->corners[2], lanes->corners[0], ac);
  cross(ab, ac, lanes->facet);
  dot(lanes->facet, lanes->rays->direction, away);
  EACH_LANE away[i] = -away[i];
  face(lanes->facet, away);
  find_weights(lanes, ab, ac);
  weigh(lanes, lanes->corners, lanes->at);
  if (shading) find_shading(lanes);
}
