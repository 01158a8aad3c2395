// OpenImageIO behind extern "C": converts, catches, decides nothing.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "bridge/oiio.h"
#include "stylut/file.h"

namespace {

using OIIO::ImageInput;
using OIIO::ImageOutput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;
using sty::check;
using sty::guard;
using sty::ImageHolder;

// Deflate, the densest codec among the formats we read, gains at most about
// 1032:1; a header that claims more than this is not worth an allocation.
constexpr double kMaxCompression = 2048.0;
constexpr double kAlwaysAllowedBytes = 64.0 * 1024 * 1024;
constexpr int kRowsAtOnce = 64;
constexpr const char *kAttributePrefix = "stylut:";

int bits_of(TypeDesc format) {
  switch (format.basetype) {
    case TypeDesc::UINT8: return 8;
    case TypeDesc::UINT16: return 16;
    default: return 32;
  }
}

// What to divide a channel's values by, as read_image asks for them.
// OpenImageIO scales 32-bit integers to 0..1; ids must stay what they are.
float get_divisor(const ImageSpec &spec, int channel) {
  if (bits_of(spec.format) == 8) return 255.0f;
  if (bits_of(spec.format) == 16) return 65535.0f;
  return spec.channelformat(channel).basetype == TypeDesc::UINT32 ? 1.0f / 4294967296.0f : 1.0f;
}

// The reader for a file, by its first bytes: left to itself, OpenImageIO would
// hand the file to one reader after the other, of formats nobody asked for.
const char *find_reader(const char *path) {
  static const struct {
    const char *reader, *begin;
    size_t size;
  } signatures[] = {{"openexr", "\x76\x2f\x31\x01", 4},
                    {"png", "\x89PNG\r\n\x1a\n", 8},
                    {"jpeg", "\xff\xd8\xff", 3},
                    {"tiff", "II*\0", 4},
                    {"tiff", "MM\0*", 4},
                    {"tiff", "II+\0", 4},
                    {"tiff", "MM\0+", 4},
                    {"hdr", "#?", 2}};
  char begin[8] = "";
  if (FILE *file = std::fopen(path, "rb")) {
    (void)!std::fread(begin, 1, sizeof begin, file);
    std::fclose(file);
  }
  for (const auto &signature : signatures)
    if (std::memcmp(begin, signature.begin, signature.size) == 0) return signature.reader;
  return "targa";  // has no signature; its reader looks for itself
}

// One part of a file: its header and the channel names it gives to our image.
struct Part {
  ImageSpec spec;
  std::vector<std::string> names;
  std::vector<float> divisors;  // of each channel's values
};

std::vector<Part> read_headers(const char *path, ImageInput &input, double file_bytes, long long most_pixels,
                               StyError *error) {
  std::vector<Part> parts;
  double claimed = 0;
  for (int index = 0; index < STY_MAX_CHANNELS; index++) {
    Part part;
    part.spec = input.spec(index, 0);
    if (part.spec.undefined()) break;
    const ImageSpec &spec = part.spec;
    if (spec.format == TypeDesc::UNKNOWN || spec.deep || spec.depth > 1)
      check(sty_fail(error, STY_ERROR_INPUT, "%s: found deep or volume data, expected a flat picture", path));
    const ImageSpec &first = parts.empty() ? spec : parts.front().spec;
    if (spec.full_width != first.full_width || spec.full_height != first.full_height) {
      // Thumbnails and pyramids of TIFF files are not parts of the picture.
      if (std::strcmp(input.format_name(), "openexr") != 0) break;
      check(sty_fail(error, STY_ERROR_INPUT, "%s: found parts of %dx%d and %dx%d pixels, expected one size", path,
                     first.full_width, first.full_height, spec.full_width, spec.full_height));
    }
    if (spec.full_width < 1 || spec.full_height < 1 || spec.full_width > STY_MAX_SIDE ||
        spec.full_height > STY_MAX_SIDE || (long long)spec.full_width * spec.full_height > most_pixels ||
        (long long)spec.width * spec.height > most_pixels || spec.width < 1 || spec.height < 1 ||
        spec.width > STY_MAX_SIDE || spec.height > STY_MAX_SIDE || spec.nchannels < 1 ||
        spec.nchannels > STY_MAX_CHANNELS)
      check(sty_fail(error, STY_ERROR_INPUT,
                     "%s: found a header of %dx%d pixels and %d channels, expected sides up to %d, at most %lld pixels "
                     "(--limit pixels=N) and %d channels",
                     path, spec.full_width, spec.full_height, spec.nchannels, STY_MAX_SIDE, most_pixels,
                     STY_MAX_CHANNELS));
    const double pixels = std::fmax(double(spec.width) * spec.height, double(spec.full_width) * spec.full_height);
    claimed += pixels * double(spec.pixel_bytes(true));  // as the file has them
    parts.push_back(part);
    if (std::strcmp(input.format_name(), "openexr") != 0) break;
  }
  if (claimed > kAlwaysAllowedBytes && claimed > file_bytes * kMaxCompression)
    check(sty_fail(error, STY_ERROR_INPUT,
                   "%s: found a header that claims %.0f bytes of pixels in a file of %.0f bytes", path, claimed,
                   file_bytes));
  for (Part &part : parts) {
    const std::string layer = part.spec.get_string_attribute("oiio:subimagename");
    for (int c = 0; c < part.spec.nchannels; c++) {
      const std::string name = part.spec.channel_name(c);
      const bool plain = parts.size() == 1 || layer.empty() || name.find('.') != std::string::npos;
      part.names.push_back(plain ? name : layer + "." + name);
      part.divisors.push_back(get_divisor(part.spec, c));
    }
  }
  return parts;
}

// Rows begin..end of a part, interleaved, in `type`.
template <typename Value>
void read_rows(const char *path, ImageInput &input, int index, const ImageSpec &spec, int begin, int end, TypeDesc type,
               std::vector<Value> &rows, StyError *error) {
  const bool read = spec.tile_width > 0 ? input.read_tiles(index, 0, spec.x, spec.x + spec.width, spec.y + begin,
                                                           spec.y + end, 0, 1, 0, spec.nchannels, type, rows.data())
                                        : input.read_scanlines(index, 0, spec.y + begin, spec.y + end, 0, 0,
                                                               spec.nchannels, type, rows.data());
  if (!read)
    check(sty_fail(error, STY_ERROR_INPUT, "%s: found damaged or missing pixel data near row %d, expected %dx%d pixels",
                   path, begin, spec.full_width, spec.full_height));
}

// Spreads interleaved rows over the planes; every value is divided by its channel's divisor.
template <typename Value>
void spread_rows(const Part &part, int begin, int end, const std::vector<Value> &rows, int first_channel,
                 StyImage *image) {
  const ImageSpec &spec = part.spec;
  const int offset_x = spec.x - spec.full_x, offset_y = spec.y - spec.full_y;
  const int from = std::max(0, -offset_x), to = std::min(spec.width, image->width - offset_x);
  const size_t channels = size_t(spec.nchannels);
  for (size_t c = 0; c < channels; c++) {
    float *plane = image->data + (size_t(first_channel) + c) * sty_count_pixels(image);
    for (int y = begin; y < end; y++) {
      const int target_y = y + offset_y;
      if (target_y < 0 || target_y >= image->height) continue;
      const Value *source = rows.data() + size_t(y - begin) * size_t(spec.width) * channels + c;
      float *target = plane + long(target_y) * image->width + offset_x;
      for (int x = from; x < to; x++) target[x] = float(source[size_t(x) * channels]) / part.divisors[c];
    }
  }
}

// Reads a part's rows into the planes first_channel... of `image`, in its own
// integers where it has them: OpenImageIO's scaling isn't v/255 to the last bit.
template <typename Value>
void read_part(const char *path, ImageInput &input, int index, const Part &part, TypeDesc type, int first_channel,
               StyImage *image, StyError *error) {
  const ImageSpec &spec = part.spec;
  // Tiled files are read by rows of tiles, others by rows.
  const int step = spec.tile_height > 0 ? spec.tile_height : kRowsAtOnce;
  std::vector<Value> rows(size_t(step) * size_t(spec.width) * size_t(spec.nchannels));
  for (int begin = 0; begin < spec.height; begin += step) {
    const int end = std::min(begin + step, spec.height);
    read_rows(path, input, index, spec, begin, end, type, rows, error);
    spread_rows(part, begin, end, rows, first_channel, image);
  }
}

void read_attributes(const ImageSpec &spec, StyImage *image, StyError *error) {
  for (const OIIO::ParamValue &attribute : spec.extra_attribs) {
    const std::string name = attribute.name().string();
    if (name.compare(0, std::strlen(kAttributePrefix), kAttributePrefix) == 0)
      check(sty_set_attribute(image, name.c_str(), attribute.get_string().c_str(), error));
  }
}

// Hands rows of interleaved values to the writer.
void write_rows(const char *path, ImageOutput &output, const StyImage *image, int first, StyError *error) {
  const ImageSpec &spec = output.spec();
  const size_t pixels = sty_count_pixels(image);
  const size_t channels = size_t(image->channel_count), width = size_t(image->width);
  std::vector<float> rows(size_t(std::min(kRowsAtOnce, image->height)) * width * channels);
  std::vector<uint16_t> integers(image->bits < 32 ? rows.size() : 0);
  const float top = image->bits == 8 ? 255.0f : 65535.0f;
  for (int begin = 0; begin < image->height; begin += kRowsAtOnce) {
    const int end = std::min(begin + kRowsAtOnce, image->height);
    const size_t count = size_t(end - begin) * width * channels;
    for (size_t c = 0; c < channels; c++) {
      const float *plane = image->data + c * pixels + size_t(begin) * width;
      for (size_t i = 0; i < count / channels; i++) rows[i * channels + c] = plane[i];
    }
    bool written;
    if (spec.format == TypeDesc::FLOAT) {
      written = output.write_scanlines(first + begin, first + end, 0, TypeDesc::FLOAT, rows.data());
    } else {
      // Rounded here, so that no library version rounds for us.
      for (size_t i = 0; i < count; i++)
        integers[i] = uint16_t(std::lrint(std::fmin(std::fmax(rows[i], 0.0f), 1.0f) * top));
      std::vector<uint8_t> bytes;
      if (image->bits == 8) bytes.assign(integers.begin(), integers.begin() + long(count));
      written = output.write_scanlines(first + begin, first + end, 0, spec.format,
                                       image->bits == 8 ? (const void *)bytes.data() : integers.data());
    }
    if (!written) check(sty_fail(error, STY_ERROR_FILE, "%s: cannot write: %s", path, output.geterror().c_str()));
  }
}

}  // namespace

// A picture file whose headers were read, and found to be of a picture that there may be.
struct Source {
  std::unique_ptr<ImageInput> input;
  std::vector<Part> parts;
};

static void check_names(const char *path, const std::vector<const char *> &names, StyError *error) {
  for (size_t n = 0; n < names.size(); n++) {
    for (size_t earlier = 0; earlier < n; earlier++)
      if (std::strcmp(names[n], names[earlier]) == 0)
        check(sty_fail(error, STY_ERROR_INPUT, "%s: found two channels named %s, expected distinct names", path,
                       names[n]));
    if (std::strlen(names[n]) >= STY_MAX_NAME)
      check(sty_fail(error, STY_ERROR_INPUT, "%s: found a channel name of %zu bytes, expected at most %d", path,
                     std::strlen(names[n]), STY_MAX_NAME - 1));
  }
}

static Source open_source(const char *path, long long most_pixels, StyError *error) {
  uint64_t file_bytes = 0;
  check(sty_check_file(path, &file_bytes, error));
  ImageSpec header, hints;
  hints["oiio:UnassociatedAlpha"] = 1;
  hints["oiio:RawColor"] = 1;
  Source source;
  source.input = ImageInput::create(find_reader(path));
  if (!source.input || !source.input->open(path, header, hints))
    check(sty_fail(error, STY_ERROR_INPUT, "%s: found no readable picture, expected EXR, PNG, TIFF, JPEG, TGA or HDR",
                   path));
  source.parts = read_headers(path, *source.input, double(file_bytes), most_pixels, error);
  return source;
}

static std::vector<const char *> get_names(const Source &source) {
  std::vector<const char *> names;
  for (const Part &part : source.parts)
    for (const std::string &name : part.names) names.push_back(name.c_str());
  return names;
}

StyStatus sty::read_shape(const char *path, long long most_pixels, StyImageShape *out, StyError *error) {
  return guard(path, error, [&] {
    const Source source = open_source(path, most_pixels, error);
    const ImageSpec &first = source.parts.front().spec;
    *out = {first.full_width, first.full_height, int(get_names(source).size())};
  });
}

StyStatus sty::read_image(const char *path, long long most_pixels, StyImage **out, StyError *error) {
  return guard(path, error, [&] {
    const Source source = open_source(path, most_pixels, error);
    const std::vector<const char *> names = get_names(source);
    check_names(path, names, error);
    const std::vector<Part> &parts = source.parts;
    const ImageSpec &first = parts.front().spec;
    StyError cause;
    StyImage *created = nullptr;
    if (const StyStatus failed = sty_create_image(first.full_width, first.full_height, int(names.size()), names.data(),
                                                  bits_of(first.format), &created, &cause))
      check(sty_fail(error, failed, "%s: %s", path, cause.text));
    ImageHolder image(created);
    int channel = 0;
    for (size_t i = 0; i < parts.size(); i++) {
      const int bits = bits_of(parts[i].spec.format);
      ImageInput &input = *source.input;
      if (bits == 8)
        read_part<uint8_t>(path, input, int(i), parts[i], TypeDesc::UINT8, channel, image.get(), error);
      else if (bits == 16)
        read_part<uint16_t>(path, input, int(i), parts[i], TypeDesc::UINT16, channel, image.get(), error);
      else
        read_part<float>(path, input, int(i), parts[i], TypeDesc::FLOAT, channel, image.get(), error);
      channel += parts[i].spec.nchannels;
    }
    read_attributes(first, image.get(), error);
    *out = image.release();
  });
}

struct StyRowWriter {
  std::string path;
  // Before the output, which still turns to it when it is destroyed.
  OIIO::Filesystem::IOFile proxy;
  std::unique_ptr<ImageOutput> output;
  int next = 0;  // row

  StyRowWriter(const char *name, FILE *stream) : path(name), proxy(stream, OIIO::Filesystem::IOProxy::Write) {}
};

static ImageSpec make_spec(const StyImage *like, int height, StyImageFormat format) {
  const bool exr = format == STY_IMAGE_EXR;
  ImageSpec spec(like->width, height, like->channel_count,
                 exr               ? TypeDesc::FLOAT
                 : like->bits == 8 ? TypeDesc::UINT8
                                   : TypeDesc::UINT16);
  for (int c = 0; c < like->channel_count; c++) spec.channelnames[size_t(c)] = like->names[c];
  // PNG gives meaning to channels by their place; only alpha needs a mark.
  spec.alpha_channel = !exr && like->channel_count % 2 == 0 ? like->channel_count - 1 : -1;
  spec["oiio:UnassociatedAlpha"] = 1;
  // Lossless; higher levels take longer and gain 2 %.
  spec["compression"] = exr ? "zip:1" : "";
  spec["DateTime"] = "2000:01:01 00:00:00";  // the same bytes whenever it is written
  for (int i = 0; i < like->attribute_count; i++) spec.attribute(like->attributes[i].name, like->attributes[i].value);
  return spec;
}

static StyStatus open_writer(const char *path, FILE *stream, StyImageFormat format, const StyImage *like, int height,
                             StyRowWriter **out, StyError *error) {
  return guard(path, error, [&] {
    auto writer = std::make_unique<StyRowWriter>(path, stream);
    writer->output = ImageOutput::create(format == STY_IMAGE_EXR ? "openexr" : "png");
    if (!writer->output)
      check(sty_fail(error, STY_ERROR_LIBRARY, "%s: OpenImageIO has no writer for this format", path));
    ImageSpec spec = make_spec(like, height, format);
    void *pointer = &writer->proxy;
    spec.attribute("oiio:ioproxy", TypeDesc::PTR, &pointer);
    if (!writer->output->open(path, spec))
      check(sty_fail(error, STY_ERROR_FILE, "%s: cannot write: %s", path, writer->output->geterror().c_str()));
    *out = writer.release();
  });
}

static StyStatus append_rows(StyRowWriter *writer, const StyImage *rows, StyError *error) {
  return guard(writer->path.c_str(), error, [&] {
    write_rows(writer->path.c_str(), *writer->output, rows, writer->next, error);
    writer->next += rows->height;
  });
}

static void discard_writer(StyRowWriter **writer) {
  delete *writer;
  *writer = nullptr;
}

static StyStatus close_writer(StyRowWriter **writer, StyError *error) {
  const std::string path = (*writer)->path;
  const StyStatus status = guard(path.c_str(), error, [&] {
    if (!(*writer)->output->close())
      check(
          sty_fail(error, STY_ERROR_FILE, "%s: cannot write: %s", path.c_str(), (*writer)->output->geterror().c_str()));
  });
  discard_writer(writer);
  return status;
}

extern "C" __attribute__((visibility("default"))) const StyImageCodec sty_image_codec = {
    sty::read_image, sty::read_shape, sty::resize_image, open_writer,        append_rows,
    close_writer,    discard_writer,  sty::open_texture, sty::close_texture, sty::sample_texture};
