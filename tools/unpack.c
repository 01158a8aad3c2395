/* stylut unpack BUNDLE -o FOLDER: a bundle taken apart. */
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "commands.h"
#include "inputs.h"
#include "options.h"
#include "stylut/image_io.h"
#include "stylut/lut.h"
#include "stylut/pack.h"
#include "stylut/parse.h"

typedef struct Arguments {
  Options options;
  const char *bundle;
} Arguments;

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
  StyStatus status = STY_OK;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: status = take_argument(&arguments->options, &arguments->bundle, text); break;
    case ARGP_KEY_END:
      status = require_argument(&arguments->options, arguments->bundle, "the bundle's folder");
      if (!status) status = require_output(&arguments->options);
      break;
    default: return ARGP_ERR_UNKNOWN;
  }
  return end_option(status);
}

static const struct argp_child children[] = {{&output_argp, 0, NULL, 0}, {&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .parser = parse_option,
    .args_doc = "BUNDLE -o FOLDER",
    .doc =
        "Writes a bundle's exemplars, guides, look-up tables and jitter tables as PNG, and a manifest.json that packs "
        "to the same textures, byte for byte.\vThe folder must be new or empty. Bases are made again by 'pack', of "
        "the exemplars.",
    .children = children,
};

/* ---- the folder in the making ----------------------------------------------------- */

typedef struct Unpacking {
  const Arguments *arguments;
  const StyLoadedBundle *loaded;
  char *index;     /* bundle.json's path */
  char *temporary; /* folder */
} Unpacking;

static StyStatus check_target(const char *path, StyError *error) {
  struct stat info;
  if (lstat(path, &info) != 0) return STY_OK;
  DIR *folder = S_ISDIR(info.st_mode) ? opendir(path) : NULL;
  int entries = 0;
  while (folder && entries < 3 && readdir(folder)) entries++;
  if (folder) closedir(folder);
  return folder && entries < 3 ? STY_OK
                               : sty_fail(error, STY_ERROR_FILE, "%s: found %s, expected a new name or an empty folder",
                                          path, folder ? "files in the folder" : "a file");
}

static StyStatus open_folder(Unpacking *unpacking, StyError *error) {
  const char *path = unpacking->arguments->options.output;
  const StyStatus status = check_target(path, error);
  return status ? status : sty_make_temporary_folder(path, &unpacking->temporary, error);
}

static StyStatus commit_folder(Unpacking *unpacking, StyError *error) {
  const char *path = unpacking->arguments->options.output;
  if (sty_rename_temporary(unpacking->temporary, path, 0) != 0)
    return sty_fail(error, STY_ERROR_FILE, "%s: cannot write: %s; expected a new name or an empty folder", path,
                    strerror(errno));
  free(unpacking->temporary);
  unpacking->temporary = NULL;
  return STY_OK;
}

/* Nothing but our own files is in it. */
static void discard_folder(Unpacking *unpacking) {
  if (unpacking->temporary) sty_remove_temporary_folder(unpacking->temporary);
  free(unpacking->temporary);
  unpacking->temporary = NULL;
}

/* ---- pictures --------------------------------------------------------------------- */

/* A table isn't made of the bundle in the sense in which tables name their guide. */
static StyStatus write_picture(const Unpacking *unpacking, const char *name, StyImage *image, bool is_table,
                               StyError *error) {
  char *path = sty_join_path(unpacking->temporary, name);
  if (!path) return sty_fail_memory(error, name, 0);
  const char *const inputs[] = {unpacking->index};
  StyStatus status = add_history(&unpacking->arguments->options, "unpack", image, inputs, is_table ? 0 : 1, error);
  if (!status) status = sty_write_image(path, image, error);
  free(path);
  return status;
}

/* One layer of bytes; two channels get a third, which is 0. */
static StyStatus write_bytes(const Unpacking *unpacking, int which, uint32_t layer, const char *name, StyError *error) {
  static const char *const names[] = {"R", "G", "B", "A"};
  const StyTexture *texture = &unpacking->loaded->bundle.textures[which];
  const size_t pixels = (size_t)texture->width * texture->height, held = texture->texel_size;
  const unsigned char *texels = texture->texels + layer * pixels * held;
  StyImage *image = NULL;
  StyStatus status =
      sty_create_image((int)texture->width, (int)texture->height, held == 4 ? 4 : 3, names, 8, &image, error);
  if (status) return status;
  for (size_t i = 0; i < pixels; i++)
    for (size_t c = 0; c < held; c++) image->data[c * pixels + i] = (float)texels[held * i + c] / 255;
  status = write_picture(unpacking, name, image, false, error);
  sty_destroy_image(&image);
  return status;
}

static StyStatus write_table(const Unpacking *unpacking, uint32_t layer, bool unorm8, const char *name,
                             StyError *error) {
  const StyTexture *texture = &unpacking->loaded->bundle.textures[STY_BUNDLE_LUTS];
  const StyTexture *source = &unpacking->loaded->bundle.textures[STY_BUNDLE_GUIDES];
  StyLut *lut = NULL;
  StyImage *image = NULL;
  StyStatus status = decode_table(texture, layer, unorm8 ? STY_SAMPLE_UNORM8 : STY_SAMPLE_CENTRE, (int)source->width,
                                  (int)source->height, &lut, error);
  if (!status) status = sty_encode_lut(lut, STY_ENCODE_RG16, &image, error);
  if (!status) status = write_picture(unpacking, name, image, true, error);
  sty_destroy_image(&image);
  sty_destroy_lut(&lut);
  return status;
}

/* ---- styles ----------------------------------------------------------------------- */

enum { STEM_SIZE = 64, NAME_SIZE = 96 };

/* "007-pencil": a number, and what of the style's name is good in every file name. */
static void name_stem(int number, const char *style, char out[STEM_SIZE]) {
  int length = snprintf(out, STEM_SIZE, "%03d-", number);
  for (; *style && length < STEM_SIZE - 1; style++) {
    const char c = *style;
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-';
    out[length++] = plain ? c : '_';
  }
  out[length] = 0;
}

static StyStatus write_exemplars(const Unpacking *unpacking, const StyStyle *style, const char *stem, json_t *entry,
                                 StyError *error) {
  json_t *list = json_array();
  StyStatus status = STY_OK;
  for (int i = 0; !status && i < style->layer_count; i++) {
    char name[NAME_SIZE];
    if (style->layer_count == 1)
      snprintf(name, sizeof name, "%s.png", stem);
    else
      snprintf(name, sizeof name, "%s.%d.png", stem, i + 1);
    status = write_bytes(unpacking, STY_BUNDLE_EXEMPLARS, (uint32_t)(style->layer + i), name, error);
    json_array_append_new(list, json_pack("{s:s, s:f}", "image", name, "luma", sty_shorten_float(style->luma[i])));
  }
  if (style->layer_count == 1 && style->luma[0] == 0)
    json_object_set(entry, "exemplar", json_object_get(json_array_get(list, 0), "image"));
  else
    json_object_set(entry, "exemplars", list);
  json_decref(list);
  return status;
}

static StyStatus write_style(const Unpacking *unpacking, int number, json_t *entry, StyError *error) {
  const json_t *styles = json_object_get(unpacking->loaded->index.root, "styles");
  const json_t *listed = json_array_get(styles, (size_t)number - 1);
  const char *name = json_string_value(json_object_get(listed, "name"));
  const uint32_t layer = (uint32_t)number - 1;
  char stem[STEM_SIZE], guide[NAME_SIZE], table[NAME_SIZE];
  StyStyle style;
  sty_get_style(&unpacking->loaded->bundle, number, &style);
  if (!name || (style.flags & STY_FLAG_BASE && !json_is_number(json_object_get(listed, "base"))))
    return sty_fail(error, STY_ERROR_INPUT, "%s: found no name or no base at styles[%d], expected what pack writes",
                    unpacking->index, number - 1);
  name_stem(number, name, stem);
  snprintf(guide, sizeof guide, "%s.guide.png", stem);
  snprintf(table, sizeof table, "%s.lut.png", stem);
  const bool unorm8 = style.flags & STY_FLAG_UNORM8;
  json_object_set_new(entry, "name", json_string(name));
  StyStatus status = write_exemplars(unpacking, &style, stem, entry, error);
  if (!status) status = write_bytes(unpacking, STY_BUNDLE_GUIDES, layer, guide, error);
  if (!status) status = write_table(unpacking, layer, unorm8, table, error);
  json_object_set_new(entry, "guide", json_string(guide));
  if (style.flags & STY_FLAG_BASE) json_object_set(entry, "base", json_object_get(listed, "base"));
  json_object_set_new(entry, "lut", json_pack("{s:s, s:s}", "file", table, "sampling", unorm8 ? "unorm8" : "centre"));
  json_object_set_new(entry, "params", sty_describe_parameters(&style));
  return status;
}

static StyStatus write_styles(const Unpacking *unpacking, json_t *list, StyError *error) {
  const int count = (int)unpacking->loaded->bundle.textures[STY_BUNDLE_PARAMS].width;
  const StyRun run = begin_progress(&unpacking->arguments->options, "unpacking");
  StyStatus status = STY_OK;
  for (int number = 1; !status && number <= count; number++) {
    json_t *entry = json_object();
    status = write_style(unpacking, number, entry, error);
    json_array_append_new(list, entry);
    if (run.progress) run.progress(run.context, (double)number / count);
  }
  end_progress(&unpacking->arguments->options);
  return status;
}

static StyStatus write_jitters(const Unpacking *unpacking, json_t *names, StyError *error) {
  const uint32_t count = unpacking->loaded->bundle.textures[STY_BUNDLE_JITTER].layers;
  StyStatus status = STY_OK;
  for (uint32_t i = 0; !status && i < count; i++) {
    char name[NAME_SIZE];
    snprintf(name, sizeof name, "jitter.%03u.png", i + 1);
    status = write_bytes(unpacking, STY_BUNDLE_JITTER, i, name, error);
    json_array_append_new(names, json_string(name));
  }
  return status;
}

static StyStatus write_all(const Unpacking *unpacking, StyError *error) {
  json_t *styles = json_array(), *jitters = json_array();
  json_t *manifest = json_pack("{s:s, s:o, s:o}", "schema", "stylut-bundle/1", "styles", styles, "jitter", jitters);
  char *path = sty_join_path(unpacking->temporary, "manifest.json");
  StyStatus status = path ? write_styles(unpacking, styles, error) : sty_fail_memory(error, "manifest", 0);
  if (!status) status = write_jitters(unpacking, jitters, error);
  if (!status) status = sty_write_json(path, manifest, error);
  free(path);
  json_decref(manifest);
  return status;
}

/* ---- the command ------------------------------------------------------------------ */

static StyStatus unpack(Unpacking *unpacking, StyError *error) {
  const Arguments *arguments = unpacking->arguments;
  if (arguments->options.dry_run) return check_target(arguments->options.output, error);
  unpacking->index = sty_join_path(arguments->bundle, STY_BUNDLE_INDEX);
  StyStatus status = unpacking->index ? open_folder(unpacking, error) : sty_fail_memory(error, "index", 0);
  if (!status) status = write_all(unpacking, error);
  if (!status) status = commit_folder(unpacking, error);
  discard_folder(unpacking);
  free(unpacking->index);
  return status;
}

static StyStatus print_report(Options *options, const StyLoadedBundle *loaded, StyError *error) {
  const int styles = (int)loaded->bundle.textures[STY_BUNDLE_PARAMS].width;
  if (options->dry_run)
    return report_dry_run(options, "%d style%s, unpacked to %s", styles, styles == 1 ? "" : "s",
                          clean_text(options->output));
  if (options->json)
    return print_json(json_pack("{s:s, s:o, s:i}", "schema", "stylut-unpack/1", "folder",
                                make_json_text(options->output), "styles", styles),
                      error);
  if (!options->quiet) printf("%s: %d style%s\n", clean_text(options->output), styles, styles == 1 ? "" : "s");
  return STY_OK;
}

static StyStatus run(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  StyLoadedBundle loaded;
  StyStatus status = sty_load_bundle(arguments->bundle, NULL, NULL, &loaded, error);
  if (status) return status;
  Unpacking unpacking = {.arguments = arguments, .loaded = &loaded};
  status = unpack(&unpacking, error);
  if (!status) status = print_report(&arguments->options, &loaded, error);
  sty_unload_bundle(&loaded);
  return status;
}

StyStatus run_unpack(int argc, char **argv) {
  Arguments arguments = {.bundle = NULL};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments);
  return finish_command(&arguments.options, status);
}
