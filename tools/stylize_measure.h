/* What stylize --measure says of a sequence: figures of each frame, and of each beside the one before. */
#ifndef STYLUT_TOOLS_STYLIZE_MEASURE_H
#define STYLUT_TOOLS_STYLIZE_MEASURE_H

#include <jansson.h>

#include "stylize_frame.h"

typedef struct Measures Measures;

/* NULL without memory. */
Measures *open_measures(void);
void close_measures(Measures **measures);

/* Measures the sequence's next frame. `work` is drawn; its picture and guide are copied for the frame after it. */
StyStatus measure_work(Measures *measures, const Request *request, const FrameFiles *files, const Work *work,
                       const StyRun *run, StyError *error);

/* {"frames": [...], "overall": {...}}: the caller's. */
json_t *pack_measures(const Measures *measures);

/* Warns where frames don't tell how they follow from one another. `guide`: the sequence's. */
void review_measures(const Measures *measures, const Request *request, const char *guide);

/* The means over all frames, as text. */
void print_measures(const Measures *measures);

#endif
