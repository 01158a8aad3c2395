#include "../scratch.h"
#include "stylut/pack.h"

static StyStatus read_text(Scratch *scratch, const char *text, StyManifest *manifest, StyError *error) {
  return sty_read_manifest(write_bytes(scratch, "m.json", text, strlen(text)), manifest, error);
}

static void open_text(Scratch *scratch, const char *text, StyManifest *manifest) {
  StyError error = {STY_OK, ""};
  if (read_text(scratch, text, manifest, &error) != STY_OK) fail_msg("%s", error.text);
}

#define HEAD "{\"schema\": \"stylut-bundle/1\",\n \"styles\": "
#define ONE "{\"name\": \"a\", \"exemplar\": \"a.png\"}"

static void test_defaults(void **state) {
  Scratch *scratch = *state;
  StyManifest manifest = {0};
  open_text(scratch, HEAD "[" ONE "]}", &manifest);
  assert_string_equal(manifest.folder, scratch->folder);
  assert_null(manifest.jitter);
  assert_int_equal(manifest.style_count, 1);
  const StyManifestStyle *style = manifest.styles;
  assert_string_equal(style->name, "a");
  assert_string_equal(style->exemplars[0], "a.png");
  assert_string_equal(style->guide, "sphere");
  assert_null(style->lut.file);
  assert_string_equal(style->lut.engine, "auto");
  assert_int_equal(style->lut.size, 0);
  assert_string_equal(style->lut.sampling, "unorm8");
  assert_int_equal(style->parameters.threshold, 24);
  assert_in_range(style->parameters.top_level, 0, STY_MAX_LEVEL);
  assert_in_range(style->parameters.radius, 0, STY_MAX_RADIUS);
  assert_true(style->parameters.depth_tolerance >= 0);
  sty_close_manifest(&manifest);
}

static void test_every_key(void **state) {
  Scratch *scratch = *state;
  StyManifest manifest = {0};
  open_text(scratch,
            HEAD
            "[{\"name\": \"first\", \"exemplar\": \"x/a.png\", \"guide\": \"g.exr\",\n"
            "  \"lut\": {\"size\": 64, \"engine\": \"brute\", \"resolve\": \"nearest\", \"sampling\": \"centre\"},\n"
            "  \"params\": {\"threshold\": 100, \"top_level\": 5, \"radius\": 3, \"depth_tolerance\": 0.25}},\n"
            " {\"name\": \"second\", \"exemplar\": \"b.png\", \"lut\": \"table.png\"},\n"
            " {\"name\": \"third\", \"exemplar\": \"c.png\", \"lut\": {\"file\": \"t.exr\", \"sampling\": "
            "\"centre\"}}],\n"
            " \"jitter\": \"noise.png\"}",
            &manifest);
  assert_int_equal(manifest.style_count, 3);
  assert_string_equal(sty_get_manifest_name(manifest.jitter, 0), "noise.png");
  const StyManifestStyle *first = manifest.styles, *second = first + 1, *third = first + 2;
  assert_string_equal(first->name, "first");
  assert_string_equal(first->exemplars[0], "x/a.png");
  assert_string_equal(first->guide, "g.exr");
  assert_int_equal(first->lut.size, 64);
  assert_string_equal(first->lut.engine, "brute");
  assert_string_equal(first->lut.sampling, "centre");
  assert_null(first->lut.file);
  assert_int_equal(first->parameters.threshold, 100);
  assert_int_equal(first->parameters.top_level, 5);
  assert_int_equal(first->parameters.radius, 3);
  assert_true(first->parameters.depth_tolerance == 0.25f);
  assert_string_equal(second->lut.file, "table.png");
  assert_null(second->lut.sampling);
  assert_string_equal(third->lut.file, "t.exr");
  assert_string_equal(third->lut.sampling, "centre");
  sty_close_manifest(&manifest);
}

/* `text` holds one '@' before the value at fault: its place is the one that the message must give. */
static void expect_fault(Scratch *scratch, const char *marked, const char *key) {
  char text[4096], place[1024];
  const char *at = strchr(marked, '@');
  assert_non_null(at);
  snprintf(text, sizeof text, "%.*s%s", (int)(at - marked), marked, at + 1);
  int line = 1, column = 1;
  for (const char *c = marked; c < at; c++) {
    column = *c == '\n' ? 1 : column + 1;
    line += *c == '\n';
  }
  StyManifest manifest = {0};
  StyError error = {STY_OK, ""};
  const StyStatus status = read_text(scratch, text, &manifest, &error);
  if (status == STY_OK) fail_msg("passes: %s", text);
  snprintf(place, sizeof place, "%s:%d:%d:", scratch->path, line, column);
  expect_message(status, STY_ERROR_INPUT, &error, PARTS(place, key));
  assert_null(manifest.styles);
  assert_null(manifest.document.root);
}

static void test_wrong_types(void **state) {
  Scratch *scratch = *state;
  static const char *const not_strings[] = {"5", "null", "true", "[\"a\"]", "{}"};
  static const char *const not_integers[] = {"\"5\"", "null", "true", "[5]", "{}", "1.5"};
  char text[1024];
  for (int i = 0; i < 5; i++) {
    const char *bad = not_strings[i];
    snprintf(text, sizeof text, "{\"schema\": @%s, \"styles\": [" ONE "]}", bad);
    expect_fault(scratch, text, "schema");
    if (strcmp(bad, "[\"a\"]") != 0) { /* a list of one file */
      snprintf(text, sizeof text, HEAD "[" ONE "],\n\n \"jitter\": @%s}", bad);
      expect_fault(scratch, text, "jitter");
    }
    snprintf(text, sizeof text, HEAD "[{\"name\": @%s, \"exemplar\": \"a.png\"}]}", bad);
    expect_fault(scratch, text, "name");
    snprintf(text, sizeof text, HEAD "[" ONE ",\n{\"name\": \"b\", \"exemplar\": @%s}]}", bad);
    expect_fault(scratch, text, "exemplar");
    snprintf(text, sizeof text, HEAD "[{\"name\": \"b\", \"exemplar\": \"b.png\",\n\"guide\" :@%s}]}", bad);
    expect_fault(scratch, text, "guide");
    if (strcmp(bad, "{}") != 0) {
      snprintf(text, sizeof text, HEAD "[{\"name\": \"b\", \"exemplar\": \"b.png\",\n\"lut\" : @%s}]}", bad);
      expect_fault(scratch, text, "lut");
      snprintf(text, sizeof text, HEAD "[{\"name\": \"b\", \"exemplar\": \"b.png\",\n\"params\" : @%s}]}", bad);
      expect_fault(scratch, text, "params");
      snprintf(text, sizeof text, HEAD "[\n@%s]}", bad);
      expect_fault(scratch, text, "styles");
    }
    static const char *const keys[] = {"engine", "resolve", "sampling", "file"};
    for (int k = 0; k < 4; k++) {
      snprintf(text, sizeof text, HEAD "[{\"name\": \"b\", \"exemplar\": \"b.png\", \"lut\": {\"%s\": @%s}}]}", keys[k],
               bad);
      expect_fault(scratch, text, keys[k]);
    }
  }
  for (int i = 0; i < 6; i++) {
    static const char *const keys[] = {"threshold", "top_level", "radius"};
    for (int k = 0; k < 3; k++) {
      snprintf(text, sizeof text, HEAD "[{\"name\": \"b\", \"exemplar\": \"b.png\", \"params\": {\"%s\": @%s}}]}",
               keys[k], not_integers[i]);
      expect_fault(scratch, text, keys[k]);
    }
    if (i < 5) {
      snprintf(text, sizeof text,
               HEAD "[{\"name\": \"b\", \"exemplar\": \"b.png\", \"params\": {\"depth_tolerance\": @%s}}]}",
               not_integers[i]);
      expect_fault(scratch, text, "depth_tolerance");
    }
    snprintf(text, sizeof text, HEAD "[{\"name\": \"b\", \"exemplar\": \"b.png\", \"lut\": {\"size\": @%s}}]}",
             not_integers[i]);
    expect_fault(scratch, text, "size");
  }
  static const char *const not_lists[] = {"5", "null", "\"a\"", "{}", ONE};
  for (int i = 0; i < 5; i++) {
    snprintf(text, sizeof text, "{\"schema\": \"stylut-bundle/1\",\n \"styles\": @%s}", not_lists[i]);
    expect_fault(scratch, text, "styles");
  }
}

static void test_ranges(void **state) {
  Scratch *scratch = *state;
  static const struct {
    const char *key;
    int least, most;
  } keys[] = {{"threshold", 0, STY_MAX_THRESHOLD}, {"top_level", 0, STY_MAX_LEVEL}, {"radius", 0, STY_MAX_RADIUS}};
  char text[1024];
  for (int k = 0; k < 3; k++) {
    const char *format = HEAD "[{\"name\": \"b\", \"exemplar\": \"b.png\", \"params\": {\"%s\": %s%d}}]}";
    for (int end = 0; end < 2; end++) {
      StyManifest manifest = {0};
      snprintf(text, sizeof text, format, keys[k].key, "", end ? keys[k].most : keys[k].least);
      open_text(scratch, text, &manifest);
      sty_close_manifest(&manifest);
      snprintf(text, sizeof text, format, keys[k].key, "@", end ? keys[k].most + 1 : keys[k].least - 1);
      expect_fault(scratch, text, keys[k].key);
    }
  }
  static const char *const sizes[] = {"0", "-1", "8193", "4294967552"};
  for (int i = 0; i < 4; i++) {
    snprintf(text, sizeof text, HEAD "[{\"name\": \"b\", \"exemplar\": \"b.png\", \"lut\": {\"size\": @%s}}]}",
             sizes[i]);
    expect_fault(scratch, text, "size");
  }
  expect_fault(scratch, HEAD "[{\"name\": \"b\", \"exemplar\": \"b.png\", \"params\": {\"depth_tolerance\": @-0.1}}]}",
               "depth_tolerance");
  /* A float in the file: what doesn't fit one is refused here and not found as infinity later. */
  expect_fault(scratch, HEAD "[{\"name\": \"b\", \"exemplar\": \"b.png\", \"params\": {\"depth_tolerance\": @1e300}}]}",
               "depth_tolerance");
  expect_fault(scratch, HEAD "[{\"name\": \"b\", \"exemplar\": \"b.png\", \"lut\": {\"sampling\": @\"center\"}}]}",
               "sampling");
  expect_fault(scratch, HEAD "[{\"name\": \"b\", \"exemplar\": \"b.png\", \"lut\": {\"resolve\": @\"best\"}}]}",
               "resolve");
  expect_fault(scratch, "{\"styles\": [" ONE "], \"schema\": @\"stylut-bundle/2\"}", "schema");
}

#define TWO(second) HEAD "[{\"name\": \"a\", \"exemplars\": [{\"image\": \"d.png\", \"luma\": 0.25}, " second "]}]}"

static void test_lightings(void **state) {
  Scratch *scratch = *state;
  StyManifest manifest = {0};
  open_text(scratch, TWO("{\"image\": \"l.png\", \"luma\": 0.75}"), &manifest);
  const StyManifestStyle *style = manifest.styles;
  assert_int_equal(style->parameters.layer_count, 2);
  assert_int_equal(sty_count_layers(&style->parameters), 2);
  assert_string_equal(style->exemplars[1], "l.png");
  assert_true(style->parameters.luma[0] == 0.25f && style->parameters.luma[1] == 0.75f);
  assert_true(style->parameters.luma_weight == 0.25f);
  sty_close_manifest(&manifest);
  expect_fault(scratch, TWO("{\"image\": \"l.png\", \"luma\": @0.25}"), "exemplars[1].luma");
  expect_fault(scratch, TWO("{\"image\": \"l.png\", \"luma\": @1.5}"), "exemplars[1].luma");
  expect_fault(scratch, HEAD "[{\"name\": \"a\", \"exemplars\": @[]}]}", "exemplars");
  expect_fault(scratch, HEAD "[{\"name\": \"a\", \"exemplars\": @[{}, {}, {}, {}, {}]}]}", "exemplars");
  expect_fault(scratch, HEAD "[{\"name\": \"a\", \"exemplar\": \"a.png\", \"exemplars\": @[]}]}", "exemplars");
}

static void test_bases_and_budgets(void **state) {
  Scratch *scratch = *state;
  StyManifest manifest = {0};
  open_text(scratch,
            HEAD
            "[{\"name\": \"a\", \"exemplar\": \"a.png\", \"base\": 8, \"lut\": {\"budget\": {\"p99\": 1}},\n"
            "\"params\": {\"objects\": true, \"scale\": 0.5, \"scatter\": 3}}]}",
            &manifest);
  const StyManifestStyle *style = manifest.styles;
  assert_int_equal(style->parameters.flags, STY_FLAG_BASE | STY_FLAG_OBJECTS);
  assert_int_equal(sty_count_layers(&style->parameters), 2);
  assert_true(style->base == 8 && style->lut.most_p99 == 1 && style->lut.most_mean == 0 && style->lut.size == 0);
  assert_true(style->parameters.scale == 0.5f);
  assert_int_equal(style->parameters.scatter, 3);
  sty_close_manifest(&manifest);
  static const char *const faults[][2] = {{"\"base\": @0", "base"},
                                          {"\"lut\": {\"budget\": @{}}", "budget"},
                                          {"\"lut\": {\"size\": 64, \"budget\": @{\"max\": 2}}", "budget"},
                                          {"\"lut\": {\"resolve\": @\"frames\"}", "resolve"},
                                          {"\"lut\": {\"slack\": @1}", "slack"},
                                          {"\"lut\": {\"frames\": @[\"f.exr\"]}", "frames"},
                                          {"\"params\": {\"scale\": @0.7}", "scale"},
                                          {"\"params\": {\"objects\": @1}", "objects"},
                                          {"\"params\": {\"scatter\": @65}", "scatter"}};
  for (size_t i = 0; i < sizeof faults / sizeof *faults; i++) {
    char text[512];
    snprintf(text, sizeof text, HEAD "[{\"name\": \"a\", \"exemplar\": \"a.png\", %s}]}", faults[i][0]);
    expect_fault(scratch, text, faults[i][1]);
  }
}

static void expect_refusal(Scratch *scratch, const char *text, const char *first, const char *second) {
  StyManifest manifest = {0};
  StyError error = {STY_OK, ""};
  const StyStatus status = read_text(scratch, text, &manifest, &error);
  if (status == STY_OK) fail_msg("passes: %s", text);
  expect_message(status, STY_ERROR_INPUT, &error, PARTS(scratch->path, first, second));
  assert_null(manifest.styles);
}

static void test_unknown_keys(void **state) {
  Scratch *scratch = *state;
  expect_refusal(scratch, HEAD "[" ONE "],\n \"jiter\": \"a\"}", ":3:", "jiter");
  expect_refusal(scratch, HEAD "[{\"name\": \"a\",\n\"exemplar\": \"a\",\n\"Guide\": \"g\"}]}", ":4:", "Guide");
  expect_refusal(scratch, HEAD "[{\"name\": \"a\", \"exemplar\": \"a\",\n\"lut\": {\"sise\": 5}}]}", ":3:", "sise");
  expect_refusal(scratch, HEAD "[{\"name\": \"a\", \"exemplar\": \"a\",\n\"params\": {\"rad\": 5}}]}", ":3:", "rad");
}

static void test_missing_keys(void **state) {
  Scratch *scratch = *state;
  expect_refusal(scratch, "{\"styles\": [" ONE "]}", "schema", "");
  expect_refusal(scratch, "{\"schema\": \"stylut-bundle/1\"}", "styles", "");
  expect_refusal(scratch, HEAD "[{\"exemplar\": \"a\"}]}", "name", "");
  expect_refusal(scratch, HEAD "[{\"name\": \"a\"}]}", "exemplar", "");
  expect_refusal(scratch, "{}", "", "");
}

static void test_duplicates(void **state) {
  Scratch *scratch = *state;
  expect_refusal(scratch, HEAD "[" ONE ",\n" ONE "]}", ":3:", "a");
  expect_refusal(scratch, HEAD "[" ONE ", {\"name\": \"b\", \"exemplar\": \"a\"},\n\n" ONE "]}", ":4:", "a");
  expect_refusal(scratch, HEAD "[{\"name\": \"a\", \"exemplar\": \"a\",\n\"name\": \"b\"}]}", ":3:", "name");
  expect_refusal(scratch, HEAD "[" ONE "], \"styles\": []}", ":2:", "styles");
}

static void test_number_of_styles(void **state) {
  Scratch *scratch = *state;
  expect_fault(scratch, "{\"schema\": \"stylut-bundle/1\", \"styles\": @[]}", "styles");
  for (int count = STY_MAX_STYLES; count <= STY_MAX_STYLES + 1; count++) {
    char *text = malloc(20000);
    assert_non_null(text);
    size_t used = (size_t)sprintf(text, HEAD "[");
    for (int i = 0; i < count; i++)
      used += (size_t)sprintf(text + used, "%s{\"name\": \"s%d\", \"exemplar\": \"a\"}", i ? "," : "", i);
    strcpy(text + used, "]}");
    if (count == STY_MAX_STYLES) {
      StyManifest manifest = {0};
      open_text(scratch, text, &manifest);
      assert_int_equal(manifest.style_count, STY_MAX_STYLES);
      assert_string_equal(manifest.styles[255].name, "s255");
      sty_close_manifest(&manifest);
    } else {
      expect_refusal(scratch, text, ":2:", "256");
    }
    free(text);
  }
}

static void test_not_a_manifest(void **state) {
  Scratch *scratch = *state;
  expect_refusal(scratch, "", "", "");
  expect_refusal(scratch, "[]", "", "");
  expect_refusal(scratch, "\"stylut-bundle/1\"", "", "");
  expect_refusal(scratch, HEAD "[" ONE "]", ":2:", "");
  expect_refusal(scratch, HEAD "[" ONE "]}}", ":2:", "");
  expect_refusal(scratch, HEAD "[" ONE ",\n]}", ":2:", "comma");
  StyManifest manifest = {0};
  StyError error = {STY_OK, ""};
  expect_message(sty_read_manifest(path_in(scratch, "missing.json"), &manifest, &error), STY_ERROR_FILE, &error,
                 PARTS("missing.json"));
  expect_message(sty_read_manifest(scratch->folder, &manifest, &error), STY_ERROR_FILE, &error, PARTS(scratch->folder));
}

/* Cut anywhere, a manifest is refused, and no byte behind the cut is looked at. */
static void test_truncated(void **state) {
  Scratch *scratch = *state;
  static const char text[] = HEAD
      "[{\"name\": \"a\", \"exemplar\": \"a\", \"lut\": {\"size\": 64}, \"params\": {\"radius\": 1}}], \"jitter\": "
      "\"j\"}";
  for (size_t length = 0; length < sizeof text - 1; length++) {
    char cut[sizeof text];
    memcpy(cut, text, length);
    cut[length] = 0;
    expect_refusal(scratch, cut, "", "");
  }
  StyManifest manifest = {0};
  open_text(scratch, text, &manifest);
  sty_close_manifest(&manifest);
}

static void test_shared_defaults(void **state) {
  Scratch *scratch = *state;
  StyManifest manifest = {0};
  open_text(scratch,
            HEAD
            "[{\"name\": \"a\", \"exemplar\": \"a.png\"},\n"
            " {\"name\": \"b\", \"exemplar\": \"b.png\", \"guide\": \"b.exr\", \"lut\": {\"engine\": \"brute\"},\n"
            "  \"params\": {\"radius\": 2}},\n"
            " {\"name\": \"c\", \"exemplars\": [{\"image\": \"1\", \"luma\": 0}, {\"image\": \"2\", \"luma\": 1}]}],\n"
            " \"defaults\": {\"check\": {\"max-p99\": 2}, \"guide\": \"{name}/g.exr\", \"lut\": {\"size\": 64},\n"
            "  \"params\": {\"threshold\": 30, \"luma_weight\": 0, \"radius\": 5}}}",
            &manifest);
  const StyManifestStyle *a = manifest.styles, *b = a + 1, *c = a + 2;
  assert_string_equal(a->guide, "a/g.exr");
  assert_string_equal(b->guide, "b.exr");
  assert_string_equal(c->guide, "c/g.exr");
  assert_int_equal(a->lut.size, 64);
  assert_int_equal(b->lut.size, 0); /* its own takes the place of the whole */
  assert_string_equal(a->lut.engine, "auto");
  assert_string_equal(b->lut.engine, "brute");
  assert_int_equal(b->parameters.threshold, 30);
  assert_int_equal(b->parameters.radius, 2);
  assert_int_equal(c->parameters.radius, 5);
  assert_true(c->parameters.luma_weight == 0);
  assert_true(json_number_value(json_object_get(b->check, "max-p99")) == 2);
  StyError error;
  expect_message(
      sty_fail_manifest_value(&manifest, a, "lut", "size", json_object_get(a->lut.written, "size"), "more", &error),
      STY_ERROR_INPUT, &error, PARTS(":6:", "defaults.lut.size: found 64, expected more"));
  expect_message(
      sty_fail_manifest_value(&manifest, b, "lut", "engine", json_object_get(b->lut.written, "engine"), "less", &error),
      STY_ERROR_INPUT, &error, PARTS(":3:", "styles[1].lut.engine: found"));
  sty_close_manifest(&manifest);
}

static void test_globs(void **state) {
  Scratch *scratch = *state;
  static const char *const files[] = {"b.png", "a.b.png", ".png", ".c.png", "a.jpg", "B.png"};
  StyManifest manifest = {0};
  StyError error;
  for (size_t i = 0; i < sizeof files / sizeof *files; i++) write_bytes(scratch, files[i], "", 0);
  open_text(scratch,
            HEAD
            "[{\"name\": \"first\", \"exemplar\": \"x.png\"},\n"
            " {\"glob\": \"./*.png\", \"lut\": \"{name}.exr\", \"params\": {\"radius\": 3}}]}",
            &manifest);
  static const char *const names[] = {"first", "B", "a.b", "b"}, *const exemplars[] = {"x.png", "./B.png", "./a.b.png",
                                                                                       "./b.png"};
  assert_int_equal(manifest.style_count, 4);
  for (int i = 0; i < 4; i++) {
    assert_string_equal(manifest.styles[i].name, names[i]);
    assert_string_equal(manifest.styles[i].exemplars[0], exemplars[i]);
    assert_int_equal(manifest.styles[i].entry, i > 0);
    assert_int_equal(manifest.styles[i].parameters.radius, i > 0 ? 3 : 1);
  }
  assert_string_equal(manifest.styles[2].lut.file, "a.b.exr");
  sty_close_manifest(&manifest);
  expect_fault(scratch, HEAD "[{\"glob\": @\"*.tif\"}]}", "glob");
  expect_fault(scratch, HEAD "[{\"glob\": @\"\"}]}", "glob");
  expect_fault(scratch, HEAD "[{\"glob\": @1}]}", "glob");
  expect_fault(scratch, HEAD "[{\"glob\": @\"*.png\", \"name\": \"a\"}]}", "glob");
  expect_fault(scratch, HEAD "[{\"name\": \"b\", \"exemplar\": \"x\"}, {\"glob\": @\"*.png\"}]}", "glob");
  expect_message(read_text(scratch, HEAD "[{\"glob\": \"missing/*.png\"}]}", &manifest, &error), STY_ERROR_FILE, &error,
                 PARTS("missing"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      scratch_test(test_defaults),         scratch_test(test_every_key),      scratch_test(test_wrong_types),
      scratch_test(test_ranges),           scratch_test(test_lightings),      scratch_test(test_bases_and_budgets),
      scratch_test(test_unknown_keys),     scratch_test(test_missing_keys),   scratch_test(test_duplicates),
      scratch_test(test_number_of_styles), scratch_test(test_not_a_manifest), scratch_test(test_truncated),
      scratch_test(test_shared_defaults),  scratch_test(test_globs),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
