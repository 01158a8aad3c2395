/* Feeds files to a fuzz target one after the other, in place of libFuzzer:
 *   fuzz_NAME FILE|FOLDER...
 * Each in a block of exactly its size, so that sanitizers see what reads past it. */
#include <dirent.h>
#include <sys/stat.h>

#include "fuzz.h"

static size_t replayed;

static void replay_file(const char *path, size_t size) {
  FILE *file = fopen(path, "rb");
  uint8_t *bytes = malloc(size);
  require(file && (bytes || !size));
  require(fread(bytes, 1, size, file) == size);
  fclose(file);
  fprintf(stderr, "%s\n", path); /* said first: it may be the last */
  LLVMFuzzerTestOneInput(bytes, size);
  free(bytes);
  replayed++;
}

static void replay(const char *path) {
  struct stat info;
  if (stat(path, &info)) {
    perror(path);
    exit(1);
  }
  if (!S_ISDIR(info.st_mode)) {
    replay_file(path, (size_t)info.st_size);
    return;
  }
  struct dirent **entries;
  const int count = scandir(path, &entries, NULL, alphasort);
  require(count >= 0);
  for (int i = 0; i < count; i++) {
    char inside[4096];
    snprintf(inside, sizeof inside, "%s/%s", path, entries[i]->d_name);
    if (entries[i]->d_name[0] != '.') replay(inside);
    free(entries[i]);
  }
  free(entries);
}

int main(int argc, char **argv) {
  for (int i = 1; i < argc; i++) replay(argv[i]);
  fprintf(stderr, "%zu files\n", replayed);
  return replayed ? 0 : 1;
}
