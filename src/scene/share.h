/* Corners to meshes and back. */
#ifndef STYLUT_SRC_SCENE_SHARE_H
#define STYLUT_SRC_SCENE_SHARE_H

#include "scene/corners.h"
#include "stylut/mesh.h"

/* Fills indices, vertex count, positions, normals and, if asked for, uvs from 3 corners per triangle: those that are
 * the same to the byte become one vertex. */
StyStatus sty_share_vertices(StyMesh *mesh, const StyCorner *corners, bool has_uvs, StyError *error);

/* One of them again. */
StyCorner sty_get_corner(const StyMesh *mesh, size_t corner);

#endif
