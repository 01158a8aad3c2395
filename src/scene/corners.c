#include "scene/corners.h"

#include <stdlib.h>
#include <string.h>

#include "scene/forest.h"
#include "scene/vector.h"

/* An edge that more triangles share than this is a tangle; it stays hard, and
 * comparing all its pairs stays cheap. */
enum { MAX_EDGE_TRIANGLES = 8 };

static uint32_t hash_bytes(const void *data, size_t size) {
  uint64_t hash = 0x9E3779B97F4A7C15u;
  for (size_t i = 0; i < size; i += sizeof(uint32_t)) {
    uint32_t word;
    memcpy(&word, (const char *)data + i, sizeof word);
    hash = (hash ^ word) * 0xD6E8FEB86659FD93u;
    hash ^= hash >> 32;
  }
  return (uint32_t)hash;
}

StyStatus sty_number_corners(const StyCorner *corners, size_t count, size_t size, uint32_t *ids, size_t *distinct,
                             StyError *error) {
  size_t capacity = 16;
  while (capacity < 2 * count) capacity *= 2;
  uint32_t *slots = malloc(capacity * sizeof *slots);
  if (!slots) return sty_fail_memory(error, "shared vertices", (double)(capacity * sizeof *slots));
  memset(slots, 0xFF, capacity * sizeof *slots);
  uint32_t next = 0;
  for (size_t i = 0; i < count; i++) {
    size_t slot = hash_bytes(&corners[i], size) & (capacity - 1);
    while (slots[slot] != UINT32_MAX && memcmp(&corners[slots[slot]], &corners[i], size) != 0)
      slot = (slot + 1) & (capacity - 1);
    if (slots[slot] == UINT32_MAX) {
      slots[slot] = (uint32_t)i;
      ids[i] = next++;
    } else {
      ids[i] = ids[slots[slot]];
    }
  }
  free(slots);
  *distinct = next;
  return STY_OK;
}

typedef struct Smoothing {
  size_t triangle_count, corner_count;
  uint32_t *ids;     /* position number per corner */
  uint32_t *parents; /* union-find forest over corners */
  StyEdge *edges;    /* 1 per corner */
  double *facets;    /* 3 per triangle, unit normals */
  double *sums;      /* 3 per corner, used at the roots */
  double cosine;     /* facets that bend less than this are joined */
} Smoothing;

static void free_smoothing(Smoothing *s) {
  free(s->ids);
  free(s->parents);
  free(s->edges);
  free(s->facets);
  free(s->sums);
}

static StyStatus allocate_smoothing(Smoothing *s, size_t triangle_count, StyError *error) {
  size_t n = 3 * triangle_count;
  *s = (Smoothing){.triangle_count = triangle_count, .corner_count = n};
  s->ids = malloc(n * sizeof *s->ids);
  s->parents = malloc(n * sizeof *s->parents);
  s->edges = malloc(n * sizeof *s->edges);
  s->facets = malloc(n * sizeof *s->facets);
  s->sums = calloc(3 * n, sizeof *s->sums);
  if (s->ids && s->parents && s->edges && s->facets && s->sums) return STY_OK;
  free_smoothing(s);
  return sty_fail_memory(error, "smooth normals",
                         (double)n * (2 * sizeof(uint32_t) + sizeof(StyEdge) + 4 * sizeof(double)));
}

static int compare_edges(const void *a, const void *b) {
  const StyEdge *x = a, *y = b;
  if (x->low != y->low) return x->low < y->low ? -1 : 1;
  if (x->high != y->high) return x->high < y->high ? -1 : 1;
  return (x->corner > y->corner) - (x->corner < y->corner);
}

void sty_list_edges(const uint32_t *ids, size_t corner_count, StyEdge *edges) {
  for (uint32_t c = 0; c < corner_count; c++) {
    const uint32_t from = ids[c], to = ids[sty_next_corner(c)];
    edges[c] = (StyEdge){from < to ? from : to, from < to ? to : from, c};
  }
  qsort(edges, corner_count, sizeof *edges, compare_edges);
}

static void join_across_edge(Smoothing *s, const StyEdge *a, const StyEdge *b) {
  if (dot_vectors(&s->facets[a->corner / 3 * 3], &s->facets[b->corner / 3 * 3]) < s->cosine) return;
  uint32_t a_from = a->corner, a_to = sty_next_corner(a_from), b_from = b->corner, b_to = sty_next_corner(b_from);
  bool same_direction = s->ids[a_from] == s->ids[b_from];
  join_sets(s->parents, a_from, same_direction ? b_from : b_to);
  join_sets(s->parents, a_to, same_direction ? b_to : b_from);
}

static void join_smooth_edges(Smoothing *s) {
  for (size_t begin = 0, end; begin < s->corner_count; begin = end) {
    const StyEdge *edge = &s->edges[begin];
    for (end = begin + 1; end < s->corner_count; end++)
      if (s->edges[end].low != edge->low || s->edges[end].high != edge->high) break;
    if (end - begin > MAX_EDGE_TRIANGLES) continue;
    for (size_t i = begin; i < end; i++)
      for (size_t j = i + 1; j < end; j++) join_across_edge(s, &s->edges[i], &s->edges[j]);
  }
}

static void get_edge_vector(const StyCorner *from, const StyCorner *to, double out[3]) {
  for (int k = 0; k < 3; k++) out[k] = (double)to->position[k] - from->position[k];
}

static void compute_facets(Smoothing *s, const StyCorner *corners) {
  for (size_t t = 0; t < s->triangle_count; t++) {
    double a[3], b[3], *facet = &s->facets[3 * t];
    get_edge_vector(&corners[3 * t], &corners[3 * t + 1], a);
    get_edge_vector(&corners[3 * t], &corners[3 * t + 2], b);
    cross_vectors(a, b, facet);
    normalize_vector(facet);
  }
}

static void add_facets(Smoothing *s, const StyCorner *corners) {
  for (uint32_t c = 0; c < s->corner_count; c++) {
    double a[3], b[3], normal[3], *sum = &s->sums[3 * (size_t)find_root(s->parents, c)];
    get_edge_vector(&corners[c], &corners[sty_next_corner(c)], a);
    get_edge_vector(&corners[c], &corners[sty_next_corner(sty_next_corner(c))], b);
    cross_vectors(a, b, normal);
    double angle = atan2(sqrt(dot_vectors(normal, normal)), dot_vectors(a, b));
    for (int k = 0; k < 3; k++) sum[k] += angle * s->facets[c / 3 * 3 + (uint32_t)k];
  }
}

static void fill_normals(Smoothing *s, StyCorner *corners) {
  for (uint32_t c = 0; c < s->corner_count; c++) {
    float *normal = corners[c].normal;
    if (normal[0] != 0 || normal[1] != 0 || normal[2] != 0) continue;
    double mean[3];
    memcpy(mean, &s->sums[3 * (size_t)find_root(s->parents, c)], sizeof mean);
    if (!normalize_vector(mean)) memcpy(mean, &s->facets[c / 3 * 3], sizeof mean);
    for (int k = 0; k < 3; k++) normal[k] = (float)mean[k] + 0.0f;
  }
}

StyStatus sty_smooth_corners(StyCorner *corners, size_t triangle_count, double crease_angle, StyError *error) {
  Smoothing s;
  StyStatus status = allocate_smoothing(&s, triangle_count, error);
  if (status != STY_OK) return status;
  /* The slack covers rounding, so that 0 joins coplanar facets and 180 all. */
  s.cosine = cos(crease_angle * (M_PI / 180)) - 1e-9;
  size_t positions;
  status = sty_number_corners(corners, s.corner_count, sizeof corners->position, s.ids, &positions, error);
  if (status == STY_OK) {
    for (uint32_t c = 0; c < s.corner_count; c++) s.parents[c] = c;
    compute_facets(&s, corners);
    sty_list_edges(s.ids, s.corner_count, s.edges);
    join_smooth_edges(&s);
    /* Before the sums are touched, so that the two never take room together. */
    free(s.edges);
    s.edges = NULL;
    add_facets(&s, corners);
    fill_normals(&s, corners);
  }
  free_smoothing(&s);
  return status;
}
