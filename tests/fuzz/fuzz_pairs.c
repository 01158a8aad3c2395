/* Files of point pairs: the fuzzer's bytes are the file, and what it says is solved, by every kind. */
#include <math.h>

#include "fuzz.h"
#include "guide/pairs.h"
#include "stylut/warp.h"

static void check_field(StyPairs *pairs, StyWarpKind kind) {
  StyImage *field = NULL;
  StyWarpFigures figures;
  StyError error;
  pairs->kind = kind;
  const StyStatus status = sty_make_warp_guide("pairs", pairs, 5, 3, &(StyRun){.threads = 1}, &figures, &field, &error);
  if (status) {
    require(kind == STY_WARP_AFFINE); /* points on a line; all else was checked before, or is brought about here */
    require_message(status, &error);
    return;
  }
  for (int i = 0; i < 45; i++) require(isfinite(field->data[i]));
  require(isfinite(figures.stretch) && isfinite(figures.compression) && isfinite(figures.residual_max));
  require(figures.inside <= 15 && figures.folded <= figures.cells && figures.cells == 8);
  sty_destroy_image(&field);
}

/* The first pair to a corner of the picture, with the others around it: they may be too near then to be told apart. */
static bool bring_inside(StyPairs *pairs) {
  const double corner[2] = {pairs->pairs[0].to[0], pairs->pairs[0].to[1]};
  for (int i = 0; i < pairs->count; i++)
    for (int k = 0; k < 2; k++) {
      pairs->pairs[i].to[k] -= corner[k];
      if (fabs(pairs->pairs[i].to[k]) > (pairs->normalized ? 1e3 : STY_MAX_PAIR_COORDINATE)) return false;
    }
  int earlier;
  bool is_to;
  return sty_find_repeated_point(pairs->pairs, pairs->count, &earlier, &is_to) < 0;
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
  const bool is_inside = bring_inside(&pairs);
  for (int kind = STY_WARP_AFFINE; is_inside && kind <= STY_WARP_RIGID; kind++) check_field(&pairs, (StyWarpKind)kind);
  sty_free_pairs(&pairs);
  return 0;
}
