#include "guide/kernels.h"

#include "base/processor.h"

const StyKernels *sty_get_kernels(void) {
#ifdef __x86_64__
  switch (sty_get_vector_unit()) {
    case STY_UNIT_AVX512: return &sty_kernels_avx512;
    case STY_UNIT_AVX2: return &sty_kernels_avx2;
    default: break;
  }
#endif
  return &sty_kernels_plain;
}
