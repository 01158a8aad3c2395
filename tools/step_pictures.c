/* Steps that make a batch's exemplars and guides. */
#include <stdlib.h>
#include <string.h>

#include "batch_inputs.h"
#include "step.h"
#include "stylut/ktx2.h"

/* ---- a guide ---- */

/* A makefile's rule: the guide is made of all that its scene names. */
static StyStatus write_depfile(const Step *step, const char *path, const char *inputs, StyError *error) {
  StyOutput output;
  StyStatus status = sty_open_output(path, &output, error);
  if (status) return status;
  const char *name;
  json_t *hash;
  fprintf(output.stream, "%s:", step->output);
  json_object_foreach(step->packing.inputs, name, hash) {
    char stamp[STAMP_SIZE];
    if (!status) status = stamp_input(inputs, name, stamp, error);
    if (!status) fprintf(output.stream, " %s", stamp);
  }
  fputc('\n', output.stream);
  if (!status) return sty_commit_output(&output, error);
  sty_discard_output(&output);
  return status;
}

StyStatus step_guide(Step *step, StyError *error) {
  const char *depfile = NULL, *inputs = NULL, *facts = NULL, *root = NULL;
  StyImage *guide = NULL;
  StyStatus status = sty_get_string(&step->recipe, NULL, step->recipe.root, "depfile", 0, &depfile, error);
  if (!status) status = sty_get_string(&step->recipe, NULL, step->recipe.root, "inputs", 0, &inputs, error);
  if (!status) status = sty_get_string(&step->recipe, NULL, step->recipe.root, "facts", 1, &facts, error);
  if (!status) status = sty_get_string(&step->recipe, NULL, step->recipe.root, "root", 0, &root, error);
  if (!status && root && !(step->packing.root = strdup(root))) status = sty_fail_memory(error, root, 0);
  step->packing.inputs = json_object();
  if (!status) status = get_guide(&step->packing, 0, &guide, error);
  if (!status && depfile && inputs) status = write_depfile(step, depfile, inputs, error);
  if (!status) status = put_guide(step->output, guide, error);
  if (!status)
    status = put_value(facts, json_pack("{s:i, s:O}", "bits", guide->bits, "inputs", step->packing.inputs), error);
  sty_destroy_image(&guide);
  return status;
}

/* ---- exemplars ---- */

/* The array as the step left it the last time: layers that would be the same are copied. */
typedef struct Earlier {
  StyMapping mapping;
  StyTexture texture;
  StyDocument keys; /* "styles": what each style's layers were made of */
} Earlier;

static void close_earlier(Earlier *earlier) {
  sty_unmap_file(&earlier->mapping);
  sty_close_document(&earlier->keys);
  *earlier = (Earlier){{NULL, 0}, {NULL, 0, 0, 0, 0}, {NULL, NULL, NULL}};
}

/* Nothing is there to be copied where anything about it is in doubt. */
static void open_earlier(const Step *step, const char *keys, Earlier *out) {
  StyError ignored;
  *out = (Earlier){{NULL, 0}, {NULL, 0, 0, 0, 0}, {NULL, NULL, NULL}};
  if (sty_read_document(keys, &out->keys, &ignored) != STY_OK) return;
  json_t *file = identify_file(step->output);
  const bool is_it = json_equal(file, json_object_get(out->keys.root, "file")) &&
                     sty_map_file(step->output, &out->mapping, &ignored) == STY_OK &&
                     sty_open_texture((StyBlob){out->mapping.data, out->mapping.size}, STY_VK_R8G8B8A8_SRGB,
                                      &out->texture) == STY_RUNTIME_OK &&
                     (int)out->texture.width == step->packing.size.width &&
                     (int)out->texture.height == step->packing.size.height;
  json_decref(file);
  if (!is_it) close_earlier(out);
}

/* The style's layers in the array as it was; NULL where it had none of this key, or has none (bases hang on guides). */
static const uint8_t *find_earlier(const Earlier *earlier, const json_t *key) {
  if (!json_is_string(key)) return NULL;
  const json_t *entry;
  size_t i, layer = 0;
  const size_t size = 4 * (size_t)earlier->texture.width * earlier->texture.height;
  json_array_foreach(json_object_get(earlier->keys.root, "styles"), i, entry) {
    const size_t layers = (size_t)json_integer_value(json_object_get(entry, "layers"));
    if (layer + layers > earlier->texture.layers) return NULL;
    if (json_equal(json_object_get(entry, "key"), key)) return earlier->texture.texels + layer * size;
    layer += layers;
  }
  return NULL;
}

/* What all styles' layers are made with. */
typedef struct Making {
  const Step *step;
  const Earlier *earlier;
  StyKtx2 *texture;
  int *first; /* layer of each style */
} Making;

static const json_t *get_key(const Step *step, int style) {
  return json_array_get(json_object_get(step->recipe.root, "keys"), (size_t)style);
}

static StyStatus make_mask(const Step *step, int style, uint8_t *const *layers, StyError *error) {
  const size_t pixels = (size_t)step->packing.size.width * (size_t)step->packing.size.height;
  const char *mask = get_step_file(step, "masks", (size_t)style, error);
  char *made = mask ? name_made(mask, error) : NULL;
  uint8_t *painted = made ? malloc(pixels) : NULL;
  StyStatus status = !made ? STY_ERROR_LIBRARY : painted ? STY_OK : sty_fail_memory(error, mask, (double)pixels);
  if (!status) status = find_painted(&step->packing, style, layers, painted, error);
  if (!status) status = write_mask(made, step->packing.size, painted, error);
  if (!status) status = put_made(mask, error);
  free(painted);
  free(made);
  return status;
}

static StyStatus add_bases(const Step *step, int style, uint8_t **layers, StyError *error) {
  StyImage *guide = NULL;
  Overlap overlap;
  if (!(step->packing.manifest.styles[style].base > 0)) return STY_OK;
  StyStatus status = open_masked_guide(step, style, &guide, &overlap, error);
  if (!status) status = make_bases(&step->packing, style, guide, layers, error);
  sty_destroy_image(&guide);
  return status;
}

static StyStatus read_layers(const Step *step, int style, uint8_t **layers, StyError *error) {
  StyStatus status = read_exemplars(&step->packing, style, layers, error);
  if (!status) status = make_mask(step, style, layers, error);
  return status ? status : add_bases(step, style, layers, error);
}

static StyStatus write_layers(const Making *making, int style, uint8_t *const *layers, StyError *error) {
  StyStatus status = STY_OK;
  for (int k = 0; !status && k < sty_count_layers(&making->step->packing.manifest.styles[style].parameters); k++)
    status = sty_place_ktx2_layer(making->texture, making->first[style] + k, layers[k], error);
  return status;
}

/* The earlier array is as large as this one, and each of its layers is wanted once. */
static StyStatus copy_layers(const Making *making, int style, const uint8_t *earlier, StyError *error) {
  const Step *step = making->step;
  const size_t size = 4 * (size_t)step->packing.size.width * (size_t)step->packing.size.height;
  const int count = sty_count_layers(&step->packing.manifest.styles[style].parameters);
  uint8_t *layers[2 * STY_MAX_LIGHTINGS];
  for (int k = 0; k < count; k++) layers[k] = (uint8_t *)(uintptr_t)(earlier + (size_t)k * size);
  StyStatus status = make_mask(step, style, layers, error);
  if (!status) status = write_layers(making, style, layers, error);
  sty_rest_mapped(earlier, (size_t)count * size);
  return status;
}

static StyStatus make_layers(void *context, long style, StyError *error) {
  const Making *making = context;
  const uint8_t *earlier = find_earlier(making->earlier, get_key(making->step, (int)style));
  if (earlier) return copy_layers(making, (int)style, earlier, error);
  uint8_t *layers[2 * STY_MAX_LIGHTINGS] = {NULL};
  StyStatus status = read_layers(making->step, (int)style, layers, error);
  if (!status) status = write_layers(making, (int)style, layers, error);
  for (int k = 0; k < 2 * STY_MAX_LIGHTINGS; k++) free(layers[k]);
  return status;
}

static StyStatus write_keys(const Step *step, const char *path, StyError *error) {
  json_t *styles = json_array();
  for (int i = 0; i < step->packing.manifest.style_count; i++)
    json_array_append_new(styles, json_pack("{s:O, s:i}", "key", get_key(step, i), "layers",
                                            sty_count_layers(&step->packing.manifest.styles[i].parameters)));
  json_t *keys = json_pack("{s:o, s:o}", "file", identify_file(step->output), "styles", styles);
  const StyStatus status = sty_write_json(path, keys, error);
  json_decref(keys);
  return status;
}

static StyStatus write_exemplars(const Step *step, const char *made, const Earlier *earlier, StyError *error) {
  const StyManifest *manifest = &step->packing.manifest;
  const Size size = step->packing.size;
  const StyRun run = {.threads = step->arguments.options.threads};
  StyKtx2 texture;
  Making making = {step, earlier, &texture, calloc((size_t)manifest->style_count, sizeof *making.first)};
  int layers = 0;
  if (!making.first) return sty_fail_memory(error, step->output, (double)manifest->style_count * sizeof *making.first);
  for (int i = 0; i < manifest->style_count; i++) {
    making.first[i] = layers;
    layers += sty_count_layers(&manifest->styles[i].parameters);
  }
  StyStatus status = sty_open_ktx2(made, STY_VK_R8G8B8A8_SRGB, size.width, size.height, layers, &texture, error);
  if (!status)
    status = sty_end_ktx2(&texture, sty_parallel_for(&run, manifest->style_count, make_layers, &making, error), error);
  free(making.first);
  return status;
}

StyStatus step_exemplars(Step *step, StyError *error) {
  const char *keys = NULL;
  Earlier earlier;
  StyStatus status = sty_get_string(&step->recipe, NULL, step->recipe.root, "made_of", 1, &keys, error);
  if (status) return status;
  char *made = name_made(step->output, error);
  if (!made) return STY_ERROR_LIBRARY;
  open_earlier(step, keys, &earlier);
  status = write_exemplars(step, made, &earlier, error);
  close_earlier(&earlier);
  if (!status) status = put_made(step->output, error);
  if (!status) status = write_keys(step, keys, error);
  free(made);
  return status;
}

/* ---- source guides ---- */

/* A guide as it is written; the next style often has the same. */
typedef struct Encoded {
  const char *guide; /* file; NULL: none yet */
  uint8_t *texels;
} Encoded;

static StyStatus encode_style(const Step *step, int style, Encoded *encoded, StyError *error) {
  const char *file = get_step_file(step, "guides", (size_t)style, error);
  if (!file) return STY_ERROR_INPUT;
  if (encoded->guide && strcmp(encoded->guide, file) == 0) return STY_OK;
  StyImage *guide = NULL;
  free(encoded->texels);
  *encoded = (Encoded){NULL, NULL};
  const Size size = step->packing.size;
  StyStatus status = read_guide_texture(file, &guide, error);
  if (!status && (guide->width != size.width || guide->height != size.height))
    status = sty_fail(error, STY_ERROR_INPUT, "%s: found %dx%d pixels, expected %dx%d as exemplars have", file,
                      guide->width, guide->height, size.width, size.height);
  if (!status) status = encode_guide(guide, &encoded->texels, error);
  if (!status) encoded->guide = file;
  sty_destroy_image(&guide);
  return status;
}

static StyStatus write_guide(const Step *step, int style, const Encoded *encoded, uint8_t *texels, StyKtx2 *texture,
                             StyError *error) {
  const Size size = step->packing.size;
  uint8_t *painted = NULL;
  const char *mask = get_step_file(step, "masks", (size_t)style, error);
  StyStatus status = mask ? read_mask(mask, size, &painted, error) : STY_ERROR_INPUT;
  if (status) return status;
  const Overlap overlap = leave_painted(encoded->texels, painted, (size_t)size.width * (size_t)size.height, texels);
  status = sty_write_ktx2_layer(texture, texels, error);
  if (!status) review_overlap(&step->packing, &step->arguments.options, style, &overlap);
  free(painted);
  return status;
}

static StyStatus write_guides(const Step *step, StyKtx2 *texture, StyError *error) {
  const size_t bytes = (size_t)texture->layer_size;
  Encoded encoded = {NULL, NULL};
  uint8_t *texels = malloc(bytes);
  StyStatus status = texels ? STY_OK : sty_fail_memory(error, step->output, (double)bytes);
  for (int i = 0; !status && i < step->packing.manifest.style_count; i++) {
    status = encode_style(step, i, &encoded, error);
    if (!status) status = write_guide(step, i, &encoded, texels, texture, error);
  }
  free(encoded.texels);
  free(texels);
  return status;
}

StyStatus step_guides(Step *step, StyError *error) {
  const Size size = step->packing.size;
  StyKtx2 texture;
  char *made = name_made(step->output, error);
  if (!made) return STY_ERROR_LIBRARY;
  StyStatus status = sty_open_ktx2(made, STY_VK_R8G8B8A8_UNORM, size.width, size.height,
                                   step->packing.manifest.style_count, &texture, error);
  if (!status) status = sty_end_ktx2(&texture, write_guides(step, &texture, error), error);
  if (!status) status = put_made(step->output, error);
  free(made);
  return status;
}
