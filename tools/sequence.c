#include "sequence.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "stylut/file.h"
#include "stylut/parse.h"

enum { MOST_FRAME_FILES = 1000000, MOST_DIGITS = 9 };

/* The place for a number: where it begins, and how many bytes and digits it has. */
typedef struct Place {
  size_t begin, length;
  int digits;
} Place;

static bool find_place(const char *name, size_t from, Place *out) {
  const char *at = strchr(name + from, '%');
  if (!at) return false;
  const char *end = at + 1;
  int digits = 1;
  if (*end == '0' && isdigit((unsigned char)end[1]) && end[1] != '0') {
    digits = end[1] - '0';
    end += 2;
  }
  *out = (Place){(size_t)(at - name), *end == 'd' ? (size_t)(end + 1 - at) : 0, digits};
  return true;
}

StyStatus find_pattern(const char *option, const char *name, bool *out, StyError *error) {
  Place place, other;
  *out = find_place(name, 0, &place);
  if (!*out) return STY_OK;
  if (place.length == 0 || find_place(name, place.begin + place.length, &other))
    return sty_fail(error, STY_ERROR_USAGE, "option '%s': found '%s', expected one %%d or %%0Nd for the frame's number",
                    option, name);
  return STY_OK;
}

StyStatus refuse_pattern(const char *option, const char *name, const char *expected, StyError *error) {
  bool is_pattern;
  const StyStatus status = find_pattern(option, name, &is_pattern, error);
  if (status || !is_pattern) return status;
  return sty_fail(error, STY_ERROR_USAGE, "option '%s': found '%s', expected no place for a number: %s", option, name,
                  expected);
}

char *name_frame(const char *pattern, int number) {
  Place place;
  if (!find_place(pattern, 0, &place) || place.length == 0) return strdup(pattern);
  const size_t size = strlen(pattern) + MOST_DIGITS + 2;
  char *name = malloc(size);
  if (name)
    snprintf(name, size, "%.*s%0*d%s", (int)place.begin, pattern, place.digits, number,
             pattern + place.begin + place.length);
  return name;
}

static int compare_numbers(const void *a, const void *b) {
  return (*(const int *)a > *(const int *)b) - (*(const int *)a < *(const int *)b);
}

static StyStatus add_number(Sequence *sequence, int number, int *room, StyError *error) {
  if (sequence->count == *room) {
    const int grown = *room ? 2 * *room : 64;
    int *numbers = realloc(sequence->numbers, (size_t)grown * sizeof *numbers);
    if (!numbers) return sty_fail_memory(error, "frames", (double)grown * sizeof *numbers);
    sequence->numbers = numbers;
    *room = grown;
  }
  sequence->numbers[sequence->count++] = number;
  return STY_OK;
}

/* The number in a file's name, if it is one that the pattern would give. */
static bool read_number(const char *pattern, const char *file, int *out) {
  Place place;
  if (!find_place(pattern, 0, &place) || strncmp(file, pattern, place.begin) != 0) return false;
  char digits[MOST_DIGITS + 1];
  const size_t count = strspn(file + place.begin, "0123456789");
  if (count < 1 || count > MOST_DIGITS) return false;
  snprintf(digits, sizeof digits, "%.*s", (int)count, file + place.begin);
  *out = (int)strtol(digits, NULL, 10);
  char *name = name_frame(pattern, *out);
  const bool is_same = name && strcmp(name, file) == 0;
  free(name);
  return is_same;
}

static StyStatus find_on_disk(const char *pattern, Sequence *out, StyError *error) {
  const char *slash = strrchr(pattern, '/'), *name = slash ? slash + 1 : pattern;
  char *folder_name = sty_get_folder(pattern);
  if (!folder_name) return sty_fail_memory(error, pattern, 0);
  if (strchr(folder_name, '%')) {
    free(folder_name);
    return sty_fail(error, STY_ERROR_USAGE, "%s: found the number in a folder's name, expected --frames then", pattern);
  }
  StyStatus status = STY_OK;
  int room = 0, number;
  DIR *folder = opendir(*folder_name ? folder_name : ".");
  if (!folder)
    status = sty_fail(error, STY_ERROR_FILE, "%s: cannot read its folder: %s", pattern, strerror(errno));
  else
    for (const struct dirent *entry; !status && out->count < MOST_FRAME_FILES && (entry = readdir(folder));)
      if (read_number(name, entry->d_name, &number)) status = add_number(out, number, &room, error);
  if (folder) closedir(folder);
  free(folder_name);
  if (!status && out->count == 0)
    status = sty_fail(error, STY_ERROR_FILE, "%s: found no such file, expected frames by that pattern", pattern);
  if (!status) qsort(out->numbers, (size_t)out->count, sizeof *out->numbers, compare_numbers);
  return status;
}

/* "A", "A-B" or "A-BxSTEP". */
static StyStatus read_range(const char *text, int range[3], StyError *error) {
  int length = 0;
  range[2] = 1;
  const int found = sscanf(text, "%9d%n-%9d%n", &range[0], &length, &range[1], &length);
  if (found == 1) range[1] = range[0];
  bool is_fine = found >= 1 && isdigit((unsigned char)*text) && range[0] <= range[1];
  if (is_fine && text[length] == 'x') {
    long long step;
    is_fine = !sty_parse_integer("--frames", text + length + 1, 1, MOST_FRAME_FILES, &step, NULL);
    if (is_fine) range[2] = (int)step;
  } else {
    is_fine = is_fine && text[length] == 0;
  }
  return is_fine ? STY_OK
                 : sty_fail(error, STY_ERROR_USAGE, "option '--frames': found '%s', expected A, A-B or A-BxSTEP", text);
}

static StyStatus check_presence(const char *pattern, int number, bool skip_missing, bool *is_there, StyError *error) {
  char *name = name_frame(pattern, number);
  if (!name) return sty_fail_memory(error, pattern, 0);
  *is_there = access(name, F_OK) == 0;
  StyStatus status = STY_OK;
  if (!*is_there && !skip_missing)
    status = sty_fail(error, STY_ERROR_FILE, "%s: found no such frame, expected it, or --skip-missing", name);
  free(name);
  return status;
}

/* Every frame of the range that has a file; where no range was asked for, what lies between the first and the last. */
static StyStatus list_present(const char *pattern, const int range[3], bool skip_missing, Sequence *out,
                              StyError *error) {
  StyStatus status = STY_OK;
  int room = 0;
  if ((range[1] - range[0]) / range[2] >= MOST_FRAME_FILES)
    return sty_fail(error, STY_ERROR_USAGE, "%s: found frames %d to %d asked for, expected at most %d of them", pattern,
                    range[0], range[1], MOST_FRAME_FILES);
  for (long long number = range[0]; !status && number <= range[1]; number += range[2]) {
    bool is_there = false;
    status = check_presence(pattern, (int)number, skip_missing, &is_there, error);
    if (!status && is_there) status = add_number(out, (int)number, &room, error);
    out->missing += !is_there;
  }
  if (!status && out->count == 0)
    status = sty_fail(error, STY_ERROR_FILE, "%s: found none of the frames asked for, expected some", pattern);
  return status;
}

StyStatus list_frames(const char *pattern, const char *range_text, bool skip_missing, Sequence *out, StyError *error) {
  Sequence found = {0}, listed = {0};
  int range[3] = {0, 0, 1};
  StyStatus status = find_pattern("--guide", pattern, &listed.is_pattern, error);
  int room = 0;
  if (!status && !listed.is_pattern) {
    status = add_number(&listed, 0, &room, error);
  } else if (!status) {
    if (range_text) {
      status = read_range(range_text, range, error);
    } else {
      status = find_on_disk(pattern, &found, error);
      if (!status) range[0] = found.numbers[0], range[1] = found.numbers[found.count - 1];
    }
    if (!status) status = list_present(pattern, range, skip_missing, &listed, error);
  }
  free(found.numbers);
  if (status)
    free(listed.numbers);
  else
    *out = listed;
  return status;
}
