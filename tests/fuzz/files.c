#include <dirent.h>
#include <unistd.h>

#include "fuzz.h"

static char folder[512], path[1024];

static void remove_folder(void) {
  DIR *entries = opendir(folder);
  for (const struct dirent *entry; entries && (entry = readdir(entries)) != NULL;) {
    snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
    unlink(path);
  }
  if (entries) closedir(entries);
  rmdir(folder);
}

const char *get_folder(void) {
  if (!*folder) {
    const char *parent = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/stylut-fuzz-XXXXXX", parent && *parent ? parent : "/tmp");
    require(mkdtemp(folder));
    atexit(remove_folder);
  }
  return folder;
}

const char *put_file(const char *name, const uint8_t *bytes, size_t size) {
  snprintf(path, sizeof path, "%s/%s", get_folder(), name);
  FILE *file = fopen(path, "wb");
  require(file);
  require(fwrite(bytes, 1, size, file) == size);
  require(fclose(file) == 0);
  return path;
}
