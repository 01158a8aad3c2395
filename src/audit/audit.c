#include "stylut/audit.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "audit/ambiguity.h"
#include "audit/figures.h"

enum { BYTES = 256 };

const char *const sty_weights_names[] = {"disc", "sphere", "frames", NULL};
const char *const sty_usage_names[STY_USAGE_BINS] = {"0", "1", "2-7", "8-19", "20+"};

double sty_get_precision(const StyImage *guide) {
  return guide->bits == 8 ? STY_LEVEL : guide->bits == 16 ? 2.0 / 65535 : (double)FLT_EPSILON;
}

void sty_free_audit_maps(StyAuditMaps *maps) {
  free(maps->assignment);
  free(maps->excess);
  free(maps->pieces);
  free(maps->spread);
  free(maps->jumps);
  free(maps->unstable);
  free(maps->weights);
  *maps = (StyAuditMaps){0};
}

/* All that an audit looks at. */
typedef struct Case {
  const StyLut *lut, *exact;
  const StyAuditOptions *options;
  StyGuidePlanes guide;
  StySites *sites;
  StyAudit *audit;
  StyAuditMaps *maps;
} Case;

static size_t get_texel(const StyLutSpec *spec, const int at[2]) {
  return (size_t)at[1] * (size_t)spec->width + (size_t)at[0];
}

/* ---- weights ------------------------------------------------------------------ */

static bool is_in_disc(const float g[2]) { return g[0] * g[0] + g[1] * g[1] <= 1; }

/* Solid angle per area of the map: 1/z for xy; equal-area maps have it built in. */
static double weigh_value(const Case *c, const float g[2]) {
  const bool sphere = c->options->weights == STY_WEIGHT_SPHERE, even = c->lut->spec.map == STY_MAP_EQUAL_AREA;
  if (sphere == even) return 1;
  /* At the rim itself one density has no end and the other is 0; half a texel inside it neither is:
   * there z is about sqrt(2/L) in xy, 2/L in equal-area. */
  const double inside = 2.0 / c->lut->spec.width, least = even ? inside : sqrt(inside);
  const double z = fmax(sqrt(fmax(0, 1 - (double)g[0] * g[0] - (double)g[1] * g[1])), least);
  return sphere ? 1 / z : z;
}

/* Calls visit for every covered pixel of the frames. */
static StyStatus visit_frames(const Case *c, void (*visit)(const Case *c, const float g[2], void *context),
                              void *context, StyError *error) {
  for (int f = 0; f < c->options->frame_count; f++) {
    StyGuidePlanes frame;
    const StyStatus status = sty_find_planes(c->options->frames[f], &frame, error);
    if (status) return status;
    for (size_t i = 0; i < sty_count_pixels(c->options->frames[f]); i++)
      if (frame.covered[i] > 0) visit(c, (const float[2]){frame.x[i], frame.y[i]}, context);
  }
  return STY_OK;
}

static void count_demand(const Case *c, const float g[2], void *counts) {
  int at[2];
  sty_find_texel(&c->lut->spec, g, at);
  ((uint64_t *)counts)[get_texel(&c->lut->spec, at)]++;
}

/* How often the frames ask for each texel. Counted in integers: a float ends at 2^24. */
static StyStatus weigh_demand(const Case *c, StyError *error) {
  const size_t texels = sty_count_texels(&c->lut->spec);
  uint64_t *counts = calloc(texels, sizeof *counts);
  if (!counts) return sty_fail_memory(error, "audit", (double)texels * sizeof *counts);
  const StyStatus status = visit_frames(c, count_demand, counts, error);
  for (size_t t = 0; t < texels; t++) c->maps->weights[t] = (float)counts[t];
  free(counts);
  return status;
}

/* Fills maps->weights: what each texel counts; infeasible ones are NAN, the sum is 1. */
static StyStatus weigh_texels(const Case *c, StyError *error) {
  const StyLutSpec *spec = &c->lut->spec;
  float *weights = c->maps->weights;
  if (c->options->weights == STY_WEIGHT_FRAMES) {
    const StyStatus status = weigh_demand(c, error);
    if (status) return status;
  }
  double sum = 0;
  for (int j = 0; j < spec->height; j++)
    for (int i = 0; i < spec->width; i++) {
      const size_t t = get_texel(spec, (const int[2]){i, j});
      float g[2];
      sty_get_texel_value(spec, i, j, g);
      if (!sty_is_feasible(spec, i, j))
        weights[t] = NAN;
      else if (c->options->weights != STY_WEIGHT_FRAMES)
        weights[t] = (float)weigh_value(c, g);
      if (!(weights[t] > 0)) continue;
      sum += (double)weights[t];
      c->audit->feasible++;
    }
  if (!(sum > 0))
    return c->options->weights == STY_WEIGHT_FRAMES
               ? sty_fail(error, STY_ERROR_INPUT,
                          "found no covered pixel in the frames that asks for a feasible texel, expected one")
               : sty_fail(error, STY_ERROR_INPUT,
                          "found no feasible texel in a LUT of size %d, expected size 3 or more", spec->width);
  for (size_t t = 0; t < sty_count_texels(spec); t++) weights[t] = (float)((double)weights[t] / sum);
  return STY_OK;
}

/* ---- error at texels ---------------------------------------------------------- */

/* Both tables' distances are measured anew, by one rule: a table read from a
 * file doesn't carry its own. */
static bool is_optimal(const Case *c, size_t texel, const float g[2]) {
  const uint32_t ours = c->lut->pixels[texel], best = c->exact->pixels[texel];
  if (ours == best) return true;
  if (!(c->guide.covered[ours] > 0)) return false;
  double squared[2];
  const uint32_t pixels[2] = {ours, best};
  for (int k = 0; k < 2; k++) {
    const double dx = (double)g[0] - c->guide.x[pixels[k]], dy = (double)g[1] - c->guide.y[pixels[k]];
    squared[k] = dx * dx + dy * dy;
    if (c->lut->spec.metric == STY_METRIC_ANGLE) squared[k] = sty_measure_pixel(&c->guide, pixels[k], g);
  }
  return squared[0] <= squared[1] * (1 + 1e-5) + 1e-12;
}

/* Guide units, by the metric. */
static double measure_distance(const Case *c, uint32_t pixel, const float g[2]) {
  if (!(c->guide.covered[pixel] > 0)) return INFINITY;
  if (c->lut->spec.metric == STY_METRIC_ANGLE)
    return 2 * sin(sty_measure_pixel(&c->guide, pixel, g) * (M_PI / 360)); /* the chord */
  return hypot((double)g[0] - c->guide.x[pixel], (double)g[1] - c->guide.y[pixel]);
}

static bool is_beyond_slack(const Case *c, size_t texel, const float g[2]) {
  const double slack = c->audit->slack, margin = 1e-6; /* distances come from floats */
  return slack > 0 && measure_distance(c, c->lut->pixels[texel], g) >
                          measure_distance(c, c->exact->pixels[texel], g) + slack + margin;
}

static void measure_texel(const Case *c, int i, int j, StyTally *assignment, StyTally *excess) {
  const StyLutSpec *spec = &c->lut->spec;
  const int at[2] = {i, j};
  const size_t texel = get_texel(spec, at);
  const double weight = (double)c->maps->weights[texel];
  if (!(weight > 0)) return;
  float g[2];
  sty_get_texel_value(spec, i, j, g);
  const uint32_t pixel = c->lut->pixels[texel];
  const double angle = sty_measure_pixel(&c->guide, pixel, g);
  const bool optimal = is_optimal(c, texel, g);
  const double above = optimal ? 0 : fmax(0, angle - sty_measure_pixel(&c->guide, c->exact->pixels[texel], g));
  sty_add_error(assignment, angle, weight, at, g, pixel, c->lut->source_width);
  sty_add_error(excess, above, weight, at, g, pixel, c->lut->source_width);
  c->maps->assignment[texel] = (float)angle;
  c->maps->excess[texel] = (float)above;
  c->audit->background += !(c->guide.covered[pixel] > 0);
  c->audit->beyond_slack += is_beyond_slack(c, texel, g);
  c->audit->optimal += optimal ? weight : 0;
  c->audit->coverage += (double)c->exact->errors[texel] <= c->audit->tolerance ? weight : 0;
}

static StyStatus measure_texels(const Case *c, StyError *error) {
  StyTally assignment, excess = {0};
  StyStatus status = sty_open_tally(c->audit->feasible, &assignment, error);
  if (!status) status = sty_open_tally(c->audit->feasible, &excess, error);
  if (!status) {
    for (int j = 0; j < c->lut->spec.height; j++)
      for (int i = 0; i < c->lut->spec.width; i++) measure_texel(c, i, j, &assignment, &excess);
    c->audit->assignment = sty_finish_tally(&assignment);
    c->audit->excess = sty_finish_tally(&excess);
  }
  sty_close_tally(&assignment);
  sty_close_tally(&excess);
  return status;
}

/* ---- error between texels ----------------------------------------------------- */

/* Lookups per texel and axis. */
static int get_samples(const StyLutSpec *spec) { return spec->width <= 1024 && spec->height <= 1024 ? 4 : 2; }

/* Adds the error of the table's answer to the guide value g. */
static void ask(const Case *c, const float g[2], double weight, StyTally *lookup) {
  int at[2];
  sty_find_texel(&c->lut->spec, g, at);
  const uint32_t pixel = c->lut->pixels[get_texel(&c->lut->spec, at)];
  sty_add_error(lookup, sty_measure_pixel(&c->guide, pixel, g), weight, at, g, pixel, c->lut->source_width);
}

static void ask_pixel(const Case *c, const float g[2], void *lookup) { ask(c, g, 1, lookup); }

/* Asks for samples x samples values spread over every texel's square, those on
 * the rim included whose own centre isn't feasible. */
static void ask_between_centres(const Case *c, StyTally *lookup) {
  const int samples = get_samples(&c->lut->spec);
  const StyLutSpec fine = {c->lut->spec.width * samples, c->lut->spec.height * samples, STY_SAMPLE_CENTRE,
                           c->lut->spec.map, c->lut->spec.metric};
  for (int b = 0; b < fine.height; b++)
    for (int a = 0; a < fine.width; a++) {
      float g[2];
      if (!sty_is_feasible(&fine, a, b)) continue;
      sty_get_texel_value(&fine, a, b, g);
      ask(c, g, weigh_value(c, g), lookup);
    }
}

/* Asks for every byte guide there is. */
static void ask_for_bytes(const Case *c, StyTally *lookup) {
  for (int b = 0; b < BYTES; b++)
    for (int a = 0; a < BYTES; a++) {
      const float g[2] = {(float)(2 * a - 255) / 255.0f, (float)(255 - 2 * b) / 255.0f};
      if (is_in_disc(g)) ask(c, g, weigh_value(c, g), lookup);
    }
}

static size_t count_questions(const Case *c) {
  if (c->options->weights != STY_WEIGHT_FRAMES) {
    const size_t samples = (size_t)get_samples(&c->lut->spec);
    return c->lut->spec.sampling == STY_SAMPLE_UNORM8 ? BYTES * BYTES
                                                      : sty_count_texels(&c->lut->spec) * samples * samples;
  }
  size_t count = 0;
  for (int f = 0; f < c->options->frame_count; f++) count += sty_count_pixels(c->options->frames[f]);
  return count;
}

static StyStatus measure_lookups(const Case *c, StyError *error) {
  StyTally lookup;
  StyStatus status = sty_open_tally(count_questions(c), &lookup, error);
  if (status) return status;
  if (c->options->weights == STY_WEIGHT_FRAMES)
    status = visit_frames(c, ask_pixel, &lookup, error);
  else if (c->lut->spec.sampling == STY_SAMPLE_UNORM8)
    ask_for_bytes(c, &lookup);
  else
    ask_between_centres(c, &lookup);
  if (!status && !lookup.count)
    status = sty_fail(error, STY_ERROR_INPUT, "found no covered pixel in the frames, expected one");
  if (!status) c->audit->lookup = sty_finish_tally(&lookup);
  sty_close_tally(&lookup);
  return status;
}

/* ---- usage and coherence ------------------------------------------------------ */

static int get_usage_bin(uint32_t uses) { return uses < 2 ? (int)uses : uses < 8 ? 2 : uses < 20 ? 3 : 4; }

static StyStatus measure_usage(const Case *c, StyError *error) {
  const size_t pixels = (size_t)c->lut->source_width * (size_t)c->lut->source_height;
  uint32_t *uses = calloc(pixels, sizeof *uses);
  if (!uses) return sty_fail_memory(error, "usage", (double)pixels * sizeof *uses);
  for (size_t t = 0; t < sty_count_texels(&c->lut->spec); t++)
    if (c->maps->weights[t] > 0) uses[c->lut->pixels[t]]++;
  for (size_t p = 0; p < pixels; p++)
    if (c->guide.covered[p] > 0) c->audit->usage[get_usage_bin(uses[p])]++;
  c->audit->unused = (double)c->audit->usage[0] / (double)c->sites->count;
  free(uses);
  return STY_OK;
}

static bool is_jump(const Case *c, size_t a, size_t b) {
  const uint32_t width = (uint32_t)c->lut->source_width, p = c->lut->pixels[a], q = c->lut->pixels[b];
  const double dx = (double)(p % width) - (double)(q % width), dy = (double)(p / width) - (double)(q / width);
  return dx * dx + dy * dy > c->audit->jump * c->audit->jump;
}

/* A pair weighs what its texels weigh together. */
static void measure_coherence(const Case *c) {
  const StyLutSpec *spec = &c->lut->spec;
  static const int steps[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  double pairs = 0, jumps = 0;
  for (int j = 0; j < spec->height; j++)
    for (int i = 0; i < spec->width; i++) {
      if (!sty_is_feasible(spec, i, j)) continue;
      const size_t texel = get_texel(spec, (const int[2]){i, j});
      int neighbours = 0, far = 0;
      for (int s = 0; s < 4; s++) {
        const int at[2] = {i + steps[s][0], j + steps[s][1]};
        if (at[0] < 0 || at[1] < 0 || at[0] >= spec->width || at[1] >= spec->height) continue;
        if (!sty_is_feasible(spec, at[0], at[1])) continue;
        const size_t other = get_texel(spec, at);
        const bool jump = is_jump(c, texel, other);
        neighbours++;
        far += jump;
        if (s >= 2) continue; /* counted from the other side */
        const double weight = (double)c->maps->weights[texel] + (double)c->maps->weights[other];
        pairs += weight;
        jumps += jump ? weight : 0;
      }
      c->maps->jumps[texel] = neighbours ? (float)far / (float)neighbours : 0;
    }
  c->audit->jumps = pairs > 0 ? jumps / pairs : 0;
}

/* ---- the guide itself --------------------------------------------------------- */

static StyStatus measure_guide(const Case *c, const StyRun *run, StyError *error) {
  StyAudit *audit = c->audit;
  StyStatus status =
      sty_measure_ambiguity(c->exact, c->sites, audit->precision, run, c->maps->pieces, c->maps->spread, error);
  if (!status)
    status = sty_measure_stability(c->exact, c->sites, audit->precision, audit->jump, c->options->seed, run,
                                   c->maps->unstable, error);
  if (status) return status;
  for (size_t t = 0; t < sty_count_texels(&c->lut->spec); t++) {
    const double weight = (double)c->maps->weights[t];
    if (isnan(weight)) c->maps->pieces[t] = c->maps->spread[t] = c->maps->unstable[t] = NAN;
    if (!(weight > 0)) continue;
    const bool ambiguous = c->maps->pieces[t] >= 2 || (double)c->maps->spread[t] > audit->jump;
    audit->ambiguous += ambiguous ? weight : 0;
    audit->spread += weight * (double)c->maps->spread[t];
    audit->unstable += weight * (double)c->maps->unstable[t];
  }
  return STY_OK;
}

/* Weights are float and sum to about 1: of shares, a whole must be 1 to the bit. */
static void normalize_shares(const Case *c) {
  StyAudit *audit = c->audit;
  double sum = 0;
  for (size_t t = 0; t < sty_count_texels(&c->lut->spec); t++)
    if (c->maps->weights[t] > 0) sum += (double)c->maps->weights[t];
  double *const shares[] = {&audit->optimal, &audit->coverage, &audit->ambiguous, &audit->spread, &audit->unstable};
  for (size_t k = 0; k < sizeof shares / sizeof *shares; k++) *shares[k] /= sum;
}

/* ---- the whole ---------------------------------------------------------------- */

static StyStatus check_case(const StyLut *lut, const StyLut *exact, const StyImage *guide, StyError *error) {
  const StyLutSpec *a = &lut->spec, *b = &exact->spec;
  if (lut->depth || exact->depth)
    return sty_fail(error, STY_ERROR_INPUT, "found a LUT of three dimensions, expected one of two");
  if (a->width != b->width || a->height != b->height || a->sampling != b->sampling || a->map != b->map ||
      a->metric != b->metric || lut->source_width != exact->source_width || lut->source_height != exact->source_height)
    return sty_fail(error, STY_ERROR_INPUT,
                    "found an exact LUT of another size, sampling or source, expected the same as of the one audited");
  if (lut->source_width == guide->width && lut->source_height == guide->height) return STY_OK;
  return sty_fail(error, STY_ERROR_INPUT,
                  "found a LUT for a source of %dx%d pixels, expected one for the guide's %dx%d", lut->source_width,
                  lut->source_height, guide->width, guide->height);
}

static StyStatus create_maps(size_t texels, StyAuditMaps *out, StyError *error) {
  float **const planes[] = {&out->assignment, &out->excess,   &out->pieces, &out->spread,
                            &out->jumps,      &out->unstable, &out->weights};
  *out = (StyAuditMaps){0};
  for (size_t p = 0; p < sizeof planes / sizeof *planes; p++) {
    *planes[p] = calloc(texels, sizeof(float));
    if (*planes[p]) continue;
    sty_free_audit_maps(out);
    return sty_fail_memory(error, "audit", (double)texels * 28);
  }
  for (size_t t = 0; t < texels; t++) out->assignment[t] = out->excess[t] = out->jumps[t] = NAN;
  return STY_OK;
}

StyStatus sty_audit_lookup(const StyLut *lut, const StyImage *guide, const StyAuditOptions *options, StyFigures *out,
                           StyError *error) {
  StyAudit audit = {.spec = lut->spec};
  Case c = {.lut = lut, .exact = lut, .options = options, .audit = &audit};
  StyStatus status = sty_find_planes(guide, &c.guide, error);
  if (!status) status = check_case(lut, lut, guide, error);
  if (!status) status = measure_lookups(&c, error);
  if (!status) *out = audit.lookup;
  return status;
}

StyStatus sty_audit_lut(const StyLut *lut, const StyLut *exact, const StyImage *guide, const StyAuditOptions *options,
                        const StyRun *run, StyAudit *out, StyAuditMaps *maps, StyError *error) {
  StyAudit audit = {.spec = lut->spec,
                    .weights = options->weights,
                    .jump = options->jump > 0 ? options->jump : sty_get_jump(&lut->spec, guide->width, guide->height),
                    .precision = options->precision > 0 ? options->precision : sty_get_precision(guide),
                    .tolerance = options->tolerance,
                    .slack = lut->slack};
  StyAuditMaps planes = {0};
  Case c = {.lut = lut, .exact = exact, .options = options, .audit = &audit, .maps = &planes};
  StyStatus status = sty_find_planes(guide, &c.guide, error);
  if (!status) status = check_case(lut, exact, guide, error);
  if (!status) status = sty_collect_sites("guide", guide, &c.sites, error);
  if (!status) status = create_maps(sty_count_texels(&lut->spec), &planes, error);
  if (!status) status = weigh_texels(&c, error);
  if (!status) status = measure_texels(&c, error);
  if (!status) status = measure_lookups(&c, error);
  if (!status) status = measure_usage(&c, error);
  if (!status) measure_coherence(&c);
  if (!status) status = measure_guide(&c, run, error);
  if (!status) normalize_shares(&c);
  sty_destroy_sites(&c.sites);
  if (status || !maps)
    sty_free_audit_maps(&planes);
  else
    *maps = planes;
  if (!status) *out = audit;
  return status;
}
