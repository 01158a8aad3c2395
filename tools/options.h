/* What all commands share: option groups that read the same everywhere, the
 * message line, progress, and what a written file says about its making. */
#ifndef STYLUT_TOOLS_OPTIONS_H
#define STYLUT_TOOLS_OPTIONS_H

#include <argp.h>
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "stylut/image.h"
#include "stylut/lut.h"
#include "stylut/parallel.h"

/* --trees, --checks and --precision, each for one engine or two. */
enum { TUNINGS = 3 };

enum { MOST_OPTIONS = 64 }; /* of one command */

/* The argp group of options that say which files are made, or what is said of them, not what they hold: a file's
 * history has none of them. */
enum { UNRECORDED = 7 };

/* First member of every command's own arguments. */
typedef struct Options {
  const char *output;
  int threads; /* 0: one per core */
  bool quiet, verbose;
  bool json;
  int progress; /* index of progress_modes */
  bool dry_run, no_history;
  uint64_t seed;
  const StyEngine *engine; /* NULL: the fastest exact one */
  StyEngineOptions engine_options;
  bool tuning[TUNINGS]; /* which of --trees, --checks, --precision were given */
  bool helped;          /* --help was given and answered: nothing is left to do */
  int reached;          /* by parsing, in argv: past the option taken last, or at it while others follow in its word */
  int stopped_at;       /* the word in argv that parsing failed at */
  char **words;         /* argv as it was given: parsing moves options to its front */
  char *history;        /* the options that shape the result, in canonical form */
  const char *given[MOST_OPTIONS]; /* their names, each once */
  int given_count;
  StyError error;
} Options;

/* Groups, to be named as argp children; a command's ARGP_KEY_INIT hands them its
 * arguments through begin_option(). */
extern const struct argp common_argp; /* -j -q -v --format --progress */
extern const struct argp output_argp; /* -o --dry-run --no-history */
extern const struct argp seed_argp;   /* --seed */
extern const struct argp engine_argp; /* -e --trees --checks --precision; engine_options want their defaults first */

/* To be called first in every command's parser: passes the arguments on to the
 * groups and records what shapes the result. */
void begin_option(int key, const char *argument, const struct argp_state *state);

/* The parser's result for a status: argp stops at anything but 0. */
error_t end_option(StyStatus status);

/* Parses a command line into `arguments` (which begin with Options). On failure
 * options.error is filled. */
StyStatus parse_arguments(const struct argp *argp, int argc, char **argv, void *arguments);

/* Whether one of the options that shape the result was given; its name without dashes. */
bool is_given(const Options *options, const char *name);

/* An option that changes something only where something else was asked for, too. */
typedef struct OptionNeed {
  const char *name; /* without dashes */
  bool is_met;
  const char *expected; /* what it takes */
} OptionNeed;

/* Refuses options that were given though the result would be the same without them. This is the one place for that. */
StyStatus check_needs(Options *options, const OptionNeed *needs, int count);

/* Options that are a number, or one of some words by its index. */
typedef struct NumberOption {
  int key;
  const char *name; /* for messages */
  double minimum, maximum;
  double *out;
} NumberOption;

typedef struct ChoiceOption {
  int key;
  const char *name;
  const char *const *words; /* NULL-terminated */
  int *out;
} ChoiceOption;

/* The parser's result for the option of this key: ARGP_ERR_UNKNOWN where it is none of them. */
error_t parse_number_option(Options *options, const NumberOption *numbers, int count, int key, const char *text);
error_t parse_choice_option(Options *options, const ChoiceOption *choices, int count, int key, const char *text);

/* --size, at most STY_MAX_PIXELS; --bits, 8 or 16. */
StyStatus parse_picture_size(Options *options, const char *text, int *width, int *height);
StyStatus parse_bits(Options *options, const char *text, int *bits);

/* RRGGBB, or RRGGBBAA, hexadecimal, with or without # before it. */
StyStatus parse_colour(Options *options, const char *what, const char *text, uint8_t out[4]);

/* Puts the command's one argument into *slot; a second one is an error. */
StyStatus take_argument(Options *options, const char **slot, const char *text);

/* The whole parser of a command that has no options but the groups' and one argument, which must be given. */
error_t parse_only_argument(int key, const char *text, struct argp_state *state, const char **slot,
                            const char *expected);

/* Whether an option that begins with `prefix` was given before this word of the command line. */
bool is_behind_option(const Options *options, const char *prefix, const char *word);

/* The argument must have been given; `expected` says what it is. */
StyStatus require_argument(Options *options, const char *argument, const char *expected);

/* A file that is to be written once the work is done: its folder must be there. */
StyStatus require_folder(Options *options, const char *path);

/* For commands that write: -o must be given, and name a place in a folder that is there. */
StyStatus require_output(Options *options);

/* For outputs that only EXR can hold. */
StyStatus require_exr(Options *options);

/* The engine that was asked for, else the fastest exact one (see
 * sty_get_fastest_engine); options that it doesn't heed are an error. */
StyStatus choose_engine(Options *options, StyTask task, int dims, const StyEngine **out);

/* Refuses to write over what is read. Inputs may be NULL. */
StyStatus protect_inputs(Options *options, const char *output, const char *const *inputs, int count);

/* Prints a line about what is most likely a mistake, unless --quiet was given. */
void warn(const Options *options, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Prints the line for a failed command and frees what Options hold. */
StyStatus finish_command(Options *options, StyStatus status);

/* Threads and progress for long work, of which `stage` is the first part: how much of that is done, and how long it
 * will still take at its pace. End with end_progress. */
StyRun begin_progress(const Options *options, const char *stage);
void end_progress(const Options *options);

/* Largest resident memory of this process so far, bytes, and what it holds now. */
double get_peak_bytes(void);
double get_held_bytes(void);

/* Prints to stdout; frees `report`. */
StyStatus print_json(json_t *report, StyError *error);

/* Text for a terminal: control characters become '?'. Valid until the eighth
 * call of the same thread after. */
const char *clean_text(const char *text);

/* Text for JSON, which must be UTF-8: where it isn't, bytes beyond ASCII become '?'. */
json_t *make_json_text(const char *text);

/* Says what --dry-run leaves undone, as text or JSON. */
StyStatus report_dry_run(Options *options, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The same, with figures of what it would take, which are freed. */
StyStatus report_estimate(Options *options, json_t *figures, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* {"stage": milliseconds, ...} from parallel lists, rounded to microseconds. */
json_t *pack_times(const char *const *stages, const double *milliseconds, int count);

/* Adds "channels": [names], "weights": [numbers] and "dims" to a report. */
void pack_features(json_t *report, const StyFeature *features, int count);

/* "stylut COMMAND" with all that shapes the result, for JSON. */
json_t *get_command_line(const Options *options, const char *command);

/* Puts version, command and the inputs' hashes into an image to be written,
 * unless --no-history was given. `inputs` are file names. */
StyStatus add_history(const Options *options, const char *command, StyImage *image, const char *const *inputs,
                      int input_count, StyError *error);

#endif
