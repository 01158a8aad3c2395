/* Files between the steps of a batch. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "step.h"
#include "stylut/ktx2.h"

const char *get_step_file(const Step *step, const char *list, size_t i, StyError *error) {
  const char *name = json_string_value(json_array_get(json_object_get(step->recipe.root, list), i));
  if (!name)
    sty_fail(error, STY_ERROR_INPUT, "%s: found no \"%s\"[%zu], expected a file's name", step->recipe.name, list, i);
  return name;
}

char *name_made(const char *output, StyError *error) {
  const size_t size = strlen(output) + sizeof ".made";
  char *name = malloc(size);
  if (name)
    snprintf(name, size, "%s.made", output);
  else
    sty_fail_memory(error, output, (double)size);
  return name;
}

enum { MOST_COPIED = 1 << 30, COMPARED = 1 << 24 };

static bool is_same_file(const char *a, const char *b) {
  StyMapping first, second;
  if (sty_map_file(a, &first, NULL) != STY_OK) return false;
  const bool opened = sty_map_file(b, &second, NULL) == STY_OK;
  bool is_same = opened && first.size == second.size;
  for (size_t at = 0; is_same && at < first.size; at += COMPARED) {
    const size_t size = first.size - at < COMPARED ? first.size - at : COMPARED;
    is_same = memcmp(first.data + at, second.data + at, size) == 0;
    sty_rest_mapped(first.data + at, size);
    sty_rest_mapped(second.data + at, size);
  }
  sty_unmap_file(&first);
  if (opened) sty_unmap_file(&second);
  return is_same;
}

StyStatus put_made(const char *output, StyError *error) {
  char *made = name_made(output, error);
  if (!made) return STY_ERROR_LIBRARY;
  StyStatus status = STY_OK;
  if (is_same_file(made, output) ? unlink(made) != 0 : rename(made, output) != 0)
    status = sty_fail(error, STY_ERROR_FILE, "%s: cannot write: %s; expected room for it", output, strerror(errno));
  free(made);
  return status;
}

StyStatus put_value(const char *output, json_t *value, StyError *error) {
  char *made = name_made(output, error);
  StyStatus status = made ? sty_write_json(made, value, error) : STY_ERROR_LIBRARY;
  if (!status) status = put_made(output, error);
  json_decref(value);
  free(made);
  return status;
}

StyStatus put_texture(const char *output, uint32_t format, int width, int height, int layers, const void *texels,
                      StyError *error) {
  char *made = name_made(output, error);
  StyStatus status = made ? sty_write_ktx2(made, format, width, height, layers, texels, error) : STY_ERROR_LIBRARY;
  if (!status) status = put_made(output, error);
  free(made);
  return status;
}

StyStatus map_texture(const char *path, uint32_t format, StyMapping *mapping, StyTexture *out, StyError *error) {
  const StyStatus status = sty_map_file(path, mapping, error);
  if (status) return status;
  if (sty_open_texture((StyBlob){mapping->data, mapping->size}, format, out) == STY_RUNTIME_OK) return STY_OK;
  sty_unmap_file(mapping);
  return sty_fail(error, STY_ERROR_INPUT, "%s: found no texture of format %u, expected one that a batch made", path,
                  format);
}

StyStatus read_sampling(const char *file, StySampling *out, StyError *error) {
  StyDocument facts = {NULL, NULL, NULL};
  const StyPath lut = {NULL, "lut", 0};
  const char *sampling = NULL;
  StyStatus status = sty_read_document(file, &facts, error);
  if (!status)
    status = sty_get_string(&facts, &lut, json_object_get(facts.root, "lut"), "sampling", 1, &sampling, error);
  *out = sampling && strcmp(sampling, "unorm8") == 0 ? STY_SAMPLE_UNORM8 : STY_SAMPLE_CENTRE;
  sty_close_document(&facts);
  return status;
}

json_t *identify_file(const char *path) {
  struct stat info;
  if (stat(path, &info) != 0) return json_null();
  return json_pack("[I,I,I,I]", (json_int_t)info.st_ino, (json_int_t)info.st_size, (json_int_t)info.st_mtim.tv_sec,
                   (json_int_t)info.st_mtim.tv_nsec);
}

StyStatus copy_file(const char *from, const char *to, StyError *error) {
  unsigned char *bytes = NULL;
  size_t size = 0;
  StyOutput output;
  StyStatus status = sty_read_file(from, MOST_COPIED, &bytes, &size, error);
  if (status) return status;
  status = sty_open_output(to, &output, error);
  if (!status) fwrite(bytes, 1, size, output.stream);
  if (!status) status = sty_commit_output(&output, error);
  free(bytes);
  return status;
}

/* ---- guides ---- */

static const char *const channels[] = {"normal.X", "normal.Y", "normal.Z", "A"};
enum { CHANNELS = 4 };

StyStatus put_guide(const char *output, const StyImage *guide, StyError *error) {
  const size_t pixels = sty_count_pixels(guide);
  float *texels = malloc(pixels * CHANNELS * sizeof *texels);
  if (!texels) return sty_fail_memory(error, output, (double)(pixels * CHANNELS * sizeof *texels));
  for (size_t c = 0; c < CHANNELS; c++) {
    const float *plane = sty_find_channel(guide, channels[c]);
    for (size_t i = 0; i < pixels; i++) texels[CHANNELS * i + c] = plane ? plane[i] : 0;
  }
  const StyStatus status =
      put_texture(output, STY_VK_R32G32B32A32_SFLOAT, guide->width, guide->height, 1, texels, error);
  free(texels);
  return status;
}

StyStatus read_guide_texture(const char *path, StyImage **out, StyError *error) {
  StyMapping mapping;
  StyTexture texture;
  StyImage *guide = NULL;
  StyStatus status = map_texture(path, STY_VK_R32G32B32A32_SFLOAT, &mapping, &texture, error);
  if (status) return status;
  status = sty_create_image((int)texture.width, (int)texture.height, CHANNELS, channels, 32, &guide, error);
  const size_t pixels = status ? 0 : sty_count_pixels(guide);
  for (size_t i = 0; i < pixels; i++)
    for (size_t c = 0; c < CHANNELS; c++)
      memcpy(&guide->data[c * pixels + i], texture.texels + (CHANNELS * i + c) * sizeof(float), sizeof(float));
  sty_unmap_file(&mapping);
  if (!status) *out = guide;
  return status;
}

/* ---- masks ---- */

enum { MASK_HEAD = 64 };

static int write_head(Size size, char head[MASK_HEAD]) {
  return snprintf(head, MASK_HEAD, "P5\n%d %d\n255\n", size.width, size.height);
}

StyStatus write_mask(const char *path, Size size, const uint8_t *painted, StyError *error) {
  char head[MASK_HEAD];
  StyOutput output;
  const StyStatus status = sty_open_output(path, &output, error);
  if (status) return status;
  fwrite(head, 1, (size_t)write_head(size, head), output.stream);
  fwrite(painted, 1, (size_t)size.width * (size_t)size.height, output.stream);
  return sty_commit_output(&output, error);
}

StyStatus read_mask(const char *path, Size size, uint8_t **out, StyError *error) {
  char head[MASK_HEAD];
  StyMapping mapping;
  StyStatus status = sty_map_file(path, &mapping, error);
  if (status) return status;
  const size_t length = (size_t)write_head(size, head), pixels = (size_t)size.width * (size_t)size.height;
  uint8_t *painted = NULL;
  if (mapping.size != length + pixels || memcmp(mapping.data, head, length) != 0)
    status = sty_fail(error, STY_ERROR_INPUT, "%s: found another file than a mask of %dx%d pixels, expected one", path,
                      size.width, size.height);
  else if (!(painted = malloc(pixels)))
    status = sty_fail_memory(error, path, (double)pixels);
  else
    memcpy(painted, mapping.data + length, pixels);
  sty_unmap_file(&mapping);
  if (!status) *out = painted;
  return status;
}

StyStatus open_masked_guide(const Step *step, int style, StyImage **out, Overlap *overlap, StyError *error) {
  const char *guide_file = get_step_file(step, "guides", (size_t)style, error);
  const char *mask_file = guide_file ? get_step_file(step, "masks", (size_t)style, error) : NULL;
  if (!mask_file) return STY_ERROR_INPUT;
  StyImage *guide = NULL;
  uint8_t *painted = NULL;
  StyStatus status = read_guide_texture(guide_file, &guide, error);
  if (!status) status = read_mask(mask_file, (Size){guide->width, guide->height}, &painted, error);
  if (!status) *overlap = uncover_unpainted(guide, painted);
  free(painted);
  if (status)
    sty_destroy_image(&guide);
  else
    *out = guide;
  return status;
}
