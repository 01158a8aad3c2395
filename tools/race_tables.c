/* Tables of a sphere, by every engine. */
#include <stdio.h>
#include <stdlib.h>

#include "options.h"
#include "races.h"
#include "stylut/guide.h"
#include "stylut/lut.h"

enum { TABLE = 256, SMALL_TABLE = 32 };

typedef struct Tables {
  StySites *sites;
  int size;
} Tables;

static StyStatus build_table(const Entrant *self, double *milliseconds, StyError *error) {
  const Tables *tables = self->subject;
  const StyLutSpec spec = {.width = tables->size, .height = tables->size};
  const StyRun run = {.threads = self->threads};
  StyLut *lut = NULL;
  const double start = sty_get_milliseconds();
  const StyStatus status = sty_build_lut(tables->sites, &sty_engines[self->choice], NULL, &spec, &run, &lut, error);
  *milliseconds = sty_get_milliseconds() - start;
  sty_destroy_lut(&lut);
  return status;
}

/* All engines but brute, or brute alone, beside FLANN's exact tree. */
static void enter_engines(Race *race, Tables *tables, const char *what, bool all, int threads) {
  const StyEngine *peer = NULL;
  const int first = race->count;
  if (sty_find_engine("bench", "flann-single", &peer, NULL)) return;
  int reference = -1;
  for (int e = 0; sty_engines[e].name; e++) {
    const bool brute = e == 0;
    if (brute == all && &sty_engines[e] != peer) continue;
    Entrant *entrant = enter(race, (Entrant){.run = build_table,
                                             .subject = tables,
                                             .choice = e,
                                             .threads = threads,
                                             .work = (double)tables->size * tables->size / 1e6,
                                             .rate_unit = "Mtexels/s",
                                             .reference_name = peer->name});
    snprintf(entrant->row, sizeof entrant->row, "lut%s %s", what, race_threads[threads]);
    snprintf(entrant->variant, sizeof entrant->variant, "%s", sty_engines[e].name);
    if (&sty_engines[e] == peer) reference = race->count - 1;
  }
  for (int e = first; e < race->count; e++) race->entrants[e].reference = reference;
}

static StyStatus race_tables(int bits, int repeats, const StyRun *run, RaceResults *results, StyError *error) {
  StyImage *guide = NULL;
  Tables tables = {.size = TABLE}, small = {.size = SMALL_TABLE};
  Race *race = calloc(1, sizeof *race);
  StyStatus status = race ? make_sphere(bits, &guide, error) : sty_fail_memory(error, "bench", sizeof *race);
  if (!status) status = sty_collect_sites("sphere", guide, &tables.sites, error);
  small.sites = tables.sites;
  if (!status) {
    for (int threads = 1; threads <= 2; threads++)
      enter_engines(race, &tables, bits == 8 ? " 8-bit" : "", true, threads);
    if (bits != 8) enter_engines(race, &small, " small", false, 1); /* brute takes half a minute for 256 x 256 */
    status = run_race(race, repeats, run, results, error);
  }
  sty_destroy_sites(&tables.sites);
  sty_destroy_image(&guide);
  free(race);
  return status;
}

StyStatus measure_tables(int repeats, const StyRun *run, RaceResults *results, StyError *error) {
  const StyStatus status = race_tables(32, repeats, run, results, error);
  return status ? status : race_tables(8, repeats, run, results, error);
}
