#include "lut/choice.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The steps' distances: the runtime's largest cells reach about as far. Twelve steps
 * along sixteen rays cost eleven times the comparisons and made the pieces no
 * larger. */
enum { FARTHEST = 40, MARGIN = FARTHEST + 1 };
static const int distances[STY_STEPS] = {4, 10, 20, FARTHEST};

/* A piece ends where guides differ by this much: the runtime's own default. */
enum { THRESHOLD = 24 };

/* Texels that no frame asks for borrow from those so near that ask. */
enum { MOST_BORROWED = 4 };

/* ---- patches ------------------------------------------------------------------ */

static uint8_t get_byte(float n) {
  const float byte = (n * 0.5f + 0.5f) * 255 + 0.5f;
  return byte > 0 ? byte < 255 ? (uint8_t)byte : 255 : 0;
}

static void set_offsets(StyPatch *patch) {
  for (int turn = 0; turn < STY_TURNS; turn++)
    for (int ray = 0; ray < STY_RAYS; ray++)
      for (int step = 0; step < STY_STEPS; step++) {
        const double angle = 2 * M_PI * (ray * STY_TURNS + turn) / (STY_RAYS * STY_TURNS);
        /* No product lies near a half, so this is the same everywhere. */
        const int dx = (int)lround(distances[step] * cos(angle)), dy = (int)lround(distances[step] * sin(angle));
        patch->offsets[turn][ray][step] = dy * patch->pitch + dx;
      }
}

static void free_patch(StyPatch *patch) { free(patch->block); }

/* Uncovered pixels hold `nothing` in all three bytes: 0 in frames and 255 in
 * sources, so that they agree with nothing, each other included. */
static StyStatus open_patch(const StyImage *guide, int nothing, StyPatch *out, StyError *error) {
  const float *covered = sty_find_channel(guide, "A");
  const float *normal[3] = {sty_find_channel(guide, "normal.X"), sty_find_channel(guide, "normal.Y"),
                            sty_find_channel(guide, "normal.Z")};
  if (!covered || !normal[0] || !normal[1])
    return sty_fail(error, STY_ERROR_INPUT, "frames: found a guide without normals, expected channels A, normal.*");
  StyPatch patch = {.pitch = guide->width + 2 * MARGIN};
  const size_t pitch = (size_t)patch.pitch, size = pitch * (size_t)(guide->height + 2 * MARGIN);
  patch.block = malloc(size * sizeof *patch.block);
  if (!patch.block) return sty_fail_memory(error, "frames", (double)size * 4);
  memset(patch.block, nothing, size * sizeof *patch.block);
  patch.bytes = patch.block + MARGIN * pitch + MARGIN;
  for (size_t y = 0; y < (size_t)guide->height; y++)
    for (size_t x = 0; x < (size_t)guide->width; x++) {
      const size_t p = y * (size_t)guide->width + x;
      if (!(covered[p] > 0)) continue;
      const float z = normal[2] ? normal[2][p] : sty_get_height(normal[0][p], normal[1][p]);
      const float n[3] = {normal[0][p], normal[1][p], z};
      for (int k = 0; k < 3; k++) patch.bytes[y * pitch + x][k] = get_byte(n[k]);
    }
  set_offsets(&patch);
  *out = patch;
  return STY_OK;
}

/* ---- who asks ----------------------------------------------------------------- */

/* The texel that a frame's pixel asks for; `texels`, one more than there are, for none. */
static size_t find_asked_texel(const StyLut *lut, const float *const planes[3], size_t pixel, size_t texels) {
  int t[2];
  if (!(planes[0][pixel] > 0)) return texels;
  sty_find_texel(&lut->spec, (const float[2]){planes[1][pixel], planes[2][pixel]}, t);
  return (size_t)t[1] * (size_t)lut->spec.width + (size_t)t[0];
}

/* Who asks for texels: of all that there are, evenly spaced ones. */
static StyStatus find_askers(const StyLut *lut, const StyImage *const *frames, StyServe *serve, StyError *error) {
  const size_t texels = sty_count_texels(&lut->spec);
  uint32_t *count = calloc(2 * (texels + 1), sizeof *count);
  if (!count) return sty_fail_memory(error, "frames", (double)texels * 8);
  uint32_t *seen = count + texels + 1;
  for (int pass = 0; pass < 2; pass++)
    for (int f = 0; f < serve->frame_count; f++) {
      const size_t width = (size_t)frames[f]->width, pixels = sty_count_pixels(frames[f]);
      const float *const planes[3] = {sty_find_channel(frames[f], "A"), sty_find_channel(frames[f], "normal.X"),
                                      sty_find_channel(frames[f], "normal.Y")};
      for (size_t p = 0; p < pixels; p++) {
        const size_t texel = find_asked_texel(lut, planes, p, texels);
        if (pass == 0) count[texel]++;
        if (pass == 0 || texel == texels) continue;
        const uint64_t most = count[texel] < STY_MOST_ASKERS ? count[texel] : STY_MOST_ASKERS;
        StyAsker *slot = &serve->askers[texel][seen[texel]++ * most / count[texel]];
        if (slot->frame == STY_NO_FRAME) *slot = (StyAsker){(uint16_t)f, (uint16_t)(p % width), (uint16_t)(p / width)};
      }
    }
  size_t asking = 0;
  for (size_t t = 0; t < texels; t++) asking += count[t];
  free(count);
  return asking ? STY_OK
                : sty_fail(error, STY_ERROR_INPUT, "found no covered pixel in the frames, expected one to serve");
}

/* Gives texel (i, j) the askers of a neighbour that had some before round r. */
static void borrow_askers(const StyLut *lut, StyServe *serve, uint8_t *round, int r, int i, int j) {
  const int width = lut->spec.width, height = lut->spec.height;
  const size_t texel = (size_t)j * (size_t)width + (size_t)i;
  for (int s = 0; s < 4 && !sty_has_askers(serve, texel); s++) {
    const int x = i + sty_steps[s][0], y = j + sty_steps[s][1];
    if (x < 0 || y < 0 || x >= width || y >= height) continue;
    const size_t other = (size_t)y * (size_t)width + (size_t)x;
    if (!sty_has_askers(serve, other) || round[other] >= r) continue;
    memcpy(serve->askers[texel], serve->askers[other], sizeof *serve->askers);
    round[texel] = (uint8_t)r;
  }
}

/* One texel's width outward at a time. */
static StyStatus lend_askers(const StyLut *lut, StyServe *serve, StyError *error) {
  const size_t texels = sty_count_texels(&lut->spec);
  uint8_t *round = calloc(texels, 1); /* in which one a texel got its askers */
  if (!round) return sty_fail_memory(error, "frames", (double)texels);
  for (int r = 1; r <= MOST_BORROWED; r++)
    for (int j = 0; j < lut->spec.height; j++)
      for (int i = 0; i < lut->spec.width; i++) borrow_askers(lut, serve, round, r, i, j);
  free(round);
  return STY_OK;
}

/* ---- serving ------------------------------------------------------------------ */

StyStatus sty_open_serve(const StyLut *lut, const StyImage *guide, const StyImage *const *frames, int frame_count,
                         StyServe *out, StyError *error) {
  const size_t texels = sty_count_texels(&lut->spec);
  StyServe serve = {.frames = calloc((size_t)frame_count, sizeof *serve.frames), .frame_count = frame_count};
  serve.askers = malloc(texels * sizeof *serve.askers);
  StyStatus status =
      serve.frames && serve.askers ? STY_OK : sty_fail_memory(error, "frames", (double)texels * sizeof *serve.askers);
  if (!status) {
    memset(serve.askers, 0xff, texels * sizeof *serve.askers);
    status = open_patch(guide, 255, &serve.source, error);
  }
  for (int f = 0; !status && f < frame_count; f++) status = open_patch(frames[f], 0, &serve.frames[f], error);
  if (!status) status = find_askers(lut, frames, &serve, error);
  if (!status) status = lend_askers(lut, &serve, error);
  if (status)
    sty_close_serve(&serve);
  else
    *out = serve;
  return status;
}

void sty_close_serve(StyServe *serve) {
  free_patch(&serve->source);
  for (int f = 0; serve->frames && f < serve->frame_count; f++) free_patch(&serve->frames[f]);
  free(serve->frames);
  free(serve->askers);
  *serve = (StyServe){0};
}

static bool agree(const uint8_t a[4], const uint8_t b[4]) {
  int sum = 0;
  for (int k = 0; k < 3; k++) sum += abs(a[k] - b[k]);
  return sum < THRESHOLD;
}

static const uint8_t (*get_place(const StyPatch *patch, int x, int y))[4] {
  return (const uint8_t(*)[4])patch->bytes + (ptrdiff_t)y * patch->pitch + x;
}

float sty_measure_service(const StyServe *serve, size_t texel, int x, int y) {
  const uint8_t(*const source)[4] = get_place(&serve->source, x, y);
  int squares = 0, count = 0;
  for (; count < STY_MOST_ASKERS && serve->askers[texel][count].frame != STY_NO_FRAME; count++) {
    const StyAsker *asker = &serve->askers[texel][count];
    const StyPatch *patch = &serve->frames[asker->frame];
    const uint8_t(*const frame)[4] = get_place(patch, asker->x, asker->y);
    const int turn = count % STY_TURNS;
    for (int ray = 0; ray < STY_RAYS; ray++) {
      const int32_t *from = serve->source.offsets[turn][ray], *to = patch->offsets[turn][ray];
      int step = 0;
      while (step < STY_STEPS && agree(source[from[step]], frame[to[step]])) step++;
      if (step) squares += distances[step - 1] * distances[step - 1];
    }
  }
  return count ? (float)squares * (float)(M_PI / STY_RAYS) / (float)count : 0;
}
