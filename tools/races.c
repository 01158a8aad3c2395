#include "races.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "stylut/chart.h"
#include "stylut/guide.h"

const char *const race_threads[] = {"", "1 thread", "2 threads"};

Entrant *enter(Race *race, Entrant entrant) {
  race->entrants[race->count] = entrant;
  return &race->entrants[race->count++];
}

static StyStatus run_rounds(Race *race, int repeats, const StyRun *run, StyError *error) {
  for (int round = 0; round < repeats; round++)
    for (int e = 0; e < race->count; e++) {
      Entrant *entrant = &race->entrants[e];
      StyError own = {STY_OK, ""};
      StyStatus status = STY_OK;
      if (!entrant->left_out) status = entrant->run(entrant, &entrant->times[entrant->runs], &own);
      entrant->left_out |= status == STY_ERROR_INPUT || status == STY_ERROR_UNAVAILABLE;
      entrant->runs += !entrant->left_out;
      if (status && !entrant->left_out) {
        *error = own;
        return status;
      }
      if (run->progress) run->progress(run->context, (double)(round * race->count + e + 1) / (repeats * race->count));
    }
  return STY_OK;
}

static void add_row(RaceResults *results, const Race *race, const double *medians, int e) {
  const Entrant *entrant = &race->entrants[e];
  const bool referred = entrant->reference >= 0 && race->entrants[entrant->reference].runs > 0;
  RaceRow *row = &results->rows[results->count++];
  *row = (RaceRow){.runs = entrant->runs,
                   .milliseconds = medians[e],
                   .rate = entrant->work / medians[e] * 1e3,
                   .rate_unit = entrant->rate_unit,
                   .ratio = referred ? medians[entrant->reference] / medians[e] : NAN};
  memcpy(row->row, entrant->row, sizeof row->row);
  memcpy(row->variant, entrant->variant, sizeof row->variant);
  if (referred) snprintf(row->reference, sizeof row->reference, "%s", entrant->reference_name);
}

StyStatus run_race(Race *race, int repeats, const StyRun *run, RaceResults *results, StyError *error) {
  double medians[MOST_ENTRANTS];
  const StyStatus status = run_rounds(race, repeats, run, error);
  if (status) return status;
  for (int e = 0; e < race->count; e++)
    if (race->entrants[e].runs) medians[e] = sty_find_median(race->entrants[e].times, race->entrants[e].runs);
  for (int e = 0; e < race->count; e++)
    if (race->entrants[e].runs) add_row(results, race, medians, e);
  return STY_OK;
}

StyStatus make_sphere(int bits, StyImage **out, StyError *error) {
  StyImage *guide = NULL, *encoded = NULL;
  StyStatus status = sty_make_sphere_guide(SPHERE, SPHERE, STY_GUIDE_NORMAL, &guide, error);
  if (!status && bits == 8) {
    status = sty_encode_normals(guide, 8, &encoded, error);
    sty_destroy_image(&guide);
    if (!status) status = sty_import_guide("sphere", &encoded, error);
    guide = encoded;
  }
  if (status)
    sty_destroy_image(&guide);
  else
    *out = guide;
  return status;
}

const RacePart race_parts[] = {{"lut", measure_tables},
                               {"guide", measure_guides},
                               {"pack", measure_packing},
                               {"stylize", measure_stylizing},
                               {NULL, NULL}};
