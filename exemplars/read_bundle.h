/* What the example programs share: a bundle's five files, read into memory. */
#ifndef STYLUT_READ_BUNDLE_H
#define STYLUT_READ_BUNDLE_H

#include <stdio.h>
#include <stdlib.h>

#include "stylut/runtime.h"

/* For errors that end the program; a status says it in words. */
static inline void require(StyRuntimeStatus status) {
  if (status == STY_RUNTIME_OK) return;
  fprintf(stderr, "%s\n", sty_describe_runtime_status(status));
  exit(3);
}

static inline StyBlob read_blob(const char *folder, const char *name) {
  char path[4096];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *file = fopen(path, "rb");
  long size = file && fseek(file, 0, SEEK_END) == 0 ? ftell(file) : 0;
  void *data = size > 0 ? malloc((size_t)size) : NULL;
  if (!data || fseek(file, 0, SEEK_SET) != 0 || fread(data, 1, (size_t)size, file) != (size_t)size) {
    fprintf(stderr, "%s: cannot be read\n", path);
    exit(2);
  }
  fclose(file);
  return (StyBlob){data, (size_t)size};
}

/* `files` stay as long as the bundle does: it points into them. */
static inline StyBundle open_bundle(const char *folder, StyBlob files[STY_BUNDLE_FILES]) {
  static const char *const names[STY_BUNDLE_FILES] = {"exemplars.ktx2", "guides.ktx2", "luts.ktx2", "params.ktx2",
                                                      "jitter.ktx2"};
  StyBundle bundle;
  for (int i = 0; i < STY_BUNDLE_FILES; i++) files[i] = read_blob(folder, names[i]);
  require(sty_open_bundle(files, &bundle, NULL));
  return bundle;
}

static inline void close_files(const StyBlob files[STY_BUNDLE_FILES]) {
  for (int i = 0; i < STY_BUNDLE_FILES; i++) free((void *)files[i].data);
}

#endif
