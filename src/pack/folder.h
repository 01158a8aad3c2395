/* A bundle's folder in the making: a temporary one beside its final place. */
#ifndef STYLUT_SRC_PACK_FOLDER_H
#define STYLUT_SRC_PACK_FOLDER_H

#include <jansson.h>

#include "stylut/pack.h"

typedef struct StyBundleFolder {
  char *path;      /* final name, without slashes at its end */
  char *temporary; /* its name so far */
} StyBundleFolder;

/* STY_ERROR_FILE when `path` can't be written or is a folder that holds anything but a bundle. */
StyStatus sty_open_bundle_folder(const char *path, StyBundleFolder *out, StyError *error);

/* A file's name in the making; the caller frees it. NULL, with *error, when memory is short. */
char *sty_name_bundle_file(const StyBundleFolder *folder, const char *name, StyError *error);

/* Once all textures and the import settings are there: completes `index` (see sty_commit_bundle), writes it, checks
 * everything as a reader would and moves the folder into its place. */
StyStatus sty_commit_bundle_folder(StyBundleFolder *folder, json_t *index, StyError *error);

/* Frees the names, and removes what isn't in its place. Does nothing to a folder that is zeroed. */
void sty_discard_bundle_folder(StyBundleFolder *folder);

#endif
