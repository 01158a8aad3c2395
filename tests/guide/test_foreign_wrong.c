/* Foreign files that are refused, or warned of. */
#include "foreign_files.h"

/* ---- what is refused, and what is warned of ------------------------------------ */

static StyImage *make_of(int program, const StyImage *guide) {
  switch (program) {
    case BLENDER: return make_blender(guide);
    case ARNOLD: return make_arnold(guide, false);
    case PBRT: return make_pbrt(guide, false);
    case HOUDINI: return make_houdini(guide, 1, "Pz");
    default: return make_unity(guide, true, 32);
  }
}

static void expect_refusal(const StyForeignOptions *options, StyImage **image, StyStatus status,
                           const char *const *parts) {
  const StyImage *before = *image;
  StyError error = {STY_OK, ""};
  expect_message(sty_import_foreign("some.exr", options, image, &notes, &error), status, &error, parts);
  assert_ptr_equal(*image, before);
}

static void test_wrong_program(void **state) {
  (void)state;
  StyImage *guide = trace_original();
  for (int of_program = BLENDER; of_program <= UNITY; of_program++)
    for (int as = BLENDER; as <= PNG; as++) {
      if (as == of_program) continue;
      StyImage *file = make_of(of_program, guide);
      const StyForeignOptions options = {.program = as, .camera = &ours};
      char count[32];
      snprintf(count, sizeof count, "%d channels", file->channel_count);
      const bool by_mark = (as == ARNOLD && of_program == PBRT) || (as == HOUDINI && of_program == PBRT) ||
                           (as == ARNOLD && of_program == HOUDINI) || (as == HOUDINI && of_program == ARNOLD) ||
                           (as == UNITY && of_program != BLENDER && of_program != HOUDINI);
      expect_refusal(&options, &file, STY_ERROR_INPUT,
                     PARTS("some.exr", "expected", by_mark ? sty_guide_programs[of_program] : count,
                           by_mark ? sty_guide_programs[as] : file->names[0]));
      sty_destroy_image(&file);
    }
  sty_destroy_image(&guide);
}

static void test_world_needs_a_camera(void **state) {
  (void)state;
  StyImage *guide = trace_original();
  static const int programs[] = {BLENDER, ARNOLD, UNITY};
  for (int p = 0; p < 3; p++) {
    StyImage *file = make_of(programs[p], guide);
    expect_refusal(&(StyForeignOptions){.program = programs[p]}, &file, STY_ERROR_USAGE, PARTS("--camera", "some.exr"));
    sty_destroy_image(&file);
  }
  StyImage *file = make_of(PBRT, guide);
  const StyForeignOptions options = {.program = PBRT, .space = STY_SPACE_WORLD};
  expect_refusal(&options, &file, STY_ERROR_USAGE, PARTS("--camera"));
  StyStand nowhere = ours;
  memcpy(nowhere.target, nowhere.position, sizeof nowhere.target);
  expect_refusal(&(StyForeignOptions){.program = PBRT, .camera = &nowhere}, &file, STY_ERROR_INPUT, PARTS("camera"));
  sty_destroy_image(&file);
  sty_destroy_image(&guide);
}

static int find_pixel(const StyImage *guide, bool covered) {
  for (int i = PIXELS / 2; i < PIXELS; i++)
    if ((at(guide, "A", i) > 0) == covered) return i;
  fail_msg("no such pixel");
  return 0;
}

/* Every channel that is taken: not finite where covered is refused with its pixel, elsewhere it is nothing. */
static void test_values_that_are_not_finite(void **state) {
  (void)state;
  StyImage *guide = trace_original();
  const StyStand camera = move_camera(Z_UP);
  const StyForeignOptions options = {.program = BLENDER, .camera = &camera};
  const int inside = find_pixel(guide, true), outside = find_pixel(guide, false);
  char place[32];
  snprintf(place, sizeof place, "(%d, %d)", inside % WIDTH, inside / WIDTH);
  StyImage *file = make_blender(guide);
  for (int c = 0; c < file->channel_count; c++) {
    const bool taken = !strstr(file->names[c], "Mist") && !strstr(file->names[c], "UV.A") &&
                       !strstr(file->names[c], "Vector.W") && !strstr(file->names[c], "Vector.Z");
    float *value = file->data + (size_t)c * PIXELS + inside;
    const float before = *value;
    *value = c % 2 && !strstr(file->names[c], "Depth") ? -INFINITY : NAN;
    if (strstr(file->names[c], "Combined.A")) *value = NAN;
    if (taken) expect_refusal(&options, &file, STY_ERROR_INPUT, PARTS("some.exr", file->names[c], place, "finite"));
    *value = before;
    if (!strstr(file->names[c], "Normal")) file->data[(size_t)c * PIXELS + (size_t)outside] = NAN;
  }
  import_with(BLENDER, STY_SPACE_USUAL, &camera, &file);
  expect_covered(file, guide);
  expect_normals(file, guide, 1e-5);
  sty_destroy_image(&file);
  sty_destroy_image(&guide);
}

/* What no command takes isn't taken here, either. */
static void test_values_that_are_huge(void **state) {
  (void)state;
  StyImage *guide = trace_original(), *file = make_houdini(guide, 1, "Pz");
  const int inside = find_pixel(guide, true);
  const StyForeignOptions options = {.program = HOUDINI, .camera = &ours};
  sty_find_channel(file, "N.Y")[inside] = -1001;
  expect_refusal(&options, &file, STY_ERROR_INPUT, PARTS("N.Y = -1001", "within 1000"));
  sty_find_channel(file, "N.Y")[inside] = 0;
  sty_find_channel(file, "P.X")[inside] = 2e30f;
  expect_refusal(&options, &file, STY_ERROR_INPUT, PARTS("P.X = 2e+30", "within 1e+30"));
  sty_destroy_image(&file);
  sty_destroy_image(&guide);
}

static void test_lengths(void **state) {
  (void)state;
  StyImage *guide = trace_original();
  for (int way = 0; way < 2; way++) {
    const double factor = way ? 0.8 : 1.05;
    StyImage *image = make_houdini(guide, 1, "Pz");
    for (size_t i = 0; i < (size_t)3 * PIXELS; i++) image->data[(size_t)4 * PIXELS + i] *= (float)factor;
    import_with(HOUDINI, STY_SPACE_USUAL, NULL, &image);
    for (int i = 0; i < PIXELS; i++)
      for (int k = 0; k < 3; k++)
        assert_true(fabs(of(image, "normal", k, i) - of(guide, "normal", k, i) * (way ? factor : 1)) < 1e-6);
    if (way) expect_note(STY_NOTE_WARNING, "off length 1 in 100.00 %");
    assert_int_equal(count_notes(STY_NOTE_WARNING), way + 1); /* beside the position's */
    sty_destroy_image(&image);
  }
  sty_destroy_image(&guide);
}

static void test_guesses_are_warned_of(void **state) {
  (void)state;
  StyImage *guide = trace_original(), *image = make_arnold(guide, false);
  StyStand other = ours;
  other.position[0] = -other.position[0];
  import_with(ARNOLD, STY_SPACE_USUAL, &other, &image);
  expect_note(STY_NOTE_WARNING, "the camera sees");
  sty_destroy_image(&image);

  other = ours;
  for (int k = 0; k < 3; k++) other.position[k] = -other.position[k];
  image = make_arnold(guide, false);
  import_with(ARNOLD, STY_SPACE_USUAL, &other, &image);
  expect_note(STY_NOTE_WARNING, "facing away");
  sty_destroy_image(&image);

  image = make_blender(guide);
  const StyStand camera = move_camera(Z_UP);
  const int pixel = find_pixel(guide, true);
  put(image, "ViewLayer.IndexMA", "X", 0, pixel, 256);
  put(image, "ViewLayer.IndexOB", "X", 0, pixel, 1.5);
  import_with(BLENDER, STY_SPACE_USUAL, &camera, &image);
  expect_note(STY_NOTE_WARNING, "style.I left out: found ViewLayer.IndexMA.X = 256");
  expect_note(STY_NOTE_WARNING, "aren't whole at 1 pixels");
  assert_null(sty_find_channel(image, "style.I"));
  sty_destroy_image(&image);

  image = make_unity(guide, false, 8);
  import_with(UNITY, STY_SPACE_VIEW, &ours, &image);
  expect_note(STY_NOTE_WARNING, "nothing in the file needs it");
  sty_destroy_image(&image);
  sty_destroy_image(&guide);
}

/* All is of the render layer that the normals are of. */
static void test_render_layers(void **state) {
  (void)state;
  static const char *const names[] = {"a.Depth.Z",  "b.Normal.X", "b.Normal.Y", "b.Normal.Z", "b.Depth.Z", "c.Normal.X",
                                      "c.Normal.Y", "c.Normal.Z", "c.UV.U",     "c.UV.V",     NULL};
  StyImage *image = make_file(names, 32);
  for (int i = 0; i < PIXELS; i++)
    for (int c = 0; c < 10; c++) image->data[c * PIXELS + i] = c == 3 || c == 7 ? 1 : c == 0 ? 2 : c == 4 ? 3 : 0;
  import_with(BLENDER, STY_SPACE_VIEW, NULL, &image);
  assert_true(at(image, "depth.Z", 0) == 3);
  assert_null(sty_find_channel(image, "uv.U"));
  expect_note(STY_NOTE_WARNING, "2 render layers, took b.Normal.X");
  expect_note(STY_NOTE_LEFT_OUT, "c.UV.V");
  sty_destroy_image(&image);
}

/* 65504 is what 16-bit floats have for 1e10. */
static void test_misses(void **state) {
  (void)state;
  static const char *const names[] = {"N.X", "N.Y", "N.Z", "Z", NULL};
  static const float depths[] = {1e10f, 65504, INFINITY, 1e30f, 0, 3, 70000};
  StyImage *image = make_file(names, 32);
  for (int i = 0; i < 7; i++) {
    sty_find_channel(image, "N.Z")[i] = 1;
    sty_find_channel(image, "Z")[i] = depths[i];
  }
  import_with(ARNOLD, STY_SPACE_VIEW, NULL, &image);
  for (int i = 0; i < 7; i++) {
    assert_true(at(image, "A", i) == (i < 5 ? 0 : 1));
    assert_true(i < 5 ? isinf(at(image, "depth.Z", i)) : at(image, "depth.Z", i) == depths[i]);
    assert_true(at(image, "normal.Z", i) == (i < 5 ? 0 : 1));
  }
  sty_destroy_image(&image);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_wrong_program),
      cmocka_unit_test(test_world_needs_a_camera),
      cmocka_unit_test(test_values_that_are_not_finite),
      cmocka_unit_test(test_values_that_are_huge),
      cmocka_unit_test(test_lengths),
      cmocka_unit_test(test_guesses_are_warned_of),
      cmocka_unit_test(test_render_layers),
      cmocka_unit_test(test_misses),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
