#include "parameters.h"

#include <stdio.h>

StyStatus take_setting(Options *options, Settings *settings, const char *text) {
  if (settings->count == MOST_SETTINGS)
    return sty_fail(&options->error, STY_ERROR_USAGE, "option '--set': found '%s' after %d others, expected fewer",
                    text, MOST_SETTINGS);
  settings->texts[settings->count++] = text;
  return STY_OK;
}

StyStatus apply_settings(const Settings *settings, StyLoadedBundle *bundle, StyError *error) {
  StyStatus status = STY_OK;
  for (int i = 0; !status && i < settings->count; i++)
    status = sty_set_bundle_parameter("option '--set'", settings->texts[i], bundle, error);
  return status;
}

void print_parameters(const StyStyle *style) {
  for (const StyParameter *p = sty_parameters; p->name; p++) {
    const double value = sty_get_parameter(p, style);
    printf("%s%s ", p == sty_parameters ? "" : ", ", p->name);
    if (p->kind == STY_PARAMETER_FLAG)
      printf("%s", value != 0 ? "true" : "false");
    else
      printf("%.9g", value);
  }
}
