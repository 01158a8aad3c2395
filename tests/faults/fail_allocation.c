/* For LD_PRELOAD: the FAIL_ALLOCATION-th allocation that the program itself asks for fails, those of libraries don't.
 * Without that number, or with 0, none does; how many there were is written to the file FAIL_COUNT at the end. */
#include <dlfcn.h>
#include <errno.h>
#include <link.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

static uintptr_t text_begin, text_end;
static long wanted;
static atomic_long count;

/* The first is the program. */
static int find_text(struct dl_phdr_info *info, size_t size, void *context) {
  (void)size, (void)context;
  for (int i = 0; i < info->dlpi_phnum; i++) {
    const ElfW(Phdr) *header = &info->dlpi_phdr[i];
    if (header->p_type != PT_LOAD || !(header->p_flags & PF_X)) continue;
    text_begin = info->dlpi_addr + header->p_vaddr;
    text_end = text_begin + header->p_memsz;
  }
  return 1;
}

__attribute__((constructor)) static void begin(void) {
  const char *text = getenv("FAIL_ALLOCATION");
  wanted = text ? atol(text) : 0;
  dl_iterate_phdr(find_text, NULL);
}

__attribute__((destructor)) static void end(void) {
  const char *name = getenv("FAIL_COUNT");
  FILE *file = name ? fopen(name, "w") : NULL;
  if (!file) return;
  fprintf(file, "%ld\n", atomic_load(&count));
  fclose(file);
}

static int fails(const void *caller) {
  if ((uintptr_t)caller < text_begin || (uintptr_t)caller >= text_end) return 0;
  if (atomic_fetch_add(&count, 1) + 1 != wanted) return 0;
  errno = ENOMEM;
  return 1;
}

#define CALLER __builtin_return_address(0)

void *malloc(size_t size) { return fails(CALLER) ? NULL : __libc_malloc(size); }
void *calloc(size_t n, size_t size) { return fails(CALLER) ? NULL : __libc_calloc(n, size); }
void *realloc(void *old, size_t size) { return fails(CALLER) ? NULL : __libc_realloc(old, size); }
void *aligned_alloc(size_t alignment, size_t size) { return fails(CALLER) ? NULL : __libc_memalign(alignment, size); }

int posix_memalign(void **out, size_t alignment, size_t size) {
  if (fails(CALLER)) return ENOMEM;
  *out = __libc_memalign(alignment, size);
  return *out ? 0 : ENOMEM;
}

char *strndup(const char *text, size_t most) {
  const size_t length = strnlen(text, most);
  char *copy = fails(CALLER) ? NULL : __libc_malloc(length + 1);
  if (!copy) return NULL;
  memcpy(copy, text, length);
  copy[length] = 0;
  return copy;
}

char *strdup(const char *text) {
  const size_t size = strlen(text) + 1;
  char *copy = fails(CALLER) ? NULL : __libc_malloc(size);
  return copy ? memcpy(copy, text, size) : NULL;
}

int asprintf(char **out, const char *format, ...) {
  *out = NULL;
  if (fails(CALLER)) return -1;
  va_list arguments;
  va_start(arguments, format);
  const int length = vasprintf(out, format, arguments);
  va_end(arguments);
  return length;
}

FILE *open_memstream(char **text, size_t *size) {
  static FILE *(*real)(char **, size_t *);
  if (fails(CALLER)) return NULL;
  if (!real) *(void **)&real = dlsym(RTLD_NEXT, "open_memstream");
  return real(text, size);
}
