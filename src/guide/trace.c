/* Guides of scenes: one ray per pixel, and what it meets as channels. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "guide/bands.h"
#include "guide/channels.h"
#include "guide/contour.h"
#include "guide/kernels.h"
#include "guide/light.h"
#include "guide/paint.h"
#include "guide/paths.h"
#include "guide/trace.h"
#include "scene/points.h"
#include "scene/vector.h"

enum { TILE = STY_STRIP_WIDTH }; /* pixels, whole blocks */

/* What a picture is made from. */
typedef struct Render {
  const StyScene *scene;
  StyTracer *tracer;
  StyPalette *palette; /* NULL where no channel asks for colours */
  const StyCamera *camera;
  const StyTraceOptions *options;
  const StyKernels *kernels;
  StyFilm film;
  StySight sight;
  unsigned groups; /* what is asked for, and what that takes */
  bool is_lit;     /* lights shine into some of it; all else is bounded */
  StyChannels channels;
  unsigned parts;     /* StyHitPart */
  StyPathWorld world; /* for light paths */
  double width;       /* of a pixel at depth 1, or at any for an orthographic camera; scene units */
  StyGuide sources;   /* what a band's outlines are made from: the row above it, its own, a block below it; owned */
} Render;

/* ---- pixels ---- */

static void see_motion(const Render *render, const StyHits *hits, int i, StyLane motion[2]) {
  const StyPrevious *previous = &render->options->previous;
  const int width = render->options->width, height = render->options->height;
  double now[2], then[2], here[3], there[3];
  motion[0][i] = motion[1][i] = 0;
  sty_get_lane(hits->at, i, here);
  sty_follow_hit(render->scene, hits, i, previous->scene, there);
  if (!sty_project_point(render->camera, width, height, here, now) ||
      !sty_project_point(previous->camera, width, height, there, then))
    return;
  for (int k = 0; k < 2; k++) motion[k][i] = then[k] - now[k];
}

/* Channels are floats, which light without bounds doesn't fit. */
static StyStatus check_light(const StyChannels *channels, const StyBlock *block, const StySamples *samples, int x,
                             int y, StyError *error) {
  const StyLane *lanes = (const StyLane *)(const void *)samples;
  for (int c = 0; c < channels->count; c++)
    for (int i = 0; i < STY_RAYS; i++) {
      const double value = lanes[channels->channels[c].lane][i];
      if (block->valid[i] && !(fabs(value) <= (double)FLT_MAX))
        return sty_fail(error, STY_ERROR_INPUT, "%s: found %g at pixel (%d, %d), expected at most %g: less light",
                        channels->channels[c].name, value, x + i % STY_BLOCK_WIDTH, y + i / STY_BLOCK_WIDTH,
                        (double)FLT_MAX);
    }
  return STY_OK;
}

/* ---- tiles ---- */

/* Rows of the picture, as a guide of their own. */
typedef struct Band {
  const Render *render;
  const StyGuide *guide;
  int first; /* its first row in the picture, even: blocks then hold the same pixels in whatever band */
  int rows;  /* that are traced: its own, and below them what outlines need */
} Band;

/* What a tile's blocks are worked out in, one after the other, and go into. */
typedef struct Bench {
  StyBlock block;
  StySamples samples;
  StyStrip strip;
} Bench;

/* False: the block's pixels show nothing. */
static bool look_at_block(const Render *render, int x, int y, Bench *bench) {
  StyBlock *block = &bench->block;
  StySamples *samples = &bench->samples;
  for (int i = 0; i < STY_RAYS; i++) {
    const bool is_inside =
        x + i % STY_BLOCK_WIDTH < render->options->width && y + i / STY_BLOCK_WIDTH < render->options->height;
    block->valid[i] = is_inside ? -1 : 0;
  }
  render->kernels->make_rays(&render->film, x, y, &block->rays);
  if (!sty_trace_rays(render->tracer, &block->rays, true, render->parts, block->valid, &block->hits)) return false;
  render->kernels->see_hits(&render->sight, &block->rays, &block->hits, samples);
  for (int i = 0; i < STY_RAYS; i++) {
    if (block->valid[i] && render->palette) sty_get_albedo(render->palette, &block->hits, i, block->albedo);
    if (block->valid[i] && render->groups & STY_GUIDE_MOTION) see_motion(render, &block->hits, i, samples->motion);
  }
  if (render->groups & STY_GUIDE_ALBEDO) memcpy(samples->albedo, block->albedo, sizeof samples->albedo);
  if (render->groups & STY_GUIDE_LUMA) sty_light_block(render->scene, render->tracer, block, samples->luma);
  if (render->groups & STY_GUIDE_PATHS) sty_trace_paths(&render->world, block, x, y, &samples->paths);
  return true;
}

/* Rows of the sources before those of the band. */
enum { ROWS_ABOVE = 1 };

static int count_tiles(int side) { return (side + TILE - 1) / TILE; }

static StyStatus trace_strip(const Band *band, int x0, int y, int right, Bench *bench, StyError *error) {
  const Render *render = band->render;
  StyStatus status = STY_OK;
  for (int x = x0; x < right && !status; x += STY_BLOCK_WIDTH) {
    if (!look_at_block(render, x, band->first + y, bench)) continue;
    if (render->is_lit)
      status = check_light(&render->channels, &bench->block, &bench->samples, x, band->first + y, error);
    render->kernels->set_samples(&render->channels, x - x0, bench->block.valid, &bench->samples, &bench->strip);
  }
  return status;
}

static StyStatus trace_tile(void *context, long tile, StyError *error) {
  const Band *band = context;
  const Render *render = band->render;
  const int width = render->options->width, columns = count_tiles(width);
  const int x0 = (int)(tile % columns) * TILE, y0 = (int)(tile / columns) * TILE;
  const int right = x0 + TILE < width ? x0 + TILE : width, bottom = y0 + TILE < band->rows ? y0 + TILE : band->rows;
  Bench bench;
  memset(&bench.block, 0, sizeof bench.block);
  memset(&bench.samples, 0, sizeof bench.samples);
  EACH_LANE bench.samples.coverage[i] = 1;
  StyStatus status = STY_OK;
  for (int y = y0; y < bottom && !status; y += STY_BLOCK_HEIGHT) {
    sty_clear_strip(&render->channels, &bench.strip);
    const bool in_sight = sty_is_in_sight(&render->film, x0, band->first + y, TILE, STY_BLOCK_HEIGHT);
    if (in_sight) status = trace_strip(band, x0, y, right, &bench, error);
    sty_write_strip(&bench.strip, x0, y, band->guide);
    if (render->sources.image) sty_write_strip(&bench.strip, x0, y + ROWS_ABOVE, &render->sources);
  }
  sty_finish_strips();
  return status;
}

static void draw_contours(const Band *band, int threads) {
  const Render *render = band->render;
  const bool perspective = render->camera->perspective;
  const StyContours contours = {.sources = render->sources.image,
                                .drawn = band->guide->image,
                                .first = ROWS_ABOVE,
                                .is_top = band->first == 0,
                                .is_bottom = band->first + band->guide->image->height == render->options->height,
                                .weights = &render->options->contour,
                                .footprint = {perspective ? 0 : render->width, perspective ? render->width : 0}};
  sty_draw_contours(&contours, threads);
}

/* The row above a band is the last of the one before. */
static void keep_last_row(const StyGuide *sources, int rows) {
  const size_t width = (size_t)sources->image->width;
  for (int c = 0; c < sources->channels.count; c++)
    memcpy(sources->planes[c], sources->planes[c] + (size_t)rows * width, width * sizeof(float));
}

/* What a band's outlines take beside its own rows. */
static StyStatus prepare_outlines(Render *render, Band *band, StyError *error) {
  const int width = render->options->width, below = render->options->height - band->first - band->rows;
  StyStatus status = STY_OK;
  if (band->first == 0) /* and no other is higher */
    status = sty_create_guide(width, ROWS_ABOVE + band->rows + STY_BLOCK_HEIGHT, STY_CONTOUR_SOURCES, &render->sources,
                              error);
  else
    keep_last_row(&render->sources, render->sources.image->height - ROWS_ABOVE - STY_BLOCK_HEIGHT);
  band->rows += below < STY_BLOCK_HEIGHT ? below : STY_BLOCK_HEIGHT;
  return status;
}

static StyStatus trace_band(void *context, int first, const StyGuide *guide, const StyRun *run, StyError *error) {
  Render *render = context;
  const bool outlined = render->groups & STY_GUIDE_CONTOUR;
  Band band = {.render = render, .guide = guide, .first = first, .rows = guide->image->height};
  StyStatus status = outlined ? prepare_outlines(render, &band, error) : STY_OK;
  const long tiles = (long)count_tiles(guide->image->width) * count_tiles(band.rows);
  if (!status) status = sty_parallel_for(run, tiles, trace_tile, &band, error);
  if (!status && render->palette) status = sty_check_palette(render->palette, error);
  if (!status && outlined) draw_contours(&band, sty_get_threads(run));
  return status;
}

/* ---- the whole ---- */

static StyStatus check_camera(const StyCamera *camera, StyError *error) {
  const double values[] = {camera->eye[0],   camera->eye[1],  camera->eye[2],     camera->right[0],   camera->right[1],
                           camera->right[2], camera->up[0],   camera->up[1],      camera->up[2],      camera->back[0],
                           camera->back[1],  camera->back[2], camera->half_width, camera->half_height};
  for (size_t i = 0; i < sizeof values / sizeof *values; i++)
    if (!(fabs(values[i]) <= STY_MAX_CAMERA))
      return sty_fail(error, STY_ERROR_USAGE, "camera: found the value %g, expected at most %g scene sizes", values[i],
                      STY_MAX_CAMERA);
  return STY_OK;
}

StyStatus sty_check_trace(const StyScene *scene, const StyCamera *camera, const StyTraceOptions *options,
                          StyError *error) {
  const int samples = options->paths.samples;
  StyStatus status = check_camera(camera, error);
  if (status) return status;
  if (options->width < 1 || options->height < 1)
    return sty_fail(error, STY_ERROR_INPUT, "guide: found %dx%d pixels, expected at least 1x1", options->width,
                    options->height);
  if (options->groups & STY_GUIDE_PATHS && (samples < 1 || samples > STY_MOST_SAMPLES))
    return sty_fail(error, STY_ERROR_USAGE, "light paths: found %d samples a pixel, expected 1 to %d", samples,
                    STY_MOST_SAMPLES);
  if (!(options->groups & STY_GUIDE_MOTION)) return STY_OK;
  if (!options->previous.scene)
    return sty_fail(error, STY_ERROR_USAGE, "channel motion: found no previous scene, expected one");
  status = sty_check_alike(scene, options->previous.scene, error);
  if (status && options->previous_name) sty_fail(error, status, "%s: %s", options->previous_name, error->text);
  return status ? status : check_camera(options->previous.camera, error);
}

/* What of a hit the channels are made from. */
static unsigned get_parts(unsigned groups, const StyScene *scene) {
  unsigned parts = 0;
  const bool textured = scene->texture_count > 0 && groups & STY_GUIDE_COLOURED;
  if (groups & (STY_GUIDE_NORMAL | STY_GUIDE_CURVATURE | STY_GUIDE_LIT)) parts |= STY_HIT_SHADING;
  if (groups & STY_GUIDE_UV || textured) parts |= STY_HIT_UV;
  if (groups & STY_GUIDE_CURVATURE) parts |= STY_HIT_CURVATURE;
  if (groups & (STY_GUIDE_OBJECT | STY_GUIDE_STYLE | STY_GUIDE_COLOURED)) parts |= STY_HIT_OWNER;
  if (groups & STY_GUIDE_PATHS || (groups & STY_GUIDE_LUMA && scene->light_count > 0)) parts |= STY_HIT_LEAVE;
  return parts;
}

static StyStatus open_render(Render *render, const StyRun *run, StyTraceTimes *times, StyError *error) {
  const StyScene *scene = render->scene;
  const StyTraceOptions *options = render->options;
  StyStatus status = sty_check_trace(scene, render->camera, options, error);
  render->groups = options->groups;
  if (options->groups & STY_GUIDE_CONTOUR) render->groups |= STY_CONTOUR_SOURCES;
  render->channels = sty_list_channels(render->groups);
  render->is_lit = render->groups & STY_GUIDE_LIT && scene->light_count > 0;
  render->parts = get_parts(render->groups, scene);
  render->kernels = sty_get_kernels();
  render->sight = (StySight){scene, render->camera, render->groups, options->flat, options->ray_frame};
  render->width = 2 * render->camera->half_height / options->height;
  if (!render->camera->perspective) render->width /= scene->scale;
  if (!status && options->groups & STY_GUIDE_COLOURED)
    status = sty_open_palette(scene, options->nearest_texels, &render->palette, error);
  if (!status) status = sty_open_film(scene, render->camera, options->width, options->height, &render->film, error);
  const double start = sty_get_milliseconds();
  if (!status) status = sty_open_tracer(scene, run, &render->tracer, error);
  times->build_ms = sty_get_milliseconds() - start;
  render->world = (StyPathWorld){.scene = scene,
                                 .tracer = render->tracer,
                                 .palette = render->palette,
                                 .parts = get_parts(render->groups & STY_GUIDE_PATHS, scene),
                                 .groups = render->groups,
                                 .options = options->paths};
  if (!status) times->tree_bytes = sty_get_tracer_bytes(render->tracer);
  sty_begin_stage(run, "tracing");
  return status;
}

static void close_render(Render *render) {
  sty_close_film(&render->film);
  sty_destroy_image(&render->sources.image);
  sty_close_tracer(&render->tracer);
  sty_close_palette(&render->palette);
}

StyStatus sty_trace_rows(const StyScene *scene, const StyCamera *camera, const StyTraceOptions *options,
                         const StyRun *run, const StyRowSink *sink, StyTraceTimes *times, StyError *error) {
  Render render = {.scene = scene, .camera = camera, .options = options};
  StyTraceTimes found = {0};
  StyBandTimes filled = {0};
  StyStatus status = open_render(&render, run, &found, error);
  const StyBands bands = {.width = options->width,
                          .height = options->height,
                          .groups = options->groups,
                          .fill = trace_band,
                          .context = &render};
  if (!status) status = sty_stream_bands(&bands, run, sink, &filled, error);
  close_render(&render);
  if (status) return status;
  found.first_ms = filled.first_ms;
  found.trace_ms = filled.fill_ms;
  if (times) *times = found;
  return STY_OK;
}

StyStatus sty_trace_guide(const StyScene *scene, const StyCamera *camera, const StyTraceOptions *options,
                          const StyRun *run, StyTraceTimes *times, StyImage **out, StyError *error) {
  Render render = {.scene = scene, .camera = camera, .options = options};
  StyTraceTimes found = {0};
  StyGuide guide = {0};
  StyStatus status = open_render(&render, run, &found, error);
  const double start = sty_get_milliseconds();
  if (!status) status = sty_create_guide(options->width, options->height, options->groups, &guide, error);
  if (!status) status = trace_band(&render, 0, &guide, run, error);
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
