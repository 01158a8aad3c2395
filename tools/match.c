/* stylut match SOURCE TARGET: a nearest-neighbour field, pixel by pixel. */
#include "stylut/match.h"

#include <stdio.h>
#include <string.h>

#include "commands.h"
#include "inputs.h"
#include "options.h"
#include "stylut/image_io.h"

typedef struct Arguments {
  Options options;
  const char *files[2]; /* source, target */
  StyFeature features[STY_MOST_DIMS];
  int feature_count;
  StyImageFormat format;
} Arguments;

enum { SOURCE, TARGET };

static const struct argp_option options_table[] = {
    {"channels", 'c', "LIST", 0,
     "what is compared: channels of both guides, or groups of them, as in normal,luma.Y:0.5; a number after a colon "
     "weighs a channel's differences (default: normal.X,normal.Y)",
     0},
    {0},
};

static StyStatus take_file(Arguments *arguments, const char *text) {
  return take_argument(&arguments->options, &arguments->files[arguments->files[SOURCE] ? TARGET : SOURCE], text);
}

static StyStatus check_arguments(Arguments *arguments) {
  Options *options = &arguments->options;
  StyStatus status = require_argument(options, arguments->files[SOURCE], "the source's and the target's guide");
  if (!status) status = require_argument(options, arguments->files[TARGET], "the target's guide after the source's");
  if (!status) status = require_output(options);
  if (!status) status = protect_inputs(options, options->output, arguments->files, 2);
  if (!status) status = sty_get_image_format(options->output, &arguments->format, &options->error);
  if (!status && !arguments->feature_count)
    status = sty_parse_features("--channels", "normal.X,normal.Y", arguments->features, &arguments->feature_count,
                                &options->error);
  return status;
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  StyStatus status = STY_OK;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: status = take_file(arguments, text); break;
    case ARGP_KEY_END: status = check_arguments(arguments); break;
    case 'c':
      status = sty_parse_features("--channels", text, arguments->features, &arguments->feature_count,
                                  &arguments->options.error);
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
    .args_doc = "SOURCE TARGET",
    .doc =
        "Finds, for every covered pixel of the guide TARGET, the pixel of the guide SOURCE whose channels are nearest: "
        "for any number of channels, where a table takes two or three.\v"
        "A .exr holds u, v, error and A; a .png holds 16 bit, R = source x, G = source y, A = matched. A name without "
        "a dot stands for all channels of that layer. All exact engines give the same bytes.",
    .children = children,
};

typedef struct Account {
  const StyEngine *engine;
  StySites *sites;
  size_t matched, unique;
  double mean_error, max_error;
  double times[3]; /* read, search, write */
} Account;

static void measure_errors(const StyField *field, Account *account) {
  double sum = 0;
  for (size_t i = 0; i < (size_t)field->width * (size_t)field->height; i++) {
    const double distance = (double)field->errors[i];
    sum += distance; /* 0 where nothing is matched */
    if (distance > account->max_error) account->max_error = distance;
  }
  account->mean_error = field->matched ? sum / (double)field->matched : 0;
  account->matched = field->matched;
  account->unique = field->unique;
}

static StyStatus print_report(const Arguments *arguments, const Account *account, StyError *error) {
  static const char *const stages[] = {"read", "search", "write"};
  const StySites *sites = account->sites;
  if (!account->matched)
    warn(&arguments->options, "%s: found no covered pixel, expected a frame that shows something",
         clean_text(arguments->files[TARGET]));
  if (arguments->options.json) {
    json_t *report =
        json_pack("{s:s, s:s, s:b, s:I, s:I, s:I, s:f, s:f, s:o, s:f}", "schema", "stylut-match/1", "engine",
                  account->engine->name, "exact", account->engine->exact, "pixels", (json_int_t)account->matched,
                  "points", (json_int_t)sites->count, "distinct", (json_int_t)account->unique, "mean_distance",
                  account->mean_error, "max_distance", account->max_error, "time_ms",
                  pack_times(stages, account->times, 3), "peak_bytes", get_peak_bytes());
    pack_features(report, sites->features, sites->dims);
    return print_json(report, error);
  }
  if (arguments->options.quiet) return STY_OK;
  char channels[STY_FEATURES_SIZE];
  sty_write_features(sites->features, sites->dims, channels);
  char distinct[64] = "";
  if (account->unique) snprintf(distinct, sizeof distinct, ", %zu distinct values", account->unique);
  printf("%s: %zu pixels matched with %zu source pixels%s, by %s\n", clean_text(arguments->options.output),
         account->matched, sites->count, distinct, clean_text(channels));
  printf("engine %s, %s; distance to the value found: mean %.5f, max %.5f\n", account->engine->name,
         account->engine->exact ? "exact" : "approximate", account->mean_error, account->max_error);
  printf("read %.1f ms, search %.1f ms, write %.1f ms; peak memory %.0f MB\n", account->times[0], account->times[1],
         account->times[2], get_peak_bytes() / 1e6);
  return STY_OK;
}

static StyStatus write_field(const Arguments *arguments, const StySites *sites, const StyField *field,
                             StyError *error) {
  StyImage *image = NULL;
  char channels[STY_FEATURES_SIZE];
  sty_write_features(sites->features, sites->dims, channels);
  StyStatus status = sty_encode_field(field, arguments->format == STY_IMAGE_EXR ? 32 : 16, &image, error);
  if (!status) status = sty_set_attribute(image, "stylut:channels", channels, error);
  if (!status) status = add_history(&arguments->options, "match", image, arguments->files, 2, error);
  if (!status) status = sty_write_image(arguments->options.output, image, error);
  sty_destroy_image(&image);
  return status;
}

/* The source's sites, and the target as a picture. */
static StyStatus read_guides(const Arguments *arguments, StySites **sites, StyImage **target, StyError *error) {
  const char *source = arguments->files[SOURCE];
  StyImage *guide = NULL;
  StyStatus status =
      read_features(&arguments->options, source, arguments->features, arguments->feature_count, &guide, error);
  if (!status)
    status = sty_collect_features(source, guide, arguments->features, arguments->feature_count, sites, error);
  sty_destroy_image(&guide);
  if (!status)
    status =
        read_features(&arguments->options, arguments->files[TARGET], (*sites)->features, (*sites)->dims, target, error);
  return status;
}

static StyStatus match(Arguments *arguments, const StyImage *target, Account *account, StyError *error) {
  const StyRun job = begin_progress(&arguments->options, "searching");
  StyField *field = NULL;
  const double start = sty_get_milliseconds();
  StyStatus status = sty_match_guide(account->sites, account->engine, &arguments->options.engine_options,
                                     arguments->files[TARGET], target, &job, &field, error);
  const double searched = sty_get_milliseconds();
  end_progress(&arguments->options);
  if (status) return status;
  measure_errors(field, account);
  status = write_field(arguments, account->sites, field, error);
  sty_destroy_field(&field);
  account->times[1] = searched - start;
  account->times[2] = sty_get_milliseconds() - searched;
  return status ? status : print_report(arguments, account, error);
}

static StyStatus run(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  Account account = {0};
  StyImage *target = NULL;
  const double start = sty_get_milliseconds();
  StyStatus status = read_guides(arguments, &account.sites, &target, error);
  account.times[0] = sty_get_milliseconds() - start;
  if (!status) {
    status = choose_engine(&arguments->options, STY_TASK_CUBE_OR_FIELD, account.sites->dims, &account.engine);
  }
  if (!status) {
    status = arguments->options.dry_run
                 ? report_dry_run(&arguments->options, "%dx%d pixels by %d channels with engine %s", target->width,
                                  target->height, account.sites->dims, account.engine->name)
                 : match(arguments, target, &account, error);
  }
  sty_destroy_image(&target);
  sty_destroy_sites(&account.sites);
  return status;
}

StyStatus run_match(int argc, char **argv) {
  Arguments arguments = {.options.engine_options = sty_default_engine_options};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments);
  return finish_command(&arguments.options, status);
}
