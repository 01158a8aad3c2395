#include "guide/paths.h"

#include <math.h>
#include <string.h>

#include "base/sobol.h"
#include "scene/vector.h"

const StyPathOptions sty_default_paths = {64, 0};

/* Roulette begins at this surface: ways that end before are all that most of the light takes. */
enum { FIRST_ROULETTE = 4 };

/* ---- one way, from the eye ---- */

/* Light by the ways it came, as StyPathSamples has it of a block. */
typedef struct PathLight {
  double full[3], lde[3], lse[3], ld12e[3], lie[3];
} PathLight;

/* Lanes of a block walk side by side, each the ways of its own pixel one after the other. */
typedef struct Walk {
  uint64_t key;       /* of the pixel */
  uint32_t sample;    /* which of its ways this is */
  int surface;        /* how many there are from the eye to here */
  double weight[3];   /* of what comes from here, at the eye */
  bool is_diffuse[2]; /* what the first two surfaces from the eye do */
  PathLight sum;
} Walk;

static void add_weighted(const Walk *walk, const double light[3], double sum[3]) {
  for (int k = 0; k < 3; k++) sum[k] += walk->weight[k] * light[k];
}

static void note_lobe(Walk *walk, bool is_diffuse) {
  if (walk->surface <= 2) walk->is_diffuse[walk->surface - 1] = is_diffuse;
}

/* Light that reaches the eye by this surface, whose lobe is noted. */
static void gather(Walk *walk, const double light[3]) {
  const bool first = walk->is_diffuse[0], both = first && walk->is_diffuse[1];
  add_weighted(walk, light, walk->sum.full);
  if (walk->surface == 1) add_weighted(walk, light, first ? walk->sum.lde : walk->sum.lse);
  if (walk->surface == 1 ? first : walk->surface == 2 && both) add_weighted(walk, light, walk->sum.ld12e);
  if (walk->surface >= 2 && both) add_weighted(walk, light, walk->sum.lie);
}

/* ---- bounces ---- */

/* Two axes that make a frame with a unit vector (Duff et al., JCGT 6(1), 2017). */
static void make_axes(const double normal[3], double x[3], double y[3]) {
  const double sign = copysign(1, normal[2]), a = -1 / (sign + normal[2]), b = normal[0] * normal[1] * a;
  const double first[3] = {1 + sign * normal[0] * normal[0] * a, sign * b, -sign * normal[0]};
  const double second[3] = {b, sign + normal[1] * normal[1] * a, -normal[1]};
  memcpy(x, first, sizeof first);
  memcpy(y, second, sizeof second);
}

/* A unit vector about the normal with this cosine; `turn` 0..1 goes round. */
static void tilt_normal(const double normal[3], double cosine, double turn, double out[3]) {
  double x[3], y[3], sine_of, cosine_of;
  make_axes(normal, x, y);
  sincos(2 * M_PI * turn, &sine_of, &cosine_of);
  const double across = sqrt(fmax(0, 1 - cosine * cosine));
  for (int k = 0; k < 3; k++) out[k] = across * (cosine_of * x[k] + sine_of * y[k]) + cosine * normal[k];
}

/* What a way goes on from. */
typedef struct Hit {
  const StyHits *hits;
  int lane;
  double shading[3], facet[3]; /* its normals */
  double albedo[3];
  const StyMaterial *material;
} Hit;

static Hit get_hit(const StyBlock *block, int i) {
  Hit hit = {.hits = &block->hits, .lane = i, .material = block->hits.material[i]};
  sty_get_lane(block->hits.shading, i, hit.shading);
  sty_get_lane(block->hits.facet, i, hit.facet);
  sty_get_lane(block->albedo, i, hit.albedo);
  return hit;
}

/* Back along the ray, mirrored by a facet that stands as the lobe's do. */
static void mirror_ray(const StyRay *ray, const Hit *hit, const double random[2], double out[3]) {
  double facet[3];
  tilt_normal(hit->shading, pow(1 - random[0], 1 / (hit->material->shininess + 1)), random[1], facet);
  const double along = 2 * dot_vectors(ray->direction, facet);
  for (int k = 0; k < 3; k++) out[k] = ray->direction[k] - along * facet[k];
}

/* On the visible side of the surface. */
static void turn_up(const Hit *hit, double direction[3]) {
  double facet[3] = {hit->facet[0], hit->facet[1], hit->facet[2]};
  if (!normalize_vector(facet)) return;
  const double below = 2 * fmin(0, dot_vectors(facet, direction));
  for (int k = 0; k < 3; k++) direction[k] -= below * facet[k];
}

static void pick_direction(const StyRay *ray, const Hit *hit, bool is_diffuse, const double random[2], double out[3]) {
  if (is_diffuse)
    tilt_normal(hit->shading, sqrt(1 - random[0]), random[1], out);
  else
    mirror_ray(ray, hit, random, out);
  turn_up(hit, out);
  normalize_vector(out);
}

static double get_most(const double colour[3]) { return fmax(colour[0], fmax(colour[1], colour[2])); }

/* Which lobe the way goes on by, by what it mirrors; the weight takes on the lobe's colour. False: all is swallowed. */
static bool pick_lobe(Walk *walk, const Hit *hit, double random, bool *is_diffuse) {
  const double most = get_most(hit->albedo), specular = hit->material->specular;
  const double scale = most + specular > 1 ? (1 - specular) / most : 1, share = scale * most, all = share + specular;
  if (!(all > 0)) return false;
  *is_diffuse = random * all < share;
  for (int k = 0; k < 3; k++) walk->weight[k] *= *is_diffuse ? hit->albedo[k] / most * all : all;
  note_lobe(walk, *is_diffuse);
  return true;
}

static bool survive(Walk *walk, double random) {
  if (walk->surface < FIRST_ROULETTE) return true;
  const double chance = fmin(1, get_most(walk->weight));
  if (!(random < chance)) return false;
  for (int k = 0; k < 3; k++) walk->weight[k] /= chance;
  return true;
}

/* The ray on which a way goes on from a hit of `ray`, which it may replace; false: it ends here. */
static bool bounce(Walk *walk, const StyRay *ray, const Hit *hit, StyRay *out) {
  double choices[2], places[2], back[3];
  StyRay unit = *ray;
  bool is_diffuse;
  const uint64_t dimension = walk->key + 2 * (uint64_t)walk->surface;
  sty_draw_pair(sty_mix_bits(dimension), walk->sample, choices);
  sty_draw_pair(sty_mix_bits(dimension + 1), walk->sample, places);
  if (!pick_lobe(walk, hit, choices[0], &is_diffuse) || !survive(walk, choices[1])) return false;
  if (!normalize_vector(unit.direction) || !(dot_vectors(hit->shading, hit->shading) > 0.5)) return false;
  pick_direction(&unit, hit, is_diffuse, places, back);
  sty_leave_hit(hit->hits, hit->lane, back, out);
  return true;
}

/* ---- all ways of a block ---- */

typedef struct Crowd {
  const StyPathWorld *world;
  const StyBlock *start; /* where every way begins */
  int most;              /* surfaces of a way */
  Walk walks[STY_RAYS];
  StyBlock block; /* where the ways are; valid[i]: this one goes on */
} Crowd;

int sty_count_path_surfaces(unsigned groups) {
  if (groups & (STY_GUIDE_FULL | STY_GUIDE_LIE)) return STY_MOST_BOUNCES;
  return groups & STY_GUIDE_LD12E ? 2 : 1;
}

/* Lights at the surfaces where the ways are. */
static void gather_lights(Crowd *crowd) {
  StyShine shine;
  sty_shine_on_block(crowd->world->scene, crowd->world->tracer, &crowd->block, &shine);
  for (int i = 0; i < STY_RAYS; i++) {
    if (!crowd->block.valid[i]) continue;
    double light[3];
    sty_get_lane(shine.diffuse, i, light);
    note_lobe(&crowd->walks[i], true);
    gather(&crowd->walks[i], light);
    sty_get_lane(shine.highlight, i, light);
    note_lobe(&crowd->walks[i], false);
    gather(&crowd->walks[i], light);
  }
}

/* Back to the eye's own surface, for the next sample. */
static void restart(Crowd *crowd, int i) {
  Walk *walk = &crowd->walks[i];
  walk->surface = 1;
  for (int k = 0; k < 3; k++) walk->weight[k] = 1;
  const StyRay ray = sty_get_ray(&crowd->start->rays, i);
  sty_set_ray(&crowd->block.rays, i, &ray);
  sty_copy_hit(&crowd->start->hits, i, &crowd->block.hits);
  for (int k = 0; k < 3; k++) crowd->block.albedo[k][i] = crowd->start->albedo[k][i];
}

/* Sends lane i on, from where it is or, where its way has ended, by the next that goes on; false: it has done all. */
static bool send_on(Crowd *crowd, int i) {
  Walk *walk = &crowd->walks[i];
  StyBlock *block = &crowd->block;
  const uint32_t samples = (uint32_t)crowd->world->options.samples;
  for (; walk->sample < samples; walk->sample++, restart(crowd, i)) {
    const StyRay ray = sty_get_ray(&block->rays, i);
    const Hit hit = get_hit(block, i);
    StyRay next;
    if (walk->surface > crowd->most || !bounce(walk, &ray, &hit, &next)) continue;
    sty_set_ray(&block->rays, i, &next);
    return true;
  }
  return false;
}

/* What lies at the ends of the rays: the surroundings, or the next surface, past the last of which a way ends. */
static void arrive(Crowd *crowd, int i, bool is_hit) {
  Walk *walk = &crowd->walks[i];
  StyBlock *block = &crowd->block;
  const double ambient = crowd->world->scene->ambient, surroundings[3] = {ambient, ambient, ambient};
  if (!is_hit) gather(walk, surroundings);
  walk->surface = is_hit ? walk->surface + 1 : crowd->most + 1;
  block->valid[i] = walk->surface <= crowd->most ? -1 : 0;
  if (block->valid[i]) sty_get_albedo(crowd->world->palette, &block->hits, i, block->albedo);
}

/* One step of every lane that isn't done; false: all are. */
static bool step(Crowd *crowd) {
  bool sent[STY_RAYS], any = false;
  for (int i = 0; i < STY_RAYS; i++) {
    sent[i] = crowd->start->valid[i] && send_on(crowd, i);
    crowd->block.valid[i] = sent[i] ? -1 : 0;
    any |= sent[i];
  }
  if (!any) return false;
  sty_trace_rays(crowd->world->tracer, &crowd->block.rays, false, crowd->world->parts, crowd->block.valid,
                 &crowd->block.hits);
  for (int i = 0; i < STY_RAYS; i++)
    if (sent[i]) arrive(crowd, i, crowd->block.valid[i]);
  gather_lights(crowd);
  return true;
}

/* (x, y) is the block's first pixel. */
static void begin(Crowd *crowd, int x, int y) {
  crowd->block = *crowd->start;
  for (int i = 0; i < STY_RAYS; i++) {
    const uint64_t place = (uint64_t)(y + i / STY_BLOCK_WIDTH) << 32 | (uint32_t)(x + i % STY_BLOCK_WIDTH);
    crowd->walks[i] = (Walk){.key = sty_mix_bits(sty_mix_bits(crowd->world->options.seed + 1) + place)};
    restart(crowd, i);
  }
}

/* Adds the mean of what the ways found to what lights do at the eye's own surfaces, which is the same for each. */
static void average(const Crowd *crowd, const PathLight direct[STY_RAYS], StyPathSamples *paths) {
  enum { VALUES = sizeof(PathLight) / sizeof(double) };
  _Static_assert(sizeof(StyPathSamples) == VALUES * sizeof(StyLane), "both hold the same, in the same order");
  StyLane lanes[VALUES];
  for (int i = 0; i < STY_RAYS; i++) {
    double sums[VALUES], values[VALUES];
    memcpy(sums, &crowd->walks[i].sum, sizeof sums);
    memcpy(values, &direct[i], sizeof values);
    for (int v = 0; v < VALUES; v++) lanes[v][i] = values[v] + sums[v] / crowd->world->options.samples;
  }
  memcpy(paths, lanes, sizeof lanes);
}

void sty_trace_paths(const StyPathWorld *world, const StyBlock *block, int x, int y, StyPathSamples *paths) {
  Crowd crowd = {.world = world, .start = block, .most = sty_count_path_surfaces(world->groups)};
  PathLight direct[STY_RAYS];
  begin(&crowd, x, y);
  gather_lights(&crowd);
  for (int i = 0; i < STY_RAYS; i++) {
    direct[i] = crowd.walks[i].sum;
    crowd.walks[i].sum = (PathLight){0};
  }
  const bool is_exact = crowd.most == 1 && world->scene->ambient == 0;
  while (!is_exact && step(&crowd)) continue;
  average(&crowd, direct, paths);
}
