// OpenImageIO's texture system behind extern "C".
#include <OpenImageIO/color.h>
#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/texture.h>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include "bridge/oiio.h"

namespace sty {

namespace {

// Whole pictures in tiles, so that neighbours in a texture are neighbours in memory.
constexpr int kTile = 64;
constexpr float kCacheMegabytes = 4096.0f;

// A picture whose colours are those of a texture.
struct Picture {
  ImageHolder image;
  const float *planes[3] = {};  // R G B; of a grey picture three times the same
};

// The plane of a picture that holds nothing but grey, with alpha or without.
const float *find_grey(const StyImage &image) {
  const int colours = image.channel_count - (sty_find_channel(&image, "A") ? 1 : 0);
  const float *grey = sty_find_channel(&image, "Y");
  for (int c = 0; !grey && colours == 1 && c < image.channel_count; c++)
    if (std::strcmp(image.names[c], "A") != 0 && !std::strchr(image.names[c], '.'))
      grey = image.data + size_t(c) * sty_count_pixels(&image);
  return grey;
}

// By name: the place of a channel in a file with layers says nothing.
bool find_planes(Picture *picture) {
  static constexpr const char *kNames[] = {"R", "G", "B"};
  const StyImage &image = *picture->image;
  for (int c = 0; c < 3; c++) picture->planes[c] = sty_find_channel(&image, kNames[c]);
  if (picture->planes[0] && picture->planes[1] && picture->planes[2]) return true;
  const float *grey = find_grey(image);
  for (const float *&plane : picture->planes) plane = grey;
  return grey;
}

std::string list_channels(const StyImage &image) {
  constexpr int kMost = 8;
  std::string list = image.names[0];
  for (int c = 1; c < image.channel_count && c < kMost; c++) list += std::string(", ") + image.names[c];
  return image.channel_count > kMost ? list + ", ..." : list;
}

void check_values(const char *path, const Picture &picture, StyError *error) {
  const size_t width = size_t(picture.image->width);
  for (const float *plane : picture.planes)
    for (size_t i = 0; i < sty_count_pixels(picture.image.get()); i++)
      if (!(plane[i] >= 0 && plane[i] <= STY_MAX_TEXEL))
        check(sty_fail(error, STY_ERROR_INPUT, "%s: found %g at pixel (%zu, %zu), expected a colour from 0 to %g", path,
                       double(plane[i]), i % width, i / width, double(STY_MAX_TEXEL)));
}

Picture read_picture(const char *path, long long most_pixels, StyError *error) {
  StyImage *read = nullptr;
  check(read_image(path, most_pixels, &read, error));
  Picture picture;
  picture.image.reset(read);
  if (!find_planes(&picture))
    check(sty_fail(error, STY_ERROR_INPUT, "%s: found the channels %s, expected R, G and B, or Y alone", path,
                   list_channels(*read).c_str()));
  check_values(path, picture, error);
  return picture;
}

// What open_texture has read, for the first time that the texture system asks for it, which is at once.
thread_local Picture just_read;

// A picture as scene-linear R G B, read through our own reader, which knows what is wrong with files.
class LinearPicture final : public OIIO::ImageInput {
 public:
  const char *format_name() const override { return "stylut linear"; }

  bool open(const std::string &name, OIIO::ImageSpec &spec) override {
    StyError error;
    const StyStatus status = guard(name.c_str(), &error, [&] {
      picture_ = just_read.image ? std::move(just_read) : read_picture(name.c_str(), STY_MAX_PIXELS, &error);
      m_spec = OIIO::ImageSpec(picture_.image->width, picture_.image->height, 3, OIIO::TypeDesc::FLOAT);
      spec = m_spec;
    });
    if (status != STY_OK) errorfmt("{}", error.text);
    return status == STY_OK;
  }

  bool close() override {
    picture_.image.reset();
    return true;
  }

  bool read_native_scanline(int subimage, int level, int y, int, void *data) override {
    const StyImage *image = picture_.image.get();
    if (subimage != 0 || level != 0 || !image || y < 0 || y >= image->height) return false;
    const size_t width = size_t(image->width);
    for (size_t c = 0; c < 3; c++) {
      const float *row = picture_.planes[c] + size_t(y) * width;
      for (size_t x = 0; x < width; x++)
        static_cast<float *>(data)[3 * x + c] = image->bits < 32 ? OIIO::sRGB_to_linear(row[x]) : row[x];
    }
    return true;
  }

 private:
  Picture picture_;
};

OIIO::ImageInput *make_picture() { return new LinearPicture; }

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
  int width = 0, height = 0;
};

namespace sty {

StyStatus open_texture(const char *path, long long most_pixels, StyTextureMap **out, StyError *error) {
  return guard(path, error, [&] {
    auto texture = std::make_unique<StyTextureMap>();
    OIIO::TextureSystem &system = get_system();
    texture->path = OIIO::ustring(path);
    system.invalidate(texture->path);  // what an earlier texture of this path has left
    just_read = read_picture(path, most_pixels, error);
    texture->width = just_read.image->width;
    texture->height = just_read.image->height;
    system.imagecache()->add_file(texture->path, make_picture, nullptr, true);
    just_read = {};
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

// The centre of the texel that holds a place from 0 to below 1: on the border between two, OpenImageIO would take the
// one before.
static double centre_on_texel(double place, int texels) {
  return (std::fmin(std::floor(place * texels), texels - 1) + 0.5) / texels;
}

bool sample_texture(const StyTextureMap *texture, const double uv[2], bool nearest, float out[3]) {
  out[0] = out[1] = out[2] = 0;
  if (!std::isfinite(uv[0]) || !std::isfinite(uv[1])) return true;
  OIIO::TextureOpt options;
  options.swrap = options.twrap = OIIO::TextureOpt::WrapPeriodic;
  options.mipmode = OIIO::TextureOpt::MipModeNoMIP;
  options.interpmode = nearest ? OIIO::TextureOpt::InterpClosest : OIIO::TextureOpt::InterpBilinear;
  try {
    // Within one period first: a float has no fraction left far from it. Rows count from the top.
    double u = uv[0] - std::floor(uv[0]), v = uv[1] - std::floor(uv[1]);
    if (nearest) u = centre_on_texel(u, texture->width), v = centre_on_texel(v, texture->height);
    return get_system().texture(texture->handle, nullptr, options, float(u), float(1 - v), 0, 0, 0, 0, 3, out);
  } catch (...) {  // memory
    return false;
  }
}

}  // namespace sty
