#include "lut_arguments.h"

#include <math.h>
#include <string.h>

#include "stylut/image_io.h"
#include "stylut/parse.h"

enum {
  KEY_SAMPLING = 0x200,
  KEY_ENCODING,
  KEY_MAP,
  KEY_METRIC,
  KEY_MAX_MEMORY,
  KEY_RESOLVE,
  KEY_SLACK,
  KEY_MAX_P99,
  KEY_FRAMES
};

/* Not given: of --size; of --slack and --encoding anything below 0. */
enum { DEFAULT_SIZE = -1 };

static const long long default_max_memory = 1LL << 30;
static const double default_slack = 2;

const char *const lut_resolve_names[] = {"nearest", "coherent", "frames", "both", NULL};

static const struct argp_option options_table[] = {
    {"size", 's', "N|auto", 0,
     "texels a side, or auto: the smallest table found that meets --max-p99, encoding included, in steps of 1.41 and "
     "three halvings (default: 256; 64 with --channels)",
     0},
    {"max-p99", KEY_MAX_P99, "DEG", 0, "for --size auto: the lookup error that 99 % of the lookups stay within", 0},
    {"frames", KEY_FRAMES, "FILE...", 0,
     "guides of real frames: with --size auto their lookups count, with --resolve frames or both they are served", 0},
    {"sampling", KEY_SAMPLING, "KIND", 0,
     "what texels answer for: centre, their centres; unorm8, byte values, exactly; corner, their lower left corners, "
     "as StyleBlitUnity's (default: centre)",
     0},
    {"map", KEY_MAP, "KIND", 0,
     "where values stand: xy; equal-area: every texel covers the same solid angle; or, with --size auto, auto: "
     "whichever does with less (default: xy)",
     0},
    {"metric", KEY_METRIC, "KIND", 0, "what nearest means: xy, or angle between normals (default: xy)", 0},
    {"encoding", KEY_ENCODING, "KIND", 0, "f32 (EXR), rg16, rg8x2 or rg8 (PNG) (default: f32 for .exr, rg16 for .png)",
     0},
    {"resolve", KEY_RESOLVE, "KIND", 0,
     "which of the pixels within the slack: nearest; coherent: neighbouring texels on neighbouring pixels, so that a "
     "style doesn't pop when a surface turns; frames: those that make the largest pieces in --frames; or both, weighed "
     "(default: nearest)",
     0},
    {"slack", KEY_SLACK, "LEVELS", 0,
     "how much farther than the nearest such a choice may be, in 8-bit levels (default: 2)", 0},
    {"channels", 'c', "LIST", 0,
     "a table of three dimensions, N x N x N texels, over these three channels, as in normal.X,normal.Y,luma.Y:0.5; "
     "a number after a colon weighs the channel's distances; axes run from 0 to 1, those of normal.* from -1 to 1",
     0},
    {"max-memory", KEY_MAX_MEMORY, "BYTES", 0,
     "refuse a table of three dimensions that takes more; K, M and G may follow (default: 1G)", 0},
    {0},
};

/* What is meant for flat tables, or NULL. */
static const char *find_flat_option(const LutArguments *arguments) {
  return arguments->size == 0                       ? "--size auto"
         : arguments->max_p99 > 0                   ? "--max-p99"
         : arguments->frames.count                  ? "--frames"
         : arguments->sampling != STY_SAMPLE_CENTRE ? "--sampling"
         : arguments->map != STY_MAP_XY             ? "--map"
         : arguments->metric != STY_METRIC_XY       ? "--metric"
         : arguments->resolve != RESOLVE_NEAREST    ? "--resolve"
                                                    : NULL;
}

void measure_cube(const LutArguments *arguments, double *texels, double *bytes) {
  const int channels = arguments->encoding == STY_ENCODE_RG8X2 ? 4 : 3;
  *texels = pow(arguments->size, 3);
  *bytes = *texels * (sizeof(uint32_t) + sizeof(float) * (size_t)(1 + channels));
}

static StyStatus check_cube(LutArguments *arguments) {
  StyError *error = &arguments->options.error;
  const char *option = find_flat_option(arguments);
  if (option)
    return sty_fail(error, STY_ERROR_USAGE, "--channels: found with %s, which is for flat tables, expected one of them",
                    option);
  const long long limit = arguments->max_memory ? arguments->max_memory : default_max_memory;
  double texels, bytes;
  measure_cube(arguments, &texels, &bytes);
  if (bytes > (double)limit)
    return sty_fail(error, STY_ERROR_USAGE,
                    "--size: found %d, %.0f texels (%d^3) that take %.0f bytes, expected at most --max-memory %lld",
                    arguments->size, texels, arguments->size, bytes, limit);
  if (arguments->size > STY_MAX_CUBE)
    return sty_fail(error, STY_ERROR_USAGE, "--size: found %d, expected 1 to %d for three dimensions", arguments->size,
                    STY_MAX_CUBE);
  return STY_OK;
}

static StyStatus check_resolve(LutArguments *arguments) {
  StyError *error = &arguments->options.error;
  const bool serves = arguments->resolve == RESOLVE_FRAMES || arguments->resolve == RESOLVE_BOTH;
  if (serves && !arguments->frames.count)
    return sty_fail(error, STY_ERROR_USAGE, "--resolve: found %s without --frames, expected the frames to serve",
                    lut_resolve_names[arguments->resolve]);
  if (arguments->resolve != RESOLVE_NEAREST && !arguments->engine->exact)
    return sty_fail(error, STY_ERROR_USAGE,
                    "--resolve: found %s with engine %s, expected an exact one, from whose "
                    "distances the slack is counted",
                    lut_resolve_names[arguments->resolve], arguments->engine->name);
  if (arguments->size == 0 && !arguments->engine->exact)
    return sty_fail(error, STY_ERROR_USAGE,
                    "--size: found auto with engine %s, expected an exact one, which the budget is for",
                    arguments->engine->name);
  if (arguments->resolve != RESOLVE_NEAREST && arguments->size == 0)
    return sty_fail(error, STY_ERROR_USAGE,
                    "--size: found auto with --resolve %s, expected a number: budgets are those of the nearest",
                    lut_resolve_names[arguments->resolve]);
  if (arguments->frames.count && !serves && arguments->size != 0 && !arguments->feature_count)
    return sty_fail(error, STY_ERROR_USAGE,
                    "--frames: found without use, expected them with --size auto or --resolve frames or both");
  if (arguments->slack >= 0 && arguments->resolve == RESOLVE_NEAREST)
    return sty_fail(error, STY_ERROR_USAGE, "--slack: found with --resolve nearest, expected coherent, frames or both");
  if (arguments->slack < 0) arguments->slack = default_slack;
  return STY_OK;
}

static StyStatus check_arguments(LutArguments *arguments) {
  StyError *error = &arguments->options.error;
  const char *inputs[1 + MOST_FRAMES] = {arguments->guide};
  const int count = append_frames(&arguments->frames, inputs, 1);
  if (arguments->size == DEFAULT_SIZE) arguments->size = arguments->feature_count ? 64 : 256;
  StyStatus status = arguments->feature_count
                         ? choose_engine(&arguments->options, STY_TASK_CUBE_OR_FIELD, 3, &arguments->engine)
                         : choose_engine(&arguments->options, STY_TASK_TABLE, 2, &arguments->engine);
  if (!status) status = require_argument(&arguments->options, arguments->guide, "the guide's file name");
  if (!status && arguments->size == 0 && !(arguments->max_p99 > 0))
    status = sty_fail(error, STY_ERROR_USAGE, "--size auto: found no --max-p99, expected the error to stay within");
  if (!status && arguments->size != 0 && (arguments->max_p99 > 0 || arguments->map == MAP_ANY))
    status = sty_fail(error, STY_ERROR_USAGE, "--size: found %d with %s, expected auto", arguments->size,
                      arguments->max_p99 > 0 ? "--max-p99" : "--map auto");
  if (!status && arguments->size != 0 && !arguments->feature_count) {
    const StyLutSpec spec = {arguments->size, arguments->size, (StySampling)arguments->sampling, (StyMap)arguments->map,
                             (StyMetric)arguments->metric};
    status = sty_check_spec(&spec, error);
  }
  if (!status) status = check_resolve(arguments);
  if (!status && !arguments->feature_count && arguments->max_memory)
    status = sty_fail(error, STY_ERROR_USAGE, "--max-memory: found without --channels, expected three dimensions");
  if (!status) status = require_output(&arguments->options);
  if (!status) status = protect_inputs(&arguments->options, arguments->options.output, inputs, count);
  StyImageFormat format = STY_IMAGE_EXR;
  if (!status) status = sty_get_image_format(arguments->options.output, &format, error);
  if (status) return status;
  const bool exr = format == STY_IMAGE_EXR;
  if (arguments->encoding < 0) arguments->encoding = exr ? STY_ENCODE_F32 : STY_ENCODE_RG16;
  if (exr != (arguments->encoding == STY_ENCODE_F32))
    return sty_fail(error, STY_ERROR_USAGE, "--encoding: found %s for %s, expected %s",
                    sty_encoding_names[arguments->encoding], arguments->options.output,
                    exr ? "f32, or a name ending in .png" : "rg16, rg8x2 or rg8, or a name ending in .exr");
  return arguments->feature_count ? check_cube(arguments) : STY_OK;
}

static StyStatus set_size(LutArguments *arguments, const char *text) {
  long long number = 0;
  StyStatus status = STY_OK;
  if (strcmp(text, "auto") != 0)
    status = sty_parse_integer("--size", text, 1, STY_MAX_LUT_SIZE, &number, &arguments->options.error);
  if (!status) arguments->size = (int)number;
  return status;
}

static StyStatus set_map(LutArguments *arguments, const char *text) {
  if (strcmp(text, "auto") != 0)
    return sty_parse_choice("--map", text, sty_map_names, &arguments->map, &arguments->options.error);
  arguments->map = MAP_ANY;
  return STY_OK;
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  LutArguments *arguments = state->input;
  StyError *error = &arguments->options.error;
  StyStatus status = STY_OK;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG:
      status = take_argument_or_frame(&arguments->options, &arguments->guide, &arguments->frames, text);
      break;
    case ARGP_KEY_END: status = check_arguments(arguments); break;
    case 's': status = set_size(arguments, text); break;
    case KEY_MAX_P99: status = sty_parse_number("--max-p99", text, 1e-6, 180, &arguments->max_p99, error); break;
    case KEY_FRAMES: status = add_frame(&arguments->frames, text, error); break;
    case KEY_SAMPLING:
      status = sty_parse_choice("--sampling", text, sty_sampling_names, &arguments->sampling, error);
      break;
    case KEY_MAP: status = set_map(arguments, text); break;
    case KEY_METRIC: status = sty_parse_choice("--metric", text, sty_metric_names, &arguments->metric, error); break;
    case KEY_RESOLVE:
      status = sty_parse_choice("--resolve", text, lut_resolve_names, &arguments->resolve, error);
      break;
    case KEY_SLACK: status = sty_parse_number("--slack", text, 0, 255, &arguments->slack, error); break;
    case 'c':
      status = sty_parse_features("--channels", text, arguments->features, &arguments->feature_count, error);
      break;
    case KEY_MAX_MEMORY: status = sty_parse_bytes("--max-memory", text, 1, &arguments->max_memory, error); break;
    case KEY_ENCODING:
      status = sty_parse_choice("--encoding", text, sty_encoding_names, &arguments->encoding, error);
      break;
    default: return ARGP_ERR_UNKNOWN;
  }
  return end_option(status);
}

static const struct argp_child children[] = {
    {&engine_argp, 0, NULL, 0}, {&output_argp, 0, NULL, 0}, {&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .options = options_table,
    .parser = parse_option,
    .args_doc = "GUIDE",
    .doc =
        "Builds the look-up table of a guide: for every normal, the source pixel whose normal is nearest.\v"
        "GUIDE is an EXR with channel normal.X .Y .Z, or an 8- or 16-bit normal map. All exact engines give the "
        "same bytes.",
    .children = children,
};

StyStatus parse_lut_arguments(int argc, char **argv, LutArguments *out) {
  *out = (LutArguments){
      .options.engine_options = sty_default_engine_options, .size = DEFAULT_SIZE, .slack = -1, .encoding = -1};
  return parse_arguments(&parser, argc, argv, out);
}
