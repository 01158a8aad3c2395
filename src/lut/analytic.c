/* A sphere that fills the picture needs no search: the guide value is the place
 * (the lit sphere's rule: Sloan, Martin, Gooch, Gooch, "The Lit Sphere", 2001). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lut/engine.h"

/* Two 8-bit levels: what rounding a painter's normal map may have done. */
static const float tolerance = 4.0f / 255.0f;

static const int most_rings = 24;

static const uint32_t not_covered = UINT32_MAX;

typedef struct Job {
  const StySites *sites;
  StyLut *lut;
  const uint32_t *site_of_pixel; /* not_covered where the pixel shows nothing */
  StyMeasure measure;
  float deviation; /* of the guide's values from a perfect sphere's, at most */
} Job;

static void get_sphere_value(const StySites *sites, uint32_t pixel, float g[2]) {
  const uint32_t x = pixel % (uint32_t)sites->width, y = pixel / (uint32_t)sites->width;
  g[0] = (float)(2 * (int)x + 1 - sites->width) / (float)sites->width;
  g[1] = (float)(sites->height - 2 * (int)y - 1) / (float)sites->height;
}

/* The guide must be a sphere; how far it is from a perfect one is kept. */
static StyStatus check_sphere(const StySites *sites, float *deviation, StyError *error) {
  *deviation = 0;
  for (size_t s = 0; s < sites->count; s++) {
    float g[2];
    get_sphere_value(sites, sites->pixels[s], g);
    const float *found = sites->values + 2 * s;
    *deviation = fmaxf(*deviation, fmaxf(fabsf(found[0] - g[0]), fabsf(found[1] - g[1])));
    if (*deviation > tolerance)
      return sty_fail(error, STY_ERROR_INPUT,
                      "engine analytic: found guide value (%.4f, %.4f) at pixel (%u, %u), expected (%.4f, %.4f) of a "
                      "sphere that fills the picture",
                      (double)found[0], (double)found[1], sites->pixels[s] % (uint32_t)sites->width,
                      sites->pixels[s] / (uint32_t)sites->width, (double)g[0], (double)g[1]);
  }
  return STY_OK;
}

/* Squared, by the measure: float, or integer where the guide's values are levels. */
static double measure_site(const Job *job, size_t site, const StyQuery *query) {
  if (!job->measure.integer) return (double)sty_square_distance(2, query->at, job->sites->values + 2 * site);
  return sty_square_steps(&job->measure, query, job->sites->levels + 2 * site);
}

/* Sites ascend by pixel: the first at the minimum is the lowest. */
static size_t scan_sites(const Job *job, const StyQuery *query) {
  size_t nearest = 0;
  for (size_t s = 1; s < job->sites->count; s++)
    if (measure_site(job, s, query) < measure_site(job, nearest, query)) nearest = s;
  return nearest;
}

/* Rings of pixels around the place (x, y) of a value, until none farther out
 * can be nearer. The place of a value that lies `gap` outside the disc is its
 * projection on the rim: a pixel of the disc is then at least as far from the
 * value as both legs of a right angle say. Mostly the first ring or two do; pixels may be missing at the
 * rim, in holes, or because a lower pixel has the same value. Where a whole
 * region is missing, looking at every site is quicker. */
static size_t find_site_near(const Job *job, int x, int y, double gap, const StyQuery *query) {
  const int width = job->sites->width, height = job->sites->height;
  const int largest = width > height ? width : height;
  size_t nearest = job->sites->count;
  double best = INFINITY; /* squared, in the measure's steps */
  const double unit = job->measure.unit * job->measure.unit;
  for (int ring = 0;; ring++) {
    const double least = (ring - 0.5) * 2 / largest - 2 * (double)job->deviation;
    if (least > 0 && least * least + gap * gap > best * unit) return nearest;
    if (ring > most_rings) return scan_sites(job, query);
    for (int dy = -ring; dy <= ring; dy++) {
      const int step = abs(dy) == ring || ring == 0 ? 1 : 2 * ring;
      for (int dx = -ring; dx <= ring; dx += step) {
        const int px = x + dx, py = y + dy;
        if (px < 0 || py < 0 || px >= width || py >= height) continue;
        const uint32_t site = job->site_of_pixel[(size_t)py * (size_t)width + (size_t)px];
        if (site == not_covered) continue;
        const double distance = measure_site(job, site, query);
        if (distance < best || (distance == best && site < nearest)) {
          best = distance;
          nearest = site;
        }
      }
    }
  }
}

static StyStatus build_row(void *context, long j, StyError *error) {
  (void)error;
  const Job *job = context;
  const int width = job->sites->width, height = job->sites->height, columns = job->lut->spec.width;
  for (int i = 0; i < columns; i++) {
    StyQuery query;
    sty_make_query(&job->measure, job->lut, i, (int)j, &query);
    const float *g = query.at;
    /* Outside the disc the nearest place is on its rim. */
    const float radius = sqrtf(g[0] * g[0] + g[1] * g[1]);
    const float pull = radius > 1 ? 1 / radius : 1, gap = fmaxf(0, radius - 1 - 2 * job->deviation);
    const int x = (int)((g[0] * pull * 0.5f + 0.5f) * (float)width);
    const int y = (int)((0.5f - g[1] * pull * 0.5f) * (float)height);
    const size_t site = find_site_near(job, x, y, (double)gap, &query);
    sty_set_texel(job->lut, &job->measure, (size_t)j * (size_t)columns + (size_t)i, job->sites->pixels[site],
                  measure_site(job, site, &query));
  }
  return STY_OK;
}

StyStatus sty_build_analytic(const StySites *sites, const StyEngineOptions *options, StyLut *lut, const StyRun *run,
                             StyError *error) {
  (void)options;
  if (lut->spec.metric != STY_METRIC_XY)
    return sty_fail(error, STY_ERROR_USAGE, "engine analytic: found metric %s, expected xy",
                    sty_metric_names[lut->spec.metric]);
  float deviation;
  const StyStatus sphere = check_sphere(sites, &deviation, error);
  if (sphere) return sphere;
  const size_t pixels = (size_t)sites->width * (size_t)sites->height;
  uint32_t *site_of_pixel = malloc(pixels * sizeof *site_of_pixel);
  if (!site_of_pixel) return sty_fail_memory(error, "engine analytic", (double)pixels * 4);
  memset(site_of_pixel, 0xff, pixels * sizeof *site_of_pixel);
  for (size_t s = 0; s < sites->count; s++) site_of_pixel[sites->pixels[s]] = (uint32_t)s;
  Job job = {sites, lut, site_of_pixel, sty_choose_measure(sites, &lut->spec), deviation};
  const StyStatus status = sty_parallel_for(run, lut->spec.height, build_row, &job, error);
  free(site_of_pixel);
  return status;
}
