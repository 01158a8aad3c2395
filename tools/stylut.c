/* stylut COMMAND: finds the command and hands the rest of the line to it. */
#include <errno.h>
#include <malloc.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "machine.h"
#include "options.h"
#include "similar.h"
#include "stylut/file.h"
#include "stylut/guide.h"
#include "stylut/image_io.h"
#include "stylut/lut.h"
#include "stylut/version.h"

typedef struct Command {
  const char *name;
  const char *summary;
  StyStatus (*run)(int argc, char **argv);
} Command;

static const Command commands[] = {
    {"guide", "make a guide map: of a sphere, a scene, a picture, other programs' passes", run_guide},
    {"lut", "build the nearest-neighbour look-up table of a guide", run_lut},
    {"match", "find each pixel's nearest source pixel by any channels", run_match},
    {"probe", "send one guide value through a table, step by step", run_probe},
    {"check", "audit a table and hold it to budgets", run_check},
    {"report", "show the audit of a table as a page with maps and charts", run_report},
    {"chart", "draw speed against accuracy over engines, sizes, maps and encodings", run_chart},
    {"pack", "pack exemplars, guides and tables into a bundle", run_pack},
    {"batch", "pack many bundles, and only what has changed since the last time", run_batch},
    {"step", "do one step of a batch, for its ninja file", run_step},
    {"params", "print a bundle's parameters, and change them in place", run_params},
    {"unpack", "take a bundle apart into pictures and a manifest", run_unpack},
    {"stylize", "dress a frame's guide in a bundle's style", run_stylize},
    {"toon", "shade a frame's guide in steps of light", run_toon},
    {"outline", "draw the lines around and inside what a frame's guide shows", run_outline},
    {"info", "say what a file or bundle holds", run_info},
    {"validate", "verify a bundle, finding by finding", run_validate},
    {"compare", "say whether and where two pictures differ", run_compare},
    {"init", "write a project of styles that packs and passes its checks at once", run_init},
    {"doctor", "say what this machine has, and check that it all works", run_doctor},
    {"bench", "measure speed on this machine beside the committed figures", run_bench},
};
enum { COMMAND_COUNT = sizeof commands / sizeof *commands };

static StyStatus print_help(void) {
  printf(
      "Usage: stylut COMMAND [OPTION...]\n"
      "Prepares what example-based stylization needs before the first frame is drawn.\n\n");
  for (int i = 0; i < COMMAND_COUNT; i++) printf("  %-10s %s\n", commands[i].name, commands[i].summary);
  printf(
      "\n'stylut COMMAND --help' says more. 'stylut --version' lists the libraries.\n"
      "Exit codes: 0 done, 1 usage, 2 file cannot be read or written, 3 invalid input,\n"
      "4 library or memory failure, 5 not built in, 6 check failed, 7 files differ.\n");
  return STY_OK;
}

static StyStatus print_version(void) {
  char libraries[MACHINE_SIZE];
  printf("stylut %s\n%s\n", STY_VERSION, format_libraries(libraries));
  printf("stylut's own code is under the MIT licence. %s\n",
         sty_get_geometry_library_version()
             ? "This binary is linked with parts of CGAL that are\n"
               "GPL-3.0-or-later: as a whole it is distributed under the GPL. Build with CGAL=0 to go without."
             : "This binary is built without CGAL and is not under the GPL.");
  return STY_OK;
}

/* A full disk behind stdout must not pass for success. A reader that has gone has what it wanted: that ends a program
 * as it ends others, once its files are whole. */
static int finish(StyStatus status) {
  errno = 0;
  const bool failed = fflush(stdout) != 0 || ferror(stdout);
  if (failed && errno == EPIPE) {
    signal(SIGPIPE, SIG_DFL);
    raise(SIGPIPE);
  }
  if (!failed || status) return (int)status;
  fprintf(stderr, "stylut: error: standard output: cannot write%s%s; expected room for the report\n", errno ? ": " : "",
          errno ? strerror(errno) : "");
  return STY_ERROR_FILE;
}

static StyStatus refuse_command(const char *name) {
  const char *names[COMMAND_COUNT + 1] = {NULL};
  char hint[HINT_SIZE];
  StyError error;
  for (int i = 0; i < COMMAND_COUNT; i++) names[i] = commands[i].name;
  if (*name)
    sty_fail(&error, STY_ERROR_USAGE, "found '%s', expected a command that 'stylut --help' lists%s", name,
             hint_at(name, names, hint));
  else
    sty_fail(&error, STY_ERROR_USAGE, "found no command, expected one that 'stylut --help' lists");
  fprintf(stderr, "stylut: error: %s\n", error.text);
  return STY_ERROR_USAGE;
}

/* What is misspelt would pass for the best unit there is. */
static bool is_unit_known(void) {
  const char *unit = getenv("STYLUT_VECTOR");
  if (!unit || !*unit || strcmp(unit, "plain") == 0 || strcmp(unit, "avx2") == 0 || strcmp(unit, "avx512") == 0)
    return true;
  fprintf(stderr, "stylut: error: STYLUT_VECTOR: found '%s', expected plain, avx2 or avx512\n", clean_text(unit));
  return false;
}

/* Arrays from this size on go back to the system when they are freed. Left to itself, malloc keeps larger ones the
 * larger those were that it saw, for each thread. */
enum { KEPT_SIZE = 4 << 20 };

int main(int argc, char **argv) {
  StyError error;
  if (!is_unit_known()) return STY_ERROR_USAGE;
  if (sty_claim_stack(&error)) {
    fprintf(stderr, "stylut: error: %s\n", error.text);
    return (int)error.status;
  }
  mallopt(M_MMAP_THRESHOLD, KEPT_SIZE);
  sty_clean_up_when_ended();
  static char help[] = "--help";
  if (argc == 3 && strcmp(argv[1], "help") == 0) {
    argv[1] = argv[2];
    argv[2] = help;
  }
  const char *name = argc > 1 ? argv[1] : "";
  if (strcmp(name, "--help") == 0 || strcmp(name, "-?") == 0 || strcmp(name, "help") == 0) return finish(print_help());
  if (strcmp(name, "--version") == 0 || strcmp(name, "-V") == 0) return finish(print_version());
  for (int i = 0; i < COMMAND_COUNT; i++) {
    if (strcmp(name, commands[i].name) != 0) continue;
    char program[32];
    snprintf(program, sizeof program, "stylut %s", name);
    argv[1] = program;
    return finish(commands[i].run(argc - 1, argv + 1));
  }
  return (int)refuse_command(name);
}
