/* Other libraries' searches, raw: one neighbour, ties as they fall, nothing
 * checked before. For the benchmark and the zoo only. */
#ifndef STYLUT_TESTS_BENCH_PEERS_H
#define STYLUT_TESTS_BENCH_PEERS_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Builds an index over `count` points (x, y) and answers `query_count` queries,
 * one thread; nearest[q] is a point's number, or something else where the library
 * finds none. Milliseconds of both together, or a negative number when the library
 * says that it failed. */
typedef double Peer(const float *points, size_t count, const float *queries, size_t query_count, int *nearest);
Peer search_with_nanoflann, search_with_flann, search_with_cgal;
Peer search_with_flann_forest, search_with_flann_linear; /* 4 trees and 32 checks; every point */

const char *get_nanoflann_version(void);

#ifdef __cplusplus
}
#endif
#endif
