/* What is said of a flow once it is found. */
#ifndef STYLUT_GUIDE_FLOW_AUDIT_H
#define STYLUT_GUIDE_FLOW_AUDIT_H

#include "guide/flow_window.h"

/* Writes A, motion, residual and origin of `level`, the finest, into `flow` and counts them. */
StyStatus sty_audit_flow(const StyFlowLevel *level, const StyFlowRules *rules, const StyRun *run, StyImage *flow,
                         StyFlowFigures *figures, StyError *error);

/* Writes consistency.Y: how far from home there and back ends. */
void sty_compare_flow_back(const StyFlowLevel *forward, const StyFlowLevel *back, StyImage *flow,
                           StyFlowFigures *figures);

#endif
