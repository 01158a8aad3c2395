#include "guide/film.h"

#include <math.h>
#include <stdlib.h>

#include "guide/lanes.h"
#include "scene/points.h"
#include "scene/vector.h"

/* Orthographic rays start this far behind the eye's plane (trace units), so
 * that a surface that touches the plane isn't missed. */
static const double START_SLACK = 1.0 / 1024;

/* What floats, which rays are traced in, may be off by, as a share of the numbers that come in: some roundings. */
static const double FLOAT_SLACK = 1e-6;

/* ---- places ---- */

bool sty_project_point(const StyCamera *camera, int width, int height, const double at[3], double pixel[2]) {
  double from[3];
  subtract_vectors(at, camera->eye, from);
  const double depth = camera->perspective ? -dot_vectors(from, camera->back) : 1;
  if (!(depth > 0)) return false;
  const double s = dot_vectors(from, camera->right) / depth, t = dot_vectors(from, camera->up) / depth;
  pixel[0] = (s / camera->half_width + 1) / 2 * width;
  pixel[1] = (1 - t / camera->half_height) / 2 * height;
  return true;
}

/* Film coordinates along a side of `count` pixels, from -half to half. */
static double get_place(int pixel, int count, double half) { return ((pixel + 0.5) / count * 2 - 1) * half; }

static int round_up(int count, int step) { return (count + step - 1) / step * step; }

static StyStatus list_places(StyFilm *film, StyError *error) {
  const int columns = round_up(film->width, STY_BLOCK_WIDTH), rows = round_up(film->height, STY_BLOCK_HEIGHT);
  const size_t bytes = ((size_t)columns + (size_t)rows) * sizeof *film->columns;
  film->columns = malloc(bytes);
  if (!film->columns) return sty_fail_memory(error, "guide", (double)bytes);
  film->rows = film->columns + columns;
  for (int x = 0; x < columns; x++) film->columns[x] = get_place(x, film->width, film->camera->half_width);
  for (int y = 0; y < rows; y++) film->rows[y] = -get_place(y, film->height, film->camera->half_height);
  return STY_OK;
}

/* ---- what is in sight ---- */

typedef struct Sight {
  StyFilm *film;
  double nearest; /* depth; 1 for orthographic cameras */
} Sight;

static void extend_to(Sight *sight, const double at[3]) {
  StyFilm *film = sight->film;
  const StyCamera *camera = film->camera;
  double pixel[2], from[3];
  subtract_vectors(at, camera->eye, from);
  const bool seen = sty_project_point(camera, film->width, film->height, at, pixel);
  if (camera->perspective) sight->nearest = fmin(sight->nearest, -dot_vectors(from, camera->back));
  for (int k = 0; k < 2; k++) {
    film->first[k] = seen ? fmin(film->first[k], pixel[k]) : -INFINITY;
    film->last[k] = seen ? fmax(film->last[k], pixel[k]) : INFINITY;
  }
}

/* Corners' projections enclose those of what lies between them, unless one is behind the camera. */
static void extend_sight(void *context, const double at[3], double radius) {
  for (int c = 0; c < (radius > 0 ? 8 : 1); c++) {
    double corner[3];
    for (int k = 0; k < 3; k++) corner[k] = at[k] + (c >> k & 1 ? radius : -radius);
    extend_to(context, corner);
  }
}

static void find_sight(const StyScene *scene, StyFilm *film) {
  const StyCamera *camera = film->camera;
  Sight sight = {film, camera->perspective ? INFINITY : 1};
  double reach = 1;
  for (int k = 0; k < 3; k++) reach = fmax(reach, fabs(camera->eye[k]));
  for (int k = 0; k < 2; k++) {
    film->first[k] = INFINITY;
    film->last[k] = -INFINITY;
  }
  sty_visit_points(scene, extend_sight, &sight);
  const double off = FLOAT_SLACK * reach / sight.nearest;
  const double slack[2] = {1 + off / camera->half_width * film->width, 1 + off / camera->half_height * film->height};
  for (int k = 0; k < 2; k++) {
    film->first[k] -= slack[k];
    film->last[k] += slack[k];
  }
}

bool sty_is_in_sight(const StyFilm *film, int x, int y, int width, int height) {
  return x < film->last[0] && x + width > film->first[0] && y < film->last[1] && y + height > film->first[1];
}

/* ---- the whole ---- */

StyStatus sty_open_film(const StyScene *scene, const StyCamera *camera, int width, int height, StyFilm *out,
                        StyError *error) {
  *out = (StyFilm){.camera = camera, .width = width, .height = height};
  for (int k = 0; k < 3; k++)
    out->start[k] = camera->eye[k] + (camera->perspective ? 0 : START_SLACK * camera->back[k]);
  const StyStatus status = list_places(out, error);
  if (!status) find_sight(scene, out);
  return status;
}

void sty_close_film(StyFilm *film) {
  free(film->columns);
  *film = (StyFilm){0};
}
