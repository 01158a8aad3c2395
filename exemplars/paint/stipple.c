/* Ink dots over a pale wash: small worlds of yellow, turquoise, cobalt and
 * indigo that mix in the eye, the closer the darker. */
#include "media.h"
#include "sphere.h"

typedef struct Drop {
  Color ink;
  float radius;
  float density;
  uint32_t seed;
} Drop;

/* How one layer of dots is laid. */
typedef struct DotLayer {
  float light_from, light_to;  /* tones between which the dots thin out */
  float gap_dense, gap_sparse; /* pixels between dots */
  float small, large;          /* radii; dots grow with their density */
  const Color *ramp;           /* inks by tone, dark to light */
  int ramp_count;
  float stray; /* how far an ink wanders from its tone */
  int tries;
} DotLayer;

static void touch_drop(Canvas *canvas, const Touch *touch, const void *brush) {
  const Drop *drop = brush;
  float waver = make_noise(touch->x * 0.28f, touch->y * 0.28f, drop->seed) - 0.5f;
  float inside = drop->radius * (1.0f + 0.55f * waver) - touch->distance;
  float edge = 1.0f - ease(0.3f, 1.9f, inside);
  float pool = 0.86f + 0.22f * edge + 0.16f * (canvas->tooth[touch->pixel] - 0.5f);
  cover(canvas, touch->pixel, drop->ink, clamp_unit(inside + 0.5f) * clamp_unit(drop->density * pool));
}

static void lay_dots(Canvas *canvas, Random *random, const DotLayer *layer) {
  clear_claims(canvas);
  for (int k = 0; k < layer->tries; k++) {
    float x = draw_between(random, 0.0f, CANVAS_SIDE - 0.01f);
    float y = draw_between(random, 0.0f, CANVAS_SIDE - 0.01f);
    Shade shade = observe_sphere(x, y);
    float light = clamp_unit(shade.light + 0.35f * shade.highlight);
    float thinness = ease(layer->light_from, layer->light_to, light);
    bool beyond = layer->light_from < layer->light_to ? light > layer->light_to : light < layer->light_to;
    if (beyond || is_claimed(canvas, x, y)) {
      continue;
    }
    claim_disc(canvas, x, y, layer->gap_dense + (layer->gap_sparse - layer->gap_dense) * thinness);

    Drop drop;
    float tone = light + draw_between(random, -layer->stray, layer->stray);
    float size = layer->large + (layer->small - layer->large) * thinness;
    drop.ink = pick_from_ramp(layer->ramp, layer->ramp_count, tone);
    drop.radius = size * draw_between(random, 0.78f, 1.22f);
    drop.density = draw_between(random, 0.84f, 1.0f);
    drop.seed = (uint32_t)(k * 7 + 3);
    Path path;
    trace_form(&path, x, y, 1.0f, 0.4f, 0.8f, random);
    path.step = 0.5f * drop.radius;
    for (int i = 0; i < path.count; i++) {
      path.x[i] = x + (path.x[i] - x) * 0.11f * drop.radius;
      path.y[i] = y + (path.y[i] - y) * 0.11f * drop.radius;
    }
    sweep_path(canvas, &path, drop.radius * 1.4f + 1.0f, touch_drop, &drop);
  }
}

static void wash_ground(Canvas *canvas) {
  const Color stops[] = {mix_from_bytes(122, 146, 196), mix_from_bytes(150, 184, 218), mix_from_bytes(182, 214, 222),
                         mix_from_bytes(232, 236, 190), mix_from_bytes(252, 244, 176), mix_from_bytes(255, 252, 232)};
  for (int i = 0; i < CANVAS_PIXELS; i++) {
    float x = (float)(i % CANVAS_SIDE) + 0.5f, y = (float)(i / CANVAS_SIDE) + 0.5f;
    Shade shade = observe_sphere(x, y);
    float cloud = make_fractal_noise(x / 17.0f, y / 17.0f, 31u) - 0.5f;
    float tone = 0.86f * shade.light + 0.25f * shade.highlight + 0.26f * cloud;
    Color wash = pick_from_ramp(stops, 6, tone);
    cover(canvas, i, wash, 1.0f);
    glaze(canvas, i, mix_from_bytes(190, 200, 215), 0.45f * (1.0f - canvas->tooth[i]) * (1.0f - shade.highlight));
  }
}

Canvas *paint_stipple(void) {
  Canvas *canvas = create_canvas(mix_from_bytes(252, 249, 240));
  if (canvas == NULL) {
    return NULL;
  }
  Random random = {202};
  roughen_paper(canvas, 3.0f, 21u);
  wash_ground(canvas);

  const Color bright[] = {mix_from_bytes(58, 66, 170),  mix_from_bytes(28, 96, 200),  mix_from_bytes(16, 150, 196),
                          mix_from_bytes(40, 186, 170), mix_from_bytes(244, 206, 30), mix_from_bytes(255, 226, 40),
                          mix_from_bytes(250, 170, 40)};
  const Color deep[] = {mix_from_bytes(18, 16, 46), mix_from_bytes(30, 26, 84), mix_from_bytes(28, 50, 140),
                        mix_from_bytes(36, 84, 176), mix_from_bytes(20, 120, 170)};
  const Color warm[] = {mix_from_bytes(168, 40, 110), mix_from_bytes(214, 70, 90), mix_from_bytes(240, 120, 60),
                        mix_from_bytes(255, 190, 40)};
  const DotLayer layers[] = {
      {0.55f, 1.25f, 8.0f, 17.0f, 2.4f, 4.2f, bright, 7, 0.16f, 60000},
      {0.05f, 0.92f, 6.4f, 25.0f, 1.9f, 4.0f, deep, 5, 0.22f, 60000},
      {0.30f, 1.10f, 24.0f, 30.0f, 2.0f, 2.9f, warm, 4, 0.25f, 12000},
      {0.02f, 0.42f, 7.0f, 16.0f, 1.7f, 3.1f, deep, 5, 0.12f, 40000},
  };
  for (size_t i = 0; i < sizeof layers / sizeof layers[0]; i++) {
    lay_dots(canvas, &random, &layers[i]);
  }
  return canvas;
}
