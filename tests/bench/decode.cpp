/* Decodes pictures with OpenImageIO and nothing else, one picture a thread, to bytes:
 * what `stylut batch` is measured beside. Usage: decode THREADS PICTURE... */
#include <OpenImageIO/imageio.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

namespace {

bool decode(const char *path) {
  const auto input = OIIO::ImageInput::open(path);
  if (!input) return false;
  std::vector<unsigned char> pixels(input->spec().image_pixels() * input->spec().nchannels);
  return input->read_image(0, 0, 0, input->spec().nchannels, OIIO::TypeDesc::UINT8, pixels.data());
}

}  // namespace

int main(int argc, char **argv) {
  OIIO::attribute("threads", 1);
  std::atomic<int> next(2);
  std::atomic<bool> failed(argc < 3);
  std::vector<std::thread> threads;
  for (int t = argc < 3 ? 0 : std::atoi(argv[1]); t > 0; t--)
    threads.emplace_back([&] {
      for (int i = next++; i < argc; i = next++)
        if (!decode(argv[i])) failed = true;
    });
  for (auto &thread : threads) thread.join();
  if (failed) std::fprintf(stderr, "decode: expected THREADS PICTURE..., all of them readable\n");
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
