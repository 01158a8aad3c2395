/* A bundle's folder in the making: a temporary one beside its final place. */
#ifndef STYLUT_SRC_PACK_FOLDER_H
#define STYLUT_SRC_PACK_FOLDER_H

#include <jansson.h>

#include "stylut/pack.h"

typedef struct StyBundleFolder {
  char *path;      /* final name, without slashes at its end */
  char *temporary; /* its name so far */
} StyBundleFolder;

/* Gives a file another name in another folder, or copies it where that can't be. */
StyStatus sty_take_file(const char *from, const char *to, StyError *error);

/* STY_ERROR_FILE as by sty_check_bundle_place. */
StyStatus sty_open_bundle_folder(const char *path, StyBundleFolder *out, StyError *error);

/* A file's name in the making; the caller frees it. NULL, with *error, when memory is short. */
char *sty_name_bundle_file(const StyBundleFolder *folder, const char *name, StyError *error);

/* Once all textures and the import settings are there: completes `index` (see sty_commit_bundle), writes it, checks
 * everything as a reader would and moves the folder into its place. */
StyStatus sty_commit_bundle_folder(StyBundleFolder *folder, json_t *index, const StyRun *run, StyError *error);

/* Frees the names, and removes what isn't in its place. Does nothing to a folder that is zeroed. */
void sty_discard_bundle_folder(StyBundleFolder *folder);

/* Checks a bundle as sty_load_bundle does, but for the hashes of its files, which the caller has just computed. */
StyStatus sty_check_fresh_bundle(const char *path, StyError *error);

#endif
