/* Watercolour: a wet first wash, then glazes dab by dab, each with its dark
 * rim where the pigment dried last and its grains in the paper's valleys. */
#include "media.h"
#include "sphere.h"

typedef struct Dab {
  Color pigment;
  float radius;
  float density;
  float wetness;     /* 0 crisp rim .. 1 soft */
  float granulation; /* how much pigment settles in the valleys */
  uint32_t seed;
} Dab;

static void touch_dab(Canvas *canvas, const Touch *touch, const void *brush) {
  const Dab *dab = brush;
  float shore = make_fractal_noise(touch->x / 13.0f, touch->y / 13.0f, dab->seed) - 0.5f;
  float inside = dab->radius * (1.0f + 0.9f * shore) - touch->distance;
  if (inside <= 0.0f) {
    return;
  }
  float dry = 1.0f - dab->wetness;
  float body = ease(0.0f, 1.3f + 9.0f * dab->wetness, inside);
  float rim = dry * 1.15f * (1.0f - ease(0.7f, 3.4f, inside));
  float drift = make_fractal_noise(touch->x / 14.0f, touch->y / 14.0f, dab->seed + 9u);
  float valley = 1.0f - canvas->tooth[touch->pixel];
  float grain = 1.0f + dab->granulation * (2.0f * valley - 1.0f);
  glaze(canvas, touch->pixel, dab->pigment, dab->density * body * (0.70f + 0.45f * drift + rim) * grain);
}

static float want_lightness(float x, float y) {
  Shade shade = observe_sphere(x, y);
  float light = 0.24f + 0.66f * shade.light;
  return light + (0.99f - light) * shade.highlight;
}

static void flood_paper(Canvas *canvas) {
  const Color stops[] = {mix_from_bytes(96, 138, 170),  mix_from_bytes(112, 176, 170), mix_from_bytes(150, 204, 150),
                         mix_from_bytes(204, 222, 120), mix_from_bytes(244, 236, 140), mix_from_bytes(255, 250, 214)};
  for (int i = 0; i < CANVAS_PIXELS; i++) {
    float x = (float)(i % CANVAS_SIDE) + 0.5f, y = (float)(i / CANVAS_SIDE) + 0.5f;
    Shade shade = observe_sphere(x, y);
    float bloom = make_fractal_noise(x / 22.0f, y / 22.0f, 41u) - 0.5f;
    Color wash = pick_from_ramp(stops, 6, shade.light * 0.92f + 0.3f * bloom);
    float valley = 1.0f - canvas->tooth[i];
    glaze(canvas, i, wash, (1.0f - 0.93f * shade.highlight) * (0.72f + 0.5f * bloom + 0.28f * valley));
  }
}

static void lay_glazes(Canvas *canvas, Random *random, int count, float radius, float strength) {
  const Color pigments[] = {mix_from_bytes(52, 44, 120),  mix_from_bytes(36, 74, 150), mix_from_bytes(20, 116, 150),
                            mix_from_bytes(30, 146, 124), mix_from_bytes(92, 166, 70), mix_from_bytes(176, 190, 44),
                            mix_from_bytes(250, 214, 60)};
  const Color rose = mix_from_bytes(238, 128, 120), violet = mix_from_bytes(112, 70, 160);
  Path path;
  for (int k = 0; k < count; k++) {
    float x, y;
    draw_place(random, k, &x, &y);
    Shade shade = observe_sphere(x, y);
    float lack = measure_lightness(canvas, x, y, radius * 1.6f) - want_lightness(x, y);
    if (lack < draw_between(random, 0.0f, 0.06f) || shade.highlight > 0.1f) {
      continue;
    }
    Dab dab;
    float tone = shade.light * 0.95f + draw_between(random, -0.17f, 0.17f);
    dab.pigment = pick_from_ramp(pigments, 7, tone);
    if (draw_chance(random, 0.09f)) {
      dab.pigment = shade.light > 0.5f ? rose : violet;
    }
    dab.radius = radius * draw_between(random, 0.65f, 1.25f);
    dab.density = strength * (0.22f + 2.2f * lack);
    dab.wetness = draw_chance(random, 0.3f) ? draw_between(random, 0.4f, 0.9f) : 0.0f;
    dab.granulation = draw_between(random, 0.15f, 0.5f);
    dab.seed = (uint32_t)(k * 31 + (int)(radius * 100.0f));
    float length = radius * draw_between(random, 1.2f, 3.2f);
    trace_form(&path, x, y, length, 0.25f, 0.35f, random);
    sweep_path(canvas, &path, dab.radius * 1.6f, touch_dab, &dab);
  }
}

Canvas *paint_watercolour(void) {
  Canvas *canvas = create_canvas(mix_from_bytes(253, 251, 244));
  if (canvas == NULL) {
    return NULL;
  }
  Random random = {303};
  roughen_paper(canvas, 2.3f, 33u);
  flood_paper(canvas);
  lay_glazes(canvas, &random, 900, 18.0f, 0.75f);
  lay_glazes(canvas, &random, 1500, 12.0f, 0.85f);
  lay_glazes(canvas, &random, 2200, 8.0f, 0.95f);
  return canvas;
}
