/* stylut guide flow A B: the motion from this frame to the previous one. */
#include <math.h>
#include <stdio.h>

#include "commands.h"
#include "options.h"
#include "stylut/flow.h"
#include "stylut/image_io.h"
#include "stylut/parse.h"

typedef struct Arguments {
  Options options;
  const char *files[3]; /* this frame, the previous one; the true motion or NULL */
  StyFlowOptions flow;
  double display; /* pixels; 0: the longest motion found */
  int bits;       /* of a PNG */
  StyImageFormat format;
} Arguments;

enum { FRAME, PREVIOUS, TRUTH };
enum {
  KEY_METHOD = 0x200,
  KEY_MOTION,
  KEY_LEVELS,
  KEY_RADIUS,
  KEY_THRESHOLD,
  KEY_TOLERANCE,
  KEY_CONSISTENCY,
  KEY_DISPLAY,
  KEY_BITS
};

static const char *const methods[] = {"coarse-to-fine", "published", NULL};

static const struct argp_option options_table[] = {
    {"motion", KEY_MOTION, "TRUTH", 0, "a guide with the true motion.U and .V: report how far the flow is off it", 0},
    {"method", KEY_METHOD, "NAME", 0,
     "coarse-to-fine: each level searches around what the coarser one found, then refines below the pixel; published: "
     "each level searches on its own, around rest, and is averaged with the coarser one (default: coarse-to-fine)",
     0},
    {"channels", 'c', "LIST", 0,
     "what is compared, up to 4 channels or layers of both files (default: the first in both of R,G,B - full - Y - "
     "luma.Y - albedo - normal)",
     0},
    {"levels", KEY_LEVELS, "N", 0,
     "of the pyramid, 1 to 12; N of them reach motions of 2^N-1 pixels, at least twice that coarse-to-fine (default: "
     "down to a longer side below 16 pixels)",
     0},
    {"radius", KEY_RADIUS, "N", 0, "of the windows, 1 to 4 pixels (default: 2; 1 with published)", 0},
    {"threshold", KEY_THRESHOLD, "L", 0, "mean difference up to which windows match, in levels of 1/255 (default: 16)",
     0},
    {"tolerance", KEY_TOLERANCE, "L", 0,
     "difference below which windows are equally good, or have no texture; a noisy picture wants more (default: 0.5)",
     0},
    {"consistency", KEY_CONSISTENCY, NULL, 0,
     "estimate the way back, too, and say where both don't cancel out (channel consistency.Y); takes twice as long", 0},
    {NULL, 0, NULL, 0, "For PNG:", 0},
    {"display", KEY_DISPLAY, "PX", 0, "motion that is shown as 0 or 1 (default: the longest that is found)", 0},
    {"bits", KEY_BITS, "8|16", 0, "precision (default: 8)", 0},
    {0},
};

static StyStatus parse_count(Options *options, const char *what, const char *text, int maximum, int *out) {
  long long number = 0;
  const StyStatus status = sty_parse_integer(what, text, 1, maximum, &number, &options->error);
  if (!status) *out = (int)number;
  return status;
}

static error_t set_number(Arguments *arguments, int key, const char *text) {
  const NumberOption numbers[] = {
      {KEY_THRESHOLD, "--threshold", 0, 1e6, &arguments->flow.threshold},
      {KEY_TOLERANCE, "--tolerance", 0, 1e6, &arguments->flow.tolerance},
      {KEY_DISPLAY, "--display", 1e-3, 1e6, &arguments->display},
  };
  return parse_number_option(&arguments->options, numbers, sizeof numbers / sizeof *numbers, key, text);
}

static StyStatus check_arguments(Arguments *arguments) {
  Options *options = &arguments->options;
  StyStatus status = require_argument(options, arguments->files[FRAME], "this frame's picture and the previous one's");
  if (!status)
    status = require_argument(options, arguments->files[PREVIOUS], "the previous frame's picture after this one's");
  if (!status) status = require_output(options);
  if (!status) status = protect_inputs(options, options->output, arguments->files, 3);
  if (!status) status = sty_get_image_format(options->output, &arguments->format, &options->error);
  const bool is_png = arguments->format == STY_IMAGE_PNG;
  const OptionNeed needs[] = {{"display", is_png, "an output that ends in .png"},
                              {"bits", is_png, "an output that ends in .png"}};
  return status ? status : check_needs(options, needs, 2);
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  Options *options = &arguments->options;
  StyFlowOptions *flow = &arguments->flow;
  StyStatus status = STY_OK;
  int choice = 0;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG:
      status = take_argument(options, &arguments->files[arguments->files[FRAME] ? PREVIOUS : FRAME], text);
      break;
    case ARGP_KEY_END: status = check_arguments(arguments); break;
    case 'c': flow->channels = text; break;
    case KEY_METHOD:
      status = sty_parse_choice("--method", text, methods, &choice, &options->error);
      flow->method = choice ? STY_FLOW_PUBLISHED : STY_FLOW_COARSE_TO_FINE;
      break;
    case KEY_MOTION: arguments->files[TRUTH] = text; break;
    case KEY_CONSISTENCY: flow->consistency = true; break;
    case KEY_LEVELS: status = parse_count(options, "--levels", text, STY_FLOW_MOST_LEVELS, &flow->levels); break;
    case KEY_RADIUS: status = parse_count(options, "--radius", text, STY_FLOW_MOST_RADIUS, &flow->radius); break;
    case KEY_BITS: status = parse_bits(options, text, &arguments->bits); break;
    default: return set_number(arguments, key, text);
  }
  return end_option(status);
}

static const struct argp_child children[] = {{&output_argp, 0, NULL, 0}, {&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .options = options_table,
    .parser = parse_option,
    .args_doc = "A B",
    .doc =
        "Finds the motion from picture A, this frame, to picture B, the previous one, by their pixels alone.\v"
        "FILE.exr holds motion.U and .V (pixels, right and down: A at p looks like B at p + motion), A, residual.Y "
        "(mean difference of the windows, 1 = white) and origin.I (the pyramid level that found it: 1 the picture "
        "itself, 2 its half...; 0 none). FILE.png shows it: R is U, G is V, one half is rest.\n\n"
        "Local windows are compared on every level of a pyramid; pixels that find nothing take the coarser level's "
        "motion (Krazanowski 2011, 4.6). Values count as they are stored, 1 as white.\n\n"
        "Some motion cannot be seen: stripes along themselves, circles about their centre and areas of one colour seem "
        "to rest; patterns may be taken for themselves a period on (fewer --levels help where motion is short); what "
        "comes into view was nowhere. Where a scene is known, its exact motion is better. 'ambiguous' is the share of "
        "pixels for which a place one pixel away fits as well; 'relative' is the mean end-point error by the mean true "
        "motion: 100 % is what rest would get.",
    .children = children,
};

/* ---- work ----------------------------------------------------------------------- */

typedef struct Account {
  int width, height;
  StyFlowFigures figures;
  StyFlowError error; /* with a truth */
  double display;
  double times[3]; /* read, search, write */
} Account;

static StyStatus write_flow(Arguments *arguments, StyImage *flow, Account *account, StyError *error) {
  StyImage *picture = NULL;
  StyStatus status = STY_OK;
  if (arguments->format == STY_IMAGE_PNG) {
    const double longest = account->figures.max_motion;
    account->display = arguments->display > 0 ? arguments->display : longest > 0 ? longest : 1;
    status = sty_encode_motion(flow, account->display, arguments->bits, &picture, error);
  }
  StyImage *written = picture ? picture : flow;
  if (!status) status = add_history(&arguments->options, "guide flow", written, arguments->files, 2, error);
  if (!status) status = sty_write_image(arguments->options.output, written, error);
  sty_destroy_image(&picture);
  return status;
}

static StyStatus estimate(Arguments *arguments, StyImage *const images[3], StyImage **flow, Account *account,
                          StyError *error) {
  const char *const names[2] = {arguments->files[FRAME], arguments->files[TRUTH]};
  const double start = sty_get_milliseconds();
  const StyRun job = begin_progress(&arguments->options, "searching");
  StyStatus status = sty_estimate_flow(arguments->files, images[FRAME], images[PREVIOUS], &arguments->flow, &job,
                                       &account->figures, flow, error);
  end_progress(&arguments->options);
  if (!status && images[TRUTH]) status = sty_measure_flow(names, *flow, images[TRUTH], &account->error, error);
  account->times[1] = sty_get_milliseconds() - start;
  return status;
}

/* ---- reports -------------------------------------------------------------------- */

static json_t *pack_spread(const StyFlowSpread *s) {
  return json_pack("{s:f, s:f, s:f, s:f, s:f}", "mean", s->mean, "p50", s->p50, "p95", s->p95, "p99", s->p99, "max",
                   s->max);
}

static json_t *pack_error(const Arguments *arguments, const StyFlowError *e) {
  if (!arguments->files[TRUTH]) return json_null();
  return json_pack("{s:o, s:I, s:o, s:o, s:f, s:f, s:f, s:f}", "truth", make_json_text(arguments->files[TRUTH]),
                   "pixels", (json_int_t)e->pixels, "end_point", pack_spread(&e->end_point), "angular_degrees",
                   pack_spread(&e->angular), "above_1", e->above_1, "above_3", e->above_3, "mean_truth", e->mean_truth,
                   "relative", e->relative);
}

static double get_share(size_t part, size_t whole) { return whole ? (double)part / (double)whole : 0; }

static json_t *pack_consistency(const Arguments *arguments, const StyFlowFigures *f) {
  if (!arguments->flow.consistency) return json_null();
  return json_pack("{s:I, s:f, s:f}", "pixels", (json_int_t)f->compared, "inconsistent",
                   get_share(f->inconsistent, f->compared), "mean", f->mean_inconsistency);
}

static StyStatus print_as_json(const Arguments *arguments, const Account *account, StyError *error) {
  static const char *const stages[] = {"read", "search", "write"};
  const StyFlowFigures *f = &account->figures;
  return print_json(
      json_pack(
          "{s:s, s:[ii], s:s, s:i, s:i, s:o, s:I, s:{s:f, s:f}, s:f, s:f, s:f, s:f, s:f, s:f, s:o, s:o, s:o, s:f}",
          "schema", "stylut-flow/1", "size", account->width, account->height, "method", methods[arguments->flow.method],
          "levels", f->levels, "radius", f->radius, "channels", make_json_text(f->channels), "covered",
          (json_int_t)f->covered, "motion", "mean", f->mean_motion, "max", f->max_motion, "matched",
          get_share(f->matched, f->covered), "inherited", get_share(f->inherited, f->covered), "unknown",
          get_share(f->unknown, f->covered), "ambiguous", get_share(f->ambiguous, f->covered), "untextured",
          get_share(f->untextured, f->covered), "residual_levels", f->mean_residual, "consistency",
          pack_consistency(arguments, f), "error", pack_error(arguments, &account->error), "time_ms",
          pack_times(stages, account->times, 3), "peak_bytes", get_peak_bytes()),
      error);
}

static void print_spread(const char *name, const StyFlowSpread *s, const char *unit) {
  printf("%-11s mean %.4f  p50 %.4f  p95 %.4f  p99 %.4f  max %.4f %s\n", name, s->mean, s->p50, s->p95, s->p99, s->max,
         unit);
}

static void print_error(const Arguments *arguments, const StyFlowError *e) {
  printf("against %s: %zu pixels, mean motion %.4f pixels\n", clean_text(arguments->files[TRUTH]), e->pixels,
         e->mean_truth);
  print_spread("end-point", &e->end_point, "pixels");
  printf("%-11s above 1 pixel %.2f %%, above 3 pixels %.2f %%; relative %.2f %%\n", "", 100 * e->above_1,
         100 * e->above_3, 100 * e->relative);
  print_spread("angular", &e->angular, "degrees");
}

static void print_as_text(const Arguments *arguments, const Account *account) {
  const StyFlowFigures *f = &account->figures;
  const double all = (double)account->width * (double)account->height;
  printf("%s: %dx%d, %.1f %% covered; %s, %d levels, radius %d, by %s\n", clean_text(arguments->options.output),
         account->width, account->height, 100 * (double)f->covered / all, methods[arguments->flow.method], f->levels,
         f->radius, clean_text(f->channels));
  printf("motion      mean %.4f  max %.4f pixels\n", f->mean_motion, f->max_motion);
  printf("found       in the picture itself %.2f %%, by a coarser level %.2f %%, nowhere %.2f %%\n",
         100 * get_share(f->matched, f->covered), 100 * get_share(f->inherited, f->covered),
         100 * get_share(f->unknown, f->covered));
  printf("residual    mean %.4f levels\n", f->mean_residual);
  printf("ambiguous   %.2f %%, of which without texture %.2f %%\n", 100 * get_share(f->ambiguous, f->covered),
         100 * get_share(f->untextured, f->covered));
  if (arguments->flow.consistency)
    printf("consistency mean %.4f pixels there and back, %.2f %% above 1, over %zu pixels\n", f->mean_inconsistency,
           100 * get_share(f->inconsistent, f->compared), f->compared);
  if (arguments->files[TRUTH]) print_error(arguments, &account->error);
  if (account->display > 0) printf("shown       rest as one half, %.4g pixels as 0 or 1\n", account->display);
  printf("read %.0f ms, search %.0f ms, write %.0f ms; peak memory %.0f MB\n", account->times[0], account->times[1],
         account->times[2], get_peak_bytes() / 1e6);
}

static StyStatus print_report(const Arguments *arguments, const Account *account, StyError *error) {
  if (!account->figures.covered)
    warn(&arguments->options, "%s: found no covered pixel, expected a frame that shows something",
         clean_text(arguments->files[FRAME]));
  if (arguments->options.json) return print_as_json(arguments, account, error);
  if (!arguments->options.quiet) print_as_text(arguments, account);
  return STY_OK;
}

static StyStatus read_inputs(const Arguments *arguments, StyImage *images[3], StyError *error) {
  StyStatus status = STY_OK;
  for (int i = 0; !status && i < 3; i++)
    if (arguments->files[i]) status = sty_read_image(arguments->files[i], &images[i], error);
  return status;
}

static StyStatus process(Arguments *arguments, StyImage *const images[3], Account *account, StyError *error) {
  StyImage *flow = NULL;
  StyStatus status = estimate(arguments, images, &flow, account, error);
  const double start = sty_get_milliseconds();
  if (!status) status = write_flow(arguments, flow, account, error);
  account->times[2] = sty_get_milliseconds() - start;
  sty_destroy_image(&flow);
  return status ? status : print_report(arguments, account, error);
}

static StyStatus plan(Arguments *arguments, StyImage *const images[3], StyError *error) {
  StyFlowFigures figures;
  const StyStatus status =
      sty_plan_flow(arguments->files, images[FRAME], images[PREVIOUS], &arguments->flow, &figures, error);
  if (status) return status;
  return report_dry_run(&arguments->options, "%dx%d pixels, %d levels, by %s", images[FRAME]->width,
                        images[FRAME]->height, figures.levels, figures.channels);
}

static StyStatus run(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  Account account = {0};
  StyImage *images[3] = {NULL, NULL, NULL};
  const double start = sty_get_milliseconds();
  StyStatus status = read_inputs(arguments, images, error);
  account.times[0] = sty_get_milliseconds() - start;
  if (!status) {
    account.width = images[FRAME]->width;
    account.height = images[FRAME]->height;
    status = arguments->options.dry_run ? plan(arguments, images, error) : process(arguments, images, &account, error);
  }
  for (int i = 0; i < 3; i++) sty_destroy_image(&images[i]);
  return status;
}

StyStatus run_guide_flow(int argc, char **argv) {
  Arguments arguments = {.flow = sty_default_flow_options, .bits = 8};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments);
  return finish_command(&arguments.options, status);
}
