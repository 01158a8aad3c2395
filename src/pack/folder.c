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

static bool is_folder_itself(const char *name) { return strcmp(name, ".") == 0 || strcmp(name, "..") == 0; }

static bool is_bundle_file(const char *name) {
  bool known = strcmp(name, STY_BUNDLE_INDEX) == 0 || strcmp(name, STY_IMPORT_SETTINGS) == 0;
  for (int i = 0; i < STY_BUNDLE_FILES; i++) known = known || strcmp(name, sty_bundle_files[i]) == 0;
  return known;
}

/* ---- files that go from folder to folder ---- */

static StyStatus fail_copy(const char *path, StyError *error) {
  return sty_fail(error, STY_ERROR_FILE, "%s: cannot write: %s; expected room for a copy", path, strerror(errno));
}

static StyStatus copy_file(const char *from, const char *to, StyError *error) {
  struct stat info;
  const int in = open(from, O_RDONLY | O_CLOEXEC);
  if (in < 0) return sty_fail(error, STY_ERROR_FILE, "%s: cannot read: %s", from, strerror(errno));
  const int out = open(to, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  StyStatus status = out >= 0 && fstat(in, &info) == 0 ? STY_OK : fail_copy(to, error);
  for (off_t left = status ? 0 : info.st_size; left > 0;) {
    const ssize_t copied = copy_file_range(in, NULL, out, NULL, (size_t)left, 0);
    if (copied <= 0) {
      status = fail_copy(to, error);
      break;
    }
    left -= copied;
  }
  if (out >= 0 && close(out) != 0 && !status) status = fail_copy(to, error);
  close(in);
  return status;
}

StyStatus sty_take_file(const char *from, const char *to, StyError *error) {
  if (link(from, to) == 0) return STY_OK;
  if (errno == EXDEV || errno == EPERM || errno == EOPNOTSUPP || errno == EMLINK) return copy_file(from, to, error);
  return sty_fail(error, STY_ERROR_FILE, "%s: cannot link: %s", from, strerror(errno));
}

/* ---- the place of a bundle ---- */

/* Of an entry in a folder we may replace: a bundle's own, or a file of somebody else's that can come along. */
static StyStatus check_entry(const char *path, int folder, const char *name, StyError *error) {
  struct stat info;
  if (fstatat(folder, name, &info, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(info.st_mode)) return STY_OK;
  return sty_fail(error, STY_ERROR_FILE, "%s: found '%s' in the folder, no file; expected a new name or a bundle", path,
                  name);
}

StyStatus sty_check_bundle_place(const char *path, StyError *error) {
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
    if (is_folder_itself(entry->d_name)) continue;
    any = true;
    has_index = has_index || strcmp(entry->d_name, STY_BUNDLE_INDEX) == 0;
    status = check_entry(path, dirfd(folder), entry->d_name, error);
  }
  closedir(folder);
  if (!status && any && !has_index)
    status = sty_fail(
        error, STY_ERROR_FILE,
        "%s: found files but no " STY_BUNDLE_INDEX " in the folder, expected a new name or a bundle to replace", path);
  if (!status && access(path, W_OK | X_OK) != 0)
    status = sty_fail(error, STY_ERROR_FILE, "%s: cannot write: %s; expected a folder that can be written to", path,
                      strerror(errno));
  return status;
}

StyStatus sty_open_bundle_folder(const char *path, StyBundleFolder *out, StyError *error) {
  StyBundleFolder folder = {.path = strdup(path)};
  if (!folder.path) return sty_fail_memory(error, path, (double)strlen(path));
  for (size_t length = strlen(path); length > 1 && folder.path[length - 1] == '/'; length--)
    folder.path[length - 1] = 0;
  StyStatus status = sty_check_bundle_place(folder.path, error);
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

typedef struct Description {
  const StyBundleFolder *folder;
  json_t *entries[STY_BUNDLE_FILES];
} Description;

static StyStatus describe_texture_file(void *context, long i, StyError *error) {
  Description *description = context;
  return describe_file(description->folder, sty_bundle_files[i], &description->entries[i], error);
}

static StyStatus complete_index(const StyBundleFolder *folder, json_t *index, const StyRun *run, StyError *error) {
  json_t *files = json_array(), *entry = NULL;
  Description description = {.folder = folder};
  json_object_set_new(index, "schema", json_string(STY_BUNDLE_SCHEMA));
  json_object_set_new(index, "version", json_string(STY_VERSION));
  json_object_set_new(index, "files", files);
  StyStatus status = sty_parallel_for(run, STY_BUNDLE_FILES, describe_texture_file, &description, error);
  for (int i = 0; i < STY_BUNDLE_FILES; i++)
    if (description.entries[i]) json_array_append_new(files, description.entries[i]);
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
  if (chown(to, (uid_t)-1, info.st_gid) != 0) /* a group that we aren't of: ours may what anybody may */
    info.st_mode = (info.st_mode & ~(mode_t)0070) | (info.st_mode & 0007) << 3;
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

/* Does `act` to each entry of a folder, until one fails. */
static StyStatus for_each_file(const char *path, StyStatus (*act)(const StyBundleFolder *, const char *, StyError *),
                               const StyBundleFolder *folder, StyError *error) {
  DIR *files = opendir(path);
  StyStatus status = files ? STY_OK : sty_fail(error, STY_ERROR_FILE, "%s: cannot read: %s", path, strerror(errno));
  for (const struct dirent *entry; !status && (entry = readdir(files));)
    if (!is_folder_itself(entry->d_name)) status = act(folder, entry->d_name, error);
  if (files) closedir(files);
  return status;
}

/* An earlier bundle's folder may hold more than ours: an engine's notes beside the textures, say. They stay. */
static StyStatus take_along(const StyBundleFolder *folder, const char *name, StyError *error) {
  if (is_bundle_file(name)) return STY_OK;
  char *from = sty_join_path(folder->path, name), *to = sty_join_path(folder->temporary, name);
  StyStatus status = from && to ? sty_take_file(from, to, error) : sty_fail_memory(error, folder->path, 0);
  if (!status) keep_mode(from, to);
  free(from);
  free(to);
  return status;
}

/* Of the folder that was swapped out: what the new one has, too. */
static StyStatus remove_replaced(const StyBundleFolder *folder, const char *name, StyError *error) {
  char *old = sty_join_path(folder->temporary, name), *new = sty_join_path(folder->path, name);
  StyStatus status = old && new ? STY_OK : sty_fail_memory(error, folder->path, 0);
  if (!status && access(new, F_OK) == 0) unlink(old);
  free(old);
  free(new);
  return status;
}

static StyStatus remove_old_bundle(const StyBundleFolder *folder, StyError *error) {
  for_each_file(folder->temporary, remove_replaced, folder, NULL);
  StyStatus status = STY_OK;
  if (rmdir(folder->temporary) != 0)
    status = sty_fail(error, STY_ERROR_FILE, "%s: written, but what was there before is still in %s: %s", folder->path,
                      folder->temporary, strerror(errno));
  sty_forget_temporary(folder->temporary);
  return status;
}

/* Renames the finished folder to its place; an earlier bundle there is swapped
 * out in one step and removed after. */
static StyStatus move_into_place(StyBundleFolder *folder, StyError *error) {
  struct stat info;
  const bool exists = lstat(folder->path, &info) == 0;
  if (exists) {
    keep_modes(folder);
    const StyStatus status = for_each_file(folder->path, take_along, folder, error);
    if (status) return status;
  }
  if (sty_rename_temporary(folder->temporary, folder->path, exists ? RENAME_EXCHANGE : 0) != 0)
    return sty_fail(error, STY_ERROR_FILE, "%s: cannot write: %s; expected a new name or a bundle to replace",
                    folder->path, strerror(errno));
  const StyStatus status = exists ? remove_old_bundle(folder, error) : STY_OK;
  free(folder->temporary);
  folder->temporary = NULL;
  return status;
}

StyStatus sty_commit_bundle_folder(StyBundleFolder *folder, json_t *index, const StyRun *run, StyError *error) {
  StyStatus status = complete_index(folder, index, run, error);
  if (!status) status = write_index(folder, index, error);
  if (!status) status = sty_check_fresh_bundle(folder->temporary, error);
  return status ? status : move_into_place(folder, error);
}

void sty_discard_bundle_folder(StyBundleFolder *folder) {
  if (folder->temporary) sty_remove_temporary_folder(folder->temporary);
  free(folder->temporary);
  free(folder->path);
  *folder = (StyBundleFolder){.path = NULL};
}
