/* What is wrong with a mesh file, in one line; vertices, faces and meshes of the file are counted from 0 here and from
 * 1 there. All fail with STY_ERROR_INPUT. */
#ifndef STYLUT_SCENE_FAULTS_H
#define STYLUT_SCENE_FAULTS_H

#include <stddef.h>

#include "stylut/status.h"

/* `at` 3 coordinates, `uv` 2 or NULL: passes where all are finite. */
StyStatus sty_check_vertex(const char *path, size_t vertex, unsigned mesh, const float *at, const float *uv,
                           StyError *error);

/* Passes where a vertex lies within STY_MAX_COORDINATE. */
StyStatus sty_check_world(const char *path, size_t vertex, unsigned mesh, const double world[3], StyError *error);

StyStatus sty_fail_index(const char *path, size_t face, unsigned mesh, long index, size_t vertex_count,
                         StyError *error);
StyStatus sty_fail_triangles(const char *path, StyError *error); /* too many */
StyStatus sty_fail_empty(const char *path, StyError *error);
StyStatus sty_fail_flat(const char *path, size_t triangle_count, StyError *error);

#endif
