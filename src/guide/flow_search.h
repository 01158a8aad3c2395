/* The search on one level, and its reconciliation with the coarser one. */
#ifndef STYLUT_GUIDE_FLOW_SEARCH_H
#define STYLUT_GUIDE_FLOW_SEARCH_H

#include "guide/flow_window.h"

/* Fills the vectors of row y of `level`; `coarser` is NULL for the coarsest. */
void sty_search_flow_row(const StyFlowLevel *level, const StyFlowLevel *coarser, const StyFlowRules *rules, int y);

/* Fills level->spare with row y of the vectors' median over 3x3 pixels. */
void sty_smooth_flow_row(const StyFlowLevel *level, int y);

#endif
