#include "view.h"

/* floor(h * (b + amount * jitter)): h*b is whole, so only the jitter is rounded. */
static Point place_seed(const unsigned char *jitter, int amount, int cell_x, int cell_y, int h) {
  const size_t column = (unsigned)cell_x % STY_JITTER_SIZE, row = (unsigned)cell_y % STY_JITTER_SIZE;
  const unsigned char *j = jitter + (row * STY_JITTER_SIZE + column) * 2;
  const int reach = h * amount;
  return (Point){h * cell_x + reach * j[0] / (255 * 255), h * cell_y + reach * j[1] / (255 * 255)};
}

/* The order of the loops and the strict comparison decide between seeds that
 * are equally near. */
Point sty_find_seed(const unsigned char *jitter, int amount, Point p, int level) {
  const int cell_x = shift_down(p.x, level), cell_y = shift_down(p.y, level);
  Point nearest = {0, 0};
  int least = INT32_MAX;
  for (int dx = -1; dx <= 1; dx++)
    for (int dy = -1; dy <= 1; dy++) {
      const Point seed = place_seed(jitter, amount, cell_x + dx, cell_y + dy, 1 << level);
      const int distance = (seed.x - p.x) * (seed.x - p.x) + (seed.y - p.y) * (seed.y - p.y);
      if (distance < least) {
        least = distance;
        nearest = seed;
      }
    }
  return nearest;
}

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

StyRuntimeStatus sty_fill_seeds(const StyBundle *bundle, const StySeeds *seeds, int y0, int y1, StyRuntimePath path) {
  if (!are_seeds_valid(bundle, seeds, y0, y1) || !sty_has_path(path)) return STY_RUNTIME_BAD_ARGUMENT;
  const unsigned char *jitter = get_layer(&bundle->textures[STY_BUNDLE_JITTER], (size_t)seeds->table);
  const StyRect area = seeds->area;
  const size_t width = (size_t)(area.x1 - area.x0), height = (size_t)(area.y1 - area.y0);
  for (int level = 1; level <= STY_SEED_LEVELS; level++)
    for (int y = y0; y < y1; y++) {
      StySeedOffset *row = seeds->offsets + ((size_t)(level - 1) * height + (size_t)(y - area.y0)) * width;
      for (int x = area.x0; x < area.x1; x++) {
        const Point seed = sty_find_seed(jitter, seeds->amount, (Point){x, y}, level);
        row[x - area.x0] = (StySeedOffset){(int8_t)(seed.x - x), (int8_t)(seed.y - y)};
      }
    }
  return STY_RUNTIME_OK;
}
