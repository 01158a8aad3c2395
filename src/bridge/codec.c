#include "bridge/codec.h"

#include <dlfcn.h>
#include <pthread.h>
#include <string.h>
#include <strings.h>

#include "bridge/whole.h"
#include "stylut/image_io.h"

static pthread_once_t once = PTHREAD_ONCE_INIT;
static const StyImageCodec *codec;
static StyError cause;

/* Found beside the program, in ../lib, or where the system looks. Stays open:
 * libraries with threads of their own don't survive being unloaded. */
static void open_module(void) {
  void *module = dlopen(STY_CODEC_MODULE, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (module) codec = dlsym(module, STY_CODEC_SYMBOL);
  if (!codec)
    sty_fail(&cause, STY_ERROR_UNAVAILABLE,
             "image module: %s; expected " STY_CODEC_MODULE " beside stylut or in ../lib", dlerror());
}

static StyStatus get_codec(const StyImageCodec **out, StyError *error) {
  pthread_once(&once, open_module);
  *out = codec;
  return codec ? STY_OK : sty_fail(error, cause.status, "%s", cause.text);
}

StyStatus sty_read_image(const char *path, StyImage **out, StyError *error) {
  const StyImageCodec *c;
  StyStatus status = get_codec(&c, error);
  if (!status) status = sty_check_whole(path, error);
  return status ? status : c->read(path, out, error);
}

static bool has_ending(const char *path, const char *ending) {
  const size_t length = strlen(path), tail = strlen(ending);
  return length > tail && strcasecmp(path + length - tail, ending) == 0;
}

StyStatus sty_get_image_format(const char *path, StyImageFormat *out, StyError *error) {
  if (!has_ending(path, ".exr") && !has_ending(path, ".png"))
    return sty_fail(error, STY_ERROR_USAGE, "%s: found an unknown ending, expected .exr or .png", path);
  *out = has_ending(path, ".exr") ? STY_IMAGE_EXR : STY_IMAGE_PNG;
  return STY_OK;
}

StyStatus sty_prepare_image(const char *path, const StyImage *image, StyOutput *out, StyError *error) {
  const StyImageCodec *c;
  StyImageFormat format = STY_IMAGE_EXR;
  StyOutput output;
  StyStatus status = sty_get_image_format(path, &format, error);
  if (!status && format == STY_IMAGE_PNG && (image->channel_count > 4 || image->bits > 16))
    status = sty_fail(error, STY_ERROR_USAGE, "%s: found %d channels of %d bits, which PNG can't hold; expected .exr",
                      path, image->channel_count, image->bits);
  if (!status) status = get_codec(&c, error);
  if (!status) status = sty_open_output(path, &output, error);
  if (status) return status;
  status = c->write(path, output.stream, format, image, error);
  if (!status) status = sty_flush_output(&output, error);
  if (status)
    sty_discard_output(&output);
  else
    *out = output;
  return status;
}

StyStatus sty_write_image(const char *path, const StyImage *image, StyError *error) {
  StyOutput output;
  const StyStatus status = sty_prepare_image(path, image, &output, error);
  return status ? status : sty_commit_output(&output, error);
}
