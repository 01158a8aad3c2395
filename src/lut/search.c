#include "lut/search.h"

#include <stdlib.h>

#include "base/processor.h"

typedef void AnswerBlocks(const StySearchJob *job, int j0);

static AnswerBlocks *choose_unit(void) {
#ifdef __x86_64__
  switch (sty_get_vector_unit()) {
    case STY_UNIT_AVX512: return sty_answer_blocks_avx512;
    case STY_UNIT_AVX2: return sty_answer_blocks_avx2;
    default: break;
  }
#endif
  return sty_answer_blocks_plain;
}

typedef struct Work {
  StySearchJob job;
  AnswerBlocks *answer;
} Work;

static StyStatus answer_row(void *context, long row, StyError *error) {
  (void)error;
  const Work *work = context;
  work->answer(&work->job, (int)row * STY_BLOCK_SIDE);
  return STY_OK;
}

/* What a table's columns and rows ask for, in one block of memory. */
static float *list_places(const StyLutSpec *spec) {
  float *places = malloc(((size_t)spec->width + (size_t)spec->height) * sizeof *places);
  float g[2];
  for (int i = 0; places && i < spec->width; i++) {
    sty_get_texel_value(spec, i, 0, g);
    places[i] = g[0];
  }
  for (int j = 0; places && j < spec->height; j++) {
    sty_get_texel_value(spec, 0, j, g);
    places[spec->width + j] = g[1];
  }
  return places;
}

StyStatus sty_search_blocks(const StyCells *cells, const StyTree *tree, const StyMeasure *measure, StyLut *lut,
                            const StyRun *run, StyError *error) {
  const StyLutSpec *spec = &lut->spec;
  const bool share = !lut->asked && spec->map == STY_MAP_XY;
  float *places = share ? list_places(spec) : NULL;
  if (share && !places) return sty_fail_memory(error, "engine grid", ((double)spec->width + spec->height) * 4);
  Work work = {{cells, tree, measure, lut, places, share ? places + spec->width : NULL}, choose_unit()};
  const StyStatus status =
      sty_parallel_for(run, (spec->height + STY_BLOCK_SIDE - 1) / STY_BLOCK_SIDE, answer_row, &work, error);
  free(places);
  return status;
}
