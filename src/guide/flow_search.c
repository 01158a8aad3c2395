#include "guide/flow_search.h"

#include <float.h>
#include <math.h>

static size_t get_index(const StyFlowLevel *level, int x, int y) {
  return (size_t)y * (size_t)level->pictures[0].width + (size_t)x;
}

/* ---- what the coarser level knows ----------------------------------------------- */

/* The pixels of the coarser level around a pixel, those that know a motion. */
typedef struct Neighbours {
  int count;
  StyFlowVector vectors[4]; /* in pixels of this level */
  float weights[4];         /* bilinear */
  bool alike[4];            /* of this pixel's colour */
} Neighbours;

static bool is_alike(const StyFlowLevel *level, const StyFlowLevel *coarser, const StyFlowRules *rules,
                     const int at[4]) {
  const StyLanes a = *sty_get_flow_pixel(&level->pictures[0], at[0], at[1]);
  const StyLanes b = *sty_get_flow_pixel(&coarser->pictures[0], at[2], at[3]);
  return sty_add_lanes(sty_get_magnitude(a - b)) * 255 <= rules->threshold * (float)rules->lanes;
}

static void find_neighbours(const StyFlowLevel *level, const StyFlowLevel *coarser, const StyFlowRules *rules, int x,
                            int y, Neighbours *out) {
  out->count = 0;
  for (int k = 0; coarser && k < 4; k++) {
    const int nx = x / 2 + (k & 1 ? (x & 1 ? 1 : -1) : 0), ny = y / 2 + (k & 2 ? (y & 1 ? 1 : -1) : 0);
    if (nx < 0 || ny < 0 || nx >= coarser->pictures[0].width || ny >= coarser->pictures[0].height) continue;
    const StyFlowVector *vector = &coarser->vectors[get_index(coarser, nx, ny)];
    if (!vector->origin) continue;
    out->vectors[out->count] = (StyFlowVector){2 * vector->u, 2 * vector->v, vector->origin};
    out->weights[out->count] = (k & 1 ? 0.25f : 0.75f) * (k & 2 ? 0.25f : 0.75f);
    out->alike[out->count++] = is_alike(level, coarser, rules, (const int[4]){x, y, nx, ny});
  }
}

/* Their mean, of those alike if there are any. As published, others don't count. */
static StyFlowVector average_neighbours(const Neighbours *n, StyFlowMethod method) {
  float u = 0, v = 0, weight = 0;
  int origin = 0, alike = 0;
  for (int i = 0; i < n->count; i++) alike += n->alike[i];
  for (int i = 0; i < n->count; i++) {
    if (!n->alike[i] && (alike || method == STY_FLOW_PUBLISHED)) continue;
    u += n->weights[i] * n->vectors[i].u;
    v += n->weights[i] * n->vectors[i].v;
    weight += n->weights[i];
    if (!origin || n->vectors[i].origin < origin) origin = n->vectors[i].origin;
  }
  return origin ? (StyFlowVector){u / weight, v / weight, origin} : (StyFlowVector){0, 0, 0};
}

/* ---- the window search ---------------------------------------------------------- */

typedef struct Match {
  int u, v;
  float mean; /* difference of the windows */
} Match;

/* The first of equals stays. */
static void try_offset(const StyFlowLevel *level, const StyFlowRules *rules, int x, int y, int u, int v, Match *best) {
  const StyFlowPicture *previous = &level->pictures[1];
  if (u == best->u && v == best->v && best->mean < FLT_MAX) return;
  if (x + u < 0 || y + v < 0 || x + u >= previous->width || y + v >= previous->height) return;
  const float mean = sty_measure_flow_offset(level, rules, x, y, u, v, best->mean);
  if (mean < best->mean) *best = (Match){u, v, mean};
}

/* Figure 4.3: a pixel on, in 8 directions. Whether one of them is better. */
static bool try_directions(const StyFlowLevel *level, const StyFlowRules *rules, int x, int y, Match *best) {
  static const int directions[8][2] = {{0, -1}, {-1, 0}, {1, 0}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
  const int u = best->u, v = best->v;
  for (int d = 0; d < 8; d++) try_offset(level, rules, x, y, u + directions[d][0], v + directions[d][1], best);
  return best->u != u || best->v != v;
}

static void try_vector(const StyFlowLevel *level, const StyFlowRules *rules, int x, int y, const StyFlowVector *vector,
                       Match *best) {
  try_offset(level, rules, x, y, (int)lrintf(vector->u), (int)lrintf(vector->v), best);
}

/* Around rest first, so that patterns which repeat move no further than they must; then around the
 * best so far and what the coarser level found: the mean, and each of its pixels, since over the border
 * of two motions, or beside a wrong one, the mean is neither's. */
static StyFlowVector search_from_coarser(const StyFlowLevel *level, const StyFlowRules *rules, int x, int y,
                                         const Neighbours *neighbours) {
  enum { STEPS = 2 };
  const StyFlowVector prior = average_neighbours(neighbours, rules->method);
  if (sty_measure_flow_texture(level, rules, x, y) <= rules->tolerance) return prior;
  /* What has left the picture can only find something else there. */
  if (!sty_is_inside(&level->pictures[1], (float)x + prior.u, (float)y + prior.v)) return prior;
  Match best = {0, 0, FLT_MAX};
  try_offset(level, rules, x, y, 0, 0, &best);
  try_directions(level, rules, x, y, &best);
  try_vector(level, rules, x, y, &prior, &best);
  for (int i = 0; i < neighbours->count; i++) try_vector(level, rules, x, y, &neighbours->vectors[i], &best);
  for (int step = 0; step < STEPS && try_directions(level, rules, x, y, &best);) step++;
  StyFlowVector vector = {(float)best.u, (float)best.v, level->index + 1};
  return sty_refine_flow(level, rules, x, y, &vector) <= rules->threshold ? vector : prior;
}

/* Around rest; averaged with the coarser level's motion, or replaced by it. */
static StyFlowVector search_from_rest(const StyFlowLevel *level, const StyFlowRules *rules, int x, int y,
                                      const Neighbours *neighbours) {
  const StyFlowVector prior = average_neighbours(neighbours, rules->method);
  if (sty_measure_flow_texture(level, rules, x, y) <= rules->tolerance) return prior;
  Match best = {0, 0, FLT_MAX};
  try_offset(level, rules, x, y, 0, 0, &best);
  try_directions(level, rules, x, y, &best);
  if (best.mean > rules->threshold) return prior;
  const float u = (float)best.u, v = (float)best.v;
  if (!prior.origin) return (StyFlowVector){u, v, level->index + 1};
  return (StyFlowVector){0.5f * (u + prior.u), 0.5f * (v + prior.v), level->index + 1};
}

void sty_search_flow_row(const StyFlowLevel *level, const StyFlowLevel *coarser, const StyFlowRules *rules, int y) {
  for (int x = 0; x < level->pictures[0].width; x++) {
    const size_t p = get_index(level, x, y);
    if (!level->covered[p]) continue;
    Neighbours neighbours;
    find_neighbours(level, coarser, rules, x, y, &neighbours);
    level->vectors[p] = rules->method == STY_FLOW_PUBLISHED ? search_from_rest(level, rules, x, y, &neighbours)
                                                            : search_from_coarser(level, rules, x, y, &neighbours);
  }
}

/* ---- the median ----------------------------------------------------------------- */

static void insert_sorted(float *sorted, int count, float value) {
  int i = count;
  for (; i > 0 && sorted[i - 1] > value; i--) sorted[i] = sorted[i - 1];
  sorted[i] = value;
}

void sty_smooth_flow_row(const StyFlowLevel *level, int y) {
  const int width = level->pictures[0].width, height = level->pictures[0].height;
  for (int x = 0; x < width; x++) {
    const size_t p = get_index(level, x, y);
    level->spare[p] = level->vectors[p];
    if (!level->vectors[p].origin) continue;
    float u[9], v[9];
    int count = 0;
    for (int j = y > 0 ? y - 1 : 0; j <= y + 1 && j < height; j++)
      for (int i = x > 0 ? x - 1 : 0; i <= x + 1 && i < width; i++) {
        const StyFlowVector *vector = &level->vectors[get_index(level, i, j)];
        if (!vector->origin) continue;
        insert_sorted(u, count, vector->u);
        insert_sorted(v, count++, vector->v);
      }
    level->spare[p].u = u[(count - 1) / 2];
    level->spare[p].v = v[(count - 1) / 2];
  }
}
