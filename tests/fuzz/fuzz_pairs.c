/* Files of point pairs: the fuzzer's bytes are the file, and what it says is solved, by every kind. */
#include <math.h>

#include "fuzz.h"
#include "stylut/warp.h"

static void check_field(StyPairs *pairs, StyWarpKind kind) {
  StyImage *field = NULL;
  StyWarpFigures figures;
  StyError error;
  pairs->kind = kind;
  const StyStatus status = sty_make_warp_guide("pairs", pairs, 5, 3, &(StyRun){.threads = 1}, &figures, &field, &error);
  if (status) {
    require(kind == STY_WARP_AFFINE); /* points on a line; all else was checked before */
    require_message(status, &error);
    return;
  }
  for (int i = 0; i < 45; i++) require(isfinite(field->data[i]));
  require(isfinite(figures.stretch) && isfinite(figures.compression) && isfinite(figures.residual_max));
  require(figures.inside <= 15 && figures.folded <= figures.cells && figures.cells == 8);
  sty_destroy_image(&field);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  StyPairs pairs;
  StyError error;
  const StyStatus status = sty_read_pairs(put_file("pairs.json", data, size), &pairs, &error);
  if (status) {
    require_message(status, &error);
    return 0;
  }
  require(pairs.count >= 1 && pairs.count <= STY_MAX_PAIRS);
  require(pairs.alpha >= STY_MIN_WARP_ALPHA && pairs.alpha <= STY_MAX_WARP_ALPHA);
  for (int kind = STY_WARP_AFFINE; kind <= STY_WARP_RIGID; kind++) check_field(&pairs, (StyWarpKind)kind);
  sty_free_pairs(&pairs);
  return 0;
}
