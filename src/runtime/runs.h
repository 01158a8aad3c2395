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

/* The nearest seeds of a run's pixels, less the run's first pixel. Pixels with the same seed hold the same bytes. */
typedef struct NearSeed {
  int16_t x, y;
} NearSeed;
typedef NearSeed SeedRow[RUN_LENGTH];

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
