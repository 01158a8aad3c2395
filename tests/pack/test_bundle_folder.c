#include <math.h>

#include "../scratch.h"
#include "pack/seal.h"
#include "stylut/pack.h"

/* Small and not square, so that mixing up sides shows. */
enum {
  WIDTH = 4,
  HEIGHT = 3,
  PIXELS = WIDTH * HEIGHT,
  LUT_SIZE = 5,
  JITTER_BYTES = 2 * STY_JITTER_SIZE * STY_JITTER_SIZE
};
static const StyBundleShape SHAPE = {WIDTH, HEIGHT, LUT_SIZE, 1, 1, 1};

static const StyStyle PARAMETERS = {.threshold = 24,
                                    .top_level = 4,
                                    .radius = 1,
                                    .depth_tolerance = 0.5f,
                                    .layer_count = 1,
                                    .jitter_amount = 1,
                                    .scale = 1,
                                    .flags = STY_FLAG_UNORM8};

typedef struct Layers {
  uint8_t exemplar[4 * PIXELS], guide[4 * PIXELS];
  uint16_t lut[2 * LUT_SIZE * LUT_SIZE];
} Layers;

/* Everything covered; LUT texels somewhere inside. */
static Layers make_layers(uint64_t seed) {
  Layers layers;
  for (int i = 0; i < 4 * PIXELS; i++) {
    layers.exemplar[i] = (uint8_t)draw_below(&seed, 256);
    layers.guide[i] = i % 4 == 3 ? 255 : (uint8_t)draw_below(&seed, 256);
  }
  for (int i = 0; i < 2 * LUT_SIZE * LUT_SIZE; i++) layers.lut[i] = (uint16_t)draw_below(&seed, 65536);
  return layers;
}

static json_t *make_index(int styles) {
  json_t *list = json_array();
  for (int i = 0; i < styles; i++) {
    char name[32];
    snprintf(name, sizeof name, "style%d", i + 1);
    json_array_append_new(list, json_pack("{s:s}", "name", name));
  }
  return json_pack("{s:o}", "styles", list);
}

static StyBundleWriter *open_writer(const char *path, int width, int styles) {
  StyBundleShape shape = SHAPE;
  shape.width = width;
  shape.style_count = shape.exemplar_count = styles;
  StyBundleWriter *writer = NULL;
  StyError error = {STY_OK, ""};
  if (sty_open_bundle_writer(path, &shape, &writer, &error) != STY_OK) fail_msg("%s", error.text);
  assert_non_null(writer);
  return writer;
}

static void write_style(StyBundleWriter *writer, const Layers *layers, const StyStyle *parameters) {
  StyError error = {STY_OK, ""};
  if (sty_write_style(writer, &(const uint8_t *){layers->exemplar}, layers->guide, layers->lut, parameters, &error) !=
      STY_OK)
    fail_msg("%s", error.text);
}

static void write_bundle(const char *path, int styles, uint64_t seed) {
  static uint8_t jitter[JITTER_BYTES];
  StyBundleWriter *writer = open_writer(path, WIDTH, styles);
  for (int s = 0; s < styles; s++) {
    const Layers layers = make_layers(seed + (uint64_t)s);
    StyStyle parameters = PARAMETERS;
    parameters.threshold += s;
    write_style(writer, &layers, &parameters);
  }
  sty_make_jitter(seed, jitter);
  json_t *index = make_index(styles);
  StyError error = {STY_OK, ""};
  if (sty_commit_bundle(&writer, jitter, index, NULL, &error) != STY_OK) fail_msg("%s", error.text);
  assert_null(writer);
  json_decref(index);
}

typedef struct Report {
  int counts[16], warnings, total;
  StyFinding last;
} Report;

static void note(void *context, const StyFinding *finding) {
  Report *report = context;
  assert_in_range(finding->number, 1, 9);
  assert_true(finding->text[0] != 0);
  report->counts[finding->number]++;
  report->warnings += finding->warning;
  report->total++;
  report->last = *finding;
}

static void expect_sound(const char *path) {
  StyLoadedBundle bundle = {0};
  StyError error = {STY_OK, ""};
  Report report = {0};
  if (sty_load_bundle(path, note, &report, &bundle, &error) != STY_OK) fail_msg("%s", error.text);
  assert_int_equal(report.total, 0);
  sty_unload_bundle(&bundle);
}

/* The bundle at `path` has this finding; it is an error whose message names the bundle or the file. */
static void expect_finding(const char *path, StyFindingNumber number, const char *file) {
  StyLoadedBundle bundle = {0};
  StyError error = {STY_OK, ""};
  Report report = {0};
  const StyStatus status = sty_load_bundle(path, note, &report, &bundle, &error);
  const StyStatus expected = number == STY_FINDING_MISSING ? STY_ERROR_FILE : STY_ERROR_INPUT;
  expect_message(status, expected, &error, PARTS(file));
  if (!report.counts[number]) fail_msg("no finding %d, last is %d: %s", number, report.last.number, report.last.text);
  assert_true(report.total > report.warnings);
  assert_int_equal(sty_load_bundle(path, NULL, NULL, &bundle, NULL), expected);
  assert_null(bundle.index.root);
}

static void put_path(char path[1024], const char *folder, const char *name) {
  if (snprintf(path, 1024, "%s/%s", folder, name) >= 1024) fail_msg("%s is too long a name", folder);
}

static void write_file(const char *path, const void *bytes, size_t size) {
  FILE *file = fopen(path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(bytes, 1, size, file), size);
  assert_int_equal(fclose(file), 0);
}

/* ---- writing and loading ----------------------------------------------------------- */

static void test_round_trip(void **state) {
  Scratch *scratch = *state;
  static const int counts[] = {1, 2, 7};
  static uint8_t jitter[JITTER_BYTES];
  for (int c = 0; c < 3; c++) {
    const int styles = counts[c];
    const char *path = path_in(scratch, "bundle");
    write_bundle(path, styles, 5);
    assert_int_equal(count_entries(scratch->folder), 1);
    assert_int_equal(count_entries(path), STY_BUNDLE_FILES + 2);

    StyLoadedBundle loaded = {0};
    StyError error = {STY_OK, ""};
    Report report = {0};
    if (sty_load_bundle(path, note, &report, &loaded, &error) != STY_OK) fail_msg("%s", error.text);
    assert_int_equal(report.total, 0);
    const StyTexture *textures = loaded.bundle.textures;
    assert_int_equal(textures[STY_BUNDLE_EXEMPLARS].width, WIDTH);
    assert_int_equal(textures[STY_BUNDLE_EXEMPLARS].height, HEIGHT);
    assert_int_equal(textures[STY_BUNDLE_EXEMPLARS].layers, styles);
    assert_int_equal(textures[STY_BUNDLE_GUIDES].layers, styles);
    assert_int_equal(textures[STY_BUNDLE_LUTS].width, LUT_SIZE);
    assert_int_equal(textures[STY_BUNDLE_LUTS].layers, styles);
    assert_int_equal(textures[STY_BUNDLE_PARAMS].width, styles);
    assert_int_equal(textures[STY_BUNDLE_JITTER].layers, 1);
    for (int s = 0; s < styles; s++) {
      const Layers layers = make_layers(5 + (uint64_t)s);
      assert_memory_equal(textures[STY_BUNDLE_EXEMPLARS].texels + (size_t)s * 4 * PIXELS, layers.exemplar, 4 * PIXELS);
      assert_memory_equal(textures[STY_BUNDLE_GUIDES].texels + (size_t)s * 4 * PIXELS, layers.guide, 4 * PIXELS);
      const unsigned char *lut = textures[STY_BUNDLE_LUTS].texels + (size_t)s * sizeof layers.lut;
      for (int i = 0; i < 2 * LUT_SIZE * LUT_SIZE; i++)
        assert_int_equal(lut[2 * i] | lut[2 * i + 1] << 8, layers.lut[i]);
      StyStyle style;
      assert_int_equal(sty_get_style(&loaded.bundle, s + 1, &style), STY_RUNTIME_OK);
      assert_int_equal(style.threshold, 24 + s);
      assert_int_equal(style.top_level, 4);
      assert_int_equal(style.radius, 1);
      assert_true(style.depth_tolerance == 0.5f);
      assert_int_equal(style.layer, s);
      assert_int_equal(style.flags, STY_FLAG_UNORM8);
    }
    sty_make_jitter(5, jitter);
    assert_memory_equal(textures[STY_BUNDLE_JITTER].texels, jitter, JITTER_BYTES);

    const json_t *root = loaded.index.root;
    assert_string_equal(json_string_value(json_object_get(root, "schema")), STY_BUNDLE_SCHEMA);
    assert_non_null(json_string_value(json_object_get(root, "version")));
    assert_int_equal(json_array_size(json_object_get(root, "files")), STY_BUNDLE_FILES);

    int number = 0;
    char last[16];
    snprintf(last, sizeof last, "style%d", styles);
    assert_int_equal(sty_find_style("--style", last, &loaded, &number, NULL), STY_OK);
    assert_int_equal(number, styles);
    assert_int_equal(sty_find_style("--style", last + 5, &loaded, &number, NULL), STY_OK);
    assert_int_equal(number, styles);
    static const char *const bad[] = {"0", "8", "-1", "", "style", "style8", "Style1", "1x"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
      expect_message(sty_find_style("--style", bad[i], &loaded, &number, &error), STY_ERROR_USAGE, &error,
                     PARTS("--style", bad[i]));
      assert_int_equal(number, styles);
    }
    sty_unload_bundle(&loaded);
  }
}

static void test_same_bytes(void **state) {
  Scratch *scratch = *state;
  char first[1024], second[1024], one[1024], other[1024];
  put_path(first, scratch->folder, "first");
  put_path(second, scratch->folder, "second");
  write_bundle(first, 2, 9);
  write_bundle(second, 2, 9);
  for (int f = 0; f <= STY_BUNDLE_FILES; f++) {
    const char *name = f < STY_BUNDLE_FILES ? sty_bundle_files[f] : STY_BUNDLE_INDEX;
    size_t size, size_again;
    put_path(one, first, name);
    put_path(other, second, name);
    unsigned char *bytes = read_bytes(one, &size), *again = read_bytes(other, &size_again);
    assert_int_equal(size, size_again);
    assert_memory_equal(bytes, again, size);
    free(bytes);
    free(again);
  }
}

static void test_replace(void **state) {
  Scratch *scratch = *state;
  const char *path = path_in(scratch, "bundle");
  write_bundle(path, 2, 1);
  write_bundle(path, 3, 2);
  assert_int_equal(count_entries(scratch->folder), 1);
  StyLoadedBundle loaded = {0};
  assert_int_equal(sty_load_bundle(path, NULL, NULL, &loaded, NULL), STY_OK);
  assert_int_equal(loaded.bundle.textures[STY_BUNDLE_PARAMS].width, 3);
  sty_unload_bundle(&loaded);
  /* A trailing slash names the same folder. */
  char slash[1024];
  snprintf(slash, sizeof slash, "%s/", path);
  write_bundle(slash, 1, 3);
  assert_int_equal(count_entries(scratch->folder), 1);
  expect_sound(path);
  /* An empty folder holds nothing to keep. */
  remove_folder(path);
  assert_int_equal(mkdir(path, 0755), 0);
  write_bundle(path, 1, 3);
  expect_sound(path);
}

/* While a new bundle is in the making the old one stays as it is. */
static void test_discard(void **state) {
  Scratch *scratch = *state;
  const char *path = path_in(scratch, "bundle");
  const Layers layers = make_layers(1);
  StyBundleWriter *writer = open_writer(path, WIDTH, 2);
  assert_int_equal(count_entries(path), -1);
  write_style(writer, &layers, &PARAMETERS);
  sty_discard_bundle(&writer);
  assert_null(writer);
  assert_int_equal(count_entries(scratch->folder), 0);
  sty_discard_bundle(&writer);

  write_bundle(path, 1, 1);
  writer = open_writer(path, WIDTH, 1);
  write_style(writer, &layers, &PARAMETERS);
  expect_sound(path);
  sty_discard_bundle(&writer);
  expect_sound(path);
  assert_int_equal(count_entries(scratch->folder), 1);
}

static void test_refused_places(void **state) {
  Scratch *scratch = *state;
  StyBundleWriter *writer = NULL;
  StyError error = {STY_OK, ""};
  /* A folder with somebody's letter. */
  const char *path = path_in(scratch, "bundle");
  char letter[1024];
  put_path(letter, path, "letter.txt");
  assert_int_equal(mkdir(path, 0755), 0);
  write_file(letter, "dear", 4);
  expect_message(sty_open_bundle_writer(path, &SHAPE, &writer, &error), STY_ERROR_FILE, &error, PARTS("bundle"));
  assert_null(writer);
  assert_int_equal(access(letter, F_OK), 0);
  assert_int_equal(count_entries(scratch->folder), 1);
  remove_folder(path);
  /* One beside a bundle comes along, whatever becomes of the bundle. */
  write_bundle(path, 1, 1);
  write_file(letter, "dear", 4);
  write_bundle(path, 1, 1);
  assert_int_equal(access(letter, F_OK), 0);
  assert_int_equal(count_entries(scratch->folder), 1);
  remove_folder(path);
  write_file(path_in(scratch, "plain"), "x", 1);
  expect_message(sty_open_bundle_writer(scratch->path, &SHAPE, &writer, &error), STY_ERROR_FILE, &error,
                 PARTS("plain"));
  expect_message(sty_open_bundle_writer(path_in(scratch, "plain/bundle"), &SHAPE, &writer, &error), STY_ERROR_FILE,
                 &error, PARTS("plain"));
  expect_message(sty_open_bundle_writer(path_in(scratch, "missing/bundle"), &SHAPE, &writer, &error), STY_ERROR_FILE,
                 &error, PARTS("missing"));
  assert_null(writer);
  assert_int_equal(count_entries(scratch->folder), 1);
}

/* A letter that arrives after the writer has begun may hinder the bundle, but isn't lost. */
static void test_letter_arrives_late(void **state) {
  Scratch *scratch = *state;
  static uint8_t jitter[JITTER_BYTES];
  const char *path = path_in(scratch, "bundle");
  char letter[1024];
  const Layers layers = make_layers(1);
  write_bundle(path, 1, 1);
  StyBundleWriter *writer = open_writer(path, WIDTH, 1);
  write_style(writer, &layers, &PARAMETERS);
  put_path(letter, path, "letter.txt");
  write_file(letter, "dear", 4);
  json_t *index = make_index(1);
  (void)sty_commit_bundle(&writer, jitter, index, NULL, NULL);
  assert_null(writer);
  json_decref(index);
  int letters = 0;
  DIR *folder = opendir(scratch->folder);
  assert_non_null(folder);
  for (const struct dirent *entry; (entry = readdir(folder)) != NULL;) {
    char place[1280];
    snprintf(place, sizeof place, "%s/%.255s/letter.txt", scratch->folder, entry->d_name);
    letters += access(place, F_OK) == 0;
  }
  closedir(folder);
  assert_int_equal(letters, 1);
}

/* Two styles were announced and one came: no bundle, and nothing of it left. */
static void test_missing_style(void **state) {
  Scratch *scratch = *state;
  static uint8_t jitter[JITTER_BYTES];
  const Layers layers = make_layers(1);
  StyBundleWriter *writer = open_writer(path_in(scratch, "bundle"), WIDTH, 2);
  write_style(writer, &layers, &PARAMETERS);
  json_t *index = make_index(2);
  StyError error = {STY_OK, ""};
  assert_int_not_equal(sty_commit_bundle(&writer, jitter, index, NULL, &error), STY_OK);
  assert_null(writer);
  json_decref(index);
  assert_int_equal(count_entries(scratch->folder), 0);
}

/* The writer reads what it wrote as a reader would, before it lets go. */
static void test_bad_parameters_are_not_written(void **state) {
  Scratch *scratch = *state;
  static uint8_t jitter[JITTER_BYTES];
  const Layers layers = make_layers(1);
  StyStyle bad[4] = {PARAMETERS, PARAMETERS, PARAMETERS, PARAMETERS};
  bad[0].threshold = STY_MAX_THRESHOLD + 1;
  bad[1].top_level = -1;
  bad[2].radius = STY_MAX_RADIUS + 1;
  bad[3].depth_tolerance = NAN;
  for (int i = 0; i < 4; i++) {
    StyBundleWriter *writer = open_writer(path_in(scratch, "bundle"), WIDTH, 1);
    StyError error = {STY_OK, ""};
    StyStatus status =
        sty_write_style(writer, &(const uint8_t *){layers.exemplar}, layers.guide, layers.lut, &bad[i], &error);
    if (status == STY_OK) {
      json_t *index = make_index(1);
      status = sty_commit_bundle(&writer, jitter, index, NULL, &error);
      json_decref(index);
    }
    assert_int_not_equal(status, STY_OK);
    sty_discard_bundle(&writer);
    assert_int_equal(count_entries(scratch->folder), 0);
  }
}

/* ---- findings ---------------------------------------------------------------------- */

static void test_unreadable(void **state) {
  Scratch *scratch = *state;
  StyLoadedBundle loaded = {0};
  StyError error = {STY_OK, ""};
  expect_message(sty_load_bundle(path_in(scratch, "missing"), NULL, NULL, &loaded, &error), STY_ERROR_FILE, &error,
                 PARTS("missing"));
  write_file(path_in(scratch, "plain"), "x", 1);
  expect_message(sty_load_bundle(scratch->path, NULL, NULL, &loaded, &error), STY_ERROR_FILE, &error, PARTS("plain"));
}

static void test_finding_index(void **state) {
  Scratch *scratch = *state;
  const char *path = path_in(scratch, "bundle");
  char index[1024];
  static const char *const texts[] = {"",
                                      "{",
                                      "[]",
                                      "{}",
                                      "{\"schema\": \"stylut-bundle-index/2\"}",
                                      "{\"schema\": \"" STY_BUNDLE_SCHEMA "\"}",
                                      "{\"schema\": \"" STY_BUNDLE_SCHEMA "\", \"files\": 5, \"styles\": []}",
                                      "{\"schema\": \"" STY_BUNDLE_SCHEMA "\", \"files\": [5], \"styles\": [5]}"};
  write_bundle(path, 1, 1);
  put_path(index, path, STY_BUNDLE_INDEX);
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
    write_file(index, texts[i], strlen(texts[i]));
    expect_finding(path, STY_FINDING_INDEX, STY_BUNDLE_INDEX);
  }
  unlink(index);
  expect_finding(path, STY_FINDING_MISSING, STY_BUNDLE_INDEX);
}

static void test_findings_of_each_file(void **state) {
  Scratch *scratch = *state;
  const char *path = path_in(scratch, "bundle");
  char file[1024];
  write_bundle(path, 2, 1);
  for (int f = 0; f < STY_BUNDLE_FILES; f++) {
    size_t size;
    put_path(file, path, sty_bundle_files[f]);
    unsigned char *bytes = read_bytes(file, &size);
    unlink(file);
    expect_finding(path, STY_FINDING_MISSING, sty_bundle_files[f]);
    assert_int_equal(mkdir(file, 0755), 0);
    expect_finding(path, STY_FINDING_MISSING, sty_bundle_files[f]);
    rmdir(file);
    for (size_t length = 0; length < size; length += 1 + size / 7) {
      write_file(file, bytes, length);
      expect_finding(path, STY_FINDING_SIZE, sty_bundle_files[f]);
    }
    write_file(file, bytes, size - 1);
    expect_finding(path, STY_FINDING_SIZE, sty_bundle_files[f]);
    bytes[size] = 'x'; /* room for it is there */
    write_file(file, bytes, size + 1);
    expect_finding(path, STY_FINDING_SIZE, sty_bundle_files[f]);
    write_file(file, bytes, size);
    free(bytes);
  }
  expect_sound(path);
}

/* One byte changed anywhere in any texture is found; the jitter table, large and plain, at some places. */
static void test_every_byte(void **state) {
  Scratch *scratch = *state;
  const char *path = path_in(scratch, "bundle");
  char name[1024];
  uint64_t random = 1;
  write_bundle(path, 1, 1);
  for (int f = 0; f < STY_BUNDLE_FILES; f++) {
    size_t size;
    put_path(name, path, sty_bundle_files[f]);
    unsigned char *bytes = read_bytes(name, &size);
    FILE *file = fopen(name, "r+b");
    assert_non_null(file);
    setbuf(file, NULL);
    const size_t step = size > 2000 ? CASES(617, 6007) : CASES(1, 7);
    for (size_t at = 0; at < size; at += step) {
      const int wrong = bytes[at] ^ (1 + draw_below(&random, 255));
      fseek(file, (long)at, SEEK_SET);
      fputc(wrong, file);
      StyLoadedBundle loaded = {0};
      Report report = {0};
      if (sty_load_bundle(path, note, &report, &loaded, NULL) != STY_ERROR_INPUT)
        fail_msg("byte %zu of %s may change", at, sty_bundle_files[f]);
      assert_true(report.counts[STY_FINDING_HASH] == 1);
      fseek(file, (long)at, SEEK_SET);
      fputc(bytes[at], file);
    }
    fclose(file);
    free(bytes);
  }
  expect_sound(path);
}

/* The index isn't hashed: a changed byte is found or harmless, and never more than that. */
static void test_every_byte_of_the_index(void **state) {
  Scratch *scratch = *state;
  const char *path = path_in(scratch, "bundle");
  char name[1024];
  size_t size, refused = 0, tried = 0;
  uint64_t random = 2;
  write_bundle(path, 2, 1);
  put_path(name, path, STY_BUNDLE_INDEX);
  unsigned char *bytes = read_bytes(name, &size);
  for (size_t at = 0; at < size; at += CASES(1, 5), tried++) {
    const unsigned char before = bytes[at];
    bytes[at] ^= (unsigned char)(1 + draw_below(&random, 255));
    write_file(name, bytes, size);
    bytes[at] = before;
    StyLoadedBundle loaded = {0};
    StyError error = {STY_OK, ""};
    const StyStatus status = sty_load_bundle(path, NULL, NULL, &loaded, &error);
    if (status == STY_OK) {
      sty_unload_bundle(&loaded);
    } else {
      expect_message(status, STY_ERROR_INPUT, &error, PARTS(""));
      refused++;
    }
  }
  assert_true(refused > tried / 2);
  free(bytes);
}

static void seal(json_t *root) {
  char hash[STY_HASH_SIZE];
  assert_int_equal(sty_seal_index(root, hash, NULL), STY_OK);
  json_object_set_new(root, STY_SEAL_KEY, json_string(hash));
}

/* Makes the index say what the file on disk now is. */
static void index_anew(const char *path, int f) {
  char name[1024], hash[STY_HASH_SIZE];
  uint64_t size;
  put_path(name, path, sty_bundle_files[f]);
  assert_int_equal(sty_hash_file(name, hash, NULL), STY_OK);
  assert_int_equal(sty_check_file(name, &size, NULL), STY_OK);
  put_path(name, path, STY_BUNDLE_INDEX);
  json_t *root = json_load_file(name, 0, NULL);
  assert_non_null(root);
  json_t *files = json_object_get(root, "files"), *entry;
  size_t i;
  int found = 0;
  json_array_foreach(files, i, entry) {
    if (strcmp(json_string_value(json_object_get(entry, "name")), sty_bundle_files[f]) != 0) continue;
    json_object_set_new(entry, "bytes", json_integer((json_int_t)size));
    json_object_set_new(entry, "sha256", json_string(hash));
    found++;
  }
  assert_int_equal(found, 1);
  seal(root);
  assert_int_equal(json_dump_file(root, name, JSON_INDENT(1)), 0);
  json_decref(root);
}

static void test_finding_texture(void **state) {
  Scratch *scratch = *state;
  const char *path = path_in(scratch, "bundle");
  char file[1024];
  for (int f = 0; f < STY_BUNDLE_FILES; f++) {
    for (int kind = 0; kind < 4; kind++) {
      size_t size;
      write_bundle(path, 1, 1);
      put_path(file, path, sty_bundle_files[f]);
      unsigned char *bytes = read_bytes(file, &size);
      if (kind == 0) bytes[1] = 'X';  /* identifier */
      if (kind == 1) bytes[12] ^= 64; /* vkFormat */
      if (kind == 2) bytes[40]++;     /* levelCount */
      if (kind == 3) size -= 1;
      write_file(file, bytes, size);
      free(bytes);
      index_anew(path, f);
      expect_finding(path, STY_FINDING_TEXTURE, sty_bundle_files[f]);
    }
  }
}

static void test_finding_mismatch(void **state) {
  Scratch *scratch = *state;
  static uint8_t jitter[JITTER_BYTES];
  const char *path = path_in(scratch, "bundle");
  /* Another bundle, wider by a pixel: its guides don't fit the exemplars here. */
  char wide[1024], from[1024], to[1024];
  put_path(wide, scratch->folder, "wide");
  uint8_t larger[4 * (WIDTH + 1) * HEIGHT];
  memset(larger, 255, sizeof larger);
  const Layers layers = make_layers(1);
  StyBundleWriter *writer = open_writer(wide, WIDTH + 1, 1);
  assert_int_equal(sty_write_style(writer, &(const uint8_t *){larger}, larger, layers.lut, &PARAMETERS, NULL), STY_OK);
  json_t *index = make_index(1);
  assert_int_equal(sty_commit_bundle(&writer, jitter, index, NULL, NULL), STY_OK);
  json_decref(index);
  write_bundle(path, 1, 1);
  put_path(from, wide, sty_bundle_files[STY_BUNDLE_GUIDES]);
  put_path(to, path, sty_bundle_files[STY_BUNDLE_GUIDES]);
  assert_int_equal(rename(from, to), 0);
  index_anew(path, STY_BUNDLE_GUIDES);
  expect_finding(path, STY_FINDING_MISMATCH, "");

  /* Parameters of two styles beside layers of one. */
  write_bundle(wide, 2, 1);
  write_bundle(path, 1, 1);
  put_path(from, wide, sty_bundle_files[STY_BUNDLE_PARAMS]);
  put_path(to, path, sty_bundle_files[STY_BUNDLE_PARAMS]);
  assert_int_equal(rename(from, to), 0);
  index_anew(path, STY_BUNDLE_PARAMS);
  expect_finding(path, STY_FINDING_MISMATCH, "");
}

static void test_finding_parameters(void **state) {
  Scratch *scratch = *state;
  const char *path = path_in(scratch, "bundle");
  char file[1024];
  static const float bad[] = {NAN, -1, 1e30f, INFINITY, 0.5f};
  for (int component = 0; component < 3; component++) { /* threshold, top level, radius */
    for (int i = 0; i < 5; i++) {
      size_t size;
      write_bundle(path, 1, 1);
      put_path(file, path, sty_bundle_files[STY_BUNDLE_PARAMS]);
      unsigned char *bytes = read_bytes(file, &size);
      /* One style: the texture is the last 80 bytes, row 0 first. */
      memcpy(bytes + size - 16 * STY_PARAM_ROWS + 4 * component, &bad[i], 4);
      write_file(file, bytes, size);
      free(bytes);
      index_anew(path, STY_BUNDLE_PARAMS);
      expect_finding(path, STY_FINDING_PARAMETERS, "");
    }
  }
}

static void test_finding_styles(void **state) {
  Scratch *scratch = *state;
  const char *path = path_in(scratch, "bundle");
  char name[1024];
  for (int more = 0; more < 2; more++) {
    write_bundle(path, 2, 1);
    put_path(name, path, STY_BUNDLE_INDEX);
    json_t *root = json_load_file(name, 0, NULL);
    json_t *styles = json_object_get(root, "styles");
    if (more)
      json_array_append_new(styles, json_pack("{s:s}", "name", "third"));
    else
      json_array_remove(styles, 1);
    seal(root);
    assert_int_equal(json_dump_file(root, name, 0), 0);
    json_decref(root);
    expect_finding(path, STY_FINDING_STYLES, STY_BUNDLE_INDEX);
  }
}

/* A warning: the bundle loads all the same. */
static void test_finding_background(void **state) {
  Scratch *scratch = *state;
  static uint8_t jitter[JITTER_BYTES];
  const char *path = path_in(scratch, "bundle");
  Layers layers = make_layers(1);
  for (int i = 0; i < PIXELS; i++) layers.guide[4 * i + 3] = 0;
  layers.guide[3] = 255;
  StyBundleWriter *writer = open_writer(path, WIDTH, 1);
  write_style(writer, &layers, &PARAMETERS);
  json_t *index = make_index(1);
  StyError error = {STY_OK, ""};
  if (sty_commit_bundle(&writer, jitter, index, NULL, &error) != STY_OK) fail_msg("%s", error.text);
  json_decref(index);
  StyLoadedBundle loaded = {0};
  Report report = {0};
  assert_int_equal(sty_load_bundle(path, note, &report, &loaded, NULL), STY_OK);
  assert_true(report.counts[STY_FINDING_BACKGROUND] >= 1);
  assert_int_equal(report.total, report.warnings);
  assert_int_equal(report.total, report.counts[STY_FINDING_BACKGROUND]);
  sty_unload_bundle(&loaded);
}

/* ---- jitter ------------------------------------------------------------------------ */

static void test_jitter(void **state) {
  (void)state;
  static uint8_t first[JITTER_BYTES], second[JITTER_BYTES];
  for (uint64_t seed = 0; seed < 20; seed++) {
    memset(first, 255, sizeof first);
    sty_make_jitter(seed, first);
    sty_make_jitter(seed, second);
    assert_memory_equal(first, second, sizeof first);
    int counts[256] = {0};
    for (int i = 0; i < JITTER_BYTES; i++) counts[first[i]]++;
    assert_int_equal(counts[255], 0);
    /* White: each of the 255 values about 514 times, give or take 5 deviations of 22.6. */
    for (int v = 0; v < 255; v++) assert_in_range(counts[v], 514 - 113, 514 + 113);
    sty_make_jitter(seed + 1, second);
    assert_memory_not_equal(first, second, sizeof first);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      scratch_test(test_round_trip),
      scratch_test(test_same_bytes),
      scratch_test(test_replace),
      scratch_test(test_discard),
      scratch_test(test_refused_places),
      scratch_test(test_letter_arrives_late),
      scratch_test(test_missing_style),
      scratch_test(test_bad_parameters_are_not_written),
      scratch_test(test_unreadable),
      scratch_test(test_finding_index),
      scratch_test(test_findings_of_each_file),
      scratch_test(test_every_byte),
      scratch_test(test_every_byte_of_the_index),
      scratch_test(test_finding_texture),
      scratch_test(test_finding_mismatch),
      scratch_test(test_finding_parameters),
      scratch_test(test_finding_styles),
      scratch_test(test_finding_background),
      cmocka_unit_test(test_jitter),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
