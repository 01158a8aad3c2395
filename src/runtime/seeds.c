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

static void find_rows(const unsigned char *jitter, int amount, int level, Point p, int count, int rows,
                      StySeedOffset *out, size_t stride) {
  for (int y = p.y; y < p.y + rows; y++, out += stride)
    for (int k = 0; k < count; k++) {
      const Point seed = find_seed(jitter, amount, (Point){p.x + k, y}, level);
      out[k] = (StySeedOffset){(int8_t)(seed.x - p.x - k), (int8_t)(seed.y - y)};
    }
}

static void find_rows_by(StyRuntimePath path, const unsigned char *jitter, int amount, int level, Point p, int count,
                         int rows, StySeedOffset *out, size_t stride) {
  switch (path) {
    case STY_PATH_PORTABLE: sty_fill_seeds_portable(jitter, amount, level, p, count, rows, out, stride); break;
    case STY_PATH_AVX2: sty_fill_seeds_avx2(jitter, amount, level, p, count, rows, out, stride); break;
    case STY_PATH_AVX512: sty_fill_seeds_avx512(jitter, amount, level, p, count, rows, out, stride); break;
    default: find_rows(jitter, amount, level, p, count, rows, out, stride);
  }
}

/* One level of the rows y0..y1-1. The table repeats every 256 cells, so low levels are mostly copies. */
static void fill_level(StyRuntimePath path, const unsigned char *jitter, const StySeeds *seeds, int level, int y0,
                       int y1) {
  const StyRect area = seeds->area;
  const int width = area.x1 - area.x0, rows = y1 - y0;
  const int period = path == STY_PATH_REFERENCE ? INT32_MAX : STY_JITTER_SIZE << level;
  const int fresh_width = width < period ? width : period, fresh_rows = rows < period ? rows : period;
  const size_t stride = (size_t)width, plane = stride * (size_t)(area.y1 - area.y0);
  StySeedOffset *out = seeds->offsets + (size_t)(level - 1) * plane + (size_t)(y0 - area.y0) * stride;
  find_rows_by(path, jitter, seeds->amount, level, (Point){area.x0, y0}, fresh_width, fresh_rows, out, stride);
  for (int row = 0; row < rows; row++) {
    StySeedOffset *offsets = out + (size_t)row * stride;
    if (row >= fresh_rows)
      memcpy(offsets, offsets - (size_t)period * stride, sizeof *out * stride);
    else
      for (int k = fresh_width; k < width; k += fresh_width)
        memcpy(offsets + k, offsets, sizeof *out * (size_t)(width - k < fresh_width ? width - k : fresh_width));
  }
}

StyRuntimeStatus sty_fill_seeds(const StyBundle *bundle, const StySeeds *seeds, int y0, int y1, StyRuntimePath path) {
  if (!are_seeds_valid(bundle, seeds, y0, y1) || !sty_has_path(path)) return STY_RUNTIME_BAD_ARGUMENT;
  const unsigned char *jitter = get_layer(&bundle->textures[STY_BUNDLE_JITTER], (size_t)seeds->table);
  for (int level = 1; level <= STY_SEED_LEVELS; level++)
    fill_level(sty_choose_path(path), jitter, seeds, level, y0, y1);
  return STY_RUNTIME_OK;
}
