/* Files that a manifest names, and those that its scenes name, are the manifest's own: in its folder. */
#ifndef STYLUT_TOOLS_INSIDE_H
#define STYLUT_TOOLS_INSIDE_H

#include "pack.h"

/* STY_ERROR_INPUT for a file that lies outside of packing->root once all links are followed; nothing is said of files
 * that aren't there. Without a root (--allow-outside), files may be anywhere. `who` names it. */
StyStatus check_inside(const Packing *packing, const char *who, const char *path, StyError *error);

/* Sets packing->root where --allow-outside isn't given, and checks all that the manifest names. */
StyStatus check_paths(Packing *packing, StyError *error);

#endif
