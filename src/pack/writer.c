#include <stdlib.h>
#include <string.h>

#include "pack/folder.h"
#include "pack/import_settings.h"

struct StyBundleWriter {
  StyBundleFolder folder;
  StyBundleShape shape;
  StyKtx2 textures[STY_BUNDLE_FILES];
  int written;                        /* styles, and */
  int exemplars;                      /* layers of theirs */
  float (*params)[STY_MAX_STYLES][4]; /* STY_PARAM_ROWS rows */
};

static StyStatus open_texture(StyBundleWriter *writer, int which, uint32_t format, int width, int height, int layers,
                              StyError *error) {
  char *file = sty_name_bundle_file(&writer->folder, sty_bundle_files[which], error);
  if (!file) return STY_ERROR_LIBRARY;
  const StyStatus status = sty_open_ktx2(file, format, width, height, layers, &writer->textures[which], error);
  free(file);
  return status;
}

StyStatus sty_open_bundle_writer(const char *path, const StyBundleShape *shape, StyBundleWriter **out,
                                 StyError *error) {
  if (shape->style_count < 1 || shape->style_count > STY_MAX_STYLES)
    return sty_fail(error, STY_ERROR_USAGE, "%s: found %d styles, expected 1 to %d", path, shape->style_count,
                    STY_MAX_STYLES);
  StyBundleWriter *writer = calloc(1, sizeof *writer);
  if (writer) writer->params = calloc(STY_PARAM_ROWS, sizeof *writer->params);
  if (!writer || !writer->params) {
    free(writer);
    return sty_fail_memory(error, path, sizeof *writer);
  }
  writer->shape = *shape;
  StyStatus status = sty_open_bundle_folder(path, &writer->folder, error);
  const int styles = shape->style_count;
  if (!status)
    status = open_texture(writer, STY_BUNDLE_EXEMPLARS, STY_VK_R8G8B8A8_SRGB, shape->width, shape->height,
                          shape->exemplar_count, error);
  if (!status)
    status = open_texture(writer, STY_BUNDLE_GUIDES, STY_VK_R8G8B8A8_UNORM, shape->width, shape->height, styles, error);
  if (!status)
    status =
        open_texture(writer, STY_BUNDLE_LUTS, STY_VK_R16G16_UNORM, shape->lut_size, shape->lut_size, styles, error);
  if (!status)
    status = open_texture(writer, STY_BUNDLE_PARAMS, STY_VK_R32G32B32A32_SFLOAT, styles, STY_PARAM_ROWS, 1, error);
  if (!status)
    status = open_texture(writer, STY_BUNDLE_JITTER, STY_VK_R8G8_UNORM, STY_JITTER_SIZE, STY_JITTER_SIZE,
                          shape->jitter_count, error);
  if (status)
    sty_discard_bundle(&writer);
  else
    *out = writer;
  return status;
}

StyStatus sty_write_style(StyBundleWriter *writer, const uint8_t *const *exemplars, const uint8_t *guide,
                          const uint16_t *lut, const StyStyle *parameters, StyError *error) {
  if (writer->written >= writer->shape.style_count)
    return sty_fail(error, STY_ERROR_USAGE, "%s: found more styles than the %d expected", writer->folder.path,
                    writer->shape.style_count);
  const int style = writer->written++, layers = sty_count_layers(parameters);
  float rows[STY_PARAM_ROWS][4];
  StyStyle placed = *parameters;
  placed.layer = writer->exemplars;
  writer->exemplars += layers;
  sty_encode_style(&placed, rows);
  for (int row = 0; row < STY_PARAM_ROWS; row++) memcpy(writer->params[row][style], rows[row], sizeof rows[row]);
  StyStatus status = STY_OK;
  for (int layer = 0; !status && layer < layers; layer++)
    status = sty_write_ktx2_layer(&writer->textures[STY_BUNDLE_EXEMPLARS], exemplars[layer], error);
  if (!status) status = sty_write_ktx2_layer(&writer->textures[STY_BUNDLE_GUIDES], guide, error);
  if (!status) status = sty_write_ktx2_layer(&writer->textures[STY_BUNDLE_LUTS], lut, error);
  return status;
}

static StyStatus write_parameters(StyBundleWriter *writer, StyError *error) {
  const size_t row_size = (size_t)writer->shape.style_count * sizeof writer->params[0][0];
  char *texels = malloc(STY_PARAM_ROWS * row_size);
  if (!texels) return sty_fail_memory(error, writer->folder.path, (double)(STY_PARAM_ROWS * row_size));
  for (int row = 0; row < STY_PARAM_ROWS; row++) memcpy(texels + (size_t)row * row_size, writer->params[row], row_size);
  const StyStatus status = sty_write_ktx2_layer(&writer->textures[STY_BUNDLE_PARAMS], texels, error);
  free(texels);
  return status;
}

StyStatus sty_commit_bundle(StyBundleWriter **writer_slot, const uint8_t *jitter, json_t *index, const StyRun *run,
                            StyError *error) {
  StyBundleWriter *writer = *writer_slot;
  StyStatus status = write_parameters(writer, error);
  for (int table = 0; !status && table < writer->shape.jitter_count; table++)
    status = sty_write_ktx2_layer(&writer->textures[STY_BUNDLE_JITTER], jitter + table * STY_JITTER_BYTES, error);
  if (!status) status = sty_write_import_settings(&writer->folder, writer->textures, error);
  for (int i = 0; !status && i < STY_BUNDLE_FILES; i++) status = sty_commit_ktx2(&writer->textures[i], error);
  if (!status) status = sty_commit_bundle_folder(&writer->folder, index, run, error);
  sty_discard_bundle(writer_slot);
  return status;
}

void sty_discard_bundle(StyBundleWriter **writer_slot) {
  StyBundleWriter *writer = *writer_slot;
  if (!writer) return;
  for (int i = 0; i < STY_BUNDLE_FILES; i++) sty_discard_ktx2(&writer->textures[i]);
  sty_discard_bundle_folder(&writer->folder);
  free(writer->params);
  free(writer);
  *writer_slot = NULL;
}
