#include "audit/facts.h"

#include <math.h>
#include <stdlib.h>

#include "audit/figures.h"

const char *const sty_sector_names[STY_SECTORS] = {
    "toward the viewer", "right", "upper right", "up", "upper left", "left", "lower left", "down", "lower right"};

int sty_find_sector(const float g[2]) {
  if (g[0] * g[0] + g[1] * g[1] < 0.25f) return 0;
  const double turn = atan2((double)g[1], (double)g[0]) / (2 * M_PI) + 1.0 / 16;
  return 1 + (int)floor((turn + 1) * 8) % 8;
}

static size_t count_report_texels(const StyReport *report) { return sty_count_texels(&report->lut->spec); }

static void get_value(const StyReport *report, size_t texel, float g[2]) {
  const size_t width = (size_t)report->lut->spec.width;
  sty_get_texel_value(&report->lut->spec, (int)(texel % width), (int)(texel / width), g);
}

static double get_radius(const float g[2]) { return sqrt((double)g[0] * g[0] + (double)g[1] * g[1]); }

static void gather_sectors(const StyReport *report, StySector sectors[STY_SECTORS]) {
  double asked[STY_SECTORS] = {0}, covered[STY_SECTORS] = {0};
  /* Of frames it is what they ask for that counts, else every texel of the sector. */
  const bool by_demand = report->audit->weights == STY_WEIGHT_FRAMES;
  for (size_t t = 0; t < count_report_texels(report); t++) {
    const double weight = (double)report->maps->weights[t];
    if (isnan(weight)) continue;
    float g[2];
    get_value(report, t, g);
    const int s = sty_find_sector(g);
    const double counts = by_demand ? weight : 1;
    asked[s] += counts;
    covered[s] += (double)report->exact->errors[t] <= report->audit->tolerance ? counts : 0;
    sectors[s].demand += weight;
  }
  for (int s = 0; s < STY_SECTORS; s++) sectors[s].coverage = asked[s] > 0 ? covered[s] / asked[s] : 1;
}

/* ---- error against radius ------------------------------------------------------ */

typedef struct Sample {
  int ring;
  float error;
} Sample;

static int compare_samples(const void *a, const void *b) {
  const Sample *x = a, *y = b;
  if (x->ring != y->ring) return x->ring - y->ring;
  return (x->error > y->error) - (x->error < y->error);
}

static void gather_rings(Sample *samples, size_t count, StyRing rings[STY_RINGS]) {
  qsort(samples, count, sizeof *samples, compare_samples);
  size_t first = 0;
  for (int r = 0; r < STY_RINGS; r++) {
    size_t end = first;
    while (end < count && samples[end].ring == r) end++;
    rings[r] = (StyRing){-1, -1, -1};
    if (end > first) {
      const size_t last = end - first - 1;
      rings[r] = (StyRing){(double)samples[first + last / 2].error, (double)samples[first + last * 95 / 100].error,
                           (double)samples[end - 1].error};
    }
    first = end;
  }
}

static StyStatus gather_radii(const StyReport *report, StyFacts *out, StyError *error) {
  Sample *samples = malloc((count_report_texels(report) + 1) * sizeof *samples);
  if (!samples) return sty_fail_memory(error, "report", (double)count_report_texels(report) * sizeof *samples);
  size_t count = 0;
  double worst = 0, outer = 0;
  for (size_t t = 0; t < count_report_texels(report); t++) {
    const float angle = report->maps->assignment[t];
    if (isnan(angle)) continue;
    float g[2];
    get_value(report, t, g);
    const double radius = get_radius(g);
    const int ring = (int)(radius * STY_RINGS);
    samples[count++] = (Sample){ring < STY_RINGS ? ring : STY_RINGS - 1, angle};
    if ((double)angle < report->audit->assignment.p99) continue;
    worst += (double)report->maps->weights[t];
    outer += radius > 0.95 ? (double)report->maps->weights[t] : 0;
  }
  gather_rings(samples, count, out->rings);
  out->rim = worst > 0 ? outer / worst : 0;
  free(samples);
  return STY_OK;
}

/* ---- ambiguity ----------------------------------------------------------------- */

static double measure_ambiguous_spread(const StyReport *report) {
  const StyAuditMaps *maps = report->maps;
  double sum = 0, weight = 0;
  for (size_t t = 0; t < count_report_texels(report); t++) {
    if (!(maps->weights[t] > 0)) continue;
    if (maps->pieces[t] < 2 && (double)maps->spread[t] <= report->audit->jump) continue;
    weight += (double)maps->weights[t];
    sum += (double)maps->weights[t] * (double)maps->spread[t];
  }
  return weight > 0 ? sum / weight : 0;
}

/* ---- encodings ----------------------------------------------------------------- */

static uint32_t encode_pixel(const StyLut *lut, uint32_t pixel, StyEncoding encoding) {
  if (encoding == STY_ENCODE_F32) return pixel;
  const uint32_t maximum = encoding == STY_ENCODE_RG8 ? 255 : 65535;
  const uint32_t width = (uint32_t)lut->source_width, height = (uint32_t)lut->source_height;
  const uint32_t x = sty_encode_coordinate(pixel % width, width, maximum);
  const uint32_t y = sty_encode_coordinate(pixel / width, height, maximum);
  return sty_decode_coordinate(y, height, maximum) * width + sty_decode_coordinate(x, width, maximum);
}

static StyStatus gather_encoding(const StyReport *report, const StyGuidePlanes *guide, StyEncoding encoding,
                                 StyEncodingCost *out, StyError *error) {
  StyTally tally;
  const StyStatus status = sty_open_tally(report->audit->feasible, &tally, error);
  if (status) return status;
  for (size_t t = 0; t < count_report_texels(report); t++) {
    const double weight = (double)report->maps->weights[t];
    if (!(weight > 0)) continue;
    float g[2];
    get_value(report, t, g);
    const uint32_t pixel = encode_pixel(report->lut, report->lut->pixels[t], encoding);
    sty_add_error(&tally, sty_measure_pixel(guide, pixel, g), weight, (const int[2]){0, 0}, g, pixel,
                  report->lut->source_width);
    out->moved += pixel != report->lut->pixels[t] ? weight : 0;
  }
  const StyFigures figures = sty_finish_tally(&tally);
  out->mean = figures.mean;
  out->p99 = figures.p99;
  sty_close_tally(&tally);
  return STY_OK;
}

static bool is_byte_coordinate(uint32_t at, uint32_t side) {
  return sty_decode_coordinate(sty_encode_coordinate(at, side, 255), side, 255) == at;
}

/* Share of the feasible texels whose pixel two bytes can name; other tools count rows from below. */
static double measure_byte_pixels(const StyReport *report, const StyLut *lut) {
  const uint32_t width = (uint32_t)lut->source_width, height = (uint32_t)lut->source_height;
  size_t texels = 0, from_above = 0, from_below = 0;
  for (size_t t = 0; t < count_report_texels(report); t++) {
    if (isnan(report->maps->weights[t])) continue;
    const uint32_t x = lut->pixels[t] % width, y = lut->pixels[t] / width;
    texels++;
    if (!is_byte_coordinate(x, width)) continue;
    from_above += is_byte_coordinate(y, height);
    from_below += is_byte_coordinate(height - 1 - y, height);
  }
  return (double)(from_above > from_below ? from_above : from_below) / (double)texels;
}

static bool lost_to_bytes(const StyReport *report) {
  return measure_byte_pixels(report, report->lut) > 0.99 && measure_byte_pixels(report, report->exact) < 0.8;
}

StyStatus sty_gather_facts(const StyReport *report, StyFacts *out, StyError *error) {
  StyFacts facts = {0};
  StyGuidePlanes guide;
  StyStatus status = sty_find_planes(report->guide, &guide, error);
  if (!status) gather_sectors(report, facts.sectors);
  if (!status) status = gather_radii(report, &facts, error);
  for (int e = 0; !status && e < STY_ENCODINGS; e++)
    status = gather_encoding(report, &guide, (StyEncoding)e, &facts.encodings[e], error);
  facts.lost_to_bytes = lost_to_bytes(report);
  facts.spread = measure_ambiguous_spread(report);
  if (!status) *out = facts;
  return status;
}
