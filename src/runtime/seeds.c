#include <string.h>

#include "runs.h"

size_t sty_get_seeds_size(StyRect area) {
  const int most = STY_MAX_ANCHOR + STY_MAX_FRAME_SIDE;
  if (area.x0 >= area.x1 || area.y0 >= area.y1 || area.x0 < -most || area.y0 < -most || area.x1 > most ||
      area.y1 > most)
    return 0;
  const uint64_t bytes =
      (uint64_t)(area.x1 - area.x0) * (uint64_t)(area.y1 - area.y0) * sizeof(StySeedOffset) * STY_SEED_LEVELS;
  return bytes <= SIZE_MAX / 2 ? (size_t)bytes : 0;
}

StyRuntimeStatus sty_plan_seeds(const StyBundle *bundle, int style, int number, StyRect area, StySeedOffset *offsets,
                                StySeeds *out) {
  Source source;
  if (!bundle || !offsets || !out || number < 0 || sty_get_seeds_size(area) == 0) return STY_RUNTIME_BAD_ARGUMENT;
  const StyRuntimeStatus status = open_source(bundle, style, number, 0, &source);
  if (status == STY_RUNTIME_OK) *out = (StySeeds){area, source.jitter_table, source.jitter_amount, offsets};
  return status;
}

static bool are_seeds_valid(const StyBundle *bundle, const StySeeds *seeds, int y0, int y1) {
  if (!bundle || !seeds || !seeds->offsets || sty_get_seeds_size(seeds->area) == 0) return false;
  if (y0 < seeds->area.y0 || y0 > y1 || y1 > seeds->area.y1 || seeds->amount < 0 || seeds->amount > 255) return false;
  return seeds->table >= 0 && (uint32_t)seeds->table < bundle->textures[STY_BUNDLE_JITTER].layers;
}

static void find_row(const unsigned char *jitter, int amount, Point p, int count, int level, StySeedOffset *out) {
  for (int k = 0; k < count; k++) {
    const Point seed = find_seed(jitter, amount, (Point){p.x + k, p.y}, level);
    out[k] = (StySeedOffset){(int8_t)(seed.x - p.x - k), (int8_t)(seed.y - p.y)};
  }
}

static void find_row_by(StyRuntimePath path, const unsigned char *jitter, int amount, Point p, int count, int level,
                        StySeedOffset *out) {
  switch (path) {
    case STY_PATH_PORTABLE: sty_fill_seeds_portable(jitter, amount, p, count, level, out); break;
    case STY_PATH_AVX2: sty_fill_seeds_avx2(jitter, amount, p, count, level, out); break;
    case STY_PATH_AVX512: sty_fill_seeds_avx512(jitter, amount, p, count, level, out); break;
    default: find_row(jitter, amount, p, count, level, out);
  }
}

/* The table repeats every 256 cells, so low levels are mostly copies. `row` is that of y, y0 the first to be filled. */
static void fill_row(StyRuntimePath path, const unsigned char *jitter, const StySeeds *seeds, int level, int y, int y0,
                     StySeedOffset *row) {
  const int width = seeds->area.x1 - seeds->area.x0;
  const int period = path == STY_PATH_REFERENCE ? INT32_MAX : STY_JITTER_SIZE << level;
  if (y - y0 >= period) {
    memcpy(row, row - (size_t)period * (size_t)width, sizeof *row * (size_t)width);
    return;
  }
  const int fresh = width < period ? width : period;
  find_row_by(path, jitter, seeds->amount, (Point){seeds->area.x0, y}, fresh, level, row);
  for (int k = fresh; k < width; k += fresh)
    memcpy(row + k, row, sizeof *row * (size_t)(width - k < fresh ? width - k : fresh));
}

StyRuntimeStatus sty_fill_seeds(const StyBundle *bundle, const StySeeds *seeds, int y0, int y1, StyRuntimePath path) {
  if (!are_seeds_valid(bundle, seeds, y0, y1) || !sty_has_path(path)) return STY_RUNTIME_BAD_ARGUMENT;
  const unsigned char *jitter = get_layer(&bundle->textures[STY_BUNDLE_JITTER], (size_t)seeds->table);
  const StyRect area = seeds->area;
  const size_t width = (size_t)(area.x1 - area.x0), height = (size_t)(area.y1 - area.y0);
  const StyRuntimePath chosen = sty_choose_path(path);
  for (int level = 1; level <= STY_SEED_LEVELS; level++)
    for (int y = y0; y < y1; y++)
      fill_row(chosen, jitter, seeds, level, y, y0,
               seeds->offsets + ((size_t)(level - 1) * height + (size_t)(y - area.y0)) * width);
  return STY_RUNTIME_OK;
}
