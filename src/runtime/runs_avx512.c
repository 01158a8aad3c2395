/* Sixteen pixels at a time. Compiled with the flags for this unit, for processors that may have it. */
#ifdef __AVX512F__

#include <immintrin.h>

#include "segments.h"
#include "voters.h"

enum { LANES = 16 };

/* The lowest lanes, all sixteen where `count` has them. */
static __mmask16 get_lanes(int count) { return count < LANES ? (__mmask16)((1u << count) - 1) : (__mmask16)0xFFFF; }

static __m512i count_up(int from) {
  return _mm512_add_epi32(_mm512_set1_epi32(from),
                          _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15));
}

static __mmask16 test_coverage(__mmask16 lanes, __m512i texels) {
  return _mm512_mask_test_epi32_mask(lanes, texels, _mm512_set1_epi32((int)0xFF000000u));
}

static int count_alike(const uint8_t *guide, int most) {
  const __mmask16 wanted = guide[3] > 0 ? 0xFFFF : 0;
  for (int k = 0; k < most; k += LANES) {
    const __mmask16 lanes = get_lanes(most - k);
    const __m512i texels = _mm512_maskz_loadu_epi32(lanes, guide + 4 * (size_t)k);
    const unsigned same = lanes & (unsigned)~(test_coverage(lanes, texels) ^ wanted);
    if (same != 0xFFFF) return k + __builtin_ctz(~same);
  }
  return most;
}

static int measure_segment(const NearSeed *seeds, int count) {
  int32_t seed;
  memcpy(&seed, seeds, sizeof seed);
  for (int k = 0; k < count; k += LANES) {
    const __mmask16 lanes = get_lanes(count - k);
    const __m512i others = _mm512_maskz_loadu_epi32(lanes, seeds + k);
    const __mmask16 same = _mm512_mask_cmpeq_epi32_mask(lanes, others, _mm512_set1_epi32(seed));
    if (same != 0xFFFF) return k + __builtin_ctz(~(unsigned)same);
  }
  return count;
}

static __mmask16 keep_inside(__mmask16 lanes, __m512i values, int limit) {
  return _mm512_mask_cmplt_epu32_mask(lanes, values, _mm512_set1_epi32(limit));
}

/* Sum over x, y, z of absolute differences. */
static __m512i sum_differences(__m512i a, __m512i b) {
  const __m512i difference =
      _mm512_and_si512(_mm512_sub_epi8(_mm512_max_epu8(a, b), _mm512_min_epu8(a, b)), _mm512_set1_epi32(0xFFFFFF));
  return _mm512_madd_epi16(_mm512_maddubs_epi16(difference, _mm512_set1_epi8(1)), _mm512_set1_epi16(1));
}

/* Distances in the frame, in source pixels. */
static __m512i scale_ways(const Source *source, __m512i ways) {
  return source->spread > 0 ? _mm512_sra_epi32(ways, _mm_cvtsi32_si128(source->spread))
                            : _mm512_sll_epi32(ways, _mm_cvtsi32_si128(-source->spread));
}

/* Source columns of a segment's pixels from k on. */
static __m512i find_columns(const Source *source, const Segment *segment, int k) {
  return _mm512_add_epi32(_mm512_set1_epi32(segment->proposal.found.x),
                          scale_ways(source, count_up(k - segment->seed.x)));
}

static void store_matches(StyMatch *matches, __mmask16 lanes, __m512i columns, uint64_t rest) {
  const __m512i low = _mm512_cvtepu32_epi64(_mm512_castsi512_si256(columns));
  const __m512i high = _mm512_cvtepu32_epi64(_mm512_extracti64x4_epi64(columns, 1));
  const __m512i all = _mm512_set1_epi64((long long)rest);
  _mm512_mask_storeu_epi64(matches, (__mmask8)lanes, _mm512_or_si512(low, all));
  _mm512_mask_storeu_epi64(matches + 8, (__mmask8)(lanes >> 8), _mm512_or_si512(high, all));
}

/* Whole words at a time: bytes of a word that has just been written are long in coming. */
static __mmask16 get_waiting(const Waiting *waiting, int k, int end) {
  const uint64_t *words = waiting->words + k / WORD;
  const int shift = k % WORD;
  return (__mmask16)((words[0] >> shift | words[1] << 1 << (WORD - 1 - shift)) & get_lanes(end - k));
}

static void remove_waiting(Waiting *waiting, int k, __mmask16 lanes) {
  uint64_t *words = waiting->words + k / WORD;
  const int shift = k % WORD;
  words[0] &= ~((uint64_t)lanes << shift);
  words[1] &= ~((uint64_t)lanes >> 1 >> (WORD - 1 - shift));
}

static void try_pixels(const Run *run, const Segment *segment, Waiting *waiting) {
  const Source *source = run->source;
  const StyFrame *frame = run->frame;
  const Proposal *proposal = &segment->proposal;
  if (proposal->is_moved) {
    try_pixels_singly(run, segment, waiting);
    return;
  }
  const int y = proposal->found.y + to_source(source, -segment->seed.y);
  if (y < 0 || y >= source->height) return;
  const unsigned char *row = source->guide + (size_t)y * (size_t)source->width * 4;
  const uint64_t rest = (uint64_t)y << 16 | (uint64_t)(unsigned)segment->level << 32 |
                        (uint64_t)(unsigned)proposal->lighting << 40 | (uint64_t)source->number << 48;
  for (int k = segment->a; k < segment->b; k += LANES) {
    const __m512i columns = find_columns(source, segment, k);
    const __mmask16 inside = keep_inside(get_lanes(segment->b - k), columns, source->width);
    __mmask16 lanes = inside & get_waiting(waiting, k, segment->b);
    if (lanes == 0) continue;
    const __m512i texels =
        source->spread == 0
            ? _mm512_maskz_loadu_epi32(inside, row + 4 * ((ptrdiff_t)proposal->found.x + k - segment->seed.x))
            : _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), inside, columns, row, 4);
    const __m512i own = _mm512_maskz_loadu_epi32(inside, frame->guide + 4 * (run->first + (size_t)k));
    __m512i error = _mm512_slli_epi32(sum_differences(texels, own), 8);
    if (frame->luma) {
      const __m512i luma = _mm512_cvtepu8_epi32(_mm_maskz_loadu_epi8(inside, frame->luma + run->first + k));
      const __m512i difference =
          _mm512_abs_epi32(_mm512_sub_epi32(luma, _mm512_set1_epi32(source->luma[proposal->lighting])));
      error = _mm512_add_epi32(error, _mm512_mullo_epi32(difference, _mm512_set1_epi32(source->luma_weight)));
    }
    lanes = test_coverage(lanes, texels);
    lanes = _mm512_mask_cmplt_epi32_mask(lanes, error, _mm512_set1_epi32(source->threshold));
    store_matches(run->matches + k, lanes, columns, rest);
    remove_waiting(waiting, k, lanes);
  }
}

/* Candidates in the order of the reference's loops, which a later one must beat. */
static void choose_seeds(const SeedGrid *grid, int y, int k0, int k1, NearSeed *out) {
  const unsigned level = (unsigned)grid->level;
  for (int k = k0; k < k1; k += LANES) {
    const int cell = (k + grid->phase) >> level;
    const __m512i at = count_up(k), phase = _mm512_set1_epi32(grid->phase);
    const __m512i cells =
        _mm512_sub_epi32(_mm512_srli_epi32(_mm512_add_epi32(at, phase), level), _mm512_set1_epi32(cell));
    const __m512i here = _mm512_or_si512(at, _mm512_set1_epi32(y << 16));
    __m512i least = _mm512_set1_epi32(INT32_MAX), chosen = here;
    for (int i = 0; i < 9; i++) {
      const __m512i row = _mm512_loadu_si512(grid->rows[i % 3] + cell + i / 3);
      const __m512i way = _mm512_sub_epi16(_mm512_permutexvar_epi32(cells, row), here);
      const __m512i distance = _mm512_madd_epi16(way, way);
      const __mmask16 nearer = _mm512_cmplt_epi32_mask(distance, least);
      chosen = _mm512_mask_mov_epi32(chosen, nearer, way);
      least = _mm512_min_epi32(least, distance);
    }
    _mm512_mask_storeu_epi32(out + k, get_lanes(k1 - k), _mm512_add_epi16(chosen, at));
  }
}

/* Pairs of bytes become pairs of 16 bits, and x counts from the row's beginning. */
static void place_offsets(const StySeedOffset *offsets, int k0, int k1, NearSeed *out) {
  for (int k = k0; k < k1; k += LANES) {
    const __mmask16 lanes = get_lanes(k1 - k);
    const __m512i ways = _mm512_cvtepi8_epi16(_mm256_maskz_loadu_epi16(lanes, offsets + k));
    _mm512_mask_storeu_epi32(out + k, lanes, _mm512_add_epi16(ways, count_up(k)));
  }
}

/* Past the caches: nobody reads them soon. */
static void empty_matches(StyMatch *matches, int count) {
  int64_t bits;
  memcpy(&bits, &no_match, sizeof bits);
  const __m512i empty = _mm512_set1_epi64(bits);
  int k = 0;
  for (; k < count && (uintptr_t)(matches + k) % 64 != 0; k++) matches[k] = no_match;
  for (; k + 8 <= count; k += 8) _mm512_stream_si512((void *)(matches + k), empty);
  _mm512_mask_storeu_epi64(matches + k, (__mmask8)get_lanes(count - k), empty);
  _mm_sfence();
}

#define UNIT(name) sty_##name##_avx512
#include "runs_seeds.h"

/* ---- low levels: seeds differ from pixel to pixel, so what is left is gathered ---- */

enum { FIRST_LOW_LEVEL = 4 };

/* Sixteen pixels of a frame: their places in it and their guides. */
typedef struct Pixels {
  __mmask16 lanes;
  __m512i index, guide;
} Pixels;

static __m512i gather(__mmask16 lanes, const void *base, __m512i index) {
  return _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), lanes, index, base, 4);
}

static __m512i multiply(__m512i a, int b) { return _mm512_mullo_epi32(a, _mm512_set1_epi32(b)); }

/* Quotients below 8192 of numbers below 2^22 by at most 510: no rounding of the division reaches the next integer. */
static __m512i divide(__m512i a, int b) {
  return _mm512_cvttps_epi32(_mm512_div_ps(_mm512_cvtepi32_ps(a), _mm512_set1_ps((float)b)));
}

/* As address_byte and address_fine. */
static __m512i address_bytes(const Source *source, __m512i bytes) {
  const int side = source->lut_side;
  if (!(source->style.flags & STY_FLAG_UNORM8))
    return _mm512_min_epi32(divide(multiply(bytes, side), 255), _mm512_set1_epi32(side - 1));
  if (side == 256) return bytes;
  return divide(_mm512_add_epi32(multiply(bytes, 2 * (side - 1)), _mm512_set1_epi32(255)), 510);
}

static __m512i address_floats(const Source *source, __m512 g) {
  const int side = source->lut_side;
  const bool halves = source->style.flags & STY_FLAG_UNORM8;
  g = _mm512_maskz_mov_ps(_mm512_cmp_ps_mask(g, g, _CMP_ORD_Q), g);
  g = _mm512_max_ps(_mm512_min_ps(g, _mm512_set1_ps(1)), _mm512_set1_ps(-1));
  const __m512 unit = _mm512_add_ps(_mm512_mul_ps(g, _mm512_set1_ps(0.5f)), _mm512_set1_ps(0.5f));
  __m512i cell = _mm512_cvttps_epi32(_mm512_mul_ps(unit, _mm512_set1_ps((float)(halves ? 2 * (side - 1) : side))));
  if (halves) cell = _mm512_srli_epi32(_mm512_add_epi32(cell, _mm512_set1_epi32(1)), 1);
  return _mm512_min_epi32(cell, _mm512_set1_epi32(side - 1));
}

/* n/65535 = (n + 1 + n/65536) / 65536 for every product of 16 bits and a side. */
static __m512i decode_coordinates(__m512i values, int side) {
  const __m512i n = multiply(values, side);
  const __m512i sum = _mm512_add_epi32(_mm512_add_epi32(n, _mm512_set1_epi32(1)), _mm512_srli_epi32(n, 16));
  return _mm512_min_epi32(_mm512_srli_epi32(sum, 16), _mm512_set1_epi32(side - 1));
}

static void look_up_pixels(const Run *run, const Pixels *pixels, __m512i *x, __m512i *y) {
  const Source *source = run->source;
  __m512i column, row;
  if (run->frame->fine) {
    const __m512i at = _mm512_slli_epi32(pixels->index, 1);
    const __m512i gx = gather(pixels->lanes, run->frame->fine, at),
                  gy = gather(pixels->lanes, run->frame->fine + 1, at);
    column = address_floats(source, _mm512_castsi512_ps(gx));
    row = address_floats(source, _mm512_sub_ps(_mm512_setzero_ps(), _mm512_castsi512_ps(gy)));
  } else {
    const __m512i byte = _mm512_set1_epi32(255);
    column = address_bytes(source, _mm512_and_si512(pixels->guide, byte));
    row = address_bytes(source, _mm512_sub_epi32(byte, _mm512_and_si512(_mm512_srli_epi32(pixels->guide, 8), byte)));
  }
  const __m512i texels = gather(pixels->lanes, source->lut, _mm512_add_epi32(multiply(row, source->lut_side), column));
  *x = decode_coordinates(_mm512_and_si512(texels, _mm512_set1_epi32(0xFFFF)), source->width);
  *y = decode_coordinates(_mm512_srli_epi32(texels, 16), source->height);
}

/* Luminances; what lies behind the frame's last isn't read. */
static __m512i get_lumas(const Run *run, const Pixels *pixels) {
  const __m512i last = _mm512_set1_epi32(run->frame->width * run->frame->height - 4);
  const __m512i start = _mm512_min_epi32(pixels->index, last);
  const __m512i words = _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), pixels->lanes, start, run->frame->luma, 1);
  const __m512i shift = _mm512_slli_epi32(_mm512_sub_epi32(pixels->index, start), 3);
  return _mm512_and_si512(_mm512_srlv_epi32(words, shift), _mm512_set1_epi32(255));
}

/* The lightings nearest to luminances, and their own. */
static __m512i choose_lightings(const Source *source, __m512i luma, __m512i *chosen_luma) {
  *chosen_luma = _mm512_set1_epi32(source->luma[0]);
  __m512i chosen = _mm512_setzero_si512(), least = _mm512_abs_epi32(_mm512_sub_epi32(luma, *chosen_luma));
  for (int i = 1; i < source->style.layer_count; i++) {
    const __m512i other = _mm512_set1_epi32(source->luma[i]);
    const __m512i difference = _mm512_abs_epi32(_mm512_sub_epi32(luma, other));
    const __mmask16 nearer = _mm512_cmplt_epi32_mask(difference, least);
    chosen = _mm512_mask_mov_epi32(chosen, nearer, _mm512_set1_epi32(i));
    *chosen_luma = _mm512_mask_mov_epi32(*chosen_luma, nearer, other);
    least = _mm512_min_epi32(least, difference);
  }
  return chosen;
}

static void scatter_matches(const Run *run, __mmask16 lanes, __m512i places, __m512i x, __m512i y, int level,
                            __m512i lightings) {
  const __m512i low = _mm512_or_si512(x, _mm512_slli_epi32(y, 16));
  const __m512i high =
      _mm512_add_epi32(_mm512_set1_epi32(level | run->source->number << 16), _mm512_slli_epi32(lightings, 8));
  const __m512i even = _mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  const __m512i odd = _mm512_setr_epi32(8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
  _mm512_mask_i32scatter_epi64(run->matches, (__mmask8)lanes, _mm512_castsi512_si256(places),
                               _mm512_permutex2var_epi32(low, even, high), 8);
  _mm512_mask_i32scatter_epi64(run->matches, (__mmask8)(lanes >> 8), _mm512_extracti64x4_epi64(places, 1),
                               _mm512_permutex2var_epi32(low, odd, high), 8);
}

/* Which of these pixels take what their seeds propose; they are served. */
static __mmask16 try_places(const Run *run, int level, const SeedRow seeds, __mmask16 lanes, __m512i places) {
  const Source *source = run->source;
  const StyFrame *frame = run->frame;
  const __m512i near = gather(lanes, seeds, places);
  const __m512i near_x = _mm512_srai_epi32(_mm512_slli_epi32(near, 16), 16), near_y = _mm512_srai_epi32(near, 16);
  const __m512i seed_x = _mm512_add_epi32(near_x, _mm512_set1_epi32(run->x)),
                seed_y = _mm512_add_epi32(near_y, _mm512_set1_epi32(run->y));
  Pixels seed = {.lanes = keep_inside(keep_inside(lanes, seed_x, frame->width), seed_y, frame->height)};
  seed.index = _mm512_add_epi32(multiply(seed_y, frame->width), seed_x);
  seed.guide = gather(seed.lanes, frame->guide, seed.index);
  seed.lanes = test_coverage(seed.lanes, seed.guide);
  __m512i x, y, lightings = _mm512_setzero_si512(), lighting_luma;
  look_up_pixels(run, &seed, &x, &y);
  x = _mm512_add_epi32(x, scale_ways(source, _mm512_sub_epi32(places, near_x)));
  y = _mm512_add_epi32(y, scale_ways(source, _mm512_sub_epi32(_mm512_setzero_si512(), near_y)));
  Pixels own = {.lanes = keep_inside(keep_inside(seed.lanes, x, source->width), y, source->height)};
  const __m512i texels = gather(own.lanes, source->guide, _mm512_add_epi32(multiply(y, source->width), x));
  own.lanes = test_coverage(own.lanes, texels);
  own.index = _mm512_add_epi32(places, _mm512_set1_epi32((int)run->first));
  own.guide = gather(own.lanes, frame->guide, own.index);
  __m512i error = _mm512_slli_epi32(sum_differences(texels, own.guide), 8);
  if (frame->luma) {
    lightings = choose_lightings(source, get_lumas(run, &seed), &lighting_luma);
    const __m512i difference = _mm512_abs_epi32(_mm512_sub_epi32(get_lumas(run, &own), lighting_luma));
    error = _mm512_add_epi32(error, multiply(difference, source->luma_weight));
  }
  const __mmask16 taken = _mm512_mask_cmplt_epi32_mask(own.lanes, error, _mm512_set1_epi32(source->threshold));
  scatter_matches(run, taken, places, x, y, level, lightings);
  return taken;
}

static void fall_back_at(const Run *run, __mmask16 lanes, __m512i places) {
  Pixels own = {.lanes = lanes, .index = _mm512_add_epi32(places, _mm512_set1_epi32((int)run->first))};
  own.guide = gather(lanes, run->frame->guide, own.index);
  __m512i x, y, lightings = _mm512_setzero_si512(), ignored;
  look_up_pixels(run, &own, &x, &y);
  if (run->frame->luma) lightings = choose_lightings(run->source, get_lumas(run, &own), &ignored);
  scatter_matches(run, lanes, places, x, y, STY_LEVEL_FALLBACK, lightings);
}

static int list_waiting(const Waiting *waiting, int length, int32_t *places) {
  int count = 0;
  for (int k = 0; k < length; k += LANES) {
    const __mmask16 lanes = get_waiting(waiting, k, length);
    _mm512_storeu_si512(places + count, _mm512_maskz_compress_epi32(lanes, count_up(k)));
    count += __builtin_popcount(lanes);
  }
  return count;
}

/* Frames and sources too large for 32-bit places, and what is rare, go by segments. */
static bool can_gather(const Run *run, int level) {
  const size_t pixels = (size_t)run->frame->width * (size_t)run->frame->height;
  return level <= FIRST_LOW_LEVEL && pixels >= 4 && pixels < (size_t)1 << 28 && run->source->layer_size < INT32_MAX &&
         !run->frame->anchors && !run->source->style.scatter;
}

static int finish_run(const Run *run, int level, Waiting *waiting) {
  if (!can_gather(run, level)) return level;
  int32_t places[RUN_LENGTH + LANES];
  SeedRow seeds;
  int count = list_waiting(waiting, run->length, places);
  for (; level >= 0 && count > 0; level--) {
    int kept = 0;
    find_seeds(run, level, places[0], places[count - 1] + 1, seeds);
    for (int i = 0; i < count; i += LANES) {
      const __mmask16 lanes = get_lanes(count - i);
      const __m512i some = _mm512_maskz_loadu_epi32(lanes, places + i);
      const __mmask16 left = lanes & (__mmask16)~try_places(run, level, seeds, lanes, some);
      _mm512_storeu_si512(places + kept, _mm512_maskz_compress_epi32(left, some));
      kept += __builtin_popcount(left);
    }
    count = kept;
  }
  for (int i = 0; i < count; i += LANES) {
    const __mmask16 lanes = get_lanes(count - i);
    fall_back_at(run, lanes, _mm512_maskz_loadu_epi32(lanes, places + i));
  }
  return -1;
}

#include "runs_segments.h"

/* ---- blending ---- */

/* The styles of eight pixels, as get_pixel_style where they are covered. */
static __m512i get_styles(const Blend *blend, size_t index, __mmask8 lanes) {
  if (!blend->frame->styles) return _mm512_set1_epi64(blend->frame->style);
  const __m128i bytes = _mm_maskz_loadu_epi8(lanes, blend->frame->styles + index);
  const __m512i styles = _mm512_cvtepu8_epi64(bytes);
  return _mm512_maskz_mov_epi64(_mm512_cmple_epu64_mask(styles, _mm512_set1_epi64(count_styles(blend->bundle))),
                                styles);
}

/* Eight pixels, as get_voter. */
static __m512i make_voters(const Blend *blend, size_t index, int x, int y, __mmask8 lanes) {
  const __m256i guide = _mm256_maskz_loadu_epi32(lanes, blend->frame->guide + 4 * index);
  __mmask8 stylized = _mm256_mask_test_epi32_mask(lanes, guide, _mm256_set1_epi32((int)0xFF000000u));
  if (stylized == 0) return _mm512_setzero_si512(); /* matches aren't even read */
  const __m512i styles = get_styles(blend, index, stylized);
  stylized = _mm512_mask_test_epi64_mask(stylized, styles, styles);
  const __m512i matches = _mm512_maskz_loadu_epi64(stylized, blend->matches + index);
  const __m512i place = _mm512_add_epi64(_mm512_set1_epi64((x & 0xFFFF) | (long long)(y & 0xFFFF) << 16),
                                         _mm512_setr_epi64(0, 1, 2, 3, 4, 5, 6, 7));
  const __m512i way = _mm512_and_si512(_mm512_sub_epi16(matches, place), _mm512_set1_epi64(0xFFFFFFFF));
  const __m512i layer = _mm512_min_epu64(_mm512_and_si512(_mm512_srli_epi64(matches, 40), _mm512_set1_epi64(255)),
                                         _mm512_set1_epi64(STY_MAX_LIGHTINGS));
  __m512i kind = _mm512_add_epi64(_mm512_slli_epi64(layer, 9), styles);
  if (blend->frame->objects) {
    const __m128i objects = _mm_maskz_loadu_epi16(stylized, blend->frame->objects + index);
    kind = _mm512_or_si512(kind, _mm512_slli_epi64(_mm512_cvtepu16_epi64(objects), 16));
  }
  return _mm512_maskz_or_epi64(stylized, way, _mm512_slli_epi64(kind, 32));
}

static void collect_voters(const Blend *blend, size_t index, int x, int y, int count, Voter *out) {
  for (int k = 0; k < count; k += 8) {
    const __mmask8 lanes = (__mmask8)get_lanes(count - k);
    _mm512_mask_storeu_epi64(out + k, lanes, make_voters(blend, index + (size_t)k, x + k, y, lanes));
  }
}

static void compare_voters(const Voter *a, const Voter *b, uint64_t bits[COLUMN_WORDS]) {
  for (int word = 0; word < COLUMN_WORDS; word++) {
    bits[word] = 0;
    for (int k = 0; k < WORD; k += 8) {
      const __mmask8 same =
          _mm512_cmpeq_epi64_mask(_mm512_loadu_si512(a + word * WORD + k), _mm512_loadu_si512(b + word * WORD + k));
      bits[word] |= (uint64_t)same << k;
    }
  }
}

/* The votes for sixteen pixels. */
typedef struct Tallies {
  __m512i colour[3], alpha, votes;
} Tallies;

/* What sixteen neighbours vote for; a neighbour that votes as the one before it is not asked again. */
typedef struct Polled {
  __m512i places, kinds; /* of the voters: x and y; tag and object */
  __mmask16 valid;
  __m512i texels;
} Polled;

static void load_voters(const Voter *voters, int count, __m512i *places, __m512i *kinds) {
  const __m512i even = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
  const __m512i low = _mm512_maskz_loadu_epi64((__mmask8)get_lanes(count), voters);
  const __m512i high =
      count > 8 ? _mm512_maskz_loadu_epi64((__mmask8)get_lanes(count - 8), voters + 8) : _mm512_setzero_si512();
  *places = _mm512_permutex2var_epi32(low, even, high);
  *kinds = _mm512_permutex2var_epi32(low, _mm512_add_epi32(even, _mm512_set1_epi32(1)), high);
}

/* Asks these voters for the pixels at `here`, x and y of 16 bits each. */
static void ask(const Source *source, __mmask16 lanes, __m512i places, __m512i kinds, __m512i here, Polled *polled) {
  polled->places = _mm512_mask_mov_epi32(polled->places, lanes, places);
  polled->kinds = _mm512_mask_mov_epi32(polled->kinds, lanes, kinds);
  const __m512i sum = _mm512_add_epi16(places, here);
  const __m512i x = _mm512_and_si512(sum, _mm512_set1_epi32(0xFFFF)), y = _mm512_srli_epi32(sum, 16);
  const __m512i layer = _mm512_and_si512(_mm512_srli_epi32(kinds, 9), _mm512_set1_epi32(127));
  __mmask16 inside = keep_inside(keep_inside(lanes, x, source->width), y, source->height);
  inside = keep_inside(inside, layer, source->style.layer_count);
  const __m512i index = _mm512_add_epi32(multiply(y, source->width), x);
  inside = test_coverage(inside, gather(inside, source->guide, index));
  const __m512i painted = _mm512_add_epi32(index, multiply(layer, (int)(source->layer_size / 4)));
  polled->texels = _mm512_mask_i32gather_epi32(polled->texels, inside, painted, source->exemplars, 4);
  polled->valid = (polled->valid & (__mmask16)~lanes) | inside;
}

static __mmask16 find_near(const Blend *blend, float tolerance, size_t own, size_t other, __mmask16 lanes) {
  const __m512 a = _mm512_maskz_loadu_ps(lanes, blend->frame->depth + own);
  const __m512 b = _mm512_maskz_loadu_ps(lanes, blend->frame->depth + other);
  const __m512 difference = _mm512_abs_ps(_mm512_sub_ps(a, b));
  return _mm512_mask_cmp_ps_mask(lanes, a, b, _CMP_EQ_OQ) |
         _mm512_mask_cmp_ps_mask(lanes, difference, _mm512_set1_ps(tolerance), _CMP_LE_OQ);
}

/* So many votes for what each was asked for. */
static void add_polled(const Polled *polled, __mmask16 lanes, __m512i weights, Tallies *tallies) {
  const __m512i byte = _mm512_set1_epi32(255);
  const __m512i alpha = _mm512_mullo_epi32(_mm512_srli_epi32(polled->texels, 24), weights);
  lanes &= polled->valid;
  for (int c = 0; c < 3; c++) {
    const __m512i value = _mm512_and_si512(_mm512_srli_epi32(polled->texels, (unsigned)(8 * c)), byte);
    const __m512i product = _mm512_mullo_epi32(value, alpha);
    tallies->colour[c] = _mm512_mask_add_epi32(tallies->colour[c], lanes, tallies->colour[c], product);
  }
  tallies->alpha = _mm512_mask_add_epi32(tallies->alpha, lanes, tallies->alpha, alpha);
  tallies->votes = _mm512_mask_add_epi32(tallies->votes, lanes, tallies->votes, weights);
}

/* Sixteen pixels and who was asked for them: themselves, and the last of others. Few chunks meet in a window. */
typedef struct Poll {
  const Pixel *pixel;
  __mmask16 lanes;
  __m512i here; /* x and y */
  Polled own, other;
  __m512i own_votes, other_votes; /* not yet in the tallies */
} Poll;

static Poll begin_poll(Strip *strip, const Pixel *pixel, int count) {
  Poll poll = {.pixel = pixel, .lanes = get_lanes(count)};
  __m512i places, kinds;
  poll.here = _mm512_add_epi16(_mm512_set1_epi32((pixel->x & 0xFFFF) | pixel->y << 16), count_up(0));
  poll.own.places = poll.own.kinds = poll.own.texels = _mm512_setzero_si512();
  poll.own_votes = poll.other_votes = _mm512_setzero_si512();
  poll.other = poll.own;
  load_voters(get_row(strip, pixel->y)->voters + pixel->x - strip->x0, count, &places, &kinds);
  ask(pixel->source, poll.lanes, places, kinds, poll.here, &poll.own);
  return poll;
}

/* The votes of the neighbours at one place of the window. They are counted as long as they are for the same. */
static void poll_neighbours(Poll *poll, __mmask16 voting, __m512i places, __m512i kinds, Tallies *tallies) {
  const __m512i one = _mm512_set1_epi32(1);
  const __mmask16 as_own = _mm512_mask_cmpeq_epi32_mask(voting, places, poll->own.places) &
                           _mm512_mask_cmpeq_epi32_mask(voting, kinds, poll->own.kinds);
  const __mmask16 as_other = voting & (__mmask16)~as_own;
  poll->own_votes = _mm512_mask_add_epi32(poll->own_votes, as_own, poll->own_votes, one);
  if (as_other == 0) return;
  const __mmask16 changed = _mm512_mask_cmpneq_epi32_mask(as_other, places, poll->other.places) |
                            _mm512_mask_cmpneq_epi32_mask(as_other, kinds, poll->other.kinds);
  if (changed != 0) {
    add_polled(&poll->other, poll->lanes, poll->other_votes, tallies);
    poll->other_votes = _mm512_setzero_si512();
    ask(poll->pixel->source, changed, places, kinds, poll->here, &poll->other);
  }
  poll->other_votes = _mm512_mask_add_epi32(poll->other_votes, as_other, poll->other_votes, one);
}

static void end_poll(const Poll *poll, Tallies *tallies) {
  add_polled(&poll->own, poll->lanes, poll->own_votes, tallies);
  add_polled(&poll->other, poll->lanes, poll->other_votes, tallies);
}

/* One row's votes. */
static void poll_row(Strip *strip, Poll *poll, int ny, Tallies *tallies) {
  const Blend *blend = strip->blend;
  const Pixel *pixel = poll->pixel;
  const Source *source = pixel->source;
  const Voter *voters = get_row(strip, ny)->voters + pixel->x - strip->x0;
  const int radius = source->style.radius, count = __builtin_popcount(poll->lanes);
  const bool has_depth = blend->frame->depth && source->style.depth_tolerance != 0;
  const bool has_objects = source->style.flags & STY_FLAG_OBJECTS;
  for (int o = -radius; o <= radius; o++) {
    __m512i places, kinds;
    load_voters(voters + o, count, &places, &kinds);
    __mmask16 voting = _mm512_mask_cmpeq_epi32_mask(poll->lanes, _mm512_and_si512(kinds, _mm512_set1_epi32(511)),
                                                    _mm512_set1_epi32(source->number + 1));
    if (has_objects) {
      const __m512i difference = _mm512_srli_epi32(_mm512_xor_si512(kinds, poll->own.kinds), 16);
      voting = _mm512_mask_cmpeq_epi32_mask(voting, difference, _mm512_setzero_si512());
    }
    if (has_depth && (ny != pixel->y || o != 0))
      voting = find_near(blend, source->style.depth_tolerance, pixel->index,
                         get_pixel_index(blend->frame, pixel->x, ny) + (size_t)(ptrdiff_t)o, voting);
    poll_neighbours(poll, voting, places, kinds, tallies);
  }
}

/* Half up, as resolve_votes; numbers below 2^24, so that no rounding of the division reaches the next integer. */
static __m512i divide_half_up(__m512i dividend, __m512i divisor) {
  const __m512i raised = _mm512_add_epi32(dividend, _mm512_srli_epi32(divisor, 1));
  return _mm512_cvttps_epi32(_mm512_div_ps(_mm512_cvtepi32_ps(raised), _mm512_cvtepi32_ps(divisor)));
}

static void write_plain(const Blend *blend, size_t index, __mmask16 lanes, const Tallies *tallies) {
  const __m512i guide = _mm512_maskz_loadu_epi32(lanes, blend->frame->guide + 4 * index);
  const __mmask16 painted = _mm512_test_epi32_mask(tallies->alpha, tallies->alpha);
  const __m512i coverage = _mm512_mullo_epi32(tallies->alpha, _mm512_srli_epi32(guide, 24));
  __m512i pixels = _mm512_slli_epi32(divide_half_up(coverage, multiply(tallies->votes, 255)), 24);
  for (int c = 0; c < 3; c++) {
    const __m512i value = divide_half_up(tallies->colour[c], tallies->alpha);
    pixels = _mm512_mask_or_epi32(pixels, painted, pixels, _mm512_slli_epi32(value, (unsigned)(8 * c)));
  }
  _mm512_mask_storeu_epi32((uint8_t *)blend->out + 4 * index, lanes, pixels);
}

static void write_tallies(const Blend *blend, const Pixel *pixel, const Tallies *tallies, int count) {
  int32_t values[5][LANES];
  for (int c = 0; c < 3; c++) _mm512_storeu_si512(values[c], tallies->colour[c]);
  _mm512_storeu_si512(values[3], tallies->alpha);
  _mm512_storeu_si512(values[4], tallies->votes);
  for (int i = 0; i < count; i++) {
    const Pixel one = {pixel->x + i, pixel->y, pixel->index + (size_t)i, pixel->source};
    const Tally tally = {{values[0][i], values[1][i], values[2][i]}, values[3][i], values[4][i]};
    uint16_t colour[4];
    resolve_votes(blend, &one, &tally, colour);
    write_pixel(blend, one.index, colour);
  }
}

/* Where no vote is left, a pixel's own match stands alone. */
static void poll_self(const Source *source, const Blend *blend, size_t index, __mmask16 lanes, Tallies *tallies) {
  for (__mmask16 left = lanes & _mm512_testn_epi32_mask(tallies->votes, tallies->votes); left; left &= left - 1) {
    const __mmask16 lane = left & (__mmask16)-left;
    const StyMatch *own = &blend->matches[index + (size_t)__builtin_ctz(left)];
    int32_t texel;
    if (own->x >= source->width || own->y >= source->height || own->layer >= source->style.layer_count) continue;
    memcpy(&texel, get_exemplar(source, own->layer, own->x, own->y), sizeof texel);
    add_polled(&(Polled){.valid = lane, .texels = _mm512_set1_epi32(texel)}, lane, _mm512_set1_epi32(1), tallies);
  }
}

/* Pixels from this one on, at most sixteen, all of its style, up to the last whose window isn't alike. */
static int measure_group(Strip *strip, const Pixel *pixel, const uint64_t alike[COLUMN_WORDS]) {
  const Voter *voters = get_row(strip, pixel->y)->voters;
  const int k = pixel->x - strip->x0, most = strip->end - k < LANES ? strip->end - k : LANES;
  __m512i places, kinds;
  load_voters(voters + k, most, &places, &kinds);
  const __m512i style = _mm512_set1_epi32(pixel->source->number + 1);
  const unsigned same = _mm512_cmpeq_epi32_mask(_mm512_and_si512(kinds, _mm512_set1_epi32(511)), style);
  const unsigned stretch = get_lanes(__builtin_ctz(~same));
  const unsigned mixed = stretch & get_lanes(most) & ~(unsigned)shift_bits(alike, k / WORD, k % WORD);
  return 32 - __builtin_clz(mixed | 1);
}

static int blend_group(Strip *strip, const Pixel *pixel, const uint64_t alike[COLUMN_WORDS]) {
  const Blend *blend = strip->blend;
  const Source *source = pixel->source;
  const int radius = source->style.radius, height = blend->frame->height;
  if (source->style.flags & STY_FLAG_BASE || source->layer_size >= (size_t)1 << 28) return 0;
  const int count = measure_group(strip, pixel, alike);
  Tallies tallies;
  memset(&tallies, 0, sizeof tallies);
  Poll poll = begin_poll(strip, pixel, count);
  for (int ny = pixel->y > radius ? pixel->y - radius : 0; ny <= pixel->y + radius && ny < height; ny++)
    poll_row(strip, &poll, ny, &tallies);
  end_poll(&poll, &tallies);
  poll_self(source, blend, pixel->index, get_lanes(count), &tallies);
  /* The votes of the largest radius don't fit the floats that write_plain divides. */
  if (blend->bits == 8 && radius < STY_MAX_RADIUS && !(blend->frame->albedo && source->colour_weight))
    write_plain(blend, pixel->index, get_lanes(count), &tallies);
  else
    write_tallies(blend, pixel, &tallies, count);
  return count;
}

#include "blend_body.h"
#include "runs_body.h"

#endif
