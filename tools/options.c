#include "options.h"

#include <errno.h>
#include <libgen.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "stylut/ceilings.h"
#include "stylut/file.h"
#include "stylut/image_io.h"
#include "stylut/parse.h"

enum {
  KEY_FORMAT = 0x100,
  KEY_PROGRESS,
  KEY_LIMIT,
  KEY_DRY_RUN,
  KEY_NO_HISTORY,
  KEY_SEED,
  KEY_USAGE,
  KEY_TREES,
  KEY_CHECKS,
  KEY_PRECISION
};

static const char *const progress_modes[] = {"auto", "bar", "json", "none", NULL};
enum { PROGRESS_AUTO, PROGRESS_BAR, PROGRESS_JSON, PROGRESS_NONE };

static const int largest_thread_count = 1024;

/* ---- groups ---- */

static error_t parse_common(int key, char *argument, struct argp_state *state) {
  static const char *const formats[] = {"text", "json", NULL};
  Options *options = state->input;
  long long number;
  int choice;
  StyStatus status = STY_OK;
  switch (key) {
    case 'j':
      status = sty_parse_integer("--threads", argument, 1, largest_thread_count, &number, &options->error);
      if (!status) options->threads = (int)number;
      break;
    case 'q': options->quiet = true; break;
    case 'v': options->verbose = true; break;
    case KEY_FORMAT:
      status = sty_parse_choice("--format", argument, formats, &choice, &options->error);
      if (!status) options->json = choice == 1;
      break;
    case KEY_PROGRESS:
      status = sty_parse_choice("--progress", argument, progress_modes, &options->progress, &options->error);
      break;
    case KEY_LIMIT: status = sty_set_ceiling("--limit", argument, &options->error); break;
    default: return ARGP_ERR_UNKNOWN;
  }
  options->reached = state->next;
  return end_option(status);
}

static const struct argp_option common_options[] = {
    {NULL, 0, NULL, 0, "Common options:", 90},
    {"threads", 'j', "N", 0,
     "use N threads (default: one per core; one where times are charted); results are the same for any number", 0},
    {"quiet", 'q', NULL, 0, "print nothing but errors", 0},
    {"verbose", 'v', NULL, 0, "say on stderr how long each stage took", 0},
    {"format", KEY_FORMAT, "text|json", 0, "how results are printed (default: text)", 0},
    {"progress", KEY_PROGRESS, "auto|bar|json|none", 0,
     "progress of long work on stderr, by stage, with the time left (default: a bar on a terminal)", 0},
    {"limit", KEY_LIMIT, "NAME=N", 0,
     "refuse files beyond it; may be repeated: pixels of a picture (default: 268435456), json-bytes (16777216), "
     "import-seconds and import-bytes of a mesh that isn't a binary PLY (by its size)",
     0},
    {"help", '?', NULL, 0, "print this and do nothing", 0},
    {"usage", KEY_USAGE, NULL, 0, "print the options alone and do nothing", 0},
    {0},
};

const struct argp common_argp = {.options = common_options, .parser = parse_common};

static error_t parse_output(int key, char *argument, struct argp_state *state) {
  Options *options = state->input;
  switch (key) {
    case 'o': options->output = argument; break;
    case KEY_DRY_RUN: options->dry_run = true; break;
    case KEY_NO_HISTORY: options->no_history = true; break;
    default: return ARGP_ERR_UNKNOWN;
  }
  options->reached = state->next;
  return 0;
}

static const struct argp_option output_options[] = {
    {NULL, 0, NULL, 0, "Output options:", 80},
    {"output", 'o', "FILE", 0, "where the result goes; it appears whole or not at all", 0},
    {"dry-run", KEY_DRY_RUN, NULL, 0, "check the inputs and say what would be done; write nothing", 0},
    {"no-history", KEY_NO_HISTORY, NULL, 0, "leave version, command and input hashes out of the file", 0},
    {0},
};

const struct argp output_argp = {.options = output_options, .parser = parse_output};

static error_t parse_seed(int key, char *argument, struct argp_state *state) {
  Options *options = state->input;
  if (key != KEY_SEED) return ARGP_ERR_UNKNOWN;
  long long number;
  begin_option(key, argument, state);
  const StyStatus status = sty_parse_integer("--seed", argument, 0, INT64_MAX, &number, &options->error);
  if (!status) options->seed = (uint64_t)number;
  return end_option(status);
}

static const struct argp_option seed_options[] = {
    {"seed", KEY_SEED, "N", 0, "seed of everything random (default: 0)", 70},
    {0},
};

const struct argp seed_argp = {.options = seed_options, .parser = parse_seed};

static StyStatus set_engine(Options *options, const char *name) {
  options->engine = NULL;
  return strcmp(name, "auto") == 0 ? STY_OK : sty_find_engine("--engine", name, &options->engine, &options->error);
}

static error_t parse_engine(int key, char *argument, struct argp_state *state) {
  Options *options = state->input;
  StyError *error = &options->error;
  long long number = 0;
  StyStatus status = STY_OK;
  if (key != 'e' && key != KEY_TREES && key != KEY_CHECKS && key != KEY_PRECISION) return ARGP_ERR_UNKNOWN;
  begin_option(key, argument, state);
  if (key != 'e') options->tuning[key - KEY_TREES] = true;
  switch (key) {
    case 'e': status = set_engine(options, argument); break;
    case KEY_TREES:
      status = sty_parse_integer("--trees", argument, 1, 64, &number, error);
      options->engine_options.trees = (int)number;
      break;
    case KEY_CHECKS:
      status = sty_parse_integer("--checks", argument, 1, 1000000, &number, error);
      options->engine_options.checks = (int)number;
      break;
    default:
      status = sty_parse_number("--precision", argument, 0.01, 1, &options->engine_options.precision, error);
      break;
  }
  return end_option(status);
}

static const struct argp_option engine_options[] = {
    {NULL, 0, NULL, 0, "Engines:", 60},
    {"engine", 'e', "NAME", 0,
     "exact: brute, flann-single, cgal (2 or 3 dimensions), grid (2), or auto: the fastest of them; approximate: "
     "analytic (2), flann-forest, flann-auto (default: auto)",
     0},
    {"trees", KEY_TREES, "N", 0, "trees of flann-forest, 1 to 64 (default: 4)", 0},
    {"checks", KEY_CHECKS, "N", 0, "leaves that flann-forest looks at (default: 32)", 0},
    {"precision", KEY_PRECISION, "SHARE", 0,
     "exact answers that flann-auto aims at, on a sample of what is asked, 0.01 to 1 (default: 0.9)", 0},
    {0},
};

const struct argp engine_argp = {.options = engine_options, .parser = parse_engine};

StyStatus choose_engine(Options *options, StyTask task, int dims, const StyEngine **out) {
  const StyEngine *engine = options->engine ? options->engine : sty_get_fastest_engine(task, dims);
  static const char *const tunings[] = {"trees", "checks", "precision"}, *const heeded_by[] = {"flann-forest",
                                                                                               "flann-forest",
                                                                                               "flann-auto"};
  for (int t = 0; t < TUNINGS; t++)
    if (options->tuning[t] && strcmp(engine->name, heeded_by[t]) != 0)
      return sty_fail(&options->error, STY_ERROR_USAGE,
                      "--%s: found with engine %s, which doesn't heed it, expected %s", tunings[t], engine->name,
                      heeded_by[t]);
  *out = engine;
  return sty_check_dims(engine, dims, &options->error);
}

/* ---- parsing ---- */

static const struct argp_option *find_option(const struct argp *argp, int key) {
  for (const struct argp_option *o = argp->options; o && (o->name || o->doc); o++)
    if (o->name && o->key == key) return o;
  return NULL;
}

/* Appends " --name=value" or " value". */
static void record(Options *options, const char *name, const char *value) {
  char *grown = NULL;
  const char *so_far = options->history ? options->history : "";
  if (asprintf(&grown, "%s%s%s%s%s%s", so_far, *so_far ? " " : "", name ? "--" : "", name ? name : "",
               name && value ? "=" : "", value ? value : "") < 0) {
    sty_fail_memory(&options->error, "history", (double)strlen(so_far)); /* parse_arguments sees it */
    return;
  }
  free(options->history);
  options->history = grown;
}

bool is_given(const Options *options, const char *name) {
  for (int g = 0; g < options->given_count; g++)
    if (strcmp(options->given[g], name) == 0) return true;
  return false;
}

/* The word that getopt gave up at: the one before the next, unless that was done
 * with; then options follow in the same word as the unknown one ("-xyz"). */
static int find_stop(const Options *options, const struct argp_state *state) {
  const int before = state->next - 1;
  const bool was_option = before > 0 && state->argv[before][0] == '-' && state->argv[before][1];
  return was_option && state->next != options->reached ? before : state->next;
}

void begin_option(int key, const char *argument, const struct argp_state *state) {
  Options *options = state->input;
  if (key == ARGP_KEY_INIT) {
    const struct argp_child *children = state->root_argp->children;
    for (int i = 0; children && children[i].argp; i++) state->child_inputs[i] = state->input;
    return;
  }
  if (key == ARGP_KEY_ERROR) {
    options->stopped_at = find_stop(options, state);
    return;
  }
  if (key == ARGP_KEY_ARG) {
    record(options, NULL, argument);
    return;
  }
  options->reached = state->next;
  const struct argp_option *option = find_option(state->root_argp, key);
  const struct argp_child *groups = state->root_argp->children;
  for (int g = 0; !option && groups && groups[g].argp; g++) option = find_option(groups[g].argp, key);
  if (!option) return;
  if (option->group != UNRECORDED) record(options, option->name, argument);
  if (!is_given(options, option->name) && options->given_count < MOST_OPTIONS)
    options->given[options->given_count++] = option->name;
}

error_t end_option(StyStatus status) { return status ? EINVAL : 0; }

/* A command's g-th group of shared options, or NULL. */
static const struct argp *get_group(const struct argp *argp, int g) {
  return argp->children ? argp->children[g].argp : NULL;
}

/* argp's own messages come in two lines and in its own words; this is ours. */
static StyStatus explain_option(const struct argp *argp, const char *program, const char *given, StyError *error) {
  const size_t length = strcspn(given, "=");
  const struct argp *group = argp;
  for (int g = 0; group; group = get_group(argp, g++))
    for (const struct argp_option *o = group->options; o && (o->name || o->doc); o++) {
      const bool is_long = o->name && strncmp(given, "--", 2) == 0 && strlen(o->name) == length - 2 &&
                           strncmp(given + 2, o->name, length - 2) == 0;
      const bool is_short = given[0] == '-' && given[1] != '-' && given[1] == o->key && length == 2;
      if ((is_long || is_short) && o->arg && !given[length])
        return sty_fail(error, STY_ERROR_USAGE, "option '%s': found no value, expected %s", given, o->arg);
      if ((is_long || is_short) && !o->arg && given[length])
        return sty_fail(error, STY_ERROR_USAGE, "option '%s': found a value, expected none", given);
    }
  return sty_fail(error, STY_ERROR_USAGE, "found '%s', expected an option that '%s --help' lists", given, program);
}

/* "--output" for "-o", "--output=" and "--output". */
static void get_long_name(const struct argp *argp, const char *given, char *out, size_t size) {
  snprintf(out, size, "%.*s", (int)strcspn(given, "="), given);
  if (given[0] != '-' || given[1] == '-') return;
  const struct argp *group = argp;
  for (int g = 0; group; group = get_group(argp, g++)) {
    const struct argp_option *option = find_option(group, given[1]);
    if (option) snprintf(out, size, "--%s", option->name);
  }
}

StyStatus parse_arguments(const struct argp *argp, int argc, char **argv, void *arguments) {
  Options *options = arguments;
  /* Told to keep its own messages to itself, argp keeps its help to itself too. */
  for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++) {
    const bool help = strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-?") == 0;
    const bool usage = strcmp(argv[i], "--usage") == 0;
    const size_t length = strlen(argv[i]);
    if (length == 0 || (argv[i][0] == '-' && argv[i][length - 1] == '=')) {
      char name[64];
      get_long_name(argp, length ? argv[i] : argv[i - 1], name, sizeof name);
      return sty_fail(&options->error, STY_ERROR_USAGE,
                      "%s '%s': found an empty value, expected one that says something",
                      name[0] == '-' ? "option" : "argument after", name);
    }
    if (!help && !usage) continue;
    argp_help(argp, stdout, help ? ARGP_HELP_SHORT_USAGE | ARGP_HELP_LONG | ARGP_HELP_DOC : ARGP_HELP_USAGE, argv[0]);
    options->helped = true;
    return STY_OK;
  }
  options->words = calloc((size_t)argc + 1, sizeof *options->words);
  if (!options->words) return sty_fail_memory(&options->error, "options", (double)argc * sizeof *options->words);
  memcpy(options->words, argv, (size_t)argc * sizeof *options->words);
  const error_t failed = argp_parse(argp, argc, argv, ARGP_NO_ERRS | ARGP_NO_HELP, NULL, arguments);
  if (!failed || options->error.status) return options->error.status;
  const int stop = options->stopped_at;
  return explain_option(argp, argv[0], stop > 0 && stop < argc ? argv[stop] : "", &options->error);
}

StyStatus check_needs(Options *options, const OptionNeed *needs, int count) {
  for (int n = 0; n < count; n++)
    if (!needs[n].is_met && is_given(options, needs[n].name))
      return sty_fail(&options->error, STY_ERROR_USAGE, "--%s: found where it changes nothing, expected it with %s",
                      needs[n].name, needs[n].expected);
  return STY_OK;
}

error_t parse_number_option(Options *options, const NumberOption *numbers, int count, int key, const char *text) {
  for (int n = 0; n < count; n++)
    if (numbers[n].key == key)
      return end_option(sty_parse_number(numbers[n].name, text, numbers[n].minimum, numbers[n].maximum, numbers[n].out,
                                         &options->error));
  return ARGP_ERR_UNKNOWN;
}

error_t parse_choice_option(Options *options, const ChoiceOption *choices, int count, int key, const char *text) {
  for (int c = 0; c < count; c++)
    if (choices[c].key == key)
      return end_option(sty_parse_choice(choices[c].name, text, choices[c].words, choices[c].out, &options->error));
  return ARGP_ERR_UNKNOWN;
}

StyStatus parse_picture_size(Options *options, const char *text, int *width, int *height) {
  const StyStatus status = sty_parse_size("--size", text, STY_MAX_SIDE, width, height, &options->error);
  if (status || (long long)*width * *height <= STY_MAX_PIXELS) return status;
  return sty_fail(&options->error, STY_ERROR_USAGE, "--size: found %dx%d, expected at most %lld pixels", *width,
                  *height, STY_MAX_PIXELS);
}

StyStatus parse_bits(Options *options, const char *text, int *bits) {
  static const char *const depths[] = {"8", "16", NULL};
  int choice = 0;
  const StyStatus status = sty_parse_choice("--bits", text, depths, &choice, &options->error);
  if (!status) *bits = choice ? 16 : 8;
  return status;
}

static int read_digit(char c) {
  static const char digits[] = "0123456789abcdef0123456789ABCDEF";
  const char *found = c ? strchr(digits, c) : NULL;
  return found ? (int)(found - digits) % 16 : -1;
}

StyStatus parse_colour(Options *options, const char *what, const char *text, uint8_t out[4]) {
  const char *const whole = text;
  text += *text == '#';
  const size_t length = strlen(text);
  uint8_t colour[4] = {0, 0, 0, 255};
  bool good = length == 6 || length == 8;
  for (size_t i = 0; good && i < length / 2; i++) {
    const int high = read_digit(text[2 * i]), low = read_digit(text[2 * i + 1]);
    good = high >= 0 && low >= 0;
    if (good) colour[i] = (uint8_t)(16 * high + low);
  }
  if (!good)
    return sty_fail(&options->error, STY_ERROR_USAGE, "%s: found '%s', expected RRGGBB or RRGGBBAA, hexadecimal", what,
                    whole);
  memcpy(out, colour, sizeof colour);
  return STY_OK;
}

StyStatus take_argument(Options *options, const char **slot, const char *text) {
  if (*slot) return sty_fail(&options->error, STY_ERROR_USAGE, "found '%s', expected nothing after '%s'", text, *slot);
  *slot = text;
  return STY_OK;
}

bool is_behind_option(const Options *options, const char *prefix, const char *word) {
  for (char **w = options->words; *w && *w != word; w++)
    if (strncmp(*w, prefix, strlen(prefix)) == 0) return true;
  return false;
}

StyStatus require_argument(Options *options, const char *argument, const char *expected) {
  return argument ? STY_OK : sty_fail(&options->error, STY_ERROR_USAGE, "found no argument, expected %s", expected);
}

error_t parse_only_argument(int key, const char *text, struct argp_state *state, const char **slot,
                            const char *expected) {
  Options *options = state->input;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: return end_option(take_argument(options, slot, text));
    case ARGP_KEY_END: return end_option(require_argument(options, *slot, expected));
    default: return ARGP_ERR_UNKNOWN;
  }
}

StyStatus require_folder(Options *options, const char *path) {
  StyError *error = &options->error;
  char *copy = strdup(path);
  if (!copy) return sty_fail_memory(error, path, (double)strlen(path));
  struct stat info;
  const char *folder = dirname(copy);
  int failed = stat(folder, &info) != 0 ? errno : S_ISDIR(info.st_mode) ? 0 : ENOTDIR;
  if (!failed && access(folder, W_OK | X_OK) != 0) failed = errno;
  free(copy);
  return failed ? sty_fail(error, STY_ERROR_FILE,
                           "%s: cannot write: %s; expected a folder that exists and can be written to", path,
                           strerror(failed))
                : STY_OK;
}

StyStatus require_output(Options *options) {
  if (!options->output)
    return sty_fail(&options->error, STY_ERROR_USAGE, "option '--output': found none, expected -o FILE");
  return *options->output ? require_folder(options, options->output) : STY_OK;
}

StyStatus require_exr(Options *options) {
  StyImageFormat format = STY_IMAGE_EXR;
  const StyStatus status = sty_get_image_format(options->output, &format, &options->error);
  if (status || format == STY_IMAGE_EXR) return status;
  return sty_fail(&options->error, STY_ERROR_USAGE, "option '--output': found %s, expected a name that ends in .exr",
                  options->output);
}

StyStatus protect_inputs(Options *options, const char *output, const char *const *inputs, int count) {
  struct stat written, read;
  if (!output || stat(output, &written) != 0) return STY_OK;
  for (int i = 0; i < count; i++)
    if (inputs[i] && stat(inputs[i], &read) == 0 && read.st_dev == written.st_dev && read.st_ino == written.st_ino)
      return sty_fail(&options->error, STY_ERROR_USAGE,
                      "option '--output': found %s, which is an input, expected another name", output);
  return STY_OK;
}

void warn(const Options *options, const char *format, ...) {
  if (options->quiet) return;
  va_list arguments;
  va_start(arguments, format);
  fputs("stylut: warning: ", stderr);
  vfprintf(stderr, format, arguments);
  fputc('\n', stderr);
  va_end(arguments);
}

StyStatus finish_command(Options *options, StyStatus status) {
  if (status && options->error.status == status) fprintf(stderr, "stylut: error: %s\n", options->error.text);
  free(options->words);
  free(options->history);
  options->words = NULL;
  options->history = NULL;
  return status;
}

/* ---- progress ---- */

/* The stage that is being worked at. */
typedef struct Bar {
  const Options *options;
  const char *stage;
  bool is_wanted, json;
  int percent; /* shown last; -1 for none */
  double start, shown;
  StyPace pace;
} Bar;

static Bar bar;

static void print_left(double milliseconds) {
  const double seconds = milliseconds / 1000;
  if (milliseconds < 0) return;
  if (seconds < 90)
    fprintf(stderr, ", %.0f s left", ceil(seconds));
  else if (seconds < 90 * 60)
    fprintf(stderr, ", %.0f min left", ceil(seconds / 60));
  else
    fprintf(stderr, ", %.1f h left", seconds / 3600);
}

static void print_bar(const Bar *b, double left) {
  char line[31] = "..............................";
  memset(line, '#', (size_t)(b->percent * 30 / 100));
  fprintf(stderr, "\r%-10s [%s] %3d %%", b->stage, line, b->percent);
  print_left(left);
  fputs("\033[K", stderr);
}

static void print_json_progress(const Bar *b, double left) {
  fprintf(stderr, "{\"stage\": \"%s\", \"percent\": %d, \"left_s\": ", b->stage, b->percent);
  fprintf(stderr, left < 0 ? "null}\n" : "%.1f}\n", left / 1000);
}

static void show_progress(void *context, double done) {
  Bar *b = context;
  const double now = sty_get_milliseconds(), left = sty_keep_pace(&b->pace, now, done);
  const int percent = (int)(done * 100 + 1e-6); /* shares add up to a little less than all */
  /* A bar's time goes on where percents are slow. */
  if (percent == b->percent && (b->json || now - b->shown < 1000)) return;
  b->percent = percent;
  b->shown = now;
  (b->json ? print_json_progress : print_bar)(b, left);
}

static void begin_stage(void *context, const char *stage) {
  Bar *b = context;
  const double now = sty_get_milliseconds();
  if (b->stage == stage || strcmp(b->stage, stage) == 0) return;
  end_progress(b->options);
  *b = (Bar){b->options, stage, b->is_wanted, b->json, -1, now, now, sty_begin_pace(now)};
  if (b->is_wanted) show_progress(b, 0);
}

StyRun begin_progress(const Options *options, const char *stage) {
  const bool terminal = isatty(STDERR_FILENO) == 1;
  const bool wanted = options->progress == PROGRESS_BAR || options->progress == PROGRESS_JSON ||
                      (options->progress == PROGRESS_AUTO && terminal && !options->quiet);
  bar = (Bar){
      .options = options, .stage = "", .is_wanted = wanted, .json = options->progress == PROGRESS_JSON, .percent = -1};
  begin_stage(&bar, stage);
  return (StyRun){options->threads, wanted ? show_progress : NULL, begin_stage, &bar};
}

void end_progress(const Options *options) {
  if (bar.percent >= 0 && !bar.json) fputs("\r\033[K", stderr);
  if (options->verbose && *bar.stage)
    fprintf(stderr, "stylut: %s took %.1f ms on %d threads\n", bar.stage, sty_get_milliseconds() - bar.start,
            sty_get_threads(&(StyRun){.threads = options->threads}));
  bar.percent = -1;
}

/* ---- reports ---- */

static double read_memory_line(const char *format) {
  FILE *stream = fopen("/proc/self/status", "r");
  char line[256];
  double kilobytes = 0;
  while (stream && fgets(line, sizeof line, stream))
    if (sscanf(line, format, &kilobytes) == 1) break;
  if (stream) fclose(stream);
  return kilobytes * 1024;
}

/* Not getrusage's ru_maxrss: Linux hands that of a large parent on through exec. */
double get_peak_bytes(void) { return read_memory_line("VmHWM: %lf kB"); }

double get_held_bytes(void) { return read_memory_line("VmRSS: %lf kB"); }

StyStatus print_json(json_t *report, StyError *error) {
  const int failed =
      !report || json_dumpf(report, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(12) | JSON_ENSURE_ASCII) != 0;
  json_decref(report);
  if (failed) return sty_fail(error, STY_ERROR_FILE, "standard output: cannot write the report");
  putchar('\n');
  return STY_OK;
}

const char *clean_text(const char *text) {
  static _Thread_local char buffers[8][1024];
  static _Thread_local int next;
  char *buffer = buffers[next++ % 8];
  snprintf(buffer, sizeof buffers[0], "%s", text);
  sty_clean_text(buffer);
  return buffer;
}

json_t *make_json_text(const char *text) {
  json_t *string = json_string(text);
  char *plain = string ? NULL : strdup(text);
  for (char *c = plain; c && *c; c++)
    if ((unsigned char)*c > 0x7f) *c = '?';
  if (plain) string = json_string(plain);
  free(plain);
  return string;
}

static StyStatus print_plan(Options *options, json_t *figures, const char *format, va_list arguments) {
  char text[512];
  vsnprintf(text, sizeof text, format, arguments);
  if (options->json)
    return print_json(json_pack("{s:s, s:o, s:o, s:o*}", "schema", "stylut-dry-run/1", "output",
                                make_json_text(options->output), "text", make_json_text(text), "estimate", figures),
                      &options->error);
  json_decref(figures);
  if (!options->quiet) printf("would write %s: %s\n", clean_text(options->output), clean_text(text));
  return STY_OK;
}

StyStatus report_dry_run(Options *options, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  const StyStatus status = print_plan(options, NULL, format, arguments);
  va_end(arguments);
  return status;
}

StyStatus report_estimate(Options *options, json_t *figures, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  const StyStatus status = print_plan(options, figures, format, arguments);
  va_end(arguments);
  return status;
}

json_t *pack_times(const char *const *stages, const double *milliseconds, int count) {
  json_t *times = json_object();
  for (int i = 0; i < count; i++)
    json_object_set_new(times, stages[i], json_real((double)(long long)(milliseconds[i] * 1e3 + 0.5) / 1e3));
  return times;
}

void pack_features(json_t *report, const StyFeature *features, int count) {
  json_t *names = json_array(), *weights = json_array();
  for (int f = 0; f < count; f++) {
    json_array_append_new(names, make_json_text(features[f].channel));
    json_array_append_new(weights, json_real((double)features[f].weight));
  }
  json_object_set_new(report, "channels", names);
  json_object_set_new(report, "weights", weights);
  json_object_set_new(report, "dims", json_integer(count));
}

json_t *get_command_line(const Options *options, const char *command) {
  char *line = NULL;
  if (asprintf(&line, "stylut %s%s%s", command, options->history ? " " : "", options->history ? options->history : "") <
      0)
    return NULL;
  json_t *text = make_json_text(line);
  free(line);
  return text;
}

StyStatus add_history(const Options *options, const char *command, StyImage *image, const char *const *inputs,
                      int input_count, StyError *error) {
  if (options->no_history) return STY_OK;
  json_t *line = get_command_line(options, command);
  if (!line) return sty_fail_memory(error, "history", 0);
  StyStatus status = sty_set_attribute(image, "stylut:version", STY_VERSION, error);
  if (!status) status = sty_set_attribute(image, "stylut:command", json_string_value(line), error);
  json_decref(line);
  for (int i = 0; !status && i < input_count; i++) {
    char name[32], value[STY_HASH_SIZE];
    snprintf(name, sizeof name, "stylut:input%d", i + 1);
    status = sty_hash_file(inputs[i], value, error);
    if (!status) status = sty_set_attribute(image, name, value, error);
  }
  return status;
}
