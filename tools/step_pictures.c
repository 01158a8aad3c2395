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

/* Some styles at a time are read, by all threads, and written in their order. */
enum { HANDFUL = 64 };
typedef struct Handful {
  const Step *step;
  const Earlier *earlier;
  int first;
  uint8_t *layers[HANDFUL][2 * STY_MAX_LIGHTINGS];
  const uint8_t *copies[HANDFUL]; /* whose layers are the earlier array's */
} Handful;

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

static StyStatus read_layers(void *context, long i, StyError *error) {
  Handful *handful = context;
  const Step *step = handful->step;
  const int style = handful->first + (int)i;
  uint8_t **layers = handful->layers[i];
  const size_t size = 4 * (size_t)step->packing.size.width * (size_t)step->packing.size.height;
  const uint8_t *earlier = handful->copies[i] = find_earlier(handful->earlier, get_key(step, style));
  for (int k = 0; earlier && k < sty_count_layers(&step->packing.manifest.styles[style].parameters); k++)
    layers[k] = (uint8_t *)(uintptr_t)(earlier + (size_t)k * size);
  StyStatus status = earlier ? STY_OK : read_exemplars(&step->packing, style, layers, error);
  if (!status) status = make_mask(step, style, layers, error);
  return status || earlier ? status : add_bases(step, style, layers, error);
}

static void free_layers(Handful *handful, int count) {
  for (int i = 0; i < count; i++)
    for (int k = 0; k < 2 * STY_MAX_LIGHTINGS; k++) {
      if (!handful->copies[i]) free(handful->layers[i][k]);
      handful->layers[i][k] = NULL;
    }
}

/* The earlier array is as large as this one, and each of its layers is wanted once. */
static void rest_copies(const Handful *handful, int count) {
  const StyManifestStyle *styles = handful->step->packing.manifest.styles + handful->first;
  const Size size = handful->step->packing.size;
  for (int i = 0; i < count; i++)
    if (handful->copies[i])
      sty_rest_mapped(handful->copies[i],
                      (size_t)sty_count_layers(&styles[i].parameters) * 4 * (size_t)size.width * (size_t)size.height);
}

static StyStatus write_exemplars(const Step *step, const Earlier *earlier, StyKtx2 *texture, StyError *error) {
  const StyManifest *manifest = &step->packing.manifest;
  const StyRun run = {.threads = step->arguments.options.threads};
  const int threads = sty_get_threads(&run), some = 2 * threads < HANDFUL ? 2 * threads : HANDFUL;
  Handful *handful = calloc(1, sizeof *handful);
  if (!handful) return sty_fail_memory(error, step->output, sizeof *handful);
  StyStatus status = STY_OK;
  handful->step = step;
  handful->earlier = earlier;
  for (; !status && handful->first < manifest->style_count; handful->first += some) {
    const int left = manifest->style_count - handful->first, count = left < some ? left : some;
    memset(handful->copies, 0, sizeof handful->copies);
    status = sty_parallel_for(&run, count, read_layers, handful, error);
    for (int i = 0; !status && i < count; i++)
      for (int k = 0; !status && k < sty_count_layers(&manifest->styles[handful->first + i].parameters); k++)
        status = sty_write_ktx2_layer(texture, handful->layers[i][k], error);
    rest_copies(handful, count);
    free_layers(handful, count);
  }
  free(handful);
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

StyStatus step_exemplars(Step *step, StyError *error) {
  const StyManifest *manifest = &step->packing.manifest;
  const Size size = step->packing.size;
  const char *keys = NULL;
  StyKtx2 texture;
  Earlier earlier;
  int layers = 0;
  StyStatus status = sty_get_string(&step->recipe, NULL, step->recipe.root, "made_of", 1, &keys, error);
  if (status) return status;
  for (int i = 0; i < manifest->style_count; i++) layers += sty_count_layers(&manifest->styles[i].parameters);
  char *made = name_made(step->output, error);
  if (!made) return STY_ERROR_LIBRARY;
  open_earlier(step, keys, &earlier);
  status = sty_open_ktx2(made, STY_VK_R8G8B8A8_SRGB, size.width, size.height, layers, &texture, error);
  if (!status) status = sty_end_ktx2(&texture, write_exemplars(step, &earlier, &texture, error), error);
  close_earlier(&earlier);
  if (!status) status = put_made(step->output, error);
  if (!status) status = write_keys(step, keys, error);
  free(made);
  return status;
}

/* ---- source guides ---- */

/* A style's layer; the next often has the same guide, and the same outline. */
typedef struct Encoded {
  const char *guide; /* file; NULL: none yet */
  uint8_t *painted, *texels;
  Overlap overlap;
} Encoded;

static void free_encoded(Encoded *encoded) {
  free(encoded->painted);
  free(encoded->texels);
  *encoded = (Encoded){.guide = NULL};
}

/* Replaces the style before, where this one's is another. */
static StyStatus encode_style(const Step *step, int style, Encoded *encoded, StyError *error) {
  const Size size = step->packing.size;
  Encoded next = {.guide = get_step_file(step, "guides", (size_t)style, error)};
  const char *mask = next.guide ? get_step_file(step, "masks", (size_t)style, error) : NULL;
  if (!mask) return STY_ERROR_INPUT;
  StyStatus status = read_mask(mask, size, &next.painted, error);
  if (!status && encoded->guide && strcmp(encoded->guide, next.guide) == 0 &&
      memcmp(encoded->painted, next.painted, (size_t)size.width * (size_t)size.height) == 0) {
    free_encoded(&next);
    return STY_OK;
  }
  StyImage *guide = NULL;
  if (!status) status = read_guide_texture(next.guide, &guide, error);
  if (!status) next.overlap = uncover_unpainted(guide, next.painted);
  if (!status) status = encode_guide(guide, &next.texels, error);
  sty_destroy_image(&guide);
  free_encoded(encoded);
  *encoded = next;
  return status;
}

static StyStatus write_guides(const Step *step, StyKtx2 *texture, StyError *error) {
  StyStatus status = STY_OK;
  Encoded encoded = {.guide = NULL};
  for (int i = 0; !status && i < step->packing.manifest.style_count; i++) {
    status = encode_style(step, i, &encoded, error);
    if (!status) status = sty_write_ktx2_layer(texture, encoded.texels, error);
    if (!status) review_overlap(&step->packing, &step->arguments.options, i, &encoded.overlap);
  }
  free_encoded(&encoded);
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
