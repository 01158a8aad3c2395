#include "../scratch.h"
#include "stylut/json.h"

static StyStatus read_text(Scratch *scratch, const char *text, StyDocument *document, StyError *error) {
  const StyStatus status = sty_read_document(write_bytes(scratch, "a.json", text, strlen(text)), document, error);
  unlink(scratch->path);
  return status;
}

static void open_text(Scratch *scratch, const char *text, StyDocument *document) {
  StyError error;
  if (read_text(scratch, text, document, &error) != STY_OK) fail_msg("%s", error.text);
  assert_string_equal(document->name, scratch->path);
  assert_string_equal(document->text, text);
  assert_true(json_is_object(document->root));
}

static void test_read(void **state) {
  Scratch *scratch = *state;
  StyDocument document = {0};
  open_text(scratch, " {\"a\": [1, 2], \"b\": {\"c\": \"x\"}}\n\n", &document);
  assert_int_equal(json_object_size(document.root), 2);
  sty_close_document(&document);
  open_text(scratch, "{}", &document);
  sty_close_document(&document);
}

/* Each text breaks one rule; the line is where. */
static void test_broken_texts(void **state) {
  Scratch *scratch = *state;
  static const struct {
    const char *text;
    int line;
  } broken[] = {
      {"", 0},
      {" ", 0},
      {"{", 1},
      {"{\n\"a\": 1,\n}", 2}, /* the comma's, whatever the bracket's */
      {"{\"a\": [\n1 ,\n\n], \"b\": 1}", 2},
      {"{\"a\": [,]}", 1},
      {"}", 1},
      {"{\"a\": \n]", 2},
      {"{\n\"a\": 1\n\"b\": 2}", 3},
      {"{\n\n\"a\": tru}", 3},
      {"{\"a\": 1}\n{}", 2},
      {"{\"a\": 1}\nx", 2},
      {"{\"a\": 1,\n \"a\": 2}", 2},
      {"{\"b\": {\"a\": 1,\n\n \"a\": 1}}", 3},
      {"{\"a\": \"\xff\"}", 1},
      {"{\"a\": 'x'}", 1},
      {"{\"a\": 01}", 1},
      {"{\"a\": 1e999}", 1},
      {"{\"a\": 99999999999999999999}", 1},
      {"{\"a\": NaN}", 1},
      {"{\"a\": \"\n\"}", 1},
      {"{a: 1}", 1},
      {"// no\n{}", 1},
  };
  for (size_t i = 0; i < sizeof broken / sizeof *broken; i++) {
    StyDocument document = {0};
    StyError error = {STY_OK, ""};
    const StyStatus status = read_text(scratch, broken[i].text, &document, &error);
    if (status == STY_OK) fail_msg("'%s' passes", broken[i].text);
    char place[1024];
    snprintf(place, sizeof place, broken[i].line ? "%s:%d:" : "%s", scratch->path, broken[i].line);
    expect_message(status, STY_ERROR_INPUT, &error, PARTS(place));
    assert_null(document.root);
    assert_null(document.text);
  }
}

static void test_other_roots(void **state) {
  Scratch *scratch = *state;
  static const char *const roots[] = {"[]", "[{}]", "1", "\"text\"", "null", "true"};
  for (size_t i = 0; i < sizeof roots / sizeof *roots; i++) {
    StyDocument document = {0};
    StyError error = {STY_OK, ""};
    expect_message(read_text(scratch, roots[i], &document, &error), STY_ERROR_INPUT, &error, PARTS(scratch->path));
    assert_null(document.root);
  }
}

/* What stands behind a NUL is still behind the value. */
static void test_zero_byte(void **state) {
  Scratch *scratch = *state;
  static const char text[] = "{\"a\": 1}\0{\"a\": 2}";
  StyDocument document = {0};
  StyError error = {STY_OK, ""};
  write_bytes(scratch, "a.json", text, sizeof text - 1);
  expect_message(sty_read_document(scratch->path, &document, &error), STY_ERROR_INPUT, &error, PARTS(scratch->path));
  /* Jansson passes over one behind a number. */
  write_bytes(scratch, "a.json", "{\"a\":\n 1\0, \"b\": 2}", 17);
  expect_message(sty_read_document(scratch->path, &document, &error), STY_ERROR_INPUT, &error,
                 PARTS(scratch->path, ":2:3: ", "zero byte"));
  write_bytes(scratch, "a.json", "{\"a\\u0000b\": 1}", 15);
  expect_message(sty_read_document(scratch->path, &document, &error), STY_ERROR_INPUT, &error, PARTS(scratch->path));
  unlink(scratch->path);
}

static void test_deep_nesting(void **state) {
  Scratch *scratch = *state;
  enum { DEPTH = 300000 };
  char *text = malloc(DEPTH + 8);
  assert_non_null(text);
  memcpy(text, "{\"a\":", 5);
  memset(text + 5, '[', DEPTH);
  text[5 + DEPTH] = 0;
  StyDocument document = {0};
  StyError error = {STY_OK, ""};
  expect_message(read_text(scratch, text, &document, &error), STY_ERROR_INPUT, &error, PARTS(scratch->path));
  free(text);
}

static void test_size_limit(void **state) {
  Scratch *scratch = *state;
  const size_t limit = 16u << 20;
  char *text = malloc(limit + 2);
  assert_non_null(text);
  memset(text, ' ', limit + 1);
  memcpy(text, "{}", 2);
  StyDocument document = {0};
  StyError error = {STY_OK, ""};
  write_bytes(scratch, "a.json", text, limit);
  assert_int_equal(sty_read_document(scratch->path, &document, &error), STY_OK);
  sty_close_document(&document);
  document = (StyDocument){0};
  write_bytes(scratch, "a.json", text, limit + 1);
  expect_message(sty_read_document(scratch->path, &document, &error), STY_ERROR_INPUT, &error, PARTS(scratch->path));
  free(text);
  unlink(scratch->path);
  expect_message(sty_read_document(scratch->path, &document, &error), STY_ERROR_FILE, &error, PARTS(scratch->path));
  expect_message(sty_read_document(scratch->folder, &document, &error), STY_ERROR_FILE, &error, PARTS(scratch->folder));
}

static void expect_place(const StyDocument *document, const StyPath *path, const json_t *found, int line, int column,
                         const char *key) {
  StyError error = {STY_OK, ""};
  char place[1024];
  snprintf(place, sizeof place, "%s:%d:%d: ", document->name, line, column);
  expect_message(sty_fail_value(document, path, found, "a unicorn", &error), STY_ERROR_INPUT, &error,
                 PARTS(place, key, "expected a unicorn"));
  if (strncmp(error.text, place, strlen(place))) fail_msg("'%s' doesn't begin with '%s'", error.text, place);
}

static void test_places(void **state) {
  Scratch *scratch = *state;
  StyDocument document = {0};
  open_text(scratch,
            "\n"
            "  {\"first\": {\"b\": [\"]}\", \"\\\"b\\\": 3\", {\"b\": null}]},\n"
            "\t\"b\":\n"
            "   [10, 20,   30],\r\n"
            "   \"\\u0063\": -1.5e3, \"d\" : true}\n",
            &document);
  expect_place(&document, NULL, document.root, 2, 3, "");
  const json_t *list = json_object_get(document.root, "b");
  const StyPath b = {NULL, "b", 0};
  expect_place(&document, &b, list, 4, 4, "b");
  expect_place(&document, &(StyPath){&b, NULL, 0}, json_array_get(list, 0), 4, 5, "");
  expect_place(&document, &(StyPath){&b, NULL, 2}, json_array_get(list, 2), 4, 15, "2");
  const StyPath c = {NULL, "c", 0}, d = {NULL, "d", 0};
  expect_place(&document, &c, json_object_get(document.root, "c"), 5, 14, "c");
  expect_place(&document, &d, json_object_get(document.root, "d"), 5, 28, "d");
  const StyPath first = {NULL, "first", 0}, inner = {&first, "b", 0}, third = {&inner, NULL, 2};
  const json_t *object = json_array_get(json_object_get(json_object_get(document.root, "first"), "b"), 2);
  expect_place(&document, &first, json_object_get(document.root, "first"), 2, 13, "first");
  expect_place(&document, &third, object, 2, 38, "");
  expect_place(&document, &(StyPath){&third, "b", 0}, json_object_get(object, "b"), 2, 44, "b");
  sty_close_document(&document);
}

/* Random documents, written here, so that the place of every value is known. */
enum { MAX_VALUES = 400 };
typedef struct Writer {
  char text[100000];
  size_t used;
  int line, column;
  uint64_t random;
  int count;
  StyPath paths[MAX_VALUES];
  int lines[MAX_VALUES], columns[MAX_VALUES];
} Writer;

static void put(Writer *writer, const char *text) {
  for (; *text; text++) {
    writer->text[writer->used++] = *text;
    if (*text == '\n') {
      writer->line++;
      writer->column = 1;
    } else {
      writer->column++;
    }
  }
  assert_true(writer->used < sizeof writer->text - 100);
}

static void put_blank(Writer *writer) {
  static const char *const blanks[] = {"", "", " ", "  ", "\n", "\t", "\r\n", " \n\n "};
  put(writer, blanks[draw_below(&writer->random, 8)]);
}

/* Keys that look like others, and like structure. */
static const char *const keys[] = {"a", "b", "ab", "a]", "}", ",", ":", "{\\\"a\\\":"};
static const char *const plain_keys[] = {"a", "b", "ab", "a]", "}", ",", ":", "{\"a\":"};

static void put_value(Writer *writer, const StyPath *path, int depth) {
  static const char *const scalars[] = {"1",    "-2.5e-3", "true",     "null",
                                        "\"\"", "\"]}\"",  "\"\\\\\"", "\"\\\"a\\\":1\""};
  if (path) {
    writer->lines[writer->count - 1] = writer->line;
    writer->columns[writer->count - 1] = writer->column;
  }
  const int kind = path ? draw_below(&writer->random, 3) : 0;
  if (kind == 2 || depth == 0) {
    put(writer, scalars[draw_below(&writer->random, 8)]);
    return;
  }
  const int members = draw_below(&writer->random, 5), first = draw_below(&writer->random, 8);
  put(writer, kind == 0 ? "{" : "[");
  put_blank(writer);
  for (int i = 0; i < members && writer->count < MAX_VALUES; i++) {
    if (i) put(writer, ","), put_blank(writer);
    StyPath *inside = &writer->paths[writer->count++];
    *inside = (StyPath){path, kind == 0 ? plain_keys[(first + i) % 8] : NULL, (size_t)i};
    if (kind == 0) {
      put(writer, "\""), put(writer, keys[(first + i) % 8]), put(writer, "\"");
      put_blank(writer), put(writer, ":"), put_blank(writer);
    }
    put_value(writer, inside, depth - 1);
    put_blank(writer);
  }
  put(writer, kind == 0 ? "}" : "]");
}

static json_t *follow(json_t *root, const StyPath *path) {
  if (!path) return root;
  json_t *parent = follow(root, path->parent);
  return path->key ? json_object_get(parent, path->key) : json_array_get(parent, path->index);
}

static void test_random_places(void **state) {
  Scratch *scratch = *state;
  Writer *writer = malloc(sizeof *writer);
  assert_non_null(writer);
  int asked = 0;
  for (int trial = 0; trial < 300; trial++) {
    memset(writer, 0, sizeof *writer);
    writer->line = writer->column = 1;
    writer->random = (uint64_t)trial;
    put_blank(writer);
    put_value(writer, NULL, 5);
    put_blank(writer);
    StyDocument document = {0};
    open_text(scratch, writer->text, &document);
    for (int i = 0; i < writer->count; i++, asked++)
      expect_place(&document, &writer->paths[i], follow(document.root, &writer->paths[i]), writer->lines[i],
                   writer->columns[i], "");
    sty_close_document(&document);
  }
  assert_true(asked > 1000);
  free(writer);
}

static void test_keys(void **state) {
  Scratch *scratch = *state;
  static const char *const known[] = {"a", "b", NULL};
  StyDocument document = {0};
  StyError error = {STY_OK, ""};
  open_text(scratch, "{\"a\": 1,\n \"c\": {\"b\": 1,\n  \"bb\": 2}}", &document);
  char place[1024];
  snprintf(place, sizeof place, "%s:2:", scratch->path);
  expect_message(sty_check_keys(&document, NULL, document.root, known, &error), STY_ERROR_INPUT, &error,
                 PARTS(place, "c"));
  const StyPath c = {NULL, "c", 0};
  const json_t *object = json_object_get(document.root, "c");
  snprintf(place, sizeof place, "%s:3:", scratch->path);
  expect_message(sty_check_keys(&document, &c, object, known, &error), STY_ERROR_INPUT, &error, PARTS(place, "bb"));
  assert_int_equal(sty_check_keys(&document, NULL, document.root, (const char *const[]){"c", "a", "z", NULL}, NULL),
                   STY_OK);
  sty_close_document(&document);
}

static void test_strings(void **state) {
  Scratch *scratch = *state;
  StyDocument document = {0};
  StyError error = {STY_OK, ""};
  open_text(scratch, "{\"s\": \"text\", \"e\": \"\",\n\"n\": 5, \"z\": null}", &document);
  const char *const before = "before", *value = before;
  assert_int_equal(sty_get_string(&document, NULL, document.root, "s", 1, &value, NULL), STY_OK);
  assert_string_equal(value, "text");
  value = before;
  assert_int_equal(sty_get_string(&document, NULL, document.root, "missing", 0, &value, NULL), STY_OK);
  assert_ptr_equal(value, before);
  expect_message(sty_get_string(&document, NULL, document.root, "missing", 1, &value, &error), STY_ERROR_INPUT, &error,
                 PARTS(scratch->path, "missing"));
  char place[1024];
  snprintf(place, sizeof place, "%s:2:6: ", scratch->path);
  expect_message(sty_get_string(&document, NULL, document.root, "n", 0, &value, &error), STY_ERROR_INPUT, &error,
                 PARTS(place, "n", "expected"));
  assert_int_equal(sty_get_string(&document, NULL, document.root, "z", 0, &value, NULL), STY_ERROR_INPUT);
  assert_ptr_equal(value, before);
  sty_close_document(&document);
}

static void test_numbers(void **state) {
  Scratch *scratch = *state;
  StyDocument document = {0};
  StyError error = {STY_OK, ""};
  open_text(scratch, "{\"i\": 5, \"r\": 2.5, \"low\": -1,\n \"high\": 10.5, \"s\": \"5\", \"b\": true, \"top\": 10}",
            &document);
  double value = 42;
  assert_int_equal(sty_get_number(&document, NULL, document.root, "i", 0, 10, &value, NULL), STY_OK);
  assert_true(value == 5);
  assert_int_equal(sty_get_number(&document, NULL, document.root, "r", 0, 10, &value, NULL), STY_OK);
  assert_true(value == 2.5);
  assert_int_equal(sty_get_number(&document, NULL, document.root, "top", 0, 10, &value, NULL), STY_OK);
  assert_true(value == 10);
  assert_int_equal(sty_get_number(&document, NULL, document.root, "missing", 0, 10, &value, NULL), STY_OK);
  assert_true(value == 10);
  char place[1024];
  snprintf(place, sizeof place, "%s:2:10: ", scratch->path);
  expect_message(sty_get_number(&document, NULL, document.root, "high", 0, 10, &value, &error), STY_ERROR_INPUT, &error,
                 PARTS(place, "10.5", "expected"));
  assert_int_equal(sty_get_number(&document, NULL, document.root, "low", 0, 10, &value, NULL), STY_ERROR_INPUT);
  assert_int_equal(sty_get_number(&document, NULL, document.root, "s", 0, 10, &value, NULL), STY_ERROR_INPUT);
  assert_int_equal(sty_get_number(&document, NULL, document.root, "b", 0, 10, &value, NULL), STY_ERROR_INPUT);
  assert_true(value == 10);
  sty_close_document(&document);
}

static void test_integers(void **state) {
  Scratch *scratch = *state;
  StyDocument document = {0};
  StyError error = {STY_OK, ""};
  open_text(scratch,
            "{\"i\": 5, \"low\": -2, \"top\": 10, \"under\": -3, \"over\": 11,\n"
            " \"real\": 2.5, \"s\": \"5\", \"wraps\": 4294967301, \"wide\": -9223372036854775808}",
            &document);
  int value = 42;
  assert_int_equal(sty_get_integer(&document, NULL, document.root, "i", -2, 10, &value, NULL), STY_OK);
  assert_int_equal(value, 5);
  assert_int_equal(sty_get_integer(&document, NULL, document.root, "low", -2, 10, &value, NULL), STY_OK);
  assert_int_equal(value, -2);
  assert_int_equal(sty_get_integer(&document, NULL, document.root, "top", -2, 10, &value, NULL), STY_OK);
  assert_int_equal(value, 10);
  assert_int_equal(sty_get_integer(&document, NULL, document.root, "missing", -2, 10, &value, NULL), STY_OK);
  static const char *const bad[] = {"under", "over", "real", "s", "wraps", "wide"};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    expect_message(sty_get_integer(&document, NULL, document.root, bad[i], -2, 10, &value, &error), STY_ERROR_INPUT,
                   &error, PARTS(scratch->path, bad[i], "-2", "10"));
    assert_int_equal(value, 10);
  }
  sty_close_document(&document);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      scratch_test(test_read),      scratch_test(test_broken_texts),  scratch_test(test_other_roots),
      scratch_test(test_zero_byte), scratch_test(test_deep_nesting),  scratch_test(test_size_limit),
      scratch_test(test_places),    scratch_test(test_random_places), scratch_test(test_keys),
      scratch_test(test_strings),   scratch_test(test_numbers),       scratch_test(test_integers),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
