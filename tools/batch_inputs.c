#include "batch_inputs.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "stylut/image_io.h"

/* ---- stamps ---- */

static void name_stamp(const char *folder, const char *path, char out[STAMP_SIZE]) {
  char id[STY_HASH_SIZE];
  sty_hash_bytes(path, strlen(path), id);
  snprintf(out, STAMP_SIZE, "%.*s/%.32s", STAMP_SIZE - 34, folder, id);
}

/* The text of a stamp, which the caller frees; NULL where there is none. */
static char *read_stamp(const char *stamp) {
  unsigned char *text = NULL;
  size_t size = 0;
  return sty_read_file(stamp, 1 << 16, &text, &size, NULL) == STY_OK ? (char *)text : NULL;
}

static StyStatus put_stamp(const char *folder, const char *path, const char *hash, char stamp[STAMP_SIZE],
                           StyError *error) {
  StyOutput output;
  name_stamp(folder, path, stamp);
  char *text = read_stamp(stamp);
  const bool is_same = text && strncmp(text, hash, strlen(hash)) == 0; /* what follows goes with the stamp's name */
  free(text);
  if (is_same) return STY_OK;
  const StyStatus status = sty_open_output(stamp, &output, error);
  if (status) return status;
  fprintf(output.stream, "%s  %s\n", hash, path);
  return sty_commit_output(&output, error);
}

StyStatus stamp_input(const char *folder, const char *path, char stamp[STAMP_SIZE], char hash[STY_HASH_SIZE],
                      StyError *error) {
  const StyStatus status = sty_hash_file(path, hash, error);
  return status ? status : put_stamp(folder, path, hash, stamp, error);
}

/* ---- what is known ---- */

/* Files that changed a moment ago may change again without a sign of it. */
static const time_t settled = 2; /* seconds */

/* What shows that a file has changed; NULL where it is too fresh to tell, or can't be looked at. */
static json_t *look_at_file(const char *path) {
  struct stat info;
  if (stat(path, &info) != 0 || !S_ISREG(info.st_mode)) return NULL;
  const time_t last = info.st_mtim.tv_sec > info.st_ctim.tv_sec ? info.st_mtim.tv_sec : info.st_ctim.tv_sec;
  if (time(NULL) - last < settled) return NULL;
  return json_pack("[I,I,I,I,I,I]", (json_int_t)info.st_ino, (json_int_t)info.st_size, (json_int_t)info.st_mtim.tv_sec,
                   (json_int_t)info.st_mtim.tv_nsec, (json_int_t)info.st_ctim.tv_sec, (json_int_t)info.st_ctim.tv_nsec);
}

/* What is known of a file as it is now: an object to add to. The caller owns it; NULL when memory is short. */
static json_t *get_known(Inputs *inputs, const char *path) {
  json_t *look = look_at_file(path), *known = json_object_get(inputs->known, path);
  if (look && known && json_equal(look, json_object_get(known, "file"))) {
    json_decref(look);
    return json_incref(known);
  }
  inputs->is_new = true;
  known = json_object();
  if (look) {
    json_object_set_new(known, "file", look);
    json_object_set(inputs->known, path, known);
  } else {
    json_object_del(inputs->known, path);
  }
  return known;
}

static StyStatus hash_known(Records *records, const char *path, char out[STY_HASH_SIZE], StyError *error) {
  json_t *known = get_known((Inputs *)records, path);
  const char *hash = json_string_value(json_object_get(known, "sha256"));
  StyStatus status = STY_OK;
  if (hash)
    snprintf(out, STY_HASH_SIZE, "%s", hash);
  else
    status = sty_hash_file(path, out, error);
  if (!status && !hash) json_object_set_new(known, "sha256", json_string(out));
  json_decref(known);
  return status;
}

static StyStatus measure_known(Records *records, const char *path, Size *out, StyError *error) {
  json_t *known = get_known((Inputs *)records, path);
  StyImageShape shape;
  StyStatus status = STY_OK;
  if (json_unpack(json_object_get(known, "size"), "[i,i]", &out->width, &out->height) != 0) {
    status = sty_read_image_shape(path, &shape, error);
    if (!status) *out = (Size){shape.width, shape.height};
    if (!status) json_object_set_new(known, "size", json_pack("[i,i]", shape.width, shape.height));
    ((Inputs *)records)->is_new = true;
  }
  json_decref(known);
  return status;
}

StyStatus open_inputs(const char *file, Inputs *out, StyError *error) {
  StyDocument document = {NULL, NULL, NULL};
  *out = (Inputs){.records = {hash_known, measure_known}, .file = strdup(file)};
  if (!out->file) return sty_fail_memory(error, file, (double)strlen(file));
  if (sty_read_document(file, &document, NULL) == STY_OK) out->known = json_incref(document.root);
  sty_close_document(&document);
  if (!out->known) out->known = json_object();
  return STY_OK;
}

StyStatus save_inputs(Inputs *inputs, StyError *error) {
  if (!inputs->is_new) return STY_OK;
  inputs->is_new = false;
  return sty_write_json(inputs->file, inputs->known, error);
}

void close_inputs(Inputs *inputs) {
  json_decref(inputs->known);
  free(inputs->file);
  *inputs = (Inputs){.file = NULL};
}

StyStatus stamp_known_input(Inputs *inputs, const char *folder, const char *path, char stamp[STAMP_SIZE],
                            StyError *error) {
  char hash[STY_HASH_SIZE];
  const StyStatus status = hash_known(&inputs->records, path, hash, error);
  return status ? status : put_stamp(folder, path, hash, stamp, error);
}

StyStatus refresh_stamps(Inputs *inputs, const char *folder_name, StyError *error) {
  DIR *folder = opendir(folder_name);
  StyStatus status = STY_OK;
  if (!folder) return STY_OK; /* there are none yet */
  for (const struct dirent *entry; !status && (entry = readdir(folder));) {
    char stamp[STAMP_SIZE], hash[STY_HASH_SIZE];
    if (strlen(entry->d_name) != 32) continue;
    snprintf(stamp, sizeof stamp, "%.*s/%s", STAMP_SIZE - 34, folder_name, entry->d_name);
    char *text = read_stamp(stamp), *path = text ? strstr(text, "  ") : NULL;
    if (path) {
      path += 2;
      path[strcspn(path, "\n")] = 0;
      if (hash_known(&inputs->records, path, hash, NULL) != STY_OK) snprintf(hash, sizeof hash, "missing");
      status = put_stamp(folder_name, path, hash, stamp, error);
    }
    free(text);
  }
  closedir(folder);
  return status;
}
