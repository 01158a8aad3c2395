// Known without loading the module.
#include <OpenImageIO/oiioversion.h>

#include "stylut/image_io.h"

extern "C" const char *sty_get_image_library_version(void) { return "OpenImageIO " OIIO_VERSION_STRING; }
