/* Whether a step has been done already: with this recipe, of these very files, and whether what it made still lies
 * there. It leaves a note beside its recipe that says so, whoever had it done. Called in the work folder. */
#ifndef STYLUT_TOOLS_STEP_DUE_H
#define STYLUT_TOOLS_STEP_DUE_H

#include <stdbool.h>

#include "stylut/json.h"

/* Files as they are before the step begins; note_done spends it. */
json_t *note_inputs(const StyDocument *recipe);

/* Whether it is to be done. */
bool is_step_due(const StyDocument *recipe);

/* After it was done: writes the note. */
StyStatus note_done(const StyDocument *recipe, json_t *inputs, StyError *error);

#endif
