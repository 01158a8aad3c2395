// OpenImageIO's filters behind extern "C".
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include "bridge/oiio.h"

namespace sty {

// Plane by plane, in place.
StyStatus resize_image(const char *name, const StyImage *image, StyImage *out, StyError *error) {
  return guard(name, error, [&] {
    const OIIO::ImageSpec from(image->width, image->height, 1, OIIO::TypeDesc::FLOAT);
    const OIIO::ImageSpec to(out->width, out->height, 1, OIIO::TypeDesc::FLOAT);
    for (int c = 0; c < image->channel_count; c++) {
      const OIIO::ImageBuf source(from, image->data + size_t(c) * sty_count_pixels(image));
      OIIO::ImageBuf target(to, out->data + size_t(c) * sty_count_pixels(out));
      if (!OIIO::ImageBufAlgo::resize(target, source))
        check(sty_fail(error, STY_ERROR_LIBRARY, "%s: OpenImageIO failed: %s", name, target.geterror().c_str()));
    }
  });
}

}  // namespace sty
