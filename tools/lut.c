/* stylut lut GUIDE */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "lut_arguments.h"
#include "stylut/audit.h"
#include "stylut/image_io.h"

/* Among the candidates of --size auto, so many smaller and larger ones are shown. */
enum { SHOWN = 2 };

typedef struct Account {
  size_t points, unique;
  double mean_error, max_error; /* guide units, feasible texels; of a cube all, weighted */
  double mean_paid, max_paid;   /* the same, for what --resolve put above the least */
  StyFeature axes[3];           /* of a cube */
  StyCandidate candidates[STY_MOST_CANDIDATES];
  int candidate_count, chosen; /* of --size auto; -1: none meets the budget */
  double times[3];             /* read, build, write */
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
static const char *name_sides(const LutArguments *arguments, char out[64]) {
  const int size = arguments->size;
  snprintf(out, 64, arguments->feature_count ? "%dx%dx%d" : "%dx%d", size, size, size);
  return out;
}

static json_t *list_candidates(const Account *account) {
  json_t *list = json_array();
  for (int c = 0; c < account->candidate_count; c++) {
    const StyCandidate *candidate = &account->candidates[c];
    json_array_append_new(
        list, json_pack("{s:s, s:i, s:I, s:f, s:f, s:b}", "map", sty_map_names[candidate->spec.map], "size",
                        candidate->spec.width, "bytes", (json_int_t)candidate->bytes, "lookup_p99",
                        candidate->lookup.p99, "lookup_mean", candidate->lookup.mean, "chosen", c == account->chosen));
  }
  return list;
}

static StyStatus print_report(const LutArguments *arguments, const Account *account, StyError *error) {
  static const char *const stages[] = {"read", "build", "write"};
  if (arguments->options.json) {
    json_t *report =
        json_pack("{s:s, s:s, s:b, s:s, s:i, s:s, s:s, s:s, s:s, s:I, s:I, s:f, s:f, s:f, s:f, s:o, s:f}", "schema",
                  "stylut-lut/1", "engine", arguments->engine->name, "exact",
                  arguments->engine->exact && arguments->resolve == RESOLVE_NEAREST, "resolve",
                  lut_resolve_names[arguments->resolve], "size", arguments->size, "sampling",
                  sty_sampling_names[arguments->sampling], "map", sty_map_names[arguments->map], "metric",
                  sty_metric_names[arguments->metric], "encoding", sty_encoding_names[arguments->encoding], "points",
                  (json_int_t)account->points, "unique", (json_int_t)account->unique, "mean_distance",
                  account->mean_error, "max_distance", account->max_error, "mean_paid", account->mean_paid, "max_paid",
                  account->max_paid, "time_ms", pack_times(stages, account->times, 3), "peak_bytes", get_peak_bytes());
    if (arguments->feature_count) pack_features(report, account->axes, 3);
    if (account->candidate_count) json_object_set_new(report, "candidates", list_candidates(account));
    return print_json(report, error);
  }
  if (arguments->options.quiet) return STY_OK;
  char texels[64];
  char distinct[64] = "";
  if (account->unique) snprintf(distinct, sizeof distinct, ", %zu distinct values", account->unique);
  printf("%s: %s texels from %zu source pixels%s\n", clean_text(arguments->options.output),
         name_sides(arguments, texels), account->points, distinct);
  if (arguments->feature_count)
    printf("engine %s; weighted distance to the value chosen: mean %.5f, max %.5f\n", arguments->engine->name,
           account->mean_error, account->max_error);
  else
    printf("engine %s; distance to the value chosen, in 8-bit levels: mean %.3f, max %.3f\n", arguments->engine->name,
           account->mean_error / STY_LEVEL, account->max_error / STY_LEVEL);
  if (arguments->resolve != RESOLVE_NEAREST)
    printf("resolve %s; of the slack of %g levels it paid: mean %.3f, max %.3f\n",
           lut_resolve_names[arguments->resolve], arguments->slack, account->mean_paid / STY_LEVEL,
           account->max_paid / STY_LEVEL);
  printf("read %.1f ms, build %.1f ms, write %.1f ms; peak memory %.0f MB\n", account->times[0], account->times[1],
         account->times[2], get_peak_bytes() / 1e6);
  return STY_OK;
}

static StyStatus write_lut(const LutArguments *arguments, const StyLut *lut, StyError *error) {
  const char *inputs[1 + MOST_FRAMES] = {arguments->guide};
  const int count = append_frames(&arguments->frames, inputs, 1);
  StyImage *image = NULL;
  if (arguments->encoding == STY_ENCODE_RG8 && (lut->source_width > 256 || lut->source_height > 256))
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

/* Of --size auto: what was chosen, or came nearest, and what its neighbours would cost and buy. */
static void show_candidates(const Account *account, int marked) {
  for (int c = 0; c < account->candidate_count; c++) {
    const StyCandidate *candidate = &account->candidates[c];
    if (c < marked - SHOWN || c > marked + SHOWN) continue;
    char bytes[32];
    printf("%s %-10s %4d: %9s, lookup p99 %.3f, mean %.3f degrees\n", c == marked ? "*" : " ",
           sty_map_names[candidate->spec.map], candidate->spec.width, name_bytes(candidate->bytes, bytes),
           candidate->lookup.p99, candidate->lookup.mean);
  }
}

/* The budget is out of reach: says what comes nearest. */
static StyStatus fail_budget(const LutArguments *arguments, const Account *account, StyError *error) {
  int best = 0;
  for (int c = 1; c < account->candidate_count; c++)
    if (account->candidates[c].lookup.p99 < account->candidates[best].lookup.p99) best = c;
  const StyCandidate *candidate = &account->candidates[best];
  if (!arguments->options.quiet && !arguments->options.json) show_candidates(account, best);
  StyStatus status = STY_OK;
  if (arguments->options.json)
    status = print_json(
        json_pack("{s:s, s:n, s:o}", "schema", "stylut-lut/1", "size", "candidates", list_candidates(account)), error);
  return status ? status
                : sty_fail(error, STY_CHECK_FAILED,
                           "--max-p99: found %.4g degrees at best (%s, size %d), expected at most %.4g",
                           candidate->lookup.p99, sty_map_names[candidate->spec.map], candidate->spec.width,
                           arguments->max_p99);
}

static StyStatus choose_spec(LutArguments *arguments, const Inputs *inputs, StyLutSpec *spec, Account *account,
                             StyError *error) {
  const StyAuditOptions options = {.weights = arguments->frames.count ? STY_WEIGHT_FRAMES : STY_WEIGHT_DISC,
                                   .frames = (const StyImage *const *)inputs->frames,
                                   .frame_count = arguments->frames.count};
  const StyRun run = begin_progress(&arguments->options, "choosing");
  const StyStatus status =
      sty_choose_size(inputs->sites, inputs->guide, spec, arguments->map == MAP_ANY, (StyEncoding)arguments->encoding,
                      &options, &(StyBudget){.p99 = arguments->max_p99}, &run, account->candidates,
                      &account->candidate_count, &account->chosen, error);
  end_progress(&arguments->options);
  if (status) return status;
  if (account->chosen < 0) return fail_budget(arguments, account, error);
  if (!arguments->options.quiet && !arguments->options.json) show_candidates(account, account->chosen);
  *spec = account->candidates[account->chosen].spec;
  arguments->size = spec->width;
  arguments->map = (int)spec->map;
  return STY_OK;
}

static StyStatus read_source(const LutArguments *arguments, StyImage **out, StyError *error) {
  return arguments->feature_count ? read_features(&arguments->options, arguments->guide, arguments->features,
                                                  arguments->feature_count, out, error)
                                  : read_guide(&arguments->options, arguments->guide, out, error);
}

/* What lies beyond the axes of a cube (see lut.h) can't be looked up. */
static void warn_about_axes(const LutArguments *arguments, const StySites *sites) {
  size_t outside = 0;
  for (size_t s = 0; s < sites->count; s++) {
    bool inside = true;
    for (int k = 0; k < 3; k++) {
      const StyFeature *feature = &sites->features[k];
      const double value = (double)sites->values[3 * s + (size_t)k] / (double)feature->weight;
      const double least = (double)sty_get_axis_start(feature->channel);
      inside = inside && value >= least - 1e-3 && value <= 1 + 1e-3;
    }
    outside += !inside;
  }
  if (outside)
    warn(&arguments->options,
         "%s: found %.1f %% of the pixels outside the table, expected channels from 0 to 1 (normal.*: -1 to 1)",
         clean_text(arguments->guide), 100 * (double)outside / (double)sites->count);
}

static StyStatus collect(const LutArguments *arguments, const StyImage *guide, StySites **out, StyError *error) {
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

static StyStatus resolve(const LutArguments *arguments, const Inputs *inputs, StyLut *lut, Account *account,
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

static StyStatus build(const LutArguments *arguments, const Inputs *inputs, const StyLutSpec *spec, StyLut **out,
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

static StyStatus open_inputs(const LutArguments *arguments, Inputs *out, Account *account, StyError *error) {
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

static StyStatus announce(LutArguments *arguments, const StySites *sites) {
  char sides[64], takes[64] = "";
  double texels, bytes;
  measure_cube(arguments, &texels, &bytes);
  if (arguments->feature_count) snprintf(takes, sizeof takes, ": %.0f texels that take %.0f bytes,", texels, bytes);
  return report_dry_run(&arguments->options, "%s texels%s from %zu source pixels with engine %s",
                        name_sides(arguments, sides), takes, sites->count, arguments->engine->name);
}

static StyStatus make_table(LutArguments *arguments, const Inputs *inputs, Account *account, StyError *error) {
  StyLutSpec spec = {arguments->size, arguments->size, (StySampling)arguments->sampling,
                     arguments->map == MAP_ANY ? STY_MAP_XY : (StyMap)arguments->map, (StyMetric)arguments->metric};
  StyStatus status = STY_OK;
  if (arguments->size == 0) status = choose_spec(arguments, inputs, &spec, account, error);
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

static StyStatus run(LutArguments *arguments) {
  StyError *error = &arguments->options.error;
  Account account = {0};
  Inputs inputs = {0};
  StyStatus status = open_inputs(arguments, &inputs, &account, error);
  if (!status) status = make_table(arguments, &inputs, &account, error);
  close_inputs(&inputs);
  return status;
}

StyStatus run_lut(int argc, char **argv) {
  LutArguments arguments;
  StyStatus status = parse_lut_arguments(argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments);
  return finish_command(&arguments.options, status);
}
