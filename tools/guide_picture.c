/* What a picture of 'guide sphere' and one of 'guide scene' have in common. */
#include "guide_render.h"

const GuideArguments default_guide_arguments = {
    .width = 512,
    .height = 512,
    .groups = STY_GUIDE_NORMAL | STY_GUIDE_DEPTH,
    .bits = 8,
    .crease_angle = -1,
    .simplify_options = {.max_error = 1, .silhouette = 0.5},
};

enum { KEY_BITS = 0x180 };

static const struct argp_option picture_options[] = {
    {"size", 's', "WxH", 0, "pixels; one number for a square (default: 512)", 0},
    {"channels", 'c', "LIST", 0,
     "comma-separated: normal, depth, position, object, style, uv, albedo, luma, curvature, contour, motion (of "
     "scenes); the light paths full, LDE (direct diffuse), LSE (direct specular), LD12E (two diffuse bounces), LIE "
     "(diffuse interreflection), together: paths; or all but motion and paths: all (default: normal,depth; a PNG holds "
     "normal only); A, the coverage, is always there",
     0},
    {"bits", KEY_BITS, "8|16", 0, "precision of a PNG (default: 8)", 0},
    {0},
};

static error_t parse_picture(int key, char *text, struct argp_state *state) {
  GuideArguments *arguments = state->input;
  Options *options = &arguments->options;
  if (key != 's' && key != 'c' && key != KEY_BITS) return ARGP_ERR_UNKNOWN;
  begin_option(key, text, state);
  if (key == 's') return end_option(parse_picture_size(options, text, &arguments->width, &arguments->height));
  if (key == KEY_BITS) return end_option(parse_bits(options, text, &arguments->bits));
  arguments->channels = text;
  return end_option(sty_parse_channels("--channels", text, &arguments->groups, &options->error));
}

const struct argp picture_argp = {.options = picture_options, .parser = parse_picture};

/* A PNG holds normals; what else was asked for by name would be missed. */
static StyStatus choose_channels(GuideArguments *arguments) {
  if (arguments->format == STY_IMAGE_EXR) return STY_OK;
  if (arguments->channels && arguments->groups != STY_GUIDE_NORMAL)
    return sty_fail(&arguments->options.error, STY_ERROR_USAGE,
                    "--channels: found %s for %s, which holds normals only, expected normal, or a name that ends in "
                    ".exr",
                    arguments->channels, arguments->options.output);
  arguments->groups = STY_GUIDE_NORMAL;
  return STY_OK;
}

StyStatus check_picture(GuideArguments *arguments) {
  Options *options = &arguments->options;
  const char *const inputs[] = {arguments->mesh, arguments->previous};
  StyStatus status = require_output(options);
  if (!status) status = protect_inputs(options, options->output, inputs, 2);
  if (!status) status = sty_get_image_format(options->output, &arguments->format, &options->error);
  if (!status) status = choose_channels(arguments);
  const OptionNeed needs[] = {{"bits", arguments->format == STY_IMAGE_PNG, "an output that ends in .png"}};
  return status ? status : check_needs(options, needs, 1);
}
