/* paint: our own exemplars, painted by code.
 *
 *   paint OUTDIR            all media, as OUTDIR/MEDIUM.png
 *   paint MEDIUM OUT.png    one of them
 *
 * Each is a sphere that fills its 512 x 512 square exactly: the source that
 * example-based stylization copies from. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "media.h"
#include "stylut/image_io.h"

typedef struct Medium {
  const char *name;
  Canvas *(*paint)(void);
} Medium;

static const Medium media[] = {
    {"pencil", paint_pencil}, {"stipple", paint_stipple},   {"watercolour", paint_watercolour},
    {"oil", paint_oil},       {"charcoal", paint_charcoal},
};

#define MEDIUM_COUNT (sizeof media / sizeof media[0])

static StyStatus write_medium(const Medium *medium, const char *path, StyError *error) {
  Canvas *canvas = medium->paint();
  if (canvas == NULL) {
    return sty_fail_memory(error, "the canvas", (double)CANVAS_PIXELS * 40.0);
  }
  StyImage *image = NULL;
  StyStatus status = develop_canvas(canvas, &image, error);
  destroy_canvas(canvas);
  if (status == STY_OK) {
    status = sty_write_image(path, image, error);
    sty_destroy_image(&image);
  }
  return status;
}

static StyStatus write_all(const char *folder, StyError *error) {
  for (size_t i = 0; i < MEDIUM_COUNT; i++) {
    size_t size = strlen(folder) + strlen(media[i].name) + sizeof "/.png";
    char *path = malloc(size);
    if (path == NULL) {
      return sty_fail_memory(error, "a file name", (double)size);
    }
    snprintf(path, size, "%s/%s.png", folder, media[i].name);
    StyStatus status = write_medium(&media[i], path, error);
    free(path);
    if (status != STY_OK) {
      return status;
    }
  }
  return STY_OK;
}

static const Medium *find_medium(const char *name) {
  for (size_t i = 0; i < MEDIUM_COUNT; i++) {
    if (strcmp(media[i].name, name) == 0) {
      return &media[i];
    }
  }
  return NULL;
}

static void print_usage(FILE *stream) {
  fprintf(stream, "Usage: paint OUTDIR\n       paint MEDIUM OUT.png\nMEDIUM is one of:");
  for (size_t i = 0; i < MEDIUM_COUNT; i++) {
    fprintf(stream, " %s", media[i].name);
  }
  fputc('\n', stream);
}

int main(int argc, char **argv) {
  StyError error = {.status = STY_OK};
  if (argc == 2 && strcmp(argv[1], "--help") == 0) {
    print_usage(stdout);
    return STY_OK;
  }
  const Medium *medium = argc == 3 ? find_medium(argv[1]) : NULL;
  if (argc != 2 && medium == NULL) {
    print_usage(stderr);
    return STY_ERROR_USAGE;
  }
  StyStatus status = medium != NULL ? write_medium(medium, argv[2], &error) : write_all(argv[1], &error);
  if (status != STY_OK) {
    fprintf(stderr, "paint: error: %s\n", error.text);
  }
  return status;
}
