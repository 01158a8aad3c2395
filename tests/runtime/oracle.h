/* The formulas of runtime.h as they stand there, in doubles where they speak of fractions: what every path has to
 * agree with. */
#ifndef STYLUT_TESTS_ORACLE_H
#define STYLUT_TESTS_ORACLE_H

#include "fixture.h"

typedef struct Pair {
  int x, y;
} Pair;

/* A fraction in `unit`ths; the product is a float, as runtime.h has it. */
static inline int round_fraction(float fraction, int unit) {
  const float product = fraction * (float)unit;
  return (int)floor((double)product + 0.5);
}

static inline size_t get_index(const StyFrame *frame, int x, int y) {
  return (size_t)y * (size_t)frame->width + (size_t)x;
}

/* ---- look-up tables ---- */

/* Texel of a LUT's side that answers for `above` out of `range`, counted from the side's beginning. */
static inline int address(double above, double range, int side, unsigned flags) {
  const int texel =
      (int)(flags & STY_FLAG_UNORM8 ? floor(above * (side - 1) / range + 0.5) : floor(above * side / range));
  return texel < side ? texel : side - 1;
}

static inline double clamp_guide(float g) { return isnan(g) ? 0 : g < -1 ? -1 : g > 1 ? 1 : (double)g; }

/* LUT(guide at a frame's pixel) of a style. */
static inline Pair look_up(const Fixture *fixture, int style, const StyFrame *frame, int x, int y) {
  const size_t i = get_index(frame, x, y);
  const int side = fixture->lut_side;
  const unsigned flags = fixture->style[style].flags;
  int column, row;
  if (frame->fine) {
    column = address(clamp_guide(frame->fine[2 * i]) + 1, 2, side, flags);
    row = address(1 - clamp_guide(frame->fine[2 * i + 1]), 2, side, flags);
  } else {
    column = address(frame->guide[4 * i], 255, side, flags);
    row = address(255 - frame->guide[4 * i + 1], 255, side, flags);
  }
  const uint8_t *texel = fixture->texels[STY_BUNDLE_LUTS] + 4 * (((style - 1) * side + row) * side + column);
  const double u = texel[0] + 256 * texel[1], v = texel[2] + 256 * texel[3];
  return (Pair){(int)fmin(floor(u * fixture->width / 65535), fixture->width - 1),
                (int)fmin(floor(v * fixture->height / 65535), fixture->height - 1)};
}

/* A source pixel moved on by pixels of the picture. */
static inline Pair move_on(const Fixture *fixture, int style, const StyFrame *frame, Pair from, int dx, int dy) {
  const double s = (double)fixture->style[style].scale * pow(2, frame->resolution);
  return (Pair){(int)floor(from.x + dx / s), (int)floor(from.y + dy / s)};
}

/* ---- light ---- */

static inline int get_lighting_luma(const Fixture *fixture, int style, int lighting) {
  return round_fraction(fixture->style[style].luma[lighting], 255);
}

/* The lighting for a pixel's luminance. */
static inline int choose_lighting(const Fixture *fixture, int style, const StyFrame *frame, int x, int y) {
  if (!frame->luma) return 0;
  const int luma = frame->luma[get_index(frame, x, y)];
  int best = 0;
  for (int i = 1; i < fixture->style[style].layer_count; i++)
    if (abs(luma - get_lighting_luma(fixture, style, i)) < abs(luma - get_lighting_luma(fixture, style, best)))
      best = i;
  return best;
}

/* Whether a source pixel may stand at a frame's pixel. */
/* `tilt`: what the frame's guide is tilted by where pieces scatter. */
static inline bool is_accepted_tilted(const Fixture *fixture, int style, const StyFrame *frame, int x, int y,
                                      const int tilt[3], Pair candidate, int lighting) {
  const uint8_t *source = ask_source(fixture, style, candidate.x, candidate.y);
  if (!source) return false;
  const size_t i = get_index(frame, x, y);
  int error = 0, difference = 0;
  for (size_t c = 0; c < 3; c++) error += abs(source[c] - (frame->guide[4 * i + c] + tilt[c]));
  if (frame->luma) difference = abs(frame->luma[i] - get_lighting_luma(fixture, style, lighting));
  const int weight = round_fraction(fixture->style[style].luma_weight, 256);
  return 256 * error + weight * difference < 256 * fixture->style[style].threshold;
}

static inline bool is_accepted(const Fixture *fixture, int style, const StyFrame *frame, int x, int y, Pair candidate,
                               int lighting) {
  return is_accepted_tilted(fixture, style, frame, x, y, (const int[3]){0, 0, 0}, candidate, lighting);
}

/* ---- seeds ---- */

static inline int find_table(const Fixture *fixture, int style, int number) {
  const int period = fixture->style[style].jitter_period;
  return period == 0 ? 0 : (int)floor((double)number / period) % fixture->jitters;
}

/* The two bytes for a cell, or for any place; the table repeats. */
static inline const uint8_t *get_jitter(const Fixture *fixture, int table, int x, int y) {
  const int column = x - 256 * (int)floor(x / 256.0), row = y - 256 * (int)floor(y / 256.0);
  return fixture->texels[STY_BUNDLE_JITTER] + 2 * ((table * 256 + row) * 256 + column);
}

/* The nearest seed of a grid that begins at 0, 0. */
static inline Pair find_seed(const Fixture *fixture, int table, int amount, int x, int y, int h) {
  Pair nearest = {0, 0};
  double least = INFINITY;
  for (int dx = -1; dx <= 1; dx++)
    for (int dy = -1; dy <= 1; dy++) {
      const int bx = (int)floor((double)x / h) + dx, by = (int)floor((double)y / h) + dy;
      const uint8_t *j = get_jitter(fixture, table, bx, by);
      const Pair seed = {h * bx + (int)floor(h * j[0] * amount / (255.0 * 255)),
                         h * by + (int)floor(h * j[1] * amount / (255.0 * 255))};
      const double ex = seed.x - x, ey = seed.y - y;
      if (ex * ex + ey * ey < least) least = ex * ex + ey * ey, nearest = seed;
    }
  return nearest;
}

static inline int get_object(const StyFrame *frame, int x, int y) {
  return frame->objects ? frame->objects[get_index(frame, x, y)] : 0;
}

static inline Pair get_anchor(const StyFrame *frame, int x, int y) {
  const int object = get_object(frame, x, y);
  if (!frame->anchors || object >= frame->anchor_count) return (Pair){0, 0};
  return (Pair){frame->anchors[2 * object], frame->anchors[2 * object + 1]};
}

static inline bool is_in_frame(const StyFrame *frame, int x, int y) { return is_inside(get_all(frame), x, y); }

static inline bool is_covered(const StyFrame *frame, int x, int y) {
  return frame->guide[4 * get_index(frame, x, y) + 3] > 0;
}

/* ---- scatter ---- */

static inline bool is_flat(const StyFrame *frame, Pair seed, int h) {
  static const int sides[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
  const uint8_t *own = frame->guide + 4 * get_index(frame, seed.x, seed.y);
  for (int i = 0; i < 4; i++) {
    const int x = seed.x + sides[i][0] * h / 2, y = seed.y + sides[i][1] * h / 2;
    if (!is_in_frame(frame, x, y)) continue;
    if (frame->anchors && get_object(frame, x, y) != get_object(frame, seed.x, seed.y)) return false;
    const uint8_t *other = frame->guide + 4 * get_index(frame, x, y);
    if (other[3] == 0 || abs(own[0] - other[0]) + abs(own[1] - other[1]) + abs(own[2] - other[2]) > 2) return false;
  }
  return true;
}

static inline Pair scatter_star(const Fixture *fixture, int style, const StyFrame *frame, Pair star, Pair seed,
                                Pair anchor, int h, int tilt[3]) {
  const int scatter = fixture->style[style].scatter;
  if (h < 8 || !is_flat(frame, seed, h)) return star;
  const int table = find_table(fixture, style, frame->number);
  const uint8_t *j = get_jitter(fixture, table, seed.x - anchor.x + 128, seed.y - anchor.y + 128);
  const Pair moved = {star.x + (int)floor((2 * scatter + 1) * j[0] / 256.0) - scatter,
                      star.y + (int)floor((2 * scatter + 1) * j[1] / 256.0) - scatter};
  const uint8_t *from = ask_source(fixture, style, star.x, star.y), *to = ask_source(fixture, style, moved.x, moved.y);
  if (!from || !to) return star;
  for (int c = 0; c < 3; c++) tilt[c] = to[c] - from[c];
  return moved;
}

/* ---- matches ---- */

static const StyMatch no_match = {.x = STY_NO_SOURCE, .y = STY_NO_SOURCE, .level = STY_LEVEL_NONE};

static inline StyMatch make_match(Pair source, int level, int lighting, int style) {
  return (StyMatch){(uint16_t)source.x, (uint16_t)source.y, (uint8_t)level, (uint8_t)lighting, (uint8_t)(style - 1), 0};
}

/* LUT(guide at p) in the lighting nearest to p; what isn't stylized has none. */
static inline StyMatch expect_fallback(const Fixture *fixture, const StyFrame *frame, int x, int y) {
  const int style = ask_style(fixture, frame, x, y);
  if (!style) return no_match;
  return make_match(look_up(fixture, style, frame, x, y), STY_LEVEL_FALLBACK,
                    choose_lighting(fixture, style, frame, x, y), style);
}

static inline StyMatch expect_match(const Fixture *fixture, const StyFrame *frame, int x, int y) {
  const int style = ask_style(fixture, frame, x, y);
  if (!style) return no_match;
  const Pair anchor = get_anchor(frame, x, y);
  const int table = find_table(fixture, style, frame->number);
  const int amount = round_fraction(fixture->style[style].jitter_amount, 255);
  for (int level = fixture->style[style].top_level; level >= 0; level--) {
    const int h = 1 << level;
    Pair seed = find_seed(fixture, table, amount, x - anchor.x, y - anchor.y, h);
    seed = (Pair){seed.x + anchor.x, seed.y + anchor.y};
    if (!is_in_frame(frame, seed.x, seed.y) || !is_covered(frame, seed.x, seed.y)) continue;
    if (frame->anchors && get_object(frame, seed.x, seed.y) != get_object(frame, x, y)) continue;
    Pair star = look_up(fixture, style, frame, seed.x, seed.y);
    int tilt[3] = {0, 0, 0};
    star = scatter_star(fixture, style, frame, star, seed, anchor, h, tilt);
    const Pair candidate = move_on(fixture, style, frame, star, x - seed.x, y - seed.y);
    const int lighting = choose_lighting(fixture, style, frame, seed.x, seed.y);
    if (is_accepted_tilted(fixture, style, frame, x, y, tilt, candidate, lighting))
      return make_match(candidate, level, lighting, style);
  }
  return expect_fallback(fixture, frame, x, y);
}

static inline bool is_same(StyMatch a, StyMatch b) { return memcmp(&a, &b, sizeof a) == 0; }

/* What a pass must leave alone. */
static const StyMatch untouched = {12345, 54321, 77, 78, 79, 80};

/* A field of untouched matches in a block of exactly the frame's size. */
static inline StyMatch *make_matches(const StyFrame *frame) {
  const size_t pixels = (size_t)frame->width * (size_t)frame->height;
  StyMatch *matches = malloc(pixels * sizeof *matches);
  assert_non_null(matches);
  for (size_t i = 0; i < pixels; i++) matches[i] = untouched;
  return matches;
}

static inline void expect_same_match(const StyFrame *frame, int x, int y, StyMatch found, StyMatch wanted) {
  if (!is_same(found, wanted))
    fail_msg(
        "(%d, %d) of %dx%d: found %u %u level %u lighting %u style %u, expected %u %u level %u lighting %u style %u", x,
        y, frame->width, frame->height, found.x, found.y, found.level, found.layer, found.style, wanted.x, wanted.y,
        wanted.level, wanted.layer, wanted.style);
}

static inline Guides draw_guides(uint64_t *random) {
  static const int spreads[] = {1, 2, 4, 20, 100, 256}, holes[] = {0, 2, 10};
  const int spread = spreads[draw_below(random, 6)];
  return (Guides){draw_below(random, 257 - spread), spread, holes[draw_below(random, 3)]};
}

#endif
