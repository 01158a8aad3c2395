/* Compiled with the flags for this unit, on processors that may have it. */
#ifdef __AVX512F__
#define KERNELS sty_kernels_avx512
#include "guide/kernel_bodies.h"
#endif
