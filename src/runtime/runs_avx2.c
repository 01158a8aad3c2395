/* Eight pixels at a time. Compiled with the flags for this unit, for processors that may have it. */
#ifdef __AVX2__

#include <immintrin.h>

#include "segments.h"
#include "voters.h"

enum { LANES = 8 };

/* All ones in the lanes whose bits are set. */
static __m256i spread_bits(unsigned bits) {
  const __m256i lanes = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  return _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32((int)bits), lanes), lanes);
}

static unsigned gather_bits(__m256i lanes) { return (unsigned)_mm256_movemask_ps(_mm256_castsi256_ps(lanes)); }

/* The lowest lanes, all eight where `count` has them. */
static unsigned get_lanes(int count) { return count < LANES ? (1u << count) - 1 : 0xFF; }

static __m256i count_up(int from) {
  return _mm256_add_epi32(_mm256_set1_epi32(from), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
}

static __m256i load_lanes(const void *from, unsigned lanes) { return _mm256_maskload_epi32(from, spread_bits(lanes)); }

static unsigned test_coverage(__m256i texels) {
  const __m256i alpha = _mm256_srli_epi32(texels, 24);
  return gather_bits(_mm256_cmpgt_epi32(alpha, _mm256_setzero_si256()));
}

static int count_alike(const uint8_t *guide, int most) {
  const unsigned wanted = guide[3] > 0 ? 0xFF : 0;
  for (int k = 0; k < most; k += LANES) {
    const unsigned lanes = get_lanes(most - k);
    const unsigned same = lanes & ~(test_coverage(load_lanes(guide + 4 * (size_t)k, lanes)) ^ wanted);
    if (same != 0xFF) return k + __builtin_ctz(~same);
  }
  return most;
}

static int measure_segment(const NearSeed *seeds, int count) {
  int32_t seed;
  memcpy(&seed, seeds, sizeof seed);
  for (int k = 0; k < count; k += LANES) {
    const unsigned lanes = get_lanes(count - k);
    const __m256i same = _mm256_cmpeq_epi32(load_lanes(seeds + k, lanes), _mm256_set1_epi32(seed));
    const unsigned bits = lanes & gather_bits(same);
    if (bits != 0xFF) return k + __builtin_ctz(~bits);
  }
  return count;
}

/* Sum over x, y, z of absolute differences. */
static __m256i sum_differences(__m256i a, __m256i b) {
  const __m256i difference =
      _mm256_and_si256(_mm256_sub_epi8(_mm256_max_epu8(a, b), _mm256_min_epu8(a, b)), _mm256_set1_epi32(0xFFFFFF));
  return _mm256_madd_epi16(_mm256_maddubs_epi16(difference, _mm256_set1_epi8(1)), _mm256_set1_epi16(1));
}

/* Eight luminances; what lies behind the frame's last isn't read. */
static __m256i load_lumas(const StyFrame *frame, size_t index) {
  const size_t size = (size_t)frame->width * (size_t)frame->height;
  const size_t start = index + LANES <= size ? index : size - LANES;
  uint64_t bytes;
  memcpy(&bytes, frame->luma + start, sizeof bytes);
  return _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((long long)(bytes >> 8 * (index - start))));
}

static unsigned get_waiting(const Waiting *waiting, int k) {
  const uint64_t *words = waiting->words + k / WORD;
  const int shift = k % WORD;
  return (unsigned)(words[0] >> shift | words[1] << 1 << (WORD - 1 - shift)) & 0xFF;
}

static void remove_waiting(Waiting *waiting, int k, unsigned lanes) {
  uint64_t *words = waiting->words + k / WORD;
  const int shift = k % WORD;
  words[0] &= ~((uint64_t)lanes << shift);
  words[1] &= ~((uint64_t)lanes >> 1 >> (WORD - 1 - shift));
}

/* Matches side by side, from source column x on. */
static void store_matches(StyMatch *matches, unsigned lanes, int x, uint64_t rest) {
  const __m256i bits = spread_bits(lanes), all = _mm256_set1_epi64x((long long)(rest + (unsigned)x));
  const __m256i low = _mm256_cvtepi32_epi64(_mm256_castsi256_si128(bits));
  const __m256i high = _mm256_cvtepi32_epi64(_mm256_extracti128_si256(bits, 1));
  _mm256_maskstore_epi64((long long *)(void *)matches, low, _mm256_add_epi64(all, _mm256_setr_epi64x(0, 1, 2, 3)));
  _mm256_maskstore_epi64((long long *)(void *)(matches + 4), high,
                         _mm256_add_epi64(all, _mm256_setr_epi64x(4, 5, 6, 7)));
}

static void try_pixels(const Run *run, const Segment *segment, Waiting *waiting) {
  const Source *source = run->source;
  const StyFrame *frame = run->frame;
  const Proposal *proposal = &segment->proposal;
  if (source->spread != 0 || proposal->is_moved ||
      (frame->luma && (size_t)frame->width * (size_t)frame->height < LANES)) {
    try_pixels_singly(run, segment, waiting);
    return;
  }
  const int y = proposal->found.y - segment->seed.y, x0 = proposal->found.x - segment->seed.x;
  if (y < 0 || y >= source->height) return;
  const int begin = segment->a > -x0 ? segment->a : -x0;
  const int end = segment->b < source->width - x0 ? segment->b : source->width - x0;
  const unsigned char *row = source->guide + (size_t)y * (size_t)source->width * 4;
  const uint64_t rest = (uint64_t)y << 16 | (uint64_t)(unsigned)segment->level << 32 |
                        (uint64_t)(unsigned)proposal->lighting << 40 | (uint64_t)source->number << 48;
  for (int k = begin; k < end; k += LANES) {
    const unsigned lanes = get_lanes(end - k) & get_waiting(waiting, k);
    if (lanes == 0) continue;
    const __m256i texels = load_lanes(row + 4 * (x0 + k), get_lanes(end - k));
    const __m256i own = load_lanes(frame->guide + 4 * (run->first + (size_t)k), get_lanes(end - k));
    __m256i error = _mm256_slli_epi32(sum_differences(texels, own), 8);
    if (frame->luma) {
      const __m256i lighting = _mm256_set1_epi32(source->luma[proposal->lighting]);
      const __m256i difference =
          _mm256_abs_epi32(_mm256_sub_epi32(load_lumas(frame, run->first + (size_t)k), lighting));
      error = _mm256_add_epi32(error, _mm256_mullo_epi32(difference, _mm256_set1_epi32(source->luma_weight)));
    }
    const unsigned low = gather_bits(_mm256_cmpgt_epi32(_mm256_set1_epi32(source->threshold), error));
    const unsigned taken = lanes & low & test_coverage(texels);
    store_matches(run->matches + k, taken, x0 + k, rest);
    remove_waiting(waiting, k, taken);
  }
}

/* Candidates in the order of the reference's loops, which a later one must beat. */
static void choose_seeds(const SeedGrid *grid, int y, int k0, int k1, NearSeed *out) {
  const __m128i level = _mm_cvtsi32_si128(grid->level);
  for (int k = k0; k < k1; k += LANES) {
    const int cell = (k + grid->phase) >> grid->level;
    const __m256i at = count_up(k), phase = _mm256_set1_epi32(grid->phase);
    const __m256i cells =
        _mm256_sub_epi32(_mm256_srl_epi32(_mm256_add_epi32(at, phase), level), _mm256_set1_epi32(cell));
    const __m256i here = _mm256_or_si256(at, _mm256_set1_epi32(y << 16));
    __m256i least = _mm256_set1_epi32(INT32_MAX), chosen = here;
    for (int i = 0; i < 9; i++) {
      const __m256i row = _mm256_loadu_si256((const void *)(grid->rows[i % 3] + cell + i / 3));
      const __m256i way = _mm256_sub_epi16(_mm256_permutevar8x32_epi32(row, cells), here);
      const __m256i distance = _mm256_madd_epi16(way, way);
      chosen = _mm256_blendv_epi8(chosen, way, _mm256_cmpgt_epi32(least, distance));
      least = _mm256_min_epi32(least, distance);
    }
    _mm256_maskstore_epi32((int *)(void *)(out + k), spread_bits(get_lanes(k1 - k)), _mm256_add_epi16(chosen, at));
  }
}

static void place_offsets(const StySeedOffset *offsets, int k0, int k1, NearSeed *out) {
  for (int k = k0; k < k1; k += LANES) {
    int64_t pairs[2] = {0, 0};
    memcpy(pairs, offsets + k, sizeof *offsets * (size_t)(k1 - k < LANES ? k1 - k : LANES));
    const __m256i ways = _mm256_cvtepi8_epi16(_mm_set_epi64x(pairs[1], pairs[0]));
    _mm256_maskstore_epi32((int *)(void *)(out + k), spread_bits(get_lanes(k1 - k)),
                           _mm256_add_epi16(ways, count_up(k)));
  }
}

static int finish_run(const Run *run, int level, Waiting *waiting) {
  (void)run;
  (void)waiting;
  return level;
}

#define UNIT(name) sty_##name##_avx2
#include "runs_plain.h"
#include "runs_seeds.h"
#include "runs_segments.h"

static void compare_voters(const Voter *a, const Voter *b, uint64_t bits[COLUMN_WORDS]) {
  for (int word = 0; word < COLUMN_WORDS; word++) {
    bits[word] = 0;
    for (int k = 0; k < WORD; k += 4) {
      const __m256i same = _mm256_cmpeq_epi64(_mm256_loadu_si256((const void *)(a + word * WORD + k)),
                                              _mm256_loadu_si256((const void *)(b + word * WORD + k)));
      bits[word] |= (uint64_t)(unsigned)_mm256_movemask_pd(_mm256_castsi256_pd(same)) << k;
    }
  }
}

#include "blend_body.h"
#include "runs_body.h"

#endif
