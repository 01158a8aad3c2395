/* Files of the KTX2 writer, byte by byte against what the KTX File Format 2.0
 * and the Khronos Data Format 1.3 ask for, and through the runtime's reader. */
#include "../scratch.h"
#include "stylut/ktx2.h"
#include "stylut/runtime.h"

/* Per format, worked out by hand: sizes, and the descriptor's words after its
 * total size and its vendor, which is 0. A sample is four words: bit offset,
 * bits less one << 16 and channel << 24; position; lowest; highest. */
typedef struct Expected {
  uint32_t vk, texel, type_size, descriptor_size, level_at;
  uint32_t words[21];
} Expected;

static const Expected expectations[] = {
    /* 104 + 60 = 164, pairs of 24 + 24 = 48 bytes: 212 is a multiple of 4. Blocks of 56 and 88 bytes, version 2;
     * model RGBSDA 1, primaries BT.709 1, transfer linear 1 or sRGB 2. */
    {STY_VK_R8G8_UNORM, 2, 1, 60, 212, {0x00380002, 0x00010101, 0, 2, 0, 0x00070000, 0, 0, 255, 0x01070008, 0, 0, 255}},
    {STY_VK_R8G8B8A8_UNORM, 4, 1, 92, 244, {0x00580002, 0x00010101, 0, 4, 0,   0x00070000, 0, 0, 255, 0x01070008, 0, 0,
                                            255,        0x02070010, 0, 0, 255, 0x0F070018, 0, 0, 255}},
    /* Alpha stays linear: qualifier 1 of the channel's high half. */
    {STY_VK_R8G8B8A8_SRGB, 4, 1, 92, 244, {0x00580002, 0x00020101, 0, 4, 0,   0x00070000, 0, 0, 255, 0x01070008, 0, 0,
                                           255,        0x02070010, 0, 0, 255, 0x1F070018, 0, 0, 255}},
    {STY_VK_R16G16_UNORM,
     4,
     2,
     60,
     212,
     {0x00380002, 0x00010101, 0, 4, 0, 0x000F0000, 0, 0, 65535, 0x010F0010, 0, 0, 65535}},
    /* Float and signed: qualifiers 8 and 4; -1 and 1 as binary32. 244 goes up to a multiple of 16. */
    {STY_VK_R32G32B32A32_SFLOAT, 16, 4, 92, 256, {0x00580002, 0x00010101, 0,          16,         0,
                                                  0xC01F0000, 0,          0xBF800000, 0x3F800000, 0xC11F0020,
                                                  0,          0xBF800000, 0x3F800000, 0xC21F0040, 0,
                                                  0xBF800000, 0x3F800000, 0xCF1F0060, 0,          0xBF800000,
                                                  0x3F800000}},
};
enum { FORMATS = 5, WIDTH = 5, HEIGHT = 3, PAIRS_SIZE = 48 };

static void append32(unsigned char **at, uint32_t value) {
  for (int i = 0; i < 4; i++) *(*at)++ = (unsigned char)(value >> 8 * i);
}

/* All that stands before the texels. */
static void expect_head(const Expected *expected, uint32_t layers, unsigned char head[256]) {
  static const unsigned char identifier[12] = {0xAB, 0x4B, 0x54, 0x58, 0x20, 0x32, 0x30, 0xBB, 0x0D, 0x0A, 0x1A, 0x0A};
  const uint32_t level_size = expected->texel * WIDTH * HEIGHT * layers, pairs_at = 104 + expected->descriptor_size;
  const uint32_t words[23] = {expected->vk,
                              expected->type_size,
                              WIDTH,
                              HEIGHT,
                              /* depth */ 0,
                              layers,
                              /* faces */ 1,
                              /* levels */ 1,
                              /* scheme */ 0,
                              /* descriptor */ 104,
                              expected->descriptor_size,
                              /* pairs */ pairs_at,
                              PAIRS_SIZE,
                              /* global data: two 64-bit zeros */ 0,
                              0,
                              0,
                              0,
                              /* level: three 64-bit numbers */ expected->level_at,
                              0,
                              level_size,
                              0,
                              level_size,
                              0};
  memset(head, 0, 256);
  memcpy(head, identifier, sizeof identifier);
  unsigned char *at = head + sizeof identifier;
  for (int i = 0; i < 23; i++) append32(&at, words[i]);
  append32(&at, expected->descriptor_size);
  append32(&at, 0);
  for (uint32_t i = 0; i < expected->descriptor_size / 4 - 2; i++) append32(&at, expected->words[i]);
  /* Keys in the order of their characters, each entry padded to 4 bytes. */
  memcpy(at, "\22\0\0\0KTXorientation\0rd\0\0\0\21\0\0\0KTXwriter\0stylut\0\0\0", PAIRS_SIZE);
}

static unsigned char *draw_texels(uint64_t *random, size_t size) {
  unsigned char *texels = malloc(size);
  assert_non_null(texels);
  for (size_t i = 0; i < size; i++) texels[i] = (unsigned char)draw(random);
  return texels;
}

static StyKtx2 open_or_fail(const char *path, uint32_t vk, int layers) {
  StyKtx2 texture;
  StyError error;
  if (sty_open_ktx2(path, vk, WIDTH, HEIGHT, layers, &texture, &error)) fail_msg("%s", error.text);
  return texture;
}

static void test_every_byte(void **state) {
  Scratch *scratch = *state;
  static const int layer_counts[] = {1, 2, 6, 7};
  uint64_t random = 1;
  for (int format = 0; format < FORMATS; format++)
    for (int i = 0; i < 4; i++) {
      const Expected *expected = &expectations[format];
      const int layers = layer_counts[i];
      const size_t layer_size = (size_t)expected->texel * WIDTH * HEIGHT, texels_size = layer_size * (size_t)layers;
      unsigned char *texels = draw_texels(&random, texels_size), head[256];
      StyError error;
      const char *path = path_in(scratch, "texture.ktx2");
      StyKtx2 texture = open_or_fail(path, expected->vk, layers);
      assert_int_equal(texture.layer_size, layer_size);
      for (int layer = 0; layer < layers; layer++)
        assert_int_equal(sty_write_ktx2_layer(&texture, texels + layer_size * (size_t)layer, &error), STY_OK);
      assert_int_equal(access(path, F_OK), -1); /* appears complete or not at all */
      if (sty_commit_ktx2(&texture, &error)) fail_msg("%s", error.text);
      assert_int_equal(count_entries(scratch->folder), 1);

      size_t size;
      unsigned char *bytes = read_bytes(path, &size);
      expect_head(expected, (uint32_t)layers, head);
      assert_int_equal(size, expected->level_at + texels_size);
      assert_memory_equal(bytes, head, expected->level_at);
      assert_memory_equal(bytes + expected->level_at, texels, texels_size);
      assert_int_equal(expected->level_at % (expected->texel > 4 ? expected->texel : 4), 0);

      StyTexture read;
      assert_int_equal(sty_open_texture((StyBlob){bytes, size}, expected->vk, &read), STY_RUNTIME_OK);
      assert_true(read.width == WIDTH && read.height == HEIGHT && read.layers == (uint32_t)layers);
      assert_int_equal(read.texel_size, expected->texel);
      assert_ptr_equal(read.texels, bytes + expected->level_at);
      for (int other = 0; other < FORMATS; other++)
        if (other != format)
          assert_int_equal(sty_open_texture((StyBlob){bytes, size}, expectations[other].vk, &read),
                           STY_RUNTIME_WRONG_FORMAT);
      free(texels);
      free(bytes);
      unlink(path);
    }
}

/* Nothing appears, and what was there before stays. */
static void test_too_few_layers(void **state) {
  Scratch *scratch = *state;
  const unsigned char texels[2 * WIDTH * HEIGHT] = {0};
  for (int written = 0; written < 3; written++)
    for (int before = 0; before < 2; before++) {
      StyError error;
      if (before) write_bytes(scratch, "few.ktx2", "before", 6);
      const char *path = path_in(scratch, "few.ktx2");
      StyKtx2 texture = open_or_fail(path, STY_VK_R8G8_UNORM, 3);
      for (int i = 0; i < written; i++) assert_int_equal(sty_write_ktx2_layer(&texture, texels, &error), STY_OK);
      char found[2] = {(char)('0' + written), 0};
      expect_message(sty_commit_ktx2(&texture, &error), STY_ERROR_USAGE, &error, PARTS("few.ktx2", found, "3"));
      assert_int_equal(count_entries(scratch->folder), before);
      sty_discard_ktx2(&texture); /* spent: nothing happens */
      assert_int_equal(count_entries(scratch->folder), before);
      if (!before) continue;
      size_t size;
      unsigned char *bytes = read_bytes(path, &size);
      assert_int_equal(size, 6);
      assert_memory_equal(bytes, "before", 6);
      free(bytes);
      unlink(path);
    }
}

/* Refused without harm: the file is what it would have been. */
static void test_too_many_layers(void **state) {
  Scratch *scratch = *state;
  const unsigned char texels[2 * WIDTH * HEIGHT] = {1, 2, 3};
  StyError error;
  const char *path = path_in(scratch, "many.ktx2");
  StyKtx2 texture = open_or_fail(path, STY_VK_R8G8_UNORM, 2);
  for (int i = 0; i < 2; i++) assert_int_equal(sty_write_ktx2_layer(&texture, texels, &error), STY_OK);
  for (int i = 0; i < 2; i++)
    expect_message(sty_write_ktx2_layer(&texture, texels, &error), STY_ERROR_USAGE, &error, PARTS("many.ktx2", "2"));
  assert_int_equal(sty_write_ktx2_layer(&texture, texels, NULL), STY_ERROR_USAGE);
  assert_int_equal(sty_commit_ktx2(&texture, &error), STY_OK);
  size_t size;
  unsigned char *bytes = read_bytes(path, &size);
  assert_int_equal(size, 212 + 2 * sizeof texels);
  assert_memory_equal(bytes + 212 + sizeof texels, texels, sizeof texels);
  free(bytes);
}

static void test_discard_leaves_nothing(void **state) {
  Scratch *scratch = *state;
  const unsigned char texels[4 * WIDTH * HEIGHT] = {0};
  for (int written = 0; written <= 2; written++) {
    StyKtx2 texture = open_or_fail(path_in(scratch, "gone.ktx2"), STY_VK_R8G8B8A8_UNORM, 2);
    for (int i = 0; i < written; i++) assert_int_equal(sty_write_ktx2_layer(&texture, texels, NULL), STY_OK);
    sty_discard_ktx2(&texture);
    sty_discard_ktx2(&texture);
    assert_int_equal(count_entries(scratch->folder), 0);
  }
}

static void test_refused_openings(void **state) {
  Scratch *scratch = *state;
  static const struct {
    uint32_t vk;
    int width, height, layers;
  } cases[] = {{0, 1, 1, 1},
               {44, 1, 1, 1},
               {37, 0, 1, 1},
               {37, 1, 0, 1},
               {37, 1, 1, 0},
               {37, -1, -1, 1},
               {37, 1, 1, -2},
               /* more bytes than can be counted: */ {109, 1 << 30, 1 << 30, 1},
               {109, INT32_MAX, INT32_MAX, INT32_MAX}};
  StyError error;
  StyKtx2 texture;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    const StyStatus status = sty_open_ktx2(path_in(scratch, "bad.ktx2"), cases[i].vk, cases[i].width, cases[i].height,
                                           cases[i].layers, &texture, &error);
    expect_message(status, STY_ERROR_USAGE, &error, PARTS("bad.ktx2"));
    assert_int_equal(count_entries(scratch->folder), 0);
  }
  const StyStatus status = sty_open_ktx2(path_in(scratch, "none/bad.ktx2"), 37, 1, 1, 1, &texture, &error);
  expect_message(status, STY_ERROR_FILE, &error, PARTS("none/bad.ktx2"));
  assert_int_equal(sty_open_ktx2(scratch->folder, 37, 1, 1, 1, &texture, NULL), STY_ERROR_FILE);
}

/* A full disk is told at the latest when committing. */
static void test_full_disk(void **state) {
  Scratch *scratch = *state;
  const size_t size = 4 << 20;
  unsigned char *texels = calloc(1, size);
  assert_non_null(texels);
  StyKtx2 texture;
  StyError error;
  assert_int_equal(sty_open_ktx2(path_in(scratch, "full.ktx2"), 37, 1024, 1024, 1, &texture, &error), STY_OK);
  FILE *full = fopen("/dev/full", "wb");
  if (!full) {
    sty_discard_ktx2(&texture);
    free(texels);
    skip();
  }
  fclose(texture.output.stream);
  texture.output.stream = full;
  StyStatus status = sty_write_ktx2_layer(&texture, texels, &error);
  if (!status)
    status = sty_commit_ktx2(&texture, &error);
  else
    sty_discard_ktx2(&texture);
  expect_message(status, STY_ERROR_FILE, &error, PARTS("full.ktx2"));
  assert_int_equal(count_entries(scratch->folder), 0);
  free(texels);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      scratch_test(test_every_byte),       scratch_test(test_too_few_layers),
      scratch_test(test_too_many_layers),  scratch_test(test_discard_leaves_nothing),
      scratch_test(test_refused_openings), scratch_test(test_full_disk),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
