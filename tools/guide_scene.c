/* stylut guide scene MESH|SCENE.json */
#include <math.h>
#include <string.h>

#include "commands.h"
#include "guide_render.h"
#include "stylut/parse.h"
#include "stylut/scene_file.h"

enum {
  KEY_VIEW = 0x200,
  KEY_UP,
  KEY_CAMERA,
  KEY_FOV,
  KEY_MARGIN,
  KEY_CREASE,
  KEY_FLAT,
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
    {NULL, 0, NULL, 0, "Scenes:", 0},
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

static const char *const cameras[] = {"orthographic", "perspective", NULL};
static const char *const frames[] = {"camera", "ray", NULL};
static const char *const filters[] = {"bilinear", "nearest", NULL};

static StyStatus set_simplify(GuideArguments *arguments, const char *text) {
  StyError *error = &arguments->options.error;
  double count = 0;
  StyStatus status = STY_OK;
  if (strcmp(text, "auto") != 0) status = sty_parse_number("--simplify", text, 1, 1e9, &count, error);
  if (status || count != floor(count))
    return sty_fail(error, STY_ERROR_USAGE, "--simplify: found '%s', expected auto or a number of triangles", text);
  arguments->simplify = true;
  arguments->simplify_options.triangles = (size_t)count;
  return STY_OK;
}

static StyStatus set_samples(GuideArguments *arguments, const char *text) {
  long long samples = 0;
  const StyStatus status = sty_parse_integer("--spp", text, 1, STY_MOST_SAMPLES, &samples, &arguments->options.error);
  arguments->paths.samples = (int)samples;
  return status;
}

/* ---- options that don't go together ---- */

/* A scene file has a camera of its own, which isn't known yet. */
static StyStatus check_camera(GuideArguments *arguments) {
  static const char *const mesh = "a mesh: scene files have a camera", *const perspective = "--camera perspective";
  const bool is_mesh = !sty_is_scene_file(arguments->mesh), is_perspective = arguments->camera == 1;
  const OptionNeed needs[] = {
      {"fov", is_mesh, mesh},
      {"view", is_mesh, mesh},
      {"up", is_mesh, mesh},
      {"camera", is_mesh, mesh},
      {"margin", is_mesh, mesh},
      {"fov", is_perspective, perspective},
      {"frame", is_perspective || !is_mesh, perspective},
  };
  arguments->view.perspective = is_perspective;
  arguments->view.up = (StyUpAxis)arguments->up;
  return check_needs(&arguments->options, needs, sizeof needs / sizeof *needs);
}

/* Simplifying looks at normals, whatever the picture shows. */
static StyStatus check_channels(GuideArguments *arguments) {
  static const char *const paths = "a channel of light paths: full, LDE, LSE, LD12E, LIE, or paths";
  static const char *const normals = "the channel normal or contour";
  if (arguments->previous) arguments->groups |= STY_GUIDE_MOTION;
  const unsigned groups = arguments->groups;
  const bool simplify = arguments->simplify, has_normals = simplify || groups & (STY_GUIDE_NORMAL | STY_GUIDE_CONTOUR);
  const OptionNeed needs[] = {
      {"previous", arguments->format == STY_IMAGE_EXR, "an output that ends in .exr"},
      {"frame", has_normals, normals},
      {"flat", has_normals, normals},
      {"crease", has_normals || groups & (STY_GUIDE_CURVATURE | STY_GUIDE_LIT),
       "the channel normal, contour, curvature or luma, or one of light paths"},
      {"contour-depth", groups & STY_GUIDE_CONTOUR, "the channel contour"},
      {"contour-normal", groups & STY_GUIDE_CONTOUR, "the channel contour"},
      {"texture-filter", groups & STY_GUIDE_COLOURED, "the channel albedo or luma, or one of light paths"},
      {"spp", groups & STY_GUIDE_PATHS, paths},
      {"seed", groups & STY_GUIDE_PATHS, paths},
      {"max-error", simplify && !arguments->simplify_options.triangles, "--simplify auto"},
  };
  return check_needs(&arguments->options, needs, sizeof needs / sizeof *needs);
}

static StyStatus check_arguments(GuideArguments *arguments) {
  StyError *error = &arguments->options.error;
  StyStatus status = require_argument(&arguments->options, arguments->mesh, "a mesh or a scene file");
  if (!status) status = check_camera(arguments);
  if (!status) status = check_picture(arguments);
  if (!status) status = check_channels(arguments);
  if (status) return status;
  if (arguments->groups & STY_GUIDE_MOTION && !arguments->previous)
    return sty_fail(error, STY_ERROR_USAGE, "--channels: found motion without --previous, expected the scene before");
  if (arguments->flat && arguments->crease_angle >= 0)
    return sty_fail(error, STY_ERROR_USAGE, "--flat: found with --crease, expected one of them");
  if (arguments->simplify && arguments->previous)
    return sty_fail(error, STY_ERROR_USAGE,
                    "--simplify: found with --previous, expected one of them: motion needs the same triangles in both");
  return arguments->simplify
             ? sty_check_simplify(arguments->width, arguments->height, &arguments->simplify_options, error)
             : STY_OK;
}

/* ---- parsing ---- */

/* Options that are a number or a word. */
static error_t set_value(GuideArguments *arguments, int key, const char *text) {
  const NumberOption numbers[] = {
      {KEY_FOV, "--fov", 1, 170, &arguments->view.fov},
      {KEY_MARGIN, "--margin", 0, 0.45, &arguments->view.margin},
      {KEY_CREASE, "--crease", 0, 180, &arguments->crease_angle},
      {KEY_CONTOUR_DEPTH, "--contour-depth", 0, 1000, &arguments->contour.depth},
      {KEY_CONTOUR_NORMAL, "--contour-normal", 0, 1000, &arguments->contour.normal},
      {KEY_MAX_ERROR, "--max-error", 0, 180, &arguments->simplify_options.max_error},
  };
  const ChoiceOption choices[] = {
      {KEY_CAMERA, "--camera", cameras, &arguments->camera},
      {KEY_UP, "--up", sty_up_axis_names, &arguments->up},
      {KEY_FRAME, "--frame", frames, &arguments->frame},
      {KEY_FILTER, "--texture-filter", filters, &arguments->filter},
  };
  Options *options = &arguments->options;
  const error_t done = parse_number_option(options, numbers, sizeof numbers / sizeof *numbers, key, text);
  if (done != ARGP_ERR_UNKNOWN) return done;
  return parse_choice_option(options, choices, sizeof choices / sizeof *choices, key, text);
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  GuideArguments *arguments = state->input;
  Options *options = &arguments->options;
  StyStatus status = STY_OK;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: status = take_argument(options, &arguments->mesh, text); break;
    case ARGP_KEY_END: status = check_arguments(arguments); break;
    case KEY_VIEW: status = sty_parse_view("--view", text, &arguments->view, &options->error); break;
    case KEY_PREVIOUS: arguments->previous = text; break;
    case KEY_SPP: status = set_samples(arguments, text); break;
    case KEY_REPAIR: arguments->repair = true; break;
    case KEY_SIMPLIFY: status = set_simplify(arguments, text); break;
    case KEY_FLAT: arguments->flat = true; break;
    default: return set_value(arguments, key, text);
  }
  return end_option(status);
}

static const struct argp_child children[] = {
    {&picture_argp, 0, NULL, 0}, {&output_argp, 0, NULL, 0}, {&seed_argp, 0, NULL, 0}, {&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .options = options_table,
    .parser = parse_option,
    .args_doc = "MESH|SCENE.json",
    .doc =
        "Renders the guide map of a scene: what its surfaces are, pixel by pixel.\v"
        "Traces a mesh (OBJ, PLY, STL, glTF, FBX, OFF) with a camera fitted to it, or a scene file (.json), which has "
        "cameras, meshes, spheres and styles of its own. FILE.exr holds float channels by name; FILE.png holds n/2+1/2 "
        "and the coverage as alpha.\n\n"
        "A binary PLY of triangles is read in at most 1.5 times the memory of its vertices and indices (24 bytes a "
        "vertex, 12 a triangle), other formats in about 9 times; the tree takes 100 bytes a triangle. --dry-run says "
        "what a scene would take.",
    .children = children,
};

StyStatus run_guide_scene(int argc, char **argv) {
  GuideArguments arguments = default_guide_arguments;
  arguments.view = sty_default_view;
  arguments.contour = sty_default_contour;
  arguments.paths = sty_default_paths;
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = render_guide(&arguments);
  return finish_command(&arguments.options, status);
}
