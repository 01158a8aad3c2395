/* stylut lut GUIDE */
#include "stylut/lut.h"

#include <math.h>
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
  int size;                  /* 0: the smallest that meets the budget; DEFAULT_SIZE: not given */
  int sampling, map, metric; /* the spec's enums; map -1: either */
  double max_p99;            /* degrees; 0: no budget */
  Frames frames;
  const StyEngine *engine;
  StyFeature features[STY_MOST_DIMS]; /* of a cube */
  int feature_count;                  /* 0: a flat table */
  long long max_memory;               /* bytes; 0: not given */
  int resolve;                        /* index of resolve_names */
  double slack;                       /* 8-bit levels; below 0: not given */
  int encoding;                       /* a StyEncoding, or -1: by the output's ending */
} Arguments;

enum {
  KEY_SAMPLING = 0x200,
  KEY_ENCODING,
  KEY_MAP,
  KEY_METRIC,
  KEY_CHANNELS,
  KEY_MAX_MEMORY,
  KEY_RESOLVE,
  KEY_SLACK,
  KEY_MAX_P99,
  KEY_FRAMES
};

enum { MAP_ANY = -1, DEFAULT_SIZE = -1 };

static const long long default_max_memory = 1LL << 30;

/* Among the candidates of --size auto, so many smaller and larger ones are shown. */
enum { SHOWN = 2 };

static const char *const resolve_names[] = {"nearest", "coherent", "frames", "both", NULL};
enum { RESOLVE_NEAREST, RESOLVE_COHERENT, RESOLVE_FRAMES, RESOLVE_BOTH };
static const double default_slack = 2;

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
    {"channels", KEY_CHANNELS, "LIST", 0,
     "a table of three dimensions, N x N x N texels, over these three channels, as in normal.X,normal.Y,luma.Y:0.5; "
     "a number after a colon weighs the channel's distances; axes run from 0 to 1, those of normal.* from -1 to 1",
     0},
    {"max-memory", KEY_MAX_MEMORY, "BYTES", 0,
     "refuse a table of three dimensions that takes more; K, M and G may follow (default: 1G)", 0},
    {0},
};

/* What is meant for flat tables, or NULL. */
static const char *find_flat_option(const Arguments *arguments) {
  return arguments->size == 0                       ? "--size auto"
         : arguments->max_p99 > 0                   ? "--max-p99"
         : arguments->frames.count                  ? "--frames"
         : arguments->sampling != STY_SAMPLE_CENTRE ? "--sampling"
         : arguments->map != STY_MAP_XY             ? "--map"
         : arguments->metric != STY_METRIC_XY       ? "--metric"
         : arguments->resolve != RESOLVE_NEAREST    ? "--resolve"
                                                    : NULL;
}

/* Of a cube: its texels, and the bytes of table and picture. */
static void measure_cube(const Arguments *arguments, double *texels, double *bytes) {
  const int channels = arguments->encoding == STY_ENCODE_RG8X2 ? 4 : 3;
  *texels = pow(arguments->size, 3);
  *bytes = *texels * (sizeof(uint32_t) + sizeof(float) * (size_t)(1 + channels));
}

static StyStatus check_cube(Arguments *arguments) {
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

static StyStatus check_resolve(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  const bool serves = arguments->resolve == RESOLVE_FRAMES || arguments->resolve == RESOLVE_BOTH;
  if (serves && !arguments->frames.count)
    return sty_fail(error, STY_ERROR_USAGE, "--resolve: found %s without --frames, expected the frames to serve",
                    resolve_names[arguments->resolve]);
  if (arguments->resolve != RESOLVE_NEAREST && !arguments->engine->exact)
    return sty_fail(error, STY_ERROR_USAGE,
                    "--resolve: found %s with engine %s, expected an exact one, from whose "
                    "distances the slack is counted",
                    resolve_names[arguments->resolve], arguments->engine->name);
  if (arguments->size == 0 && !arguments->engine->exact)
    return sty_fail(error, STY_ERROR_USAGE,
                    "--size: found auto with engine %s, expected an exact one, which the budget is for",
                    arguments->engine->name);
  if (arguments->resolve != RESOLVE_NEAREST && arguments->size == 0)
    return sty_fail(error, STY_ERROR_USAGE,
                    "--size: found auto with --resolve %s, expected a number: budgets are those of the nearest",
                    resolve_names[arguments->resolve]);
  if (arguments->frames.count && !serves && arguments->size != 0 && !arguments->feature_count)
    return sty_fail(error, STY_ERROR_USAGE,
                    "--frames: found without use, expected them with --size auto or --resolve frames or both");
  if (arguments->slack >= 0 && arguments->resolve == RESOLVE_NEAREST)
    return sty_fail(error, STY_ERROR_USAGE, "--slack: found with --resolve nearest, expected coherent, frames or both");
  if (arguments->slack < 0) arguments->slack = default_slack;
  return STY_OK;
}

static StyStatus check_arguments(Arguments *arguments) {
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

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
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
    case KEY_RESOLVE: status = sty_parse_choice("--resolve", text, resolve_names, &arguments->resolve, error); break;
    case KEY_SLACK: status = sty_parse_number("--slack", text, 0, 255, &arguments->slack, error); break;
    case KEY_CHANNELS:
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

typedef struct Account {
  size_t points, unique;
  double mean_error, max_error; /* guide units, feasible texels; of a cube all, weighted */
  double mean_paid, max_paid;   /* the same, for what --resolve put above the least */
  StyFeature axes[3];           /* of a cube */
  double times[3];              /* read, build, write */
} Account;

/* Of the table's errors, less `base` where there is one: mean and largest. */
static void measure_errors(const StyLut *lut, const float *base, double *mean, double *most) {
  size_t feasible = 0;
  double sum = 0;
  *most = 0;
  for (int j = 0; j < lut->spec.height; j++)
    for (int i = 0; i < lut->spec.width; i++) {
      if (!lut->depth && !sty_is_feasible(&lut->spec, i, j)) continue;
      const size_t texel = (size_t)j * (size_t)lut->spec.width + (size_t)i;
      /* Other pixels' distances are summed anew, and may come out a rounding lower. */
      const double distance = fmax(0, (double)lut->errors[texel] - (base ? (double)base[texel] : 0));
      feasible++;
      sum += distance;
      if (distance > *most) *most = distance;
    }
  *mean = feasible ? sum / (double)feasible : 0;
}

/* "256x256" or "64x64x64". */
static const char *name_sides(const Arguments *arguments, char out[64]) {
  const int size = arguments->size;
  snprintf(out, 64, arguments->feature_count ? "%dx%dx%d" : "%dx%d", size, size, size);
  return out;
}

static StyStatus print_report(const Arguments *arguments, const Account *account, StyError *error) {
  static const char *const stages[] = {"read", "build", "write"};
  if (arguments->options.json) {
    json_t *report =
        json_pack("{s:s, s:s, s:b, s:s, s:i, s:s, s:s, s:s, s:s, s:I, s:I, s:f, s:f, s:f, s:f, s:o, s:f}", "schema",
                  "stylut-lut/1", "engine", arguments->engine->name, "exact", arguments->engine->exact, "resolve",
                  resolve_names[arguments->resolve], "size", arguments->size, "sampling",
                  sty_sampling_names[arguments->sampling], "map", sty_map_names[arguments->map], "metric",
                  sty_metric_names[arguments->metric], "encoding", sty_encoding_names[arguments->encoding], "points",
                  (json_int_t)account->points, "unique", (json_int_t)account->unique, "mean_distance",
                  account->mean_error, "max_distance", account->max_error, "mean_paid", account->mean_paid, "max_paid",
                  account->max_paid, "time_ms", pack_times(stages, account->times, 3), "peak_bytes", get_peak_bytes());
    if (arguments->feature_count) pack_features(report, account->axes, 3);
    return print_json(report, error);
  }
  if (arguments->options.quiet) return STY_OK;
  char texels[64];
  char distinct[64] = "";
  if (account->unique) snprintf(distinct, sizeof distinct, ", %zu distinct values", account->unique);
  printf("%s: %s texels from %zu source pixels%s\n", clean_text(arguments->options.output),
         name_sides(arguments, texels), account->points, distinct);
  if (arguments->feature_count)
    printf("engine %s; weighted distance to the nearest value: mean %.5f, max %.5f\n", arguments->engine->name,
           account->mean_error, account->max_error);
  else
    printf("engine %s; distance to the nearest value, in 8-bit levels: mean %.3f, max %.3f\n", arguments->engine->name,
           account->mean_error / STY_LEVEL, account->max_error / STY_LEVEL);
  if (arguments->resolve != RESOLVE_NEAREST)
    printf("resolve %s; of the slack of %g levels it paid: mean %.3f, max %.3f\n", resolve_names[arguments->resolve],
           arguments->slack, account->mean_paid / STY_LEVEL, account->max_paid / STY_LEVEL);
  printf("read %.1f ms, build %.1f ms, write %.1f ms; peak memory %.0f MB\n", account->times[0], account->times[1],
         account->times[2], get_peak_bytes() / 1e6);
  return STY_OK;
}

static StyStatus write_lut(const Arguments *arguments, const StyLut *lut, StyError *error) {
  const char *inputs[1 + MOST_FRAMES] = {arguments->guide};
  const int count = append_frames(&arguments->frames, inputs, 1);
  StyImage *image = NULL;
  if (arguments->encoding == STY_ENCODE_RG8 && (lut->source_width > 255 || lut->source_height > 255))
    warn(
        &arguments->options,
        "--encoding: found rg8 for a source of %d x %d pixels, of which 8 bits can't name each; expected rg16 or rg8x2",
        lut->source_width, lut->source_height);
  StyStatus status = sty_encode_lut(lut, (StyEncoding)arguments->encoding, &image, error);
  if (!status) status = add_history(&arguments->options, "lut", image, inputs, count, error);
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

/* What was chosen, or came nearest, and what its neighbours would cost and buy. */
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
    if (!arguments->options.quiet && !arguments->options.json) show_candidates(candidates, count, best);
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

static StyStatus read_source(const Arguments *arguments, StyImage **out, StyError *error) {
  return arguments->feature_count
             ? read_features(arguments->guide, arguments->features, arguments->feature_count, out, error)
             : read_guide(&arguments->options, arguments->guide, out, error);
}

/* What lies beyond the axes of a cube (see lut.h) can't be looked up. */
static void warn_about_axes(const Arguments *arguments, const StySites *sites) {
  size_t outside = 0;
  for (size_t s = 0; s < sites->count; s++) {
    bool inside = true;
    for (int k = 0; k < 3; k++) {
      const StyFeature *feature = &sites->features[k];
      const double value = (double)sites->values[3 * s + (size_t)k] / (double)feature->weight;
      const double least = strncmp(feature->channel, "normal.", 7) == 0 ? -1 : 0;
      inside = inside && value >= least - 1e-3 && value <= 1 + 1e-3;
    }
    outside += !inside;
  }
  if (outside)
    warn(&arguments->options,
         "%s: found %.1f %% of the pixels outside the table, expected channels from 0 to 1 (normal.*: -1 to 1)",
         clean_text(arguments->guide), 100 * (double)outside / (double)sites->count);
}

static StyStatus collect(const Arguments *arguments, const StyImage *guide, StySites **out, StyError *error) {
  if (!arguments->feature_count) return sty_collect_sites(arguments->guide, guide, out, error);
  StySites *sites = NULL;
  const StyStatus status =
      sty_collect_features(arguments->guide, guide, arguments->features, arguments->feature_count, &sites, error);
  if (status) return status;
  if (sites->dims == 3) {
    warn_about_axes(arguments, sites);
    *out = sites;
    return STY_OK;
  }
  char channels[STY_FEATURES_SIZE];
  sty_write_features(sites->features, sites->dims, channels);
  sty_fail(error, STY_ERROR_USAGE, "--channels: found %d (%.200s), expected three", sites->dims, channels);
  sty_destroy_sites(&sites);
  return STY_ERROR_USAGE;
}

static StyStatus resolve(const Arguments *arguments, const Inputs *inputs, StyLut *lut, Account *account,
                         StyError *error) {
  if (arguments->resolve == RESOLVE_NEAREST) return STY_OK;
  const size_t size = sty_count_texels(&lut->spec) * sizeof *lut->errors;
  float *least = malloc(size);
  if (!least) return sty_fail_memory(error, "LUT", (double)size);
  memcpy(least, lut->errors, size);
  const bool serves = arguments->resolve != RESOLVE_COHERENT;
  const StyResolveOptions options = {.slack = arguments->slack * STY_LEVEL,
                                     .coherent = arguments->resolve != RESOLVE_FRAMES,
                                     .guide = inputs->guide,
                                     .frames = serves ? (const StyImage *const *)inputs->frames : NULL,
                                     .frame_count = serves ? arguments->frames.count : 0};
  const StyRun run = begin_progress(&arguments->options, "resolving");
  const StyStatus status = sty_resolve_lut(lut, inputs->sites, &options, &run, error);
  end_progress(&arguments->options);
  if (!status) measure_errors(lut, least, &account->mean_paid, &account->max_paid);
  free(least);
  return status;
}

static StyStatus build(const Arguments *arguments, const Inputs *inputs, const StyLutSpec *spec, StyLut **out,
                       Account *account, StyError *error) {
  const StyEngineOptions *options = &arguments->options.engine_options;
  const StyEngine *engine = arguments->engine;
  const StyRun run = begin_progress(&arguments->options, "searching");
  StyStatus status = arguments->feature_count
                         ? sty_build_cube(inputs->sites, engine, options, arguments->size, &run, out, error)
                         : sty_build_lut(inputs->sites, engine, options, spec, &run, out, error);
  end_progress(&arguments->options);
  if (!status) status = resolve(arguments, inputs, *out, account, error);
  if (status) sty_fail(error, status, "%s: %s", arguments->guide, error->text);
  return status;
}

static StyStatus open_inputs(const Arguments *arguments, Inputs *out, Account *account, StyError *error) {
  const double start = sty_get_milliseconds();
  StyStatus status = read_source(arguments, &out->guide, error);
  if (!status) status = read_frames(&arguments->options, &arguments->frames, out->frames, error);
  const double read = sty_get_milliseconds();
  if (!status) status = collect(arguments, out->guide, &out->sites, error);
  account->times[0] = read - start;
  account->times[1] = sty_get_milliseconds() - read;
  return status;
}

static void close_inputs(Inputs *inputs) {
  sty_destroy_image(&inputs->guide);
  sty_destroy_sites(&inputs->sites);
  destroy_frames(inputs->frames);
}

static StyStatus announce(Arguments *arguments, const StySites *sites) {
  char sides[64], takes[64] = "";
  double texels, bytes;
  measure_cube(arguments, &texels, &bytes);
  if (arguments->feature_count) snprintf(takes, sizeof takes, ": %.0f texels that take %.0f bytes,", texels, bytes);
  return report_dry_run(&arguments->options, "%s texels%s from %zu source pixels with engine %s",
                        name_sides(arguments, sides), takes, sites->count, arguments->engine->name);
}

static StyStatus make_table(Arguments *arguments, const Inputs *inputs, Account *account, StyError *error) {
  StyLutSpec spec = {arguments->size, arguments->size, (StySampling)arguments->sampling,
                     arguments->map == MAP_ANY ? STY_MAP_XY : (StyMap)arguments->map, (StyMetric)arguments->metric};
  StyStatus status = STY_OK;
  if (arguments->size == 0) status = choose_spec(arguments, inputs, &spec, error);
  if (status) return status;
  if (arguments->options.dry_run) return announce(arguments, inputs->sites);
  StyLut *lut = NULL;
  const double start = sty_get_milliseconds();
  status = build(arguments, inputs, &spec, &lut, account, error);
  const double built = sty_get_milliseconds();
  account->times[1] += built - start;
  if (!status) {
    account->points = inputs->sites->count;
    account->unique = lut->unique;
    memcpy(account->axes, lut->axes, sizeof account->axes);
    measure_errors(lut, NULL, &account->mean_error, &account->max_error);
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
      .options.engine_options = sty_default_engine_options, .size = DEFAULT_SIZE, .slack = -1, .encoding = -1};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments);
  return finish_command(&arguments.options, status);
}
