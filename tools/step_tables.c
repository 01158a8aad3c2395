/* Steps that make a batch's tables and parameters, and its bundles of all parts. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "parameters.h"
#include "step.h"
#include "stylut/ktx2.h"

/* ---- the size of all tables ---- */

/* What one style's budget takes. */
StyStatus step_lut_size(Step *step, StyError *error) {
  const char *fixed_by = NULL;
  int fixed = 0, size = 0;
  StyImage *guide = NULL;
  Overlap overlap;
  StyStatus status =
      sty_get_integer(&step->recipe, NULL, step->recipe.root, "fixed", 0, STY_MAX_LUT_SIDE, &fixed, error);
  if (!status) status = sty_get_string(&step->recipe, NULL, step->recipe.root, "fixed_by", 0, &fixed_by, error);
  if (!status) status = open_masked_guide(step, 0, &guide, &overlap, error);
  if (!status) status = choose_lut_size(&step->packing, 0, guide, &size, error);
  if (!status) status = check_lut_size(fixed, fixed_by, step->packing.manifest.styles, size, error);
  sty_destroy_image(&guide);
  return status ? status : put_value(step->output, json_pack("{s:i}", "size", size), error);
}

/* The least that the recipe says, or what budgets take beyond it. */
static StyStatus find_lut_size(const Step *step, int *out, StyError *error) {
  const json_t *files = json_object_get(step->recipe.root, "lut_sizes");
  StyStatus status =
      sty_get_integer(&step->recipe, NULL, step->recipe.root, "lut_size", 2, STY_MAX_LUT_SIDE, out, error);
  for (size_t i = 0; !status && i < json_array_size(files); i++) {
    StyDocument document = {NULL, NULL, NULL};
    int size = 0;
    const char *file = get_step_file(step, "lut_sizes", i, error);
    status = file ? sty_read_document(file, &document, error) : STY_ERROR_INPUT;
    if (!status) status = sty_get_integer(&document, NULL, document.root, "size", 2, STY_MAX_LUT_SIDE, &size, error);
    sty_close_document(&document);
    if (size > *out) *out = size;
  }
  return status;
}

/* ---- tables ---- */

/* Styles that are painted on one guide, with one outline, have one table: the first that makes it leaves a link to it
 * under a name that says what it was made of, and the others take that. */
typedef struct Shared {
  char table[NAME_SIZE], facts[NAME_SIZE]; /* empty: not shared */
} Shared;

/* What a table is made of: guide, mask, and what is asked for. Guides are large, and stay the files they are as long as
 * they hold the same. */
static StyStatus name_shared(const Step *step, Shared *out, StyError *error) {
  const json_t *root = step->recipe.root;
  const StyManifestStyle *style = step->packing.manifest.styles;
  const char *folder = NULL, *guide = get_step_file(step, "guides", 0, error);
  const char *mask = guide ? get_step_file(step, "masks", 0, error) : NULL;
  char mask_hash[STY_HASH_SIZE], key[STY_HASH_SIZE];
  StyStatus status = mask ? sty_hash_file(mask, mask_hash, error) : STY_ERROR_INPUT;
  if (!status) status = sty_get_string(&step->recipe, NULL, root, "shared", 0, &folder, error);
  out->table[0] = out->facts[0] = 0;
  if (status || !folder || style->lut.file || style->lut.frames) return status;
  json_t *asked = json_pack("{s:i, s:O*, s:s, s:o, s:s}", "size", step->packing.lut_size, "lut", style->lut.written,
                            "guide", guide, "file", identify_file(guide), "mask", mask_hash);
  char *text = asked ? json_dumps(asked, JSON_COMPACT | JSON_SORT_KEYS) : NULL;
  json_decref(asked);
  if (!text) return sty_fail_memory(error, step->recipe.name, 0);
  sty_hash_bytes(text, strlen(text), key);
  free(text);
  snprintf(out->table, sizeof out->table, "%s/%.32s.ktx2", folder, key);
  snprintf(out->facts, sizeof out->facts, "%s/%.32s.facts", folder, key);
  return STY_OK;
}

/* "OUTPUT.shared" is a link to the shared file that OUTPUT is a copy of: what nobody has a link to is pruned. The copy
 * itself is new, as whatever depends on it goes by its time. */
static char *name_mark(const char *output, StyError *error) {
  char *name = NULL;
  if (asprintf(&name, "%s.shared", output) >= 0) return name;
  sty_fail_memory(error, output, 0);
  return NULL;
}

static void drop_mark(const char *output) {
  char *mark = name_mark(output, NULL);
  if (mark) unlink(mark);
  free(mark);
}

static bool take_copy(const char *from, const char *output) {
  char *made = name_made(output, NULL), *mark = name_mark(output, NULL);
  const bool is_copied = made && mark && link(from, mark) == 0 && copy_file(from, made, NULL) == STY_OK;
  free(mark);
  free(made);
  return is_copied && put_made(output, NULL) == STY_OK;
}

/* Where links can't be made every style makes its own. The facts come last, and count. */
static void share(const Step *step, const char *facts, const Shared *shared) {
  if (*shared->table && link(step->output, shared->table) == 0 && link(facts, shared->facts) != 0)
    unlink(shared->table);
}

static StyStatus make_lut(Step *step, const char *facts, StyError *error) {
  Packing *packing = &step->packing;
  StyImage *guide = NULL;
  Overlap overlap;
  Table table = {0};
  StyStatus status = open_masked_guide(step, 0, &guide, &overlap, error);
  if (!status) status = make_table(packing, 0, guide, &table, error);
  if (!status) review_holes(&step->arguments.options, packing->manifest.styles, table.holes);
  if (!status)
    status =
        put_texture(step->output, STY_VK_R16G16_UNORM, packing->lut_size, packing->lut_size, 1, table.texels, error);
  if (!status) status = put_value(facts, json_pack("{s:o}", "lut", describe_lut(packing, 0, &table)), error);
  free(table.texels);
  sty_destroy_image(&guide);
  return status;
}

StyStatus step_lut(Step *step, StyError *error) {
  const char *facts = NULL;
  Shared shared;
  StyStatus status = sty_get_string(&step->recipe, NULL, step->recipe.root, "facts", 1, &facts, error);
  if (!status) status = find_lut_size(step, &step->packing.lut_size, error);
  if (!status) status = name_shared(step, &shared, error);
  if (status) return status;
  drop_mark(step->output);
  drop_mark(facts);
  if (*shared.table && access(shared.facts, F_OK) == 0 && take_copy(shared.table, step->output) &&
      take_copy(shared.facts, facts))
    return STY_OK;
  status = make_lut(step, facts, error);
  if (!status) share(step, facts, &shared);
  return status;
}

static StyStatus place_lut(const char *file, StyKtx2 *texture, int layer, StyError *error) {
  StyMapping mapping;
  StyTexture one;
  StyStatus status = map_texture(file, STY_VK_R16G16_UNORM, &mapping, &one, error);
  if (status) return status;
  if ((int)one.width != texture->width || (int)one.height != texture->height)
    status = sty_fail(error, STY_ERROR_INPUT, "%s: found a table of %ux%u texels, expected %dx%d as the first has",
                      file, one.width, one.height, texture->width, texture->height);
  else
    status = sty_place_ktx2_layer(texture, layer, one.texels, error);
  sty_unmap_file(&mapping);
  return status;
}

typedef struct Stack {
  const Step *step;
  StyKtx2 texture;
} Stack;

static StyStatus stack_lut(void *context, long i, StyError *error) {
  Stack *stack = context;
  const char *file = get_step_file(stack->step, "luts", (size_t)i, error);
  return file ? place_lut(file, &stack->texture, (int)i, error) : STY_ERROR_INPUT;
}

/* One behind the other; the first says how large all are. */
static StyStatus write_luts(const Step *step, int count, const char *made, StyError *error) {
  const StyRun run = {.threads = step->arguments.options.threads};
  Stack stack = {.step = step};
  StyMapping mapping;
  StyTexture first;
  const char *file = get_step_file(step, "luts", 0, error);
  StyStatus status = file ? map_texture(file, STY_VK_R16G16_UNORM, &mapping, &first, error) : STY_ERROR_INPUT;
  if (status) return status;
  sty_unmap_file(&mapping);
  status = sty_open_ktx2(made, STY_VK_R16G16_UNORM, (int)first.width, (int)first.height, count, &stack.texture, error);
  return status ? status : sty_end_ktx2(&stack.texture, sty_parallel_for(&run, count, stack_lut, &stack, error), error);
}

StyStatus step_luts(Step *step, StyError *error) {
  const size_t count = json_array_size(json_object_get(step->recipe.root, "luts"));
  if (count < 1 || count > STY_MAX_STYLES)
    return sty_fail(error, STY_ERROR_INPUT, "%s: found %zu \"luts\", expected 1 to %d", step->recipe.name, count,
                    STY_MAX_STYLES);
  char *made = name_made(step->output, error);
  StyStatus status = made ? write_luts(step, (int)count, made, error) : STY_ERROR_LIBRARY;
  if (!status) status = put_made(step->output, error);
  free(made);
  return status;
}

/* ---- parameters ---- */

/* Whether a style's table is meant for bytes: the recipe knows, or has the file that says so. */
static StyStatus find_unorm8(const Step *step, int style, bool *out, StyError *error) {
  const json_t *known = json_array_get(json_object_get(step->recipe.root, "unorm8"), (size_t)style);
  *out = json_is_true(known);
  if (json_is_boolean(known)) return STY_OK;
  StySampling sampling = STY_SAMPLE_CENTRE;
  const char *file = get_step_file(step, "unorm8", (size_t)style, error);
  const StyStatus status = file ? read_sampling(file, &sampling, error) : STY_ERROR_INPUT;
  *out = sampling == STY_SAMPLE_UNORM8;
  return status;
}

StyStatus step_params(Step *step, StyError *error) {
  const StyManifest *manifest = &step->packing.manifest;
  const int styles = manifest->style_count,
            jitters = (int)json_integer_value(json_object_get(step->recipe.root, "jitters"));
  float(*texels)[4] = calloc((size_t)styles * STY_PARAM_ROWS, sizeof *texels);
  if (!texels) return sty_fail_memory(error, step->output, (double)styles * STY_PARAM_ROWS * sizeof *texels);
  StyStatus status = STY_OK;
  int layer = 0;
  for (int i = 0; !status && i < styles; i++) {
    StyStyle placed = manifest->styles[i].parameters;
    float rows[STY_PARAM_ROWS][4];
    bool unorm8;
    status = find_unorm8(step, i, &unorm8, error);
    if (status) break;
    review_parameters(&step->arguments.options, manifest->styles[i].name, &placed, jitters);
    if (unorm8) placed.flags |= STY_FLAG_UNORM8;
    placed.layer = layer;
    layer += sty_count_layers(&placed);
    sty_encode_style(&placed, rows);
    for (int row = 0; row < STY_PARAM_ROWS; row++) memcpy(texels[row * styles + i], rows[row], sizeof rows[row]);
  }
  if (!status) status = put_texture(step->output, STY_VK_R32G32B32A32_SFLOAT, styles, STY_PARAM_ROWS, 1, texels, error);
  free(texels);
  return status;
}

StyStatus step_jitter(Step *step, StyError *error) {
  PackArguments *arguments = &step->arguments;
  const StyDocument *recipe = &step->recipe;
  StyStatus status =
      sty_get_integer(recipe, NULL, recipe->root, "jitter_frames", 1, MOST_JITTERS, &arguments->jitter_frames, error);
  if (!status)
    status =
        sty_get_choice(recipe, NULL, recipe->root, "jitter_noise", sty_noise_names, &arguments->jitter_noise, error);
  arguments->options.seed = (uint64_t)json_integer_value(json_object_get(recipe->root, "seed"));
  uint8_t *tables = NULL;
  if (!status) status = get_jitters(&step->packing, &tables, error);
  if (!status)
    status = put_texture(step->output, STY_VK_R8G8_UNORM, STY_JITTER_SIZE, STY_JITTER_SIZE,
                         count_jitters(&step->packing), tables, error);
  free(tables);
  return status;
}

/* ---- bundles ---- */

/* What the table's step said of it takes the place of what the manifest knew, but for the name of its file. */
static StyStatus add_facts(const Step *step, size_t i, json_t *style, StyError *error) {
  StyDocument facts = {NULL, NULL, NULL};
  const char *path = get_step_file(step, "facts", i, error);
  const StyStatus status = path ? sty_read_document(path, &facts, error) : STY_ERROR_INPUT;
  if (status) return status;
  json_t *lut = json_object_get(facts.root, "lut"), *file = json_object_get(json_object_get(style, "lut"), "file");
  if (file) json_object_set(lut, "file", file);
  json_object_set(style, "lut", lut);
  sty_close_document(&facts);
  return STY_OK;
}

/* What a guide's scene names joins the history, by its name in the manifest's folder. */
static StyStatus add_inputs(const Step *step, size_t i, const char *root, json_t *inputs, StyError *error) {
  StyDocument facts = {NULL, NULL, NULL};
  const char *path = get_step_file(step, "guide_facts", i, error), *name;
  const StyStatus status = path ? sty_read_document(path, &facts, error) : STY_ERROR_INPUT;
  const size_t length = strlen(root);
  json_t *hash;
  json_object_foreach(json_object_get(facts.root, "inputs"), name, hash) {
    const bool is_inside = strncmp(name, root, length) == 0 && name[length] == '/';
    json_object_set(inputs, is_inside ? name + length + 1 : name, hash);
  }
  sty_close_document(&facts);
  return status;
}

/* The recipe has the index as far as it is known before anything is made; tables say the rest. */
StyStatus step_bundle(Step *step, StyError *error) {
  const char *parts = NULL, *path = NULL, *root = NULL;
  const StyDocument *recipe = &step->recipe;
  json_t *index = json_object_get(recipe->root, "index"), *style;
  json_t *inputs = json_object_get(json_object_get(index, "history"), "inputs");
  StyStatus status = sty_get_string(recipe, NULL, recipe->root, "parts", 1, &parts, error);
  if (!status) status = sty_get_string(recipe, NULL, recipe->root, "bundle", 1, &path, error);
  if (!status) status = sty_get_string(recipe, NULL, recipe->root, "root", 1, &root, error);
  if (!status && !json_is_object(index))
    status = sty_fail(error, STY_ERROR_INPUT, "%s: found no \"index\", expected an object", recipe->name);
  size_t i;
  json_array_foreach(json_object_get(index, "styles"), i, style) {
    if (!status) status = add_facts(step, i, style, error);
    if (!status && inputs) status = add_inputs(step, i, root, inputs, error);
  }
  const StyRun run = {.threads = step->arguments.options.threads};
  return status ? status : sty_assemble_bundle(path, parts, index, &run, error);
}
