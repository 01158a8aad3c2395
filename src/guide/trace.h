/* What guides of scenes are asked for, before anything is traced. */
#ifndef STYLUT_GUIDE_TRACE_H
#define STYLUT_GUIDE_TRACE_H

#include "stylut/guide.h"

/* STY_ERROR_USAGE and STY_ERROR_INPUT as of sty_trace_rows, but for what textures hold. */
StyStatus sty_check_trace(const StyScene *scene, const StyCamera *camera, const StyTraceOptions *options,
                          StyError *error);

#endif
