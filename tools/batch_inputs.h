/* What a batch is made of, by content: each file from outside has a stamp in the work folder, "SHA-256  NAME" as
 * sha256sum prints it, which is only written anew when the file's content is another. Steps depend on stamps, so that
 * a file that was touched, or checked out again, costs nothing. */
#ifndef STYLUT_TOOLS_BATCH_INPUTS_H
#define STYLUT_TOOLS_BATCH_INPUTS_H

#include "stylut/file.h"

/* A stamp's name, the folder's name and 33 more. */
enum { STAMP_SIZE = 128 };

/* Hashes a file and brings its stamp in `folder` up to date; its name goes to `stamp`. */
StyStatus stamp_input(const char *folder, const char *path, char stamp[STAMP_SIZE], char hash[STY_HASH_SIZE],
                      StyError *error);

#endif
