#include "stylut/runtime.h"

int sty_has_path(StyRuntimePath path) { return path == STY_PATH_BEST || path == STY_PATH_REFERENCE; }
