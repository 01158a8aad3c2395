/* The fast form of sty_blend_frame, for the files that include it (see runs_body.h). Most of a picture is the inside of
 * chunks, where all votes are for the same source pixel. Neighbours that vote alike are found a row at a time, as bits;
 * pixels whose whole window is alike copy their match, the others count each distinct vote once, with its weight.
 * Before including this a file defines
 *   static void collect_voters(const Blend *, size_t index, int x, int y, int count, Voter *out): from (x, y) on;
 *   static int blend_group(Strip *, const Pixel *, const uint64_t alike[COLUMN_WORDS]): may blend the pixel and some to
 *     its right; how many.
 *   static void compare_voters(const Voter *a, const Voter *b, uint64_t bits[COLUMN_WORDS]): bit k is set where
 *     a[k] equals b[k], k < COLUMNS; one more may be read. */

/* Fills the row y, after its predecessor. Columns outside of the frame are like their neighbours. */
static void fill_row(Strip *strip, int y) {
  const StyFrame *frame = strip->blend->frame;
  VoterRow *row = get_row(strip, y);
  const int from = strip->x0 < 0 ? -strip->x0 : 0;
  const int to = frame->width - strip->x0 < COLUMNS ? frame->width - strip->x0 : COLUMNS;
  if (from > 0 || to < COLUMNS) memset(row->voters, 0, sizeof row->voters);
  collect_voters(strip->blend, get_pixel_index(frame, strip->x0 + from, y), strip->x0 + from, y, to - from,
                 row->voters + from);
  compare_voters(row->voters + 1, row->voters, row->like_left);
  for (int word = COLUMN_WORDS - 1; word >= 0;
       word--) /* column 0 has no left: what was found of column 1 is its bit 0 */
    row->like_left[word] = row->like_left[word] << 1 | (word > 0 ? row->like_left[word - 1] >> (WORD - 1) : 0);
  if (from > 0) set_bits(row->like_left, 0, from + 1);
  if (to < COLUMNS) set_bits(row->like_left, to, COLUMNS);
  if (y == strip->first)
    memset(row->like_above, 0, sizeof row->like_above);
  else
    compare_voters(row->voters, get_row(strip, y - 1)->voters, row->like_above);
}

/* Bits of the columns of row y whose whole window votes alike. */
static void find_alike(Strip *strip, int y, int radius, uint64_t out[COLUMN_WORDS]) {
  const int height = strip->blend->frame->height;
  for (int word = 0; word < COLUMN_WORDS; word++) out[word] = UINT64_MAX;
  for (int ny = y > radius ? y - radius : 0; ny <= y + radius && ny < height; ny++) {
    const VoterRow *row = get_row(strip, ny);
    for (int word = 0; word < COLUMN_WORDS; word++) {
      for (int shift = 1 - radius; shift <= radius; shift++) out[word] &= shift_bits(row->like_left, word, shift);
      if (ny > y - radius && ny > 0) out[word] &= row->like_above[word];
    }
  }
}

/* ---- pixels ---- */

/* What a window votes for, each with its weight. */
enum { MOST_VOTES = 8 };
typedef struct Ballot {
  int count;
  Voter voters[MOST_VOTES];
  int weights[MOST_VOTES];
} Ballot;

/* Counts the votes of one voter for the pixel (x, y). */
static void count_vote(const Source *source, int x, int y, const Voter *voter, int weight, Tally *tally) {
  const int layer = voter->tag >> 9;
  const int source_x = (uint16_t)(voter->x + x), source_y = (uint16_t)(voter->y + y);
  if (layer < source->style.layer_count && find_source_texel(source, source_x, source_y))
    add_votes(tally, source, layer, source_x, source_y, weight);
}

static void cast_votes(const Source *source, int x, int y, const Voter *voter, int weight, Ballot *ballot,
                       Tally *tally) {
  int i = 0;
  while (i < ballot->count && !is_same_vote(&ballot->voters[i], voter)) i++;
  if (i < ballot->count) {
    ballot->weights[i] += weight;
  } else if (i < MOST_VOTES) {
    ballot->voters[i] = *voter;
    ballot->weights[i] = weight;
    ballot->count++;
  } else {
    count_vote(source, x, y, voter, weight, tally);
  }
}

/* How many of `count` pixels from `index` on are as deep as the pixel `own`. */
static int count_near(const Blend *blend, const Source *source, size_t own, size_t index, int count) {
  int near = 0;
  for (int i = 0; i < count; i++) near += is_depth_near(source, blend->frame, own, index + (size_t)i);
  return near;
}

static Tally poll_window(Strip *strip, const Source *source, int x, int y) {
  const Blend *blend = strip->blend;
  const StyFrame *frame = blend->frame;
  const int radius = source->style.radius, style = source->number + 1;
  const size_t own = get_pixel_index(frame, x, y);
  const bool has_depth = frame->depth && source->style.depth_tolerance != 0;
  const bool has_objects = source->style.flags & STY_FLAG_OBJECTS;
  const int x_end = x + radius < frame->width ? x + radius : frame->width - 1;
  const int y_end = y + radius < frame->height ? y + radius : frame->height - 1;
  const uint16_t object = get_row(strip, y)->voters[x - strip->x0].object;
  Ballot ballot = {.count = 0};
  Tally tally = {{0, 0, 0}, 0, 0};
  for (int ny = y > radius ? y - radius : 0; ny <= y_end; ny++) {
    const VoterRow *row = get_row(strip, ny);
    for (int nx = x > radius ? x - radius : 0, alike; nx <= x_end; nx += alike) {
      const int k = nx - strip->x0;
      const Voter *voter = &row->voters[k];
      alike = 1 + count_ones(row->like_left, k + 1);
      if (alike > x_end + 1 - nx) alike = x_end + 1 - nx;
      if ((voter->tag & 511) != style || (has_objects && voter->object != object)) continue;
      const int weight = has_depth ? count_near(blend, source, own, get_pixel_index(frame, nx, ny), alike) : alike;
      if (weight > 0) cast_votes(source, x, y, voter, weight, &ballot, &tally);
    }
  }
  for (int i = 0; i < ballot.count; i++) count_vote(source, x, y, &ballot.voters[i], ballot.weights[i], &tally);
  return tally;
}

/* All votes are for the match itself: its colour, whether it is masked or not. */
static void blend_alike(const Blend *blend, const Pixel *pixel) {
  const Source *source = pixel->source;
  const StyMatch *match = &blend->matches[pixel->index];
  Tally tally = {{0, 0, 0}, 0, 0};
  uint16_t colour[4];
  if (match->x < source->width && match->y < source->height && match->layer < source->style.layer_count)
    add_votes(&tally, source, match->layer, match->x, match->y, 1);
  resolve_votes(blend, pixel, &tally, colour);
  write_pixel(blend, pixel->index, colour);
}

/* Whether opaque paint on covered pixels comes through as it is. */
static bool keeps_paint(const Blend *blend, const Source *source) {
  return blend->bits == 8 && !(source->style.flags & STY_FLAG_BASE) &&
         (!blend->frame->albedo || !source->colour_weight);
}

/* Pixels side by side of one chunk whose windows are alike, `count` of them. */
static void copy_chunk(const Blend *blend, Pixel *pixel, int count) {
  const Source *source = pixel->source;
  const StyMatch *match = &blend->matches[pixel->index];
  const bool is_inside =
      match->x + count <= source->width && match->y < source->height && match->layer < source->style.layer_count;
  const bool is_copy = is_inside && keeps_paint(blend, source);
  const unsigned char *paint = is_copy ? get_exemplar(source, match->layer, match->x, match->y) : NULL;
  for (; count > 0; count--, pixel->index++, pixel->x++) {
    if (is_copy && (paint[3] & blend->frame->guide[4 * pixel->index + 3]) == 255)
      memcpy((uint8_t *)blend->out + 4 * pixel->index, paint, 4);
    else
      blend_alike(blend, pixel);
    if (is_copy) paint += 4;
  }
}

static void blend_mixed(Strip *strip, const Pixel *pixel) {
  const Blend *blend = strip->blend;
  const Source *source = pixel->source;
  const StyMatch *own = &blend->matches[pixel->index];
  uint16_t colour[4];
  Tally tally = poll_window(strip, source, pixel->x, pixel->y);
  if (tally.votes == 0 && own->x < source->width && own->y < source->height && own->layer < source->style.layer_count)
    add_votes(&tally, source, own->layer, own->x, own->y, 1);
  resolve_votes(blend, pixel, &tally, colour);
  write_pixel(blend, pixel->index, colour);
}

static StyRuntimeStatus blend_row(Strip *strip, int y, OpenSources *open) {
  const Blend *blend = strip->blend;
  const StyFrame *frame = blend->frame;
  const VoterRow *row = get_row(strip, y);
  uint64_t alike[COLUMN_WORDS];
  int radius = -1;
  for (int k = strip->begin; k < strip->end;) {
    Pixel pixel = {strip->x0 + k, y, get_pixel_index(frame, strip->x0 + k, y), NULL};
    const int style = row->voters[k].tag & 511;
    if (style == 0) {
      const int left = strip->end - k, stretch = 1 + count_ones(row->like_left, k + 1);
      const int count = stretch < left ? stretch : left;
      const size_t size = 4 * (size_t)blend->bits / 8;
      memset((char *)blend->out + pixel.index * size, 0, (size_t)count * size);
      k += count;
      continue;
    }
    const StyRuntimeStatus status = find_source(blend->bundle, frame, style, open, &pixel.source);
    if (status != STY_RUNTIME_OK) return status;
    if (radius != pixel.source->style.radius) {
      radius = pixel.source->style.radius;
      find_alike(strip, y, radius, alike);
    }
    if (pixel.source->spread != 0) { /* neighbours of a chunk vote for parts of pixels */
      sty_blend_pixel((void *)(uintptr_t)blend, &pixel);
      k++;
    } else if (alike[k / WORD] >> k % WORD & 1) {
      int count = 1 + count_ones(row->like_left, k + 1);
      const int also = count_ones(alike, k), left = strip->end - k;
      count = count < also ? count : also;
      count = count < left ? count : left;
      copy_chunk(blend, &pixel, count);
      k += count;
    } else {
      const int done = blend_group(strip, &pixel, alike);
      if (done == 0) blend_mixed(strip, &pixel);
      k += done ? done : 1;
    }
  }
  return STY_RUNTIME_OK;
}

/* The largest radius of the styles that a frame may have. */
static int find_reach(const Blend *blend) {
  const StyTexture *params = &blend->bundle->textures[STY_BUNDLE_PARAMS];
  const StyFrame *frame = blend->frame;
  int reach = 0;
  for (int style = frame->styles ? 1 : frame->style; style <= (frame->styles ? (int)params->width : frame->style);
       style++) {
    const uint32_t bits = read_u32(params->texels + (size_t)(style - 1) * params->texel_size + 8);
    float radius;
    memcpy(&radius, &bits, sizeof radius);
    if (radius > (float)reach) reach = radius < STY_MAX_RADIUS ? (int)radius : STY_MAX_RADIUS;
  }
  return reach;
}

StyRuntimeStatus UNIT(blend)(const Blend *blend, StyRect rect) {
  const int height = blend->frame->height, reach = find_reach(blend);
  OpenSources open;
  Strip strip = {.blend = blend, .first = rect.y0 > reach ? rect.y0 - reach : 0};
  memset(open.styles, 0, sizeof open.styles);
  for (int x = rect.x0; x < rect.x1; x += STRIP) {
    strip.x0 = x - MARGIN;
    strip.begin = MARGIN;
    strip.end = MARGIN + (rect.x1 - x < STRIP ? rect.x1 - x : STRIP);
    for (int y = rect.y0, filled = strip.first; y < rect.y1; y++) {
      for (; filled <= y + reach && filled < height; filled++) fill_row(&strip, filled);
      const StyRuntimeStatus status = blend_row(&strip, y, &open);
      if (status != STY_RUNTIME_OK) return status;
    }
  }
  return STY_RUNTIME_OK;
}
