/* Guide images: what a picture's surfaces are, pixel by pixel.
 *
 * Channels by name, point-sampled at pixel centres, never anti-aliased:
 *   A                    1 where a surface covers the pixel centre, else 0
 *   normal.X .Y .Z       view-space shading normal, unit length; miss 0
 *   depth.Z              distance along the view axis, scene units; miss +inf
 *   position.X .Y .Z     world position; miss 0
 *   object.I             id of the part, 1 and up; miss 0
 *   style.I              id of the style that the scene gives it, 0 = none; miss 0
 *   uv.U .V              texture coordinates, V up, as the mesh's file has them; miss 0
 *   albedo.R .G .B       scene-linear diffuse reflectance, colour times texture; miss 0
 *   luma.Y               scene-linear luminance of the lit surface (Rec. 709 weights): its
 *                        reflectance times what reaches it, times the cosine, and the highlight;
 *                        white, faced by a light of intensity 1, is 1; miss 0
 *   curvature.Y          mean curvature of the surface that the shading normals tell, per scene unit,
 *                        positive where it bulges toward the viewer: 1/r on a sphere of radius r; miss 0
 *   contour.Y            strength of the outline, 0..1, see StyContourWeights; miss 0
 *   motion.U .V          pixels from this frame to where the same point was in the previous one, +U
 *                        right, +V down; 0 where that lies behind the camera; miss 0
 *   full LDE LSE LD12E LIE, each .R .G .B
 *                        scene-linear colour of the lit surface by the ways that light came, see StyPathOptions; miss 0
 * View space: +X right, +Y up, +Z toward the viewer. A shading normal that
 * would face away from its view ray is bent to the horizon.
 * In the ray frame, +Z is the way back along the pixel's own view ray, +X is the camera's right
 * made perpendicular to that, and +Y their cross product: a flat surface under perspective then
 * varies from pixel to pixel, where view space gives it one normal (the known fault of matcaps).
 * Orthographic, both frames are the same. */
#ifndef STYLUT_GUIDE_H
#define STYLUT_GUIDE_H

#include <stdint.h>

#include "stylut/image.h"
#include "stylut/parallel.h"
#include "stylut/scene.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Groups of channels that can be asked for; A is always there. */
typedef enum StyChannelGroup {
  STY_GUIDE_NORMAL = 1 << 0,
  STY_GUIDE_DEPTH = 1 << 1,
  STY_GUIDE_POSITION = 1 << 2,
  STY_GUIDE_OBJECT = 1 << 3,
  STY_GUIDE_STYLE = 1 << 4,
  STY_GUIDE_ALBEDO = 1 << 5,
  STY_GUIDE_LUMA = 1 << 6,
  STY_GUIDE_UV = 1 << 7,
  STY_GUIDE_CURVATURE = 1 << 8,
  STY_GUIDE_CONTOUR = 1 << 9,
  STY_GUIDE_MOTION = 1 << 10, /* needs a previous frame, so that "all" doesn't hold it */
  STY_GUIDE_FULL = 1 << 11,   /* these five take many rays a pixel, so that "all" doesn't hold them; "paths" does */
  STY_GUIDE_LDE = 1 << 12,
  STY_GUIDE_LSE = 1 << 13,
  STY_GUIDE_LD12E = 1 << 14,
  STY_GUIDE_LIE = 1 << 15,
  STY_GUIDE_PATHS = STY_GUIDE_FULL | STY_GUIDE_LDE | STY_GUIDE_LSE | STY_GUIDE_LD12E | STY_GUIDE_LIE,
  STY_GUIDE_LIT = STY_GUIDE_LUMA | STY_GUIDE_PATHS,      /* what surfaces' light goes into, and */
  STY_GUIDE_COLOURED = STY_GUIDE_LIT | STY_GUIDE_ALBEDO, /* what their colours do, textures included */
} StyChannelGroup;

/* "normal,depth,...", "all" or "paths" to a set of StyChannelGroup. STY_ERROR_USAGE lists the names. */
StyStatus sty_parse_channels(const char *what, const char *text, unsigned *groups, StyError *error);

/* The unit sphere, orthographic, filling a width x height picture (an ellipse
 * where the sides differ): normal (x, y, sqrt(1-x*x-y*y)) at the pixel centre's
 * x = (i+1/2)/width*2-1, y = 1-(j+1/2)/height*2, where x*x+y*y <= 1. Its depth
 * counts from the plane z = 1 that touches the sphere; position = normal;
 * object 1. Its light is ambient, 1 from everywhere: full, LDE and LD12E are 1, LSE and LIE 0. */
StyStatus sty_make_sphere_guide(int width, int height, unsigned groups, StyImage **out, StyError *error);

/* What makes an outline (thesis of the Unreal plugin, seed 000, 3.4.2: the weighted sum of what depth and normals do
 * beside a pixel). Depth: by how much the pixel leaves the line between its neighbours, left and right or above and
 * below, whichever is more; STY_CONTOUR_SPAN pixels' width counts as 1, so that slanted planes count as 0 and
 * silhouettes as 1. Normals: one minus the cosine to that of a neighbour, whichever of the four is most. */
typedef struct StyContourWeights {
  double depth, normal; /* 0..1000 */
} StyContourWeights;

#define STY_CONTOUR_SPAN 16
extern const StyContourWeights sty_default_contour; /* 1, 1 */

/* How the light-path channels are sampled. They are sums over the ways that light takes from a source L to the eye E by
 * diffuse (D) and glossy (S) reflections, first to last (Heckbert 1990); the channels are StyLit's (Fiser et al. 2016):
 *   full   L[DS]+E      everything that surfaces send to the eye
 *   LDE    LDE          direct diffuse
 *   LSE    LSE          direct specular
 *   LD12E  LDE, LDDE    the first two diffuse bounces
 *   LIE    L[DS]*DDE    diffuse interreflection (StyLit's L.*DDE)
 * full = LDE + LSE + LIE + what has no channel: L[DS]*SDE (light thrown on diffuse surfaces by glossy ones) and
 * L[DS]+SE (what glossy surfaces mirror). No way is in two of these five; both of the last are 0 where nothing has a
 * highlight. LD12E is LDE and the part LDDE of LIE.
 *
 * Sources are the scene's lights, as for luma: at ambient 0 the luminance of LDE + LSE is luma.Y, without any noise.
 * Ambient light is a surrounding of that radiance, seen by every ray that leaves the scene: it lights white to
 * `ambient`, less what stands in its way, where luma's is never hidden.
 * Bounces: a surface sends its albedo on as Lambert does. A highlight's lobe is that of facets whose normals have the
 * density (shininess+1)/2pi cos^shininess about the surface's (Blinn 1977), and mirrors `specular` of what comes, for
 * any shininess: a wall that a light brings to 1 is mirrored as bright as the peak of that light's own highlight.
 * Where albedo and specular sum to more than 1, bounces scale the albedo down so that they don't: no bounce gives back
 * more than it got. Ways that would lead below the facet are mirrored to above it.
 * Each way ends after STY_MOST_BOUNCES surfaces, which at albedo 0.9 leaves out 0.1 % of the light in a closed room,
 * and from the fourth on by Russian roulette, which changes no mean. Samples are scrambled Sobol points (Burley 2020),
 * of a pixel's place, the seed and nothing else: channels have the same values whichever others are asked for. */
typedef struct StyPathOptions {
  int samples; /* ways per pixel, 1..STY_MOST_SAMPLES; powers of 2 are best spread */
  uint64_t seed;
} StyPathOptions;

enum { STY_MOST_SAMPLES = 65536, STY_MOST_BOUNCES = 64 };
extern const StyPathOptions sty_default_paths; /* 64, 0 */

/* Of a scene one frame before: it must be alike (sty_check_alike). */
typedef struct StyPrevious {
  const StyScene *scene;
  const StyCamera *camera;
} StyPrevious;

typedef struct StyTraceOptions {
  int width, height;
  unsigned groups;
  bool flat;                 /* facet normals instead of shading normals */
  bool ray_frame;            /* normals relative to the view ray, see above */
  bool nearest_texels;       /* textures are looked up without interpolation */
  StyContourWeights contour; /* for STY_GUIDE_CONTOUR */
  StyPrevious previous;      /* for STY_GUIDE_MOTION */
  const char *previous_name; /* what messages call it; NULL: nothing */
  StyPathOptions paths;      /* for STY_GUIDE_PATHS */
} StyTraceOptions;

typedef struct StyTraceTimes {
  double build_ms;   /* acceleration structure */
  double first_ms;   /* from the end of that to the first band of pixels */
  double trace_ms;   /* rays and shading, of all bands, without waiting for the sink */
  double tree_bytes; /* most memory that the structure took, over the scene's own */
} StyTraceTimes;

/* What tracing a picture will take. Rays that depend on what others meet are counted as the most there can be. */
typedef struct StyTraceEstimate {
  double camera_rays;
  double paths, path_rays; /* for STY_GUIDE_PATHS: ways, and rays of theirs */
  double shadow_rays;
  double build_bytes;   /* of the acceleration structure while it is built, and */
  double tree_bytes;    /* when it is, as measured per triangle */
  double texture_bytes; /* of colours, and */
  double decode_bytes;  /* while the largest is read */
  double band_bytes;    /* of the rows in the making and on their way */
  int channels, rows;   /* of a band */
} StyTraceEstimate;

/* Reads no more than the headers of the textures that would be looked at. Errors: those of sty_trace_rows, but for its
 * sink's, and what isn't seen before it is traced. */
StyStatus sty_estimate_trace(const StyScene *scene, const StyCamera *camera, const StyTraceOptions *options,
                             StyTraceEstimate *out, StyError *error);

/* Takes the next rows of a guide, from the top: a guide of its own, as high as the rows are, which it may change but
 * does not own. */
typedef struct StyRowSink {
  StyStatus (*take)(void *context, StyImage *rows, StyError *error);
  void *context;
} StyRowSink;

/* Casts one ray per pixel with Embree (more for luma and light paths), in tiles on all threads of `run`, band by band;
 * the result does not depend on their number. While a band is traced, a thread of its own hands the one before to the
 * sink, so that no more than two bands are held. `times` may be NULL. Depth of a fitted orthographic camera counts from
 * the eye's plane. Errors: those of the sink; STY_ERROR_USAGE (channels that lack what they need, a number of samples),
 * STY_ERROR_INPUT (scenes that aren't alike, textures), STY_ERROR_LIBRARY. */
StyStatus sty_trace_rows(const StyScene *scene, const StyCamera *camera, const StyTraceOptions *options,
                         const StyRun *run, const StyRowSink *sink, StyTraceTimes *times, StyError *error);

/* The same as one image, which the caller owns. */
StyStatus sty_trace_guide(const StyScene *scene, const StyCamera *camera, const StyTraceOptions *options,
                          const StyRun *run, StyTraceTimes *times, StyImage **out, StyError *error);

/* Turns a picture as read from a file into a guide with channels A and
 * normal.X .Y .Z and all other channels with a dot in their names, in place of
 * the picture: *image is replaced.
 * - Channels named normal.* are taken as they are; without A every pixel whose
 *   normal isn't zero is covered.
 * A keeps the values it has above 0, at most 1: they become the picture's alpha.
 * - Otherwise R, G, B of an 8- or 16-bit file hold n/2+1/2 (Y up), and A, where
 *   there is one, covers where it is above 0; without alpha, black is background.
 * `name` is for messages. STY_ERROR_INPUT: no normals, a coverage that isn't a number, or a covered pixel
 * whose normal isn't finite or lies outside STY_MAX_GUIDE_VALUE (the message names it). A guide without any
 * covered pixel passes: a frame may well be empty. */
StyStatus sty_import_guide(const char *name, StyImage **image, StyError *error);

/* A guide's normals as a picture that any program opens: R G B = n/2+1/2, A =
 * covered, in 8 or 16 bits; 0 where nothing is covered. With 8 bits this is
 * what the runtime compares. */
StyStatus sty_encode_normals(const StyImage *guide, int bits, StyImage **out, StyError *error);

#ifdef __cplusplus
}
#endif
#endif
