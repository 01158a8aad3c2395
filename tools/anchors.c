#include "anchors.h"

#include <math.h>
#include <stdlib.h>

#include "stylut/image.h"
#include "stylut/runtime.h"

const char *const anchor_kinds[] = {"screen", "object", NULL};

_Static_assert(2 * STY_MAX_PIVOT <= STY_MAX_ANCHOR, "pivots are places of anchors, at double resolution, too");

StyStatus check_anchors(Options *options, const AnchorOptions *anchors) {
  const OptionNeed needs[] = {{"pivots", anchors->kind == ANCHOR_OBJECT, "--anchor object"}};
  return check_needs(options, needs, 1);
}

StyStatus open_pivots(const AnchorOptions *anchors, StyPivotFile *out, StyError *error) {
  *out = (StyPivotFile){0};
  return anchors->pivots ? sty_read_pivots(anchors->pivots, out, error) : STY_OK;
}

static StyStatus round_pivots(const StyPivots *pivots, double scale, Anchors *out, StyError *error) {
  const int count = pivots->count ? pivots->items[pivots->count - 1].object + 1 : 1;
  int32_t *places = calloc(2 * (size_t)count, sizeof *places);
  if (!places) return sty_fail_memory(error, "anchors", 2.0 * count * sizeof *places);
  for (size_t i = 0; i < pivots->count; i++) {
    int32_t *place = places + 2 * pivots->items[i].object;
    place[0] = (int32_t)floor(pivots->items[i].x * scale + 0.5);
    place[1] = (int32_t)floor(pivots->items[i].y * scale + 0.5);
  }
  *out = (Anchors){places, count};
  return STY_OK;
}

static StyStatus place_from_guide(const char *guide, const StyImage *image, double scale, Anchors *out,
                                  StyError *error) {
  StyPivots pivots;
  const char *text = sty_find_attribute(image, STY_PIVOTS_ATTRIBUTE);
  if (!text)
    return sty_fail(error, STY_ERROR_INPUT,
                    "%s: found no objects' pivots in its metadata, expected those of guide scene --channels object, "
                    "or --pivots",
                    guide);
  StyStatus status = sty_decode_pivots(guide, text, &pivots, error);
  if (status) return status;
  status = round_pivots(&pivots, scale, out, error);
  sty_free_pivots(&pivots);
  return status;
}

StyStatus place_anchors(const AnchorOptions *anchors, const StyPivotFile *file, const char *guide,
                        const StyImage *image, int number, double scale, Anchors *out, StyError *error) {
  *out = (Anchors){NULL, 0};
  if (anchors->kind == ANCHOR_SCREEN) return STY_OK;
  if (!sty_find_channel(image, "object.I"))
    return sty_fail(error, STY_ERROR_INPUT, "%s: found no channel object.I, expected one for --anchor object", guide);
  if (!anchors->pivots) return place_from_guide(guide, image, scale, out, error);
  const StyPivots *pivots = sty_get_frame_pivots(file, number);
  if (!pivots)
    return sty_fail(error, STY_ERROR_INPUT, "%s: found no frame %d, expected the pivots of %s", anchors->pivots, number,
                    guide);
  return round_pivots(pivots, scale, out, error);
}
