/* What the fast form of sty_blend_frame (blend_body.h) keeps of a strip of the picture. */
#ifndef STYLUT_RUNTIME_VOTERS_H
#define STYLUT_RUNTIME_VOTERS_H

#include "runs.h"

/* What a pixel votes for, wherever it is looked at from: two with the same bytes vote alike. */
typedef struct Voter {
  uint16_t x, y; /* its match less its place, modulo 2^16: sources are smaller than that */
  uint16_t tag;  /* 0: none; else style (1..256) + 512 * lighting */
  uint16_t object;
} Voter;

enum { MARGIN = STY_MAX_RADIUS, COLUMNS = 256, COLUMN_WORDS = COLUMNS / WORD };
enum { STRIP = COLUMNS - 2 * MARGIN, RING = 2 * STY_MAX_RADIUS + 2 };

/* One row of a strip; bit k speaks of column k. The last voter lets neighbours be compared. */
typedef struct VoterRow {
  Voter voters[COLUMNS + 1];
  uint64_t like_left[COLUMN_WORDS], like_above[COLUMN_WORDS];
  bool is_empty; /* nothing is covered */
} VoterRow;

/* Columns x0 .. x0+COLUMNS-1 of the frame, MARGIN of them on either side of a strip of the rectangle; rows y at y
 * modulo RING. */
typedef struct Strip {
  const Blend *blend;
  int x0, begin, end; /* columns of the rectangle, counted from x0 */
  int first;          /* row: there is none before */
  VoterRow rows[RING];
} Strip;

static inline VoterRow *get_row(Strip *strip, int y) { return &strip->rows[y % RING]; }

static inline bool is_same_vote(const Voter *a, const Voter *b) { return memcmp(a, b, sizeof *a) == 0; }

static inline Voter get_voter(const Blend *blend, size_t index, int x, int y) {
  const StyMatch *match = &blend->matches[index];
  const int style = get_pixel_style(blend->bundle, blend->frame, index);
  if (style == 0) return (Voter){0, 0, 0, 0};
  return (Voter){(uint16_t)(match->x - x), (uint16_t)(match->y - y),
                 (uint16_t)(style + 512 * (match->layer < STY_MAX_LIGHTINGS ? match->layer : STY_MAX_LIGHTINGS)),
                 (uint16_t)get_object(blend->frame, index)};
}

static inline void set_bits(uint64_t *words, int from, int to) {
  for (int k = from; k < to; k++) words[k / WORD] |= (uint64_t)1 << k % WORD;
}

/* The word whose bit k is bit k + shift of a row, -WORD < shift < WORD. */
static inline uint64_t shift_bits(const uint64_t words[COLUMN_WORDS], int word, int shift) {
  if (shift >= 0) {
    const uint64_t next = word + 1 < COLUMN_WORDS ? words[word + 1] : 0;
    return words[word] >> shift | next << 1 << (WORD - 1 - shift);
  }
  const uint64_t last = word > 0 ? words[word - 1] : 0;
  return words[word] << -shift | last >> 1 >> (WORD - 1 + shift);
}

/* Set bits from `from` on, up to the first that isn't; at most a word. */
static inline int count_ones(const uint64_t words[COLUMN_WORDS], int from) {
  if (from >= COLUMNS) return 0;
  const uint64_t bits = shift_bits(words, from / WORD, from % WORD);
  return bits == UINT64_MAX ? WORD : __builtin_ctzll(~bits);
}

#endif
