#include "sphere.h"

#include <math.h>

static const Vector light_axis = {-0.515f, 0.572f, 0.638f};

/* Halfway from the light to the viewer. */
static const Vector highlight_axis = {-0.285f, 0.316f, 0.905f};

/* The pole of the parallels that strokes follow. It lies just inside the rim
 * on the lit side, so that no whorl shows and strokes run across the highlight
 * as a right hand draws them. */
static const Vector form_axis = {-0.678f, 0.714f, 0.176f};

static float dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

Vector find_normal(float x, float y) {
  const float half = CANVAS_SIDE / 2.0f;
  Vector n = {(x - half) / half, (half - y) / half, 0.0f};
  float square = n.x * n.x + n.y * n.y;
  if (square < 1.0f) {
    n.z = sqrtf(1.0f - square);
  } else {
    float radius = sqrtf(square);
    n.x /= radius;
    n.y /= radius;
  }
  return n;
}

Shade observe_sphere(float x, float y) {
  static const Vector floor_bounce = {0.62f, -0.72f, 0.31f};
  Vector n = find_normal(x, y);
  Shade shade;
  float direct = ease(-0.42f, 1.06f, dot(n, light_axis));
  float rim = 1.0f - n.z;
  shade.reflected = clamp_unit(dot(n, floor_bounce)) * ease(0.25f, 0.95f, rim);
  shade.light = clamp_unit(direct + 0.26f * shade.reflected);
  shade.highlight = ease(0.945f, 0.992f, dot(n, highlight_axis));
  return shade;
}

/* Unit direction, in pixels with y down, of the parallels. */
static void find_direction(float x, float y, float turn, float *dx, float *dy) {
  Vector n = find_normal(x, y);
  float u = form_axis.y * n.z - form_axis.z * n.y, v = form_axis.x * n.z - form_axis.z * n.x;
  float u_turned = u - turn * v, v_turned = v + turn * u;
  float length = sqrtf(u_turned * u_turned + v_turned * v_turned);
  if (length < 1e-6f) {
    *dx = 1.0f;
    *dy = 0.0f;
    return;
  }
  *dx = u_turned / length;
  *dy = v_turned / length;
}

void trace_form(Path *path, float x, float y, float length, float turn, float wobble, Random *random) {
  const float step = 4.0f;
  int half_count = (int)(0.5f * length / step + 0.5f);
  float bend = draw_between(random, -wobble, wobble);
  float lean = draw_between(random, -wobble, wobble);
  if (half_count < 1) {
    half_count = 1;
  }
  if (half_count > (PATH_POINTS - 1) / 2) {
    half_count = (PATH_POINTS - 1) / 2;
  }
  path->count = 2 * half_count + 1;
  path->step = step;
  for (int side = -1; side <= 1; side += 2) {
    float px = x, py = y, last_dx = 0.0f, last_dy = 0.0f;
    path->x[half_count] = x;
    path->y[half_count] = y;
    for (int k = 1; k <= half_count; k++) {
      float share = (float)(side * k) / (float)half_count;
      float dx, dy;
      find_direction(px, py, turn + lean + bend * share, &dx, &dy);
      /* Near the pole the parallels turn faster than a hand can. */
      if (k > 1 && dx * last_dx + dy * last_dy < 0.9f) {
        dx = last_dx;
        dy = last_dy;
      }
      last_dx = dx;
      last_dy = dy;
      px += (float)side * step * dx;
      py += (float)side * step * dy;
      path->x[half_count + side * k] = px;
      path->y[half_count + side * k] = py;
    }
  }
  for (int i = 0; i < path->count; i++) {
    path->pressure[i] = 1.0f;
  }
}
