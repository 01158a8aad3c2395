/* What every processor can do. */
#define ANSWER_BLOCKS sty_answer_blocks_plain
#include "lut/search_blocks.h"
