/* Scene files, schema stylut-scene/1: JSON that people write.
 *
 *   { "schema": "stylut-scene/1",
 *     "camera": { "type": "fit", "view": "three-quarter", "up": [0,1,0], "fov": 35 },
 *     "objects": [ { "mesh": "golem.obj", "transform": [16 numbers, row by row], "style": 1 } ],
 *     "spheres": [ { "center": [2,0,0], "radius": 0.7, "style": 2, "color": [0.8,0.3,0.2] } ],
 *     "lights":  [ { "type": "directional", "direction": [-1,-1,-1], "intensity": 1, "color": [1,1,1] },
 *                  { "type": "point", "position": [0,5,0], "intensity": 20 } ],
 *     "ambient": 0.1, "shadows": true }
 *
 * Paths are relative to the file. A camera of type
 *   fit           holds the whole scene, seen from "view" (default "front") with "up" along one of
 *                 the world's axes; orthographic, or with "fov" perspective
 *   perspective   stands at "position", looks at "target", "fov" (default 35) degrees high
 *   orthographic  likewise, but sees "height" world units
 * "up" is [0,1,0] where it isn't given, "style" 1; without a camera, fit. A transform takes the
 * mesh file's coordinates to the world's; its last row is 0 0 0 1. Objects that name the same mesh
 * share it. Objects and spheres may have a "color" (default white), a "texture" (a picture, which it
 * multiplies), and a highlight: "specular" (0) and "shininess" (32); an object with neither color nor texture has its
 * mesh file's. "ambient" is 0.1 where there are lights, else 1, so that a scene
 * without any is evenly lit; shadows are on. Unknown keys and wrong types are errors with line and column.
 *
 * Threads: nothing is kept between calls, and each may run beside any other, under what sty_read_mesh says of
 * importing. Out parameters are written on success. */
#ifndef STYLUT_SCENE_FILE_H
#define STYLUT_SCENE_FILE_H

#include "stylut/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Where a scene is to be seen from, before the picture's size is known. */
typedef struct StyViewpoint {
  bool is_fit;
  StyView view;   /* of a camera that is fitted */
  StyStand stand; /* of others */
} StyViewpoint;

/* By its ending, .json of any case. Opens nothing. */
bool sty_is_scene_file(const char *path);

/* Reads the file and the meshes it names. The caller owns the scene, which is finished. What may well be a mistake all
 * the same sty_review_scene tells.
 * Errors: STY_ERROR_FILE, STY_ERROR_INPUT ("FILE:LINE:COLUMN: KEY: ..."); those of sty_read_mesh, which name the key
 * before the mesh's file; those of sty_finish_scene ("FILE: ..."). Textures are opened by who shows them: messages
 * about them begin "FILE: objects[2].texture: ". */
StyStatus sty_read_scene(const char *path, const StyMeshOptions *options, StyScene **out, StyViewpoint *viewpoint,
                         StyError *error);

/* Reads the camera alone: the file may lack all else, and meshes that it names aren't read. It has to stand
 * somewhere, so "fit", which takes a scene, is STY_ERROR_INPUT. Errors: STY_ERROR_FILE, STY_ERROR_INPUT. */
StyStatus sty_read_stand(const char *path, StyStand *out, StyError *error);

/* sty_fit_camera or sty_place_camera, as the viewpoint asks, with their errors. STY_ERROR_INPUT: beyond STY_MAX_CAMERA,
 * too. */
StyStatus sty_set_camera(const StyScene *scene, const StyViewpoint *viewpoint, int width, int height, StyCamera *out,
                         StyError *error);

#ifdef __cplusplus
}
#endif
#endif
