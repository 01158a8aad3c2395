/* Parameters of styles on the command line: --set [STYLE.]KEY=VALUE of params and stylize, and in words. */
#ifndef STYLUT_TOOLS_PARAMETERS_H
#define STYLUT_TOOLS_PARAMETERS_H

#include "options.h"
#include "stylut/pack.h"

enum { MOST_SETTINGS = 1024 };

typedef struct Settings {
  const char *texts[MOST_SETTINGS];
  int count;
} Settings;

StyStatus take_setting(Options *options, Settings *settings, const char *text);

/* In their order, in memory. */
StyStatus apply_settings(const Settings *settings, StyLoadedBundle *bundle, StyError *error);

/* "threshold 24, top_level 6, ...", to stdout. */
void print_parameters(const StyStyle *style);

#endif
