/* stylut guide strokes IMAGE: multiscale colour, luminance, orientation and detail. */
#include "stylut/strokes.h"

#include <stdio.h>
#include <string.h>

#include "commands.h"
#include "options.h"
#include "stylut/image_io.h"
#include "stylut/parse.h"

typedef struct Arguments {
  Options options;
  const char *picture;
  StyStrokeOptions strokes;
  bool all_levels;
} Arguments;

enum { KEY_LEVEL = 0x200, KEY_LEVELS, KEY_UPSAMPLE, KEY_SPACE, KEY_LAYER, KEY_THRESHOLD };

static const struct argp_option options_table[] = {
    {"channels", 'c', "LIST", 0,
     "comma-separated: color, luma, orientation, detail, line, or all (default: all but line); A, the coverage, is "
     "always there",
     0},
    {"level", KEY_LEVEL, "M", 0,
     "one level, at the picture's size: each of its pixels is the mean of 2^M x 2^M of the picture's (default: 0)", 0},
    {"levels", KEY_LEVELS, "N|all", 0, "the first N levels, with their number in the channels' names: color.2.R", 0},
    {"upsample", KEY_UPSAMPLE, "nearest|linear", 0,
     "how a coarse level comes to the picture's size: its values as they are, or blended between its pixels (default: "
     "nearest)",
     0},
    {"space", KEY_SPACE, "linear|srgb", 0,
     "what means and gradients are taken of; 8- and 16-bit pictures hold sRGB, float ones are linear (default: linear)",
     0},
    {"layer", KEY_LAYER, "NAME", 0, "read NAME.R .G .B or NAME.Y instead of R G B or Y", 0},
    {"threshold", KEY_THRESHOLD, "D", 0, "least detail that has an orientation, 0 to 1 (default: 1e-6)", 0},
    {0},
};

static StyStatus parse_groups(Arguments *arguments, const char *text) {
  static const char *const names[] = {"color", "luma", "orientation", "detail", "line", "all", NULL};
  arguments->strokes.groups = 0;
  for (const char *at = text;; at++) {
    char word[32];
    int group = 0;
    const size_t length = strcspn(at, ",");
    snprintf(word, sizeof word, "%.*s", (int)(length < sizeof word ? length : sizeof word), at);
    const StyStatus status = sty_parse_choice("--channels", word, names, &group, &arguments->options.error);
    if (status) return status;
    arguments->strokes.groups |= names[group + 1] ? 1u << group : (1u << STY_STROKE_GROUPS) - 1;
    at += length;
    if (!*at) return STY_OK;
  }
}

static StyStatus parse_level(Arguments *arguments, int key, const char *text) {
  const bool several = key == KEY_LEVELS;
  long long number = 0;
  arguments->strokes.numbered = several;
  arguments->all_levels = several && strcmp(text, "all") == 0;
  if (arguments->all_levels) return STY_OK;
  const StyStatus status = sty_parse_integer(several ? "--levels" : "--level", text, several,
                                             several ? STY_MAX_STROKE_LEVELS : STY_MAX_STROKE_LEVELS - 1, &number,
                                             &arguments->options.error);
  if (status) return status;
  arguments->strokes.first = several ? 0 : (int)number;
  arguments->strokes.count = several ? (int)number : 1;
  return STY_OK;
}

static StyStatus check_arguments(Arguments *arguments) {
  Options *options = &arguments->options;
  StyStatus status = require_argument(options, arguments->picture, "a picture");
  if (!status && is_given(options, "level") && is_given(options, "levels"))
    status = sty_fail(&options->error, STY_ERROR_USAGE, "--level: found with --levels, expected one of them");
  if (!status) status = require_output(options);
  if (!status) status = protect_inputs(options, options->output, &arguments->picture, 1);
  return status ? status : require_exr(options);
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  static const char *const samplings[] = {"nearest", "linear", NULL}, *const spaces[] = {"linear", "srgb", NULL};
  Arguments *arguments = state->input;
  StyError *error = &arguments->options.error;
  StyStatus status = STY_OK;
  int choice = 0;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: status = take_argument(&arguments->options, &arguments->picture, text); break;
    case ARGP_KEY_END: status = check_arguments(arguments); break;
    case 'c': status = parse_groups(arguments, text); break;
    case KEY_LEVEL:
    case KEY_LEVELS: status = parse_level(arguments, key, text); break;
    case KEY_UPSAMPLE:
      status = sty_parse_choice("--upsample", text, samplings, &choice, error);
      arguments->strokes.smooth = choice == 1;
      break;
    case KEY_SPACE:
      status = sty_parse_choice("--space", text, spaces, &choice, error);
      arguments->strokes.srgb = choice == 1;
      break;
    case KEY_LAYER: arguments->strokes.layer = text; break;
    case KEY_THRESHOLD:
      status = sty_parse_number("--threshold", text, 0, 1, &arguments->strokes.threshold, error);
      break;
    default: return ARGP_ERR_UNKNOWN;
  }
  return end_option(status);
}

static const struct argp_child children[] = {{&output_argp, 0, NULL, 0}, {&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .options = options_table,
    .parser = parse_option,
    .args_doc = "IMAGE",
    .doc =
        "Measures what a painter looks for in a picture, at any scale: mean colour and luminance, which way the "
        "isolines run, and how much detail there is.\v"
        "color.R .G .B, luma.Y; orientation.X .Y: unit vector along the isoline, +X right, +Y up, lighter on its left; "
        "detail.Y: length of luma's gradient, per pixel of the level; line.X .Y: cosine and sine of twice the "
        "orientation's angle, which has no sign and compares by distance. A pixel of level M is the mean of 2x2 of "
        "level M-1, up to a single pixel. The report has a line per level: pixels without an orientation, and "
        "percentiles of the detail.",
    .children = children,
};

enum { READ, MEASURE, WRITE, STAGES };

typedef struct Account {
  int width, height;
  StyStrokeFigures figures;
  double times[STAGES];
} Account;

static double get_flat_share(const StyStrokeLevel *level) {
  return level->covered ? (double)level->flat / (double)level->covered : 0;
}

static json_t *pack_levels(const StyStrokeFigures *figures) {
  json_t *levels = json_array();
  for (int m = 0; m < figures->count; m++) {
    const StyStrokeLevel *level = &figures->levels[m];
    json_array_append_new(levels, json_pack("{s:i, s:[ii], s:I, s:f, s:{s:f, s:f, s:f, s:f}}", "level", m, "size",
                                            level->width, level->height, "covered", (json_int_t)level->covered,
                                            "without_orientation", get_flat_share(level), "detail", "p50", level->p50,
                                            "p90", level->p90, "p99", level->p99, "max", level->max));
  }
  return levels;
}

/* "level 2", or "levels 0 to 3" */
static const char *format_levels(const StyStrokeOptions *strokes, char out[32]) {
  if (strokes->count == 1)
    snprintf(out, 32, "level %d", strokes->first);
  else
    snprintf(out, 32, "levels %d to %d", strokes->first, strokes->first + strokes->count - 1);
  return out;
}

static StyStatus print_report(const Arguments *arguments, const Account *account, StyError *error) {
  static const char *const stages[] = {"read", "measure", "write"};
  const Options *options = &arguments->options;
  const StyStrokeFigures *figures = &account->figures;
  char levels[32];
  if (!figures->levels[0].covered)
    warn(options, "%s: found no covered pixel, expected a picture that shows something",
         clean_text(arguments->picture));
  if (options->json)
    return print_json(
        json_pack("{s:s, s:[ii], s:s, s:f, s:{s:i, s:i}, s:o, s:o, s:f}", "schema", "stylut-guide-strokes/1", "size",
                  account->width, account->height, "space", arguments->strokes.srgb ? "srgb" : "linear", "threshold",
                  arguments->strokes.threshold, "written", "first", arguments->strokes.first, "last",
                  arguments->strokes.first + arguments->strokes.count - 1, "levels", pack_levels(figures), "time_ms",
                  pack_times(stages, account->times, STAGES), "peak_bytes", get_peak_bytes()),
        error);
  if (options->quiet) return STY_OK;
  printf("%s: %dx%d, %s of %s\n", clean_text(options->output), account->width, account->height,
         format_levels(&arguments->strokes, levels), arguments->strokes.srgb ? "sRGB values" : "scene-linear values");
  printf("level  size         covered  no orientation  detail p50     p90     p99     max\n");
  for (int m = 0; m < figures->count; m++) {
    const StyStrokeLevel *level = &figures->levels[m];
    char size[32];
    snprintf(size, sizeof size, "%dx%d", level->width, level->height);
    printf("%-5d  %-11s %8zu  %12.2f %%  %10.5f %7.5f %7.5f %7.5f\n", m, size, level->covered,
           100 * get_flat_share(level), level->p50, level->p90, level->p99, level->max);
  }
  printf("read %.0f ms, measure %.0f ms, write %.0f ms\n", account->times[READ], account->times[MEASURE],
         account->times[WRITE]);
  return STY_OK;
}

static StyStatus write_guide(const Arguments *arguments, StyImage *guide, StyError *error) {
  const Options *options = &arguments->options;
  StyStatus status = sty_set_attribute(guide, "stylut:space", arguments->strokes.srgb ? "srgb" : "linear", error);
  if (!status) status = add_history(options, "guide strokes", guide, &arguments->picture, 1, error);
  return status ? status : sty_write_image(options->output, guide, error);
}

static StyStatus measure(Arguments *arguments, const StyImage *picture, Account *account, StyError *error) {
  StyImage *guide = NULL;
  const double start = sty_get_milliseconds();
  const StyRun run = begin_progress(&arguments->options, "measuring");
  StyStatus status =
      sty_make_stroke_guide(arguments->picture, picture, &arguments->strokes, &run, &account->figures, &guide, error);
  end_progress(&arguments->options);
  const double measured = sty_get_milliseconds();
  if (!status && !arguments->options.dry_run) status = write_guide(arguments, guide, error);
  sty_destroy_image(&guide);
  account->times[MEASURE] = measured - start;
  account->times[WRITE] = sty_get_milliseconds() - measured;
  return status;
}

static StyStatus run(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  Account account = {0};
  StyImage *picture = NULL;
  const double start = sty_get_milliseconds();
  StyStatus status = sty_read_image(arguments->picture, &picture, error);
  account.times[READ] = sty_get_milliseconds() - start;
  if (!status) {
    account.width = picture->width;
    account.height = picture->height;
    const int levels = sty_count_stroke_levels(picture->width, picture->height);
    if (arguments->all_levels) arguments->strokes.count = levels;
    status = measure(arguments, picture, &account, error);
    if (!status)
      status = arguments->options.dry_run
                   ? report_dry_run(&arguments->options, "%dx%d pixels, %d of %d levels", account.width, account.height,
                                    arguments->strokes.count, levels)
                   : print_report(arguments, &account, error);
  }
  sty_destroy_image(&picture);
  return status;
}

StyStatus run_guide_strokes(int argc, char **argv) {
  Arguments arguments = {
      .strokes = {.groups = STY_STROKES_COLOUR | STY_STROKES_LUMA | STY_STROKES_ORIENTATION | STY_STROKES_DETAIL,
                  .count = 1,
                  .threshold = STY_DEFAULT_STROKE_THRESHOLD}};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments);
  return finish_command(&arguments.options, status);
}
