#include <math.h>
#include <stdbool.h>

#include "stylut/runtime.h"

/* NaN fails every comparison, so it is refused with the rest. */
static bool read_integer(float value, int lowest, int highest, int *out) {
  if (!(value >= (float)lowest && value <= (float)highest)) return false;
  *out = (int)value;
  return (float)*out == value;
}

static bool read_number(float value, float highest, float *out) {
  if (!(value >= 0 && value <= highest) || isinf(value)) return false;
  *out = value;
  return true;
}

static bool read_flags(float value, unsigned *out) {
  int flags;
  if (!read_integer(value, 0, (int)STY_KNOWN_FLAGS, &flags)) return false;
  *out = (unsigned)flags;
  return (*out & ~STY_KNOWN_FLAGS) == 0;
}

static bool read_rows(const float rows[STY_PARAM_ROWS][4], StyStyle *out) {
  for (int i = 0; i < STY_MAX_LIGHTINGS; i++)
    if (!read_number(rows[2][i], 1, &out->luma[i])) return false;
  return read_integer(rows[0][0], 0, STY_MAX_THRESHOLD, &out->threshold) &&
         read_integer(rows[0][1], 0, STY_MAX_LEVEL, &out->top_level) &&
         read_integer(rows[0][2], 0, STY_MAX_RADIUS, &out->radius) &&
         read_number(rows[0][3], HUGE_VALF, &out->depth_tolerance) &&
         read_number(rows[1][0], STY_MAX_LUMA_WEIGHT, &out->luma_weight) &&
         read_number(rows[1][1], 1, &out->colour_weight) &&
         read_integer(rows[1][2], 0, STY_MAX_STYLES * STY_MAX_LIGHTINGS * 2, &out->layer) &&
         read_integer(rows[1][3], 1, STY_MAX_LIGHTINGS, &out->layer_count) &&
         read_number(rows[3][0], 1, &out->jitter_amount) &&
         read_integer(rows[3][1], 0, STY_MAX_PERIOD, &out->jitter_period) && read_number(rows[3][2], 2, &out->scale) &&
         (out->scale == 0.5f || out->scale == 1 || out->scale == 2) && read_flags(rows[3][3], &out->flags) &&
         read_integer(rows[4][0], 0, STY_MAX_SCATTER, &out->scatter) && rows[4][1] == 0 && rows[4][2] == 0 &&
         rows[4][3] == 0;
}

StyRuntimeStatus sty_decode_style(const float rows[STY_PARAM_ROWS][4], uint32_t exemplars, StyStyle *out) {
  StyStyle style;
  if (!rows || !out) return STY_RUNTIME_BAD_ARGUMENT;
  if (!read_rows(rows, &style)) return STY_RUNTIME_BAD_PARAMETER;
  const int layers = style.flags & STY_FLAG_BASE ? 2 * style.layer_count : style.layer_count;
  if ((uint32_t)(style.layer + layers) > exemplars) return STY_RUNTIME_BAD_PARAMETER;
  *out = style;
  return STY_RUNTIME_OK;
}

void sty_encode_style(const StyStyle *style, float rows[STY_PARAM_ROWS][4]) {
  const float values[STY_PARAM_ROWS][4] = {
      {(float)style->threshold, (float)style->top_level, (float)style->radius, style->depth_tolerance},
      {style->luma_weight, style->colour_weight, (float)style->layer, (float)style->layer_count},
      {style->luma[0], style->luma[1], style->luma[2], style->luma[3]},
      {style->jitter_amount, (float)style->jitter_period, style->scale, (float)style->flags},
      {(float)style->scatter, 0, 0, 0},
  };
  for (int row = 0; row < STY_PARAM_ROWS; row++)
    for (int component = 0; component < 4; component++) rows[row][component] = values[row][component];
}
