#include "audit/planes.h"

#include <math.h>
#include <nettle/base64.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "audit/figures.h"

enum { NONE = 65535, MOST_STEPS = 65534 };

char *sty_encode_base64(const unsigned char *bytes, size_t size) {
  char *text = malloc(BASE64_ENCODE_RAW_LENGTH(size) + 1);
  if (!text) return NULL;
  base64_encode_raw(text, size, bytes);
  text[BASE64_ENCODE_RAW_LENGTH(size)] = 0;
  return text;
}

/* ---- one plane ----------------------------------------------------------------- */

/* A grid of cells over a table or a guide. */
typedef struct Grid {
  int side_x, side_y; /* of what is shown */
  int step;
  int width, height; /* cells */
} Grid;

static Grid make_grid(int side_x, int side_y, int most, int step) {
  const int larger = side_x > side_y ? side_x : side_y;
  Grid grid = {side_x, side_y, (larger + most - 1) / most, 0, 0};
  if (grid.step < step) grid.step = step;
  grid.width = (side_x + grid.step - 1) / grid.step;
  grid.height = (side_y + grid.step - 1) / grid.step;
  return grid;
}

static size_t count_cells(const Grid *grid) { return (size_t)grid->width * (size_t)grid->height; }

/* Calls visit for each place of a cell; that is all that a cell is. */
typedef void VisitPlace(void *context, size_t cell, size_t place, bool middle);

static void visit_places(const Grid *grid, VisitPlace *visit, void *context) {
  for (int y = 0; y < grid->side_y; y++)
    for (int x = 0; x < grid->side_x; x++) {
      const int column = x / grid->step, row = y / grid->step;
      const int right = grid->side_x - 1 - column * grid->step, below = grid->side_y - 1 - row * grid->step;
      const int half = grid->step / 2;
      const bool middle =
          x % grid->step == (half < right ? half : right) && y % grid->step == (half < below ? half : below);
      visit(context, (size_t)row * (size_t)grid->width + (size_t)column, (size_t)y * (size_t)grid->side_x + (size_t)x,
            middle);
    }
}

/* Smooth maps have small differences, whose high bytes are all alike. */
static unsigned char *split_bytes(const Grid *grid, const uint16_t *values) {
  const size_t count = count_cells(grid);
  unsigned char *bytes = malloc(2 * count);
  for (size_t i = 0; bytes && i < count; i++) {
    const uint16_t before = i % (size_t)grid->width ? values[i - 1] : 0;
    const uint16_t difference = (uint16_t)(values[i] - before);
    bytes[i] = (unsigned char)(difference >> 8);
    bytes[count + i] = (unsigned char)difference;
  }
  return bytes;
}

static unsigned char *deflate_bytes(const unsigned char *bytes, size_t size, size_t *packed_size) {
  z_stream stream = {0};
  if (deflateInit2(&stream, 9, Z_DEFLATED, -15, 9, Z_DEFAULT_STRATEGY) != Z_OK) return NULL;
  const size_t room = deflateBound(&stream, size);
  unsigned char *packed = malloc(room);
  stream.next_in = (unsigned char *)bytes; /* zlib only reads it */
  stream.avail_in = (uInt)size;
  stream.next_out = packed;
  stream.avail_out = (uInt)room;
  const int result = packed ? deflate(&stream, Z_FINISH) : Z_MEM_ERROR;
  *packed_size = stream.total_out;
  deflateEnd(&stream);
  if (result == Z_STREAM_END) return packed;
  free(packed);
  return NULL;
}

/* Adds {"scale", "data"} to the planes. */
static StyStatus add_plane(json_t *planes, const char *name, const Grid *grid, const uint16_t *values, double scale,
                           StyError *error) {
  size_t size = 0;
  unsigned char *bytes = split_bytes(grid, values);
  unsigned char *packed = bytes ? deflate_bytes(bytes, 2 * count_cells(grid), &size) : NULL;
  char *text = packed ? sty_encode_base64(packed, size) : NULL;
  json_t *plane = text ? json_pack("{s:f, s:s}", "scale", scale, "data", text) : NULL;
  free(bytes);
  free(packed);
  free(text);
  return plane && json_object_set_new(planes, name, plane) == 0
             ? STY_OK
             : sty_fail_memory(error, "report", (double)count_cells(grid) * 6);
}

static uint16_t quantize(double value, double scale) {
  if (isnan(value)) return NONE;
  const double steps = scale > 0 ? floor(value / scale + 0.5) : 0;
  return (uint16_t)fmin(fmax(steps, 0), MOST_STEPS);
}

/* Reals, NAN for none, over their whole range. */
static StyStatus add_reals(json_t *planes, const char *name, const Grid *grid, const float *values, StyError *error) {
  double largest = 0;
  for (size_t i = 0; i < count_cells(grid); i++)
    if ((double)values[i] > largest) largest = (double)values[i];
  uint16_t *steps = malloc(count_cells(grid) * sizeof *steps);
  if (!steps) return sty_fail_memory(error, "report", (double)count_cells(grid) * 2);
  for (size_t i = 0; i < count_cells(grid); i++) steps[i] = quantize((double)values[i], largest / MOST_STEPS);
  const StyStatus status = add_plane(planes, name, grid, steps, largest / MOST_STEPS, error);
  free(steps);
  return status;
}

static json_t *pack_grid(const Grid *grid, json_t *planes) {
  return json_pack("{s:i, s:i, s:i, s:O}", "width", grid->width, "height", grid->height, "step", grid->step, "planes",
                   planes);
}

static StyStatus finish_planes(const Grid *grid, json_t *planes, StyStatus status, json_t **out, StyError *error) {
  json_t *packed = status ? NULL : pack_grid(grid, planes);
  json_decref(planes);
  if (status) return status;
  if (!packed) return sty_fail_memory(error, "report", 0);
  *out = packed;
  return STY_OK;
}

/* ---- the table ----------------------------------------------------------------- */

typedef struct Gathering {
  const float *map;
  float *cells; /* NAN: none yet */
  bool sum;
} Gathering;

static void gather_place(void *context, size_t cell, size_t place, bool middle) {
  const Gathering *gathering = context;
  const float value = gathering->map[place];
  float *slot = &gathering->cells[cell];
  (void)middle;
  if (isnan(value)) return;
  if (isnan(*slot))
    *slot = value;
  else if (gathering->sum)
    *slot += value;
  else if (value > *slot)
    *slot = value;
}

static StyStatus add_map(json_t *planes, const char *name, const Grid *grid, const float *map, bool sum,
                         StyError *error) {
  Gathering gathering = {map, malloc(count_cells(grid) * sizeof(float)), sum};
  if (!gathering.cells) return sty_fail_memory(error, "report", (double)count_cells(grid) * 4);
  for (size_t i = 0; i < count_cells(grid); i++) gathering.cells[i] = NAN;
  visit_places(grid, gather_place, &gathering);
  const StyStatus status = add_reals(planes, name, grid, gathering.cells, error);
  free(gathering.cells);
  return status;
}

typedef struct SourceGathering {
  const StyReport *report;
  uint16_t *x, *y;
} SourceGathering;

static void gather_source(void *context, size_t cell, size_t place, bool middle) {
  const SourceGathering *gathering = context;
  const StyLut *lut = gathering->report->lut;
  if (!middle) return;
  const bool none = isnan(gathering->report->maps->weights[place]);
  gathering->x[cell] = none ? NONE : (uint16_t)(lut->pixels[place] % (uint32_t)lut->source_width);
  gathering->y[cell] = none ? NONE : (uint16_t)(lut->pixels[place] / (uint32_t)lut->source_width);
}

static StyStatus add_sources(json_t *planes, const Grid *grid, const StyReport *report, StyError *error) {
  SourceGathering gathering = {report, calloc(count_cells(grid), 2), calloc(count_cells(grid), 2)};
  StyStatus status = STY_OK;
  if (!gathering.x || !gathering.y) status = sty_fail_memory(error, "report", (double)count_cells(grid) * 4);
  if (!status) visit_places(grid, gather_source, &gathering);
  if (!status) status = add_plane(planes, "x", grid, gathering.x, 1, error);
  if (!status) status = add_plane(planes, "y", grid, gathering.y, 1, error);
  free(gathering.x);
  free(gathering.y);
  return status;
}

StyStatus sty_pack_table(const StyReport *report, int step, json_t **out, StyError *error) {
  const StyLutSpec *spec = &report->lut->spec;
  const StyAuditMaps *maps = report->maps;
  const Grid grid = make_grid(spec->width, spec->height, STY_MOST_TABLE_CELLS, step);
  const struct {
    const char *name;
    const float *map;
    bool sum;
  } planes_table[] = {{"error", maps->assignment, false}, {"excess", maps->excess, false},
                      {"pieces", maps->pieces, false},    {"spread", maps->spread, false},
                      {"jumps", maps->jumps, false},      {"unstable", maps->unstable, false},
                      {"weight", maps->weights, true}};
  json_t *planes = json_object();
  StyStatus status = add_sources(planes, &grid, report, error);
  for (size_t p = 0; !status && p < sizeof planes_table / sizeof *planes_table; p++)
    status = add_map(planes, planes_table[p].name, &grid, planes_table[p].map, planes_table[p].sum, error);
  return finish_planes(&grid, planes, status, out, error);
}

/* ---- the guide ----------------------------------------------------------------- */

typedef struct GuideGathering {
  const StyReport *report;
  StyGuidePlanes guide;
  const uint32_t *texel_uses; /* per source pixel */
  uint16_t *gx, *gy;
  float *covered, *ambiguous, *unused, *uses;
} GuideGathering;

static uint16_t quantize_value(float g) { return quantize((fmin(fmax((double)g, -1), 1) + 1) / 2, 1.0 / MOST_STEPS); }

static bool is_pixel_ambiguous(const GuideGathering *gathering, size_t pixel) {
  const StyLutSpec *spec = &gathering->report->lut->spec;
  const StyAuditMaps *maps = gathering->report->maps;
  int at[2];
  sty_find_texel(spec, (const float[2]){gathering->guide.x[pixel], gathering->guide.y[pixel]}, at);
  const size_t texel = (size_t)at[1] * (size_t)spec->width + (size_t)at[0];
  return maps->pieces[texel] >= 2 || (double)maps->spread[texel] > gathering->report->audit->jump;
}

static void gather_pixel(void *context, size_t cell, size_t pixel, bool middle) {
  const GuideGathering *gathering = context;
  const bool covered = gathering->guide.covered[pixel] > 0;
  if (middle) {
    gathering->gx[cell] = covered ? quantize_value(gathering->guide.x[pixel]) : NONE;
    gathering->gy[cell] = covered ? quantize_value(gathering->guide.y[pixel]) : NONE;
  }
  if (!covered) return;
  gathering->covered[cell]++;
  gathering->ambiguous[cell] += is_pixel_ambiguous(gathering, pixel) ? 1.0f : 0.0f;
  gathering->unused[cell] += gathering->texel_uses[pixel] ? 0.0f : 1.0f;
  gathering->uses[cell] += (float)gathering->texel_uses[pixel];
}

static uint32_t *count_uses(const StyReport *report) {
  uint32_t *uses = calloc(sty_count_pixels(report->guide), sizeof *uses);
  for (size_t t = 0; uses && t < sty_count_texels(&report->lut->spec); t++)
    if (report->maps->weights[t] > 0) uses[report->lut->pixels[t]]++;
  return uses;
}

static void turn_into_shares(const Grid *grid, GuideGathering *gathering) {
  for (size_t i = 0; i < count_cells(grid); i++) {
    gathering->ambiguous[i] /= gathering->covered[i];
    gathering->unused[i] /= gathering->covered[i];
    if (!(gathering->covered[i] > 0)) gathering->uses[i] = NAN;
  }
}

static StyStatus add_guide(json_t *planes, const Grid *grid, GuideGathering *gathering, StyError *error) {
  visit_places(grid, gather_pixel, gathering);
  turn_into_shares(grid, gathering);
  StyStatus status = add_plane(planes, "gx", grid, gathering->gx, 1.0 / MOST_STEPS, error);
  if (!status) status = add_plane(planes, "gy", grid, gathering->gy, 1.0 / MOST_STEPS, error);
  if (!status) status = add_reals(planes, "ambiguous", grid, gathering->ambiguous, error);
  if (!status) status = add_reals(planes, "unused", grid, gathering->unused, error);
  if (!status) status = add_reals(planes, "uses", grid, gathering->uses, error);
  return status;
}

StyStatus sty_pack_guide(const StyReport *report, json_t **out, StyError *error) {
  const Grid grid = make_grid(report->guide->width, report->guide->height, STY_MOST_GUIDE_CELLS, 1);
  const size_t cells = count_cells(&grid);
  uint32_t *uses = count_uses(report);
  uint16_t *values = calloc(2 * cells, sizeof *values);
  float *sums = calloc(4 * cells, sizeof *sums);
  json_t *planes = json_object();
  GuideGathering gathering = {.report = report, .texel_uses = uses, .gx = values, .covered = sums};
  StyStatus status = sty_find_planes(report->guide, &gathering.guide, error);
  if (!status && (!uses || !values || !sums)) status = sty_fail_memory(error, "report", (double)cells * 20);
  if (!status) {
    gathering.gy = values + cells;
    gathering.ambiguous = sums + cells;
    gathering.unused = sums + 2 * cells;
    gathering.uses = sums + 3 * cells;
    status = add_guide(planes, &grid, &gathering, error);
  }
  free(uses);
  free(values);
  free(sums);
  return finish_planes(&grid, planes, status, out, error);
}
