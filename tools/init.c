/* stylut init FOLDER: a project of styles that packs and passes its checks at once. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "commands.h"
#include "options.h"
#include "stylut/file.h"
#include "take.h"

TAKE(init_styles, "styles.json");
TAKE(init_workflow, "workflow.yml");
TAKE(init_pre_commit, "pre-commit");
TAKE(init_attributes, "gitattributes");
TAKE(init_ignore, "gitignore");
TAKE(init_readme, "readme.md");

typedef struct Arguments {
  Options options;
  const char *folder;
} Arguments;

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  return parse_only_argument(key, text, state, &arguments->folder, "a folder");
}

static const struct argp_child children[] = {{&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .parser = parse_option,
    .args_doc = "FOLDER",
    .doc =
        "Writes a project of three painted styles: a manifest with budgets, which 'stylut batch --check' packs at "
        "once, "
        "a workflow for GitHub, a hook for git, and a page on how to go on.\v"
        "Files that are there already and say something else are never written over: the folder is new, empty, or one "
        "that this command was ended in before.",
    .children = children,
};

typedef struct ProjectFile {
  const char *name, *text;
  mode_t mode;
} ProjectFile;

static const char *const folders[] = {"", "painted", "hooks", ".github", ".github/workflows"};
enum { FOLDERS = sizeof folders / sizeof *folders };

static const ProjectFile files[] = {{".gitattributes", init_attributes, 0644},
                                    {".gitignore", init_ignore, 0644},
                                    {".github/workflows/styles.yml", init_workflow, 0644},
                                    {"hooks/pre-commit", init_pre_commit, 0755},
                                    {"README.md", init_readme, 0644},
                                    {"styles.json", init_styles, 0644}};
enum { FILES = sizeof files / sizeof *files };

/* Spheres as 'stylut toon' paints them; {"--texture", ...}. */
typedef struct Painting {
  const char *name, *texture, *bands, *colours, *strength, *cell;
} Painting;

static const Painting paintings[] = {
    {"painted/engraving.png", "hatch", "0.15,0.35,0.6,0.85", "1d2b53,2f5d8a,5b9bb8,a8d0d6,f4f1de", "0.35", "64"},
    {"painted/gouache.png", "noise", "0.2,0.45,0.7", "6b2d1f,b5542c,e39a4f,f6dfa8", "0.5", "32"},
    {"painted/ink.png", "hatch", "0.5", "2b2b2b,f4f1de", "1", "32"}};
enum { PAINTINGS = sizeof paintings / sizeof *paintings };

static StyStatus make_folder(const char *path, StyError *error) {
  struct stat info;
  if (mkdir(path, 0777) == 0 || (errno == EEXIST && stat(path, &info) == 0 && S_ISDIR(info.st_mode))) return STY_OK;
  return sty_fail(error, STY_ERROR_FILE, "%s: cannot create: %s; expected a folder that can be written to", path,
                  strerror(errno));
}

/* A file that is there must be the one that would be written. */
static StyStatus check_file(const char *path, const char *text, StyError *error) {
  unsigned char *held = NULL;
  size_t size = 0;
  struct stat info;
  if (lstat(path, &info) != 0) return STY_OK;
  StyStatus status = sty_read_file(path, 1 << 20, &held, &size, error);
  if (!status && (size != strlen(text) || memcmp(held, text, size) != 0))
    status =
        sty_fail(error, STY_ERROR_FILE, "%s: found a file with other contents, expected a new or empty folder", path);
  free(held);
  return status;
}

static StyStatus write_file(const char *path, const ProjectFile *file, StyError *error) {
  StyOutput output;
  const StyStatus status = sty_open_output(path, &output, error);
  if (status) return status;
  fputs(file->text, output.stream);
  fchmod(fileno(output.stream), file->mode);
  return sty_commit_output(&output, error);
}

static StyStatus do_files(const char *folder, bool writes, StyError *error) {
  StyStatus status = STY_OK;
  for (int i = 0; !status && i < FILES; i++) {
    char *path = sty_join_path(folder, files[i].name);
    if (!path) return sty_fail_memory(error, folder, 0);
    status = writes ? write_file(path, &files[i], error) : check_file(path, files[i].text, error);
    free(path);
  }
  return status;
}

/* The commands say themselves what fails. */
static StyStatus paint(const Painting *painting, char *guide, char *path) {
  char *const words[] = {"stylut toon",
                         "--guide",
                         guide,
                         "--texture",
                         (char *)(uintptr_t)painting->texture,
                         "--bands",
                         (char *)(uintptr_t)painting->bands,
                         "--colours",
                         (char *)(uintptr_t)painting->colours,
                         "--strength",
                         (char *)(uintptr_t)painting->strength,
                         "--cell",
                         (char *)(uintptr_t)painting->cell,
                         "--no-history",
                         "-q",
                         "-o",
                         path,
                         NULL};
  return run_toon(sizeof words / sizeof *words - 1, (char **)(uintptr_t)words);
}

static StyStatus paint_all(const char *folder, StyError *error) {
  char *scratch = NULL, *guide = NULL, *inside = sty_join_path(folder, "painted");
  StyStatus status = inside ? sty_make_temporary_folder(inside, &scratch, error) : sty_fail_memory(error, folder, 0);
  if (!status && !(guide = sty_join_path(scratch, "sphere.exr"))) status = sty_fail_memory(error, folder, 0);
  char *words[] = {"stylut guide sphere", "-s", "512", "--no-history", "-q", "-o", guide, NULL};
  if (!status) status = run_guide_sphere(sizeof words / sizeof *words - 1, words);
  for (int i = 0; !status && i < PAINTINGS; i++) {
    char *path = sty_join_path(folder, paintings[i].name);
    status = path ? STY_OK : sty_fail_memory(error, folder, 0);
    if (!status && access(path, F_OK) != 0) status = paint(&paintings[i], guide, path);
    free(path);
  }
  if (scratch) sty_remove_temporary_folder(scratch);
  free(scratch);
  free(guide);
  free(inside);
  return status;
}

static StyStatus run(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  StyStatus status = do_files(arguments->folder, false, error);
  for (int i = 0; !status && i < FOLDERS; i++) {
    char *path = *folders[i] ? sty_join_path(arguments->folder, folders[i]) : strdup(arguments->folder);
    status = path ? make_folder(path, error) : sty_fail_memory(error, arguments->folder, 0);
    free(path);
  }
  if (!status) status = paint_all(arguments->folder, error);
  if (!status) status = do_files(arguments->folder, true, error);
  if (status) return status;
  if (arguments->options.json)
    return print_json(json_pack("{s:s, s:o, s:i, s:i}", "schema", "stylut-init/1", "folder",
                                make_json_text(arguments->folder), "files", FILES, "paintings", PAINTINGS),
                      error);
  if (!arguments->options.quiet)
    printf("%s: a project of %d styles; next: cd %s && stylut batch styles.json -o bundles --check\n",
           clean_text(arguments->folder), PAINTINGS, clean_text(arguments->folder));
  return STY_OK;
}

StyStatus run_init(int argc, char **argv) {
  Arguments arguments = {.folder = NULL};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments);
  return finish_command(&arguments.options, status);
}
