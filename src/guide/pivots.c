#include "stylut/pivots.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "guide/film.h"
#include "scene/points.h"
#include "stylut/json.h"
#include "stylut/parse.h"

static const char *const pivots_schema = "stylut-pivots/1";

void sty_free_pivots(StyPivots *pivots) {
  free(pivots->items);
  *pivots = (StyPivots){NULL, 0};
}

static StyStatus allocate_pivots(size_t most, StyPivots *out, StyError *error) {
  *out = (StyPivots){malloc((most + 1) * sizeof *out->items), 0};
  return out->items ? STY_OK : sty_fail_memory(error, "pivots", (double)(most * sizeof *out->items));
}

/* ---- of a scene ---- */

typedef struct View {
  const StyCamera *camera;
  int width, height;
} View;

static double round_to_thousandths(double value) { return round(value * 1000) / 1000; }

/* For the parts first .. first+count-1 of an object whose pivot is at `at`, trace space. */
static void add_parts(const View *view, const double at[3], int first, int count, StyPivots *pivots) {
  double pixel[2];
  if (!sty_project_point(view->camera, view->width, view->height, at, pixel)) return;
  const double x = round_to_thousandths(pixel[0]), y = round_to_thousandths(pixel[1]);
  if (!(fabs(x) <= STY_MAX_PIVOT && fabs(y) <= STY_MAX_PIVOT)) return;
  for (int id = first; id < first + count && id <= STY_MOST_PIVOT_ID; id++)
    pivots->items[pivots->count++] = (StyPivot){id, x, y};
}

static size_t count_ids(const StyScene *scene) {
  size_t count = (size_t)scene->sphere_count;
  for (int o = 0; o < scene->object_count; o++) count += (size_t)scene->meshes[scene->objects[o].mesh]->part_count;
  return count;
}

StyStatus sty_find_pivots(const StyScene *scene, const StyCamera *camera, int width, int height, StyPivots *out,
                          StyError *error) {
  const View view = {camera, width, height};
  const StyStatus status = allocate_pivots(count_ids(scene), out, error);
  if (status) return status;
  for (int o = 0; o < scene->object_count; o++) {
    double matrix[3][4]; /* a mesh's trace space begins in the middle of its box */
    sty_get_object_matrix(scene, &scene->objects[o], matrix);
    add_parts(&view, (double[3]){matrix[0][3], matrix[1][3], matrix[2][3]}, scene->objects[o].first_id,
              scene->meshes[scene->objects[o].mesh]->part_count, out);
  }
  for (int s = 0; s < scene->sphere_count; s++) {
    double at[3];
    sty_get_trace_point(scene, scene->spheres[s].centre, at);
    add_parts(&view, at, scene->spheres[s].id, 1, out);
  }
  return STY_OK;
}

/* ---- text ---- */

/* "-12345678.125" at its longest, less the zeros that say nothing. */
static void print_number(double value, char out[32]) {
  snprintf(out, 32, "%.3f", value + 0.0); /* no -0 */
  char *end = out + strlen(out);
  while (end[-1] == '0') *--end = 0;
  if (end[-1] == '.') end[-1] = 0;
}

StyStatus sty_encode_pivots(const StyPivots *pivots, char **out, StyError *error) {
  enum { LONGEST = 2 + 5 + 2 * (1 + 12) };
  const size_t size = pivots->count * LONGEST + 1;
  char *text = malloc(size), *end = text;
  if (!text) return sty_fail_memory(error, "pivots", (double)size);
  *end = 0;
  for (size_t i = 0; i < pivots->count; i++) {
    char x[32], y[32];
    print_number(pivots->items[i].x, x);
    print_number(pivots->items[i].y, y);
    end += sprintf(end, "%s%d %s %s", i ? "; " : "", pivots->items[i].object, x, y);
  }
  *out = text;
  return STY_OK;
}

/* The next pivot of a text, and past it. */
static bool take_pivot(const char **text, int before, StyPivot *out) {
  char *first, *second, *end;
  const long object = strtol(*text, &first, 10);
  const double x = strtod(first, &second), y = strtod(second, &end);
  if (first == *text || second == first || end == second || (*end && strncmp(end, "; ", 2) != 0)) return false;
  if (!(object > before && object <= STY_MOST_PIVOT_ID && fabs(x) <= STY_MAX_PIVOT && fabs(y) <= STY_MAX_PIVOT))
    return false;
  *out = (StyPivot){(int)object, x, y};
  *text = *end ? end + 2 : end;
  return true;
}

StyStatus sty_decode_pivots(const char *name, const char *text, StyPivots *out, StyError *error) {
  size_t most = 1;
  for (const char *c = text; *c; c++) most += *c == ';';
  StyPivots pivots;
  const StyStatus status = allocate_pivots(most, &pivots, error);
  if (status) return status;
  int before = 0;
  for (const char *rest = text; *rest; before = pivots.items[pivots.count++].object) {
    const char *start = rest;
    if (take_pivot(&rest, before, &pivots.items[pivots.count])) continue;
    sty_free_pivots(&pivots);
    return sty_fail(error, STY_ERROR_INPUT,
                    "%s: found '%.40s' in " STY_PIVOTS_ATTRIBUTE
                    ", expected an object's number from %d on, and x and y within %d pixels",
                    name, start, before + 1, STY_MAX_PIVOT);
  }
  *out = pivots;
  return STY_OK;
}

/* ---- JSON ---- */

/* Numbers are keys here, digits alone and none in front that says nothing, so that no number has two keys. */
static StyStatus read_key(const StyDocument *document, const StyPath *path, int least, int most, int *out,
                          StyError *error) {
  const char *key = path->key;
  long long number = 0;
  StyError ignored;
  const bool is_plain = isdigit((unsigned char)key[0]) && (key[0] != '0' || !key[1]);
  if (is_plain && !sty_parse_integer("", key, least, most, &number, &ignored)) {
    *out = (int)number;
    return STY_OK;
  }
  char found[64], expected[64];
  snprintf(found, sizeof found, "\"%.40s\"", key);
  snprintf(expected, sizeof expected, "a number from %d to %d", least, most);
  return sty_fail_found(document, path, found, expected, error);
}

static int compare_pivots(const void *a, const void *b) {
  const int first = ((const StyPivot *)a)->object, second = ((const StyPivot *)b)->object;
  return (first > second) - (first < second);
}

static StyStatus read_objects(const StyDocument *document, const StyPath *path, json_t *value, StyPivots *out,
                              StyError *error) {
  if (!json_is_object(value))
    return sty_fail_value(document, path, value, "an object of pivots, as {\"1\": [x, y]}", error);
  StyPivots pivots;
  StyStatus status = allocate_pivots(json_object_size(value), &pivots, error);
  if (status) return status;
  const char *key;
  json_t *point;
  json_object_foreach(value, key, point) {
    StyPivot *pivot = &pivots.items[pivots.count++];
    double at[2];
    status = read_key(document, &(StyPath){path, key, 0}, 1, STY_MOST_PIVOT_ID, &pivot->object, error);
    if (!status) status = sty_get_numbers(document, path, value, key, -STY_MAX_PIVOT, STY_MAX_PIVOT, 2, at, error);
    if (status) break;
    pivot->x = at[0], pivot->y = at[1];
  }
  qsort(pivots.items, pivots.count, sizeof *pivots.items, compare_pivots);
  if (status)
    sty_free_pivots(&pivots);
  else
    *out = pivots;
  return status;
}

static StyStatus read_frames(const StyDocument *document, json_t *frames, StyPivotFile *file, StyError *error) {
  const StyPath path = {NULL, "frames", 0};
  if (!json_is_object(frames)) return sty_fail_value(document, &path, frames, "an object of frames by number", error);
  StyStatus status = STY_OK;
  const char *key;
  json_t *value;
  json_object_foreach(frames, key, value) {
    const StyPath here = {&path, key, 0};
    StyFramePivots *frame = &file->frames[file->count];
    status = read_key(document, &here, 0, INT32_MAX, &frame->number, error);
    if (!status) status = read_objects(document, &here, value, &frame->pivots, error);
    if (status) break;
    file->count++;
  }
  return status;
}

static StyStatus read_root(const StyDocument *document, StyPivotFile *file, StyError *error) {
  static const char *const known[] = {"schema", "pivots", "frames", NULL};
  const json_t *root = document->root;
  json_t *all = json_object_get(root, "pivots"), *frames = json_object_get(root, "frames");
  const char *schema = NULL;
  StyStatus status = sty_check_keys(document, NULL, root, known, error);
  if (!status) status = sty_get_string(document, NULL, root, "schema", 1, &schema, error);
  if (status) return status;
  if (strcmp(schema, pivots_schema) != 0)
    return sty_fail_value(document, &(StyPath){NULL, "schema", 0}, json_object_get(root, "schema"),
                          "\"stylut-pivots/1\"", error);
  if (!all == !frames)
    return sty_fail_found(document, NULL, all ? "\"pivots\" and \"frames\"" : "neither \"pivots\" nor \"frames\"",
                          "one of them", error);
  const size_t most = all ? 1 : json_object_size(frames);
  file->frames = calloc(most + 1, sizeof *file->frames);
  if (!file->frames) return sty_fail_memory(error, "pivots", (double)(most * sizeof *file->frames));
  if (frames) return read_frames(document, frames, file, error);
  file->is_for_all = true;
  status = read_objects(document, &(StyPath){NULL, "pivots", 0}, all, &file->frames[0].pivots, error);
  file->count = !status;
  return status;
}

StyStatus sty_read_pivots(const char *path, StyPivotFile *out, StyError *error) {
  StyDocument document;
  StyPivotFile file = {0};
  StyStatus status = sty_read_document(path, &document, error);
  if (status) return status;
  status = read_root(&document, &file, error);
  if (status)
    sty_free_pivot_file(&file);
  else
    *out = file;
  sty_close_document(&document);
  return status;
}

void sty_free_pivot_file(StyPivotFile *file) {
  for (size_t f = 0; f < file->count; f++) sty_free_pivots(&file->frames[f].pivots);
  free(file->frames);
  *file = (StyPivotFile){0};
}

const StyPivots *sty_get_frame_pivots(const StyPivotFile *file, int number) {
  for (size_t f = 0; f < file->count; f++)
    if (file->is_for_all || file->frames[f].number == number) return &file->frames[f].pivots;
  return NULL;
}
