/* What `stylut bench` measures: races, whose entrants take turns, so that all of
 * them meet the same weather on the machine. Everything they work on is made
 * here; nothing needs to be installed beside the tool. */
#ifndef STYLUT_TOOLS_RACES_H
#define STYLUT_TOOLS_RACES_H

#include <stdbool.h>

#include "stylut/image.h"
#include "stylut/parallel.h"

/* A row of the benchmark: its name and variant, and how it fared. */
typedef struct RaceRow {
  char row[64], variant[64];
  int runs;
  double milliseconds;   /* median */
  double rate;           /* units of work a second */
  const char *rate_unit; /* e.g. "Mtexels/s" */
  double ratio;          /* the reference's time over this one's: above 1, this one is faster; NAN without one */
  char reference[64];    /* its variant, or what makes it differ; "" without one */
} RaceRow;

enum { MOST_RACE_ROWS = 128 };

typedef struct RaceResults {
  RaceRow rows[MOST_RACE_ROWS];
  int count;
} RaceResults;

/* ---- racing ----------------------------------------------------------------------- */

enum { MOST_ENTRANTS = 32, MOST_REPEATS = 99 };

/* Whoever can't do it (STY_ERROR_INPUT, STY_ERROR_UNAVAILABLE) is left out. */
typedef struct Entrant {
  char row[64], variant[64];
  StyStatus (*run)(const struct Entrant *self, double *milliseconds, StyError *error);
  void *subject; /* what it works on */
  int choice;    /* which of several ways */
  int threads;
  double work; /* of one run, in what `rate_unit` counts */
  const char *rate_unit;
  int reference; /* place in the race; -1: none */
  const char *reference_name;
  double times[MOST_REPEATS];
  int runs;
  bool left_out; /* it can't do this, or isn't built in */
} Entrant;

typedef struct Race {
  Entrant entrants[MOST_ENTRANTS];
  int count;
} Race;

/* "1 thread", "2 threads", by their number. */
extern const char *const race_threads[];

/* Copies an entrant into the race, at its end. */
Entrant *enter(Race *race, Entrant entrant);

/* Everybody runs once, then everybody again; adds the rows. */
StyStatus run_race(Race *race, int repeats, const StyRun *run, RaceResults *results, StyError *error);

/* ---- what they race on ------------------------------------------------------------ */

/* A sphere that fills a picture of SPHERE x SPHERE pixels, in float or rounded to 8 bits. */
enum { SPHERE = 512 };
StyStatus make_sphere(int bits, StyImage **out, StyError *error);

/* A part of the benchmark: adds its rows, each time the median of `repeats` runs. */
typedef StyStatus RaceMeasure(int repeats, const StyRun *run, RaceResults *results, StyError *error);
RaceMeasure measure_tables, measure_guides, measure_packing, measure_stylizing;

typedef struct RacePart {
  const char *name;
  RaceMeasure *measure;
} RacePart;

/* The last has a NULL name. */
extern const RacePart race_parts[];

#endif
