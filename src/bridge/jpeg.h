/* JPEG readers fill what is missing of a truncated file with grey and call it a
 * picture. */
#ifndef STYLUT_BRIDGE_JPEG_H
#define STYLUT_BRIDGE_JPEG_H

#include "stylut/status.h"

/* STY_ERROR_INPUT for a file that begins as a JPEG and has no end of image
 * after its first scan; anything else passes, as does what can't be read. */
StyStatus sty_check_jpeg(const char *path, StyError *error);

#endif
