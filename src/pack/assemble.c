/* A bundle of textures that lie ready. */
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pack/folder.h"
#include "pack/import_settings.h"

static const uint32_t formats[STY_BUNDLE_FILES] = {STY_VK_R8G8B8A8_SRGB, STY_VK_R8G8B8A8_UNORM, STY_VK_R16G16_UNORM,
                                                   STY_VK_R32G32B32A32_SFLOAT, STY_VK_R8G8_UNORM};

static StyStatus fail_copy(const char *path, StyError *error) {
  return sty_fail(error, STY_ERROR_FILE, "%s: cannot write: %s; expected room for a texture", path, strerror(errno));
}

static StyStatus copy_file(const char *from, const char *to, StyError *error) {
  struct stat info;
  const int in = open(from, O_RDONLY | O_CLOEXEC);
  if (in < 0) return sty_fail(error, STY_ERROR_FILE, "%s: cannot read: %s", from, strerror(errno));
  const int out = open(to, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  StyStatus status = out >= 0 && fstat(in, &info) == 0 ? STY_OK : fail_copy(to, error);
  for (off_t left = status ? 0 : info.st_size; left > 0;) {
    const ssize_t copied = copy_file_range(in, NULL, out, NULL, (size_t)left, 0);
    if (copied <= 0) {
      status = fail_copy(to, error);
      break;
    }
    left -= copied;
  }
  if (out >= 0 && close(out) != 0 && !status) status = fail_copy(to, error);
  close(in);
  return status;
}

static StyStatus take_part(const char *from, const char *to, StyError *error) {
  if (link(from, to) == 0) return STY_OK;
  if (errno == EXDEV || errno == EPERM || errno == EOPNOTSUPP || errno == EMLINK) return copy_file(from, to, error);
  return sty_fail(error, STY_ERROR_FILE, "%s: cannot link: %s; expected a texture in the making", from,
                  strerror(errno));
}

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

StyStatus sty_assemble_bundle(const char *path, const char *parts, json_t *index, StyError *error) {
  StyBundleFolder folder = {.path = NULL};
  StyKtx2 textures[STY_BUNDLE_FILES];
  StyStatus status = sty_open_bundle_folder(path, &folder, error);
  for (int i = 0; !status && i < STY_BUNDLE_FILES; i++) {
    char *from = sty_join_path(parts, sty_bundle_files[i]);
    char *to = sty_name_bundle_file(&folder, sty_bundle_files[i], error);
    if (!from || !to) status = sty_fail_memory(error, path, 0);
    if (!status) status = take_part(from, to, error);
    if (!status) status = describe_part(to, i, &textures[i], error);
    free(from);
    free(to);
  }
  if (!status) status = sty_write_import_settings(&folder, textures, error);
  if (!status) status = sty_commit_bundle_folder(&folder, index, error);
  sty_discard_bundle_folder(&folder);
  return status;
}
