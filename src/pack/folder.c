#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pack/folder.h"

#include "pack/seal.h"

const char *const sty_bundle_files[STY_BUNDLE_FILES] = {"exemplars.ktx2", "guides.ktx2", "luts.ktx2", "params.ktx2",
                                                        "jitter.ktx2"};

static bool is_bundle_file(const char *name) {
  bool known = strcmp(name, STY_BUNDLE_INDEX) == 0 || strcmp(name, STY_IMPORT_SETTINGS) == 0;
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

void sty_remove_bundle(const char *folder) {
  for (int i = 0; i <= STY_BUNDLE_FILES + 1; i++) {
    char *file = sty_join_path(folder, i < STY_BUNDLE_FILES    ? sty_bundle_files[i]
                                       : i == STY_BUNDLE_FILES ? STY_IMPORT_SETTINGS
                                                               : STY_BUNDLE_INDEX);
    if (file) unlink(file);
    free(file);
  }
  rmdir(folder);
  sty_forget_temporary(folder);
}

StyStatus sty_open_bundle_folder(const char *path, StyBundleFolder *out, StyError *error) {
  StyBundleFolder folder = {.path = strdup(path)};
  if (!folder.path) return sty_fail_memory(error, path, (double)strlen(path));
  for (size_t length = strlen(path); length > 1 && folder.path[length - 1] == '/'; length--)
    folder.path[length - 1] = 0;
  StyStatus status = check_target(folder.path, error);
  if (!status) status = sty_make_temporary_folder(folder.path, &folder.temporary, error);
  if (status)
    free(folder.path);
  else
    *out = folder;
  return status;
}

char *sty_name_bundle_file(const StyBundleFolder *folder, const char *name, StyError *error) {
  char *file = sty_join_path(folder->temporary, name);
  if (!file) sty_fail_memory(error, folder->path, 0);
  return file;
}

/* {"name", "bytes", "sha256"} of a file, for the index. */
static StyStatus describe_file(const StyBundleFolder *folder, const char *name, json_t **out, StyError *error) {
  char hash[STY_HASH_SIZE];
  uint64_t size = 0;
  char *file = sty_name_bundle_file(folder, name, error);
  StyStatus status = file ? sty_check_file(file, &size, error) : STY_ERROR_LIBRARY;
  if (!status) status = sty_hash_file(file, hash, error);
  if (!status) *out = json_pack("{s:s, s:I, s:s}", "name", name, "bytes", (json_int_t)size, "sha256", hash);
  free(file);
  return status;
}

static StyStatus complete_index(const StyBundleFolder *folder, json_t *index, StyError *error) {
  json_t *files = json_array(), *entry = NULL;
  StyStatus status = STY_OK;
  json_object_set_new(index, "schema", json_string(STY_BUNDLE_SCHEMA));
  json_object_set_new(index, "version", json_string(STY_VERSION));
  json_object_set_new(index, "files", files);
  for (int i = 0; !status && i < STY_BUNDLE_FILES; i++) {
    status = describe_file(folder, sty_bundle_files[i], &entry, error);
    if (!status) json_array_append_new(files, entry);
  }
  if (!status) status = describe_file(folder, STY_IMPORT_SETTINGS, &entry, error);
  if (!status) json_object_set_new(index, STY_IMPORT_KEY, entry);
  char seal[STY_HASH_SIZE];
  if (!status) status = sty_seal_index(index, seal, error);
  if (!status) json_object_set_new(index, STY_SEAL_KEY, json_string(seal));
  return status;
}

static StyStatus write_index(const StyBundleFolder *folder, const json_t *index, StyError *error) {
  char *file = sty_name_bundle_file(folder, STY_BUNDLE_INDEX, error);
  const StyStatus status = file ? sty_write_json(file, index, error) : STY_ERROR_LIBRARY;
  free(file);
  return status;
}

/* Whoever could read a bundle still can, and nobody else. */
static void keep_mode(const char *from, const char *to) {
  struct stat info;
  if (stat(from, &info) != 0) return;
  if (chown(to, (uid_t)-1, info.st_gid) != 0) info.st_mode &= 0707; /* a group that we aren't of */
  chmod(to, info.st_mode & 07777);
}

static void keep_modes(const StyBundleFolder *folder) {
  const char *const more[] = {STY_IMPORT_SETTINGS, STY_BUNDLE_INDEX, ""};
  for (int i = 0; i < STY_BUNDLE_FILES + 3; i++) {
    const char *name = i < STY_BUNDLE_FILES ? sty_bundle_files[i] : more[i - STY_BUNDLE_FILES];
    char *from = sty_join_path(folder->path, name), *to = sty_join_path(folder->temporary, name);
    if (from && to) keep_mode(from, to);
    free(from);
    free(to);
  }
}

/* Renames the finished folder to its place; an earlier bundle there is swapped
 * out in one step and removed after. */
static StyStatus move_into_place(StyBundleFolder *folder, StyError *error) {
  struct stat info;
  const bool exists = lstat(folder->path, &info) == 0;
  if (exists) keep_modes(folder);
  if (sty_rename_temporary(folder->temporary, folder->path, exists ? RENAME_EXCHANGE : 0) != 0)
    return sty_fail(error, STY_ERROR_FILE, "%s: cannot write: %s; expected a new name or a bundle to replace",
                    folder->path, strerror(errno));
  if (exists) sty_remove_bundle(folder->temporary);
  free(folder->temporary);
  folder->temporary = NULL;
  return STY_OK;
}

StyStatus sty_commit_bundle_folder(StyBundleFolder *folder, json_t *index, StyError *error) {
  StyStatus status = complete_index(folder, index, error);
  if (!status) status = write_index(folder, index, error);
  StyLoadedBundle check;
  if (!status) {
    status = sty_load_bundle(folder->temporary, NULL, NULL, &check, error);
    if (!status) sty_unload_bundle(&check);
  }
  return status ? status : move_into_place(folder, error);
}

void sty_discard_bundle_folder(StyBundleFolder *folder) {
  if (folder->temporary) sty_remove_bundle(folder->temporary);
  free(folder->temporary);
  free(folder->path);
  *folder = (StyBundleFolder){.path = NULL};
}
