#include "guide/flow_window.h"

#include <float.h>
#include <math.h>

StyFlowPlace sty_find_flow_place(float x, float y) {
  const float left = floorf(x), top = floorf(y);
  return (StyFlowPlace){(int)left, (int)top, x - left, y - top};
}

void sty_sample_flow_window(const StyFlowPicture *picture, const StyFlowPlace *place, int radius, StyLanes *out) {
  const float right = place->right, down = place->down, left = 1 - right, up = 1 - down;
  const float weights[4] = {left * up, right * up, left * down, right * down};
  const int side = 2 * radius + 1;
  for (int j = -radius; j <= radius; j++, out += side) {
    const StyLanes *upper = sty_get_flow_pixel(picture, place->x - radius, place->y + j);
    const StyLanes *lower = upper + picture->stride;
    for (int i = 0; i < side; i++)
      out[i] =
          (weights[0] * upper[i] + weights[1] * upper[i + 1]) + (weights[2] * lower[i] + weights[3] * lower[i + 1]);
  }
}

/* With `r` known to the compiler, a row is a few instructions. */
static inline float measure_offset(const StyFlowLevel *level, const StyLanes *a, const StyLanes *b, StyLanes base,
                                   int r, float scale, float limit) {
  const ptrdiff_t stride = level->pictures[0].stride;
  StyLanes sum = sty_spread_lanes(0);
  float mean = 0;
  for (ptrdiff_t j = -r; j <= r && mean <= limit; j++) {
    for (ptrdiff_t i = -r; i <= r; i++) sum += sty_get_magnitude(a[j * stride + i] - b[j * stride + i] - base);
    mean = sty_add_lanes(sum) * scale;
  }
  return mean;
}

float sty_measure_flow_offset(const StyFlowLevel *level, const StyFlowRules *rules, int x, int y, int u, int v,
                              float limit) {
  const StyLanes *a = sty_get_flow_pixel(&level->pictures[0], x, y);
  const StyLanes *b = sty_get_flow_pixel(&level->pictures[1], x + u, y + v);
  if (rules->method == STY_FLOW_PUBLISHED)
    return measure_offset(level, a, b, *a - *b, rules->radius, rules->scale, limit);
  const StyLanes none = sty_spread_lanes(0);
  return rules->radius == 2 ? measure_offset(level, a, b, none, 2, rules->scale, limit)
                            : measure_offset(level, a, b, none, rules->radius, rules->scale, limit);
}

float sty_measure_flow_texture(const StyFlowLevel *level, const StyFlowRules *rules, int x, int y) {
  const int r = rules->radius;
  const StyLanes *centre = sty_get_flow_pixel(&level->pictures[0], x, y);
  StyLanes sum = sty_spread_lanes(0);
  for (int j = -r; j <= r; j++) {
    const StyLanes *p = centre + j * level->pictures[0].stride;
    for (int i = -r; i <= r; i++) sum += sty_get_magnitude(p[i] - *centre);
  }
  return sty_add_lanes(sum) * rules->scale;
}

float sty_compare_flow_window(const StyFlowLevel *level, const StyFlowRules *rules, int x, int y,
                              const StyLanes *sampled, int side, float limit) {
  const int r = rules->radius;
  StyLanes sum = sty_spread_lanes(0);
  float mean = 0;
  for (int j = -r; j <= r && mean <= limit; j++, sampled += side) {
    const StyLanes *p = sty_get_flow_pixel(&level->pictures[0], x - r, y + j);
    for (int i = 0; i <= 2 * r; i++) sum += sty_get_magnitude(p[i] - sampled[i]);
    mean = sty_add_lanes(sum) * rules->scale;
  }
  return mean;
}

/* ---- below the pixel ------------------------------------------------------------ */

/* The normal equations of Lucas and Kanade over the window: gradients of this frame, and what the
 * sampled window differs by. */
typedef struct Equations {
  float xx, xy, yy, x, y;
} Equations;

static Equations sum_equations(const StyFlowLevel *level, int r, int x, int y, const StyLanes *sampled) {
  StyLanes xx = sty_spread_lanes(0), xy = xx, yy = xx, ex = xx, ey = xx;
  const ptrdiff_t stride = level->pictures[0].stride;
  for (int j = -r; j <= r; j++) {
    const StyLanes *p = sty_get_flow_pixel(&level->pictures[0], x - r, y + j);
    for (int i = 0; i <= 2 * r; i++, p++) {
      const StyLanes gx = 0.5f * (p[1] - p[-1]), gy = 0.5f * (p[stride] - p[-stride]);
      const StyLanes difference = *sampled++ - *p;
      xx += gx * gx;
      xy += gx * gy;
      yy += gy * gy;
      ex += gx * difference;
      ey += gy * difference;
    }
  }
  return (Equations){sty_add_lanes(xx), sty_add_lanes(xy), sty_add_lanes(yy), sty_add_lanes(ex), sty_add_lanes(ey)};
}

/* A share of the trace on the diagonal keeps a step across an edge from running along it. Windows
 * that are the same give the step 0, so whole motions stay whole. */
static bool solve_equations(const Equations *e, float *u, float *v) {
  static const float damping = 0.01f;
  const float more = damping * (e->xx + e->yy), xx = e->xx + more, yy = e->yy + more;
  const float determinant = xx * yy - e->xy * e->xy;
  if (!(determinant > 0)) return false;
  *u = (e->xy * e->y - yy * e->x) / determinant;
  *v = (e->xy * e->x - xx * e->y) / determinant;
  return true;
}

float sty_refine_flow(const StyFlowLevel *level, const StyFlowRules *rules, int x, int y, StyFlowVector *vector) {
  enum { STEPS = 2 };
  StyLanes window[STY_FLOW_MOST_PATCH];
  float least = FLT_MAX, u = vector->u, v = vector->v;
  for (int step = 0;; step++) {
    if (!sty_is_inside(&level->pictures[1], (float)x + u, (float)y + v)) return least;
    const StyFlowPlace place = sty_find_flow_place((float)x + u, (float)y + v);
    sty_sample_flow_window(&level->pictures[1], &place, rules->radius, window);
    const float mean = sty_compare_flow_window(level, rules, x, y, window, 2 * rules->radius + 1, least);
    if (mean >= least) return least;
    least = mean;
    *vector = (StyFlowVector){u, v, vector->origin};
    if (step == STEPS || mean == 0) return least;
    const Equations equations = sum_equations(level, rules->radius, x, y, window);
    float du, dv;
    if (!solve_equations(&equations, &du, &dv) || !(fabsf(du) <= 1 && fabsf(dv) <= 1)) return least;
    u += du;
    v += dv;
  }
}
