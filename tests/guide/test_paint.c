/* Textures: which pictures can be one, which channels are looked at, and look-ups that fail. */
#include <math.h>

#include "guide/paint.h"

#include "../scratch.h"
#include "bridge/texture.h"
#include "stylut/image_io.h"

enum { SIDE = 2, MOST_CHANNELS = 8 };

/* A picture of these channels, the values of each its number; one value of the last channel is another. */
static const char *write_picture(Scratch *scratch, const char *name, int count, const char *const *channels,
                                 float odd) {
  StyImage *image = NULL;
  assert_int_equal(sty_create_image(SIDE, SIDE, count, channels, 32, &image, NULL), STY_OK);
  for (int c = 0; c < count; c++)
    for (int i = 0; i < SIDE * SIDE; i++) image->data[c * SIDE * SIDE + i] = (float)c;
  image->data[count * SIDE * SIDE - 2] = odd; /* pixel (0, 1) */
  assert_int_equal(sty_write_image(path_in(scratch, name), image, NULL), STY_OK);
  sty_destroy_image(&image);
  return scratch->path;
}

static void test_channels(void **state) {
  static const struct {
    int count;
    const char *channels[MOST_CHANNELS];
    float colour[3]; /* negative: refused */
  } cases[] = {{3, {"R", "G", "B"}, {0, 1, 2}},
               {4, {"A", "B", "G", "R"}, {3, 2, 1}},
               {7, {"A", "depth.Z", "B", "G", "normal.X", "R", "uv.U"}, {5, 3, 2}},
               {1, {"Y"}, {0, 0, 0}},
               {2, {"A", "Y"}, {1, 1, 1}},
               {3, {"A", "normal.X", "Y"}, {2, 2, 2}},
               {2, {"A", "grey"}, {1, 1, 1}},
               {5, {"A", "depth.Z", "normal.X", "normal.Y", "normal.Z"}, {-1, 0, 0}},
               {3, {"albedo.R", "albedo.G", "albedo.B"}, {-1, 0, 0}},
               {1, {"luma.Y"}, {-1, 0, 0}},
               {2, {"R", "G"}, {-1, 0, 0}}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    StyTextureMap *texture = NULL;
    StyError error = {STY_OK, ""};
    const int last = cases[i].count - 1;
    const char *path = write_picture(*state, "picture.exr", cases[i].count, cases[i].channels, (float)last);
    const StyStatus status = sty_open_texture_map(path, &texture, &error);
    unlink(path);
    if (cases[i].colour[0] < 0) {
      assert_int_equal(status, STY_ERROR_INPUT);
      assert_non_null(strstr(error.text, "picture.exr: found the channels "));
      assert_non_null(strstr(error.text, cases[i].channels[last]));
      assert_non_null(strstr(error.text, "expected R, G and B, or Y alone"));
      continue;
    }
    float colour[3];
    if (status) fail_msg("case %zu: %s", i, error.text);
    assert_true(sty_sample_texture_map(texture, (const double[2]){0.3, 0.3}, true, colour));
    assert_memory_equal(colour, cases[i].colour, sizeof colour);
    sty_close_texture_map(&texture);
  }
}

static void test_values(void **state) {
  static const char *const rgb[] = {"R", "G", "B"}, *const layers[] = {"R", "G", "B", "depth.Z"};
  const float bad[] = {NAN, INFINITY, -INFINITY, -0.5f, 2 * STY_MAX_TEXEL};
  const char *const named[] = {"nan", "inf", "-inf", "-0.5", "2e+06"};
  StyTextureMap *texture = NULL;
  for (int b = 0; b < 5; b++) {
    StyError error = {STY_OK, ""};
    char expected[80];
    snprintf(expected, sizeof expected, "found %s at pixel (0, 1), expected a colour from 0 to 1e+06", named[b]);
    const char *path = write_picture(*state, "picture.exr", 3, rgb, bad[b]);
    assert_int_equal(sty_open_texture_map(path, &texture, &error), STY_ERROR_INPUT);
    if (!strstr(error.text, expected)) fail_msg("'%s' lacks '%s'", error.text, expected);
    /* Of what isn't looked at, nothing is asked. */
    write_picture(*state, "picture.exr", 4, layers, bad[b]);
    assert_int_equal(sty_open_texture_map(path, &texture, &error), STY_OK);
    sty_close_texture_map(&texture);
    write_picture(*state, "picture.exr", 3, rgb, STY_MAX_TEXEL);
    assert_int_equal(sty_open_texture_map(path, &texture, &error), STY_OK);
    sty_close_texture_map(&texture);
    unlink(path);
  }
}

/* A texture of the same path is what the file holds when it is opened. */
static void test_opened_again(void **state) {
  static const char *const rgb[] = {"R", "G", "B"};
  for (int i = 0; i < 3; i++) {
    StyTextureMap *texture = NULL;
    float colour[3];
    const char *path = write_picture(*state, "picture.exr", 3, rgb, (float)i);
    assert_int_equal(sty_open_texture_map(path, &texture, NULL), STY_OK);
    assert_true(sty_sample_texture_map(texture, (const double[2]){0.25, 0.25}, true, colour));
    assert_true(colour[0] == 0 && colour[1] == 1 && colour[2] == (float)i);
    sty_close_texture_map(&texture);
    unlink(path);
  }
}

/* More textures than are kept open at a time, all of which go away while the palette is in use. */
static void test_lost(void **state) {
  enum { COUNT = 150 };
  static const char *const rgb[] = {"R", "G", "B"};
  Scratch *scratch = *state;
  StyScene *scene = NULL;
  StyPalette *palette = NULL;
  assert_int_equal(sty_create_scene(&scene, NULL), STY_OK);
  for (int t = 0; t < COUNT; t++) {
    char name[16];
    StySphere sphere = {.radius = 1, .material = sty_white};
    snprintf(name, sizeof name, "%d.exr", t);
    write_picture(scratch, name, 3, rgb, 1);
    assert_int_equal(sty_add_texture(scene, scratch->path, NULL, &sphere.material.paint.texture, NULL), STY_OK);
    assert_int_equal(sty_add_sphere(scene, &sphere, NULL), STY_OK);
  }
  assert_int_equal(sty_open_palette(scene, true, &palette, NULL), STY_OK);
  assert_int_equal(sty_check_palette(palette, NULL), STY_OK);
  for (int t = 0; t < COUNT; t++) unlink(scene->textures[t].path);
  for (int t = 0; t < COUNT; t++) {
    StyHits hits = {.paint[0] = &scene->spheres[t].material.paint};
    StyLane albedo[3];
    sty_get_albedo(palette, &hits, 0, albedo);
  }
  StyError error = {STY_OK, ""};
  assert_int_equal(sty_check_palette(palette, &error), STY_ERROR_LIBRARY);
  assert_non_null(strstr(error.text, ".exr: found no colour"));
  sty_close_palette(&palette);
  sty_destroy_scene(&scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_channels),
      cmocka_unit_test(test_values),
      cmocka_unit_test(test_opened_again),
      cmocka_unit_test(test_lost),
  };
  return cmocka_run_group_tests(tests, open_scratch, close_scratch);
}
