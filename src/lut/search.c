#include "lut/search.h"

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

StyStatus sty_search_blocks(const StyCells *cells, const StyTree *tree, const StyMeasure *measure, StyLut *lut,
                            const StyRun *run, StyError *error) {
  Work work = {{cells, tree, measure, lut}, choose_unit()};
  return sty_parallel_for(run, (lut->spec.height + STY_BLOCK_SIDE - 1) / STY_BLOCK_SIDE, answer_row, &work, error);
}
