#include "guide/pairs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "stylut/json.h"

static const char *const pairs_schema = "stylut-pairs/1";

const char *const sty_warp_kinds[] = {"affine", "similarity", "rigid", NULL};

static bool are_same(const double a[2], const double b[2]) {
  return fabs(a[0] - b[0]) < STY_SAME_POINT && fabs(a[1] - b[1]) < STY_SAME_POINT;
}

int sty_find_repeated_point(const StyPair *pairs, int count, int *earlier, bool *is_to) {
  for (int i = 1; i < count; i++)
    for (int k = 0; k < i; k++) {
      *is_to = are_same(pairs[i].to, pairs[k].to);
      *earlier = k;
      if (*is_to || are_same(pairs[i].from, pairs[k].from)) return i;
    }
  return -1;
}

static StyStatus get_point(const StyDocument *document, const StyPath *path, const json_t *pair, const char *key,
                           double most, double out[2], StyError *error) {
  if (json_object_get(pair, key)) return sty_get_numbers(document, path, pair, key, -most, most, 2, out, error);
  char expected[64];
  snprintf(expected, sizeof expected, "a key \"%s\", a point [x, y]", key);
  return sty_fail_value(document, path, pair, expected, error);
}

static StyStatus read_pair(const StyDocument *document, const StyPath *path, const json_t *value, double most,
                           StyPair *out, StyError *error) {
  static const char *const known[] = {"from", "to", NULL};
  StyStatus status = sty_check_keys(document, path, value, known, error);
  if (!status) status = get_point(document, path, value, "from", most, out->from, error);
  return status ? status : get_point(document, path, value, "to", most, out->to, error);
}

static StyStatus check_repeats(const StyDocument *document, const StyPath *list, const StyPairs *pairs,
                               StyError *error) {
  int earlier = 0;
  bool is_to = false;
  const int later = sty_find_repeated_point(pairs->pairs, pairs->count, &earlier, &is_to);
  if (later < 0) return STY_OK;
  const StyPath path = {list, NULL, (size_t)later};
  const char *key = is_to ? "to" : "from";
  const json_t *pair = json_array_get(json_object_get(document->root, "pairs"), (size_t)later);
  char expected[96];
  snprintf(expected, sizeof expected, "another point than that of pairs[%d]: each may be named once", earlier);
  return sty_fail_value(document, &(StyPath){&path, key, 0}, json_object_get(pair, key), expected, error);
}

static StyStatus read_list(const StyDocument *document, StyPairs *pairs, StyError *error) {
  const json_t *list = json_object_get(document->root, "pairs");
  const StyPath path = {NULL, "pairs", 0};
  const double most = pairs->normalized ? STY_MAX_PAIR_COORDINATE / 1e3 : STY_MAX_PAIR_COORDINATE;
  if (!json_is_array(list) || json_array_size(list) < 1 || json_array_size(list) > STY_MAX_PAIRS)
    return sty_fail_value(document, list ? &path : NULL, list, "a list \"pairs\" of 1 to 4096 pairs of points", error);
  pairs->pairs = calloc(json_array_size(list), sizeof *pairs->pairs);
  if (!pairs->pairs)
    return sty_fail_memory(error, document->name, (double)json_array_size(list) * sizeof *pairs->pairs);
  StyStatus status = STY_OK;
  for (size_t i = 0; !status && i < json_array_size(list); i++)
    status = read_pair(document, &(StyPath){&path, NULL, i}, json_array_get(list, i), most, &pairs->pairs[i], error);
  pairs->count = (int)json_array_size(list);
  return status ? status : check_repeats(document, &path, pairs, error);
}

static StyStatus read_head(const StyDocument *document, StyPairs *pairs, StyError *error) {
  static const char *const known[] = {"schema", "kind", "alpha", "units", "pairs", NULL};
  static const char *const units[] = {"pixels", "normalized", NULL};
  const json_t *root = document->root;
  const char *schema = NULL;
  int kind = STY_WARP_RIGID, unit = 0;
  StyStatus status = sty_check_keys(document, NULL, root, known, error);
  if (!status) status = sty_get_string(document, NULL, root, "schema", 1, &schema, error);
  if (!status && strcmp(schema, pairs_schema) != 0)
    return sty_fail_value(document, &(StyPath){NULL, "schema", 0}, json_object_get(root, "schema"),
                          "\"stylut-pairs/1\"", error);
  if (!status) status = sty_get_choice(document, NULL, root, "kind", sty_warp_kinds, &kind, error);
  if (!status) status = sty_get_choice(document, NULL, root, "units", units, &unit, error);
  *pairs = (StyPairs){.kind = (StyWarpKind)kind, .alpha = 1, .normalized = unit == 1};
  if (status) return status;
  return sty_get_number(document, NULL, root, "alpha", STY_MIN_WARP_ALPHA, STY_MAX_WARP_ALPHA, &pairs->alpha, error);
}

StyStatus sty_read_pairs(const char *path, StyPairs *out, StyError *error) {
  StyDocument document;
  StyPairs pairs = {.pairs = NULL};
  StyStatus status = sty_read_document(path, &document, error);
  if (status) return status;
  status = read_head(&document, &pairs, error);
  if (!status) status = read_list(&document, &pairs, error);
  if (status)
    sty_free_pairs(&pairs);
  else
    *out = pairs;
  sty_close_document(&document);
  return status;
}

void sty_free_pairs(StyPairs *pairs) {
  free(pairs->pairs);
  pairs->pairs = NULL;
  pairs->count = 0;
}
