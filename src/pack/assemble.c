/* A bundle of textures that lie ready. */
#include <stdlib.h>

#include "pack/folder.h"
#include "pack/import_settings.h"

static const uint32_t formats[STY_BUNDLE_FILES] = {STY_VK_R8G8B8A8_SRGB, STY_VK_R8G8B8A8_UNORM, STY_VK_R16G16_UNORM,
                                                   STY_VK_R32G32B32A32_SFLOAT, STY_VK_R8G8_UNORM};

/* What the import settings say of a texture. */
static StyStatus describe_part(const char *path, int which, StyKtx2 *out, StyError *error) {
  StyMapping mapping;
  StyTexture texture;
  StyStatus status = sty_map_file(path, &mapping, error);
  if (status) return status;
  if (sty_open_texture((StyBlob){mapping.data, mapping.size}, formats[which], &texture) != STY_RUNTIME_OK)
    status = sty_fail(error, STY_ERROR_INPUT, "%s: found no texture as a bundle's, expected one", path);
  if (!status)
    *out = (StyKtx2){.offset = (uint64_t)(texture.texels - mapping.data),
                     .layer_size = (uint64_t)texture.width * texture.height * texture.texel_size,
                     .width = (int)texture.width,
                     .height = (int)texture.height,
                     .layers = (int)texture.layers};
  sty_unmap_file(&mapping);
  return status;
}

StyStatus sty_assemble_bundle(const char *path, const char *parts, json_t *index, const StyRun *run, StyError *error) {
  StyBundleFolder folder = {.path = NULL};
  StyKtx2 textures[STY_BUNDLE_FILES];
  StyStatus status = sty_open_bundle_folder(path, &folder, error);
  for (int i = 0; !status && i < STY_BUNDLE_FILES; i++) {
    char *from = sty_join_path(parts, sty_bundle_files[i]);
    char *to = sty_name_bundle_file(&folder, sty_bundle_files[i], error);
    if (!from || !to) status = sty_fail_memory(error, path, 0);
    if (!status) status = sty_take_file(from, to, error);
    if (!status) status = describe_part(to, i, &textures[i], error);
    free(from);
    free(to);
  }
  if (!status) status = sty_write_import_settings(&folder, textures, error);
  if (!status) status = sty_commit_bundle_folder(&folder, index, run, error);
  sty_discard_bundle_folder(&folder);
  return status;
}
