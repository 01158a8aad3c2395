#include <fcntl.h>
#include <math.h>

#include "../scratch.h"
#include "stylut/image_io.h"

static const char *const RGBA[] = {"R", "G", "B", "A"};
static const char *const GREY[] = {"Y", "A"};

static StyImage *make_picture(int width, int height, int count, const char *const *names, int bits) {
  StyImage *image = NULL;
  assert_int_equal(sty_create_image(width, height, count, names, bits, &image, NULL), STY_OK);
  return image;
}

/* Random integers over M for 8 and 16 bits, floats otherwise. */
static StyImage *make_noise(int width, int height, int count, const char *const *names, int bits) {
  StyImage *image = make_picture(width, height, count, names, bits);
  uint64_t random = (uint64_t)width;
  const size_t values = sty_count_pixels(image) * (size_t)count;
  const int top = bits == 8 ? 255 : 65535;
  for (size_t i = 0; i < values; i++)
    image->data[i] = bits == 32 ? draw_signed(&random) * 100 : (float)draw_below(&random, top + 1) / (float)top;
  return image;
}

static StyImage *read_back(const char *path) {
  StyImage *image = NULL;
  StyError error = {STY_OK, ""};
  if (sty_read_image(path, &image, &error) != STY_OK) fail_msg("%s", error.text);
  return image;
}

static void write_out(const char *path, const StyImage *image) {
  StyError error = {STY_OK, ""};
  if (sty_write_image(path, image, &error) != STY_OK) fail_msg("%s", error.text);
}

/* Bit for bit. PNG has no names for its grey channels, so that their order has to do. */
static int same_pixels(const StyImage *a, const StyImage *b, int by_name) {
  if (a->width != b->width || a->height != b->height || a->channel_count != b->channel_count) return 0;
  const size_t plane = sty_count_pixels(a);
  for (int c = 0; c < a->channel_count; c++) {
    const float *other = by_name ? sty_find_channel(b, a->names[c]) : b->data + plane * (size_t)c;
    if (!other || memcmp(a->data + plane * (size_t)c, other, plane * sizeof(float))) return 0;
  }
  return 1;
}

static void test_png_round_trips(void **state) {
  Scratch *scratch = *state;
  static const int sizes[][2] = {{1, 1}, {7, 5}, {64, 3}, {255, 33}};
  for (int count = 1; count <= 4; count++) {
    for (int bits = 8; bits <= 16; bits += 8) {
      for (int s = 0; s < 4; s++) {
        StyImage *image = make_noise(sizes[s][0], sizes[s][1], count, count < 3 ? GREY : RGBA, bits);
        write_out(path_in(scratch, "a.png"), image);
        assert_int_equal(count_entries(scratch->folder), 1);
        StyImage *back = read_back(scratch->path);
        assert_int_equal(back->bits, bits);
        if (!same_pixels(image, back, count >= 3)) fail_msg("%d channels of %d bits come back changed", count, bits);
        sty_destroy_image(&back);
        sty_destroy_image(&image);
        unlink(scratch->path);
      }
    }
  }
}

/* All integers survive, and are v/M exactly as divided in float. */
static void test_every_integer(void **state) {
  Scratch *scratch = *state;
  for (int bits = 8; bits <= 16; bits += 8) {
    const int top = bits == 8 ? 255 : 65535;
    StyImage *image = make_picture(256, (top + 1) / 256, 3, RGBA, bits);
    for (int c = 0; c < 3; c++)
      for (int i = 0; i <= top; i++) image->data[c * (top + 1) + i] = (float)i / (float)top;
    write_out(path_in(scratch, "a.png"), image);
    StyImage *back = read_back(scratch->path);
    assert_int_equal(back->bits, bits);
    for (int i = 0; i <= top; i++) assert_true(back->data[i] == (float)i / (float)top);
    assert_true(same_pixels(image, back, 1));
    sty_destroy_image(&back);
    sty_destroy_image(&image);
  }
  unlink(scratch->path);
}

/* Colour under alpha 0 is kept, and none is multiplied in. */
static void test_unassociated_alpha(void **state) {
  Scratch *scratch = *state;
  for (int bits = 8; bits <= 32; bits *= 2) {
    StyImage *image = make_noise(16, 16, 4, RGBA, bits);
    const int top = bits == 8 ? 255 : 65535;
    float *alpha = sty_find_channel(image, "A");
    for (int i = 0; i < 256; i++) alpha[i] = i % 4 == 0 ? 0 : (float)(i * top / 255) / (float)top;
    write_out(path_in(scratch, bits == 32 ? "a.exr" : "a.png"), image);
    StyImage *back = read_back(scratch->path);
    assert_true(same_pixels(image, back, 1));
    sty_destroy_image(&back);
    sty_destroy_image(&image);
    unlink(scratch->path);
  }
}

static void test_clamping(void **state) {
  Scratch *scratch = *state;
  StyImage *image = make_picture(4, 1, 1, GREY, 8);
  static const float values[] = {-0.5f, 1.5f, 1e30f, -INFINITY};
  memcpy(image->data, values, sizeof values);
  write_out(path_in(scratch, "a.png"), image);
  StyImage *back = read_back(scratch->path);
  assert_true(back->data[0] == 0 && back->data[1] == 1 && back->data[2] == 1 && back->data[3] == 0);
  sty_destroy_image(&back);
  sty_destroy_image(&image);
  unlink(scratch->path);
}

static void test_exr_round_trip(void **state) {
  Scratch *scratch = *state;
  static const char *const names[] = {"normal.X", "A", "depth.Z", "normal.Y", "style.I", "zeta", "a.b.c"};
  StyImage *image = make_noise(33, 17, 7, names, 32);
  static const float special[] = {INFINITY, -INFINITY, -0.0f, 1e-45f, 3.4028235e38f, 1e-38f, 0.1f};
  memcpy(image->data, special, sizeof special);
  memcpy(sty_find_channel(image, "depth.Z") + 100, special, sizeof special);
  assert_int_equal(sty_set_attribute(image, "stylut:history", "guide sphere -s 5 -o \"x y.exr\"", NULL), STY_OK);
  assert_int_equal(sty_set_attribute(image, "stylut:seed", "7", NULL), STY_OK);
  write_out(path_in(scratch, "a.exr"), image);
  StyImage *back = read_back(scratch->path);
  assert_int_equal(back->bits, 32);
  assert_true(same_pixels(image, back, 1));
  assert_string_equal(sty_find_attribute(back, "stylut:history"), "guide sphere -s 5 -o \"x y.exr\"");
  assert_string_equal(sty_find_attribute(back, "stylut:seed"), "7");
  sty_destroy_image(&back);
  sty_destroy_image(&image);
  unlink(scratch->path);
}

static void test_exr_with_many_channels(void **state) {
  Scratch *scratch = *state;
  char texts[STY_MAX_CHANNELS][16];
  const char *names[STY_MAX_CHANNELS];
  for (int c = 0; c < STY_MAX_CHANNELS; c++) {
    snprintf(texts[c], sizeof texts[c], "c%d.v", c);
    names[c] = texts[c];
  }
  StyImage *image = make_noise(3, 2, STY_MAX_CHANNELS, names, 32);
  write_out(path_in(scratch, "a.exr"), image);
  StyImage *back = read_back(scratch->path);
  assert_true(same_pixels(image, back, 1));
  sty_destroy_image(&back);
  sty_destroy_image(&image);
  unlink(scratch->path);
}

static void test_png_attributes(void **state) {
  Scratch *scratch = *state;
  StyImage *image = make_noise(5, 5, 3, RGBA, 16);
  assert_int_equal(sty_set_attribute(image, "stylut:lut", "centre", NULL), STY_OK);
  assert_int_equal(sty_set_attribute(image, "stylut:source", "640x480", NULL), STY_OK);
  write_out(path_in(scratch, "a.png"), image);
  StyImage *back = read_back(scratch->path);
  assert_string_equal(sty_find_attribute(back, "stylut:lut"), "centre");
  assert_string_equal(sty_find_attribute(back, "stylut:source"), "640x480");
  sty_destroy_image(&back);
  sty_destroy_image(&image);
  unlink(scratch->path);
}

/* Libraries like to write the date. */
static void test_same_bytes_later(void **state) {
  Scratch *scratch = *state;
  static const char *const names[2][3] = {{"a.png", "b.png"}, {"a.exr", "b.exr"}};
  StyImage *image = make_noise(20, 10, 4, RGBA, 16);
  unsigned char *bytes[2];
  size_t sizes[2], later;
  for (int f = 0; f < 2; f++) {
    write_out(path_in(scratch, names[f][0]), image);
    bytes[f] = read_bytes(scratch->path, &sizes[f]);
    unlink(scratch->path);
  }
  usleep(1100000);
  for (int f = 0; f < 2; f++) {
    write_out(path_in(scratch, names[f][1]), image); /* the name isn't in it either */
    unsigned char *again = read_bytes(scratch->path, &later);
    assert_int_equal(later, sizes[f]);
    assert_memory_equal(again, bytes[f], later);
    free(again);
    free(bytes[f]);
    unlink(scratch->path);
  }
  sty_destroy_image(&image);
}

/* libpng complains on stderr by itself, hundreds of times here. */
static StyStatus read_quietly(const char *path, StyImage **image, StyError *error) {
  const int kept = dup(2), nowhere = open("/dev/null", O_WRONLY);
  assert_true(kept >= 0 && nowhere >= 0);
  dup2(nowhere, 2);
  const StyStatus status = sty_read_image(path, image, error);
  dup2(kept, 2);
  close(kept);
  close(nowhere);
  return status;
}

/* ---- broken files ---------------------------------------------------------------- */

static void expect_unreadable(Scratch *scratch, const char *name, const void *bytes, size_t size) {
  write_bytes(scratch, name, bytes, size);
  StyImage *image = NULL;
  StyError error = {STY_OK, ""};
  const StyStatus status = read_quietly(scratch->path, &image, &error);
  if (status != STY_ERROR_INPUT && status != STY_ERROR_FILE)
    fail_msg("%s of %zu bytes: status %d, message '%s'", name, size, status, error.text);
  expect_message(status, status, &error, PARTS(name));
  assert_null(image);
  unlink(scratch->path);
}

/* Cut anywhere, a file is refused; only what follows the last pixel may be missing. */
static void cut_everywhere(Scratch *scratch, const char *name, const StyImage *image, int step) {
  size_t size;
  write_out(path_in(scratch, name), image);
  unsigned char *bytes = read_bytes(scratch->path, &size);
  StyImage *whole = read_back(scratch->path);
  size_t refused = 0, cuts = 0;
  for (size_t length = 0; length < size; length += (size_t)step, cuts++) {
    /* An exactly sized file: nothing behind the cut. */
    write_bytes(scratch, name, bytes, length);
    StyImage *back = NULL;
    StyError error = {STY_OK, ""};
    const StyStatus status = read_quietly(scratch->path, &back, &error);
    if (status == STY_OK) {
      if (!same_pixels(whole, back, 1))
        fail_msg("%s, cut to %zu of %zu bytes, is read with wrong pixels", name, length, size);
      sty_destroy_image(&back);
      continue;
    }
    if (status != STY_ERROR_INPUT && status != STY_ERROR_FILE)
      fail_msg("%s, cut to %zu of %zu bytes: status %d, '%s'", name, length, size, status, error.text);
    expect_message(status, status, &error, PARTS(scratch->path));
    assert_null(back);
    refused++;
  }
  if (refused + 20 < cuts) fail_msg("%s: only %zu of %zu cuts are refused", name, refused, cuts);
  free(bytes);
  sty_destroy_image(&whole);
  unlink(scratch->path);
}

static void test_truncated(void **state) {
  Scratch *scratch = *state;
  for (int bits = 8; bits <= 16; bits += 8) {
    StyImage *image = make_noise(9, 7, 4, RGBA, bits);
    cut_everywhere(scratch, "cut.png", image, CASES(1, 3));
    cut_everywhere(scratch, "cut.exr", image, CASES(1, 5));
    sty_destroy_image(&image);
  }
  StyImage *image = make_noise(70, 90, 3, RGBA, 16); /* several blocks */
  cut_everywhere(scratch, "cut.png", image, CASES(191, 997));
  cut_everywhere(scratch, "cut.exr", image, CASES(191, 997));
  sty_destroy_image(&image);
}

/* Any byte may be wrong: refused, or read as a picture of a sane shape. */
static void test_flipped_bytes(void **state) {
  Scratch *scratch = *state;
  static const char *const names[] = {"flip.png", "flip.exr"};
  for (int f = 0; f < 2; f++) {
    size_t size;
    StyImage *image = make_noise(5, 4, 3, RGBA, 8);
    write_out(path_in(scratch, names[f]), image);
    unsigned char *bytes = read_bytes(scratch->path, &size);
    uint64_t random = 3;
    for (size_t at = 0; at < size; at += CASES(1, 4)) {
      const unsigned char before = bytes[at];
      bytes[at] ^= (unsigned char)(1 + draw_below(&random, 255));
      write_bytes(scratch, names[f], bytes, size);
      StyImage *back = NULL;
      StyError error = {STY_OK, ""};
      const StyStatus status = read_quietly(scratch->path, &back, &error);
      if (status == STY_OK) {
        assert_true(back->width > 0 && back->height > 0 && (long long)back->width * back->height <= STY_MAX_PIXELS);
        sty_destroy_image(&back);
      } else {
        if (status != STY_ERROR_INPUT && status != STY_ERROR_FILE)
          fail_msg("%s, byte %zu: status %d, '%s'", names[f], at, status, error.text);
        expect_message(status, status, &error, PARTS(scratch->path));
      }
      bytes[at] = before;
    }
    free(bytes);
    sty_destroy_image(&image);
    unlink(scratch->path);
  }
}

static void put_big_endian(unsigned char *at, uint32_t value) {
  for (int i = 0; i < 4; i++) at[i] = (unsigned char)(value >> (24 - 8 * i));
}

static void put_little_endian(unsigned char *at, uint32_t value) {
  for (int i = 0; i < 4; i++) at[i] = (unsigned char)(value >> (8 * i));
}

static uint32_t crc32_of(const unsigned char *bytes, size_t size) {
  uint32_t crc = 0xFFFFFFFFu;
  for (size_t i = 0; i < size; i++) {
    crc ^= bytes[i];
    for (int b = 0; b < 8; b++) crc = (crc >> 1) ^ (crc & 1 ? 0xEDB88320u : 0);
  }
  return ~crc;
}

static const uint32_t absurd[][2] = {{60000, 60000}, {16384, 16384}, {65537, 1},
                                     {1, 65537},     {1000000, 1},   {0x7FFFFFFF, 0x7FFFFFFF},
                                     {0, 5},         {5, 0},         {0x80000000u, 1}};

/* A hundred bytes that claim gigabytes, with a right checksum. */
static void test_absurd_png(void **state) {
  Scratch *scratch = *state;
  for (size_t i = 0; i < sizeof absurd / sizeof *absurd; i++) {
    unsigned char bytes[100] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n', 0, 0, 0, 13, 'I', 'H', 'D', 'R'};
    put_big_endian(bytes + 16, absurd[i][0]);
    put_big_endian(bytes + 20, absurd[i][1]);
    bytes[24] = 16; /* bits */
    bytes[25] = 6;  /* RGBA */
    put_big_endian(bytes + 29, crc32_of(bytes + 12, 17));
    put_big_endian(bytes + 33, 100 - 45 - 12);
    memcpy(bytes + 37, "IDAT\x78\x9c", 6);
    put_big_endian(bytes + 100 - 16, crc32_of(bytes + 37, 100 - 16 - 37));
    memcpy(bytes + 100 - 12, "\0\0\0\0IEND\xae\x42\x60\x82", 12);
    expect_unreadable(scratch, "absurd.png", bytes, sizeof bytes);
  }
}

static void test_absurd_exr(void **state) {
  Scratch *scratch = *state;
  StyImage *image = make_noise(2, 2, 4, RGBA, 32);
  size_t size;
  write_out(path_in(scratch, "a.exr"), image);
  unsigned char *bytes = read_bytes(scratch->path, &size);
  unlink(scratch->path);
  for (size_t i = 0; i < sizeof absurd / sizeof *absurd; i++) {
    for (int which = 1; which <= 3; which++) {
      unsigned char *broken = malloc(size);
      assert_non_null(broken);
      memcpy(broken, bytes, size);
      int patched = 0;
      for (size_t at = 0; at + 60 < size; at++) {
        const int data = (which & 1) && !memcmp(broken + at, "dataWindow\0box2i", 17);
        const int display = (which & 2) && !memcmp(broken + at, "displayWindow\0box2i", 20);
        if (!data && !display) continue;
        unsigned char *const box = broken + at + (data ? 17 : 20) + 4;
        put_little_endian(box + 8, absurd[i][0] - 1);
        put_little_endian(box + 12, absurd[i][1] - 1);
        patched++;
      }
      assert_int_equal(patched, which == 3 ? 2 : 1);
      expect_unreadable(scratch, "absurd.exr", broken, size);
      free(broken);
    }
  }
  free(bytes);
  sty_destroy_image(&image);
}

/* Readers would make room for a part before they see that the file hasn't got it. */
static void expect_absurd_lengths(Scratch *scratch, const char *name, const char *before, size_t before_size,
                                  int distance, void (*put)(unsigned char *at, uint32_t value)) {
  StyImage *image = make_noise(2, 2, 4, RGBA, strstr(name, ".exr") ? 32 : 8);
  size_t size;
  write_out(path_in(scratch, name), image);
  unsigned char *bytes = read_bytes(scratch->path, &size);
  const unsigned char *found = memmem(bytes, size, before, before_size);
  assert_non_null(found);
  unsigned char *length = bytes + (found - bytes) + distance;
  const uint32_t claims[] = {0x70000000, 0x7FFFFFFF, 0xFFFFFFFF, (uint32_t)(bytes + size - length) - 3};
  for (size_t i = 0; i < sizeof claims / sizeof *claims; i++) {
    put(length, claims[i]);
    write_bytes(scratch, name, bytes, size);
    StyImage *back = NULL;
    StyError error = {STY_OK, ""};
    expect_message(sty_read_image(scratch->path, &back, &error), STY_ERROR_INPUT, &error,
                   PARTS(name, "reaches beyond the file"));
  }
  free(bytes);
  sty_destroy_image(&image);
}

static void test_absurd_lengths(void **state) {
  expect_absurd_lengths(*state, "a.exr", "channels\0chlist", 16, 16, put_little_endian);
  expect_absurd_lengths(*state, "a.png", "IDAT", 4, -4, put_big_endian);
}

/* The bytes say what a file is, not its name; formats that aren't ours are refused even where OpenImageIO reads them.
 */
static void test_names_and_signatures(void **state) {
  Scratch *scratch = *state;
  StyImage *image = make_noise(3, 2, 3, RGBA, 8);
  size_t size;
  write_out(path_in(scratch, "a.png"), image);
  unsigned char *bytes = read_bytes(scratch->path, &size);
  static const char *const names[] = {"a.exr", "a.tga", "a.jpg", "a.hdr", "a.tif", "a"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    StyImage *back = read_back(write_bytes(scratch, names[i], bytes, size));
    assert_true(same_pixels(image, back, 1));
    sty_destroy_image(&back);
  }
  static const char pixmap[] = "P6 1 1 255\nabc";
  StyImage *back = NULL;
  StyError error = {STY_OK, ""};
  expect_message(sty_read_image(write_bytes(scratch, "a.ppm", pixmap, sizeof pixmap - 1), &back, &error),
                 STY_ERROR_INPUT, &error, PARTS("a.ppm", "found no readable picture", "PNG"));
  free(bytes);
  sty_destroy_image(&image);
}

static void test_not_a_picture(void **state) {
  Scratch *scratch = *state;
  static const char *const names[] = {"a.png", "a.exr", "a.tif", "a.jpg", "a.tga", "a.hdr", "a.xyz", "a"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    expect_unreadable(scratch, names[i], "", 0);
    expect_unreadable(scratch, names[i], "This is a text.\n", 16);
  }
}

static void test_unreadable_places(void **state) {
  Scratch *scratch = *state;
  StyImage *image = NULL;
  StyError error = {STY_OK, ""};
  expect_message(sty_read_image(path_in(scratch, "missing.png"), &image, &error), STY_ERROR_FILE, &error,
                 PARTS("missing.png"));
  expect_message(sty_read_image(path_in(scratch, "missing/a.exr"), &image, &error), STY_ERROR_FILE, &error,
                 PARTS("missing/a.exr"));
  expect_message(sty_read_image(scratch->folder, &image, &error), STY_ERROR_FILE, &error, PARTS(scratch->folder));
  assert_int_equal(mkdir(path_in(scratch, "folder.png"), 0700), 0);
  expect_message(sty_read_image(scratch->path, &image, &error), STY_ERROR_FILE, &error, PARTS("folder.png"));
  image = make_noise(2, 2, 3, RGBA, 8);
  expect_message(sty_write_image(scratch->path, image, &error), STY_ERROR_FILE, &error, PARTS("folder.png"));
  rmdir(scratch->path);
  static const char *const nowhere[] = {"missing/a.png", "missing/a.exr"};
  for (int i = 0; i < 2; i++)
    expect_message(sty_write_image(path_in(scratch, nowhere[i]), image, &error), STY_ERROR_FILE, &error,
                   PARTS(nowhere[i]));
  sty_destroy_image(&image);
  assert_int_equal(count_entries(scratch->folder), 0);
}

static void test_unwritable_pictures(void **state) {
  Scratch *scratch = *state;
  StyError error = {STY_OK, ""};
  static const char *const names[] = {"a.xyz", "a", "a.jpg", "png", "a.png.", "a.exr.txt"};
  StyImage *image = make_noise(2, 2, 3, RGBA, 8);
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    assert_int_not_equal(sty_write_image(path_in(scratch, names[i]), image, &error), STY_OK);
    assert_non_null(strstr(error.text, names[i]));
  }
  sty_destroy_image(&image);
  /* PNG holds 1 to 4 channels of integers. */
  static const char *const five[] = {"a", "b", "c", "d", "e"};
  image = make_noise(2, 2, 5, five, 8);
  assert_int_not_equal(sty_write_image(path_in(scratch, "a.png"), image, &error), STY_OK);
  sty_destroy_image(&image);
  image = make_noise(2, 2, 3, RGBA, 32);
  assert_int_not_equal(sty_write_image(path_in(scratch, "a.png"), image, &error), STY_OK);
  sty_destroy_image(&image);
  assert_int_equal(count_entries(scratch->folder), 0);
}

/* ---- pictures of other tools ------------------------------------------------------ */

/* Skips where OpenImageIO's own tool isn't installed. */
static void run_oiiotool(const Scratch *scratch, const char *arguments) {
  char command[2048];
  if (system("oiiotool --help >/dev/null 2>&1")) skip();
  snprintf(command, sizeof command, "cd '%s' && oiiotool %s >/dev/null 2>&1", scratch->folder, arguments);
  if (system(command)) fail_msg("failed: %s", command);
}

static void test_multi_part_exr(void **state) {
  Scratch *scratch = *state;
  run_oiiotool(scratch,
               "--pattern constant:color=0.25,0.5,0.75 6x4 3 --attrib oiio:subimagename beauty "
               "--pattern constant:color=1,2,3 6x4 3 --chnames N.X,N.Y,N.Z --attrib oiio:subimagename normals "
               "--siappend -d float -o multi.exr");
  StyImage *image = read_back(path_in(scratch, "multi.exr"));
  unlink(scratch->path);
  assert_int_equal(image->channel_count, 6);
  assert_int_equal(image->width, 6);
  assert_int_equal(image->height, 4);
  static const char *const names[] = {"beauty.R", "beauty.G", "beauty.B", "N.X", "N.Y", "N.Z"};
  static const float values[] = {0.25f, 0.5f, 0.75f, 1, 2, 3};
  for (int c = 0; c < 6; c++) {
    const float *plane = sty_find_channel(image, names[c]);
    if (!plane) fail_msg("no channel %s", names[c]);
    for (int i = 0; i < 24; i++) assert_true(plane[i] == values[c]);
  }
  sty_destroy_image(&image);
}

static void test_only_part_keeps_its_names(void **state) {
  Scratch *scratch = *state;
  run_oiiotool(scratch, "--pattern constant:color=1,2,3 6x4 3 --attrib oiio:subimagename beauty -d float -o one.exr");
  StyImage *image = read_back(path_in(scratch, "one.exr"));
  unlink(scratch->path);
  assert_non_null(sty_find_channel(image, "R"));
  sty_destroy_image(&image);
}

static void test_data_window(void **state) {
  Scratch *scratch = *state;
  run_oiiotool(scratch, "--pattern constant:color=1,2,3 4x3+2+1 3 --fullsize 10x8+0+0 -d float -o window.exr");
  StyImage *image = read_back(path_in(scratch, "window.exr"));
  unlink(scratch->path);
  assert_int_equal(image->width, 10);
  assert_int_equal(image->height, 8);
  const float *green = sty_find_channel(image, "G");
  for (int i = 0; i < 80; i++) {
    const int x = i % 10, y = i / 10, inside = x >= 2 && x < 6 && y >= 1 && y < 4;
    assert_true(green[i] == (inside ? 2 : 0));
  }
  sty_destroy_image(&image);
}

static void test_other_formats(void **state) {
  Scratch *scratch = *state;
  StyImage *image = make_noise(12, 9, 3, RGBA, 16);
  write_out(path_in(scratch, "a.png"), image);
  if (system("oiiotool --help >/dev/null 2>&1")) {
    unlink(scratch->path);
    sty_destroy_image(&image);
    skip();
  }
  run_oiiotool(scratch,
               "a.png -d uint16 -o a.tif a.png -d uint8 -o a.tga a.png -d uint8 -o a.jpg a.png -d float -o a.hdr");
  unlink(scratch->path);
  StyImage *back = read_back(path_in(scratch, "a.tif"));
  assert_int_equal(back->bits, 16);
  assert_true(same_pixels(image, back, 1));
  sty_destroy_image(&back);
  unlink(scratch->path);
  back = read_back(path_in(scratch, "a.tga"));
  assert_int_equal(back->bits, 8);
  for (int i = 0; i < 108 * 3; i++) {
    assert_true(fabsf(back->data[i] - image->data[i]) < 0.51f / 255);
    assert_true(back->data[i] == roundf(back->data[i] * 255) / 255);
  }
  sty_destroy_image(&back);
  unlink(scratch->path);
  static const char *const lossy[] = {"a.jpg", "a.hdr"};
  for (int f = 0; f < 2; f++) {
    back = read_back(path_in(scratch, lossy[f]));
    assert_int_equal(back->width, 12);
    assert_int_equal(back->height, 9);
    assert_int_equal(back->channel_count, 3);
    assert_int_equal(back->bits, f ? 32 : 8);
    sty_destroy_image(&back);
    unlink(scratch->path);
  }
  sty_destroy_image(&image);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      scratch_test(test_png_round_trips),
      scratch_test(test_every_integer),
      scratch_test(test_unassociated_alpha),
      scratch_test(test_clamping),
      scratch_test(test_exr_round_trip),
      scratch_test(test_exr_with_many_channels),
      scratch_test(test_png_attributes),
      scratch_test(test_same_bytes_later),
      scratch_test(test_truncated),
      scratch_test(test_flipped_bytes),
      scratch_test(test_absurd_png),
      scratch_test(test_absurd_exr),
      scratch_test(test_absurd_lengths),
      scratch_test(test_names_and_signatures),
      scratch_test(test_not_a_picture),
      scratch_test(test_unreadable_places),
      scratch_test(test_unwritable_pictures),
      scratch_test(test_multi_part_exr),
      scratch_test(test_only_part_keeps_its_names),
      scratch_test(test_data_window),
      scratch_test(test_other_formats),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
