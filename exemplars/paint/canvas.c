#include "canvas.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

Canvas *create_canvas(Color paper) {
  Canvas *canvas = calloc(1, sizeof *canvas);
  if (canvas == NULL) {
    return NULL;
  }
  canvas->color = malloc(CANVAS_PIXELS * sizeof *canvas->color);
  canvas->tooth = calloc(CANVAS_PIXELS, sizeof *canvas->tooth);
  canvas->relief = calloc(CANVAS_PIXELS, sizeof *canvas->relief);
  canvas->distance = malloc(CANVAS_PIXELS * sizeof *canvas->distance);
  canvas->along = malloc(CANVAS_PIXELS * sizeof *canvas->along);
  canvas->across = malloc(CANVAS_PIXELS * sizeof *canvas->across);
  canvas->touched = malloc(CANVAS_PIXELS * sizeof *canvas->touched);
  canvas->stroke_mark = calloc(CANVAS_PIXELS, sizeof *canvas->stroke_mark);
  canvas->claimed = calloc(CANVAS_PIXELS, sizeof *canvas->claimed);
  if (canvas->color == NULL || canvas->tooth == NULL || canvas->relief == NULL || canvas->distance == NULL ||
      canvas->along == NULL || canvas->across == NULL || canvas->touched == NULL || canvas->stroke_mark == NULL ||
      canvas->claimed == NULL) {
    destroy_canvas(canvas);
    return NULL;
  }
  for (int i = 0; i < CANVAS_PIXELS; i++) {
    canvas->color[i] = paper;
  }
  return canvas;
}

void destroy_canvas(Canvas *canvas) {
  if (canvas == NULL) {
    return;
  }
  free(canvas->color);
  free(canvas->tooth);
  free(canvas->relief);
  free(canvas->distance);
  free(canvas->along);
  free(canvas->across);
  free(canvas->touched);
  free(canvas->stroke_mark);
  free(canvas->claimed);
  free(canvas);
}

float clamp_unit(float value) { return value < 0.0f ? 0.0f : value > 1.0f ? 1.0f : value; }

float ease(float from, float to, float value) {
  float t = clamp_unit((value - from) / (to - from));
  return t * t * (3.0f - 2.0f * t);
}

/* Clips a span of coordinates to whole pixels of the canvas. */
static void clip_span(float low, float high, int *first, int *last) {
  *first = low < 0.0f ? 0 : (int)low;
  *last = high > CANVAS_SIDE - 1.0f ? CANVAS_SIDE - 1 : (int)high;
}

/* Offers segment i of the path to every pixel near it; the nearest segment
 * wins. The outer segments run on past the ends of the path. */
static int offer_segment(Canvas *canvas, const Path *path, int i, float reach, int touched_count) {
  float ax = path->x[i], ay = path->y[i];
  float dx = path->x[i + 1] - ax, dy = path->y[i + 1] - ay;
  float length = sqrtf(dx * dx + dy * dy);
  if (length <= 0.0f) {
    return touched_count;
  }
  dx /= length;
  dy /= length;
  int x0, x1, y0, y1;
  float bx = path->x[i + 1], by = path->y[i + 1];
  clip_span((ax < bx ? ax : bx) - reach, (ax < bx ? bx : ax) + reach, &x0, &x1);
  clip_span((ay < by ? ay : by) - reach, (ay < by ? by : ay) + reach, &y0, &y1);
  for (int y = y0; y <= y1; y++) {
    for (int x = x0; x <= x1; x++) {
      float px = (float)x + 0.5f - ax, py = (float)y + 0.5f - ay;
      float t = px * dx + py * dy;
      float side = py * dx - px * dy;
      float beyond = t < 0.0f ? -t : t > length ? t - length : 0.0f;
      float distance = sqrtf(side * side + beyond * beyond);
      if (distance > reach) {
        continue;
      }
      int pixel = y * CANVAS_SIDE + x;
      if (canvas->stroke_mark[pixel] != canvas->stroke_count) {
        canvas->stroke_mark[pixel] = canvas->stroke_count;
        canvas->touched[touched_count++] = pixel;
      } else if (distance >= canvas->distance[pixel]) {
        continue;
      }
      bool runs_on = (t < 0.0f && i == 0) || (t > length && i == path->count - 2);
      float within = runs_on ? t : t < 0.0f ? 0.0f : t > length ? length : t;
      canvas->distance[pixel] = distance;
      canvas->across[pixel] = side;
      canvas->along[pixel] = (float)i * path->step + within;
    }
  }
  return touched_count;
}

static float press_at(const Path *path, float along) {
  float at = along / path->step;
  if (at <= 0.0f) {
    return path->pressure[0];
  }
  int i = (int)at;
  if (i >= path->count - 1) {
    return path->pressure[path->count - 1];
  }
  float share = at - (float)i;
  return path->pressure[i] * (1.0f - share) + path->pressure[i + 1] * share;
}

void sweep_path(Canvas *canvas, const Path *path, float reach, TouchPixel *paint, const void *brush) {
  int count = 0;
  canvas->stroke_count++;
  for (int i = 0; i + 1 < path->count; i++) {
    count = offer_segment(canvas, path, i, reach, count);
  }
  for (int k = 0; k < count; k++) {
    Touch touch;
    touch.pixel = canvas->touched[k];
    touch.x = (float)(touch.pixel % CANVAS_SIDE) + 0.5f;
    touch.y = (float)(touch.pixel / CANVAS_SIDE) + 0.5f;
    touch.along = canvas->along[touch.pixel];
    touch.across = canvas->across[touch.pixel];
    touch.distance = canvas->distance[touch.pixel];
    touch.pressure = press_at(path, touch.along);
    paint(canvas, &touch, brush);
  }
}

float get_path_length(const Path *path) { return (float)(path->count - 1) * path->step; }

void clear_claims(Canvas *canvas) { memset(canvas->claimed, 0, CANVAS_PIXELS); }

void claim_disc(Canvas *canvas, float x, float y, float radius) {
  int x0, x1, y0, y1;
  clip_span(x - radius, x + radius, &x0, &x1);
  clip_span(y - radius, y + radius, &y0, &y1);
  for (int j = y0; j <= y1; j++) {
    for (int i = x0; i <= x1; i++) {
      float dx = (float)i + 0.5f - x, dy = (float)j + 0.5f - y;
      if (dx * dx + dy * dy < radius * radius) {
        canvas->claimed[j * CANVAS_SIDE + i] = 1;
      }
    }
  }
}

void claim_path(Canvas *canvas, const Path *path, float radius) {
  for (int i = 0; i < path->count; i++) {
    claim_disc(canvas, path->x[i], path->y[i], radius);
  }
}

bool is_claimed(const Canvas *canvas, float x, float y) {
  if (x < 0.0f || y < 0.0f || x >= CANVAS_SIDE || y >= CANVAS_SIDE) {
    return false;
  }
  return canvas->claimed[(int)y * CANVAS_SIDE + (int)x] != 0;
}

bool trim_to_free(const Canvas *canvas, Path *path, float length) {
  int best = 0, best_start = 0, run = 0;
  for (int i = 0; i < path->count; i++) {
    run = is_claimed(canvas, path->x[i], path->y[i]) ? 0 : run + 1;
    if (run > best) {
      best = run;
      best_start = i + 1 - run;
    }
  }
  if (best < 2 || (float)(best - 1) * path->step < length) {
    return false;
  }
  path->count = best;
  memmove(path->x, path->x + best_start, (size_t)best * sizeof path->x[0]);
  memmove(path->y, path->y + best_start, (size_t)best * sizeof path->y[0]);
  memmove(path->pressure, path->pressure + best_start, (size_t)best * sizeof path->pressure[0]);
  return true;
}

void cover(Canvas *canvas, int pixel, Color color, float opacity) {
  canvas->color[pixel] = mix_colors(canvas->color[pixel], color, clamp_unit(opacity));
}

void glaze(Canvas *canvas, int pixel, Color pigment, float density) {
  Color *under = &canvas->color[pixel];
  /* Whole layers filter one after the other; the rest of a layer is mixed
   * with no layer, which is near enough to a power and exact everywhere. */
  while (density > 0.0f) {
    float share = density < 1.0f ? density : 1.0f;
    under->r *= 1.0f - share * (1.0f - pigment.r);
    under->g *= 1.0f - share * (1.0f - pigment.g);
    under->b *= 1.0f - share * (1.0f - pigment.b);
    density -= 1.0f;
  }
}

float measure_lightness(const Canvas *canvas, float x, float y, float radius) {
  float sum = 0.0f;
  int count = 0;
  for (int j = -2; j <= 2; j++) {
    for (int i = -2; i <= 2; i++) {
      int px = (int)(x + (float)i * radius * 0.5f), py = (int)(y + (float)j * radius * 0.5f);
      if (px >= 0 && py >= 0 && px < CANVAS_SIDE && py < CANVAS_SIDE) {
        const Color *c = &canvas->color[py * CANVAS_SIDE + px];
        sum += 0.25f * c->r + 0.65f * c->g + 0.10f * c->b;
        count++;
      }
    }
  }
  return count > 0 ? sqrtf(sum / (float)count) : 1.0f;
}

void roughen_paper(Canvas *canvas, float size, uint32_t seed) {
  for (int y = 0; y < CANVAS_SIDE; y++) {
    for (int x = 0; x < CANVAS_SIDE; x++) {
      float bumps = make_noise((float)x / size, (float)y / size, seed);
      float fibres = make_noise(((float)x + 0.6f * (float)y) / (size * 2.2f),
                                ((float)y - 0.6f * (float)x) / (size * 0.8f), seed + 1u);
      float fine = make_noise((float)x / (size * 0.55f), (float)y / (size * 0.55f), seed + 2u);
      float height = 0.45f * bumps + 0.25f * fibres + 0.30f * fine;
      canvas->tooth[y * CANVAS_SIDE + x] = ease(0.22f, 0.78f, height);
    }
  }
}

StyStatus develop_canvas(const Canvas *canvas, StyImage **out, StyError *error) {
  static const char *const names[] = {"R", "G", "B", "A"};
  StyImage *image = NULL;
  StyStatus status = sty_create_image(CANVAS_SIDE, CANVAS_SIDE, 4, names, 8, &image, error);
  if (status != STY_OK) {
    return status;
  }
  const float half = CANVAS_SIDE / 2.0f;
  for (int i = 0; i < CANVAS_PIXELS; i++) {
    Color c = canvas->color[i];
    float x = (float)(i % CANVAS_SIDE) + 0.5f - half, y = (float)(i / CANVAS_SIDE) + 0.5f - half;
    float outside = sqrtf(x * x + y * y) - half;
    float bleed = 3.0f + 6.0f * make_fractal_noise(x / 11.0f, y / 11.0f, 77u);
    image->data[i] = sqrtf(clamp_unit(c.r));
    image->data[i + CANVAS_PIXELS] = sqrtf(clamp_unit(c.g));
    image->data[i + 2 * CANVAS_PIXELS] = sqrtf(clamp_unit(c.b));
    image->data[i + 3 * CANVAS_PIXELS] = clamp_unit(bleed - outside);
  }
  *out = image;
  return STY_OK;
}

Color mix_from_bytes(int r, int g, int b) {
  float red = (float)r / 255.0f, green = (float)g / 255.0f, blue = (float)b / 255.0f;
  return (Color){red * red, green * green, blue * blue};
}

Color mix_colors(Color a, Color b, float share_of_b) {
  return (Color){a.r + (b.r - a.r) * share_of_b, a.g + (b.g - a.g) * share_of_b, a.b + (b.b - a.b) * share_of_b};
}

Color pick_from_ramp(const Color *stops, int count, float position) {
  float at = clamp_unit(position) * (float)(count - 1);
  int i = (int)at;
  if (i >= count - 1) {
    return stops[count - 1];
  }
  return mix_colors(stops[i], stops[i + 1], at - (float)i);
}

/* splitmix64 */
static uint64_t draw_bits(Random *random) {
  uint64_t z = random->state += 0x9E3779B97F4A7C15u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

float draw_unit(Random *random) { return (float)(draw_bits(random) >> 40) / 16777216.0f; }

float draw_between(Random *random, float low, float high) { return low + (high - low) * draw_unit(random); }

bool draw_chance(Random *random, float probability) { return draw_unit(random) < probability; }

void draw_place(Random *random, int k, float *x, float *y) {
  /* The two-dimensional golden ratio sequence. */
  double u = 0.5 + k * 0.7548776662466927, v = 0.5 + k * 0.5698402909980532;
  float span = CANVAS_SIDE + 2.0f * CANVAS_MARGIN;
  u -= (double)(int64_t)u;
  v -= (double)(int64_t)v;
  *x = (float)u * span - CANVAS_MARGIN + draw_between(random, -3.0f, 3.0f);
  *y = (float)v * span - CANVAS_MARGIN + draw_between(random, -3.0f, 3.0f);
}

static float hash_lattice(int32_t x, int32_t y, uint32_t seed) {
  uint32_t h = (uint32_t)x * 0x8DA6B343u + (uint32_t)y * 0xD8163841u + seed * 0xCB1AB31Fu;
  h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
  h = (h ^ (h >> 12)) * 0x297A2D39u;
  return (float)((h ^ (h >> 15)) >> 8) / 16777216.0f;
}

static int32_t round_down(float value) {
  int32_t whole = (int32_t)value;
  return (float)whole > value ? whole - 1 : whole;
}

float make_noise(float x, float y, uint32_t seed) {
  int32_t i = round_down(x), j = round_down(y);
  float u = ease(0.0f, 1.0f, x - (float)i), v = ease(0.0f, 1.0f, y - (float)j);
  float top = hash_lattice(i, j, seed) * (1.0f - u) + hash_lattice(i + 1, j, seed) * u;
  float bottom = hash_lattice(i, j + 1, seed) * (1.0f - u) + hash_lattice(i + 1, j + 1, seed) * u;
  return top * (1.0f - v) + bottom * v;
}

float make_fractal_noise(float x, float y, uint32_t seed) {
  return 0.55f * make_noise(x, y, seed) + 0.30f * make_noise(x * 2.1f, y * 2.1f, seed + 1u) +
         0.15f * make_noise(x * 4.3f, y * 4.3f, seed + 2u);
}
