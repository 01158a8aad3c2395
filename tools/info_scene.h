/* What `info` says of the JSON files that people write: scenes and point pairs. */
#ifndef STYLUT_TOOLS_INFO_SCENE_H
#define STYLUT_TOOLS_INFO_SCENE_H

#include "options.h"

/* Tells by its "schema" what the file is, and prints it. */
StyStatus show_document(const Options *options, const char *path, StyError *error);

json_t *pack_vector(const double v[3]);

#endif
