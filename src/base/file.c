#include "stylut/file.h"

#include "base/leftovers.h"

#include <errno.h>
#include <fcntl.h>
#include <nettle/sha2.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

enum { ATTEMPTS = 100 };

/* A name for something in the making beside `path`, less slashes at its end; another for each attempt. The caller frees
 * it; NULL when memory is short. */
static char *name_temporary(const char *path, unsigned attempt) {
  char *name = NULL;
  int length = (int)strlen(path);
  while (length > 1 && path[length - 1] == '/') length--;
  const unsigned mark = ((unsigned)getpid() * 2654435761u + attempt * 40503u) >> 8 & 0xffffffu;
  return asprintf(&name, "%.*s.%06x", length, path, mark) < 0 ? NULL : name;
}

static int create_folder(const char *name) { return mkdir(name, 0777); }

static int create_file(const char *name) { return open(name, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666); }

/* Creates and notes a temporary beside `path`: what creating gave, or -1. */
static int create_temporary(const char *path, int (*create)(const char *name), char **out) {
  char *name = NULL;
  int made = -1;
  for (unsigned attempt = 0; made < 0 && attempt < ATTEMPTS; attempt++) {
    free(name);
    errno = ENOMEM;
    name = name_temporary(path, attempt);
    if (!name) break;
    sty_lock_leftovers();
    made = create(name);
    if (made >= 0) sty_note_leftover(name);
    sty_unlock_leftovers();
    if (made < 0 && errno != EEXIST) break;
  }
  *out = name;
  return made;
}

static StyStatus fail_temporary(const char *path, int cause, StyError *error) {
  if (cause == ENOMEM) return sty_fail_memory(error, path, (double)strlen(path));
  return sty_fail(error, STY_ERROR_FILE, "%s: cannot write: %s; expected a folder that exists and can be written to",
                  path, strerror(cause));
}

StyStatus sty_make_temporary_folder(const char *path, char **out, StyError *error) {
  char *name = NULL;
  if (create_temporary(path, create_folder, &name) == 0) {
    *out = name;
    return STY_OK;
  }
  const int cause = errno;
  free(name);
  return fail_temporary(path, cause, error);
}

/* Under its final name it is no leftover; what it changed places with is one under the temporary's. */
int sty_rename_temporary(const char *temporary, const char *path, unsigned flags) {
  sty_lock_leftovers();
  const int failed = renameat2(AT_FDCWD, temporary, AT_FDCWD, path, flags);
  if (!failed && !(flags & RENAME_EXCHANGE)) sty_forget_leftover(temporary);
  sty_unlock_leftovers();
  return failed;
}

void sty_forget_temporary(const char *temporary) {
  sty_lock_leftovers();
  sty_forget_leftover(temporary);
  sty_unlock_leftovers();
}

void sty_remove_temporary_folder(const char *temporary) {
  sty_remove_folder(temporary);
  sty_forget_temporary(temporary);
}

StyStatus sty_open_output(const char *path, StyOutput *out, StyError *error) {
  struct stat info;
  if (!*path) return sty_fail(error, STY_ERROR_USAGE, "output: found an empty name, expected a file name");
  if (stat(path, &info) == 0 && S_ISDIR(info.st_mode))
    return sty_fail(error, STY_ERROR_FILE, "%s: found a folder, expected a file name to write to", path);
  StyOutput output = {NULL, strdup(path), NULL};
  const int descriptor = output.path ? create_temporary(path, create_file, &output.temporary) : -1;
  if (descriptor < 0) {
    const int cause = errno;
    free(output.path);
    free(output.temporary);
    return fail_temporary(path, cause, error);
  }
  output.stream = fdopen(descriptor, "w+b");
  if (!output.stream) {
    close(descriptor);
    sty_discard_output(&output);
    return sty_fail_memory(error, path, BUFSIZ);
  }
  *out = output;
  return STY_OK;
}

static StyStatus fail_output(const StyOutput *output, int cause, StyError *error) {
  return sty_fail(error, STY_ERROR_FILE, "%s: cannot write: %s; expected room and permission for the whole file",
                  output->path, strerror(cause ? cause : EIO));
}

StyStatus sty_flush_output(StyOutput *output, StyError *error) {
  const int earlier = ferror(output->stream);
  errno = 0;
  return fflush(output->stream) != 0 || earlier ? fail_output(output, errno ? errno : ENOSPC, error) : STY_OK;
}

StyStatus sty_place_output(const StyOutput *output, uint64_t offset, const void *bytes, size_t size, StyError *error) {
  for (size_t done = 0; done < size;) {
    const ssize_t some =
        pwrite(fileno(output->stream), (const char *)bytes + done, size - done, (off_t)(offset + done));
    if (some > 0)
      done += (size_t)some;
    else if (some == 0 || errno != EINTR)
      return fail_output(output, some == 0 ? ENOSPC : errno, error);
  }
  return STY_OK;
}

StyStatus sty_commit_output(StyOutput *output, StyError *error) {
  StyStatus status = sty_flush_output(output, error);
  const int closed = fclose(output->stream);
  output->stream = NULL;
  if (!status && (closed != 0 || sty_rename_temporary(output->temporary, output->path, 0) != 0))
    status = fail_output(output, errno, error);
  if (!status) {
    free(output->temporary);
    output->temporary = NULL;
  }
  sty_discard_output(output);
  return status;
}

void sty_discard_output(StyOutput *output) {
  if (output->stream) fclose(output->stream);
  if (output->temporary) {
    unlink(output->temporary);
    sty_forget_temporary(output->temporary);
  }
  free(output->path);
  free(output->temporary);
  *output = (StyOutput){NULL, NULL, NULL};
}

StyStatus sty_check_file(const char *path, uint64_t *size, StyError *error) {
  struct stat info;
  if (stat(path, &info) != 0)
    return sty_fail(error, STY_ERROR_FILE, "%s: %s; expected a file to read", path, strerror(errno));
  if (!S_ISREG(info.st_mode))
    return sty_fail(error, STY_ERROR_FILE, "%s: found %s, expected a file to read", path,
                    S_ISDIR(info.st_mode) ? "a folder" : "something that isn't a regular file");
  if (access(path, R_OK) != 0)
    return sty_fail(error, STY_ERROR_FILE, "%s: %s; expected a file to read", path, strerror(errno));
  if (size) *size = (uint64_t)info.st_size;
  return STY_OK;
}

StyStatus sty_read_file(const char *path, size_t limit, unsigned char **data, size_t *size, StyError *error) {
  uint64_t length;
  const StyStatus status = sty_check_file(path, &length, error);
  if (status) return status;
  if (length > limit)
    return sty_fail(error, STY_ERROR_INPUT, "%s: found %llu bytes, expected at most %zu", path,
                    (unsigned long long)length, limit);
  FILE *stream = fopen(path, "rb");
  if (!stream) return sty_fail(error, STY_ERROR_FILE, "%s: %s; expected a file to read", path, strerror(errno));
  unsigned char *bytes = malloc((size_t)length + 1);
  if (!bytes) {
    fclose(stream);
    return sty_fail_memory(error, path, (double)length);
  }
  const size_t got = fread(bytes, 1, (size_t)length, stream);
  fclose(stream);
  if (got != length) {
    free(bytes);
    return sty_fail(error, STY_ERROR_FILE, "%s: found %zu bytes while reading, expected %llu", path, got,
                    (unsigned long long)length);
  }
  bytes[length] = 0;
  *data = bytes;
  *size = (size_t)length;
  return STY_OK;
}

StyStatus sty_map_file(const char *path, StyMapping *out, StyError *error) {
  uint64_t length;
  const StyStatus status = sty_check_file(path, &length, error);
  if (status) return status;
  if (length == 0) return sty_fail(error, STY_ERROR_INPUT, "%s: found an empty file, expected data", path);
  const int descriptor = open(path, O_RDONLY | O_CLOEXEC);
  void *memory = descriptor < 0 ? MAP_FAILED : mmap(NULL, (size_t)length, PROT_READ, MAP_PRIVATE, descriptor, 0);
  const int cause = errno;
  if (descriptor >= 0) close(descriptor);
  if (memory == MAP_FAILED && cause == ENOMEM) return sty_fail_memory(error, path, (double)length);
  if (memory == MAP_FAILED)
    return sty_fail(error, STY_ERROR_FILE, "%s: %s; expected a file to read", path, strerror(cause));
  *out = (StyMapping){memory, (size_t)length};
  return STY_OK;
}

void sty_unmap_file(StyMapping *mapping) {
  if (mapping->data) munmap((void *)(uintptr_t)mapping->data, mapping->size);
  *mapping = (StyMapping){NULL, 0};
}

void sty_rest_mapped(const void *part, size_t size) {
  const uintptr_t page = (uintptr_t)sysconf(_SC_PAGESIZE);
  const uintptr_t begin = ((uintptr_t)part + page - 1) / page * page, end = ((uintptr_t)part + size) / page * page;
  if (begin < end) madvise((void *)begin, end - begin, MADV_DONTNEED);
}

static void write_digest(struct sha256_ctx *state, char out[STY_HASH_SIZE]) {
  uint8_t digest[SHA256_DIGEST_SIZE];
  sha256_digest(state, sizeof digest, digest);
  for (int i = 0; i < SHA256_DIGEST_SIZE; i++) snprintf(out + 2 * i, 3, "%02x", digest[i]);
}

void sty_hash_bytes(const void *data, size_t size, char out[STY_HASH_SIZE]) {
  struct sha256_ctx state;
  sha256_init(&state);
  sha256_update(&state, size, data);
  write_digest(&state, out);
}

StyStatus sty_hash_file(const char *path, char out[STY_HASH_SIZE], StyError *error) {
  const StyStatus status = sty_check_file(path, NULL, error);
  if (status) return status;
  FILE *stream = fopen(path, "rb");
  if (!stream) return sty_fail(error, STY_ERROR_FILE, "%s: %s; expected a file to read", path, strerror(errno));
  struct sha256_ctx state;
  sha256_init(&state);
  unsigned char block[65536];
  size_t got;
  while ((got = fread(block, 1, sizeof block, stream)) > 0) sha256_update(&state, got, block);
  const int failed = ferror(stream);
  fclose(stream);
  if (failed) return sty_fail(error, STY_ERROR_FILE, "%s: reading failed midway; expected a file to read", path);
  write_digest(&state, out);
  return STY_OK;
}

char *sty_join_path(const char *folder, const char *name) {
  char *path = NULL;
  if (name[0] == '/' || !*folder) return strdup(name);
  const char *slash = folder[strlen(folder) - 1] == '/' ? "" : "/";
  return asprintf(&path, "%s%s%s", folder, slash, name) < 0 ? NULL : path;
}

char *sty_get_folder(const char *path) {
  const char *slash = strrchr(path, '/');
  if (!slash) return strdup(".");
  return strndup(path, slash == path ? 1 : (size_t)(slash - path));
}

const char *sty_get_base_name(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash && slash[1] ? slash + 1 : path;
}
