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

typedef struct Summing {
  uint32_t *counts, *first;
  int parts;
  size_t buckets;
  uint32_t begin[STY_MOST_PARTS]; /* of each range of buckets: its items' total, then where they begin */
} Summing;

static void total_range(void *context, int range, size_t begin, size_t end) {
  Summing *s = context;
  uint32_t total = 0;
  for (int part = 0; part < s->parts; part++)
    for (size_t b = begin; b < end; b++) total += s->counts[(size_t)part * s->buckets + b];
  s->begin[range] = total;
}

static void sum_range(void *context, int range, size_t begin, size_t end) {
  const Summing *s = context;
  uint32_t next = s->begin[range];
  for (size_t b = begin; b < end; b++) {
    s->first[b] = next;
    for (int part = 0; part < s->parts; part++) {
      uint32_t *own = &s->counts[(size_t)part * s->buckets + b];
      const uint32_t members = *own;
      *own = next;
      next += members;
    }
  }
  if (end == s->buckets) s->first[end] = next;
}

void sty_sum_counts(uint32_t *counts, int parts, size_t buckets, uint32_t *first, const StyRun *run) {
  Summing s = {counts, first, parts, buckets, {0}};
  const int ranges = sty_count_parts(run, buckets);
  if (ranges > 1) sty_split_items(run, buckets, ranges, total_range, &s);
  uint32_t next = 0;
  for (int range = 0; range < ranges; range++) {
    const uint32_t members = s.begin[range];
    s.begin[range] = next;
    next += members;
  }
  sty_split_items(run, buckets, ranges, sum_range, &s);
}
