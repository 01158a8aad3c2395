/* Writes KTX2 files of every format with 1, 2, 6 and 7 layers, and beside each
 * a raw dump and what a reader should find, for ktx_parse.mjs.
 * Usage: write_ktx2 FOLDER */
#include <stdio.h>
#include <stdlib.h>

#include "stylut/ktx2.h"
#include "stylut/runtime_format.h"

enum { WIDTH = 5, HEIGHT = 3, LARGEST_TEXEL = 16 };

static const struct {
  uint32_t vk;
  int texel_size;
} formats[] = {{STY_VK_R8G8_UNORM, 2},
               {STY_VK_R8G8B8A8_UNORM, 4},
               {STY_VK_R8G8B8A8_SRGB, 4},
               {STY_VK_R16G16_UNORM, 4},
               {STY_VK_R32G32B32A32_SFLOAT, 16}};

static void write_case(const char *folder, uint32_t vk, int texel_size, int layers) {
  char path[4096];
  StyKtx2 texture;
  StyError error;
  snprintf(path, sizeof path, "%s/%u-%d.ktx2", folder, vk, layers);
  StyStatus status = sty_open_ktx2(path, vk, WIDTH, HEIGHT, layers, &texture, &error);
  snprintf(path, sizeof path, "%s/%u-%d.raw", folder, vk, layers);
  FILE *raw = fopen(path, "wb");
  for (int layer = 0; raw && !status && layer < layers; layer++) {
    unsigned char texels[WIDTH * HEIGHT * LARGEST_TEXEL];
    const size_t size = (size_t)(WIDTH * HEIGHT * texel_size);
    for (size_t i = 0; i < size; i++) texels[i] = (unsigned char)(i * 7 + (size_t)layer * 31 + vk);
    fwrite(texels, 1, size, raw);
    status = sty_write_ktx2_layer(&texture, texels, &error);
  }
  if (!status) status = sty_commit_ktx2(&texture, &error);
  if (!raw || fclose(raw) != 0 || status) {
    fprintf(stderr, "write_ktx2: %s\n", status ? error.text : path);
    exit(1);
  }
}

int main(int argc, char **argv) {
  static const int layers[] = {1, 2, 6, 7};
  if (argc != 2) return 1;
  for (size_t f = 0; f < sizeof formats / sizeof *formats; f++)
    for (size_t n = 0; n < sizeof layers / sizeof *layers; n++)
      write_case(argv[1], formats[f].vk, formats[f].texel_size, layers[n]);
  return 0;
}
