/* stylut guide KIND */
#include <stdio.h>
#include <string.h>

#include "commands.h"
#include "options.h"
#include "similar.h"

static const char *const names[] = {"sphere", "scene", "import", "strokes", "warp", "flow", NULL};
static StyStatus (*const runs[])(int argc, char **argv) = {run_guide_sphere,  run_guide_scene, run_guide_import,
                                                           run_guide_strokes, run_guide_warp,  run_guide_flow};

static int find_kind(const char *word) {
  for (int k = 0; names[k]; k++)
    if (strcmp(word, names[k]) == 0) return k;
  return -1;
}

/* Each kind reads its own command line; what comes here hasn't begun with one. */
static StyStatus fail_kind(Options *options, const char *word) {
  char hint[HINT_SIZE];
  if (find_kind(word) >= 0)
    return sty_fail(&options->error, STY_ERROR_USAGE,
                    "guide %s: found behind options, expected 'stylut guide %s' and then those", word, word);
  return sty_fail(&options->error, STY_ERROR_USAGE,
                  "guide: found %s%s%s, expected sphere, scene, import, strokes, warp or flow%s", word[0] ? "'" : "",
                  word[0] ? word : "nothing", word[0] ? "'" : "", hint_at(word, names, hint));
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: return end_option(fail_kind(state->input, text));
    case ARGP_KEY_NO_ARGS: return end_option(fail_kind(state->input, ""));
    default: return ARGP_ERR_UNKNOWN;
  }
}

static const struct argp_child children[] = {{&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .parser = parse_option,
    .args_doc = "sphere\nscene MESH|SCENE.json\nimport FILE\nstrokes IMAGE\nwarp PAIRS.json\nflow A B",
    .doc =
        "Makes a guide map: what a picture's surfaces are, pixel by pixel.\v"
        "'sphere' is the map of a painted sphere, 'scene' traces meshes, 'import' turns another program's file into a "
        "guide, 'strokes' measures a picture at several scales, 'warp' bends one by pairs of points, 'flow' finds the "
        "motion between two. Each has options of its own: 'stylut guide scene --help' and so on.",
    .children = children,
};

StyStatus run_guide(int argc, char **argv) {
  const int kind = argc > 1 ? find_kind(argv[1]) : -1;
  if (kind >= 0) {
    static char program[32];
    snprintf(program, sizeof program, "stylut guide %s", names[kind]);
    argv[1] = program;
    return runs[kind](argc - 1, argv + 1);
  }
  Options options = {.output = NULL};
  const char *word = argc > 1 ? argv[1] : ""; /* parsing moves it */
  StyStatus status = parse_arguments(&parser, argc, argv, &options);
  for (int i = 1; i < argc && word[0] == '-'; i++)
    if (find_kind(argv[i]) >= 0) word = argv[i];
  if (status && word[0] != '-') status = fail_kind(&options, word);
  return finish_command(&options, status);
}
