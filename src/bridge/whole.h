/* What readers of pictures don't notice, or too late: JPEG readers fill what is
 * missing of a truncated file with grey and call it a picture; OpenEXR and libpng
 * make room for as many bytes as a part claims to have before they read them, so
 * that a file of 100 bytes may cost 2 GB. */
#ifndef STYLUT_BRIDGE_WHOLE_H
#define STYLUT_BRIDGE_WHOLE_H

#include "stylut/status.h"

/* STY_ERROR_INPUT for a file that begins as a JPEG and has no end of image after
 * its first scan, as a PNG with a chunk that reaches beyond the file, or as an
 * EXR whose header does; anything else passes, as does what can't be read. */
StyStatus sty_check_whole(const char *path, StyError *error);

#endif
