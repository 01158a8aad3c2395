#include "lut/deal.h"

/* Fewer items aren't worth a thread. */
enum { LEAST_ITEMS = 1 << 14 };

int sty_count_parts(const StyRun *run, size_t count) {
  const size_t worth = count / LEAST_ITEMS;
  const int threads = sty_get_threads(run), most = threads < STY_MOST_PARTS ? threads : STY_MOST_PARTS;
  return worth < 1 ? 1 : worth < (size_t)most ? (int)worth : most;
}

typedef struct Split {
  size_t count;
  int parts;
  void (*body)(void *context, int part, size_t begin, size_t end);
  void *context;
} Split;

static StyStatus do_part(void *context, long part, StyError *error) {
  (void)error;
  const Split *split = context;
  const size_t p = (size_t)part, parts = (size_t)split->parts;
  split->body(split->context, (int)part, split->count * p / parts, split->count * (p + 1) / parts);
  return STY_OK;
}

void sty_split_items(const StyRun *run, size_t count, int parts,
                     void (*body)(void *context, int part, size_t begin, size_t end), void *context) {
  Split split = {count, parts, body, context};
  /* Progress is the caller's to tell. */
  sty_parallel_for(&(StyRun){.threads = sty_get_threads(run)}, parts, do_part, &split, NULL);
}

void sty_sum_counts(uint32_t *counts, int parts, size_t buckets, uint32_t *first) {
  uint32_t next = 0;
  for (size_t b = 0; b < buckets; b++) {
    first[b] = next;
    for (int part = 0; part < parts; part++) {
      uint32_t *own = &counts[(size_t)part * buckets + b];
      const uint32_t members = *own;
      *own = next;
      next += members;
    }
  }
  first[buckets] = next;
}
