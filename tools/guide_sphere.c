/* stylut guide sphere */
#include "commands.h"
#include "guide_render.h"

static StyStatus check_arguments(GuideArguments *arguments) {
  if (arguments->groups & STY_GUIDE_MOTION)
    return sty_fail(&arguments->options.error, STY_ERROR_USAGE,
                    "--channels: found motion for the sphere, which stands still, expected it of 'stylut guide scene' "
                    "with --previous");
  return check_picture(arguments);
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  GuideArguments *arguments = state->input;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG:
      return end_option(sty_fail(&arguments->options.error, STY_ERROR_USAGE,
                                 "guide sphere: found '%s', expected nothing more", text));
    case ARGP_KEY_END: return end_option(check_arguments(arguments));
    default: return ARGP_ERR_UNKNOWN;
  }
}

static const struct argp_child children[] = {
    {&picture_argp, 0, NULL, 0}, {&output_argp, 0, NULL, 0}, {&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .parser = parse_option,
    .doc =
        "Renders the guide map of a sphere that fills the picture, seen without perspective: the map of a painted "
        "sphere.\v"
        "Every pixel is computed from its place alone; light is 1 from everywhere. FILE.exr holds float channels by "
        "name; FILE.png holds n/2+1/2 and the coverage as alpha.",
    .children = children,
};

StyStatus run_guide_sphere(int argc, char **argv) {
  GuideArguments arguments = default_guide_arguments;
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = render_guide(&arguments);
  return finish_command(&arguments.options, status);
}
