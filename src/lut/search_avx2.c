/* Compiled with the flags for this unit, on processors that may have it. */
#ifdef __AVX2__
#define ANSWER_BLOCKS sty_answer_blocks_avx2
#include "lut/search_blocks.h"
#endif
