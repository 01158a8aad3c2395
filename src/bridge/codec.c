#include "bridge/codec.h"

#include <dlfcn.h>
#include <pthread.h>

#include "bridge/jpeg.h"
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
  if (!status) status = sty_check_jpeg(path, error);
  return status ? status : c->read(path, out, error);
}

StyStatus sty_write_image(const char *path, const StyImage *image, StyError *error) {
  const StyImageCodec *c;
  const StyStatus status = get_codec(&c, error);
  return status ? status : c->write(path, image, error);
}
