/* stylut toon --guide FRAME -o OUT.png: a frame in steps of light. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "anchors.h"
#include "commands.h"
#include "frames.h"
#include "inputs.h"
#include "options.h"
#include "passes.h"
#include "patterns.h"
#include "stylut/pack.h"
#include "stylut/parse.h"

/* What `stylut toon` is asked for, in the units that people type. */
typedef struct Arguments {
  Options options;
  const char *guide, *texture;
  int bits, band_count, colour_count;
  double thresholds[STY_MAX_BANDS]; /* of luminance, 0..1; one less than bands */
  uint8_t colours[STY_MAX_BANDS][4];
  double strength, albedo, cell, jitter;
  bool lit;
  double light[2]; /* azimuth, elevation, degrees */
  int orient;
  AnchorOptions anchors;
} Arguments;

enum {
  KEY_GUIDE = 0x200,
  KEY_BANDS,
  KEY_COLOURS,
  KEY_ALBEDO,
  KEY_LIGHT,
  KEY_TEXTURE,
  KEY_STRENGTH,
  KEY_ORIENT,
  KEY_CELL,
  KEY_JITTER,
  KEY_ANCHOR,
  KEY_PIVOTS,
  KEY_BITS
};
enum { FLAT, CELLS };

static const struct argp_option options_table[] = {
    {"guide", KEY_GUIDE, "FRAME", 0, "guide of the frame: EXR, or an 8- or 16-bit normal map", 0},
    {"light", KEY_LIGHT, "AZ,EL", 0,
     "light it from there: degrees to the viewer's right, and up (default: as luma.Y says; where the guide has none, "
     "or "
     "it is the same all over, -40,40)",
     0},
    {"bands", KEY_BANDS, "L,...", 0, "luminance at which each next band begins, 0 to 1, up to 7 (default: 0.15,0.5)",
     0},
    {"colours", KEY_COLOURS, "C,...", 0, "a colour per band from the darkest, RRGGBB or RRGGBBAA (default: greys)", 0},
    {"albedo", KEY_ALBEDO, "WEIGHT", 0,
     "how much of the surface's own colour the bands take on, 0 to 1; wants albedo.* in the guide (default: 1 with it)",
     0},
    {"texture", KEY_TEXTURE, "hatch|noise|PICTURE", 0, "pattern that bands' borders break up into (default: none)", 0},
    {"strength", KEY_STRENGTH, "LUMA", 0, "by how much white and black of it change luminance, 0 to 1 (default: 0.15)",
     0},
    {"orient", KEY_ORIENT, "flat|cells", 0,
     "pattern as it lies, or in cells that are turned the way the surface bends (default: cells)", 0},
    {"cell", KEY_CELL, "SIZE", 0, "size of cells: 4, 8, 16 ... 256 pixels (default: 32)", 0},
    {"jitter", KEY_JITTER, "AMOUNT", 0, "how uneven cells are, 0 to 1 (default: 1)", 0},
    {"anchor", KEY_ANCHOR, "screen|object", 0,
     "what cells ride on: the screen, or each object's pivot, so that one that moves takes them along (default: "
     "screen)",
     0},
    {"pivots", KEY_PIVOTS, "FILE.json", 0,
     "objects' pivots in pixels (default: as the guide's metadata say), as of 'stylize'", 0},
    {"bits", KEY_BITS, "8|16", 0, "precision of the picture (default: 8)", 0},
    {0},
};

/* ---- lists ---- */

/* Calls `take` for each part between commas; too many are an error. */
static StyStatus parse_list(Arguments *arguments, const char *what, const char *text, int most,
                            StyStatus (*take)(Arguments *arguments, int i, const char *part), int *count) {
  StyError *error = &arguments->options.error;
  StyStatus status = STY_OK;
  int i = 0;
  for (const char *from = text; !status && from; i++) {
    const size_t length = strcspn(from, ",");
    char part[32];
    if (length >= sizeof part || i == most)
      return sty_fail(error, STY_ERROR_USAGE, "%s: found '%s', expected at most %d values with commas between", what,
                      text, most);
    memcpy(part, from, length);
    part[length] = 0;
    status = take(arguments, i, part);
    from = from[length] ? from + length + 1 : NULL;
  }
  *count = i;
  return status;
}

static StyStatus take_threshold(Arguments *arguments, int i, const char *part) {
  StyError *error = &arguments->options.error;
  const StyStatus status = sty_parse_number("--bands", part, 0, 1, &arguments->thresholds[i], error);
  if (status || i == 0 || arguments->thresholds[i] > arguments->thresholds[i - 1]) return status;
  return sty_fail(error, STY_ERROR_USAGE, "--bands: found %s after %g, expected luminances that grow", part,
                  arguments->thresholds[i - 1]);
}

static StyStatus take_colour(Arguments *arguments, int i, const char *part) {
  return parse_colour(&arguments->options, "--colours", part, arguments->colours[i]);
}

static StyStatus take_angle(Arguments *arguments, int i, const char *part) {
  static const char *const names[] = {"--light: azimuth", "--light: elevation"};
  const double most = i ? 90 : 360;
  return sty_parse_number(names[i], part, -most, most, &arguments->light[i], &arguments->options.error);
}

static StyStatus parse_light(Arguments *arguments, const char *text) {
  int count = 0;
  StyStatus status = parse_list(arguments, "--light", text, 2, take_angle, &count);
  if (!status && count != 2)
    status = sty_fail(&arguments->options.error, STY_ERROR_USAGE,
                      "--light: found '%s', expected AZIMUTH,ELEVATION in degrees", text);
  arguments->lit = true;
  return status;
}

static StyStatus parse_bands(Arguments *arguments, const char *text) {
  int count = 0;
  const StyStatus status = parse_list(arguments, "--bands", text, STY_MAX_BANDS - 1, take_threshold, &count);
  arguments->band_count = count + 1;
  return status;
}

/* ---- options ---- */

static StyStatus check_cell(Arguments *arguments) {
  int level = 0;
  const double size = arguments->cell;
  if (frexp(size, &level) == 0.5) return STY_OK;
  return sty_fail(&arguments->options.error, STY_ERROR_USAGE, "--cell: found %g, expected 4, 8, 16, 32, 64, 128 or 256",
                  size);
}

static StyStatus check_arguments(Arguments *arguments) {
  Options *options = &arguments->options;
  StyStatus status = require_frame(options, arguments->guide);
  const char *const inputs[] = {arguments->guide, arguments->texture, arguments->anchors.pivots};
  if (!status) status = protect_inputs(options, options->output, inputs, 3);
  if (!status && arguments->colour_count && arguments->colour_count != arguments->band_count)
    status = sty_fail(&options->error, STY_ERROR_USAGE, "--colours: found %d, expected %d: one per band",
                      arguments->colour_count, arguments->band_count);
  if (!status) status = check_cell(arguments);
  const bool turned = arguments->texture && arguments->orient == CELLS;
  const OptionNeed needs[] = {
      {"strength", arguments->texture, "--texture"},      {"orient", arguments->texture, "--texture"},
      {"seed", arguments->texture, "--texture"},          {"cell", turned, "--texture and --orient cells"},
      {"jitter", turned, "--texture and --orient cells"}, {"anchor", turned, "--texture and --orient cells"}};
  if (!status) status = check_needs(options, needs, sizeof needs / sizeof *needs);
  return status ? status : check_anchors(options, &arguments->anchors);
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  static const char *const orients[] = {"flat", "cells", NULL};
  Arguments *arguments = state->input;
  const NumberOption numbers[] = {{KEY_ALBEDO, "--albedo", 0, 1, &arguments->albedo},
                                  {KEY_STRENGTH, "--strength", 0, 1, &arguments->strength},
                                  {KEY_CELL, "--cell", 4, 256, &arguments->cell},
                                  {KEY_JITTER, "--jitter", 0, 1, &arguments->jitter}};
  StyStatus status = STY_OK;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: status = refuse_argument(&arguments->options, text); break;
    case ARGP_KEY_END: status = check_arguments(arguments); break;
    case KEY_GUIDE: arguments->guide = text; break;
    case KEY_TEXTURE: arguments->texture = text; break;
    case KEY_BANDS: status = parse_bands(arguments, text); break;
    case KEY_LIGHT: status = parse_light(arguments, text); break;
    case KEY_BITS: status = parse_bits(&arguments->options, text, &arguments->bits); break;
    case KEY_COLOURS:
      status = parse_list(arguments, "--colours", text, STY_MAX_BANDS, take_colour, &arguments->colour_count);
      break;
    case KEY_PIVOTS: arguments->anchors.pivots = text; break;
    case KEY_ANCHOR:
      status = sty_parse_choice("--anchor", text, anchor_kinds, &arguments->anchors.kind, &arguments->options.error);
      break;
    case KEY_ORIENT:
      status = sty_parse_choice("--orient", text, orients, &arguments->orient, &arguments->options.error);
      break;
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
        "Shades a frame in steps of light; a pattern breaks up the steps' borders.\vLuminance is scene-linear. Where "
        "the "
        "guide has albedo.*, that is taken out of luma.Y first, so that bands tell light and not paint. With --format "
        "json "
        "the runtime's structure is printed as it was set, for engines that draw the same.",
    .children = children,
};

/* ---- light ---- */

/* Light from everywhere shows nothing. */
static bool has_shades(const FilledFrame *filled) {
  const size_t pixels = (size_t)filled->frame.width * (size_t)filled->frame.height;
  int least = 255, most = 0;
  for (size_t i = 0; filled->luma && i < pixels; i++)
    if (filled->guide[4 * i + 3] > 0) {
      least = filled->luma[i] < least ? filled->luma[i] : least;
      most = filled->luma[i] > most ? filled->luma[i] : most;
    }
  return most > least;
}

/* Cosines to a light in luma's place. */
static StyStatus light_frame(const double angles[2], const StyImage *guide, FilledFrame *filled, StyError *error) {
  static const double degree = 3.14159265358979323846 / 180;
  const double azimuth = angles[0] * degree, elevation = angles[1] * degree;
  const double light[3] = {sin(azimuth) * cos(elevation), sin(elevation), cos(azimuth) * cos(elevation)};
  const float *x = sty_find_channel(guide, "normal.X"), *y = sty_find_channel(guide, "normal.Y"),
              *z = sty_find_channel(guide, "normal.Z");
  if (!filled->luma) filled->luma = malloc(sty_count_pixels(guide));
  if (!filled->luma) return sty_fail_memory(error, "light", (double)sty_count_pixels(guide));
  for (size_t i = 0; i < sty_count_pixels(guide); i++) {
    const double cosine = (double)x[i] * light[0] + (double)y[i] * light[1] + (double)z[i] * light[2];
    filled->luma[i] = (uint8_t)(cosine > 0 ? fmin(cosine, 1) * 255 + 0.5 : 0);
  }
  filled->frame.luma = filled->luma;
  return STY_OK;
}

/* ---- shading ---- */

/* A frame and what it is shaded with. */
typedef struct Work {
  FilledFrame filled;
  Anchors anchors;
  StyToon toon;
  uint8_t jitter[2 * STY_JITTER_SIZE * STY_JITTER_SIZE];
  int bits;
  void *picture;
} Work;

static void destroy_work(Work *work) {
  free_frame(&work->filled);
  free(work->anchors.places);
  free((void *)work->toon.pattern.texels);
  free(work->picture);
}

static StyStatus anchor_frame(const AnchorOptions *options, const char *path, const StyImage *guide, Work *work,
                              StyError *error) {
  StyPivotFile pivots;
  StyStatus status = open_pivots(options, &pivots, error);
  if (status) return status;
  status = place_anchors(options, &pivots, path, guide, 0, 1, &work->anchors, error);
  sty_free_pivot_file(&pivots);
  work->filled.frame.anchors = work->anchors.places;
  work->filled.frame.anchor_count = work->anchors.count;
  return status;
}

static StyStatus load_frame(const Arguments *arguments, Work *work, StyError *error) {
  StyImage *guide = NULL;
  StyStatus status = read_guide(&arguments->options, arguments->guide, &guide, error);
  if (!status && is_given(&arguments->options, "albedo") && !sty_find_channel(guide, "albedo.R"))
    status = sty_fail(error, STY_ERROR_INPUT, "%s: found no albedo.R, expected it for --albedo", arguments->guide);
  if (!status) status = fill_frame(arguments->guide, guide, 1, &work->filled, error);
  if (!status) status = anchor_frame(&arguments->anchors, arguments->guide, guide, work, error);
  if (!status && (arguments->lit || !has_shades(&work->filled)))
    status = light_frame(arguments->light, guide, &work->filled, error);
  if (!status && !(work->picture = malloc(sty_count_pixels(guide) * (size_t)work->bits / 2)))
    status = sty_fail_memory(error, "picture", (double)sty_count_pixels(guide) * work->bits / 2);
  sty_destroy_image(&guide);
  return status;
}

/* From a third to white, evenly as they look. */
static void choose_greys(StyToon *toon) {
  const int steps = toon->band_count - 1;
  for (int i = 0; i < toon->band_count; i++) {
    const uint8_t grey = (uint8_t)(steps ? 85 + 170 * i / steps : 255);
    for (int c = 0; c < 3; c++) toon->colours[i][c] = grey;
    toon->colours[i][3] = 255;
  }
}

static StyStatus set_toon(const Arguments *arguments, Work *work, StyError *error) {
  StyToon *toon = &work->toon;
  *toon = (StyToon){.band_count = arguments->band_count, .colour_weight = (int)(arguments->albedo * 256 + 0.5)};
  for (int i = 0; i < toon->band_count - 1; i++) toon->thresholds[i] = (uint8_t)(arguments->thresholds[i] * 255 + 0.5);
  if (arguments->colour_count)
    memcpy(toon->colours, arguments->colours, sizeof toon->colours);
  else
    choose_greys(toon);
  if (!arguments->texture) return STY_OK;
  toon->pattern_weight = (int)(arguments->strength * 255 / 128 * 256 + 0.5);
  sty_make_jitter(arguments->options.seed, work->jitter);
  toon->jitter = work->jitter;
  toon->jitter_amount = (int)(arguments->jitter * 255 + 0.5);
  toon->cell_level = arguments->orient == CELLS ? ilogb(arguments->cell) : 0;
  return open_pattern(arguments->texture, arguments->options.seed, &toon->pattern, error);
}

static StyRuntimeStatus shade_rect(void *context, StyRect rect) {
  const Work *work = context;
  return sty_shade_toon(&work->filled.frame, &work->toon, rect, work->bits, work->picture);
}

/* What an engine sets to draw the same. */
static json_t *describe_settings(const StyToon *toon) {
  json_t *thresholds = json_array(), *colours = json_array();
  for (int i = 0; i < toon->band_count - 1; i++) json_array_append_new(thresholds, json_integer(toon->thresholds[i]));
  for (int i = 0; i < toon->band_count; i++) {
    const uint8_t *colour = toon->colours[i];
    json_array_append_new(colours, json_pack("[iiii]", colour[0], colour[1], colour[2], colour[3]));
  }
  return json_pack("{s:{s:i, s:o, s:o, s:i, s:i, s:i, s:i}}", "StyToon", "band_count", toon->band_count, "thresholds",
                   thresholds, "colours", colours, "colour_weight", toon->colour_weight, "pattern_weight",
                   toon->pattern_weight, "cell_level", toon->cell_level, "jitter_amount", toon->jitter_amount);
}

static StyStatus finish(Arguments *arguments, Work *work, StyError *error) {
  const StyFrame *frame = &work->filled.frame;
  Options *options = &arguments->options;
  if (options->dry_run) return report_dry_run(options, "%dx%d pixels", frame->width, frame->height);
  const StyRun run = begin_progress(options, "toon");
  StyStatus status = pass_rects(frame->width, frame->height, shade_rect, work, &run, error);
  end_progress(options);
  const char *inputs[3] = {arguments->guide};
  int input_count = 1;
  if (arguments->texture && !is_own_pattern(arguments->texture)) inputs[input_count++] = arguments->texture;
  if (arguments->anchors.pivots) inputs[input_count++] = arguments->anchors.pivots;
  if (!status)
    status = write_picture(options, "toon", frame->width, frame->height, work->bits, work->picture, inputs, input_count,
                           error);
  return status
             ? status
             : report_picture(options, "stylut-toon/1", arguments->guide, frame, describe_settings(&work->toon), error);
}

static StyStatus run(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  Work work = {.bits = arguments->bits};
  StyStatus status = load_frame(arguments, &work, error);
  if (!status) status = set_toon(arguments, &work, error);
  if (!status) status = finish(arguments, &work, error);
  destroy_work(&work);
  return status;
}

StyStatus run_toon(int argc, char **argv) {
  Arguments arguments = {.bits = 8,
                         .band_count = 3,
                         .thresholds = {0.15, 0.5},
                         .light = {-40, 40},
                         .strength = 0.15,
                         .albedo = 1,
                         .cell = 32,
                         .jitter = 1,
                         .orient = CELLS};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments);
  return finish_command(&arguments.options, status);
}
