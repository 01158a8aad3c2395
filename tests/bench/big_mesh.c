/* Writes a torus with waves on it, of about COUNT triangles and half as many vertices: what large meshes are measured
 * with. Usage: big_mesh COUNT FILE.ply|FILE.obj|FILE.stl (PLY and STL in binary; STL has no shared vertices) */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct Torus {
  FILE *file;
  uint32_t side; /* vertices each way round */
} Torus;

static void get_vertex(const Torus *torus, uint32_t i, uint32_t j, float out[3]) {
  const double u = 2 * M_PI * (i % torus->side) / torus->side, v = 2 * M_PI * (j % torus->side) / torus->side;
  const double tube = 0.4 + 0.03 * sin(24 * u) * sin(9 * v), out_from = 1 + tube * cos(v);
  out[0] = (float)(out_from * cos(u));
  out[1] = (float)(tube * sin(v) + 0.2 * sin(2 * u));
  out[2] = (float)(out_from * sin(u));
}

/* The two triangles of a cell, by the vertices' numbers. */
static void get_cell(const Torus *torus, uint32_t i, uint32_t j, uint32_t out[2][3]) {
  const uint32_t side = torus->side, right = (i + 1) % side, up = (j + 1) % side;
  const uint32_t corners[4] = {i * side + j, right * side + j, right * side + up, i * side + up};
  static const int order[2][3] = {{0, 2, 1}, {0, 3, 2}};
  for (int t = 0; t < 2; t++)
    for (int k = 0; k < 3; k++) out[t][k] = corners[order[t][k]];
}

/* ---- formats ---- */

static void begin_file(const Torus *torus, const char *ending) {
  const uint32_t side = torus->side;
  if (strcmp(ending, ".ply") == 0)
    fprintf(torus->file,
            "ply\nformat binary_little_endian 1.0\nelement vertex %u\nproperty float x\nproperty float y\nproperty "
            "float z\nelement face %u\nproperty list uchar uint vertex_indices\nend_header\n",
            side * side, 2 * side * side);
  if (strcmp(ending, ".stl") == 0) {
    const char header[80] = "a torus";
    const uint32_t count = 2 * side * side;
    fwrite(header, sizeof header, 1, torus->file);
    fwrite(&count, sizeof count, 1, torus->file);
  }
}

static void write_vertex(const Torus *torus, const char *ending, uint32_t i, uint32_t j) {
  float at[3];
  get_vertex(torus, i, j, at);
  if (strcmp(ending, ".ply") == 0) fwrite(at, sizeof at, 1, torus->file);
  if (strcmp(ending, ".obj") == 0)
    fprintf(torus->file, "v %.7g %.7g %.7g\n", (double)at[0], (double)at[1], (double)at[2]);
}

static void write_facet(const Torus *torus, const uint32_t corners[3]) {
  float numbers[12] = {0};
  const uint16_t attributes = 0;
  for (int k = 0; k < 3; k++)
    get_vertex(torus, corners[k] / torus->side, corners[k] % torus->side, &numbers[3 + 3 * k]);
  fwrite(numbers, sizeof numbers, 1, torus->file);
  fwrite(&attributes, sizeof attributes, 1, torus->file);
}

static void write_triangle(const Torus *torus, const char *ending, const uint32_t corners[3]) {
  if (strcmp(ending, ".ply") == 0) {
    putc(3, torus->file);
    fwrite(corners, 3 * sizeof *corners, 1, torus->file);
  } else if (strcmp(ending, ".obj") == 0) {
    fprintf(torus->file, "f %u %u %u\n", corners[0] + 1, corners[1] + 1, corners[2] + 1);
  } else {
    write_facet(torus, corners);
  }
}

int main(int argc, char **argv) {
  const char *ending = argc == 3 ? strrchr(argv[2], '.') : NULL;
  const double count = argc == 3 ? strtod(argv[1], NULL) : 0;
  if (!ending || !(count >= 18 && count <= 4e8)) {
    fprintf(stderr, "usage: big_mesh COUNT FILE.ply|FILE.obj|FILE.stl, with a count from 18 to 4e8\n");
    return EXIT_FAILURE;
  }
  const Torus torus = {fopen(argv[2], "wb"), (uint32_t)lround(sqrt(count / 2))};
  if (!torus.file) {
    perror(argv[2]);
    return EXIT_FAILURE;
  }
  begin_file(&torus, ending);
  for (uint32_t i = 0; i < torus.side; i++)
    for (uint32_t j = 0; j < torus.side; j++) write_vertex(&torus, ending, i, j);
  for (uint32_t i = 0; i < torus.side; i++)
    for (uint32_t j = 0; j < torus.side; j++) {
      uint32_t cell[2][3];
      get_cell(&torus, i, j, cell);
      for (int t = 0; t < 2; t++) write_triangle(&torus, ending, cell[t]);
    }
  const int failed = ferror(torus.file) | fclose(torus.file);
  if (failed) perror(argv[2]);
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
