/* How engines are to import a bundle's textures. */
#ifndef STYLUT_SRC_PACK_IMPORT_SETTINGS_H
#define STYLUT_SRC_PACK_IMPORT_SETTINGS_H

#include "pack/folder.h"
#include "stylut/ktx2.h"

/* Writes STY_IMPORT_SETTINGS into a folder in the making; of the textures only shape and offset are looked at. */
StyStatus sty_write_import_settings(const StyBundleFolder *folder, const StyKtx2 textures[STY_BUNDLE_FILES],
                                    StyError *error);

#endif
