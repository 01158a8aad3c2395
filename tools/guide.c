/* stylut guide KIND */
#include <stdio.h>
#include <string.h>

#include "commands.h"

/* Kinds that have a command line of their own. */
static const struct {
  const char *name;
  StyStatus (*run)(int argc, char **argv);
} kinds[] = {
    {"import", run_guide_import},
    {"strokes", run_guide_strokes},
    {"warp", run_guide_warp},
    {"flow", run_guide_flow},
};

StyStatus run_guide(int argc, char **argv) {
  for (size_t k = 0; argc > 1 && k < sizeof kinds / sizeof *kinds; k++) {
    static char program[32];
    if (strcmp(argv[1], kinds[k].name) != 0) continue;
    snprintf(program, sizeof program, "stylut guide %s", kinds[k].name);
    argv[1] = program;
    return kinds[k].run(argc - 1, argv + 1);
  }
  return run_guide_scene(argc, argv);
}
