#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pack/folder.h"
#include "pack/seal.h"
#include "stylut/image.h"
#include "stylut/pack.h"
#include "stylut/parse.h"

/* Where findings go: to the caller, and the first that counts to the message. */
typedef struct Report {
  const char *path;
  bool is_fresh; /* the index has the hashes of a moment ago */
  void (*send)(void *context, const StyFinding *finding);
  void *context;
  StyStatus status;
  StyError *error;
} Report;

static void add_finding(Report *report, StyFindingNumber number, const char *file, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

static void add_finding(Report *report, StyFindingNumber number, const char *file, const char *format, ...) {
  StyFinding finding = {.number = number, .warning = number == STY_FINDING_BACKGROUND};
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(finding.text, sizeof finding.text, format, arguments);
  va_end(arguments);
  snprintf(finding.file, sizeof finding.file, "%s", file);
  if (report->send) report->send(report->context, &finding);
  if (finding.warning || report->status) return;
  report->status = number == STY_FINDING_MISSING ? STY_ERROR_FILE : STY_ERROR_INPUT;
  sty_fail(report->error, report->status, "%s/%s: %s", report->path, file, finding.text);
}

/* Messages from below begin with the full path; findings name the file already. */
static const char *without_path(const char *text, const char *path) {
  const size_t length = strlen(path);
  return strncmp(text, path, length) == 0 && text[length] == ':' ? text + length + 1 + strspn(text + length + 1, " ")
                                                                 : text;
}

/* What was found out from below; without memory nothing was, and the bundle may well be good. */
static void add_cause(Report *report, StyFindingNumber number, const char *file, const char *path,
                      const StyError *cause) {
  if (cause->status != STY_ERROR_LIBRARY)
    add_finding(report, number, file, "%s", without_path(cause->text, path ? path : ""));
  else if (report->status != STY_ERROR_LIBRARY)
    report->status = sty_fail(report->error, STY_ERROR_LIBRARY, "%s", cause->text);
}

static bool read_index(Report *report, StyDocument *index) {
  char *path = sty_join_path(report->path, STY_BUNDLE_INDEX);
  StyError cause;
  const char *schema = NULL;
  StyStatus status = path ? sty_read_document(path, index, &cause) : sty_fail_memory(&cause, report->path, 0);
  if (!status) status = sty_get_string(index, NULL, index->root, "schema", 1, &schema, &cause);
  if (!status && strcmp(schema, STY_BUNDLE_SCHEMA) != 0)
    status = sty_fail_value(index, &(StyPath){NULL, "schema", 0}, json_object_get(index->root, "schema"),
                            "\"" STY_BUNDLE_SCHEMA "\"", &cause);
  const json_t *files = status ? NULL : json_object_get(index->root, "files");
  if (!status && json_array_size(files) != STY_BUNDLE_FILES)
    status = sty_fail_value(index, files ? &(StyPath){NULL, "files", 0} : NULL, files,
                            "a list \"files\" of the five textures", &cause);
  if (status) {
    add_cause(report, status == STY_ERROR_FILE ? STY_FINDING_MISSING : STY_FINDING_INDEX, STY_BUNDLE_INDEX, path,
              &cause);
    /* An index that can't be read is about the folder: a bundle is what was expected. */
    if (status == STY_ERROR_FILE)
      sty_fail(report->error, status, "%s: found no readable " STY_BUNDLE_INDEX " in it, expected a bundle folder",
               report->path);
  }
  free(path);
  return !status;
}

static void check_seal(Report *report, const StyDocument *index) {
  const char *seal = json_string_value(json_object_get(index->root, STY_SEAL_KEY));
  char found[STY_HASH_SIZE];
  StyError cause;
  if (sty_seal_index(index->root, found, &cause))
    add_cause(report, STY_FINDING_HASH, STY_BUNDLE_INDEX, NULL, &cause);
  else if (!seal || strcmp(seal, found) != 0)
    add_finding(report, STY_FINDING_HASH, STY_BUNDLE_INDEX,
                "found contents whose SHA-256 isn't the one they give: the index was changed");
}

/* A file's entry in the index, which is called `place`. */
typedef struct Listed {
  const json_t *entry;
  const char *name;
  char place[32];
} Listed;

static Listed get_texture_entry(const StyDocument *index, int which) {
  Listed listed = {json_array_get(json_object_get(index->root, "files"), (size_t)which), sty_bundle_files[which], ""};
  snprintf(listed.place, sizeof listed.place, "files[%d]", which);
  return listed;
}

/* Length and hash of a file, as the index has them. */
static void compare_with_index(Report *report, const Listed *listed, const char *path, uint64_t size) {
  const char *name = json_string_value(json_object_get(listed->entry, "name"));
  const char *wanted_hash = json_string_value(json_object_get(listed->entry, "sha256"));
  const json_int_t wanted_size = json_integer_value(json_object_get(listed->entry, "bytes"));
  char hash[STY_HASH_SIZE];
  StyError cause;
  if (!name || strcmp(name, listed->name) != 0 || !wanted_hash)
    add_finding(report, STY_FINDING_INDEX, STY_BUNDLE_INDEX,
                "found no entry with name and sha256 for %s at %s, expected one", listed->name, listed->place);
  else if ((json_int_t)size != wanted_size)
    add_finding(report, STY_FINDING_SIZE, name, "found %llu bytes, expected %lld by the index",
                (unsigned long long)size, (long long)wanted_size);
  else if (report->is_fresh)
    return;
  else if (sty_hash_file(path, hash, &cause))
    add_cause(report, STY_FINDING_MISSING, name, path, &cause);
  else if (strcmp(hash, wanted_hash) != 0)
    add_finding(report, STY_FINDING_HASH, name,
                "found SHA-256 %.16s..., expected %.16s... by the index: the file was changed", hash, wanted_hash);
}

/* The file that nothing here reads, but engines do. */
static void check_settings(Report *report, const StyDocument *index) {
  const Listed listed = {json_object_get(index->root, STY_IMPORT_KEY), STY_IMPORT_SETTINGS, STY_IMPORT_KEY};
  char *path = sty_join_path(report->path, STY_IMPORT_SETTINGS);
  uint64_t size = 0;
  StyError cause;
  if ((path ? sty_check_file(path, &size, &cause) : sty_fail_memory(&cause, report->path, 0)) == STY_OK)
    compare_with_index(report, &listed, path, size);
  else
    add_cause(report, STY_FINDING_MISSING, STY_IMPORT_SETTINGS, path, &cause);
  free(path);
}

static bool map_file(Report *report, StyLoadedBundle *bundle, int which) {
  char *path = sty_join_path(report->path, sty_bundle_files[which]);
  uint64_t size = 0;
  StyError cause;
  StyStatus status = path ? sty_check_file(path, &size, &cause) : sty_fail_memory(&cause, report->path, 0);
  if (!status) {
    const Listed listed = get_texture_entry(&bundle->index, which);
    compare_with_index(report, &listed, path, size);
    status = sty_map_file(path, &bundle->files[which], &cause);
  }
  if (status)
    add_cause(report, status == STY_ERROR_FILE ? STY_FINDING_MISSING : STY_FINDING_TEXTURE, sty_bundle_files[which],
              path, &cause);
  free(path);
  return !status;
}

static bool map_files(Report *report, StyLoadedBundle *bundle) {
  bool complete = true;
  for (int i = 0; i < STY_BUNDLE_FILES; i++) complete = map_file(report, bundle, i) && complete;
  return complete;
}

static bool open_view(Report *report, StyLoadedBundle *bundle) {
  StyBlob blobs[STY_BUNDLE_FILES];
  int culprit = 0;
  for (int i = 0; i < STY_BUNDLE_FILES; i++) blobs[i] = (StyBlob){bundle->files[i].data, bundle->files[i].size};
  const StyRuntimeStatus status = sty_open_bundle(blobs, &bundle->bundle, &culprit);
  if (status == STY_RUNTIME_OK) return true;
  const StyFindingNumber number = status == STY_RUNTIME_MISMATCH        ? STY_FINDING_MISMATCH
                                  : status == STY_RUNTIME_BAD_PARAMETER ? STY_FINDING_PARAMETERS
                                                                        : STY_FINDING_TEXTURE;
  add_finding(report, number, sty_bundle_files[culprit], "found that %s, expected what stylut pack writes",
              sty_describe_runtime_status(status));
  return false;
}

/* LUT texels that point where nothing is painted; the runtime survives them. */
static void check_luts(Report *report, const StyBundle *bundle) {
  const StyTexture *luts = &bundle->textures[STY_BUNDLE_LUTS], *guides = &bundle->textures[STY_BUNDLE_GUIDES];
  const size_t texels = (size_t)luts->width * luts->height, pixels = (size_t)guides->width * guides->height;
  for (uint32_t layer = 0; layer < luts->layers; layer++) {
    const unsigned char *lut = luts->texels + layer * texels * 4, *guide = guides->texels + layer * pixels * 4;
    size_t background = 0;
    for (size_t t = 0; t < texels; t++, lut += 4) {
      const size_t x = sty_decode_coordinate((uint32_t)(lut[0] | lut[1] << 8), guides->width, 65535);
      const size_t y = sty_decode_coordinate((uint32_t)(lut[2] | lut[3] << 8), guides->height, 65535);
      background += guide[4 * (y * guides->width + x) + 3] == 0;
    }
    sty_rest_mapped(luts->texels + layer * texels * 4, texels * 4);
    sty_rest_mapped(guide, pixels * 4);
    if (background)
      add_finding(report, STY_FINDING_BACKGROUND, sty_bundle_files[STY_BUNDLE_LUTS],
                  "found %zu texels of style %u that point at uncovered source pixels, expected none", background,
                  layer + 1);
  }
}

static StyStatus load_bundle(Report *report, StyLoadedBundle *out) {
  StyLoadedBundle bundle;
  memset(&bundle, 0, sizeof bundle);
  const bool has_index = read_index(report, &bundle.index);
  if (has_index) check_seal(report, &bundle.index);
  if (has_index) check_settings(report, &bundle.index);
  if (has_index && map_files(report, &bundle) && open_view(report, &bundle)) {
    const size_t listed = json_array_size(json_object_get(bundle.index.root, "styles"));
    const uint32_t styles = bundle.bundle.textures[STY_BUNDLE_PARAMS].width;
    if (listed != styles)
      add_finding(report, STY_FINDING_STYLES, STY_BUNDLE_INDEX,
                  "found %zu styles in the index, expected the %u of "
                  "the textures",
                  listed, styles);
    check_luts(report, &bundle.bundle);
  }
  if (report->status)
    sty_unload_bundle(&bundle);
  else
    *out = bundle;
  return report->status;
}

StyStatus sty_load_bundle(const char *path, void (*send)(void *context, const StyFinding *finding), void *context,
                          StyLoadedBundle *out, StyError *error) {
  return load_bundle(&(Report){path, false, send, context, STY_OK, error}, out);
}

StyStatus sty_check_fresh_bundle(const char *path, StyError *error) {
  StyLoadedBundle bundle;
  const StyStatus status = load_bundle(&(Report){path, true, NULL, NULL, STY_OK, error}, &bundle);
  if (!status) sty_unload_bundle(&bundle);
  return status;
}

void sty_unload_bundle(StyLoadedBundle *bundle) {
  for (int i = 0; i < STY_BUNDLE_FILES; i++) sty_unmap_file(&bundle->files[i]);
  sty_close_document(&bundle->index);
  free(bundle->parameters);
  bundle->parameters = NULL;
}

const char *sty_get_style_name(const StyLoadedBundle *bundle, int number) {
  const json_t *styles = json_object_get(bundle->index.root, "styles");
  const char *name = json_string_value(json_object_get(json_array_get(styles, (size_t)number - 1), "name"));
  return name ? name : "";
}

/* "'ink', 'oil', ...": those that have room. */
static void list_names(const StyLoadedBundle *bundle, int count, char *out, size_t size) {
  size_t used = 0;
  *out = 0;
  for (int number = 1; number <= count; number++) {
    const char *name = sty_get_style_name(bundle, number);
    if (used + strlen(name) + sizeof ", '', ..." > size) {
      snprintf(out + used, size - used, ", ...");
      return;
    }
    used += (size_t)snprintf(out + used, size - used, "%s'%s'", used ? ", " : "", name);
  }
}

StyStatus sty_find_style(const char *what, const char *text, const StyLoadedBundle *bundle, int *out, StyError *error) {
  const int count = (int)json_array_size(json_object_get(bundle->index.root, "styles"));
  for (int number = 1; number <= count; number++)
    if (strcmp(sty_get_style_name(bundle, number), text) == 0) {
      *out = number;
      return STY_OK;
    }
  long long number;
  if (sty_parse_integer(what, text, 1, count, &number, NULL)) {
    char names[256];
    list_names(bundle, count, names, sizeof names);
    return sty_fail(error, STY_ERROR_USAGE, "%s: found '%s', expected a style's name (%s) or a number from 1 to %d",
                    what, text, names, count);
  }
  *out = (int)number;
  return STY_OK;
}
