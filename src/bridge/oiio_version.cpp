// Known without loading the module.
#include <OpenImageIO/oiioversion.h>

#include "stylut/version.h"

extern "C" const char *sty_get_image_library_version(void) { return "OpenImageIO " OIIO_VERSION_STRING; }
