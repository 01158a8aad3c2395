/* stylut pack MANIFEST.json -o BUNDLE */
#include "pack.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "inside.h"
#include "parameters.h"
#include "stylut/guide.h"
#include "stylut/parse.h"

_Static_assert(STY_MAX_LUT_SIDE == STY_MAX_LUT_SIZE, "a bundle holds every square table there can be");

const char *const fit_names[] = {"none", "resize", "pad", NULL};

enum { KEY_FIT = 0x180, KEY_JITTER_FRAMES, KEY_JITTER_NOISE, KEY_ALLOW_OUTSIDE };
static const struct argp_option making_options[] = {
    {"fit", KEY_FIT, "HOW", 0,
     "exemplars of differing sizes: none (default) refuses them, resize filters them to the largest width and height, "
     "pad adds what isn't covered at the right and below",
     0},
    {"jitter-frames", KEY_JITTER_FRAMES, "N", 0,
     "jitter tables to draw, 1 to 256 (default: 1), which frames take in turn where a style's jitter_period says so",
     0},
    {"jitter-noise", KEY_JITTER_NOISE, "white|blue", 0,
     "how they are drawn: each cell by itself (default), or so that cells that are near get different places, which "
     "takes "
     "about a second a table",
     0},
    {"allow-outside", KEY_ALLOW_OUTSIDE, NULL, 0,
     "take files from outside of the manifest's folder, which are refused else, as are links that lead there", 0},
    {0}};

static error_t parse_making(int key, char *text, struct argp_state *state) {
  PackArguments *arguments = state->input;
  StyError *error = &arguments->options.error;
  StyStatus status = STY_OK;
  long long frames = 0;
  if (key < KEY_FIT || key > KEY_ALLOW_OUTSIDE) return ARGP_ERR_UNKNOWN;
  begin_option(key, text, state);
  switch (key) {
    case KEY_JITTER_FRAMES:
      status = sty_parse_integer("--jitter-frames", text, 1, MOST_JITTERS, &frames, error);
      arguments->jitter_frames = (int)frames;
      break;
    case KEY_JITTER_NOISE:
      status = sty_parse_choice("--jitter-noise", text, sty_noise_names, &arguments->jitter_noise, error);
      break;
    case KEY_ALLOW_OUTSIDE: arguments->allow_outside = true; break;
    default: status = sty_parse_choice("--fit", text, fit_names, &arguments->fit, error); break;
  }
  return end_option(status);
}

const struct argp making_argp = {.options = making_options, .parser = parse_making};

static error_t parse_option(int key, char *text, struct argp_state *state) {
  PackArguments *arguments = state->input;
  StyStatus status = STY_OK;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: status = take_argument(&arguments->options, &arguments->manifest, text); break;
    case ARGP_KEY_END:
      status = require_argument(&arguments->options, arguments->manifest, "the manifest's file name");
      if (!status) status = require_output(&arguments->options);
      break;
    default: return ARGP_ERR_UNKNOWN;
  }
  return end_option(status);
}

static const struct argp_child children[] = {
    {&making_argp, 0, NULL, 0}, {&output_argp, 0, NULL, 0}, {&seed_argp, 0, NULL, 0}, {&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .parser = parse_option,
    .args_doc = "MANIFEST.json -o BUNDLE",
    .doc =
        "Packs exemplars, guides, look-up tables and parameters of 1 to 256 styles into a bundle: a folder of KTX2 "
        "texture arrays that engines and the runtime read.\v"
        "The manifest:\n"
        "  { \"schema\": \"stylut-bundle/1\",\n"
        "    \"styles\": [ { \"name\": \"pencil\", \"exemplar\": \"pencil.png\",\n"
        "                  \"guide\": \"sphere\",\n"
        "                  \"lut\": { \"size\": 256, \"engine\": \"auto\",\n"
        "                           \"resolve\": \"nearest\", \"sampling\": \"unorm8\" },\n"
        "                  \"params\": { \"threshold\": 24, \"top_level\": 6, \"radius\": 1,\n"
        "                              \"depth_tolerance\": 0, \"luma_weight\": 0,\n"
        "                              \"colour_weight\": 0, \"jitter_amount\": 1,\n"
        "                              \"jitter_period\": 0, \"scale\": 1,\n"
        "                              \"objects\": false, \"scatter\": 0 } } ],\n"
        "    \"jitter\": \"table.png\" }\n"
        "Only name and exemplar are needed; the values above are the defaults. Up to four exemplars by luminance are "
        "\"exemplars\": [ { \"image\": \"dark.png\", \"luma\": 0.2 }, ... ], whose \"luma_weight\" is 0.25 "
        "unless given. \"base\": SIGMA takes low frequencies (a Gaussian of so many pixels) from the lit sphere. "
        "\"guide\" may name a guide file or a scene, \"lut\" a table (or { \"file\": ..., \"sampling\": ... }); "
        "{ \"budget\": { \"p99\": 1 } } (mean, p99, max; degrees) asks for the smallest table that meets it, "
        "\"resolve\" (coherent; frames or both with \"frames\": [ ... ]) chooses among pixels within \"slack\". "
        "What many styles share stands once, in \"defaults\": { \"guide\", \"base\", \"lut\", \"params\", \"check\" }; "
        "{ "
        "\"glob\": "
        "\"painted/*.png\" } is a style for each file, named as it is without the extension, which {name} in "
        "\"guide\" and \"lut\" stands for. "
        "Without \"jitter\" (or a list of them) the table is drawn from --seed. Paths are relative to the manifest.",
    .children = children,
};

/* ---- styles --------------------------------------------------------------------- */

/* Source and table of a style. */
typedef struct Prepared {
  int style; /* -1: none */
  Source source;
  Table table;
  bool same_table; /* as the style before has */
} Prepared;

static void close_prepared(Prepared *prepared) {
  close_source(&prepared->source);
  free(prepared->table.texels);
  *prepared = (Prepared){.style = -1};
}

/* Styles are prepared some at a time, by all threads, and written in their order. How many doesn't depend on the
 * threads, so that it is always the same failure that is found first. */
enum { MOST_AT_ONCE = 8 };
typedef struct Handful {
  const Packing *packing;
  int first, count;
  Prepared prepared[MOST_AT_ONCE], before; /* the style before the first */
  Guide guides[MOST_AT_ONCE];
  int guide_count, guide_of[MOST_AT_ONCE];
} Handful;

/* Bytes that styles hold at a time, beside the one that there must be. */
static const double most_held = 1 << 27;

static int count_at_once(const Packing *packing) {
  enum { PIXEL_BYTES = 4 * sizeof(float) + 4 + 4 }; /* guide, its texels, an exemplar */
  const double fit = most_held / ((double)packing->size.width * packing->size.height * PIXEL_BYTES);
  return fit < 1 ? 1 : fit < MOST_AT_ONCE ? (int)fit : MOST_AT_ONCE;
}

/* Of the guides only the one that was used last may be wanted again. */
static StyStatus open_guides(Handful *handful, StyError *error) {
  StyStatus status = STY_OK;
  for (int i = 0; i < handful->guide_count - 1; i++) close_guide(&handful->guides[i]);
  if (handful->guide_count > 1) handful->guides[0] = handful->guides[handful->guide_count - 1];
  if (handful->guide_count > 1) handful->guide_count = 1;
  for (int i = 0; !status && i < handful->count; i++) {
    const int style = handful->first + i;
    if (handful->guide_count == 0 || !is_same_guide(handful->packing, style - 1, style)) {
      if (i == 0 && handful->guide_count) close_guide(&handful->guides[--handful->guide_count]);
      status = open_guide(handful->packing, style, &handful->guides[handful->guide_count], error);
      if (!status) handful->guide_count++;
    }
    handful->guide_of[i] = handful->guide_count - 1;
  }
  return status;
}

static StyStatus prepare_source(void *context, long i, StyError *error) {
  Handful *handful = context;
  Prepared *prepared = &handful->prepared[i];
  prepared->style = handful->first + (int)i;
  return open_source(handful->packing, prepared->style, &handful->guides[handful->guide_of[i]], &prepared->source,
                     error);
}

/* Whether one table serves both: of one guide, asked for in the same words, with paint on the same pixels. */
static bool is_same_table(const Packing *packing, const Prepared *a, const Prepared *b) {
  if (a->style < 0 || !is_same_guide(packing, a->style, b->style)) return false;
  const json_t *asked[2] = {packing->manifest.styles[a->style].lut.written,
                            packing->manifest.styles[b->style].lut.written};
  return (asked[0] == asked[1] || json_equal(asked[0], asked[1])) &&
         memcmp(sty_find_channel(a->source.guide, "A"), sty_find_channel(b->source.guide, "A"),
                sty_count_pixels(a->source.guide) * sizeof(float)) == 0;
}

static StyStatus prepare_table(void *context, long i, StyError *error) {
  Handful *handful = context;
  Prepared *prepared = &handful->prepared[i];
  if (prepared->same_table) return STY_OK;
  return make_table(handful->packing, prepared->style, prepared->source.guide, &prepared->table, error);
}

static StyStatus copy_table(const Packing *packing, const Table *table, Table *out, StyError *error) {
  const size_t size = (size_t)packing->lut_size * (size_t)packing->lut_size * 2 * sizeof *table->texels;
  *out = *table;
  out->texels = malloc(size);
  if (!out->texels) return sty_fail_memory(error, "table", (double)size);
  memcpy(out->texels, table->texels, size);
  return STY_OK;
}

/* What is read may be warned of, in the styles' order; and where there are fewer tables than threads, each is better
 * made by all of them. */
static bool is_side_by_side(const Handful *handful, const StyRun *run) {
  int tables = 0;
  for (int i = 0; i < handful->count; i++) {
    const StyManifestStyle *style = &handful->packing->manifest.styles[handful->first + i];
    if (style->lut.file || style->lut.frames) return false;
    tables += !handful->prepared[i].same_table;
  }
  return tables >= sty_get_threads(run);
}

static StyStatus prepare_tables(Handful *handful, const StyRun *run, StyError *error) {
  StyStatus status = STY_OK;
  for (int i = 0; i < handful->count; i++)
    handful->prepared[i].same_table =
        is_same_table(handful->packing, i ? &handful->prepared[i - 1] : &handful->before, &handful->prepared[i]);
  if (is_side_by_side(handful, run))
    status = sty_parallel_for(run, handful->count, prepare_table, handful, error);
  else
    for (int i = 0; !status && i < handful->count; i++) status = prepare_table(handful, i, error);
  for (int i = 0; !status && i < handful->count; i++) {
    Prepared *prepared = &handful->prepared[i];
    const Prepared *before = i ? prepared - 1 : &handful->before;
    if (prepared->same_table) status = copy_table(handful->packing, &before->table, &prepared->table, error);
  }
  return status;
}

/* Without `tables`, all but those. */
static StyStatus prepare_styles(Handful *handful, bool tables, StyError *error) {
  const StyRun run = {.threads = handful->packing->arguments->options.threads};
  StyStatus status = open_guides(handful, error);
  if (!status) status = sty_parallel_for(&run, handful->count, prepare_source, handful, error);
  if (!status && tables) status = prepare_tables(handful, &run, error);
  return status;
}

/* The last one is the next handful's before. */
static void close_styles(Handful *handful) {
  close_prepared(&handful->before);
  handful->before = handful->prepared[handful->count - 1];
  for (int i = 0; i < handful->count - 1; i++) close_prepared(&handful->prepared[i]);
  handful->prepared[handful->count - 1] = (Prepared){.style = -1};
}

/* Share of a guide without paint that no exemplar of the same picture has; paint without guide is common: canvas. */
static const double most_unpainted = 0.25;

void review_overlap(const Packing *packing, const Options *options, int number, const Overlap *overlap) {
  const StyManifestStyle *style = &packing->manifest.styles[number];
  const Size size = packing->sizes[number];
  const double unpainted = 1 - (double)overlap->painted / (double)(overlap->guided ? overlap->guided : 1);
  if (unpainted > most_unpainted)
    warn(options,
         "style '%s': found %.0f %% of what its guide covers without paint, expected the guide of the scene that was "
         "painted",
         clean_text(style->name), 100 * unpainted);
  if (is_sphere(style) && size.width != size.height)
    warn(options,
         "style '%s': found an exemplar of %dx%d pixels, whose guide is an ellipse then, expected a square one",
         clean_text(style->name), size.width, size.height);
}

void review_holes(const Options *options, const StyManifestStyle *style, size_t holes) {
  if (holes)
    warn(options,
         "style '%s': found %zu entries of %s where the exemplar has no paint or the guide is empty, expected them on "
         "paint; without \"lut\" a table is made that is",
         clean_text(style->name), holes, clean_text(style->lut.file));
}

static StyStatus read_jitter(const Packing *packing, const char *name, uint8_t *out, StyError *error) {
  char *path = find_file(packing, name, error);
  if (!path) return STY_ERROR_LIBRARY;
  uint8_t *bytes = NULL;
  Size size = {0};
  StyStatus status = read_bytes(path, &bytes, &size, error);
  if (!status && (size.width != STY_JITTER_SIZE || size.height != STY_JITTER_SIZE))
    status = sty_fail(error, STY_ERROR_INPUT, "%s: found %dx%d pixels, expected a jitter table of %dx%d", path,
                      size.width, size.height, STY_JITTER_SIZE, STY_JITTER_SIZE);
  for (int i = 0; !status && i < STY_JITTER_SIZE * STY_JITTER_SIZE; i++) {
    out[2 * i] = bytes[4 * i];
    out[2 * i + 1] = bytes[4 * i + 1];
  }
  free(bytes);
  free(path);
  return status;
}

int count_jitters(const Packing *packing) {
  const json_t *files = packing->manifest.jitter;
  return files ? (int)sty_count_manifest_names(files) : packing->arguments->jitter_frames;
}

static StyStatus draw_jitters(const Packing *packing, int count, uint8_t *tables, StyError *error) {
  const PackArguments *arguments = packing->arguments;
  const StyRun run = begin_progress(&arguments->options, "jitter");
  const StyStatus status =
      sty_make_jitters((StyNoise)arguments->jitter_noise, arguments->options.seed, count, &run, tables, error);
  end_progress(&arguments->options);
  return status;
}

StyStatus get_jitters(const Packing *packing, uint8_t **out, StyError *error) {
  const json_t *files = packing->manifest.jitter;
  const int count = count_jitters(packing);
  uint8_t *tables = malloc((size_t)count * STY_JITTER_BYTES);
  if (!tables) return sty_fail_memory(error, "jitter", (double)count * STY_JITTER_BYTES);
  StyStatus status =
      files || packing->arguments->options.dry_run ? STY_OK : draw_jitters(packing, count, tables, error);
  for (int i = 0; files && !status && i < count; i++)
    status = read_jitter(packing, sty_get_manifest_name(files, (size_t)i), tables + i * STY_JITTER_BYTES, error);
  if (status)
    free(tables);
  else
    *out = tables;
  return status;
}

/* Tables are drawn where none are brought. */
static StyStatus check_jitter(const Packing *packing) {
  static const char *const expected = "a manifest without the key \"jitter\", which brings tables of its own";
  const bool draws = !packing->manifest.jitter;
  const OptionNeed needs[] = {{"jitter-frames", draws, expected}, {"jitter-noise", draws, expected}};
  return check_needs(&packing->arguments->options, needs, 2);
}

static StyBundleShape get_shape(const Packing *packing) {
  StyBundleShape shape = {.width = packing->size.width,
                          .height = packing->size.height,
                          .lut_size = packing->lut_size,
                          .style_count = packing->manifest.style_count,
                          .jitter_count = count_jitters(packing)};
  for (int i = 0; i < shape.style_count; i++)
    shape.exemplar_count += sty_count_layers(&packing->manifest.styles[i].parameters);
  return shape;
}

static StyStatus write_style(const Packing *packing, const Prepared *prepared, int layer, StyBundleWriter *writer,
                             json_t *styles, StyError *error) {
  const Options *options = &packing->arguments->options;
  const StyManifestStyle *style = &packing->manifest.styles[prepared->style];
  StyStyle parameters = style->parameters;
  review_overlap(packing, options, prepared->style, &prepared->source.overlap);
  review_holes(options, style, prepared->table.holes);
  review_parameters(options, style->name, &parameters, count_jitters(packing));
  if (prepared->table.unorm8) parameters.flags |= STY_FLAG_UNORM8;
  if (writer) {
    const StyStatus status = sty_write_style(writer, (const uint8_t *const *)prepared->source.layers,
                                             prepared->source.texels, prepared->table.texels, &parameters, error);
    if (status) return status;
  }
  json_array_append_new(styles, describe_style(packing, prepared->style, &parameters, layer, &prepared->table));
  return STY_OK;
}

/* Without a writer all is read, and no table made. */
static StyStatus write_styles(const Packing *packing, StyBundleWriter *writer, json_t *styles, StyError *error) {
  const int count = packing->manifest.style_count, some = count_at_once(packing);
  Handful handful = {.packing = packing, .before = {.style = -1}};
  StyStatus status = STY_OK;
  int layer = 0;
  const StyRun run = begin_progress(&packing->arguments->options, "packing");
  for (; !status && handful.first < count; handful.first += handful.count) {
    handful.count = count - handful.first < some ? count - handful.first : some;
    status = prepare_styles(&handful, writer, error);
    for (int i = 0; !status && i < handful.count; i++) {
      status = write_style(packing, &handful.prepared[i], layer, writer, styles, error);
      layer += sty_count_layers(&packing->manifest.styles[handful.first + i].parameters);
    }
    close_styles(&handful);
    if (run.progress) run.progress(run.context, (double)(handful.first + handful.count) / count);
  }
  end_progress(&packing->arguments->options);
  close_prepared(&handful.before);
  for (int i = 0; i < handful.guide_count; i++) close_guide(&handful.guides[i]);
  return status;
}

/* Texels of all textures; headers are a few hundred bytes each. */
static double count_bytes(const StyBundleShape *shape) {
  const double layer = 4.0 * shape->width * shape->height, styles = shape->style_count;
  return layer * (shape->exemplar_count + styles) + 4.0 * shape->lut_size * shape->lut_size * styles +
         16.0 * STY_PARAM_ROWS * styles + (double)STY_JITTER_BYTES * shape->jitter_count;
}

static StyStatus report_bytes(Options *options, const StyBundleShape *shape) {
  const double bytes = count_bytes(shape);
  return report_estimate(options,
                         json_pack("{s:i, s:[ii], s:i, s:i, s:i, s:I}", "styles", shape->style_count, "size",
                                   shape->width, shape->height, "exemplar_layers", shape->exemplar_count, "lut_size",
                                   shape->lut_size, "jitter_tables", shape->jitter_count, "bytes", (json_int_t)bytes),
                         "%d style%s, %d exemplar layer%s of %dx%d, tables of %d a side: about %.0f bytes",
                         shape->style_count, shape->style_count == 1 ? "" : "s", shape->exemplar_count,
                         shape->exemplar_count == 1 ? "" : "s", shape->width, shape->height, shape->lut_size, bytes);
}

/* The style whose table errs most. */
static const json_t *find_worst(const json_t *styles, double *p99) {
  const json_t *style, *worst = NULL;
  size_t i;
  json_array_foreach(styles, i, style) {
    const json_t *error = json_object_get(json_object_get(style, "lut"), "error");
    const double found = json_number_value(json_object_get(error, "p99"));
    if (!error || (worst && found <= *p99)) continue;
    worst = style;
    *p99 = found;
  }
  return worst;
}

/* What exemplars of another size than the bundle's have become. */
static void print_fits(const Packing *packing) {
  const bool pads = packing->arguments->fit == FIT_PAD;
  for (int i = 0; i < packing->manifest.style_count; i++) {
    const Size from = packing->sizes[i], to = packing->size;
    if (from.width != to.width || from.height != to.height)
      printf("style '%s': %dx%d %s %dx%d%s\n", clean_text(packing->manifest.styles[i].name), from.width, from.height,
             pads ? "padded to" : "filtered to", to.width, to.height,
             pads || (long long)from.width * to.height == (long long)to.width * from.height ? "" : ", out of shape");
  }
}

static json_t *list_tables(const json_t *styles) {
  json_t *out = json_array(), *style;
  size_t i;
  json_array_foreach(styles, i, style)
      json_array_append_new(out, json_pack("{s:O, s:O, s:O}", "name", json_object_get(style, "name"), "size",
                                           json_object_get(style, "size"), "lut", json_object_get(style, "lut")));
  return out;
}

static StyStatus print_report(Options *options, const Packing *packing, const json_t *styles, double milliseconds,
                              StyError *error) {
  const StyBundleShape shape = get_shape(packing);
  double p99 = 0;
  if (options->dry_run) return report_bytes(options, &shape);
  if (options->json)
    return print_json(json_pack("{s:s, s:o, s:i, s:[ii], s:i, s:i, s:I, s:o, s:f, s:f}", "schema", "stylut-pack/1",
                                "bundle", make_json_text(options->output), "styles", shape.style_count, "size",
                                shape.width, shape.height, "exemplar_layers", shape.exemplar_count, "lut_size",
                                shape.lut_size, "bytes", (json_int_t)count_bytes(&shape), "tables", list_tables(styles),
                                "time_ms", milliseconds, "peak_bytes", get_peak_bytes()),
                      error);
  if (options->quiet) return STY_OK;
  printf("%s: %d style%s in %.0f ms: %d layer%s of %dx%d, tables of %d a side\n", clean_text(options->output),
         shape.style_count, shape.style_count == 1 ? "" : "s", milliseconds, shape.exemplar_count,
         shape.exemplar_count == 1 ? "" : "s", shape.width, shape.height, shape.lut_size);
  print_fits(packing);
  const json_t *worst = find_worst(styles, &p99);
  if (worst)
    printf("tables are off by up to %.4g degrees (99th percentile, style '%s')\n", p99,
           clean_text(json_string_value(json_object_get(worst, "name"))));
  return STY_OK;
}

/* Budgets are for exact tables, and slack is counted from their distances. */
static bool takes_exact(const StyManifestStyle *style) {
  return strcmp(style->lut.resolve, "nearest") != 0 || style->lut.most_mean > 0 || style->lut.most_p99 > 0 ||
         style->lut.most_error > 0;
}

/* The manifest's reader knows no engines; their names are checked here. */
static StyStatus check_engines(const StyManifest *manifest, StyError *error) {
  for (int i = 0; i < manifest->style_count; i++) {
    const StyManifestStyle *style = &manifest->styles[i];
    const StyEngine *engine;
    StyError cause;
    if (sty_find_engine("engine", style->lut.engine, &engine, &cause) == STY_OK) {
      if (engine->exact || !takes_exact(style)) continue;
      sty_fail(&cause, STY_ERROR_USAGE, "one of the exact engines, as budgets and \"resolve\" count from the least");
    }
    json_t *name = json_string(style->lut.engine);
    const char *expected = strstr(cause.text, "one of ");
    sty_fail_manifest_value(manifest, style, "lut", "engine", name, expected ? expected : "an engine", error);
    json_decref(name);
    return STY_ERROR_INPUT;
  }
  return STY_OK;
}

/* Nor does it know what audits can be held to. */
static StyStatus check_limits(const StyManifest *manifest, StyError *error) {
  for (int i = 0; i < manifest->style_count; i++) {
    const StyManifestStyle *style = &manifest->styles[i];
    const char *key;
    json_t *budget;
    json_object_foreach((json_t *)(uintptr_t)style->check, key, budget) {
      const StyLimit *limit = sty_limits;
      char expected[512] = "one of";
      while (limit->name && strcmp(limit->name, key) != 0) limit++;
      for (const StyLimit *l = sty_limits; !limit->name && l->name; l++)
        snprintf(expected + strlen(expected), sizeof expected - strlen(expected), "%s %s", l == sty_limits ? "" : ",",
                 l->name);
      if (limit->name) snprintf(expected, sizeof expected, "a number from 0 to %g", limit->largest);
      const double value = json_number_value(budget);
      if (!limit->name || !json_is_number(budget) || !(value >= 0 && value <= limit->largest))
        return sty_fail_manifest_value(manifest, style, "check", key, budget, expected, error);
    }
  }
  return STY_OK;
}

StyStatus check_manifest(const Packing *packing, StyError *error) {
  StyStatus status = check_engines(&packing->manifest, error);
  if (!status) status = check_limits(&packing->manifest, error);
  return status ? status : check_jitter(packing);
}

/* All but the report, for which `styles` is filled with what the index says of them. */
static StyStatus pack(Packing *packing, json_t *styles, StyError *error) {
  const Options *options = &packing->arguments->options;
  StyBundleWriter *writer = NULL;
  uint8_t *jitters = NULL;
  json_t *index = json_object();
  json_object_set(index, "styles", styles);
  json_object_set_new(index, "jitter", describe_jitter(packing));
  StyStatus status = options->no_history ? STY_OK : begin_history(packing, index, error);
  if (!status) status = measure_exemplars(packing, error);
  if (!status) status = settle_lut_size(packing, error);
  if (!status) status = get_jitters(packing, &jitters, error);
  const StyBundleShape shape = get_shape(packing);
  const StyRun run = {.threads = options->threads};
  if (!status)
    status = options->dry_run ? sty_check_bundle_place(options->output, error)
                              : sty_open_bundle_writer(options->output, &shape, &writer, error);
  if (!status) status = write_styles(packing, writer, styles, error);
  if (!status && writer) status = sty_commit_bundle(&writer, jitters, index, &run, error);
  sty_discard_bundle(&writer);
  free(jitters);
  json_decref(index);
  return status;
}

static StyStatus run(PackArguments *arguments) {
  StyError *error = &arguments->options.error;
  const double start = sty_get_milliseconds();
  Packing *packing = calloc(1, sizeof *packing);
  if (!packing) return sty_fail_memory(error, arguments->manifest, sizeof *packing);
  packing->arguments = arguments;
  packing->command = "pack";
  packing->guides = json_object();
  StyStatus status = sty_read_manifest(arguments->manifest, &packing->manifest, error);
  if (!status) status = check_manifest(packing, error);
  if (!status) status = check_paths(packing, error);
  json_t *styles = json_array();
  if (!status) status = pack(packing, styles, error);
  if (!status) status = print_report(&arguments->options, packing, styles, sty_get_milliseconds() - start, error);
  json_decref(styles);
  sty_close_manifest(&packing->manifest);
  json_decref(packing->guides);
  free(packing->root);
  free(packing);
  return status;
}

StyStatus run_pack(int argc, char **argv) {
  PackArguments arguments = {.jitter_frames = 1};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments);
  return finish_command(&arguments.options, status);
}
