// OpenImageIO's texture system behind extern "C".
#include <OpenImageIO/color.h>
#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/texture.h>
#include <cmath>
#include <string>
#include <vector>

#include "bridge/oiio.h"

namespace sty {

namespace {

// Whole pictures in tiles, so that neighbours in a texture are neighbours in memory.
constexpr int kTile = 64;
constexpr float kCacheMegabytes = 4096.0f;

// One of the picture's first three channels, or its only one (with alpha or without).
const float *find_plane(const StyImage &image, int channel) {
  return image.data + (image.channel_count < 3 ? 0 : size_t(channel)) * sty_count_pixels(&image);
}

// A picture as scene-linear R G B, read through our own reader, which knows what is wrong with files.
class LinearPicture final : public OIIO::ImageInput {
 public:
  const char *format_name() const override { return "stylut linear"; }

  bool open(const std::string &name, OIIO::ImageSpec &spec) override {
    StyImage *read = nullptr;
    StyError error;
    if (sty::read_image(name.c_str(), &read, &error) != STY_OK) {
      errorfmt("{}", error.text);
      return false;
    }
    image_.reset(read);
    m_spec = OIIO::ImageSpec(read->width, read->height, 3, OIIO::TypeDesc::FLOAT);
    spec = m_spec;
    return true;
  }

  bool close() override {
    image_.reset();
    return true;
  }

  bool read_native_scanline(int subimage, int level, int y, int, void *data) override {
    if (subimage != 0 || level != 0 || !image_ || y < 0 || y >= image_->height) return false;
    const size_t width = size_t(image_->width);
    for (int c = 0; c < 3; c++) {
      const float *row = find_plane(*image_, c) + size_t(y) * width;
      for (size_t x = 0; x < width; x++)
        static_cast<float *>(data)[3 * x + size_t(c)] = image_->bits < 32 ? OIIO::sRGB_to_linear(row[x]) : row[x];
    }
    return true;
  }

 private:
  ImageHolder image_;
};

OIIO::ImageInput *make_picture() { return new LinearPicture; }

void check_values(const char *path, StyError *error) {
  StyImage *read = nullptr;
  check(read_image(path, &read, error));
  const ImageHolder image(read);
  for (int c = 0; c < 3; c++) {
    const float *plane = find_plane(*image, c);
    for (size_t i = 0; i < sty_count_pixels(read); i++)
      if (!std::isfinite(plane[i]))
        check(sty_fail(error, STY_ERROR_INPUT, "%s: pixel (%d, %d) holds %g, expected a finite colour", path,
                       int(i % size_t(read->width)), int(i / size_t(read->width)), double(plane[i])));
  }
}

// One for the process, for good: threads keep what they looked up last, and would take it
// for their own in a later system at the same address.
OIIO::TextureSystem &get_system() {
  static OIIO::TextureSystem *const system = [] {
    OIIO::TextureSystem *made = OIIO::TextureSystem::create(false);
    made->attribute("autotile", kTile);
    made->attribute("max_memory_MB", kCacheMegabytes);
    return made;
  }();
  return *system;
}

}  // namespace

}  // namespace sty

struct StyTextureMap {
  OIIO::ustring path;
  OIIO::TextureSystem::TextureHandle *handle = nullptr;
};

namespace sty {

StyStatus open_texture(const char *path, StyTextureMap **out, StyError *error) {
  return guard(path, error, [&] {
    check_values(path, error);
    auto texture = std::make_unique<StyTextureMap>();
    OIIO::TextureSystem &system = get_system();
    texture->path = OIIO::ustring(path);
    system.imagecache()->add_file(texture->path, make_picture, nullptr, true);
    system.invalidate(texture->path);
    texture->handle = system.get_texture_handle(texture->path);
    if (!texture->handle || !system.good(texture->handle))
      check(sty_fail(error, STY_ERROR_LIBRARY, "%s: OpenImageIO has no texture of it: %s", path,
                     system.geterror().c_str()));
    *out = texture.release();
  });
}

void close_texture(StyTextureMap **texture) {
  try {
    get_system().invalidate((*texture)->path);  // its pixels
  } catch (...) {
  }
  delete *texture;
  *texture = nullptr;
}

void sample_texture(const StyTextureMap *texture, const double uv[2], bool nearest, float out[3]) {
  out[0] = out[1] = out[2] = 0;
  if (!std::isfinite(uv[0]) || !std::isfinite(uv[1])) return;
  OIIO::TextureOpt options;
  options.swrap = options.twrap = OIIO::TextureOpt::WrapPeriodic;
  options.mipmode = OIIO::TextureOpt::MipModeNoMIP;
  options.interpmode = nearest ? OIIO::TextureOpt::InterpClosest : OIIO::TextureOpt::InterpBilinear;
  try {
    // Within one period first: a float has no fraction left far from it. Rows count from the top.
    const double u = uv[0] - std::floor(uv[0]), v = 1 - (uv[1] - std::floor(uv[1]));
    get_system().texture(texture->handle, nullptr, options, float(u), float(v), 0, 0, 0, 0, 3, out);
  } catch (...) {  // memory: the picture itself was read when it was opened
  }
}

}  // namespace sty
