/* stylut guide sphere|scene */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "commands.h"
#include "guide_render.h"
#include "stylut/image_io.h"
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

static StyStatus set_simplify(GuideArguments *arguments, const char *text) {
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

static StyStatus set_option(GuideArguments *arguments, int key, const char *text) {
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
      return set_number(options, "--crease", text, 0, 180, &arguments->crease_angle);
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

static StyStatus check_output(GuideArguments *arguments) {
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
static StyStatus check_channels(GuideArguments *arguments) {
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

static StyStatus check_simplify(GuideArguments *arguments) {
  StyError *error = &arguments->options.error;
  if (arguments->has_max_error && (!arguments->simplify || arguments->simplify_options.triangles))
    return sty_fail(error, STY_ERROR_USAGE, "--max-error: found without --simplify auto, expected it with that only");
  if (arguments->simplify && arguments->previous)
    return sty_fail(error, STY_ERROR_USAGE,
                    "--simplify: found with --previous, expected one of them: motion needs the same triangles in both");
  return arguments->simplify
             ? sty_check_simplify(arguments->width, arguments->height, &arguments->simplify_options, error)
             : STY_OK;
}

static StyStatus check_arguments(GuideArguments *arguments) {
  static const char *const kinds[] = {"sphere", "scene", "import", "strokes", "warp", "flow", NULL};
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
  if (arguments->flat && arguments->crease_angle >= 0)
    return sty_fail(error, STY_ERROR_USAGE, "--flat: found with --crease, expected one of them");
  if ((long long)arguments->width * arguments->height > STY_MAX_PIXELS)
    return sty_fail(error, STY_ERROR_USAGE, "--size: found %dx%d, expected at most %lld pixels", arguments->width,
                    arguments->height, STY_MAX_PIXELS);
  StyStatus checked = check_channels(arguments);
  if (!checked) checked = check_simplify(arguments);
  return checked ? checked : check_output(arguments);
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  GuideArguments *arguments = state->input;
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
        "A binary PLY of triangles is read in at most 1.5 times the memory of its vertices and indices (24 bytes a "
        "vertex, "
        "12 a triangle), other formats in about 9 times; the tree takes 100 bytes a triangle. --dry-run says what a "
        "scene would take.\n\n"
        "'import' turns another program's file into a guide, 'strokes' measures a picture at several scales, 'warp' "
        "bends "
        "one by pairs of points, 'flow' finds the motion between two; they have options of their own: 'stylut guide "
        "import --help' and so on.",
    .children = children,
};

StyStatus run_guide_scene(int argc, char **argv) {
  GuideArguments arguments = {
      .width = 512,
      .height = 512,
      .groups = STY_GUIDE_NORMAL | STY_GUIDE_DEPTH,
      .bits = 8,
      .view = {.margin = sty_default_view.margin},
      .crease_angle = -1,
      .contour = sty_default_contour,
      .paths = sty_default_paths,
      .simplify_options = {.max_error = 1, .silhouette = 0.5},
  };
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = render_guide(&arguments);
  return finish_command(&arguments.options, status);
}
