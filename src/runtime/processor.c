#include "runs.h"

#ifdef STY_HAS_X86
static bool has_avx2(void) { return __builtin_cpu_supports("avx2"); }
static bool has_avx512(void) {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
}
#else
static bool has_avx2(void) { return false; }
static bool has_avx512(void) { return false; }
#endif

int sty_has_path(StyRuntimePath path) {
  switch (path) {
    case STY_PATH_BEST:
    case STY_PATH_REFERENCE:
    case STY_PATH_PORTABLE: return 1;
    case STY_PATH_AVX2: return has_avx2();
    case STY_PATH_AVX512: return has_avx512();
  }
  return 0;
}

StyRuntimePath sty_choose_path(StyRuntimePath path) {
  if (path != STY_PATH_BEST) return path;
  return has_avx512() ? STY_PATH_AVX512 : has_avx2() ? STY_PATH_AVX2 : STY_PATH_PORTABLE;
}
