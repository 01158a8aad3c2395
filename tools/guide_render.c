/* From a scene to the guide's file. */
#include "guide_render.h"

#include <stdio.h>
#include <stdlib.h>

#include "meshes.h"
#include "stylut/image_io.h"
#include "stylut/scene_file.h"

/* A scene, and from where it is seen. */
typedef struct Shot {
  StyScene *scene;
  StyCamera camera;
} Shot;

/* A scene file, or a mesh that stands alone. */
static StyStatus read_scene(const GuideArguments *arguments, const char *path, StyScene **scene,
                            StyViewpoint *viewpoint, StyError *error) {
  if (sty_is_scene_file(path)) return sty_read_scene(path, &arguments->mesh_options, scene, viewpoint, error);
  StyMesh *mesh = NULL;
  *viewpoint = (StyViewpoint){.is_fit = true, .view = arguments->view};
  const StyStatus status = sty_read_mesh(path, &arguments->mesh_options, &mesh, error);
  return status ? status : sty_wrap_mesh(&mesh, scene, error);
}

static StyStatus open_shot(const GuideArguments *arguments, const char *path, Shot *out, StyError *error) {
  StyViewpoint viewpoint;
  Shot shot = {0};
  StyStatus status = read_scene(arguments, path, &shot.scene, &viewpoint, error);
  if (!status) {
    status = sty_set_camera(shot.scene, &viewpoint, arguments->width, arguments->height, &shot.camera, error);
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
  StyImageWriter *writer; /* from the first rows on */
  size_t triangles, covered;
  double read_ms, write_ms;
  StyTraceTimes trace;
  StyRepair repair;
  StySimplification simplification;
} Work;

/* Every file that the picture comes from: the scenes, and what they name. */
static StyStatus list_inputs(const Work *work, const char ***out, int *count, StyError *error) {
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
  const bool coloured = arguments->groups & COLOURED;
  for (int t = 0; coloured && work->shot.scene && t < work->shot.scene->texture_count; t++)
    inputs[(*count)++] = work->shot.scene->textures[t];
  *out = inputs;
  return STY_OK;
}

static StyStatus open_writer(Work *work, StyImage *like, StyError *error) {
  Options *options = &work->arguments->options;
  const char **inputs = NULL;
  int count = 0;
  StyStatus status = list_inputs(work, &inputs, &count, error);
  if (!status) status = add_history(options, "guide", like, inputs, count, error);
  free(inputs);
  return status ? status : sty_open_image_writer(options->output, like, work->arguments->height, &work->writer, error);
}

/* The next rows of the guide, from the top: as they are, or as a picture of normals. */
static StyStatus take_rows(void *context, StyImage *rows, StyError *error) {
  Work *work = context;
  const GuideArguments *arguments = work->arguments;
  const double start = sty_get_milliseconds();
  const float *covered = sty_find_channel(rows, "A");
  for (size_t i = 0; i < sty_count_pixels(rows); i++) work->covered += covered[i] > 0;
  StyImageFormat format = STY_IMAGE_EXR;
  StyImage *encoded = NULL;
  StyStatus status = sty_get_image_format(arguments->options.output, &format, error);
  if (!status && format == STY_IMAGE_PNG) status = sty_encode_normals(rows, arguments->bits, &encoded, error);
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
                           .paths = {arguments->paths.samples, arguments->options.seed}};
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
  work->triangles = status ? 0 : sty_count_scene_triangles(work->shot.scene);
  return status;
}

static StyStatus trace_scene(Work *work, StyError *error) {
  const GuideArguments *arguments = work->arguments;
  const StyTraceOptions trace = get_trace_options(work);
  const StyRun run = begin_progress(&arguments->options, "tracing");
  const StyStatus status = sty_trace_rows(work->shot.scene, &work->shot.camera, &trace, &run,
                                          &(StyRowSink){take_rows, work}, &work->trace, error);
  end_progress(&arguments->options);
  return status;
}

static StyStatus open_shots(Work *work, StyError *error) {
  const GuideArguments *arguments = work->arguments;
  const double start = sty_get_milliseconds();
  StyStatus status = open_shot(arguments, arguments->mesh, &work->shot, error);
  if (!status && arguments->previous) status = open_shot(arguments, arguments->previous, &work->previous, error);
  work->read_ms = sty_get_milliseconds() - start;
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

static StyStatus print_report(const Work *work, StyError *error) {
  static const char *const stages[] = {"read", "build", "first", "trace", "write"};
  const GuideArguments *arguments = work->arguments;
  const double times[] = {work->read_ms, work->trace.build_ms, work->trace.first_ms, work->trace.trace_ms,
                          work->write_ms};
  const double pixels = (double)arguments->width * arguments->height;
  const double rate = work->trace.trace_ms > 0 ? pixels / work->trace.trace_ms / 1e3 : 0;
  if (!work->covered)
    warn(&arguments->options, "%s: found that no pixel's centre shows the mesh, expected more pixels or another view",
         clean_text(arguments->options.output));
  if (arguments->options.json) {
    json_t *report =
        json_pack("{s:s, s:[ii], s:I, s:I, s:o, s:f, s:f}", "schema", "stylut-guide/1", "size", arguments->width,
                  arguments->height, "covered", (json_int_t)work->covered, "triangles", (json_int_t)work->triangles,
                  "time_ms", pack_times(stages, times, 5), "mrays_per_s", rate, "peak_bytes", get_peak_bytes());
    if (arguments->repair || arguments->simplify) json_object_set_new(report, "repair", pack_repair(&work->repair));
    if (arguments->simplify) json_object_set_new(report, "simplify", pack_simplification(&work->simplification));
    return print_json(report, error);
  }
  if (arguments->options.quiet) return STY_OK;
  printf("%s: %dx%d, %.1f %% covered\n", clean_text(arguments->options.output), arguments->width, arguments->height,
         100.0 * (double)work->covered / pixels);
  if (arguments->mesh)
    printf(
        "%zu triangles; read %.0f ms, tree %.0f ms, first pixels %.0f ms, all %.0f ms (%.1f million rays/s), of which "
        "writing, alongside, took %.0f ms\n",
        work->triangles, times[0], times[1], times[2], times[3], rate, times[4]);
  if (arguments->repair || arguments->simplify) print_repair(&work->repair);
  if (arguments->simplify) print_simplification(&work->simplification, &arguments->simplify_options);
  return STY_OK;
}

static StyStatus render(Work *work, StyError *error) {
  GuideArguments *arguments = work->arguments;
  StyStatus status = arguments->mesh ? open_shots(work, error) : STY_OK;
  if (status) return status;
  if (arguments->options.dry_run)
    return report_dry_run(&arguments->options, "%dx%d pixels, %zu triangles", arguments->width, arguments->height,
                          work->triangles);
  status = arguments->mesh ? trace_scene(work, error) : draw_sphere(work, error);
  const double start = sty_get_milliseconds();
  if (!status) status = sty_close_image_writer(&work->writer, error);
  work->write_ms += sty_get_milliseconds() - start;
  return status ? status : print_report(work, error);
}

StyStatus render_guide(GuideArguments *arguments) {
  Work work = {.arguments = arguments};
  const StyStatus status = render(&work, &arguments->options.error);
  sty_discard_image_writer(&work.writer);
  sty_destroy_scene(&work.shot.scene);
  sty_destroy_scene(&work.previous.scene);
  return status;
}
