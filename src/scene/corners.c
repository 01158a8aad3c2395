#include "scene/corners.h"

#include <stdlib.h>
#include <string.h>

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

StyStatus sty_number_distinct(const void *items, size_t stride, size_t count, size_t size, uint32_t *ids,
                              size_t *distinct, StyError *error) {
  const char *bytes = items;
  size_t capacity = 16;
  while (capacity < 2 * count) capacity *= 2;
  uint32_t *slots = malloc(capacity * sizeof *slots);
  if (!slots) return sty_fail_memory(error, "shared vertices", (double)(capacity * sizeof *slots));
  memset(slots, 0xFF, capacity * sizeof *slots);
  uint32_t next = 0;
  for (size_t i = 0; i < count; i++) {
    size_t slot = hash_bytes(&bytes[i * stride], size) & (capacity - 1);
    while (slots[slot] != UINT32_MAX && memcmp(&bytes[slots[slot] * stride], &bytes[i * stride], size) != 0)
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

int sty_compare_triples(const void *a, const void *b) {
  const uint32_t *x = a, *y = b;
  for (int k = 0; k < 2; k++)
    if (x[k] != y[k]) return x[k] < y[k] ? -1 : 1;
  return (x[2] > y[2]) - (x[2] < y[2]);
}

void sty_list_edges(const uint32_t *ids, size_t corner_count, StyEdge *edges) {
  for (uint32_t c = 0; c < corner_count; c++) {
    const uint32_t from = ids[c], to = ids[sty_next_corner(c)];
    edges[c] = (StyEdge){from < to ? from : to, from < to ? to : from, c};
  }
  qsort(edges, corner_count, sizeof *edges, sty_compare_triples);
}
