/* The scene: what stands where, and from where it is seen, no more than guides need.
 *
 * Frames. World: right-handed; objects bring their file's coordinates there by
 * their transform. View: +X right, +Y up, +Z toward the viewer (the camera looks
 * along -Z). Trace space, used inside: world recentred and rescaled so that the
 * scene fits the cube [-1, 1]^3, as in mesh.h; world = trace / scale + centre.
 *
 * Threads: nothing is kept between calls. Functions that take a const scene may run side by side on one; those that
 * change it (sty_add_..., sty_finish_scene, sty_destroy_scene) need it for themselves. All that can fail may do so for
 * lack of memory, STY_ERROR_LIBRARY; other reasons are said with each. Out parameters are written on success. */
#ifndef STYLUT_SCENE_H
#define STYLUT_SCENE_H

#include "stylut/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Within this a camera's eye and the halves of its film lie, trace units: what rays in floats can bear. */
#define STY_MAX_CAMERA 1e6

/* An object is at least as thick as this share of the scene's extent, for the same reason. */
#define STY_MIN_THICKNESS 1e-11

enum { STY_MOST_OBJECTS = 65536, STY_MOST_STYLE = 255, STY_MOST_LIGHTS = 64, STY_MOST_TEXTURES = 4096 };

/* How a surface answers light, scene-linear: Lambert, and Blinn-Phong's highlight (Blinn 1977). */
typedef struct StyMaterial {
  StyPaint paint;
  double specular;  /* of the highlight, 0..1; 0: none */
  double shininess; /* its exponent, 1..10000 */
} StyMaterial;

extern const StyMaterial sty_white; /* without a highlight */

/* A mesh put into the world; several may share one. */
typedef struct StyObject {
  int mesh;               /* index in the scene */
  double transform[3][4]; /* the file's coordinates to the world's; the last column moves */
  int style;              /* 1 .. STY_MOST_STYLE, 0 = none */
  StyMaterial material;
  bool is_painted; /* with the material's paint; else as the mesh's file says, part by part */
  int first_id;    /* part p of the mesh has object.I = first_id + p - 1; set by sty_finish_scene */
} StyObject;

/* An analytic sphere: exact wherever it is looked at. */
typedef struct StySphere {
  double centre[3], radius; /* world */
  int style;                /* as above */
  StyMaterial material;
  int id; /* its object.I; set by sty_finish_scene */
} StySphere;

/* A light without size. What reaches a surface that faces it is colour * intensity, of a
 * point light divided by the distance squared, world units. */
typedef struct StyLight {
  bool is_point;
  double direction[3]; /* the way a directional light shines, any length; world */
  double position[3];  /* of a point light; world */
  double intensity;    /* 0 and up */
  double colour[3];    /* 0 and up */
} StyLight;

typedef struct StyScene {
  StyMesh **meshes; /* owned */
  int mesh_count;
  StyObject *objects;
  int object_count;
  StySphere *spheres;
  int sphere_count;
  StyLight *lights;
  int light_count;
  StyPicture *textures; /* owned */
  int texture_count;
  double ambient;                /* reaches every surface from everywhere */
  bool shadows;                  /* whether things stand in each other's light */
  double centre[3];              /* world */
  double scale;                  /* trace units per world unit */
  double minimum[3], maximum[3]; /* world bounds */
} StyScene;

extern const double sty_identity[3][4];

/* What part p (from 0) of an object's mesh is painted with: the object's own paint, or that of its mesh's file. */
static inline const StyPaint *sty_get_paint(const StyObject *object, const StyMesh *mesh, int p) {
  return object->is_painted || !mesh->paints ? &object->material.paint : &mesh->paints[p];
}

/* An empty scene, evenly lit (ambient 1, with shadows); the caller owns it. sty_destroy_scene frees and nulls *scene
 * and all it owns, and does nothing for NULL. */
StyStatus sty_create_scene(StyScene **out, StyError *error);
void sty_destroy_scene(StyScene **scene);

/* The number of the texture at this path, which is remembered but not opened. Who names it stands at the beginning of
 * messages about the file; of those that name the same the first, NULL: nobody. Pictures that a mesh brings along
 * become the scene's with the mesh, and its paints then have their numbers here. Both texts are copied.
 * STY_ERROR_INPUT: more than STY_MOST_TEXTURES. */
StyStatus sty_add_texture(StyScene *scene, const char *path, const char *named_by, int *number, StyError *error);

/* These append; what is passed by const pointer is copied. A mesh is taken over (*mesh becomes NULL, on failure too)
 * and *number says which it is. An object's mesh and texture must be the scene's. STY_ERROR_INPUT: a transform without
 * a volume or with values that aren't finite, a radius that isn't positive, a light without a direction, more than
 * STY_MOST_OBJECTS, STY_MOST_LIGHTS or STY_MOST_TEXTURES. */
StyStatus sty_add_mesh(StyScene *scene, StyMesh **mesh, int *number, StyError *error);
StyStatus sty_add_object(StyScene *scene, const StyObject *object, StyError *error);
StyStatus sty_add_sphere(StyScene *scene, const StySphere *sphere, StyError *error);
StyStatus sty_add_light(StyScene *scene, const StyLight *light, StyError *error);

/* To be called when all is there: numbers objects, their parts in turn and then spheres,
 * from 1, and sets bounds and trace space. STY_ERROR_INPUT: an empty scene, one without
 * extent, one that reaches beyond 1e30, or with an object that is too thin for it. */
StyStatus sty_finish_scene(StyScene *scene, StyError *error);

/* A scene of one mesh as it stands in its file, of style 1, finished; the mesh is taken over (*mesh becomes NULL, on
 * failure too), and the caller owns the scene. Errors: those of the calls above. */
StyStatus sty_wrap_mesh(StyMesh **mesh, StyScene **out, StyError *error);

/* STY_ERROR_INPUT unless `other` can be an earlier state of the same scene: as many objects and spheres, and objects of
 * the same triangles, wherever their corners are now. Where vertices differ it looks at which corners lie together,
 * with memory for 24 bytes a triangle and 8 a vertex. */
StyStatus sty_check_alike(const StyScene *scene, const StyScene *other, StyError *error);

/* Tells, line by line, what in a finished scene is most likely a mistake and is rendered all the same: material files
 * and textures that aren't there (no channel needs them, or they would be errors), textures on parts that have no
 * texture coordinates, things too small for floats beside the rest. `tell` copies what it keeps. */
void sty_review_scene(const StyScene *scene, void (*tell)(void *context, const char *line), void *context);

/* Triangles of all objects, shared ones counted for each. Never fails. */
size_t sty_count_scene_triangles(const StyScene *scene);

/* The world axis that points up. Its "front", where azimuth is 0, is seen from
 * +Z, and for +Z up from -Y, for -Z up from +Y. */
typedef enum StyUpAxis { STY_UP_Y, STY_UP_Z, STY_UP_X, STY_UP_MINUS_Y, STY_UP_MINUS_Z, STY_UP_MINUS_X } StyUpAxis;
extern const char *const sty_up_axis_names[]; /* NULL-terminated, in the enum's order */

/* The axis that is this unit vector of the world; false: none is, and *out stays. */
bool sty_find_up_axis(const double up[3], StyUpAxis *out);

/* Where the eye is, as people say it. */
typedef struct StyView {
  double azimuth;   /* degrees about the up axis; 0 is the front, 90 its right */
  double elevation; /* degrees above the horizon, -90..90 */
  bool perspective; /* else orthographic */
  double fov;       /* vertical opening, degrees, 1..170; perspective only */
  double margin;    /* empty border as a share of the picture's side, 0..0.45 */
  StyUpAxis up;
} StyView;

/* From the front, orthographic; its opening is for those that make it perspective. */
extern const StyView sty_default_view;

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

/* The camera that looks at the scene, which is finished, from `view` and holds all of it with the
 * margin, for a picture of width x height square pixels. STY_ERROR_USAGE: a value of the view beyond its bounds, or a
 * picture without pixels. STY_ERROR_INPUT: a scene without an extent in this view. */
StyStatus sty_fit_camera(const StyScene *scene, const StyView *view, int width, int height, StyCamera *out,
                         StyError *error);

/* A camera that stands somewhere, world frame. */
typedef struct StyStand {
  bool perspective;
  double position[3], target[3], up[3];
  double fov;    /* vertical opening, degrees, 1..170; perspective only */
  double height; /* of what the film sees, world units; orthographic only */
} StyStand;

/* Of the scene only its trace space counts. STY_ERROR_INPUT: a stand without a direction, an up that it looks along, or
 * a film without a size. STY_ERROR_USAGE: a picture without pixels. */
StyStatus sty_place_camera(const StyScene *scene, const StyStand *stand, int width, int height, StyCamera *out,
                           StyError *error);

#ifdef __cplusplus
}
#endif
#endif
