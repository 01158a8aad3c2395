#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pack/seal.h"
#include "stylut/pack.h"

const char *const sty_bundle_files[STY_BUNDLE_FILES] = {"exemplars.ktx2", "guides.ktx2", "luts.ktx2", "params.ktx2",
                                                        "jitter.ktx2"};

struct StyBundleWriter {
  char *path;
  char *temporary; /* folder beside it */
  StyBundleShape shape;
  StyKtx2 textures[STY_BUNDLE_FILES];
  int written;                        /* styles, and */
  int exemplars;                      /* layers of theirs */
  float (*params)[STY_MAX_STYLES][4]; /* STY_PARAM_ROWS rows */
};

static bool is_bundle_file(const char *name) {
  bool known = strcmp(name, STY_BUNDLE_INDEX) == 0;
  for (int i = 0; i < STY_BUNDLE_FILES; i++) known = known || strcmp(name, sty_bundle_files[i]) == 0;
  return known;
}

/* A folder we may replace is empty, or holds a bundle's files and nothing else. */
static StyStatus check_target(const char *path, StyError *error) {
  struct stat info;
  if (lstat(path, &info) != 0) return STY_OK;
  DIR *folder = S_ISDIR(info.st_mode) ? opendir(path) : NULL;
  if (!folder)
    return sty_fail(error, STY_ERROR_FILE,
                    "%s: found a file or a folder that can't be read, expected a new name or a bundle to replace",
                    path);
  StyStatus status = STY_OK;
  bool any = false, has_index = false;
  for (const struct dirent *entry; !status && (entry = readdir(folder));) {
    const char *name = entry->d_name;
    if (strcmp(name, ".") == 0 || strcmp(name, "..") == 0) continue;
    const bool ours =
        is_bundle_file(name) && fstatat(dirfd(folder), name, &info, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(info.st_mode);
    any = true;
    has_index = has_index || strcmp(name, STY_BUNDLE_INDEX) == 0;
    if (!ours)
      status = sty_fail(error, STY_ERROR_FILE,
                        "%s: found '%s' in the folder, expected a new name or a bundle to replace", path, name);
  }
  closedir(folder);
  if (!status && any && !has_index)
    status = sty_fail(
        error, STY_ERROR_FILE,
        "%s: found files but no " STY_BUNDLE_INDEX " in the folder, expected a new name or a bundle to replace", path);
  return status;
}

/* Removes a bundle's files and their folder; stays away from anything else. */
static void remove_bundle(const char *folder) {
  for (int i = 0; i <= STY_BUNDLE_FILES; i++) {
    char *file = sty_join_path(folder, i < STY_BUNDLE_FILES ? sty_bundle_files[i] : STY_BUNDLE_INDEX);
    if (file) unlink(file);
    free(file);
  }
  rmdir(folder);
}

static StyStatus open_texture(StyBundleWriter *writer, int which, uint32_t format, int width, int height, int layers,
                              StyError *error) {
  char *file = sty_join_path(writer->temporary, sty_bundle_files[which]);
  if (!file) return sty_fail_memory(error, writer->path, 0);
  const StyStatus status = sty_open_ktx2(file, format, width, height, layers, &writer->textures[which], error);
  free(file);
  return status;
}

static StyStatus make_temporary(StyBundleWriter *writer, const char *path, StyError *error) {
  writer->path = strdup(path);
  if (!writer->path) return sty_fail_memory(error, path, (double)strlen(path));
  for (size_t length = strlen(path); length > 1 && writer->path[length - 1] == '/'; length--)
    writer->path[length - 1] = 0;
  const StyStatus status = check_target(writer->path, error);
  if (status) return status;
  int made = -1;
  char *name = NULL;
  for (unsigned attempt = 0; made != 0 && attempt < STY_TEMPORARY_ATTEMPTS; attempt++) {
    free(name);
    name = sty_name_temporary(writer->path, attempt);
    made = name ? mkdir(name, 0777) : -1;
    if (made != 0 && errno != EEXIST) break;
  }
  if (made == 0) {
    writer->temporary = name;
    return STY_OK;
  }
  const int cause = errno;
  free(name);
  return sty_fail(error, STY_ERROR_FILE, "%s: cannot write: %s; expected a folder that exists and can be written to",
                  path, strerror(cause));
}

StyStatus sty_open_bundle_writer(const char *path, const StyBundleShape *shape, StyBundleWriter **out,
                                 StyError *error) {
  if (shape->style_count < 1 || shape->style_count > STY_MAX_STYLES)
    return sty_fail(error, STY_ERROR_USAGE, "%s: found %d styles, expected 1 to %d", path, shape->style_count,
                    STY_MAX_STYLES);
  StyBundleWriter *writer = calloc(1, sizeof *writer);
  if (writer) writer->params = calloc(STY_PARAM_ROWS, sizeof *writer->params);
  if (!writer || !writer->params) {
    free(writer);
    return sty_fail_memory(error, path, sizeof *writer);
  }
  writer->shape = *shape;
  StyStatus status = make_temporary(writer, path, error);
  const int styles = shape->style_count;
  if (!status)
    status = open_texture(writer, STY_BUNDLE_EXEMPLARS, STY_VK_R8G8B8A8_SRGB, shape->width, shape->height,
                          shape->exemplar_count, error);
  if (!status)
    status = open_texture(writer, STY_BUNDLE_GUIDES, STY_VK_R8G8B8A8_UNORM, shape->width, shape->height, styles, error);
  if (!status)
    status =
        open_texture(writer, STY_BUNDLE_LUTS, STY_VK_R16G16_UNORM, shape->lut_size, shape->lut_size, styles, error);
  if (!status)
    status = open_texture(writer, STY_BUNDLE_PARAMS, STY_VK_R32G32B32A32_SFLOAT, styles, STY_PARAM_ROWS, 1, error);
  if (!status)
    status = open_texture(writer, STY_BUNDLE_JITTER, STY_VK_R8G8_UNORM, STY_JITTER_SIZE, STY_JITTER_SIZE,
                          shape->jitter_count, error);
  if (status)
    sty_discard_bundle(&writer);
  else
    *out = writer;
  return status;
}

StyStatus sty_write_style(StyBundleWriter *writer, const uint8_t *const *exemplars, const uint8_t *guide,
                          const uint16_t *lut, const StyStyle *parameters, StyError *error) {
  if (writer->written >= writer->shape.style_count)
    return sty_fail(error, STY_ERROR_USAGE, "%s: found more styles than the %d expected", writer->path,
                    writer->shape.style_count);
  const int style = writer->written++, layers = sty_count_layers(parameters);
  float rows[STY_PARAM_ROWS][4];
  StyStyle placed = *parameters;
  placed.layer = writer->exemplars;
  writer->exemplars += layers;
  sty_encode_style(&placed, rows);
  for (int row = 0; row < STY_PARAM_ROWS; row++) memcpy(writer->params[row][style], rows[row], sizeof rows[row]);
  StyStatus status = STY_OK;
  for (int layer = 0; !status && layer < layers; layer++)
    status = sty_write_ktx2_layer(&writer->textures[STY_BUNDLE_EXEMPLARS], exemplars[layer], error);
  if (!status) status = sty_write_ktx2_layer(&writer->textures[STY_BUNDLE_GUIDES], guide, error);
  if (!status) status = sty_write_ktx2_layer(&writer->textures[STY_BUNDLE_LUTS], lut, error);
  return status;
}

static StyStatus write_parameters(StyBundleWriter *writer, StyError *error) {
  const size_t row_size = (size_t)writer->shape.style_count * sizeof writer->params[0][0];
  char *texels = malloc(STY_PARAM_ROWS * row_size);
  if (!texels) return sty_fail_memory(error, writer->path, (double)(STY_PARAM_ROWS * row_size));
  for (int row = 0; row < STY_PARAM_ROWS; row++) memcpy(texels + (size_t)row * row_size, writer->params[row], row_size);
  const StyStatus status = sty_write_ktx2_layer(&writer->textures[STY_BUNDLE_PARAMS], texels, error);
  free(texels);
  return status;
}

/* {"name", "bytes", "sha256"} of every texture, for the index. */
static StyStatus list_files(const StyBundleWriter *writer, json_t *files, StyError *error) {
  StyStatus status = STY_OK;
  for (int i = 0; !status && i < STY_BUNDLE_FILES; i++) {
    char *file = sty_join_path(writer->temporary, sty_bundle_files[i]);
    char hash[STY_HASH_SIZE];
    uint64_t size = 0;
    status = file ? sty_check_file(file, &size, error) : sty_fail_memory(error, writer->path, 0);
    if (!status) status = sty_hash_file(file, hash, error);
    if (!status)
      json_array_append_new(
          files, json_pack("{s:s, s:I, s:s}", "name", sty_bundle_files[i], "bytes", (json_int_t)size, "sha256", hash));
    free(file);
  }
  return status;
}

static StyStatus write_index(const StyBundleWriter *writer, json_t *index, StyError *error) {
  json_t *files = json_array();
  StyStatus status = list_files(writer, files, error);
  json_object_set_new(index, "schema", json_string(STY_BUNDLE_SCHEMA));
  json_object_set_new(index, "version", json_string(STY_VERSION));
  json_object_set_new(index, "files", files);
  char seal[STY_HASH_SIZE];
  if (!status) status = sty_seal_index(index, seal, error);
  if (!status) json_object_set_new(index, STY_SEAL_KEY, json_string(seal));
  char *file = sty_join_path(writer->temporary, STY_BUNDLE_INDEX);
  StyOutput output;
  if (!status) status = file ? sty_open_output(file, &output, error) : sty_fail_memory(error, writer->path, 0);
  if (!status) {
    json_dumpf(index, output.stream, JSON_INDENT(2) | JSON_SORT_KEYS | JSON_REAL_PRECISION(STY_INDEX_PRECISION));
    fputc('\n', output.stream);
    status = sty_commit_output(&output, error);
  }
  free(file);
  return status;
}

/* Renames the finished folder to its place; an earlier bundle there is swapped
 * out in one step and removed after. */
static StyStatus move_into_place(StyBundleWriter *writer, StyError *error) {
  struct stat info;
  const bool exists = lstat(writer->path, &info) == 0;
  if (renameat2(AT_FDCWD, writer->temporary, AT_FDCWD, writer->path, exists ? RENAME_EXCHANGE : 0) != 0)
    return sty_fail(error, STY_ERROR_FILE, "%s: cannot write: %s; expected a new name or a bundle to replace",
                    writer->path, strerror(errno));
  if (exists) remove_bundle(writer->temporary);
  free(writer->temporary);
  writer->temporary = NULL;
  return STY_OK;
}

StyStatus sty_commit_bundle(StyBundleWriter **writer_slot, const uint8_t *jitter, json_t *index, StyError *error) {
  StyBundleWriter *writer = *writer_slot;
  StyStatus status = write_parameters(writer, error);
  for (int table = 0; !status && table < writer->shape.jitter_count; table++)
    status = sty_write_ktx2_layer(&writer->textures[STY_BUNDLE_JITTER], jitter + table * STY_JITTER_BYTES, error);
  for (int i = 0; !status && i < STY_BUNDLE_FILES; i++) status = sty_commit_ktx2(&writer->textures[i], error);
  if (!status) status = write_index(writer, index, error);
  StyLoadedBundle check;
  if (!status) {
    status = sty_load_bundle(writer->temporary, NULL, NULL, &check, error);
    if (!status) sty_unload_bundle(&check);
  }
  if (!status) status = move_into_place(writer, error);
  sty_discard_bundle(writer_slot);
  return status;
}

void sty_discard_bundle(StyBundleWriter **writer_slot) {
  StyBundleWriter *writer = *writer_slot;
  if (!writer) return;
  for (int i = 0; i < STY_BUNDLE_FILES; i++) sty_discard_ktx2(&writer->textures[i]);
  if (writer->temporary) remove_bundle(writer->temporary);
  free(writer->temporary);
  free(writer->path);
  free(writer->params);
  free(writer);
  *writer_slot = NULL;
}
