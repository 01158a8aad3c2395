/* creature: our own model, a small dragon that waves.
 *
 *   creature OUT.ply
 *
 * Ellipsoids and tapered tubes are blended into one signed field by smooth
 * minima, and CGAL meshes its zero set. Round forms show a style's large
 * chunks; ears, horns, fingers, tail and spines try it where there is little
 * room. Y is up, the creature faces +Z and stands about two units tall.
 * Only + - * / and sqrt are used, so the field is the same everywhere. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bridge/cgal.h"
#include "stylut/file.h"

typedef struct Vector {
  double x, y, z;
} Vector;

static Vector add(Vector a, Vector b) { return (Vector){a.x + b.x, a.y + b.y, a.z + b.z}; }
static Vector subtract(Vector a, Vector b) { return (Vector){a.x - b.x, a.y - b.y, a.z - b.z}; }
static Vector scale(Vector a, double by) { return (Vector){a.x * by, a.y * by, a.z * by}; }
static double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static double measure(Vector a) { return sqrt(dot(a, a)); }
static Vector normalize(Vector a) { return scale(a, 1.0 / measure(a)); }
static Vector cross(Vector a, Vector b) {
  return (Vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* An ellipsoid whose second axis points along `axis` and whose third faces
 * `front` as nearly as that allows. Negative `blend` carves it away. */
typedef struct Ellipsoid {
  Vector center, radii, axis, front;
  double blend;
} Ellipsoid;

/* A tube along a quadratic Bezier curve, its radius going evenly from one end
 * to the other. */
typedef struct Tube {
  Vector from, by, to;
  double radius_from, radius_to;
  double blend;
} Tube;

#define UPRIGHT \
  {0.0, 1.0, 0.0}, { 0.0, 0.0, 1.0 }
#define HEAD_TILT \
  {0.17, 0.98, 0.05}, { 0.10, 0.0, 1.0 }

static const Ellipsoid body[] = {
    {{0.00, -0.40, 0.03}, {0.42, 0.41, 0.39}, UPRIGHT, 0.0},
    {{0.02, -0.02, -0.02}, {0.27, 0.28, 0.24}, UPRIGHT, 0.16},
    {{0.06, 0.43, 0.06}, {0.37, 0.31, 0.33}, HEAD_TILT, 0.06},
    {{0.00, 0.31, 0.33}, {0.21, 0.14, 0.20}, HEAD_TILT, 0.10},
    {{-0.13, 0.32, 0.22}, {0.15, 0.12, 0.15}, HEAD_TILT, 0.08},
    {{0.19, 0.27, 0.22}, {0.15, 0.12, 0.15}, HEAD_TILT, 0.08},
    {{-0.22, -0.90, 0.16}, {0.15, 0.10, 0.23}, {0.0, 1.0, 0.0}, {-0.35, 0.0, 1.0}, 0.06},
    {{0.27, -0.90, 0.10}, {0.15, 0.10, 0.23}, {0.0, 1.0, 0.0}, {0.55, 0.0, 1.0}, 0.06},
};

static const Tube limbs[] = {
    /* legs */
    {{-0.20, -0.55, 0.04}, {-0.27, -0.72, 0.10}, {-0.21, -0.88, 0.06}, 0.21, 0.13, 0.09},
    {{0.20, -0.55, 0.04}, {0.29, -0.72, 0.08}, {0.25, -0.88, 0.02}, 0.21, 0.13, 0.09},
    /* tail, coming round to the front */
    {{0.00, -0.62, -0.22}, {-0.25, -0.98, -0.62}, {-0.66, -0.80, -0.36}, 0.20, 0.105, 0.12},
    {{-0.66, -0.80, -0.36}, {-1.02, -0.64, -0.13}, {-0.86, -0.30, -0.06}, 0.105, 0.06, 0.004},
    {{-0.86, -0.30, -0.06}, {-0.74, -0.08, -0.02}, {-0.90, 0.05, 0.00}, 0.06, 0.03, 0.004},
    /* the arm that waves */
    {{0.20, 0.08, 0.00}, {0.56, -0.14, 0.08}, {0.75, 0.10, 0.18}, 0.115, 0.08, 0.07},
    {{0.75, 0.10, 0.18}, {0.82, 0.19, 0.21}, {0.86, 0.27, 0.23}, 0.08, 0.085, 0.006},
    /* the arm on the hip */
    {{-0.22, 0.06, 0.00}, {-0.62, -0.02, -0.06}, {-0.60, -0.22, 0.06}, 0.115, 0.09, 0.07},
    {{-0.60, -0.22, 0.06}, {-0.56, -0.34, 0.20}, {-0.38, -0.36, 0.26}, 0.09, 0.075, 0.006},
};

static const Tube details[] = {
    /* fingers of the raised hand, thumb first */
    {{0.83, 0.27, 0.25}, {0.73, 0.32, 0.33}, {0.71, 0.40, 0.36}, 0.045, 0.032, 0.035},
    {{0.84, 0.32, 0.23}, {0.79, 0.46, 0.25}, {0.80, 0.54, 0.27}, 0.042, 0.030, 0.025},
    {{0.88, 0.33, 0.23}, {0.91, 0.46, 0.24}, {0.93, 0.56, 0.25}, 0.042, 0.030, 0.025},
    {{0.91, 0.30, 0.22}, {1.01, 0.38, 0.22}, {1.06, 0.46, 0.23}, 0.040, 0.028, 0.025},
    /* fingers on the hip */
    {{-0.38, -0.33, 0.27}, {-0.30, -0.28, 0.36}, {-0.22, -0.27, 0.385}, 0.042, 0.032, 0.02},
    {{-0.37, -0.37, 0.28}, {-0.28, -0.37, 0.37}, {-0.19, -0.38, 0.40}, 0.042, 0.032, 0.02},
    {{-0.37, -0.41, 0.27}, {-0.29, -0.46, 0.35}, {-0.21, -0.49, 0.39}, 0.042, 0.032, 0.02},
    /* toes */
    {{-0.36, -0.92, 0.28}, {-0.38, -0.93, 0.33}, {-0.39, -0.945, 0.37}, 0.062, 0.045, 0.02},
    {{-0.28, -0.92, 0.32}, {-0.29, -0.93, 0.38}, {-0.30, -0.945, 0.42}, 0.062, 0.045, 0.02},
    {{-0.19, -0.92, 0.31}, {-0.19, -0.93, 0.36}, {-0.19, -0.945, 0.40}, 0.062, 0.045, 0.02},
    {{0.30, -0.92, 0.26}, {0.32, -0.93, 0.32}, {0.33, -0.945, 0.36}, 0.062, 0.045, 0.02},
    {{0.38, -0.92, 0.24}, {0.41, -0.93, 0.29}, {0.44, -0.945, 0.33}, 0.062, 0.045, 0.02},
    {{0.44, -0.92, 0.17}, {0.48, -0.93, 0.20}, {0.52, -0.945, 0.23}, 0.062, 0.045, 0.02},
    /* horns */
    {{-0.06, 0.64, 0.02}, {-0.22, 0.86, 0.02}, {-0.10, 1.04, -0.12}, 0.075, 0.018, 0.03},
    {{0.28, 0.60, 0.02}, {0.50, 0.78, 0.02}, {0.44, 0.98, -0.12}, 0.075, 0.018, 0.03},
    /* brows */
    {{-0.215, 0.580, 0.21}, {-0.14, 0.705, 0.22}, {-0.035, 0.675, 0.29}, 0.028, 0.036, 0.03},
    {{0.130, 0.635, 0.30}, {0.24, 0.645, 0.26}, {0.305, 0.500, 0.235}, 0.036, 0.028, 0.03},
    /* spines down the back */
    {{0.10, 0.70, -0.06}, {0.12, 0.78, -0.10}, {0.12, 0.84, -0.19}, 0.060, 0.015, 0.03},
    {{0.08, 0.60, -0.20}, {0.09, 0.67, -0.29}, {0.09, 0.70, -0.38}, 0.065, 0.015, 0.03},
    {{0.05, 0.34, -0.24}, {0.05, 0.37, -0.34}, {0.05, 0.38, -0.43}, 0.065, 0.015, 0.03},
    {{0.03, 0.08, -0.24}, {0.03, 0.11, -0.34}, {0.03, 0.11, -0.45}, 0.075, 0.015, 0.03},
    {{0.01, -0.18, -0.32}, {0.01, -0.16, -0.42}, {0.01, -0.17, -0.52}, 0.080, 0.015, 0.03},
    {{-0.03, -0.48, -0.40}, {-0.03, -0.46, -0.50}, {-0.03, -0.48, -0.60}, 0.075, 0.015, 0.03},
    {{-0.25, -0.70, -0.50}, {-0.26, -0.66, -0.57}, {-0.28, -0.62, -0.66}, 0.060, 0.015, 0.03},
    /* barbs and point of the tail's spade */
    {{-0.90, 0.08, 0.01}, {-0.97, 0.09, 0.00}, {-1.03, 0.02, 0.00}, 0.042, 0.016, 0.04},
    {{-0.90, 0.08, 0.01}, {-0.84, 0.13, 0.02}, {-0.765, 0.09, 0.03}, 0.042, 0.016, 0.04},
    {{-0.90, 0.10, 0.01}, {-0.92, 0.20, 0.01}, {-0.97, 0.31, 0.02}, 0.070, 0.014, 0.05},
};

static const Ellipsoid features[] = {
    /* ears: each a leaf, then its hollow */
    {{-0.45, 0.60, 0.00}, {0.145, 0.28, 0.055}, {-0.94, 0.30, -0.10}, {-0.10, 0.20, 1.0}, 0.04},
    {{-0.47, 0.605, 0.050}, {0.085, 0.20, 0.045}, {-0.94, 0.30, -0.10}, {-0.10, 0.20, 1.0}, -0.02},
    {{0.50, 0.47, -0.04}, {0.135, 0.25, 0.055}, {0.93, 0.10, -0.30}, {0.10, 0.25, 1.0}, 0.04},
    {{0.52, 0.47, 0.010}, {0.080, 0.18, 0.045}, {0.93, 0.10, -0.30}, {0.10, 0.25, 1.0}, -0.02},
    /* the tail's spade */
    {{-0.90, 0.11, 0.01}, {0.090, 0.100, 0.045}, {-0.25, 0.97, 0.05}, {0.1, 0.0, 1.0}, 0.03},
    /* eyes, the dents of their pupils, nose */
    {{-0.085, 0.535, 0.325}, {0.078, 0.088, 0.070}, HEAD_TILT, 0.010},
    {{0.185, 0.490, 0.330}, {0.078, 0.088, 0.070}, HEAD_TILT, 0.010},
    {{-0.070, 0.530, 0.410}, {0.036, 0.044, 0.032}, HEAD_TILT, -0.008},
    {{0.205, 0.485, 0.412}, {0.036, 0.044, 0.032}, HEAD_TILT, -0.008},
    {{0.02, 0.385, 0.505}, {0.075, 0.050, 0.050}, HEAD_TILT, 0.025},
};

/* Carved last: the smile, higher on one side. */
static const Tube smile = {{-0.225, 0.345, 0.350}, {0.00, 0.13, 0.64}, {0.23, 0.305, 0.368}, 0.017, 0.020, 0.015};

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static Vector find_curve_point(const Tube *tube, double t) {
  Vector a = scale(tube->from, (1.0 - t) * (1.0 - t)), b = scale(tube->by, 2.0 * t * (1.0 - t));
  return add(add(a, b), scale(tube->to, t * t));
}

/* Polynomial smooth minimum: exact where the two differ by more than
 * `blend`. */
static double blend_minimum(double a, double b, double blend) {
  double least = a < b ? a : b, apart = fabs(a - b);
  if (apart >= blend) {
    return least;
  }
  double h = 1.0 - apart / blend;
  return least - h * h * blend * 0.25;
}

/* Exact on the surface, and near enough to a distance around it. */
static double measure_ellipsoid(const Ellipsoid *e, Vector p) {
  Vector y = normalize(e->axis), x = normalize(cross(y, e->front)), z = cross(x, y);
  Vector d = subtract(p, e->center);
  Vector q = {dot(d, x) / e->radii.x, dot(d, y) / e->radii.y, dot(d, z) / e->radii.z};
  Vector gradient = {q.x / e->radii.x, q.y / e->radii.y, q.z / e->radii.z};
  double steepness = measure(gradient);
  if (steepness < 1e-9) {
    double thinnest = e->radii.x < e->radii.y ? e->radii.x : e->radii.y;
    return -(thinnest < e->radii.z ? thinnest : e->radii.z);
  }
  double level = measure(q);
  return level * (level - 1.0) / steepness;
}

/* How far the field of a tube can be at most below the distance to its middle
 * control point: a tube lies within the triangle of its control points. */
static double find_reach(const Tube *tube) {
  double a = measure(subtract(tube->from, tube->by)), b = measure(subtract(tube->to, tube->by));
  double thickest = tube->radius_from > tube->radius_to ? tube->radius_from : tube->radius_to;
  return (a > b ? a : b) + thickest;
}

static double measure_tube(const Tube *tube, Vector p) {
  const int samples = 8;
  double nearest = 0.0, least = INFINITY;
  for (int k = 0; k <= samples; k++) {
    double t = (double)k / samples;
    Vector offset = subtract(find_curve_point(tube, t), p);
    double square = dot(offset, offset);
    if (square < least) {
      least = square;
      nearest = t;
    }
  }
  /* Newton's steps to the foot of the perpendicular. */
  Vector bend = add(subtract(tube->to, scale(tube->by, 2.0)), tube->from);
  for (int k = 0; k < 4; k++) {
    Vector offset = subtract(find_curve_point(tube, nearest), p);
    Vector speed = scale(add(subtract(tube->by, tube->from), scale(bend, nearest)), 2.0);
    double slope = dot(speed, speed) + 2.0 * dot(offset, bend);
    if (slope <= 0.0) {
      break;
    }
    nearest -= dot(offset, speed) / slope;
    nearest = nearest < 0.0 ? 0.0 : nearest > 1.0 ? 1.0 : nearest;
  }
  double radius = tube->radius_from + (tube->radius_to - tube->radius_from) * nearest;
  return measure(subtract(find_curve_point(tube, nearest), p)) - radius;
}

static double blend_ellipsoids(double field, const Ellipsoid *ellipsoids, size_t count, Vector p) {
  for (size_t i = 0; i < count; i++) {
    double distance = measure_ellipsoid(&ellipsoids[i], p);
    double blend = ellipsoids[i].blend;
    field = blend < 0.0 ? -blend_minimum(-field, distance, -blend) : blend_minimum(field, distance, blend);
  }
  return field;
}

static double blend_tubes(double field, const Tube *tubes, size_t count, Vector p) {
  for (size_t i = 0; i < count; i++) {
    double at_least = measure(subtract(p, tubes[i].by)) - find_reach(&tubes[i]);
    if (at_least < field + tubes[i].blend) {
      field = blend_minimum(field, measure_tube(&tubes[i], p), tubes[i].blend);
    }
  }
  return field;
}

static double measure_creature(void *context, const double point[3]) {
  (void)context;
  Vector p = {point[0], point[1], point[2]};
  double field = measure_ellipsoid(&body[0], p);
  field = blend_ellipsoids(field, body + 1, COUNT(body) - 1, p);
  field = blend_tubes(field, limbs, COUNT(limbs), p);
  field = blend_tubes(field, details, COUNT(details), p);
  field = blend_ellipsoids(field, features, COUNT(features), p);
  return -blend_minimum(-field, measure_tube(&smile, p), smile.blend);
}

static Vector find_normal(const double point[3]) {
  const double step = 2e-3;
  double slope[3];
  for (int axis = 0; axis < 3; axis++) {
    double before[3], after[3];
    memcpy(before, point, sizeof before);
    memcpy(after, point, sizeof after);
    before[axis] -= step;
    after[axis] += step;
    slope[axis] = measure_creature(NULL, after) - measure_creature(NULL, before);
  }
  return normalize((Vector){slope[0], slope[1], slope[2]});
}

static Vector get_vertex(const StyFieldMesh *mesh, uint32_t i) {
  return (Vector){mesh->vertices[i][0], mesh->vertices[i][1], mesh->vertices[i][2]};
}

/* Positive when the triangles face outward. */
static double measure_volume(const StyFieldMesh *mesh) {
  double volume = 0.0;
  for (size_t i = 0; i < mesh->triangle_count; i++) {
    const uint32_t *corner = mesh->triangles[i];
    Vector a = get_vertex(mesh, corner[0]), b = get_vertex(mesh, corner[1]), c = get_vertex(mesh, corner[2]);
    volume += dot(a, cross(b, c)) / 6.0;
  }
  return volume;
}

static void face_outward(StyFieldMesh *mesh) {
  if (measure_volume(mesh) > 0.0) {
    return;
  }
  for (size_t i = 0; i < mesh->triangle_count; i++) {
    uint32_t second = mesh->triangles[i][1];
    mesh->triangles[i][1] = mesh->triangles[i][2];
    mesh->triangles[i][2] = second;
  }
}

static void put_word(FILE *stream, uint32_t word) {
  for (int shift = 0; shift < 32; shift += 8) {
    fputc((int)(word >> shift & 0xFFu), stream);
  }
}

static void put_float(FILE *stream, double value) {
  float narrow = (float)value;
  uint32_t word;
  memcpy(&word, &narrow, sizeof word);
  put_word(stream, word);
}

static StyStatus write_ply(const char *path, const StyFieldMesh *mesh, StyError *error) {
  StyOutput output;
  StyStatus status = sty_open_output(path, &output, error);
  if (status != STY_OK) {
    return status;
  }
  fprintf(output.stream,
          "ply\nformat binary_little_endian 1.0\ncomment stylut creature\nelement vertex %zu\n"
          "property float x\nproperty float y\nproperty float z\n"
          "property float nx\nproperty float ny\nproperty float nz\n"
          "element face %zu\nproperty list uchar int vertex_indices\nend_header\n",
          mesh->vertex_count, mesh->triangle_count);
  for (size_t i = 0; i < mesh->vertex_count; i++) {
    Vector normal = find_normal(mesh->vertices[i]);
    for (int axis = 0; axis < 3; axis++) {
      put_float(output.stream, mesh->vertices[i][axis]);
    }
    put_float(output.stream, normal.x);
    put_float(output.stream, normal.y);
    put_float(output.stream, normal.z);
  }
  for (size_t i = 0; i < mesh->triangle_count; i++) {
    fputc(3, output.stream);
    for (int corner = 0; corner < 3; corner++) {
      put_word(output.stream, mesh->triangles[i][corner]);
    }
  }
  return sty_commit_output(&output, error);
}

int main(int argc, char **argv) {
  if (argc == 2 && strcmp(argv[1], "--help") == 0) {
    puts("Usage: creature OUT.ply");
    return STY_OK;
  }
  if (argc != 2) {
    fputs("Usage: creature OUT.ply\n", stderr);
    return STY_ERROR_USAGE;
  }
  const StyFieldBounds bounds = {
      .center = {0.0, -0.3, 0.0}, .radius = 2.0, .angle = 28.0, .size = 0.05, .distance = 0.0014};
  StyError error = {.status = STY_OK};
  StyFieldMesh mesh = {0};
  StyStatus status = sty_mesh_field(measure_creature, NULL, &bounds, &mesh, &error);
  if (status == STY_OK) {
    face_outward(&mesh);
    status = write_ply(argv[1], &mesh, &error);
    sty_destroy_field_mesh(&mesh);
  }
  if (status != STY_OK) {
    fprintf(stderr, "creature: error: %s\n", error.text);
  }
  return status;
}
