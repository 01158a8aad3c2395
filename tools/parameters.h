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

/* Warns of what a style asks for that nothing comes of; `jitters`: tables of the bundle. */
void review_parameters(const Options *options, const char *name, const StyStyle *style, int jitters);

/* The same of a bundle's styles, once of each kind. */
void review_bundle_parameters(const Options *options, const StyLoadedBundle *bundle);

/* "threshold 24, top_level 6, ...", to stdout. */
void print_parameters(const StyStyle *style);

#endif
