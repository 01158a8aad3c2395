/* The fast forms of the passes. They work on runs, pixels side by side that have the same source and anchor. What is
 * the same for all of them is in runs_body.h, which a file per vector unit includes. */
#ifndef STYLUT_RUNTIME_RUNS_H
#define STYLUT_RUNTIME_RUNS_H

#include <string.h>

#include "blend.h"

enum { RUN_LENGTH = 256, WORD = 64 };

typedef struct Run {
  const Source *source;
  const StyFrame *frame;
  Point anchor;
  int x, y, length;
  size_t first;      /* its first pixel's place in the frame */
  StyMatch *matches; /* of its first pixel */
} Run;

/* Pixels of a run that no level has served yet, a bit each; the last word lets vectors read beyond the end. */
typedef struct Waiting {
  uint64_t words[RUN_LENGTH / WORD + 1];
} Waiting;

/* The next waiting pixel from `from` on, or `end`. */
static inline int find_waiting(const Waiting *waiting, int from, int end) {
  while (from < end) {
    const uint64_t rest = waiting->words[from / WORD] >> from % WORD;
    if (rest != 0) {
      from += __builtin_ctzll(rest);
      break;
    }
    from += WORD - from % WORD;
  }
  return from < end ? from : end;
}

static inline int find_last_waiting(const Waiting *waiting) {
  int word = RUN_LENGTH / WORD - 1;
  while (word > 0 && waiting->words[word] == 0) word--;
  return word * WORD + WORD - 1 - __builtin_clzll(waiting->words[word] | 1);
}

static inline void wait_for_all(Waiting *waiting, int length) {
  *waiting = (Waiting){{0}};
  for (int word = 0; word * WORD < length; word++)
    waiting->words[word] = length - word * WORD < WORD ? ((uint64_t)1 << length % WORD) - 1 : UINT64_MAX;
}

/* The nearest seeds of a run's pixels, less the run's first pixel. Pixels with the same seed hold the same bytes. */
typedef struct NearSeed {
  int16_t x, y;
} NearSeed;
typedef NearSeed SeedRow[RUN_LENGTH];

/* Pixels a..b-1 of a run, all with one seed, and what the seed proposes to them. */
typedef struct Segment {
  int a, b;
  NearSeed seed;
  int level;
  Proposal proposal;
} Segment;

/* Serves the waiting pixels of a segment that take its proposal, one by one. */
static inline void try_pixels_singly(const Run *run, const Segment *segment, Waiting *waiting) {
  const Source *source = run->source;
  const Proposal *proposal = &segment->proposal;
  const int y = proposal->found.y + to_source(source, -segment->seed.y);
  for (int k = segment->a; k < segment->b; k = find_waiting(waiting, k + 1, segment->b)) {
    const Point candidate = {proposal->found.x + to_source(source, k - segment->seed.x), y};
    if (!accepts(source, run->frame, run->first + (size_t)k, candidate, proposal->lighting)) continue;
    run->matches[k] = (StyMatch){.x = (uint16_t)candidate.x,
                                 .y = (uint16_t)candidate.y,
                                 .level = (uint8_t)segment->level,
                                 .layer = (uint8_t)proposal->lighting,
                                 .style = source->number};
    waiting->words[k / WORD] &= ~((uint64_t)1 << k % WORD);
  }
}

/* The seeds of the cells around a row of pixels, less its first pixel: those of columns c, c+1 and c+2 and all three
 * rows compete for the pixels (k + phase) / h = c. */
enum { MOST_CELLS = RUN_LENGTH / 2 + 3, CELL_PADDING = 16 };
typedef struct SeedGrid {
  int level, phase;
  NearSeed rows[3][MOST_CELLS + CELL_PADDING]; /* vectors read beyond the end */
} SeedGrid;

/* Styles alternate in rows where things touch: the last few stay open. */
enum { OPEN_SOURCES = 4 };
typedef struct OpenSources {
  int styles[OPEN_SOURCES]; /* 0 = none */
  Source sources[OPEN_SOURCES];
} OpenSources;

static inline StyRuntimeStatus find_source(const StyBundle *bundle, const StyFrame *frame, int style, OpenSources *open,
                                           const Source **out) {
  const int slot = style % OPEN_SOURCES;
  if (open->styles[slot] != style) {
    open->styles[slot] = 0;
    const StyRuntimeStatus status = open_source(bundle, style, frame->number, frame->resolution, &open->sources[slot]);
    if (status != STY_RUNTIME_OK) return status;
    open->styles[slot] = style;
  }
  *out = &open->sources[slot];
  return STY_RUNTIME_OK;
}

/* The fast forms, one set per vector unit. Functions rather than tables of them, which would be data to relocate. */
#define DECLARE_UNIT(unit)                                                                                     \
  StyRuntimeStatus sty_transfer_##unit(const StyBundle *bundle, const StyFrame *frame, StyRect rect,           \
                                       StyMatch *matches);                                                     \
  StyRuntimeStatus sty_blend_##unit(const Blend *blend, StyRect rect);                                         \
  /* Rows of offsets of the nearest seeds of `count` pixels from p on; levels 1..STY_SEED_LEVELS. */           \
  void sty_fill_seeds_##unit(const unsigned char *jitter, int amount, int level, Point p, int count, int rows, \
                             StySeedOffset *out, size_t stride);
DECLARE_UNIT(portable)
#if defined(__x86_64__) && defined(__GNUC__)
#define STY_HAS_X86
DECLARE_UNIT(avx2)
DECLARE_UNIT(avx512)
#else /* never chosen there, see processor.c */
#define sty_transfer_avx2 sty_transfer_portable
#define sty_transfer_avx512 sty_transfer_portable
#define sty_blend_avx2 sty_blend_portable
#define sty_blend_avx512 sty_blend_portable
#define sty_fill_seeds_avx2 sty_fill_seeds_portable
#define sty_fill_seeds_avx512 sty_fill_seeds_portable
#endif

/* The path that a frame's stands for: the best that there is for STY_PATH_BEST. */
StyRuntimePath sty_choose_path(StyRuntimePath path);

#endif
