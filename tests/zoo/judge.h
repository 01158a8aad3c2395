/* What engines, and libraries on their own, make of a guide: claims held against
 * brute force. */
#ifndef STYLUT_TESTS_ZOO_JUDGE_H
#define STYLUT_TESTS_ZOO_JUDGE_H

#include "lut/engine.h"
#include "stylut/audit.h"

typedef enum ZooOutcome {
  ZOO_NOTHING,     /* not judged yet */
  ZOO_EXACT,       /* the bytes of brute force */
  ZOO_APPROXIMATE, /* valid answers of an engine that doesn't claim exactness */
  ZOO_CALM,        /* coherent tables: within the slack, and no more jumps than before */
  ZOO_REFUSED,     /* the guide or the question, with the message that it was to have */
  ZOO_UNSUITED,    /* the engine isn't for such guides, and says so */
  ZOO_NOT_BUILT,   /* the engine isn't in this build */
  ZOO_BROKEN,      /* a claim doesn't hold: see the note */
  /* Of raw libraries: */
  ZOO_SAME,  /* the answers of brute force, ties too */
  ZOO_TIES,  /* other pixels, as near up to rounding */
  ZOO_WRONG, /* farther pixels, or none */
  ZOO_BLIND, /* no error where there is no answer */
  ZOO_ERROR, /* said to have failed */
  /* Of the process: */
  ZOO_CRASHED,
  ZOO_HUNG
} ZooOutcome;

typedef struct ZooVerdict {
  ZooOutcome outcome;
  size_t texels;               /* looked at */
  size_t right;                /* ZOO_APPROXIMATE: as near as any */
  double worst;                /* ZOO_APPROXIMATE: largest excess, guide units */
  size_t pairs, before, after; /* ZOO_CALM: feasible neighbours, jumps in the exact table and in the coherent one */
  size_t ties, wrong;          /* of raw libraries' answers */
  int signal;                  /* ZOO_CRASHED; 0: it ended without a word */
  char note[1200];             /* of what is broken, refused or unsuited: a line */
} ZooVerdict;

/* Called before every table that is built, resolved or audited, where it isn't NULL: each has
 * a time of its own. */
extern void (*zoo_clock)(void);

/* Notes the first claim that doesn't hold. */
void break_verdict(ZooVerdict *verdict, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* All that a table may be, by number: sampling, map and metric. */
enum { ZOO_LOOKS = 8 };
StyLutSpec describe_zoo_look(int look, int size);

/* Each function adds to a verdict, which begins as zero. Those that judge a table
 * are called once for each. */

/* `reference` is brute force's. Exact engines must equal it, the grid under each
 * vector unit that the processor has; others must answer with covered pixels at
 * the distance stated, and their tables are resolved as well. */
void judge_engine(const StyImage *guide, const StySites *sites, const StyEngine *engine, const StyLut *reference,
                  ZooVerdict *verdict);

/* Tables resolved from `base`, every way, for a slack of two levels and for none, the
 * guide and a sphere being the frames to serve: no texel beyond the slack, and with
 * `coherent` alone no more jumps than before. */
void judge_resolve(const StyImage *guide, const StySites *sites, const StyLut *base, ZooVerdict *verdict);

/* The audit of brute force's table: figures that can be, no excess. */
void judge_audit(const StyImage *guide, const StyLut *exact, StyWeights weights, ZooVerdict *verdict);

/* A guide that is to be refused: by one line with `part` in it. */
void judge_refusal(const StyImage *guide, const char *part, ZooVerdict *verdict);

/* A question that is to be refused. */
void judge_question(const StySites *sites, const StyEngine *engine, const float asked[2], const char *part,
                    ZooVerdict *verdict);

/* Whether this verdict is of something that was promised not to be. */
bool is_claim_broken(const ZooVerdict *verdict);

#endif
