/* Guides that try to hurt a search: what test_zoo.c and zoo.c run the engines on. */
#ifndef STYLUT_TESTS_ZOO_CASES_H
#define STYLUT_TESTS_ZOO_CASES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "stylut/image.h"

/* A pixel about to be drawn. */
typedef struct ZooPixel {
  int x, y, width, height;
  size_t index, count; /* row-major; of all pixels */
} ZooPixel;

typedef struct ZooCase {
  const char *name;
  const char *what; /* in a line */
  int width, height;
  int table; /* texels a side */
  int bits;  /* values are rounded to those of so many bits; 32: not at all */
  /* The guide value g[0], g[1]; false: the pixel isn't covered. */
  bool (*draw)(const ZooPixel *pixel, float g[2]);
  const char *refusal; /* NULL, or what the one message must say */
  const float *asked;  /* NULL, or the guide value that is to be refused as a question */
} ZooCase;

/* The last has a NULL name. */
extern const ZooCase zoo_cases[];

/* Guides of a million pixels are for zoo.c alone. */
static inline bool is_zoo_case_large(const ZooCase *zoo) { return (size_t)zoo->width * (size_t)zoo->height > 100000; }

/* The guide, channels A, normal.X, .Y and .Z; with one pixel of noise if `noisy`:
 * covered, and of a value that no other pixel has. The caller destroys it; NULL
 * when memory is short. */
StyImage *make_zoo_guide(const ZooCase *zoo, bool noisy);

/* Whether the guide is refused for what it holds. An empty one is not once it has a pixel of noise. */
bool is_zoo_refused(const ZooCase *zoo, bool noisy);

#endif
