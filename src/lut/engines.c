#include <math.h>
#include <stdio.h>
#include <string.h>

#include "lut/engine.h"
#include "stylut/parse.h"

const StyEngine sty_engines[] = {
    {"brute", "looks at every source pixel; the reference", true, 1, STY_MOST_DIMS, sty_build_brute},
    {"analytic", "spheres that fill the picture: no search, within half a source pixel", false, 2, 2,
     sty_build_analytic},
    {"flann-single", "FLANN's single kd-tree", true, 1, STY_MOST_DIMS, sty_build_flann_single},
    {"cgal", "CGAL's kd-tree with sliding midpoints", true, 2, 3, sty_build_cgal},
    {"flann-forest", "FLANN's randomized forest (--trees, --checks); approximate, and not the same from run to run",
     false, 1, STY_MOST_DIMS, sty_build_flann_forest},
    {"flann-auto",
     "FLANN's forest with as many checks as --precision takes; approximate, and not the same from run to run", false, 1,
     STY_MOST_DIMS, sty_build_flann_auto},
    {"grid", "stylut's own: a distance transform for 8-bit guides, cells and a packed tree for others", true, 2, 2,
     sty_build_grid},
    {NULL, NULL, false, 0, 0, NULL},
};

const StyEngineOptions sty_default_engine_options = {.trees = 4, .checks = 32, .precision = 0.9};

static const StyEngine *find_named(const char *name) {
  const StyEngine *engine = sty_engines;
  while (strcmp(engine->name, name) != 0) engine++;
  return engine;
}

const StyEngine *sty_get_fastest_engine(StyTask task, int dims) {
#ifdef STY_WITH_CGAL
  const char *const general = dims == 2 || dims == 3 ? "cgal" : "flann-single";
#else
  (void)dims;
  const char *const general = "flann-single";
#endif
  return find_named(task == STY_TASK_TABLE ? "grid" : general);
}

StyStatus sty_find_engine(const char *what, const char *name, const StyEngine **out, StyError *error) {
  const char *names[sizeof sty_engines / sizeof *sty_engines + 1] = {"auto"};
  for (int i = 0; sty_engines[i].name; i++) names[i + 1] = sty_engines[i].name;
  int choice;
  const StyStatus status = sty_parse_choice(what, name, names, &choice, error);
  if (!status) *out = choice ? &sty_engines[choice - 1] : sty_get_fastest_engine(STY_TASK_TABLE, 2);
  return status;
}

static bool takes(const StyEngine *engine, int dims) { return engine->least_dims <= dims && dims <= engine->most_dims; }

static StyStatus fail_dims(const StyEngine *engine, int dims, StyError *error) {
  char able[128] = "";
  for (const StyEngine *other = sty_engines; other->name; other++)
    if (takes(other, dims)) snprintf(able + strlen(able), sizeof able - strlen(able), " %s", other->name);
  return sty_fail(error, STY_ERROR_USAGE, "engine %s: found values of %d dimension%s, expected one of these engines:%s",
                  engine->name, dims, dims == 1 ? "" : "s", able);
}

StyStatus sty_check_dims(const StyEngine *engine, int dims, StyError *error) {
  return takes(engine, dims) ? STY_OK : fail_dims(engine, dims, error);
}

/* Has the engine fill a new table; destroys it on failure. */
static StyStatus fill_lut(const StySites *sites, const StyEngine *engine, const StyEngineOptions *options, StyLut *lut,
                          const StyRun *run, StyLut **out, StyError *error) {
  StyStatus status = sty_check_dims(engine, sites->dims, error);
  if (!status) status = engine->build(sites, options ? options : &sty_default_engine_options, lut, run, error);
  if (status)
    sty_destroy_lut(&lut);
  else
    *out = lut;
  return status;
}

static StyStatus fail_sites(const StySites *sites, int expected, StyError *error) {
  return sty_fail(error, STY_ERROR_USAGE, "LUT: found values of %d dimensions, expected %d", sites->dims, expected);
}

StyStatus sty_build_lut(const StySites *sites, const StyEngine *engine, const StyEngineOptions *options,
                        const StyLutSpec *spec, const StyRun *run, StyLut **out, StyError *error) {
  StyLut *lut = NULL;
  if (sites->dims != 2) return fail_sites(sites, 2, error);
  StyStatus status = sty_check_spec(spec, error);
  if (!status) status = sty_allocate_lut(spec, sites->width, sites->height, &lut, error);
  return status ? status : fill_lut(sites, engine, options, lut, run, out, error);
}

StyStatus sty_build_cube(const StySites *sites, const StyEngine *engine, const StyEngineOptions *options, int size,
                         const StyRun *run, StyLut **out, StyError *error) {
  StyLut *lut = NULL;
  if (sites->dims != 3) return fail_sites(sites, 3, error);
  const StyStatus status = sty_create_cube(size, sites->features, sites->width, sites->height, &lut, error);
  return status ? status : fill_lut(sites, engine, options, lut, run, out, error);
}

/* So many values make a row of the table that stands for them: a thread's share at a time. */
enum { ROW = 256 };

StyStatus sty_answer_values(const StySites *sites, const StyEngine *engine, const StyEngineOptions *options,
                            StyMetric metric, const float *values, size_t count, const StyRun *run, StyLut **out,
                            StyError *error) {
  if (metric == STY_METRIC_ANGLE && sites->dims != 2) return fail_sites(sites, 2, error);
  const StyLutSpec spec = {count < ROW ? (int)count : ROW, (int)((count + ROW - 1) / ROW), STY_SAMPLE_CENTRE,
                           STY_MAP_XY, metric};
  StySites searched = *sites;
  searched.levels = NULL; /* the integer measure knows texels' places only */
  StyLut *lut = NULL;
  StyStatus status = sty_allocate_lut(&spec, sites->width, sites->height, &lut, error);
  if (status) return status;
  lut->asked = values;
  lut->asked_count = count;
  status = fill_lut(&searched, engine, options, lut, run, out, error);
  if (!status) lut->asked = NULL;
  return status;
}

StyStatus sty_ask_engine(const StySites *sites, const StyEngine *engine, const StyEngineOptions *options,
                         StyMetric metric, const float *g, const StyRun *run, uint32_t *pixel, float *distance,
                         StyError *error) {
  for (int k = 0; k < sites->dims; k++)
    if (!(fabsf(g[k]) <= STY_MAX_GUIDE_VALUE))
      return sty_fail(error, STY_ERROR_INPUT, "guide value: found %g, expected a finite value within %g", (double)g[k],
                      (double)STY_MAX_GUIDE_VALUE);
  StyLut *lut = NULL;
  const StyStatus status = sty_answer_values(sites, engine, options, metric, g, 1, run, &lut, error);
  if (status) return status;
  *pixel = lut->pixels[0];
  *distance = lut->errors[0];
  sty_destroy_lut(&lut);
  return STY_OK;
}
