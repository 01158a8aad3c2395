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

/* NULL: all has its use. */
static const char *find_idle_parameter(const StyStyle *style, int jitters) {
  if (style->jitter_period > 0 && jitters == 1)
    return "a jitter_period and one jitter table, expected several (pack --jitter-frames): pieces stay as they are";
  if (style->luma_weight > 0 && style->layer_count == 1)
    return "a luma_weight and one exemplar, expected several: nothing is chosen by light";
  return NULL;
}

void review_parameters(const Options *options, const char *name, const StyStyle *style, int jitters) {
  const char *idle = find_idle_parameter(style, jitters);
  if (idle) warn(options, "style '%s': found %s", clean_text(name), idle);
}

void review_bundle_parameters(const Options *options, const StyLoadedBundle *bundle) {
  const json_t *entries = json_object_get(bundle->index.root, "styles");
  const int jitters = (int)bundle->bundle.textures[STY_BUNDLE_JITTER].layers;
  const char *said = NULL;
  for (size_t i = 0; i < json_array_size(entries); i++) {
    StyStyle style;
    if (sty_get_style(&bundle->bundle, (int)i + 1, &style)) continue;
    const char *idle = find_idle_parameter(&style, jitters);
    if (!idle || idle == said) continue;
    review_parameters(options, sty_get_style_name(bundle, (int)i + 1), &style, jitters);
    said = idle;
  }
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
