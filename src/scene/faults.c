#include "scene/faults.h"

#include <math.h>

#include "scene/corners.h"
#include "stylut/mesh.h"

StyStatus sty_check_vertex(const char *path, size_t vertex, unsigned mesh, const float *at, const float *uv,
                           StyError *error) {
  if (uv && !(isfinite(uv[0]) && isfinite(uv[1])))
    return sty_fail(error, STY_ERROR_INPUT,
                    "%s: vertex %zu of mesh %u (counted from 1) has the texture coordinates (%g, %g), expected finite "
                    "ones",
                    path, vertex + 1, mesh + 1, (double)uv[0], (double)uv[1]);
  if (isfinite(at[0]) && isfinite(at[1]) && isfinite(at[2])) return STY_OK;
  return sty_fail(error, STY_ERROR_INPUT,
                  "%s: vertex %zu of mesh %u (counted from 1) is (%g, %g, %g), expected finite float coordinates", path,
                  vertex + 1, mesh + 1, (double)at[0], (double)at[1], (double)at[2]);
}

StyStatus sty_check_world(const char *path, size_t vertex, unsigned mesh, const double world[3], StyError *error) {
  for (int k = 0; k < 3; k++)
    if (!(fabs(world[k]) <= STY_MAX_COORDINATE))
      return sty_fail(
          error, STY_ERROR_INPUT,
          "%s: vertex %zu of mesh %u (counted from 1) lies at (%g, %g, %g), expected coordinates from %g to %g", path,
          vertex + 1, mesh + 1, world[0], world[1], world[2], -STY_MAX_COORDINATE, STY_MAX_COORDINATE);
  return STY_OK;
}

StyStatus sty_fail_index(const char *path, size_t face, unsigned mesh, long index, size_t vertex_count,
                         StyError *error) {
  return sty_fail(error, STY_ERROR_INPUT,
                  "%s: face %zu of mesh %u (counted from 1) asks for vertex index %ld, expected 0 to %ld", path,
                  face + 1, mesh + 1, index, (long)vertex_count - 1);
}

StyStatus sty_fail_triangles(const char *path, StyError *error) {
  return sty_fail(error, STY_ERROR_INPUT, "%s: found more than %zu triangles, which is the most a mesh may have", path,
                  STY_MAX_TRIANGLES);
}

StyStatus sty_fail_empty(const char *path, StyError *error) {
  return sty_fail(error, STY_ERROR_INPUT, "%s: holds no faces, expected a mesh with triangles or polygons", path);
}

StyStatus sty_fail_flat(const char *path, size_t triangle_count, StyError *error) {
  return sty_fail(error, STY_ERROR_INPUT, "%s: none of its %zu triangles has an area", path, triangle_count);
}
