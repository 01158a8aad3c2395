/* Willow charcoal and white chalk on buff paper: a broad side-of-the-stick
 * lay-in, rubbed along the form, then fresh strokes that catch on the grain. */
#include <math.h>
#include <stdlib.h>

#include "media.h"
#include "sphere.h"

typedef struct Stick {
  Color color;
  float half_width;
  float strength;
  float hardness; /* 0 dusty: fills the grain .. 1 catches on its hills only */
  float seed;
} Stick;

static void touch_stick(Canvas *canvas, const Touch *touch, const void *brush) {
  const Stick *stick = brush;
  float crumbs = make_noise(touch->across * 0.7f + stick->seed, touch->along * 0.04f, 61u);
  float side = 1.0f - ease(0.55f, 1.0f, touch->distance / stick->half_width + 0.5f * (crumbs - 0.5f));
  float press = clamp_unit(touch->pressure) * side * (0.35f + 1.3f * crumbs);
  float catch_at = stick->hardness * (1.0f - 0.45f * press);
  float bite = ease(catch_at - 0.42f, catch_at + 0.42f, canvas->tooth[touch->pixel]);
  cover(canvas, touch->pixel, stick->color, stick->strength * press * bite);
}

static float want_lightness(float x, float y) {
  Shade shade = observe_sphere(x, y);
  return 0.09f + 0.84f * shade.light + 0.2f * shade.highlight;
}

static float swing_hand(const Path *path, int i) {
  float t = (float)i / (float)(path->count - 1);
  return ease(-0.12f, 0.18f, t) * (1.0f - 0.65f * ease(0.55f, 1.0f, t));
}

static void lay_in(Canvas *canvas, Random *random, Color color) {
  Path path;
  for (int k = 0; k < 3600; k++) {
    float x, y;
    draw_place(random, k, &x, &y);
    Stick stick = {.color = color, .strength = 0.34f, .hardness = 0.0f};
    stick.half_width = draw_between(random, 6.0f, 10.0f);
    stick.seed = draw_between(random, 0.0f, 4000.0f);
    float length = draw_between(random, 36.0f, 64.0f);
    trace_form(&path, x, y, length, 0.15f, 0.14f, random);
    for (int i = 0; i < path.count; i++) {
      float want = want_lightness(path.x[i], path.y[i]) + 0.02f;
      float lack = measure_lightness(canvas, path.x[i], path.y[i], 6.0f) - want;
      path.pressure[i] = clamp_unit(4.0f * lack) * swing_hand(&path, i);
    }
    sweep_path(canvas, &path, stick.half_width * 1.3f + 1.0f, touch_stick, &stick);
  }
}

/* Evenly spaced strokes, their pressure growing between two tones: toward the
 * dark for charcoal, toward the light for chalk. */
typedef struct StickPass {
  Color color;
  float none, full; /* wanted lightness */
  float turn;
  float gap;
  float half_width;
  float length;
  float strength;
  float hardness;
} StickPass;

static void lay_strokes(Canvas *canvas, Random *random, const StickPass *pass) {
  Path path;
  clear_claims(canvas);
  for (int k = 0; k < 9000; k++) {
    float x, y;
    draw_place(random, k, &x, &y);
    float length = pass->length * draw_between(random, 0.7f, 1.3f);
    float turn = pass->turn + draw_between(random, -0.14f, 0.14f);
    trace_form(&path, x, y, length, turn, 0.14f, random);
    if (!trim_to_free(canvas, &path, 14.0f)) {
      continue;
    }
    Stick stick = {.color = pass->color, .strength = pass->strength, .hardness = pass->hardness};
    stick.half_width = pass->half_width * draw_between(random, 0.7f, 1.25f);
    stick.seed = draw_between(random, 0.0f, 4000.0f);
    float mood = draw_between(random, 0.65f, 1.15f);
    float total = 0.0f;
    for (int i = 0; i < path.count; i++) {
      float t = (want_lightness(path.x[i], path.y[i]) - pass->none) / (pass->full - pass->none);
      path.pressure[i] = mood * clamp_unit(t) * swing_hand(&path, i);
      total += path.pressure[i];
    }
    if (total > 0.06f * (float)path.count) {
      sweep_path(canvas, &path, stick.half_width * 1.3f + 1.0f, touch_stick, &stick);
      claim_path(canvas, &path, pass->gap * draw_between(random, 0.8f, 1.2f));
    }
  }
}

/* A finger drawn along the form: each pixel becomes the mean of a short path
 * through it, by `share`. */
static bool smudge(Canvas *canvas, Random *random, float length, float share) {
  Color *rubbed = malloc(CANVAS_PIXELS * sizeof *rubbed);
  if (rubbed == NULL) {
    return false;
  }
  Path path;
  for (int i = 0; i < CANVAS_PIXELS; i++) {
    float x = (float)(i % CANVAS_SIDE) + 0.5f, y = (float)(i / CANVAS_SIDE) + 0.5f;
    Color sum = {0.0f, 0.0f, 0.0f};
    int count = 0;
    trace_form(&path, x, y, length, 0.3f, 0.0f, random);
    for (int k = 0; k < path.count; k++) {
      int px = (int)path.x[k], py = (int)path.y[k];
      if (path.x[k] >= 0.0f && path.y[k] >= 0.0f && px < CANVAS_SIDE && py < CANVAS_SIDE) {
        Color c = canvas->color[py * CANVAS_SIDE + px];
        sum.r += c.r;
        sum.g += c.g;
        sum.b += c.b;
        count++;
      }
    }
    float each = 1.0f / (float)count;
    Color mean = {sum.r * each, sum.g * each, sum.b * each};
    rubbed[i] = mix_colors(canvas->color[i], mean, share);
  }
  free(canvas->color);
  canvas->color = rubbed;
  return true;
}

Canvas *paint_charcoal(void) {
  Canvas *canvas = create_canvas(mix_from_bytes(205, 184, 150));
  if (canvas == NULL) {
    return NULL;
  }
  const Color charcoal = mix_from_bytes(18, 16, 19), chalk = mix_from_bytes(253, 249, 240);
  const StickPass passes[] = {
      {charcoal, 0.88f, 0.36f, 0.20f, 7.5f, 4.8f, 52.0f, 0.95f, 0.40f},
      {charcoal, 0.58f, 0.18f, -0.35f, 8.0f, 4.2f, 48.0f, 1.00f, 0.36f},
      {charcoal, 0.98f, 0.42f, 0.45f, 9.0f, 1.5f, 46.0f, 1.00f, 0.35f},
      {charcoal, 0.46f, 0.12f, 0.10f, 7.5f, 2.6f, 46.0f, 1.00f, 0.30f},
      {chalk, 0.50f, 0.92f, 0.10f, 7.0f, 4.8f, 44.0f, 1.00f, 0.50f},
      {chalk, 0.66f, 0.96f, 0.55f, 7.5f, 2.4f, 38.0f, 1.00f, 0.35f},
      {chalk, 0.88f, 1.02f, -0.20f, 5.0f, 4.0f, 34.0f, 1.00f, 0.30f},
  };
  Random random = {505};
  roughen_paper(canvas, 3.1f, 55u);
  lay_in(canvas, &random, charcoal);
  if (!smudge(canvas, &random, 26.0f, 0.7f)) {
    destroy_canvas(canvas);
    return NULL;
  }
  for (size_t i = 0; i < sizeof passes / sizeof passes[0]; i++) {
    lay_strokes(canvas, &random, &passes[i]);
  }
  return canvas;
}
