#include <stdbool.h>
#include <stdlib.h>

#include "stylut/measure.h"

/* ---- pieces ---- */

/* Whether a step of one pixel of the picture is one in the source, too: 1/scale pixels, rounded either way. */
static bool is_step(int distance, int pixels, float scale) {
  const float exact = (float)pixels / scale;
  return (float)distance > exact - 1 && (float)distance < exact + 1;
}

static bool belong_together(const StyMatch *a, const StyMatch *b, int dx, int dy, const float *scales) {
  if (a->level == STY_LEVEL_NONE || b->level == STY_LEVEL_NONE || a->style != b->style || a->layer != b->layer)
    return false;
  return is_step(b->x - a->x, dx, scales[a->style]) && is_step(b->y - a->y, dy, scales[a->style]);
}

static uint32_t find_root(uint32_t *parents, uint32_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

static void join(uint32_t *parents, uint32_t a, uint32_t b) {
  const uint32_t root_a = find_root(parents, a), root_b = find_root(parents, b);
  parents[root_a > root_b ? root_a : root_b] = root_a < root_b ? root_a : root_b;
}

static void join_neighbours(const StyShot *shot, const float *scales, uint32_t *parents) {
  const uint32_t width = (uint32_t)shot->width, height = (uint32_t)shot->height;
  for (uint32_t i = 0; i < width * height; i++) parents[i] = i;
  for (uint32_t i = 0; i < width * height; i++) {
    const StyMatch *match = &shot->matches[i];
    if (i % width > 0 && belong_together(match - 1, match, 1, 0, scales)) join(parents, i - 1, i);
    if (i >= width && belong_together(match - width, match, 0, 1, scales)) join(parents, i - width, i);
  }
}

StyStatus sty_measure_chunks(const StyShot *shot, const float *scales, StyChunks *out, StyError *error) {
  const size_t pixels = (size_t)shot->width * (size_t)shot->height;
  uint32_t *parents = malloc(pixels * sizeof *parents), *areas = calloc(pixels, sizeof *areas);
  if (!parents || !areas) {
    free(parents);
    free(areas);
    return sty_fail_memory(error, "chunks", (double)(2 * pixels * sizeof *areas));
  }
  StyChunks chunks = {0};
  double squares = 0;
  join_neighbours(shot, scales, parents);
  for (size_t i = 0; i < pixels; i++)
    if (shot->matches[i].level != STY_LEVEL_NONE) areas[find_root(parents, (uint32_t)i)]++;
  for (size_t i = 0; i < pixels; i++) {
    chunks.count += areas[i] > 0;
    chunks.pixels += areas[i];
    squares += (double)areas[i] * (double)areas[i];
    if (areas[i] > chunks.largest) chunks.largest = areas[i];
  }
  if (chunks.pixels) {
    chunks.mean = (double)chunks.pixels / (double)chunks.count;
    chunks.weighted = squares / (double)chunks.pixels;
  }
  free(parents);
  free(areas);
  *out = chunks;
  return STY_OK;
}

/* ---- levels ---- */

void sty_measure_levels(const StyShot *shot, StyLevels *out) {
  const size_t pixels = (size_t)shot->width * (size_t)shot->height;
  size_t counts[STY_LEVEL_NONE + 1] = {0};
  for (size_t i = 0; i < pixels; i++) counts[shot->matches[i].level]++;
  *out = (StyLevels){.pixels = pixels - counts[STY_LEVEL_NONE]};
  if (!out->pixels) return;
  for (int level = 0; level <= STY_MAX_LEVEL; level++) out->share[level] = (double)counts[level] / (double)out->pixels;
  out->fallback = (double)counts[STY_LEVEL_FALLBACK] / (double)out->pixels;
}
