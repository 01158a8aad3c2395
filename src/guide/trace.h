/* What guides of scenes are asked for, before anything is traced. */
#ifndef STYLUT_GUIDE_TRACE_H
#define STYLUT_GUIDE_TRACE_H

#include "stylut/guide.h"

/* The channels that the surfaces' light goes into, and those that their colours do. */
enum { STY_LIT = STY_GUIDE_LUMA | STY_GUIDE_PATHS, STY_COLOURED = STY_LIT | STY_GUIDE_ALBEDO };

/* STY_ERROR_USAGE and STY_ERROR_INPUT as of sty_trace_rows, but for what textures hold. */
StyStatus sty_check_trace(const StyScene *scene, const StyCamera *camera, const StyTraceOptions *options,
                          StyError *error);

#endif
