/* stylut stylize BUNDLE --guide FRAME -o OUT.png: the runtime on one frame. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "anchors.h"
#include "commands.h"
#include "frames.h"
#include "inputs.h"
#include "options.h"
#include "passes.h"
#include "stylut/image_io.h"
#include "stylut/match.h"
#include "stylut/pack.h"
#include "stylut/parse.h"
#include "stylut/runtime.h"

typedef struct Arguments {
  Options options;
  const char *bundle, *guide, *style, *nnf, *chunks;
  int bits;
  AnchorOptions anchors;
} Arguments;

enum { KEY_GUIDE = 0x200, KEY_STYLE, KEY_NNF, KEY_CHUNKS, KEY_BITS, KEY_ANCHOR, KEY_PIVOTS };

static const struct argp_option options_table[] = {
    {"guide", KEY_GUIDE, "FRAME", 0, "guide of the frame: EXR, or an 8- or 16-bit normal map", 0},
    {"style", KEY_STYLE, "N|NAME", 0, "style, by number or name (default: the guide's style.I channel, else 1)", 0},
    {"bits", KEY_BITS, "8|16", 0, "precision of the picture (default: 8)", 0},
    {"nnf", KEY_NNF, "FILE.png", 0,
     "write the nearest-neighbour field: 16 bit, R = source x, G = source y, A = covered", 0},
    {"chunks", KEY_CHUNKS, "FILE.png", 0, "write the chunks: one colour for each piece copied as a whole", 0},
    {"anchor", KEY_ANCHOR, "screen|object", 0,
     "what pieces ride on: the screen, or each object's pivot, so that one that moves takes its pieces along (default: "
     "screen)",
     0},
    {"pivots", KEY_PIVOTS, "FILE.json", 0, "objects' pivots in pixels (default: as the guide's metadata say)", 0},
    {0},
};

/* A picture's name must end in .png and be no other output's. */
static StyStatus check_picture(const char *option, const char *path, const char *const *others, StyError *error) {
  StyImageFormat format;
  if (sty_get_image_format(path, &format, NULL) || format != STY_IMAGE_PNG)
    return sty_fail(error, STY_ERROR_USAGE, "option '%s': found '%s', expected a name that ends in .png", option, path);
  for (int i = 0; i < 3; i++)
    if (others[i] && others[i] != path && strcmp(others[i], path) == 0)
      return sty_fail(error, STY_ERROR_USAGE, "option '%s': found '%s' twice, expected a name of its own", option,
                      path);
  return STY_OK;
}

static StyStatus check_arguments(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  StyStatus status = require_argument(&arguments->options, arguments->bundle, "the bundle's folder");
  if (!status && !arguments->guide)
    status = sty_fail(error, STY_ERROR_USAGE, "option '--guide': found none, expected the frame's guide");
  if (!status) status = require_output(&arguments->options);
  if (status) return status;
  static const char *const options[] = {"--output", "--nnf", "--chunks"};
  const char *const paths[] = {arguments->options.output, arguments->nnf, arguments->chunks};
  for (int i = 0; !status && i < 3; i++)
    if (paths[i]) status = check_picture(options[i], paths[i], paths, error);
  const char *const inputs[] = {arguments->guide, arguments->anchors.pivots};
  for (int i = 0; !status && i < 3; i++)
    status = protect_inputs(&arguments->options, paths[i], inputs, arguments->anchors.pivots ? 2 : 1);
  return status ? status : check_anchors(&arguments->options, &arguments->anchors);
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  StyStatus status = STY_OK;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: status = take_argument(&arguments->options, &arguments->bundle, text); break;
    case ARGP_KEY_END: status = check_arguments(arguments); break;
    case KEY_GUIDE: arguments->guide = text; break;
    case KEY_STYLE: arguments->style = text; break;
    case KEY_NNF: arguments->nnf = text; break;
    case KEY_CHUNKS: arguments->chunks = text; break;
    case KEY_ANCHOR:
      status = sty_parse_choice("--anchor", text, anchor_kinds, &arguments->anchors.kind, &arguments->options.error);
      break;
    case KEY_PIVOTS: arguments->anchors.pivots = text; break;
    case KEY_BITS: status = parse_bits(&arguments->options, text, &arguments->bits); break;
    default: return ARGP_ERR_UNKNOWN;
  }
  return end_option(status);
}

static const struct argp_child children[] = {{&output_argp, 0, NULL, 0}, {&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .options = options_table,
    .parser = parse_option,
    .args_doc = "BUNDLE --guide FRAME -o OUT.png",
    .doc =
        "Dresses a frame in a bundle's style: each pixel takes a piece of the exemplar whose surface faces the same "
        "way.\vThe picture's alpha is the frame's coverage times the exemplar's alpha.",
    .children = children,
};

/* A frame and all that is computed for it. */
typedef struct Work {
  const StyBundle *bundle;
  FilledFrame filled;
  Anchors anchors;
  StyMatch *matches;
  int bits;
  void *picture;
} Work;

static void destroy_work(Work *work) {
  free_frame(&work->filled);
  free(work->anchors.places);
  free(work->matches);
  free(work->picture);
}

static StyStatus allocate_work(Work *work, size_t pixels, StyError *error) {
  work->matches = malloc(pixels * sizeof *work->matches);
  work->picture = malloc(pixels * 4 * (size_t)work->bits / 8);
  if (!work->matches || !work->picture) return sty_fail_memory(error, "picture", (double)pixels * 16);
  return STY_OK;
}

/* ---- what is written ---- */

static StyStatus draw_rgba(const Work *work, int bits, float (*get)(const Work *work, size_t pixel, int channel),
                           StyImage **out, StyError *error) {
  static const char *const names[] = {"R", "G", "B", "A"};
  StyImage *image = NULL;
  const StyStatus status =
      sty_create_image(work->filled.frame.width, work->filled.frame.height, 4, names, bits, &image, error);
  if (status) return status;
  const size_t pixels = sty_count_pixels(image);
  for (int c = 0; c < 4; c++)
    for (size_t i = 0; i < pixels; i++)
      image->data[(size_t)c * pixels + i] = get(work, i, c) / (bits == 8 ? 255.0f : 65535.0f);
  *out = image;
  return STY_OK;
}

static float get_picture(const Work *work, size_t pixel, int channel) {
  const size_t i = 4 * pixel + (size_t)channel;
  return work->bits == 8 ? (float)((const uint8_t *)work->picture)[i] : (float)((const uint16_t *)work->picture)[i];
}

/* Pixels of one chunk share the offset between picture and source. */
static float get_chunk(const Work *work, size_t pixel, int channel) {
  const StyMatch *match = &work->matches[pixel];
  if (match->level == STY_LEVEL_NONE) return 0;
  if (channel == 3) return 255;
  const uint32_t dx = (uint32_t)match->x - (uint32_t)(pixel % (size_t)work->filled.frame.width);
  const uint32_t dy = (uint32_t)match->y - (uint32_t)(pixel / (size_t)work->filled.frame.width);
  uint32_t hash = dx * 0x9e3779b1u ^ dy * 0x85ebca6bu;
  hash = (hash ^ hash >> 15) * 0x2c1b3c6du;
  hash ^= hash >> 13;
  return (float)(64 + (hash >> 8 * channel & 255) * 3 / 4);
}

static StyStatus draw_picture(const Work *work, StyImage **out, StyError *error) {
  return draw_rgba(work, work->bits, get_picture, out, error);
}

static StyStatus draw_chunks(const Work *work, StyImage **out, StyError *error) {
  return draw_rgba(work, 8, get_chunk, out, error);
}

static StyStatus draw_field(const Work *work, StyImage **out, StyError *error) {
  const StyTexture *source = &work->bundle->textures[STY_BUNDLE_GUIDES];
  StyField *field = NULL;
  StyStatus status = sty_create_field(work->filled.frame.width, work->filled.frame.height, (int)source->width,
                                      (int)source->height, &field, error);
  if (status) return status;
  for (size_t i = 0; i < (size_t)field->width * (size_t)field->height; i++)
    if (work->matches[i].level != STY_LEVEL_NONE)
      field->pixels[i] = work->matches[i].y * source->width + work->matches[i].x;
  status = sty_encode_field(field, 16, out, error);
  sty_destroy_field(&field);
  return status;
}

static StyStatus prepare_output(const Arguments *arguments, const char *path, const Work *work,
                                StyStatus (*draw)(const Work *work, StyImage **out, StyError *error), StyOutput *out,
                                StyError *error) {
  StyImage *image = NULL;
  StyStatus status = draw(work, &image, error);
  if (status) return status;
  char *index = sty_join_path(arguments->bundle, STY_BUNDLE_INDEX);
  const char *const inputs[] = {arguments->guide, index, arguments->anchors.pivots};
  status = index ? add_history(&arguments->options, "stylize", image, inputs, arguments->anchors.pivots ? 3 : 2, error)
                 : sty_fail_memory(error, "history", 0);
  free(index);
  if (!status) status = sty_prepare_image(path, image, out, error);
  sty_destroy_image(&image);
  return status;
}

/* All or none: what was asked for appears once everything is written. */
static StyStatus write_pictures(const Arguments *arguments, const Work *work, StyError *error) {
  StyOutput outputs[3];
  int count = 0;
  StyStatus status = prepare_output(arguments, arguments->options.output, work, draw_picture, &outputs[count], error);
  if (!status) count++;
  if (!status && arguments->nnf) {
    status = prepare_output(arguments, arguments->nnf, work, draw_field, &outputs[count], error);
    if (!status) count++;
  }
  if (!status && arguments->chunks) {
    status = prepare_output(arguments, arguments->chunks, work, draw_chunks, &outputs[count], error);
    if (!status) count++;
  }
  for (int i = 0; i < count; i++) {
    if (status)
      sty_discard_output(&outputs[i]);
    else
      status = sty_commit_output(&outputs[i], error);
  }
  return status;
}

/* Share of pixels without a piece: no exemplar is that poor in directions. */
static const double hopeless = 0.5;

typedef struct Account {
  size_t covered, fallback;
  size_t unnamed;  /* pixels whose style.I is that of no style */
  double times[5]; /* load, read, transfer, blend, write */
} Account;

static StyStatus print_report(const Arguments *arguments, const Work *work, const Account *account, StyError *error) {
  static const char *const stages[] = {"load", "read", "transfer", "blend", "write"};
  const double share = account->covered ? (double)account->fallback / (double)account->covered : 0;
  if (!account->covered && !account->unnamed)
    warn(&arguments->options, "%s: found no covered pixel, expected a frame that shows something",
         clean_text(arguments->guide));
  if (share > hopeless)
    warn(&arguments->options,
         "%s: found no piece of the exemplar that fits %.1f %% of the pixels, expected a frame of the convention of "
         "the bundle's guide, or a larger threshold",
         clean_text(arguments->guide), 100 * share);
  if (account->unnamed)
    warn(&arguments->options, "%s: found %zu pixels whose style.I the bundle has no style for, expected 1 to %u, or 0",
         clean_text(arguments->guide), account->unnamed, work->bundle->textures[STY_BUNDLE_GUIDES].layers);
  if (arguments->options.json)
    return print_json(
        json_pack("{s:s, s:[ii], s:I, s:f, s:o, s:f}", "schema", "stylut-stylize/1", "size", work->filled.frame.width,
                  work->filled.frame.height, "covered", (json_int_t)account->covered, "fallback", share, "time_ms",
                  pack_times(stages, account->times, 5), "peak_bytes", get_peak_bytes()),
        error);
  if (arguments->options.quiet) return STY_OK;
  printf("%s: %dx%d, %zu pixels stylized, %.1f %% of them without a chunk\n", clean_text(arguments->options.output),
         work->filled.frame.width, work->filled.frame.height, account->covered, 100 * share);
  printf("load %.1f ms, read %.1f ms, transfer %.1f ms, blend %.1f ms, write %.1f ms\n", account->times[0],
         account->times[1], account->times[2], account->times[3], account->times[4]);
  return STY_OK;
}

static StyStatus stylize(const Arguments *arguments, Work *work, Account *account, StyError *error) {
  StyRun run = begin_progress(&arguments->options, "transfer");
  const double start = sty_get_milliseconds();
  StyStatus status = transfer_frame(work->bundle, &work->filled.frame, work->matches, &run, error);
  const double transferred = sty_get_milliseconds();
  end_progress(&arguments->options);
  run = begin_progress(&arguments->options, "blend");
  if (!status)
    status = blend_frame(work->bundle, &work->filled.frame, work->matches, work->bits, work->picture, &run, error);
  end_progress(&arguments->options);
  account->times[2] = transferred - start;
  account->times[3] = sty_get_milliseconds() - transferred;
  for (size_t i = 0; !status && i < (size_t)work->filled.frame.width * (size_t)work->filled.frame.height; i++) {
    account->covered += work->matches[i].level != STY_LEVEL_NONE;
    account->fallback += work->matches[i].level == STY_LEVEL_FALLBACK;
    account->unnamed += work->filled.styles && work->filled.styles[i] && work->filled.guide[4 * i + 3] > 0 &&
                        work->matches[i].level == STY_LEVEL_NONE;
  }
  return status;
}

/* 0 stands for "as the guide's style.I says". */
static StyStatus choose_style(const Arguments *arguments, const StyLoadedBundle *bundle, const StyImage *guide,
                              int *style, StyError *error) {
  if (arguments->style) return sty_find_style("--style", arguments->style, bundle, style, error);
  *style = sty_find_channel(guide, "style.I") ? 0 : 1;
  return STY_OK;
}

/* A frame that stands alone is number 0. */
static StyStatus anchor_frame(const Arguments *arguments, const StyImage *guide, Work *work, StyError *error) {
  StyPivotFile pivots;
  StyStatus status = open_pivots(&arguments->anchors, &pivots, error);
  if (status) return status;
  status = place_anchors(&arguments->anchors, &pivots, arguments->guide, guide, 0, 1, &work->anchors, error);
  work->filled.frame.anchors = work->anchors.places;
  work->filled.frame.anchor_count = work->anchors.count;
  sty_free_pivot_file(&pivots);
  return status;
}

static StyStatus run(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  Account account = {0};
  StyLoadedBundle bundle;
  const double start = sty_get_milliseconds();
  StyStatus status = sty_load_bundle(arguments->bundle, NULL, NULL, &bundle, error);
  if (status) return status;
  const double loaded = sty_get_milliseconds();
  Work work = {.bundle = &bundle.bundle, .bits = arguments->bits};
  StyImage *guide = NULL;
  int style = 0;
  status = read_guide(&arguments->options, arguments->guide, &guide, error);
  if (!status) status = choose_style(arguments, &bundle, guide, &style, error);
  if (!status) status = allocate_work(&work, sty_count_pixels(guide), error);
  if (!status) status = fill_frame(guide, style, &work.filled, error);
  if (!status) status = anchor_frame(arguments, guide, &work, error);
  sty_destroy_image(&guide);
  account.times[0] = loaded - start;
  account.times[1] = sty_get_milliseconds() - loaded;
  if (!status && arguments->options.dry_run) {
    status = report_dry_run(&arguments->options, "%dx%d pixels", work.filled.frame.width, work.filled.frame.height);
  } else if (!status) {
    status = stylize(arguments, &work, &account, error);
    const double before = sty_get_milliseconds();
    if (!status) status = write_pictures(arguments, &work, error);
    account.times[4] = sty_get_milliseconds() - before;
    if (!status) status = print_report(arguments, &work, &account, error);
  }
  destroy_work(&work);
  sty_unload_bundle(&bundle);
  return status;
}

StyStatus run_stylize(int argc, char **argv) {
  Arguments arguments = {.bits = 8};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments);
  return finish_command(&arguments.options, status);
}
