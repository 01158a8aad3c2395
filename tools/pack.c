/* stylut pack MANIFEST.json -o BUNDLE */
#include "stylut/pack.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "inputs.h"
#include "options.h"
#include "stylut/image_io.h"

_Static_assert(STY_MAX_LUT_SIDE == STY_MAX_LUT_SIZE, "a bundle holds every square table there can be");

typedef struct Arguments {
  Options options;
  const char *manifest;
} Arguments;

static error_t parse_option(int key, char *text, struct argp_state *state) {
  Arguments *arguments = state->input;
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
    {&output_argp, 0, NULL, 0}, {&seed_argp, 0, NULL, 0}, {&common_argp, 0, NULL, 0}, {0}};
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
        "                  \"lut\": { \"size\": 256, \"engine\": \"auto\", \"sampling\": \"unorm8\" },\n"
        "                  \"params\": { \"threshold\": 24, \"top_level\": 6, \"radius\": 1,\n"
        "                              \"depth_tolerance\": 0 } } ],\n"
        "    \"jitter\": \"table.png\" }\n"
        "Only name and exemplar are needed; the values above are the defaults. \"guide\" may name a guide file, "
        "\"lut\" a table (or { \"file\": ..., \"sampling\": ... }); without \"jitter\" the table is drawn from "
        "--seed. Paths are relative to the manifest.",
    .children = children,
};

/* All of one style, ready to be written. */
typedef struct Textures {
  int width, height;
  uint8_t *exemplar, *guide;
  uint16_t *lut;
  int lut_size;
  StyStyle parameters;
} Textures;

static void destroy_textures(Textures *textures) {
  free(textures->exemplar);
  free(textures->guide);
  free(textures->lut);
  *textures = (Textures){0};
}

/* Reads a picture as RGBA bytes. */
static StyStatus read_bytes(const char *path, uint8_t **bytes, int *width, int *height, StyError *error) {
  StyImage *image = NULL;
  StyStatus status = sty_read_image(path, &image, error);
  uint8_t *out = status ? NULL : malloc(4 * sty_count_pixels(image));
  if (!status && !out) status = sty_fail_memory(error, path, 4.0 * (double)sty_count_pixels(image));
  if (!status) status = sty_convert_to_rgba8(path, image, out, error);
  if (status) {
    free(out);
  } else {
    *bytes = out;
    *width = image->width;
    *height = image->height;
  }
  sty_destroy_image(&image);
  return status;
}

/* The source guide of a style: the sphere that fills the exemplar, or a file. */
static StyStatus get_guide(const Arguments *arguments, const StyManifest *manifest, const StyManifestStyle *style,
                           int width, int height, StyImage **out, StyError *error) {
  if (strcmp(style->guide, "sphere") == 0) return sty_make_sphere_guide(width, height, STY_GUIDE_NORMAL, out, error);
  char *path = sty_join_path(manifest->folder, style->guide);
  if (!path) return sty_fail_memory(error, style->guide, 0);
  StyStatus status = read_guide(&arguments->options, path, out, error);
  if (!status && ((*out)->width != width || (*out)->height != height)) {
    status = sty_fail(error, STY_ERROR_INPUT,
                      "style '%s': found exemplar %s of %dx%d and guide %s of %dx%d pixels, expected one size",
                      style->name, style->exemplar, width, height, style->guide, (*out)->width, (*out)->height);
    sty_destroy_image(out);
  }
  free(path);
  return status;
}

static StyStatus encode_guide(const StyImage *guide, uint8_t *out, StyError *error) {
  StyImage *encoded = NULL;
  StyStatus status = sty_encode_normals(guide, 8, &encoded, error);
  if (!status) status = sty_convert_to_rgba8("guide", encoded, out, error);
  sty_destroy_image(&encoded);
  return status;
}

/* "unorm8" or "centre", as the manifest's reader made sure; -1 for none. */
static int get_sampling(const char *name) {
  return !name ? -1 : strcmp(name, "unorm8") == 0 ? STY_SAMPLE_UNORM8 : STY_SAMPLE_CENTRE;
}

static StyStatus get_lut(const Arguments *arguments, const StyManifest *manifest, const StyManifestStyle *style,
                         const StyImage *guide, StyLut **out, StyError *error) {
  if (style->lut_file) {
    const StyLutHints hints = {guide->width, guide->height, get_sampling(style->lut_sampling), STY_FOREIGN_NONE};
    char *path = sty_join_path(manifest->folder, style->lut_file);
    const bool sphere = strcmp(style->guide, "sphere") == 0;
    char *guide_path = sphere ? NULL : sty_join_path(manifest->folder, style->guide);
    bool of_another;
    StyStatus status = path && (sphere || guide_path)
                           ? read_lut(&arguments->options, path, guide_path, &hints, out, &of_another, error)
                           : sty_fail_memory(error, style->lut_file, 0);
    free(path);
    free(guide_path);
    if (!status && ((*out)->spec.map != STY_MAP_XY || (*out)->spec.sampling == STY_SAMPLE_CORNER)) {
      status = sty_fail(error, STY_ERROR_INPUT,
                        "%s: found a LUT of map %s and sampling %s, expected xy and centre or unorm8", style->lut_file,
                        sty_map_names[(*out)->spec.map], sty_sampling_names[(*out)->spec.sampling]);
      sty_destroy_lut(out);
    }
    return status;
  }
  const StyEngine *engine = NULL;
  StySites *sites = NULL;
  StyStatus status = sty_find_engine("engine", style->lut_engine, &engine, error);
  char name[512]; /* only what is covered by both counts */
  snprintf(name, sizeof name, "%.200s (guide %.200s)", style->exemplar, style->guide);
  if (!status) status = sty_collect_sites(name, guide, &sites, error);
  const StyRun run = {.threads = arguments->options.threads};
  const StyLutSpec spec = {
      .width = style->lut_size, .height = style->lut_size, .sampling = (StySampling)get_sampling(style->lut_sampling)};
  if (!status) status = sty_build_lut(sites, engine, NULL, &spec, &run, out, error);
  sty_destroy_sites(&sites);
  return status;
}

static void encode_lut(const StyLut *lut, uint16_t *out) {
  const uint32_t width = (uint32_t)lut->source_width, height = (uint32_t)lut->source_height;
  for (size_t t = 0; t < sty_count_texels(&lut->spec); t++) {
    out[2 * t] = (uint16_t)sty_encode_coordinate(lut->pixels[t] % width, width, 65535);
    out[2 * t + 1] = (uint16_t)sty_encode_coordinate(lut->pixels[t] / width, height, 65535);
  }
}

/* Whether two styles have the same source: one table then serves both. */
static bool same_source(const StyManifestStyle *a, const StyManifestStyle *b) {
  if (strcmp(a->guide, b->guide) != 0 || (a->lut_file == NULL) != (b->lut_file == NULL)) return false;
  const bool same_sampling = get_sampling(a->lut_sampling) == get_sampling(b->lut_sampling);
  if (a->lut_file) return strcmp(a->lut_file, b->lut_file) == 0 && same_sampling;
  return strcmp(a->lut_engine, b->lut_engine) == 0 && a->lut_size == b->lut_size && same_sampling;
}

/* Whether there is paint on a pixel of an exemplar; less is a hole that no
 * surface should be given. */
static bool has_paint(const uint8_t *exemplar, size_t pixel) { return exemplar[4 * pixel + 3] >= 128; }

static void uncover_unpainted(const uint8_t *exemplar, StyImage *guide) {
  float *covered = sty_find_channel(guide, "A");
  for (size_t i = 0; i < sty_count_pixels(guide); i++)
    if (!has_paint(exemplar, i)) covered[i] = 0;
}

static bool same_paint(const Textures *a, const Textures *b) {
  const size_t pixels = (size_t)a->width * (size_t)a->height;
  for (size_t i = 0; i < pixels; i++)
    if (has_paint(a->exemplar, i) != has_paint(b->exemplar, i)) return false;
  return true;
}

/* Fills guide and LUT of `textures`, whose exemplar is there. */
static StyStatus prepare_source(const Arguments *arguments, const StyManifest *manifest, const StyManifestStyle *style,
                                Textures *textures, StyError *error) {
  StyImage *guide = NULL;
  StyLut *lut = NULL;
  const size_t pixels = (size_t)textures->width * (size_t)textures->height;
  StyStatus status = get_guide(arguments, manifest, style, textures->width, textures->height, &guide, error);
  if (!status) uncover_unpainted(textures->exemplar, guide);
  if (!status) status = get_lut(arguments, manifest, style, guide, &lut, error);
  if (!status) {
    textures->lut_size = lut->spec.width;
    textures->guide = malloc(4 * pixels);
    textures->lut = malloc(sty_count_texels(&lut->spec) * 4);
    if (!textures->guide || !textures->lut) status = sty_fail_memory(error, style->name, 4.0 * (double)pixels);
  }
  if (!status) status = encode_guide(guide, textures->guide, error);
  if (!status) {
    encode_lut(lut, textures->lut);
    textures->parameters.flags = lut->spec.sampling == STY_SAMPLE_UNORM8 ? STY_FLAG_UNORM8 : 0;
  }
  sty_destroy_image(&guide);
  sty_destroy_lut(&lut);
  return status;
}

/* Replaces what `textures` hold of the style before (NULL for the first) by this style's. */
static StyStatus prepare_style(const Arguments *arguments, const StyManifest *manifest, const StyManifestStyle *style,
                               const StyManifestStyle *before, Textures *textures, StyError *error) {
  Textures next = {.parameters = style->parameters};
  char *path = sty_join_path(manifest->folder, style->exemplar);
  StyStatus status = path ? read_bytes(path, &next.exemplar, &next.width, &next.height, error)
                          : sty_fail_memory(error, style->exemplar, 0);
  free(path);
  if (!status && (next.width > STY_MAX_SOURCE_SIDE || next.height > STY_MAX_SOURCE_SIDE))
    status = sty_fail(error, STY_ERROR_INPUT, "style '%s': found exemplar %s of %dx%d pixels, expected sides up to %d",
                      style->name, style->exemplar, next.width, next.height, STY_MAX_SOURCE_SIDE);
  if (!status && before && (next.width != textures->width || next.height != textures->height))
    status = sty_fail(error, STY_ERROR_INPUT,
                      "found exemplars %s of %dx%d and %s of %dx%d pixels, expected one size in a bundle",
                      before->exemplar, textures->width, textures->height, style->exemplar, next.width, next.height);
  if (!status && before && same_source(before, style) && same_paint(textures, &next)) {
    next.guide = textures->guide;
    next.lut = textures->lut;
    next.lut_size = textures->lut_size;
    next.parameters.flags = textures->parameters.flags;
    textures->guide = NULL;
    textures->lut = NULL;
  } else if (!status) {
    status = prepare_source(arguments, manifest, style, &next, error);
  }
  if (!status && before && next.lut_size != textures->lut_size)
    status = sty_fail(error, STY_ERROR_INPUT,
                      "found LUTs of %d texels a side for style '%s' and %d for '%s', expected one size in a bundle",
                      textures->lut_size, before->name, next.lut_size, style->name);
  destroy_textures(textures);
  *textures = next;
  return status;
}

static StyStatus read_jitter(const Arguments *arguments, const StyManifest *manifest, uint8_t *out, StyError *error) {
  if (!manifest->jitter) {
    sty_make_jitter(arguments->options.seed, out);
    return STY_OK;
  }
  char *path = sty_join_path(manifest->folder, manifest->jitter);
  uint8_t *bytes = NULL;
  int width = 0, height = 0;
  StyStatus status =
      path ? read_bytes(path, &bytes, &width, &height, error) : sty_fail_memory(error, manifest->jitter, 0);
  if (!status && (width != STY_JITTER_SIZE || height != STY_JITTER_SIZE))
    status = sty_fail(error, STY_ERROR_INPUT, "%s: found %dx%d pixels, expected a jitter table of %dx%d", path, width,
                      height, STY_JITTER_SIZE, STY_JITTER_SIZE);
  for (int i = 0; !status && i < STY_JITTER_SIZE * STY_JITTER_SIZE; i++) {
    out[2 * i] = bytes[4 * i];
    out[2 * i + 1] = bytes[4 * i + 1];
  }
  free(bytes);
  free(path);
  return status;
}

/* Adds the hash of a file named in the manifest, once. */
static StyStatus record_input(const char *folder, const char *name, json_t *inputs, StyError *error) {
  char hash[STY_HASH_SIZE];
  if (json_object_get(inputs, name)) return STY_OK;
  char *path = sty_join_path(folder, name);
  const StyStatus status = path ? sty_hash_file(path, hash, error) : sty_fail_memory(error, name, 0);
  if (!status) json_object_set_new(inputs, name, json_string(hash));
  free(path);
  return status;
}

/* How the bundle came about: the command, and every file that went in. */
static StyStatus record_inputs(const Arguments *arguments, const StyManifest *manifest, json_t *index,
                               StyError *error) {
  char hash[STY_HASH_SIZE];
  json_t *inputs = json_object();
  StyStatus status = sty_hash_file(arguments->manifest, hash, error);
  if (!status && manifest->jitter) status = record_input(manifest->folder, manifest->jitter, inputs, error);
  for (int i = 0; !status && i < manifest->style_count; i++) {
    const StyManifestStyle *style = &manifest->styles[i];
    status = record_input(manifest->folder, style->exemplar, inputs, error);
    if (!status && strcmp(style->guide, "sphere") != 0)
      status = record_input(manifest->folder, style->guide, inputs, error);
    if (!status && style->lut_file) status = record_input(manifest->folder, style->lut_file, inputs, error);
  }
  json_object_set_new(index, "history",
                      json_pack("{s:o, s:s, s:o}", "command", get_command_line(&arguments->options, "pack"), "manifest",
                                hash, "inputs", inputs));
  return status;
}

/* What the index says of one style. */
static void describe_style(const StyManifest *manifest, int number, const Textures *textures, json_t *styles) {
  const StyManifestStyle *style = &manifest->styles[number];
  const StyStyle *p = &textures->parameters;
  json_t *lut =
      json_pack("{s:i, s:s}", "size", textures->lut_size, "sampling", p->flags & STY_FLAG_UNORM8 ? "unorm8" : "centre");
  if (style->lut_file)
    json_object_set_new(lut, "file", json_string(style->lut_file));
  else
    json_object_set_new(lut, "engine", json_string(style->lut_engine));
  json_array_append_new(
      styles,
      json_pack("{s:i, s:s, s:{s:s, s:[ii]}, s:s, s:o, s:{s:i, s:i, s:i, s:f}, s:[ii]}", "id", number + 1, "name",
                style->name, "exemplar", "file", style->exemplar, "size", textures->width, textures->height, "guide",
                style->guide, "lut", lut, "params", "threshold", p->threshold, "top_level", p->top_level, "radius",
                p->radius, "depth_tolerance", (double)p->depth_tolerance, "layers", number, 1));
}

static StyStatus write_styles(const Arguments *arguments, const StyManifest *manifest, StyBundleWriter **writer,
                              json_t *styles, StyError *error) {
  Textures textures = {0};
  StyStatus status = STY_OK;
  const StyRun run = begin_progress(&arguments->options, "packing");
  for (int i = 0; !status && i < manifest->style_count; i++) {
    status =
        prepare_style(arguments, manifest, &manifest->styles[i], i ? &manifest->styles[i - 1] : NULL, &textures, error);
    const StyBundleShape shape = {textures.width, textures.height, textures.lut_size, manifest->style_count};
    if (!status && i == 0 && !arguments->options.dry_run)
      status = sty_open_bundle_writer(arguments->options.output, &shape, writer, error);
    if (!status && *writer)
      status = sty_write_style(*writer, textures.exemplar, textures.guide, textures.lut, &textures.parameters, error);
    if (!status) describe_style(manifest, i, &textures, styles);
    if (run.progress) run.progress(run.context, (double)(i + 1) / manifest->style_count);
  }
  end_progress(&arguments->options);
  destroy_textures(&textures);
  return status;
}

static StyStatus print_report(Arguments *arguments, const StyManifest *manifest, double milliseconds, StyError *error) {
  Options *options = &arguments->options;
  const char *plural = manifest->style_count == 1 ? "" : "s";
  if (options->dry_run) return report_dry_run(options, "%d style%s", manifest->style_count, plural);
  if (options->json)
    return print_json(
        json_pack("{s:s, s:o, s:i, s:f, s:f}", "schema", "stylut-pack/1", "bundle", make_json_text(options->output),
                  "styles", manifest->style_count, "time_ms", milliseconds, "peak_bytes", get_peak_bytes()),
        error);
  if (!options->quiet)
    printf("%s: %d style%s in %.0f ms\n", clean_text(options->output), manifest->style_count, plural, milliseconds);
  return STY_OK;
}

/* The manifest's reader knows no engines; their names are checked here. */
static StyStatus check_engines(const StyManifest *manifest, StyError *error) {
  const StyPath styles = {NULL, "styles", 0};
  for (int i = 0; i < manifest->style_count; i++) {
    const StyPath style = {&styles, NULL, (size_t)i}, lut = {&style, "lut", 0};
    const StyEngine *engine;
    StyError cause;
    if (sty_find_engine("engine", manifest->styles[i].lut_engine, &engine, &cause) == STY_OK) continue;
    json_t *name = json_string(manifest->styles[i].lut_engine);
    const char *expected = strstr(cause.text, "one of ");
    sty_fail_value(&manifest->document, &(StyPath){&lut, "engine", 0}, name, expected ? expected : "an engine", error);
    json_decref(name);
    return STY_ERROR_INPUT;
  }
  return STY_OK;
}

static StyStatus run(Arguments *arguments) {
  StyError *error = &arguments->options.error;
  static uint8_t jitter[2 * STY_JITTER_SIZE * STY_JITTER_SIZE];
  const double start = sty_get_milliseconds();
  StyManifest manifest;
  StyStatus status = sty_read_manifest(arguments->manifest, &manifest, error);
  if (status) return status;
  StyBundleWriter *writer = NULL;
  json_t *index = json_object(), *styles = json_array();
  if (!arguments->options.no_history) status = record_inputs(arguments, &manifest, index, error);
  json_object_set_new(index, "styles", styles);
  json_object_set_new(index, "seed", json_integer((json_int_t)arguments->options.seed));
  if (!status) status = check_engines(&manifest, error);
  if (!status) status = read_jitter(arguments, &manifest, jitter, error);
  if (!status) status = write_styles(arguments, &manifest, &writer, styles, error);
  if (!status && writer) status = sty_commit_bundle(&writer, jitter, index, error);
  sty_discard_bundle(&writer);
  json_decref(index);
  if (!status) status = print_report(arguments, &manifest, sty_get_milliseconds() - start, error);
  sty_close_manifest(&manifest);
  return status;
}

StyStatus run_pack(int argc, char **argv) {
  Arguments arguments = {.manifest = NULL};
  StyStatus status = parse_arguments(&parser, argc, argv, &arguments);
  if (!status && !arguments.options.helped) status = run(&arguments);
  return finish_command(&arguments.options, status);
}
