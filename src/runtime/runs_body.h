/* The loops of the fast forms, for the files that include them. Before that each defines, for its vector unit,
 *   UNIT(name), what its functions are called;
 *   static int count_alike(const uint8_t *guide, int most): pixels from the first on that are covered if it is, and
 *     aren't if it isn't; at least 1;
 *   static int measure_segment(const NearSeed *seeds, int count): how many seeds equal the first, at least 1;
 *   static void try_pixels(const Run *, const Segment *, Waiting *): serves the waiting pixels of a segment that take
 *     its proposal;
 *   static void choose_seeds(const SeedGrid *, int y, int k0, int k1, NearSeed *out): the nearest of each pixel of the
 *     row y rows below the grid's, less its own first pixel;
 *   static void place_offsets(const StySeedOffset *, int k0, int k1, NearSeed *out): seeds from ways to them;
 *   static void empty_matches(StyMatch *, int count): no_match in all;
 *   static int finish_run(const Run *, int level, Waiting *): may serve all that wait from this level on; the level
 *     that it left off at, -1 where nothing waits any more. */

/* ---- seeds ---- */

/* Cells for `count` pixels from p on. */
static void place_cells(const unsigned char *jitter, int amount, int level, Point p, int count, SeedGrid *grid) {
  const Point cell = {shift_down(p.x, level), shift_down(p.y, level)};
  grid->level = level;
  grid->phase = p.x - cell.x * (1 << level);
  const int cells = ((grid->phase + count - 1) >> level) + 3;
  for (int row = 0; row < 3; row++)
    for (int c = 0; c < cells; c++) {
      const Point seed = place_seed(jitter, amount, cell.x + c - 1, cell.y + row - 1, 1 << level);
      grid->rows[row][c] = (NearSeed){(int16_t)(seed.x - p.x), (int16_t)(seed.y - p.y)};
    }
}

/* A row of cells has the same seeds for all its rows of pixels. */
void UNIT(fill_seeds)(const unsigned char *jitter, int amount, int level, Point p, int count, int rows,
                      StySeedOffset *out, size_t stride) {
  const int h = 1 << level;
  SeedGrid grid;
  SeedRow seeds;
  for (int k = 0; k < count; k += RUN_LENGTH) {
    const int length = count - k < RUN_LENGTH ? count - k : RUN_LENGTH;
    for (int row = 0, end; row < rows; row = end) {
      const Point first = {p.x + k, p.y + row};
      const int left = h - (first.y - shift_down(first.y, level) * h);
      end = left < rows - row ? row + left : rows;
      place_cells(jitter, amount, level, first, length, &grid);
      for (int y = row; y < end; y++) {
        StySeedOffset *offsets = out + (size_t)y * stride + k;
        choose_seeds(&grid, y - row, 0, length, seeds);
        for (int i = 0; i < length; i++) offsets[i] = (StySeedOffset){(int8_t)(seeds[i].x - i), (int8_t)seeds[i].y};
      }
    }
  }
}

/* Seeds worked out before that answer for a run at this level, from its first pixel on; or NULL. */
static const StySeedOffset *find_kept_seeds(const Run *run, int level) {
  const int x0 = run->x - run->anchor.x, y = run->y - run->anchor.y;
  for (int i = 0; run->frame->seeds && i < run->frame->seeds_count; i++) {
    const StySeeds *seeds = &run->frame->seeds[i];
    const StyRect *area = &seeds->area;
    if (seeds->table != run->source->jitter_table || seeds->amount != run->source->jitter_amount) continue;
    if (x0 < area->x0 || x0 + run->length > area->x1 || y < area->y0 || y >= area->y1) continue;
    const size_t width = (size_t)(area->x1 - area->x0), height = (size_t)(area->y1 - area->y0);
    return seeds->offsets + ((size_t)(level - 1) * height + (size_t)(y - area->y0)) * width + (x0 - area->x0);
  }
  return NULL;
}

static NearSeed find_near_seed(const Source *source, Point p, int k, int level) {
  const Point seed = find_seed(source->jitter, source->jitter_amount, (Point){p.x + k, p.y}, level);
  return (NearSeed){(int16_t)(seed.x - p.x), (int16_t)(seed.y - p.y)};
}

/* At level 0 a cell is a pixel, and its seed is on it, but for a jitter of a whole cell. */
static void find_pixel_seeds(const Source *source, Point p, int k0, int k1, SeedRow out) {
  const unsigned char *row = source->jitter + (unsigned)p.y % STY_JITTER_SIZE * (size_t)(2 * STY_JITTER_SIZE);
  for (int k = k0; k < k1; k++) out[k] = (NearSeed){(int16_t)k, 0};
  if (source->jitter_amount < 255) return;
  for (int k = k0; k < k1; k++) {
    const unsigned char *j = row + 2 * ((unsigned)(p.x + k) % STY_JITTER_SIZE);
    if (j[0] == 255 || j[1] == 255) out[k] = find_near_seed(source, p, k, 0);
  }
}

/* Seeds of the pixels k0..k1-1 of a run. */
static void find_seeds(const Run *run, int level, int k0, int k1, SeedRow out) {
  const Source *source = run->source;
  const Point p = {run->x - run->anchor.x, run->y - run->anchor.y};
  const StySeedOffset *kept = level > 0 && level <= STY_SEED_LEVELS ? find_kept_seeds(run, level) : NULL;
  if (kept) {
    place_offsets(kept, k0, k1, out);
  } else if (level > 0 && level <= STY_SEED_LEVELS) {
    SeedGrid grid;
    place_cells(source->jitter, source->jitter_amount, level, p, k1, &grid);
    choose_seeds(&grid, 0, k0, k1, out);
  } else if (level == 0) {
    find_pixel_seeds(source, p, k0, k1, out);
  } else {
    for (int k = k0; k < k1; k++) out[k] = find_near_seed(source, p, k, level);
  }
}

/* ---- matching ---- */

static Segment cut_segment(const Run *run, int level, const SeedRow seeds, int a, int end) {
  const Point in_frame = {run->x + seeds[a].x, run->y + seeds[a].y};
  const Point in_grid = {in_frame.x - run->anchor.x, in_frame.y - run->anchor.y};
  Segment segment = {.a = a, .b = a + measure_segment(seeds + a, end - a), .seed = seeds[a], .level = level};
  segment.proposal = propose(run->source, run->frame, in_frame, in_grid, level);
  /* The pixels of a run have one object, where that matters. */
  if (run->frame->anchors && segment.proposal.object != get_object(run->frame, run->first))
    segment.proposal.is_made = false;
  return segment;
}

static void try_segments(const Run *run, int level, const SeedRow seeds, int a, int end, Waiting *waiting) {
  while (a < end) {
    const Segment segment = cut_segment(run, level, seeds, a, end);
    if (segment.proposal.is_made) try_pixels(run, &segment, waiting);
    a = find_waiting(waiting, segment.b, end);
  }
}

static void match_run(const Run *run) {
  Waiting waiting;
  SeedRow seeds;
  wait_for_all(&waiting, run->length);
  int first = 0;
  for (int level = run->source->style.top_level; level >= 0 && first < run->length; level--) {
    level = finish_run(run, level, &waiting);
    if (level < 0) return;
    const int end = find_last_waiting(&waiting) + 1;
    find_seeds(run, level, first, end, seeds);
    try_segments(run, level, seeds, first, end, &waiting);
    first = find_waiting(&waiting, first, run->length);
  }
  for (int k = first; k < run->length; k = find_waiting(&waiting, k + 1, run->length))
    run->matches[k] = fall_back(run->source, run->frame, run->first + (size_t)k);
}

/* Pixels from the first on that are stylized as it is, and have its object where that matters. */
static int measure_run(const StyBundle *bundle, const StyFrame *frame, int style, size_t first, int most) {
  const int alike = count_alike(frame->guide + 4 * first, most);
  if (!frame->styles && !frame->anchors) return alike;
  int length = 1;
  while (length < alike && get_pixel_style(bundle, frame, first + (size_t)length) == style &&
         (!frame->anchors || get_object(frame, first + (size_t)length) == get_object(frame, first)))
    length++;
  return length;
}

StyRuntimeStatus UNIT(transfer)(const StyBundle *bundle, const StyFrame *frame, StyRect rect, StyMatch *matches) {
  OpenSources open;
  memset(open.styles, 0, sizeof open.styles);
  Run run = {.frame = frame};
  for (run.y = rect.y0; run.y < rect.y1; run.y++)
    for (run.x = rect.x0; run.x < rect.x1; run.x += run.length) {
      run.first = get_pixel_index(frame, run.x, run.y);
      run.matches = matches + run.first;
      const int style = get_pixel_style(bundle, frame, run.first);
      run.length = measure_run(bundle, frame, style, run.first, rect.x1 - run.x);
      if (style == 0) {
        empty_matches(run.matches, run.length);
        continue;
      }
      if (run.length > RUN_LENGTH) run.length = RUN_LENGTH;
      const StyRuntimeStatus status = find_source(bundle, frame, style, &open, &run.source);
      if (status != STY_RUNTIME_OK) return status;
      run.anchor = get_anchor(frame, run.first);
      match_run(&run);
    }
  return STY_RUNTIME_OK;
}
