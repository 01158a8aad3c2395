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
  int size;                  /* 0: the smallest that meets the budget */
  int sampling, map, metric; /* the spec's enums; map -1: either */
  double max_p99;            /* degrees; 0: no budget */
  Frames frames;
  const char *engine_name;
  const StyEngine *engine;
  StyEngineOptions engine_options;
  int resolve;  /* index of resolve_names */
  double slack; /* 8-bit levels; below 0: not given */
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
  KEY_SLACK,
  KEY_MAX_P99,
  KEY_FRAMES
};

enum { MAP_ANY = -1 };

/* Among the candidates of --size auto, so many smaller and larger ones are shown. */
enum { SHOWN = 2 };

static const char *const resolve_names[] = {"nearest", "coherent", "frames", "both", NULL};
enum { RESOLVE_NEAREST, RESOLVE_COHERENT, RESOLVE_FRAMES, RESOLVE_BOTH };
static const double default_slack = 2;

static const struct argp_option options_table[] = {
    {"size", 's', "N|auto", 0,
     "texels a side, or auto: the smallest table that meets --max-p99, encoding included (default: 256)", 0},
    {"max-p99", KEY_MAX_P99, "DEG", 0, "for --size auto: the lookup error that 99 % of the lookups stay within", 0},
    {"frames", KEY_FRAMES, "FILE...", 0,
     "guides of real frames: with --size auto their lookups count, with --resolve frames or both they are served", 0},
    {"engine", 'e', "NAME", 0,
     "exact: brute, flann-single, cgal, grid, or auto: the fastest of them; approximate: analytic, flann-forest, "
     "flann-auto (default: auto)",
     0},
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
    {NULL, 0, NULL, 0, "For the approximate engines:", 0},
    {"trees", KEY_TREES, "N", 0, "trees of flann-forest, 1 to 64 (default: 4)", 0},
    {"checks", KEY_CHECKS, "N", 0, "leaves that flann-forest looks at (default: 32)", 0},
    {"precision", KEY_PRECISION, "SHARE", 0, "exact answers that flann-auto aims at, 0.01 to 1 (default: 0.9)", 0},
    {0},
};

static StyStatus check_resolve(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  const bool serves = arguments->resolve == RESOLVE_FRAMES || arguments->resolve == RESOLVE_BOTH;
  if (serves && !arguments->frames.count)
    return sty_fail(error, STY_ERROR_USAGE, "--resolve: found %s without --frames, expected the frames to serve",
                    resolve_names[arguments->resolve]);
  if (arguments->frames.count && !serves && arguments->size != 0)
    return sty_fail(error, STY_ERROR_USAGE,
                    "--frames: found with --size %d and --resolve %s, expected auto, frames or "
                    "both",
                    arguments->size, resolve_names[arguments->resolve]);
  if (arguments->slack >= 0 && arguments->resolve == RESOLVE_NEAREST)
    return sty_fail(error, STY_ERROR_USAGE, "--slack: found with --resolve nearest, expected coherent, frames or both");
  if (arguments->slack < 0) arguments->slack = default_slack;
  return STY_OK;
}

static StyStatus check_arguments(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  StyStatus status = require_argument(&arguments->options, arguments->guide, "the guide's file name");
  if (!status && arguments->size == 0 && !(arguments->max_p99 > 0))
    status = sty_fail(error, STY_ERROR_USAGE, "--size auto: found no --max-p99, expected the error to stay within");
  if (!status && arguments->size != 0 && (arguments->max_p99 > 0 || arguments->map == MAP_ANY))
    status = sty_fail(error, STY_ERROR_USAGE, "--size: found %d with %s, expected auto", arguments->size,
                      arguments->max_p99 > 0 ? "--max-p99" : "--map auto");
  if (!status) status = check_resolve(arguments);
  if (!status) status = sty_find_engine("--engine", arguments->engine_name, &arguments->engine, error);
  if (!status) status = require_output(&arguments->options);
  if (!status) status = protect_inputs(&arguments->options, arguments->options.output, &arguments->guide, 1);
  if (!status)
    status = protect_inputs(&arguments->options, arguments->options.output, arguments->frames.files,
                            arguments->frames.count);
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

static StyStatus set_size(Arguments *arguments, const char *text) {
  long long number = 0;
  StyStatus status = STY_OK;
  if (strcmp(text, "auto") != 0)
    status = sty_parse_integer("--size", text, 1, STY_MAX_LUT_SIZE, &number, &arguments->options.error);
  if (!status) arguments->size = (int)number;
  return status;
}

static StyStatus set_map(Arguments *arguments, const char *text) {
  if (strcmp(text, "auto") != 0)
    return sty_parse_choice("--map", text, sty_map_names, &arguments->map, &arguments->options.error);
  arguments->map = MAP_ANY;
  return STY_OK;
}

/* The guide, then more frames once --frames was given. */
static StyStatus take_file(Arguments *arguments, const char *text) {
  if (arguments->guide && arguments->frames.count)
    return add_frame(&arguments->frames, text, &arguments->options.error);
  return take_argument(&arguments->options, &arguments->guide, text);
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  StyError *error = &arguments->options.error;
  long long number = 0;
  StyStatus status = STY_OK;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: status = take_file(arguments, text); break;
    case ARGP_KEY_END: status = check_arguments(arguments); break;
    case 's': status = set_size(arguments, text); break;
    case KEY_MAX_P99: status = sty_parse_number("--max-p99", text, 1e-6, 180, &arguments->max_p99, error); break;
    case KEY_FRAMES: status = add_frame(&arguments->frames, text, error); break;
    case 'e': arguments->engine_name = text; break;
    case KEY_SAMPLING:
      status = sty_parse_choice("--sampling", text, sty_sampling_names, &arguments->sampling, error);
      break;
    case KEY_MAP: status = set_map(arguments, text); break;
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

/* All that is read. */
typedef struct Inputs {
  StyImage *guide;
  StySites *sites;
  StyImage *frames[MOST_FRAMES];
} Inputs;

static const char *name_bytes(size_t bytes, char out[32]) {
  snprintf(out, 32, bytes < 1 << 20 ? "%.1f kB" : "%.1f MB", (double)bytes / (bytes < 1 << 20 ? 1e3 : 1e6));
  return out;
}

/* What was chosen, and what its neighbours would cost and buy. */
static void show_candidates(const StyCandidate *candidates, int count, int chosen) {
  for (int c = 0; c < count; c++) {
    if (c < chosen - SHOWN || c > chosen + SHOWN) continue;
    char bytes[32];
    printf("%s %-10s %4d: %9s, lookup p99 %.3f, mean %.3f degrees\n", c == chosen ? "*" : " ",
           sty_map_names[candidates[c].spec.map], candidates[c].spec.width, name_bytes(candidates[c].bytes, bytes),
           candidates[c].lookup.p99, candidates[c].lookup.mean);
  }
}

static StyStatus choose_spec(Arguments *arguments, const Inputs *inputs, StyLutSpec *spec, StyError *error) {
  StyCandidate candidates[STY_MOST_CANDIDATES];
  int count = 0, chosen = -1;
  const StyAuditOptions options = {.weights = arguments->frames.count ? STY_WEIGHT_FRAMES : STY_WEIGHT_DISC,
                                   .frames = (const StyImage *const *)inputs->frames,
                                   .frame_count = arguments->frames.count};
  const StyRun run = begin_progress(&arguments->options, "choosing");
  const StyStatus status =
      sty_choose_size(inputs->sites, inputs->guide, spec, arguments->map == MAP_ANY, (StyEncoding)arguments->encoding,
                      &options, arguments->max_p99, &run, candidates, &count, &chosen, error);
  end_progress(&arguments->options);
  if (status) return status;
  if (chosen < 0) {
    int best = 0;
    for (int c = 1; c < count; c++)
      if (candidates[c].lookup.p99 < candidates[best].lookup.p99) best = c;
    return sty_fail(error, STY_CHECK_FAILED,
                    "--max-p99: found %.4g degrees at best (%s, size %d), expected at most %.4g",
                    candidates[best].lookup.p99, sty_map_names[candidates[best].spec.map], candidates[best].spec.width,
                    arguments->max_p99);
  }
  if (!arguments->options.quiet && !arguments->options.json) show_candidates(candidates, count, chosen);
  *spec = candidates[chosen].spec;
  arguments->size = spec->width;
  arguments->map = (int)spec->map;
  return STY_OK;
}

static StyStatus resolve(const Arguments *arguments, const Inputs *inputs, StyLut *lut, StyError *error) {
  if (arguments->resolve == RESOLVE_NEAREST) return STY_OK;
  const bool serves = arguments->resolve != RESOLVE_COHERENT;
  const StyResolveOptions options = {.slack = arguments->slack * STY_LEVEL,
                                     .coherent = arguments->resolve != RESOLVE_FRAMES,
                                     .guide = serves ? inputs->guide : NULL,
                                     .frames = serves ? (const StyImage *const *)inputs->frames : NULL,
                                     .frame_count = serves ? arguments->frames.count : 0};
  const StyRun run = begin_progress(&arguments->options, "resolving");
  const StyStatus status = sty_resolve_lut(lut, inputs->sites, &options, &run, error);
  end_progress(&arguments->options);
  return status;
}

static StyStatus build(const Arguments *arguments, const Inputs *inputs, const StyLutSpec *spec, StyLut **out,
                       StyError *error) {
  const StyRun run = begin_progress(&arguments->options, "searching");
  StyStatus status =
      sty_build_lut(inputs->sites, arguments->engine, &arguments->engine_options, spec, &run, out, error);
  end_progress(&arguments->options);
  if (!status) status = resolve(arguments, inputs, *out, error);
  if (status) sty_fail(error, status, "%s: %s", arguments->guide, error->text);
  return status;
}

static StyStatus open_inputs(const Arguments *arguments, Inputs *out, Account *account, StyError *error) {
  const double start = sty_get_milliseconds();
  StyStatus status = read_guide(arguments->guide, &out->guide, error);
  if (!status) status = read_frames(&arguments->frames, out->frames, error);
  const double read = sty_get_milliseconds();
  if (!status) status = sty_collect_sites(arguments->guide, out->guide, &out->sites, error);
  account->times[0] = read - start;
  account->times[1] = sty_get_milliseconds() - read;
  return status;
}

static void close_inputs(Inputs *inputs) {
  sty_destroy_image(&inputs->guide);
  sty_destroy_sites(&inputs->sites);
  destroy_frames(inputs->frames);
}

static StyStatus make_table(Arguments *arguments, const Inputs *inputs, Account *account, StyError *error) {
  StyLutSpec spec = {arguments->size, arguments->size, (StySampling)arguments->sampling,
                     arguments->map == MAP_ANY ? STY_MAP_XY : (StyMap)arguments->map, (StyMetric)arguments->metric};
  StyStatus status = STY_OK;
  if (arguments->size == 0) status = choose_spec(arguments, inputs, &spec, error);
  if (status) return status;
  if (arguments->options.dry_run)
    return report_dry_run(&arguments->options, "%dx%d texels from %zu source pixels with engine %s", arguments->size,
                          arguments->size, inputs->sites->count, arguments->engine->name);
  StyLut *lut = NULL;
  const double start = sty_get_milliseconds();
  status = build(arguments, inputs, &spec, &lut, error);
  const double built = sty_get_milliseconds();
  account->times[1] += built - start;
  if (!status) {
    account->points = inputs->sites->count;
    account->unique = lut->unique;
    measure_errors(lut, account);
    status = write_lut(arguments, lut, error);
    account->times[2] = sty_get_milliseconds() - built;
  }
  sty_destroy_lut(&lut);
  return status ? status : print_report(arguments, account, error);
}

static StyStatus run(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  Account account = {0};
  Inputs inputs = {0};
  StyStatus status = open_inputs(arguments, &inputs, &account, error);
  if (!status) status = make_table(arguments, &inputs, &account, error);
  close_inputs(&inputs);
  return status;
}

StyStatus run_lut(int argc, char **argv) {
  Arguments arguments = {
      .size = 256, .engine_name = "auto", .engine_options = sty_default_engine_options, .slack = -1, .encoding = -1};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments);
  return finish_command(&arguments.options, status);
}
