/* A stable counting sort on several threads: each counts its part of the items by
 * bucket, then moves them to where they belong. */
#ifndef STYLUT_SRC_LUT_DEAL_H
#define STYLUT_SRC_LUT_DEAL_H

#include <stddef.h>
#include <stdint.h>

#include "stylut/parallel.h"

/* Calls body(context, part, begin, end) for `parts` equal parts of `count` items, in
 * any order, on the threads of `run`. */
void sty_split_items(const StyRun *run, size_t count, int parts,
                     void (*body)(void *context, int part, size_t begin, size_t end), void *context);

/* How many parts are worth while: one per thread, few of few items, and at most STY_MOST_PARTS. */
enum { STY_MOST_PARTS = 8 };
int sty_count_parts(const StyRun *run, size_t count);

/* Turns counts, part after part of `buckets` each, into where each part's items
 * of a bucket begin when all are sorted by bucket and, within one, stay in their
 * order. `first` has room for buckets + 1 and receives where each bucket begins. */
void sty_sum_counts(uint32_t *counts, int parts, size_t buckets, uint32_t *first, const StyRun *run);

#endif
