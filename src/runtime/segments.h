/* What runs_segments.h works on: pixels of a run that share a seed. */
#ifndef STYLUT_RUNTIME_SEGMENTS_H
#define STYLUT_RUNTIME_SEGMENTS_H

#include "runs.h"

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
    if (!accepts(source, run->frame, run->first + (size_t)k, proposal->tilt, candidate, proposal->lighting)) continue;
    run->matches[k] = (StyMatch){.x = (uint16_t)candidate.x,
                                 .y = (uint16_t)candidate.y,
                                 .level = (uint8_t)segment->level,
                                 .layer = (uint8_t)proposal->lighting,
                                 .style = source->number};
    waiting->words[k / WORD] &= ~((uint64_t)1 << k % WORD);
  }
}

#endif
