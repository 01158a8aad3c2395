/* stylut chart GUIDE -o chart.svg --csv chart.csv */
#include "stylut/chart.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "commands.h"
#include "inputs.h"
#include "machine.h"
#include "options.h"
#include "plot.h"
#include "stylut/file.h"
#include "stylut/parse.h"

enum { MOST_ENGINES = 16, MOST_REPEATS = 99 };

typedef struct Arguments {
  Options options;
  const char *guide, *csv;
  PlotFormat format;
  int sizes[STY_MOST_CHART_SIZES];
  int size_count;
  const StyEngine *engines[MOST_ENGINES];
  int engine_count;
  int repeats;
  Frames frames;
} Arguments;

enum { KEY_CSV = 0x200, KEY_REPEATS, KEY_FRAMES };

static const struct argp_option options_table[] = {
    {"csv", KEY_CSV, "FILE.csv", 0, "write all figures as a table; needs no gnuplot", 0},
    {"sizes", 's', "N,N...", 0, "texels a side of the tables (default: 64,128,256,512)", 0},
    {"engines", 'e', "NAME,...", 0, "engines whose time is taken (default: all)", 0},
    {"repeats", KEY_REPEATS, "N", 0, "builds that a time is the median of (default: 5)", 0},
    {"frames", KEY_FRAMES, "FILE...", 0, "guides of real frames, whose lookups count (default: every place alike)", 0},
    {0},
};

/* ---- arguments ------------------------------------------------------------------- */

/* Calls take(context, word, error) for each word between commas. */
static StyStatus split_list(const char *text, StyStatus (*take)(void *context, const char *word, StyError *error),
                            void *context, StyError *error) {
  StyStatus status = STY_OK;
  for (const char *at = text; !status; at++) {
    const size_t length = strcspn(at, ",");
    char *word = strndup(at, length);
    if (!word) return sty_fail_memory(error, "list", (double)length);
    status = take(context, word, error);
    free(word);
    at += length;
    if (!*at) break;
  }
  return status;
}

static StyStatus take_size(void *context, const char *word, StyError *error) {
  Arguments *arguments = context;
  long long number = 0;
  const StyStatus status = sty_parse_integer("--sizes", word, 1, STY_MAX_LUT_SIZE, &number, error);
  if (status) return status;
  int place = arguments->size_count;
  while (place > 0 && arguments->sizes[place - 1] > (int)number) place--;
  if (place > 0 && arguments->sizes[place - 1] == (int)number)
    return sty_fail(error, STY_ERROR_USAGE, "--sizes: found %d twice, expected each size once", (int)number);
  if (arguments->size_count == STY_MOST_CHART_SIZES)
    return sty_fail(error, STY_ERROR_USAGE, "--sizes: found more than %d, expected at most that", STY_MOST_CHART_SIZES);
  memmove(arguments->sizes + place + 1, arguments->sizes + place,
          (size_t)(arguments->size_count - place) * sizeof *arguments->sizes);
  arguments->sizes[place] = (int)number;
  arguments->size_count++;
  return STY_OK;
}

static StyStatus take_engine(void *context, const char *word, StyError *error) {
  Arguments *arguments = context;
  const StyEngine *engine = NULL;
  const StyStatus status = sty_find_engine("--engines", word, &engine, error);
  if (status) return status;
  for (int e = 0; e < arguments->engine_count; e++)
    if (arguments->engines[e] == engine)
      return sty_fail(error, STY_ERROR_USAGE, "--engines: found %s twice, expected each engine once", engine->name);
  arguments->engines[arguments->engine_count++] = engine;
  return STY_OK;
}

static StyStatus set_defaults(Arguments *arguments, StyError *error) {
  StyStatus status = STY_OK;
  if (!arguments->size_count) status = split_list("64,128,256,512", take_size, arguments, error);
  if (!arguments->engine_count)
    for (int e = 0; !status && sty_engines[e].name && e < MOST_ENGINES; e++)
      status = take_engine(arguments, sty_engines[e].name, error);
  return status;
}

static StyStatus check_ending(const char *option, const char *path, const char *const *endings, int *choice,
                              StyError *error) {
  const char *dot = strrchr(path, '.');
  for (int e = 0; endings[e]; e++)
    if (dot && strcasecmp(dot, endings[e]) == 0) {
      *choice = e;
      return STY_OK;
    }
  return sty_fail(error, STY_ERROR_USAGE, "option '%s': found %s, expected a name ending in %s%s%s", option, path,
                  endings[0], endings[1] ? " or " : "", endings[1] ? endings[1] : "");
}

static StyStatus check_outputs(Arguments *arguments) {
  static const char *const pictures[] = {".svg", ".png", NULL}, *const tables[] = {".csv", NULL};
  Options *options = &arguments->options;
  const char *const outputs[] = {options->output, arguments->csv};
  StyError *error = &options->error;
  StyStatus status = STY_OK;
  int choice = 0;
  if (!options->output && !arguments->csv)
    return sty_fail(error, STY_ERROR_USAGE, "option '--output': found none, expected -o FILE or --csv FILE");
  if (arguments->csv) status = check_ending("--csv", arguments->csv, tables, &choice, error);
  if (!status && options->output) status = check_ending("--output", options->output, pictures, &choice, error);
  arguments->format = (PlotFormat)choice;
  const char *inputs[1 + MOST_FRAMES] = {arguments->guide};
  const int count = append_frames(&arguments->frames, inputs, 1);
  for (int i = 0; !status && i < 2; i++) {
    status = protect_inputs(options, outputs[i], inputs, count);
    if (!status && outputs[i]) status = require_folder(options, outputs[i]);
  }
  return status;
}

static StyStatus check_arguments(Arguments *arguments) {
  StyStatus status = require_argument(&arguments->options, arguments->guide, "the guide's file name");
  if (!status) status = set_defaults(arguments, &arguments->options.error);
  return status ? status : check_outputs(arguments);
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  StyError *error = &arguments->options.error;
  long long number = 0;
  StyStatus status = STY_OK;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG:
      status = take_argument_or_frame(&arguments->options, &arguments->guide, &arguments->frames, text);
      break;
    case ARGP_KEY_END: status = check_arguments(arguments); break;
    case KEY_CSV: arguments->csv = text; break;
    case 's':
      arguments->size_count = 0;
      status = split_list(text, take_size, arguments, error);
      break;
    case 'e':
      arguments->engine_count = 0;
      status = split_list(text, take_engine, arguments, error);
      break;
    case KEY_REPEATS:
      status = sty_parse_integer("--repeats", text, 1, MOST_REPEATS, &number, error);
      arguments->repeats = (int)number;
      break;
    case KEY_FRAMES: status = add_frame(&arguments->frames, text, error); break;
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
        "Draws what tables of a guide cost and what they are worth: time against the p99 of the lookup error over "
        "engines and sizes, bytes against it over maps, metrics, encodings and sizes.\v"
        "-o takes .svg or .png and needs gnuplot. The Pareto front is what nothing else beats: less error always "
        "costs more there.\n\nTimes are of building alone, on one thread unless -j says more, the median of runs that "
        "take turns. What takes seconds is run less often, or, for brute, left out; engines that can't serve the "
        "guide are left out, and the report says so.",
    .children = children,
};

/* ---- figures ----------------------------------------------------------------------- */

static const char *const panel_names[STY_PANELS] = {"time", "bytes"};

/* Names in text that others read: valid UTF-8 without control characters. */
static json_t *make_plain_text(const char *name) { return make_json_text(clean_text(name)); }

/* In quotes, as RFC 4180 has it. */
static void write_quoted(FILE *stream, const char *text) {
  fputc('"', stream);
  for (const char *c = text; *c; c++) {
    if (*c == '"') fputc('"', stream);
    fputc(*c, stream);
  }
  fputc('"', stream);
}

static void write_row(FILE *stream, const char *guide, const StyChartPoint *point) {
  static const char *const flags[] = {"", "0", "1"};
  char parameters[STY_PARAMETERS_SIZE];
  write_quoted(stream, guide);
  fprintf(stream, ",%s,%s,%s,%s,%d,%s,%zu,%.3f,%d,%.6f,%.6f,%.6f,%s,%s\n", point->engine->name,
          sty_format_parameters(point->engine, &point->parameters, parameters), sty_metric_names[point->spec.metric],
          sty_map_names[point->spec.map], point->spec.width, sty_encoding_names[point->encoding], point->bytes,
          point->milliseconds, point->runs, point->lookup.mean, point->lookup.p99, point->lookup.max,
          flags[point->places[STY_PANEL_TIME]], flags[point->places[STY_PANEL_BYTES]]);
}

/* What pictures and tables say of their making, one printable line; the caller
 * frees it. NULL in *out: they are to say nothing. */
static StyStatus describe_making(const Arguments *arguments, char **out, StyError *error) {
  const Frames *frames = &arguments->frames;
  *out = NULL;
  if (arguments->options.no_history) return STY_OK;
  json_t *line = get_command_line(&arguments->options, "chart");
  json_t *plain = line ? make_plain_text(json_string_value(line)) : NULL;
  char hash[STY_HASH_SIZE], *text = NULL;
  StyStatus status = plain ? sty_hash_file(arguments->guide, hash, error) : sty_fail_memory(error, "history", 0);
  if (!status &&
      asprintf(&text, "%s; version " STY_VERSION "; guide of SHA-256 %s", json_string_value(plain), hash) < 0)
    status = sty_fail_memory(error, "history", 0);
  for (int f = 0; !status && f < frames->count; f++) {
    char *longer = NULL;
    status = sty_hash_file(frames->files[f], hash, error);
    if (!status && asprintf(&longer, "%s%s %s", text, f ? "" : "; frames of", hash) < 0)
      status = sty_fail_memory(error, "history", 0);
    if (status) break;
    free(text);
    text = longer;
  }
  json_decref(line);
  json_decref(plain);
  if (status)
    free(text);
  else
    *out = text;
  return status;
}

static StyStatus write_table(const Arguments *arguments, const char *making, const StyChart *chart, FILE *stream,
                             StyError *error) {
  char machine[MACHINE_SIZE];
  json_t *guide = make_plain_text(arguments->guide);
  if (!guide) return sty_fail_memory(error, "chart", 0);
  fprintf(stream, "# %s\n", format_machine(machine));
  if (making) fprintf(stream, "# %s\n", making);
  fprintf(stream,
          "guide,engine,parameters,metric,map,size,encoding,bytes,time_ms,runs,lookup_mean,lookup_p99,lookup_max,"
          "pareto_time,pareto_bytes\n");
  for (int p = 0; p < chart->count; p++) write_row(stream, json_string_value(guide), &chart->points[p]);
  json_decref(guide);
  return STY_OK;
}

/* ---- files ------------------------------------------------------------------------- */

static StyStatus draw_picture(const Arguments *arguments, const char *making, const StyImage *guide,
                              const StyChart *chart, FILE *stream, StyError *error) {
  json_t *name = make_plain_text(sty_get_base_name(arguments->guide));
  char *title = NULL;
  if (!name || asprintf(&title, "%s: %d x %d pixels, %s%s; numbers are texels a side", json_string_value(name),
                        guide->width, guide->height,
                        guide->bits == 32   ? "float"
                        : guide->bits == 16 ? "16 bit"
                                            : "8 bit",
                        arguments->frames.count ? ", as frames ask" : "") < 0)
    title = NULL;
  json_decref(name);
  if (!title) return sty_fail_memory(error, "chart", 0);
  const Plot plot = {title, making, chart, arguments->options.threads, arguments->format};
  const StyStatus status = draw_plot(&plot, stream, error);
  free(title);
  return status;
}

/* Neither appears before both are written whole. */
static StyStatus write_files(const Arguments *arguments, const StyImage *guide, const StyChart *chart,
                             StyError *error) {
  StyOutput picture = {NULL, NULL, NULL}, table = {NULL, NULL, NULL};
  char *making = NULL;
  StyStatus status = describe_making(arguments, &making, error);
  if (!status && arguments->options.output) status = sty_open_output(arguments->options.output, &picture, error);
  if (!status && arguments->csv) status = sty_open_output(arguments->csv, &table, error);
  if (!status && picture.stream) status = draw_picture(arguments, making, guide, chart, picture.stream, error);
  if (!status && table.stream) status = write_table(arguments, making, chart, table.stream, error);
  if (!status && table.stream) status = sty_flush_output(&table, error);
  if (!status && picture.stream) status = sty_commit_output(&picture, error);
  if (!status && table.stream) status = sty_commit_output(&table, error);
  sty_discard_output(&picture);
  sty_discard_output(&table);
  free(making);
  return status;
}

/* ---- reports ------------------------------------------------------------------------- */

static json_t *pack_place(StyChartPlace place) {
  return place == STY_PLACE_NONE ? json_null() : json_boolean(place == STY_PLACE_FRONT);
}

static json_t *pack_point(const StyChartPoint *point) {
  char parameters[STY_PARAMETERS_SIZE];
  return json_pack("{s:s, s:b, s:s, s:s, s:s, s:i, s:s, s:I, s:f, s:i, s:{s:f, s:f, s:f}, s:{s:o, s:o}}", "engine",
                   point->engine->name, "exact", point->engine->exact, "parameters",
                   sty_format_parameters(point->engine, &point->parameters, parameters), "metric",
                   sty_metric_names[point->spec.metric], "map", sty_map_names[point->spec.map], "size",
                   point->spec.width, "encoding", sty_encoding_names[point->encoding], "bytes",
                   (json_int_t)point->bytes, "time_ms", point->milliseconds, "runs", point->runs, "lookup", "mean",
                   point->lookup.mean, "p99", point->lookup.p99, "max", point->lookup.max, "pareto",
                   panel_names[STY_PANEL_TIME], pack_place(point->places[STY_PANEL_TIME]), panel_names[STY_PANEL_BYTES],
                   pack_place(point->places[STY_PANEL_BYTES]));
}

static StyStatus print_as_json(const Arguments *arguments, const StyChart *chart, StyError *error) {
  char machine[MACHINE_SIZE];
  json_t *points = json_array(), *omissions = json_array();
  for (int p = 0; p < chart->count; p++) json_array_append_new(points, pack_point(&chart->points[p]));
  for (int i = 0; i < chart->omission_count; i++)
    json_array_append_new(omissions,
                          json_pack("{s:s, s:i, s:o}", "engine", chart->omissions[i].engine->name, "size",
                                    chart->omissions[i].size, "reason", make_json_text(chart->omissions[i].reason)));
  return print_json(json_pack("{s:s, s:o, s:s, s:i, s:s, s:o, s:o}", "schema", "stylut-chart/1", "guide",
                              make_json_text(arguments->guide), "machine", format_machine(machine), "threads",
                              arguments->options.threads, "weights",
                              sty_weights_names[arguments->frames.count ? STY_WEIGHT_FRAMES : STY_WEIGHT_DISC],
                              "points", points, "left_out", omissions),
                    error);
}

static void print_front(const StyChart *chart, StyChartPanel panel) {
  for (int p = 0; p < chart->count; p++) {
    const StyChartPoint *point = &chart->points[p];
    char parameters[STY_PARAMETERS_SIZE], series[128];
    if (point->places[panel] != STY_PLACE_FRONT) continue;
    if (panel == STY_PANEL_TIME)
      snprintf(series, sizeof series, "%s %s", point->engine->name,
               sty_format_parameters(point->engine, &point->parameters, parameters));
    else
      snprintf(series, sizeof series, "%s, %s, %s", sty_map_names[point->spec.map],
               sty_metric_names[point->spec.metric], sty_encoding_names[point->encoding]);
    printf("%-5s  %-26s %4d: %9.3f ms, %8.1f kB, lookup p99 %.3f, mean %.3f degrees\n", panel_names[panel], series,
           point->spec.width, point->milliseconds, (double)point->bytes / 1e3, point->lookup.p99, point->lookup.mean);
  }
}

static void print_as_text(const Arguments *arguments, const StyChart *chart) {
  printf("%s: %d points; of these nothing beats\n", clean_text(arguments->guide), chart->count);
  for (int panel = 0; panel < STY_PANELS; panel++) print_front(chart, (StyChartPanel)panel);
  for (int i = 0; i < chart->omission_count; i++)
    printf("left out: %s from size %d on: %s\n", chart->omissions[i].engine->name, chart->omissions[i].size,
           chart->omissions[i].reason);
}

/* ---- the command --------------------------------------------------------------------- */

typedef struct Subject {
  StyImage *guide;
  StySites *sites;
  StyImage *frames[MOST_FRAMES];
} Subject;

static StyStatus open_subject(const Arguments *arguments, Subject *out, StyError *error) {
  StyStatus status = read_guide(&arguments->options, arguments->guide, &out->guide, error);
  if (!status) status = sty_collect_sites(arguments->guide, out->guide, &out->sites, error);
  if (!status) status = read_frames(&arguments->options, &arguments->frames, out->frames, error);
  return status;
}

static void close_subject(Subject *subject) {
  sty_destroy_image(&subject->guide);
  sty_destroy_sites(&subject->sites);
  destroy_frames(subject->frames);
}

static StyStatus measure(const Arguments *arguments, const Subject *subject, StyChart *out, StyError *error) {
  const StyAuditOptions audit = {.weights = arguments->frames.count ? STY_WEIGHT_FRAMES : STY_WEIGHT_DISC,
                                 .frames = (const StyImage *const *)subject->frames,
                                 .frame_count = arguments->frames.count};
  const StyChartOptions options = {.sizes = arguments->sizes,
                                   .size_count = arguments->size_count,
                                   .engines = arguments->engines,
                                   .engine_count = arguments->engine_count,
                                   .repeats = arguments->repeats,
                                   .audit = &audit};
  const StyRun run = begin_progress(&arguments->options, "measuring");
  const StyStatus status = sty_measure_chart(subject->sites, subject->guide, &options, &run, out, error);
  end_progress(&arguments->options);
  return status ? sty_fail(error, status, "%s: %s", arguments->guide, error->text) : STY_OK;
}

static StyStatus measure_and_write(const Arguments *arguments, const Subject *subject, StyError *error) {
  StyChart chart = {0};
  StyStatus status = measure(arguments, subject, &chart, error);
  if (!status) status = write_files(arguments, subject->guide, &chart, error);
  if (!status && arguments->options.json)
    status = print_as_json(arguments, &chart, error);
  else if (!status && !arguments->options.quiet)
    print_as_text(arguments, &chart);
  sty_free_chart(&chart);
  return status;
}

static StyStatus report_plan(Arguments *arguments, size_t pixels) {
  Options *options = &arguments->options;
  const bool both = options->output && arguments->csv;
  if (!options->output) options->output = arguments->csv;
  return report_dry_run(options, "engines: %d, sizes: %d; from %zu source pixels%s%s", arguments->engine_count,
                        arguments->size_count, pixels, both ? "; figures to " : "", both ? arguments->csv : "");
}

static StyStatus run(Arguments *arguments) {
  Options *options = &arguments->options;
  Subject subject = {0};
  StyStatus status = options->output ? find_gnuplot(&options->error) : STY_OK;
  if (!status) status = open_subject(arguments, &subject, &options->error);
  if (!status && options->dry_run)
    status = report_plan(arguments, subject.sites->count);
  else if (!status)
    status = measure_and_write(arguments, &subject, &options->error);
  close_subject(&subject);
  return status;
}

StyStatus run_chart(int argc, char **argv) {
  Arguments arguments = {.options = {.threads = 1}, .repeats = 5};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments);
  return finish_command(&arguments.options, status);
}
