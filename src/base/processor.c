#include "base/processor.h"

#include <stdlib.h>
#include <string.h>

static StyVectorUnit find_widest(void) {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl"))
    return STY_UNIT_AVX512;
  if (__builtin_cpu_supports("avx2")) return STY_UNIT_AVX2;
#endif
  return STY_UNIT_PLAIN;
}

StyVectorUnit sty_get_vector_unit(void) {
  static const char *const names[] = {"plain", "avx2", "avx512"};
  const StyVectorUnit widest = find_widest();
  const char *wanted = getenv("STYLUT_VECTOR");
  for (int u = 0; wanted && u < (int)widest; u++)
    if (strcmp(wanted, names[u]) == 0) return (StyVectorUnit)u;
  return widest;
}
