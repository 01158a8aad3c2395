/* stylut guide warp PAIRS.json: a displacement field from pairs of points. */
#include "stylut/warp.h"

#include <stdio.h>

#include "commands.h"
#include "options.h"
#include "stylut/image_io.h"
#include "stylut/parse.h"

typedef struct Arguments {
  Options options;
  const char *file;
  int width, height;
  int kind;     /* of sty_warp_kinds; -1: the file's */
  double alpha; /* 0: the file's */
} Arguments;

enum { KEY_KIND = 0x200, KEY_ALPHA };

static const struct argp_option options_table[] = {
    {"size", 's', "WxH", 0, "pixels of source and output; one number for a square (default: 512)", 0},
    {"kind", KEY_KIND, "affine|similarity|rigid", 0, "in place of the file's", 0},
    {"alpha", KEY_ALPHA, "A", 0, "in place of the file's: how fast a pair's influence fades, 0.5 to 4", 0},
    {0},
};

static StyStatus check_arguments(Arguments *arguments) {
  Options *options = &arguments->options;
  StyStatus status = require_argument(options, arguments->file, "a file of point pairs");
  if (!status) status = require_output(options);
  if (!status) status = protect_inputs(options, options->output, &arguments->file, 1);
  return status ? status : require_exr(options);
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  StyError *error = &arguments->options.error;
  StyStatus status = STY_OK;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: status = take_argument(&arguments->options, &arguments->file, text); break;
    case ARGP_KEY_END: status = check_arguments(arguments); break;
    case 's': status = parse_picture_size(&arguments->options, text, &arguments->width, &arguments->height); break;
    case KEY_KIND: status = sty_parse_choice("--kind", text, sty_warp_kinds, &arguments->kind, error); break;
    case KEY_ALPHA:
      status = sty_parse_number("--alpha", text, STY_MIN_WARP_ALPHA, STY_MAX_WARP_ALPHA, &arguments->alpha, error);
      break;
    default: return ARGP_ERR_UNKNOWN;
  }
  return end_option(status);
}

static const struct argp_child children[] = {{&output_argp, 0, NULL, 0}, {&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .options = options_table,
    .parser = parse_option,
    .args_doc = "PAIRS.json",
    .doc =
        "Makes a displacement field from pairs of points, by moving least squares (Schaefer, McPhail, Warren 2006).\v"
        "What the source shows at a pair's 'from' appears at its 'to'; between the pairs the picture bends smoothly, "
        "as "
        "an affine map, by rotation and scale (similarity), or by rotation alone (rigid, the default). The file:\n"
        "  { \"schema\": \"stylut-pairs/1\", \"kind\": \"rigid\", \"alpha\": 1, \"units\": \"pixels\",\n"
        "    \"pairs\": [ { \"from\": [10, 20], \"to\": [12, 25] } ] }\n"
        "Pixel (x, y)'s centre is at (x+1/2, y+1/2), y down; units \"normalized\" are shares of the picture's sides. "
        "motion.U .V says, in pixels, right and down, where in the source a pixel of the output comes from; A is 1 "
        "where "
        "that is inside the picture. The report says how well the field meets the pairs, how much it stretches and "
        "compresses the source, and where it folds.",
    .children = children,
};

enum { READ, WARP, WRITE, STAGES };

typedef struct Account {
  StyPairs pairs;
  StyWarpFigures figures;
  double times[STAGES];
} Account;

static double get_share(size_t part, size_t whole) { return whole ? (double)part / (double)whole : 0; }

static json_t *make_report(const Arguments *arguments, const Account *account) {
  static const char *const stages[] = {"read", "warp", "write"};
  const StyWarpFigures *f = &account->figures;
  const double pixels = (double)arguments->width * arguments->height;
  return json_pack(
      "{s:s, s:[ii], s:s, s:f, s:i, s:i, s:f, s:{s:i, s:f, s:f}, s:{s:f, s:[ii]}, s:{s:f, s:[ii]}, s:f, s:o, s:f}",
      "schema", "stylut-guide-warp/1", "size", arguments->width, arguments->height, "kind",
      sty_warp_kinds[account->pairs.kind], "alpha", account->pairs.alpha, "pairs", account->pairs.count, "outside",
      f->outside, "inside", (double)f->inside / pixels, "residual", "pairs", f->measured, "mean", f->residual_mean,
      "max", f->residual_max, "stretch", "max", f->stretch, "pixel", f->stretch_at[0], f->stretch_at[1], "compression",
      "max", f->compression, "pixel", f->compression_at[0], f->compression_at[1], "folded",
      get_share(f->folded, f->cells), "time_ms", pack_times(stages, account->times, STAGES), "peak_bytes",
      get_peak_bytes());
}

static void warn_of_figures(const Arguments *arguments, const StyPairs *pairs, const StyWarpFigures *figures) {
  const StyPair *first = &pairs->pairs[figures->first_outside];
  if (figures->outside)
    warn(
        &arguments->options,
        "%s: found %d of %d pairs outside the picture, the first pairs[%d] from (%g, %g) to (%g, %g), expected them in "
        "%dx%d pixels, or normalized",
        clean_text(arguments->file), figures->outside, pairs->count, figures->first_outside, first->from[0],
        first->from[1], first->to[0], first->to[1], arguments->width, arguments->height);
  if (!figures->inside)
    warn(&arguments->options, "%s: found that no pixel comes from inside the picture, expected pairs in %s",
         clean_text(arguments->file), "pixels of --size, or normalized");
  if (figures->folded)
    warn(&arguments->options,
         "%s: found the field folded over %.2f %% of the picture, expected pairs that keep their order",
         clean_text(arguments->file), 100 * get_share(figures->folded, figures->cells));
}

static void print_extreme(const char *name, double value, const int at[2]) {
  if (at[0] < 0)
    printf("%-11s  none: no pixel has neighbours that aren't folded\n", name);
  else
    printf("%-11s  at most %.4f times, at pixel (%d, %d)\n", name, value, at[0], at[1]);
}

static StyStatus print_report(const Arguments *arguments, const Account *account, StyError *error) {
  const StyWarpFigures *f = &account->figures;
  const double pixels = (double)arguments->width * arguments->height;
  warn_of_figures(arguments, &account->pairs, f);
  if (arguments->options.json) return print_json(make_report(arguments, account), error);
  if (arguments->options.quiet) return STY_OK;
  printf("%s: %dx%d, %s, %d pair%s, alpha %g; %.1f %% come from inside the picture\n",
         clean_text(arguments->options.output), arguments->width, arguments->height,
         sty_warp_kinds[account->pairs.kind], account->pairs.count, account->pairs.count == 1 ? "" : "s",
         account->pairs.alpha, 100 * (double)f->inside / pixels);
  printf("residual     mean %.5f  max %.5f pixels at the %d pairs inside, read bilinearly\n", f->residual_mean,
         f->residual_max, f->measured);
  print_extreme("stretch", f->stretch, f->stretch_at);
  print_extreme("compression", f->compression, f->compression_at);
  printf("folded       %.2f %% of the picture\n", 100 * get_share(f->folded, f->cells));
  printf("read %.0f ms, warp %.0f ms, write %.0f ms\n", account->times[READ], account->times[WARP],
         account->times[WRITE]);
  return STY_OK;
}

static StyStatus write_guide(const Arguments *arguments, const Account *account, StyImage *guide, StyError *error) {
  StyStatus status = sty_set_attribute(guide, "stylut:warp", sty_warp_kinds[account->pairs.kind], error);
  if (!status) status = add_history(&arguments->options, "guide warp", guide, &arguments->file, 1, error);
  return status ? status : sty_write_image(arguments->options.output, guide, error);
}

static StyStatus warp(Arguments *arguments, Account *account, StyError *error) {
  StyImage *guide = NULL;
  const double start = sty_get_milliseconds();
  const StyRun run = begin_progress(&arguments->options, "warping");
  StyStatus status = sty_make_warp_guide(arguments->file, &account->pairs, arguments->width, arguments->height, &run,
                                         &account->figures, &guide, error);
  end_progress(&arguments->options);
  const double warped = sty_get_milliseconds();
  if (!status && !arguments->options.dry_run) status = write_guide(arguments, account, guide, error);
  sty_destroy_image(&guide);
  account->times[WARP] = warped - start;
  account->times[WRITE] = sty_get_milliseconds() - warped;
  return status;
}

static StyStatus run(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  Account account = {.pairs = {.pairs = NULL}};
  const double start = sty_get_milliseconds();
  StyStatus status = sty_read_pairs(arguments->file, &account.pairs, error);
  account.times[READ] = sty_get_milliseconds() - start;
  if (!status) {
    if (arguments->kind >= 0) account.pairs.kind = (StyWarpKind)arguments->kind;
    if (arguments->alpha > 0) account.pairs.alpha = arguments->alpha;
    status = warp(arguments, &account, error);
  }
  if (!status)
    status = arguments->options.dry_run
                 ? report_dry_run(&arguments->options, "%dx%d pixels, %s, %d pairs", arguments->width,
                                  arguments->height, sty_warp_kinds[account.pairs.kind], account.pairs.count)
                 : print_report(arguments, &account, error);
  sty_free_pairs(&account.pairs);
  return status;
}

StyStatus run_guide_warp(int argc, char **argv) {
  Arguments arguments = {.width = 512, .height = 512, .kind = -1};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments);
  return finish_command(&arguments.options, status);
}
