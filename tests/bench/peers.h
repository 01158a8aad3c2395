/* Other libraries' searches, raw: one neighbour, ties as they fall. For the
 * benchmark only. */
#ifndef STYLUT_TESTS_BENCH_PEERS_H
#define STYLUT_TESTS_BENCH_PEERS_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Builds an index over `count` points (x, y) and answers `query_count` queries,
 * one thread; nearest[q] is a point's number. Milliseconds of both together, or
 * a negative number when the library failed. */
typedef double Peer(const float *points, size_t count, const float *queries, size_t query_count, int *nearest);
Peer search_with_nanoflann, search_with_flann, search_with_cgal;

#ifdef __cplusplus
}
#endif
#endif
