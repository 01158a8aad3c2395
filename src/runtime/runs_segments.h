/* A run matched by segments, for the files that include it. Before that each defines
 *   static int measure_segment(const NearSeed *seeds, int count): how many seeds equal the first, at least 1;
 *   static void try_pixels(const Run *, const Segment *, Waiting *): serves the waiting pixels of a segment that take
 *     its proposal;
 *   static int finish_run(const Run *, int level, Waiting *): may serve all that wait from this level on; the level
 *     that it left off at, -1 where nothing waits any more;
 * and includes runs_seeds.h. */

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
