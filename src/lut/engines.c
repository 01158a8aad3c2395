#include <math.h>
#include <string.h>

#include "lut/engine.h"
#include "stylut/parse.h"

const StyEngine sty_engines[] = {
    {"brute", "looks at every source pixel; the reference", true, sty_build_brute},
    {"analytic", "spheres that fill the picture: no search, within half a source pixel", false, sty_build_analytic},
    {"flann-single", "FLANN's single kd-tree, ties settled as brute settles them", true, sty_build_flann_single},
    {NULL, NULL, false, NULL},
};

static const char *const fastest_exact = "flann-single";

StyStatus sty_find_engine(const char *what, const char *name, const StyEngine **out, StyError *error) {
  const char *names[sizeof sty_engines / sizeof *sty_engines + 1] = {"auto"};
  for (int i = 0; sty_engines[i].name; i++) names[i + 1] = sty_engines[i].name;
  int choice;
  StyStatus status = sty_parse_choice(what, name, names, &choice, error);
  if (!status && choice == 0) return sty_find_engine(what, fastest_exact, out, error);
  if (!status) *out = &sty_engines[choice - 1];
  return status;
}

void sty_set_texel(StyLut *lut, int i, int j, const StySites *sites, size_t site, const float g[2]) {
  const size_t texel = (size_t)j * (size_t)lut->size + (size_t)i;
  const double dx = (double)g[0] - sites->values[2 * site], dy = (double)g[1] - sites->values[2 * site + 1];
  lut->pixels[texel] = sites->pixels[site];
  lut->errors[texel] = (float)sqrt(dx * dx + dy * dy);
}

StyStatus sty_build_lut(const StySites *sites, const StyEngine *engine, int size, StySampling sampling,
                        const StyRun *run, StyLut **out, StyError *error) {
  StyLut *lut = NULL;
  StyStatus status = sty_create_lut(size, sampling, sites->width, sites->height, &lut, error);
  if (!status) status = engine->build(sites, lut, run, error);
  if (status)
    sty_destroy_lut(&lut);
  else
    *out = lut;
  return status;
}
