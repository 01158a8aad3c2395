/* Compiled with the flags for this unit, on processors that may have it. */
#ifdef __AVX2__
#define KERNELS sty_kernels_avx2
#include "guide/kernel_bodies.h"
#endif
