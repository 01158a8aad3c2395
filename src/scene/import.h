#ifndef STYLUT_SCENE_IMPORT_H
#define STYLUT_SCENE_IMPORT_H

#include "stylut/mesh.h"

/* sty_read_mesh in this process, where a file that the importer can't bear takes all down. From one
 * thread at a time: the importer's log and its last error belong to the process. */
StyStatus sty_import_mesh(const char *path, const StyMeshOptions *options, StyMesh **out, StyError *error);

#endif
