/* stylut probe LUT --guide GUIDE X Y: one guide value's way through a table. */
#include "stylut/probe.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "audits.h"
#include "commands.h"
#include "options.h"
#include "stylut/parse.h"

typedef struct Arguments {
  AuditCommand base;
  int numbers; /* how many of X and Y were given */
  double value[2];
} Arguments;

/* ---- arguments ---------------------------------------------------------------- */

/* argp takes -0.5 for an option; with this in front it is none. */
enum { SHIELD = 1 };

static const char *drop_shield(const char *text) { return text[0] == SHIELD ? text + 1 : text; }

static StyStatus take_text(Arguments *arguments, const char *text) {
  static const char *const names[] = {"X", "Y"};
  Options *options = &arguments->base.options;
  if (!arguments->base.audit.lut) return take_argument(options, &arguments->base.audit.lut, text);
  if (arguments->numbers == 2)
    return sty_fail(&options->error, STY_ERROR_USAGE, "found '%s', expected nothing after Y", text);
  const int k = arguments->numbers++;
  return sty_parse_number(names[k], text, -1, 1, &arguments->value[k], &options->error);
}

static StyStatus check_arguments(Arguments *arguments) {
  const StyStatus status = check_audit_arguments(&arguments->base);
  if (status || arguments->numbers == 2) return status;
  return sty_fail(&arguments->base.options.error, STY_ERROR_USAGE,
                  "found %s after '%s', expected a guide value: X Y, each from -1 to 1",
                  arguments->numbers ? "one number" : "nothing", arguments->base.audit.lut);
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  const char *argument = key == ARGP_KEY_ARG ? drop_shield(text) : text;
  begin_option(key, argument, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: return end_option(take_text(arguments, argument));
    case ARGP_KEY_END: return end_option(check_arguments(arguments));
    default: return ARGP_ERR_UNKNOWN;
  }
}

static const struct argp_child children[] = {{&table_argp, 0, NULL, 0}, {&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .parser = parse_option,
    .args_doc = "LUT --guide GUIDE X Y",
    .doc =
        "Sends one guide value through a table and says each step: texel, stored source pixel, and the exact answer by "
        "every exact engine.\v"
        "X and Y, from -1 to 1, are those of a normal; negative numbers need no '--' before them. The engines answer "
        "to the value itself; the texel answers for its own value, and stores the nearest when no source pixel is "
        "nearer to that one. Ambiguity: the source pixels within --precision of the least distance; two connected "
        "pieces or more, or a spread above --jump, are ambiguous.",
    .children = children,
};

/* Whether the next argument is this option's value. */
static bool takes_value(const char *given) {
  if (given[0] != '-' || strchr(given, '=')) return false;
  for (const struct argp_child *child = children; child->argp; child++)
    for (const struct argp_option *o = child->argp->options; o->name || o->doc; o++) {
      const bool is_long =
          o->name && strncmp(given, "--", 2) == 0 && given[2] && strncmp(o->name, given + 2, strlen(given + 2)) == 0;
      const bool is_short = given[1] == o->key && !given[2];
      if (o->arg && (is_long || is_short)) return true;
    }
  return false;
}

/* Also what isn't one but was meant to be, for the sake of the message. */
static bool is_negative_number(const char *text) {
  return text[0] == '-' &&
         (isdigit((unsigned char)text[1]) || text[1] == '.' || strcmp(text, "-inf") == 0 || strcmp(text, "-nan") == 0);
}

static void free_shields(int argc, char **argv) {
  for (int i = 0; i < argc; i++)
    if (argv[i][0] == SHIELD) free(argv[i]);
  free(argv);
}

/* A copy of argv in which negative numbers are shielded, unless they are an
 * option's value. NULL: memory is short. */
static char **shield_numbers(int argc, char **argv) {
  char **shielded = calloc((size_t)argc + 1, sizeof *shielded);
  for (int i = 0; shielded && i < argc; i++) {
    shielded[i] = argv[i];
    if (!is_negative_number(argv[i]) || takes_value(argv[i - 1])) continue;
    if (asprintf(&shielded[i], "%c%s", SHIELD, argv[i]) >= 0) continue;
    free_shields(i, shielded);
    return NULL;
  }
  return shielded;
}

/* ---- answers ------------------------------------------------------------------ */

enum { MOST_ENGINES = 16 };

typedef struct Answer {
  const StyEngine *engine;
  StyNeighbour neighbour;
} Answer;

/* All that was found out. */
typedef struct Findings {
  StyLutSpec spec;
  StyProbe probe;
  Answer answers[MOST_ENGINES];
  int answer_count;
  bool agree; /* all engines, and the scan of all source pixels */
} Findings;

static bool is_same(const StyNeighbour *a, const StyNeighbour *b) {
  return a->pixel[0] == b->pixel[0] && a->pixel[1] == b->pixel[1] && (float)a->distance == (float)b->distance;
}

/* Every exact engine that is built in. */
static StyStatus ask_engines(Arguments *arguments, const StySites *sites, Findings *out) {
  const StyRun run = begin_progress(&arguments->base.options, "asking");
  StyError *error = &arguments->base.options.error;
  StyStatus status = STY_OK;
  out->agree = true;
  for (const StyEngine *engine = sty_engines; !status && engine->name && out->answer_count < MOST_ENGINES; engine++) {
    Answer answer = {.engine = engine};
    if (!engine->exact) continue;
    status = sty_probe_engine(sites, engine, out->spec.metric, out->probe.value, &run, &answer.neighbour, error);
    if (status == STY_ERROR_UNAVAILABLE) {
      status = STY_OK;
      continue;
    }
    if (status) {
      sty_fail(error, status, "%s: %s", arguments->base.audit.guide, error->text);
      break;
    }
    out->agree = out->agree && is_same(&answer.neighbour, &out->probe.best);
    out->answers[out->answer_count++] = answer;
  }
  end_progress(&arguments->base.options);
  return status;
}

static StyStatus probe_table(Arguments *arguments, Findings *out) {
  const AuditArguments *audit = &arguments->base.audit;
  StyError *error = &arguments->base.options.error;
  const StyProbeOptions options = {.precision = audit->precision * STY_LEVEL, .jump = audit->jump};
  const float value[2] = {(float)arguments->value[0], (float)arguments->value[1]};
  AuditCase subject = {0};
  StyStatus status = open_table(&arguments->base, &subject, error);
  if (!status) {
    status = sty_probe_lut(subject.lut, subject.guide, subject.sites, value, &options, &out->probe, error);
    if (status) sty_fail(error, status, "%s: %s", audit->lut, error->text);
  }
  if (!status) {
    out->spec = subject.lut->spec;
    status = ask_engines(arguments, subject.sites, out);
  }
  close_audit(&subject);
  return status;
}

/* ---- JSON --------------------------------------------------------------------- */

static json_t *pack_pair(const float value[2]) { return json_pack("[ff]", (double)value[0], (double)value[1]); }

static void add_distance(json_t *object, double distance, double degrees) {
  json_object_set_new(object, "distance", json_real(distance));
  json_object_set_new(object, "levels", json_real(distance / STY_LEVEL));
  json_object_set_new(object, "degrees", json_real(degrees));
}

static json_t *pack_neighbour(const StyNeighbour *n) {
  json_t *object = json_pack("{s:[ii], s:b, s:o}", "pixel", n->pixel[0], n->pixel[1], "covered", n->covered, "value",
                             n->covered ? pack_pair(n->value) : json_null());
  if (n->covered) add_distance(object, n->distance, n->degrees);
  return object;
}

static json_t *pack_stored(const StyNeighbour *n, bool nearest) {
  json_t *object = json_pack("{s:b}", "nearest", nearest);
  if (n->covered) add_distance(object, n->distance, n->degrees);
  return object;
}

static json_t *pack_texel(const StyProbe *probe) {
  json_t *object = json_pack("{s:[ii], s:o}", "at", probe->texel[0], probe->texel[1], "value", pack_pair(probe->own));
  add_distance(object, probe->distance, probe->degrees);
  return object;
}

static json_t *pack_engines(const Findings *findings) {
  json_t *engines = json_array();
  for (int a = 0; a < findings->answer_count; a++) {
    json_t *answer = pack_neighbour(&findings->answers[a].neighbour);
    json_object_set_new(answer, "engine", json_string(findings->answers[a].engine->name));
    json_array_append_new(engines, answer);
  }
  return engines;
}

static json_t *pack_ambiguity(const StyProbe *probe) {
  return json_pack("{s:f, s:f, s:I, s:I, s:f, s:f, s:b}", "precision", probe->precision, "precision_levels",
                   probe->precision / STY_LEVEL, "pixels", (json_int_t)probe->choice, "pieces",
                   (json_int_t)probe->pieces, "spread", probe->spread, "jump", probe->jump, "ambiguous",
                   probe->ambiguous);
}

static json_t *pack_findings(const Arguments *arguments, const Findings *findings) {
  const StyProbe *probe = &findings->probe;
  const StyLutSpec *spec = &findings->spec;
  json_t *table = json_pack("{s:o, s:[ii], s:s, s:s, s:s}", "file", make_json_text(arguments->base.audit.lut), "size",
                            spec->width, spec->height, "sampling", sty_sampling_names[spec->sampling], "map",
                            sty_map_names[spec->map], "metric", sty_metric_names[spec->metric]);
  json_t *stored =
      json_pack("{s:[ii], s:b, s:o, s:o, s:o}", "pixel", probe->stored.pixel[0], probe->stored.pixel[1], "covered",
                probe->stored.covered, "value", probe->stored.covered ? pack_pair(probe->stored.value) : json_null(),
                "from_value", pack_stored(&probe->stored, probe->nearest), "from_texel",
                pack_stored(&probe->stored_at_texel, probe->nearest_at_texel));
  return json_pack("{s:s, s:o, s:o, s:o, s:b, s:o, s:o, s:o, s:o, s:b, s:o, s:o}", "schema", "stylut-probe/1", "table",
                   table, "guide", make_json_text(arguments->base.audit.guide), "value", pack_pair(probe->value),
                   "inside_disc", probe->inside, "texel", pack_texel(probe), "stored", stored, "exact_at_texel",
                   pack_neighbour(&probe->best_at_texel), "engines", pack_engines(findings), "engines_agree",
                   findings->agree, "runner_up", probe->has_runner_up ? pack_neighbour(&probe->runner_up) : json_null(),
                   "ambiguity", pack_ambiguity(probe));
}

/* ---- text --------------------------------------------------------------------- */

static void print_distance(double distance, double degrees) {
  printf("%.6g = %.4g levels, %.4g degrees", distance, distance / STY_LEVEL, degrees);
}

static void print_neighbour(const char *step, const char *name, const StyNeighbour *n) {
  printf("%-10s %-13s pixel (%d, %d) of value (%.6g, %.6g) at ", step, name, n->pixel[0], n->pixel[1],
         (double)n->value[0], (double)n->value[1]);
  print_distance(n->distance, n->degrees);
  putchar('\n');
}

static void print_stored(const char *from, const StyNeighbour *n, bool nearest) {
  printf("%-10s from %s: ", "", from);
  print_distance(n->distance, n->degrees);
  printf(", %s\n", nearest ? "as near as any" : "not the nearest");
}

static void print_table_steps(const Findings *findings) {
  const StyProbe *probe = &findings->probe;
  const StyLutSpec *spec = &findings->spec;
  printf("%-10s (%g, %g), %s the disc\n", "value", (double)probe->value[0], (double)probe->value[1],
         probe->inside ? "inside" : "outside");
  printf("%-10s (%d, %d) of %dx%d (%s, map %s, metric %s), whose own value (%.6g, %.6g) is away by ", "texel",
         probe->texel[0], probe->texel[1], spec->width, spec->height, sty_sampling_names[spec->sampling],
         sty_map_names[spec->map], sty_metric_names[spec->metric], (double)probe->own[0], (double)probe->own[1]);
  print_distance(probe->distance, probe->degrees);
  printf("\n%-10s pixel (%d, %d)", "stored", probe->stored.pixel[0], probe->stored.pixel[1]);
  if (!probe->stored.covered) {
    printf(", which isn't covered: no answer at all\n");
  } else {
    printf(" of value (%.6g, %.6g)\n", (double)probe->stored.value[0], (double)probe->stored.value[1]);
    print_stored("the value", &probe->stored, probe->nearest);
    print_stored("the texel's own", &probe->stored_at_texel, probe->nearest_at_texel);
  }
  if (!probe->nearest_at_texel) print_neighbour("", "should be", &probe->best_at_texel);
}

static void print_exact_steps(const Findings *findings) {
  const StyProbe *probe = &findings->probe;
  for (int a = 0; a < findings->answer_count; a++)
    print_neighbour(a ? "" : "exact", findings->answers[a].engine->name, &findings->answers[a].neighbour);
  if (!findings->agree) printf("%-10s the engines disagree, which is a defect of stylut's: please report it\n", "");
  if (probe->has_runner_up)
    print_neighbour("runner-up", "", &probe->runner_up);
  else
    printf("%-10s none: all source pixels have one value\n", "runner-up");
  printf("%-10s %zu source pixel%s within %.4g levels of the least distance, in %zu piece%s, spread %.4g pixels: %s\n",
         "choice", probe->choice, probe->choice == 1 ? "" : "s", probe->precision / STY_LEVEL, probe->pieces,
         probe->pieces == 1 ? "" : "s", probe->spread, probe->ambiguous ? "ambiguous" : "not ambiguous");
}

static StyStatus print_findings(const Arguments *arguments, const Findings *findings, StyError *error) {
  if (arguments->base.options.json) return print_json(pack_findings(arguments, findings), error);
  if (arguments->base.options.quiet) return STY_OK;
  print_table_steps(findings);
  print_exact_steps(findings);
  return STY_OK;
}

/* ---- the command -------------------------------------------------------------- */

StyStatus run_probe(int argc, char **argv) {
  Arguments arguments = {.base.audit = default_audit_arguments};
  Options *options = &arguments.base.options;
  Findings findings = {.answer_count = 0};
  char **shielded = shield_numbers(argc, argv);
  StyStatus status = shielded ? parse_arguments(&parser, argc, shielded, &arguments)
                              : sty_fail_memory(&options->error, "arguments", 0);
  if (!status && !options->helped) {
    status = probe_table(&arguments, &findings);
    if (!status) status = print_findings(&arguments, &findings, &options->error);
  }
  if (shielded) free_shields(argc, shielded);
  return finish_command(options, status);
}
