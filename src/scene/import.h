#ifndef STYLUT_SCENE_IMPORT_H
#define STYLUT_SCENE_IMPORT_H

#include "stylut/mesh.h"

/* Opens Assimp, which sty_import_mesh else does: there may be no room for it in a process that is held short. */
StyStatus sty_open_importer(StyError *error);

/* sty_read_mesh through Assimp, in this process, where a file that the importer can't bear takes all down. From one
 * thread at a time: the importer's log and its last error belong to the process. Normals that the file hasn't, or none
 * where they aren't kept, are zero. */
StyStatus sty_import_mesh(const char *path, bool keep_normals, StyMesh **out, StyError *error);

#endif
