/* Graphite on cartridge paper: rubbed undertone, then hatching laid wherever
 * the sheet is still lighter than the model. */
#include "media.h"
#include "sphere.h"

typedef struct Lead {
  float radius;
  float hardness; /* 0 soft: fills the grain .. 1 hard: catches on its hills only */
  float darkness;
} Lead;

static void touch_lead(Canvas *canvas, const Touch *touch, const void *brush) {
  const Lead *lead = brush;
  Color graphite = mix_from_bytes(36, 36, 42);
  float press = clamp_unit(touch->pressure);
  float radius = lead->radius * (0.62f + 0.38f * press);
  float core = 1.0f - ease(0.45f * radius, radius + 0.55f, touch->distance);
  float bite = 1.0f - lead->hardness * (1.0f - ease(0.0f, 0.75f, canvas->tooth[touch->pixel] + 0.2f * press));
  cover(canvas, touch->pixel, graphite, core * lead->darkness * (0.15f + 0.85f * press) * bite);
}

static float want_lightness(float x, float y) {
  Shade shade = observe_sphere(x, y);
  float light = 0.06f + 0.84f * shade.light * (0.62f + 0.38f * shade.light);
  return light + (0.97f - light) * shade.highlight;
}

/* A hand comes down quickly and lifts off slowly. */
static float swing_hand(const Path *path, int i) {
  float t = (float)i / (float)(path->count - 1);
  return ease(-0.08f, 0.14f, t) * (1.0f - 0.7f * ease(0.5f, 1.0f, t));
}

static void rub_undertone(Canvas *canvas, Random *random) {
  const Lead side = {.radius = 6.0f, .hardness = 0.55f, .darkness = 0.22f};
  Path path;
  for (int k = 0; k < 4200; k++) {
    float x, y;
    draw_place(random, k, &x, &y);
    float length = draw_between(random, 24.0f, 44.0f);
    trace_form(&path, x, y, length, 0.35f, 0.2f, random);
    for (int i = 0; i < path.count; i++) {
      float want = 1.0f - 0.72f * (1.0f - want_lightness(path.x[i], path.y[i]));
      float lack = measure_lightness(canvas, path.x[i], path.y[i], 5.0f) - want;
      path.pressure[i] = clamp_unit(5.0f * lack) * swing_hand(&path, i);
    }
    sweep_path(canvas, &path, side.radius + 1.0f, touch_lead, &side);
  }
}

/* One direction of hatching: evenly spaced lines, where the model is darker
 * than `from`, at full pressure from `full` on. */
typedef struct Hatching {
  float turn;
  float from, full; /* darkness */
  float gap;        /* pixels between lines */
  float radius;
  float darkness;
} Hatching;

static void hatch(Canvas *canvas, Random *random, const Hatching *hatching) {
  Path path;
  clear_claims(canvas);
  for (int k = 0; k < 14000; k++) {
    float x, y;
    draw_place(random, k, &x, &y);
    float length = draw_between(random, 34.0f, 74.0f);
    trace_form(&path, x, y, length, hatching->turn, 0.09f, random);
    if (!trim_to_free(canvas, &path, 14.0f)) {
      continue;
    }
    Lead lead = {.hardness = 0.42f};
    lead.radius = hatching->radius * draw_between(random, 0.75f, 1.25f);
    lead.darkness = hatching->darkness * draw_between(random, 0.75f, 1.0f);
    float total = 0.0f;
    for (int i = 0; i < path.count; i++) {
      float darkness = 1.0f - want_lightness(path.x[i], path.y[i]);
      path.pressure[i] = ease(hatching->from, hatching->full, darkness) * swing_hand(&path, i);
      total += path.pressure[i];
    }
    if (total > 0.06f * (float)path.count) {
      sweep_path(canvas, &path, lead.radius + 1.0f, touch_lead, &lead);
      claim_path(canvas, &path, hatching->gap * draw_between(random, 0.8f, 1.15f));
    }
  }
}

Canvas *paint_pencil(void) {
  const Hatching directions[] = {
      {0.06f, -0.05f, 0.45f, 4.8f, 1.30f, 0.92f}, {0.80f, 0.12f, 0.55f, 4.8f, 1.40f, 0.95f},
      {-0.62f, 0.30f, 0.70f, 4.8f, 1.55f, 1.00f}, {2.40f, 0.48f, 0.80f, 4.6f, 1.70f, 1.00f},
      {0.35f, 0.60f, 0.85f, 4.4f, 1.90f, 1.00f},
  };
  Canvas *canvas = create_canvas(mix_from_bytes(249, 246, 238));
  if (canvas == NULL) {
    return NULL;
  }
  Random random = {101};
  roughen_paper(canvas, 1.9f, 11u);
  rub_undertone(canvas, &random);
  for (size_t i = 0; i < sizeof directions / sizeof directions[0]; i++) {
    hatch(canvas, &random, &directions[i]);
  }
  return canvas;
}
