#include "batch_inputs.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "stylut/image_io.h"

/* ---- stamps ---- */

void name_stamp(const char *folder, const char *path, char out[STAMP_SIZE]) {
  char id[STY_HASH_SIZE];
  sty_hash_bytes(path, strlen(path), id);
  snprintf(out, STAMP_SIZE, "%.*s/%.32s", STAMP_SIZE - 34, folder, id);
}

char *format_stamp(const char *path, const char *hash) {
  const size_t size = strlen(hash) + strlen(path) + sizeof "  \n";
  char *text = malloc(size);
  if (text) snprintf(text, size, "%s  %s\n", hash, path);
  return text;
}

enum { MOST_TEXT = 1 << 26 };

char *read_stamp(const char *stamp) {
  unsigned char *text = NULL;
  size_t size = 0;
  if (sty_read_file(stamp, MOST_TEXT, &text, &size, NULL) != STY_OK) return NULL;
  const char *path = strstr((const char *)text, "  ");
  char *out = path ? strndup(path + 2, strcspn(path + 2, "\n")) : NULL;
  free(text);
  return out;
}

static bool holds_text(const char *path, const char *text) {
  unsigned char *held = NULL;
  size_t size = 0;
  const bool holds = sty_read_file(path, MOST_TEXT, &held, &size, NULL) == STY_OK && size == strlen(text) &&
                     memcmp(held, text, size) == 0;
  free(held);
  return holds;
}

StyStatus write_text(const char *path, const char *text, StyError *error) {
  StyOutput output;
  if (holds_text(path, text)) return STY_OK;
  const StyStatus status = sty_open_output(path, &output, error);
  if (status) return status;
  fputs(text, output.stream);
  return sty_commit_output(&output, error);
}

StyStatus stamp_input(const char *folder, const char *path, char stamp[STAMP_SIZE], StyError *error) {
  char hash[STY_HASH_SIZE];
  StyStatus status = sty_hash_file(path, hash, error);
  char *text = status ? NULL : format_stamp(path, hash);
  if (!status && !text) status = sty_fail_memory(error, path, 0);
  name_stamp(folder, path, stamp);
  if (!status) status = write_text(stamp, text, error);
  free(text);
  return status;
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

/* What is known of a file as it is now: an object to add to. The caller owns it; NULL when memory is short. What is too
 * fresh to be kept serves for this run. */
static json_t *get_known(Inputs *inputs, const char *path) {
  json_t *look = look_at_file(path), *list = look ? inputs->known : inputs->fresh, *known = json_object_get(list, path);
  const bool is_current = known && (!look || json_equal(look, json_object_get(known, "file")));
  if (!is_current) {
    known = json_object();
    if (look) json_object_set(known, "file", look);
    json_object_set_new(list, path, known);
    inputs->is_new = true;
  }
  json_decref(look);
  return json_incref(known);
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

/* Pictures that are to be looked at, by all threads; what fails is asked for again, and fails, where it is needed. */
typedef struct Looking {
  char **paths;
  struct Look {
    char hash[STY_HASH_SIZE];
    StyImageShape shape;
    bool is_hashed, is_measured;
  } * looks;
} Looking;

static StyStatus look_at_picture(void *context, long i, StyError *error) {
  const Looking *looking = context;
  struct Look *look = &looking->looks[i];
  (void)error;
  look->is_hashed = sty_hash_file(looking->paths[i], look->hash, NULL) == STY_OK;
  look->is_measured = look->is_hashed && sty_read_image_shape(looking->paths[i], &look->shape, NULL) == STY_OK;
  return STY_OK;
}

static bool is_known(Inputs *inputs, const char *path) {
  json_t *known = get_known(inputs, path);
  const bool is = json_object_get(known, "sha256") && json_object_get(known, "size");
  json_decref(known);
  return is;
}

void look_at_pictures(Inputs *inputs, char **paths, int count, const StyRun *run) {
  Looking looking = {calloc((size_t)count + 1, sizeof *paths), calloc((size_t)count + 1, sizeof *looking.looks)};
  int wanted = 0;
  for (int i = 0; looking.paths && looking.looks && i < count; i++)
    if (!is_known(inputs, paths[i])) looking.paths[wanted++] = paths[i];
  sty_parallel_for(run, wanted, look_at_picture, &looking, NULL);
  for (int i = 0; i < wanted; i++) {
    const struct Look *look = &looking.looks[i];
    json_t *known = get_known(inputs, looking.paths[i]);
    if (look->is_hashed) json_object_set_new(known, "sha256", json_string(look->hash));
    if (look->is_measured)
      json_object_set_new(known, "size", json_pack("[i,i]", look->shape.width, look->shape.height));
    json_decref(known);
  }
  free(looking.looks);
  free(looking.paths);
}

StyStatus open_inputs(const char *file, Inputs *out, StyError *error) {
  StyDocument document = {NULL, NULL, NULL};
  *out = (Inputs){.records = {hash_known, measure_known}, .file = strdup(file), .fresh = json_object()};
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
  json_decref(inputs->fresh);
  free(inputs->file);
  *inputs = (Inputs){.file = NULL};
}
