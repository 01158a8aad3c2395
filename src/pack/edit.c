/* Parameters of a bundle that is there already: set in memory, and put into its folder. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "pack/folder.h"

static StyStatus copy_parameters(StyLoadedBundle *bundle, StyError *error) {
  StyTexture *texture = &bundle->bundle.textures[STY_BUNDLE_PARAMS];
  const size_t size = (size_t)texture->width * texture->height * texture->texel_size;
  bundle->parameters = malloc(size);
  if (!bundle->parameters) return sty_fail_memory(error, "parameters", (double)size);
  memcpy(bundle->parameters, texture->texels, size);
  texture->texels = bundle->parameters;
  return STY_OK;
}

StyStatus sty_put_style(StyLoadedBundle *bundle, int number, const StyStyle *style, StyError *error) {
  float rows[STY_PARAM_ROWS][4];
  const StyStatus status = bundle->parameters ? STY_OK : copy_parameters(bundle, error);
  if (status) return status;
  sty_encode_style(style, rows);
  const size_t styles = bundle->bundle.textures[STY_BUNDLE_PARAMS].width;
  for (size_t row = 0; row < STY_PARAM_ROWS; row++)
    memcpy(bundle->parameters + (row * styles + (size_t)number - 1) * sizeof rows[row], rows[row], sizeof rows[row]);
  const json_t *entries = json_object_get(bundle->index.root, "styles");
  json_object_set_new(json_array_get(entries, (size_t)number - 1), "params", sty_describe_parameters(style));
  return STY_OK;
}

/* STYLE.KEY=VALUE taken apart, in place; no style: all of them. Names may have dots and equals signs; keys and values
 * have none, but for a number's. */
typedef struct Setting {
  char *style, *key, *value;
} Setting;

static bool split_setting(char *text, Setting *out) {
  char *equals = strrchr(text, '=');
  if (!equals) return false;
  *equals = 0;
  char *dot = strrchr(text, '.');
  if (dot) *dot = 0;
  *out = (Setting){dot ? text : NULL, dot ? dot + 1 : text, equals + 1};
  return true;
}

static StyStatus apply_setting(const char *what, const Setting *setting, StyLoadedBundle *bundle, StyError *error) {
  int first = 1, last = (int)bundle->bundle.textures[STY_BUNDLE_PARAMS].width;
  StyStatus status = setting->style ? sty_find_style(what, setting->style, bundle, &first, error) : STY_OK;
  if (setting->style) last = first;
  for (int number = first; !status && number <= last; number++) {
    StyStyle style;
    sty_get_style(&bundle->bundle, number, &style);
    status = sty_set_parameter(what, setting->key, setting->value, &style, error);
    if (!status) status = sty_put_style(bundle, number, &style, error);
  }
  return status;
}

StyStatus sty_set_bundle_parameter(const char *what, const char *text, StyLoadedBundle *bundle, StyError *error) {
  Setting setting;
  char *copy = strdup(text);
  if (!copy) return sty_fail_memory(error, what, (double)strlen(text));
  const StyStatus status =
      split_setting(copy, &setting)
          ? apply_setting(what, &setting, bundle, error)
          : sty_fail(error, STY_ERROR_USAGE,
                     "%s: found '%s', expected KEY=VALUE for all styles or STYLE.KEY=VALUE for one", what, text);
  free(copy);
  return status;
}

/* The files that stay are the same ones under another name. */
static StyStatus keep_file(const char *path, const StyBundleFolder *folder, const char *name, StyError *error) {
  char *from = sty_join_path(path, name), *to = sty_name_bundle_file(folder, name, error);
  const StyStatus status = from && to ? sty_take_file(from, to, error) : sty_fail_memory(error, path, 0);
  free(from);
  free(to);
  return status;
}

static StyStatus write_texture(const StyLoadedBundle *bundle, const StyBundleFolder *folder, StyError *error) {
  const StyTexture *texture = &bundle->bundle.textures[STY_BUNDLE_PARAMS];
  char *file = sty_name_bundle_file(folder, sty_bundle_files[STY_BUNDLE_PARAMS], error);
  if (!file) return STY_ERROR_LIBRARY;
  const StyStatus status =
      sty_write_ktx2(file, STY_VK_R32G32B32A32_SFLOAT, (int)texture->width, STY_PARAM_ROWS, 1, texture->texels, error);
  free(file);
  return status;
}

StyStatus sty_save_parameters(const char *name, const StyLoadedBundle *bundle, StyError *error) {
  StyBundleFolder folder = {.path = NULL};
  char *path = realpath(name, NULL); /* links to a bundle stay */
  StyStatus status =
      path ? sty_open_bundle_folder(path, &folder, error)
           : sty_fail(error, STY_ERROR_FILE, "%s: cannot write: %s; expected a bundle folder", name, strerror(errno));
  for (int i = 0; !status && i < STY_BUNDLE_FILES; i++)
    if (i != STY_BUNDLE_PARAMS) status = keep_file(path, &folder, sty_bundle_files[i], error);
  if (!status) status = keep_file(path, &folder, STY_IMPORT_SETTINGS, error);
  if (!status) status = write_texture(bundle, &folder, error);
  if (!status) status = sty_commit_bundle_folder(&folder, bundle->index.root, NULL, error);
  sty_discard_bundle_folder(&folder);
  free(path);
  return status;
}
