/* Triangles of a mesh file, no more than guides need.
 *
 * World: as in the file, right-handed. Trace space, used inside: the file's
 * coordinates recentred and rescaled so that the mesh fits the cube [-1, 1]^3,
 * because ray casters miss geometry that is tiny or far from the origin;
 * world = trace / scale + centre.
 *
 * Threads: nothing is kept between calls. Functions that take a const mesh may
 * run side by side on one; those that change it need it for themselves. */
#ifndef STYLUT_MESH_H
#define STYLUT_MESH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "stylut/parallel.h"

#ifdef __cplusplus
extern "C" {
#endif

/* World coordinates lie within this: depth and position must fit a float, at the distance of a 1-degree camera, too.
 * 1e30, and what the nearest float and the way through a transform make of it. */
#define STY_MAX_COORDINATE (1e30 * (1 + 1e-6))

/* The colour of a surface, scene-linear. */
typedef struct StyPaint {
  double colour[3]; /* diffuse reflectance, 0..1; a texture multiplies it */
  int texture;      /* index of the mesh's textures, once it is part of a scene of the scene's; -1: none */
} StyPaint;

/* A picture that surfaces show. */
typedef struct StyPicture {
  char *path;           /* its file; of one inside a mesh's file, what messages call it */
  char *named_by;       /* who names that file, for messages: "wall.obj"; NULL: nobody else than the caller */
  unsigned char *bytes; /* of the latter: a picture's file, byte by byte; NULL: at the path */
  size_t size;
} StyPicture;

typedef struct StyMesh {
  char *path; /* the file; NULL: made by a program */
  size_t vertex_count;
  size_t triangle_count;
  int part_count;       /* parts of the file; ids are 1 .. part_count */
  float *positions;     /* 3 per vertex, trace space; one more float follows (Embree reads 16 bytes) */
  float *normals;       /* 3 per vertex, unit length, world frame */
  float *uvs;           /* 2 per vertex, v up; NULL where the file has none */
  uint32_t *indices;    /* 3 per triangle, counter-clockwise seen from outside */
  uint32_t *part_ids;   /* 1 per triangle; NULL: the mesh has one part */
  StyPaint *paints;     /* 1 per part, of the file's materials; NULL: all white */
  StyPicture *textures; /* that they name, beside the file or inside of it; a scene takes them over */
  int texture_count;
  double centre[3];              /* world */
  double scale;                  /* trace units per world unit */
  double minimum[3], maximum[3]; /* world bounds */
  /* What reading it did. */
  size_t vertices_read;  /* as the file, or the importer, has them: of an OBJ or STL one per corner, unused ones too */
  size_t repeated_faces; /* left out: two of their corners lie at the same place */
  size_t flat_faces;     /* left out: others without area */
  char *lost_materials;  /* "material file skin.mtl" or "material skin": what an OBJ file asks for and isn't there */
  double import_bytes;   /* the most memory that the importer's process held; 0: there was none */
  double crease_angle;   /* that normals were computed with, degrees; negative: they are the file's own */
  size_t clashes;        /* edges that both their triangles run along the same way, where normals were computed */
} StyMesh;

typedef struct StyMeshOptions {
  /* Edges sharper than this stay hard where normals are computed, degrees
   * 0..180. Negative: the file's own normals where it has them, else 60. STL
   * files count as having none, since that format can only store facets. */
  double crease_angle;
  const StyRun *run; /* of reading and normals; NULL: one thread per core */
} StyMeshOptions;

static inline int sty_get_part(const StyMesh *mesh, size_t triangle) {
  return mesh->part_ids ? (int)mesh->part_ids[triangle] : 1;
}

/* What messages call it: its file. */
static inline const char *sty_name_mesh(const StyMesh *mesh) {
  return mesh->path ? mesh->path : "a mesh without a file";
}

/* Bytes of what rays need of a mesh: vertices, indices and parts. Never fails. */
double sty_get_mesh_bytes(const StyMesh *mesh);

/* By its ending, of any case: .obj, .ply, .stl, .gltf, .glb, .fbx or .off. Opens nothing. */
bool sty_is_mesh_file(const char *path);

/* Reads OBJ, PLY, STL, glTF, FBX or OFF: binary PLY files of triangles here, where reading takes no more than a quarter
 * of the mesh's bytes beside them; all others through Assimp, in a process of its own and at a multiple of that. Every
 * index and coordinate is checked. Zero-area triangles are left out. The caller owns the mesh; the path and the options
 * are its own again after the call.
 * Several threads may each read a mesh. Where one goes through Assimp the process forks: the child has the calling
 * thread alone, calls nothing but Assimp and malloc, and is waited for by its number, so a program must not reap
 * children that it didn't start. It holds what pipes are open when it begins: of two imports side by side, one that
 * crashes may be noticed only when the other ends. The run's progress and stage are called from the calling thread.
 * Errors: STY_ERROR_FILE (cannot be read), STY_ERROR_INPUT (not a mesh, no
 * faces, all faces without area, NaN or infinite coordinates, indices out of
 * range; the message names the file and the first offending vertex or face),
 * STY_ERROR_LIBRARY (memory, no process for the importer), STY_ERROR_USAGE (a
 * crease angle beyond 180). Textures aren't opened. */
StyStatus sty_read_mesh(const char *path, const StyMeshOptions *options, StyMesh **out, StyError *error);

/* Frees and nulls *mesh and all it owns; does nothing for NULL. */
void sty_destroy_mesh(StyMesh **mesh);

#ifdef __cplusplus
}
#endif
#endif
