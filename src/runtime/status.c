#include "stylut/runtime.h"

int sty_get_runtime_abi(void) { return STY_RUNTIME_ABI; }

const char *sty_describe_runtime_status(StyRuntimeStatus status) {
  switch (status) {
    case STY_RUNTIME_OK: return "done";
    case STY_RUNTIME_BAD_ARGUMENT:
      return "an argument is out of range: null pointer, empty frame, rectangle outside, or unknown style";
    case STY_RUNTIME_NOT_KTX2: return "not a KTX2 file, or its header contradicts itself";
    case STY_RUNTIME_TRUNCATED: return "the file ends before what its header announces";
    case STY_RUNTIME_WRONG_FORMAT: return "a KTX2 file, but not the kind of texture that belongs here";
    case STY_RUNTIME_MISMATCH: return "the files of the bundle don't fit each other: sizes or numbers of layers differ";
    case STY_RUNTIME_BAD_PARAMETER: return "a style's parameters are out of range";
  }
  return "unknown status";
}
