/* OpenEXR makes room for as many bytes as an attribute claims to have before it
 * reads them: a file of 100 bytes may cost 2 GB. */
#ifndef STYLUT_BRIDGE_EXR_H
#define STYLUT_BRIDGE_EXR_H

#include "stylut/status.h"

/* STY_ERROR_INPUT for a file that begins as an EXR and whose header doesn't end
 * inside it; anything else passes, as does what can't be read. */
StyStatus sty_check_exr(const char *path, StyError *error);

#endif
