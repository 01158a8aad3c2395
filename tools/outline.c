/* stylut outline --guide FRAME -o OUT.png: lines around and inside what a frame shows. */
#include <math.h>
#include <stdlib.h>

#include "commands.h"
#include "frames.h"
#include "inputs.h"
#include "options.h"
#include "passes.h"
#include "patterns.h"
#include "stylut/image_io.h"
#include "stylut/parse.h"
#include "stylut/runtime.h"

/* What `stylut outline` is asked for, in the units that people type. */
typedef struct Arguments {
  Options options;
  const char *guide, *over, *texture;
  double width, silhouette, object, normal, depth; /* strengths: 1 is enough for a line */
  double angle, gap, noise, wobble;                /* gap 0: by how deep the frame is */
  uint8_t colour[4];
  bool inside;
} Arguments;

enum {
  KEY_GUIDE = 0x200,
  KEY_OVER,
  KEY_WIDTH,
  KEY_COLOUR,
  KEY_INSIDE,
  KEY_SILHOUETTE,
  KEY_OBJECT,
  KEY_NORMAL,
  KEY_DEPTH,
  KEY_ANGLE,
  KEY_GAP,
  KEY_NOISE,
  KEY_TEXTURE,
  KEY_WOBBLE
};

static const struct argp_option options_table[] = {
    {"guide", KEY_GUIDE, "FRAME", 0, "guide of the frame: EXR, or an 8- or 16-bit normal map", 0},
    {"over", KEY_OVER, "PICTURE", 0, "lay the lines over this picture of the frame (default: on nothing)", 0},
    {"inside", KEY_INSIDE, NULL, 0, "draw nothing beyond what the picture of --over shows", 0},
    {"width", KEY_WIDTH, "PIXELS", 0, "width of lines, 0.5 to 64 (default: 2)", 0},
    {"colour", KEY_COLOUR, "RRGGBB[AA]", 0, "colour of lines, hexadecimal (default: 000000)", 0},
    {NULL, 0, NULL, 0, "Which lines (strengths add up, 0 to 100; 1 is a line):", 10},
    {"silhouette", KEY_SILHOUETTE, "S", 0, "where the background begins (default: 2)", 0},
    {"object", KEY_OBJECT, "S", 0, "where another object begins; wants object.I in the guide (default: 2)", 0},
    {"normal", KEY_NORMAL, "S", 0, "per 30 degrees beyond --angle that neighbours face apart (default: 2)", 0},
    {"angle", KEY_ANGLE, "DEGREES", 0, "bends that are no edge yet, 0 to 90 (default: 20)", 0},
    {"depth", KEY_DEPTH, "S", 0,
     "per doubling of --gap by which what is behind lies farther; wants depth.Z in the guide (default: 2)", 0},
    {"gap", KEY_GAP, "UNITS", 0, "gap in depth that is a line, in scene units (default: 1/200 of the frame's depth)",
     0},
    {NULL, 0, NULL, 0, "Hands aren't machines:", 20},
    {"noise", KEY_NOISE, "S", 0, "strength that a pattern takes away where it is white, 0 to 100 (default: 0)", 0},
    {"texture", KEY_TEXTURE, "noise|hatch|PICTURE", 0, "that pattern (default: noise)", 0},
    {"wobble", KEY_WOBBLE, "PIXELS", 0, "how far lines stray, 0 to 16 (default: 0)", 0},
    {0},
};

static StyStatus check_arguments(Arguments *arguments) {
  Options *options = &arguments->options;
  const char *const inputs[] = {arguments->guide, arguments->over, arguments->texture};
  StyStatus status = require_frame(options, arguments->guide);
  if (!status) status = protect_inputs(options, options->output, inputs, 3);
  const OptionNeed needs[] = {{"inside", arguments->over, "--over"},
                              {"texture", arguments->noise > 0, "--noise above 0"},
                              {"angle", arguments->normal > 0, "--normal above 0"},
                              {"gap", arguments->depth > 0 || arguments->object > 0 || arguments->normal > 0,
                               "--depth, --object or --normal above 0"},
                              {"seed", arguments->wobble > 0 || arguments->noise > 0, "--wobble or --noise above 0"}};
  return status ? status : check_needs(options, needs, sizeof needs / sizeof *needs);
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  const NumberOption numbers[] = {{KEY_WIDTH, "--width", 0.5, 64, &arguments->width},
                                  {KEY_SILHOUETTE, "--silhouette", 0, 100, &arguments->silhouette},
                                  {KEY_OBJECT, "--object", 0, 100, &arguments->object},
                                  {KEY_NORMAL, "--normal", 0, 100, &arguments->normal},
                                  {KEY_ANGLE, "--angle", 0, 90, &arguments->angle},
                                  {KEY_DEPTH, "--depth", 0, 100, &arguments->depth},
                                  {KEY_GAP, "--gap", 1e-6, 1e6, &arguments->gap},
                                  {KEY_NOISE, "--noise", 0, 100, &arguments->noise},
                                  {KEY_WOBBLE, "--wobble", 0, 16, &arguments->wobble}};
  StyStatus status = STY_OK;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: status = refuse_argument(&arguments->options, text); break;
    case ARGP_KEY_END: status = check_arguments(arguments); break;
    case KEY_GUIDE: arguments->guide = text; break;
    case KEY_OVER: arguments->over = text; break;
    case KEY_INSIDE: arguments->inside = true; break;
    case KEY_TEXTURE: arguments->texture = text; break;
    case KEY_COLOUR: status = parse_colour(&arguments->options, "--colour", text, arguments->colour); break;
    default: return parse_number_option(&arguments->options, numbers, sizeof numbers / sizeof *numbers, key, text);
  }
  return end_option(status);
}

static const struct argp_child children[] = {
    {&seed_argp, 0, NULL, 0}, {&output_argp, 0, NULL, 0}, {&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .options = options_table,
    .parser = parse_option,
    .args_doc = "--guide FRAME -o OUT.png",
    .doc =
        "Draws lines where a frame's surfaces end, bend or hide each other.\vA guide of normals alone has silhouettes "
        "and edges; depth.Z and object.I add what stands before what. With --format json the "
        "runtime's structures are printed as they were set, for engines that draw the same.",
    .children = children,
};

/* Options that ask for lines of what the guide doesn't tell; the defaults take what there is. */
static StyStatus require_channels(const Arguments *arguments, const StyImage *guide, StyError *error) {
  static const char *const options[] = {"object", "depth", "gap"}, *const channels[] = {"object.I", "depth.Z",
                                                                                        "depth.Z"};
  for (int i = 0; i < 3; i++)
    if (is_given(&arguments->options, options[i]) && !sty_find_channel(guide, channels[i]))
      return sty_fail(error, STY_ERROR_INPUT, "%s: found no %s, expected it for --%s", arguments->guide, channels[i],
                      options[i]);
  return STY_OK;
}

/* ---- the lines ---- */

/* A frame and what its lines are made of. */
typedef struct Work {
  FilledFrame filled;
  StyOutline outline;
  StyLine line;
  const uint8_t *colour;
  int bits; /* those of --over */
  uint8_t *contours, *lines, *wobble;
  int8_t *columns;
  void *picture;
  bool inside;
} Work;

static void destroy_work(Work *work) {
  free_frame(&work->filled);
  free((void *)work->outline.noise.texels);
  free(work->contours);
  free(work->columns);
  free(work->lines);
  free(work->wobble);
  free(work->picture);
}

static StyStatus allocate_work(Work *work, size_t pixels, StyError *error) {
  work->contours = malloc(pixels);
  work->columns = malloc(pixels);
  work->lines = malloc(pixels);
  if (!work->picture) work->picture = calloc(pixels, (size_t)work->bits / 2);
  if (!work->contours || !work->columns || !work->lines || !work->picture)
    return sty_fail_memory(error, "lines", 7 * (double)pixels);
  return STY_OK;
}

/* A gap that shows: 1/200 of how deep the frame is. */
static float choose_gap(const FilledFrame *filled) {
  const size_t pixels = (size_t)filled->frame.width * (size_t)filled->frame.height;
  float least = INFINITY, most = -INFINITY;
  for (size_t i = 0; filled->depth && i < pixels; i++)
    if (filled->guide[4 * i + 3] > 0 && fabsf(filled->depth[i]) <= STY_MAX_DEPTH) {
      least = fminf(least, filled->depth[i]);
      most = fmaxf(most, filled->depth[i]);
    }
  return most > least ? fminf((most - least) / 200, STY_MAX_DEPTH) : 1;
}

/* Strength 1, in the runtime's units, and how far apart bytes of normals are per radian, along an axis or between. */
static const double unit = 256, bytes_per_radian = 160;
static const double degree = 3.14159265358979323846 / 180;

static int scale(double value, double by) { return (int)fmin(value * by + 0.5, STY_MAX_OUTLINE_WEIGHT); }

static void set_outline(const Arguments *arguments, Work *work) {
  work->outline =
      (StyOutline){.silhouette_weight = scale(arguments->silhouette, unit),
                   .object_weight = scale(arguments->object, unit),
                   .normal_weight = scale(arguments->normal, unit / (30 * degree * bytes_per_radian)),
                   .depth_weight = scale(arguments->depth, unit),
                   .normal_tolerance = scale(arguments->angle * degree, bytes_per_radian),
                   .depth_tolerance = arguments->gap > 0 ? (float)arguments->gap : choose_gap(&work->filled),
                   .noise_weight = scale(arguments->noise, unit * 256 / 255),
                   .threshold = (int)unit - 1};
  work->line = (StyLine){.width = (int)(arguments->width * 256 + 0.5)};
}

/* Patterns that were asked for. Hills as far apart as strokes of a hand are long. */
static StyStatus set_patterns(const Arguments *arguments, Work *work, StyError *error) {
  StyStatus status = STY_OK;
  if (arguments->noise > 0)
    status = open_pattern(arguments->texture, arguments->options.seed, &work->outline.noise, error);
  if (status || arguments->wobble == 0) return status;
  work->wobble = malloc(2 * PATTERN_SIDE * PATTERN_SIDE);
  if (!work->wobble) return sty_fail_memory(error, "wobble", 2.0 * PATTERN_SIDE * PATTERN_SIDE);
  make_hills(arguments->options.seed, 16, 2, work->wobble);
  work->line.wobble = (StyPattern){work->wobble, PATTERN_SIDE, PATTERN_SIDE};
  work->line.wobble_amount = (int)(arguments->wobble * 256 + 0.5);
  return STY_OK;
}

/* RGBA in the picture's own precision. */
static StyStatus convert_under(const Arguments *arguments, const StyImage *image, Work *work, StyError *error) {
  const size_t pixels = sty_count_pixels(image), last = (size_t)image->channel_count - 1;
  work->bits = image->bits == 16 ? 16 : 8;
  work->picture = malloc(pixels * (size_t)work->bits / 2);
  if (!work->picture) return sty_fail_memory(error, arguments->over, (double)pixels * work->bits / 2);
  if (work->bits == 8 || image->channel_count > 4)
    return sty_convert_to_rgba8(arguments->over, image, work->picture, error);
  uint16_t *out = work->picture;
  for (size_t i = 0; i < pixels; i++) {
    for (size_t c = 0; c < 3; c++)
      out[4 * i + c] = (uint16_t)(image->data[(last < 2 ? 0 : c) * pixels + i] * 65535 + 0.5f);
    out[4 * i + 3] = last % 2 ? (uint16_t)(image->data[last * pixels + i] * 65535 + 0.5f) : 65535;
  }
  return STY_OK;
}

static StyStatus read_under(const Arguments *arguments, const StyImage *guide, Work *work, StyError *error) {
  StyImage *image = NULL;
  StyStatus status = arguments->over ? sty_read_image(arguments->over, &image, error) : STY_OK;
  if (status || !image) return status;
  if (image->width != guide->width || image->height != guide->height)
    status = sty_fail(error, STY_ERROR_INPUT, "%s: found %dx%d pixels, expected %dx%d as %s has", arguments->over,
                      image->width, image->height, guide->width, guide->height, arguments->guide);
  if (!status) status = convert_under(arguments, image, work, error);
  sty_destroy_image(&image);
  return status;
}

static StyRuntimeStatus find_contours(void *context, StyRect rect) {
  const Work *work = context;
  return sty_find_contours(&work->filled.frame, &work->outline, rect, work->contours);
}

static StyRuntimeStatus measure_columns(void *context, StyRect rect) {
  const Work *work = context;
  const StyFrame *frame = &work->filled.frame;
  return sty_measure_columns(frame->width, frame->height, work->contours, &work->line, rect, work->columns);
}

static StyRuntimeStatus draw_lines(void *context, StyRect rect) {
  const Work *work = context;
  const StyFrame *frame = &work->filled.frame;
  const StyRuntimeStatus status =
      sty_draw_lines(frame->width, frame->height, work->columns, &work->line, rect, work->lines);
  if (status) return status;
  return sty_lay_lines(frame->width, frame->height, work->lines, work->colour, !work->inside, rect, work->bits,
                       work->picture);
}

/* Each pass wants the one before it around its rectangles, too. */
static StyStatus draw(Work *work, const StyRun *run, StyError *error) {
  PassRect *const passes[] = {find_contours, measure_columns, draw_lines};
  StyStatus status = STY_OK;
  for (int p = 0; !status && p < 3; p++)
    status = pass_rects(work->filled.frame.width, work->filled.frame.height, passes[p], work, run, error);
  return status;
}

/* What an engine sets to draw the same. */
static json_t *describe_settings(const Work *work) {
  const StyOutline *outline = &work->outline;
  return json_pack("{s:{s:i, s:i, s:i, s:i, s:i, s:f, s:i, s:i}, s:{s:i, s:i}}", "StyOutline", "silhouette_weight",
                   outline->silhouette_weight, "object_weight", outline->object_weight, "normal_weight",
                   outline->normal_weight, "depth_weight", outline->depth_weight, "normal_tolerance",
                   outline->normal_tolerance, "depth_tolerance", sty_shorten_float(outline->depth_tolerance),
                   "noise_weight", outline->noise_weight, "threshold", outline->threshold, "StyLine", "width",
                   work->line.width, "wobble_amount", work->line.wobble_amount);
}

static StyStatus finish(Arguments *arguments, Work *work, StyError *error) {
  const StyFrame *frame = &work->filled.frame;
  Options *options = &arguments->options;
  if (options->dry_run) return report_dry_run(options, "%dx%d pixels", frame->width, frame->height);
  const StyRun run = begin_progress(options, "outline");
  StyStatus status = draw(work, &run, error);
  end_progress(options);
  const char *inputs[3] = {arguments->guide};
  int input_count = 1;
  if (arguments->over) inputs[input_count++] = arguments->over;
  if (arguments->noise > 0 && !is_own_pattern(arguments->texture)) inputs[input_count++] = arguments->texture;
  if (!status)
    status = write_picture(options, "outline", frame->width, frame->height, work->bits, work->picture, inputs,
                           input_count, error);
  return status ? status
                : report_picture(options, "stylut-outline/1", arguments->guide, frame, describe_settings(work), error);
}

static StyStatus run(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  Work work = {.bits = 8, .colour = arguments->colour, .inside = arguments->inside};
  StyImage *guide = NULL;
  StyStatus status = read_guide(&arguments->options, arguments->guide, &guide, error);
  if (!status) status = require_channels(arguments, guide, error);
  if (!status) status = read_under(arguments, guide, &work, error);
  if (!status) status = allocate_work(&work, sty_count_pixels(guide), error);
  if (!status) status = fill_frame(arguments->guide, guide, 1, &work.filled, error);
  sty_destroy_image(&guide);
  if (!status) {
    set_outline(arguments, &work);
    status = set_patterns(arguments, &work, error);
  }
  if (!status) status = finish(arguments, &work, error);
  destroy_work(&work);
  return status;
}

StyStatus run_outline(int argc, char **argv) {
  Arguments arguments = {.texture = "noise",
                         .width = 2,
                         .silhouette = 2,
                         .object = 2,
                         .normal = 2,
                         .depth = 2,
                         .angle = 20,
                         .colour = {0, 0, 0, 255}};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments);
  return finish_command(&arguments.options, status);
}
