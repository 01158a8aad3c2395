#include <signal.h>
#include <sys/resource.h>

#include "../scratch.h"
#include "stylut/file.h"

static void expect_contents(const char *path, const char *text) {
  size_t size = 0;
  unsigned char *bytes = read_bytes(path, &size);
  assert_int_equal(size, strlen(text));
  assert_memory_equal(bytes, text, size);
  free(bytes);
}

static void test_output_appears_on_commit(void **state) {
  Scratch *scratch = *state;
  StyOutput output = {0};
  assert_int_equal(sty_open_output(path_in(scratch, "a.txt"), &output, NULL), STY_OK);
  assert_int_equal(access(scratch->path, F_OK), -1);
  assert_int_equal(count_entries(scratch->folder), 1); /* the temporary stands beside it */
  assert_string_equal(output.path, scratch->path);
  fputs("whole", output.stream);
  assert_int_equal(sty_commit_output(&output, NULL), STY_OK);
  expect_contents(scratch->path, "whole");
  assert_int_equal(count_entries(scratch->folder), 1);
  sty_discard_output(&output); /* spent: nothing happens */
  expect_contents(scratch->path, "whole");
  unlink(scratch->path);
}

static void test_output_replaces(void **state) {
  Scratch *scratch = *state;
  write_bytes(scratch, "a.txt", "old", 3);
  StyOutput output = {0};
  assert_int_equal(sty_open_output(scratch->path, &output, NULL), STY_OK);
  fputs("new", output.stream);
  fflush(output.stream);
  expect_contents(scratch->path, "old");
  sty_discard_output(&output);
  expect_contents(scratch->path, "old");
  assert_int_equal(count_entries(scratch->folder), 1);

  assert_int_equal(sty_open_output(scratch->path, &output, NULL), STY_OK);
  fputs("new", output.stream);
  assert_int_equal(sty_commit_output(&output, NULL), STY_OK);
  expect_contents(scratch->path, "new");
  unlink(scratch->path);
}

static void test_discarding_nothing(void **state) {
  (void)state;
  StyOutput output = {0};
  sty_discard_output(&output);
}

/* Two writers of one path each write a whole file; the last one stays. */
static void test_two_writers(void **state) {
  Scratch *scratch = *state;
  StyOutput first = {0}, second = {0};
  assert_int_equal(sty_open_output(path_in(scratch, "a.txt"), &first, NULL), STY_OK);
  assert_int_equal(sty_open_output(scratch->path, &second, NULL), STY_OK);
  fputs("first", first.stream);
  fputs("the second", second.stream);
  assert_int_equal(sty_commit_output(&second, NULL), STY_OK);
  expect_contents(scratch->path, "the second");
  assert_int_equal(sty_commit_output(&first, NULL), STY_OK);
  expect_contents(scratch->path, "first");
  assert_int_equal(count_entries(scratch->folder), 1);
  unlink(scratch->path);
}

/* Others may read what the umask lets them read: a private temporary's mode mustn't stay. */
static void test_output_mode(void **state) {
  Scratch *scratch = *state;
  const mode_t before = umask(027);
  StyOutput output = {0};
  struct stat about;
  assert_int_equal(sty_open_output(path_in(scratch, "a.txt"), &output, NULL), STY_OK);
  assert_int_equal(sty_commit_output(&output, NULL), STY_OK);
  umask(before);
  assert_int_equal(stat(scratch->path, &about), 0);
  assert_int_equal(about.st_mode & 0777, 0640);
  unlink(scratch->path);
}

static void test_output_in_bad_places(void **state) {
  Scratch *scratch = *state;
  StyError error;
  StyOutput output = {0};
  const char *const missing = path_in(scratch, "missing/a.txt");
  expect_message(sty_open_output(missing, &output, &error), STY_ERROR_FILE, &error, PARTS(missing));
  assert_null(output.stream);
  write_bytes(scratch, "plain", "x", 1);
  const char *const inside = path_in(scratch, "plain/a.txt");
  expect_message(sty_open_output(inside, &output, &error), STY_ERROR_FILE, &error, PARTS(inside));
  unlink(path_in(scratch, "plain"));
  assert_int_not_equal(sty_open_output("", &output, &error), STY_OK);
  assert_null(output.stream);

  if (geteuid() != 0) { /* root may write anywhere */
    assert_int_equal(chmod(scratch->folder, 0500), 0);
    const StyStatus status = sty_open_output(path_in(scratch, "a.txt"), &output, &error);
    chmod(scratch->folder, 0700);
    expect_message(status, STY_ERROR_FILE, &error, PARTS("a.txt"));
  }
  /* A folder of this name: whether found when opening or when renaming, nothing stays behind. */
  assert_int_equal(mkdir(path_in(scratch, "folder"), 0700), 0);
  StyStatus status = sty_open_output(scratch->path, &output, &error);
  if (status == STY_OK) status = sty_commit_output(&output, &error);
  expect_message(status, STY_ERROR_FILE, &error, PARTS(scratch->path));
  assert_int_equal(rmdir(scratch->path), 0);
  assert_int_equal(count_entries(scratch->folder), 0);
}

/* A file size limit fails writes the way a full disk does. */
static void test_failed_write(void **state) {
  Scratch *scratch = *state;
  write_bytes(scratch, "a.txt", "old", 3);
  struct rlimit before, small;
  assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
  small = before;
  small.rlim_cur = 10000;
  StyOutput output = {0};
  StyError error = {STY_OK, ""};
  assert_int_equal(sty_open_output(scratch->path, &output, NULL), STY_OK);
  signal(SIGXFSZ, SIG_IGN);
  assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
  for (int i = 0; i < 100000; i++) fputc('x', output.stream);
  const StyStatus status = sty_commit_output(&output, &error);
  setrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, SIG_DFL);
  expect_message(status, STY_ERROR_FILE, &error, PARTS(scratch->path));
  expect_contents(scratch->path, "old");
  assert_int_equal(count_entries(scratch->folder), 1);
  sty_discard_output(&output);
  unlink(scratch->path);
}

static void test_check_file(void **state) {
  Scratch *scratch = *state;
  uint64_t size = 42;
  StyError error;
  assert_int_equal(sty_check_file(write_bytes(scratch, "a", "12345", 5), &size, NULL), STY_OK);
  assert_int_equal(size, 5);
  assert_int_equal(sty_check_file(scratch->path, NULL, NULL), STY_OK);
  if (geteuid() != 0) {
    chmod(scratch->path, 0);
    expect_message(sty_check_file(scratch->path, &size, &error), STY_ERROR_FILE, &error, PARTS(scratch->path));
  }
  unlink(scratch->path);
  size = 42;
  expect_message(sty_check_file(scratch->path, &size, &error), STY_ERROR_FILE, &error, PARTS(scratch->path));
  char missing[1024];
  strcpy(missing, error.text);
  expect_message(sty_check_file(scratch->folder, &size, &error), STY_ERROR_FILE, &error,
                 PARTS(scratch->folder, "folder"));
  assert_string_not_equal(missing, error.text);
  assert_int_equal(size, 42);
}

static void test_read_file(void **state) {
  Scratch *scratch = *state;
  static const char bytes[] = "with\0zero\xff";
  unsigned char *data = NULL;
  size_t size = 0;
  StyError error;
  write_bytes(scratch, "a", bytes, sizeof bytes - 1);
  assert_int_equal(sty_read_file(scratch->path, sizeof bytes - 1, &data, &size, NULL), STY_OK);
  assert_int_equal(size, sizeof bytes - 1);
  assert_memory_equal(data, bytes, sizeof bytes); /* the NUL behind it included */
  free(data);
  data = NULL;
  size = 42;
  expect_message(sty_read_file(scratch->path, sizeof bytes - 2, &data, &size, &error), STY_ERROR_INPUT, &error,
                 PARTS(scratch->path));
  assert_null(data);
  assert_int_equal(size, 42);

  write_bytes(scratch, "a", "", 0);
  assert_int_equal(sty_read_file(scratch->path, 0, &data, &size, NULL), STY_OK);
  assert_int_equal(size, 0);
  assert_int_equal(data[0], 0);
  free(data);
  data = NULL;
  unlink(scratch->path);
  expect_message(sty_read_file(scratch->path, 100, &data, &size, &error), STY_ERROR_FILE, &error, PARTS(scratch->path));
  expect_message(sty_read_file(scratch->folder, 100, &data, &size, &error), STY_ERROR_FILE, &error,
                 PARTS(scratch->folder));
  assert_null(data);
}

static void test_map_file(void **state) {
  Scratch *scratch = *state;
  StyMapping mapping = {0};
  StyError error;
  char text[10000];
  for (size_t i = 0; i < sizeof text; i++) text[i] = (char)(i * 7);
  write_bytes(scratch, "a", text, sizeof text);
  assert_int_equal(sty_map_file(scratch->path, &mapping, NULL), STY_OK);
  assert_int_equal(mapping.size, sizeof text);
  assert_memory_equal(mapping.data, text, sizeof text);
  unlink(scratch->path); /* the mapping outlives the name */
  assert_memory_equal(mapping.data, text, sizeof text);
  sty_unmap_file(&mapping);
  mapping = (StyMapping){0};
  expect_message(sty_map_file(scratch->path, &mapping, &error), STY_ERROR_FILE, &error, PARTS(scratch->path));
  expect_message(sty_map_file(scratch->folder, &mapping, &error), STY_ERROR_FILE, &error, PARTS(scratch->folder));
  assert_null(mapping.data);
  /* Nothing to map in an empty file: either way it mustn't claim bytes. */
  write_bytes(scratch, "a", "", 0);
  if (sty_map_file(scratch->path, &mapping, NULL) == STY_OK) {
    assert_int_equal(mapping.size, 0);
    sty_unmap_file(&mapping);
  }
  unlink(scratch->path);
}

static void test_hash_file(void **state) {
  Scratch *scratch = *state;
  char *million = malloc(1000000);
  assert_non_null(million);
  memset(million, 'a', 1000000);
  /* FIPS 180-4's examples. */
  const struct {
    const char *bytes;
    size_t size;
    const char *hash;
  } known[] = {
      {"", 0, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"},
      {"abc", 3, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"},
      {"abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq", 56,
       "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1"},
      {million, 1000000, "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0"},
  };
  char hash[STY_HASH_SIZE];
  for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
    write_bytes(scratch, "a", known[i].bytes, known[i].size);
    assert_int_equal(sty_hash_file(scratch->path, hash, NULL), STY_OK);
    assert_string_equal(hash, known[i].hash);
  }
  free(million);
  unlink(scratch->path);
  StyError error;
  expect_message(sty_hash_file(scratch->path, hash, &error), STY_ERROR_FILE, &error, PARTS(scratch->path));
  expect_message(sty_hash_file(scratch->folder, hash, &error), STY_ERROR_FILE, &error, PARTS(scratch->folder));
}

static void test_paths(void **state) {
  (void)state;
  static const char *const joined[][3] = {{"a", "b", "a/b"},
                                          {"a/b", "c/d.png", "a/b/c/d.png"},
                                          {"a", "/abs/b", "/abs/b"},
                                          {"/", "b", "/b"},
                                          {".", "../b", "./../b"}};
  for (size_t i = 0; i < sizeof joined / sizeof *joined; i++) {
    char *path = sty_join_path(joined[i][0], joined[i][1]);
    assert_non_null(path);
    /* Two slashes are as good as one. */
    char *to = path;
    for (const char *from = path; *from; from++)
      if (!(from[0] == '/' && from[1] == '/')) *to++ = *from;
    *to = 0;
    assert_string_equal(path, joined[i][2]);
    free(path);
  }
  static const char *const folders[][2] = {{"a/b/c.png", "a/b"}, {"c.png", "."},     {"/c.png", "/"},
                                           {"./c.png", "."},     {"../c.png", ".."}, {"/a/c", "/a"}};
  for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
    char *folder = sty_get_folder(folders[i][0]);
    assert_non_null(folder);
    assert_string_equal(folder, folders[i][1]);
    free(folder);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      scratch_test(test_output_appears_on_commit),
      scratch_test(test_output_replaces),
      scratch_test(test_discarding_nothing),
      scratch_test(test_two_writers),
      scratch_test(test_output_mode),
      scratch_test(test_output_in_bad_places),
      scratch_test(test_failed_write),
      scratch_test(test_check_file),
      scratch_test(test_read_file),
      scratch_test(test_map_file),
      scratch_test(test_hash_file),
      scratch_test(test_paths),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
