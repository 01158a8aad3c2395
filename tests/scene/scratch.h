/* A temporary folder with files for one test program, and meshes to put there. */
#ifndef STYLUT_TESTS_SCRATCH_H
#define STYLUT_TESTS_SCRATCH_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "stylut/scene.h"

typedef struct Scratch {
  char folder[512];
  char path[768]; /* of the file written last */
} Scratch;

static inline int open_scratch(void **state) {
  Scratch *scratch = calloc(1, sizeof *scratch);
  const char *parent = getenv("TMPDIR");
  if (!scratch) return -1;
  snprintf(scratch->folder, sizeof scratch->folder, "%s/stylut-test-XXXXXX", parent && *parent ? parent : "/tmp");
  *state = scratch;
  return mkdtemp(scratch->folder) ? 0 : -1;
}

static inline int close_scratch(void **state) {
  Scratch *scratch = *state;
  const int result = rmdir(scratch->folder);
  free(scratch);
  return result;
}

static inline const char *write_bytes(Scratch *scratch, const char *name, const void *bytes, size_t size) {
  snprintf(scratch->path, sizeof scratch->path, "%s/%s", scratch->folder, name);
  FILE *file = fopen(scratch->path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(bytes, 1, size, file), size);
  assert_int_equal(fclose(file), 0);
  return scratch->path;
}

/* Reads the mesh whose text is given, and takes the file away again. */
static inline StyStatus read_text_mesh(Scratch *scratch, const char *name, const char *text, double crease_angle,
                                       StyMesh **mesh, StyError *error) {
  const StyMeshOptions options = {.crease_angle = crease_angle};
  const StyStatus status = sty_read_mesh(write_bytes(scratch, name, text, strlen(text)), &options, mesh, error);
  unlink(scratch->path);
  return status;
}

/* The same as a scene of its own. */
static inline StyStatus read_text_scene(Scratch *scratch, const char *name, const char *text, double crease_angle,
                                        StyScene **scene, StyError *error) {
  StyMesh *mesh = NULL;
  const StyStatus status = read_text_mesh(scratch, name, text, crease_angle, &mesh, error);
  return status ? status : sty_wrap_mesh(&mesh, scene, error);
}

/* The cube [-1, 1]^3 of six quads, without normals. */
#define CUBE_OBJ                                 \
  "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\n" \
  "v -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"     \
  "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4\n"

/* A tetrahedron of the given size, its corner at (at, at, at). */
static inline void print_tetrahedron(char *text, size_t size, double at, double edge) {
  const double far_end = at + edge;
  snprintf(text, size,
           "v %.9g %.9g %.9g\nv %.9g %.9g %.9g\nv %.9g %.9g %.9g\nv %.9g %.9g %.9g\n"
           "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
           at, at, at, far_end, at, at, at, far_end, at, at, at, far_end);
}

#endif
