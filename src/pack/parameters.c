#include <stdio.h>
#include <string.h>

#include "stylut/pack.h"
#include "stylut/parse.h"

#define WHOLE(field, most) \
  { #field, STY_PARAMETER_WHOLE, 0, most, offsetof(StyStyle, field), 0 }
#define NUMBER(field, most) \
  { #field, STY_PARAMETER_NUMBER, 0, most, offsetof(StyStyle, field), 0 }

const StyParameter sty_parameters[] = {
    WHOLE(threshold, STY_MAX_THRESHOLD),
    WHOLE(top_level, STY_MAX_LEVEL),
    WHOLE(radius, STY_MAX_RADIUS),
    NUMBER(depth_tolerance, 1e30),
    NUMBER(luma_weight, STY_MAX_LUMA_WEIGHT),
    NUMBER(colour_weight, 1),
    NUMBER(jitter_amount, 1),
    WHOLE(jitter_period, STY_MAX_PERIOD),
    {"scale", STY_PARAMETER_SCALE, 0.5, 2, offsetof(StyStyle, scale), 0},
    {"objects", STY_PARAMETER_FLAG, 0, 1, offsetof(StyStyle, flags), STY_FLAG_OBJECTS},
    WHOLE(scatter, STY_MAX_SCATTER),
    {NULL, STY_PARAMETER_WHOLE, 0, 0, 0, 0},
};

const char *sty_name_parameter_range(const StyParameter *parameter, char out[STY_RANGE_SIZE]) {
  switch (parameter->kind) {
    case STY_PARAMETER_WHOLE:
    case STY_PARAMETER_NUMBER:
      snprintf(out, STY_RANGE_SIZE, "a %snumber from %g to %g", parameter->kind == STY_PARAMETER_WHOLE ? "whole " : "",
               parameter->minimum, parameter->maximum);
      break;
    case STY_PARAMETER_SCALE: snprintf(out, STY_RANGE_SIZE, "0.5, 1 or 2"); break;
    case STY_PARAMETER_FLAG: snprintf(out, STY_RANGE_SIZE, "true or false"); break;
  }
  return out;
}

/* NaN is in no range. */
static bool is_in_range(const StyParameter *parameter, double value) {
  if (!(value >= parameter->minimum && value <= parameter->maximum)) return false;
  if (value > 0 && !((float)value > 0)) return false; /* 0 may mean something else than next to nothing */
  if (parameter->kind == STY_PARAMETER_SCALE) return value == 0.5 || value == 1 || value == 2;
  return parameter->kind == STY_PARAMETER_NUMBER || value == (int)value;
}

bool sty_put_parameter(const StyParameter *parameter, double value, StyStyle *style) {
  if (!is_in_range(parameter, value)) return false;
  void *field = (char *)style + parameter->offset;
  if (parameter->kind == STY_PARAMETER_WHOLE)
    *(int *)field = (int)value;
  else if (parameter->kind == STY_PARAMETER_FLAG)
    style->flags = value != 0 ? style->flags | parameter->flag : style->flags & ~parameter->flag;
  else
    *(float *)field = (float)(value + 0); /* -0 becomes 0 */
  return true;
}

double sty_get_parameter(const StyParameter *parameter, const StyStyle *style) {
  const void *field = (const char *)style + parameter->offset;
  if (parameter->kind == STY_PARAMETER_WHOLE) return *(const int *)field;
  if (parameter->kind == STY_PARAMETER_FLAG) return (style->flags & parameter->flag) != 0;
  return sty_shorten_float(*(const float *)field);
}

json_t *sty_describe_parameters(const StyStyle *style) {
  json_t *out = json_object();
  for (const StyParameter *p = sty_parameters; p->name; p++) {
    const double value = sty_get_parameter(p, style);
    json_object_set_new(out, p->name,
                        p->kind == STY_PARAMETER_WHOLE  ? json_integer((json_int_t)value)
                        : p->kind == STY_PARAMETER_FLAG ? json_boolean(value != 0)
                                                        : json_real(value));
  }
  return out;
}

static StyStatus fail_name(const char *what, const char *name, StyError *error) {
  char names[512] = "";
  for (const StyParameter *p = sty_parameters; p->name; p++)
    snprintf(names + strlen(names), sizeof names - strlen(names), "%s%s", *names ? ", " : "", p->name);
  return sty_fail(error, STY_ERROR_USAGE, "%s: found parameter '%s', expected one of %s", what, name, names);
}

StyStatus sty_set_parameter(const char *what, const char *name, const char *text, StyStyle *style, StyError *error) {
  const StyParameter *parameter = sty_parameters;
  while (parameter->name && strcmp(parameter->name, name) != 0) parameter++;
  if (!parameter->name) return fail_name(what, name, error);
  double value = strcmp(text, "true") == 0;
  const bool known = parameter->kind == STY_PARAMETER_FLAG
                         ? value != 0 || strcmp(text, "false") == 0
                         : !sty_parse_number(what, text, parameter->minimum, parameter->maximum, &value, NULL);
  char range[STY_RANGE_SIZE];
  if (known && sty_put_parameter(parameter, value, style)) return STY_OK;
  return sty_fail(error, STY_ERROR_USAGE, "%s: found %s=%s, expected %s", what, name, text,
                  sty_name_parameter_range(parameter, range));
}
