// What the files of the image module share.
#ifndef STYLUT_BRIDGE_OIIO_H
#define STYLUT_BRIDGE_OIIO_H

#include <exception>
#include <memory>
#include <new>

#include "bridge/codec.h"

namespace sty {

// Ends the work inside try blocks below; caught in guard().
struct Failure {
  StyStatus status;
};

inline void check(StyStatus status) {
  if (status != STY_OK) throw Failure{status};
}

// Runs `body` and turns every exception into a status.
template <typename Body>
StyStatus guard(const char *path, StyError *error, Body body) {
  try {
    body();
    return STY_OK;
  } catch (const Failure &failure) {
    return failure.status;
  } catch (const std::bad_alloc &) {
    return sty_fail(error, STY_ERROR_LIBRARY, "%s: found too little memory for the picture", path);
  } catch (const std::exception &exception) {
    return sty_fail(error, STY_ERROR_LIBRARY, "%s: OpenImageIO failed: %s", path, exception.what());
  } catch (...) {
    return sty_fail(error, STY_ERROR_LIBRARY, "%s: OpenImageIO failed", path);
  }
}

struct ImageDeleter {
  void operator()(StyImage *image) const { sty_destroy_image(&image); }
};
using ImageHolder = std::unique_ptr<StyImage, ImageDeleter>;

StyStatus read_image(const char *path, long long most_pixels, StyImage **out, StyError *error);
StyStatus read_shape(const char *path, long long most_pixels, StyImageShape *out, StyError *error);

StyStatus resize_image(const char *name, const StyImage *image, StyImage *out, StyError *error);

StyStatus open_texture(const char *path, long long most_pixels, StyTextureMap **out, StyError *error);
void close_texture(StyTextureMap **texture);
bool sample_texture(const StyTextureMap *texture, const double uv[2], bool nearest, float out[3]);

}  // namespace sty
#endif
