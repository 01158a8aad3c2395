/* What the fuzz targets share: the fuzzer's bytes handed out piece by piece, and
 * what every call of ours is held to. A target is one function; libFuzzer calls
 * it in config=fuzz, replay.c everywhere else. */
#ifndef STYLUT_TESTS_FUZZ_H
#define STYLUT_TESTS_FUZZ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "stylut/status.h"

/* libFuzzer's name for it. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A crash that says why. */
#define require(truth) ((truth) ? (void)0 : stop_at(__FILE__, __LINE__, #truth))
static inline void stop_at(const char *file, int line, const char *truth) {
  fprintf(stderr, "%s:%d: not so: %s\n", file, line, truth);
  abort();
}

/* A failed call says one line. */
static inline void require_message(StyStatus status, const StyError *error) {
  require(status >= STY_ERROR_USAGE && status <= STY_FILES_DIFFER);
  require(error->status == status);
  require(error->text[0] && strlen(error->text) < sizeof error->text);
  for (const char *c = error->text; *c; c++) require((unsigned char)*c >= 0x20 && *c != 0x7f);
}

/* What is left of the fuzzer's bytes. */
typedef struct Supply {
  const uint8_t *bytes;
  size_t size;
} Supply;

/* The next byte; 0 when all are spent. */
static inline unsigned take(Supply *supply) {
  if (!supply->size) return 0;
  supply->size--;
  return *supply->bytes++;
}

/* `count` bytes, little-endian. */
static inline uint32_t take_number(Supply *supply, int count) {
  uint32_t number = 0;
  for (int i = 0; i < count; i++) number |= (uint32_t)take(supply) << 8 * i;
  return number;
}

/* The i-th of all that is left, over and over; 0 where nothing is. */
static inline uint8_t peek(const Supply *supply, size_t i) {
  return supply->size ? supply->bytes[i % supply->size] : 0;
}

/* A folder for this process, removed with what put_file wrote there when it ends. */
const char *get_folder(void);

/* Writes a file in that folder; its path is good until the next call. */
const char *put_file(const char *name, const uint8_t *bytes, size_t size);

#endif
