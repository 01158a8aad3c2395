/* A torus that turns and moves, lit, eight frames: what a renderer does for every frame with libstylut_rt alone.
 * Usage: animate_runtime BUNDLE > strip.ppm (the frames one below the other). Wears style 1; the more lightings that
 * has, the more its light shows. */
#include <math.h>
#include <stdbool.h>

#include "read_bundle.h"

enum { SIDE = 192, FRAMES = 8, BANDS = 4, TORUS = 1 };

typedef struct Buffers {
  uint8_t guide[4 * SIDE * SIDE], luma[SIDE * SIDE], picture[4 * SIDE * SIDE];
  float fine[2 * SIDE * SIDE], depth[SIDE * SIDE];
  uint16_t objects[SIDE * SIDE];
  StyMatch matches[SIDE * SIDE];
} Buffers;

/* ---- the renderer ---- */

static const double ring = 48, tube = 21; /* radii, pixels */

/* How far (x, y, z) lies from a torus tilted by `tilt`, and its normal there. */
static double measure_torus(const double p[3], double tilt, double normal[3]) {
  const double c = cos(tilt), s = sin(tilt), up = c * p[1] - s * p[2], deep = s * p[1] + c * p[2];
  const double around = hypot(p[0], deep), out = around - ring, distance = hypot(out, up);
  if (distance > 0 && around > 0) {
    const double local[3] = {out * p[0] / around, up, out * deep / around};
    normal[0] = local[0] / distance;
    normal[1] = (c * local[1] + s * local[2]) / distance;
    normal[2] = (c * local[2] - s * local[1]) / distance;
  }
  return distance - tube;
}

/* Follows the ray of a pixel that lies (x, y) from the torus' middle, y up. */
static bool hit_torus(double x, double y, double tilt, double *depth, double normal[3]) {
  double p[3] = {x, y, ring + tube + 1};
  for (int step = 0; step < 100 && p[2] > -(ring + tube + 1); step++) {
    const double distance = measure_torus(p, tilt, normal);
    if (distance < 0.01) return *depth = -p[2], true;
    p[2] -= distance;
  }
  return false;
}

static uint8_t to_byte(double unit) { return (uint8_t)(unit * 255 + 0.5); }

static void draw_pixel(Buffers *b, size_t i, double x, double y, double tilt) {
  double n[3] = {0, 0, 1}, depth;
  b->objects[i] = 0;
  b->guide[4 * i + 3] = 0;
  if (!hit_torus(x, y, tilt, &depth, n)) return;
  b->objects[i] = TORUS;
  b->depth[i] = (float)depth;
  b->luma[i] = to_byte(fmax(0, 0.5 * n[0] + 0.7 * n[1] + 0.5 * n[2]));
  for (size_t c = 0; c < 3; c++) b->guide[4 * i + c] = to_byte(n[c] / 2 + 0.5);
  for (size_t c = 0; c < 2; c++) b->fine[2 * i + c] = (float)n[c];
  b->guide[4 * i + 3] = 255;
}

/* ---- the style ---- */

/* Seeds last as long as their jitter table: found anew only when the frame asks for another. The torus never reaches
 * beyond the area, whose middle is its anchor. */
static void update_seeds(const StyBundle *bundle, int number, StySeeds *seeds) {
  static StySeedOffset offsets[STY_SEED_LEVELS * SIDE * SIDE];
  const StyRect area = {-SIDE / 2, -SIDE / 2, SIDE / 2, SIDE / 2};
  StySeeds wanted;
  require(sty_plan_seeds(bundle, 1, number, area, offsets, &wanted));
  if (seeds->offsets && seeds->table == wanted.table) return;
  *seeds = wanted;
  require(sty_fill_seeds(bundle, seeds, area.y0, area.y1, STY_PATH_BEST));
}

static StyRect get_band(int i) { return (StyRect){0, SIDE * i / BANDS, SIDE, SIDE * (i + 1) / BANDS}; }

/* Bands may be worked on by as many threads as you have; all matches are there before the first band is blended. */
static void stylize(const StyBundle *bundle, const StyFrame *frame, Buffers *b) {
  for (int i = 0; i < BANDS; i++) require(sty_transfer_frame(bundle, frame, get_band(i), b->matches));
  for (int i = 0; i < BANDS; i++) require(sty_blend_frame(bundle, frame, get_band(i), b->matches, 8, b->picture));
}

static void draw_frame(const StyBundle *bundle, int number, Buffers *b, StySeeds *seeds) {
  const int x = SIDE / 2 - 10 + 3 * number, y = SIDE / 2 + 8 - 2 * number;
  for (int i = 0; i < SIDE * SIDE; i++)
    draw_pixel(b, (size_t)i, i % SIDE + 0.5 - x, y - i / SIDE - 0.5, 0.7 + 0.08 * number);
  const int32_t anchors[2 * (TORUS + 1)] = {0, 0, x, y}; /* strokes go where the torus goes */
  const int drawn = number / 2;                          /* on twos: a new table every second frame */
  update_seeds(bundle, drawn, seeds);
  const StyFrame frame = {.width = SIDE,
                          .height = SIDE,
                          .guide = b->guide,
                          .fine = b->fine,
                          .depth = b->depth,
                          .style = 1,
                          .objects = b->objects,
                          .luma = b->luma,
                          .anchors = anchors,
                          .anchor_count = TORUS + 1,
                          .number = drawn,
                          .seeds = seeds,
                          .seeds_count = 1};
  stylize(bundle, &frame, b);
}

int main(int argc, char **argv) {
  static Buffers buffers;
  StyBlob files[STY_BUNDLE_FILES];
  StySeeds seeds = {.offsets = NULL};
  const StyBundle bundle = open_bundle(argc > 1 ? argv[1] : ".", files);
  printf("P6 %d %d 255\n", SIDE, SIDE * FRAMES);
  for (int number = 0; number < FRAMES; number++) {
    draw_frame(&bundle, number, &buffers, &seeds);
    for (int i = 0; i < SIDE * SIDE; i++) fwrite(buffers.picture + 4 * i, 1, 3, stdout);
  }
  close_files(files);
  return 0;
}
