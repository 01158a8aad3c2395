/* What units do without vectors where those gain nothing: see runs_body.h and blend_body.h. */

static void place_offsets(const StySeedOffset *offsets, int k0, int k1, NearSeed *out) {
  for (int k = k0; k < k1; k++) out[k] = (NearSeed){(int16_t)(k + offsets[k].x), offsets[k].y};
}

static void empty_matches(StyMatch *matches, int count) {
  for (int k = 0; k < count; k++) matches[k] = no_match;
}

static int finish_run(const Run *run, int level, Waiting *waiting) {
  (void)run;
  (void)waiting;
  return level;
}

static void collect_voters(const Blend *blend, size_t index, int x, int y, int count, Voter *out) {
  for (int k = 0; k < count; k++) out[k] = get_voter(blend, index + (size_t)k, x + k, y);
}

static int blend_group(Strip *strip, const Pixel *pixel, const uint64_t alike[COLUMN_WORDS]) {
  (void)strip;
  (void)pixel;
  (void)alike;
  return 0;
}
