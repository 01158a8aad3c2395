/* Tables: an image of any kind decoded as one, and what becomes of it. The
 * input says, in this order: hints, size, channels, attributes; all that is left
 * are values, over and over. */
#include <math.h>

#include "fuzz.h"
#include "stylut/probe.h"
#include "stylut/report.h"

enum { MOST_SIDE = 12, MOST_SOURCE_PIXELS = 1024 };

static const StyRun one_thread = {.threads = 1};

/* The i-th value of an image of this precision. */
static float make_value(const Supply *values, size_t i, int bits, bool tame) {
  uint32_t number = 0;
  for (size_t b = 0; b < 4; b++) number |= (uint32_t)peek(values, 4 * i + b) << 8 * b;
  if (bits == 8) return (float)(number & 255) / 255.0f;
  if (bits == 16) return (float)(number & 65535) / 65535.0f;
  if (tame) return (float)(number & 65535) / 65535.0f;
  float value;
  memcpy(&value, &number, sizeof value);
  return value;
}

static void add_attributes(Supply *supply, StyImage *image) {
  static const char *const names[] = {"stylut:kind",     "stylut:encoding", "stylut:source",
                                      "stylut:sampling", "stylut:map",      "stylut:metric",
                                      "stylut:depth",    "stylut:channels", "stylut:slack"};
  static const char *const values[] = {"lut",
                                       "f32",
                                       "rg16",
                                       "rg8x2",
                                       "rg8",
                                       "16x16",
                                       "7x5",
                                       "65536",
                                       "centre",
                                       "unorm8",
                                       "xy",
                                       "equal-area",
                                       "angle",
                                       "300x2",
                                       "40000x30000",
                                       "1",
                                       "3",
                                       "0.02",
                                       "normal.X,normal.Y,luma.Y:0.5",
                                       "a,b"};
  enum { NAMES = sizeof names / sizeof *names, VALUES = sizeof values / sizeof *values };
  for (unsigned count = take(supply) % 8; count; count--) {
    const char *name = names[take(supply) % NAMES];
    const unsigned choice = take(supply) % (VALUES + 1);
    char text[32] = "";
    if (choice == VALUES)
      for (size_t i = 0; i + 1 < sizeof text; i++) text[i] = (char)take(supply);
    require(sty_set_attribute(image, name, choice < VALUES ? values[choice] : text, NULL) == STY_OK);
  }
}

static StyImage *take_image(Supply *supply, bool tame) {
  static const int precisions[] = {8, 16, 32};
  static const char *const channels[] = {"u", "v", "error", "R", "G", "B", "A", "Y"};
  const int width = 1 + (int)take(supply) % MOST_SIDE, longer = (int)take(supply);
  const int height = longer % 4 == 0 ? 1 + longer % MOST_SIDE : longer % 4 == 3 ? width * width : width;
  const int bits = precisions[take(supply) % 3];
  const int first = take(supply) % 2 ? 3 : 0, count = 1 + (int)take(supply) % 5;
  StyImage *image = NULL;
  require(sty_create_image(width, height, count, channels + first, bits, &image, NULL) == STY_OK);
  add_attributes(supply, image);
  const size_t values = (size_t)count * sty_count_pixels(image);
  for (size_t i = 0; i < values; i++) image->data[i] = make_value(supply, i, bits, tame);
  return image;
}

static bool is_same_table(const StyLut *a, const StyLut *b) {
  return memcmp(&a->spec, &b->spec, sizeof a->spec) == 0 && a->depth == b->depth &&
         a->source_width == b->source_width && a->source_height == b->source_height &&
         memcmp(a->pixels, b->pixels, sty_count_texels(&a->spec) * sizeof *a->pixels) == 0;
}

/* There and back: what has bits enough keeps every pixel. */
static void check_encodings(const StyLut *lut) {
  static const int capacities[] = {
      [STY_ENCODE_F32] = 1 << 20, [STY_ENCODE_RG16] = 65536, [STY_ENCODE_RG8X2] = 65536, [STY_ENCODE_RG8] = 256};
  for (int e = 0; sty_encoding_names[e]; e++) {
    StyImage *image = NULL;
    StyLut *read = NULL;
    StyError error;
    require(sty_encode_lut(lut, (StyEncoding)e, &image, &error) == STY_OK);
    const StyStatus status = sty_decode_lut("again", image, &(StyLutHints){0, 0, -1, STY_FOREIGN_NONE}, &read, &error);
    if (!lut->depth && lut->spec.width != lut->spec.height) {
      require(status == STY_ERROR_INPUT);
    } else {
      require(status == STY_OK);
      if (lut->source_width <= capacities[e] && lut->source_height <= capacities[e]) require(is_same_table(lut, read));
      if (e == STY_ENCODE_F32)
        require(memcmp(lut->errors, read->errors, sty_count_texels(&lut->spec) * sizeof *lut->errors) == 0);
    }
    sty_destroy_lut(&read);
    sty_destroy_image(&image);
  }
}

/* A guide that the table could have been made for. */
static StyImage *make_guide(const Supply *values, int width, int height) {
  static const char *const names[] = {"A", "normal.X", "normal.Y", "normal.Z"};
  static const int precisions[] = {8, 16, 32};
  StyImage *guide = NULL;
  require(sty_create_image(width, height, 4, names, precisions[peek(values, 1) % 3], &guide, NULL) == STY_OK);
  const size_t pixels = sty_count_pixels(guide);
  for (size_t i = 0; i < pixels; i++) {
    guide->data[i] = (float)(peek(values, i) & 1);
    for (size_t c = 1; c < 4; c++) {
      const uint8_t byte = peek(values, 3 * i + c);
      guide->data[c * pixels + i] = byte & 1 ? (float)(2 * byte - 255) / 255.0f : (float)byte / 100 - 1.28f;
    }
  }
  return guide;
}

static void check_share(double share) { require(share >= 0 && share <= 1 + 1e-9); }

static void check_audit(const StyAudit *audit) {
  const StyFigures *figures[] = {&audit->assignment, &audit->lookup, &audit->excess};
  for (int f = 0; f < 3; f++) {
    require(figures[f]->mean >= 0 && figures[f]->p99 <= figures[f]->max && figures[f]->max <= 180);
    require(figures[f]->p50 <= figures[f]->p95 && figures[f]->p95 <= figures[f]->p99);
  }
  check_share(audit->optimal);
  check_share(audit->coverage);
  check_share(audit->unused);
  check_share(audit->ambiguous);
  check_share(audit->jumps);
  check_share(audit->unstable);
}

/* Audit of the table and the opinion about it. */
static void judge(const StyLut *lut, const StyLut *exact, const StyImage *guide, const Supply *values) {
  const StyImage *frame = guide;
  const StyAuditOptions options = {
      .tolerance = STY_LEVEL, .weights = (StyWeights)(peek(values, 2) % 3), .frames = &frame, .frame_count = 1};
  StyAudit audit;
  StyAuditMaps maps;
  StyError error;
  const StyStatus status = sty_audit_lut(lut, exact, guide, &options, &one_thread, &audit, &maps, &error);
  if (status) {
    require_message(status, &error);
  } else {
    static const StyReportFile files[2] = {{"table", "table.exr", ""}, {"guide", "guide.exr", ""}};
    const StyReport report = {files, 2, NULL, lut, exact, guide, &audit, &maps, peek(values, 5) & 1};
    StyOpinion opinion;
    check_audit(&audit);
    require(sty_judge_report(&report, &opinion, &error) == STY_OK);
    require(*opinion.headline && *opinion.reason && opinion.advice_count <= STY_MOST_ADVICE);
    sty_free_audit_maps(&maps);
  }
}

static void probe_table(const StyLut *lut, const StyImage *guide, const StySites *sites, const Supply *values) {
  const float value[2] = {(float)peek(values, 3) / 127.5f - 1, (float)peek(values, 4) / 127.5f - 1};
  StyProbe probe;
  StyError error;
  require(sty_probe_lut(lut, guide, sites, value, &(StyProbeOptions){0, 0}, &probe, &error) == STY_OK);
  require(probe.choice >= 1 && probe.pieces >= 1);
}

static void use_table(const StyLut *lut, const Supply *values) {
  StyImage *guide = make_guide(values, lut->source_width, lut->source_height);
  StySites *sites = NULL;
  StyLut *exact = NULL;
  StyError error;
  StyStatus status = sty_collect_sites("guide", guide, &sites, &error);
  if (!status) status = sty_build_lut(sites, &sty_engines[0], NULL, &lut->spec, &one_thread, &exact, &error);
  if (status) {
    require_message(status, &error);
  } else {
    probe_table(lut, guide, sites, values);
    /* unorm8 is asked for every byte there is, which takes its time. */
    if (lut->spec.sampling != STY_SAMPLE_UNORM8 || peek(values, 0) % 8 == 0) judge(lut, exact, guide, values);
  }
  sty_destroy_lut(&exact);
  sty_destroy_sites(&sites);
  sty_destroy_image(&guide);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  Supply supply = {data, size};
  const unsigned kind = take(&supply), source = take(&supply);
  const StyLutHints hints = {.source_width = source % 4 ? 0 : 1 + (int)(source / 4),
                             .source_height = source % 4 ? 0 : 1 + (int)(source / 8),
                             .sampling = (int)(kind / 8 % 4) - 1,
                             .foreign = (StyForeign)(kind % 8 % 5)};
  StyImage *image = take_image(&supply, kind / 32 % 2);
  StyLut *lut = NULL;
  StyError error;
  const StyStatus status = sty_decode_lut("table", image, &hints, &lut, &error);
  if (status) {
    require(!lut);
    require_message(status, &error);
  } else {
    const uint64_t pixels = (uint64_t)lut->source_width * (uint64_t)lut->source_height;
    for (size_t t = 0; t < sty_count_texels(&lut->spec); t++) require(lut->pixels[t] < pixels);
    check_encodings(lut);
    if (!lut->depth && pixels <= MOST_SOURCE_PIXELS) use_table(lut, &supply);
  }
  sty_destroy_lut(&lut);
  sty_destroy_image(&image);
  return 0;
}
