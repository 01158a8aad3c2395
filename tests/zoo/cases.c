#include "cases.h"

#include <math.h>

#include "base/random.h"
#include "lut/engine.h"

/* ---- drawing ------------------------------------------------------------------ */

/* -1 .. 1, the same for a pixel each time; `k` numbers the draws of one pixel. */
static double draw_signed(const ZooPixel *pixel, int k) {
  return (double)(sty_mix_bits(2 * (uint64_t)pixel->index + (uint64_t)k + 1) >> 11) * 0x1p-52 - 1;
}

static void get_place(const ZooPixel *pixel, float g[2]) {
  g[0] = (float)(2 * pixel->x + 1 - pixel->width) / (float)pixel->width;
  g[1] = (float)(pixel->height - 2 * pixel->y - 1) / (float)pixel->height;
}

static bool draw_sphere(const ZooPixel *pixel, float g[2]) {
  get_place(pixel, g);
  return g[0] * g[0] + g[1] * g[1] <= 1;
}

static bool draw_half_sphere(const ZooPixel *pixel, float g[2]) { return draw_sphere(pixel, g) && g[0] < 0; }

static bool draw_equal(const ZooPixel *pixel, float g[2]) {
  (void)pixel;
  g[0] = 0.3f;
  g[1] = 0.2f;
  return true;
}

static bool draw_nothing(const ZooPixel *pixel, float g[2]) { return draw_equal(pixel, g) && false; }

static bool draw_one(const ZooPixel *pixel, float g[2]) {
  return draw_equal(pixel, g) && pixel->index == pixel->count / 2;
}

static bool draw_two_values(const ZooPixel *pixel, float g[2]) {
  draw_equal(pixel, g);
  if (pixel->x < pixel->width / 2) g[0] = -0.4f;
  return true;
}

static bool draw_two(const ZooPixel *pixel, float g[2]) {
  draw_two_values(pixel, g);
  return pixel->index == pixel->count / 2 || pixel->index == pixel->count / 2 + (size_t)pixel->width / 2;
}

/* Three faces about the corner that looks at the viewer. */
static bool draw_cube(const ZooPixel *pixel, float g[2]) {
  float place[2];
  get_place(pixel, place);
  const bool top = place[1] > 0.57735f * fabsf(place[0]);
  g[0] = top ? 0.0f : place[0] < 0 ? -0.70711f : 0.70711f;
  g[1] = top ? 0.8165f : -0.40825f;
  return place[0] * place[0] + place[1] * place[1] < 0.8f;
}

static bool draw_cylinder(const ZooPixel *pixel, float g[2]) {
  get_place(pixel, g);
  g[1] = 0;
  return true;
}

static bool draw_plane(const ZooPixel *pixel, float g[2]) {
  (void)pixel;
  g[0] = g[1] = 0;
  return true;
}

static bool draw_circle(const ZooPixel *pixel, float g[2]) {
  const double angle = 2 * M_PI * (double)pixel->index / (double)pixel->count;
  g[0] = (float)cos(angle);
  g[1] = (float)sin(angle);
  return true;
}

static bool draw_cluster(const ZooPixel *pixel, float g[2]) {
  g[0] = (float)(0.3 + 0.5e-5 * draw_signed(pixel, 0));
  g[1] = (float)(0.2 + 0.5e-5 * draw_signed(pixel, 1));
  return true;
}

static bool draw_two_clusters(const ZooPixel *pixel, float g[2]) {
  const double side = pixel->index % 2 ? 1 : -1;
  g[0] = (float)(0.7 * side + 1e-3 * draw_signed(pixel, 0));
  g[1] = (float)(0.6 * side + 1e-3 * draw_signed(pixel, 1));
  return true;
}

/* 8 steps to 1: the centres of a table of 16 lie exactly between four of them. */
static bool draw_lattice(const ZooPixel *pixel, float g[2]) {
  g[0] = (float)(pixel->x - pixel->width / 2) / 8.0f;
  g[1] = (float)(pixel->y - pixel->height / 2) / 8.0f;
  return true;
}

static bool draw_outside(const ZooPixel *pixel, float g[2]) {
  get_place(pixel, g);
  g[0] *= 1.5f;
  g[1] *= 1.5f;
  return true;
}

static bool draw_far(const ZooPixel *pixel, float g[2]) {
  for (int k = 0; k < 2; k++) g[k] = (float)(1000 * draw_signed(pixel, k));
  return true;
}

/* From 2^-127 down to the least there is, and beyond. */
static bool draw_denormals(const ZooPixel *pixel, float g[2]) {
  for (int k = 0; k < 2; k++) g[k] = (float)ldexp(draw_signed(pixel, k), -127 - (pixel->x + pixel->y) % 24);
  return true;
}

static bool draw_zeros(const ZooPixel *pixel, float g[2]) {
  g[0] = pixel->x % 2 ? -0.0f : 0.0f;
  g[1] = pixel->y % 3 ? pixel->y % 3 == 1 ? -0.0f : 0.0f : 0.5f;
  return true;
}

/* Beyond the disc, and so little off an axis that it vanishes when the value is
 * shortened to the rim: by angle these are two values, not four. */
static bool draw_vanishing(const ZooPixel *pixel, float g[2]) {
  static const float sides[] = {0.0f, 0x1p-149f, -0x1p-149f, -0.0f};
  g[0] = sides[pixel->index % 4];
  g[1] = pixel->y % 2 ? 900.0f : -900.0f;
  return true;
}

/* As seeds lie in a sunflower: no two alike, all over the disc. */
static bool draw_sunflower(const ZooPixel *pixel, float g[2]) {
  const double radius = sqrt(((double)pixel->index + 0.5) / (double)pixel->count), angle = (double)pixel->index * 2.4;
  g[0] = (float)(radius * cos(angle));
  g[1] = (float)(radius * sin(angle));
  return true;
}

/* A sphere with one pixel that has no answer. */
static bool draw_spoilt_sphere(const ZooPixel *pixel, float g[2], float value) {
  const bool covered = draw_sphere(pixel, g);
  if (pixel->index == pixel->count / 3 + (size_t)pixel->width / 2) g[pixel->width % 2] = value;
  return covered;
}

static bool draw_nan(const ZooPixel *pixel, float g[2]) { return draw_spoilt_sphere(pixel, g, NAN); }
static bool draw_infinity(const ZooPixel *pixel, float g[2]) { return draw_spoilt_sphere(pixel, g, INFINITY); }
static bool draw_minus_infinity(const ZooPixel *pixel, float g[2]) { return draw_spoilt_sphere(pixel, g, -INFINITY); }
static bool draw_huge(const ZooPixel *pixel, float g[2]) { return draw_spoilt_sphere(pixel, g, 3e38f); }
static bool draw_minus_huge(const ZooPixel *pixel, float g[2]) { return draw_spoilt_sphere(pixel, g, -3e38f); }
static bool draw_too_far(const ZooPixel *pixel, float g[2]) { return draw_spoilt_sphere(pixel, g, 1000.1f); }

static bool draw_all_nan(const ZooPixel *pixel, float g[2]) {
  (void)pixel;
  g[0] = g[1] = NAN;
  return true;
}

static bool draw_all_huge(const ZooPixel *pixel, float g[2]) {
  for (int k = 0; k < 2; k++) g[k] = draw_signed(pixel, k) < 0 ? -3e38f : 3e38f;
  return true;
}

/* ---- the cases ---------------------------------------------------------------- */

static const float nan_asked[] = {NAN, 0}, infinity_asked[] = {0, INFINITY}, huge_asked[] = {-3e38f, 3e38f};

#define SPOILT "expected a finite value within 1000"

const ZooCase zoo_cases[] = {
    {"empty mask", "no pixel is covered", 64, 64, 64, 32, draw_nothing, "found no covered pixel", NULL},
    {"one pixel", "one of 64 x 64 is covered", 64, 64, 64, 32, draw_one, NULL, NULL},
    {"two pixels", "two of 64 x 64 are covered", 64, 64, 64, 32, draw_two, NULL, NULL},
    {"all equal", "one value, 4,096 times", 64, 64, 64, 32, draw_equal, NULL, NULL},
    {"two values", "each 2,048 times", 64, 64, 64, 32, draw_two_values, NULL, NULL},
    {"cube", "three normals", 64, 64, 64, 32, draw_cube, NULL, NULL},
    {"cylinder", "a line in the domain, each value 64 times", 64, 64, 64, 32, draw_cylinder, NULL, NULL},
    {"plane", "everything faces the viewer: (0, 0)", 64, 64, 64, 32, draw_plane, NULL, NULL},
    {"sphere", "fills the picture", 64, 64, 64, 32, draw_sphere, NULL, NULL},
    {"half a sphere", "its left half", 64, 64, 64, 32, draw_half_sphere, NULL, NULL},
    {"unit circle", "4,096 points on it, evenly", 64, 64, 64, 32, draw_circle, NULL, NULL},
    {"cluster", "4,096 points within 1e-5", 64, 64, 64, 32, draw_cluster, NULL, NULL},
    {"two clusters", "of width 2e-3, far apart", 64, 64, 64, 32, draw_two_clusters, NULL, NULL},
    {"lattice", "texels lie exactly between four values", 17, 17, 16, 32, draw_lattice, NULL, NULL},
    {"outside the disc", "values up to 1.5", 64, 64, 64, 32, draw_outside, NULL, NULL},
    {"far outside", "values up to 1,000", 64, 64, 64, 32, draw_far, NULL, NULL},
    {"denormals", "values below 1e-38", 64, 64, 64, 32, draw_denormals, NULL, NULL},
    {"-0", "zeros of both signs, and (0, 0.5)", 64, 64, 64, 32, draw_zeros, NULL, NULL},
    {"vanishing", "the least float beside 900", 64, 64, 64, 32, draw_vanishing, NULL, NULL},
    {"8 bit", "a sphere of bytes", 64, 64, 64, 8, draw_sphere, NULL, NULL},
    {"10 bit", "a sphere in steps of 2/1023", 64, 64, 64, 10, draw_sphere, NULL, NULL},
    {"16 bit", "a sphere in steps of 2/65535", 64, 64, 64, 16, draw_sphere, NULL, NULL},
    {"8 bit, few values", "17 x 17 bytes, each many times", 64, 64, 64, 4, draw_sphere, NULL, NULL},
    {"1 x 4,096", "a single column", 1, 4096, 64, 32, draw_sunflower, NULL, NULL},
    {"65,536 x 1", "a single row, the longest there may be", 65536, 1, 32, 32, draw_sunflower, NULL, NULL},
    {"a million duplicates", "one value", 1000, 1000, 16, 32, draw_equal, NULL, NULL},
    {"a million on the circle", "evenly", 1000, 1000, 16, 32, draw_circle, NULL, NULL},
    {"a million in a cluster", "within 1e-5: many are the same", 1000, 1000, 16, 32, draw_cluster, NULL, NULL},
    {"a million in two clusters", "of width 2e-3", 1000, 1000, 16, 32, draw_two_clusters, NULL, NULL},
    {"one NaN", "a sphere with one pixel of it", 64, 64, 64, 32, draw_nan, SPOILT, NULL},
    {"all NaN", "nothing else", 64, 64, 64, 32, draw_all_nan, SPOILT, NULL},
    {"one +inf", "a sphere with one pixel of it", 64, 64, 64, 32, draw_infinity, SPOILT, NULL},
    {"one -inf", "the same", 64, 64, 64, 32, draw_minus_infinity, SPOILT, NULL},
    {"one +3e38", "the same", 64, 64, 64, 32, draw_huge, SPOILT, NULL},
    {"one -3e38", "the same", 64, 64, 64, 32, draw_minus_huge, SPOILT, NULL},
    {"all +-3e38", "nothing else", 64, 64, 64, 32, draw_all_huge, SPOILT, NULL},
    {"a million of +-3e38", "nothing else", 1000, 1000, 16, 32, draw_all_huge, SPOILT, NULL},
    {"one 1000.1", "a sphere with one pixel just too far", 64, 64, 64, 32, draw_too_far, SPOILT, NULL},
    {"NaN is asked for", "of a sphere", 64, 64, 64, 32, draw_sphere, SPOILT, nan_asked},
    {"inf is asked for", "of a sphere", 64, 64, 64, 32, draw_sphere, SPOILT, infinity_asked},
    {"3e38 is asked for", "of a sphere", 64, 64, 64, 32, draw_sphere, SPOILT, huge_asked},
    {NULL, NULL, 0, 0, 0, 0, NULL, NULL, NULL},
};

/* ---- guides ------------------------------------------------------------------- */

/* The nearest value of so many bits. Four are every 17th byte. */
static float round_to_bits(float value, int bits) {
  if (bits == 32) return value;
  const int top = (1 << bits) - 1, whole = bits == 4 ? 255 : top;
  const int level = (int)lround(((double)value + 1) / 2 * top) * (whole / top);
  return (float)(2 * level - whole) / (float)whole;
}

StyImage *make_zoo_guide(const ZooCase *zoo, bool noisy) {
  static const char *const names[] = {"A", "normal.X", "normal.Y", "normal.Z"};
  StyImage *guide = NULL;
  const int bits = zoo->bits <= 8 ? 8 : zoo->bits <= 16 ? 16 : 32;
  if (sty_create_image(zoo->width, zoo->height, 4, names, bits, &guide, NULL)) return NULL;
  const size_t count = sty_count_pixels(guide), noise = count * 5 / 8 + (size_t)zoo->width / 2;
  for (size_t i = 0; i < count; i++) {
    const ZooPixel pixel = {
        (int)(i % (size_t)zoo->width), (int)(i / (size_t)zoo->width), zoo->width, zoo->height, i, count};
    float g[2] = {0.437f, -0.291f};
    const bool covered = (noisy && i == noise % count) || zoo->draw(&pixel, g);
    if (!covered) continue;
    for (int k = 0; k < 2; k++) g[k] = round_to_bits(g[k], zoo->bits);
    guide->data[i] = 1;
    guide->data[count + i] = g[0];
    guide->data[2 * count + i] = g[1];
    guide->data[3 * count + i] = sty_get_height(g[0], g[1]);
  }
  return guide;
}

bool is_zoo_refused(const ZooCase *zoo, bool noisy) { return zoo->refusal && !(noisy && zoo->draw == draw_nothing); }
