#include "stylut/audit.h"

const StyLimit sty_limits[] = {
    {"max-mean", 180, false},    {"max-p99", 180, false}, {"max-error", 180, false},  {"max-excess", 180, false},
    {"max-ambiguous", 1, false}, {"max-jumps", 1, false}, {"max-unstable", 1, false}, {"max-unused", 1, false},
    {"min-coverage", 1, true},   {NULL, 0, false},
};

double sty_get_limited(const StyAudit *audit, int limit) {
  const double found[STY_LIMITS] = {audit->lookup.mean, audit->lookup.p99, audit->lookup.max,
                                    audit->excess.mean, audit->ambiguous,  audit->jumps,
                                    audit->unstable,    audit->unused,     audit->coverage};
  return found[limit];
}

bool sty_is_within(const StyAudit *audit, int limit, double budget) {
  const double found = sty_get_limited(audit, limit);
  return sty_limits[limit].at_least ? found >= budget : found <= budget;
}
