#include <math.h>
#include <string.h>

#include "lut/engine.h"
#include "stylut/parse.h"

const StyEngine sty_engines[] = {
    {"brute", "looks at every source pixel; the reference", true, sty_build_brute},
    {"analytic", "spheres that fill the picture: no search, within half a source pixel", false, sty_build_analytic},
    {"flann-single", "FLANN's single kd-tree", true, sty_build_flann_single},
    {"cgal", "CGAL's kd-tree with sliding midpoints", true, sty_build_cgal},
    {"flann-forest", "FLANN's randomized forest (--trees, --checks); approximate, and not the same from run to run",
     false, sty_build_flann_forest},
    {"flann-auto", "the index that FLANN finds fastest for --precision; approximate, and not the same from run to run",
     false, sty_build_flann_auto},
    {"grid", "stylut's own: a distance transform for 8-bit guides, cells and a packed tree for others", true,
     sty_build_grid},
    {NULL, NULL, false, NULL},
};

static const char *const fastest_exact = "grid";

const StyEngineOptions sty_default_engine_options = {.trees = 4, .checks = 32, .precision = 0.9};

StyStatus sty_find_engine(const char *what, const char *name, const StyEngine **out, StyError *error) {
  const char *names[sizeof sty_engines / sizeof *sty_engines + 1] = {"auto"};
  for (int i = 0; sty_engines[i].name; i++) names[i + 1] = sty_engines[i].name;
  int choice;
  StyStatus status = sty_parse_choice(what, name, names, &choice, error);
  if (!status && choice == 0) return sty_find_engine(what, fastest_exact, out, error);
  if (!status) *out = &sty_engines[choice - 1];
  return status;
}

StyStatus sty_build_lut(const StySites *sites, const StyEngine *engine, const StyEngineOptions *options,
                        const StyLutSpec *spec, const StyRun *run, StyLut **out, StyError *error) {
  StyLut *lut = NULL;
  StyStatus status = sty_create_lut(spec, sites->width, sites->height, &lut, error);
  if (!status) status = engine->build(sites, options ? options : &sty_default_engine_options, lut, run, error);
  if (status)
    sty_destroy_lut(&lut);
  else
    *out = lut;
  return status;
}

StyStatus sty_ask_engine(const StySites *sites, const StyEngine *engine, const StyEngineOptions *options,
                         StyMetric metric, const float g[2], const StyRun *run, uint32_t *pixel, float *distance,
                         StyError *error) {
  if (!(fabsf(g[0]) <= STY_MAX_GUIDE_VALUE && fabsf(g[1]) <= STY_MAX_GUIDE_VALUE))
    return sty_fail(error, STY_ERROR_INPUT, "guide value: found (%g, %g), expected finite values within %g",
                    (double)g[0], (double)g[1], (double)STY_MAX_GUIDE_VALUE);
  const StyLutSpec spec = {1, 1, STY_SAMPLE_CENTRE, STY_MAP_XY, metric};
  StySites values = *sites;
  values.levels = NULL; /* the integer measure knows texels' places only */
  StyLut *lut = NULL;
  StyStatus status = sty_create_lut(&spec, sites->width, sites->height, &lut, error);
  if (status) return status;
  lut->asked = g;
  status = engine->build(&values, options ? options : &sty_default_engine_options, lut, run, error);
  if (!status) {
    *pixel = lut->pixels[0];
    *distance = lut->errors[0];
  }
  sty_destroy_lut(&lut);
  return status;
}
