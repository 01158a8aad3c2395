/* How calm a style lies on frames, from the nearest-neighbour fields that
 * `stylize --nnf` writes. A line per field, CSV:
 *   field    its file name
 *   covered  pixels
 *   piece    the mean size, pixels, of the piece that a covered pixel belongs to:
 *            pixels that are connected and whose source pixel advances with them
 *   moved    share of the pixels covered in the field before as well whose source
 *            pixel is more than FAR away from the one it was there; empty for the first
 * Usage: pieces NNF.png... */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "stylut/image_io.h"

enum { FAR = 64 };

typedef struct Field {
  const char *name;
  StyImage *image;
  const float *x, *y, *covered;
} Field;

static void require(StyStatus status, const StyError *error) {
  if (!status) return;
  fprintf(stderr, "pieces: %s\n", error->text);
  exit(EXIT_FAILURE);
}

static Field read_field(const char *name) {
  StyError error;
  Field field = {.name = name};
  require(sty_read_image(name, &field.image, &error), &error);
  field.x = sty_find_channel(field.image, "R");
  field.y = sty_find_channel(field.image, "G");
  field.covered = sty_find_channel(field.image, "A");
  if (field.image->bits != 16 || !field.x || !field.y || !field.covered)
    require(sty_fail(&error, STY_ERROR_INPUT, "%s: found no field, expected 16 bits a channel and R G B A", name),
            &error);
  return field;
}

static int get_coordinate(const float *plane, int pixel) { return (int)lrintf(plane[pixel] * 65535); }

/* Whether pixel q, (dx, dy) beside p, continues p's piece. */
static bool continues(const Field *field, int p, int q, int dx, int dy) {
  return field->covered[q] > 0 && get_coordinate(field->x, q) - get_coordinate(field->x, p) == dx &&
         get_coordinate(field->y, q) - get_coordinate(field->y, p) == dy;
}

/* Pixels of the piece around a covered one; marks them as seen. */
static long fill_piece(const Field *field, int start, bool *seen, int *queue) {
  static const int steps[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  const int width = field->image->width, height = field->image->height;
  long count = 0;
  queue[count++] = start;
  seen[start] = true;
  for (long at = 0; at < count; at++)
    for (int s = 0; s < 4; s++) {
      const int x = queue[at] % width + steps[s][0], y = queue[at] / width + steps[s][1], q = y * width + x;
      if (x < 0 || y < 0 || x >= width || y >= height || seen[q] ||
          !continues(field, queue[at], q, steps[s][0], steps[s][1]))
        continue;
      seen[q] = true;
      queue[count++] = q;
    }
  return count;
}

static double measure_pieces(const Field *field, long *covered) {
  const size_t pixels = sty_count_pixels(field->image);
  bool *seen = calloc(pixels, sizeof *seen);
  int *queue = malloc(pixels * sizeof *queue);
  if (!seen || !queue) {
    fprintf(stderr, "pieces: found too little memory for %zu pixels\n", pixels);
    exit(EXIT_FAILURE);
  }
  double squares = 0;
  *covered = 0;
  for (int p = 0; p < (int)pixels; p++) {
    if (seen[p] || !(field->covered[p] > 0)) continue;
    const long count = fill_piece(field, p, seen, queue);
    squares += (double)count * (double)count;
    *covered += count;
  }
  free(seen);
  free(queue);
  return *covered ? squares / (double)*covered : 0;
}

static double measure_moved(const Field *before, const Field *now) {
  StyError error;
  if (before->image->width != now->image->width || before->image->height != now->image->height)
    require(sty_fail(&error, STY_ERROR_INPUT, "%s: found %dx%d pixels, expected %dx%d as of %s", now->name,
                     now->image->width, now->image->height, before->image->width, before->image->height, before->name),
            &error);
  long both = 0, moved = 0;
  for (int p = 0; p < (int)sty_count_pixels(now->image); p++) {
    if (!(before->covered[p] > 0) || !(now->covered[p] > 0)) continue;
    const double dx = get_coordinate(now->x, p) - get_coordinate(before->x, p);
    const double dy = get_coordinate(now->y, p) - get_coordinate(before->y, p);
    both++;
    moved += dx * dx + dy * dy > FAR * FAR;
  }
  return both ? (double)moved / (double)both : 0;
}

int main(int argc, char **argv) {
  if (argc < 2) {
    fprintf(stderr, "Usage: pieces NNF.png...\n");
    return EXIT_FAILURE;
  }
  printf("field,covered,piece,moved\n");
  Field before = {0};
  for (int i = 1; i < argc; i++) {
    Field now = read_field(argv[i]);
    long covered;
    const double piece = measure_pieces(&now, &covered);
    printf("%s,%ld,%.2f,", now.name, covered, piece);
    if (before.image) printf("%.5f", measure_moved(&before, &now));
    printf("\n");
    sty_destroy_image(&before.image);
    before = now;
  }
  sty_destroy_image(&before.image);
  return EXIT_SUCCESS;
}
