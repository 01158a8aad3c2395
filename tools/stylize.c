/* stylut stylize BUNDLE --guide FRAME -o OUT.png: the runtime on a frame, or on a sequence of them. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "anchors.h"
#include "commands.h"
#include "options.h"
#include "parameters.h"
#include "passes.h"
#include "sequence.h"
#include "stylize_frame.h"
#include "stylize_measure.h"
#include "stylut/file.h"
#include "stylut/image_io.h"
#include "stylut/pack.h"
#include "stylut/parse.h"

typedef struct Arguments {
  Options options;
  const char *bundle, *guide, *style, *range, *measure;
  const char *outputs[OUTPUTS]; /* the first is options.output */
  int bits, method, resolution;
  bool skip_missing, force;
  double fps, flicker;
  AnchorOptions anchors;
  Settings settings;
} Arguments;

enum {
  KEY_GUIDE = 0x200,
  KEY_STYLE,
  KEY_NNF,
  KEY_CHUNKS,
  KEY_FLAT,
  KEY_BITS,
  KEY_METHOD,
  KEY_RESOLUTION,
  KEY_ANCHOR,
  KEY_PIVOTS,
  KEY_FRAMES,
  KEY_SKIP_MISSING,
  KEY_FORCE,
  KEY_FPS,
  KEY_FLICKER,
  KEY_MEASURE,
  KEY_SET
};

static const char *const method_names[] = {"styleblit", "lit-sphere", "brute", NULL};
static const char *const resolution_names[] = {"half", "full", "double", NULL};

static const struct argp_option options_table[] = {
    {"guide", KEY_GUIDE, "FRAME", 0,
     "guide of the frame: EXR, or an 8- or 16-bit normal map; of a sequence, with %04d or the like for the number, as "
     "in "
     "all names of outputs then",
     0},
    {"style", KEY_STYLE, "N|NAME", 0, "style, by number or name (default: the guide's style.I channel, else 1)", 0},
    {"bits", KEY_BITS, "8|16", 0, "precision of the picture (default: 8)", 0},
    {"nnf", KEY_NNF, "FILE.png", 0,
     "write the nearest-neighbour field, of the guide's size: 16 bit, R = source x, G = source y, A = covered",
     UNRECORDED},
    {"chunks", KEY_CHUNKS, "FILE.png", 0, "write the chunks: one colour for each piece copied as a whole", UNRECORDED},
    {"flat", KEY_FLAT, "FILE.png", 0,
     "write where the guide is flat: white where 64x64 pixels face one way, so that a patch may repeat", UNRECORDED},
    {"method", KEY_METHOD, "NAME", 0,
     "styleblit (default), lit-sphere (each pixel for itself, as a matcap) or brute (StyleBlit as first stated, for "
     "small "
     "pictures)",
     0},
    {"resolution", KEY_RESOLUTION, "NAME", 0,
     "half (pieces are found for every second pixel), full (default) or double (the guide has twice the picture's "
     "size; "
     "pieces get smooth edges)",
     0},
    {"anchor", KEY_ANCHOR, "screen|object", 0,
     "what pieces ride on: the screen, or each object's pivot, so that one that moves takes its pieces along (default: "
     "screen)",
     0},
    {"pivots", KEY_PIVOTS, "FILE.json", 0,
     "objects' pivots in pixels (default: as the guide's metadata say): {\"schema\": \"stylut-pivots/1\", \"pivots\": "
     "{\"1\": [x, y], ...}}, or \"frames\": {\"1\": {\"1\": [x, y], ...}, ...}",
     0},
    {"frames", KEY_FRAMES, "A[-B[xSTEP]]", 0, "frames of the sequence (default: those on disk, none missing between)",
     UNRECORDED},
    {"skip-missing", KEY_SKIP_MISSING, NULL, 0, "go on where a frame of the sequence is missing", UNRECORDED},
    {"force", KEY_FORCE, NULL, 0, "draw frames anew that are there, made by this command of these inputs", UNRECORDED},
    {"flicker", KEY_FLICKER, "D", 0,
     "drawings a second: so often pieces are laid anew, 0 for never (default: as the bundle says)", 0},
    {"set", KEY_SET, "[STYLE.]KEY=VALUE", 0, "a parameter in place of the bundle's (as of 'params'); may be repeated",
     0},
    {"fps", KEY_FPS, "F", 0, "frames a second, for --flicker (default: 24)", 0},
    {"measure", KEY_MEASURE, "FILE.json", 0,
     "how steady and how coarse the sequence is: warping error and jumps (where the guides have motion.U and "
     "motion.V), "
     "SSIM, FLIP, chunks, levels, repetition",
     UNRECORDED},
    {0},
};

static const char *const output_options[OUTPUTS] = {"--output", "--nnf", "--chunks", "--flat"};

/* More digits than any pattern asks for, so that %d and %04d name one file. */
enum { ANY_FRAME = 1000000000 };

/* Whether two names, there or not, mean one file: by the folders' identity, and by what stands behind them. */
static bool is_same_name(const char *a, const char *b) {
  char *const folders[2] = {sty_get_folder(a), sty_get_folder(b)};
  char *const frames[2] = {name_frame(sty_get_base_name(a), ANY_FRAME), name_frame(sty_get_base_name(b), ANY_FRAME)};
  struct stat info[2];
  const bool is_same = folders[0] && folders[1] && frames[0] && frames[1] && strcmp(frames[0], frames[1]) == 0 &&
                       stat(folders[0], &info[0]) == 0 && stat(folders[1], &info[1]) == 0 &&
                       info[0].st_dev == info[1].st_dev && info[0].st_ino == info[1].st_ino;
  for (int i = 0; i < 2; i++) {
    free(folders[i]);
    free(frames[i]);
  }
  return is_same;
}

/* Whether a name means a file of the bundle. */
static StyStatus find_in_bundle(const char *bundle, const char *path, bool *out, StyError *error) {
  const char *const more[] = {STY_BUNDLE_INDEX, STY_IMPORT_SETTINGS};
  *out = false;
  for (int i = 0; i < STY_BUNDLE_FILES + 2 && !*out; i++) {
    char *file = sty_join_path(bundle, i < STY_BUNDLE_FILES ? sty_bundle_files[i] : more[i - STY_BUNDLE_FILES]);
    if (!file) return sty_fail_memory(error, bundle, 0);
    *out = is_same_name(file, path);
    free(file);
  }
  return STY_OK;
}

/* What is written may be no input, and nothing else that is written. */
static StyStatus check_written(const Arguments *arguments, const char *option, const char *path, StyError *error) {
  const char *const *outputs = arguments->outputs, *const pivots = arguments->anchors.pivots;
  bool is_input = is_same_name(path, arguments->guide) || (pivots && is_same_name(path, pivots));
  const StyStatus status = is_input ? STY_OK : find_in_bundle(arguments->bundle, path, &is_input, error);
  if (status) return status;
  if (is_input)
    return sty_fail(error, STY_ERROR_USAGE, "option '%s': found %s, which is an input, expected another name", option,
                    path);
  for (int i = 0; i < OUTPUTS; i++)
    if (outputs[i] && outputs[i] != path && is_same_name(outputs[i], path))
      return sty_fail(error, STY_ERROR_USAGE, "option '%s': found '%s' twice, expected a name of its own", option,
                      path);
  return STY_OK;
}

static StyStatus check_picture(const char *option, const char *path, StyError *error) {
  StyImageFormat format;
  if (sty_get_image_format(path, &format, NULL) || format != STY_IMAGE_PNG)
    return sty_fail(error, STY_ERROR_USAGE, "option '%s': found '%s', expected a name that ends in .png", option, path);
  return STY_OK;
}

static StyStatus check_patterns(Arguments *arguments) {
  const char *const *paths = arguments->outputs;
  StyError *error = &arguments->options.error;
  bool is_sequence, is_pattern;
  StyStatus status = find_pattern("--guide", arguments->guide, &is_sequence, error);
  for (int i = 0; !status && i < OUTPUTS; i++) {
    if (!paths[i]) continue;
    status = find_pattern(output_options[i], paths[i], &is_pattern, error);
    if (!status && is_pattern != is_sequence)
      status = sty_fail(error, STY_ERROR_USAGE, "option '%s': found '%s', expected %s", output_options[i], paths[i],
                        is_sequence ? "%d or %0Nd for the frame's number, as in --guide's name"
                                    : "no place for a number, since --guide's name has none");
  }
  const OptionNeed needs[] = {{"frames", is_sequence, "a sequence: %d or %0Nd in --guide's name"},
                              {"skip-missing", is_sequence, "a sequence: %d or %0Nd in --guide's name"},
                              {"force", is_sequence, "a sequence: %d or %0Nd in --guide's name"},
                              {"flicker", is_sequence, "a sequence: %d or %0Nd in --guide's name"},
                              {"measure", arguments->resolution != RESOLUTION_DOUBLE, "--resolution half or full"},
                              {"fps", arguments->flicker > 0, "--flicker"},
                              {"anchor", arguments->method == METHOD_STYLEBLIT, "--method styleblit"},
                              {"resolution", arguments->method == METHOD_STYLEBLIT, "--method styleblit"},
                              {"chunks", arguments->method != METHOD_LIT_SPHERE, "--method styleblit or brute"}};
  return status ? status : check_needs(&arguments->options, needs, sizeof needs / sizeof *needs);
}

/* A drawing lasts a whole number of frames. */
static StyStatus check_flicker(Arguments *arguments) {
  if (arguments->flicker == 0) return STY_OK;
  const double period = arguments->fps / arguments->flicker;
  if (period >= 1 && period <= STY_MAX_PERIOD && period == (double)(int)period) return STY_OK;
  return sty_fail(&arguments->options.error, STY_ERROR_USAGE,
                  "option '--flicker': found %g drawings for %g frames a second, expected a number that divides them",
                  arguments->flicker, arguments->fps);
}

static StyStatus check_arguments(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  StyStatus status = require_argument(&arguments->options, arguments->bundle, "the bundle's folder");
  if (!status && !arguments->guide)
    status = sty_fail(error, STY_ERROR_USAGE, "option '--guide': found none, expected the frame's guide");
  if (!status) status = require_output(&arguments->options);
  if (status) return status;
  const char *const *paths = arguments->outputs;
  arguments->outputs[OUTPUT_PICTURE] = arguments->options.output;
  for (int i = 0; !status && i < OUTPUTS; i++)
    if (paths[i]) status = check_picture(output_options[i], paths[i], error);
  const char *const inputs[] = {arguments->guide, arguments->anchors.pivots};
  for (int i = 0; !status && i < OUTPUTS; i++) {
    if (!paths[i]) continue;
    status = check_written(arguments, output_options[i], paths[i], error);
    if (!status) status = protect_inputs(&arguments->options, paths[i], inputs, 2); /* links */
  }
  if (!status && arguments->measure) status = require_folder(&arguments->options, arguments->measure);
  if (!status && arguments->measure) status = check_written(arguments, "--measure", arguments->measure, error);
  if (!status) status = protect_inputs(&arguments->options, arguments->measure, inputs, 2);
  if (!status && arguments->measure)
    status = refuse_pattern("--measure", arguments->measure, "one file for all frames", error);
  if (!status) status = check_patterns(arguments);
  if (!status) status = check_flicker(arguments);
  return status ? status : check_anchors(&arguments->options, &arguments->anchors);
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  const ChoiceOption choices[] = {{KEY_METHOD, "--method", method_names, &arguments->method},
                                  {KEY_RESOLUTION, "--resolution", resolution_names, &arguments->resolution},
                                  {KEY_ANCHOR, "--anchor", anchor_kinds, &arguments->anchors.kind}};
  const NumberOption numbers[] = {{KEY_FPS, "--fps", 1, 1000, &arguments->fps},
                                  {KEY_FLICKER, "--flicker", 0, 1000, &arguments->flicker}};
  StyStatus status = STY_OK;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: status = take_argument(&arguments->options, &arguments->bundle, text); break;
    case ARGP_KEY_END: status = check_arguments(arguments); break;
    case KEY_GUIDE: arguments->guide = text; break;
    case KEY_STYLE: arguments->style = text; break;
    case KEY_NNF: arguments->outputs[OUTPUT_FIELD] = text; break;
    case KEY_CHUNKS: arguments->outputs[OUTPUT_CHUNKS] = text; break;
    case KEY_FLAT: arguments->outputs[OUTPUT_FLAT] = text; break;
    case KEY_PIVOTS: arguments->anchors.pivots = text; break;
    case KEY_FRAMES: arguments->range = text; break;
    case KEY_SKIP_MISSING: arguments->skip_missing = true; break;
    case KEY_FORCE: arguments->force = true; break;
    case KEY_SET: status = take_setting(&arguments->options, &arguments->settings, text); break;
    case KEY_MEASURE: arguments->measure = text; break;
    case KEY_BITS: status = parse_bits(&arguments->options, text, &arguments->bits); break;
    case KEY_FPS:
    case KEY_FLICKER: return parse_number_option(&arguments->options, numbers, 2, key, text);
    default: return parse_choice_option(&arguments->options, choices, 3, key, text);
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
        "way.\vThe picture's alpha is the frame's coverage times the exemplar's alpha.\n\nFrames of a sequence are "
        "drawn side by side on all threads. Those that are there already, made by the same command of the same inputs, "
        "are kept, so that a run that was cut off goes on where it was.",
    .children = children,
};

/* ---- frames ----------------------------------------------------------------------- */

/* Names of one frame of a sequence; they are the caller's. */
typedef struct Names {
  FrameFiles files;
  char *guide, *outputs[OUTPUTS];
} Names;

static void free_names(Names *names) {
  free(names->guide);
  for (int i = 0; i < OUTPUTS; i++) free(names->outputs[i]);
}

static StyStatus make_names(const Arguments *arguments, int number, Names *out, StyError *error) {
  bool failed = !(out->guide = name_frame(arguments->guide, number));
  out->files = (FrameFiles){.guide = out->guide, .number = number};
  for (int i = 0; i < OUTPUTS; i++) {
    if (!arguments->outputs[i]) continue;
    out->files.outputs[i] = out->outputs[i] = name_frame(arguments->outputs[i], number);
    failed |= !out->outputs[i];
  }
  return failed ? sty_fail_memory(error, "frame", 0) : STY_OK;
}

/* A frame in the making. */
typedef struct Slot {
  Names names;
  Work work;
  bool is_kept, is_drawn;
} Slot;

/* Frames side by side: as many as there are threads. */
enum { MOST_SLOTS = 64 };
typedef struct Batch {
  const Arguments *arguments;
  const Request *request;
  bool is_sequence;
  const int *numbers;
  int count;
  StyRun inner; /* of one frame */
  Slot slots[MOST_SLOTS];
} Batch;

static StyStatus draw_slot(void *context, long i, StyError *error) {
  Batch *batch = context;
  Slot *slot = &batch->slots[i];
  const FrameFiles *files = &slot->names.files;
  const bool is_measured = batch->arguments->measure;
  StyStatus status = make_names(batch->arguments, batch->numbers[i], &slot->names, error);
  if (status) return status;
  slot->is_kept = batch->is_sequence && !batch->arguments->force && is_kept(batch->request, files);
  if (slot->is_kept && !is_measured) return STY_OK;
  status = open_work(batch->request, files, &slot->work, error);
  if (!status) status = draw_work(batch->request, files, &slot->work, &batch->inner, error);
  slot->is_drawn = !status;
  if (!status && !slot->is_kept) status = write_work(batch->request, files, &slot->work, error);
  return status;
}

/* What all frames together took and gave. */
typedef struct Account {
  int drawn, kept;
  int width, height;
  size_t covered, fallback;
  double times[5]; /* load, read, transfer, blend, write */
  Review review;
} Account;

static void account_for(Account *account, const Slot *slot) {
  account->kept += slot->is_kept;
  account->drawn += !slot->is_kept;
  if (!slot->is_drawn) return;
  account->width = slot->work.width;
  account->height = slot->work.height;
  account->covered += slot->work.covered;
  account->fallback += slot->work.fallback;
  for (int t = 0; t < 4; t++) account->times[t + 1] += slot->work.times[t];
}

/* Reviews and measures a batch in the order of its frames, and empties it. */
static StyStatus end_batch(Batch *batch, Measures *measures, const StyRun *run, Account *account, StyError *error) {
  StyStatus status = STY_OK;
  for (int i = 0; i < batch->count; i++) {
    Slot *slot = &batch->slots[i];
    if (slot->is_drawn) review_work(batch->request, &slot->names.files, &slot->work, &account->review);
    if (!status && measures && slot->is_drawn)
      status = measure_work(measures, batch->request, &slot->names.files, &slot->work, run, error);
    account_for(account, slot);
    close_work(&slot->work);
    free_names(&slot->names);
    *slot = (Slot){.is_kept = false};
  }
  return status;
}

static StyStatus draw_frames(const Arguments *arguments, const Request *request, const Sequence *sequence,
                             Measures *measures, Account *account, StyError *error) {
  Batch *batch = calloc(1, sizeof *batch);
  if (!batch) return sty_fail_memory(error, "frames", sizeof *batch);
  StyRun run = begin_progress(&arguments->options, sequence->is_pattern ? "frames" : "transfer");
  const StyRun quiet = {.threads = run.threads};
  const int threads = sty_get_threads(&run), most = threads < MOST_SLOTS ? threads : MOST_SLOTS;
  StyStatus status = STY_OK;
  *batch = (Batch){.arguments = arguments, .request = request, .is_sequence = sequence->is_pattern, .inner = run};
  if (sequence->is_pattern) batch->inner = (StyRun){.threads = 1};
  for (int first = 0; !status && first < sequence->count; first += batch->count) {
    batch->numbers = sequence->numbers + first;
    batch->count = sequence->count - first < most ? sequence->count - first : most;
    status = sequence->is_pattern ? sty_parallel_for(&quiet, batch->count, draw_slot, batch, error)
                                  : draw_slot(batch, 0, error);
    StyError ignored;
    const StyStatus ended = end_batch(batch, status ? NULL : measures, &quiet, account, status ? &ignored : error);
    status = status ? status : ended;
    if (sequence->is_pattern && run.progress)
      run.progress(run.context, (double)(first + batch->count) / sequence->count);
  }
  end_progress(&arguments->options);
  end_review(request, arguments->guide, &account->review);
  if (!status && measures) review_measures(measures, request, arguments->guide);
  free(batch);
  return status;
}

/* ---- reports ---------------------------------------------------------------------- */

static void print_still(const Arguments *arguments, const Account *account, double share) {
  printf("%s: %dx%d, %zu pixels stylized", clean_text(arguments->options.output), account->width, account->height,
         account->covered);
  if (arguments->method != METHOD_LIT_SPHERE) /* which has no chunks */
    printf(", %.1f %% of them without a chunk", 100 * share);
  putchar('\n');
}

static StyStatus print_report(const Arguments *arguments, const Sequence *sequence, const Account *account,
                              const Measures *measures, StyError *error) {
  static const char *const stages[] = {"load", "read", "transfer", "blend", "write"};
  const double share = account->covered ? (double)account->fallback / (double)account->covered : 0;
  if (arguments->options.json) {
    json_t *report = json_pack("{s:s, s:[ii], s:I, s:f, s:o, s:f}", "schema", "stylut-stylize/1", "size",
                               account->width, account->height, "covered", (json_int_t)account->covered, "fallback",
                               share, "time_ms", pack_times(stages, account->times, 5), "peak_bytes", get_peak_bytes());
    if (sequence->is_pattern) {
      json_object_set_new(report, "drawn", json_integer(account->drawn));
      json_object_set_new(report, "kept", json_integer(account->kept));
      json_object_set_new(report, "missing", json_integer(sequence->missing));
    }
    return print_json(report, error);
  }
  if (arguments->options.quiet) return STY_OK;
  if (sequence->is_pattern)
    printf("%s: %d frame%s drawn, %d kept, %d missing\n", clean_text(arguments->options.output), account->drawn,
           account->drawn == 1 ? "" : "s", account->kept, sequence->missing);
  else
    print_still(arguments, account, share);
  printf("load %.1f ms, read %.1f ms, transfer %.1f ms, blend %.1f ms, write %.1f ms\n", account->times[0],
         account->times[1], account->times[2], account->times[3], account->times[4]);
  if (measures) print_measures(measures);
  return STY_OK;
}

static StyStatus write_measures(const Arguments *arguments, const Measures *measures, StyError *error) {
  json_t *report = pack_measures(measures);
  const StyStatus status = sty_write_json(arguments->measure, report, error);
  json_decref(report);
  return status;
}

/* ---- the command ------------------------------------------------------------------ */

/* What was asked for in place of the bundle's parameters. */
static StyStatus set_parameters(const Arguments *arguments, StyLoadedBundle *loaded, StyError *error) {
  char period[64];
  StyStatus status = STY_OK;
  const bool flickers = is_given(&arguments->options, "flicker");
  snprintf(period, sizeof period, "jitter_period=%.0f",
           arguments->flicker > 0 ? arguments->fps / arguments->flicker : 0.0);
  if (flickers) status = sty_set_bundle_parameter("option '--flicker'", period, loaded, error);
  if (!status) status = apply_settings(&arguments->settings, loaded, error);
  if (!status && (flickers || arguments->settings.count > 0)) review_bundle_parameters(&arguments->options, loaded);
  return status;
}

static StyStatus stylize(const Arguments *arguments, const Request *request, const Sequence *sequence, Account *account,
                         StyError *error) {
  Measures *measures = arguments->measure ? open_measures() : NULL;
  StyStatus status = arguments->measure && !measures
                         ? sty_fail_memory(error, "measures", 0)
                         : draw_frames(arguments, request, sequence, measures, account, error);
  if (!status && measures) status = write_measures(arguments, measures, error);
  if (!status) status = print_report(arguments, sequence, account, measures, error);
  close_measures(&measures);
  return status;
}

/* Looks at the first frame, so that what can't be done is refused. */
static StyStatus plan(Arguments *arguments, const Request *request, const Sequence *sequence, StyError *error) {
  Names names = {.guide = NULL};
  Work work = {.motion = NULL};
  Review review = {{0}};
  StyStatus status = make_names(arguments, sequence->numbers[0], &names, error);
  if (!status) status = open_work(request, &names.files, &work, error);
  if (!status) review_channels(request, &names.files, &work, &review);
  if (!status)
    status = report_dry_run(&arguments->options, "%d frame%s of %dx%d pixels", sequence->count,
                            sequence->count == 1 ? "" : "s", work.width, work.height);
  close_work(&work);
  free_names(&names);
  return status;
}

static StyStatus run(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  StyLoadedBundle loaded;
  Sequence sequence = {.numbers = NULL};
  StyPivotFile pivots;
  Account account = {0};
  const double start = sty_get_milliseconds();
  StyStatus status = list_frames(arguments->guide, arguments->range, arguments->skip_missing, &sequence, error);
  if (status) return status;
  status = sty_load_bundle(arguments->bundle, NULL, NULL, &loaded, error);
  if (status) {
    free(sequence.numbers);
    return status;
  }
  const Request request = {.options = &arguments->options,
                           .bundle_path = arguments->bundle,
                           .loaded = &loaded,
                           .bundle = &loaded.bundle,
                           .style = arguments->style,
                           .method = arguments->method,
                           .resolution = arguments->resolution,
                           .bits = arguments->bits,
                           .anchors = &arguments->anchors,
                           .pivots = &pivots,
                           .path = get_asked_path()};
  status = open_pivots(&arguments->anchors, &pivots, error);
  account.times[0] = sty_get_milliseconds() - start;
  if (!status) {
    status = set_parameters(arguments, &loaded, error);
    if (!status && arguments->options.dry_run)
      status = plan(arguments, &request, &sequence, error);
    else if (!status)
      status = stylize(arguments, &request, &sequence, &account, error);
    sty_free_pivot_file(&pivots);
  }
  free(sequence.numbers);
  sty_unload_bundle(&loaded);
  return status;
}

StyStatus run_stylize(int argc, char **argv) {
  Arguments arguments = {.bits = 8, .method = METHOD_STYLEBLIT, .resolution = RESOLUTION_FULL, .fps = 24};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments);
  return finish_command(&arguments.options, status);
}
