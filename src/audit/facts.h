/* What a report tells beyond the audit's figures. */
#ifndef STYLUT_SRC_AUDIT_FACTS_H
#define STYLUT_SRC_AUDIT_FACTS_H

#include "stylut/report.h"

/* Directions: toward the viewer (guide values within half the radius), then eight
 * ways around, counter-clockwise from the right. */
enum { STY_SECTORS = 9, STY_RINGS = 40, STY_ENCODINGS = 4 };
extern const char *const sty_sector_names[STY_SECTORS];

int sty_find_sector(const float g[2]);

/* Where texels can be asked for but hold nothing near. */
typedef struct StySector {
  double coverage; /* share of its texels with a source pixel within the tolerance */
  double demand;   /* weight of its texels, of 1 */
} StySector;

/* Assignment error of the texels of one ring of the disc, degrees; negative where there is none. */
typedef struct StyRing {
  double p50, p95, max;
} StyRing;

/* The assignment error once the table went through an encoding. */
typedef struct StyEncodingCost {
  double mean, p99; /* degrees */
  double moved;     /* share of the texels that then name another pixel */
} StyEncodingCost;

typedef struct StyFacts {
  StySector sectors[STY_SECTORS];
  StyRing rings[STY_RINGS];
  StyEncodingCost encodings[STY_ENCODINGS]; /* by StyEncoding */
  double spread;                            /* mean of the ambiguous texels' spread, source pixels */
  bool lost_to_bytes; /* the table names only pixels that two bytes can name; an exact one names others, too */
  double rim;         /* share of the worst hundredth of assignment errors that lies beyond radius 0.95 */
} StyFacts;

StyStatus sty_gather_facts(const StyReport *report, StyFacts *out, StyError *error);

/* The opinion from audit and facts. */
void sty_form_opinion(const StyReport *report, const StyFacts *facts, StyOpinion *out);

#endif
