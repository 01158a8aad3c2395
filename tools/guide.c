/* stylut guide sphere|scene */
#include "stylut/guide.h"

#include <stdio.h>
#include <string.h>

#include "commands.h"
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
  int frame;               /* index of frames */
  const char *scene_only;  /* an option that means nothing for a sphere */
  const char *camera_only; /* one that means nothing where a scene file has the camera */
} Arguments;

enum { KEY_VIEW = 0x200, KEY_UP, KEY_CAMERA, KEY_FOV, KEY_MARGIN, KEY_CREASE, KEY_FLAT, KEY_BITS, KEY_FRAME };

static const struct argp_option options_table[] = {
    {"size", 's', "WxH", 0, "pixels; one number for a square (default: 512)", 0},
    {"channels", 'c', "LIST", 0,
     "comma-separated: normal, depth, position, object, style, albedo, luma, or all (default: normal,depth); A, the "
     "coverage, is "
     "always "
     "there",
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
    {0},
};

static StyStatus set_number(Options *options, const char *what, const char *text, double minimum, double maximum,
                            double *out) {
  return sty_parse_number(what, text, minimum, maximum, out, &options->error);
}

static StyStatus set_option(Arguments *arguments, int key, const char *text) {
  static const char *const cameras[] = {"orthographic", "perspective", NULL};
  static const char *const depths[] = {"8", "16", NULL}, *const frames[] = {"camera", "ray", NULL};
  Options *options = &arguments->options;
  int choice = 0;
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
    default:
      arguments->scene_only = "--flat";
      arguments->flat = true;
      return STY_OK;
  }
}

static StyStatus check_output(Arguments *arguments) {
  StyImageFormat format = STY_IMAGE_EXR;
  StyStatus status = require_output(&arguments->options);
  if (!status) status = protect_inputs(&arguments->options, arguments->options.output, &arguments->mesh, 1);
  if (!status) status = sty_get_image_format(arguments->options.output, &format, &arguments->options.error);
  if (!status && format == STY_IMAGE_PNG && !(arguments->groups & STY_GUIDE_NORMAL))
    status = sty_fail(&arguments->options.error, STY_ERROR_USAGE,
                      "option '--channels': found no normal, expected it for %s, which holds normals only",
                      arguments->options.output);
  return status;
}

static StyStatus check_arguments(Arguments *arguments) {
  static const char *const kinds[] = {"sphere", "scene", NULL};
  StyError *error = &arguments->options.error;
  int kind;
  const char *given = arguments->kind ? arguments->kind : "";
  const StyStatus status = sty_parse_choice("guide", given, kinds, &kind, error);
  if (status) return status;
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
  return check_output(arguments);
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
    case KEY_FLAT: return end_option(set_option(arguments, key, text));
    default: return ARGP_ERR_UNKNOWN;
  }
}

static const struct argp_child children[] = {{&output_argp, 0, NULL, 0}, {&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .options = options_table,
    .parser = parse_option,
    .args_doc = "sphere\nscene MESH|SCENE.json\nflow A B",
    .doc =
        "Renders a guide map: what a picture's surfaces are, pixel by pixel.\v"
        "'sphere' is analytic and fills the picture. 'scene' traces a mesh (OBJ, PLY, STL, glTF, OFF) with a camera "
        "fitted to it, or a scene file (.json), which has cameras, meshes, spheres and styles of its own. FILE.exr "
        "holds float channels by name; FILE.png holds n/2+1/2 and the coverage as alpha. 'flow' finds the motion "
        "from picture A to picture B; it has options of its own: 'stylut guide flow --help'.",
    .children = children,
};

/* What was done, for the report. */
typedef struct Account {
  size_t triangles, covered;
  double read_ms, write_ms;
  StyTraceTimes trace;
} Account;

/* A scene file, or a mesh that stands alone. */
static StyStatus read_scene(const Arguments *arguments, StyScene **scene, StyViewpoint *viewpoint, StyError *error) {
  if (sty_is_scene_file(arguments->mesh))
    return sty_read_scene(arguments->mesh, &arguments->mesh_options, scene, viewpoint, error);
  StyMesh *mesh = NULL;
  *viewpoint = (StyViewpoint){.is_fit = true, .view = arguments->view};
  const StyStatus status = sty_read_mesh(arguments->mesh, &arguments->mesh_options, &mesh, error);
  return status ? status : sty_wrap_mesh(&mesh, scene, error);
}

static StyStatus render(Arguments *arguments, Account *account, StyImage **out) {
  StyError *error = &arguments->options.error;
  if (!arguments->mesh)
    return sty_make_sphere_guide(arguments->width, arguments->height, arguments->groups, out, error);
  StyScene *scene = NULL;
  StyViewpoint viewpoint;
  StyCamera camera;
  const double start = sty_get_milliseconds();
  StyStatus status = read_scene(arguments, &scene, &viewpoint, error);
  account->read_ms = sty_get_milliseconds() - start;
  if (!status) status = sty_set_camera(scene, &viewpoint, arguments->width, arguments->height, &camera, error);
  if (!status) {
    const StyTraceOptions trace = {arguments->width, arguments->height, arguments->groups, arguments->flat,
                                   arguments->frame == 1};
    account->triangles = sty_count_scene_triangles(scene);
    const StyRun run = begin_progress(&arguments->options, "tracing");
    if (!arguments->options.dry_run)
      status = sty_trace_guide(scene, &camera, &trace, &run, &account->trace, out, error);
    end_progress(&arguments->options);
  }
  sty_destroy_scene(&scene);
  return status;
}

static StyStatus write_guide(Arguments *arguments, StyImage *guide) {
  Options *options = &arguments->options;
  StyImageFormat format = STY_IMAGE_EXR;
  StyStatus status = sty_get_image_format(options->output, &format, &options->error);
  const bool png = format == STY_IMAGE_PNG;
  StyImage *encoded = NULL;
  if (!status && png) status = sty_encode_normals(guide, arguments->bits, &encoded, &options->error);
  StyImage *image = png ? encoded : guide;
  if (!status)
    status = add_history(options, "guide", image, &arguments->mesh, arguments->mesh ? 1 : 0, &options->error);
  if (!status) status = sty_write_image(options->output, image, &options->error);
  sty_destroy_image(&encoded);
  return status;
}

static StyStatus print_report(const Arguments *arguments, const Account *account, StyError *error) {
  static const char *const stages[] = {"read", "build", "trace", "write"};
  const double times[] = {account->read_ms, account->trace.build_ms, account->trace.trace_ms, account->write_ms};
  const double pixels = (double)arguments->width * arguments->height;
  const double rate = account->trace.trace_ms > 0 ? pixels / account->trace.trace_ms / 1e3 : 0;
  if (!account->covered)
    warn(&arguments->options, "%s: found that no pixel's centre shows the mesh, expected more pixels or another view",
         clean_text(arguments->options.output));
  if (arguments->options.json)
    return print_json(json_pack("{s:s, s:[ii], s:I, s:I, s:o, s:f, s:f}", "schema", "stylut-guide/1", "size",
                                arguments->width, arguments->height, "covered", (json_int_t)account->covered,
                                "triangles", (json_int_t)account->triangles, "time_ms", pack_times(stages, times, 4),
                                "mrays_per_s", rate, "peak_bytes", get_peak_bytes()),
                      error);
  if (arguments->options.quiet) return STY_OK;
  printf("%s: %dx%d, %.1f %% covered\n", clean_text(arguments->options.output), arguments->width, arguments->height,
         100.0 * (double)account->covered / pixels);
  if (arguments->mesh)
    printf("%zu triangles; read %.0f ms, build %.0f ms, trace %.0f ms (%.1f million rays/s), write %.0f ms\n",
           account->triangles, times[0], times[1], times[2], rate, times[3]);
  return STY_OK;
}

static StyStatus run(Arguments *arguments) {
  Account account = {0};
  StyImage *guide = NULL;
  StyStatus status = render(arguments, &account, &guide);
  if (!status && arguments->options.dry_run) {
    sty_destroy_image(&guide);
    return report_dry_run(&arguments->options, "%dx%d pixels, %zu triangles", arguments->width, arguments->height,
                          account.triangles);
  }
  if (!status) {
    const float *covered = sty_find_channel(guide, "A");
    for (size_t i = 0; i < sty_count_pixels(guide); i++) account.covered += covered[i] > 0;
    const double start = sty_get_milliseconds();
    status = write_guide(arguments, guide);
    account.write_ms = sty_get_milliseconds() - start;
  }
  sty_destroy_image(&guide);
  if (!status) status = print_report(arguments, &account, &arguments->options.error);
  return status;
}

/* Kinds that have a parser and a file of their own. */
typedef struct Kind {
  const char *name;
  StyStatus (*run)(int argc, char **argv);
} Kind;

static const Kind own_kinds[] = {
    {"flow", run_guide_flow},
};

StyStatus run_guide(int argc, char **argv) {
  for (size_t k = 0; argc > 1 && k < sizeof own_kinds / sizeof *own_kinds; k++) {
    if (strcmp(argv[1], own_kinds[k].name) != 0) continue;
    static char program[64];
    snprintf(program, sizeof program, "stylut guide %s", own_kinds[k].name);
    argv[1] = program;
    return own_kinds[k].run(argc - 1, argv + 1);
  }
  Arguments arguments = {
      .width = 512,
      .height = 512,
      .groups = STY_GUIDE_NORMAL | STY_GUIDE_DEPTH,
      .bits = 8,
      .view = {.margin = sty_default_view.margin},
      .mesh_options = {.crease_angle = -1},
  };
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments);
  return finish_command(&arguments.options, status);
}
