/* stylut bench [PART...] */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "machine.h"
#include "options.h"
#include "races.h"
#include "stylut/file.h"
#include "stylut/parse.h"

/* The committed table, which the assembler brings in as it is. */
__asm__(
    ".section .rodata\n.global committed_table\ncommitted_table:\n.incbin \"exemplars/charts/bench.csv\"\n.byte "
    "0\n.previous\n");
extern const char committed_table[];

enum { MOST_PARTS = 8, MOST_COMMITTED = 512, FIELDS = 8 };

typedef struct Arguments {
  Options options;
  bool parts[MOST_PARTS];
  bool any_part;
  int repeats;
  const char *csv;
} Arguments;

enum { KEY_CSV = 0x200, KEY_REPEATS };

static const struct argp_option options_table[] = {
    {"csv", KEY_CSV, "FILE.csv", 0, "write this machine's rows as a table like the committed one", 0},
    {"repeats", KEY_REPEATS, "N", 0, "runs that a time is the median of (default: 7)", 0},
    {0},
};

static StyStatus take_part(Arguments *arguments, const char *text) {
  const char *names[MOST_PARTS + 1] = {NULL};
  int choice = 0;
  for (int p = 0; race_parts[p].name; p++) names[p] = race_parts[p].name;
  const StyStatus status = sty_parse_choice("part", text, names, &choice, &arguments->options.error);
  if (status) return status;
  arguments->parts[choice] = arguments->any_part = true;
  return STY_OK;
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  StyError *error = &arguments->options.error;
  long long number = 0;
  StyStatus status = STY_OK;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: status = take_part(arguments, text); break;
    case ARGP_KEY_END:
      if (arguments->options.threads)
        status = sty_fail(error, STY_ERROR_USAGE, "--threads: found with bench, whose rows have their own numbers");
      break;
    case KEY_CSV:
      arguments->csv = text;
      status = require_folder(&arguments->options, text);
      break;
    case KEY_REPEATS:
      status = sty_parse_integer("--repeats", text, 1, MOST_REPEATS, &number, error);
      arguments->repeats = (int)number;
      break;
    default: return ARGP_ERR_UNKNOWN;
  }
  return end_option(status);
}

static const struct argp_child children[] = {{&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .options = options_table,
    .parser = parse_option,
    .args_doc = "[PART...]",
    .doc =
        "Measures speed on this machine, beside the figures that were committed with this version.\v"
        "PART is lut (tables of a sphere by every engine), guide (ray-traced guides of a torus), pack (a bundle of "
        "five styles) or stylize (the runtime on frames of 1920x1080); all of them take about a minute. The number of "
        "threads is each row's own.\n\nTimes differ from machine to machine; ratios, which are the time of a reference "
        "in the same run over the row's, hardly should: look at those first.",
    .children = children,
};

/* ---- the committed table ------------------------------------------------------------ */

typedef struct Committed {
  char *text; /* the table, cut at its commas and line ends */
  const char *machine;
  const char *rows[MOST_COMMITTED][FIELDS];
  int count;
} Committed;

/* Its lines are ours: comment, header, rows without quotes. */
static StyStatus read_committed(Committed *out, StyError *error) {
  *out = (Committed){.text = strdup(committed_table), .machine = ""};
  if (!out->text) return sty_fail_memory(error, "bench", (double)strlen(committed_table));
  char *rest = out->text;
  for (char *line; (line = strsep(&rest, "\n")) && out->count < MOST_COMMITTED;) {
    if (*line == '#') {
      out->machine = line + 1 + strspn(line + 1, " ");
      continue;
    }
    int fields = 0;
    while (line && fields < FIELDS) out->rows[out->count][fields++] = strsep(&line, ",");
    out->count += fields == FIELDS;
  }
  return STY_OK;
}

static const char *const *find_committed(const Committed *committed, const RaceRow *row) {
  for (int r = 0; r < committed->count; r++)
    if (strcmp(committed->rows[r][0], row->row) == 0 && strcmp(committed->rows[r][1], row->variant) == 0)
      return committed->rows[r];
  return NULL;
}

enum { FIELD_TIME = 3, FIELD_RATIO = 6 };

/* NAN where the field is empty or there is no row. */
static double get_number(const char *const *row, int field) {
  return row && *row[field] ? strtod(row[field], NULL) : NAN;
}

/* ---- reports -------------------------------------------------------------------------- */

static void write_number(FILE *stream, double value) {
  if (isnan(value))
    fputc(',', stream);
  else
    fprintf(stream, "%.3f,", value);
}

static StyStatus write_table(const char *path, const RaceResults *results, StyError *error) {
  StyOutput output;
  char machine[MACHINE_SIZE];
  const StyStatus status = sty_open_output(path, &output, error);
  if (status) return status;
  fprintf(output.stream, "# %s\nrow,variant,runs,median_ms,rate,rate_unit,ratio,reference\n", format_machine(machine));
  for (int r = 0; r < results->count; r++) {
    const RaceRow *row = &results->rows[r];
    fprintf(output.stream, "%s,%s,%d,", row->row, row->variant, row->runs);
    write_number(output.stream, row->milliseconds);
    write_number(output.stream, row->rate);
    fprintf(output.stream, "%s,", row->rate_unit);
    write_number(output.stream, row->ratio);
    fprintf(output.stream, "%s\n", row->reference);
  }
  return sty_commit_output(&output, error);
}

static json_t *pack_number(double value) { return isnan(value) ? json_null() : json_real(round(value * 1e3) / 1e3); }

static json_t *pack_row(const RaceRow *row, const char *const *known) {
  json_t *committed = known ? json_pack("{s:o, s:o}", "time_ms", pack_number(get_number(known, FIELD_TIME)), "ratio",
                                        pack_number(get_number(known, FIELD_RATIO)))
                            : json_null();
  return json_pack("{s:s, s:s, s:i, s:o, s:o, s:s, s:o, s:s, s:o}", "row", row->row, "variant", row->variant, "runs",
                   row->runs, "time_ms", pack_number(row->milliseconds), "rate", pack_number(row->rate), "rate_unit",
                   row->rate_unit, "ratio", pack_number(row->ratio), "reference", row->reference, "committed",
                   committed);
}

static StyStatus print_as_json(const Committed *committed, const RaceResults *results, StyError *error) {
  char machine[MACHINE_SIZE];
  json_t *rows = json_array();
  for (int r = 0; r < results->count; r++)
    json_array_append_new(rows, pack_row(&results->rows[r], find_committed(committed, &results->rows[r])));
  return print_json(json_pack("{s:s, s:s, s:s, s:o}", "schema", "stylut-bench/1", "machine", format_machine(machine),
                              "committed_machine", committed->machine, "rows", rows),
                    error);
}

static const char *format_number(double value, int decimals, char text[32]) {
  snprintf(text, 32, "%.*f", decimals, value);
  return isnan(value) ? "-" : text;
}

static void print_as_text(const Committed *committed, const RaceResults *results) {
  char machine[MACHINE_SIZE], texts[4][32];
  printf("here       %s\ncommitted  %s\n", format_machine(machine), committed->machine);
  printf("\n%-24s %-26s %11s %11s %9s %9s  %s\n", "row", "variant", "here ms", "committed", "ratio", "committed", "to");
  for (int r = 0; r < results->count; r++) {
    const RaceRow *row = &results->rows[r];
    const char *const *known = find_committed(committed, row);
    if (r && strcmp(row->row, row[-1].row) != 0) putchar('\n');
    printf("%-24s %-26s %11s %11s %9s %9s%s%s\n", row->row, row->variant, format_number(row->milliseconds, 1, texts[0]),
           format_number(get_number(known, FIELD_TIME), 1, texts[1]), format_number(row->ratio, 3, texts[2]),
           format_number(get_number(known, FIELD_RATIO), 3, texts[3]), *row->reference ? "  " : "", row->reference);
  }
  printf("\nratio: the reference's time over the row's; above 1, the row is the faster one.\n");
}

/* ---- the command ---------------------------------------------------------------------- */

static StyStatus measure(const Arguments *arguments, RaceResults *results, StyError *error) {
  StyStatus status = STY_OK;
  for (int p = 0; !status && race_parts[p].name; p++) {
    if (arguments->any_part && !arguments->parts[p]) continue;
    const StyRun run = begin_progress(&arguments->options, race_parts[p].name);
    status = race_parts[p].measure(arguments->repeats, &run, results, error);
    end_progress(&arguments->options);
  }
  return status;
}

static StyStatus run(const Arguments *arguments, StyError *error) {
  static RaceResults results;
  static Committed committed;
  StyStatus status = read_committed(&committed, error);
  if (!status) status = measure(arguments, &results, error);
  if (!status && arguments->csv) status = write_table(arguments->csv, &results, error);
  if (!status && arguments->options.json)
    status = print_as_json(&committed, &results, error);
  else if (!status && !arguments->options.quiet)
    print_as_text(&committed, &results);
  free(committed.text);
  return status;
}

StyStatus run_bench(int argc, char **argv) {
  Arguments arguments = {.repeats = 7};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments, &arguments.options.error);
  return finish_command(&arguments.options, status);
}
