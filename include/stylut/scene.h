/* The scene: triangles and a camera, no more than guides need.
 *
 * Frames. World: as in the mesh file, right-handed. View: +X right, +Y up,
 * +Z toward the viewer (the camera looks along -Z). Trace space, used inside:
 * world recentred and rescaled so that the scene fits the cube [-1, 1]^3,
 * because ray casters miss geometry that is tiny or far from the origin;
 * world = trace / scale + centre. */
#ifndef STYLUT_SCENE_H
#define STYLUT_SCENE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "stylut/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct StyScene {
  size_t vertex_count;
  size_t triangle_count;
  int object_count;              /* parts of the file; ids are 1 .. object_count */
  float *positions;              /* 3 per vertex, trace space; one more float follows (Embree reads 16 bytes) */
  float *normals;                /* 3 per vertex, unit length, world frame */
  uint32_t *indices;             /* 3 per triangle, counter-clockwise seen from outside */
  uint32_t *object_ids;          /* 1 per triangle */
  double centre[3];              /* world */
  double scale;                  /* trace units per world unit */
  double minimum[3], maximum[3]; /* world bounds */
} StyScene;

typedef struct StyMeshOptions {
  /* Edges sharper than this stay hard where normals are computed, degrees
   * 0..180. Negative: the file's own normals where it has them, else 60. STL
   * files count as having none, since that format can only store facets. */
  double crease_angle;
} StyMeshOptions;

/* Imports OBJ, PLY, STL, glTF or OFF through Assimp. Every index and coordinate
 * is checked. Zero-area triangles are left out. The caller owns the scene.
 * Errors: STY_ERROR_FILE (cannot be read), STY_ERROR_INPUT (not a mesh, no
 * faces, all faces without area, NaN or infinite coordinates, indices out of
 * range; the message names the file and the first offending vertex or face),
 * STY_ERROR_LIBRARY (memory). */
StyStatus sty_read_mesh(const char *path, const StyMeshOptions *options, StyScene **out, StyError *error);

/* Frees and nulls *scene. */
void sty_destroy_scene(StyScene **scene);

/* The world axis that points up. Its "front", where azimuth is 0, is seen from
 * +Z, and for +Z up from -Y, for -Z up from +Y. */
typedef enum StyUpAxis { STY_UP_Y, STY_UP_Z, STY_UP_X, STY_UP_MINUS_Y, STY_UP_MINUS_Z, STY_UP_MINUS_X } StyUpAxis;
extern const char *const sty_up_axis_names[]; /* NULL-terminated, in the enum's order */

/* Where the eye is, as people say it. */
typedef struct StyView {
  double azimuth;   /* degrees about the up axis; 0 is the front, 90 its right */
  double elevation; /* degrees above the horizon, -90..90 */
  bool perspective; /* else orthographic */
  double fov;       /* vertical opening, degrees, 1..170; perspective only */
  double margin;    /* empty border as a share of the picture's side, 0..0.45 */
  StyUpAxis up;
} StyView;

/* "front", "three-quarter" (35 degrees around, 20 up) or "AZ,EL" in degrees.
 * Sets azimuth and elevation only. STY_ERROR_USAGE; `what` names the option. */
StyStatus sty_parse_view(const char *what, const char *text, StyView *view, StyError *error);

/* A camera in trace space. A pixel centre (x+1/2, y+1/2) of a width x height
 * picture has film coordinates
 *   s = ((x+1/2)/width*2-1) * half_width, t = (1-(y+1/2)/height*2) * half_height.
 * Orthographic: the ray starts at eye + s*right + t*up and runs along -back.
 * Perspective: it starts at eye and runs along s*right + t*up - back. */
typedef struct StyCamera {
  bool perspective;
  double eye[3];
  double right[3], up[3], back[3]; /* orthonormal: the view frame's axes */
  double half_width, half_height;  /* of the film; at distance 1 for perspective */
} StyCamera;

/* The camera that looks at the scene from `view` and holds all of it with the
 * margin, for a picture of width x height square pixels. */
StyStatus sty_fit_camera(const StyScene *scene, const StyView *view, int width, int height, StyCamera *out,
                         StyError *error);

#ifdef __cplusplus
}
#endif
#endif
