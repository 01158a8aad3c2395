/* stylut doctor: what this machine has, and whether it all works. */
#include "doctor.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <sys/utsname.h>
#include <unistd.h>

#include "commands.h"
#include "machine.h"
#include "stylut/file.h"
#include "stylut/runtime.h"

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Options *options = state->input;
  begin_option(key, text, state);
  if (key == ARGP_KEY_INIT) return 0;
  if (key != ARGP_KEY_ARG) return ARGP_ERR_UNKNOWN;
  return end_option(sty_fail(&options->error, STY_ERROR_USAGE, "found argument '%s', expected none", text));
}

static const struct argp_child children[] = {{&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .parser = parse_option,
    .doc =
        "Says what stylut is built of and runs on, and checks in a few seconds that it all works: a text for a bug "
        "report. Exit code 6 where something doesn't.",
    .children = children,
};

/* ---- facts ---- */

enum { FACT_SIZE = 1024 };
typedef struct Fact {
  const char *name;
  char text[FACT_SIZE];
} Fact;

static void tell_system(char *text) {
  struct utsname name;
  char line[256] = "", pretty[200] = "unknown system";
  FILE *stream = fopen("/etc/os-release", "r");
  while (stream && fgets(line, sizeof line, stream)) sscanf(line, "PRETTY_NAME=\"%199[^\"]\"", pretty);
  if (stream) fclose(stream);
  if (uname(&name) != 0) memset(&name, 0, sizeof name);
  snprintf(text, FACT_SIZE, "%s, %s %s, %s", clean_text(pretty), name.sysname, name.release, name.machine);
}

static void tell_units(char *text) {
  const char *asked = getenv("STYLUT_VECTOR");
  snprintf(text, FACT_SIZE, "plain%s%s%s%s", sty_has_path(STY_PATH_AVX2) ? ", AVX2" : "",
           sty_has_path(STY_PATH_AVX512) ? ", AVX-512" : "",
           asked && *asked ? "; STYLUT_VECTOR asks for " : "; the best is used", asked ? clean_text(asked) : "");
}

static void tell_memory(char *text) {
  char line[256];
  double total = 0, available = 0, value;
  struct rlimit limit;
  FILE *stream = fopen("/proc/meminfo", "r");
  while (stream && fgets(line, sizeof line, stream)) {
    if (sscanf(line, "MemTotal: %lf", &value) == 1) total = value;
    if (sscanf(line, "MemAvailable: %lf", &value) == 1) available = value;
  }
  if (stream) fclose(stream);
  const int length = snprintf(text, FACT_SIZE, "%.1f GiB, %.1f of it available", total / 0x1p20, available / 0x1p20);
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
    snprintf(text + length, FACT_SIZE - (size_t)length, "; a process may have %.1f GiB",
             (double)limit.rlim_cur / 0x1p30);
}

static bool is_in_path(const char *program) {
  const char *path = getenv("PATH");
  char *folders = path ? strdup(path) : NULL, *rest = folders;
  bool found = false;
  for (const char *folder; !found && rest && (folder = strsep(&rest, ":"));) {
    char *file = sty_join_path(*folder ? folder : ".", program);
    found = file && access(file, X_OK) == 0;
    free(file);
  }
  free(folders);
  return found;
}

static void tell_programs(char *text) {
  static const char *const programs[][2] = {{"ninja", "stylut batch"}, {"gnuplot", "stylut chart"}};
  *text = 0;
  for (size_t i = 0; i < sizeof programs / sizeof *programs; i++)
    snprintf(text + strlen(text), FACT_SIZE - strlen(text), "%s%s: %s", i ? "; " : "", programs[i][0],
             is_in_path(programs[i][0]) ? "found" : "not found");
}

static const char *get_temporary(void) {
  const char *folder = getenv("TMPDIR");
  return folder && *folder ? folder : "/tmp";
}

static void tell_room(char *text) {
  struct statvfs info;
  const char *folder = get_temporary();
  if (statvfs(folder, &info) != 0)
    snprintf(text, FACT_SIZE, "%s: cannot be looked at", clean_text(folder));
  else
    snprintf(text, FACT_SIZE, "%s, %.1f GiB free", clean_text(folder),
             (double)info.f_bavail * (double)info.f_frsize / 0x1p30);
}

enum { FACTS = 7 };
static void gather_facts(Fact facts[FACTS]) {
  static const char *const names[FACTS] = {"made of", "system",   "runs on",  "vector units",
                                           "memory",  "programs", "temporary"};
  for (int i = 0; i < FACTS; i++) facts[i].name = names[i];
  format_libraries(facts[0].text);
  tell_system(facts[1].text);
  format_processor(facts[2].text);
  tell_units(facts[3].text);
  tell_memory(facts[4].text);
  tell_programs(facts[5].text);
  tell_room(facts[6].text);
}

/* ---- the self-check ---- */

enum { MOST_CHECKS = 16 };
typedef struct Outcome {
  StyError error; /* STY_OK: it works */
  double milliseconds;
} Outcome;

static StyStatus run_checks(Outcome outcomes[MOST_CHECKS], StyError *error) {
  char *folder = NULL, *name = sty_join_path(get_temporary(), "stylut-doctor");
  StyStatus status = name ? sty_make_temporary_folder(name, &folder, error) : sty_fail_memory(error, "doctor", 0);
  for (int i = 0; !status && checks[i].name; i++) {
    const double start = sty_get_milliseconds();
    outcomes[i].error = (StyError){STY_OK, ""};
    checks[i].run(folder, &outcomes[i].error);
    outcomes[i].milliseconds = sty_get_milliseconds() - start;
  }
  if (folder) sty_remove_temporary_folder(folder);
  free(folder);
  free(name);
  return status;
}

/* ---- reports ---- */

static void print_as_text(const Fact facts[FACTS], const Outcome outcomes[MOST_CHECKS]) {
  printf("stylut %s\n", STY_VERSION);
  for (int i = 0; i < FACTS; i++) printf("%-13s %s\n", facts[i].name, facts[i].text);
  printf("\n");
  for (int i = 0; checks[i].name; i++) {
    const bool works = outcomes[i].error.status == STY_OK;
    printf("%-6s  %-9s %s (%.0f ms)%s%s\n", works ? "works" : "FAILED", checks[i].name, checks[i].what,
           outcomes[i].milliseconds, works ? "" : ": ", works ? "" : clean_text(outcomes[i].error.text));
  }
}

static StyStatus print_as_json(const Fact facts[FACTS], const Outcome outcomes[MOST_CHECKS], StyError *error) {
  json_t *said = json_object(), *list = json_array();
  for (int i = 0; i < FACTS; i++) json_object_set_new(said, facts[i].name, make_json_text(facts[i].text));
  for (int i = 0; checks[i].name; i++) {
    json_t *entry = json_pack("{s:s, s:b, s:f}", "name", checks[i].name, "works", outcomes[i].error.status == STY_OK,
                              "time_ms", outcomes[i].milliseconds);
    if (outcomes[i].error.status) json_object_set_new(entry, "said", make_json_text(outcomes[i].error.text));
    json_array_append_new(list, entry);
  }
  return print_json(json_pack("{s:s, s:s, s:o, s:o}", "schema", "stylut-doctor/1", "version", STY_VERSION, "facts",
                              said, "checks", list),
                    error);
}

static StyStatus run(Options *options) {
  Fact facts[FACTS];
  Outcome outcomes[MOST_CHECKS];
  gather_facts(facts);
  StyStatus status = run_checks(outcomes, &options->error);
  if (status) return status;
  if (options->json)
    status = print_as_json(facts, outcomes, &options->error);
  else if (!options->quiet)
    print_as_text(facts, outcomes);
  for (int i = 0; !status && checks[i].name; i++)
    if (outcomes[i].error.status)
      return sty_fail(&options->error, STY_CHECK_FAILED, "%s: %s", checks[i].name, outcomes[i].error.text);
  return status;
}

StyStatus run_doctor(int argc, char **argv) {
  Options options = {.output = NULL};
  StyStatus status = parse_arguments(&parser, argc, argv, &options);
  if (!status && !options.helped) status = run(&options);
  return finish_command(&options, status);
}
