/* From a scene to the guide's file. */
#include "guide_render.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "meshes.h"
#include "stylut/image_io.h"
#include "stylut/pivots.h"
#include "stylut/scene_file.h"

/* A scene, and from where it is seen. */
typedef struct Shot {
  StyScene *scene;
  StyViewpoint viewpoint;
  StyCamera camera;
} Shot;

/* A scene file, or a mesh that stands alone. */
static StyStatus read_scene(const GuideArguments *arguments, const char *path, const StyRun *run, StyScene **scene,
                            StyViewpoint *viewpoint, StyError *error) {
  const StyMeshOptions options = {.crease_angle = arguments->crease_angle, .run = run};
  if (sty_is_scene_file(path)) return sty_read_scene(path, &options, scene, viewpoint, error);
  StyMesh *mesh = NULL;
  *viewpoint = (StyViewpoint){.is_fit = true, .view = arguments->view};
  const StyStatus status = sty_read_mesh(path, &options, &mesh, error);
  return status ? status : sty_wrap_mesh(&mesh, scene, error);
}

static StyStatus open_shot(const GuideArguments *arguments, const char *path, const StyRun *run, Shot *out,
                           StyError *error) {
  Shot shot = {0};
  StyStatus status = read_scene(arguments, path, run, &shot.scene, &shot.viewpoint, error);
  if (!status) {
    status = sty_set_camera(shot.scene, &shot.viewpoint, arguments->width, arguments->height, &shot.camera, error);
    if (status) sty_fail(error, status, "%s: %s", path, error->text);
  }
  if (status)
    sty_destroy_scene(&shot.scene);
  else
    *out = shot;
  return status;
}

/* The guide on its way into the file, and what was done, for the report. */
typedef struct Work {
  GuideArguments *arguments;
  Shot shot, previous;
  char *previous_name;    /* for messages; owned */
  StyImageWriter *writer; /* from the first rows on */
  size_t triangles, covered;
  double read_ms, write_ms, render_ms; /* the last: all but reading */
  double mesh_bytes;                   /* of all meshes */
  double read_bytes;                   /* the most that this process, or one that imported, held until all were read */
  StyTraceTimes trace;
  StyRepair repair;
  StySimplification simplification;
} Work;

/* Every file that the picture comes from: the scenes, what they name and, if asked for, textures that nothing looks
 * at. */
static StyStatus list_inputs(const Work *work, bool all_textures, const char ***out, int *count, StyError *error) {
  const GuideArguments *arguments = work->arguments;
  const Shot *shots[] = {&work->shot, &work->previous};
  const char *const files[] = {arguments->mesh, arguments->previous};
  size_t most = 2;
  for (int s = 0; s < 2; s++)
    if (shots[s]->scene) most += (size_t)shots[s]->scene->mesh_count + (size_t)shots[s]->scene->texture_count;
  const char **inputs = malloc(most * sizeof *inputs);
  if (!inputs) return sty_fail_memory(error, "inputs", (double)(most * sizeof *inputs));
  *count = 0;
  for (int s = 0; s < 2; s++) {
    const StyScene *scene = shots[s]->scene;
    if (files[s]) inputs[(*count)++] = files[s];
    if (!scene || !sty_is_scene_file(files[s])) continue;
    for (int m = 0; m < scene->mesh_count; m++) inputs[(*count)++] = scene->meshes[m]->path;
  }
  for (int s = 0; s < 2; s++) {
    const bool looked_at = all_textures || (s == 0 && arguments->groups & STY_GUIDE_COLOURED);
    for (int t = 0; looked_at && shots[s]->scene && t < shots[s]->scene->texture_count; t++)
      if (!shots[s]->scene->textures[t].bytes) inputs[(*count)++] = shots[s]->scene->textures[t].path;
  }
  *out = inputs;
  return STY_OK;
}

/* Before any work is put into what would be written over them. */
static StyStatus protect_scene(const Work *work, StyError *error) {
  Options *options = &work->arguments->options;
  const char **inputs = NULL;
  int count = 0;
  StyStatus status = list_inputs(work, true, &inputs, &count, error);
  if (!status && protect_inputs(options, options->output, inputs, count))
    status = sty_fail(error, options->error.status, "%s", options->error.text);
  free(inputs);
  return status;
}

/* What stylize --anchor object goes by. */
static StyStatus add_pivots(const Work *work, StyImage *image, StyError *error) {
  const GuideArguments *arguments = work->arguments;
  StyPivots pivots = {NULL, 0};
  char *text = NULL;
  StyStatus status =
      sty_find_pivots(work->shot.scene, &work->shot.camera, arguments->width, arguments->height, &pivots, error);
  if (!status) status = sty_encode_pivots(&pivots, &text, error);
  if (!status) status = sty_set_attribute(image, STY_PIVOTS_ATTRIBUTE, text, error);
  free(text);
  sty_free_pivots(&pivots);
  return status;
}

static StyStatus open_writer(Work *work, StyImage *like, StyError *error) {
  Options *options = &work->arguments->options;
  const char **inputs = NULL;
  int count = 0;
  StyStatus status = list_inputs(work, false, &inputs, &count, error);
  if (!status)
    status = add_history(options, work->arguments->mesh ? "guide scene" : "guide sphere", like, inputs, count, error);
  free(inputs);
  if (!status && work->shot.scene && sty_find_channel(like, "object.I")) status = add_pivots(work, like, error);
  return status ? status : sty_open_image_writer(options->output, like, work->arguments->height, &work->writer, error);
}

/* The next rows of the guide, from the top: as they are, or as a picture of normals. */
static StyStatus take_rows(void *context, StyImage *rows, StyError *error) {
  Work *work = context;
  const GuideArguments *arguments = work->arguments;
  const double start = sty_get_milliseconds();
  const float *covered = sty_find_channel(rows, "A");
  for (size_t i = 0; i < sty_count_pixels(rows); i++) work->covered += covered[i] > 0;
  StyImage *encoded = NULL;
  StyStatus status = STY_OK;
  if (arguments->format == STY_IMAGE_PNG) status = sty_encode_normals(rows, arguments->bits, &encoded, error);
  StyImage *image = encoded ? encoded : rows;
  if (!status && !work->writer) status = open_writer(work, image, error);
  if (!status) status = sty_write_rows(work->writer, image, error);
  sty_destroy_image(&encoded);
  work->write_ms += sty_get_milliseconds() - start;
  return status;
}

static StyTraceOptions get_trace_options(const Work *work) {
  const GuideArguments *arguments = work->arguments;
  return (StyTraceOptions){.width = arguments->width,
                           .height = arguments->height,
                           .groups = arguments->groups,
                           .flat = arguments->flat,
                           .ray_frame = arguments->frame == 1,
                           .nearest_texels = arguments->filter == 1,
                           .contour = arguments->contour,
                           .previous = {work->previous.scene, &work->previous.camera},
                           .previous_name = work->previous_name,
                           .paths = {arguments->paths.samples, arguments->options.seed}};
}

/* Normals that were computed have seams where neighbours clash: a fault of the mesh that one would look for elsewhere.
 */
static void warn_about_seams(const Work *work) {
  static const unsigned shaded = STY_GUIDE_NORMAL | STY_GUIDE_CURVATURE | STY_GUIDE_CONTOUR | STY_GUIDE_LIT;
  const GuideArguments *arguments = work->arguments;
  const StyScene *scene = work->shot.scene;
  if (arguments->repair || arguments->simplify || arguments->flat || !(arguments->groups & shaded)) return;
  for (int m = 0; m < scene->mesh_count; m++)
    if (scene->meshes[m]->clashes)
      warn(&arguments->options,
           "%s: found %zu edges with neighbours wound against each other, which leaves seams in the normals; --repair "
           "turns them alike",
           clean_text(scene->meshes[m]->path), scene->meshes[m]->clashes);
}

/* What was asked for to be done to the meshes before they are traced. */
static StyStatus prepare_meshes(Work *work, StyError *error) {
  const GuideArguments *arguments = work->arguments;
  StyRepair of_previous;
  StyStatus status = STY_OK;
  if (arguments->repair || arguments->simplify) status = sty_repair_scene(work->shot.scene, &work->repair, error);
  if (!status && arguments->repair && work->previous.scene)
    status = sty_repair_scene(work->previous.scene, &of_previous, error);
  if (!status && arguments->simplify && !arguments->options.dry_run) {
    const StyTraceOptions trace = get_trace_options(work);
    const StyRun run = {.threads = arguments->options.threads};
    status = sty_simplify_scene(work->shot.scene, &work->shot.camera, &trace, &arguments->simplify_options, &run,
                                &work->simplification, error);
  }
  if (!status) warn_of_remains(&arguments->options, &work->simplification, &arguments->simplify_options);
  work->triangles = status ? 0 : sty_count_scene_triangles(work->shot.scene);
  return status;
}

static StyStatus trace_scene(Work *work, StyError *error) {
  const GuideArguments *arguments = work->arguments;
  const StyTraceOptions trace = get_trace_options(work);
  const StyRun run = begin_progress(&arguments->options, "building");
  const StyStatus status = sty_trace_rows(work->shot.scene, &work->shot.camera, &trace, &run,
                                          &(StyRowSink){take_rows, work}, &work->trace, error);
  end_progress(&arguments->options);
  return status;
}

static void count_bytes(Work *work) {
  const StyScene *scenes[] = {work->shot.scene, work->previous.scene};
  work->read_bytes = get_peak_bytes();
  for (int s = 0; s < 2; s++)
    for (int m = 0; scenes[s] && m < scenes[s]->mesh_count; m++) {
      work->mesh_bytes += sty_get_mesh_bytes(scenes[s]->meshes[m]);
      work->read_bytes = fmax(work->read_bytes, scenes[s]->meshes[m]->import_bytes);
    }
}

static StyStatus open_previous(Work *work, const StyRun *run, StyError *error) {
  const char *file = work->arguments->previous;
  if (asprintf(&work->previous_name, "--previous %s", file) < 0) return sty_fail_memory(error, file, 0);
  return open_shot(work->arguments, file, run, &work->previous, error);
}

static StyStatus open_shots(Work *work, StyError *error) {
  const GuideArguments *arguments = work->arguments;
  const double start = sty_get_milliseconds();
  const StyRun run = begin_progress(&arguments->options, "reading");
  StyStatus status = open_shot(arguments, arguments->mesh, &run, &work->shot, error);
  if (!status && arguments->previous) status = open_previous(work, &run, error);
  end_progress(&arguments->options);
  count_bytes(work);
  work->read_ms = sty_get_milliseconds() - start;
  if (!status) status = protect_scene(work, error);
  if (!status) warn_about_seams(work);
  return status ? status : prepare_meshes(work, error);
}

static StyStatus draw_sphere(Work *work, StyError *error) {
  const GuideArguments *arguments = work->arguments;
  StyImage *guide = NULL;
  StyStatus status = sty_make_sphere_guide(arguments->width, arguments->height, arguments->groups, &guide, error);
  if (!status) status = take_rows(work, guide, error);
  sty_destroy_image(&guide);
  return status;
}

/* A camera that is fitted sees the scene, if only between its pixels; one that stands somewhere may look away. */
static void warn_of_nothing(const Work *work) {
  const StyViewpoint *viewpoint = &work->shot.viewpoint;
  const StyStand *stand = &viewpoint->stand;
  const char *output = clean_text(work->arguments->options.output);
  if (!work->arguments->mesh || viewpoint->is_fit)
    warn(&work->arguments->options,
         "%s: found that no pixel's centre shows the mesh, expected more pixels or another view", output);
  else
    warn(&work->arguments->options,
         "%s: found that no pixel's centre shows the scene, expected its camera, at (%g, %g, %g), to see it: it "
         "looks at (%g, %g, %g)",
         output, stand->position[0], stand->position[1], stand->position[2], stand->target[0], stand->target[1],
         stand->target[2]);
}

static StyStatus print_report(const Work *work, StyError *error) {
  static const char *const stages[] = {"read", "build", "first", "trace", "write", "render"};
  const GuideArguments *arguments = work->arguments;
  const double times[] = {work->read_ms,        work->trace.build_ms, work->trace.first_ms,
                          work->trace.trace_ms, work->write_ms,       work->render_ms};
  const double pixels = (double)arguments->width * arguments->height;
  const double rate = work->trace.trace_ms > 0 ? pixels / work->trace.trace_ms / 1e3 : 0; /* millions a second */
  if (!work->covered) warn_of_nothing(work);
  if (arguments->options.json) {
    json_t *report = json_pack("{s:s, s:[ii], s:I, s:I, s:o, s:f, s:f, s:f, s:f, s:f}", "schema", "stylut-guide/1",
                               "size", arguments->width, arguments->height, "covered", (json_int_t)work->covered,
                               "triangles", (json_int_t)work->triangles, "time_ms", pack_times(stages, times, 6),
                               "mpixels_per_s", rate, "mesh_bytes", work->mesh_bytes, "read_bytes", work->read_bytes,
                               "tree_bytes", work->trace.tree_bytes, "peak_bytes", get_peak_bytes());
    if (arguments->repair || arguments->simplify) json_object_set_new(report, "repair", pack_repair(&work->repair));
    if (arguments->simplify) json_object_set_new(report, "simplify", pack_simplification(&work->simplification));
    return print_json(report, error);
  }
  if (arguments->options.quiet) return STY_OK;
  printf("%s: %dx%d, %.1f %% covered\n", clean_text(arguments->options.output), arguments->width, arguments->height,
         100.0 * (double)work->covered / pixels);
  if (arguments->mesh)
    printf(
        "%zu triangles; read %.0f ms; rendered in %.0f ms: tree %.0f ms, first pixels %.0f ms, all pixels %.0f ms "
        "(%.3g million/s), writing alongside %.0f ms\n",
        work->triangles, times[0], times[5], times[1], times[2], times[3], rate, times[4]);
  if (arguments->repair || arguments->simplify) print_repair(&work->repair);
  if (arguments->simplify) print_simplification(&work->simplification, &arguments->simplify_options);
  return STY_OK;
}

/* Reading is done, so that its share is known. Then textures, if there are any, are read by the library that writes
 * later on; the tree is built; and rows are written beside it. */
static double estimate_peak(const Work *work, double held, const StyTraceEstimate *trace) {
  const double writer = sty_estimate_writer_bytes(work->arguments->width, trace->channels, trace->rows);
  const double library = trace->texture_bytes > 0 ? sty_get_image_library_bytes() : 0;
  const double opening = library + fmax(trace->decode_bytes, trace->build_bytes);
  const double tracing = trace->tree_bytes + trace->band_bytes + writer;
  return fmax(work->read_bytes, held + trace->texture_bytes + fmax(opening, tracing));
}

static StyStatus plan_scene(Work *work, StyError *error) {
  const GuideArguments *arguments = work->arguments;
  const StyTraceOptions options = get_trace_options(work);
  const double held = get_held_bytes(); /* before OpenImageIO is there, which the writer counts */
  StyTraceEstimate e;
  const StyStatus status = sty_estimate_trace(work->shot.scene, &work->shot.camera, &options, &e, error);
  if (status) return status;
  const double peak = estimate_peak(work, held, &e);
  warn_of_scene(&arguments->options, work->shot.scene);
  json_t *figures =
      json_pack("{s:I, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "triangles", (json_int_t)work->triangles,
                "camera_rays", e.camera_rays, "paths", e.paths, "most_path_rays", e.path_rays, "most_shadow_rays",
                e.shadow_rays, "mesh_bytes", work->mesh_bytes, "read_bytes", work->read_bytes, "build_bytes",
                e.build_bytes, "tree_bytes", e.tree_bytes, "texture_bytes", e.texture_bytes, "peak_bytes", peak);
  char paths[128] = "", shadows[64] = "", textures[64] = "";
  if (e.paths > 0) snprintf(paths, sizeof paths, ", %.0f light paths of at most %.0f rays", e.paths, e.path_rays);
  if (e.shadow_rays > 0) snprintf(shadows, sizeof shadows, ", at most %.0f for shadows", e.shadow_rays);
  if (e.texture_bytes > 0) snprintf(textures, sizeof textures, ", textures %.0f", e.texture_bytes / 1e6);
  return report_estimate(&work->arguments->options, figures,
                         "%dx%d pixels, %zu triangles%s; rays: %.0f from the camera%s%s; memory: about %.0f MB at its "
                         "most, of which meshes %.0f, their tree while it is built %.0f%s",
                         arguments->width, arguments->height, work->triangles,
                         arguments->simplify ? " (--simplify is left out of a dry run)" : "", e.camera_rays, paths,
                         shadows, peak / 1e6, work->mesh_bytes / 1e6, e.build_bytes / 1e6, textures);
}

static StyStatus render(Work *work, StyError *error) {
  GuideArguments *arguments = work->arguments;
  StyStatus status = arguments->mesh ? open_shots(work, error) : STY_OK;
  if (status) return status;
  if (arguments->options.dry_run)
    return arguments->mesh ? plan_scene(work, error)
                           : report_dry_run(&arguments->options, "%dx%d pixels", arguments->width, arguments->height);
  const double start = sty_get_milliseconds();
  status = arguments->mesh ? trace_scene(work, error) : draw_sphere(work, error);
  const double last = sty_get_milliseconds();
  if (!status) status = sty_close_image_writer(&work->writer, error);
  work->write_ms += sty_get_milliseconds() - last;
  work->render_ms = sty_get_milliseconds() - start;
  if (!status && arguments->mesh) warn_of_scene(&arguments->options, work->shot.scene);
  return status ? status : print_report(work, error);
}

StyStatus render_guide(GuideArguments *arguments) {
  Work work = {.arguments = arguments};
  const StyStatus status = render(&work, &arguments->options.error);
  sty_discard_image_writer(&work.writer);
  sty_destroy_scene(&work.shot.scene);
  sty_destroy_scene(&work.previous.scene);
  free(work.previous_name);
  return status;
}
