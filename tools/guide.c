/* stylut guide sphere|scene */
#include "stylut/guide.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "meshes.h"
#include "options.h"
#include "stylut/image_io.h"
#include "stylut/parse.h"
#include "stylut/scene_file.h"

typedef struct Arguments {
  Options options;
  const char *kind, *mesh;
  int width, height;
  unsigned groups;
  int bits;
  StyView view;
  StyMeshOptions mesh_options;
  bool flat;
  int frame;  /* index of frames */
  int filter; /* index of filters */
  StyPathOptions paths;
  const char *paths_only; /* an option that means nothing without light paths */
  StyContourWeights contour;
  const char *contour_only; /* an option that means nothing without the channel contour */
  const char *previous;
  bool repair, simplify;
  StySimplifyOptions simplify_options;
  bool has_max_error;
  const char *scene_only;  /* an option that means nothing for a sphere */
  const char *camera_only; /* one that means nothing where a scene file has the camera */
} Arguments;

/* The channels that textures go into. */
enum { COLOURED = STY_GUIDE_ALBEDO | STY_GUIDE_LUMA | STY_GUIDE_PATHS };

enum {
  KEY_VIEW = 0x200,
  KEY_UP,
  KEY_CAMERA,
  KEY_FOV,
  KEY_MARGIN,
  KEY_CREASE,
  KEY_FLAT,
  KEY_BITS,
  KEY_FRAME,
  KEY_FILTER,
  KEY_CONTOUR_DEPTH,
  KEY_CONTOUR_NORMAL,
  KEY_PREVIOUS,
  KEY_SPP,
  KEY_REPAIR,
  KEY_SIMPLIFY,
  KEY_MAX_ERROR
};

static const struct argp_option options_table[] = {
    {"size", 's', "WxH", 0, "pixels; one number for a square (default: 512)", 0},
    {"channels", 'c', "LIST", 0,
     "comma-separated: normal, depth, position, object, style, uv, albedo, luma, curvature, contour, motion; the light "
     "paths full, LDE (direct diffuse), LSE (direct specular), LD12E (two diffuse bounces), LIE (diffuse "
     "interreflection), together: paths; or all but motion and paths: all (default: normal,depth); A, the coverage, is "
     "always there",
     0},
    {"bits", KEY_BITS, "8|16", 0, "precision of a PNG (default: 8)", 0},
    {NULL, 0, NULL, 0, "For scenes:", 0},
    {"view", KEY_VIEW, "VIEW", 0, "front, three-quarter, or AZIMUTH,ELEVATION in degrees (default: front)", 0},
    {"up", KEY_UP, "AXIS", 0, "the mesh's axis that points up: x, y, z, -x, -y or -z (default: y)", 0},
    {"camera", KEY_CAMERA, "KIND", 0, "orthographic or perspective (default: orthographic)", 0},
    {"fov", KEY_FOV, "DEG", 0, "vertical opening of a perspective camera (default: 35)", 0},
    {"margin", KEY_MARGIN, "SHARE", 0, "empty border, share of the picture's side (default: 0.05)", 0},
    {"crease", KEY_CREASE, "DEG", 0,
     "compute normals, smooth across edges up to DEG (default: the file's own, else 60)", 0},
    {"flat", KEY_FLAT, NULL, 0, "facet normals", 0},
    {"frame", KEY_FRAME, "camera|ray", 0,
     "what normals are relative to: the camera, or each pixel's view ray, so that flat surfaces vary under perspective "
     "(default: camera)",
     0},
    {"texture-filter", KEY_FILTER, "KIND", 0, "bilinear, or nearest: the texel that holds a place (default: bilinear)",
     0},
    {"contour-depth", KEY_CONTOUR_DEPTH, "W", 0, "weight of jumps in depth in the channel contour (default: 1)", 0},
    {"contour-normal", KEY_CONTOUR_NORMAL, "W", 0, "weight of turning normals (default: 1)", 0},
    {"previous", KEY_PREVIOUS, "MESH|SCENE.json", 0,
     "the scene one frame before, with its own camera: adds the channel motion", 0},
    {"spp", KEY_SPP, "N", 0, "light paths per pixel, best a power of two; --seed makes others (default: 64)", 0},
    {"repair", KEY_REPAIR, NULL, 0,
     "take duplicate triangles out, turn neighbours the same way round before normals are computed, and say what was "
     "found, holes included",
     0},
    {"simplify", KEY_SIMPLIFY, "auto|COUNT", 0,
     "repair, then collapse edges: auto to as few triangles as leave normals within --max-error and silhouettes within "
     "half a pixel, verified by rendering both; COUNT to about so many, whatever that changes",
     0},
    {"max-error", KEY_MAX_ERROR, "DEG", 0,
     "for --simplify auto: how far normals may turn, 99th percentile over pixels (default: 1)", 0},
    {0},
};

static StyStatus set_number(Options *options, const char *what, const char *text, double minimum, double maximum,
                            double *out) {
  return sty_parse_number(what, text, minimum, maximum, out, &options->error);
}

static StyStatus set_simplify(Arguments *arguments, const char *text) {
  double count = 0;
  StyStatus status = STY_OK;
  if (strcmp(text, "auto") != 0) status = set_number(&arguments->options, "--simplify", text, 1, 1e9, &count);
  if (status || count != floor(count))
    return sty_fail(&arguments->options.error, STY_ERROR_USAGE,
                    "--simplify: found '%s', expected auto or a number of triangles", text);
  arguments->scene_only = "--simplify";
  arguments->simplify = true;
  arguments->simplify_options.triangles = (size_t)count;
  return STY_OK;
}

static StyStatus set_option(Arguments *arguments, int key, const char *text) {
  static const char *const cameras[] = {"orthographic", "perspective", NULL};
  static const char *const depths[] = {"8", "16", NULL}, *const frames[] = {"camera", "ray", NULL},
                           *const filters[] = {"bilinear", "nearest", NULL};
  Options *options = &arguments->options;
  int choice = 0;
  long long samples = 0;
  StyStatus status;
  switch (key) {
    case 's':
      return sty_parse_size("--size", text, STY_MAX_SIDE, &arguments->width, &arguments->height, &options->error);
    case 'c': return sty_parse_channels("--channels", text, &arguments->groups, &options->error);
    case KEY_BITS:
      status = sty_parse_choice("--bits", text, depths, &choice, &options->error);
      arguments->bits = choice ? 16 : 8;
      return status;
    case KEY_VIEW:
      arguments->scene_only = arguments->camera_only = "--view";
      return sty_parse_view("--view", text, &arguments->view, &options->error);
    case KEY_UP:
      arguments->scene_only = arguments->camera_only = "--up";
      status = sty_parse_choice("--up", text, sty_up_axis_names, &choice, &options->error);
      arguments->view.up = (StyUpAxis)choice;
      return status;
    case KEY_CAMERA:
      arguments->scene_only = arguments->camera_only = "--camera";
      status = sty_parse_choice("--camera", text, cameras, &choice, &options->error);
      arguments->view.perspective = choice == 1;
      return status;
    case KEY_FOV:
      arguments->scene_only = arguments->camera_only = "--fov";
      return set_number(options, "--fov", text, 1, 170, &arguments->view.fov);
    case KEY_MARGIN:
      arguments->scene_only = arguments->camera_only = "--margin";
      return set_number(options, "--margin", text, 0, 0.45, &arguments->view.margin);
    case KEY_CREASE:
      arguments->scene_only = "--crease";
      return set_number(options, "--crease", text, 0, 180, &arguments->mesh_options.crease_angle);
    case KEY_FRAME:
      arguments->scene_only = "--frame";
      return sty_parse_choice("--frame", text, frames, &arguments->frame, &options->error);
    case KEY_FILTER:
      arguments->scene_only = "--texture-filter";
      return sty_parse_choice("--texture-filter", text, filters, &arguments->filter, &options->error);
    case KEY_CONTOUR_DEPTH:
      arguments->scene_only = arguments->contour_only = "--contour-depth";
      return set_number(options, "--contour-depth", text, 0, 1000, &arguments->contour.depth);
    case KEY_CONTOUR_NORMAL:
      arguments->scene_only = arguments->contour_only = "--contour-normal";
      return set_number(options, "--contour-normal", text, 0, 1000, &arguments->contour.normal);
    case KEY_PREVIOUS:
      arguments->scene_only = "--previous";
      arguments->previous = text;
      return STY_OK;
    case KEY_SPP:
      arguments->scene_only = arguments->paths_only = "--spp";
      status = sty_parse_integer("--spp", text, 1, STY_MOST_SAMPLES, &samples, &options->error);
      arguments->paths.samples = (int)samples;
      return status;
    case KEY_REPAIR:
      arguments->scene_only = "--repair";
      arguments->repair = true;
      return STY_OK;
    case KEY_SIMPLIFY: return set_simplify(arguments, text);
    case KEY_MAX_ERROR:
      arguments->scene_only = "--max-error";
      arguments->has_max_error = true;
      return set_number(options, "--max-error", text, 0, 180, &arguments->simplify_options.max_error);
    default:
      arguments->scene_only = "--flat";
      arguments->flat = true;
      return STY_OK;
  }
}

static StyStatus check_output(Arguments *arguments) {
  StyImageFormat format = STY_IMAGE_EXR;
  StyStatus status = require_output(&arguments->options);
  const char *const inputs[] = {arguments->mesh, arguments->previous};
  if (!status) status = protect_inputs(&arguments->options, arguments->options.output, inputs, 2);
  if (!status) status = sty_get_image_format(arguments->options.output, &format, &arguments->options.error);
  if (!status && format == STY_IMAGE_PNG && !(arguments->groups & STY_GUIDE_NORMAL))
    status = sty_fail(&arguments->options.error, STY_ERROR_USAGE,
                      "option '--channels': found no normal, expected it for %s, which holds normals only",
                      arguments->options.output);
  return status;
}

/* Options that only some channels heed, and a channel that needs an option. */
static StyStatus check_channels(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  if (arguments->previous) arguments->groups |= STY_GUIDE_MOTION;
  if (arguments->groups & STY_GUIDE_MOTION && !arguments->previous)
    return sty_fail(error, STY_ERROR_USAGE, "--channels: found motion without --previous, expected the scene before");
  if (arguments->contour_only && !(arguments->groups & STY_GUIDE_CONTOUR))
    return sty_fail(error, STY_ERROR_USAGE, "%s: found without the channel contour, expected it in --channels",
                    arguments->contour_only);
  if (arguments->paths_only && !(arguments->groups & STY_GUIDE_PATHS))
    return sty_fail(error, STY_ERROR_USAGE,
                    "%s: found without the channels full, LDE, LSE, LD12E and LIE, expected one in --channels",
                    arguments->paths_only);
  if (arguments->filter && !(arguments->groups & COLOURED))
    return sty_fail(error, STY_ERROR_USAGE,
                    "--texture-filter: found without the channels albedo, luma and paths, expected one in --channels");
  return STY_OK;
}

static StyStatus check_simplify(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  if (arguments->has_max_error && (!arguments->simplify || arguments->simplify_options.triangles))
    return sty_fail(error, STY_ERROR_USAGE, "--max-error: found without --simplify auto, expected it with that only");
  if (arguments->simplify && arguments->previous)
    return sty_fail(error, STY_ERROR_USAGE,
                    "--simplify: found with --previous, expected one of them: motion needs the same triangles in both");
  return STY_OK;
}

static StyStatus check_arguments(Arguments *arguments) {
  static const char *const kinds[] = {"sphere", "scene", "strokes", "warp", NULL};
  StyError *error = &arguments->options.error;
  int kind;
  const char *given = arguments->kind ? arguments->kind : "";
  const StyStatus status = sty_parse_choice("guide", given, kinds, &kind, error);
  if (status) return status;
  if (kind > 1)
    return sty_fail(error, STY_ERROR_USAGE, "guide %s: found behind options, expected 'stylut guide %s' and then those",
                    given, given);
  if (kind == 1 && !arguments->mesh)
    return sty_fail(error, STY_ERROR_USAGE, "guide scene: found no mesh, expected a file name");
  if (kind == 0 && arguments->mesh)
    return sty_fail(error, STY_ERROR_USAGE, "guide sphere: found '%s', expected nothing more", arguments->mesh);
  if (kind == 1 && arguments->camera_only && sty_is_scene_file(arguments->mesh))
    return sty_fail(error, STY_ERROR_USAGE,
                    "option '%s': found with %s, expected it with a mesh: scene files have a camera",
                    arguments->camera_only, arguments->mesh);
  if (kind == 0 && arguments->scene_only)
    return sty_fail(error, STY_ERROR_USAGE, "option '%s': found with 'guide sphere', expected with 'guide scene' only",
                    arguments->scene_only);
  if (arguments->view.fov > 0 && !arguments->view.perspective)
    return sty_fail(error, STY_ERROR_USAGE, "--fov: found with an orthographic camera, expected --camera perspective");
  if (!(arguments->view.fov > 0)) arguments->view.fov = sty_default_view.fov;
  if (arguments->flat && arguments->mesh_options.crease_angle >= 0)
    return sty_fail(error, STY_ERROR_USAGE, "--flat: found with --crease, expected one of them");
  if ((long long)arguments->width * arguments->height > STY_MAX_PIXELS)
    return sty_fail(error, STY_ERROR_USAGE, "--size: found %dx%d, expected at most %lld pixels", arguments->width,
                    arguments->height, STY_MAX_PIXELS);
  StyStatus checked = check_channels(arguments);
  if (!checked) checked = check_simplify(arguments);
  return checked ? checked : check_output(arguments);
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG:
      return end_option(
          take_argument(&arguments->options, arguments->kind ? &arguments->mesh : &arguments->kind, text));
    case ARGP_KEY_END: return end_option(check_arguments(arguments));
    case 's':
    case 'c':
    case KEY_BITS:
    case KEY_VIEW:
    case KEY_UP:
    case KEY_CAMERA:
    case KEY_FOV:
    case KEY_MARGIN:
    case KEY_CREASE:
    case KEY_FRAME:
    case KEY_FILTER:
    case KEY_CONTOUR_DEPTH:
    case KEY_CONTOUR_NORMAL:
    case KEY_PREVIOUS:
    case KEY_SPP:
    case KEY_REPAIR:
    case KEY_SIMPLIFY:
    case KEY_MAX_ERROR:
    case KEY_FLAT: return end_option(set_option(arguments, key, text));
    default: return ARGP_ERR_UNKNOWN;
  }
}

static const struct argp_child children[] = {
    {&output_argp, 0, NULL, 0}, {&seed_argp, 0, NULL, 0}, {&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .options = options_table,
    .parser = parse_option,
    .args_doc = "sphere\nscene MESH|SCENE.json\nimport FILE\nstrokes IMAGE\nwarp PAIRS.json\nflow A B",
    .doc =
        "Renders a guide map: what a picture's surfaces are, pixel by pixel.\v"
        "'sphere' is analytic and fills the picture. 'scene' traces a mesh (OBJ, PLY, STL, glTF, OFF) with a camera "
        "fitted to it, or a scene file (.json), which has cameras, meshes, spheres and styles of its own. FILE.exr "
        "holds float channels by name; FILE.png holds n/2+1/2 and the coverage as alpha.\n\n"
        "'import' turns another program's file into a guide, 'strokes' measures a picture at several scales, 'warp' "
        "bends "
        "one by pairs of points, 'flow' finds the motion between two; they have options of their own: 'stylut guide "
        "import --help' and so on.",
    .children = children,
};

/* A scene, and from where it is seen. */
typedef struct Shot {
  StyScene *scene;
  StyCamera camera;
} Shot;

/* A scene file, or a mesh that stands alone. */
static StyStatus read_scene(const Arguments *arguments, const char *path, StyScene **scene, StyViewpoint *viewpoint,
                            StyError *error) {
  if (sty_is_scene_file(path)) return sty_read_scene(path, &arguments->mesh_options, scene, viewpoint, error);
  StyMesh *mesh = NULL;
  *viewpoint = (StyViewpoint){.is_fit = true, .view = arguments->view};
  const StyStatus status = sty_read_mesh(path, &arguments->mesh_options, &mesh, error);
  return status ? status : sty_wrap_mesh(&mesh, scene, error);
}

static StyStatus open_shot(const Arguments *arguments, const char *path, Shot *out, StyError *error) {
  StyViewpoint viewpoint;
  Shot shot = {0};
  StyStatus status = read_scene(arguments, path, &shot.scene, &viewpoint, error);
  if (!status)
    status = sty_set_camera(shot.scene, &viewpoint, arguments->width, arguments->height, &shot.camera, error);
  if (status)
    sty_destroy_scene(&shot.scene);
  else
    *out = shot;
  return status;
}

/* The guide on its way into the file, and what was done, for the report. */
typedef struct Work {
  Arguments *arguments;
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
  const Arguments *arguments = work->arguments;
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
  const Arguments *arguments = work->arguments;
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
  const Arguments *arguments = work->arguments;
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
  const Arguments *arguments = work->arguments;
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
  const Arguments *arguments = work->arguments;
  const StyTraceOptions trace = get_trace_options(work);
  const StyRun run = begin_progress(&arguments->options, "tracing");
  const StyStatus status = sty_trace_rows(work->shot.scene, &work->shot.camera, &trace, &run,
                                          &(StyRowSink){take_rows, work}, &work->trace, error);
  end_progress(&arguments->options);
  return status;
}

static StyStatus open_shots(Work *work, StyError *error) {
  const Arguments *arguments = work->arguments;
  const double start = sty_get_milliseconds();
  StyStatus status = open_shot(arguments, arguments->mesh, &work->shot, error);
  if (!status && arguments->previous) status = open_shot(arguments, arguments->previous, &work->previous, error);
  work->read_ms = sty_get_milliseconds() - start;
  return status ? status : prepare_meshes(work, error);
}

static StyStatus draw_sphere(Work *work, StyError *error) {
  const Arguments *arguments = work->arguments;
  StyImage *guide = NULL;
  StyStatus status = sty_make_sphere_guide(arguments->width, arguments->height, arguments->groups, &guide, error);
  if (!status) status = take_rows(work, guide, error);
  sty_destroy_image(&guide);
  return status;
}

static StyStatus print_report(const Work *work, StyError *error) {
  static const char *const stages[] = {"read", "build", "first", "trace", "write"};
  const Arguments *arguments = work->arguments;
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
  Arguments *arguments = work->arguments;
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

static StyStatus run(Arguments *arguments) {
  Work work = {.arguments = arguments};
  const StyStatus status = render(&work, &arguments->options.error);
  sty_discard_image_writer(&work.writer);
  sty_destroy_scene(&work.shot.scene);
  sty_destroy_scene(&work.previous.scene);
  return status;
}

/* Kinds that have a command line of their own. */
static const struct {
  const char *name;
  StyStatus (*run)(int argc, char **argv);
} kinds[] = {
    {"import", run_guide_import},
    {"strokes", run_guide_strokes},
    {"warp", run_guide_warp},
    {"flow", run_guide_flow},
};

StyStatus run_guide(int argc, char **argv) {
  for (size_t k = 0; argc > 1 && k < sizeof kinds / sizeof *kinds; k++) {
    static char program[32];
    if (strcmp(argv[1], kinds[k].name) != 0) continue;
    snprintf(program, sizeof program, "stylut guide %s", kinds[k].name);
    argv[1] = program;
    return kinds[k].run(argc - 1, argv + 1);
  }
  Arguments arguments = {
      .width = 512,
      .height = 512,
      .groups = STY_GUIDE_NORMAL | STY_GUIDE_DEPTH,
      .bits = 8,
      .view = {.margin = sty_default_view.margin},
      .mesh_options = {.crease_angle = -1},
      .contour = sty_default_contour,
      .paths = sty_default_paths,
      .simplify_options = {.max_error = 1, .silhouette = 0.5},
  };
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments);
  return finish_command(&arguments.options, status);
}
