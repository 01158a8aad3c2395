/* Oil, alla prima: three brushes from broad to small, every stroke loaded
 * with two half-mixed colours, its bristles dragging ridges that catch the
 * studio light. */
#include <math.h>

#include "media.h"
#include "sphere.h"

typedef struct Bristles {
  Color color, streak; /* what was picked up, half mixed */
  float half_width;
  float length;
  float thickness; /* pixels of paint */
  float dryness;   /* 0 loaded .. 1 runs out early */
  float seed;
} Bristles;

static void touch_bristles(Canvas *canvas, const Touch *touch, const void *brush) {
  const Bristles *b = brush;
  float across = touch->across / b->half_width;
  if (across < -1.1f || across > 1.1f) {
    return;
  }
  float hair = make_noise(touch->across * 0.85f + b->seed, touch->along * 0.035f, 51u);
  float tuft = make_noise(touch->across * 0.32f + b->seed, touch->along * 0.02f, 52u);
  float bristle = 0.6f * hair + 0.4f * tuft;

  float ragged_start = 3.5f * (bristle - 0.5f), ragged_end = (5.0f + 14.0f * b->dryness) * (bristle - 0.5f);
  float from_start = touch->along - ragged_start, to_end = b->length - touch->along + ragged_end;
  float side = (1.0f - fabsf(across) + 0.22f * (tuft - 0.5f)) * b->half_width;
  float inside = side < from_start ? side : from_start;
  inside = inside < to_end ? inside : to_end;

  float travelled = clamp_unit(touch->along / b->length);
  float supply = 1.25f - b->dryness * (0.35f + 0.75f * travelled);
  float opacity = clamp_unit(0.8f * inside) * ease(0.0f, 0.28f, supply - (1.0f - bristle));
  if (opacity <= 0.0f) {
    return;
  }
  Color paint = mix_colors(b->color, b->streak, ease(0.38f, 0.72f, tuft * 0.65f + hair * 0.35f));
  cover(canvas, touch->pixel, paint, 0.94f * opacity);

  /* Paint is pushed to the sides and piles up where the brush is lifted. */
  float ridge = 1.0f - ease(0.0f, 2.6f, side);
  float pile = 1.0f - ease(0.0f, 5.0f, to_end);
  float height = b->thickness * (0.35f + 0.75f * bristle + 0.45f * ridge + 0.5f * pile);
  float *relief = &canvas->relief[touch->pixel];
  *relief += (0.35f * *relief + height - *relief) * opacity;
}

static Color pick_paint(Random *random, float light, float stray) {
  const Color stops[] = {mix_from_bytes(30, 12, 40),   mix_from_bytes(66, 14, 48),   mix_from_bytes(122, 16, 40),
                         mix_from_bytes(176, 24, 30),  mix_from_bytes(214, 52, 26),  mix_from_bytes(236, 104, 30),
                         mix_from_bytes(248, 160, 58), mix_from_bytes(255, 212, 124)};
  float tone = light + draw_between(random, -stray, stray);
  Color color = pick_from_ramp(stops, 8, tone);
  if (light < 0.38f && draw_chance(random, 0.13f)) {
    color = mix_colors(color, mix_from_bytes(34, 74, 122), draw_between(random, 0.35f, 0.75f));
  } else if (light > 0.35f && light < 0.8f && draw_chance(random, 0.07f)) {
    color = mix_colors(color, mix_from_bytes(206, 60, 112), draw_between(random, 0.3f, 0.7f));
  }
  return color;
}

typedef struct BrushPass {
  int count;
  float half_width;
  float length;
  float turn;
  float stray;
  float thickness;
  float dryness;
} BrushPass;

static void lay_strokes(Canvas *canvas, Random *random, const BrushPass *pass) {
  Path path;
  for (int k = 0; k < pass->count; k++) {
    float x, y;
    draw_place(random, k, &x, &y);
    Shade shade = observe_sphere(x, y);
    Bristles b;
    float light = shade.light * 0.97f;
    b.color = pick_paint(random, light, pass->stray);
    b.streak = pick_paint(random, light, 1.6f * pass->stray);
    if (draw_unit(random) < 1.3f * shade.highlight) {
      float white = ease(0.0f, 0.5f, shade.highlight);
      b.color = mix_colors(b.color, mix_from_bytes(255, 247, 222), 0.35f + 0.6f * white);
      b.streak = mix_colors(b.streak, mix_from_bytes(255, 232, 168), 0.3f + 0.5f * white);
    } else if (shade.reflected > 0.25f && draw_chance(random, 0.45f)) {
      b.streak = mix_colors(b.streak, mix_from_bytes(96, 82, 150), 0.55f);
    }
    b.half_width = pass->half_width * draw_between(random, 0.72f, 1.2f);
    float length = pass->length * draw_between(random, 0.7f, 1.25f);
    float sway = make_noise(x / 90.0f, y / 90.0f, 53u) - 0.5f;
    float turn = pass->turn + 1.3f * sway + draw_between(random, -0.35f, 0.35f);
    trace_form(&path, x, y, length, turn, 0.16f, random);
    b.length = get_path_length(&path);
    b.thickness = pass->thickness * (0.75f + 0.6f * shade.light);
    b.dryness = draw_unit(random) * pass->dryness;
    b.seed = draw_between(random, 0.0f, 4000.0f);
    sweep_path(canvas, &path, b.half_width * 1.15f + 3.0f, touch_bristles, &b);
  }
}

static float get_relief(const Canvas *canvas, int x, int y) {
  x = x < 0 ? 0 : x >= CANVAS_SIDE ? CANVAS_SIDE - 1 : x;
  y = y < 0 ? 0 : y >= CANVAS_SIDE ? CANVAS_SIDE - 1 : y;
  return canvas->relief[y * CANVAS_SIDE + x];
}

static void light_relief(Canvas *canvas) {
  const Color glint = mix_from_bytes(255, 246, 232);
  for (int y = 0; y < CANVAS_SIDE; y++) {
    for (int x = 0; x < CANVAS_SIDE; x++) {
      int pixel = y * CANVAS_SIDE + x;
      float slope_x = get_relief(canvas, x + 1, y) - get_relief(canvas, x - 1, y);
      float slope_y = get_relief(canvas, x, y + 1) - get_relief(canvas, x, y - 1);
      float facing = 0.62f * slope_x + 0.78f * slope_y;
      float shade = facing / sqrtf(1.0f + slope_x * slope_x + slope_y * slope_y);
      Color *c = &canvas->color[pixel];
      float gain = 1.0f + (shade > 0.0f ? 0.75f : 0.62f) * shade;
      c->r *= gain;
      c->g *= gain;
      c->b *= gain;
      cover(canvas, pixel, glint, 0.26f * ease(0.42f, 0.95f, shade));
    }
  }
}

Canvas *paint_oil(void) {
  Canvas *canvas = create_canvas(mix_from_bytes(96, 34, 40));
  if (canvas == NULL) {
    return NULL;
  }
  Random random = {404};
  const BrushPass passes[] = {
      {900, 13.0f, 84.0f, 0.1f, 0.05f, 0.7f, 0.4f},
      {1500, 8.5f, 60.0f, 0.15f, 0.085f, 1.0f, 0.8f},
      {2100, 5.2f, 40.0f, 0.0f, 0.12f, 1.25f, 0.95f},
  };
  for (size_t i = 0; i < sizeof passes / sizeof passes[0]; i++) {
    lay_strokes(canvas, &random, &passes[i]);
  }
  light_relief(canvas);
  return canvas;
}
