/* Pivots of objects: the fuzzer's bytes are a file that people write, and the text of a guide's attribute. */
#include <math.h>

#include "fuzz.h"
#include "stylut/pivots.h"

static void check_pivots(const StyPivots *pivots) {
  for (size_t i = 0; i < pivots->count; i++) {
    const StyPivot *pivot = &pivots->items[i];
    require(pivot->object >= 1 && pivot->object <= STY_MOST_PIVOT_ID);
    require(fabs(pivot->x) <= STY_MAX_PIVOT && fabs(pivot->y) <= STY_MAX_PIVOT);
    require(i == 0 || pivot->object > pivots->items[i - 1].object);
  }
}

/* What is written, in thousandths, is read as the same. */
static void check_text(const StyPivots *pivots) {
  char *text = NULL;
  StyPivots again;
  require(sty_encode_pivots(pivots, &text, NULL) == STY_OK);
  require(sty_decode_pivots("again", text, &again, NULL) == STY_OK);
  require(again.count == pivots->count);
  for (size_t i = 0; i < again.count; i++)
    require(again.items[i].object == pivots->items[i].object &&
            fabs(again.items[i].x - pivots->items[i].x) <= 0.000501 &&
            fabs(again.items[i].y - pivots->items[i].y) <= 0.000501);
  sty_free_pivots(&again);
  free(text);
}

static void read_attribute(const uint8_t *data, size_t size) {
  char *text = calloc(size + 1, 1);
  StyPivots pivots;
  StyError error;
  require(text);
  memcpy(text, data, size);
  const StyStatus status = sty_decode_pivots("guide", text, &pivots, &error);
  free(text);
  if (status) {
    require_message(status, &error);
    return;
  }
  check_pivots(&pivots);
  check_text(&pivots);
  sty_free_pivots(&pivots);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  StyPivotFile file;
  StyError error;
  read_attribute(data, size);
  const StyStatus status = sty_read_pivots(put_file("pivots.json", data, size), &file, &error);
  if (status) {
    require_message(status, &error);
    return 0;
  }
  require(!file.is_for_all || file.count == 1);
  for (size_t i = 0; i < file.count; i++) {
    check_pivots(&file.frames[i].pivots);
    const StyPivots *found = sty_get_frame_pivots(&file, file.frames[i].number);
    require(found);
  }
  sty_free_pivot_file(&file);
  return 0;
}
