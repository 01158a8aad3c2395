/* How engines are to import a bundle's textures. */
#ifndef STYLUT_SRC_PACK_IMPORT_SETTINGS_H
#define STYLUT_SRC_PACK_IMPORT_SETTINGS_H

#include <jansson.h>

#include "stylut/ktx2.h"
#include "stylut/runtime_format.h"

/* The contents of STY_IMPORT_SETTINGS, for textures begun; the caller owns it. */
json_t *sty_describe_import_settings(const StyKtx2 textures[STY_BUNDLE_FILES]);

#endif
