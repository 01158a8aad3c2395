/* What every processor can do. */
#define KERNELS sty_kernels_plain
#include "guide/kernel_bodies.h"
