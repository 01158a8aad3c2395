/* Every program's file comes back as the guide that it was made of. */
#include "foreign_files.h"

/* ---- one test a program -------------------------------------------------------- */

static void test_blender(void **state) {
  Scratch *scratch = *state;
  StyImage *guide = trace_original(), *file = make_blender(guide), *image = NULL;
  const StyStand camera = move_camera(Z_UP);
  /* By way of a file, whose channels are in another order. */
  assert_int_equal(sty_write_image(path_in(scratch, "blender.exr"), file, NULL), STY_OK);
  assert_int_equal(sty_read_image(scratch->path, &image, NULL), STY_OK);
  import_with(BLENDER, STY_SPACE_USUAL, &camera, &image);
  expect_covered(image, guide);
  expect_normals(image, guide, 1e-5);
  static const char *const exact[] = {"depth.Z", "object.I", "style.I", "albedo.R", "albedo.G", "albedo.B"};
  for (int c = 0; c < 6; c++) expect_channel(image, guide, exact[c], 0);
  for (int i = 0; i < PIXELS; i++) { /* positions stay in the file's world */
    double p[3];
    for (int k = 0; k < 3; k++) p[k] = of(guide, "position", k, i);
    change_world(Z_UP, p, p);
    for (int k = 0; k < 3; k++) assert_true(of(image, "position", k, i) == p[k]);
  }
  expect_constant(image, guide, "uv.U", 0.25);
  expect_constant(image, guide, "uv.V", 0.75);
  expect_constant(image, guide, "motion.U", 3);
  expect_constant(image, guide, "motion.V", -2);
  expect_constant(image, guide, "luma.Y", 0.1 * 0.2126 + 0.2 * 0.7152 + 0.3 * 0.0722);
  assert_int_equal(count_notes(STY_NOTE_WARNING), 0);
  assert_int_equal(count_notes(STY_NOTE_LEFT_OUT), 4);
  expect_note(STY_NOTE_LEFT_OUT, "ViewLayer.Mist.Z");
  expect_note(STY_NOTE_LEFT_OUT, "ViewLayer.Vector.W");
  expect_note(STY_NOTE_TAKEN, "normal.X .Y .Z from ViewLayer.Normal.X .Y .Z");
  sty_destroy_image(&image);
  sty_destroy_image(&file);
  sty_destroy_image(&guide);
}

static void test_arnold(void **state) {
  (void)state;
  StyImage *guide = trace_original();
  for (int along_ray = 0; along_ray < 2; along_ray++) {
    StyImage *image = make_arnold(guide, along_ray);
    import_with(ARNOLD, STY_SPACE_USUAL, &ours, &image);
    expect_normals(image, guide, 1e-5);
    expect_channel(image, guide, "depth.Z", along_ray ? 1e-5 : 0);
    expect_channel(image, guide, "position.X", 0);
    expect_channel(image, guide, "object.I", 0);
    expect_constant(image, guide, "A", 0.5);
    expect_constant(image, guide, "luma.Y", 2 * (0.1 * 0.2126 + 0.2 * 0.7152 + 0.3 * 0.0722));
    expect_note(STY_NOTE_ASSUMED, along_ray ? "along the ray" : "along the view axis");
    assert_int_equal(count_notes(STY_NOTE_WARNING), 0);
    sty_destroy_image(&image);
  }
  /* Without P, what Z is can't be told. */
  StyImage *image = make_arnold(guide, false);
  for (int k = 0; k < 3; k++) image->names[7 + k][0] = 'Q';
  import_with(ARNOLD, STY_SPACE_USUAL, &ours, &image);
  expect_note(STY_NOTE_WARNING, "Z is taken for the distance along the view axis");
  expect_note(STY_NOTE_LEFT_OUT, "Q.X");
  sty_destroy_image(&image);
  sty_destroy_image(&guide);
}

static void test_pbrt(void **state) {
  (void)state;
  StyImage *guide = trace_original();
  const StyStand left = move_camera(LEFT_HANDED);
  for (int world = 0; world < 2; world++) {
    StyImage *image = make_pbrt(guide, world);
    import_with(PBRT, world ? STY_SPACE_WORLD : STY_SPACE_USUAL, &left, &image);
    expect_covered(image, guide);
    expect_normals(image, guide, 1e-5);
    expect_channel(image, guide, "depth.Z", 2e-6);
    expect_constant(image, guide, "uv.V", 0.75);
    expect_channel(image, guide, "position.Y", 2e-6);
    for (int i = 0; i < PIXELS; i++)
      assert_true(fabs((double)at(image, "position.Z", i) + (double)at(guide, "position.Z", i)) < 2e-6);
    assert_int_equal(count_notes(STY_NOTE_WARNING), 0);
    expect_note(STY_NOTE_LEFT_OUT, "N.X");
    sty_destroy_image(&image);
  }
  /* Camera space needs a camera for positions alone. */
  StyImage *image = make_pbrt(guide, false);
  import_with(PBRT, STY_SPACE_USUAL, NULL, &image);
  expect_normals(image, guide, 1e-7);
  expect_channel(image, guide, "depth.Z", 0);
  assert_null(sty_find_channel(image, "position.X"));
  expect_note(STY_NOTE_WARNING, "position left out");
  sty_destroy_image(&image);
  sty_destroy_image(&guide);
}

static void test_houdini(void **state) {
  (void)state;
  StyImage *guide = trace_original();
  for (int toward = -1; toward <= 1; toward += 2)
    for (int by_distance = 0; by_distance < 2; by_distance++) {
      StyImage *image = make_houdini(guide, toward, by_distance ? "hitdist" : "Pz");
      import_with(HOUDINI, STY_SPACE_USUAL, &ours, &image);
      expect_covered(image, guide);
      expect_normals(image, guide, 1e-7);
      expect_channel(image, guide, "depth.Z", by_distance ? 2e-6 : 0);
      expect_channel(image, guide, "position.X", 2e-6);
      expect_channel(image, guide, "position.Z", 2e-6);
      expect_note(STY_NOTE_ASSUMED, toward > 0 ? "Z toward the viewer, as" : "Z away from the viewer, as");
      assert_int_equal(count_notes(STY_NOTE_WARNING), 0);
      sty_destroy_image(&image);
    }
  /* Camera space's positions need the camera; what isn't used is left out. */
  StyImage *image = make_houdini(guide, 1, "Pz");
  import_with(HOUDINI, STY_SPACE_USUAL, NULL, &image);
  expect_note(STY_NOTE_WARNING, "position left out");
  expect_note(STY_NOTE_LEFT_OUT, "P.Y");
  sty_destroy_image(&image);
  /* Without a camera positions tell the depth, and without them nothing does. */
  image = make_houdini(guide, 1, "hitdist");
  import_with(HOUDINI, STY_SPACE_USUAL, NULL, &image);
  expect_channel(image, guide, "depth.Z", 0);
  sty_destroy_image(&image);
  image = make_houdini(guide, 1, "hitdist");
  for (int k = 0; k < 3; k++) image->names[8 + k][0] = 'Q';
  import_with(HOUDINI, STY_SPACE_USUAL, NULL, &image);
  assert_null(sty_find_channel(image, "depth.Z"));
  expect_note(STY_NOTE_WARNING, "depth.Z left out: hitdist");
  sty_destroy_image(&image);
  sty_destroy_image(&guide);
}

static void test_unity(void **state) {
  (void)state;
  StyImage *guide = trace_original();
  const StyStand left = move_camera(LEFT_HANDED);
  static const struct {
    int bits;
    double tolerance;
  } cases[] = {{8, 0.008}, {16, 3.1e-5}, {32, 1e-5}};
  for (int c = 0; c < 3; c++)
    for (int world = 0; world < 2; world++) {
      StyImage *image = make_unity(guide, world, cases[c].bits);
      import_with(UNITY, world ? STY_SPACE_USUAL : STY_SPACE_VIEW, world ? &left : NULL, &image);
      expect_covered(image, guide);
      expect_normals(image, guide, cases[c].tolerance);
      assert_int_equal(image->bits, world ? 32 : cases[c].bits);
      assert_int_equal(count_notes(STY_NOTE_WARNING), 0);
      sty_destroy_image(&image);
    }
  sty_destroy_image(&guide);
}

/* ---- pictures, as every command reads them ------------------------------------- */

static StyImage *make_noise(int bits, bool alpha) {
  static const char *const with[] = {"R", "G", "B", "A", NULL}, *const without[] = {"R", "G", "B", NULL};
  StyImage *file = make_file(alpha ? with : without, bits);
  uint64_t random = (uint64_t)bits;
  const int top = bits == 8 ? 255 : 65535;
  for (int i = 0; i < PIXELS * file->channel_count; i++)
    file->data[i] = i % 3 ? (float)draw_below(&random, top + 1) / (float)top : 0;
  return file;
}

static void expect_same(const StyImage *a, const StyImage *b) {
  assert_int_equal(a->channel_count, b->channel_count);
  assert_int_equal(a->bits, b->bits);
  for (int c = 0; c < a->channel_count; c++) assert_string_equal(a->names[c], b->names[c]);
  assert_memory_equal(a->data, b->data, (size_t)a->channel_count * PIXELS * sizeof(float));
}

static void test_png_is_what_the_reader_reads(void **state) {
  (void)state;
  for (int c = 0; c < 4; c++) {
    StyImage *read = make_noise(c % 2 ? 8 : 16, c / 2), *image = make_noise(c % 2 ? 8 : 16, c / 2),
             *flipped = make_noise(c % 2 ? 8 : 16, c / 2);
    const StyForeignOptions flip = {.program = PNG, .flip_y = true};
    assert_int_equal(sty_import_guide("some.png", &read, NULL), STY_OK);
    import_with(PNG, STY_SPACE_USUAL, NULL, &image);
    expect_same(image, read);
    assert_int_equal(sty_import_foreign("some.png", &flip, &flipped, &notes, NULL), STY_OK);
    for (int i = 0; i < PIXELS; i++) {
      assert_true(at(flipped, "normal.Y", i) == -at(read, "normal.Y", i));
      assert_true(at(flipped, "normal.X", i) == at(read, "normal.X", i));
    }
    sty_destroy_image(&read);
    sty_destroy_image(&image);
    sty_destroy_image(&flipped);
  }
}

/* Our own pictures come back as the reader has them, of whichever program they are said to be. */
static void test_exported_guides_come_back(void **state) {
  (void)state;
  StyImage *guide = trace_original();
  for (int bits = 8; bits <= 16; bits += 8)
    for (int program = UNITY; program <= PNG; program++) {
      StyImage *read = NULL, *image = NULL;
      assert_int_equal(sty_encode_normals(guide, bits, &read, NULL), STY_OK);
      assert_int_equal(sty_encode_normals(guide, bits, &image, NULL), STY_OK);
      assert_int_equal(sty_import_guide("some.png", &read, NULL), STY_OK);
      import_with(program, STY_SPACE_VIEW, NULL, &image);
      expect_same(image, read);
      sty_destroy_image(&read);
      sty_destroy_image(&image);
    }
  sty_destroy_image(&guide);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      scratch_test(test_blender),
      cmocka_unit_test(test_arnold),
      cmocka_unit_test(test_pbrt),
      cmocka_unit_test(test_houdini),
      cmocka_unit_test(test_unity),
      cmocka_unit_test(test_png_is_what_the_reader_reads),
      cmocka_unit_test(test_exported_guides_come_back),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
