#include "judge.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "stylut/guide.h"

void (*zoo_clock)(void);

static void start_clock(void) {
  if (zoo_clock) zoo_clock();
}

void break_verdict(ZooVerdict *verdict, const char *format, ...) {
  if (verdict->outcome == ZOO_BROKEN) return;
  verdict->outcome = ZOO_BROKEN;
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(verdict->note, sizeof verdict->note, format, arguments);
  va_end(arguments);
}

bool is_claim_broken(const ZooVerdict *verdict) {
  return verdict->outcome == ZOO_NOTHING || verdict->outcome >= ZOO_BROKEN;
}

StyLutSpec describe_zoo_look(int look, int size) {
  static const StySampling samplings[] = {STY_SAMPLE_CENTRE, STY_SAMPLE_UNORM8, STY_SAMPLE_CORNER, STY_SAMPLE_CENTRE};
  return (StyLutSpec){size, size, samplings[look % 4], look % 4 == 3 ? STY_MAP_EQUAL_AREA : STY_MAP_XY,
                      look < 4 ? STY_METRIC_XY : STY_METRIC_ANGLE};
}

static const char *name_look(const StyLutSpec *spec, char text[64]) {
  snprintf(text, 64, "%s %s %s", sty_sampling_names[spec->sampling], sty_map_names[spec->map],
           sty_metric_names[spec->metric]);
  return text;
}

/* ---- refusals ----------------------------------------------------------------- */

/* One printable line that says `part`. */
static void judge_message(StyStatus status, StyStatus expected, const StyError *error, const char *part,
                          ZooVerdict *verdict) {
  bool printable = error->text[0] != '\0';
  for (const char *c = error->text; *c; c++) printable = printable && isprint((unsigned char)*c);
  if (status != expected || error->status != expected || !printable || !strstr(error->text, part)) {
    break_verdict(verdict, "status %d, message '%s', expected status %d and '%s'", status, error->text, expected, part);
    return;
  }
  verdict->outcome = ZOO_REFUSED;
  snprintf(verdict->note, sizeof verdict->note, "%s", error->text);
}

void judge_refusal(const StyImage *guide, const char *part, ZooVerdict *verdict) {
  StySites *sites = NULL;
  StyError error = {STY_OK, ""};
  judge_message(sty_collect_sites("guide", guide, &sites, &error), STY_ERROR_INPUT, &error, part, verdict);
  if (sites) break_verdict(verdict, "sites were written by a call that failed");
  sty_destroy_sites(&sites);
}

void judge_question(const StySites *sites, const StyEngine *engine, const float asked[2], const char *part,
                    ZooVerdict *verdict) {
  for (int metric = STY_METRIC_XY; metric <= STY_METRIC_ANGLE; metric++) {
    StyError error = {STY_OK, ""};
    uint32_t pixel = 0;
    float distance = 0;
    const StyStatus status =
        sty_ask_engine(sites, engine, NULL, (StyMetric)metric, asked, NULL, &pixel, &distance, &error);
    judge_message(status, STY_ERROR_INPUT, &error, part, verdict);
    if (verdict->outcome == ZOO_BROKEN) return;
  }
}

/* ---- engines ------------------------------------------------------------------ */

static bool differs(const StyLut *lut, const StyLut *reference, size_t texel) {
  return lut->pixels[texel] != reference->pixels[texel] ||
         memcmp(&lut->errors[texel], &reference->errors[texel], sizeof *lut->errors) != 0;
}

static void judge_exact(const StyLut *lut, const StyLut *reference, const char *what, ZooVerdict *verdict) {
  const size_t texels = sty_count_texels(&reference->spec);
  size_t wrong = 0, first = 0;
  for (size_t t = texels; t-- > 0;)
    if (differs(lut, reference, t)) wrong++, first = t;
  verdict->texels += texels;
  if (wrong)
    break_verdict(verdict, "%s: %zu of %zu texels differ, first (%zu, %zu): pixel %u at %.9g instead of %u at %.9g",
                  what, wrong, texels, first % (size_t)lut->spec.width, first / (size_t)lut->spec.width,
                  lut->pixels[first], (double)lut->errors[first], reference->pixels[first],
                  (double)reference->errors[first]);
  if (lut->unique != reference->unique)
    break_verdict(verdict, "%s: %zu distinct values instead of %zu", what, lut->unique, reference->unique);
}

static int compare_pixels(const void *a, const void *b) {
  const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
  return (x > y) - (x < y);
}

/* The number of the site at a pixel, or -1: not covered. */
static long find_site(const StySites *sites, uint32_t pixel) {
  const uint32_t *found = bsearch(&pixel, sites->pixels, sites->count, sizeof pixel, compare_pixels);
  return found ? found - sites->pixels : -1;
}

/* The distance to a site as a table states it. */
static float measure_site(const StySites *sites, const StyLut *lut, size_t texel, size_t site) {
  const StyMeasure measure = sty_choose_measure(sites, &lut->spec);
  const int width = lut->spec.width;
  StyQuery query;
  sty_make_query(&measure, lut, (int)texel % width, (int)texel / width, &query);
  if (measure.integer)
    return (float)(sqrt(sty_square_steps(&measure, &query, sites->levels + 2 * site)) * measure.unit);
  float at[3];
  sty_lift(measure.dims, sites->values + 2 * site, at);
  return (float)sqrt((double)sty_square_distance(measure.dims, query.at, at));
}

static void judge_approximate(const StyImage *guide, const StySites *sites, const StyLut *lut, const StyLut *reference,
                              const char *what, ZooVerdict *verdict) {
  const size_t texels = sty_count_texels(&lut->spec);
  for (size_t t = 0; t < texels; t++) {
    const long site = find_site(sites, lut->pixels[t]);
    const float least = reference->errors[t], stated = lut->errors[t];
    if (site < 0 || stated != measure_site(sites, lut, t, (size_t)site) || stated < least) {
      break_verdict(verdict, "%s: texel %zu holds pixel %u at %.9g, the least is %.9g", what, t, lut->pixels[t],
                    (double)stated, (double)least);
      return;
    }
    verdict->right += stated == least;
    verdict->worst = fmax(verdict->worst, (double)stated - (double)least);
  }
  verdict->texels += texels;
  verdict->outcome = ZOO_APPROXIMATE;
  ZooVerdict resolved = {0};
  judge_resolve(guide, sites, lut, &resolved);
  if (resolved.outcome == ZOO_BROKEN) break_verdict(verdict, "%s", resolved.note);
}

/* The one that says it isn't for this guide or metric is as right as one that answers. */
static void note_status(const StyEngine *engine, StyStatus status, const StyError *error, const char *what,
                        ZooVerdict *verdict) {
  if (status == STY_ERROR_UNAVAILABLE) {
    verdict->outcome = ZOO_NOT_BUILT;
  } else if (!engine->exact && (status == STY_ERROR_INPUT || status == STY_ERROR_USAGE) &&
             strstr(error->text, engine->name)) {
    if (verdict->outcome != ZOO_NOTHING) return;
    verdict->outcome = ZOO_UNSUITED;
    snprintf(verdict->note, sizeof verdict->note, "%s", error->text);
  } else {
    break_verdict(verdict, "%s: status %d, %s", what, status, error->text);
  }
}

static void judge_build(const StyImage *guide, const StySites *sites, const StyEngine *engine, const StyLut *reference,
                        int threads, const char *what, ZooVerdict *verdict) {
  const StyRun run = {.threads = threads};
  StyError error = {STY_OK, ""};
  StyLut *lut = NULL;
  start_clock();
  const StyStatus status = sty_build_lut(sites, engine, NULL, &reference->spec, &run, &lut, &error);
  if (status) {
    note_status(engine, status, &error, what, verdict);
  } else if (engine->exact) {
    if (verdict->outcome == ZOO_NOTHING) verdict->outcome = ZOO_EXACT;
    judge_exact(lut, reference, what, verdict);
  } else {
    judge_approximate(guide, sites, lut, reference, what, verdict);
  }
  sty_destroy_lut(&lut);
}

void judge_engine(const StyImage *guide, const StySites *sites, const StyEngine *engine, const StyLut *reference,
                  ZooVerdict *verdict) {
  /* What the processor lacks is its widest once more. */
  static const char *const units[] = {"plain", "avx2", "avx512"};
  char look[64], what[128];
  name_look(&reference->spec, look);
  if (strcmp(engine->name, "grid") != 0) {
    snprintf(what, sizeof what, "%s, %s", engine->name, look);
    judge_build(guide, sites, engine, reference, 1, what, verdict);
    return;
  }
  for (int u = 0; u < 3; u++) {
    snprintf(what, sizeof what, "%s (%s), %s", engine->name, units[u], look);
    setenv("STYLUT_VECTOR", units[u], 1);
    judge_build(guide, sites, engine, reference, 1 + u % 2, what, verdict);
  }
  unsetenv("STYLUT_VECTOR");
}

/* ---- coherent tables ---------------------------------------------------------- */

static bool is_jump(const StyLut *lut, size_t a, size_t b) {
  const int width = lut->source_width, height = lut->source_height;
  const double most = fmax(1, 4.0 * (width > height ? width : height) / lut->spec.width);
  const int p = (int)lut->pixels[a], q = (int)lut->pixels[b];
  return hypot(p % width - q % width, p / width - q / width) > most;
}

static size_t count_jumps(const StyLut *lut, size_t *pairs) {
  const int width = lut->spec.width, height = lut->spec.height;
  size_t jumps = 0;
  *pairs = 0;
  for (int j = 0; j < height; j++)
    for (int i = 0; i < width; i++)
      for (int s = 0; s < 2; s++) {
        const int x = i + (s == 0), y = j + (s == 1);
        if (x >= width || y >= height || !sty_is_feasible(&lut->spec, i, j) || !sty_is_feasible(&lut->spec, x, y))
          continue;
        ++*pairs;
        jumps += is_jump(lut, (size_t)(j * width + i), (size_t)(y * width + x));
      }
  return jumps;
}

static StyLut *copy_lut(const StyLut *lut) {
  StyLut *copy = NULL;
  if (sty_create_lut(&lut->spec, lut->source_width, lut->source_height, &copy, NULL)) return NULL;
  memcpy(copy->pixels, lut->pixels, sty_count_texels(&lut->spec) * sizeof *lut->pixels);
  memcpy(copy->errors, lut->errors, sty_count_texels(&lut->spec) * sizeof *lut->errors);
  copy->unique = lut->unique;
  return copy;
}

/* Pixels that stayed keep their distance as it is; others have theirs in float, of bytes too. */
static bool is_stated_right(const StySites *sites, const StyLut *base, const StyLut *lut, size_t texel) {
  if (lut->pixels[texel] == base->pixels[texel]) return lut->errors[texel] == base->errors[texel];
  const long site = find_site(sites, lut->pixels[texel]);
  if (site < 0) return false;
  const int dims = lut->spec.metric == STY_METRIC_ANGLE ? 3 : 2, width = lut->spec.width;
  float g[2], at[3], place[3];
  sty_get_texel_value(&lut->spec, (int)texel % width, (int)texel / width, g);
  sty_lift(dims, g, at);
  sty_lift(dims, sites->values + 2 * site, place);
  return lut->errors[texel] == sqrtf(sty_square_distance(dims, at, place));
}

typedef enum Resolve { COHERENT, FRAMES, BOTH } Resolve;

static const char *const resolve_names[] = {"coherent", "frames", "both"};

/* A frame as other guides see it: a small sphere. The tests' own, for good. */
static const StyImage *get_sphere(void) {
  static StyImage *sphere;
  if (!sphere && sty_make_sphere_guide(48, 48, STY_GUIDE_NORMAL, &sphere, NULL)) abort();
  return sphere;
}

/* The frames to be served are the guide itself and a sphere. */
static void judge_slack(const StyImage *guide, const StySites *sites, const StyLut *base, Resolve resolve, double slack,
                        ZooVerdict *verdict) {
  char look[96];
  const size_t named = (size_t)snprintf(look, sizeof look, "%s, ", resolve_names[resolve]);
  name_look(&base->spec, look + named);
  StyError error = {STY_OK, ""};
  const StyImage *const frames[] = {guide, get_sphere()};
  const StyResolveOptions options = {.slack = slack,
                                     .coherent = resolve != FRAMES,
                                     .guide = guide,
                                     .frames = frames,
                                     .frame_count = resolve != COHERENT ? 2 : 0};
  StyLut *lut = copy_lut(base);
  start_clock();
  const StyStatus status = lut ? sty_resolve_lut(lut, sites, &options, NULL, &error) : STY_ERROR_LIBRARY;
  if (status) {
    break_verdict(verdict, "%s: status %d, %s", look, status, error.text);
    sty_destroy_lut(&lut);
    return;
  }
  const size_t texels = sty_count_texels(&base->spec);
  for (size_t t = 0; t < texels; t++)
    if (!is_stated_right(sites, base, lut, t) || !((double)lut->errors[t] <= (double)base->errors[t] + slack))
      break_verdict(verdict, "%s, slack %g: texel %zu holds pixel %u at %.9g instead of %u at %.9g", look, slack, t,
                    lut->pixels[t], (double)lut->errors[t], base->pixels[t], (double)base->errors[t]);
  size_t pairs;
  const size_t before = count_jumps(base, &pairs), after = count_jumps(lut, &pairs);
  if (resolve == COHERENT && after > before)
    break_verdict(verdict, "%s, slack %g: %zu jumps instead of %zu", look, slack, after, before);
  if (resolve == COHERENT && slack > 0) {
    verdict->pairs += pairs;
    verdict->before += before;
    verdict->after += after;
  }
  sty_destroy_lut(&lut);
}

/* ---- audits ------------------------------------------------------------------- */

static void judge_share(double share, const char *name, const char *what, ZooVerdict *verdict) {
  if (!(share >= 0 && share <= 1 + 1e-9)) break_verdict(verdict, "%s: %s is %g", what, name, share);
}

void judge_audit(const StyImage *guide, const StyLut *exact, StyWeights weights, ZooVerdict *verdict) {
  char look[64], what[96];
  snprintf(what, sizeof what, "audit by %s, %s", sty_weights_names[weights], name_look(&exact->spec, look));
  StyError error = {STY_OK, ""};
  StyAudit audit;
  const StyImage *const frames[] = {get_sphere()};
  const StyAuditOptions options = {.tolerance = 4 * STY_LEVEL, .weights = weights, .frames = frames, .frame_count = 1};
  start_clock();
  const StyStatus status = sty_audit_lut(exact, exact, guide, &options, NULL, &audit, NULL, &error);
  if (status) {
    break_verdict(verdict, "%s: status %d, %s", what, status, error.text);
    return;
  }
  judge_share(audit.coverage, "coverage", what, verdict);
  judge_share(audit.unused, "unused", what, verdict);
  judge_share(audit.ambiguous, "ambiguous", what, verdict);
  judge_share(audit.jumps, "jumps", what, verdict);
  judge_share(audit.unstable, "unstable", what, verdict);
  if (audit.optimal != 1 || audit.excess.max != 0 || audit.background)
    break_verdict(verdict, "%s: optimal %g, excess up to %g, %zu texels on the background", what, audit.optimal,
                  audit.excess.max, audit.background);
  if (!(audit.lookup.p50 <= audit.lookup.p99 && audit.lookup.p99 <= audit.lookup.max && audit.lookup.max <= 180))
    break_verdict(verdict, "%s: lookup p50 %g, p99 %g, max %g", what, audit.lookup.p50, audit.lookup.p99,
                  audit.lookup.max);
}

void judge_resolve(const StyImage *guide, const StySites *sites, const StyLut *base, ZooVerdict *verdict) {
  if (verdict->outcome == ZOO_NOTHING) verdict->outcome = ZOO_CALM;
  verdict->texels += sty_count_texels(&base->spec);
  for (Resolve resolve = COHERENT; resolve <= BOTH; resolve++) {
    judge_slack(guide, sites, base, resolve, 2 * STY_LEVEL, verdict);
    judge_slack(guide, sites, base, resolve, 0, verdict);
  }
}
