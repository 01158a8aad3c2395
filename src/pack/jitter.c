/* Jitter tables. Blue noise by void and cluster: R. Ulichney, "The void-and-cluster method for dither array
 * generation", SPIE 1913, 1993; its tightest cluster of the later half is the largest void of what is left, as the
 * energies of both add up to a constant. */
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "stylut/pack.h"

enum {
  SIDE = STY_JITTER_SIZE,
  PLACES = SIDE * SIDE,
  REACH = 9,           /* where the Gaussian has no weight left */
  FIRST = PLACES / 10, /* of the pattern that is evened out before anything is ranked */
  MOST_MOVES = PLACES, /* of which a tenth suffices */
  NONE = -1
};

const char *const sty_noise_names[] = {"white", "blue", NULL};

/* A pattern of places taken, on a torus. Energies are whole numbers: sums in any order are the same. */
typedef struct Pattern {
  bool is_taken[PLACES];
  uint32_t energy[PLACES];
  uint32_t kernel[REACH + 1][REACH + 1];
  short least[SIDE], most[SIDE]; /* of each row: columns of the largest void and of the tightest cluster, or NONE */
} Pattern;

static int get_place(int x, int y) { return (y & (SIDE - 1)) * SIDE + (x & (SIDE - 1)); }

static void consider(Pattern *pattern, int x, int y) {
  const int place = get_place(x, y);
  short *extreme = pattern->is_taken[place] ? &pattern->most[y] : &pattern->least[y];
  const uint32_t energy = pattern->energy[place];
  const uint32_t held = *extreme < 0 ? 0 : pattern->energy[y * SIDE + *extreme];
  if (*extreme < 0 || (pattern->is_taken[place] ? energy > held : energy < held)) *extreme = (short)(place % SIDE);
}

static void search_row(Pattern *pattern, int y) {
  pattern->least[y] = pattern->most[y] = NONE;
  for (int x = 0; x < SIDE; x++) consider(pattern, x, y);
}

/* Whether a column is among those from `x` - REACH to `x` + REACH. */
static bool is_near(int column, int x) { return column != NONE && ((column - x + REACH) & (SIDE - 1)) <= 2 * REACH; }

/* After a change around column `x`: what lies elsewhere stays as good as it was. */
static void update_row(Pattern *pattern, int x, int y) {
  if (is_near(pattern->least[y], x) || is_near(pattern->most[y], x)) {
    search_row(pattern, y);
    return;
  }
  for (int dx = -REACH; dx <= REACH; dx++) consider(pattern, x + dx, y);
}

static void spread(Pattern *pattern, int place, bool takes) {
  const int x = place % SIDE, y = place / SIDE;
  for (int dy = -REACH; dy <= REACH; dy++)
    for (int dx = -REACH; dx <= REACH; dx++) {
      const uint32_t weight = pattern->kernel[abs(dy)][abs(dx)];
      pattern->energy[get_place(x + dx, y + dy)] += takes ? weight : -weight;
    }
}

static void change(Pattern *pattern, int place, bool takes) {
  pattern->is_taken[place] = takes;
  spread(pattern, place, takes);
  for (int dy = -REACH; dy <= REACH; dy++) update_row(pattern, place % SIDE, (place / SIDE + dy) & (SIDE - 1));
}

static int find_void(const Pattern *pattern) {
  int best = NONE;
  for (int y = 0; y < SIDE; y++) {
    const int place = y * SIDE + pattern->least[y];
    if (pattern->least[y] != NONE && (best == NONE || pattern->energy[place] < pattern->energy[best])) best = place;
  }
  return best;
}

static int find_cluster(const Pattern *pattern) {
  int best = NONE;
  for (int y = 0; y < SIDE; y++) {
    const int place = y * SIDE + pattern->most[y];
    if (pattern->most[y] != NONE && (best == NONE || pattern->energy[place] > pattern->energy[best])) best = place;
  }
  return best;
}

/* Low bits are drawn, so that ties aren't decided by the order of places. */
static void begin_pattern(Pattern *pattern, uint64_t *seed) {
  const double sigma = 1.9, scale = 1 << 24;
  memset(pattern, 0, sizeof *pattern);
  for (int y = 0; y <= REACH; y++)
    for (int x = 0; x <= REACH; x++)
      pattern->kernel[y][x] = (uint32_t)(scale * exp(-(x * x + y * y) / (2 * sigma * sigma)) + 0.5);
  for (int i = 0; i < PLACES; i++) pattern->energy[i] = (uint32_t)(sty_draw_bits(seed) >> 56);
  for (int taken = 0; taken < FIRST;) {
    const int place = (int)(sty_draw_bits(seed) >> 48);
    if (pattern->is_taken[place]) continue;
    pattern->is_taken[place] = true;
    spread(pattern, place, true);
    taken++;
  }
  for (int y = 0; y < SIDE; y++) search_row(pattern, y);
}

/* Moves the tightest cluster into the largest void until that is where it came from. */
static void even_out(Pattern *pattern) {
  for (int move = 0; move < MOST_MOVES; move++) {
    const int from = find_cluster(pattern);
    change(pattern, from, false);
    const int to = find_void(pattern);
    change(pattern, to, true);
    if (to == from) return;
  }
}

static uint8_t to_jitter(int rank) { return (uint8_t)(rank * 255 / PLACES); }

/* One channel of a table, every second byte: the evened pattern is taken down again, and filled up. */
static void rank_places(Pattern patterns[2], uint64_t seed, uint8_t *out) {
  Pattern *pattern = &patterns[0], *evened = &patterns[1];
  begin_pattern(pattern, &seed);
  even_out(pattern);
  *evened = *pattern;
  for (int rank = FIRST - 1; rank >= 0; rank--) {
    const int place = find_cluster(pattern);
    out[2 * place] = to_jitter(rank);
    change(pattern, place, false);
  }
  for (int rank = FIRST; rank < PLACES; rank++) {
    const int place = find_void(evened);
    out[2 * place] = to_jitter(rank);
    change(evened, place, true);
  }
}

void sty_make_jitter(uint64_t seed, uint8_t *out) {
  for (int i = 0; i < STY_JITTER_BYTES; i++) out[i] = (uint8_t)((sty_draw_bits(&seed) >> 32) * 255 >> 32);
}

typedef struct Tables {
  StyNoise noise;
  uint64_t seed;
  uint8_t *out;
} Tables;

/* The first is that of the seed itself. */
static uint64_t get_table_seed(const Tables *tables, long table) {
  return table ? sty_mix_bits(tables->seed + (uint64_t)table) : tables->seed;
}

static StyStatus make_channel(void *context, long i, StyError *error) {
  const Tables *tables = context;
  const long table = i / 2, channel = i % 2;
  uint8_t *out = tables->out + table * STY_JITTER_BYTES;
  const uint64_t seed = get_table_seed(tables, table);
  if (tables->noise == STY_NOISE_WHITE) {
    if (channel == 0) sty_make_jitter(seed, out);
    return STY_OK;
  }
  Pattern *patterns = malloc(2 * sizeof *patterns);
  if (!patterns) return sty_fail_memory(error, "jitter", 2 * sizeof *patterns);
  rank_places(patterns, sty_mix_bits(seed) + (uint64_t)channel, out + channel);
  free(patterns);
  return STY_OK;
}

StyStatus sty_make_jitters(StyNoise noise, uint64_t seed, int count, const StyRun *run, uint8_t *out, StyError *error) {
  return sty_parallel_for(run, 2L * count, make_channel, &(Tables){noise, seed, out}, error);
}
