#include <stdio.h>
#include <string.h>

#include "scene/points.h"
#include "scene/vector.h"
#include "stylut/parse.h"

/* Distance that a perspective eye keeps from the scene, trace units, where a
 * spike that fits the opening would otherwise touch it. */
static const double CLEARANCE = 0.01;

/* ---- views ---- */

const char *const sty_up_axis_names[] = {"y", "z", "x", "-y", "-z", "-x", NULL};

/* Right, up and front of the world for each up axis; right-handed. */
static const double FRAMES[][3][3] = {
    [STY_UP_Y] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},        [STY_UP_Z] = {{1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
    [STY_UP_X] = {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},       [STY_UP_MINUS_Y] = {{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}},
    [STY_UP_MINUS_Z] = {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}, [STY_UP_MINUS_X] = {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}},
};

bool sty_find_up_axis(const double up[3], StyUpAxis *out) {
  for (size_t a = 0; a < sizeof FRAMES / sizeof *FRAMES; a++)
    if (memcmp(FRAMES[a][1], up, sizeof FRAMES[a][1]) == 0) {
      *out = (StyUpAxis)a;
      return true;
    }
  return false;
}

const StyView sty_default_view = {.fov = 35, .margin = 0.05};

static StyStatus parse_angles(const char *what, const char *text, double *azimuth, double *elevation, StyError *error) {
  const char *comma = strchr(text, ',');
  char first[32];
  if (!comma || (size_t)(comma - text) >= sizeof first)
    return sty_fail(error, STY_ERROR_USAGE,
                    "%s: found '%s', expected front, three-quarter, or AZIMUTH,ELEVATION in degrees", what, text);
  snprintf(first, sizeof first, "%.*s", (int)(comma - text), text);
  char name[128];
  snprintf(name, sizeof name, "%s: azimuth", what);
  StyStatus status = sty_parse_number(name, first, -360, 360, azimuth, error);
  if (status != STY_OK) return status;
  snprintf(name, sizeof name, "%s: elevation", what);
  return sty_parse_number(name, comma + 1, -90, 90, elevation, error);
}

StyStatus sty_parse_view(const char *what, const char *text, StyView *view, StyError *error) {
  double azimuth = 0, elevation = 0;
  if (strcmp(text, "three-quarter") == 0) {
    azimuth = 35;
    elevation = 20;
  } else if (strcmp(text, "front") != 0) {
    StyStatus status = parse_angles(what, text, &azimuth, &elevation, error);
    if (status != STY_OK) return status;
  }
  view->azimuth = azimuth;
  view->elevation = elevation;
  return STY_OK;
}

/* ---- fitting ---- */

/* Exact at multiples of 90 degrees, so that axis-aligned views are axis-aligned. */
static void get_sine_cosine(double degrees, double *sine, double *cosine) {
  static const double SINES[4] = {0, 1, 0, -1};
  const double quarters = degrees / 90;
  if (quarters == floor(quarters)) {
    const int q = (int)(quarters - 4 * floor(quarters / 4));
    *sine = SINES[q];
    *cosine = SINES[(q + 1) % 4];
  } else {
    *sine = sin(degrees * (M_PI / 180));
    *cosine = cos(degrees * (M_PI / 180));
  }
}

static void set_axes(const StyView *view, StyCamera *camera) {
  double sa, ca, se, ce;
  get_sine_cosine(view->azimuth, &sa, &ca);
  get_sine_cosine(view->elevation, &se, &ce);
  const double(*world)[3] = FRAMES[view->up];
  for (int k = 0; k < 3; k++) {
    camera->back[k] = sa * ce * world[0][k] + se * world[1][k] + ca * ce * world[2][k];
    camera->right[k] = ca * world[0][k] - sa * world[2][k];
  }
  cross_vectors(camera->back, camera->right, camera->up);
}

/* A point of trace space in the view's axes. */
static void get_view_position(const StyCamera *camera, const double at[3], double out[3]) {
  out[0] = dot_vectors(at, camera->right);
  out[1] = dot_vectors(at, camera->up);
  out[2] = dot_vectors(at, camera->back);
}

static void place_eye(const double view_position[3], StyCamera *camera) {
  for (int k = 0; k < 3; k++)
    camera->eye[k] =
        view_position[0] * camera->right[k] + view_position[1] * camera->up[k] + view_position[2] * camera->back[k];
}

typedef struct Bounds {
  const StyCamera *camera;
  double low[3], high[3];
} Bounds;

static void extend_bounds(void *context, const double point[3], double radius) {
  Bounds *bounds = context;
  double at[3];
  get_view_position(bounds->camera, point, at);
  for (int k = 0; k < 3; k++) {
    bounds->low[k] = fmin(bounds->low[k], at[k] - radius);
    bounds->high[k] = fmax(bounds->high[k], at[k] + radius);
  }
}

/* The film holds the bounds; the eye's plane touches the nearest point. */
static StyStatus fit_orthographic(const StyScene *scene, double share, double aspect, StyCamera *camera,
                                  StyError *error) {
  Bounds b = {camera, {INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  sty_visit_points(scene, extend_bounds, &b);
  const double half_width = (b.high[0] - b.low[0]) / 2, half_height = (b.high[1] - b.low[1]) / 2;
  if (!(half_width > 0 || half_height > 0) || !isfinite(half_width + half_height))
    return sty_fail(error, STY_ERROR_INPUT, "camera: the scene has no extent in this view");
  camera->half_width = fmax(half_width, half_height * aspect) / share;
  camera->half_height = fmax(half_height, half_width / aspect) / share;
  place_eye((double[3]){(b.low[0] + b.high[0]) / 2, (b.low[1] + b.high[1]) / 2, b.high[2]}, camera);
  return STY_OK;
}

typedef struct Opening {
  const StyCamera *camera;
  double slopes[2], plus[2], minus[2], nearest;
} Opening;

/* Point p is in the frustum of slope a when |p.x - e.x| <= a (e.z - p.z), and
 * likewise for y: so e.z is at least half the sum of max(p.z + p.x/a) and
 * max(p.z - p.x/a), and half their difference, times a, centres the eye. Over a
 * sphere both are greater than at its centre by r sqrt(1 + 1/a^2). */
static void open_frustum(void *context, const double point[3], double radius) {
  Opening *o = context;
  double at[3];
  get_view_position(o->camera, point, at);
  o->nearest = fmax(o->nearest, at[2] + radius);
  for (int k = 0; k < 2; k++) {
    const double reach = radius > 0 ? radius * sqrt(1 + 1 / (o->slopes[k] * o->slopes[k])) : 0;
    o->plus[k] = fmax(o->plus[k], at[2] + at[k] / o->slopes[k] + reach);
    o->minus[k] = fmax(o->minus[k], at[2] - at[k] / o->slopes[k] + reach);
  }
}

static StyStatus fit_perspective(const StyScene *scene, double share, StyCamera *camera, StyError *error) {
  Opening o = {camera,
               {camera->half_width * share, camera->half_height * share},
               {-INFINITY, -INFINITY},
               {-INFINITY, -INFINITY},
               -INFINITY};
  sty_visit_points(scene, open_frustum, &o);
  double eye[3] = {0, 0, o.nearest + CLEARANCE};
  for (int k = 0; k < 2; k++) {
    eye[k] = (o.plus[k] - o.minus[k]) / 2 * o.slopes[k];
    eye[2] = fmax(eye[2], (o.plus[k] + o.minus[k]) / 2);
  }
  if (!isfinite(eye[0] + eye[1] + eye[2]))
    return sty_fail(error, STY_ERROR_INPUT, "camera: the scene has no finite extent");
  place_eye(eye, camera);
  return STY_OK;
}

static StyStatus check_view(const StyView *view, int width, int height, StyError *error) {
  if (width < 1 || height < 1)
    return sty_fail(error, STY_ERROR_USAGE, "camera: found a picture of %d x %d pixels, expected at least 1 x 1", width,
                    height);
  if (!isfinite(view->azimuth) || !(fabs(view->elevation) <= 90))
    return sty_fail(error, STY_ERROR_USAGE,
                    "camera: found azimuth %g and elevation %g, expected -90 to 90 for elevation", view->azimuth,
                    view->elevation);
  if (!(view->margin >= 0 && view->margin <= 0.45))
    return sty_fail(error, STY_ERROR_USAGE, "camera: found margin %g, expected 0 to 0.45", view->margin);
  if (view->perspective && !(view->fov >= 1 && view->fov <= 170))
    return sty_fail(error, STY_ERROR_USAGE, "camera: found an opening of %g degrees, expected 1 to 170", view->fov);
  return STY_OK;
}

StyStatus sty_fit_camera(const StyScene *scene, const StyView *view, int width, int height, StyCamera *out,
                         StyError *error) {
  StyStatus status = check_view(view, width, height, error);
  if (status != STY_OK) return status;
  const double share = 1 - 2 * view->margin, aspect = (double)width / height;
  StyCamera camera = {.perspective = view->perspective};
  set_axes(view, &camera);
  if (view->perspective) {
    camera.half_height = tan(view->fov * (M_PI / 360));
    camera.half_width = camera.half_height * aspect;
    status = fit_perspective(scene, share, &camera, error);
  } else {
    status = fit_orthographic(scene, share, aspect, &camera, error);
  }
  if (status == STY_OK) *out = camera;
  return status;
}

/* ---- placing ---- */

StyStatus sty_place_camera(const StyScene *scene, const StyStand *stand, int width, int height, StyCamera *out,
                           StyError *error) {
  StyCamera camera = {.perspective = stand->perspective};
  if (width < 1 || height < 1)
    return sty_fail(error, STY_ERROR_USAGE, "camera: found a picture of %d x %d pixels, expected at least 1 x 1", width,
                    height);
  subtract_vectors(stand->position, stand->target, camera.back);
  if (!normalize_vector(camera.back))
    return sty_fail(error, STY_ERROR_INPUT, "camera: found position and target in one place, expected them apart");
  double up[3] = {stand->up[0], stand->up[1], stand->up[2]};
  if (normalize_vector(up)) cross_vectors(up, camera.back, camera.right);
  if (!(dot_vectors(camera.right, camera.right) > 1e-12) || !normalize_vector(camera.right))
    return sty_fail(error, STY_ERROR_INPUT,
                    "camera: found the up (%g, %g, %g), expected a direction that it doesn't look along", stand->up[0],
                    stand->up[1], stand->up[2]);
  cross_vectors(camera.back, camera.right, camera.up);
  sty_get_trace_point(scene, stand->position, camera.eye);
  camera.half_height = stand->perspective ? tan(stand->fov * (M_PI / 360)) : stand->height / 2 * scene->scale;
  camera.half_width = camera.half_height * width / height;
  if (!(camera.half_height > 0) || !isfinite(camera.half_width))
    return sty_fail(error, STY_ERROR_INPUT, "camera: found no opening, expected a film that has a size");
  *out = camera;
  return STY_OK;
}
