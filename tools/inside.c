#include "inside.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* Where a file is or would be; NULL where not even its folder is there. The caller frees it. */
static char *resolve(const char *path) {
  char *place = realpath(path, NULL);
  if (place) return place;
  char *folder = sty_get_folder(path);
  place = folder ? realpath(folder, NULL) : NULL;
  free(folder);
  return place;
}

static bool is_inside(const char *root, const char *place) {
  const size_t length = strcmp(root, "/") == 0 ? 0 : strlen(root);
  return strncmp(root, place, length) == 0 && (place[length] == '/' || !place[length]);
}

StyStatus check_inside(const Packing *packing, const char *who, const char *path, StyError *error) {
  char *place = packing->root ? resolve(path) : NULL;
  const bool leaves = place && !is_inside(packing->root, place);
  free(place);
  if (!leaves) return STY_OK;
  return sty_fail(
      error, STY_ERROR_INPUT,
      "%s: found '%s', which is outside of the manifest's folder, expected a file inside, or --allow-outside", who,
      path);
}

static StyStatus check_name(const Packing *packing, const char *who, const char *name, StyError *error) {
  char *path = find_file(packing, name, error);
  const StyStatus status = path ? check_inside(packing, who, path, error) : STY_ERROR_LIBRARY;
  free(path);
  return status;
}

static StyStatus check_names(const Packing *packing, const char *who, const json_t *names, StyError *error) {
  StyStatus status = STY_OK;
  for (size_t i = 0; !status && i < sty_count_manifest_names(names); i++)
    status = check_name(packing, who, sty_get_manifest_name(names, i), error);
  return status;
}

static StyStatus check_style(const Packing *packing, const StyManifestStyle *style, StyError *error) {
  char who[320];
  StyStatus status = STY_OK;
  snprintf(who, sizeof who, "%s: style '%.200s'", sty_get_base_name(packing->arguments->manifest), style->name);
  for (int k = 0; !status && k < style->parameters.layer_count; k++)
    status = check_name(packing, who, style->exemplars[k], error);
  if (!status && !is_sphere(style)) status = check_name(packing, who, style->guide, error);
  if (!status && style->lut.file) status = check_name(packing, who, style->lut.file, error);
  return status ? status : check_names(packing, who, style->lut.frames, error);
}

StyStatus check_paths(Packing *packing, StyError *error) {
  const char *manifest = packing->arguments->manifest;
  if (packing->arguments->allow_outside) return STY_OK;
  packing->root = realpath(packing->manifest.folder, NULL);
  if (!packing->root)
    return sty_fail(error, STY_ERROR_FILE, "%s: cannot find its folder: %s", manifest, strerror(errno));
  StyStatus status = check_names(packing, manifest, packing->manifest.jitter, error);
  for (int i = 0; !status && i < packing->manifest.style_count; i++)
    status = check_style(packing, &packing->manifest.styles[i], error);
  return status;
}
