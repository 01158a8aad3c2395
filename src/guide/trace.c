/* Guides of scenes: one ray per pixel, and what it meets as channels. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "guide/bands.h"
#include "guide/channels.h"
#include "guide/contour.h"
#include "guide/light.h"
#include "guide/paint.h"
#include "guide/paths.h"
#include "scene/points.h"
#include "scene/vector.h"

/* A block of rays covers so many pixels. */
enum { BLOCK_WIDTH = 4, BLOCK_HEIGHT = STY_RAYS / BLOCK_WIDTH, TILE = 32 };

/* Orthographic rays start this far behind the eye's plane (trace units), so
 * that a surface that touches the plane isn't missed. */
static const double START_SLACK = 1.0 / 1024;

/* Embree aborts on absurd origins; a camera near the scene is far below this. */
static const double LARGEST_CAMERA = 1e6;

/* What a picture is made from. */
typedef struct Render {
  const StyScene *scene;
  StyTracer *tracer;
  StyPalette *palette; /* NULL where no channel asks for colours */
  const StyCamera *camera;
  const StyTraceOptions *options;
  unsigned groups;    /* what is asked for, and what that takes */
  unsigned parts;     /* StyHitPart */
  StyPathWorld world; /* for light paths */
  double width;       /* of a pixel at depth 1, or at any for an orthographic camera; scene units */
} Render;

/* ---- pixels ---- */

/* Film coordinates along a side of `count` pixels, from -half to half. */
static double get_film(int pixel, int count, double half) { return ((pixel + 0.5) / count * 2 - 1) * half; }

/* The rays of a block: the film's point moves, and with it their origins or their directions. */
static void make_rays(const Render *render, int x0, int y0, StyRays *rays) {
  const StyCamera *camera = render->camera;
  double s[STY_RAYS], t[STY_RAYS];
  for (int i = 0; i < STY_RAYS; i++) {
    s[i] = get_film(x0 + i % BLOCK_WIDTH, render->options->width, camera->half_width);
    t[i] = -get_film(y0 + i / BLOCK_WIDTH, render->options->height, camera->half_height);
  }
  for (int k = 0; k < 3; k++) {
    const double eye = camera->eye[k], back = camera->back[k], start = eye + START_SLACK * back;
    for (int i = 0; i < STY_RAYS; i++) {
      const double film = s[i] * camera->right[k] + t[i] * camera->up[k];
      rays->origin[k][i] = camera->perspective ? eye : start + film;
      rays->direction[k][i] = camera->perspective ? film - back : -back;
    }
  }
}

static void bend_to_horizon(const double direction[3], double normal[3]) {
  if (dot_vectors(normal, direction) <= 0) return;
  double along[3] = {direction[0], direction[1], direction[2]};
  normalize_vector(along);
  const double away = dot_vectors(normal, along);
  for (int k = 0; k < 3; k++) normal[k] -= away * along[k];
  normalize_vector(normal);
}

/* The axes that are relative to a ray. */
static void turn_axes(const StyCamera *camera, const double direction[3], double right[3], double up[3],
                      double back[3]) {
  memcpy(right, camera->right, 3 * sizeof *right);
  for (int k = 0; k < 3; k++) back[k] = -direction[k];
  normalize_vector(back);
  const double along = dot_vectors(right, back);
  for (int k = 0; k < 3; k++) right[k] -= along * back[k];
  normalize_vector(right);
  cross_vectors(back, right, up);
}

static void shade_normal(const Render *render, const StyHit *hit, const double direction[3], double out[3]) {
  double normal[3], right[3], up[3], back[3];
  if (render->options->flat) {
    memcpy(normal, hit->facet, sizeof normal);
    normalize_vector(normal);
  } else {
    memcpy(normal, hit->shading, sizeof normal);
    bend_to_horizon(direction, normal);
  }
  const StyCamera *camera = render->camera;
  const bool turned = render->options->ray_frame && camera->perspective;
  if (turned) turn_axes(camera, direction, right, up, back);
  out[0] = dot_vectors(normal, turned ? right : camera->right);
  out[1] = dot_vectors(normal, turned ? up : camera->up);
  out[2] = dot_vectors(normal, turned ? back : camera->back);
}

static void shade_place(const Render *render, const StyHit *hit, StySample *sample) {
  const StyScene *scene = render->scene;
  double from_eye[3];
  for (int k = 0; k < 3; k++) {
    from_eye[k] = hit->at[k] - render->camera->eye[k];
    if (render->groups & STY_GUIDE_POSITION) sample->position[k] = hit->at[k] / scene->scale + scene->centre[k];
  }
  sample->depth = -dot_vectors(from_eye, render->camera->back) / scene->scale;
}

/* Where a point of trace space is on the film, in pixels; false: behind the camera. The inverse of make_rays. */
static bool project(const StyCamera *camera, const StyTraceOptions *options, const double at[3], double pixel[2]) {
  double from[3];
  subtract_vectors(at, camera->eye, from);
  const double depth = camera->perspective ? -dot_vectors(from, camera->back) : 1;
  if (!(depth > 0)) return false;
  const double s = dot_vectors(from, camera->right) / depth, t = dot_vectors(from, camera->up) / depth;
  pixel[0] = (s / camera->half_width + 1) / 2 * options->width;
  pixel[1] = (1 - t / camera->half_height) / 2 * options->height;
  return true;
}

static void shade_motion(const Render *render, const StyHit *hit, double motion[2]) {
  const StyPrevious *previous = &render->options->previous;
  double now[2], then[2], at[3];
  motion[0] = motion[1] = 0;
  sty_follow_hit(render->scene, hit, previous->scene, at);
  if (!project(render->camera, render->options, hit->at, now) || !project(previous->camera, render->options, at, then))
    return;
  for (int k = 0; k < 2; k++) motion[k] = then[k] - now[k];
}

static void shade_hit(const Render *render, const StyBlock *block, int i, const StyPathLight *paths,
                      const StyGuide *guide, size_t pixel) {
  const StyHit *hit = &block->hits[i];
  StySample sample; /* no more of it is set than is read */
  sample.object = hit->object;
  sample.style = hit->style;
  sample.luma = block->luma[i];
  if (render->palette) memcpy(sample.albedo, block->albedo[i], sizeof sample.albedo);
  const StyRay ray = sty_get_ray(&block->rays, i);
  if (render->groups & STY_GUIDE_NORMAL) shade_normal(render, hit, ray.direction, sample.normal);
  if (render->groups & (STY_GUIDE_DEPTH | STY_GUIDE_POSITION)) shade_place(render, hit, &sample);
  if (render->groups & STY_GUIDE_UV) memcpy(sample.uv, hit->uv, sizeof sample.uv);
  if (render->groups & STY_GUIDE_CURVATURE) sample.curvature = hit->curvature * render->scene->scale;
  if (render->groups & STY_GUIDE_MOTION) shade_motion(render, hit, sample.motion);
  if (render->groups & STY_GUIDE_PATHS) sample.paths = *paths;
  sty_set_sample(guide, pixel, &sample);
}

/* ---- tiles ---- */

/* Rows of the picture, as a guide of their own. */
typedef struct Band {
  const Render *render;
  const StyGuide *guide;
  int first; /* its first row in the picture, even: blocks then hold the same pixels in whatever band */
} Band;

static void trace_block(const Band *band, int x0, int y0) {
  const Render *render = band->render;
  const int width = render->options->width;
  StyBlock block;
  StyPathLight paths[STY_RAYS];
  int pixels[STY_RAYS][2];
  for (int i = 0; i < STY_RAYS; i++) {
    const int x = pixels[i][0] = x0 + i % BLOCK_WIDTH, y = pixels[i][1] = y0 + i / BLOCK_WIDTH;
    block.valid[i] = x < width && y < render->options->height ? -1 : 0;
  }
  make_rays(render, x0, y0, &block.rays);
  if (!sty_trace_rays(render->tracer, &block.rays, true, render->parts, block.valid, block.hits)) return;
  for (int i = 0; i < STY_RAYS; i++)
    if (block.valid[i] && render->palette) sty_get_albedo(render->palette, &block.hits[i], block.albedo[i]);
  if (render->groups & STY_GUIDE_LUMA) sty_light_block(render->scene, render->tracer, &block);
  if (render->groups & STY_GUIDE_PATHS) sty_trace_paths(&render->world, &block, pixels, paths);
  for (int i = 0; i < STY_RAYS; i++) {
    const int x = pixels[i][0], row = pixels[i][1] - band->first;
    if (block.valid[i] && row < band->guide->image->height)
      shade_hit(render, &block, i, &paths[i], band->guide, (size_t)row * (size_t)width + (size_t)x);
  }
}

static int count_tiles(int side) { return (side + TILE - 1) / TILE; }

static StyStatus trace_tile(void *context, long tile, StyError *error) {
  (void)error;
  const Band *band = context;
  const int width = band->render->options->width, height = band->guide->image->height, columns = count_tiles(width);
  const int x0 = (int)(tile % columns) * TILE, y0 = (int)(tile / columns) * TILE;
  for (int y = y0; y < y0 + TILE && y < height; y += BLOCK_HEIGHT)
    for (int x = x0; x < x0 + TILE && x < width; x += BLOCK_WIDTH) trace_block(band, x, band->first + y);
  return STY_OK;
}

static StyStatus draw_contours(const Render *render, const StyGuide *guide, const StyRun *run, StyError *error) {
  const bool perspective = render->camera->perspective;
  const StyFootprint footprint = {perspective ? 0 : render->width, perspective ? render->width : 0};
  return sty_draw_contours(guide, &render->options->contour, &footprint, run, error);
}

static StyStatus trace_band(void *context, int first, const StyGuide *guide, const StyRun *run, StyError *error) {
  const Render *render = context;
  Band band = {render, guide, first};
  const long tiles = (long)count_tiles(guide->image->width) * count_tiles(guide->image->height);
  const StyStatus status = sty_parallel_for(run, tiles, trace_tile, &band, error);
  return status || !(render->groups & STY_GUIDE_CONTOUR) ? status : draw_contours(render, guide, run, error);
}

/* ---- the whole ---- */

static StyStatus check_camera(const StyCamera *camera, StyError *error) {
  const double values[] = {camera->eye[0],   camera->eye[1],  camera->eye[2],     camera->right[0],   camera->right[1],
                           camera->right[2], camera->up[0],   camera->up[1],      camera->up[2],      camera->back[0],
                           camera->back[1],  camera->back[2], camera->half_width, camera->half_height};
  for (size_t i = 0; i < sizeof values / sizeof *values; i++)
    if (!(fabs(values[i]) <= LARGEST_CAMERA))
      return sty_fail(error, STY_ERROR_USAGE, "camera: found the value %g, expected at most %g scene sizes", values[i],
                      LARGEST_CAMERA);
  return STY_OK;
}

static StyStatus check_options(const StyScene *scene, const StyTraceOptions *options, StyError *error) {
  const int samples = options->paths.samples;
  if (options->width < 1 || options->height < 1)
    return sty_fail(error, STY_ERROR_INPUT, "guide: found %dx%d pixels, expected at least 1x1", options->width,
                    options->height);
  if (options->groups & STY_GUIDE_PATHS && (samples < 1 || samples > STY_MOST_SAMPLES))
    return sty_fail(error, STY_ERROR_USAGE, "light paths: found %d samples a pixel, expected 1 to %d", samples,
                    STY_MOST_SAMPLES);
  if (!(options->groups & STY_GUIDE_MOTION)) return STY_OK;
  if (!options->previous.scene)
    return sty_fail(error, STY_ERROR_USAGE, "channel motion: found no previous scene, expected one");
  const StyStatus status = sty_check_alike(scene, options->previous.scene, error);
  return status ? status : check_camera(options->previous.camera, error);
}

/* The channels that the surfaces' colours, and their light, go into. */
enum { LIT = STY_GUIDE_LUMA | STY_GUIDE_PATHS, COLOURED = LIT | STY_GUIDE_ALBEDO };

/* What of a hit the channels are made from. */
static unsigned get_parts(unsigned groups, const StyScene *scene) {
  unsigned parts = 0;
  const bool textured = scene->texture_count > 0 && groups & COLOURED;
  if (groups & (STY_GUIDE_NORMAL | STY_GUIDE_CURVATURE | LIT)) parts |= STY_HIT_SHADING;
  if (groups & STY_GUIDE_UV || textured) parts |= STY_HIT_UV;
  if (groups & STY_GUIDE_CURVATURE) parts |= STY_HIT_CURVATURE;
  return parts;
}

static StyStatus open_render(Render *render, StyTraceTimes *times, StyError *error) {
  const StyScene *scene = render->scene;
  const StyTraceOptions *options = render->options;
  StyStatus status = check_camera(render->camera, error);
  if (!status) status = check_options(scene, options, error);
  render->groups = options->groups;
  if (options->groups & STY_GUIDE_CONTOUR) render->groups |= STY_CONTOUR_SOURCES;
  render->parts = get_parts(render->groups, scene);
  render->width = 2 * render->camera->half_height / options->height;
  if (!render->camera->perspective) render->width /= scene->scale;
  if (!status && options->groups & COLOURED)
    status = sty_open_palette(scene, options->nearest_texels, &render->palette, error);
  const double start = sty_get_milliseconds();
  if (!status) status = sty_open_tracer(scene, &render->tracer, error);
  times->build_ms = sty_get_milliseconds() - start;
  render->world = (StyPathWorld){.scene = scene,
                                 .tracer = render->tracer,
                                 .palette = render->palette,
                                 .parts = get_parts(render->groups & STY_GUIDE_PATHS, scene),
                                 .groups = render->groups,
                                 .options = options->paths};
  if (!status) times->tree_bytes = sty_get_tracer_bytes(render->tracer);
  return status;
}

static void close_render(Render *render) {
  sty_close_tracer(&render->tracer);
  sty_close_palette(&render->palette);
}

StyStatus sty_trace_rows(const StyScene *scene, const StyCamera *camera, const StyTraceOptions *options,
                         const StyRun *run, const StyRowSink *sink, StyTraceTimes *times, StyError *error) {
  Render render = {.scene = scene, .camera = camera, .options = options};
  StyTraceTimes found = {0};
  StyStatus status = open_render(&render, &found, error);
  const double start = sty_get_milliseconds();
  const StyBands bands = {.width = options->width,
                          .height = options->height,
                          .apron = options->groups & STY_GUIDE_CONTOUR ? BLOCK_HEIGHT : 0,
                          .groups = render.groups,
                          .wanted = options->groups,
                          .fill = trace_band,
                          .context = &render};
  if (!status) status = sty_stream_bands(&bands, run, sink, &found.first_ms, error);
  close_render(&render);
  if (status) return status;
  found.trace_ms = sty_get_milliseconds() - start;
  if (times) *times = found;
  return STY_OK;
}

StyStatus sty_trace_guide(const StyScene *scene, const StyCamera *camera, const StyTraceOptions *options,
                          const StyRun *run, StyTraceTimes *times, StyImage **out, StyError *error) {
  Render render = {.scene = scene, .camera = camera, .options = options};
  StyTraceTimes found = {0};
  StyGuide guide = {0};
  StyStatus status = open_render(&render, &found, error);
  const double start = sty_get_milliseconds();
  if (!status) status = sty_create_guide(options->width, options->height, render.groups, &guide, error);
  if (!status) status = trace_band(&render, 0, &guide, run, error);
  if (!status) status = sty_select_channels(&guide.image, 0, options->height, options->groups, error);
  close_render(&render);
  if (status) {
    sty_destroy_image(&guide.image);
    return status;
  }
  found.first_ms = found.trace_ms = sty_get_milliseconds() - start;
  if (times) *times = found;
  *out = guide.image;
  return STY_OK;
}
