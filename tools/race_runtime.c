/* The runtime on frames of 1920 x 1080, each path beside the reference. A bundle is made in memory: a sphere of 512 x
 * 512, noise as its paint, levels 6..0, threshold 24. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "options.h"
#include "passes.h"
#include "races.h"
#include "stylut/guide.h"
#include "stylut/image_io.h"
#include "stylut/lut.h"
#include "stylut/runtime.h"

enum { WIDTH = 1920, HEIGHT = 1080, PIXELS = WIDTH * HEIGHT, TABLE = 256, SOURCE = SPHERE * SPHERE };
enum { MOST_LOOKS = 64 };

/* ---- a bundle in memory ----------------------------------------------------------- */

/* Styles of one source that differ in their parameters. */
typedef struct Stage {
  unsigned char *texels[STY_BUNDLE_FILES];
  int styles;
  StyBundle bundle;
} Stage;

static const StyStyle plain_style = {.threshold = 24,
                                     .top_level = 6,
                                     .radius = 1,
                                     .layer_count = 1,
                                     .jitter_amount = 1,
                                     .scale = 1,
                                     .flags = STY_FLAG_UNORM8};

static void set_style(Stage *stage, int style, const StyStyle *values) {
  float rows[STY_PARAM_ROWS][4];
  sty_encode_style(values, rows);
  for (int row = 0; row < STY_PARAM_ROWS; row++)
    memcpy(stage->texels[STY_BUNDLE_PARAMS] + (size_t)(row * stage->styles + style - 1) * sizeof rows[row], rows[row],
           sizeof rows[row]);
}

/* Bytes that are the same on every machine; below 255, so that seeds stay in their cells. */
static void fill_noise(unsigned char *bytes, size_t count) {
  uint32_t state = 1;
  for (size_t i = 0; i < count; i++) {
    state = state * 1664525u + 1013904223u;
    bytes[i] = (unsigned char)((uint64_t)state * 255 >> 32);
  }
}

static StyStatus fill_table(const StyImage *sphere, unsigned char *out, StyError *error) {
  const StyLutSpec spec = {.width = TABLE, .height = TABLE, .sampling = STY_SAMPLE_UNORM8};
  const StyEngine *engine = NULL;
  StySites *sites = NULL;
  StyLut *lut = NULL;
  StyStatus status = sty_find_engine("bench", "auto", &engine, error);
  if (!status) status = sty_collect_sites("sphere", sphere, &sites, error);
  if (!status) status = sty_build_lut(sites, engine, NULL, &spec, NULL, &lut, error);
  for (size_t t = 0; !status && t < (size_t)TABLE * TABLE; t++) {
    const uint32_t x = sty_encode_coordinate(lut->pixels[t] % SPHERE, SPHERE, 65535);
    const uint32_t y = sty_encode_coordinate(lut->pixels[t] / SPHERE, SPHERE, 65535);
    const unsigned char bytes[4] = {(unsigned char)x, (unsigned char)(x >> 8), (unsigned char)y,
                                    (unsigned char)(y >> 8)};
    memcpy(out + 4 * t, bytes, sizeof bytes);
  }
  sty_destroy_lut(&lut);
  sty_destroy_sites(&sites);
  return status;
}

static void close_stage(Stage *stage) {
  for (int i = 0; i < STY_BUNDLE_FILES; i++) free(stage->texels[i]);
}

/* `styles` plain ones, four layers of paint. */
static StyStatus open_stage(Stage *stage, int styles, StyError *error) {
  const uint32_t count = (uint32_t)styles;
  const StyTexture shapes[STY_BUNDLE_FILES] = {{NULL, SPHERE, SPHERE, STY_MAX_LIGHTINGS, 4},
                                               {NULL, SPHERE, SPHERE, count, 4},
                                               {NULL, TABLE, TABLE, count, 4},
                                               {NULL, count, STY_PARAM_ROWS, 1, 16},
                                               {NULL, STY_JITTER_SIZE, STY_JITTER_SIZE, 1, 2}};
  StyImage *sphere = NULL, *encoded = NULL;
  *stage = (Stage){.styles = styles};
  StyStatus status = make_sphere(32, &sphere, error);
  for (int i = 0; !status && i < STY_BUNDLE_FILES; i++) {
    const StyTexture *shape = &shapes[i];
    const size_t size = (size_t)shape->width * shape->height * shape->layers * shape->texel_size;
    stage->texels[i] = malloc(size);
    if (!stage->texels[i]) status = sty_fail_memory(error, "bench", (double)size);
    if (!status && (i == STY_BUNDLE_EXEMPLARS || i == STY_BUNDLE_JITTER)) fill_noise(stage->texels[i], size);
    stage->bundle.textures[i] = *shape;
    stage->bundle.textures[i].texels = stage->texels[i];
  }
  for (size_t i = 3; !status && i < 4 * (size_t)SOURCE * STY_MAX_LIGHTINGS; i += 4)
    stage->texels[STY_BUNDLE_EXEMPLARS][i] = 255;
  if (!status) status = sty_encode_normals(sphere, 8, &encoded, error);
  if (!status) status = sty_convert_to_rgba8("sphere", encoded, stage->texels[STY_BUNDLE_GUIDES], error);
  if (!status) status = fill_table(sphere, stage->texels[STY_BUNDLE_LUTS], error);
  for (int style = 1; !status && style <= styles; style++) {
    const size_t guide = 4 * (size_t)SOURCE, table = 4 * (size_t)TABLE * TABLE, at = (size_t)style - 1;
    if (at) memcpy(stage->texels[STY_BUNDLE_GUIDES] + at * guide, stage->texels[STY_BUNDLE_GUIDES], guide);
    if (at) memcpy(stage->texels[STY_BUNDLE_LUTS] + at * table, stage->texels[STY_BUNDLE_LUTS], table);
    set_style(stage, style, &plain_style);
  }
  sty_destroy_image(&sphere);
  sty_destroy_image(&encoded);
  return status;
}

/* ---- frames ----------------------------------------------------------------------- */

/* A height field of waves that leaves no pixel bare; its slopes reach about 60 degrees. */
static void draw_waves(uint8_t *guide) {
  for (int i = 0; i < PIXELS; i++) {
    const double x = i % WIDTH, y = i / WIDTH, shared = 0.5 * sin((x + y) / 91);
    const double dx = 1.2 * sin(x / 37) + shared, dy = 1.2 * cos(y / 53) + shared;
    const double length = sqrt(dx * dx + dy * dy + 1), normal[3] = {-dx / length, -dy / length, 1 / length};
    for (int c = 0; c < 3; c++) guide[4 * i + c] = (uint8_t)(normal[c] * 127.5 + 128);
    guide[4 * i + 3] = 255;
  }
}

/* Uncovers all but a disc, cut off at the picture's rim, that covers so much of the picture. */
static void keep_disc(uint8_t *guide, double share) {
  double low = 0, high = WIDTH;
  for (int step = 0; step < 30; step++) {
    const double radius = (low + high) / 2;
    double covered = 0;
    for (int y = 0; y < HEIGHT; y++) {
      const double dy = y + 0.5 - HEIGHT / 2.0, half = radius > fabs(dy) ? sqrt(radius * radius - dy * dy) : 0;
      covered += fmin(2 * half, WIDTH);
    }
    *(covered < share * PIXELS ? &low : &high) = radius;
  }
  for (int i = 0; i < PIXELS; i++) {
    const double dx = i % WIDTH + 0.5 - WIDTH / 2.0, dy = i / WIDTH + 0.5 - HEIGHT / 2.0;
    if (share == 0 || dx * dx + dy * dy > high * high) memset(guide + 4 * i, 0, 4);
  }
}

/* ---- what races ------------------------------------------------------------------- */

enum { TRANSFER = 1, BLEND = 2, SEEDS = 4 };

/* One entrant's way of drawing a frame. */
typedef struct Look {
  struct Studio *studio;
  const StyBundle *bundle;
  StyFrame frame;
  int passes;
} Look;

/* What all looks share: buffers, and seeds kept for the plain style. */
typedef struct Studio {
  uint8_t *waves, *figure, *luma, *styles, *picture;
  StyMatch *matches;
  StySeedOffset *offsets;
  StySeeds seeds;
  Stage stage;
  Look looks[MOST_LOOKS];
  int look_count;
  Race race;
} Studio;

static StyStatus fill_band(void *context, long i, StyError *error) {
  const Look *look = context;
  const struct Studio *studio = look->studio;
  const int y = (int)i * 32, end = y + 32 < HEIGHT ? y + 32 : HEIGHT;
  const StyRuntimeStatus status = sty_fill_seeds(look->bundle, &studio->seeds, y, end, look->frame.path);
  return status ? sty_fail(error, STY_ERROR_LIBRARY, "runtime: %s", sty_describe_runtime_status(status)) : STY_OK;
}

static StyStatus draw_look(const Entrant *self, double *milliseconds, StyError *error) {
  const Look *look = self->subject;
  struct Studio *studio = look->studio;
  const StyRun run = {.threads = self->threads};
  StyStatus status = STY_OK;
  /* What is blended must have been matched. */
  if (look->passes == BLEND) status = transfer_frame(look->bundle, &look->frame, studio->matches, &run, error);
  const double start = sty_get_milliseconds();
  if (!status && look->passes & SEEDS)
    status = sty_parallel_for(&run, (HEIGHT + 31) / 32, fill_band, (void *)(uintptr_t)look, error);
  if (!status && look->passes & TRANSFER)
    status = transfer_frame(look->bundle, &look->frame, studio->matches, &run, error);
  if (!status && look->passes & BLEND)
    status = blend_frame(look->bundle, &look->frame, studio->matches, 8, studio->picture, &run, error);
  *milliseconds = sty_get_milliseconds() - start;
  return status;
}

static void close_studio(Studio *studio) {
  if (!studio) return;
  close_stage(&studio->stage);
  free(studio->waves);
  free(studio->figure);
  free(studio->luma);
  free(studio->styles);
  free(studio->picture);
  free(studio->matches);
  free(studio->offsets);
  free(studio);
}

static StyStatus open_studio(int styles, Studio **out, StyError *error) {
  const StyRect all = {0, 0, WIDTH, HEIGHT};
  Studio *studio = calloc(1, sizeof *studio);
  if (!studio) return sty_fail_memory(error, "bench", sizeof *studio);
  studio->waves = malloc(4 * (size_t)PIXELS);
  studio->figure = malloc(4 * (size_t)PIXELS);
  studio->luma = malloc(PIXELS);
  studio->styles = malloc(PIXELS);
  studio->picture = malloc(4 * (size_t)PIXELS);
  studio->matches = malloc((size_t)PIXELS * sizeof *studio->matches);
  studio->offsets = malloc(sty_get_seeds_size(all));
  StyStatus status = STY_OK;
  if (!studio->waves || !studio->figure || !studio->luma || !studio->styles || !studio->picture || !studio->matches ||
      !studio->offsets)
    status = sty_fail_memory(error, "bench", 40.0 * PIXELS);
  if (!status) status = open_stage(&studio->stage, styles, error);
  if (!status && sty_plan_seeds(&studio->stage.bundle, 1, 0, all, studio->offsets, &studio->seeds))
    status = sty_fail(error, STY_ERROR_LIBRARY, "runtime: seeds cannot be planned");
  if (status) {
    close_studio(studio);
    return status;
  }
  (void)sty_fill_seeds(&studio->stage.bundle, &studio->seeds, 0, HEIGHT, STY_PATH_BEST);
  draw_waves(studio->waves);
  for (int i = 0; i < PIXELS; i++) studio->luma[i] = (uint8_t)(i % WIDTH * 255 / WIDTH);
  *out = studio;
  return STY_OK;
}

/* An entrant that draws `guide` by one path; its frame may be changed before the race. */
static Look *add_look(Studio *studio, const char *row, const char *variant, const uint8_t *guide, int passes,
                      StyRuntimePath path, int threads, int reference) {
  Look *look = &studio->looks[studio->look_count++];
  *look = (Look){.studio = studio, .bundle = &studio->stage.bundle, .passes = passes};
  look->frame = (StyFrame){.width = WIDTH,
                           .height = HEIGHT,
                           .guide = guide,
                           .style = 1,
                           .seeds = &studio->seeds,
                           .seeds_count = path == STY_PATH_REFERENCE ? 0 : 1,
                           .path = path};
  Entrant *entrant =
      enter(&studio->race, (Entrant){.run = draw_look,
                                     .subject = look,
                                     .threads = threads,
                                     .work = PIXELS * 1e-6,
                                     .rate_unit = "Mpixels/s",
                                     .reference = reference,
                                     .reference_name = reference < 0 ? "" : studio->race.entrants[reference].variant});
  snprintf(entrant->row, sizeof entrant->row, "stylize %s", row);
  snprintf(entrant->variant, sizeof entrant->variant, "%s", variant);
  return look;
}

static const struct {
  StyRuntimePath path;
  const char *name;
} ways[] = {{STY_PATH_PORTABLE, "portable"}, {STY_PATH_AVX2, "avx2"}, {STY_PATH_AVX512, "avx512"}};
enum { WAYS = 3 };

/* Every path beside the reference, and two threads beside one; the place of the reference. */
static int enter_paths(Studio *studio, const char *row, const char *what, const uint8_t *guide, int passes) {
  char variant[64];
  const int first = studio->race.count;
  snprintf(variant, sizeof variant, "%s: reference", what);
  add_look(studio, row, variant, guide, passes, STY_PATH_REFERENCE, 1, -1);
  for (int i = 0; i < WAYS; i++) {
    if (!sty_has_path(ways[i].path)) continue;
    snprintf(variant, sizeof variant, "%s: %s", what, ways[i].name);
    add_look(studio, row, variant, guide, passes, ways[i].path, 1, first);
  }
  const int best = studio->race.count - 1;
  snprintf(variant, sizeof variant, "%s: 2 threads", what);
  add_look(studio, row, variant, guide, passes, STY_PATH_BEST, 2, best);
  return first;
}

/* Finding all seeds anew, beside one transfer by the same path; `transfers`: the place of their reference. */
static void enter_seeds(Studio *studio, int transfers) {
  char variant[64];
  for (int i = 0, transfer = transfers + 1; i < WAYS; i++) {
    if (!sty_has_path(ways[i].path)) continue;
    snprintf(variant, sizeof variant, "new jitter: %s", ways[i].name);
    add_look(studio, "full", variant, studio->waves, SEEDS, ways[i].path, 1, transfer++);
  }
}

/* Styles 2 to 7 are the plain one with four lightings, and with other radii. */
enum { LIT = 2, FIRST_RADIUS = 3, RADII = 5 };
static const int radii[RADII] = {0, 1, 2, 4, 8};

static void set_looks(Studio *studio) {
  StyStyle lit = plain_style;
  lit.layer_count = STY_MAX_LIGHTINGS;
  lit.luma_weight = 0.25f;
  for (int i = 0; i < STY_MAX_LIGHTINGS; i++) lit.luma[i] = (float)i / (STY_MAX_LIGHTINGS - 1);
  set_style(&studio->stage, LIT, &lit);
  for (int i = 0; i < RADII; i++) {
    StyStyle wide = plain_style;
    wide.radius = radii[i];
    set_style(&studio->stage, FIRST_RADIUS + i, &wide);
  }
}

static void enter_styles(Studio *studio) {
  const int one = studio->race.count;
  char variant[64];
  add_look(studio, "full", "frame", studio->waves, TRANSFER | BLEND, STY_PATH_BEST, 1, -1);
  Look *lit = add_look(studio, "full", "frame: four lightings", studio->waves, TRANSFER | BLEND, STY_PATH_BEST, 1, one);
  lit->frame.style = LIT;
  lit->frame.luma = studio->luma;
  for (int i = 0; i < RADII; i++) {
    snprintf(variant, sizeof variant, "frame: radius %d", radii[i]);
    add_look(studio, "full", variant, studio->waves, TRANSFER | BLEND, STY_PATH_BEST, 1, one)->frame.style =
        FIRST_RADIUS + i;
  }
}

static StyStatus race_paths(int repeats, const StyRun *run, RaceResults *results, StyError *error) {
  Studio *studio = NULL;
  StyStatus status = open_studio(FIRST_RADIUS + RADII - 1, &studio, error);
  if (status) return status;
  set_looks(studio);
  memcpy(studio->figure, studio->waves, 4 * (size_t)PIXELS);
  keep_disc(studio->figure, 0.14);
  const int transfers = enter_paths(studio, "full", "transfer", studio->waves, TRANSFER);
  enter_paths(studio, "full", "blend", studio->waves, BLEND);
  enter_paths(studio, "14 % covered", "frame", studio->figure, TRANSFER | BLEND);
  enter_seeds(studio, transfers);
  enter_styles(studio);
  status = run_race(&studio->race, repeats, run, results, error);
  close_studio(studio);
  return status;
}

/* How a frame's time grows with what it covers. */
static StyStatus race_coverage(int repeats, const StyRun *run, RaceResults *results, StyError *error) {
  static const double shares[] = {0, 0.05, 0.25, 0.5, 0.75};
  StyStatus status = STY_OK;
  for (int i = 0; !status && i < 5; i++) {
    Studio *studio = NULL;
    char variant[64];
    status = open_studio(1, &studio, error);
    if (status) return status;
    keep_disc(studio->waves, shares[i]);
    snprintf(variant, sizeof variant, "frame: %.0f %% covered", 100 * shares[i]);
    add_look(studio, "coverage", variant, studio->waves, TRANSFER | BLEND, STY_PATH_BEST, 1, -1);
    status = run_race(&studio->race, repeats, run, results, error);
    close_studio(studio);
  }
  return status;
}

/* How a frame's time grows with its styles, in squares of 60 pixels. */
static StyStatus race_styles(int repeats, const StyRun *run, RaceResults *results, StyError *error) {
  static const int counts[] = {2, 8, 32};
  StyStatus status = STY_OK;
  for (int i = 0; !status && i < 3; i++) {
    Studio *studio = NULL;
    char variant[64];
    status = open_studio(counts[i], &studio, error);
    if (status) return status;
    for (int p = 0; p < PIXELS; p++)
      studio->styles[p] = (uint8_t)(1 + (p % WIDTH / 60 + p / WIDTH / 60 * 7) % counts[i]);
    snprintf(variant, sizeof variant, "frame: %d styles", counts[i]);
    add_look(studio, "styles", variant, studio->waves, TRANSFER | BLEND, STY_PATH_BEST, 1, -1)->frame.styles =
        studio->styles;
    status = run_race(&studio->race, repeats, run, results, error);
    close_studio(studio);
  }
  return status;
}

StyStatus measure_stylizing(int repeats, const StyRun *run, RaceResults *results, StyError *error) {
  StyStatus status = race_paths(repeats, run, results, error);
  if (!status) status = race_coverage(repeats, run, results, error);
  if (!status) status = race_styles(repeats, run, results, error);
  return status;
}
