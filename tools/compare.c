/* stylut compare A B: whether and where two pictures differ. */
#include "stylut/compare.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "commands.h"
#include "options.h"
#include "stylut/image_io.h"
#include "stylut/parse.h"

typedef struct Arguments {
  Options options;
  const char *files[2];
  StyCompareOptions limits;
  double failpercent;
} Arguments;

enum { KEY_FAIL = 0x200, KEY_FAILPERCENT, KEY_HARDFAIL };

static const double largest_limit = 1e39; /* above every finite float */

static const struct argp_option options_table[] = {
    {"fail", KEY_FAIL, "X", 0, "a pixel fails when one of its channels differs by more (default: 0)", 0},
    {"failpercent", KEY_FAILPERCENT, "P", 0, "how many pixels may fail, in percent (default: 0)", 0},
    {"hardfail", KEY_HARDFAIL, "X", 0, "no pixel at all may differ by more (default: infinity)", 0},
    {0},
};

static StyStatus take_file(Arguments *arguments, const char *text) {
  return take_argument(&arguments->options, &arguments->files[arguments->files[0] ? 1 : 0], text);
}

static StyStatus check_arguments(Arguments *arguments) {
  Options *options = &arguments->options;
  StyStatus status = require_argument(options, arguments->files[0], "two pictures");
  if (!status && !arguments->files[1])
    return sty_fail(&options->error, STY_ERROR_USAGE, "found nothing after '%s', expected a second picture",
                    arguments->files[0]);
  if (status || !options->output) return status;
  StyImageFormat format = STY_IMAGE_PNG;
  status = sty_get_image_format(options->output, &format, &options->error);
  if (!status && format != STY_IMAGE_PNG)
    return sty_fail(&options->error, STY_ERROR_USAGE, "option '--output': found %s, expected a heat map in .png",
                    options->output);
  return status ? status : protect_inputs(options, options->output, arguments->files, 2);
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  StyCompareOptions *limits = &arguments->limits;
  StyError *error = &arguments->options.error;
  StyStatus status = STY_OK;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: status = take_file(arguments, text); break;
    case ARGP_KEY_END: status = check_arguments(arguments); break;
    case KEY_FAIL: status = sty_parse_number("--fail", text, 0, largest_limit, &limits->fail, error); break;
    case KEY_FAILPERCENT:
      status = sty_parse_number("--failpercent", text, 0, 100, &arguments->failpercent, error);
      break;
    case KEY_HARDFAIL:
      status = sty_parse_number("--hardfail", text, 0, largest_limit, &limits->hard_fail, error);
      break;
    default: return ARGP_ERR_UNKNOWN;
  }
  return end_option(status);
}

static const struct argp_child children[] = {{&output_argp, 0, NULL, 0}, {&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .options = options_table,
    .parser = parse_option,
    .args_doc = "A B",
    .doc =
        "Compares two pictures, all channels by name: exit code 7 when they differ beyond the thresholds, or have "
        "other sizes or channels.\v"
        "Differences are of values as read: one level of an 8-bit picture is 1/255, so --fail 0.004 lets one level "
        "pass and not two. Two NaN are equal; NaN and a number, or an infinity and anything else, are infinitely "
        "different, and are counted apart from mean and RMS, which are over all other values.\n\n"
        "-o writes a heat map of each pixel's largest difference: black where equal, else violet over teal (a quarter "
        "of the largest) to yellow (the largest), by the square root; white where infinitely different.",
    .children = children,
};

typedef struct Pair {
  StyImage *images[2];
  StyComparison comparison;
  bool compared;  /* else sizes or channels differ */
  float *largest; /* per pixel, for the heat map; NULL without one */
} Pair;

static void close_pair(Pair *pair) {
  sty_destroy_image(&pair->images[0]);
  sty_destroy_image(&pair->images[1]);
  free(pair->largest);
}

static double get_percent(size_t part, const StyComparison *c) { return 100 * (double)part / (double)c->pixels; }

static bool passes(const Arguments *arguments, const StyComparison *c) {
  return get_percent(c->failing, c) <= arguments->failpercent && c->hard_failing == 0;
}

/* ---- reports ------------------------------------------------------------------ */

/* JSON has no number for NaN and infinities: null. */
static json_t *make_number(double value) { return isfinite(value) ? json_real(value) : json_null(); }

static json_t *list_channels(const StyImage *image) {
  json_t *names = json_array();
  for (int c = 0; c < image->channel_count; c++) json_array_append_new(names, make_json_text(image->names[c]));
  return names;
}

static json_t *pack_count(size_t pixels, const StyComparison *c) {
  return json_pack("{s:I, s:f}", "pixels", (json_int_t)pixels, "share", (double)pixels / (double)c->pixels);
}

static json_t *pack_largest(const Pair *pair) {
  const StyComparison *c = &pair->comparison;
  if (c->max <= 0) return json_null();
  return json_pack("{s:o, s:o, s:[ii], s:[oo]}", "difference", make_number(c->max), "channel",
                   make_json_text(pair->images[0]->names[c->channel]), "pixel", c->x, c->y, "values",
                   make_number((double)c->found[0]), make_number((double)c->found[1]));
}

static json_t *pack_comparison(const Pair *pair) {
  const StyComparison *c = &pair->comparison;
  if (!pair->compared) return json_null();
  return json_pack("{s:I, s:o, s:o, s:o, s:f, s:f, s:I, s:o}", "pixels", (json_int_t)c->pixels, "differing",
                   pack_count(c->differing, c), "failing", pack_count(c->failing, c), "hard_failing",
                   pack_count(c->hard_failing, c), "mean", c->mean, "rms", c->rms, "infinite_values",
                   (json_int_t)c->infinite, "largest", pack_largest(pair));
}

static json_t *pack_heat(const Arguments *arguments, const Pair *pair) {
  if (!pair->largest) return json_null();
  return json_pack("{s:o, s:f}", "file", make_json_text(arguments->options.output), "top", pair->comparison.finite_max);
}

static const char *get_verdict(const Arguments *arguments, const Pair *pair) {
  if (!pair->compared || !passes(arguments, &pair->comparison)) return "different";
  return pair->comparison.differing ? "within thresholds" : "equal";
}

static StyStatus print_as_json(const Arguments *arguments, const Pair *pair, StyError *error) {
  const StyImage *a = pair->images[0], *b = pair->images[1];
  return print_json(
      json_pack("{s:s, s:[oo], s:[[ii][ii]], s:[oo], s:{s:f, s:f, s:o}, s:s, s:o, s:o}", "schema", "stylut-compare/1",
                "files", make_json_text(arguments->files[0]), make_json_text(arguments->files[1]), "sizes", a->width,
                a->height, b->width, b->height, "channels", list_channels(a), list_channels(b), "thresholds", "fail",
                arguments->limits.fail, "failpercent", arguments->failpercent, "hardfail",
                make_number(arguments->limits.hard_fail), "verdict", get_verdict(arguments, pair), "comparison",
                pack_comparison(pair), "heat", pack_heat(arguments, pair)),
      error);
}

static void print_heat(const Arguments *arguments, const StyComparison *c) {
  printf("%s: black where equal", clean_text(arguments->options.output));
  if (c->finite_max > 0)
    printf(", violet just above 0, teal at %.6g, yellow at %.6g (by the square root)", c->finite_max / 4,
           c->finite_max);
  if (c->infinite) printf(", white where infinitely different");
  putchar('\n');
}

static void print_as_text(const Arguments *arguments, const Pair *pair) {
  const StyComparison *c = &pair->comparison;
  const StyImage *a = pair->images[0];
  printf("%s and %s: %dx%d pixels, channels", clean_text(arguments->files[0]), clean_text(arguments->files[1]),
         a->width, a->height);
  for (int i = 0; i < a->channel_count; i++) printf(" %s", clean_text(a->names[i]));
  printf(": %s\n", get_verdict(arguments, pair));
  printf("differing  %zu pixels (%.4g %%)\n", c->differing, get_percent(c->differing, c));
  printf("failing    %zu pixels (%.4g %%), by more than %g\n", c->failing, get_percent(c->failing, c),
         arguments->limits.fail);
  printf("difference mean %.6g  RMS %.6g  largest %.6g", c->mean, c->rms, c->max);
  if (c->max > 0)
    printf(", in channel %s at (%d, %d): %.9g and %.9g", clean_text(a->names[c->channel]), c->x, c->y,
           (double)c->found[0], (double)c->found[1]);
  putchar('\n');
  if (c->infinite) printf("infinite   %zu values, which mean and RMS leave out\n", c->infinite);
  if (pair->largest) print_heat(arguments, c);
}

/* ---- verdict ------------------------------------------------------------------ */

/* All in one line, whichever threshold it was. */
static StyStatus judge(const Arguments *arguments, const Pair *pair, StyError *error) {
  const StyComparison *c = &pair->comparison;
  char hard[64] = "";
  if (passes(arguments, c)) return STY_OK;
  if (isfinite(arguments->limits.hard_fail))
    snprintf(hard, sizeof hard, " and none by more than %g", arguments->limits.hard_fail);
  return sty_fail(error, STY_FILES_DIFFER,
                  "%s and %s: found %zu pixels (%.4g %%) that differ by more than %g, the largest by %.6g in channel "
                  "%s at (%d, %d), expected at most %g %%%s",
                  arguments->files[0], arguments->files[1], c->failing, get_percent(c->failing, c),
                  arguments->limits.fail, c->max, pair->images[0]->names[c->channel], c->x, c->y,
                  arguments->failpercent, hard);
}

/* ---- the command -------------------------------------------------------------- */

static StyStatus write_heat(const Arguments *arguments, const Pair *pair, StyError *error) {
  StyImage *heat = NULL;
  StyStatus status = sty_paint_heat(pair->largest, pair->images[0]->width, pair->images[0]->height,
                                    pair->comparison.finite_max, &heat, error);
  if (!status) status = add_history(&arguments->options, "compare", heat, arguments->files, 2, error);
  if (!status) status = sty_write_image(arguments->options.output, heat, error);
  sty_destroy_image(&heat);
  return status;
}

static StyStatus compare_pair(const Arguments *arguments, Pair *pair, StyError *error) {
  const size_t pixels = sty_count_pixels(pair->images[0]);
  if (arguments->options.output && !arguments->options.dry_run) {
    pair->largest = malloc(pixels * sizeof *pair->largest);
    if (!pair->largest) return sty_fail_memory(error, "heat map", (double)pixels * sizeof *pair->largest);
  }
  const StyRun run = begin_progress(&arguments->options, "comparing");
  const StyStatus status =
      sty_compare_images(arguments->files[0], pair->images[0], arguments->files[1], pair->images[1], &arguments->limits,
                         &run, &pair->comparison, pair->largest, error);
  end_progress(&arguments->options);
  pair->compared = !status;
  if (!status) return STY_OK;
  free(pair->largest);
  pair->largest = NULL;
  return status;
}

static StyStatus report(const Arguments *arguments, const Pair *pair, StyError *error) {
  if (arguments->options.json) return print_as_json(arguments, pair, error);
  if (!arguments->options.quiet && pair->compared) print_as_text(arguments, pair);
  return STY_OK;
}

static StyStatus run(Arguments *arguments, Pair *pair) {
  StyError *error = &arguments->options.error;
  StyStatus status = STY_OK;
  for (int k = 0; !status && k < 2; k++) status = sty_read_image(arguments->files[k], &pair->images[k], error);
  if (!status) status = compare_pair(arguments, pair, error);
  if (status && status != STY_FILES_DIFFER) return status;
  StyStatus printed = STY_OK;
  if (!status && arguments->options.dry_run && arguments->options.output) {
    printed = report_dry_run(&arguments->options, "heat map of %dx%d pixels", pair->images[0]->width,
                             pair->images[0]->height);
  } else {
    if (pair->largest) printed = write_heat(arguments, pair, error);
    if (!printed) printed = report(arguments, pair, error);
  }
  if (printed) return printed;
  return status ? status : judge(arguments, pair, error);
}

StyStatus run_compare(int argc, char **argv) {
  Arguments arguments = {.limits = {.fail = 0, .hard_fail = INFINITY}};
  Options *options = &arguments.options;
  Pair pair = {.compared = false};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !options->helped) status = run(&arguments, &pair);
  close_pair(&pair);
  return finish_command(options, status);
}
