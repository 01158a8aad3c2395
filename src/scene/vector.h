/* Three-vectors in double, for the scene and what looks at it. */
#ifndef STYLUT_SCENE_VECTOR_H
#define STYLUT_SCENE_VECTOR_H

#include <math.h>
#include <stdbool.h>

static inline double dot_vectors(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void subtract_vectors(const double a[3], const double b[3], double out[3]) {
  for (int k = 0; k < 3; k++) out[k] = a[k] - b[k];
}

static inline void cross_vectors(const double a[3], const double b[3], double out[3]) {
  double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
  out[0] = x, out[1] = y, out[2] = z;
}

/* False, and `v` as it was, when it has no direction: zero or not finite. */
static inline bool normalize_vector(double v[3]) {
  double length = sqrt(dot_vectors(v, v));
  if (!(length > 0 && length < INFINITY)) return false;
  double inverse = 1 / length;
  if (inverse == INFINITY) return false;
  for (int k = 0; k < 3; k++) v[k] *= inverse;
  return true;
}

#endif
