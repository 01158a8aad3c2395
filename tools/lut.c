/* stylut lut GUIDE */
#include "stylut/lut.h"

#include <stdio.h>
#include <string.h>

#include "commands.h"
#include "inputs.h"
#include "options.h"
#include "stylut/audit.h"
#include "stylut/image_io.h"
#include "stylut/parse.h"

typedef struct Arguments {
  Options options;
  const char *guide;
  int size, sampling, map, metric; /* the last three are the spec's enums */
  const char *engine_name;
  const StyEngine *engine;
  StyEngineOptions engine_options;
  int resolve;  /* index of resolve_names */
  double slack; /* 8-bit levels */
  int encoding; /* a StyEncoding, or -1: by the output's ending */
} Arguments;

enum {
  KEY_SAMPLING = 0x200,
  KEY_ENCODING,
  KEY_MAP,
  KEY_METRIC,
  KEY_TREES,
  KEY_CHECKS,
  KEY_PRECISION,
  KEY_RESOLVE,
  KEY_SLACK
};

static const char *const resolve_names[] = {"nearest", "coherent", NULL};
enum { RESOLVE_NEAREST, RESOLVE_COHERENT };

static const struct argp_option options_table[] = {
    {"size", 's', "N", 0, "texels a side (default: 256)", 0},
    {"engine", 'e', "NAME", 0,
     "exact: brute, flann-single, cgal, grid, or auto: the fastest of them; approximate: analytic, flann-forest, "
     "flann-auto (default: auto)",
     0},
    {"sampling", KEY_SAMPLING, "KIND", 0,
     "what texels answer for: centre, their centres; unorm8, byte values, exactly; corner, their lower left corners, "
     "as "
     "StyleBlitUnity's (default: centre)",
     0},
    {"map", KEY_MAP, "KIND", 0,
     "where values stand: xy, or equal-area: every texel covers the same solid angle (default: xy)", 0},
    {"metric", KEY_METRIC, "KIND", 0, "what nearest means: xy, or angle between normals (default: xy)", 0},
    {"encoding", KEY_ENCODING, "KIND", 0, "f32 (EXR), rg16, rg8x2 or rg8 (PNG) (default: f32 for .exr, rg16 for .png)",
     0},
    {"resolve", KEY_RESOLVE, "KIND", 0,
     "which of the pixels within the slack: nearest, or coherent: neighbouring texels on neighbouring pixels, so that "
     "a style doesn't pop when a surface turns (default: nearest)",
     0},
    {"slack", KEY_SLACK, "LEVELS", 0,
     "how much farther than the nearest a coherent choice may be, in 8-bit levels (default: 2)", 0},
    {NULL, 0, NULL, 0, "For the approximate engines:", 0},
    {"trees", KEY_TREES, "N", 0, "trees of flann-forest, 1 to 64 (default: 4)", 0},
    {"checks", KEY_CHECKS, "N", 0, "leaves that flann-forest looks at (default: 32)", 0},
    {"precision", KEY_PRECISION, "SHARE", 0, "exact answers that flann-auto aims at, 0.01 to 1 (default: 0.9)", 0},
    {0},
};

static StyStatus check_arguments(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  StyStatus status = require_argument(&arguments->options, arguments->guide, "the guide's file name");
  if (!status) status = sty_find_engine("--engine", arguments->engine_name, &arguments->engine, error);
  if (!status) status = require_output(&arguments->options);
  if (!status) status = protect_inputs(&arguments->options, arguments->options.output, &arguments->guide, 1);
  StyImageFormat format = STY_IMAGE_EXR;
  if (!status) status = sty_get_image_format(arguments->options.output, &format, error);
  if (status) return status;
  const bool exr = format == STY_IMAGE_EXR;
  if (arguments->encoding < 0) arguments->encoding = exr ? STY_ENCODE_F32 : STY_ENCODE_RG16;
  if (exr != (arguments->encoding == STY_ENCODE_F32))
    return sty_fail(error, STY_ERROR_USAGE,
                    "--encoding: found %s for %s, expected f32 for .exr and the others for .png",
                    sty_encoding_names[arguments->encoding], arguments->options.output);
  return STY_OK;
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  StyError *error = &arguments->options.error;
  long long number = arguments->size;
  StyStatus status = STY_OK;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: status = take_argument(&arguments->options, &arguments->guide, text); break;
    case ARGP_KEY_END: status = check_arguments(arguments); break;
    case 's':
      status = sty_parse_integer("--size", text, 1, STY_MAX_LUT_SIZE, &number, error);
      arguments->size = (int)number;
      break;
    case 'e': arguments->engine_name = text; break;
    case KEY_SAMPLING:
      status = sty_parse_choice("--sampling", text, sty_sampling_names, &arguments->sampling, error);
      break;
    case KEY_MAP: status = sty_parse_choice("--map", text, sty_map_names, &arguments->map, error); break;
    case KEY_METRIC: status = sty_parse_choice("--metric", text, sty_metric_names, &arguments->metric, error); break;
    case KEY_RESOLVE: status = sty_parse_choice("--resolve", text, resolve_names, &arguments->resolve, error); break;
    case KEY_SLACK: status = sty_parse_number("--slack", text, 0, 255, &arguments->slack, error); break;
    case KEY_TREES:
      status = sty_parse_integer("--trees", text, 1, 64, &number, error);
      arguments->engine_options.trees = (int)number;
      break;
    case KEY_CHECKS:
      status = sty_parse_integer("--checks", text, 1, 1000000, &number, error);
      arguments->engine_options.checks = (int)number;
      break;
    case KEY_PRECISION:
      status = sty_parse_number("--precision", text, 0.01, 1, &arguments->engine_options.precision, error);
      break;
    case KEY_ENCODING:
      status = sty_parse_choice("--encoding", text, sty_encoding_names, &arguments->encoding, error);
      break;
    default: return ARGP_ERR_UNKNOWN;
  }
  return end_option(status);
}

static const struct argp_child children[] = {{&output_argp, 0, NULL, 0}, {&common_argp, 0, NULL, 0}, {0}};
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

typedef struct Account {
  size_t points, unique;
  double mean_error, max_error; /* guide units, feasible texels */
  double times[3];              /* read, build, write */
} Account;

static void measure_errors(const StyLut *lut, Account *account) {
  size_t feasible = 0;
  double sum = 0;
  for (int j = 0; j < lut->spec.height; j++)
    for (int i = 0; i < lut->spec.width; i++) {
      if (!sty_is_feasible(&lut->spec, i, j)) continue;
      const double distance = lut->errors[(size_t)j * (size_t)lut->spec.width + (size_t)i];
      feasible++;
      sum += distance;
      if (distance > account->max_error) account->max_error = distance;
    }
  account->mean_error = feasible ? sum / (double)feasible : 0;
}

static StyStatus print_report(const Arguments *arguments, const Account *account, StyError *error) {
  static const char *const stages[] = {"read", "build", "write"};
  if (arguments->options.json)
    return print_json(
        json_pack("{s:s, s:s, s:b, s:s, s:i, s:s, s:s, s:s, s:s, s:I, s:I, s:f, s:f, s:o, s:f}", "schema",
                  "stylut-lut/1", "engine", arguments->engine->name, "exact", arguments->engine->exact, "resolve",
                  resolve_names[arguments->resolve], "size", arguments->size, "sampling",
                  sty_sampling_names[arguments->sampling], "map", sty_map_names[arguments->map], "metric",
                  sty_metric_names[arguments->metric], "encoding", sty_encoding_names[arguments->encoding], "points",
                  (json_int_t)account->points, "unique", (json_int_t)account->unique, "mean_distance",
                  account->mean_error, "max_distance", account->max_error, "time_ms",
                  pack_times(stages, account->times, 3), "peak_bytes", get_peak_bytes()),
        error);
  if (arguments->options.quiet) return STY_OK;
  printf("%s: %dx%d texels from %zu source pixels, %zu distinct values\n", clean_text(arguments->options.output),
         arguments->size, arguments->size, account->points, account->unique);
  printf("engine %s; distance to the nearest value, in 8-bit levels: mean %.3f, max %.3f\n", arguments->engine->name,
         account->mean_error / STY_LEVEL, account->max_error / STY_LEVEL);
  printf("read %.1f ms, build %.1f ms, write %.1f ms; peak memory %.0f MB\n", account->times[0], account->times[1],
         account->times[2], get_peak_bytes() / 1e6);
  return STY_OK;
}

static StyStatus write_lut(const Arguments *arguments, const StyLut *lut, StyError *error) {
  StyImage *image = NULL;
  StyStatus status = sty_encode_lut(lut, (StyEncoding)arguments->encoding, &image, error);
  if (!status) status = add_history(&arguments->options, "lut", image, &arguments->guide, 1, error);
  if (!status) status = sty_write_image(arguments->options.output, image, error);
  sty_destroy_image(&image);
  return status;
}

static StyStatus run(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  Account account = {0};
  StyImage *guide = NULL;
  StySites *sites = NULL;
  StyLut *lut = NULL;
  const double start = get_milliseconds();
  StyStatus status = read_guide(arguments->guide, &guide, error);
  const double read = get_milliseconds();
  if (!status) status = sty_collect_sites(arguments->guide, guide, &sites, error);
  sty_destroy_image(&guide);
  if (!status && arguments->options.dry_run) {
    status = report_dry_run(&arguments->options, "%dx%d texels from %zu source pixels with engine %s", arguments->size,
                            arguments->size, sites->count, arguments->engine->name);
    sty_destroy_sites(&sites);
    return status;
  }
  if (!status) {
    const StyRun job = begin_progress(&arguments->options, "searching");
    const StyLutSpec spec = {arguments->size, arguments->size, (StySampling)arguments->sampling, (StyMap)arguments->map,
                             (StyMetric)arguments->metric};
    status = sty_build_lut(sites, arguments->engine, &arguments->engine_options, &spec, &job, &lut, error);
    end_progress(&arguments->options);
    if (!status && arguments->resolve == RESOLVE_COHERENT) {
      const StyRun choice = begin_progress(&arguments->options, "resolving");
      status = sty_resolve_coherent(lut, sites, arguments->slack * STY_LEVEL, &choice, error);
      end_progress(&arguments->options);
    }
    if (status) sty_fail(error, status, "%s: %s", arguments->guide, error->text);
  }
  const double built = get_milliseconds();
  if (!status) {
    account.points = sites->count;
    account.unique = lut->unique;
    measure_errors(lut, &account);
    const double before = get_milliseconds();
    status = write_lut(arguments, lut, error);
    account.times[0] = read - start;
    account.times[1] = built - read;
    account.times[2] = get_milliseconds() - before;
  }
  sty_destroy_sites(&sites);
  sty_destroy_lut(&lut);
  if (!status) status = print_report(arguments, &account, error);
  return status;
}

StyStatus run_lut(int argc, char **argv) {
  Arguments arguments = {
      .size = 256, .engine_name = "auto", .engine_options = sty_default_engine_options, .slack = 2, .encoding = -1};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments);
  return finish_command(&arguments.options, status);
}
